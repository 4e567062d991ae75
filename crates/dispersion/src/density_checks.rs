//! Densities of the six entries against draws, and against each other.

use gyradius_attitude::{FisherBingham, MeanHalf, RadiallyConstrainedGaussian, UniformAttitude};
use gyradius_inertia::{Inertia, InertiaMatrix, PrincipalAxes, RootSecondMoments};
use nalgebra::{Matrix3, Matrix4, SMatrix, SVector, UnitQuaternion, Vector4};
use proptest::prelude::*;
use rand::RngExt;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::Distribution;
use std::f64::consts::{LN_2, PI};

use crate::density_of_entries::{Bounded, ln_density_of_labels};
use crate::*;

type Laws = Vec<(&'static str, Box<dyn InertiaLaw>)>;

fn body(moments: [f64; 3], products: [f64; 3]) -> Inertia {
    InertiaMatrix::from_entries(moments, products).unwrap().try_into().unwrap()
}

fn roots(laws: [Result<ScalarLaw, ScalarLawError>; 3]) -> ScalarRoots {
    ScalarRoots::new(laws.map(Result::unwrap)).unwrap()
}

fn rcg(mean: [f64; 3], variances: [f64; 4]) -> RadiallyConstrainedGaussian {
    let mean = UnitQuaternion::from_euler_angles(mean[0], mean[1], mean[2]);
    RadiallyConstrainedGaussian::new(mean, Matrix4::from_diagonal(&variances.into())).unwrap()
}

fn diagonal(deviations: [f64; 6]) -> SMatrix<f64, 6, 6> {
    SMatrix::from_diagonal(&SVector::from(deviations.map(|d| d * d)))
}

/// Of every kind, most of them so wide that several labels, both lobes and both signs of a root matter.
fn laws() -> Laws {
    let mean = body([5.0, 4.0, 3.0], [0.3, 0.2, -0.5]);
    let wide = || {
        let normal = |mean| ScalarLaw::normal(mean, 0.4);
        roots([normal(1.0), normal(1.3), normal(1.8)])
    };
    let folded = roots([
        ScalarLaw::normal(0.3, 0.8),
        ScalarLaw::uniform(-1.0, 2.0),
        ScalarLaw::truncated_normal(1.0, 0.8, -0.7, 3.0),
    ]);
    let others = roots([
        ScalarLaw::lognormal(1.5, 0.4),
        ScalarLaw::weibull(0.1, 1.5, 3.0),
        ScalarLaw::beta(0.2, 2.5, 2.0, 3.0),
    ]);
    let c = Matrix3::new(0.2, 0.1, -0.05, 0.1, 0.3, 0.08, -0.05, 0.08, 0.15);
    let middle = RootSecondMoments::new([0.8, 1.2, 1.7]).unwrap();
    let correlated = CorrelatedRoots::new(middle, c).unwrap();
    let loose = rcg([0.4, -0.2, 0.9], [0.1, 0.2, 0.3, 1.0]);
    let tight = rcg([0.4, -0.2, 0.9], [0.01, 0.02, 0.03, 0.6]);
    let bingham = {
        let linear = Vector4::new(0.5, -1.0, 2.0, 1.0);
        FisherBingham::new(Matrix4::from_diagonal(&Vector4::new(5.0, 1.0, -2.0, 0.0)), linear)
    };
    let deviations = [1.0, 0.8, 0.7, 0.4, 0.5, 0.3];
    let mut joint = diagonal(deviations);
    joint[(0, 1)] = 0.5;
    joint[(1, 0)] = 0.5;
    joint[(3, 5)] = -0.07;
    joint[(5, 3)] = -0.07;
    let entrywise = EntrywiseGaussian::new(mean, deviations).unwrap();
    let correlated_entries = CorrelatedEntries::new(mean, joint).unwrap();
    let cholesky = diagonal([0.2, 0.15, 0.25, 0.3, 0.2, 0.1]);
    let still = InertiaMatrix::from_entries([5.0, 4.5, 3.0], [0.0; 3]).unwrap();
    let free = BasiliskDispersion::NO_BOUNDS;
    let twice = JacobianTwice::new(loose.clone()).unwrap();
    vec![
        ("uniform axes", Box::new(PrincipalDispersion::new(wide(), UniformAttitude))),
        ("whole sphere", Box::new(PrincipalDispersion::new(wide(), loose.clone()))),
        ("tight axes", Box::new(PrincipalDispersion::new(others, tight))),
        ("mean half", Box::new(PrincipalDispersion::new(wide(), MeanHalf::new(loose)))),
        ("jacobian twice", Box::new(PrincipalDispersion::new(wide(), twice))),
        ("fisher-bingham", Box::new(PrincipalDispersion::new(wide(), bingham.unwrap()))),
        ("folded", Box::new(PrincipalDispersion::new(folded, UniformAttitude))),
        ("correlated roots", Box::new(PrincipalDispersion::new(correlated, UniformAttitude))),
        ("entrywise", Box::new(entrywise)),
        ("correlated entries", Box::new(correlated_entries)),
        ("realizable only", Box::new(RealizableOnly::new(entrywise).unwrap())),
        ("log-cholesky", Box::new(LogCholeskyGaussian::about(&mean, cholesky).unwrap())),
        ("wishart", Box::new(Wishart::new(mean, 0.4).unwrap())),
        ("wide wishart", Box::new(Wishart::new(mean, 0.9).unwrap())),
        ("basilisk", Box::new(BasiliskDispersion::new(still, 0.8, free, 0.4).unwrap())),
        ("basilisk all round", Box::new(BasiliskDispersion::new(still, 0.8, free, 2.0).unwrap())),
        ("any body", Box::new(AnyBody::new(4.0, 9.0).unwrap())),
    ]
}

/// How draws and a density agree in a few places: a Gaussian g there, half as wide as the law, has the mean of g/p
/// over draws of p equal to the share of g where p is not zero; and a box as many draws as the density, integrated by
/// uniform points, says. Ratios of found to expected with their standard errors.
fn compare(
    law: &dyn InertiaLaw,
    ln_density: &dyn Fn(&InertiaMatrix) -> f64,
    seed: u64,
    n: usize,
) -> Vec<[f64; 2]> {
    const PLACES: usize = 3;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let draws: Vec<InertiaMatrix> = (0..n).map(|_| law.draw(&mut rng).inertia).collect();
    let points: Vec<SVector<f64, 6>> = draws.iter().map(|x| x.entries().into()).collect();
    let of_draws: Vec<f64> = draws.iter().map(ln_density).collect();
    let mean = points.iter().sum::<SVector<f64, 6>>() / n as f64;
    let covariance = points.iter().fold(SMatrix::<f64, 6, 6>::zeros(), |sum, x| {
        sum + (x - mean) * (x - mean).transpose() / n as f64
    });
    let deviations = covariance.diagonal().map(f64::sqrt);
    let mean_of = |x: &[f64]| {
        let n = x.len() as f64;
        let mean = x.iter().sum::<f64>() / n;
        [mean, (x.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / n / n).sqrt()]
    };
    let mut found = Vec::new();
    for place in 0..PLACES {
        // Between the mean and a draw.
        let centre = mean + (points[place] - mean) * 0.4;
        let at = |x: &SVector<f64, 6>| {
            InertiaMatrix::from_entries([x[0], x[1], x[2]], [x[3], x[4], x[5]]).unwrap()
        };
        let narrow = CorrelatedEntries::new(at(&centre), covariance * 0.25).unwrap();
        let ratios: Vec<f64> = draws
            .iter()
            .zip(&of_draws)
            .map(|(x, p)| (narrow.ln_density(x).unwrap() - p).exp())
            .collect();
        let inside: Vec<f64> = (0..n / 4)
            .map(|_| f64::from(u8::from(ln_density(&narrow.sample(&mut rng)) > f64::NEG_INFINITY)))
            .collect();
        let (a, b) = (mean_of(&ratios), mean_of(&inside));
        found.push([a[0] / b[0], a[1].hypot(b[1]) / b[0]]);

        let half = deviations * 0.7;
        let hits: Vec<f64> = points
            .iter()
            .map(|x| f64::from(u8::from((0..6).all(|e| (x[e] - centre[e]).abs() < half[e]))))
            .collect();
        let volume = half.iter().map(|h| 2.0 * h).product::<f64>();
        let densities: Vec<f64> = (0..n)
            .map(|_| {
                let x = SVector::<f64, 6>::from_fn(|e, _| {
                    centre[e] + half[e] * rng.random_range(-1.0..1.0)
                });
                ln_density(&at(&x)).exp() * volume
            })
            .collect();
        let (a, b) = (mean_of(&hits), mean_of(&densities));
        found.push([a[0] / b[0], (a[1] / a[0]).hypot(b[1] / b[0]) * a[0] / b[0]]);
    }
    found
}

#[test]
fn densities_are_those_of_the_draws() {
    let mut sharp = 0;
    for (i, (name, law)) in laws().iter().enumerate() {
        let density = |x: &InertiaMatrix| law.ln_density(x).unwrap();
        for [ratio, error] in compare(&**law, &density, i as u64, 60_000) {
            assert!(error < 0.15, "{name}: {ratio} ± {error}");
            sharp += usize::from(error < 0.04);
            assert!((ratio - 1.0).abs() < 4.0 * error, "{name}: {ratio} ± {error}");
        }
    }
    assert!(sharp > 80, "{sharp} of 102");
}

/// What is easily forgotten is seen.
#[test]
fn wrong_densities_are_found_out() {
    let all = laws();
    let law = |name: &str| &all.iter().find(|law| law.0 == name).unwrap().1;
    let seen = |name: &str, density: &dyn Fn(&InertiaMatrix) -> f64| {
        let found = compare(&**law(name), density, 100, 20_000);
        assert!(found.iter().any(|[ratio, error]| (ratio - 1.0).abs() > 8.0 * error), "{name}");
    };
    for name in ["whole sphere", "wishart", "log-cholesky", "any body", "basilisk"] {
        let right = |x: &InertiaMatrix| law(name).ln_density(x).unwrap();
        // dI for dΣ, and surface measure on S³ for rotation vectors.
        seen(name, &|x| right(x) + LN_2);
        seen(name, &|x| right(x) + 3.0 * LN_2);
        seen(name, &|x| right(x) - 0.3);
    }
    // Labels left out: one order of the axes, and one way to point them.
    let loose = rcg([0.4, -0.2, 0.9], [0.1, 0.2, 0.3, 1.0]);
    let normal = |mean| ScalarLaw::normal(mean, 0.4);
    let wide = roots([normal(1.0), normal(1.3), normal(1.8)]);
    let labels = |orders: usize, ways: usize| {
        let (loose, wide) = (loose.clone(), wide.clone());
        move |x: &InertiaMatrix| {
            if !x.is_realizable() {
                return f64::NEG_INFINITY;
            }
            let axes = x.principal_axes();
            let k = axes.second_moments().map(|k| k.max(0.0));
            let mut densities = wide.ln_densities_in_orders(k).unwrap();
            densities[orders..].fill(f64::NEG_INFINITY);
            let mut way = 0;
            let density = |q: &UnitQuaternion<f64>| {
                way += 1;
                let kept = (way - 1) % 4 < ways;
                if kept { loose.ln_haar_density(q) } else { f64::NEG_INFINITY }
            };
            ln_density_of_labels(&axes, densities, Bounded { density, at_most: f64::INFINITY })
                - LN_2
        }
    };
    let all_labels = compare(&**law("whole sphere"), &labels(6, 4), 100, 20_000);
    assert!(all_labels.iter().all(|[ratio, error]| (ratio - 1.0).abs() < 4.0 * error));
    seen("whole sphere", &labels(1, 4));
    seen("whole sphere", &labels(3, 4));
    seen("whole sphere", &labels(6, 1));
    // Roots that are not folded.
    let folded = [
        ScalarLaw::normal(0.3, 0.8).unwrap(),
        ScalarLaw::uniform(-1.0, 2.0).unwrap(),
        ScalarLaw::truncated_normal(1.0, 0.8, -0.7, 3.0).unwrap(),
    ];
    seen("folded", &|x| {
        let axes = x.principal_axes();
        let k = axes.second_moments().map(|k| k.max(0.0).sqrt());
        let densities = PrincipalAxes::ORDERS.map(|(order, _)| {
            (0..3).map(|i| folded[i].ln_density(k[order[i]]).unwrap() - (2.0 * k[i]).ln()).sum()
        });
        if !x.is_realizable() {
            return f64::NEG_INFINITY;
        }
        ln_density_of_labels(&axes, densities, Bounded { density: |_: &_| 0.0, at_most: 0.0 })
            - LN_2
    });
}

/// The mean of p/h over draws of h is 1, if h covers p: each of random laws under that of any body.
#[test]
fn densities_are_normalised() {
    const N: usize = 100_000;
    let any = AnyBody::new(0.3, 300.0).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(200);
    let draws: Vec<(InertiaMatrix, f64)> = (0..N)
        .map(|_| InertiaMatrix::from(Distribution::<Inertia>::sample(&any, &mut rng)))
        .map(|x| (x, any.ln_density(&x).unwrap()))
        .collect();
    for _ in 0..25 {
        let root = |rng: &mut ChaCha8Rng| match rng.random_range(0..4) {
            0 => ScalarLaw::lognormal(rng.random_range(1.0..2.0), rng.random_range(0.4..0.8)),
            1 => ScalarLaw::uniform(rng.random_range(-2.0..0.5), rng.random_range(1.5..3.0)),
            2 => ScalarLaw::normal(rng.random_range(-2.0..2.0), rng.random_range(0.5..1.0)),
            _ => ScalarLaw::triangular(0.1, rng.random_range(0.2..2.0), rng.random_range(2.0..3.0)),
        };
        let laws = [(); 3].map(|()| root(&mut rng));
        let q = UniformAttitude.sample(&mut rng).euler_angles();
        let variances = [(); 4].map(|()| rng.random_range(0.1..1.0));
        let axes = rcg([q.0, q.1, q.2], variances);
        let delta = rng.random_range(0.4..0.8);
        let mean = body([5.0, 4.0, 3.0], [0.3, 0.2, -0.5]);
        let candidates: [Box<dyn InertiaLaw>; 3] = [
            Box::new(PrincipalDispersion::new(roots(laws.clone()), UniformAttitude)),
            Box::new(PrincipalDispersion::new(roots(laws), axes)),
            Box::new(Wishart::new(mean, delta).unwrap()),
        ];
        for law in candidates {
            let ratios: Vec<f64> =
                draws.iter().map(|(x, h)| (law.ln_density(x).unwrap() - h).exp()).collect();
            let mean = ratios.iter().sum::<f64>() / N as f64;
            let square = ratios.iter().map(|r| (r - mean) * (r - mean)).sum::<f64>();
            let error = square.sqrt() / N as f64;
            // What lies below the smallest trace or above the largest is not seen.
            let outside = (0..2000)
                .filter(|_| {
                    let trace = law.draw(&mut rng).inertia.matrix().trace();
                    !(0.3..=300.0).contains(&trace)
                })
                .count() as f64
                / 2000.0;
            assert!(outside < 0.02 && error < 0.08, "{law:?}: {outside} {error}");
            let gap = (mean - 1.0 + outside).abs();
            assert!(
                gap < 4.0 * error + 4.0 * (outside / 2000.0).sqrt(),
                "{law:?}: {mean} ± {error}"
            );
        }
    }
}

/// Where nothing is said of the axes, 8π²/24 Π |I_i − I_j| p(I) dI₁ dI₂ dI₃ is a density of the moments: by the
/// trapezoidal rule over the logarithms of the K.
#[test]
fn a_ball_of_wishart_integrates_to_one() {
    for (delta, size) in [(0.25, 1e-60), (0.6, 1.0), (0.95, 1e60)] {
        let law = Wishart::new(body([2.0 * size; 3], [0.0; 3]), delta).unwrap();
        // ln K₁ evenly, and the logarithms of K₂/K₁ and K₃/K₂ as squares, so that the rule sees no edge at zero.
        let (low, range) =
            (-10.0 * delta - 30.0 * delta.powi(4), 14.0 * delta + 30.0 * delta.powi(4));
        const STEPS: i32 = 100;
        let step = range / f64::from(STEPS);
        let root = (0.9 * range).sqrt() / f64::from(STEPS);
        let mut sum = 0.0;
        for i in 0..STEPS {
            for j in 1..STEPS {
                for l in 1..STEPS {
                    let (s, t) = (root * f64::from(j), root * f64::from(l));
                    let first = (low + step * f64::from(i)).exp();
                    let k = [first, first * (s * s).exp(), first * (s * s + t * t).exp()];
                    let moments = [k[1] + k[2], k[0] + k[2], k[0] + k[1]].map(|m| m * size);
                    let x = InertiaMatrix::from_entries(moments, [0.0; 3]).unwrap();
                    let density = (law.ln_density(&x).unwrap() + 6.0 * size.ln()).exp();
                    let gaps = (k[1] - k[0]) * (k[2] - k[1]) * (k[2] - k[0]);
                    // dI₁ dI₂ dI₃ = 2 dK₁ dK₂ dK₃, and one of six orders is summed.
                    let volume = 2.0 * k.iter().product::<f64>() * 4.0 * s * t;
                    sum += density * gaps * volume * step * root * root;
                }
            }
        }
        let whole = sum * 6.0 * 8.0 * PI * PI / 24.0;
        assert!((whole - 1.0).abs() < 1e-6, "{delta}: {whole}");
    }
}

/// However narrow: about its mean a Wishart law of 4e12 degrees of freedom is Gaussian with its own covariance.
#[test]
fn a_narrow_wishart_is_gaussian() {
    let mean = body([5.0, 4.0, 3.0], [0.3, 0.2, -0.5]);
    let law = Wishart::new(mean, 1e-6).unwrap();
    let gaussian = CorrelatedEntries::new(mean, *law.entry_moments().covariance());
    let gaussian = gaussian.unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(300);
    for _ in 0..1000 {
        let x: Inertia = law.sample(&mut rng);
        let found = law.ln_density(&x.into()).unwrap();
        let expected = gaussian.ln_density(&x.into()).unwrap();
        assert!((found - expected).abs() < 1e-4, "{found} {expected}");
    }
}

proptest! {
    /// p(c I) = p(I)/c⁶ under the law that is c times as large, and turned body axes change nothing.
    #[test]
    fn size_and_frame_do_not_matter(
        moments in prop::array::uniform3(1.0..2.0f64),
        products in prop::array::uniform3(-0.2..0.2f64),
        exponent in -190..190i32,
        delta in 0.01..1.4f64,
        seed in 0..u64::MAX,
    ) {
        let c = 2f64.powi(exponent);
        let mean = body(moments, products);
        let large = |x: &Inertia| Inertia::new(x.matrix() * c).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let turn = UniformAttitude.sample(&mut rng);
        let law = Wishart::new(mean, delta).unwrap();
        let x: Inertia = law.sample(&mut rng);
        let here = law.ln_density(&x.into()).unwrap();
        let scaled = Wishart::new(large(&mean), delta).unwrap().ln_density(&large(&x).into()).unwrap();
        let turned = Wishart::new(mean.rotated(&turn).unwrap(), delta).unwrap();
        let turned = turned.ln_density(&x.rotated(&turn).unwrap().into()).unwrap();
        // A second moment that is near none has lost its digits.
        let room = 1e-9 * (1.0 + here.abs()) / x.second_moments().values().into_iter().fold(1.0, f64::min);
        prop_assume!(room < 1.0);
        prop_assert!((here - scaled - 6.0 * c.ln()).abs() < 1e-6 + room, "{} {}", here, scaled);
        prop_assert!((here - turned).abs() < 1e-6 + room, "{} {}", here, turned);

        let any = AnyBody::new(0.01, 100.0).unwrap();
        let here = any.ln_density(&x.into()).unwrap();
        prop_assert!((here - any.ln_density(&x.rotated(&turn).unwrap().into()).unwrap()).abs() < 1e-6);
        let scaled = AnyBody::new(0.01 * c, 100.0 * c).unwrap().ln_density(&large(&x).into()).unwrap();
        prop_assert!((here - scaled - 6.0 * c.ln()).abs() < 1e-9 * (1.0 + scaled.abs()));
    }
}

/// Every model at run time has the density of the law inside, of any matrix, without a NaN; laws without one say so
/// of every matrix.
#[test]
fn models_have_the_density_or_none() {
    let mean = body([5e3, 4e3, 3e3], [20.0, 2.0, -50.0]);
    let moments = KnownMoments::entry_moments(&Wishart::new(mean, 0.05).unwrap());
    let matrix = |m: [f64; 3], p: [f64; 3]| InertiaMatrix::from_entries(m, p).unwrap();
    let matrices = [
        matrix([5e3, 4e3, 3e3], [20.0, 2.0, -50.0]),
        matrix([5e3, 1e3, 3e3], [20.0, 2.0, -50.0]),
        matrix([5e3; 3], [0.0; 3]),
        matrix([0.0; 3], [0.0; 3]),
        matrix([3.0, 2.0, 1.0], [0.0; 3]),
        matrix([-1.0, 2.0, 1.0], [1e3, -1e5, 0.0]),
        matrix([1e300, 1e300, 1e-300], [0.0; 3]),
        matrix([1e-300, 1e-300, 1.5e-300], [0.0; 3]),
    ];
    for kind in ModelKind::ALL {
        let model = DispersionModel::matched(kind, &moments).unwrap().into_model();
        // About a body with products of inertia the density of Basilisk's dispersion is not known.
        assert_eq!(model.ln_density(&matrices[0]).is_some(), kind != ModelKind::Basilisk, "{kind}");
        for x in &matrices {
            let density = model.ln_density(x);
            assert!(density.is_none_or(|p| !p.is_nan()), "{kind} {x:?}");
            assert_eq!(density, model.law().ln_density(x));
            assert_eq!(density.is_some(), kind != ModelKind::Basilisk, "{kind}");
            if model.is_realizable_by_construction() && !x.is_realizable() {
                assert!(density.is_none_or(|p| p == f64::NEG_INFINITY), "{kind} {x:?}");
            }
        }
    }
    let k = mean.second_moments().roots();
    let normal = ScalarRoots::normal(k, [1.0; 3]).unwrap();
    let fixed = FixedAttitude::new(UnitQuaternion::identity());
    let sure = ScalarRoots::normal(k, [1.0, 0.0, 1.0]).unwrap();
    let rigid = CorrelatedRoots::new(k, Matrix3::from_element(0.5)).unwrap();
    let seen = EmpiricalRoots::new(&[k]).unwrap();
    let flat = CorrelatedEntries::new(mean, SMatrix::from_element(4.0)).unwrap();
    let plate = body([1.0, 2.0, 3.0], [0.0; 3]);
    let still = matrix([5e3, 4e3, 3e3], [0.0; 3]);
    let free = BasiliskDispersion::NO_BOUNDS;
    let basilisk = |x: InertiaMatrix, d, b, a| BasiliskDispersion::new(x, d, b, a).unwrap();
    let none: [Box<dyn InertiaLaw>; 13] = [
        Box::new(PrincipalDispersion::new(normal, fixed)),
        Box::new(PrincipalDispersion::new(sure, UniformAttitude)),
        Box::new(PrincipalDispersion::new(rigid, UniformAttitude)),
        Box::new(PrincipalDispersion::new(seen, UniformAttitude)),
        Box::new(EntrywiseGaussian::new(mean, [1.0, 1.0, 1.0, 1.0, 0.0, 1.0]).unwrap()),
        Box::new(flat),
        Box::new(RealizableOnly::new(flat).unwrap()),
        Box::new(Wishart::new(mean, 0.0).unwrap()),
        Box::new(Wishart::new(plate, 0.5).unwrap()),
        Box::new(AnyBody::new(1.0, 1.0).unwrap()),
        Box::new(basilisk(still, 1.0, [-1.0, 1.0], 0.1)),
        Box::new(basilisk(still, 0.0, free, 0.1)),
        Box::new(basilisk(still, 1.0, free, 0.0)),
    ];
    for law in &none {
        assert!(matrices.iter().all(|x| law.ln_density(x).is_none()), "{law:?}");
    }
}
