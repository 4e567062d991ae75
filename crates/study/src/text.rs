//! The short table that ends a study on the terminal.

use gyradius_report::{most_frequent, optional, percent};
use std::fmt::{self, Display, Formatter};

use crate::{
    quantity::Quantity,
    summary::{QuantitySummary, Summary},
};

/// What is told of every quantity.
type Told = (&'static str, fn(&QuantitySummary) -> String);
const TOLD: [Told; 3] = [
    ("mean", |q| optional(q.sample.mean, 4)),
    ("sd", |q| optional(q.sample.deviation, 4)),
    ("p95", |q| optional(q.sample.p95, 4)),
];
/// How many runs have a value, which is told where not all of those that did not fail have one.
const RUNS: Told = ("runs", |q| q.sample.n.to_string());

/// One line of the table: a cell of each quantity. The line is 76 characters long, for terminals
/// of 80; the name of a model therefore has a line of its own.
fn line(f: &mut Formatter<'_>, head: &str, cell: impl Fn(Quantity) -> String) -> fmt::Result {
    write!(f, "  {head:4}")?;
    for quantity in Quantity::behaviour() {
        write!(f, " {:>13}", cell(quantity))?;
    }
    writeln!(f)
}

/// The short table that ends a study on the terminal.
impl Display for Summary {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        line(f, "", |quantity| quantity.label().into_owned())?;
        line(f, "", |quantity| quantity.unit().to_owned())?;
        for model in &self.models {
            writeln!(f, "\n{}, unrealizable draws: {}", model.name, percent(&model.unrealizable))?;
            let told = || Quantity::behaviour().into_iter().filter_map(|q| model.quantity(q));
            let runs = told().any(|q| q.sample.n < model.succeeded()).then_some(RUNS);
            for (told, value) in TOLD.into_iter().chain(runs) {
                line(f, told, |q| model.quantity(q).map_or_else(|| "–".to_owned(), value))?;
            }
        }
        for model in self.models.iter().filter(|m| m.failed > 0) {
            let (name, failed) = (&model.name, model.failed);
            writeln!(f, "\n{name}: {failed} of {} runs failed:", self.head.runs_per_model)?;
            for kind in most_frequent(&model.failures) {
                writeln!(f, "  {kind}")?;
            }
            let first = self.head.alerts.iter().find_map(|alert| alert.first_failure(name));
            first.map_or(Ok(()), |first| writeln!(f, "  {first}"))?;
        }
        Ok(())
    }
}
