//! Tests of the comparison of models.

use super::*;
use gyradius_campaign::CampaignError;
use nalgebra::Matrix3;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use serde_json::Value;

fn compare(options: &CompareOptions) -> ModelComparison {
    ModelComparison::run(options, &|_| {}).unwrap()
}

fn share(comparison: &ModelComparison, body: usize, level: usize, kind: ModelKind) -> (u64, u64) {
    let level = &comparison.bodies[body].levels[level];
    let share = level.cell(kind).unwrap().results.as_ref().unwrap().unrealizable;
    (share.count, share.of)
}

#[test]
fn no_draw_is_impossible_where_none_can_be() {
    let options = CompareOptions { draws: 300, separations: 5, ..CompareOptions::default() };
    let comparison = compare(&options);
    let mut built = 0;
    for body in &comparison.bodies {
        for cell in body.levels.iter().flat_map(|level| &level.models) {
            let Some(results) = &cell.results else { continue };
            if cell.realizable_by_construction {
                built += 1;
                assert_eq!(results.unrealizable.count, 0, "{} {}", body.name, cell.model);
                assert_eq!(results.failed_separations, 0, "{} {}", body.name, cell.model);
            }
        }
        // The reference law is there at every level, and is what it was matched to.
        for level in &body.levels {
            let fit = level.cell(ModelKind::Principal).unwrap().results.as_ref().unwrap().fit;
            assert!(fit.mean_off < 1e-12 && fit.covariance_off < 1e-12, "{fit:?}");
        }
    }
    assert!(built > 100, "{built}");
}

/// Six independent Gaussians of the same deviation by a path of its own: plain draws, and the signs of
/// the eigenvalues of Σ.
fn naive_share(moments: [f64; 3], deviation: f64) -> f64 {
    const N: u32 = 100_000;
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut z = || -> f64 { deviation * Distribution::<f64>::sample(&StandardNormal, &mut rng) };
    let mut bad = 0;
    for _ in 0..N {
        let [a, b, c] = moments.map(|m| m + z());
        let (d, e, f) = (z(), z(), z());
        let inertia = Matrix3::new(a, d, e, d, b, f, e, f, c);
        let sigma = Matrix3::from_diagonal_element(0.5 * inertia.trace()) - inertia;
        bad += u32::from(sigma.symmetric_eigenvalues().min() < 0.0);
    }
    f64::from(bad) / f64::from(N)
}

/// 10 % of the largest moment: three draws in four of a slender stage are impossible, one in a hundred
/// of a compact bus; at 1 % none of the bus.
#[test]
fn the_naive_model_is_as_bad_as_it_is() {
    let comparison = compare(&CompareOptions {
        bodies: vec!["slender-stage".into(), "bus".into()],
        reference: Reference::Entries,
        levels_percent: vec![1.0, 10.0],
        models: vec![ModelKind::ENTRYWISE, ModelKind::CORRELATED_ENTRIES],
        draws: 20_000,
        separations: 0,
        ..CompareOptions::default()
    });
    for (body, moments, about) in
        [(0, [2000.0, 15_000.0, 15_500.0], 0.76), (1, [900.0, 800.0, 600.0], 0.014)]
    {
        let expected = naive_share(moments, 0.1 * moments.into_iter().fold(0.0, f64::max));
        assert!((expected / about - 1.0).abs() < 0.1, "{expected}");
        // Without correlation the two are one law.
        for kind in [ModelKind::ENTRYWISE, ModelKind::CORRELATED_ENTRIES] {
            let (count, of) = share(&comparison, body, 1, kind);
            let error = (expected * (1.0 - expected) * (1.0 / of as f64 + 1e-5)).sqrt();
            let z = (count as f64 / of as f64 - expected) / error;
            assert!(z.abs() < 4.0, "{kind}: {z}");
        }
    }
    assert_eq!(share(&comparison, 1, 0, ModelKind::ENTRYWISE), (0, 20_000));
    // No law of bodies has the moments of the slender stage, and the comparison says so.
    let level = &comparison.bodies[0].levels[1];
    assert!(level.reference.as_ref().unwrap().impossible.is_some());
    assert!(comparison.to_string().contains("no law of bodies has these moments"));
}

/// What cannot be made stays in sight, with its reason.
#[test]
fn models_that_do_not_exist_are_told() {
    let comparison = compare(&CompareOptions {
        bodies: vec!["panel".into()],
        reference: Reference::Entries,
        levels_percent: vec![50.0],
        draws: 50,
        separations: 5,
        ..CompareOptions::default()
    });
    let level = &comparison.bodies[0].levels[0];
    assert_eq!(level.models.len(), ModelKind::ALL.len());
    let wishart = level.cell(ModelKind::Wishart).unwrap();
    let problem = wishart.problem.as_deref().unwrap();
    assert!(wishart.results.is_none() && problem.contains('δ'), "{problem}");
    let text = comparison.to_string();
    assert!(text.contains("no wishart at 50 %: "), "{text}");
    let csv = comparison.to_csv();
    let row = csv.lines().find(|l| l.contains(",wishart,")).unwrap();
    assert!(row.contains("dispersion"), "{row}");
    // Draws that do not even turn are counted.
    let naive = level.cell(ModelKind::ENTRYWISE).unwrap().results.as_ref().unwrap();
    assert!(naive.failed_separations > 0);
    assert!(text.contains("separations failed"), "{text}");
    assert!(comparison.document().html().contains("no wishart"));
}

fn small() -> CompareOptions {
    CompareOptions {
        bodies: vec!["panel".into(), "5,4,3,0.1,0,0".into()],
        levels_percent: vec![5.0, 50.0],
        draws: 100,
        separations: 8,
        ..CompareOptions::default()
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let with = |threads| compare(&CompareOptions { threads: Some(threads), ..small() });
    let (one, four) = (with(1), with(4));
    assert_eq!(one.to_json().unwrap(), four.to_json().unwrap());
    assert_eq!(one.to_csv(), four.to_csv());
    assert_eq!(one.to_string(), four.to_string());
    let other = compare(&CompareOptions { seed: 7, ..small() });
    assert_ne!(one.to_csv(), other.to_csv());
    assert!(
        ModelComparison::run(&CompareOptions { threads: Some(0), ..small() }, &|_| {}).is_err()
    );
}

/// A model draws the same whatever else is compared.
#[test]
fn other_models_levels_and_bodies_shift_no_draw() {
    let many = compare(&small());
    let one = compare(&CompareOptions {
        bodies: vec!["panel".into()],
        levels_percent: vec![50.0],
        models: vec![ModelKind::Basilisk],
        ..small()
    });
    assert_eq!(
        one.bodies[0].levels[0].cell(ModelKind::Basilisk),
        many.bodies[0].levels[1].cell(ModelKind::Basilisk)
    );
}

/// Numbers read back bit for bit, from JSON and from CSV.
#[test]
fn files_read_back() {
    let comparison = compare(&small());
    let json: Value = serde_json::from_str(&comparison.to_json().unwrap()).unwrap();
    assert_eq!(
        serde_json::to_string_pretty(&json).unwrap().len() + 1,
        comparison.to_json().unwrap().len()
    );
    let csv = comparison.to_csv();
    let mut rows = csv.lines().skip(1);
    for (b, body) in comparison.bodies.iter().enumerate() {
        for (l, level) in body.levels.iter().enumerate() {
            for (m, cell) in level.models.iter().enumerate() {
                let found = &json["bodies"][b]["levels"][l]["models"][m];
                assert_eq!(found["model"], cell.model.name());
                let Some(results) = &cell.results else {
                    assert!(rows.next().unwrap().contains(cell.model.name()));
                    continue;
                };
                let same = |value: &Value, x: Option<f64>| {
                    assert_eq!(value.as_f64().map(f64::to_bits), x.map(f64::to_bits));
                };
                same(&found["results"]["fit"]["covariance_off"], Some(results.fit.covariance_off));
                for (s, spread) in results.spreads.iter().enumerate() {
                    let value = &found["results"]["spreads"][s];
                    same(&value["mean"], spread.mean);
                    same(&value["p95"], spread.p95);
                    let row = rows.next().unwrap();
                    let last = row.rsplit(',').next().unwrap();
                    same(&value["p95"], last.parse().ok());
                }
            }
        }
    }
    assert_eq!(rows.next(), None);
    // The body of six numbers is one field.
    assert!(csv.contains("\n\"5,4,3,0.1,0,0\",5,principal,"));
}

/// The spread of what is known in closed form: uniform rescaling moves no ratio, and the largest moment
/// of the reference law varies as its level says.
#[test]
fn the_largest_moment_varies_by_the_level() {
    let comparison = compare(&CompareOptions {
        bodies: vec!["slender-stage".into()],
        levels_percent: vec![2.0],
        models: vec![ModelKind::Principal],
        draws: 20_000,
        separations: 0,
        ..CompareOptions::default()
    });
    let results = comparison.bodies[0].levels[0].models[0].results.as_ref().unwrap();
    let deviation = results.spread(Measure::LargestMoment).unwrap().deviation.unwrap();
    // I₂ and I₃ are both near: the larger of the two varies a little less than either.
    let ratio = deviation / (0.02 * 15_500.0);
    assert!((0.9..1.02).contains(&ratio), "{ratio}");
    let wobble = results.spread(Measure::Wobble).unwrap();
    // Two turns of 0.02 rad: Rayleigh, of 95th percentile σ√(−2 ln 0.05).
    let expected = (0.02 * (-2.0 * 0.05_f64.ln()).sqrt()).to_degrees();
    assert!((wobble.p95.unwrap() / expected - 1.0).abs() < 0.03, "{wobble:?}");
}

#[test]
fn lines_fit_a_terminal() {
    for reference in [Reference::Principal, Reference::Entries] {
        let text = compare(&CompareOptions { reference, ..small() }).to_string();
        for line in text.lines() {
            assert!(line.chars().count() <= 100, "{line}");
        }
    }
}

/// Each file of a figure is announced before the draws, and a file of the user's in its place is found then.
#[test]
fn what_is_in_the_way_of_a_figure_is_found_before_the_draws() {
    let scratch = tempfile::tempdir().unwrap();
    let options = |place: &str| CompareOptions {
        draws: 50,
        separations: 10,
        bodies: vec!["payload".to_owned()],
        levels_percent: vec![1.0, 3.0],
        out: Some(scratch.path().join(place)),
        force: true,
        ..CompareOptions::default()
    };
    let names: Vec<String> = figures_of_models::names().iter().map(|name| file_of(name)).collect();
    ModelComparison::run(&options("free"), &|_| {}).unwrap();
    for entry in std::fs::read_dir(scratch.path().join("free/figures")).unwrap() {
        let name = format!("figures/{}", entry.unwrap().file_name().to_str().unwrap());
        assert!(names.contains(&name), "{name}");
    }
    for (i, name) in names.iter().enumerate() {
        let options = options(&format!("taken-{i}"));
        let mine = options.out.as_ref().unwrap().join(name);
        std::fs::create_dir_all(mine.parent().unwrap()).unwrap();
        std::fs::write(&mine, "mine").unwrap();
        let error = ModelComparison::run(&options, &|_| panic!("it has begun")).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
    }
}

/// The deviation of the rotation vectors, rad, that docs/compare.md states for the axes of the reference.
#[test]
fn the_axes_of_the_reference_turn_as_far_as_is_said() {
    let body = NominalBody::known(None).unwrap().remove(0);
    for (level, expected) in [(0.01, 0.01), (0.05, 0.05), (0.2, 0.2), (0.5, 0.41), (1.0, 0.50)] {
        let law = reference::principal(body.inertia(), level).unwrap();
        let nominal = body.inertia().principal_axes().attitude();
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        const N: u32 = 40_000;
        let mut squares = [0.0; 3];
        for _ in 0..N {
            let turn = (nominal.inverse() * law.axes().sample(&mut rng)).scaled_axis();
            for (sum, angle) in squares.iter_mut().zip(turn.iter()) {
                *sum += angle * angle;
            }
        }
        for sum in squares {
            let found = (sum / f64::from(N)).sqrt();
            assert!(
                (found / expected - 1.0).abs() < 0.025,
                "{level}: {found} rad, {expected} stated"
            );
        }
    }
}

/// A body that is known exactly has no figures beside those of other models, but words; the other body has them as before.
#[test]
fn bodies_that_are_known_exactly_have_words_and_no_numbers() {
    let paper = Scenario::peck_2003().unwrap().with_runs(20).unwrap().to_toml();
    let (before, stage) = paper.split_once("[stage.dispersion]").unwrap();
    let (own, after) = stage.split_once("\n\n").unwrap();
    assert!(own.contains("axes_covariance"), "{own}");
    let still = "\nroot_second_moment_variance_kg_m2 = [0.0, 0.0, 0.0]\naxes = \"fixed\"\n";
    let of_payload = before.split_once("[payload.dispersion]").unwrap();
    let (of_payload, (_, rest)) = (of_payload.0, of_payload.1.split_once("\n\n").unwrap());
    // What the mass does to an inertia is no matter of its law.
    let follows = "mass_percent = 5.0\ninertia_follows_mass = true\n";
    for (payload_too, head, follows) in [
        (false, before.to_owned(), ""),
        (false, before.to_owned(), follows),
        (true, format!("{of_payload}[payload.dispersion]{still}\n{rest}"), ""),
        (true, format!("{of_payload}[payload.dispersion]{still}{follows}\n{rest}"), follows),
    ] {
        // The models that are matched need a covariance.
        let (after, _) = after.split_once("[[models]]").unwrap();
        let text = format!(
            "{head}[stage.dispersion]{still}{follows}\n{after}[[models]]\nname = \"own\"\nlaw = \"principal\"\naxes = \"whole-sphere\"\n"
        );
        let scenario = Scenario::from_toml(&text).unwrap_or_else(|e| panic!("{e}\n{text}"));
        let every = Section::new(&scenario, &|| Ok(())).unwrap();
        assert_eq!(every.figure().is_none(), payload_too);
        let page =
            every.section().map(|section| Document::new("", "", "").section(section).markdown());
        assert_eq!(page.is_none(), payload_too);
        let Some(page) = page else { continue };
        assert!(!page.contains("NaN") && !page.contains(" inf "), "{page}");
        let why = "> stage: no reference: the inertia is not dispersed where the mass is nominal";
        assert!(page.contains(why), "{page}");
        let rows = page.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| ---"));
        let rows: Vec<Vec<&str>> = rows.skip(1).map(|line| line.split(" | ").collect()).collect();
        assert_eq!(rows.len(), ModelKind::ALL.len());
        assert!(rows.iter().all(|row| row[2] == "–" && row[7] == "– |"), "{page}");
    }
}

/// Whoever wants an end does not wait for the separations that are left, which can take a second each.
#[test]
fn an_end_comes_between_two_separations() {
    let scenario = Scenario::peck_2003().unwrap();
    let asked = AtomicU64::new(0);
    let go_on = || match asked.fetch_add(1, Ordering::Relaxed) {
        0..=6 => Ok(()),
        _ => Err(CampaignError::Stopped.into()),
    };
    let pool = threads(Some(1)).unwrap();
    let error = pool.install(|| Section::new(&scenario, &go_on)).unwrap_err();
    assert!(matches!(error, StudyError::Campaign(CampaignError::Stopped)), "{error}");
    assert!((8..8 + ModelKind::ALL.len() as u64).contains(&asked.into_inner()));
}
