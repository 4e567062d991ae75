//! Slender bodies, whose smallest moment the axes alone move by more than is stated of it.

use super::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// A slender link, the moment about whose long axis the stated axes alone move by more than is stated of it: the inertia
    /// follows the mass wholly all the same, for less would bring that moment no nearer.
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
        prop_assert!(follows > 0.85, "{follows} {found:?}");
        // What can be had is had: axes move these moments to second order, by up to √2 φ², and the mass by its share.
        let turn = degrees.to_radians();
        let by_axes = std::f64::consts::SQRT_2 * turn * turn;
        let stated = mass * more / 100.0;
        for e in (0..3).filter(|e| *e != axis) {
            let most = stated.max(by_axes.hypot(mass / 100.0));
            prop_assert!(found[e] > 0.97 * stated && found[e] < 1.15 * most, "{e}: {found:?} {stated}");
        }
    }
}
