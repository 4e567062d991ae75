//! What a mass centre adds, and what it cannot.

use super::*;

fn on_axes_or_tilted() -> impl Strategy<Value = Inertia> {
    let k = prop::array::uniform3(0.5..10.0_f64);
    let turn = prop::array::uniform3(-3.0..3.0_f64);
    (k, turn, prop::sample::select(vec![0.0, 0.01, 1.0])).prop_map(|(k, turn, tilt)| {
        let q = UnitQuaternion::from_scaled_axis(Vector3::from(turn) * tilt);
        Inertia::from_second_moments(SecondMoments::new(k).unwrap(), &q).unwrap()
    })
}

/// What is said of what the mass centre adds, and of what was needed to have it.
fn of_the_centre(model: &StatedModel) -> Vec<StatementWarning> {
    let is_of_it = |warning: &&StatementWarning| {
        use StatementWarning::{CentreBesideAxes, CentreMissed, Correlated};
        matches!(warning, Correlated | CentreMissed { .. } | CentreBesideAxes { .. })
    };
    model.warnings().iter().filter(is_of_it).copied().collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// A mass centre that adds no more than axes scatter that are held still gives rise to no warning, whether it is known wholly,
    /// or along some axes, or along none.
    #[test]
    fn a_centre_that_adds_nothing_has_no_warning(
        nominal in on_axes_or_tilted(),
        known in prop::array::uniform3(any::<bool>()),
        log_mm in -4.0..-0.5_f64,
    ) {
        let off = 1e-3 * libm::pow(10.0, log_mm);
        let centre = CentreStatement::new(known.map(|known| if known { 0.0 } else { off }), 1.0, [0.0; 3]).unwrap();
        let model = Statements { centre: Some(centre), ..Statements::default() };
        let model = model.model(&nominal, Some(20.0)).unwrap();
        prop_assert!(of_the_centre(&model).is_empty(), "{:?}", model.warnings());
        let most = 3e-6 * nominal.matrix().trace();
        prop_assert!(model.implied().deviations().iter().all(|d| *d < most), "{:?}", model.implied().deviations());
    }

    /// One that is uncertain along one axis of the body alone moves the two other moments, which come out, and nothing else is
    /// worth a word.
    #[test]
    fn a_centre_along_one_axis_moves_two_moments(
        k in prop::array::uniform3(0.5..10.0_f64),
        axis in 0..3_usize,
        log_mm in -1.0..1.5_f64,
        arm in prop::sample::select(vec![0.0, 0.1, 1.0]),
    ) {
        let nominal = Inertia::from_second_moments(SecondMoments::new(k).unwrap(), &UnitQuaternion::identity()).unwrap();
        let along = |x: f64| std::array::from_fn(|i| if i == axis { x } else { 0.0 });
        let off = 1e-3 * libm::pow(10.0, log_mm);
        prop_assume!(off * arm < 0.01);
        let centre = CentreStatement::new(along(off), 1.0, along(arm)).unwrap();
        let model = Statements { centre: Some(centre), ..Statements::default() };
        let model = model.model(&nominal, Some(20.0)).unwrap();
        prop_assert!(of_the_centre(&model).is_empty(), "{:?} {:?}", model.warnings(), model.implied().deviations());
        let (implied, added) = (model.implied().deviations(), centre.entry_variances(20.0).map(f64::sqrt));
        for e in (0..3).filter(|e| *e != axis) {
            prop_assert!((implied[e] - added[e]).abs() < 0.03 * added[e] + 1e-8 * nominal.matrix().trace(), "{implied:?} {added:?}");
        }
    }

    /// With and without moments and axes that are stated, every product of which nothing is stated has what the mass centre adds, or a
    /// warning names it; and beside axes there is that warning for no other product.
    #[test]
    fn no_product_misses_what_the_centre_adds_without_a_word(
        nominal in on_axes_or_tilted(),
        log_mm in prop::array::uniform3(-1.0..1.0_f64),
        arm in prop::array::uniform3(prop_oneof![Just(0.0), -1.0..1.0_f64]),
        degrees in prop::option::weighted(0.8, prop::array::uniform3(prop_oneof![1 => Just(0.0), 4 => 0.01..2.0_f64])),
        moments in any::<bool>(),
    ) {
        let centre = CentreStatement::new(log_mm.map(|x| 1e-3 * libm::pow(10.0, x)), 1.0, arm).unwrap();
        let axes = degrees.map(|degrees| AxesStatement::each(degrees, 1.0).unwrap());
        let moments = if moments { percent(3.0) } else { None };
        let stated = Statements { centre: Some(centre), axes, moments, ..Statements::default() };
        let model = stated.model(&nominal, Some(20.0)).unwrap();
        let (implied, alone) = (model.implied().deviations(), centre.entry_variances(20.0).map(f64::sqrt));
        let largest = alone[3..].iter().copied().fold(0.0, f64::max);
        for product in 3..6 {
            let names_it = |warning: &&StatementWarning| match warning {
                StatementWarning::CentreBesideAxes { entry, .. } | StatementWarning::CentreMissed { entry, .. } => *entry == product,
                _ => false,
            };
            let told = model.warnings().iter().filter(names_it).count();
            let (found, alone) = (implied[product], alone[product]);
            let misses = found < 0.96 * alone && alone - found > 2e-3 * largest + 4e-6 * nominal.matrix().trace();
            prop_assert!(told == 1 || !misses, "{product}: {found} {alone} {:?}", model.warnings());
            prop_assert!(told == 0 || axes.is_none() || found < alone, "{product}: {found} {alone} {:?}", model.warnings());
        }
    }
}
