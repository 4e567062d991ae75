//! Principal moments and axes, in a unique order and with unique signs.

use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};

use crate::eigen::{eigen, size};
use crate::{InertiaMatrix, RELATIVE_TOLERANCE};

/// Two candidate orders or signs of the axes count as equally near the body axes below this
/// difference of tr A, far above rounding and far below anything an engineer could mean.
const TIE: f64 = 1e-12;

/// Principal moments and axes of an inertia matrix, in a unique order and with unique signs.
///
/// The attitude q takes body components to principal components, I_B = R(q)ᵀ I_P R(q); the columns
/// of A = R(q)ᵀ are the principal axes in body components (Peck 2003, Eq. 5).
///
/// # Order and signs
/// Of the 24 right-handed ways to name and point three axes, the one nearest to the body axes: the
/// largest |q₄|. A tie (within 1e-12 in tr A) goes to the larger first moment, then to the larger
/// second, then to the larger q₃, q₂, q₁. Where moments are equal to rounding, the axes are free to
/// turn, and the turn nearest to the body axes is taken: a ball has the identity. q₄ is positive.
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
#[getset(get_copy = "pub")]
pub struct PrincipalAxes {
    /// Principal moments of inertia I₁, I₂, I₃, in kg·m².
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::read::principal_moments"))]
    moments: [f64; 3],
    /// The attitude q that takes body components to principal components.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::read::unit"))]
    attitude: UnitQuaternion<f64>,
}

impl PrincipalAxes {
    /// The six orders in which three axes can be named, counted from 0, each with the sign of its permutation; the
    /// first changes nothing. Axes stay right-handed if as many of them are reversed as the sign asks for: an even
    /// number with 1, an odd one with −1.
    pub const ORDERS: [([usize; 3], f64); 6] = [
        ([0, 1, 2], 1.0),
        ([1, 2, 0], 1.0),
        ([2, 0, 1], 1.0),
        ([0, 2, 1], -1.0),
        ([2, 1, 0], -1.0),
        ([1, 0, 2], -1.0),
    ];

    pub(crate) fn of(inertia: &InertiaMatrix) -> Self {
        let (values, vectors) = eigen(inertia.matrix());
        let gap = RELATIVE_TOLERANCE * size(inertia.matrix());
        let equal = |i: usize, j: usize| (values[i] - values[j]).abs() <= gap;
        let (moments, axes) = match (equal(0, 1), equal(1, 2), equal(2, 0)) {
            (false, false, false) => {
                nearest(values, &vectors).unwrap_or_else(|| nearest_of_24(values, &vectors, gap))
            }
            (true, false, false) => nearest_about(values, &vectors, 2),
            (false, true, false) => nearest_about(values, &vectors, 0),
            (false, false, true) => nearest_about(values, &vectors, 1),
            // Equal to rounding is not transitive; two equalities are a ball all the same.
            _ => (values, Matrix3::identity()),
        };
        let attitude = quaternion(&axes);
        Self { moments, attitude }
    }

    /// The principal axes in body components, as columns of a rotation: A = R(q)ᵀ.
    #[must_use]
    pub fn axes(&self) -> Rotation3<f64> {
        self.attitude.inverse().to_rotation_matrix()
    }

    /// Second mass moments K_k about the axes (Peck 2003, Eq. 8), in kg·m²; negative where the
    /// matrix is not realizable.
    #[must_use]
    pub fn second_moments(&self) -> [f64; 3] {
        second_moments(self.moments)
    }
}

/// K_k = ½ tr I − I_k.
pub(crate) fn second_moments([i1, i2, i3]: [f64; 3]) -> [f64; 3] {
    [0.5 * (i2 + i3 - i1), 0.5 * (i1 + i3 - i2), 0.5 * (i1 + i2 - i3)]
}

impl InertiaMatrix {
    /// Principal moments and axes; see [`PrincipalAxes`] for their order and signs.
    #[must_use]
    pub fn principal_axes(&self) -> PrincipalAxes {
        PrincipalAxes::of(self)
    }
}

/// All moments distinct: the signed permutation of the eigenvectors nearest to the body axes, if no
/// other is about as near.
fn nearest(values: [f64; 3], v: &Matrix3<f64>) -> Option<([f64; 3], Matrix3<f64>)> {
    // Where every axis lies within 36° of a body axis, no other choice comes near: its trace is above
    // 2.4 and that of any other below 2.2. A reflection cannot have a trace above 1.
    let place = |row: usize| {
        let (a, b, c) = (v[(row, 0)].abs(), v[(row, 1)].abs(), v[(row, 2)].abs());
        if a > 0.8 {
            Some(0)
        } else if b > 0.8 {
            Some(1)
        } else {
            (c > 0.8).then_some(2)
        }
    };
    if let (Some(i), Some(j), Some(k)) = (place(0), place(1), place(2)) {
        let column = |row: usize, place: usize| {
            Vector3::from(v.column(place)) * 1.0_f64.copysign(v[(row, place)])
        };
        let axes = Matrix3::from_columns(&[column(0, i), column(1, j), column(2, k)]);
        return Some(([values[i], values[j], values[k]], axes));
    }
    nearest_of_all(values, v)
}

/// The same wherever the axes point.
fn nearest_of_all(values: [f64; 3], v: &Matrix3<f64>) -> Option<([f64; 3], Matrix3<f64>)> {
    let mut best = ([0, 1, 2], [1.0; 3]);
    let (mut first, mut second) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
    for (order, parity) in PrincipalAxes::ORDERS {
        let [a, b, c] = [v[(0, order[0])], v[(1, order[1])], v[(2, order[2])]];
        // With every diagonal entry positive, if that is a rotation; else the least of them is not.
        let mirrored = a.is_sign_negative() ^ b.is_sign_negative() ^ c.is_sign_negative();
        let (x, y, z) = (a.abs(), b.abs(), c.abs());
        let least = x.min(y).min(z);
        let sum = x + y + z;
        let middle = sum - least - x.max(y).max(z);
        let rotation = mirrored == (parity < 0.0);
        let mut signs = [1.0_f64.copysign(a), 1.0_f64.copysign(b), 1.0_f64.copysign(c)];
        let (trace, next) = if rotation {
            (sum, sum - 2.0 * (least + middle))
        } else {
            let place = if least == x { 0 } else { 1 + usize::from(least != y) };
            signs[place] = -signs[place];
            (sum - 2.0 * least, sum - 2.0 * middle)
        };
        if trace > first {
            second = first.max(next);
            first = trace;
            best = (order, signs);
        } else {
            second = second.max(trace);
        }
    }
    let (order, signs) = best;
    let columns =
        Matrix3::from_columns(&[0, 1, 2].map(|j| Vector3::from(v.column(order[j])) * signs[j]));
    (first - second > TIE).then_some((order.map(|i| values[i]), columns))
}

/// The same where a tie has to be settled.
fn nearest_of_24(values: [f64; 3], v: &Matrix3<f64>, gap: f64) -> ([f64; 3], Matrix3<f64>) {
    let mut best: Option<([f64; 3], Matrix3<f64>)> = None;
    for (order, parity) in PrincipalAxes::ORDERS {
        for (s0, s1) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let signs = [s0, s1, parity * s0 * s1];
            let trace: f64 = (0..3).map(|i| signs[i] * v[(i, order[i])]).sum();
            let lead = best.map_or(f64::INFINITY, |(_, a)| trace - a.trace());
            if lead < -TIE {
                continue;
            }
            let candidate = (
                order.map(|i| values[i]),
                Matrix3::from_fn(|row, column| signs[column] * v[(row, order[column])]),
            );
            if lead > TIE || best.is_some_and(|best| wins_tie(&candidate, &best, gap)) {
                best = Some(candidate);
            }
        }
    }
    best.unwrap_or((values, *v))
}

fn wins_tie(a: &([f64; 3], Matrix3<f64>), b: &([f64; 3], Matrix3<f64>), gap: f64) -> bool {
    for (x, y) in a.0.iter().zip(&b.0) {
        if (x - y).abs() > gap {
            return x > y;
        }
    }
    let (p, q) = (quaternion(&a.1), quaternion(&b.1));
    for (x, y) in [(p.k, q.k), (p.j, q.j), (p.i, q.i)] {
        if (x - y).abs() > TIE {
            return x > y;
        }
    }
    false
}

/// Two moments equal: only the direction of the third axis, `odd`, is determined. The nearest
/// axes follow from the smallest turn that brings a body axis onto it.
fn nearest_about(values: [f64; 3], v: &Matrix3<f64>, odd: usize) -> ([f64; 3], Matrix3<f64>) {
    let axis: Vector3<f64> = v.column(odd).into();
    let (i, j) = ((odd + 1) % 3, (odd + 2) % 3);
    let pair = (values[i].max(values[j]), values[i].min(values[j]));
    // Among equally near body axes, larger moments come first.
    let first_wins = values[odd] > pair.0;
    let mut place = 0;
    for k in 1..3 {
        let lead = axis[k].abs() - axis[place].abs();
        if lead > TIE || (lead >= -TIE && !first_wins) {
            place = k;
        }
    }
    let n = axis * 1.0_f64.copysign(axis[place]);
    let turn = Vector3::ith(place, 1.0).cross(&n).cross_matrix();
    let axes = Matrix3::identity() + turn + turn * turn / (1.0 + n[place]);
    let mut moments = [pair.0, pair.1, pair.1];
    moments[place] = values[odd];
    if place == 0 {
        (moments[1], moments[2]) = pair;
    } else if place == 1 {
        moments[2] = pair.1;
    }
    (moments, axes)
}

/// The attitude q with A = R(q)ᵀ, its scalar part positive. Near the body axes the trace is large.
#[inline(always)]
fn quaternion(a: &Matrix3<f64>) -> UnitQuaternion<f64> {
    let square = 1.0 + a.trace();
    if square > 0.1 {
        let root = square.sqrt();
        // 1/(2 root), by a division that does not wait for the root.
        let (w, scale) = (0.5 * root, root * (0.5 / square));
        let vector = [a[(1, 2)] - a[(2, 1)], a[(2, 0)] - a[(0, 2)], a[(0, 1)] - a[(1, 0)]];
        let [x, y, z] = vector.map(|v| v * scale);
        // One Newton step to unit norm: the axes are a rotation to rounding.
        let off = 0.5 - 0.5 * (w * w + x * x + y * y + z * z);
        let [w, x, y, z] = [w, x, y, z].map(|v| v + v * off);
        return UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
    }
    far_quaternion(a)
}

/// The same wherever the axes point.
#[cold]
fn far_quaternion(a: &Matrix3<f64>) -> UnitQuaternion<f64> {
    let q = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(a.transpose()));
    if q.w < 0.0 { UnitQuaternion::new_unchecked(-q.into_inner()) } else { q }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn axes_of(moments: [f64; 3], products: [f64; 3]) -> PrincipalAxes {
        InertiaMatrix::from_entries(moments, products).unwrap().principal_axes()
    }

    fn reconstruct(p: &PrincipalAxes) -> Matrix3<f64> {
        let a = p.axes();
        a.matrix() * Matrix3::from_diagonal(&Vector3::from(p.moments())) * a.matrix().transpose()
    }

    /// Peck 2003, Table 1 (payload), Eq. 27 (its mean quaternion), to twelve digits by 50-digit
    /// arithmetic (mpmath `eigsy`).
    #[test]
    fn the_papers_payload() {
        let p = axes_of([5000.0, 4000.0, 3000.0], [20.0, 2.0, -50.0]);
        let moments = [5000.400340853638, 4002.0979168828417, 2997.501742263521];
        let q = [0.024935566015959365, 0.0004991664980075949, -0.009972645510243931];
        for (found, expected) in p.moments().iter().zip(moments) {
            // Two units in the last place of the trace.
            assert!((found - expected).abs() < 4e-12, "{found} {expected}");
        }
        for (found, expected) in p.attitude().imag().iter().zip(q) {
            assert!((found - expected).abs() < 1e-14, "{found} {expected}");
        }
        assert!((p.attitude().w - 0.9996391922697899).abs() < 1e-15);
    }

    /// Turned 45° about axis 3, where naming the axes 1, 2 or 2, -1 is equally near.
    #[test]
    fn the_papers_upper_stage_ties_and_the_larger_moment_goes_first() {
        let p = axes_of([6700.0, 6700.0, 2000.0], [0.0, 20.0, -20.0]);
        let q = [0.0011514237297395697, 0.0027797827843850944, 0.38268170015168];
        assert!(p.moments()[0] > p.moments()[1]);
        for (found, expected) in p.attitude().imag().iter().zip(q) {
            assert!((found - expected).abs() < 1e-11, "{found} {expected}");
        }
    }

    #[test]
    fn equal_moments_stay_near_the_body_axes() {
        assert_eq!(axes_of([2.0; 3], [0.0; 3]).attitude(), UnitQuaternion::identity());
        assert_eq!(axes_of([0.0; 3], [0.0; 3]).attitude(), UnitQuaternion::identity());
        assert_eq!(axes_of([2.0, 2.0, 1.0], [0.0; 3]).attitude(), UnitQuaternion::identity());
        // Axisymmetric about an axis tilted by 0.1 rad in the 2-3 plane: the nearest attitude is
        // that tilt and nothing else, whatever plane the eigen solver turned in.
        let tilt = UnitQuaternion::from_scaled_axis(Vector3::new(0.1, 0.0, 0.0));
        let body = InertiaMatrix::from_entries([5.0, 5.0, 3.0], [0.0; 3]).unwrap();
        let p = body.rotated(&tilt.inverse()).unwrap().principal_axes();
        assert!(p.attitude().angle_to(&tilt) < 1e-14);
        assert_eq!(p.moments()[2], p.moments()[0].min(p.moments()[2]));
    }

    #[test]
    fn an_odd_axis_between_two_body_axes_follows_the_tie_rule() {
        let turn =
            UnitQuaternion::from_scaled_axis(Vector3::new(0.0, 0.0, 0.25 * std::f64::consts::PI));
        let small =
            InertiaMatrix::from_entries([3.0, 5.0, 5.0], [0.0; 3]).unwrap().rotated(&turn).unwrap();
        let large =
            InertiaMatrix::from_entries([7.0, 5.0, 5.0], [0.0; 3]).unwrap().rotated(&turn).unwrap();
        let (small, large) = (small.principal_axes().moments(), large.principal_axes().moments());
        assert!(small[1] < 4.0 && large[0] > 6.0, "{small:?} {large:?}");
    }

    proptest! {
        /// The short cuts choose what looking at all 24 chooses.
        #[test]
        fn short_cuts_agree_with_all_24(q in prop::array::uniform4(-1.0..1.0f64), small in any::<bool>()) {
            prop_assume!(q.iter().map(|x| x * x).sum::<f64>() > 0.1);
            let tilt = if small { 0.2 } else { 1.0 };
            let q = UnitQuaternion::from_quaternion(Quaternion::new(q[3], q[0] * tilt, q[1] * tilt, q[2] * tilt));
            let v = *q.to_rotation_matrix().matrix();
            let values = [3.0, 2.0, 4.0];
            let all = nearest_of_24(values, &v, 1e-13);
            for found in [nearest(values, &v), nearest_of_all(values, &v)] {
                let found = found.unwrap();
                prop_assert_eq!(found.0, all.0);
                prop_assert!((found.1 - all.1).amax() < 1e-15);
            }
        }
    }

    proptest! {
        #[test]
        fn reconstructs_and_is_never_far(
            d in prop::array::uniform3(0.0..10.0f64),
            o in prop::array::uniform3(-5.0..5.0f64),
        ) {
            let m = InertiaMatrix::from_entries(d, o).unwrap();
            let p = m.principal_axes();
            prop_assert!((reconstruct(&p) - m.matrix()).amax() < 1e-13);
            // No orientation is further than 62.8° from the nearest naming of its axes.
            prop_assert!(p.attitude().w > 0.853);
        }

        #[test]
        fn small_turns_come_back(v in prop::array::uniform3(-0.2..0.2f64)) {
            let q = UnitQuaternion::from_scaled_axis(Vector3::from(v));
            let body = InertiaMatrix::from_entries([5.0, 4.0, 3.0], [0.0; 3]).unwrap();
            let p = body.rotated(&q.inverse()).unwrap().principal_axes();
            prop_assert!(p.attitude().angle_to(&q) < 1e-14);
        }

        #[test]
        fn nearly_equal_moments_do_not_harm_the_matrix(
            v in prop::array::uniform3(-2.0..2.0f64),
            exponent in -18.0..-6.0f64,
        ) {
            let q = UnitQuaternion::from_scaled_axis(Vector3::from(v));
            let near = 5.0 + 10f64.powf(exponent);
            let body = InertiaMatrix::from_entries([5.0, near, 3.0], [0.0; 3]).unwrap().rotated(&q).unwrap();
            prop_assert!((reconstruct(&body.principal_axes()) - body.matrix()).amax() < 2e-13);
        }
    }

    #[cfg(feature = "serde")]
    proptest! {
        /// The axes of any matrix come back as they were, up to its largest entries, and what is read has finite second moments.
        #[test]
        fn what_is_read_is_what_a_matrix_can_have(
            shares in prop::array::uniform6(prop_oneof![Just(1.0), Just(-1.0), -1.0..1.0f64]),
            moments in prop::array::uniform3((prop_oneof![300.0..308.25f64, -3.0..3.0f64], any::<bool>())),
        ) {
            let [a, b, c, d, e, f] = shares.map(|share| share * crate::MAX_ENTRY);
            let own = axes_of([a, b, c], [d, e, f]);
            let read = serde_json::from_str::<PrincipalAxes>(&serde_json::to_string(&own).unwrap());
            prop_assert_eq!(read.unwrap(), own);
            let moments = moments.map(|(e, is_negative)| 10f64.powf(e) * if is_negative { -1.0 } else { 1.0 });
            let any = PrincipalAxes { moments, ..own };
            let is_too_large = moments.iter().any(|moment| moment.abs() > 4.0 * crate::MAX_ENTRY);
            match serde_json::from_str::<PrincipalAxes>(&serde_json::to_string(&any).unwrap()) {
                Ok(read) => {
                    prop_assert!(!is_too_large && read == any);
                    prop_assert!(read.second_moments().iter().all(|k| k.is_finite()));
                }
                Err(error) => {
                    let error = error.to_string();
                    prop_assert!(is_too_large && error.starts_with("principal moment = "), "{error}");
                }
            }
        }
    }
}
