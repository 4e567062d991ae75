//! Alerts held against what the run tables say, and an ordinary scenario, which has none.

use super::*;
use crate::{
    OffNominal, Scenario, Summary,
    body::{Body, Entry},
    model::Model,
    quantity::Quantity,
    study::{all_runs, judged},
    subject::Subject,
};
use gyradius_campaign::Runs;
use gyradius_inertia::{InertiaMatrix, RealizabilityReport};
use gyradius_statistics::Confidence;
use proptest::prelude::*;

pub(super) fn study(scenario: &Scenario) -> (Summary, Vec<Runs>) {
    let models = Model::all(scenario).unwrap();
    (judged(scenario, &models), all_runs(scenario, &models))
}

/// A satellite of three tonnes on a stage, with four like springs, of which little is uncertain.
pub(super) fn ordinary(runs: u64, spread: f64, springs: &str) -> Scenario {
    let body = |name: &str, mass: f64, inertia: f64, z: f64, factor: f64| {
        let matrix = [[inertia, 0.0, 0.0], [0.0, factor * inertia, 0.0], [0.0, 0.0, 0.9 * inertia]];
        let variance = [spread * spread * inertia * 0.4; 3];
        format!(
            "[{name}]\nmass_kg = {mass:?}\ninertia_kg_m2 = {matrix:?}\nposition_m = [0.0, 0.0, {z:?}]\n\
             angular_velocity_rad_per_s = [0.0, 0.0, 0.5]\n\
             [{name}.dispersion]\naxes = \"fixed\"\nroot_second_moment_variance_kg_m2 = {variance:?}\n"
        )
    };
    let bodies =
        body("payload", 3000.0, 2000.0, 1.0, 1.1) + &body("stage", 2000.0, 3000.0, -1.0, 1.05);
    let springs: String = [[0.5, 0.5], [-0.5, 0.5], [-0.5, -0.5], [0.5, -0.5]]
        .map(|[x, y]| {
            // Turned a little, so that the springs also give a moment about the spin axis.
            let [a, b] = [x - 0.02 * y, y + 0.02 * x];
            format!(
                "[[springs]]\nstiffness_n_per_m = 2e4\nstroke_m = 0.05\npayload_point_m = [{a:?}, {b:?}, -0.9]\n\
                 stage_point_m = [{x:?}, {y:?}, 0.9]\ndispersion = {{ {springs} }}\n"
            )
        })
        .concat();
    let text = format!(
        "name = \"ordinary\"\nruns = {runs}\nspin_axis = [0.0, 0.0, 1.0]\n{bodies}{springs}\
         [[models]]\nname = \"principal\"\nlaw = \"principal\"\naxes = \"whole-sphere\"\n"
    );
    Scenario::from_toml(&text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

pub(super) const NORMAL: &str = "stiffness_n_per_m = { law = \"normal\", sigma = 200.0 }";

#[test]
fn an_ordinary_scenario_has_no_alert() {
    let scenario = ordinary(2000, 0.01, NORMAL);
    let (summary, _) = study(&scenario);
    assert_eq!(summary.head.alerts, []);
    assert!(!scenario.report(&summary).html().contains("Before you rely on the results"));
}

/// Thrown at the stage, at rest and away from it, by springs that may fail: the alert counts the rows, and the page names it. Spun about
/// axes at all angles to the spin axis: it is told beyond 45°.
#[test]
fn what_goes_the_wrong_way_is_told() {
    let base = ordinary(60, 0.01, NORMAL).to_toml();
    let with = |speed: f64, spin: [f64; 3]| {
        let mut table: toml::Table = base.parse().unwrap();
        let list = |v: [f64; 3]| toml::Value::from(v.to_vec());
        let payload = table["payload"].as_table_mut().unwrap();
        payload.insert("velocity_m_per_s".to_owned(), list([0.0, 0.0, speed]));
        payload.insert("angular_velocity_rad_per_s".to_owned(), list(spin));
        Scenario::from_toml(&toml::to_string(&table).unwrap()).unwrap()
    };
    let mut seen = [0_u64; 2];
    for speed in [-8.0, -5.0, -3.0, -0.1, 0.0, 2.0] {
        let scenario = with(speed, [0.0, 0.0, 0.5]);
        let (summary, runs) = study(&scenario);
        let table = runs[0].table().unwrap();
        let errors = Quantity::DirectionError.in_table(&table);
        let expected = errors.iter().filter(|error| **error > 90.0).count() as u64;
        let told = summary.head.alerts.iter().find_map(|alert| match alert {
            Alert::Backwards { backwards, runs, .. } => Some([*backwards, *runs]),
            _ => None,
        });
        assert_eq!(told, (expected > 0).then_some([expected, errors.len() as u64]), "{speed}");
        seen[usize::from(expected > 0)] += 1;
        let page = scenario.report(&summary).html();
        assert_eq!(page.contains("the payload leaves the wrong way"), expected > 0);
        assert!(page.contains("meant to spin about, (0, 0, 1) in its body axes"));
    }
    assert!(seen.iter().all(|seen| *seen > 1), "{seen:?}");
    // Whoever has given outlines is not told to give some.
    for outlines in [false, true] {
        let mut text = with(-8.0, [0.0, 0.0, 0.5]).to_toml();
        if outlines {
            text += "\n[clearance]\npayload = [{ points_m = [[0.0, 0.0, -0.5]] }]\nstage = [{ points_m = [[1.0, 0.0, 0.9]] }]\n";
        }
        let scenario = Scenario::from_toml(&text).unwrap();
        let page = scenario.report(&study(&scenario).0).html();
        assert!(page.contains("the payload leaves the wrong way"));
        assert_eq!(page.contains("in the scenario, would tell"), !outlines);
        assert_eq!(page.contains("in how many runs the outlines of the bodies touch"), outlines);
    }
    for turn in [0.0_f64, 30.0, 44.0, 46.0, 90.0, 180.0] {
        let (sin, cos) = turn.to_radians().sin_cos();
        // The momentum turns with the moments, 2000 and 1800 kg·m².
        let scenario = with(0.0, [sin / 2000.0, 0.0, cos / 1800.0]);
        let (summary, _) = study(&scenario);
        let told = summary.head.alerts.iter().find_map(|alert| match alert {
            Alert::OffAxis { angle_deg, .. } => Some(*angle_deg),
            _ => None,
        });
        assert_eq!(told.is_some(), turn > 45.0, "{turn}");
        assert!(told.is_none_or(|told| (told - turn).abs() < 1e-6), "{turn} {told:?}");
    }
    assert!(
        study(&with(0.0, [0.0; 3]))
            .0
            .head
            .alerts
            .iter()
            .all(|a| !matches!(a, Alert::OffAxis { .. }))
    );
}

/// A law whose mean is beside the nominal value: it is told if they are ten times apart.
#[test]
fn laws_far_from_nominal_values_are_told() {
    let base = ordinary(2, 0.01, NORMAL).to_toml();
    for factor in [-1.0, 0.05, 0.1, 0.11, 0.5, 1.0, 3.0, 9.0, 10.0, 11.0, 100.0] {
        for (key, nominal) in [("mass_kg", 3000.0), ("root_second_moments", 0.0)] {
            if key != "mass_kg" && factor < 0.0 {
                continue;
            }
            let mut table: toml::Table = base.parse().unwrap();
            let dispersion = table["payload"]["dispersion"].as_table_mut().unwrap();
            if key == "mass_kg" {
                let law = toml::Table::from_iter([
                    ("mean".to_owned(), toml::Value::from(nominal * (factor - 1.0))),
                    ("sigma".to_owned(), toml::Value::from(0.1)),
                ]);
                dispersion.insert(key.to_owned(), law.into());
            } else {
                // The moments go with the squares of the roots.
                let scale = f64::sqrt(factor);
                let nominal = Scenario::from_toml(&base).unwrap();
                let roots = nominal.payload().nominal().principal_axes().second_moments();
                let law = |k: &f64| {
                    toml::Value::from(toml::Table::from_iter([
                        ("mean".to_owned(), toml::Value::from(k.sqrt() * scale)),
                        ("sigma".to_owned(), toml::Value::from(0.001)),
                    ]))
                };
                dispersion.remove("root_second_moment_variance_kg_m2");
                dispersion.insert("roots".to_owned(), "independent".into());
                dispersion.insert(
                    "root_second_moment_laws_sqrt_kg_m".to_owned(),
                    roots.iter().map(law).collect::<Vec<_>>().into(),
                );
            }
            let scenario = match Scenario::from_toml(&toml::to_string(&table).unwrap()) {
                Ok(scenario) => scenario,
                Err(error) => {
                    assert!(factor < 0.0, "{key} {factor}: {error}");
                    continue;
                }
            };
            let (summary, _) = study(&scenario);
            let told: Vec<_> = summary
                .head
                .alerts
                .iter()
                .filter_map(|alert| match alert {
                    Alert::OffNominal(OffNominal::Value { quantity, nominal, mean }) => {
                        Some((quantity.clone(), mean / nominal))
                    }
                    _ => None,
                })
                .collect();
            let is_far = !(0.1 + 1e-9..10.0 - 1e-9).contains(&factor);
            assert_eq!(told.len(), usize::from(is_far), "{key} {factor}: {told:?}");
            assert!(told.iter().all(|(_, ratio)| (ratio / factor - 1.0).abs() < 1e-3), "{told:?}");
        }
    }
}

/// Mass centres whose laws are near the nominal one and far from it, of one body or both, stated as dispersions or as whole laws: those are
/// told that are farther away than three deviations and than a tenth of the size of the body.
#[test]
fn mass_centres_far_from_nominal_are_told() {
    let base = ordinary(2, 0.01, NORMAL);
    for case in 0..4 * 4 * 3 * 3 * 2 {
        let mean = [0.0_f64, 0.02, -0.2, 1.5][case % 4];
        let sigma = [1e-6, 0.001, 0.1, 1.0][case / 4 % 4];
        let (which, axis, whole) = (case / 16 % 3, case / 48 % 3, case / 144 == 1);
        let mut table: toml::Table = base.to_toml().parse().unwrap();
        let mut expected = Vec::new();
        for (place, body) in Body::BOTH.into_iter().enumerate().filter(|(i, _)| which & 1 << i == 0)
        {
            let law = |i| {
                format!(
                    "{{ mean = {:?}, sigma = {:?} }}",
                    if i == axis { mean } else { 0.0 },
                    sigma
                )
            };
            let centre = format!("mass_centre_m = [{}, {}, {}]", law(0), law(1), law(2));
            let entry = table[body.name()].as_table_mut().unwrap();
            let mass = entry["mass_kg"].as_float().unwrap();
            let nominal = if place == 0 { base.payload() } else { base.stage() };
            let moments = nominal.nominal().principal_axes().second_moments();
            if whole {
                let roots = moments.map(|k| format!("{{ mean = {:?}, sigma = 0.001 }}", k.sqrt()));
                let law = format!(
                    "mass_kg = {{ mean = {mass:?}, sigma = 1.0 }}\n{centre}\n[inertia.of.roots]\nlaws = [{}]\naxes = {{ law = \"uniform\" }}",
                    roots.join(", ")
                );
                entry.remove("dispersion");
                entry.insert("law".to_owned(), law.parse::<toml::Table>().unwrap().into());
            } else {
                let centre: toml::Table = centre.parse().unwrap();
                entry["dispersion"].as_table_mut().unwrap().extend(centre);
            }
            let size = f64::sqrt(moments.iter().sum::<f64>() / mass);
            if mean.abs() > 3.0 * sigma && mean.abs() > 0.1 * size {
                expected.push((
                    body.name().to_owned(),
                    [0, 1, 2].map(|i| if i == axis { mean } else { 0.0 }),
                ));
            }
        }
        let text = toml::to_string(&table).unwrap();
        let scenario = Scenario::from_toml(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        let laws = scenario.off_nominal();
        let told = laws.iter().map(|law| match law {
            OffNominal::Centre { body, change_m, is_of_change: true } => (body.clone(), *change_m),
            other => panic!("{other}\n{text}"),
        });
        assert_eq!(told.collect::<Vec<_>>(), expected, "{mean} {sigma} {axis} {whole}\n{text}");
        if case % 53 == 0 {
            let (summary, _) = study(&scenario);
            let page = scenario.report(&summary).html();
            let count = page.matches("is far from the nominal one").count();
            assert_eq!(count, expected.len(), "{text}");
        }
    }
}

/// Matched to a principal law that is more and more uncertain: it is told exactly where the moments of what is drawn are not
/// those of the principal law, and what is told of them is what the draws do.
#[test]
fn a_model_without_the_moments_it_is_matched_to_is_told() {
    let mut seen = [0; 2];
    let fixed = [0.01, 0.1, 0.3, 0.5, 0.7, 1.0, 1.4].map(|spread| (spread, false));
    for (spread, turned) in fixed.into_iter().chain([0.01, 0.1].map(|spread| (spread, true))) {
        let mut text = ordinary(2, spread, NORMAL).to_toml()
            + "\n[[models]]\nname = \"log\"\nlaw = \"log-cholesky\"\nmatched_to = \"principal\"\n";
        if turned {
            // Slender, and turned anyhow.
            let mut table: toml::Table = toml::from_str(&text).unwrap();
            let slender = [[9e3, 0.0, 0.0], [0.0, 1e4, 0.0], [0.0, 0.0, 4e3]];
            let slender = toml::Value::try_from(slender).unwrap();
            let payload = table["payload"].as_table_mut().unwrap();
            payload.insert("inertia_kg_m2".to_owned(), slender);
            let dispersion = payload["dispersion"].as_table_mut().unwrap();
            dispersion.insert("axes".to_owned(), "uniform".into());
            text = toml::to_string(&table).unwrap();
        }
        let scenario = Scenario::from_toml(&text).unwrap();
        let told = scenario.unmatched();
        let draws = |model: &Model| -> Vec<[f64; 6]> {
            let inertia = |run| model.draw(&scenario, run).bodies[0].inertia.entries();
            (0..40_000).map(inertia).collect()
        };
        let models = Model::all(&scenario).unwrap();
        let [principal, log] = &models[..] else { panic!("{}", models.len()) };
        let moments = |draws: &[[f64; 6]], e: usize| {
            let n = draws.len() as f64;
            let mean = draws.iter().map(|d| d[e]).sum::<f64>() / n;
            (mean, (draws.iter().map(|d| (d[e] - mean).powi(2)).sum::<f64>() / n).sqrt())
        };
        let (principal, log) = (draws(principal), draws(log));
        let off = (0..3).map(|e| {
            let ((mean, deviation), (other, its)) = (moments(&principal, e), moments(&log, e));
            [(other - mean).abs() / deviation, its / deviation]
        });
        let off = off.fold([0.0, 1.0_f64], |a, b| {
            [a[0].max(b[0]), if b[1].ln().abs() > a[1].ln().abs() { b[1] } else { a[1] }]
        });
        match &told[..] {
            [] => {
                assert!(off[0] < 0.02 && (off[1] - 1.0).abs() < 0.05, "{spread}: {off:?}");
                seen[0] += 1;
            }
            [law, ..] => {
                assert_eq!(
                    [&law.model, &law.matched_to, &law.body],
                    ["log", "principal", "payload"].map(str::to_owned).each_ref()
                );
                assert!(
                    (law.mean_off - off[0]).abs() < 0.02 + 0.1 * law.mean_off,
                    "{law}: {off:?}"
                );
                assert!((law.deviation_ratio / off[1] - 1.0).abs() < 0.1, "{law}: {off:?}");
                seen[1] += 1;
                let (summary, _) = study(&scenario);
                let page = scenario.report(&summary).html();
                assert!(page.contains("no log-cholesky law is found with the mean and covariance"));
            }
        }
    }
    assert!(seen.iter().all(|seen| *seen > 0), "{seen:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Scenarios with little and much uncertainty, with faults of any probability: each alert is there exactly if the run table
    /// says so, and the page has it before everything else.
    #[test]
    fn alerts_are_what_the_tables_say(
        runs in 2..400_u64,
        spread in prop::sample::select(vec![0.01, 0.3, 1.0]),
        springs in prop::sample::select(vec![
            NORMAL.to_owned(),
            "failure_probability = 0.0".to_owned(),
            format!("{NORMAL}, failure_probability = 0.01"),
            "failure_probability = 1.0".to_owned(),
            "stroke_m = { law = \"normal\", sigma = 0.02 }, late_probability = 0.05, start_s = { law = \"uniform\", low = 0.0, high = 0.1 }".to_owned(),
        ]),
    ) {
        let scenario = ordinary(runs, spread, &springs);
        let (summary, tables) = study(&scenario);
        let table = tables[0].table().unwrap();
        let mut expected: Vec<(&str, String)> = Vec::new();
        let failed = table.failures().len() as u64;
        if failed > 0 {
            expected.push(("failed", format!("{failed} of {runs}")));
        }
        let outcomes = Quantity::of(scenario.separation()).filter(|q| !q.is_drawn());
        let shown = Quantity::behaviour().into_iter().chain(Quantity::parting());
        let shown: Vec<Quantity> = shown.collect();
        let succeeded = runs - failed;
        let few = shown.iter().filter(|q| {
            let n = q.in_table(&table).len() as u64;
            n > 0 && 2 * n < succeeded
        });
        let few: Vec<String> = few.map(|q| q.label().into_owned()).collect();
        if !few.is_empty() {
            expected.push(("few", few.len().to_string()));
        }
        for dispersed in scenario.dispersions().all() {
            let values = table.values(&dispersed.column).unwrap();
            if values.len() > 1 && values.iter().all(|x| *x == values[0]) {
                expected.push(("unmoved", dispersed.column.clone()));
            }
        }
        let heavy: Vec<String> = outcomes
            .filter(|q| shown.contains(q))
            .filter(|q| {
                let values = q.in_table(&table);
                let sample = SampleSummary::new(&values, Confidence::default());
                let [least, most] = [f64::min, f64::max].map(|f| values.iter().copied().reduce(f).unwrap_or(0.0));
                // Both bodies turn at 0.5 rad/s, of which rates of rounding are left.
                let size = match q.unit() {
                    "deg" => 1.0,
                    "rad/s" => 0.5,
                    "deg/s" => 0.5_f64.to_degrees(),
                    _ => 0.0,
                };
                let largest = least.abs().max(most.abs()).max(size);
                // Rounding has no tails.
                most - least > 1e-11 * largest && sample.kurtosis.is_some_and(|k| k > 10.0)
            })
            .map(|q| q.label().into_owned())
            .collect();
        if !heavy.is_empty() {
            expected.push(("heavy", heavy.len().to_string()));
        }
        for body in Body::BOTH {
            let entries = Entry::ALL.map(|entry| Quantity::entry(body, entry));
            let near = table.rows().filter(|row| {
                let [a, b, c, d, e, f] = entries.map(|entry| entry.in_row(row).unwrap());
                let matrix = InertiaMatrix::from_entries([a, b, c], [d, e, f]).unwrap();
                RealizabilityReport::of(matrix.matrix()).margin().unwrap() < 0.01
            });
            let near = near.count() as u64;
            prop_assert_eq!(near_boundary(&table, &entries.map(Quantity::column)), [near, runs]);
            if near as f64 > 0.001 * runs as f64 {
                expected.push(("near", format!("{near} {}", body.name())));
            }
        }
        // Roots within two deviations of zero.
        for (body, inertia, factor) in [("payload", 2000.0, 1.1), ("stage", 3000.0, 1.05)] {
            let second = [factor + 0.9 - 1.0, 1.9 - factor, 1.0 + factor - 0.9].map(|k: f64| 0.5 * inertia * k);
            let variance = spread * spread * inertia * 0.4;
            for (axis, k) in (1..).zip(second) {
                if k < 4.0 * variance {
                    expected.push(("folded", format!("{body} root_{axis}")));
                }
            }
        }
        let told = summary.head.alerts.iter().map(|alert| match alert {
            Alert::Failed { failed, runs, kinds, .. } => {
                assert_eq!(kinds.iter().map(|(_, count)| count).sum::<u64>(), *failed);
                ("failed", format!("{failed} of {runs}"))
            }
            Alert::Unmoved { column, probability, .. } => {
                assert_eq!(probability.is_some(), column.ends_with("_failure") || column.ends_with("_late"), "{column}");
                ("unmoved", column.clone())
            }
            Alert::FewValues { outcomes, runs, .. } => {
                assert!(outcomes.iter().all(|(label, n)| few.contains(label) && *n > 0 && 2 * n < *runs), "{outcomes:?}");
                assert_eq!(*runs, succeeded);
                ("few", outcomes.len().to_string())
            }
            Alert::HeavyTails { outcomes, .. } => {
                assert!(outcomes.iter().all(|(label, _)| heavy.contains(label)), "{outcomes:?} {heavy:?}");
                ("heavy", outcomes.len().to_string())
            }
            Alert::NearBoundary { near, body, .. } => ("near", format!("{near} {body}")),
            Alert::Folded(root) => ("folded", format!("{} {}", root.body, root.quantity)),
            Alert::Backwards { backwards, runs, .. } => ("backwards", format!("{backwards} of {runs}")),
            Alert::OffNominal(law) => ("off nominal", law.to_string()),
            Alert::OffAxis { angle_deg, .. } => ("off axis", angle_deg.to_string()),
            Alert::NominalFailed { why } => ("nominal", why.clone()),
            Alert::Unmatched(law) => ("unmatched", law.to_string()),
        });
        prop_assert_eq!(told.collect::<Vec<_>>(), expected);
        let written = serde_json::to_string(&summary).unwrap();
        let read: Summary = serde_json::from_str(&written).unwrap();
        prop_assert_eq!(&read.head.alerts, &summary.head.alerts);
        let page = scenario.report(&read).markdown();
        let place = page.find("Before you rely on the results");
        prop_assert_eq!(place.is_some(), !summary.head.alerts.is_empty());
        if let Some(place) = place {
            prop_assert!(place < page.find("What the payload does").unwrap());
        }
    }
    /// Means and deviations of each axis of a mass centre at will: only axes whose means are beyond their own deviations count.
    #[test]
    fn axes_of_a_mass_centre_count_alone(
        axes in prop::array::uniform3((
            prop_oneof![Just(0.0), -0.3..0.3_f64, -1e-5..1e-5_f64],
            prop_oneof![Just(1e-9), 1e-3..0.2_f64],
        )),
    ) {
        let base = ordinary(2, 0.01, NORMAL);
        let law = |(mean, sigma)| format!("{{ mean = {mean:?}, sigma = {sigma:?} }}");
        let centre: toml::Table =
            format!("mass_centre_m = [{}]", axes.map(law).join(", ")).parse().unwrap();
        let mut table: toml::Table = base.to_toml().parse().unwrap();
        table["payload"]["dispersion"].as_table_mut().unwrap().extend(centre);
        let scenario = Scenario::from_toml(&toml::to_string(&table).unwrap()).unwrap();
        let [mass, trace] = [3000.0, 2000.0 * (1.0 + 1.1 + 0.9)];
        let known = axes.iter().filter(|(mean, sigma)| mean.abs() > 3.0 * sigma);
        let squares: f64 = known.map(|(mean, _)| mean * mean).sum();
        let off = squares.sqrt() / f64::sqrt(0.5 * trace / mass);
        prop_assume!((off - 0.1).abs() > 1e-9);
        let laws = scenario.off_nominal();
        let told = laws.iter().find_map(|law| match law {
            OffNominal::Centre { change_m, .. } => Some(*change_m),
            OffNominal::Change { .. } | OffNominal::Value { .. } => None,
        });
        prop_assert_eq!(told, (off > 0.1).then(|| axes.map(|(mean, _)| mean)));
    }
}
