//! Laws of the value itself where a scenario takes laws of changes.

use super::{
    Alert,
    tests::{ordinary, study},
};
use crate::{OffNominal, Scenario, subject::Subject};
use gyradius_report::Text;
use proptest::prelude::*;

/// The table of a dispersion, a key in it, the component if it is of a vector, the column, the nominal value, and that in the unit of the key.
type Number = (&'static str, &'static str, Option<usize>, &'static str, f64, f64);

/// Numbers of the base scenario with nominal values of all kinds.
const NUMBERS: &[Number] = &[
    ("payload", "mass_kg", None, "payload_mass_kg", 3000.0, 3000.0),
    ("stage", "mass_percent", None, "stage_mass_kg", 2000.0, 100.0),
    ("payload", "position_m", Some(2), "payload_position_3_m", 1.0, 1.0),
    ("stage", "position_m", Some(2), "stage_position_3_m", -1.0, -1.0),
    ("payload", "velocity_m_per_s", Some(0), "payload_velocity_1_m_per_s", 1e-3, 1e-3),
    (
        "stage",
        "angular_velocity_rad_per_s",
        Some(2),
        "stage_angular_velocity_3_rad_per_s",
        0.5,
        0.5,
    ),
    ("springs", "stiffness_n_per_m", None, "spring_1_stiffness_n_per_m", 2e4, 2e4),
    ("springs", "stiffness_percent", None, "spring_1_stiffness_n_per_m", 2e4, 100.0),
    ("springs", "stroke_m", None, "spring_1_stroke_m", 0.05, 0.05),
    ("springs", "stroke_percent", None, "spring_1_stroke_m", 0.05, 100.0),
    ("springs", "friction_n", None, "spring_1_friction_n", 12.0, 12.0),
    ("springs", "start_s", None, "spring_1_start_s", 0.03, 0.03),
    ("springs", "payload_point_m", Some(0), "spring_1_payload_point_1_m", 0.49, 0.49),
    ("springs", "stage_point_m", Some(2), "spring_1_stage_point_3_m", 0.9, 0.9),
];

/// The scenario with a law of one number.
fn with(number: &Number, law: &str) -> Scenario {
    let mut table: toml::Table = ordinary(2, 0.01, "").to_toml().parse().unwrap();
    let speed = toml::Value::from(vec![1e-3, 0.0, 0.0]);
    table["payload"].as_table_mut().unwrap().insert("velocity_m_per_s".to_owned(), speed);
    let spring = table["springs"].as_array_mut().unwrap()[0].as_table_mut().unwrap();
    spring.insert("friction_n".to_owned(), 12.0.into());
    spring.insert("start_s".to_owned(), 0.03.into());
    let law: toml::Table = format!("law = {law}").parse().unwrap();
    let (place, key, component, ..) = *number;
    if table.remove("runs").is_some() {
        table.insert("vehicles".to_owned(), 2.into());
        table.insert("flights".to_owned(), 2.into());
    }
    let law = match component {
        None => law["law"].clone(),
        Some(i) => {
            let mut each = vec![toml::Value::from(0.0); 3];
            each[i] = law["law"].clone();
            each.into()
        }
    };
    let of = if place == "springs" {
        &mut table["springs"].as_array_mut().unwrap()[0]
    } else {
        &mut table[place]
    };
    of["dispersion"].as_table_mut().unwrap().insert(key.to_owned(), law);
    let text = toml::to_string(&table).unwrap();
    Scenario::from_toml(&text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// A law of a kind about a middle, so wide.
fn law(kind: usize, middle: f64, half: f64) -> String {
    let [low, high] = [middle - half, middle + half];
    match kind {
        0 => format!("{{ law = \"uniform\", low = {low:?}, high = {high:?} }}"),
        1 => format!("{{ mean = {middle:?}, sigma = {half:?}, sigmas = 3 }}"),
        2 => {
            format!("{{ law = \"triangular\", low = {low:?}, mode = {middle:?}, high = {high:?} }}")
        }
        3 => format!(
            "{{ law = \"truncated-normal\", mean = {middle:?}, sigma = {half:?}, low = {low:?}, high = {high:?} }}"
        ),
        4 => {
            format!("{{ law = \"beta\", low = {low:?}, high = {high:?}, alpha = 2.0, beta = 3.0 }}")
        }
        5 => format!("{{ law = \"weibull\", low = {low:?}, scale = {half:?}, shape = 2.0 }}"),
        6 => {
            format!("{{ law = \"samples\", samples = [{low:?}, {middle:?}, {high:?}, {high:?}] }}")
        }
        7 => format!("{{ law = \"lognormal\", mean = {middle:?}, sigma = {half:?} }}"),
        // From the nominal value on, as it is read.
        8 => format!("{{ law = \"weibull\", scale = {middle:?}, shape = 20.0 }}"),
        _ => unreachable!(),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    /// Whatever the number and the law: one about the nominal value in the place of one of the change is told, with what to write instead, which
    /// has the same shape about the nominal value, is drawn for the same, and is not told. Nor is a law about no change, however wide.
    #[test]
    fn a_law_of_the_value_itself_is_told(
        which in 0..NUMBERS.len(), kind in 0..9_usize, half in 1e-3..0.24_f64, off in -0.05..0.05_f64, wide in 0.0..0.9_f64,
        drawn in prop::sample::select(vec!["", ", drawn = \"flight\"", ", drawn = \"vehicle\""]),
    ) {
        let number = &NUMBERS[which];
        let (.., column, nominal, in_unit) = *number;
        // A lognormal law is about positive values alone, and a Weibull law from zero on has them.
        let kind = if nominal < 0.0 { kind % 7 } else { kind };
        let (middle, half) = (in_unit * (1.0 + off), half * in_unit.abs());
        let slipped = with(number, &law(kind, middle, half).replace(" }", &format!("{drawn} }}")));
        let told = slipped.off_nominal();
        let [OffNominal::Change { quantity, nominal: at, change, instead: Some(instead) }] = &told[..] else {
            panic!("{told:?}");
        };
        let found = |scenario: &Scenario| {
            let all = scenario.dispersions().all().to_vec();
            let found = all.into_iter().find(|d| d.column == column).unwrap();
            (found.law, found.each)
        };
        let ((given, each), scale) = (found(&slipped), nominal.abs());
        prop_assert_eq!((quantity.as_str(), *at), (column, nominal));
        prop_assert!((given.mean() - nominal - change).abs() < 1e-12 * scale);
        let (key, written) = instead.split_once(" = ").unwrap();
        prop_assert!(key.contains(number.1) && key.ends_with(']') == number.2.is_some(), "{}", instead);
        let meant = with(number, written);
        let (law_meant, each_meant) = found(&meant);
        prop_assert_eq!(each_meant, each, "{}", instead);
        prop_assert!((law_meant.mean() + nominal - given.mean()).abs() < 1e-9 * scale, "{}", instead);
        prop_assert!((law_meant.deviation() - given.deviation()).abs() < 1e-9 * scale, "{}", instead);
        prop_assert!(written.len() < 160, "{}", instead);
        // It can be copied from the page, hyphens and all.
        let alert = Alert::OffNominal(told[0].clone());
        let text = alert.text(std::slice::from_ref(&alert)).unwrap();
        prop_assert_eq!(text, Text::default().strong(told[0].title()).plain(format!(": {}", told[0]).strip_suffix(&**instead).unwrap()).code(&**instead));
        prop_assert_eq!(meant.off_nominal(), []);
        let about_no_change = with(number, &law(kind % 7, 0.0, wide * in_unit.abs()));
        prop_assert_eq!(about_no_change.off_nominal(), []);
    }
}

/// What to write is told of short laws alone: of many samples it would be a page of numbers.
#[test]
fn long_laws_are_not_written_out() {
    for count in [1, 10, 100, 10_000] {
        let samples: Vec<String> =
            (0..count).map(|i| format!("{:?}", 3000.0 + f64::from(i % 7))).collect();
        let law = format!("{{ law = \"samples\", samples = [{}] }}", samples.join(", "));
        let told = with(&NUMBERS[0], &law).off_nominal();
        let [OffNominal::Change { instead, .. }] = &told[..] else { panic!("{told:?}") };
        assert_eq!(instead.is_some(), count <= 10, "{instead:?}");
        assert!(told[0].to_string().len() < 600, "{}", told[0]);
    }
}

/// Lengths, which have no column, and a page that tells it.
#[test]
fn lengths_and_pages_tell_it() {
    let base = ordinary(2, 0.01, "");
    let roots = base.stage().nominal().second_moments().roots().values();
    let lengths = roots.map(|root| root / 2000_f64.sqrt());
    for told in 0..8 {
        let mut table: toml::Table = base.to_toml().parse().unwrap();
        let laws = (0..3).map(|i| {
            let mean = if told >> i & 1 == 1 { lengths[i] } else { 0.0 };
            let law = [("mean".to_owned(), mean.into()), ("sigma".to_owned(), 0.01.into())];
            toml::Value::from(toml::Table::from_iter(law))
        });
        let laws: Vec<toml::Value> = laws.collect();
        let dispersion = table["stage"]["dispersion"].as_table_mut().unwrap();
        dispersion.remove("root_second_moment_variance_kg_m2");
        dispersion.remove("roots");
        dispersion.insert("gyration_lengths_m".to_owned(), laws.into());
        let scenario = Scenario::from_toml(&toml::to_string(&table).unwrap()).unwrap();
        let found = scenario.off_nominal();
        let names: Vec<String> = found
            .iter()
            .map(|law| match law {
                OffNominal::Change { quantity, nominal, change, instead: None } => {
                    assert!((nominal - change).abs() < 1e-12);
                    quantity.clone()
                }
                other => panic!("{other}"),
            })
            .collect();
        let expected: Vec<String> = (0..3)
            .filter(|i| told >> i & 1 == 1)
            .map(|i| format!("stage_gyration_length_{}_m", i + 1))
            .collect();
        assert_eq!(names, expected);
        let page = scenario.report(&study(&scenario).0).html();
        assert_eq!(page.matches("may be meant of the value itself").count(), expected.len());
    }
}
