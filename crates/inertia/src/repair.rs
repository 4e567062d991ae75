//! A realizable inertia in place of a matrix that no body has.

use nalgebra::Matrix3;

use crate::{Inertia, InertiaMatrix, RealizabilityError, SecondMoments};

/// How an unrealizable matrix becomes the inertia of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum RepairMethod {
    /// The realizable inertia with the smallest Frobenius distance ‖I′ − I‖: as little change of the
    /// entries as there can be.
    Nearest,
    /// Negative second moments K_k set to zero: the smallest change of Σ instead of I.
    ClipSecondMoments,
    /// The same number added to all three moments, as little as makes the matrix realizable. Keeps
    /// products and differences of moments.
    ShiftMoments,
    /// The inertia of a body of known shape, turned to the principal axes of the matrix and scaled to its
    /// trace: for matrices of which only the size and the axes are to be trusted.
    Shape(Inertia),
}

/// A realizable inertia in place of a matrix, and how far it is from it.
///
/// What is realizable already is not moved by a bit, so that repairing twice is repairing once. The
/// principal axes stay, so that the repair of a turned matrix is the turned repair.
///
/// ```
/// use gyradius_inertia::{InertiaMatrix, Repair, RepairMethod};
///
/// let measured = InertiaMatrix::from_entries([1.0, 2.0, 3.3], [0.0; 3])?;
/// let nearest = Repair::new(&measured, RepairMethod::Nearest)?;
/// // A third of what is missing is taken from the largest moment, a third given to each other.
/// for (moment, expected) in nearest.inertia().entries().iter().zip([1.1, 2.1, 3.2]) {
///     assert!((moment - expected).abs() < 1e-12);
/// }
/// let shifted = Repair::new(&measured, RepairMethod::ShiftMoments)?;
/// assert!(nearest.distance() < shifted.distance());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters, getset::Getters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Repair {
    /// The realizable inertia.
    #[getset(get = "pub")]
    inertia: Inertia,
    /// ‖I′ − I‖, Frobenius, kg·m²: 0 if nothing had to be moved.
    #[getset(get_copy = "pub")]
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::read::size"))]
    distance: f64,
    /// The distance over ‖I‖.
    #[getset(get_copy = "pub")]
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::read::size"))]
    relative_distance: f64,
}

impl Repair {
    /// Repairs a matrix.
    ///
    /// # Errors
    /// [`RepairMethod::Shape`] of a matrix whose trace is not positive or of a shape that is a point,
    /// or a result too large to hold, or so small that rounding leaves no body of it.
    pub fn new(matrix: &InertiaMatrix, method: RepairMethod) -> Result<Self, RealizabilityError> {
        if let Ok(inertia) = Inertia::try_from(*matrix) {
            return Ok(Self { inertia, distance: 0.0, relative_distance: 0.0 });
        }
        let size = matrix.matrix().amax();
        let axes = matrix.principal_axes();
        let k = axes.second_moments();
        let k = match method {
            // Squares of the numbers themselves could overflow, or vanish.
            RepairMethod::Nearest => nearest(k.map(|k| k / size)).map(|k| k * size),
            RepairMethod::ClipSecondMoments => k.map(|k| k.max(0.0)),
            RepairMethod::ShiftMoments => {
                let least = k.into_iter().fold(f64::INFINITY, f64::min);
                k.map(|k| k - least)
            }
            RepairMethod::Shape(shape) => {
                let trace: f64 = k.iter().sum();
                let own = shape.second_moments().values();
                let sum: f64 = own.iter().sum();
                if !(trace > 0.0 && sum > 0.0) {
                    return Err(RealizabilityError::of(matrix));
                }
                sorted_like(own.map(|x| x / sum * trace), k)
            }
        };
        let moments = SecondMoments::new(k.map(|k| k + 0.0))?;
        let inertia = Inertia::from_second_moments(moments, &axes.attitude())?;
        let scaled = |m: &Matrix3<f64>| m.map(|x| x / size);
        let relative_to_size = (scaled(inertia.matrix()) - scaled(matrix.matrix())).norm();
        let norm = scaled(matrix.matrix()).norm();
        Ok(Self {
            inertia,
            distance: relative_to_size * size,
            relative_distance: relative_to_size / norm,
        })
    }
}

/// The K ≥ 0 for which the moments move least. As I = tr(K)·1 − K, moving K by δ moves the moments by
/// |δ|² + (Σδ)², squared. That norm does not depend on the frame, so the nearest matrix has the same
/// axes; with the set of zeros given, the rest is linear, and eight sets are all there are.
fn nearest(k: [f64; 3]) -> [f64; 3] {
    let mut best = (f64::INFINITY, k.map(|k| k.max(0.0)));
    for zeros in 0..8_usize {
        let zero = |j: usize| zeros >> j & 1 == 1;
        let (mut fixed, mut free) = (0.0, 0.0);
        for (j, k) in k.iter().enumerate() {
            if zero(j) {
                fixed -= k;
            } else {
                free += 1.0;
            }
        }
        // Stationary: δ_j = −Σδ for those that are free.
        let sum = fixed / (1.0 + free);
        let moved: [f64; 3] = std::array::from_fn(|j| if zero(j) { 0.0 } else { k[j] - sum });
        if moved.iter().any(|m| *m < 0.0) {
            continue;
        }
        let delta: [f64; 3] = std::array::from_fn(|j| moved[j] - k[j]);
        let total: f64 = delta.iter().sum();
        let cost = delta.iter().map(|d| d * d).sum::<f64>() + total * total;
        if cost < best.0 {
            best = (cost, moved);
        }
    }
    best.1
}

/// The values in the order of size of others.
fn sorted_like(mut values: [f64; 3], others: [f64; 3]) -> [f64; 3] {
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| others[i].total_cmp(&others[j]));
    values.sort_by(f64::total_cmp);
    let mut sorted = [0.0; 3];
    for (place, value) in order.into_iter().zip(values) {
        sorted[place] = value;
    }
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{SecondMomentsError, matrix::tests::any_attitude};
    use proptest::prelude::*;

    const METHODS: [RepairMethod; 3] =
        [RepairMethod::Nearest, RepairMethod::ClipSecondMoments, RepairMethod::ShiftMoments];

    fn diagonal(moments: [f64; 3]) -> InertiaMatrix {
        InertiaMatrix::from_entries(moments, [0.0; 3]).unwrap()
    }

    #[test]
    fn shapes_keep_axes_and_trace() {
        let plate = Inertia::new(*diagonal([1.0, 1.0, 2.0]).matrix()).unwrap();
        let bad = InertiaMatrix::from_entries([10.0, 30.0, 50.0], [1.0, 0.0, 2.0]).unwrap();
        let repair = Repair::new(&bad, RepairMethod::Shape(plate)).unwrap();
        assert!((repair.inertia().matrix().trace() - 90.0).abs() < 1e-12);
        let point = Inertia::new(Matrix3::zeros()).unwrap();
        assert!(Repair::new(&bad, RepairMethod::Shape(point)).is_err());
        let negative = diagonal([-1.0, -2.0, -3.0]);
        assert!(Repair::new(&negative, RepairMethod::Shape(plate)).is_err());
        // All negative: the nearest body is a point.
        let nearest = Repair::new(&negative, RepairMethod::Nearest).unwrap();
        assert_eq!(nearest.inertia().entries(), [0.0; 6]);
        assert!((nearest.distance() - 14_f64.sqrt()).abs() < 1e-12);
        assert!((nearest.relative_distance() - 1.0).abs() < 1e-12);
    }

    proptest! {
        /// Realizable, idempotent, equivariant, and nothing that is realizable is moved.
        #[test]
        fn repairs(
            moments in prop::array::uniform3(-1.0..5.0f64),
            products in prop::array::uniform3(-2.0..2.0f64),
            q in any_attitude(),
            exponent in -250..250i32,
        ) {
            let scale = 10f64.powi(exponent);
            let entries = (moments.map(|x| x * scale), products.map(|x| x * scale));
            let m = InertiaMatrix::from_entries(entries.0, entries.1).unwrap();
            for method in METHODS {
                let repair = Repair::new(&m, method).unwrap();
                prop_assert!(repair.inertia().as_inertia_matrix().is_realizable());
                if m.is_realizable() {
                    prop_assert_eq!(repair.inertia().matrix(), m.matrix());
                    prop_assert_eq!(repair.distance(), 0.0);
                }
                let again = Repair::new(repair.inertia().as_inertia_matrix(), method).unwrap();
                prop_assert_eq!(again.inertia(), repair.inertia());
                let turned = Repair::new(&m.rotated(&q).unwrap(), method).unwrap();
                let image = repair.inertia().as_inertia_matrix().rotated(&q).unwrap();
                let difference = (turned.inertia().matrix() - image.matrix()).map(|x| x / scale).amax();
                prop_assert!(difference < 1e-13, "{method:?}: {difference:e}");
                prop_assert!((turned.distance() - repair.distance()).abs() < 1e-13 * scale);
            }
        }

        /// Of numbers so small that they have few digits or none: what is repaired is realizable, stays as it is, and is
        /// read back, or is refused; so is what principal moments make.
        #[test]
        fn repairs_of_the_smallest_numbers(
            moments in prop::array::uniform3(-1.0..5.0f64),
            products in prop::array::uniform3(-2.0..2.0f64),
            k in prop::array::uniform3(0.1..2.0f64),
            q in any_attitude(),
            exponent in -324.0..-300.0f64,
        ) {
            let scale = 10f64.powf(exponent);
            let shape = Inertia::from_second_moments(SecondMoments::new(k).unwrap(), &q).unwrap();
            let small = |x: [f64; 3]| x.map(|x| x * scale);
            let m = InertiaMatrix::from_entries(small(moments), small(products)).unwrap();
            let mut bodies = vec![];
            for method in METHODS.into_iter().chain([RepairMethod::Shape(shape)]) {
                let repair = match Repair::new(&m, method) {
                    Ok(repair) => repair,
                    Err(RealizabilityError::SecondMoments(SecondMomentsError::Lost { value })) => {
                        prop_assert!(value < f64::MIN_POSITIVE, "{value:e}");
                        continue;
                    }
                    Err(_) => {
                        // Or one of a few units in the last place.
                        let no_trace = !(m.matrix().trace() > 1e-322);
                        prop_assert!(no_trace && matches!(method, RepairMethod::Shape(_)));
                        continue;
                    }
                };
                let again = Repair::new(repair.inertia().as_inertia_matrix(), method).unwrap();
                prop_assert_eq!((again.inertia(), again.distance()), (repair.inertia(), 0.0));
                prop_assert!(repair.distance().is_finite() && repair.relative_distance().is_finite());
                bodies.push(*repair.inertia());
            }
            let of = [k[1] + k[2], k[0] + k[2], k[0] + k[1]];
            bodies.extend(Inertia::from_principal_moments(small(of), &q));
            let of_second = SecondMoments::new(small(k)).unwrap();
            bodies.extend(Inertia::from_second_moments(of_second, &q));
            prop_assert!(exponent < -306.0 || bodies.len() >= 5);
            for body in bodies {
                for body in [Ok(body), body.rotated(&q)].into_iter().flatten() {
                    let matrix = body.as_inertia_matrix();
                    prop_assert!(matrix.is_realizable(), "{matrix:?}");
                    prop_assert!(crate::RealizabilityReport::of(body.matrix()).is_realizable());
                    prop_assert_eq!(Inertia::try_from(<[[f64; 3]; 3]>::from(body)), Ok(body));
                }
            }
        }

        /// Nothing realizable is nearer than the nearest: not another repair, and no body at random.
        #[test]
        fn the_nearest_is_nearest(
            moments in prop::array::uniform3(-1.0..5.0f64),
            products in prop::array::uniform3(-2.0..2.0f64),
            k in prop::array::uniform3(0.0..2.0f64),
            share in 0.0..1.0f64,
            q in any_attitude(),
        ) {
            let m = InertiaMatrix::from_entries(moments, products).unwrap();
            let nearest = Repair::new(&m, RepairMethod::Nearest).unwrap();
            for method in METHODS {
                prop_assert!(nearest.distance() <= Repair::new(&m, method).unwrap().distance() + 1e-13);
            }
            // The obtuse-angle criterion of a projection onto a convex cone (Moreau).
            let moved = m.matrix() - nearest.inertia().matrix();
            prop_assert!(moved.dot(nearest.inertia().matrix()).abs() < 1e-12);
            // On the way from the nearest to any other body, all are bodies, and none is nearer.
            let other = Inertia::from_second_moments(SecondMoments::new(k).unwrap(), &q).unwrap();
            let between = nearest.inertia().matrix() * (1.0 - share) + other.matrix() * share;
            prop_assert!(nearest.distance() <= (between - m.matrix()).norm() + 1e-13);
            prop_assert!(moved.dot(other.matrix()) < 1e-12);
        }
    }
}
