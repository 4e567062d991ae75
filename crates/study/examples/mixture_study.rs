//! An inertia model of one's own in a study: a payload that is built in two variants, and nobody knows which will fly.
//! Run tables, summary and report, and one run replayed and held against its row.
//!
//! ```sh
//! cargo run -p gyradius-study --example mixture_study
//! ```

use gyradius_dispersion::{EntryMoments, EntryMomentsError, InertiaLaw, ModelDraw, Wishart};
use gyradius_inertia::{Inertia, InertiaMatrix};
use gyradius_study::{Options, Replay, Results, Scenario, ScenarioError, Study};
use nalgebra::{SMatrix, SVector};
use rand::{Rng, RngExt};
use std::{borrow::Cow, error::Error, path::Path, sync::Arc};

/// What the scenario says of the model, and a naive model with the standard deviations of its entries.
const MODELS: &str = r#"
[[models]]
name = "two-variants"
law = "outside"

[[models]]
name = "entries-of-variants"
law = "entrywise"
matched_to = "two-variants"

[[comparisons]]
title = "Two variants"
physical = "two-variants"
naive = "entries-of-variants"
"#;

/// One variant or the other, each with a law of its own.
#[derive(Debug)]
struct Mixture {
    /// The probability of the first.
    share: f64,
    variants: [Box<dyn InertiaLaw>; 2],
}

impl Mixture {
    /// Of two laws; none if the share of the first is no probability.
    fn new(share: f64, variants: [Box<dyn InertiaLaw>; 2]) -> Option<Self> {
        (0.0..=1.0).contains(&share).then_some(Self { share, variants })
    }

    /// E I = Σ w_v m_v and Cov I = Σ w_v (C_v + m_v m_vᵀ) − E I E Iᵀ, with the last two put together as the
    /// difference of the means, so that no digits are lost.
    fn moments(
        &self,
        a: &EntryMoments,
        b: &EntryMoments,
    ) -> Result<EntryMoments, EntryMomentsError> {
        let (p, q) = (self.share, 1.0 - self.share);
        let [m, n] = [a, b].map(|moments| SVector::<f64, 6>::from(moments.mean()));
        let apart: SMatrix<f64, 6, 6> = (m - n) * (m - n).transpose();
        let covariance = a.covariance() * p + b.covariance() * q + apart * (p * q);
        EntryMoments::new((m * p + n * q).into(), covariance)
    }
}

impl InertiaLaw for Mixture {
    fn name(&self) -> Cow<'_, str> {
        "mixture".into()
    }

    fn draw(&self, rng: &mut dyn Rng) -> ModelDraw {
        let first = rng.random::<f64>() < self.share;
        self.variants[usize::from(!first)].draw(rng)
    }

    fn is_realizable_by_construction(&self) -> bool {
        self.variants.iter().all(|law| law.is_realizable_by_construction())
    }

    fn expected_moments(&self) -> Option<EntryMoments> {
        let [a, b] = &self.variants;
        self.moments(&a.expected_moments()?, &b.expected_moments()?).ok()
    }
}

fn wishart(
    moments: [f64; 3],
    products: [f64; 3],
    delta: f64,
) -> Result<Box<dyn InertiaLaw>, Box<dyn Error>> {
    let mean = InertiaMatrix::from_entries(moments, products)?;
    Ok(Box::new(Wishart::new(Inertia::try_from(mean)?, delta)?))
}

/// A satellite with full tanks with the given probability, or one with half of the propellant.
fn satellite(full_tanks: f64) -> Result<Mixture, Box<dyn Error>> {
    let full = wishart([5000.0, 4000.0, 3000.0], [20.0, 2.0, -50.0], 0.05)?;
    let half = wishart([4600.0, 3500.0, 2900.0], [10.0, 2.0, -40.0], 0.05)?;
    Mixture::new(full_tanks, [full, half]).ok_or_else(|| "no probability".into())
}

/// Gives the laws to a scenario: one that says `law = "outside"`, from which a study is made, or that study's.
fn with_variants(scenario: Scenario) -> Result<Scenario, Box<dyn Error>> {
    let stage = wishart([6700.0, 6700.0, 2000.0], [0.0, 20.0, -20.0], 0.02)?;
    Ok(scenario.with_model("two-variants", Arc::new(satellite(0.7)?), stage.into())?)
}

fn scenario(runs: u64) -> Result<Scenario, ScenarioError> {
    let text = Scenario::peck_2003()?.to_toml() + MODELS;
    Scenario::from_toml(&text)?.with_runs(runs)
}

/// A run of a study again, held against its row.
fn replay(folder: &Path, model: &str, run: u64) -> Result<Replay, Box<dyn Error>> {
    let scenario = with_variants(Results::read(folder)?.scenario().clone())?;
    Ok(Replay::new(&scenario, Some(model), run, 0.0)?.held_against(folder)?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let scenario = with_variants(scenario(500)?)?;
    let options = Options { out: Some("target/study/mixture".into()), ..Options::default() };
    let study = Study::run(&scenario, &options, &|_done| {})?;
    println!("{}{}\n", study.summary(), study.folder().display());
    println!("{}", replay(study.folder(), "two-variants", 7)?);
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

    use super::*;
    use gyradius_dispersion::{DispersionModel, EntrywiseGaussian, ModelKind, RealizableOnly};
    use gyradius_study::{ReplayError, ResultsError, StudyError};
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use std::fs;
    use tempfile::TempDir;

    fn study(scenario: &Scenario, threads: usize) -> (TempDir, Study) {
        let place = TempDir::new().unwrap();
        let out = Some(place.path().join("study"));
        let options = Options { out, threads: Some(threads), ..Options::default() };
        let study = Study::run(scenario, &options, &|_| {}).unwrap();
        (place, study)
    }

    /// The whole way: same bytes on one thread and on three; rows replayed; the report made again from the folder
    /// alone; and what the folder cannot do without the law.
    #[test]
    fn a_mixture_goes_through_a_study() {
        let given = with_variants(scenario(60).unwrap()).unwrap();
        let [(_place, one), (_other, three)] = [1, 3].map(|threads| study(&given, threads));
        let files = [
            "scenario.toml",
            "summary.json",
            "report.html",
            "report.md",
            "runs/two-variants/000000000-000000059.parquet",
            "runs/entries-of-variants/000000000-000000059.parquet",
        ];
        for file in files {
            let [a, b] = [&one, &three].map(|study| fs::read(study.folder().join(file)).unwrap());
            assert!(a == b, "{file}");
        }
        let folder = one.folder();
        let summary = fs::read_to_string(folder.join("summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
        let models = summary["models"].as_array().unwrap();
        let model = models.iter().find(|m| m["name"] == "two-variants").unwrap();
        assert_eq!(model["law"], "outside");
        assert_eq!(model["realizable_by_construction"], true);
        assert_eq!((&model["failed"], &model["unrealizable"]["count"]), (&0.into(), &0.into()));

        let report = fs::read_to_string(folder.join("report.html")).unwrap();
        assert!(report.contains("Two variants"));
        let results = Results::read(folder).unwrap();
        assert_eq!(results.report(), report);
        results.write_report(None, false).unwrap();
        assert_eq!(fs::read_to_string(folder.join("report.html")).unwrap(), report);

        for table in one.tables().unwrap().iter().filter(|t| t.model().contains("variants")) {
            for row in table.rows().step_by(11) {
                let again = replay(folder, table.model(), row.run()).unwrap();
                assert!(again.row().cells().eq(row.cells()), "{} {}", table.model(), row.run());
            }
        }

        // Without the law: models of the scenario's own are replayed, the others and the study are refused.
        assert!(Replay::open(folder, Some("naive"), 5, 0.0).is_ok());
        for (model, law) in [("two-variants", "mixture"), ("entries-of-variants", "mixture")] {
            let refused = Replay::open(folder, Some(model), 5, 0.0).unwrap_err();
            assert!(matches!(refused, ReplayError::Scenario(_)), "{refused}");
            let message = format!("its law \"{law}\" is a program's own");
            assert!(refused.to_string().contains(&message), "{refused}");
        }
        let read = Scenario::read(&folder.join("scenario.toml")).unwrap();
        let out = folder.with_file_name("again");
        let options = Options { out: Some(out.clone()), ..Options::default() };
        let refused = Study::run(&read, &options, &|_| {}).unwrap_err();
        assert!(matches!(refused, StudyError::Scenario(_)) && !out.exists(), "{refused}");

        // Another law is told from this one, and another study from this one.
        let mut others = 0;
        for share in [0.0, 0.6, 0.69, 0.71, 1.0] {
            let [payload, stage] = [share, 0.5].map(|share| Arc::new(satellite(share).unwrap()));
            let refused = read.clone().with_model("two-variants", payload, stage).unwrap_err();
            others += usize::from(refused.to_string().contains(".outside: the laws were"));
        }
        assert_eq!(others, 5);
        fs::remove_file(folder.join("summary.json")).unwrap();
        assert!(matches!(Results::read(folder), Err(ResultsError::Study { .. })));
    }

    /// Names that scenario files refuse, or that another model has, and what does not go with such a law in a file.
    #[test]
    fn what_is_refused() {
        let law = || Arc::new(satellite(0.7).unwrap());
        let peck = Scenario::peck_2003().unwrap();
        let taken: Vec<String> = peck.model_names().map(str::to_owned).collect();
        let bad = ["", "a b", "é", "../up", "nul", "x/y", "."].map(str::to_owned);
        let cased = taken.iter().map(|name| name.to_uppercase());
        for name in bad.into_iter().chain(["a".repeat(65)]).chain(taken.clone()).chain(cased) {
            let refused = peck.clone().with_model(&name, law(), law()).unwrap_err().to_string();
            assert!(refused.starts_with(&format!("models[{}].name", taken.len() + 1)), "{refused}");
        }
        let once = peck.clone().with_model("mine", law(), law()).unwrap();
        assert!(once.clone().with_model("mine", law(), law()).is_err());
        assert!(once.clone().with_model("mine-too", law(), law()).is_ok());
        let mut full = peck.clone();
        let room = 100 - taken.len();
        for i in 0..room {
            full = full.with_model(&format!("m{i}"), law(), law()).unwrap();
        }
        let refused = full.with_model("one-more", law(), law()).unwrap_err().to_string();
        assert!(refused.starts_with("models: 101 of them"), "{refused}");

        // A law that can be impossible is no physical model; the file cannot know it before.
        let mean = InertiaMatrix::from_entries([5000.0, 4000.0, 3000.0], [0.0; 3]).unwrap();
        let entries = Arc::new(EntrywiseGaussian::new(mean, [1.0; 6]).unwrap());
        let file = scenario(10).unwrap();
        let refused = file.with_model("two-variants", law(), entries).unwrap_err().to_string();
        assert!(refused.starts_with("comparisons[") && refused.contains(".physical"), "{refused}");

        let text = once.to_toml();
        for more in ["axes = \"whole-sphere\"", "matched_to = \"proposed\"", "payload_delta = 0.1"]
        {
            let own = "law = \"outside\"";
            let refused = Scenario::from_toml(&text.replace(own, &format!("{own}\n{more}")));
            let refused = refused.unwrap_err().to_string();
            let key = more.split(' ').next().unwrap();
            assert!(refused.contains(&format!(".{key}: law \"outside\"")), "{refused}");
        }
        let text = text.replace("law = \"outside\"", "law = \"wishart\"");
        let refused = Scenario::from_toml(&text).unwrap_err().to_string();
        assert!(refused.contains(".outside: law \"wishart\" does not take it"), "{refused}");
        let text = text.replace("law = \"wishart\"", "law = \"mixture\"");
        let refused = Scenario::from_toml(&text).unwrap_err().to_string();
        assert!(refused.contains("\"mixture\": it must be one of principal"), "{refused}");
    }

    /// Draws through the trait alone: moments to |z| < 4.5, every one of them a body, columns the same as one by one,
    /// and the two variants apart.
    #[test]
    fn a_mixture_has_its_moments() {
        const N: usize = 60_000;
        let law: Box<dyn InertiaLaw> = Box::new(satellite(0.7).unwrap());
        assert!(law.is_realizable_by_construction() && law.acceptance().is_none());
        let moments = law.expected_moments().unwrap();
        let mut columns: [Vec<f64>; 6] = std::array::from_fn(|_| vec![0.0; N]);
        let rng = || ChaCha8Rng::seed_from_u64(9);
        law.draw_columns(&mut rng(), columns.each_mut().map(Vec::as_mut_slice)).unwrap();
        let mut one = rng();
        for row in 0..N {
            let inertia = law.draw(&mut one).inertia;
            assert!(inertia.is_realizable());
            assert_eq!(inertia.entries(), columns.each_ref().map(|c| c[row]));
        }
        for e in 0..6 {
            for f in 0..=e {
                let gap = |i: usize| {
                    (columns[e][i] - moments.mean()[e]) * (columns[f][i] - moments.mean()[f])
                };
                let average = (0..N).map(gap).sum::<f64>() / N as f64;
                let spread = (0..N).map(|i| (gap(i) - average).powi(2)).sum::<f64>() / N as f64;
                let z = (average - moments.covariance()[(e, f)]) / (spread / N as f64).sqrt();
                assert!(z.abs() < 4.5, "covariance {e}{f}: {z}");
            }
            let mean = columns[e].iter().sum::<f64>() / N as f64;
            let z = (mean - moments.mean()[e]) / (moments.covariance()[(e, e)] / N as f64).sqrt();
            assert!(z.abs() < 4.5, "mean {e}: {z}");
        }
    }

    /// It goes where laws go: models are matched to its moments, and a mixture of any two laws promises no more than
    /// both do.
    #[test]
    fn a_mixture_goes_where_laws_go() {
        let moments = satellite(0.7).unwrap().expected_moments().unwrap();
        for kind in [ModelKind::CORRELATED_ENTRIES, ModelKind::Wishart, ModelKind::LogCholesky] {
            let model = DispersionModel::matched(kind, &moments).unwrap().into_model();
            let found = model.law().expected_moments().unwrap();
            for (a, b) in found.mean().iter().zip(moments.mean()) {
                assert!((a - b).abs() < 1e-6 * 5e3, "{kind}: {a} {b}");
            }
        }
        let mean =
            InertiaMatrix::from_entries([5000.0, 4000.0, 3000.0], [20.0, 2.0, -50.0]).unwrap();
        let entries = || EntrywiseGaussian::new(mean, [100.0; 6]).unwrap();
        let laws = || -> [Box<dyn InertiaLaw>; 3] {
            let body = Inertia::try_from(mean).unwrap();
            [
                Box::new(entries()),
                Box::new(RealizableOnly::new(entries()).unwrap()),
                Box::new(Wishart::new(body, 0.1).unwrap()),
            ]
        };
        for first in 0..3 {
            for second in 0..3 {
                let [a, b] = [first, second].map(|i| laws().into_iter().nth(i).unwrap());
                let sound = a.is_realizable_by_construction() && b.is_realizable_by_construction();
                let known = a.expected_moments().is_some() && b.expected_moments().is_some();
                let both: Box<dyn InertiaLaw> = Box::new(Mixture::new(0.5, [a, b]).unwrap());
                assert_eq!(both.is_realizable_by_construction(), sound);
                assert_eq!(both.expected_moments().is_some(), known);
            }
        }
        assert!(Mixture::new(1.5, [Box::new(entries()), Box::new(entries())]).is_none());
    }
}
