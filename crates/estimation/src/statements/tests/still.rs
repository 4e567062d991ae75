//! Moments that are stated not to scatter.

use super::*;

/// A moment that is stated not to scatter is held as far as it can be, and not at the cost of the others.
#[test]
fn moments_of_no_deviation_are_held() {
    for products in [[0.0; 3], [20.0, 2.0, -50.0], [300.0, 200.0, -400.0]] {
        let nominal = body([5000.0, 4000.0, 3000.0], products);
        for (percents, mass) in (1..8)
            .map(|bits| [1, 2, 4].map(|bit| if bits & bit > 0 { 4.0 } else { 0.0 }))
            .flat_map(|p| [(p, None), (p, MassStatement::percent(1.0, 1.0).ok())])
        {
            let moments = MomentsStatement::new(Amount::Percent(percents), 1.0).ok();
            let statements = Statements { moments, mass, ..Statements::default() };
            let model = statements.model(&nominal, None).unwrap();
            let implied = model.implied().deviations();
            let said = format!("{percents:?} of {products:?}: {implied:?} {:?}", model.warnings());
            for e in 0..3 {
                let stated = 0.01 * percents[e] * nominal.entries()[e];
                let off = if stated > 0.0 { 0.03 * stated } else { 0.05 * 200.0 };
                assert!((implied[e] - stated).abs() <= off, "{said}");
                let missed = |w: &&StatementWarning| matches!(w, StatementWarning::Missed { entry, .. } if *entry == e);
                let warning = model.warnings().iter().find(missed).map(ToString::to_string);
                // What is left of it is said.
                assert!(
                    stated > 0.0
                        || implied[e] < 0.1
                        || warning.is_some_and(|w| w.contains("no deviation is stated")),
                    "{said}"
                );
            }
        }
    }
}
