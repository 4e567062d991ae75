//! Events that are not rare, for which nothing is searched for.

use super::*;

/// An event that a tenth of plain runs are needs no search: one level, plain runs with weights of one, and no warning. One that is just
/// rarer is searched for.
#[test]
fn what_is_not_rare_is_not_searched_for() {
    for (limit, is_rare) in
        [(-9.0, false), (-4.0, false), (0.5, false), (1.08, false), (1.5, true), (2.0, true)]
    {
        let probability = tail::normal(limit);
        let excess = |scores: &[f64], _: &mut ChaCha8Rng| sum(scores) - limit;
        let (mut covered, mut mean) = (0, 0.0);
        for seed in 0..20 {
            let search = searched(PLAN, &mut ChaCha8Rng::seed_from_u64(seed), &excess);
            assert_eq!(search.law().is_own(), !is_rare, "{probability}");
            assert_eq!(search.evaluations() == PLAN.per_level as u64, !is_rare, "{probability}");
            let found = estimate(PLAN, seed, &excess);
            assert!(is_rare || found.warnings().is_empty(), "{:?}", found.warnings());
            covered += u32::from(found.interval().contains(probability));
            mean += found.probability() / probability / 20.0;
            // Never surer than so many runs can be.
            assert!(found.interval().upper() - found.interval().lower() > 1.0 / PLAN.sample as f64);
        }
        // 15 of 20 or fewer are found in one of 400 cases at 95 %.
        assert!(covered >= 16 && (mean - 1.0).abs() < 0.03, "{probability}: {covered} {mean}");
    }
}
