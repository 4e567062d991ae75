//! The comparison as CSV: one row for each model, body, level and measure.

use std::borrow::Cow;

use super::{ModelComparison, contest::Results, measure::Spread};
use crate::csv;

const HEADER: [&str; 26] = [
    "body",
    "level_percent",
    "reference",
    "model",
    "problem",
    "matched",
    "mean_off",
    "covariance_off",
    "off_from_draws",
    "acceptance",
    "draws",
    "unrealizable",
    "unrealizable_share",
    "unrealizable_lower",
    "unrealizable_upper",
    "separations",
    "failed_separations",
    "measure",
    "unit",
    "n",
    "undefined",
    "mean",
    "deviation",
    "p05",
    "median",
    "p95",
];

impl ModelComparison {
    /// One row for each body, level, model and measure, in the columns of docs/compare.md; a model
    /// that cannot be made has one row with its reason. Numbers read back bit for bit.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let mut rows = vec![HEADER.map(Cow::Borrowed).to_vec()];
        for body in &self.bodies {
            for level in &body.levels {
                let place: [Cow<'_, str>; 3] = [
                    body.name.as_str().into(),
                    csv::number(level.level_percent),
                    self.settings.reference.name().into(),
                ];
                let refused = |model: &str, problem: &str| {
                    let mut row = place.to_vec();
                    row.extend([model, problem].map(|text| Cow::Owned(text.to_owned())));
                    row.resize(HEADER.len(), "".into());
                    row
                };
                rows.extend(level.problem.as_ref().map(|problem| refused("", problem)));
                for cell in &level.models {
                    let model = cell.model.to_string();
                    let Some(results) = &cell.results else {
                        rows.push(refused(&model, cell.problem.as_deref().unwrap_or_default()));
                        continue;
                    };
                    let mut start = place.to_vec();
                    start.extend([model.into(), "".into()]);
                    start.extend(results.fields());
                    for spread in &results.spreads {
                        rows.push(start.iter().cloned().chain(spread.fields()).collect());
                    }
                }
            }
        }
        csv::table(rows)
    }
}

impl Results {
    fn fields(&self) -> [Cow<'_, str>; 12] {
        let (unrealizable, fit) = (&self.unrealizable, &self.fit);
        [
            (&*self.matched).into(),
            fit.mean_off.to_string().into(),
            fit.covariance_off.to_string().into(),
            fit.from_draws.to_string().into(),
            csv::number(self.acceptance),
            unrealizable.of.to_string().into(),
            unrealizable.count.to_string().into(),
            unrealizable.share.to_string().into(),
            unrealizable.interval.lower().to_string().into(),
            unrealizable.interval.upper().to_string().into(),
            self.separations.to_string().into(),
            self.failed_separations.to_string().into(),
        ]
    }
}

impl Spread {
    fn fields(&self) -> [Cow<'_, str>; 9] {
        [
            self.measure.name().into(),
            (&*self.unit).into(),
            self.n.to_string().into(),
            self.undefined.to_string().into(),
            csv::number(self.mean),
            csv::number(self.deviation),
            csv::number(self.p05),
            csv::number(self.median),
            csv::number(self.p95),
        ]
    }
}
