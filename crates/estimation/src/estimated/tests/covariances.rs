//! Covariances of what does not vary, and of estimates that are read.

use super::*;

proptest::proptest! {
    /// What does not vary has no covariances: any that is stated is refused by its place, and the estimate without it is taken as it is.
    #[test]
    fn what_has_no_variance_has_no_covariances(
        seed in proptest::prelude::any::<u64>(),
        fixed in proptest::collection::btree_set(0_usize..10, 1..6),
        other in 0_usize..10,
        value in proptest::prop_oneof![-1e3..-1e-300, 1e-300..1e3],
    ) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mean = Ten::from([2.0, 0.0, 0.0, 0.1, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
        let varies = |i: usize| if fixed.contains(&i) { 0.0 } else { 1.0 };
        let s = Ten::from_fn(|i, _| varies(i) * rng.random_range(0.01..10.0));
        let c = random_correlation(&mut rng);
        let known = estimate(TenForm::Natural, mean, &s, &c);
        for (found, stated) in known.deviations().into_iter().zip(s.iter()) {
            proptest::prop_assert!((found - stated).abs() <= 1e-12 * stated);
        }
        for i in fixed.iter().copied().filter(|i| *i != other) {
            let mut covariance = *known.covariance();
            covariance[(i, other)] = value;
            covariance[(other, i)] = value;
            let found = TenEstimate::new(TenForm::Natural, mean, covariance);
            let (row, column) = (i.min(other) + 1, i.max(other) + 1);
            let fixed = if varies(row - 1) == 0.0 { row } else { column };
            proptest::prop_assert_eq!(found, Err(TenEstimateError::Fixed { row, column, value, fixed }));
        }
    }
}

/// What is written reads back to the bit, singular covariances too; correlations that rounding took beyond one are read as
/// they are made.
#[cfg(feature = "serde")]
#[test]
fn what_is_read_is_what_is_made() {
    let mut rng = ChaCha8Rng::seed_from_u64(267);
    let read = |estimate: &TenEstimate| {
        serde_json::from_str::<TenEstimate>(&serde_json::to_string(estimate).unwrap()).unwrap()
    };
    let mut moved = 0;
    for case in 0..200_usize {
        let scale = Ten::from_fn(|_, _| 10_f64.powf(rng.random_range(-6.0..6.0)));
        let rank = [1, 3, 10][case % 3];
        let covariance = (0..rank).fold(Matrix10::zeros(), |sum, _| {
            let a = scale.map(|s| s * rng.random_range(-1.0..1.0));
            sum + a * a.transpose()
        });
        let form = forms()[case % 2];
        let made = TenEstimate::new(form, scale, covariance).unwrap();
        assert_eq!(read(&made), made);
        let size = 1.0 + rng.random_range(1e-9..2e-8);
        let beyond = Matrix10::from_fn(|i, j| covariance[(i, j)] * if i == j { 1.0 } else { size });
        let Ok(expected) = TenEstimate::new(form, scale, beyond) else { continue };
        let found = read(&made.with(&scale, &beyond));
        let s = found.deviations();
        let correlation = |i: usize, j: usize| found.covariance()[(i, j)] / (s[i] * s[j]);
        assert!((0..100).all(|k| correlation(k / 10, k % 10).abs() < 1.0 + 1e-12), "{found:?}");
        moved += usize::from(found == expected);
    }
    assert!(moved > 100, "{moved}");
}
