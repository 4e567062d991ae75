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
                        || warning.is_some_and(|w| w.contains("a deviation of 0 kg·m² is stated")),
                    "{said}"
                );
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// About axes of the body itself nothing moves the products, so that products of which 0 is stated are as stated: what axes
    /// that are held to 2e-6 rad make of them is none. Tilted, they have a warning.
    #[test]
    fn products_that_stay_still_have_no_warning(
        k in prop::array::uniform3(1.0..9.0_f64),
        percents in prop::array::uniform3(1.0..5.0_f64),
        power in -6..9,
    ) {
        let scale = 10_f64.powi(power);
        let moments = [k[1] + k[2], k[2] + k[0], k[0] + k[1]].map(|i| i * scale);
        let statements = Statements {
            moments: Some(MomentsStatement::new(Amount::Percent(percents), 1.0).unwrap()),
            products: products(0.0, 1.0),
            ..Statements::default()
        };
        let missed = |nominal: &Inertia| {
            let model = statements.model(nominal, None).unwrap();
            let products = |w: &&StatementWarning| matches!(w, StatementWarning::Missed { entry: 3.., .. });
            (model.warnings().iter().filter(products).count(), model)
        };
        let own = body(moments, [0.0; 3]);
        let (count, model) = missed(&own);
        let largest = model.implied().deviations()[3..].iter().copied().fold(0.0, f64::max);
        prop_assert!(largest < 1e-5 * own.matrix().trace(), "{largest:e}");
        prop_assert_eq!(count, 0, "{:?}", model.warnings());
        let tilted = own.rotated(&UnitQuaternion::from_euler_angles(0.3, 0.4, 0.5)).unwrap();
        let (count, model) = missed(&tilted);
        prop_assert!(count > 0, "{:?}", model.implied().deviations());
    }
}
