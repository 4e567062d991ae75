//! Slender bodies, whose smallest moment the axes alone move by more than is stated of it.

use super::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Where the axes alone leave room, stated moments are met, if there is any share of the mass that the inertia can follow with
    /// which they are: if they are met when nothing is said of the mass.
    #[test]
    fn moments_do_not_miss_for_the_mass(
        k in prop::array::uniform3(0.02..1.0_f64),
        turn in prop::array::uniform3(-3.0..3.0_f64),
        moments in 1.0..30.0_f64,
        mass in 0.5..30.0_f64,
        degrees in 0.2..6.0_f64,
    ) {
        let q = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
        let nominal = Inertia::from_second_moments(SecondMoments::new(k).unwrap(), &q).unwrap();
        let without = Statements {
            moments: percent(moments),
            axes: Some(AxesStatement::each([degrees; 3], 1.0).unwrap()),
            ..Statements::default()
        };
        let mass = Some(MassStatement::percent(mass, 1.0).unwrap());
        let with = Statements { mass, ..without };
        let [with, without] = [with, without].map(|it| it.model(&nominal, None).unwrap());
        let axes = by_axes(&with);
        let stated = |e: usize| moments / 100.0 * nominal.entries()[e];
        let open: Vec<usize> = (0..3).filter(|e| axes[*e] < stated(*e)).collect();
        let miss = |model: &StatedModel| {
            let found = model.implied().deviations();
            open.iter().fold(0.0, |worst: f64, e| worst.max((found[*e] / stated(*e) - 1.0).abs()))
        };
        let (found, possible) = (miss(&with), miss(&without));
        prop_assert!(found < 0.025 || possible > 0.4 * found, "{found} {possible} {axes:?}");
    }

    /// A slender link, the moment about whose long axis the stated axes alone move by more than is stated of it: the inertia
    /// follows the mass wholly all the same, for less would bring that moment no nearer. Where axes and mass are more than is
    /// stated of another moment, it may follow less.
    #[test]
    fn axes_do_not_part_a_slender_link_from_its_mass(
        slender in -4.0..-1.0_f64,
        axis in 0..3_usize,
        degrees in 0.1..20.0_f64,
        mass in 1.0..12.0_f64,
        more in 1.1..3.0_f64,
    ) {
        let mut moments = [1.0; 3];
        moments[axis] = 10_f64.powf(slender);
        let nominal = body(moments, [0.0; 3]);
        let statements = Statements {
            moments: percent(mass * more),
            axes: Some(AxesStatement::each([degrees; 3], 1.0).unwrap()),
            mass: Some(MassStatement::percent(mass, 1.0).unwrap()),
            ..Statements::default()
        };
        let model = statements.model(&nominal, None).unwrap();
        let follows = model.mass().unwrap().inertia_follows();
        let found = model.implied().deviations();
        let stated = mass * more / 100.0;
        let (entries, alone) = (nominal.entries(), by_axes(&model));
        let is_beyond = alone[axis] > 1.01 * stated * entries[axis];
        let others = (0..3).filter(|e| *e != axis);
        let has_room = others.into_iter().all(|e| (alone[e] / entries[e]).hypot(mass / 100.0) < stated);
        prop_assert!(follows > 0.85 || !is_beyond || !has_room, "{follows} {found:?}");
        // What can be had is had: axes move these moments to second order, by up to √2 φ², and the mass by its share.
        let turn = degrees.to_radians();
        let by_axes = std::f64::consts::SQRT_2 * turn * turn;
        for e in (0..3).filter(|e| *e != axis) {
            let most = stated.max(by_axes.hypot(mass / 100.0));
            prop_assert!(found[e] > 0.97 * stated && found[e] < 1.15 * most, "{e}: {found:?} {stated}");
        }
    }
}
