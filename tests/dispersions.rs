//! What is dispersed besides the inertias: drawn by its law, from its own stream, and put where it
//! belongs.

use gyradius_dispersion::ScalarLaw;
use gyradius_statistics::Moments;
use gyradius_study::{Column, Options, Quantity, Scenario, Study, Table};
use std::fs;

/// When a spring lets go, springs from 0.
fn release(spring: usize) -> Quantity {
    Quantity::of_column(&format!("spring_{}_release_s", spring + 1)).unwrap()
}

/// One model, so that it is quick.
fn base() -> String {
    let text = Scenario::peck_2003().unwrap().to_toml();
    let models = text.find("[[models]]").unwrap();
    let second = models + 1 + text[models + 1..].find("[[models]]").unwrap();
    let text = text[..second].replace("comparisons = []\n", "");
    format!("{text}[[models]]\nname = \"naive\"\nlaw = \"entrywise\"\nmatched_to = \"proposed\"\n")
}

/// The scenario with something put into the dispersion of a body, the springs, or at its end.
fn with(payload: &str, spring_1: &str, rest: &str) -> String {
    let mut text =
        base().replace("[payload.dispersion]\n", &format!("[payload.dispersion]\n{payload}\n"));
    let second = text.match_indices("[[springs]]").nth(1).unwrap().0;
    text.insert_str(second, &format!("[springs.dispersion]\n{spring_1}\n\n"));
    format!("{text}\n{rest}\n")
}

fn tables(text: &str, runs: u64) -> Vec<Table> {
    let scratch = tempfile::tempdir().unwrap();
    let scenario = Scenario::from_toml(text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let options = Options { out: Some(scratch.path().join("s")), ..Options::default() };
    let study = Study::run(&scenario.with_runs(runs).unwrap(), &options, &|_| {}).unwrap();
    study.tables().unwrap()
}

/// The columns of what else was drawn, which stand between these two.
fn drawn_columns(table: &Table) -> Vec<&str> {
    let names = table.columns().iter().map(Column::name);
    names
        .skip_while(|name| *name != "recompressed")
        .skip(1)
        .take_while(|name| *name != "clearance_note")
        .collect()
}

const EVERYTHING: [&str; 3] = [
    "mass_kg = { law = \"lognormal\", sigma = 100.0 }
     inertia_follows_mass = true
     mass_centre_m = [0.01, 0.01, { law = \"uniform\", low = -0.03, high = 0.03 }]
     position_m = 0.001
     velocity_m_per_s = { law = \"truncated-normal\", sigma = 0.001, low = -0.002, high = 0.002 }
     attitude_deg = 0.1
     angular_velocity_rad_per_s = { covariance = [[1e-6, 5e-7, 0.0], [5e-7, 1e-6, 0.0], [0.0, 0.0, 4e-6]] }",
    "stiffness_percent = 2
     stroke_percent = { sigma = 1.0, mean = -0.5 }
     friction_n = { law = \"uniform\", low = 0.0, high = 200.0 }
     line_of_action_deg = 0.5
     payload_point_m = 0.002
     stage_point_m = 0.002
     start_s = { law = \"lognormal\", mean = 0.01, sigma = 0.005 }
     late_probability = 0.3
     failure_probability = 0.02",
    "[stack.dispersion]
     attitude_deg = 1.0
     angular_velocity_rad_per_s = 0.002
     [[correlations]]
     between = [\"payload_mass_kg\", \"spring_1_friction_n\", \"spring_1_stroke_m\"]
     coefficient = 0.6",
];

fn everything() -> String {
    with(EVERYTHING[0], EVERYTHING[1], EVERYTHING[2])
}

/// Kolmogorov and Smirnov's distance times √n: above 2.23 once in ten thousand.
fn distance(law: &ScalarLaw, values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let gaps = sorted.iter().enumerate().map(|(i, x)| (law.cdf(*x) - (i as f64 + 0.5) / n).abs());
    gaps.fold(0.0, f64::max) * n.sqrt()
}

fn z_of_mean(law: &ScalarLaw, values: &[f64]) -> f64 {
    let n = values.len() as f64;
    (values.iter().sum::<f64>() / n - law.mean()) / law.deviation() * n.sqrt()
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let (ma, mb) = (Moments::new(a).unwrap(), Moments::new(b).unwrap());
    let sum: f64 = a.iter().zip(b).map(|(x, y)| (x - ma.mean()) * (y - mb.mean())).sum();
    sum / (a.len() as f64 - 1.0) / (ma.standard_deviation() * mb.standard_deviation())
}

/// Fisher's z of a correlation found, less that of the one expected, in its deviations.
fn z_of_correlation(found: f64, expected: f64, n: usize) -> f64 {
    (found.atanh() - expected.atanh()) * (n as f64 - 3.0).sqrt()
}

#[test]
fn every_quantity_follows_its_law() {
    const N: u64 = 4000;
    let tables = tables(&everything(), N);
    let normal = |mean, sigma| ScalarLaw::normal(mean, sigma).unwrap();
    let uniform = |low, high| ScalarLaw::uniform(low, high).unwrap();
    let mut laws = vec![
        ("payload_mass_kg".to_owned(), ScalarLaw::lognormal(1e4, 100.0).unwrap()),
        ("payload_mass_centre_1_m".to_owned(), normal(0.0, 0.01)),
        ("payload_mass_centre_2_m".to_owned(), normal(0.0, 0.01)),
        ("payload_mass_centre_3_m".to_owned(), uniform(-0.03, 0.03)),
        ("spring_1_stiffness_n_per_m".to_owned(), normal(1e5, 2e3)),
        ("spring_1_stroke_m".to_owned(), normal(0.0995, 0.001)),
        ("spring_1_friction_n".to_owned(), uniform(0.0, 200.0)),
        ("spring_1_line_of_action_1_deg".to_owned(), normal(0.0, 0.5)),
        ("spring_1_line_of_action_2_deg".to_owned(), normal(0.0, 0.5)),
    ];
    let velocity = ScalarLaw::truncated_normal(0.0, 0.001, -0.002, 0.002).unwrap();
    for (i, z) in [0.0, 0.0, 1.0].into_iter().enumerate() {
        let i1 = i + 1;
        laws.push((format!("payload_position_{i1}_m"), normal(z, 0.001)));
        laws.push((format!("payload_velocity_{i1}_m_per_s"), velocity.clone()));
        laws.push((format!("payload_attitude_{i1}_deg"), normal(0.0, 0.1)));
        let rate = normal(0.0, [1e-3, 1e-3, 2e-3][i]);
        laws.push((format!("payload_angular_velocity_{i1}_rad_per_s"), rate));
        laws.push((format!("stack_attitude_{i1}_deg"), normal(0.0, 1.0)));
        laws.push((format!("stack_angular_velocity_{i1}_rad_per_s"), normal(0.0, 0.002)));
        let point = normal([1.0, 1.0, -0.9][i], 0.002);
        laws.push((format!("spring_1_payload_point_{i1}_m"), point));
        let point = normal([1.0, 1.0, 0.9][i], 0.002);
        laws.push((format!("spring_1_stage_point_{i1}_m"), point));
    }
    for table in &tables {
        // And the start, late and failure, below.
        assert_eq!(drawn_columns(table).len(), laws.len() + 3);
        for (column, law) in &laws {
            let values = table.values(column).unwrap();
            assert_eq!(values.len() as u64, N);
            let (d, z) = (distance(law, &values), z_of_mean(law, &values));
            assert!(d < 2.23 && z.abs() < 4.0, "{} {column}: {d} {z}", table.model());
            // A law half a deviation away is told apart.
            let shifted: Vec<_> = values.iter().map(|x| x + 0.5 * law.deviation()).collect();
            assert!(distance(law, &shifted) > 2.23, "{column}");
        }
        let column = |name: &str| table.values(name).unwrap();
        for (name, p) in [("spring_1_late", 0.3), ("spring_1_failure", 0.02)] {
            let z = z_of_mean(&ScalarLaw::bernoulli(p).unwrap(), &column(name));
            assert!(z.abs() < 4.0, "{name}: {z}");
        }
        let late: Vec<bool> = column("spring_1_late").iter().map(|x| *x == 1.0).collect();
        let starts = column("spring_1_start_s");
        assert!(late.iter().zip(&starts).all(|(late, start)| *late == (*start > 0.0)));
        let starts: Vec<f64> = starts.into_iter().filter(|s| *s > 0.0).collect();
        let law = ScalarLaw::lognormal(0.01, 0.005).unwrap();
        assert!(distance(&law, &starts) < 2.23);

        // Correlations of the scores: Spearman's of the values is (6/π) asin(ρ/2), whatever the laws.
        let ranks = |name: &str| {
            let values = column(name);
            let mut order: Vec<usize> = (0..values.len()).collect();
            order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
            let mut ranks = vec![0.0; values.len()];
            order.into_iter().enumerate().for_each(|(rank, i)| ranks[i] = rank as f64);
            ranks
        };
        let names = ["payload_mass_kg", "spring_1_friction_n", "spring_1_stroke_m"];
        for (i, a) in names.iter().enumerate() {
            for b in &names[..i] {
                let found = correlation(&ranks(a), &ranks(b));
                let expected = 6.0 / std::f64::consts::PI * 0.3_f64.asin();
                // Spearman's varies a little more than Pearson's of normal values.
                let z = z_of_correlation(found, expected, N as usize) / 1.06;
                assert!(z.abs() < 4.0, "{a} {b}: {found}");
            }
            let found = correlation(&ranks(a), &ranks("payload_position_1_m"));
            assert!(z_of_correlation(found, 0.0, N as usize).abs() < 4.0, "{a}: {found}");
        }
        let rate = |i: usize| column(&format!("payload_angular_velocity_{i}_rad_per_s"));
        let found = correlation(&rate(1), &rate(2));
        assert!(z_of_correlation(found, 0.5, N as usize).abs() < 4.0, "{found}");
        assert!(z_of_correlation(found, 0.3, N as usize).abs() > 4.0, "{found}");
    }
    // Models draw apart from each other.
    let [a, b] = [0, 1].map(|i| tables[i].values("payload_mass_kg").unwrap());
    assert!(z_of_correlation(correlation(&a, &b), 0.0, N as usize).abs() < 4.0);
}

/// Adding a quantity, or correlating others, leaves what is drawn of the rest as it is.
#[test]
fn quantities_have_streams_of_their_own() {
    let parts: Vec<(usize, &str)> = EVERYTHING[..2]
        .iter()
        .enumerate()
        .flat_map(|(i, part)| part.lines().map(move |line| (i, line.trim())))
        .filter(|(_, line)| !line.starts_with("late_prob") && !line.starts_with("inertia"))
        .collect();
    let scenario = |lines: &[(usize, &str)], rest: &str| {
        let of = |place| {
            let lines = lines.iter().filter(|(i, _)| *i == place).map(|(_, line)| *line);
            lines.collect::<Vec<_>>().join("\n")
        };
        with(&of(0), &of(1), rest)
    };
    let none = tables(&base(), 20);
    let whole = tables(&scenario(&parts, ""), 20);
    let same_bits = |a: &Table, b: &Table, column: &str| {
        let [a, b] = [a, b].map(|t| t.values(column).unwrap());
        assert!(a.iter().zip(&b).all(|(a, b)| a.to_bits() == b.to_bits()), "{column}");
    };
    for part in &parts {
        let alone = tables(&scenario(std::slice::from_ref(part), ""), 20);
        for ((alone, whole), none) in alone.iter().zip(&whole).zip(&none) {
            assert!(!drawn_columns(alone).is_empty() && drawn_columns(none).is_empty());
            for column in drawn_columns(alone) {
                same_bits(alone, whole, column);
            }
            for q in &Quantity::ALL[..12] {
                assert_eq!(q.in_table(alone), q.in_table(none), "{part:?}: {q:?}");
            }
            let moved = Quantity::SpinRate.in_table(alone) != Quantity::SpinRate.in_table(none);
            // One failure in fifty may not have happened in twenty runs.
            assert!(moved || part.1.starts_with("failure"), "{part:?} does nothing");
        }
    }
    let correlated = EVERYTHING[2].lines().skip(3).collect::<Vec<_>>().join("\n");
    for (table, other) in whole.iter().zip(&tables(&scenario(&parts, &correlated), 20)) {
        for column in drawn_columns(table) {
            let follows = ["spring_1_friction_n", "spring_1_stroke_m"].contains(&column);
            if follows {
                assert_ne!(table.values(column), other.values(column));
            } else {
                same_bits(table, other, column);
            }
        }
    }
}

/// A negative mass or stiffness, of a wide Gaussian: a row with its reason.
#[test]
fn impossible_draws_are_failed_rows() {
    let text = with("mass_percent = 60.0", "stiffness_n_per_m = 8e4", "");
    for table in tables(&text, 400) {
        let (mass, stiffness) = (
            table.values("payload_mass_kg").unwrap(),
            table.values("spring_1_stiffness_n_per_m").unwrap(),
        );
        let mut failed = 0;
        for (i, row) in table.rows().enumerate() {
            if mass[i] <= 0.0 {
                assert!(row.status().starts_with("payload: mass = -"), "{}", row.status());
                assert!(row.status().contains("kg: it must be positive"), "{}", row.status());
            } else if stiffness[i] <= 0.0 {
                assert!(row.status().starts_with("spring 1: stiffness = -"), "{}", row.status());
            } else {
                assert_eq!(row.status(), "ok");
            }
            failed += u32::from(row.status() != "ok");
        }
        assert!((20..150).contains(&failed), "{failed}");
    }
    // Springs that fail, all of them, are a run in which nothing separates.
    let fail = "[springs.dispersion]\nfailure_probability = 1.0\n\n";
    let text = base();
    let at: Vec<usize> = text.match_indices("[[springs]]").map(|m| m.0).collect();
    let mut text = text;
    for i in at.iter().skip(1).rev() {
        text.insert_str(*i, fail);
    }
    let models = text.find("[[models]]").unwrap();
    let text = format!("{}{fail}{}", &text[..models], &text[models..]);
    for row in tables(&text, 3).iter().flat_map(Table::rows) {
        assert!(row.status().starts_with("none of the springs ever pushes"), "{}", row.status());
    }
}

/// A spring that always fails is one that is not there.
#[test]
fn a_failed_spring_is_none() {
    let failed = tables(&with("", "failure_probability = 1.0", ""), 10);
    let text = base();
    let at: Vec<usize> = text.match_indices("[[springs]]").map(|m| m.0).collect();
    let without = tables(&format!("{}{}", &text[..at[0]], &text[at[1]..]), 10);
    for (a, b) in failed.iter().zip(&without) {
        for q in [Quantity::SpinRate, Quantity::RelativeSpeed, Quantity::ReleaseTime] {
            for (a, b) in q.in_table(a).iter().zip(q.in_table(b)) {
                assert!((a / b - 1.0).abs() < 1e-11, "{q:?}: {a} {b}");
            }
        }
        // It lets go at no time and in no order, for a time of zero would be one.
        assert!(release(0).in_table(a).is_empty());
        assert_eq!(release(1).in_table(a).len(), 10);
        assert!(a.rows().all(|row| !row.text("release_order").unwrap().contains('1')));
    }
}

/// The table, the summary and the report show what was dispersed; without it they do not.
#[test]
fn what_was_dispersed_is_shown() {
    let scratch = tempfile::tempdir().unwrap();
    let run = |text: &str, name: &str| {
        let options = Options { out: Some(scratch.path().join(name)), ..Options::default() };
        let scenario = Scenario::from_toml(text).unwrap().with_runs(30).unwrap();
        let study = Study::run(&scenario, &options, &|_| {}).unwrap();
        let read = |file: &str| fs::read_to_string(study.folder().join(file)).unwrap();
        [read("summary.json"), read("report.html"), read("scenario.toml")]
    };
    let [summary, report, resolved] = run(&everything(), "everything");
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let first = &summary["models"][0]["dispersed"][0];
    assert_eq!(first["quantity"], "payload_mass_kg");
    assert_eq!(first["law"], "lognormal");
    assert_eq!(first["law_deviation"], 100.0);
    assert!((first["mean"].as_f64().unwrap() - 1e4).abs() < 100.0);
    assert!(report.contains("What else was dispersed") && report.contains("spring_1_failure"));
    // The resolved scenario says it all again.
    let again = run(&resolved, "again");
    assert_eq!(again[2], resolved);
    let [summary, report, _] = run(&base(), "nothing");
    assert!(!summary.contains("\"dispersed\"") && !report.contains("What else was dispersed"));
}

#[test]
fn bad_dispersions_are_named() {
    let springs = "springs[1].dispersion";
    let cases = [
        (["mass_kg = -1.0", "", ""], "payload.dispersion.mass_kg: -1.0".to_owned()),
        (["mass_kg = nan", "", ""], "payload.dispersion.mass_kg: NaN".to_owned()),
        (
            ["mass_kg = 1.0\nmass_percent = 1.0", "", ""],
            "payload.dispersion.mass_percent: there is payload.dispersion.mass_kg already".to_owned(),
        ),
        (
            ["mass_kg = { law = \"uniform\", sigma = 1.0 }", "", ""],
            "payload.dispersion.mass_kg.sigma: law = \"uniform\" takes low, high, not sigma".to_owned(),
        ),
        (
            ["mass_kg = { law = \"uniform\", low = 1.0 }", "", ""],
            "payload.dispersion.mass_kg.high: missing: law = \"uniform\" needs high".to_owned(),
        ),
        (
            ["mass_kg = { law = \"uniform\", low = 1.0, high = 0.5 }", "", ""],
            "payload.dispersion.mass_kg.high: 0.5: it must not be below low".to_owned(),
        ),
        (
            ["inertia_follows_mass = true", "", ""],
            "payload.dispersion.inertia_follows_mass: the mass is not".to_owned(),
        ),
        (
            ["position_m = [1.0, 2.0]", "", ""],
            "payload.dispersion.position_m: 2 laws: it must be one for all components or 3".to_owned(),
        ),
        (
            ["position_m = [1.0, 2.0, -3.0]", "", ""],
            "payload.dispersion.position_m[3]: -3.0".to_owned(),
        ),
        (
            ["position_m = { covariance = [[1, 0, 0], [0, -1, 0], [0, 0, 1]] }", "", ""],
            "payload.dispersion.position_m.covariance: entry (2, 2) = -1.0".to_owned(),
        ),
        (
            ["position_m = { covariance = [[1, 0.5, 0], [0.4, 1, 0], [0, 0, 1]] }", "", ""],
            "payload.dispersion.position_m.covariance: entries (2, 1) = 0.4 and (1, 2) = 0.5".to_owned(),
        ),
        (
            ["position_m = { covariance = [[1, 2, 0], [2, 1, 0], [0, 0, 1]] }", "", ""],
            "payload.dispersion.position_m.covariance: entry (1, 2): it is larger".to_owned(),
        ),
        (
            ["position_m = { covariance = [[1, 0, 0], [0, 1, 0], [0, 0, 1]], sigma = 1 }", "", ""],
            "payload.dispersion.position_m.covariance: a covariance is for the three components of a vector"
                .to_owned(),
        ),
        (["", "friction_n = 5.0", ""], format!("{springs}.friction_n: at least half of the draws")),
        (["", "stroke_m = inf", ""], format!("{springs}.stroke_m: inf")),
        (["", "late_probability = 0.1", ""], format!("{springs}.late_probability: it needs start_s")),
        (["", "failure_probability = 2.0", ""], format!("{springs}.failure_probability: probability = 2.0")),
        (
            ["", "line_of_action_deg = { covariance = [[1, 0, 0], [0, 1, 0], [0, 0, 1]] }", ""],
            format!("{springs}.line_of_action_deg.covariance: it is for vectors of three"),
        ),
        (
            ["mass_kg = 1.0", "", "[[correlations]]\nbetween = [\"payload_mass\"]\ncoefficient = 0.1"],
            "correlations[1].between: \"payload_mass\" is not dispersed: the dispersion of payload, stage, stack and springs names payload_mass_kg".to_owned(),
        ),
        (
            ["", "", "[[correlations]]\nbetween = [\"a\", \"b\"]\ncoefficient = 0.1"],
            "correlations[1].between: \"a\" is not dispersed: the dispersion of payload, stage, stack and springs names payload_root_1".to_owned(),
        ),
        (
            ["mass_kg = 1.0", "", "[[correlations]]\nbetween = [\"payload_mass_kg\"]\ncoefficient = 0.1"],
            "correlations[1].between: [\"payload_mass_kg\"]: it must name at least two".to_owned(),
        ),
        (
            ["position_m = 1.0", "", "[[correlations]]\nbetween = [\"payload_position_1_m\", \"payload_position_2_m\"]\ncoefficient = 1.5"],
            "correlations[1].coefficient: \"payload_position_1_m\" and \"payload_position_2_m\": coefficient = 1.5".to_owned(),
        ),
        (
            ["position_m = 1.0", "", "[[correlations]]\nbetween = [\"payload_position_1_m\", \"payload_position_2_m\", \"payload_position_3_m\"]\ncoefficient = -0.6"],
            "correlations[1].coefficient: \"payload_position_".to_owned(),
        ),
        (
            ["position_m = { covariance = [[1, 0.5, 0], [0.5, 1, 0], [0, 0, 1]] }", "", "[[correlations]]\nbetween = [\"payload_position_1_m\", \"payload_position_2_m\"]\ncoefficient = 0.5"],
            "correlations[1].between: \"payload_position_1_m\" and \"payload_position_2_m\": these two have been".to_owned(),
        ),
    ];
    for ([payload, spring, rest], expected) in cases {
        let error = Scenario::from_toml(&with(payload, spring, rest)).unwrap_err().to_string();
        assert!(error.starts_with(&expected), "{error}\nexpected {expected}");
    }
    for (wrong, expected) in [
        ("mass_kg = { law = \"gauss\", sigma = 1.0 }", "gauss"),
        ("mass_kg = { sgima = 1.0 }", "unknown field `sgima`"),
        ("mass_kg = \"1 %\"", "a standard deviation, or a table"),
        ("position_m = [[1.0]]", "a standard deviation, or a table"),
    ] {
        let error = Scenario::from_toml(&with(wrong, "", "")).unwrap_err().to_string();
        assert!(error.contains(expected) && error.contains("line"), "{error}");
    }
}

/// The pads of the last spring are its release length apart as it lets go, wherever mass centres are: the
/// outlines stay with the structure.
#[test]
fn outlines_stay_with_the_structure() {
    let pads = |z: f64| {
        format!(
            "{{ points_m = [[1.0, 1.0, {z:?}], [-1.0, 1.0, {z:?}], [-1.0, -1.0, {z:?}], [1.0, -1.0, {z:?}]] }}"
        )
    };
    let clearance =
        format!("[clearance]\npayload = [{}]\nstage = [{}]\n\n[payload]", pads(-0.9), pads(0.9));
    let text = with("mass_centre_m = 0.05", "", "").replacen("[payload]", &clearance, 1).replacen(
        "[stage.dispersion]",
        "[stage.dispersion]\nmass_centre_m = 0.1",
        1,
    );
    for table in tables(&text, 300) {
        let values = |q: Quantity| q.in_table(&table);
        let (clearance, when) = (values(Quantity::Clearance), values(Quantity::ClearanceTime));
        assert_eq!(clearance.len(), 300);
        for ((clearance, when), release) in
            clearance.iter().zip(&when).zip(&values(Quantity::ReleaseTime))
        {
            assert!((clearance - 0.3).abs() < 1e-9, "{clearance} m");
            assert!((when - release).abs() < 1e-9);
        }
    }
}
