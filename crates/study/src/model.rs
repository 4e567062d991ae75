//! Inertia models ready to draw, and the runs that their draws make.

use gyradius_campaign::{Column as RunColumn, Failure, Simulation, Table, TableError};
use gyradius_dispersion::{DispersionModel, EntryMoments, InertiaLaw, ModelKind, ModelParameters};
use gyradius_separation::Batch;
use std::{ops::Range, sync::Arc};

use crate::{
    body::Body,
    column::Column,
    drawn::{self, Draws},
    groups::{BodyLaw, Drawing, Groups},
    run::{Case, Run},
    scenario::{KeptShares, Law, ModelLaw, ModelSpec, Scenario, ScenarioError, UncertainBody},
    unmatched::UnmatchedLaw,
};

/// A model ready to draw: a law and its random streams for either body.
#[derive(Debug)]
pub(crate) struct Model {
    law: ModelLaw,
    /// Of the six entries of payload and stage, if the law is entrywise.
    given: Option<[[f64; 6]; 2]>,
    /// Of payload and stage.
    draws: Draws,
    /// The estimated share of draws that the region of payload and stage keeps, and its standard error.
    kept: KeptShares,
}

impl Model {
    /// Those of a scenario.
    pub(crate) fn all(scenario: &Scenario) -> Result<Vec<Self>, ScenarioError> {
        scenario.models().iter().map(|spec| Self::new(spec, scenario)).collect()
    }

    pub(crate) fn new(spec: &ModelSpec, scenario: &Scenario) -> Result<Self, ScenarioError> {
        let law = |which: Body, body: &UncertainBody| {
            let outside = |spec: &ModelSpec| scenario.outside_law(spec, which).cloned();
            let models = scenario.models();
            let modelled = Modelled { place: which as usize, body, models, outside: &outside };
            modelled.law(spec).map_err(|error| {
                let problem = format!("the {}: {error}", which.name());
                let field = scenario.place(spec) + spec.law.key();
                scenario.located(ScenarioError::field(field, problem))
            })
        };
        let (payload, payload_given) = law(Body::Payload, scenario.payload())?;
        let (stage, stage_given) = law(Body::Stage, scenario.stage())?;
        let dispersions = scenario.dispersions();
        let key = (scenario.seed(), spec.name.as_str());
        let body = |which: Body, law: Arc<dyn InertiaLaw>| {
            let (each, own) = (dispersions.inertia[which as usize], spec.law.own_axes().is_some());
            BodyLaw::new(key, which.name(), law, each, own)
        };
        let bodies = vec![body(Body::Payload, payload), body(Body::Stage, stage)];
        Ok(Self {
            law: spec.law.named(),
            given: payload_given.zip(stage_given).map(<[_; 2]>::from),
            draws: Draws::new(key, bodies, &dispersions.joint),
            kept: scenario.regions(spec),
        })
    }

    /// Which law it has.
    pub(crate) fn law(&self) -> ModelLaw {
        self.law
    }

    /// Whether no draw can be unrealizable.
    pub(crate) fn is_realizable_by_construction(&self) -> bool {
        self.draws.bodies.iter().all(|body| body.law.is_realizable_by_construction())
    }

    /// The estimated shares of draws for payload and stage that rejection keeps, where it rejects.
    pub(crate) fn acceptance(&self) -> Option<[f64; 2]> {
        let [payload, stage] = &self.draws.bodies[..] else { return None };
        Some([payload.law.acceptance()?, stage.law.acceptance()?])
    }

    /// The estimated share of draws that the region of each body keeps that is kept to one, and its standard error.
    pub(crate) fn kept(&self) -> impl Iterator<Item = (Body, (f64, f64))> {
        Body::BOTH.into_iter().zip(self.kept).filter_map(|(body, kept)| Some((body, kept?)))
    }

    /// The deviations of the six entries of payload and stage that the law was given, if it is
    /// entrywise.
    pub(crate) fn given_deviations(&self) -> Option<[[f64; 6]; 2]> {
        self.given
    }

    /// The groups of inputs that it draws independently of each other.
    pub(crate) fn groups(&self) -> &Groups {
        &self.draws.groups
    }

    /// Draws the bodies of one run.
    pub(crate) fn draw(&self, scenario: &Scenario, run: u64) -> Case {
        self.draw_of(scenario, &Drawing::Plain, run)
    }

    /// Draws the bodies of a run, of which some groups of inputs may be those of a second draw, or scores may be steered.
    pub(crate) fn draw_of(&self, scenario: &Scenario, drawing: &Drawing, run: u64) -> Case {
        let taken = self.draws.taken(drawing, scenario.size(), run);
        let (drawn, inertias) = self.draws.run(&scenario.dispersions().joint, taken);
        let drawn = drawn::with_starts(scenario, drawn);
        let bodies = Body::BOTH.map(|body| inertias[body as usize]);
        let [payload, stage] = bodies.map(|drawn| drawn.inertia);
        Case {
            bodies,
            separation: drawn::separation(scenario, &drawn, payload, stage),
            drawn,
            flight: scenario.fleet().map(|fleet| fleet.numbers(taken.mix.base())),
        }
    }
}

/// The separations of a scenario with the bodies that a model draws.
#[derive(Clone, Debug)]
pub(crate) struct Separations<'a> {
    scenario: &'a Scenario,
    model: &'a Model,
    columns: Vec<Column>,
    drawing: Drawing,
}

impl<'a> Separations<'a> {
    pub(crate) fn new(scenario: &'a Scenario, model: &'a Model) -> Self {
        let columns = Column::of(scenario);
        Self { scenario, model, columns, drawing: Drawing::Plain }
    }

    /// The same, whose runs draw this.
    pub(crate) fn drawing(self, drawing: Drawing) -> Self {
        Self { drawing, ..self }
    }

    /// The same, whose runs write only the columns of these names.
    pub(crate) fn writing(mut self, names: &[String]) -> Self {
        let drawn = self.scenario.dispersions().columns();
        self.columns
            .retain(|column| names.iter().any(|name| name == column.declaration(&drawn).name()));
        self
    }

    /// Whose bodies they have.
    pub(crate) fn model(&self) -> &Model {
        self.model
    }

    /// The scores of so many runs, if they are steered.
    pub(crate) fn scores(&self, runs: u64) -> Vec<Vec<f64>> {
        self.model.draws.steered(&self.drawing, self.scenario.size(), runs)
    }

    /// What is drawn for a run, by column, with every digit.
    #[cfg(test)]
    pub(crate) fn drawn(&self, run: u64) -> std::collections::BTreeMap<String, String> {
        let case = self.model.draw(self.scenario, run);
        let (run, names) = (case.drawn(), self.scenario.dispersions().columns());
        let columns = self.columns.iter().filter(|column| column.is_drawn());
        let cell = |column: &Column| {
            let name = column.declaration(&names).name().to_owned();
            (name, column.cell(&run).to_string())
        };
        columns.map(cell).collect()
    }

    /// Writes the row of a run that has ended.
    pub(crate) fn push(&self, run: &Run<'_>, rows: &mut Table) -> Result<(), TableError> {
        let cells = self.columns.iter().map(|column| column.cell(run));
        rows.push(run.failure().map(Failure::from), cells)
    }
}

impl Simulation for Separations<'_> {
    type Worker = Batch;

    fn columns(&self) -> Vec<RunColumn> {
        Column::declarations(&self.columns, self.scenario)
    }

    fn worker(&self) -> Batch {
        Batch::new(*self.scenario.settings())
    }

    /// Draws the bodies of several runs and separates them together, to the bits that each has alone.
    fn run(&self, runs: Range<u64>, batch: &mut Batch, rows: &mut Table) -> Result<(), TableError> {
        let scenario = self.scenario;
        let cases: Vec<Case> =
            runs.map(|run| self.model.draw_of(scenario, &self.drawing, run)).collect();
        let sound = |i: &usize| cases[*i].separation.is_ok();
        let places: Vec<usize> = (0..cases.len()).filter(sound).collect();
        let mut results: Vec<_> = cases.iter().map(|_| None).collect();
        let queue = cases.iter().filter_map(|case| case.separation.as_ref().ok());
        batch.run(queue, |i, result| results[places[i]] = Some(result));
        for (case, result) in cases.iter().zip(results) {
            self.push(&case.ended(scenario, result), rows)?;
        }
        Ok(())
    }
}

/// A law, and the deviations that it was given if it is entrywise.
type GivenLaw = (Arc<dyn InertiaLaw>, Option<[f64; 6]>);

/// A body in its place among those of a scenario, and the models that the scenario has.
pub(crate) struct Modelled<'a> {
    pub(crate) place: usize,
    pub(crate) body: &'a UncertainBody,
    pub(crate) models: &'a [ModelSpec],
    /// A program's own law under a model, if it gave one.
    pub(crate) outside: &'a dyn Fn(&ModelSpec) -> Option<Arc<dyn InertiaLaw>>,
}

impl Modelled<'_> {
    /// The law of the body under one of the models.
    pub(crate) fn law(&self, spec: &ModelSpec) -> Result<GivenLaw, Box<dyn std::error::Error>> {
        let model = match &spec.law {
            Law::Outside(said) => {
                let names = said.as_ref().map(|said| [&said.payload, &said.stage]);
                let name = names.and_then(|names| names.get(self.place).copied());
                let name = name.map_or_else(String::new, |name| format!(" {name:?}"));
                let law = (self.outside)(spec).ok_or_else(|| {
                    format!(
                        "its law{name} is a program's own, which no file holds: run or replay the study from that \
                         program, which gives the law by Scenario::with_model"
                    )
                })?;
                return Ok((law, None));
            }
            Law::Principal(axes) => self.body.law(*axes)?,
            Law::Given { kind, parameters } => {
                let given = parameters.get(self.place).copied().unwrap_or_default();
                DispersionModel::about(*kind, self.body.nominal(), &given)
                    .map_err(|error| error.problem)?
            }
            Law::Matched { kind, to } => self.matched(*kind, &self.moments_of(to)?)?,
        };
        let given = if let DispersionModel::Entrywise(law) = &model {
            Some(law.deviations())
        } else {
            None
        };
        Ok((Arc::new(model), given))
    }

    /// What the law of the body, which is called so, misses under a model that is to have the moments of another. Other kinds
    /// than log-Cholesky say in their documentation which of the moments they have, whatever these are.
    pub(crate) fn unmatched(&self, spec: &ModelSpec, name: &str) -> Option<UnmatchedLaw> {
        let Law::Matched { kind: kind @ ModelKind::LogCholesky, to } = &spec.law else {
            return None;
        };
        let asked = self.moments_of(to).ok()?;
        let found = self.matched(*kind, &asked).ok()?.entry_moments()?;
        UnmatchedLaw::of([&spec.name, to, name], &asked, &found)
    }

    /// The moments of the entries of the body under the model of a name.
    fn moments_of(&self, name: &str) -> Result<EntryMoments, Box<dyn std::error::Error>> {
        let model = self.models.iter().find(|m| m.name == name);
        let model = model.filter(|m| matches!(m.law, Law::Principal(_) | Law::Outside(_)));
        let model = model.ok_or_else(|| format!("matched_to {name:?}: no such model"))?;
        let (of_model, _) = self.law(model)?;
        let moments = match model.law.own_axes() {
            Some(axes) => self.body.expected_moments(axes),
            None => of_model.expected_moments(),
        };
        let of = of_model.name();
        let unknown =
            || format!("matched_to {name:?}: the moments of its law {of:?} are not known");
        Ok(moments.ok_or_else(unknown)?)
    }

    /// The model of a kind that has these moments of the entries.
    fn matched(
        &self,
        kind: ModelKind,
        moments: &EntryMoments,
    ) -> Result<DispersionModel, Box<dyn std::error::Error>> {
        if let ModelKind::Entries { correlated: false, .. } = kind {
            // The naive model knows the nominal body and how far its entries scatter, no more.
            let given = ModelParameters::of_deviations(moments.deviations());
            let nominal = self.body.nominal();
            return Ok(DispersionModel::about(kind, nominal, &given).map_err(|e| e.problem)?);
        }
        Ok(DispersionModel::matched(kind, moments)?.into_model())
    }
}

impl Scenario {
    /// Laws of payload and stage that have not the moments to which they were to be matched, since no law of their kind has.
    #[must_use]
    pub fn unmatched(&self) -> Vec<UnmatchedLaw> {
        let models = self.models();
        let of_model = |spec| {
            self.bodies().into_iter().filter_map(move |(which, body)| {
                let outside = |spec: &ModelSpec| self.outside_law(spec, which).cloned();
                let body = Modelled { place: which as usize, body, models, outside: &outside };
                body.unmatched(spec, which.name())
            })
        };
        models.iter().flat_map(of_model).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Target;
    use gyradius_inertia::InertiaMatrix;
    use std::fmt::Write;
    use toml::{Table as Toml, Value};

    /// Every model of a scenario given from outside in its place, one after the other: it and those matched to it draw
    /// the same bodies to the bit, and without the law it is refused.
    #[test]
    fn laws_from_outside_draw_what_the_scenarios_own_do() {
        let mut text = Scenario::peck_2003().unwrap().to_toml();
        for kind in ModelKind::ALL.into_iter().filter(|kind| *kind != ModelKind::Principal) {
            let matched = "matched_to = \"proposed\"";
            write!(text, "\n[[models]]\nname = \"{kind}\"\nlaw = \"{kind}\"\n{matched}\n").unwrap();
        }
        let mut table: Toml = toml::from_str(&text).unwrap();
        let payload = table["payload"]["dispersion"].as_table_mut().unwrap();
        payload.insert("mass_percent".to_owned(), 1.0.into());
        payload.insert("inertia_follows_mass".to_owned(), true.into());
        let scenario =
            |table: &Toml| Scenario::from_toml(&toml::to_string(table).unwrap()).unwrap();
        let built_in = scenario(&table);
        let own = Model::all(&built_in).unwrap();
        let draws = |scenario: &Scenario, models: &[Model]| -> Vec<String> {
            let runs = models.iter().flat_map(|model| (0..20).map(move |run| (model, run)));
            runs.map(|(model, run)| format!("{:?}", model.draw(scenario, run))).collect()
        };
        let expected = draws(&built_in, &own);
        for (i, (model, name)) in own.iter().zip(built_in.model_names()).enumerate() {
            let mut table = table.clone();
            let only = [("name", name), ("law", "outside")];
            let only = only.map(|(key, value)| (key.to_owned(), Value::from(value)));
            table["models"][i] = Value::Table(only.into_iter().collect());
            let bare = scenario(&table);
            let refused = Model::all(&bare).unwrap_err().to_string();
            assert!(refused.contains("is a program's own"), "{refused}");

            let (payload, stage) =
                (Arc::clone(&model.draws.bodies[0].law), Arc::clone(&model.draws.bodies[1].law));
            let given = bare.with_model(name, payload, stage).unwrap();
            let models = Model::all(&given).unwrap();
            assert!(draws(&given, &models) == expected, "{name}");
            assert_eq!(models[i].law(), ModelLaw::Outside);
            let sound = model.is_realizable_by_construction();
            assert_eq!(models[i].is_realizable_by_construction(), sound);
            // What it says of itself reads back, and is refused without the law as before.
            let read = Scenario::from_toml(&given.to_toml()).unwrap();
            assert_eq!(read.fingerprint(), given.fingerprint());
            assert_ne!(read.fingerprint(), built_in.fingerprint());
            let refused = Model::all(&read).unwrap_err().to_string();
            let name = format!("its law {:?} is a program's own", model.draws.bodies[0].law.name());
            assert!(refused.contains(&name) && refused.starts_with("models["), "{refused}");
        }
    }

    /// What a group exchanges is that of the second draw, and all else that of the first, for every group of a scenario in
    /// which everything is dispersed and some of it correlated, under models that draw axes and models that do not.
    #[test]
    fn groups_exchange_what_they_hold_and_nothing_else() {
        let text = include_str!("../tests/data/dispersed.toml");
        let naive = "\n[[models]]\nname = \"naive\"\nlaw = \"entrywise\"\nmatched_to = \"MODEL\"\n";
        let own = Scenario::from_toml(text).unwrap();
        let naive = naive.replace("MODEL", own.model_names().next().unwrap());
        let scenario = Scenario::from_toml(&format!("{text}{naive}")).unwrap();
        let all = scenario.dispersions().all();
        let near = |a: &InertiaMatrix, b: &InertiaMatrix| {
            (a.matrix() - b.matrix()).norm() < 1e-9 * b.matrix().norm()
        };
        for model in Model::all(&scenario).unwrap() {
            let groups = model.groups();
            let names = groups.names();
            assert!(
                names.iter().enumerate().all(|(i, name)| !names[..i].contains(name)),
                "{names:?}"
            );
            let splits = model.draws.bodies[0].law.has_independent_axes();
            assert_eq!(splits, names.contains(&"payload axes".to_owned()), "{names:?}");
            for base in 0..20 {
                let first = groups.designs().runs(base);
                let draw =
                    |design: u64| model.draw_of(&scenario, &Drawing::Exchanging, first + design);
                let (a, b) = (draw(0), draw(1));
                assert_eq!(format!("{a:?}"), format!("{:?}", model.draw(&scenario, base)));
                for (place, name) in names.iter().enumerate() {
                    let c = draw(place as u64 + 2);
                    for (i, d) in all.iter().enumerate() {
                        let mine = groups.stream_of(
                            i,
                            groups.mix(&Drawing::Exchanging, first + place as u64 + 2, None),
                            0,
                        ) != 0;
                        // When a load starts also says whether it is late.
                        let late = all.iter().any(|other| match other.target {
                            Target::Late(load, start) => d.target == Target::Load(load, start, 0),
                            _ => false,
                        });
                        let expected = if mine { b.drawn[i] } else { a.drawn[i] };
                        assert!(
                            late || c.drawn[i].to_bits() == expected.to_bits(),
                            "{name}: {}",
                            d.column
                        );
                    }
                    let moments = |case: &Case| case.bodies[0].inertia.principal_axes().moments();
                    let follows = scenario.payload().follows().0 != 0.0;
                    if follows {
                        continue;
                    }
                    match name.as_str() {
                        "payload roots" => {
                            assert_eq!(c.bodies[0].axes, a.bodies[0].axes);
                            let (found, expected) = (moments(&c), moments(&b));
                            let apart = (0..3).map(|i| (found[i] - expected[i]).abs()).sum::<f64>();
                            assert!(apart < 1e-8 * expected[0].abs(), "{found:?} {expected:?}");
                        }
                        "payload axes" => {
                            assert_eq!(c.bodies[0].axes, b.bodies[0].axes);
                            let (found, expected) = (moments(&c), moments(&a));
                            let apart = (0..3).map(|i| (found[i] - expected[i]).abs()).sum::<f64>();
                            assert!(apart < 1e-8 * expected[0].abs(), "{found:?} {expected:?}");
                        }
                        "payload inertia" => {
                            assert!(near(&c.bodies[0].inertia, &b.bodies[0].inertia))
                        }
                        _ => assert!(near(&c.bodies[0].inertia, &a.bodies[0].inertia), "{name}"),
                    }
                }
            }
        }
    }

    /// What is correlated is exchanged together, under one name.
    #[test]
    fn correlated_numbers_are_one_group() {
        let text = Scenario::peck_2003().unwrap().to_toml();
        let springs = text.matches("[[springs]]").count();
        let with = |correlation: &str| {
            let text = text.replace(
                "[[springs]]",
                "[[springs]]\ndispersion = { stiffness_percent = 1.0, stage_point_m = 0.01, failure_probability = 0.1 }",
            );
            let scenario = Scenario::from_toml(&format!("{text}\n{correlation}")).unwrap();
            let models = Model::all(&scenario).unwrap();
            models[0].groups().names().to_vec()
        };
        let alone = with("");
        // Roots and axes of two bodies; of each spring its stiffness, the point as a whole, and its failure.
        assert_eq!(alone.len(), 4 + 3 * springs, "{alone:?}");
        assert!(alone.contains(&"spring 3 stiffness".to_owned()), "{alone:?}");
        let tied = with(
            "[[correlations]]\nbetween = [\"spring_1_stiffness_n_per_m\", \"spring_2_stiffness_n_per_m\", \"spring_4_stage_point_2_m\"]\n\
             coefficient = 0.3",
        );
        assert_eq!(tied.len(), alone.len() - 2, "{tied:?}");
        let name = "spring 1 stiffness, spring 2 stiffness, spring 4 stage point";
        assert!(tied.contains(&name.to_owned()), "{tied:?}");
    }
}
