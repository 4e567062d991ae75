//! Rates, momenta and energies that cancel to rounding: nothing is told of their spread.

use super::{Alert, tests::study};
use crate::{Scenario, quantity::Quantity, subject::Subject};
use gyradius_campaign::Table;
use gyradius_statistics::Survey;
use proptest::prelude::*;
use std::fmt::Write;

/// Bodies between springs in a ring, which turn nothing, `away` from the origin, all of it turning at a rate and standing askew; the
/// first spring has a stroke that is uncertain by `uneven`, m.
fn ring(springs: usize, away: [f64; 3], rate: f64, uneven: f64) -> Scenario {
    let body = |name: &str, mass: f64, place: f64, moments: [f64; 3], more: &str| {
        let [x, y, z] = away;
        let [a, b, c] = moments;
        format!(
            "[{name}]\nmass_kg = {mass:?}\ninertia_kg_m2 = [[{a:?}, 0, 0], [0, {b:?}, 0], [0, 0, {c:?}]]\n\
             position_m = [{x:?}, {y:?}, {:?}]\nangular_velocity_rad_per_s = [0, 0, {rate:?}]\n[{name}.dispersion]\n\
             root_second_moment_variance_kg_m2 = [0.01, 0.01, 0.01]\naxes = \"fixed\"\n{more}\n",
            z + place
        )
    };
    let mut text = format!(
        "name = \"ring\"\nruns = 200\n{}{}[stack.dispersion]\nattitude_deg = 30.0\n",
        body("payload", 500.0, 1.0, [120.0, 110.0, 90.0], "mass_kg = 5.0"),
        body("stage", 2000.0, -1.0, [3000.0, 3000.0, 900.0], "")
    );
    for spring in 0..springs {
        let (sin, cos) = (std::f64::consts::TAU * spring as f64 / springs as f64).sin_cos();
        let (x, y) = (0.4 * cos, 0.4 * sin);
        write!(
            text,
            "[[springs]]\nstiffness_n_per_m = 20000.0\nstroke_m = 0.1\npayload_point_m = [{x:?}, {y:?}, -0.9]\n\
             stage_point_m = [{x:?}, {y:?}, 0.9]\n"
        )
        .unwrap();
        if spring == 0 && uneven > 0.0 {
            writeln!(text, "[springs.dispersion]\nstroke_m = {uneven:?}").unwrap();
        }
    }
    text += "[[models]]\nname = \"own\"\nlaw = \"principal\"\naxes = \"whole-sphere\"\n\
             [[models]]\nname = \"naive\"\nlaw = \"entrywise\"\nmatched_to = \"own\"\n\
             [[comparisons]]\ntitle = \"c\"\nphysical = \"own\"\nnaive = \"naive\"\n";
    Scenario::from_toml(&text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

const RATES: [Quantity; 6] = [
    Quantity::PayloadTipOff1,
    Quantity::PayloadTipOff2,
    Quantity::PayloadTipOff3,
    Quantity::StageTipOff1,
    Quantity::StageTipOff2,
    Quantity::StageTipOff3,
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// However many springs, wherever the origin is and however fast all of it turns: rates of rounding have no heavy tails, drivers or
    /// ratios of deviations. A stroke that is uncertain by a thousandth makes rates that have a spread.
    #[test]
    fn rates_of_rounding_do_not_vary(
        springs in 3..7_usize,
        away in prop_oneof![Just([0.0; 3]), prop::array::uniform3(-4e6..4e6_f64)],
        rate in prop_oneof![Just(0.0), -0.5..0.5_f64],
        uneven in prop_oneof![Just(0.0), Just(1e-4)],
    ) {
        let scenario = ring(springs, away, rate, uneven);
        let (summary, tables) = study(&scenario);
        let is_rate = |label: &String| RATES.iter().any(|rate| rate.label() == *label);
        let rounding = scenario.rounding();
        for table in &tables {
            let table = table.table().unwrap();
            let varies = |quantity: &Quantity| {
                let values = quantity.in_table(&table);
                let mut survey = Survey::new(values.len() as u64);
                while let Some(mut pass) = survey.pass() {
                    pass.extend((0..).zip(values.iter().copied()));
                    survey.advance(pass);
                }
                let deviation = survey.moments().unwrap().standard_deviation();
                let size = rounding.size(survey.mean().unwrap(), (&quantity.column(), quantity.unit()));
                [rounding.is_exceeded_in(*quantity, &survey), rounding.is_exceeded_by(deviation, size)]
            };
            let all = RATES.iter().chain(&Quantity::PAYLOAD_RATE);
            let found: Vec<_> = all.filter(|rate| varies(rate).contains(&true)).collect();
            prop_assert_eq!(!found.is_empty(), uneven > 0.0, "{:?}", found);
            if uneven == 0.0 {
                let energy = [Quantity::PayloadRotation, Quantity::StageRotation];
                let found: Vec<_> = energy.iter().filter(|q| varies(q).contains(&true)).collect();
                prop_assert!(found.is_empty() || rate != 0.0, "{:?}", found);
            }
        }
        let has_ratio = RATES.iter().filter_map(|rate| summary.comparisons[0].ratio(*rate)).any(|r| r.deviation_ratio.is_some());
        prop_assert_eq!(has_ratio, uneven > 0.0);
        let heavy = summary.head.alerts.iter().any(|alert| match alert {
            Alert::HeavyTails { outcomes, .. } => outcomes.iter().any(|(label, _)| is_rate(label)),
            _ => false,
        });
        prop_assert!(!heavy || uneven > 0.0, "{:?}", summary.head.alerts);
    }
}

/// A spring beside the mass centres pushes a small body from one that is `times` as heavy, which is `away` from the origin along
/// axis 1 and moves past it with a velocity of a thousandth of that.
fn unequal(mass: f64, times: f64, size: f64, away: f64, rate: f64) -> Scenario {
    let body = |name: &str, mass: f64, size: f64, [x, z]: [f64; 2], more: &str| {
        let moment = mass * size * size;
        format!(
            "[{name}]\nmass_kg = {mass:?}\n\
             inertia_kg_m2 = [[{moment:?}, 0, 0], [0, {:?}, 0], [0, 0, {:?}]]\n\
             position_m = [{:?}, 0.0, {z:?}]\nvelocity_m_per_s = [0.0, {:?}, 0.0]\n\
             angular_velocity_rad_per_s = [0, 0, {rate:?}]\n[{name}.dispersion]\n\
             root_second_moment_variance_kg_m2 = [0.0, 0.0, 0.0]\naxes = \"fixed\"\n{more}\n",
            0.9 * moment,
            0.8 * moment,
            away + x,
            1e-3 * away
        )
    };
    let [arm, reach] = [size, size * times.cbrt()];
    let text = format!(
        "name = \"unequal\"\nruns = 60\n{}{}[[springs]]\nstiffness_n_per_m = {:?}\nstroke_m = {:?}\n\
         payload_point_m = [{:?}, {:?}, {:?}]\nstage_point_m = [{:?}, {:?}, {:?}]\n\
         [springs.dispersion]\nstiffness_percent = 3.0\n\
         [[models]]\nname = \"own\"\nlaw = \"principal\"\naxes = \"whole-sphere\"\n",
        body("payload", mass, arm, [0.37 * arm, arm + reach], "mass_percent = 2.0"),
        body("stage", mass * times, reach, [0.0; 2], ""),
        100.0 * mass / size,
        0.5 * size,
        0.2 * arm,
        0.1 * arm,
        -0.8 * arm,
        0.57 * arm,
        0.1 * arm,
        reach - 0.1 * arm
    );
    Scenario::from_toml(&text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// The values of an outcome in a table, and its mean and deviation.
fn spread(table: &Table, quantity: Quantity) -> (Vec<f64>, f64, f64) {
    let values = quantity.in_table(table);
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n;
    (values, mean, variance.sqrt())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// However unlike the bodies are, and wherever the origin: an outcome that spreads a million times as far as its true rounding,
    /// by which it changes with the origin, is never taken for rounding.
    #[test]
    fn outcomes_of_unequal_bodies_vary(
        (mass, times) in (-2..3_i32, 0.0..6.0_f64).prop_map(|(m, t)| (10_f64.powi(m), 10_f64.powf(t))),
        size in 0.03..2.0_f64,
        away in prop_oneof![Just(0.0), 6e6..8e6_f64, -1e4..1e4_f64],
        rate in prop_oneof![Just(0.0), -0.1..0.1_f64],
    ) {
        let scenarios = [0.0, away, away + 1.0 / 3.0, away + 2.0 / 3.0].map(|away| unequal(mass, times, size, away, rate));
        let tables = scenarios.each_ref().map(|scenario| study(scenario).1[0].table().unwrap());
        let rounding = scenarios[1].rounding();
        let mut told = 0;
        let outcomes = Quantity::ALL.iter().filter(|q| q.unit() != "deg" && !q.is_drawn());
        for quantity in outcomes {
            let [(near, ..), far @ ..] = tables.each_ref().map(|table| spread(table, *quantity));
            let apart = far.iter().flat_map(|(far, ..)| near.iter().zip(far));
            let true_rounding = apart.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let [(far, mean, deviation), ..] = far;
            let column = quantity.column();
            // What it is a difference of.
            let inertia = match column.starts_with("stage") {
                true => mass * times * (size * times.cbrt()).powi(2),
                false => mass * size * size,
            };
            let before = match quantity.unit() {
                "rad/s" => rate.abs(),
                "deg/s" => rate.to_degrees().abs(),
                "kg·m²/s" => inertia * rate.abs(),
                "J" => inertia * rate * rate,
                _ => mean.abs(),
            };
            let resolved = (1e6 * true_rounding).max(1e-9 * before.max(mean.abs()));
            if deviation > resolved {
                told += 1;
                let of = (&*column, quantity.unit());
                let size = rounding.size(mean, of);
                let least = far.iter().copied().fold(f64::INFINITY, f64::min);
                let most = far.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                let is_told = rounding.is_exceeded_by(deviation, size)
                    && rounding.is_exceeded(least, most, of);
                prop_assert!(is_told, "{column}: {deviation:e} about {mean:e}, {true_rounding:e}: {size:e}");
            }
        }
        prop_assert!(told > 2, "{told}");
    }
}
