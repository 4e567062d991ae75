//! The density of the joint law, held against other densities by the mean of their ratio, and against draws.

use gyradius_inertia::{Inertia, InertiaMatrix, MassProperties, Region, SecondMoments};
use nalgebra::{UnitQuaternion, Vector3};
use proptest::prelude::*;
use rand::RngExt;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::{Distribution, StandardNormal};

use super::tests::{any_law, scalar};
use super::*;
use crate::{AnyBody, ScalarLaw, Wishart};

const N: usize = 40_000;

/// A wide law of everything with a density that is written here anew.
struct Wide {
    inertia: Wishart,
    mass_width: f64,
    centre_width: f64,
}

impl Wide {
    fn draw(&self, rng: &mut ChaCha8Rng) -> (MassProperties, f64) {
        // Student's t with two degrees of freedom: tails wider than any law here.
        let mut t = |middle: f64, width: f64| {
            let z: f64 = StandardNormal.sample(rng);
            let chi: f64 = -2.0 * (1.0 - rng.random::<f64>()).ln();
            let t = z / (chi / 2.0).sqrt();
            let density = (2.0 + t * t).powf(-1.5) / width;
            (middle + width * t, density.ln())
        };
        loop {
            let width = self.centre_width;
            let parts = [t(9.0, self.mass_width), t(0.4, width), t(0.8, width), t(0.3, width)];
            if parts[0].0 > 0.0 {
                let inertia: Inertia = self.inertia.sample(rng);
                let own = crate::InertiaLaw::ln_density(&self.inertia, inertia.as_inertia_matrix());
                let centre = Vector3::new(parts[1].0, parts[2].0, parts[3].0);
                let ln: f64 = parts.iter().map(|p| p.1).sum::<f64>() + own.unwrap();
                // So many masses are drawn again.
                let end = 9.0 / self.mass_width;
                let kept = 0.5 * (1.0 + end / (2.0 + end * end).sqrt());
                return (MassProperties::new(parts[0].0, centre, inertia).unwrap(), ln - kept.ln());
            }
        }
    }
}

/// The mean over draws of a wide law of the density of another over its own is 1, where the first can draw all that the
/// second can. The wide one has the mean inertia of the other and second moments with a dispersion as given, which is followed
/// by the widths of the mass and of the mass centre.
pub(super) fn ratio(
    [i11, i22, i33, i12, i13, i23]: [f64; 6],
    [delta, mass_width, centre_width]: [f64; 3],
    of: impl Fn(&MassProperties) -> f64,
) -> (f64, f64) {
    let mean = InertiaMatrix::from_entries([i11, i22, i33], [i12, i13, i23]).unwrap();
    let inertia = Wishart::new(Inertia::try_from(mean).unwrap(), delta).unwrap();
    let wide = Wide { inertia, mass_width, centre_width };
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let ratios: Vec<f64> = (0..N)
        .map(|_| {
            let (body, ln) = wide.draw(&mut rng);
            (of(&body) - ln).exp()
        })
        .collect();
    let mean = ratios.iter().sum::<f64>() / N as f64;
    let spread = ratios.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / N as f64;
    (mean, (spread / N as f64).sqrt())
}

/// The mean inertia of a law.
pub(super) fn mean_inertia(law: &dyn MassPropertiesModel) -> [f64; 6] {
    let mean = *law.moments().unwrap().mean();
    std::array::from_fn(|i| mean[4 + i])
}

/// Laws with densities, wide enough for ratios.
fn laws() -> Vec<MassPropertiesLaw> {
    let lengths =
        || [(0.4, 0.1), (0.5, 0.12), (0.45, 0.08)].map(|(m, s)| ScalarLaw::normal(m, s).unwrap());
    let uniform = gyradius_attitude::UniformAttitude;
    let centre = || [scalar(0, 0.4, 0.2), scalar(1, 0.8, 0.2), scalar(2, 0.3, 0.2)];
    let new = |tensor| MassPropertiesLaw::new(scalar(2, 9.0, 1.5), centre(), tensor).unwrap();
    let plain = new(TensorLaw::gyration_lengths(lengths(), uniform));
    let roots = || [1.2, 1.5, 1.3].map(|m| ScalarLaw::normal(m, 0.3).unwrap());
    let mean = InertiaMatrix::from_entries([5.0, 4.0, 4.5], [0.1, 0.2, -0.3]).unwrap();
    let wishart = Wishart::new(Inertia::try_from(mean).unwrap(), 0.2).unwrap();
    use JointScalar::{Centre1, Centre3, Mass, Shape1, Shape3};
    vec![
        plain.clone(),
        plain.clone().with_correlation(&[(Mass, Centre1, 0.7)]).unwrap(),
        plain
            .with_correlation(&[(Mass, Shape1, 0.6), (Shape1, Shape3, -0.5), (Centre3, Mass, 0.3)])
            .unwrap(),
        new(TensorLaw::roots(roots(), uniform)),
        new(TensorLaw::roots(roots(), uniform).with_follows(0.5, 9.0).unwrap()),
        new(TensorLaw::model(wishart).unwrap().with_follows(1.0, 9.0).unwrap()),
    ]
}

#[test]
fn densities_have_the_integral_one() {
    for (i, law) in laws().into_iter().enumerate() {
        let wide = [if i == 5 { 0.35 } else { 0.8 }, 2.0, 0.3];
        let mean = mean_inertia(&law);
        let (found, error) = ratio(mean, wide, |body| law.ln_density(body).unwrap());
        assert!(error < 0.1, "{i}: {error}");
        assert!((found - 1.0).abs() < 4.0 * error, "law {i}: {found} ± {error}");
        // The control: Σ in place of I.
        let wrong = |body: &MassProperties| law.ln_density(body).unwrap() + std::f64::consts::LN_2;
        let (found, error) = ratio(mean, wide, wrong);
        assert!((found - 1.0).abs() > 4.0 * error, "law {i}: {found} ± {error}");
    }
}

/// Laws with infinite densities at their bounds, at bodies on and beyond the bounds of other scalars: no draw can be there,
/// however large the other factors are. On the bounds alone the density is infinite, and at no body is it no number.
#[test]
fn no_density_is_no_number() {
    let beta = |low: f64, high: f64| ScalarLaw::beta(low, high, 0.5, 2.0).unwrap();
    let weibull = ScalarLaw::weibull(0.4, 0.1, 0.5).unwrap();
    let normal = |sigma| ScalarLaw::normal(0.0, sigma).unwrap();
    let uniform = |low, high| ScalarLaw::uniform(low, high).unwrap();
    let lengths = [uniform(0.2, 0.25), weibull, uniform(0.6, 0.7)];
    let tensor = TensorLaw::gyration_lengths(lengths, gyradius_attitude::UniformAttitude);
    let centre = [beta(0.0, 0.1), normal(0.01), normal(0.01)];
    let plain = MassPropertiesLaw::new(uniform(10.0, 12.0), centre, tensor).unwrap();
    use JointScalar::{Centre1, Mass, Shape2};
    let tied = plain.clone().with_correlation(&[(Mass, Centre1, 0.5), (Mass, Shape2, 0.4)]);
    for law in [plain, tied.unwrap()] {
        for mass in [9.9, 10.0, 11.0, 12.0, 12.1] {
            for x in [-0.01, 0.0, 0.05, 0.1, 0.2] {
                for length in [0.1, 0.4, 0.45, 0.5] {
                    let k = [0.22, length, 0.65].map(|l: f64| l * l * mass);
                    let k = SecondMoments::new(k).unwrap();
                    let inertia = Inertia::from_second_moments(k, &UnitQuaternion::identity());
                    let inertia = inertia.unwrap();
                    let body = MassProperties::new(mass, [x, 0.0, 0.0], inertia).unwrap();
                    let found = law.ln_density(&body).unwrap();
                    let can_be =
                        (10.0..=12.0).contains(&mass) && (0.0..0.1).contains(&x) && length >= 0.4;
                    assert!(!found.is_nan(), "{mass} {x} {length}");
                    assert!(can_be || found == f64::NEG_INFINITY, "{mass} {x} {length}: {found}");
                }
            }
        }
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        assert!((0..100).all(|_| law.ln_density(&law.sample(&mut rng)).unwrap().is_finite()));
    }
}

/// Kept to a region the density is larger where draws are, and none elsewhere.
#[test]
fn densities_in_a_region_have_the_integral_one() {
    for region in [
        Region::ellipsoid([0.4, 0.8, 0.3], [0.9, 0.8, 1.0]).unwrap(),
        Region::solid_box([0.4, 0.8, 0.3], [0.55, 0.6, 0.6]).unwrap(),
    ] {
        let open = laws()[0].clone();
        let law = open.clone().inside(region.clone()).unwrap();
        let (share, error) = law.acceptance();
        assert!(share > 0.2 && share < 0.8 && error < 0.01, "{share}");
        let mean = mean_inertia(&open);
        let (found, own) = ratio(mean, [0.8, 2.0, 0.3], |body| law.ln_density(body).unwrap());
        assert!((found - 1.0).abs() < 4.0 * own.hypot(error / share), "{found} ± {own}");
        // The control: a region that is ignored.
        let (found, own) =
            ratio(mean, [0.8, 2.0, 0.3], |body| open.ln_density(body).unwrap() - share.ln());
        assert!((found - 1.0).abs() > 4.0 * own, "{found} ± {own}");
        let mut rng = ChaCha8Rng::seed_from_u64(10);
        for _ in 0..300 {
            let body: MassProperties = law.sample(&mut rng);
            assert!(region.room(&body) >= -1e-13);
            assert!(law.ln_density(&body).unwrap() > f64::NEG_INFINITY);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Every draw has a density where the law has one, and bodies of any kind never make a NaN.
    #[test]
    fn draws_have_a_density(law in any_law(), seed in any::<u64>()) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        for _ in 0..20 {
            let body: MassProperties = law.sample(&mut rng);
            if let Some(density) = law.ln_density(&body) {
                prop_assert!(density > f64::NEG_INFINITY, "{density}");
            }
            let any: Inertia = AnyBody::new(1e-3, 1e3).unwrap().sample(&mut rng);
            let any = MassProperties::new(rng.random_range(1e-3..1e3), body.mass_centre_m(), any).unwrap();
            let density = law.ln_density(&any);
            prop_assert!(density.is_none_or(|d| !d.is_nan()), "{density:?}");
            prop_assert_eq!(density.is_some(), law.ln_density(&body).is_some());
        }
    }
}

/// Of parts that are independent the density is the product, with the Jacobian of the lengths.
#[test]
fn parts_multiply() {
    let law = &laws()[0];
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let body: MassProperties = law.sample(&mut rng);
    let (m, c) = (body.mass_kg(), body.mass_centre_m());
    let own = crate::ScalarRoots::new(law.tensor().scalar_laws().unwrap().clone()).unwrap();
    let shape = crate::PrincipalDispersion::new(own, gyradius_attitude::UniformAttitude);
    let unit = InertiaMatrix::new(body.inertia().matrix() / m).unwrap();
    let scalars = law.mass().ln_density(m).unwrap()
        + (0..3).map(|i| law.centre()[i].ln_density(c[i]).unwrap()).sum::<f64>();
    let expected = scalars + shape.ln_density(&unit).unwrap() - 6.0 * m.ln();
    assert!((law.ln_density(&body).unwrap() - expected).abs() < 1e-9);
}
