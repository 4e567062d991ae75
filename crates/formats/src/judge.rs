//! Whether a body can have an inertia, by how much not, and the nearest one that it can have.

use gyradius_inertia::{InertiaMatrix, MAX_ENTRY, Repair, RepairMethod};
use nalgebra::Matrix3;

/// What is wrong with the inertia of a body.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// An entry is too large to be computed with.
    #[error("an entry is larger than {MAX_ENTRY:.1e}, the most that is computed with")]
    TooLarge,
    /// Entries across the diagonal differ.
    #[error("the matrix is not symmetric: {upper} above the diagonal and {lower} below")]
    NotSymmetric {
        /// Above the diagonal.
        upper: f64,
        /// Below.
        lower: f64,
    },
    /// A principal moment is negative.
    #[error("a principal moment is negative: {0:.4e}")]
    NegativeMoment(f64),
    /// The largest principal moment exceeds the sum of the others.
    #[error("the largest principal moment, {largest:.6}, exceeds the sum of the others, {sum:.6}")]
    Triangle {
        /// The largest.
        largest: f64,
        /// The sum of the others.
        sum: f64,
    },
    /// Inertia without mass.
    #[error("inertia on a mass of {0} kg")]
    NoMass(f64),
    /// A mass below zero.
    #[error("the mass is negative: {0} kg")]
    NegativeMass(f64),
}

/// What is worth knowing, and no fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Note {
    /// No mass and no inertia: a frame.
    #[error("no mass and no inertia: a frame, not a body")]
    Massless,
    /// Mass without inertia.
    #[error("no inertia: a point mass, which resists no rotation")]
    PointMass,
    /// The other sign convention would do.
    #[error("it is realizable with the signs of its products flipped: see --flip-products")]
    FlippedProducts,
}

/// The judgement of one inertia.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    moments: [f64; 3],
    second_moments: [f64; 3],
    margin: f64,
    impossible: bool,
    faults: Vec<Fault>,
    notes: Vec<Note>,
}

impl Judgement {
    /// Principal moments, ascending.
    #[must_use]
    pub fn principal_moments(&self) -> [f64; 3] {
        self.moments
    }

    /// Second mass moments K about the same axes, negative where no body has them; therefore
    /// descending.
    #[must_use]
    pub fn second_moments(&self) -> [f64; 3] {
        self.second_moments
    }

    /// The smallest K over the trace: 1/6 for a ball, 0 for a plate, negative where no body has
    /// it, −∞ where the trace is not positive.
    #[must_use]
    pub fn margin(&self) -> f64 {
        self.margin
    }

    /// How much the largest moment exceeds the sum of the others, in percent of that sum, if it
    /// does and if that sum is positive.
    #[must_use]
    pub fn shortfall_percent(&self) -> Option<f64> {
        let [a, b, c] = self.moments;
        let percent = 100.0 * (c / (a + b) - 1.0);
        (self.impossible && a + b > 0.0 && percent > 0.0).then_some(percent)
    }

    /// Whether no distribution of mass has this inertia.
    #[must_use]
    pub fn is_impossible(&self) -> bool {
        self.impossible
    }

    /// Everything that is wrong.
    #[must_use]
    pub fn faults(&self) -> &[Fault] {
        &self.faults
    }

    /// What is worth knowing besides.
    #[must_use]
    pub fn notes(&self) -> &[Note] {
        &self.notes
    }
}

/// Judges an inertia about the mass centre, products as tensor entries: impossible if
/// min K < −`tolerance`·tr(I), or if entries across the diagonal differ by more than `tolerance`
/// of the largest.
#[must_use]
pub fn judge(matrix: &Matrix3<f64>, mass: Option<f64>, tolerance: f64) -> Judgement {
    let mut faults = Vec::new();
    let mut notes = Vec::new();
    let size = matrix.amax();
    let (moments, second_moments, margin) = spectrum(matrix).unwrap_or_else(|| {
        faults.push(Fault::TooLarge);
        ([f64::NAN; 3], [f64::NAN; 3], f64::NEG_INFINITY)
    });
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        let (upper, lower) = (matrix[(i, j)], matrix[(j, i)]);
        if (upper / size - lower / size).abs() > tolerance {
            faults.push(Fault::NotSymmetric { upper, lower });
        }
    }
    if margin < -tolerance {
        let [a, b, c] = moments;
        if a < -tolerance * size {
            faults.push(Fault::NegativeMoment(a));
        }
        if a + b > 0.0 || a >= -tolerance * size {
            faults.push(Fault::Triangle { largest: c, sum: a + b });
        }
    }
    let impossible = !faults.is_empty();
    let flipped = matrix.map_with_location(|i, j, x| if i == j { x } else { -x });
    if impossible && spectrum(&flipped).is_some_and(|(.., margin)| margin >= -tolerance) {
        notes.push(Note::FlippedProducts);
    }
    match mass {
        Some(mass) if mass < 0.0 => faults.push(Fault::NegativeMass(mass)),
        Some(mass) if mass == 0.0 && size > 0.0 => faults.push(Fault::NoMass(mass)),
        Some(mass) if size == 0.0 => {
            notes.push(if mass > 0.0 { Note::PointMass } else { Note::Massless });
        }
        _ => {}
    }
    Judgement { moments, second_moments, margin, impossible, faults, notes }
}

/// Principal moments ascending, second moments in the same order, and the relative margin.
fn spectrum(matrix: &Matrix3<f64>) -> Option<([f64; 3], [f64; 3], f64)> {
    let size = matrix.amax();
    if !(size <= MAX_ENTRY) {
        return None;
    }
    if size == 0.0 {
        return Some(([0.0; 3], [0.0; 3], 0.0));
    }
    let scaled = symmetric(&matrix.map(|x| x / size));
    let mut moments = InertiaMatrix::new(scaled).ok()?.principal_axes().moments();
    moments.sort_by(f64::total_cmp);
    let [a, b, c] = moments;
    let second = [0.5 * (b + c - a), 0.5 * (a + c - b), 0.5 * (a + b - c)];
    let trace = a + b + c;
    let smallest = second[2];
    let margin = if trace > 0.0 {
        smallest / trace
    } else if smallest < 0.0 {
        f64::NEG_INFINITY
    } else {
        0.0
    };
    Some((moments.map(|x| x * size), second.map(|x| x * size), margin))
}

fn symmetric(matrix: &Matrix3<f64>) -> Matrix3<f64> {
    matrix.zip_map(&matrix.transpose(), |a, b| 0.5 * a + 0.5 * b)
}

/// The realizable inertia nearest to a matrix in the Frobenius norm; none where a number is too large.
#[must_use]
pub fn nearest(matrix: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let symmetric = InertiaMatrix::new(symmetric(matrix)).ok()?;
    let repair = Repair::new(&symmetric, RepairMethod::Nearest).ok()?;
    Some(*repair.inertia().matrix())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn diagonal(d: [f64; 3]) -> Matrix3<f64> {
        Matrix3::from_diagonal(&d.into())
    }

    fn of(matrix: &Matrix3<f64>) -> Judgement {
        judge(matrix, None, 1e-6)
    }

    #[test]
    fn the_shortfall_is_what_an_engineer_would_compute() {
        let judgement = of(&diagonal([1.0, 3.0, 1.0]));
        assert!(judgement.is_impossible());
        assert_eq!(judgement.principal_moments(), [1.0, 1.0, 3.0]);
        assert_eq!(judgement.second_moments(), [1.5, 1.5, -0.5]);
        assert!((judgement.shortfall_percent().unwrap() - 50.0).abs() < 1e-12);
        assert!((judgement.margin() + 0.1).abs() < 1e-15);
        let sentence = judgement.faults()[0].to_string();
        assert!(sentence.contains("3.0") && sentence.contains("2.0"), "{sentence}");
    }

    #[test]
    fn plates_printed_with_six_digits_are_realizable_and_worse_is_not() {
        assert!(!of(&diagonal([0.333333, 0.666666, 1.0])).is_impossible());
        assert!(of(&diagonal([0.3333, 0.6666, 1.0])).is_impossible());
        assert!(judge(&diagonal([0.333333, 0.666666, 1.0]), None, 0.0).is_impossible());
    }

    #[test]
    fn negative_moments_are_said_to_be_negative() {
        for moments in [[-1.0; 3], [-1.0, 5.0, 5.0], [0.0, 0.0, -1e-20], [-2.0, 1.0, 1.0]] {
            let judgement = of(&diagonal(moments));
            let negative = |f: &Fault| matches!(f, Fault::NegativeMoment(_));
            assert!(judgement.faults().iter().any(negative), "{moments:?}");
        }
        assert_eq!(of(&diagonal([-1.0; 3])).margin(), f64::NEG_INFINITY);
        assert_eq!(of(&diagonal([-1.0; 3])).shortfall_percent(), None);
        assert_eq!(of(&diagonal([0.0, 0.0, 1.0])).shortfall_percent(), None, "no sum");
    }

    #[test]
    fn masses_are_judged_apart() {
        let with = |matrix: Matrix3<f64>, mass| judge(&matrix, Some(mass), 1e-6);
        assert_eq!(with(diagonal([1.0; 3]), 0.0).faults(), [Fault::NoMass(0.0)]);
        assert!(!with(diagonal([1.0; 3]), 0.0).is_impossible());
        assert_eq!(with(diagonal([1.0; 3]), -1.0).faults(), [Fault::NegativeMass(-1.0)]);
        assert_eq!(with(Matrix3::zeros(), 0.0).notes(), [Note::Massless]);
        assert_eq!(with(Matrix3::zeros(), 1.0).notes(), [Note::PointMass]);
        assert!(with(Matrix3::zeros(), 1.0).faults().is_empty());
        assert!(of(&Matrix3::zeros()).notes().is_empty(), "nothing is known of the mass");
    }

    #[test]
    fn a_wrong_sign_convention_is_noticed() {
        // A rod along (1, 1, 1): Σ = x xᵀ, all products −1 as tensor entries.
        let rod = Matrix3::new(2.0, -1.0, -1.0, -1.0, 2.0, -1.0, -1.0, -1.0, 2.0);
        assert!(!of(&rod).is_impossible());
        let flipped = rod.map(f64::abs);
        assert!(of(&flipped).is_impossible());
        assert_eq!(of(&flipped).notes(), [Note::FlippedProducts]);
    }

    #[test]
    fn lopsided_and_huge_matrices_are_faults() {
        let mut matrix = Matrix3::identity();
        matrix[(0, 1)] = 0.1;
        assert!(matches!(of(&matrix).faults(), [Fault::NotSymmetric { .. }]));
        assert_eq!(of(&diagonal([1e308; 3])).faults(), [Fault::TooLarge]);
        assert!(of(&diagonal([1e306, 1e306, 2.5e306])).is_impossible());
        assert!(of(&diagonal([5e-324, 5e-324, 2e-323])).is_impossible());
    }

    #[test]
    fn the_nearest_inertia_is_a_face_an_edge_or_the_tip() {
        let near = |d| nearest(&diagonal(d)).unwrap().diagonal();
        assert!(
            (near([1.0, 1.0, 3.0]) - diagonal([4.0 / 3.0, 4.0 / 3.0, 8.0 / 3.0]).diagonal()).amax()
                < 1e-15
        );
        assert!((near([-1.0, 2.0, 4.0]) - diagonal([0.0, 3.0, 3.0]).diagonal()).amax() < 1e-15);
        assert_eq!(near([-1.0; 3]).amax(), 0.0);
        assert_eq!(near([3.0, 4.0, 5.0]).as_slice(), [3.0, 4.0, 5.0]);
    }

    proptest! {
        #[test]
        fn no_realizable_inertia_is_nearer(
            d in prop::array::uniform3(-1.0..1.0f64),
            o in prop::array::uniform3(-1.0..1.0f64),
            points in prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 3),
        ) {
            let m = Matrix3::new(d[0], o[0], o[1], o[0], d[1], o[2], o[1], o[2], d[2]);
            let near = nearest(&m).unwrap();
            prop_assert!(InertiaMatrix::new(near).unwrap().is_realizable());
            // The obtuse-angle criterion of a projection onto a convex cone.
            prop_assert!((m - near).dot(&near).abs() < 1e-13);
            for p in points {
                let x = nalgebra::Vector3::from(p);
                let other = Matrix3::identity() * x.norm_squared() - x * x.transpose();
                prop_assert!((m - near).dot(&other) < 1e-13);
            }
        }

        #[test]
        fn nothing_panics(
            nine in prop::array::uniform9(prop::num::f64::ANY),
            mass in prop::num::f64::ANY,
        ) {
            let matrix = Matrix3::from_row_slice(&nine);
            let _ = (judge(&matrix, Some(mass), 1e-6), nearest(&matrix));
        }
    }
}
