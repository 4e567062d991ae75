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

/// The short table that ends a study on the terminal.
impl Display for Summary {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let names = self.models.iter().map(|m| m.name.chars().count());
        let width = names.max().unwrap_or(0).max("model".len());
        let shares: Vec<String> = self.models.iter().map(|m| percent(&m.unrealizable)).collect();
        let wide =
            shares.iter().map(|s| s.chars().count()).max().unwrap_or(0).max("unrealizable".len());
        write!(f, "{:width$}  {:>wide$}  {:4}", "model", "unrealizable", "")?;
        for quantity in Quantity::behaviour() {
            write!(f, " {:>13}", quantity.label())?;
        }
        write!(f, "\n{:width$}  {:>wide$}  {:4}", "", "draws", "")?;
        for quantity in Quantity::behaviour() {
            write!(f, " {:>13}", quantity.unit())?;
        }
        writeln!(f)?;
        for (model, share) in self.models.iter().zip(&shares) {
            let told = || Quantity::behaviour().into_iter().filter_map(|q| model.quantity(q));
            let runs = told().any(|q| q.sample.n < model.succeeded()).then_some(RUNS);
            for (line, (told, value)) in TOLD.into_iter().chain(runs).enumerate() {
                if line == 0 {
                    write!(f, "\n{:width$}  {share:>wide$}", model.name)?;
                } else {
                    write!(f, "{:width$}  {:wide$}", "", "")?;
                }
                write!(f, "  {told:4}")?;
                for quantity in Quantity::behaviour() {
                    let value = model.quantity(quantity).map_or_else(|| "–".to_owned(), value);
                    write!(f, " {value:>13}")?;
                }
                writeln!(f)?;
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
