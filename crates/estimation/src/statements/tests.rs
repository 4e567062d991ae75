//! What is said of statements, by example.

use super::*;
use gyradius_attitude::UniformAttitude;
use gyradius_dispersion::{EntryMoments, PrincipalDispersion, ScalarRoots};
use gyradius_inertia::{InertiaMatrix, RootSecondMoments, SecondMoments};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use proptest::{prelude::*, test_runner::TestCaseResult};
use rand::RngExt;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::Distribution;

mod centre;
mod planted;
mod reach;
mod reasons;
mod sizes;
mod slender;
mod still;
mod turns;

fn body(moments: [f64; 3], products: [f64; 3]) -> Inertia {
    Inertia::try_from(InertiaMatrix::from_entries(moments, products).unwrap()).unwrap()
}

/// The deviations that the axes alone give the entries.
pub(super) fn by_axes(model: &StatedModel) -> [f64; 6] {
    let roots = model.nominal().second_moments().roots();
    let still = ScalarRoots::normal(roots, [0.0; 3]).unwrap();
    EntryMoments::of(&PrincipalDispersion::new(still, model.law().axes().clone())).deviations()
}

fn percent(x: f64) -> Option<MomentsStatement> {
    Some(MomentsStatement::new(Amount::Percent([x; 3]), 1.0).unwrap())
}

fn products(x: f64, sigmas: f64) -> Option<ProductsStatement> {
    Some(ProductsStatement::new([x; 3], sigmas).unwrap())
}

/// What is stated comes out, on a body whose axes are not those of the body, and draws have it.
#[test]
fn moments_and_products_come_out_as_stated() {
    let nominal = body([5000.0, 4000.0, 3000.0], [300.0, 200.0, -400.0]);
    let deviations = [40.0, 36.0, 38.0];
    let statements = Statements {
        moments: Some(MomentsStatement::new(Amount::Absolute(deviations), 1.0).unwrap()),
        products: Some(ProductsStatement::new([60.0, 120.0, 60.0], 3.0).unwrap()),
        ..Statements::default()
    };
    let model = statements.model(&nominal, None).unwrap();
    let implied = model.implied().deviations();
    for (found, expected) in implied.iter().zip([40.0, 36.0, 38.0, 20.0, 40.0, 20.0]) {
        assert!((found / expected - 1.0).abs() < 0.01, "{implied:?}");
    }
    assert!(model.warnings().is_empty(), "{:?}", model.warnings());
    const N: usize = 50_000;
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let draws: Vec<[f64; 6]> = (0..N)
        .map(|_| {
            let drawn: Inertia = model.law().sample(&mut rng);
            drawn.entries()
        })
        .collect();
    for e in 0..6 {
        let mean = draws.iter().map(|d| d[e]).sum::<f64>() / N as f64;
        let square = draws.iter().map(|d| (d[e] - mean).powi(2)).sum::<f64>() / N as f64;
        // A deviation of 50,000 draws is known to 0.3 %.
        assert!((square.sqrt() / implied[e] - 1.0).abs() < 0.02, "{e}");
    }
}

/// What people state most, about the payload of Peck (2003).
#[test]
fn what_people_state_most() {
    let nominal = body([5000.0, 4000.0, 3000.0], [20.0, 2.0, -50.0]);
    let three_sigma = |x| Some(MomentsStatement::new(Amount::Percent([x; 3]), 3.0).unwrap());
    let mass = Some(MassStatement::percent(2.0, 3.0).unwrap());
    let cases = [
        (Statements { moments: percent(1.0), ..Statements::default() }, [50.0, 40.0, 30.0]),
        (Statements { moments: percent(3.0), ..Statements::default() }, [150.0, 120.0, 90.0]),
        (
            Statements { moments: three_sigma(10.0), mass, ..Statements::default() },
            [500.0 / 3.0, 400.0 / 3.0, 100.0],
        ),
        (
            Statements {
                moments: percent(10.0),
                mass: Some(MassStatement::percent(10.0, 1.0).unwrap()),
                ..Statements::default()
            },
            [500.0, 400.0, 300.0],
        ),
    ];
    for (statements, expected) in cases {
        let model = statements.model(&nominal, None).unwrap();
        for (found, expected) in model.implied().deviations().iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 0.01, "{:?}", model.implied().deviations());
        }
        assert!(model.turns().iter().all(|t| *t < 1e-5), "{:?}", model.turns());
    }
    // Products alone: the moments stay but for what tilted axes force.
    let model = Statements { products: products(50.0, 3.0), ..Statements::default() };
    let implied = model.model(&nominal, None).unwrap().implied().deviations();
    assert!(implied[..3].iter().all(|d| *d < 5.0), "{implied:?}");
    assert!(implied[3..].iter().all(|d| (d * 3.0 / 50.0 - 1.0).abs() < 0.01), "{implied:?}");

    let light = body([90.0, 95.0, 70.0], [0.0, 1.0, -1.0]);
    let centre = Some(CentreStatement::new([0.01; 3], 3.0, [0.0; 3]).unwrap());
    let statements = Statements { moments: three_sigma(10.0), centre, ..Statements::default() };
    let implied = statements.model(&light, Some(60.0)).unwrap().implied().deviations();
    for (found, expected) in implied.iter().zip([3.0, 9.5 / 3.0, 7.0 / 3.0]) {
        assert!((found / expected - 1.0).abs() < 0.01, "{implied:?}");
    }
}

/// A plate keeps its shape: its second moments must go together.
#[test]
fn a_plate_scatters_as_stated() {
    let model = Statements { moments: percent(10.0), ..Statements::default() }
        .model(&body([500.0, 520.0, 1020.0], [0.0; 3]), None)
        .unwrap();
    let implied = model.implied().deviations();
    for (found, expected) in implied.iter().zip([50.0, 52.0, 102.0]) {
        assert!((found / expected - 1.0).abs() < 0.03, "{implied:?} {:?}", model.warnings());
    }
    assert!(model.warnings().contains(&StatementWarning::Correlated), "{:?}", model.warnings());
}

/// The mass is in what is stated of the moments, once.
#[test]
fn a_mass_is_counted_once() {
    let nominal = body([5000.0, 4000.0, 3000.0], [20.0, 2.0, -50.0]);
    let mass = Some(MassStatement::percent(5.0, 1.0).unwrap());
    let statements = Statements { moments: percent(10.0), mass, ..Statements::default() };
    let model = statements.model(&nominal, None).unwrap();
    let mass = model.mass().unwrap();
    assert_eq!((mass.relative_deviation(), mass.inertia_follows()), (0.05, 1.0));
    // As wherever an inertia follows: of the whole change the ratio itself.
    assert!((1..100).map(|i| 0.01 * f64::from(i)).all(|ratio| mass.factor(ratio) == ratio));
    // Draws of both: mass and inertia at the nominal mass.
    const N: usize = 40_000;
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let draws: Vec<(f64, f64)> = (0..N)
        .map(|_| {
            let z: f64 = rand_distr::StandardNormal.sample(&mut rng);
            let ratio = 1.0 + 0.05 * z;
            let inertia: Inertia = model.law_at_nominal_mass().sample(&mut rng);
            (ratio, inertia.entries()[0] * mass.factor(ratio))
        })
        .collect();
    let n = N as f64;
    let mean = draws.iter().map(|d| d.1).sum::<f64>() / n;
    let variance = draws.iter().map(|d| (d.1 - mean).powi(2)).sum::<f64>() / n;
    let together = draws.iter().map(|d| (d.0 - 1.0) * (d.1 - mean)).sum::<f64>() / n;
    assert!((variance.sqrt() / 500.0 - 1.0).abs() < 0.02, "{}", variance.sqrt());
    let correlation = together / (0.05 * variance.sqrt());
    assert!((correlation - 0.5).abs() < 0.02, "{correlation}");
    // Stated of the moments is less than the mass would do: it follows in part.
    let statements = Statements { moments: percent(1.0), ..statements };
    let model = statements.model(&nominal, None).unwrap();
    let follows = model.mass().unwrap().inertia_follows();
    assert!((follows - 0.2).abs() < 1e-4, "{follows}");
    assert!((model.implied().deviations()[0] / 50.0 - 1.0).abs() < 0.01);
    let said: String = model.warnings().iter().map(ToString::to_string).collect();
    assert!(said.contains("only in part, by 0.200"), "{said}");
}

/// Three equal tolerances on a slender body: the largest moment is the sum of the others but for
/// little, and cannot scatter less than they do, unless second moments go together.
#[test]
fn moments_that_no_independent_second_moments_have_are_told() {
    let nominal = body([2000.0, 15000.0, 15500.0], [0.0; 3]);
    for deviations in [[200.0, 1500.0, 1550.0], [200.0, 10.0, 10.0], [10.0, 100.0, 20.0]] {
        let moments = MomentsStatement::new(Amount::Absolute(deviations), 1.0).unwrap();
        let model = Statements { moments: Some(moments), ..Statements::default() };
        let model = model.model(&nominal, None).unwrap();
        let implied = model.implied().deviations();
        for (found, expected) in implied.iter().zip(deviations) {
            assert!((found / expected - 1.0).abs() < 0.03, "{implied:?}");
        }
        assert!(model.warnings().contains(&StatementWarning::Correlated), "{:?}", model.warnings());
    }
}

#[test]
fn a_plate_contradicts_independent_moments() {
    let model = Statements { moments: percent(10.0), axes: None, ..Statements::default() }
        .model(&body([500.0, 520.0, 1000.0], [0.0; 3]), None)
        .unwrap();
    let said: String = model.warnings().iter().map(|w| format!("{w}\n")).collect();
    assert!(said.contains("contradict realizability") && said.contains("43.6 %"), "{said}");
    let moments = MomentsStatement::new(Amount::Absolute([50.0, 52.0, 60.0]), 1.0).unwrap();
    let model = Statements { moments: Some(moments), ..Statements::default() }
        .model(&body([500.0, 520.0, 1000.0], [0.0; 3]), None)
        .unwrap();
    let said: String = model.warnings().iter().map(|w| format!("{w}\n")).collect();
    assert!(said.contains("nearly flat across principal axis 3"), "{said}");
    let compact = Statements { moments: percent(2.0), ..Statements::default() }
        .model(&body([900.0, 1000.0, 1100.0], [0.0; 3]), None)
        .unwrap();
    assert_eq!(compact.warnings(), [StatementWarning::FixedAxes]);
}

/// Two equal moments: a turn about the third axis moves their product only as far as they scatter.
#[test]
fn products_of_equal_moments_come_from_their_scatter() {
    let nominal = body([6700.0, 6700.0, 2000.0], [0.0; 3]);
    let make = |product| Statements {
        moments: Some(MomentsStatement::new(Amount::Absolute([67.0, 67.0, 20.0]), 1.0).unwrap()),
        products: Some(ProductsStatement::new([product, 50.0, 50.0], 1.0).unwrap()),
        ..Statements::default()
    };
    // Within reach.
    let model = make(3.0).model(&nominal, None).unwrap();
    let implied = model.implied().deviations();
    assert!((implied[3] / 3.0 - 1.0).abs() < 0.05, "{implied:?} {:?}", model.warnings());
    assert!((implied[4] / 50.0 - 1.0).abs() < 0.02, "{implied:?}");
    assert_eq!(model.warnings(), [StatementWarning::EqualMoments { axes: [1, 2] }]);
    // Beyond it: too little, whatever the turn.
    let model = make(100.0).model(&nominal, None).unwrap();
    let said: String = model.warnings().iter().map(|w| format!("{w}\n")).collect();
    assert!(said.contains("I12: a deviation of 100"), "{said}");
    assert!(model.turns()[2] > 0.5, "{:?}", model.turns());
}

#[test]
fn mass_scales_and_the_centre_adds_parallel_axes() {
    let nominal = body([5000.0, 4000.0, 3000.0], [0.0; 3]);
    let mass = Some(MassStatement::percent(3.0, 3.0).unwrap());
    let model = Statements { mass, ..Statements::default() }.model(&nominal, None).unwrap();
    for (found, expected) in model.implied().deviations().iter().zip([50.0, 40.0, 30.0]) {
        assert!((found / expected - 1.0).abs() < 0.01, "{:?}", model.implied().deviations());
    }
    // All together: the body keeps its shape.
    let covariance = model.implied().covariance();
    for (e, f) in [(0, 1), (0, 2), (1, 2)] {
        let scale = (covariance[(e, e)] * covariance[(f, f)]).sqrt();
        assert!((covariance[(e, f)] / scale - 1.0).abs() < 1e-12);
    }
    // Tilted axes, and products of which more is said than the mass does: within 1 % of 50 kg·m².
    let tilted = body([5000.0, 4000.0, 3000.0], [20.0, 2.0, -50.0]);
    let with = Statements { mass, products: products(50.0, 1.0), ..Statements::default() };
    let implied = with.model(&tilted, None).unwrap();
    for (found, expected) in implied.implied().deviations().iter().zip([50.0, 40.0, 30.0]) {
        assert!((found / expected - 1.0).abs() < 0.06, "{:?}", implied.implied().deviations());
    }
    for found in &implied.implied().deviations()[3..] {
        assert!((found / 50.0 - 1.0).abs() < 0.03, "{:?}", implied.implied().deviations());
    }
    let kg = Some(MassStatement::kg(100.0, 1.0).unwrap());
    let same = Statements { mass: kg, ..Statements::default() };
    assert!(matches!(same.model(&nominal, None), Err(StatementError::NoMass { .. })));
    let again = same.model(&nominal, Some(1e4)).unwrap();
    let (a, b) = (again.implied().deviations(), model.implied().deviations());
    for e in 0..3 {
        assert!((a[e] / b[e] - 1.0).abs() < 1e-9);
    }

    // Without an arm 10 mm of 10 t is nothing: 2 m s² = 2 kg·m².
    let centre = |arm| {
        let centre = Some(CentreStatement::new([0.01; 3], 1.0, arm).unwrap());
        Statements { centre, ..Statements::default() }.model(&nominal, Some(1e4)).unwrap()
    };
    for found in &centre([0.0; 3]).implied().deviations()[..3] {
        assert!((found / 2.0 - 1.0).abs() < 0.05, "{found}");
    }
    // Measured 1.5 m below: I11 and I22 by 2 m L s = 300, products by m L s = 150.
    let lever = centre([0.0, 0.0, 1.5]);
    let implied = lever.implied().deviations();
    for (e, expected) in [(0, 300.0), (1, 300.0), (4, 150.0), (5, 150.0)] {
        assert!((implied[e] / expected - 1.0).abs() < 0.1, "{implied:?}");
    }
}

/// The variances that the rule for the mass centre claims, against draws of it.
#[test]
fn the_mass_centre_moves_entries_as_claimed() {
    use rand_distr::StandardNormal;
    const N: usize = 200_000;
    let (arm, s, m) = ([0.02, -0.05, 0.03], [0.01, 0.02, 0.015], 7.0);
    let claimed = CentreStatement::new(s, 1.0, arm).unwrap().entry_variances(m);
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let about = |p: Vector3<f64>| (Matrix3::identity() * p.norm_squared() - p * p.transpose()) * m;
    let draws: Vec<[f64; 6]> = (0..N)
        .map(|_| {
            let z: [f64; 3] = [0; 3].map(|_| StandardNormal.sample(&mut rng));
            let l = Vector3::from(arm);
            let d = Vector3::new(s[0] * z[0], s[1] * z[1], s[2] * z[2]);
            let off = about(l + d) - about(l);
            InertiaMatrix::new(off).unwrap().entries()
        })
        .collect();
    for e in 0..6 {
        let mean = draws.iter().map(|x| x[e]).sum::<f64>() / N as f64;
        let squares: Vec<f64> = draws.iter().map(|x| (x[e] - mean).powi(2)).collect();
        let variance = squares.iter().sum::<f64>() / N as f64;
        let spread = squares.iter().map(|x| (x - variance).powi(2)).sum::<f64>() / N as f64;
        let z = (variance - claimed[e]) / (spread / N as f64).sqrt();
        assert!(z.abs() < 4.0, "{e}: {z}");
    }
}

/// With an arm, the entries have what the rule adds, and no more because the axes scatter for other entries; or a warning says so.
#[test]
fn the_mass_centre_alone_is_added_once() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let mut had = 0;
    for case in 0..20 {
        let k = SecondMoments::new(std::array::from_fn(|_| rng.random_range(0.1..1.0))).unwrap();
        let axes = UniformAttitude.sample(&mut rng);
        let nominal = Inertia::from_second_moments(k, &axes).unwrap();
        let m = nominal.matrix().trace() * 10_f64.powf(rng.random_range(-1.0..1.0));
        let arm = std::array::from_fn(|_| rng.random_range(-0.5..0.5));
        let centre = CentreStatement::new([0.002; 3], 1.0, arm).unwrap();
        let added = centre.entry_variances(m).map(f64::sqrt);
        let statements = Statements { centre: Some(centre), ..Statements::default() };
        let model = statements.model(&nominal, Some(m)).unwrap();
        let said: String = model.warnings().iter().map(ToString::to_string).collect();
        for (e, (implied, added)) in model.implied().deviations().into_iter().zip(added).enumerate()
        {
            let off = (implied / added - 1.0).abs();
            had += usize::from(off < 0.03);
            let name = InertiaMatrix::ENTRY_NAMES[e];
            assert!(off < 0.04 || said.contains(name), "{case}, {name}: {implied} {added}: {said}");
        }
    }
    assert!(had > 100, "{had} of 120");
}

#[test]
fn what_is_stated_includes_mass_and_centre() {
    let nominal = body([5000.0, 4000.0, 3000.0], [0.0; 3]);
    let mass = Some(MassStatement::percent(5.0, 1.0).unwrap());
    let moments = Some(MomentsStatement::new(Amount::Absolute([40.0; 3]), 1.0).unwrap());
    let model = Statements { moments, mass, ..Statements::default() };
    let model = model.model(&nominal, None).unwrap();
    assert!((model.implied().deviations()[0] / 40.0 - 1.0).abs() < 0.01);
    let said: String = model.warnings().iter().map(ToString::to_string).collect();
    assert!(said.contains("the mass alone would move I11 by 250"), "{said}");
}

#[test]
fn bad_statements_are_named() {
    let message = |e: StatementError| e.to_string();
    let bad = MomentsStatement::new(Amount::Percent([1.0, -1.0, 1.0]), 1.0).unwrap_err();
    assert!(message(bad).starts_with("moments.percent[2] = -1.0: "));
    for sigmas in [0.0, -1.0, f64::NAN, 1e9] {
        let error = message(ProductsStatement::new([1.0; 3], sigmas).unwrap_err());
        assert!(error.starts_with("products.sigmas = "), "{error}");
    }
    assert!(message(AxesStatement::each([100.0; 3], 1.0).unwrap_err()).contains("at most 45 °"));
    assert!(message(AxesStatement::total(f64::NAN, 1.0).unwrap_err()).contains("NaN"));
    assert!(
        message(MassStatement::kg(f64::INFINITY, 1.0).unwrap_err()).starts_with("mass.kg = inf: ")
    );
    assert!(CentreStatement::new([0.0; 3], 1.0, [f64::NAN, 0.0, 0.0]).is_err());
    let point = Inertia::new(Matrix3::zeros()).unwrap();
    assert!(matches!(
        Statements::default().model(&point, None),
        Err(StatementError::Nominal { .. })
    ));
    let nominal = body([5.0, 4.0, 3.0], [0.0; 3]);
    for mass in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            Statements::default().model(&nominal, Some(mass)),
            Err(StatementError::Mass { .. })
        ));
    }
}

#[cfg(feature = "serde")]
#[test]
fn serde_goes_through_the_constructors() {
    let json = r#"{"moments": {"percent": 10, "sigmas": 1}, "products": {"kg_m2": [1, 2, 3], "sigmas": 3},
        "axes": {"deg": 2, "sigmas": 3, "of": "total"}, "mass": {"kg": 5, "sigmas": 1},
        "centre": {"mm": 10, "sigmas": 3, "arm_m": [0, 0, 1]}}"#;
    let statements: Statements = serde_json::from_str(json).unwrap();
    let again = serde_json::to_string(&statements).unwrap();
    let again: Statements = serde_json::from_str(&again).unwrap();
    let nominal = body([5000.0, 4000.0, 3000.0], [0.0; 3]);
    let deviations = |s: &Statements| s.model(&nominal, Some(1e3)).unwrap().implied().deviations();
    for (a, b) in deviations(&statements).iter().zip(deviations(&again)) {
        assert!((a / b - 1.0).abs() < 1e-6);
    }
    for (from, to, word) in [
        ("\"percent\": 10", "\"percent\": -10", "moments.percent = -10.0: "),
        ("\"percent\": 10", "\"percent\": 10, \"kg_m2\": 3", "exactly one of percent, kg_m2"),
        ("\"sigmas\": 1}", "\"sigma\": 1}", "unknown field"),
        ("\"percent\": 10, \"sigmas\": 1", "\"percent\": 10", "sigmas"),
        ("\"deg\": 2", "\"deg\": [1, 2, 3]", "axes.deg: there must be one number"),
    ] {
        let error = serde_json::from_str::<Statements>(&json.replacen(from, to, 1)).unwrap_err();
        assert!(error.to_string().contains(word), "{error}");
    }
}

/// Roots of the second moments, a turn, and any statements.
fn anything() -> impl Strategy<Value = ([f64; 3], [f64; 3], Statements)> {
    let three = |most: f64| prop::array::uniform3(0.0..most);
    let statements = (
        prop::option::of(three(2000.0)),
        prop::option::of(three(2000.0)),
        prop::option::of(three(45.0)),
        prop::option::of(0.0..50.0_f64),
        prop::option::of(three(0.5)),
    );
    let statements = statements.prop_map(|(moments, products, axes, mass, centre)| Statements {
        moments: moments.map(|x| MomentsStatement::new(Amount::Absolute(x), 1.0).unwrap()),
        products: products.map(|x| ProductsStatement::new(x, 1.0).unwrap()),
        axes: axes.map(|x| AxesStatement::each(x, 1.0).unwrap()),
        mass: mass.map(|x| MassStatement::percent(x, 1.0).unwrap()),
        centre: centre.map(|x| CentreStatement::new(x, 1.0, [1.0, 0.0, 0.0]).unwrap()),
    });
    (three(100.0), prop::array::uniform3(-3.0..3.0_f64), statements)
}

/// A law that draws bodies, or an error; no panic.
fn a_law_or_an_error(k: [f64; 3], turn: [f64; 3], statements: &Statements) -> TestCaseResult {
    let k = SecondMoments::new(k).unwrap();
    let q = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
    let nominal = Inertia::from_second_moments(k, &q).unwrap();
    if let Ok(model) = statements.model(&nominal, Some(100.0)) {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let drawn: Inertia = model.law().sample(&mut rng);
        prop_assert!(drawn.as_inertia_matrix().is_realizable());
        prop_assert!(model.implied().deviations().iter().all(|d| d.is_finite()));
        // Beside products, axes are limits.
        if let Some(axes) = statements.axes {
            for (found, most) in model.turns().iter().zip(axes.deviations()) {
                prop_assert!(*found <= most * (1.0 + 1e-6), "{found} {most}");
            }
        }
        for warning in model.warnings() {
            prop_assert!(!warning.to_string().is_empty());
        }
    }
    Ok(())
}

// Two tests, so that two threads do them: a case takes a second.
proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// Whatever is stated of whatever solid body.
    #[test]
    fn any_statements_of_solid_bodies_make_a_law_or_an_error((k, turn, statements) in anything()) {
        a_law_or_an_error(k, turn, &statements)?;
    }

    /// Whatever is stated of whatever plate, which has a root that is zero.
    #[test]
    fn any_statements_of_plates_make_a_law_or_an_error((k, turn, statements) in anything()) {
        a_law_or_an_error([k[0], k[0], 0.0], turn, &statements)?;
    }
}

/// The same statements make the same model, others another; in JSON every number with a unit says it.
#[test]
fn models_are_compared_and_written() {
    let nominal = body([5000.0, 4000.0, 3000.0], [300.0, 200.0, -400.0]);
    let model = |x: f64| {
        let statements = Statements {
            moments: percent(x),
            products: products(60.0, 3.0),
            ..Statements::default()
        };
        statements.model(&nominal, None).unwrap()
    };
    assert_eq!(model(1.0), model(1.0));
    assert_ne!(model(1.0), model(1.5));
    #[cfg(feature = "serde")]
    {
        let json = serde_json::to_value(model(1.0)).unwrap();
        assert_eq!(json["nominal_kg_m2"][0][1], 300.0);
        assert!((json["stated_kg_m2"][3].as_f64().unwrap() - 20.0).abs() < 1e-9, "{json}");
        assert!(json["warnings"].is_array() && json["rotation_variance_rad2"].is_array());
    }
}
