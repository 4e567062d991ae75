//! Mass, mass centre and inertia of a body as one law: every way to say it, and what is drawn of it.

mod moments;
mod refusals;

use gyradius_attitude::{RadiallyConstrainedGaussian, UniformAttitude};
use gyradius_dispersion::{
    AxesLaw, JointScalar, MassPropertiesLaw, ScalarLaw, TenMoments, TensorLaw, Wishart,
};
use gyradius_inertia::{Containment, Inertia, InertiaMatrix, MassProperties, Region};
use nalgebra::{Matrix4, SMatrix, SVector, Vector3, Vector4};
use rand::RngExt;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

use crate::{
    Draw, DrawOptions, Scenario,
    groups::Drawing,
    model::Model,
    run::Case,
    scenario::{ModelLaw, Target},
};
use gyradius_dispersion::ModelKind;
use gyradius_separation::BodyParameter;

const MASS: f64 = 120.0;
const INERTIA: [f64; 6] = [21.0, 19.0, 26.0, 0.2, -0.1, 0.3];

/// A scenario with this of the payload's uncertainty, and this besides.
fn text(payload: &str, rest: &str) -> String {
    format!(
        r#"
name = "joint"
runs = 50
seed = 11
{rest}
[payload]
mass_kg = 120.0
inertia_kg_m2 = [[21.0, 0.2, -0.1], [0.2, 19.0, 0.3], [-0.1, 0.3, 26.0]]
position_m = [0.0, 0.0, 1.0]
{payload}

[stage]
mass_kg = 900.0
inertia_kg_m2 = [[400.0, 0.0, 0.0], [0.0, 420.0, 0.0], [0.0, 0.0, 150.0]]
position_m = [0.0, 0.0, -1.0]

[stage.dispersion]
root_second_moment_variance_kg_m2 = [0.01, 0.01, 0.01]
axes = "fixed"
mass_percent = 1.0

[[springs]]
stiffness_n_per_m = 1e4
stroke_m = 0.05
payload_point_m = [0.0, 0.0, -0.9]
stage_point_m = [0.0, 0.0, 0.9]

[springs.dispersion]
stiffness_percent = 2.0

[[models]]
name = "proposed"
law = "principal"
axes = "whole-sphere"

[[models]]
name = "naive"
law = "entrywise"
matched_to = "proposed"
"#
    )
}

fn read(payload: &str, rest: &str) -> Scenario {
    let text = text(payload, rest);
    Scenario::from_toml(&text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// With a whole law in the place of the payload's dispersion.
fn with_law(law: &MassPropertiesLaw, rest: &str) -> Scenario {
    let mut table: toml::Table = toml::from_str(&text("", rest)).unwrap();
    let payload = table["payload"].as_table_mut().unwrap();
    payload.insert("law".to_owned(), toml::Value::try_from(law).unwrap());
    let text = toml::to_string(&table).unwrap();
    Scenario::from_toml(&text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn refusal(payload: &str, rest: &str) -> String {
    let text = text(payload, rest);
    match Scenario::from_toml(&text) {
        Ok(_) => panic!("taken:\n{text}"),
        Err(error) => error.to_string(),
    }
}

/// The drawn body, if there is one.
fn body(scenario: &Scenario, case: &Case) -> Option<MassProperties> {
    let value = |parameter, i| {
        let target = Target::Body(crate::body::Body::Payload, parameter, i);
        let place = scenario.dispersions().all().iter().position(|d| d.target == target);
        place.map(|place| case.drawn[place])
    };
    let centre = [0, 1, 2].map(|i| value(BodyParameter::MassCentre, i).unwrap_or(0.0));
    let mass = value(BodyParameter::Mass, 0).unwrap_or(MASS);
    let inertia = Inertia::try_from(case.bodies[0].inertia).ok()?;
    MassProperties::new(mass, Vector3::from(centre), inertia).ok()
}

fn bodies(scenario: &Scenario, model: usize, runs: u64) -> Vec<MassProperties> {
    let model = &Model::all(scenario).unwrap()[model];
    (0..runs).map(|run| body(scenario, &model.draw(scenario, run)).unwrap()).collect()
}

fn ten(body: &MassProperties) -> SVector<f64, 10> {
    gyradius_dispersion::TenParameters::from(*body).values().into()
}

/// The largest deviation of mean and covariance from what they should be, in standard errors of a normal sample.
fn worst(expected: &TenMoments, bodies: &[MassProperties]) -> f64 {
    let n = bodies.len() as f64;
    let mean = bodies.iter().map(ten).sum::<SVector<f64, 10>>() / n;
    let square = |x: SVector<f64, 10>| (x - mean) * (x - mean).transpose();
    let covariance = bodies.iter().map(|b| square(ten(b))).sum::<SMatrix<f64, 10, 10>>() / n;
    let c = expected.covariance();
    let mut worst = 0.0_f64;
    for i in 0..10 {
        let off = (mean[i] - expected.mean()[i]).abs();
        worst = worst.max(off / ((c[(i, i)] / n).sqrt() + 1e-9));
        for j in 0..=i {
            let error = ((c[(i, i)] * c[(j, j)] + c[(i, j)].powi(2)) / n).sqrt();
            worst = worst.max((covariance[(i, j)] - c[(i, j)]).abs() / (error + 1e-12));
        }
    }
    worst
}

fn fixed_axes() -> gyradius_dispersion::FixedAttitude {
    let nominal = Inertia::try_from(inertia()).unwrap();
    gyradius_dispersion::FixedAttitude::new(nominal.principal_axes().attitude())
}

fn inertia() -> InertiaMatrix {
    let [a, b, c, d, e, f] = INERTIA;
    InertiaMatrix::from_entries([a, b, c], [d, e, f]).unwrap()
}

/// The nominal radii of gyration.
fn lengths() -> [f64; 3] {
    let nominal = Inertia::try_from(inertia()).unwrap();
    nominal.second_moments().roots().values().map(|k| k / MASS.sqrt())
}

const REGIONS: [&str; 3] = [
    "ellipsoid = { middle_m = [0.02, 0.0, 0.0], semi_axes_m = [0.56, 0.6, 0.58] }",
    "box = { middle_m = [0.0, 0.0, 0.01], half_sides_m = [0.45, 0.46, 0.44], attitude = [0.0, 0.0, 0.1, 0.99498743710662] }",
    "hull = { points_m = [[1.1, 0.0, 0.0], [-1.1, 0.0, 0.0], [0.0, 1.1, 0.0], [0.0, -1.1, 0.0], [0.0, 0.0, 1.1], [0.0, 0.0, -1.1]] }",
];

/// Any scenario with any of the keys: it says itself again, draws the same again and of its own law nothing that is
/// not in the region, and correlations may name what it has.
#[test]
fn every_subset_of_the_keys_is_drawn_and_says_itself_again() {
    let mut rng = ChaCha8Rng::seed_from_u64(16);
    let mut kept = 0;
    for case in 0..100 {
        let mut pick = |n: usize| rng.random_range(0..n);
        let law = |kind: usize, s: f64| match kind {
            0 => format!("{s:?}"),
            1 => format!("{{ law = \"uniform\", low = {:?}, high = {s:?} }}", -s),
            2 => format!("{{ law = \"lognormal\", sigma = {s:?} }}"),
            3 => format!("{{ law = \"truncated-normal\", sigma = {s:?}, low = {:?} }}", -s),
            _ => format!("{{ sigma = {s:?}, sigmas = 3, mean = {:?} }}", 0.1 * s),
        };
        // Trial draws in hulls and boxes take a while.
        let region = [0, 3, 0, 3, 0, 3, 0, 3, 1, 2][case % 10];
        let (lengths, mass) = (pick(2) == 0, pick(3));
        let mut payload = "[payload.dispersion]\n".to_owned();
        if lengths {
            let [a, b, c] = [0.02, 0.015, 0.0].map(|s| law(if s > 0.0 { pick(5) } else { 0 }, s));
            payload += &format!("gyration_lengths_m = [{a}, {b}, {c}]\n");
        } else {
            payload += "root_second_moment_variance_kg_m2 = [0.04, 0.02, 0.01]\n";
        }
        let axes = [
            "axes = \"fixed\"",
            "axes = \"uniform\"",
            "axes_covariance = [[1e-3, 0.0, 0.0, 0.0], [0.0, 1e-3, 0.0, 0.0], [0.0, 0.0, 1e-3, 0.0], [0.0, 0.0, 0.0, 0.5]]",
        ];
        payload += &format!("{}\n", axes[pick(3)]);
        match mass {
            0 => {}
            1 => payload += &format!("mass_kg = {}\n", law(pick(5), 6.0)),
            _ => payload += &format!("mass_percent = {}\n", law(pick(5), 4.0)),
        }
        let follows = pick(3);
        if mass > 0 && follows > 0 {
            let share = if lengths || follows == 1 { "true" } else { "0.4" };
            payload += &format!("inertia_follows_mass = {share}\n");
        }
        let centre = pick(2) > 0;
        if centre {
            payload +=
                &format!("mass_centre_m = [0.01, {}, 0.0]\n", law([0, 1, 3, 4][pick(4)], 0.02));
        }
        if region < 3 {
            payload += &format!("inside = {{ {} }}\n", REGIONS[region]);
        }
        let size = if lengths { "payload_gyration_length_N_m" } else { "payload_root_N_sqrt_kg_m" };
        let mut rest = String::new();
        let mut between = |a: &str, b: &str, coefficient: f64| {
            rest += &format!(
                "[[correlations]]\nbetween = [\"{a}\", \"{b}\"]\ncoefficient = {coefficient}\n"
            );
        };
        let correlated = pick(3);
        if correlated > 0 {
            between(&size.replace('N', "1"), &size.replace('N', "2"), -0.5);
        }
        if correlated > 1 && mass > 0 {
            between("payload_mass_kg", &size.replace('N', "2"), 0.6);
        }
        if correlated > 1 && centre {
            between("payload_mass_centre_2_m", "spring_1_stiffness_n_per_m", 0.3);
        }
        let text = text(&payload, &rest);
        let scenario = Scenario::from_toml(&text).unwrap_or_else(|e| panic!("{e}\n{text}"));
        let resolved = scenario.to_toml();
        let again = Scenario::from_toml(&resolved).unwrap_or_else(|e| panic!("{e}\n{resolved}"));
        assert_eq!(again.to_toml(), resolved);
        let columns = scenario.dispersions().columns();
        assert!(!columns.iter().any(|c| c.contains("length") || c.contains("root")), "{columns:?}");
        let (models, others) = (Model::all(&scenario).unwrap(), Model::all(&again).unwrap());
        for (model, other) in models.iter().zip(&others) {
            let own = model.law() == ModelLaw::Kind(ModelKind::Principal);
            for run in 0..30 {
                let drawn = model.draw(&scenario, run);
                assert_eq!(format!("{drawn:?}"), format!("{:?}", other.draw(&again, run)));
                if own && let Some(region) = scenario.payload().region() {
                    let body = body(&scenario, &drawn).unwrap();
                    assert_eq!(region.containment(&body), Containment::Possible, "{text}");
                    kept += 1;
                }
            }
        }
        let found = models[0].kept().count();
        assert_eq!(found, usize::from(region < 3));
        assert!(models[1].kept().count() == 0);
    }
    assert!(kept > 1000, "{kept}");
}

/// A law of scalars of every kind.
fn scalar(kind: usize, mean: f64, sigma: f64) -> ScalarLaw {
    let half = 3f64.sqrt() * sigma;
    match kind % 9 {
        0 => ScalarLaw::normal(mean, sigma),
        1 => ScalarLaw::uniform(mean - half, mean + half),
        2 => ScalarLaw::lognormal(mean, sigma),
        3 => ScalarLaw::truncated_normal(mean, sigma, mean - 1.5 * sigma, f64::INFINITY),
        4 => ScalarLaw::triangular(mean - half, mean, mean + 2.0 * half),
        5 => ScalarLaw::beta(mean - half, mean + half, 2.0, 3.0),
        6 => ScalarLaw::weibull(mean - half, half, 2.0),
        7 => ScalarLaw::samples(&[mean - sigma, mean, mean + sigma]),
        _ => ScalarLaw::normal(mean, 0.0),
    }
    .unwrap()
}

/// What a region keeps are the draws without it that are in it: the same law, by its moments, and the share that is told.
#[test]
fn a_region_conditions_the_law() {
    let payload = "[payload.dispersion]\ngyration_lengths_m = [0.03, 0.02, 0.02]\naxes = \"fixed\"\n\
                   mass_percent = 5.0\nmass_centre_m = 0.1\n";
    let rest = "[[correlations]]\nbetween = [\"payload_mass_kg\", \"payload_gyration_length_1_m\", \
                \"spring_1_stiffness_n_per_m\"]\ncoefficient = 0.5\n";
    let free = read(payload, rest);
    let kept = read(&format!("{payload}inside = {{ {} }}\n", REGIONS[0]), rest);
    let region = kept.payload().region().unwrap();
    let all = bodies(&free, 0, 20_000);
    let inside: Vec<MassProperties> =
        all.iter().filter(|b| region.containment(b) == Containment::Possible).copied().collect();
    let share = inside.len() as f64 / all.len() as f64;
    let models = Model::all(&kept).unwrap();
    let (_, (told, error)) = models[0].kept().next().unwrap();
    assert!((told - share).abs() < 5.0 * error && told < 0.9, "{told} {error} {share}");
    let drawn = bodies(&kept, 0, 10_000);
    let mean = |bodies: &[MassProperties]| {
        let n = bodies.len() as f64;
        let mean = bodies.iter().map(ten).sum::<SVector<f64, 10>>() / n;
        let square = |b: &MassProperties| (ten(b) - mean).component_mul(&(ten(b) - mean));
        (mean, bodies.iter().map(square).sum::<SVector<f64, 10>>() / (n * n))
    };
    let ((a, var_a), (b, var_b)) = (mean(&inside), mean(&drawn));
    for i in 0..10 {
        let z = (a[i] - b[i]) / ((var_a[i] + var_b[i]).sqrt() + 1e-12);
        assert!(z.abs() < 4.5, "{i} {z}");
    }
    // A draw that is in the region at once is that without the region; the stiffness goes with the mass.
    let [open, closed] = [&free, &kept].map(|s| {
        let models = Model::all(s).unwrap();
        (0..200).map(|run| models[0].draw(s, run)).collect::<Vec<_>>()
    });
    let same =
        |(a, b): &(&Case, &Case)| a.drawn == b.drawn && a.bodies[0].inertia == b.bodies[0].inertia;
    let same = open.iter().zip(&closed).filter(same).count();
    assert!((50..200).contains(&same), "{same}");
    let one = models[0].groups();
    let expected = "payload inertia, payload mass, payload mass centre and 2 more, correlated";
    assert!(one.names().contains(&expected.to_owned()), "{:?}", one.names());
    assert!(!one.names().iter().any(|name| name.ends_with("payload axes")));
    let [scored, others] = one.by_scores();
    assert!(scored == ["stage mass"] && others.contains(&expected.to_owned()), "{scored:?}");
    // Other models have no region, and no lengths.
    let naive = models[1].groups();
    let names = naive.names();
    assert!(!names.iter().any(|name| name.contains("length")), "{names:?}");
    assert_eq!(naive.by_scores()[0].len(), 3, "{:?}", naive.by_scores());
}

/// A group that is exchanged takes what it holds from the second draw, and all else stays, of correlated lengths too.
#[test]
fn groups_of_joint_laws_are_exchanged() {
    let payload = "[payload.dispersion]\ngyration_lengths_m = [0.03, 0.02, 0.02]\naxes = \"uniform\"\n\
                   mass_percent = 5.0\nmass_centre_m = 0.1\n";
    let rest = "[[correlations]]\nbetween = [\"payload_mass_kg\", \"payload_gyration_length_1_m\"]\n\
                coefficient = 0.5\n";
    for region in ["".to_owned(), format!("inside = {{ {} }}\n", REGIONS[1])] {
        let scenario = read(&format!("{payload}{region}"), rest);
        let model = &Model::all(&scenario).unwrap()[0];
        let groups = model.groups();
        let draw = |run: u64| model.draw_of(&scenario, &Drawing::Exchanging, run);
        for base in 0..10 {
            let first = groups.designs().runs(base);
            let (a, b) = (draw(first), draw(first + 1));
            assert_eq!(format!("{a:?}"), format!("{:?}", model.draw(&scenario, base)));
            for (i, name) in groups.names().iter().enumerate() {
                let c = draw(first + 2 + i as u64);
                let of = |name: &str, from: &Case| match name {
                    "axes" => format!("{:?}", from.bodies[0].axes),
                    "centre" => format!("{:?}", &from.drawn[1..4]),
                    _ => {
                        let trace = from.bodies[0].inertia.matrix().trace() as f32;
                        format!("{:?}", (from.drawn[0], trace))
                    }
                };
                let own: &[&str] = match name.as_str() {
                    "payload inertia, payload mass, payload mass centre and 1 more, correlated" => {
                        &["axes", "centre", "size"]
                    }
                    "payload axes" => &["axes"],
                    "payload mass, payload gyration length" => &["size"],
                    "payload mass centre" => &["centre"],
                    _ => &[],
                };
                for part in ["axes", "centre", "size"] {
                    let expected = if own.contains(&part) { &b } else { &a };
                    assert_eq!(of(part, &c), of(part, expected), "{name}: {part}");
                }
            }
        }
    }
}

/// Models that are matched have the moments of the inertia at the nominal mass, with the correlations of the roots.
#[test]
fn matched_models_know_of_correlated_lengths() {
    let payload =
        "[payload.dispersion]\ngyration_lengths_m = [0.03, 0.02, 0.02]\naxes = \"fixed\"\n";
    let rest = "[[correlations]]\nbetween = [\"payload_gyration_length_1_m\", \
                \"payload_gyration_length_2_m\", \"payload_gyration_length_3_m\"]\ncoefficient = 0.9\n";
    let scenario = read(payload, rest);
    let models = Model::all(&scenario).unwrap();
    let [given, _] = models[1].given_deviations().unwrap();
    let drawn = bodies(&scenario, 0, 20_000);
    let n = drawn.len() as f64;
    for (i, given) in given.into_iter().enumerate() {
        let values: Vec<f64> = drawn.iter().map(|b| ten(b)[4 + i]).collect();
        let mean = values.iter().sum::<f64>() / n;
        let found = (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt();
        assert!((found / given - 1.0).abs() < 0.05, "{i} {found} {given}");
    }
}

/// The same table on any number of threads, whose columns are in the region, as are those of a replay.
#[test]
fn tables_are_the_same_on_any_number_of_threads() {
    let payload = format!(
        "[payload.dispersion]\ngyration_lengths_m = [0.03, 0.02, 0.02]\naxes = \"uniform\"\n\
         mass_percent = 5.0\nmass_centre_m = 0.1\ninside = {{ {} }}\n",
        REGIONS[0]
    );
    let rest = "[[correlations]]\nbetween = [\"payload_mass_kg\", \"payload_gyration_length_1_m\"]\n\
                coefficient = 0.5\n";
    let scenario = read(&payload, rest);
    let table = |threads| {
        let options = DrawOptions { threads: Some(threads), ..DrawOptions::default() };
        let mut table = Vec::new();
        Draw::new(&scenario, &options).unwrap().write(&mut table, &|_| {}).unwrap();
        String::from_utf8(table).unwrap()
    };
    let (one, four) = (table(1), table(4));
    assert!(one == four);
    let mut rows = one.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let names = rows.next().unwrap();
    let region = scenario.payload().region().unwrap();
    let mut found = 0;
    for row in rows.filter(|row| row[0] == "proposed") {
        let number = |name: &str| -> f64 {
            row[names.iter().position(|n| *n == name).unwrap()].parse().unwrap()
        };
        let entries =
            ["11", "22", "33", "12", "13", "23"].map(|e| number(&format!("payload_i{e}")));
        let [a, b, c, d, e, f] = entries;
        let inertia = InertiaMatrix::from_entries([a, b, c], [d, e, f]).unwrap();
        let centre = [1, 2, 3].map(|i| number(&format!("payload_mass_centre_{i}_m")));
        let mass = number("payload_mass_kg");
        let body =
            MassProperties::new(mass, Vector3::from(centre), Inertia::try_from(inertia).unwrap());
        assert_eq!(region.containment(&body.unwrap()), Containment::Possible);
        found += 1;
    }
    assert_eq!(found, 50);
}

/// What the page of scenario files shows is taken as it stands, and says what the page says of it.
#[test]
fn the_page_shows_what_is_taken() {
    let page = include_str!("../../../../../docs/scenario.md");
    let section = page.split("\n## ").find(|s| s.starts_with("Mass, mass centre and")).unwrap();
    let examples: Vec<&str> =
        section.split("```toml").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    assert_eq!(examples.len(), 2);
    for example in examples {
        let scenario = read(example, "");
        assert_eq!(scenario.dispersions().joint.roots.len(), 3, "{example}");
        let has_region = scenario.payload().region().is_some();
        assert_eq!(has_region, example.contains("inside"), "{example}");
        assert_eq!(bodies(&scenario, 0, 50).len(), 50);
    }
}
