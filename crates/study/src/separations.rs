//! Separations as a study: how their runs are simulated, and what they amount to.

use gyradius_campaign::{CampaignError, Column, Forecast, Kind, Runs};
use gyradius_report::Document;
use rayon::ThreadPool;
use std::sync::{Arc, atomic::AtomicBool};

use crate::{
    Scenario, ScenarioError, StudyError, Summary,
    body::{Body, Entry},
    claims,
    column::Column as Declared,
    compare::Section,
    figures_of_study,
    groups::{Drawing, Groups},
    model::{Model, Separations},
    quantity::Quantity,
    report,
    rounding::Rounding,
    seen::{Looking, Seen},
    subject::{Grouped, Subject},
    summary::ModelSummary,
    unusual::DrawnInput,
};

impl Grouped for Separations<'_> {
    fn groups(&self) -> &Groups {
        self.model().groups()
    }

    fn steered(&self, runs: u64) -> Vec<Vec<f64>> {
        self.scores(runs)
    }

    fn wanted(self, names: &[String]) -> Self {
        self.writing(names)
    }
}

impl Subject for Scenario {
    /// Some tenths of a second of separations.
    const BLOCK_RUNS: u64 = 1 << 14;
    const MAIN_OUTCOMES: &str = "each outcome under “What the payload does”";
    const IMMATERIAL: &[&str] =
        &["runs", "vehicles", "rows", "columns", "requirements", "until", "drivers"];

    type Prepared = Vec<Model>;
    type Simulation<'a> = Separations<'a>;
    type Look<'a> = Looking<'a>;
    type Summary = Summary;

    fn resolved(text: &str) -> Result<Self, ScenarioError> {
        Self::from_toml(text)
    }

    fn prepare(&self, _: Option<&Arc<AtomicBool>>) -> Result<Vec<Model>, ScenarioError> {
        Model::all(self)
    }

    fn begin(&self, _: &Vec<Model>) -> Result<(), ScenarioError> {
        Ok(())
    }

    fn forecast(
        &self,
        simulations: &[(&str, Separations<'_>)],
        left: u64,
        threads: &ThreadPool,
    ) -> Result<Forecast, StudyError> {
        let timed = simulations.iter().map(|(_, simulation)| simulation);
        let each = left.div_ceil(simulations.len() as u64);
        let forecast = Forecast::of(timed, each, threads.current_num_threads());
        Ok(forecast.map_err(CampaignError::from)?)
    }

    fn drawing<'a>(
        &'a self,
        models: &'a Vec<Model>,
        place: usize,
        drawing: Drawing,
    ) -> Result<Separations<'a>, ScenarioError> {
        Ok(Separations::new(self, &models[place]).drawing(drawing))
    }

    fn run_columns(&self) -> Vec<Column> {
        Declared::declarations(&Declared::of(self), self)
    }

    fn outcomes(&self) -> Vec<String> {
        let outcomes: Vec<Declared> =
            Declared::of(self).into_iter().filter(|column| column.is_outcome()).collect();
        let outcomes = Declared::declarations(&outcomes, self).into_iter();
        outcomes.map(|column| column.name().to_owned()).collect()
    }

    fn drawn_columns(&self) -> Vec<String> {
        let drawn: Vec<Declared> =
            Declared::of(self).into_iter().filter(|column| column.is_drawn()).collect();
        let drawn = Declared::declarations(&drawn, self).into_iter();
        let numbers = drawn.filter(|column| column.kind() == Kind::Number);
        numbers.map(|column| column.name().to_owned()).collect()
    }

    fn inertias(&self) -> Vec<[String; 6]> {
        let column = |body, entry| Quantity::entry(body, entry).column().into_owned();
        Body::BOTH.map(|body| Entry::ALL.map(|entry| column(body, entry))).into()
    }

    fn main_outcomes(&self) -> Vec<String> {
        Quantity::behaviour().iter().map(|quantity| quantity.column().into_owned()).collect()
    }

    fn look(&self, model: &str, columns: &[Column]) -> Looking<'_> {
        Looking::new(self, model, columns)
    }

    fn judge(
        &self,
        models: &Vec<Model>,
        looks: Vec<Looking<'_>>,
        runs: &[Runs],
    ) -> Result<Summary, StudyError> {
        let seen = looks.into_iter().zip(runs).map(|(look, runs)| look.finish(runs));
        let seen: Vec<Seen> = seen.collect::<Result<_, _>>()?;
        let columns = runs.first().map_or(&[][..], Runs::columns);
        let go_on = || Ok(runs.iter().try_for_each(Runs::go_on)?);
        let compared = Section::new(self, &go_on)?;
        let mut summary = Summary::new(self, models, &seen, columns, compared)?;
        summary.claims = claims::judge(self, &summary, &seen);
        summary.figures = figures_of_study::of_study(self, &summary, &seen);
        Ok(summary)
    }

    fn drawn_inputs(&self, summary: &Summary, model: &str) -> Vec<DrawnInput> {
        summary.model(model).map_or_else(Vec::new, ModelSummary::drawn_inputs)
    }

    fn rounding(&self) -> Rounding {
        Rounding::of_separations(self.separation(), self.settings())
    }

    fn report_files(&self) -> Vec<String> {
        report::files(self).collect()
    }

    fn report(&self, summary: &Summary) -> Document {
        report::report(self, summary)
    }
}

#[cfg(test)]
mod tests {
    use gyradius_campaign::run;

    use super::*;

    /// A column of numbers or flags is drawn, or comes of a run; the flag that follows from what is drawn is both.
    #[test]
    fn numbers_are_drawn_or_outcomes() {
        for text in [
            include_str!("../tests/data/dispersed.toml").to_owned(),
            Scenario::peck_2003().unwrap().to_toml(),
        ] {
            let scenario = Scenario::from_toml(&text).unwrap();
            let (outcomes, drawn) = (scenario.outcomes(), scenario.drawn_columns());
            for column in scenario.run_columns() {
                let is = |names: &[String]| names.iter().any(|name| name == column.name());
                let expected = match column.kind() {
                    Kind::Number => !is(&drawn),
                    Kind::Flag => true,
                    // Vehicle and flight are no outcome, and neither is a text.
                    Kind::Integer | Kind::Text => false,
                };
                assert_eq!(is(&outcomes), expected, "{}", column.name());
            }
            assert!(outcomes.iter().any(|name| name == "realizable"));
            assert!(outcomes.iter().any(|name| name == "spring_1_release_s"));
        }
    }

    /// Of every column alone, of some together and of none: what all columns have, and the same failures.
    #[test]
    fn wanted_columns_are_those_of_a_run_that_writes_all() {
        let text = include_str!("../tests/data/dispersed.toml");
        let scenario = Scenario::from_toml(text).unwrap();
        let models = Model::all(&scenario).unwrap();
        let threads = gyradius_campaign::threads(Some(2)).unwrap();
        let of =
            |simulation: Separations<'_>| run(&simulation, "m", 70, &threads, &|_| {}).unwrap();
        for place in 0..models.len() {
            let drawing = || scenario.drawing(&models, place, Drawing::Plain).unwrap();
            let all = of(drawing());
            let names: Vec<String> =
                scenario.run_columns().iter().map(|column| column.name().to_owned()).collect();
            let ones = names.iter().map(std::slice::from_ref);
            for wanted in ones.chain(names.chunks(7)).chain([&[][..]]) {
                let some = of(drawing().wanted(wanted));
                let written: Vec<&str> = some
                    .columns()
                    .iter()
                    .map(Column::name)
                    .filter(|name| names.iter().any(|n| n == name))
                    .collect();
                assert_eq!(written, wanted);
                assert!(some.failures().eq(all.failures()));
                for (row, whole) in some.rows().zip(all.rows()) {
                    assert_eq!(row.run(), whole.run());
                    assert!(
                        wanted.iter().all(|name| row.cell(name) == whole.cell(name)),
                        "{wanted:?}"
                    );
                }
            }
        }
    }
}
