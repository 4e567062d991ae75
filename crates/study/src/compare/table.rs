//! The comparison as CSV: one row for each model, body, level and measure.

use super::{ModelComparison, contest::Results, measure::Spread};
use crate::csv;

/// What stands first in a row.
const PLACE: [&str; 5] = ["body", "level_percent", "reference", "model", "problem"];

/// Columns, each with what stands in it.
type Columns<T> = &'static [(&'static str, fn(&T) -> String)];

const RESULTS: Columns<Results> = &[
    ("matched", |r| r.matched.to_string()),
    ("mean_off", |r| r.fit.mean_off.to_string()),
    ("covariance_off", |r| r.fit.covariance_off.to_string()),
    ("off_from_draws", |r| r.fit.from_draws.to_string()),
    ("acceptance", |r| number(r.acceptance)),
    ("draws", |r| r.unrealizable.of.to_string()),
    ("unrealizable", |r| r.unrealizable.count.to_string()),
    ("unrealizable_share", |r| r.unrealizable.share.to_string()),
    ("unrealizable_lower", |r| r.unrealizable.interval.lower().to_string()),
    ("unrealizable_upper", |r| r.unrealizable.interval.upper().to_string()),
    ("separations", |r| r.separations.to_string()),
    ("failed_separations", |r| r.failed_separations.to_string()),
];

const SPREADS: Columns<Spread> = &[
    ("measure", |s| s.measure.name().to_owned()),
    ("unit", |s| s.unit.to_string()),
    ("n", |s| s.n.to_string()),
    ("undefined", |s| s.undefined.to_string()),
    ("mean", |s| number(s.mean)),
    ("deviation", |s| number(s.deviation)),
    ("p05", |s| number(s.p05)),
    ("median", |s| number(s.median)),
    ("p95", |s| number(s.p95)),
];

/// A number with as many digits as read back bit for bit; nothing if there is none.
fn number(number: Option<f64>) -> String {
    number.map_or_else(String::new, |number| number.to_string())
}

impl ModelComparison {
    /// One row for each body, level, model and measure, in the columns of docs/compare.md; a model
    /// that cannot be made has one row with its reason. Numbers read back bit for bit.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let names =
            RESULTS.iter().map(|(name, _)| *name).chain(SPREADS.iter().map(|(name, _)| *name));
        let header: Vec<String> = PLACE.into_iter().chain(names).map(str::to_owned).collect();
        let width = header.len();
        let mut rows = vec![header];
        for body in &self.bodies {
            for level in &body.levels {
                let place = |model: &str, problem: &str| {
                    let (level, reference) = (number(level.level_percent), self.settings.reference);
                    let place = [&*body.name, &level, reference.name(), model, problem];
                    place.map(str::to_owned).to_vec()
                };
                let refused = |model: &str, problem: &str| {
                    let mut row = place(model, problem);
                    row.resize(width, String::new());
                    row
                };
                rows.extend(level.problem.as_ref().map(|problem| refused("", problem)));
                for cell in &level.models {
                    let model = cell.model.to_string();
                    let Some(results) = &cell.results else {
                        rows.push(refused(&model, cell.problem.as_deref().unwrap_or_default()));
                        continue;
                    };
                    let mut start = place(&model, "");
                    start.extend(RESULTS.iter().map(|(_, of)| of(results)));
                    rows.extend(results.spreads.iter().map(|spread| {
                        let own = SPREADS.iter().map(|(_, of)| of(spread));
                        start.iter().cloned().chain(own).collect()
                    }));
                }
            }
        }
        csv::table(rows)
    }
}
