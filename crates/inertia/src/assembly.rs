//! Mass properties of many parts together.

use std::borrow::Borrow;

use nalgebra::{Matrix3, Vector3};

use crate::mass_properties::{INERTIA, check_lost, check_mass, check_vector};
use crate::second_moment_matrix::{inertia_of, nearest, outer, point_inertia, remainder};
use crate::{MassProperties, MassPropertiesError, RELATIVE_TOLERANCE};

impl MassProperties {
    /// A cloud of point masses: pairs of mass (kg) and position (m, reference frame).
    ///
    /// # Errors
    /// There is no point, a mass is not positive and finite, a coordinate not finite or too far,
    /// or a sum overflows.
    ///
    /// ```
    /// use gyradius_inertia::MassProperties;
    ///
    /// let dumbbell = MassProperties::from_points([(1.0, [0.0; 3]), (3.0, [2.0, 0.0, 0.0])])?;
    /// assert_eq!(dumbbell.mass_centre_m().x, 1.5);
    /// assert_eq!(dumbbell.inertia().entries(), [0.0, 3.0, 3.0, 0.0, 0.0, 0.0]);
    /// # Ok::<(), gyradius_inertia::MassPropertiesError>(())
    /// ```
    pub fn from_points<P: Into<Vector3<f64>>>(
        points: impl IntoIterator<Item = (f64, P)>,
    ) -> Result<Self, MassPropertiesError> {
        let points: Vec<(f64, Vector3<f64>)> =
            points.into_iter().map(|(mass, position)| (mass, position.into())).collect();
        for (mass, position) in &points {
            check_mass(*mass)?;
            check_vector("position", position)?;
        }
        assembled(&points, Matrix3::zeros())
    }

    /// Several bodies, all described in one frame, as one.
    ///
    /// Σ = Σᵢ (Σᵢ + mᵢ dᵢ dᵢᵀ) with dᵢ from the common mass centre, formed from differences of
    /// mass centres, so that nothing is lost far from the origin.
    ///
    /// # Errors
    /// There is no body, or a sum overflows.
    pub fn combined<B: Borrow<Self>>(
        bodies: impl IntoIterator<Item = B>,
    ) -> Result<Self, MassPropertiesError> {
        let mut own = Matrix3::zeros();
        let mut centres = Vec::new();
        for body in bodies {
            let body = body.borrow();
            own += body.inertia().matrix();
            centres.push((body.mass_kg(), body.mass_centre_m()));
        }
        assembled(&centres, own)
    }

    /// What is left when `part`, described in the same frame, is cut out.
    ///
    /// I = I_whole − I_part − μ (|d|²·1 − d dᵀ) with μ = m_part m_whole / m, m the mass left and d
    /// between the mass centres of part and whole.
    ///
    /// What cancels is lost beside the terms: d is a difference of rounded mass centres, and m one
    /// of rounded masses. With ε = [`RELATIVE_TOLERANCE`], an error of ε r in d, where
    /// r = |c_whole| + |c_part| + √(tr I_whole / m_whole), and of ε m_whole in m, change the second
    /// moments by at most ε (max(I_whole, μ|d|²) + μ|d|² m_whole/m + 2μ|d|r + ε μ r²). What is below
    /// zero by no more than that is zero.
    ///
    /// # Errors
    /// The part is not lighter than the whole by more than rounding, or what is left is no body's:
    /// then the part was not in the whole.
    pub fn without(&self, part: &Self) -> Result<Self, MassPropertiesError> {
        let (whole, removed) = (self.mass_kg(), part.mass_kg());
        let left = whole - removed;
        if !(left > RELATIVE_TOLERANCE * whole) {
            return Err(MassPropertiesError::NothingLeft { whole, part: removed });
        }
        let (centre, own) = (self.mass_centre_m(), self.inertia().matrix());
        let d = centre - part.mass_centre_m();
        let lever = point_inertia(removed * (whole / left), &d);
        let reach = centre.norm()
            + part.mass_centre_m().norm()
            + (own.trace().max(0.0).sqrt() / whole.sqrt());
        // μ|d|² m_whole/m, 2μ|d|r and ε μ r²; mass times length first, which overflows last.
        let (mu, distance) = (removed * (whole / left), d.norm());
        let size = own.amax().max(lever.amax())
            + (mu * distance) * distance * (whole / left)
            + (2.0 * mu * distance) * reach
            + (RELATIVE_TOLERANCE * mu * reach) * reach;
        let inertia = remainder(own - part.inertia().matrix() - lever, size)
            .map_err(MassPropertiesError::NotAPart)?;
        Self::new(left, centre + d * (removed / left), inertia)
    }
}

/// Point masses and the sum of inertias about each of them.
fn assembled(
    points: &[(f64, Vector3<f64>)],
    own: Matrix3<f64>,
) -> Result<MassProperties, MassPropertiesError> {
    // Distances are taken from the heaviest, which the mass centre is never far from.
    let heaviest = points.iter().max_by(|a, b| a.0.total_cmp(&b.0));
    let &(_, origin) = heaviest.ok_or(MassPropertiesError::Empty)?;
    let mass: f64 = points.iter().map(|(m, _)| m).sum();
    check_mass(mass)?;
    let offset: Vector3<f64> = points.iter().map(|(m, x)| (x - origin) * (m / mass)).sum();
    let sigma: Matrix3<f64> = points.iter().map(|(m, x)| outer(*m, &(x - origin - offset))).sum();
    let inertia = nearest(own + inertia_of(&sigma))?;
    if points.iter().any(|(_, x)| *x != origin) {
        check_lost(INERTIA, inertia.matrix().amax())?;
    }
    MassProperties::new(mass, origin + offset, inertia)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass_properties::tests::{any_attitude, any_body, distance};
    use crate::{Inertia, SecondMoments};
    use nalgebra::Isometry3;
    use proptest::prelude::*;

    fn sorted(mut values: [f64; 3]) -> [f64; 3] {
        values.sort_by(f64::total_cmp);
        values
    }

    #[test]
    fn sums_of_nothing_and_overflows_are_refused() {
        assert_eq!(
            MassProperties::combined([] as [MassProperties; 0]),
            Err(MassPropertiesError::Empty)
        );
        assert_eq!(
            MassProperties::from_points([] as [(f64, [f64; 3]); 0]),
            Err(MassPropertiesError::Empty)
        );
        let heavy = (1e308, [0.0; 3]);
        assert!(matches!(
            MassProperties::from_points([heavy, heavy]),
            Err(MassPropertiesError::Mass { .. })
        ));
        assert!(MassProperties::from_points([(1.0, [f64::NAN, 0.0, 0.0])]).is_err());
        assert!(MassProperties::from_points([(0.0, [0.0; 3])]).is_err());
        let far = MassProperties::from_points([(1e200, [1e100, 0.0, 0.0]), (1e200, [0.0; 3])]);
        assert!(matches!(far, Err(MassPropertiesError::Inertia(_))));
    }

    #[test]
    fn what_was_never_inside_cannot_be_cut_out() {
        let k = SecondMoments::new([1.0; 3]).unwrap();
        let ball = Inertia::from_second_moments(k, &nalgebra::UnitQuaternion::identity()).unwrap();
        let ball = MassProperties::new(1.0, [0.0; 3], ball).unwrap();
        let far = MassProperties::point(0.5, [2.0, 0.0, 0.0]).unwrap();
        assert!(matches!(ball.without(&far), Err(MassPropertiesError::NotAPart(_))));
        assert!(matches!(ball.without(&ball), Err(MassPropertiesError::NothingLeft { .. })));
        let almost = MassProperties::point(1.0 - f64::EPSILON, [0.0; 3]).unwrap();
        assert!(matches!(ball.without(&almost), Err(MassPropertiesError::NothingLeft { .. })));
        let near = MassProperties::point(0.5, [0.5, 0.0, 0.0]).unwrap();
        // K₁ = 1 − 0.5·1/0.5·0.25 = 0.75.
        let left = ball.without(&near).unwrap();
        assert_eq!(left.mass_centre_m().x, -0.5);
        assert_eq!(left.inertia().as_inertia_matrix().second_moment_matrix()[(0, 0)], 0.75);
    }

    /// Two craft 1 m apart at Earth's distance from the Sun: the sum knows the metre.
    #[test]
    fn sums_far_from_the_origin_keep_their_digits() {
        let origin = 2f64.powi(37);
        let here = (2.0, [origin, 0.0, 0.0]);
        let there = (6.0, [origin + 1.0, 0.0, 0.0]);
        let pair = MassProperties::from_points([here, there]).unwrap();
        assert_eq!(pair.inertia().entries(), [0.0, 1.5, 1.5, 0.0, 0.0, 0.0]);
        // The way that loses it: about the origin and back.
        let about = pair.inertia_about([0.0; 3]).unwrap();
        let back =
            MassProperties::from_inertia_about([0.0; 3], 8.0, pair.mass_centre_m(), about).unwrap();
        assert!((back.inertia().entries()[1] - 1.5).abs() > 0.1);
    }

    /// Points, rods, plates and solids, a few metres from the origin.
    fn any_remnant() -> impl Strategy<Value = MassProperties> {
        (any_body(), prop::array::uniform3(any::<bool>())).prop_map(|(body, flat)| {
            let axes = body.inertia().principal_axes();
            let k = body.inertia().second_moments().values();
            let k = std::array::from_fn(|i| if flat[i] { 0.0 } else { k[i] });
            let inertia =
                Inertia::from_second_moments(SecondMoments::new(k).unwrap(), &axes.attitude());
            MassProperties::new(body.mass_kg(), body.mass_centre_m(), inertia.unwrap()).unwrap()
        })
    }

    proptest! {
        #[test]
        fn any_cloud_is_a_body_with_the_second_moments_of_its_definition(
            points in prop::collection::vec(
                (1e-6..1e3f64, prop::array::uniform3(-1e3..1e3f64)), 1..12),
        ) {
            let cloud = MassProperties::from_points(points.iter().copied()).unwrap();
            prop_assert!(cloud.inertia().as_inertia_matrix().is_realizable());
            // About the definition's own mass centre, by nalgebra's solver.
            let mass: f64 = points.iter().map(|p| p.0).sum();
            let centre: Vector3<f64> =
                points.iter().map(|(m, x)| Vector3::from(*x) * *m).sum::<Vector3<f64>>() / mass;
            let sigma: Matrix3<f64> = points
                .iter()
                .map(|(m, x)| {
                    let d = Vector3::from(*x) - centre;
                    d * d.transpose() * *m
                })
                .sum();
            let expected: [f64; 3] = sigma.symmetric_eigen().eigenvalues.into();
            let found = cloud.inertia().second_moments().values();
            for (a, b) in sorted(expected).iter().zip(sorted(found)) {
                prop_assert!((a - b).abs() <= 1e-12 * mass * 3e6, "{expected:?} {found:?}");
            }
            prop_assert!((cloud.mass_centre_m() - centre).amax() < 1e-9);
        }

        #[test]
        fn what_is_added_can_be_taken_away(a in any_body(), b in any_body()) {
            let both = MassProperties::combined([a, b]).unwrap();
            let size = both.inertia().matrix().amax();
            prop_assert!(distance(&both.without(&b).unwrap(), &a) < 1e-11 * size);
            prop_assert!(distance(&both.without(&a).unwrap(), &b) < 1e-11 * size);
        }

        /// Points, rods, plates and solids are left of wholes up to 10⁶ times as heavy, or as light,
        /// at any scale, far from the origin, turned and moved with their parts: all come back
        /// within the bound. Parts a little aside, or with a little more inertia, do not.
        #[test]
        fn what_is_in_the_whole_can_be_cut_out_and_what_is_not_cannot(
            (left, part) in (any_remnant(), any_body()),
            (ratio, mass, length) in (-6.0..6.0f64, -9.0..9.0f64, -9.0..9.0f64),
            (q, t, far) in (any_attitude(), prop::array::uniform3(-1.0..1.0f64), -3.0..4.0f64),
            aside in prop::array::uniform3(-1.0..1.0f64),
        ) {
            let [ratio, mass, length, far] = [ratio, mass, length, far].map(|x| 10f64.powf(x));
            let pose = Isometry3::from_parts((Vector3::from(t) * length * far).into(), q);
            let place = |body: &MassProperties, factor: f64| {
                let k = body.inertia().matrix() * (factor * length * length);
                let centre = body.mass_centre_m() * length;
                let body = MassProperties::new(
                    body.mass_kg() * factor, centre, nearest(k).unwrap()).unwrap();
                body.transformed(&pose).unwrap()
            };
            let (left, part) = (place(&left, mass), place(&part, mass * ratio));
            let whole = MassProperties::combined([left, part]).unwrap();
            let found = whole.without(&part);
            prop_assert!(found.is_ok(), "{found:?}");
            let (m, p, w) = (left.mass_kg(), part.mass_kg(), whole.mass_kg());
            let found = found.unwrap();
            prop_assert!((found.mass_kg() - m).abs() <= 2.0 * f64::EPSILON * w);
            // The rounding of the mass centres times mass times arm, in the terms of the bodies.
            let arm = (left.mass_centre_m() - part.mass_centre_m()).norm();
            let (near, own) = (part.mass_centre_m().norm() + arm, whole.inertia().matrix().trace());
            let reach = 3.0 * near + (own / w).sqrt();
            let size = own + m * arm * arm * (1.0 + w / m) + 2.0 * p * arm * reach
                + RELATIVE_TOLERANCE * p * (w / m) * reach * reach;
            let error = (found.inertia().matrix() - left.inertia().matrix()).amax();
            prop_assert!(error <= RELATIVE_TOLERANCE * size, "{error:e} {size:e}");

            // What is not in it: a part aside, across the arm.
            let across = Vector3::from(aside).cross(&(left.mass_centre_m() - part.mass_centre_m()));
            prop_assume!(across.norm() > 0.0);
            // So far that the second moment along it is missed by a hundred times the bound.
            let direction = across.normalize();
            let sigma = left.inertia().as_inertia_matrix().second_moment_matrix();
            let needed = direction.dot(&(sigma * direction)) + 100.0 * RELATIVE_TOLERANCE * size;
            let step = direction * (needed / p * (m / w)).sqrt();
            let moved = part.translated(step).unwrap();
            prop_assert!(whole.without(&moved).is_err(), "{step:?}");
            let missing = sigma.trace() + 100.0 * RELATIVE_TOLERANCE * size;
            let excess = 1.0 + missing
                / part.inertia().second_moments().values().into_iter().fold(f64::MAX, f64::min);
            prop_assume!(excess.is_finite());
            let heavy = Inertia::new(part.inertia().matrix() * excess).unwrap();
            let heavy = MassProperties::new(p, part.mass_centre_m(), heavy).unwrap();
            prop_assert!(whole.without(&heavy).is_err(), "{excess}");
        }

        /// Two points, by powers of two: the inertia is right to the bit, or refused.
        #[test]
        fn pairs_keep_their_digits_over_the_range_of_floats(
            (mass, distance) in (-1074..1023i32, -600..330i32),
        ) {
            let power = |e: i32| 2f64.powi(e / 2) * 2f64.powi(e - e / 2);
            let (m, x) = (power(mass), power(distance));
            // ½ m x², the last step alone leaves the range.
            let moment = if distance < 0 { m * x * (0.5 * x) } else { 0.5 * m * x * x };
            match MassProperties::from_points([(m, [0.0; 3]), (m, [x, 0.0, 0.0])]) {
                Ok(pair) => {
                    prop_assert!(moment >= f64::MIN_POSITIVE);
                    prop_assert_eq!(pair.inertia().entries(), [0.0, moment, moment, 0.0, 0.0, 0.0]);
                    prop_assert_eq!(pair.mass_centre_m().x, 0.5 * x);
                }
                Err(MassPropertiesError::Lost { .. }) => prop_assert!(moment < f64::MIN_POSITIVE),
                Err(error) => prop_assert!(moment > 1e306 || mass > 1021, "{}", error),
            }
        }

        #[test]
        fn sums_do_not_depend_on_grouping_or_frame(
            (a, b, c) in (any_body(), any_body(), any_body()),
            (q, t) in (any_attitude(), prop::array::uniform3(-9.0..9.0f64)),
        ) {
            let all = MassProperties::combined([a, b, c]).unwrap();
            let ab = MassProperties::combined([&a, &b]).unwrap();
            let size = all.inertia().matrix().amax();
            prop_assert!(distance(&MassProperties::combined([c, ab]).unwrap(), &all) < 1e-13 * size);
            let pose = Isometry3::from_parts(Vector3::from(t).into(), q);
            let moved = [a, b, c].map(|body| body.transformed(&pose).unwrap());
            let moved = MassProperties::combined(moved).unwrap();
            prop_assert!(distance(&moved, &all.transformed(&pose).unwrap()) < 1e-12 * size);
        }

        /// About any point, inertias add as they are: the parallel axis theorem from outside.
        #[test]
        fn inertia_about_a_point_is_additive(
            (a, b) in (any_body(), any_body()),
            point in prop::array::uniform3(-9.0..9.0f64),
        ) {
            let both = MassProperties::combined([a, b]).unwrap();
            let about = |body: &MassProperties| *body.inertia_about(point).unwrap().matrix();
            let sum = about(&a) + about(&b);
            prop_assert!((sum - about(&both)).amax() < 1e-13 * sum.amax());
            // The control: inertias added without their lever arms.
            let forgotten = a.inertia().matrix() + b.inertia().matrix();
            let d = a.mass_centre_m() - b.mass_centre_m();
            prop_assume!(d.norm() > 0.1);
            prop_assert!((forgotten - both.inertia().matrix()).amax() > 1e-4);
        }

        #[test]
        fn no_input_panics(
            x in prop::collection::vec((prop::num::f64::ANY,
                prop::array::uniform3(prop::num::f64::ANY)), 0..4),
            y in prop::collection::vec((1e-320..1e307f64,
                prop::array::uniform3(-1e100..1e100f64)), 0..4),
        ) {
            for points in [x, y] {
                let all = MassProperties::from_points(points.iter().copied());
                let first = MassProperties::from_points(points.iter().copied().take(1));
                if let (Ok(all), Ok(first)) = (all, first) {
                    let _ = (all.without(&first), first.without(&all));
                }
            }
        }
    }
}
