//! Values of laws at normal scores, far out and near each other.

use super::*;

/// However far out and however near two scores are, infinite ones too: values fall by no more than rounding of the largest
/// of them.
#[test]
fn values_fall_by_rounding_at_most() {
    let mut rng = ChaCha8Rng::seed_from_u64(22);
    let any: Vec<ScalarLaw> = (0..2000).map(|_| any_law(&mut rng)).collect();
    let one =
        ScalarLaw::truncated_normal(0.0, 3.0359111174516764, 4.057169114644934, 5.446566664865514);
    for law in laws().into_iter().chain(any).chain([one.unwrap()]) {
        let mut scores: Vec<f64> = (0..30).map(|_| rng.random_range(-40.0..40.0)).collect();
        scores.extend((0..30).map(|_| rng.random_range(-9.0..9.0)));
        scores.extend([-INF, INF, 8.0, 8.2]);
        scores.extend(scores.clone().into_iter().map(|z| z + 1e-9));
        scores.sort_by(f64::total_cmp);
        let size = law.at_score(-9.0).abs().max(law.at_score(9.0).abs());
        for pair in scores.windows(2) {
            let [x, above] = [pair[0], pair[1]].map(|z| law.at_score(z));
            let rounding = 1e-14 * size.max(x.abs());
            assert!(above >= x || above >= x - rounding, "{law:?} {pair:?}: {x:e} {above:e}");
        }
    }
}
