//! The comparison in words and tables for the terminal.

use gyradius_dispersion::ModelKind;
use std::fmt::{self, Display, Formatter};

use super::{BodyResult, LevelResult, ModelComparison, contest::Cell, measure::Measure};
use gyradius_report::{optional, percent, significant};

/// Columns of a terminal that are used.
const MOST: usize = 100;
const NAME: usize = 32;
/// The narrowest column of a level.
const COLUMN: usize = 10;

/// A table of models by levels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Block {
    Unrealizable,
    Spread(Measure),
    CovarianceOff,
    MeanOff,
}

impl Block {
    pub(crate) fn title(self) -> String {
        match self {
            Self::Unrealizable => "unrealizable draws, %".to_owned(),
            Self::Spread(measure) => measure.title(),
            Self::CovarianceOff => "covariance off the reference, % of its size".to_owned(),
            Self::MeanOff => "mean off the reference, % of its deviation".to_owned(),
        }
    }

    /// What a cell has to say, shares of none and of all in words; a dash if there is no such model.
    pub(crate) fn cell(self, cell: Option<&Cell>) -> String {
        let Some(r) = cell.and_then(|cell| cell.results.as_ref()) else { return "–".to_owned() };
        let by_construction = cell.is_some_and(|cell| cell.realizable_by_construction);
        let off = |x: f64| {
            let rounding = if r.fit.from_draws { 0.0 } else { 5e-5 };
            if x < rounding { "0".to_owned() } else { significant(100.0 * x, 2) }
        };
        match self {
            Self::Unrealizable if by_construction && r.unrealizable.count == 0 => "0".to_owned(),
            Self::Unrealizable if [0, r.unrealizable.of].contains(&r.unrealizable.count) => {
                percent(&r.unrealizable)
            }
            Self::Unrealizable => significant(100.0 * r.unrealizable.share, 3),
            Self::Spread(measure) => {
                optional(r.spread(measure).and_then(super::measure::Spread::headline), 3)
            }
            Self::CovarianceOff => off(r.fit.covariance_off),
            Self::MeanOff => off(r.fit.mean_off),
        }
    }
}

/// Whether a model's covariance is far from what was asked for.
pub(crate) fn is_poor(cell: Option<&Cell>) -> bool {
    cell.and_then(|cell| cell.results.as_ref()).is_some_and(|r| r.fit.is_poor())
}

/// A level as a heading.
pub(crate) fn heading(level: &LevelResult) -> String {
    level.level_percent.map_or_else(|| "as given".to_owned(), |p| format!("{p} %"))
}

/// The models of a body, in order.
pub(crate) fn kinds(body: &BodyResult) -> Vec<ModelKind> {
    let mut kinds: Vec<ModelKind> = Vec::new();
    for cell in body.levels.iter().flat_map(|level| &level.models) {
        if !kinds.contains(&cell.model) {
            kinds.push(cell.model);
        }
    }
    kinds
}

/// What must be said of a body beside its tables: references and models that there are none of, measures that not all draws have, and
/// separations that failed.
pub(crate) fn remarks(body: &BodyResult) -> Vec<String> {
    let mut remarks = Vec::new();
    // A body as it is given has no level to be named.
    let is_given = body.levels.iter().all(|level| level.level_percent.is_none());
    let at = |levels: &str| if is_given { String::new() } else { format!(" at {levels}") };
    // The reason at the lowest of the levels stands for all: only its numbers change.
    let mut tell = |what: &str, reasons: Vec<(String, &str)>| {
        if let Some((_, reason)) = reasons.first() {
            let levels: Vec<&str> = reasons.iter().map(|(level, _)| level.as_str()).collect();
            remarks.push(format!("{what}{}: {reason}", at(&levels.join(", "))));
        }
    };
    let levels = || body.levels.iter();
    tell(
        "no reference",
        levels().filter_map(|l| Some((heading(l), l.problem.as_deref()?))).collect(),
    );
    let impossible =
        |l: &'_ LevelResult| l.reference.as_ref().is_some_and(|r| r.impossible.is_some());
    let reasons = levels()
        .filter(|l| impossible(l))
        .filter_map(|l| Some((heading(l), l.reference.as_ref()?.impossible.as_deref()?)));
    tell("reference", reasons.collect());
    for kind in kinds(body) {
        let reasons = levels()
            .filter_map(|l| Some((heading(l), l.cell(kind)?.problem.as_deref()?)))
            .collect();
        tell(&format!("no {kind}"), reasons);
    }
    for kind in kinds(body) {
        for measure in Measure::ALL {
            let some = levels().filter_map(|level| {
                let spread = level.cell(kind)?.results.as_ref()?.spread(measure)?;
                let all = spread.n + spread.undefined;
                (spread.n < all).then(|| format!("{} of {all}{}", spread.n, at(&heading(level))))
            });
            let some: Vec<String> = some.collect();
            if !some.is_empty() {
                let (what, some) = (measure.label(), some.join(", "));
                remarks.push(format!(
                    "{kind}: the quantiles of {what} are of {some}, which alone have a finite one"
                ));
            }
        }
    }
    for kind in kinds(body) {
        let mut why: Vec<&str> = Vec::new();
        let mut failed: Vec<String> = Vec::new();
        let mut of = 0;
        for level in levels() {
            let Some(r) = level.cell(kind).and_then(|c| c.results.as_ref()) else { continue };
            if r.failed_separations > 0 {
                failed.push(format!("{}{}", r.failed_separations, at(&heading(level))));
                of = r.separations;
            }
            for (kind, _) in &r.failures {
                if !why.contains(&kind.as_str()) {
                    why.push(kind);
                }
            }
        }
        if !failed.is_empty() {
            let (failed, why) = (failed.join(", "), why.join("; "));
            remarks.push(format!("{kind}: of {of} separations failed {failed}: {why}"));
        }
    }
    remarks
}

/// What each model was given, with the levels where it was not always the same.
pub(crate) fn matched(body: &BodyResult, kind: ModelKind) -> String {
    let mut told: Vec<(&str, Vec<String>)> = Vec::new();
    for level in &body.levels {
        let Some(r) = level.cell(kind).and_then(|cell| cell.results.as_ref()) else { continue };
        match told.iter_mut().find(|(what, _)| *what == r.matched) {
            Some((_, levels)) => levels.push(heading(level)),
            None => told.push((&r.matched, vec![heading(level)])),
        }
    }
    match told.as_slice() {
        [] => "nothing: there is no such model".to_owned(),
        [(what, _)] => (*what).to_owned(),
        several => several
            .iter()
            .map(|(what, levels)| format!("{what} (at {})", levels.join(", ")))
            .collect::<Vec<_>>()
            .join("; "),
    }
}

/// The tables that the terminal shows; the page has more.
const BLOCKS: [Block; 5] = [
    Block::Unrealizable,
    Block::Spread(Measure::InertiaRatio),
    Block::Spread(Measure::Wobble),
    Block::Spread(Measure::Nutation),
    Block::CovarianceOff,
];

impl Display for ModelComparison {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let s = &self.settings;
        let separations = s.separations;
        wrapped(
            f,
            &format!(
                "Reference {}. {} {} draws a model and level, {separations} of them separated in the \
                 scenario {} in place of its payload; seed {}.",
                s.reference.name(),
                s.reference_meaning,
                s.draws,
                s.scenario,
                s.seed
            ),
            "",
        )?;
        wrapped(
            f,
            "–: there is no such model, see below, or no such number; *: covariance further off the \
             reference than that of a body known exactly (100 %), so no like for like.",
            "",
        )?;
        for body in &self.bodies {
            write_body(f, body)?;
        }
        writeln!(f, "\nMatched, of the reference:")?;
        for &kind in &s.models {
            // The bodies differ in levels at most.
            let told: Vec<String> = self.bodies.iter().map(|body| matched(body, kind)).collect();
            if told.windows(2).all(|pair| pair[0] == pair[1]) {
                wrapped(
                    f,
                    &format!("{:NAME$}{}", format!("  {kind}"), told[0]),
                    &" ".repeat(NAME),
                )?;
            } else {
                for (body, what) in self.bodies.iter().zip(told) {
                    let line = format!("{:NAME$}{}: {what}", format!("  {kind}"), body.name);
                    wrapped(f, &line, &" ".repeat(NAME))?;
                }
            }
        }
        Ok(())
    }
}

fn write_body(f: &mut Formatter<'_>, body: &BodyResult) -> fmt::Result {
    let [i11, i22, i33, products @ ..] = body.inertia_kg_m2;
    write!(f, "\n{}: I = {i11}, {i22}, {i33}", body.name)?;
    if products.iter().any(|x| *x != 0.0) {
        write!(f, "; {}, {}, {}", products[0], products[1], products[2])?;
    }
    writeln!(
        f,
        " kg·m²\n  nominal inertia ratio {}, wobble {} deg, nutation {} deg",
        optional(body.nominal(Measure::InertiaRatio), 4),
        optional(body.nominal(Measure::Wobble), 3),
        optional(body.nominal(Measure::Nutation), 3)
    )?;
    for block in BLOCKS {
        let cells = body.levels.iter().flat_map(|level| level.models.iter());
        let widths = cells.map(|cell| block.cell(Some(cell)).chars().count());
        let width = widths.fold(COLUMN, usize::max);
        let together = ((MOST - NAME) / (width + 1)).max(1);
        for levels in body.levels.chunks(together) {
            write!(f, "\n{:NAME$}", "")?;
            for level in levels {
                write!(f, "{:>width$} ", heading(level))?;
            }
            writeln!(f, "\n{}", block.title())?;
            for kind in kinds(body) {
                write!(f, "{:NAME$}", format!("  {kind}"))?;
                for level in levels {
                    let cell = level.cell(kind);
                    let star = if is_poor(cell) { "*" } else { " " };
                    write!(f, "{:>width$}{star}", block.cell(cell))?;
                }
                writeln!(f)?;
            }
        }
    }
    let remarks = remarks(body);
    if !remarks.is_empty() {
        writeln!(f)?;
    }
    for remark in remarks {
        wrapped(f, &format!("  {remark}"), "    ")?;
    }
    Ok(())
}

/// The text on lines of at most 100 characters, those after the first indented.
fn wrapped(f: &mut Formatter<'_>, text: &str, indent: &str) -> fmt::Result {
    let mut line = String::new();
    let start: String = text.chars().take_while(|c| *c == ' ').collect();
    line.push_str(&start);
    let mut fresh = true;
    // Runs of spaces within are columns, and kept.
    // A number and its percent sign stay together.
    let text = text.replace(" %", "\u{a0}%");
    for word in text.trim_start().split(' ') {
        if !fresh && line.chars().count() + 1 + word.chars().count() > MOST {
            writeln!(f, "{}", line.trim_end().replace('\u{a0}', " "))?;
            line = indent.to_owned();
            fresh = true;
        }
        if !fresh {
            line.push(' ');
        }
        line.push_str(word);
        fresh = false;
    }
    writeln!(f, "{}", line.trim_end().replace('\u{a0}', " "))
}
