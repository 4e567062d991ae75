//! A separation that fails without any dispersion, which is told with its reason, and takes nothing away that is known without it.

use super::{
    Alert,
    tests::{NORMAL, ordinary, study},
};
use crate::{Scenario, quantity::Quantity, subject::Subject};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Whatever the horizon is: it is told if the nominal bodies do not part within it, and what follows from the inertia stays.
    #[test]
    fn a_nominal_separation_that_fails_is_told(share in prop_oneof![0.2..0.99_f64, 1.01..3.0_f64]) {
        let base = ordinary(20, 0.01, NORMAL);
        let release = base.separation().run(base.settings()).unwrap().release_time();
        let mut table: toml::Table = base.to_toml().parse().unwrap();
        let horizon = toml::Table::from_iter([("horizon_s".to_owned(), (share * release).into())]);
        table.insert("integration".to_owned(), horizon.into());
        let scenario = Scenario::from_toml(&toml::to_string(&table).unwrap()).unwrap();
        let (summary, _) = study(&scenario);
        let mut told = summary.head.alerts.iter().filter_map(|alert| match alert {
            Alert::NominalFailed { why } => Some(why.clone()),
            _ => None,
        });
        let error = scenario.separation().run(scenario.settings()).err();
        prop_assert_eq!(error.is_some(), share < 1.0);
        prop_assert_eq!(told.next(), error.map(|error| error.to_string()));
        prop_assert_eq!(told.next(), None);

        let (whole, _) = study(&base);
        for quantity in Quantity::of(scenario.separation()) {
            let alone = quantity.is_drawn() || [Quantity::Wobble, Quantity::InertiaRatio].contains(&quantity);
            let expected = whole.nominal_value(quantity).filter(|_| alone || share > 1.0);
            prop_assert_eq!(summary.nominal_value(quantity), expected, "{:?}", quantity);
        }
        let page = scenario.report(&summary).markdown();
        prop_assert_eq!(page.contains("The separation without any dispersion fails"), share < 1.0);
    }
}
