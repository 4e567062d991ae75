//! Products that the turns of the axes cannot make as large as is stated, and turns that change nothing.

use super::*;

/// ± 2° of the axes is ± (I_i − I_j)·2° of a product; both stated, the tighter one holds.
#[test]
fn the_tighter_of_axes_and_products_holds() {
    let nominal = body([5000.0, 4000.0, 3000.0], [0.0; 3]);
    let axes = Some(AxesStatement::each([1.0; 3], 1.0).unwrap());
    let alone = Statements { axes, ..Statements::default() }.model(&nominal, None).unwrap();
    let gaps = [1000.0, 2000.0, 1000.0];
    for (found, gap) in alone.implied().deviations()[3..].iter().zip(gaps) {
        assert!((found / (gap * 1_f64.to_radians()) - 1.0).abs() < 0.01);
    }
    assert_eq!(alone.warnings(), [StatementWarning::FixedMoments]);
    let both = Statements { axes, products: products(50.0, 3.0), ..Statements::default() };
    let model = both.model(&nominal, None).unwrap();
    let implied = model.implied().deviations();
    // 1° would be 17.5, 34.9, 17.5; 16.7 is stated.
    for found in &implied[3..] {
        assert!((found / (50.0 / 3.0) - 1.0).abs() < 0.01, "{implied:?}");
    }
    let said: String = model.warnings().iter().map(ToString::to_string).collect();
    assert!(
        said.contains("1.00°, 1.00°, 1.00°") && said.matches("0.96°, 0.48°, 0.96°").count() == 2,
        "{said}"
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// A product of two moments that are nearly equal is out of reach, and the others are what is stated of them all the same, with and without a limit of
    /// the axes.
    #[test]
    fn a_product_out_of_reach_spares_the_others(
        third in prop_oneof![0.1..0.8_f64, 1.2..1.9_f64],
        gap in prop_oneof![Just(0.0), (-4.0..-1.5_f64).prop_map(|power| libm::pow(10.0, power))],
        size in (-4.0..-1.5_f64).prop_map(|power| libm::pow(10.0, power)),
        degrees in prop::option::of(1.0..20.0_f64),
        place in 0..3_usize,
    ) {
        let mut moments = [1.0, 1.0 + gap, third];
        moments.rotate_right(place);
        let axes = degrees.map(|degrees| AxesStatement::each([degrees; 3], 1.0).unwrap());
        let products = Some(ProductsStatement::new([size; 3], 1.0).unwrap());
        let statements = Statements { products, axes, ..Statements::default() };
        let model = statements.model(&body(moments, [0.0; 3]), None).unwrap();
        let implied = model.implied().deviations();
        for (entry, [m, n]) in (3..).zip([[0, 1], [0, 2], [1, 2]]) {
            let turn = size / (moments[m] - moments[n]).abs();
            let limit = degrees.map_or(0.2, |degrees| degrees.to_radians().min(0.2));
            let share = implied[entry] / size;
            if turn < 0.8 * limit {
                prop_assert!((share - 1.0).abs() < 0.05, "{:?} {}: {:?}", moments, size, implied);
            }
            prop_assert!(share < 1.25, "{:?} {}: {:?}", moments, size, implied);
        }
    }

    /// A product that is stated far above the others, which are to be small or none, is not given up for them: turns about tilted axes that go together
    /// have it, as far as the axes may turn.
    #[test]
    fn one_large_product_is_had_beside_small_ones(
        gaps in prop::array::uniform2(0.1..0.4_f64),
        tilt in prop::array::uniform3(-0.05..0.05_f64),
        turn in (-3.0..-1.5_f64).prop_map(|power| libm::pow(10.0, power)),
        small in prop::array::uniform2(prop_oneof![Just(0.0), (-4.0..-1.5_f64).prop_map(|power| libm::pow(10.0, power))]),
        degrees in prop::option::of(0.5..10.0_f64),
        place in 0..3_usize,
    ) {
        let moments = [1.0 + gaps[0] + gaps[1], 1.0 + gaps[0], 1.0];
        let [m, n] = [[0, 1], [0, 2], [1, 2]][place];
        let gap = moments[m] - moments[n];
        let size = turn * gap;
        let mut stated = small.map(|share| share * size).to_vec();
        stated.insert(place, size);
        let stated = [stated[0], stated[1], stated[2]];
        let axes = degrees.map(|degrees| AxesStatement::each([degrees; 3], 1.0).unwrap());
        let products = Some(ProductsStatement::new(stated, 1.0).unwrap());
        let statements = Statements { products, axes, ..Statements::default() };
        let model = statements.model(&body(moments, tilt), None).unwrap();
        let implied = model.implied().deviations();
        let reach = degrees.map_or(size, |degrees| size.min(gap * degrees.to_radians()));
        prop_assert!(implied[3 + place] > 0.4 * reach, "{stated:?}: {implied:?}");
        for (found, stated) in implied[3..].iter().zip(stated) {
            prop_assert!(*found < stated + 0.02 * size, "{stated:?}: {implied:?}");
        }
    }

    /// Axes of which every stated turn mixes two equal moments that do not scatter are told to have no effect, and have none; others have one.
    #[test]
    fn turns_without_effect_are_told(
        k in prop::array::uniform3(1..4_u8),
        degrees in prop::array::uniform3(prop_oneof![Just(0.0), 0.5..20.0_f64]),
    ) {
        let nominal = Inertia::from_second_moments(
            SecondMoments::new(k.map(f64::from)).unwrap(),
            &UnitQuaternion::identity(),
        )
        .unwrap();
        let axes = Some(AxesStatement::each(degrees, 1.0).unwrap());
        let model = Statements { axes, ..Statements::default() }.model(&nominal, None).unwrap();
        let told = model.warnings().contains(&StatementWarning::AxesWithoutEffect);
        let moves = model.implied().deviations().into_iter().any(|deviation| deviation > 1e-4);
        let turns = degrees.iter().any(|turn| *turn > 0.0);
        prop_assert_eq!(told, turns && !moves, "{:?}", model.implied().deviations());
    }
}
