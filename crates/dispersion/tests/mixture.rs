//! A law of inertia from outside of this crate: the mixture of the example is as good as a built-in one.

#[path = "../examples/mixture.rs"]
mod mixture;

use gyradius_dispersion::{
    DispersionModel, EntrywiseGaussian, InertiaLaw, ModelKind, RealizableOnly, Wishart,
};
use gyradius_inertia::{Inertia, InertiaMatrix};
use mixture::{Mixture, satellite};
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

/// Draws through the trait alone: moments to |z| < 4.5, every one of them a body, columns the same as one by one,
/// and the two variants apart.
#[test]
fn a_mixture_has_its_moments() {
    const N: usize = 60_000;
    let law: Box<dyn InertiaLaw> = Box::new(satellite().unwrap());
    assert!(law.is_realizable_by_construction() && law.acceptance().is_none());
    let moments = law.expected_moments().unwrap();
    let mut columns: [Vec<f64>; 6] = std::array::from_fn(|_| vec![0.0; N]);
    let rng = || ChaCha8Rng::seed_from_u64(9);
    law.draw_columns(&mut rng(), columns.each_mut().map(Vec::as_mut_slice)).unwrap();
    let mut one = rng();
    for row in 0..N {
        let inertia = law.draw(&mut one).inertia;
        assert!(inertia.is_realizable());
        assert_eq!(inertia.entries(), columns.each_ref().map(|c| c[row]));
    }
    for e in 0..6 {
        for f in 0..=e {
            let gap = |i: usize| {
                (columns[e][i] - moments.mean()[e]) * (columns[f][i] - moments.mean()[f])
            };
            let average = (0..N).map(gap).sum::<f64>() / N as f64;
            let spread = (0..N).map(|i| (gap(i) - average).powi(2)).sum::<f64>() / N as f64;
            let z = (average - moments.covariance()[(e, f)]) / (spread / N as f64).sqrt();
            assert!(z.abs() < 4.5, "covariance {e}{f}: {z}");
        }
        let mean = columns[e].iter().sum::<f64>() / N as f64;
        let z = (mean - moments.mean()[e]) / (moments.covariance()[(e, e)] / N as f64).sqrt();
        assert!(z.abs() < 4.5, "mean {e}: {z}");
    }
}

/// It goes where laws go: models are matched to its moments, and a mixture of any two laws promises no more than
/// both do.
#[test]
fn a_mixture_goes_where_laws_go() {
    let moments = satellite().unwrap().expected_moments().unwrap();
    for kind in [ModelKind::CorrelatedEntries, ModelKind::Wishart, ModelKind::LogCholesky] {
        let model = DispersionModel::matched(kind, &moments).unwrap().into_model();
        let found = model.law().expected_moments().unwrap();
        for (a, b) in found.mean().iter().zip(moments.mean()) {
            assert!((a - b).abs() < 1e-6 * 5e3, "{kind}: {a} {b}");
        }
    }
    let mean = InertiaMatrix::from_entries([5000.0, 4000.0, 3000.0], [20.0, 2.0, -50.0]).unwrap();
    let entries = || EntrywiseGaussian::new(mean, [100.0; 6]).unwrap();
    let laws = || -> [Box<dyn InertiaLaw>; 3] {
        let body = Inertia::try_from(mean).unwrap();
        [
            Box::new(entries()),
            Box::new(RealizableOnly::new(entries()).unwrap()),
            Box::new(Wishart::new(body, 0.1).unwrap()),
        ]
    };
    for first in 0..3 {
        for second in 0..3 {
            let [a, b] = [first, second].map(|i| laws().into_iter().nth(i).unwrap());
            let sound = a.is_realizable_by_construction() && b.is_realizable_by_construction();
            let known = a.expected_moments().is_some() && b.expected_moments().is_some();
            let both: Box<dyn InertiaLaw> = Box::new(Mixture::new(0.5, [a, b]).unwrap());
            assert_eq!(both.is_realizable_by_construction(), sound);
            assert_eq!(both.expected_moments().is_some(), known);
        }
    }
    assert!(Mixture::new(1.5, [Box::new(entries()), Box::new(entries())]).is_none());
}
