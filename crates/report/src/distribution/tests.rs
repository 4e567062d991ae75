//! Figures of requirements of any runs: well-formed, in view, and readable on a telephone.

use super::*;
use crate::convergence_figure;
use crate::svg::tests::read;
use gyradius_campaign::{Cell, Column, Judging, Measured, Runs, Table};
use proptest::prelude::*;
use std::collections::BTreeSet;

fn judged(numbers: &[Option<f64>], requirement: &Requirement) -> Option<Judgement> {
    judged_at(&[], numbers, requirement)
}

/// After looks at so many runs.
fn judged_at(
    looks: &[u64],
    numbers: &[Option<f64>],
    requirement: &Requirement,
) -> Option<Judgement> {
    let columns = vec![Column::number("x", "1", "A number.")];
    let mut table = Table::new("model", 0, columns).unwrap();
    for x in numbers {
        table.push(None, [Cell::from(*x)]).unwrap();
    }
    let judging = Judging::new([requirement.clone()], numbers.len() as u64, 1).looked_after(looks);
    judging.look(&table);
    judging.finish(&Runs::from(table)).unwrap().pop()
}

/// The only model.
fn own(judgement: &Judgement) -> JudgedModel<'_> {
    JudgedModel { name: "m", colour: 0, judgement }
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => -3.0..3.0,
        1 => prop::sample::select(vec![0.0, -0.0, 1.0, f64::MAX, f64::MIN, 5e-324, 1e300, -1e-300, 1e9]),
    ]
}

fn bound() -> impl Strategy<Value = Bound> {
    prop_oneof![
        number().prop_map(Bound::AtMost),
        number().prop_map(Bound::AtLeast),
        (number(), number()).prop_map(|(a, b)| Bound::Between(a.min(b), a.max(b))),
    ]
}

/// Sizes of all texts, but for exponents, which are a share of them.
fn sizes(svg: &str) -> Vec<f64> {
    let sizes = svg.split("font-size=\"").skip(1);
    sizes.filter_map(|rest| rest.split('"').next().unwrap().parse().ok()).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// Whatever the numbers there are figures, whose texts are at least 9 pixels high when they are 360 wide; limits, failures and
    /// models are named.
    #[test]
    fn any_runs_give_figures(
        models in prop::collection::vec(prop::collection::vec(prop::option::weighted(0.9, number()), 1..60), 1..5),
        bound in bound(),
        probability in 0.05..0.99999_f64,
        confidence in 0.5..0.999_f64,
        left_out in any::<bool>(),
        (first, step) in (0..6_usize, prop::sample::select(vec![1_usize, 5])),
    ) {
        let failed = if left_out { FailedRuns::LeftOut } else { FailedRuns::Against };
        let quantity = Measured::column("x");
        let Ok(requirement) = Requirement::new("a <name>", quantity, bound, probability, confidence) else { return Ok(()) };
        let requirement = requirement.with_failed_runs(failed);
        let judged: Vec<Judgement> = models.iter().filter_map(|numbers| judged(numbers, &requirement)).collect();
        let names: Vec<String> = (0..judged.len()).map(|i| format!("model {i}")).collect();
        let colour = |place: usize| (first + step * place) % 6;
        let model = |(place, judgement): (usize, _)| JudgedModel { name: &names[place], colour: colour(place), judgement };
        let models: Vec<JudgedModel<'_>> = judged.iter().enumerate().map(model).collect();
        for drawing in [distribution_figure("f", "c", &requirement, Some("m"), &models), convergence_figure("f", "c", &requirement, &models)] {
            let seen = read(&drawing.svg);
            prop_assert!(seen.contains("a <name>") && !seen.contains(": ."));
            prop_assert!(names.iter().all(|name| seen.contains(name)));
            // Each model has the colour that it is to have, and no other colour of models is there.
            for of in 0..6 {
                let is_used = models.iter().any(|model| model.colour == of);
                prop_assert_eq!(drawing.svg.contains(style::model(of)), is_used, "{}", of);
            }
            let least = sizes(&drawing.svg).into_iter().fold(f64::INFINITY, f64::min);
            let narrowest = 0.75 * crate::field::WIDTH;
            let least_width = format!("min-width:{narrowest}px");
            prop_assert!(drawing.svg.contains(&least_width));
            prop_assert!(least * narrowest / crate::field::WIDTH >= 9.0, "{}", least);
        }
        let seen = read(&convergence_figure("f", "c", &requirement, &models).svg);
        let none = judged.iter().all(|judgement| judgement.counted() == 0);
        prop_assert_eq!(seen.contains("No run counts"), none, "{}", seen);
        let seen = read(&distribution_figure("f", "c", &requirement, Some("furlong"), &models).svg);
        prop_assert!(seen.contains("limit") && seen.contains("x (furlong)"));
        let any_failed = judged.iter().any(|judgement| judgement.runs_without_number() > 0);
        prop_assert_eq!(seen.contains("failed or have no number"), any_failed);
        let any_bound = judged.iter().any(|judgement| judgement.tolerance().is_some());
        prop_assert_eq!(seen.contains("tolerance point"), any_bound);
    }

    /// Looks are marked at how many runs counted then, once each, as far as the axis reaches.
    #[test]
    fn looks_are_marked_where_runs_count(
        numbers in prop::collection::vec(prop::option::weighted(0.6, 0.0..2.0_f64), 1..300),
        looks in prop::collection::btree_set(1..400_u64, 0..40),
        left_out in any::<bool>(),
    ) {
        let failed = if left_out { FailedRuns::LeftOut } else { FailedRuns::Against };
        let requirement: Requirement = "x <= 1 in 60 % at 90 %".parse().unwrap();
        let requirement = requirement.with_failed_runs(failed);
        let looks: Vec<u64> = looks.into_iter().collect();
        let judgement = judged_at(&looks, &numbers, &requirement).unwrap();
        let counted = |look: &u64| numbers.iter().take(*look as usize).filter(|x| x.is_some() || !left_out).count();
        let counted: BTreeSet<usize> = looks.iter().map(counted).collect();
        let logs = judgement.convergence().iter().map(|e| (e.runs as f64).log10());
        let (first, end) = crate::convergence::range(logs);
        let logs = counted.iter().map(|counted| (*counted as f64).log10());
        let marks = logs.filter(|log| (first..=end).contains(log)).count();
        let svg = convergence_figure("f", "c", &requirement, &[own(&judgement)]).svg;
        prop_assert_eq!(svg.matches(&format!(" {}v-9", px(HIGH))).count(), marks, "{}", svg);
        prop_assert_eq!(svg.contains("looks of the rule"), !looks.is_empty());
    }

    /// The axis is that of the normal law, from its own tail.
    #[test]
    fn the_axis_is_that_of_the_normal_law(share in prop_oneof![1e-9..0.5_f64, 0.5..0.999_999_9_f64]) {
        let z = probit(share);
        prop_assert!((tail::normal(-z) - share).abs() < 1e-9 * share.min(1.0 - share).max(1e-6), "{z}");
    }
}

/// A line a model through all its runs: the extreme runs of both tails are markers in the plot, the line passes the median at half,
/// and the band is about it.
#[test]
fn the_line_reaches_both_tails() {
    let numbers: Vec<Option<f64>> = (0..2001).map(|i| Some(f64::from(i))).collect();
    let requirement: Requirement = "x <= 1999 in 99 % at 90 %".parse().unwrap();
    let judgement = judged(&numbers, &requirement).unwrap();
    let up = Up::new(&requirement, &[own(&judgement)]);
    let (across, far) = across(requirement.bound(), &[own(&judgement)]);
    assert!(far.is_empty());
    for point in points(&judgement) {
        let y = up.y(point.share);
        assert!(y > 0.0 && y < HIGH, "{point:?}");
        assert!(up.y(point.upper) <= y && y <= up.y(point.lower));
        let x = across.x(point.value);
        assert!(x > 0.0 && x < ACROSS, "{point:?}");
    }
    assert!((up.y(0.5) - 0.5 * HIGH).abs() < 1.0, "both tails are alike");
    let labels: Vec<String> = up.ticks().into_iter().map(|tick| tick.label).collect();
    for label in ["0.1", "1", "5", "20", "50", "80", "95", "99", "99.9"] {
        assert!(labels.iter().any(|l| l == label), "{label}: {labels:?}");
    }
    // A limit that is far away leaves the runs readable.
    let far: Requirement = "x <= 1e6 in 99 % at 90 %".parse().unwrap();
    let judgement = judged(&numbers, &far).unwrap();
    let seen = read(&svg(&far, None, &[own(&judgement)]));
    assert!(seen.contains("is far off this axis"), "{seen}");
}

/// A share that is above the axis is not drawn along its edge, and is told in words.
#[test]
fn shares_above_the_axis_leave_the_plot() {
    let requirement: Requirement = "x <= 1 in 99 % at 90 %".parse().unwrap();
    let mut above = 0;
    for failing in [&[0, 2][..], &[1500], &[0, 1, 2], &[40, 41], &[], &[10, 500, 1000]] {
        let number = |i: u64| Some(if failing.contains(&i) { 2.0 } else { 0.5 });
        let numbers: Vec<Option<f64>> = (0..3000).map(number).collect();
        let judgement = judged(&numbers, &requirement).unwrap();
        let most = judgement.convergence().iter().map(|e| e.failing).fold(0.0, f64::max);
        let last = judgement.convergence().last().unwrap().interval.upper();
        let expected = most > f64::max(1.8 * last, 2.2 * (1.0 - requirement.probability()));
        above += usize::from(expected);
        let svg = convergence_figure("f", "c", &requirement, &[own(&judgement)]).svg;
        let seen = read(&svg);
        assert_eq!(seen.contains("m: up to"), expected, "{failing:?}: {seen}");
        // Both ends of a line at the upper edge would be a line along it.
        let pen = format!("<path {} d=\"", line_pen(0));
        assert!(svg.contains(&pen), "{svg}");
        let line = svg.split(&pen).skip(1).map(|rest| rest.split('"').next().unwrap());
        for piece in line.flat_map(|d| d.split('M').skip(1)) {
            let ends: Vec<&str> =
                piece.split('L').map(|end| end.split(' ').nth(1).unwrap()).collect();
            assert!(ends.iter().any(|y| *y != "0"), "{failing:?}: {piece}");
        }
    }
    assert!((2..5).contains(&above), "{above}");
}

/// The interval of a single number of runs is a bar that can be seen; where no run counts, the words say so.
#[test]
fn a_single_number_of_runs_has_an_interval() {
    let requirement: Requirement = "x <= 1 in 50 % at 90 %".parse().unwrap();
    let left_out = requirement.clone().with_failed_runs(FailedRuns::LeftOut);
    for (numbers, requirement, drawn) in [
        (vec![Some(0.5)], &requirement, true),
        (vec![None], &requirement, true),
        (vec![Some(0.5), None], &left_out, true),
        (vec![None, None], &left_out, false),
    ] {
        let judgement = judged(&numbers, requirement).unwrap();
        assert_eq!(judgement.convergence().len(), usize::from(drawn), "{numbers:?}");
        let svg = convergence_figure("f", "c", requirement, &[own(&judgement)]).svg;
        let pen = format!("<path {} d=\"M", band_pen(0));
        let shapes = svg.split(&pen).skip(1).map(|rest| rest.split('"').next().unwrap());
        let bars: Vec<Vec<f64>> = shapes
            .filter(|d| d.contains('L'))
            .map(|d| {
                d.trim_end_matches('z')
                    .split('L')
                    .map(|at| at.split(' ').next().unwrap().parse().unwrap())
                    .collect()
            })
            .collect();
        assert_eq!(bars.len(), usize::from(drawn), "{svg}");
        for x in bars {
            assert!(x[0] > 0.0 && x[1] - x[0] > 5.0 && x[2] == x[1] && x[3] == x[0], "{x:?}");
        }
        assert_eq!(svg.contains("m: no run counts."), !drawn, "{svg}");
    }
}

/// Limits that differ in the last digits are told apart where the axis does.
#[test]
fn limits_of_a_narrow_axis_are_told_apart() {
    for (middle, half) in
        [(1e9, 1e-6), (7_000_123.0, 0.02), (293.15, 0.001), (-1e15, 0.5), (5.0, 1.0)]
    {
        let numbers: Vec<Option<f64>> =
            (0..200).map(|i| Some(middle + half * (f64::from(i) / 100.0 - 1.0))).collect();
        let bound = Bound::Between(middle - half, middle + half);
        let requirement = Requirement::new("r", Measured::column("x"), bound, 0.9, 0.9).unwrap();
        let judgement = judged(&numbers, &requirement).unwrap();
        let seen = read(&svg(&requirement, None, &[own(&judgement)]));
        let told: Vec<&str> =
            seen.split("limit ").skip(1).map(|rest| rest.lines().next().unwrap()).collect();
        assert!(told.len() >= 2 && told[0] != told[1], "{middle} {half}: {told:?}\n{seen}");
    }
}
