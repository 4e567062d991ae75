//! Laws that are realizable by construction, over random parameters: no draw may be unrealizable.
//!
//! A million draws by default. The long run, a hundred million in some minutes:
//! `cargo test --release -p gyradius-dispersion --test realizable -- --ignored`

#![allow(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use gyradius_attitude::{
    AboutAxis, FisherBingham, MeanHalf, RadiallyConstrainedGaussian, UniformAttitude,
};
use gyradius_dispersion::{
    AnyBody, AxesLaw, CorrelatedRoots, DispersionModel, EmpiricalRoots, EntrywiseGaussian,
    FixedAttitude, JacobianTwice, LogCholeskyGaussian, PrincipalDispersion, RealizableOnly,
    RootLaw, ScalarRoots, Wishart,
};
use gyradius_inertia::{Inertia, InertiaMatrix, RootSecondMoments};
use nalgebra::{Matrix3, Matrix4, SMatrix, UnitQuaternion, Vector3};
use rand::{Rng, RngExt};
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::{Distribution, StandardNormal};

/// Draws from one law before the next is made.
const DRAWS: usize = 2000;

fn normal(rng: &mut impl Rng) -> f64 {
    StandardNormal.sample(rng)
}

/// A number spread over powers of ten.
fn power(rng: &mut impl Rng, low: f64, high: f64) -> f64 {
    10f64.powf(low + rng.random::<f64>() * (high - low))
}

fn any_roots(rng: &mut impl Rng) -> RootLaw {
    let scale = power(rng, -6.0, 6.0);
    // Every third one of the roots is nearly nothing: plates and rods.
    let k: [f64; 3] = std::array::from_fn(|_| {
        let thin = if rng.random_range(0..3) == 0 { power(rng, -9.0, 0.0) } else { 1.0 };
        scale * thin * rng.random::<f64>()
    });
    let variances: [f64; 3] = std::array::from_fn(|i| (k[i] * power(rng, -6.0, 1.0)).powi(2));
    let mean = RootSecondMoments::new(k).unwrap();
    match rng.random_range(0..6) {
        0 => ScalarRoots::normal(mean, variances).unwrap().into(),
        1 => ScalarRoots::uniform(mean, variances).unwrap().into(),
        2 => {
            let positive = k.map(|k| k.max(1e-300));
            let mean = RootSecondMoments::new(positive).unwrap();
            let variances = std::array::from_fn(|i| variances[i].min(positive[i].powi(2)));
            ScalarRoots::lognormal(mean, variances).unwrap().into()
        }
        3 => {
            let bounds = std::array::from_fn(|i| {
                let s = variances[i].sqrt();
                [k[i] - s * rng.random::<f64>() - 1e-3 * s, k[i] + 3.0 * s]
            });
            ScalarRoots::truncated_normal(mean, variances, bounds).unwrap().into()
        }
        4 => {
            let f = Matrix3::from_fn(|i, _| variances[i].sqrt() * normal(rng));
            CorrelatedRoots::new(mean, f * f.transpose()).unwrap().into()
        }
        _ => {
            let samples: Vec<[f64; 3]> =
                (0..20).map(|_| k.map(|k| k * (1.0 + 0.3 * normal(rng)))).collect();
            EmpiricalRoots::from_values(&samples).unwrap().into()
        }
    }
}

fn any_axes(rng: &mut impl Rng) -> AxesLaw {
    let mean: UnitQuaternion<f64> = UniformAttitude.sample(rng);
    let variances =
        Matrix4::from_diagonal(&nalgebra::Vector4::from_fn(|_, _| power(rng, -6.0, 1.0)));
    let law = |rng: &mut dyn Rng| {
        // Cells take milliseconds to set up; every other law is drawn by a chart or uniformly.
        let covariance = if rng.random_range(0..8) == 0 {
            variances
        } else {
            Matrix4::identity() * variances[(0, 0)]
        };
        RadiallyConstrainedGaussian::new(mean, covariance).unwrap()
    };
    match rng.random_range(0..8) {
        0 | 1 => law(rng).into(),
        2 => MeanHalf::new(law(rng)).into(),
        3 => JacobianTwice::new(law(rng)).map_or(UniformAttitude.into(), AxesLaw::from),
        4 => UniformAttitude.into(),
        5 => AboutAxis::new(mean, Vector3::x_axis()).into(),
        6 => {
            let linear = mean.coords * power(rng, -1.0, 1.0);
            FisherBingham::new(Matrix4::identity(), linear).unwrap().into()
        }
        _ => FixedAttitude::new(mean).into(),
    }
}

fn any_model(rng: &mut ChaCha8Rng) -> DispersionModel {
    let body: Inertia = AnyBody::new(1e-6, 1e6).unwrap().sample(rng);
    match rng.random_range(0..8) {
        0 => {
            let delta = 1.41 * rng.random::<f64>();
            Wishart::new(body, delta.max(1e-6)).unwrap().into()
        }
        1 => {
            let size = power(rng, -4.0, 0.3);
            let f = SMatrix::<f64, 6, 6>::from_fn(|_, _| size * normal(rng));
            match LogCholeskyGaussian::about(&body, f * f.transpose()) {
                Ok(law) => law.into(),
                Err(_) => Wishart::new(body, 0.5).unwrap().into(),
            }
        }
        2 => {
            let trace = body.matrix().trace();
            let deviation = trace * power(rng, -5.0, -0.5);
            let law = EntrywiseGaussian::new(body, [deviation; 6]).unwrap();
            match RealizableOnly::new(law) {
                Ok(law) if law.acceptance() > 0.05 => law.into(),
                _ => Wishart::new(body, 0.7).unwrap().into(),
            }
        }
        _ => PrincipalDispersion::new(any_roots(rng), any_axes(rng)).into(),
    }
}

fn none_is_unrealizable(draws: usize, seed: u64) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    for _ in 0..draws.div_ceil(DRAWS) {
        let model = any_model(&mut rng);
        assert!(model.kind().is_realizable_by_construction());
        for _ in 0..DRAWS {
            let draw: InertiaMatrix = model.sample(&mut rng);
            assert!(draw.is_realizable(), "{draw:?} from {model:?}");
        }
    }
}

#[test]
fn none_of_a_million_draws_is_unrealizable() {
    none_is_unrealizable(1_000_000, 1);
}

#[test]
#[ignore = "minutes"]
fn none_of_a_hundred_million_draws_is_unrealizable() {
    std::thread::scope(|scope| {
        for part in 0..4 {
            scope.spawn(move || none_is_unrealizable(25_000_000, 2 + part));
        }
    });
}

/// A law that does not keep to bodies fails the same test.
#[test]
fn the_test_would_notice() {
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let bad = (0..100)
        .map(|_| {
            let body: Inertia = AnyBody::new(1.0, 1.0).unwrap().sample(&mut rng);
            EntrywiseGaussian::new(body, [0.03; 6]).unwrap().sample(&mut rng)
        })
        .filter(|draw| !draw.is_realizable())
        .count();
    assert!(bad > 10, "{bad}");
}
