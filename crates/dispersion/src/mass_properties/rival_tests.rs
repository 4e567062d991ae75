//! Rivals of the joint law: densities, moments, and how many of their draws belong to no body.

use gyradius_inertia::{Inertia, InertiaMatrix, MassProperties, Region, Shape};
use nalgebra::{SMatrix, SVector};
use proptest::prelude::*;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::Distribution;

use super::density_tests::ratio;
use super::tests::worst;
use super::*;
use crate::ScalarLaw;

fn body() -> MassProperties {
    let inertia = InertiaMatrix::from_entries([5.0, 4.0, 4.5], [0.3, -0.2, 0.1]).unwrap();
    MassProperties::new(9.0, [0.4, 0.8, 0.3], Inertia::try_from(inertia).unwrap()).unwrap()
}

fn spread() -> SMatrix<f64, 10, 10> {
    let root = SMatrix::<f64, 10, 10>::from_fn(|i, j| {
        let own = if i == j { 0.08 } else { 0.0 };
        own + 0.02 * ((3 * i + 5 * j) % 7) as f64 / 7.0
    });
    root * root.transpose()
}

/// Draws of a law, as ten numbers each.
fn rows(law: &dyn MassPropertiesModel, n: usize) -> Vec<TenParameters> {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    (0..n).map(|_| law.draw(&mut rng)).collect()
}

#[test]
fn densities_have_the_integral_one() {
    let ellipsoid = Region::ellipsoid([0.4, 0.8, 0.3], [0.85, 1.0, 0.85]).unwrap();
    let entropy = MaximumEntropy::new(&body(), 0.15, [0.15, 0.2, 0.18], 0.25).unwrap();
    let kept = entropy.clone().inside(ellipsoid.clone()).unwrap();
    assert_eq!(kept.clone().inside(ellipsoid), Err(RegionAcceptanceError::Second));
    let share = MassPropertiesModel::acceptance(&kept).unwrap();
    assert!(share > 0.1 && share < 0.9, "{share}");
    let laws: [Box<dyn MassPropertiesModel>; 4] = [
        Box::new(LogCholeskyTen::about(&body(), spread()).unwrap()),
        Box::new(PseudoInertiaWishart::new(&body(), 60.0).unwrap()),
        Box::new(entropy),
        Box::new(kept),
    ];
    let inertia = body().inertia().entries();
    for law in &laws {
        let (mean, error) = ratio(inertia, [0.5, 1.6, 0.15], |body| law.ln_density(body).unwrap());
        assert!(error < 0.1, "{}: {error}", law.name());
        assert!((mean - 1.0).abs() < 4.5 * error, "{}: {mean} ± {error}", law.name());
        // The control: Σ in place of I.
        let wrong = |body: &MassProperties| law.ln_density(body).unwrap() + std::f64::consts::LN_2;
        let (mean, error) = ratio(inertia, [0.5, 1.6, 0.15], wrong);
        assert!((mean - 1.0).abs() > 4.5 * error, "{}: {mean} ± {error}", law.name());
    }
}

#[test]
fn moments_are_those_of_the_draws() {
    let entropy = MaximumEntropy::new(&body(), 0.3, [0.1, 0.2, 0.0], 0.4).unwrap();
    let natural = |draws: &[TenParameters]| -> Vec<SVector<f64, 10>> {
        draws.iter().map(|ten| ten.values().into()).collect()
    };
    let z = worst(&entropy.moments().unwrap(), &natural(&rows(&entropy, 40_000)));
    assert!(z < 5.0, "{z}");
    let log = LogCholeskyTen::about(&body(), spread()).unwrap();
    let z = worst(&log.moments().unwrap(), &natural(&rows(&log, 40_000)));
    assert!(z < 5.0, "{z}");
    let linear: Vec<_> = rows(&log, 40_000).iter().map(TenParameters::linear).collect();
    let z = worst(&log.linear_moments().unwrap(), &linear);
    assert!(z < 5.0, "{z}");
    // The control: those about the mass centre.
    assert!(worst(&log.moments().unwrap(), &linear) > 20.0);
    let wishart = PseudoInertiaWishart::new(&body(), 20.5).unwrap();
    let linear: Vec<_> = rows(&wishart, 40_000).iter().map(TenParameters::linear).collect();
    let moments = wishart.linear_moments();
    let z = worst(&moments, &linear);
    assert!(z < 5.0, "{z}");
    // The control: the natural ten.
    assert!(worst(&moments, &natural(&rows(&wishart, 40_000))) > 20.0);
}

/// Draws of the four laws of bodies are bodies, and of the naive ways as many as can be counted otherwise.
#[test]
fn impossible_draws_are_counted() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let laws: [Box<dyn MassPropertiesModel>; 3] = [
        Box::new(LogCholeskyTen::about(&body(), spread()).unwrap()),
        Box::new(PseudoInertiaWishart::new(&body(), 5.0).unwrap()),
        Box::new(MaximumEntropy::new(&body(), 0.5, [0.1; 3], 0.9).unwrap()),
    ];
    for law in &laws {
        assert!(law.is_realizable_by_construction());
        assert_eq!(law.unrealizable_share(&mut rng, 5_000), 0.0, "{}", law.name());
    }
    let ball = Shape::sphere(0.3).unwrap().of_mass(2.0).unwrap();
    let factor = || ScalarLaw::uniform(0.5, 1.5).unwrap();
    let naive = |rule| NaiveBody::new(ball, rule, factor()).unwrap();
    // Of a ball, f₁ > f₂ + f₃ or one of two others: 3 · ∫ (a − ½)²/2 da over [½, 1] = 1/16.
    const N: usize = 40_000;
    let near = |share: f64, expected: f64| {
        let error = (expected * (1.0 - expected) / N as f64).sqrt();
        assert!((share - expected).abs() < 4.0 * error, "{share} {expected}");
    };
    for rule in [NaiveRule::DiagonalFactors, NaiveRule::EntryFactors, NaiveRule::PrincipalFactors] {
        let law = naive(rule).with_mass_factor(factor()).unwrap();
        near(law.unrealizable_share(&mut rng, N), 1.0 / 16.0);
    }
    assert_eq!(naive(NaiveRule::ScaleAll).unrealizable_share(&mut rng, N), 0.0);
    // A rod of no thickness: one of two moments differs from the other in every draw.
    let rod = Shape::rod(1.0).unwrap().of_mass(1.0).unwrap();
    let rod = NaiveBody::new(rod, NaiveRule::PrincipalFactors, factor()).unwrap();
    assert_eq!(rod.unrealizable_share(&mut rng, N), 1.0);
    // Noise on the six entries of a ball of 1 kg·m²: the smallest second moment of a random matrix, counted by its own.
    let noise = ScalarLaw::normal(0.0, 1e-9).unwrap();
    let still = NaiveBody::new(ball, NaiveRule::EntryNoise, noise).unwrap();
    assert_eq!(still.unrealizable_share(&mut rng, N), 0.0);
    // A mass that is negative belongs to no body, and a mass centre always does.
    let mass = naive(NaiveRule::ScaleAll).with_mass_factor(ScalarLaw::normal(0.0, 1.0).unwrap());
    near(mass.unwrap().unrealizable_share(&mut rng, N), 0.5);
    let centre =
        naive(NaiveRule::ScaleAll).with_centre_offset_m(ScalarLaw::normal(0.0, 9.0).unwrap());
    assert_eq!(centre.unwrap().unrealizable_share(&mut rng, N), 0.0);
}

#[test]
fn what_is_no_rival_is_refused_by_name() {
    let plate = Shape::plate([1.0, 2.0]).unwrap().of_mass(1.0).unwrap();
    assert!(matches!(LogCholeskyTen::about(&plate, spread()), Err(LogCholeskyTenError::Mean(_))));
    assert!(matches!(
        PseudoInertiaWishart::new(&plate, 9.0),
        Err(PseudoInertiaWishartError::Singular)
    ));
    for freedom in [3.9, f64::NAN, 1e15] {
        let error = PseudoInertiaWishart::new(&body(), freedom).unwrap_err();
        assert!(error.to_string().starts_with("degrees of freedom = "), "{error}");
    }
    for (mass, centre, delta, what) in [
        (0.0, 0.1, 0.1, "deviation of the mass over"),
        (2.0, 0.1, 0.1, "deviation of the mass over"),
        (0.1, -1.0, 0.1, "deviation of the mass centre along axis 1"),
        (0.1, 0.1, 2.0, "dispersion"),
    ] {
        let error = MaximumEntropy::new(&body(), mass, [centre; 3], delta).unwrap_err();
        assert!(error.to_string().starts_with(what), "{error}");
    }
    let far = ScalarLaw::normal(1e40, 0.0).unwrap();
    assert!(NaiveBody::new(body(), NaiveRule::EntryNoise, far).is_err());
    let wide = LogCholeskyTen::about(&body(), SMatrix::identity() * 9.0).unwrap_err();
    assert!(wide.to_string().starts_with("coordinate 1 "), "{wide}");
}

proptest! {
    #[test]
    fn nothing_panics(x in prop::array::uniform5(prop::num::f64::ANY)) {
        let law = MaximumEntropy::new(&body(), x[0], [x[1], x[2], x[3]], x[4]);
        let _ = law.map(|law| law.draw(&mut ChaCha8Rng::seed_from_u64(1)));
        let law = PseudoInertiaWishart::new(&body(), x[0]);
        let _: Option<MassProperties> = law.ok().map(|law| law.sample(&mut ChaCha8Rng::seed_from_u64(1)));
    }
}
