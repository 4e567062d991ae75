//! Laws of single roots and gyration lengths that are far from the nominal ones, of random bodies.

use super::tests::{NORMAL, ordinary};
use crate::{LawFile, OffNominal, Scenario};
use gyradius_inertia::PrincipalAxes;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use proptest::prelude::*;

/// The ways in which a body can have three roots or lengths: as a dispersion says them, and as a whole law does.
const WAYS: [&str; 5] = ["laws", "changes", "samples", "whole roots", "whole lengths"];

/// A scenario with a payload of such second moments about such axes.
fn body(roots: [f64; 3], turn: [f64; 3]) -> toml::Table {
    let second = Matrix3::from_diagonal(&Vector3::from(roots.map(|root| root * root)));
    let turn = UnitQuaternion::from_scaled_axis(Vector3::from(turn)).to_rotation_matrix();
    let second = turn * second * turn.transpose();
    let inertia = Matrix3::identity() * second.trace() - second;
    let rows: [[f64; 3]; 3] =
        [0, 1, 2].map(|i| [0, 1, 2].map(|j| 0.5 * (inertia[(i, j)] + inertia[(j, i)])));
    let mut table: toml::Table = ordinary(2, 0.01, NORMAL).to_toml().parse().unwrap();
    table["payload"]["inertia_kg_m2"] = toml::Value::try_from(rows).unwrap();
    table
}

fn read(table: &toml::Table) -> Scenario {
    let text = toml::to_string(table).unwrap();
    Scenario::from_toml(&text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// The same with roots that have these means, in one of the ways.
fn with(
    mut table: toml::Table,
    way: &str,
    nominal: [f64; 3],
    means: [f64; 3],
    spread: f64,
) -> toml::Table {
    let one = if way == "whole lengths" || way == "changes" { 3000_f64.sqrt() } else { 1.0 };
    let law = |i: usize| {
        let mean = if way == "changes" { means[i] - nominal[i] } else { means[i] };
        format!("{{ mean = {:?}, sigma = {:?} }}", mean / one, spread * means[i] / one)
    };
    let laws = format!("[{}, {}, {}]", law(0), law(1), law(2));
    let samples = [1.0 - spread, 1.0 + spread].map(|factor| means.map(|mean| factor * mean));
    let payload = table["payload"].as_table_mut().unwrap();
    let of_whole = |of: &str| {
        format!(
            "[law]\nmass_kg = {{ mean = 3000.0, sigma = 1.0 }}\nmass_centre_m = [0.0, 0.0, 0.0]\n[law.inertia.of.{of}]\nlaws = {laws}\naxes = {{ law = \"uniform\" }}"
        )
        .replace("[0.0, 0.0, 0.0]", "[{ mean = 0.0, sigma = 0.0 }, { mean = 0.0, sigma = 0.0 }, { mean = 0.0, sigma = 0.0 }]")
    };
    let said = match way {
        "laws" => format!(
            "[dispersion]\naxes = \"fixed\"\nroots = \"independent\"\nroot_second_moment_laws_sqrt_kg_m = {laws}"
        ),
        "changes" => format!("[dispersion]\naxes = \"fixed\"\ngyration_lengths_m = {laws}"),
        "samples" => format!(
            "[dispersion]\naxes = \"fixed\"\nroots = \"empirical\"\nroot_second_moment_samples_sqrt_kg_m = {samples:?}"
        ),
        "whole roots" => of_whole("roots"),
        "whole lengths" => of_whole("gyration-lengths"),
        _ => unreachable!(),
    };
    payload.remove("dispersion");
    payload.extend(said.parse::<toml::Table>().unwrap_or_else(|error| panic!("{error}\n{said}")));
    table
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    /// Nothing is told of laws about the nominal values, in any order where a law has axes of its own; of one that is ten times too large or
    /// too small, that one.
    #[test]
    fn one_root_that_slipped_is_told(
        way in 0..WAYS.len(), roots in prop::array::uniform3((-1.0..1.5_f64).prop_map(|x| 10_f64.powf(x))), like in 0..3_usize,
        turn in prop::array::uniform3(-2.0..2.0_f64), order in 0..6_usize, spread in 0.0..0.05_f64, off in prop::array::uniform3(-0.4..0.5_f64),
        slipped in 0..3_usize, by in 11.0..15.0_f64, less in any::<bool>(),
    ) {
        // Bodies with two like axes, and three.
        let roots = [roots[0], if like > 0 { roots[0] } else { roots[1] }, if like > 1 { roots[0] } else { roots[2] }];
        let base = body(roots, turn);
        let nominal = read(&base).payload().nominal().second_moments().roots().values();
        let way = WAYS[way];
        let is_whole = way.starts_with("whole");
        let (order, _) = PrincipalAxes::ORDERS[if is_whole { order } else { 0 }];
        let means = [0, 1, 2].map(|i| nominal[order[i]] * (1.0 + off[i]));
        let about = read(&with(base.clone(), way, nominal, means, spread));
        prop_assert_eq!(about.off_nominal(), [], "{} {:?} {:?}", way, nominal, means);
        let mut means = [0, 1, 2].map(|i| nominal[order[i]] * (1.0 + 0.04 * off[i]));
        means[slipped] *= if less { 1.0 / by } else { by };
        let far = read(&with(base, way, nominal, means, spread)).off_nominal();
        let [OffNominal::Value { quantity, nominal: at, mean }] = &far[..] else { panic!("{far:?} {way} {nominal:?} {means:?}") };
        let ratio = mean / at;
        prop_assert!(if less { ratio < 0.1 } else { ratio > 10.0 }, "{quantity} {ratio}");
        let lengths = way == "changes" || way == "whole lengths";
        let [called, unit] = if lengths { ["gyration_length", "m"] } else { ["root", "sqrt_kg_m"] };
        prop_assert!(quantity.starts_with(&format!("payload_{called}_")) && quantity.ends_with(unit), "{quantity}");
        if !is_whole {
            prop_assert_eq!(quantity, &format!("payload_{called}_{}_{unit}", slipped + 1));
            let one = if lengths { 3000_f64.sqrt() } else { 1.0 };
            prop_assert!((at * one / nominal[slipped] - 1.0).abs() < 1e-9 && (mean * one / means[slipped] - 1.0).abs() < 2e-3);
        }
    }

    /// A law without a scenario has nothing beside it from which it could be far, however its axes scatter.
    #[test]
    fn a_law_alone_is_far_from_nothing(
        roots in prop::array::uniform3((-1.0..2.0_f64).prop_map(|x| 10_f64.powf(x))), spread in 0.0..0.4_f64, whole in 3..5_usize,
    ) {
        let table = with(body([1.0; 3], [0.0; 3]), WAYS[whole], [1.0; 3], roots, spread);
        let law = toml::Table::from_iter([("law".to_owned(), table["payload"]["law"].clone())]);
        let file = toml::Table::from_iter([("payload".to_owned(), law.into())]);
        let file = LawFile::from_toml(&toml::to_string(&file).unwrap()).unwrap();
        prop_assert_eq!(file.scenario().off_nominal(), []);
    }
}

/// Of a plate a root is zero but for rounding, and its law may be about zero.
#[test]
fn plates_are_told_nothing() {
    for turn in 0..40 {
        let turn = [0.1 * f64::from(turn), -0.3, 0.07 * f64::from(turn)];
        let base = body([5.0, 7.0, 0.0], turn);
        let nominal = read(&base).payload().nominal().second_moments().roots().values();
        for sigma in [0.0, 0.001, 0.5] {
            let means = nominal.map(|root| if root > 1.0 { root } else { 0.0 });
            let mut table = with(base.clone(), "laws", nominal, means, 0.01);
            let laws = table["payload"]["dispersion"]["root_second_moment_laws_sqrt_kg_m"]
                .as_array_mut()
                .unwrap();
            for (law, mean) in laws.iter_mut().zip(means) {
                law.as_table_mut().unwrap()["sigma"] = (sigma + 0.01 * mean).into();
            }
            let told = read(&table).off_nominal();
            assert!(told.is_empty(), "{told:?} {nominal:?}");
        }
    }
}
