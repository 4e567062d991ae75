//! Reasons why a matrix is not the inertia of any body.

use nalgebra::Matrix3;
use std::fmt;

#[cfg(feature = "serde")]
use crate::principal::second_moments;
use crate::{InertiaMatrix, MAX_ENTRY, RELATIVE_TOLERANCE};

/// Which axes moments of inertia belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Axes {
    /// The axes the matrix is given in.
    Given,
    /// The principal axes.
    Principal,
}

/// One reason why a matrix is not the inertia of any body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Fault {
    /// An entry is NaN, infinite or too large.
    NotFinite {
        /// Row, from 1.
        row: usize,
        /// Column, from 1.
        column: usize,
        /// The entry, kg·m². JSON has it as a text where it is no finite number.
        #[cfg_attr(feature = "serde", serde(with = "crate::read::any"))]
        value: f64,
    },
    /// Entries across the diagonal differ.
    NotSymmetric {
        /// Row of the upper entry, from 1.
        row: usize,
        /// Column of the upper entry, from 1.
        column: usize,
        /// The entry above the diagonal, kg·m².
        upper: f64,
        /// The entry below the diagonal, kg·m².
        lower: f64,
        /// Their difference, in percent of the largest entry.
        percent: f64,
    },
    /// A moment of inertia is negative.
    NegativeMoment {
        /// About which axes.
        axes: Axes,
        /// Which axis, from 1.
        axis: usize,
        /// The moment, kg·m².
        moment: f64,
    },
    /// A moment of inertia is larger than the sum of the other two.
    Triangle {
        /// About which axes.
        axes: Axes,
        /// Which axis has the largest moment, from 1.
        axis: usize,
        /// The moments, kg·m².
        moments: [f64; 3],
        /// How far the largest exceeds the sum of the others, in percent of that sum; none where that is nothing.
        percent: Option<f64>,
    },
    /// A product of inertia is larger in magnitude than half the moment about the third axis:
    /// |I_ij| ≤ ½ I_kk.
    Product {
        /// Row, from 1.
        row: usize,
        /// Column, from 1.
        column: usize,
        /// The product, kg·m².
        product: f64,
        /// The moment about the third axis, kg·m².
        moment: f64,
    },
}

/// What is to be said of a matrix in the place of an inertia matrix: whether some body has it, by
/// what margin, and if none, why.
///
/// # Rule
/// Realizable means finite, symmetric and min K_k ≥ −[`RELATIVE_TOLERANCE`]·tr I, with the second
/// mass moments K_k the eigenvalues of Σ = ½ tr(I)·1 − I. Rods, plates and points (K_k = 0) are
/// realizable; [`is_strict`](Self::is_strict) leaves them out. K_k and the trace are the same in every
/// frame, and the rule the same in all units.
///
/// ```
/// use gyradius_inertia::RealizabilityReport;
/// use nalgebra::Matrix3;
///
/// let report = RealizabilityReport::of(&Matrix3::new(
///     100.0, 5.0, 10.0,
///     5.0, 200.0, 20.0,
///     10.0, 20.0, 300.0,
/// ));
/// assert!(!report.is_realizable());
/// assert_eq!(
///     report.to_string(),
///     "not realizable: principal moment 304.42 kg·m² exceeds the sum of the others, \
///      99.339 + 196.24 kg·m², by 2.99 %"
/// );
/// ```
#[derive(Clone, Debug, PartialEq, getset::CopyGetters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(remote = "Self"))]
#[getset(get_copy = "pub")]
pub struct RealizabilityReport {
    /// The second mass moments K_k about the principal axes, with their signs, kg·m²; none where an
    /// entry is not finite.
    second_moments: Option<[f64; 3]>,
    /// The principal moments, kg·m², in the order of [`PrincipalAxes`](crate::PrincipalAxes).
    principal_moments: Option<[f64; 3]>,
    /// min K_k / Σ|I_k| with the principal moments I_k, whose sum is the trace of every body: ⅙ for a
    /// ball, 0 for a plate, a rod and a point, negative beyond, and never below −½. None where an
    /// entry is not finite.
    margin: Option<f64>,
    #[getset(skip)]
    faults: Vec<Fault>,
}

#[cfg(feature = "serde")]
crate::read::belonging!(RealizabilityReport);

impl RealizabilityReport {
    /// Looks at a matrix, in kg·m², products as tensor entries. Any numbers will do.
    #[must_use]
    pub fn of(matrix: &Matrix3<f64>) -> Self {
        Self::within(matrix, RELATIVE_TOLERANCE)
    }

    /// The same with another tolerance, as a share of tr I: numbers with six digits put plates and rods
    /// up to 1e-6 beyond the boundary, and a matrix may be as far from symmetric. A smaller tolerance than
    /// [`RELATIVE_TOLERANCE`], also NaN or a negative one, is taken as that one: the computation itself rounds by as much.
    #[must_use]
    pub fn within(matrix: &Matrix3<f64>, tolerance: f64) -> Self {
        let tolerance = tolerance.max(RELATIVE_TOLERANCE);
        let size = matrix.amax();
        let mut faults = Vec::new();
        for row in 0..3 {
            for column in 0..3 {
                let value = matrix[(row, column)];
                if !(value.abs() <= MAX_ENTRY) {
                    faults.push(Fault::NotFinite { row: row + 1, column: column + 1, value });
                }
            }
        }
        if !faults.is_empty() {
            return Self { second_moments: None, principal_moments: None, margin: None, faults };
        }
        for (row, column) in [(0, 1), (0, 2), (1, 2)] {
            let (upper, lower) = (matrix[(row, column)], matrix[(column, row)]);
            if (upper - lower).abs() > tolerance * size {
                faults.push(Fault::NotSymmetric {
                    row: row + 1,
                    column: column + 1,
                    upper,
                    lower,
                    percent: 100.0 * ((upper - lower) / size).abs(),
                });
            }
        }
        let symmetric = InertiaMatrix::symmetrized(matrix);
        let axes = symmetric.principal_axes();
        let (k, moments) = (axes.second_moments(), axes.moments());
        let margin = margin_of(&symmetric);
        if !symmetric.is_realizable_within(tolerance) {
            let given: [f64; 3] = symmetric.matrix().diagonal().into();
            let slack = tolerance * size;
            let before = faults.len();
            moment_faults(Axes::Given, given, slack, &mut faults);
            product_faults(&symmetric, slack, &mut faults);
            // Where the given axes show nothing, the principal ones do.
            if faults.len() == before {
                moment_faults(Axes::Principal, moments, 0.0, &mut faults);
            }
        }
        Self {
            second_moments: Some(k),
            principal_moments: Some(moments),
            margin: Some(margin),
            faults,
        }
    }

    /// Whether some distribution of non-negative mass has this inertia.
    #[must_use]
    pub fn is_realizable(&self) -> bool {
        self.faults.is_empty()
    }

    /// Whether a body of positive volume has it: no rod, plate or point.
    #[must_use]
    pub fn is_strict(&self) -> bool {
        self.is_realizable() && self.margin.is_some_and(|m| m > RELATIVE_TOLERANCE)
    }

    /// How far the largest principal moment exceeds the sum of the other two, in percent of that sum: 0
    /// if it does not, infinite if that sum is negative or rounding beside the largest, none where an
    /// entry is not finite.
    #[must_use]
    pub fn excess_percent(&self) -> Option<f64> {
        self.principal_moments.map(excess_percent)
    }

    /// Whether some matrix has these numbers, with some tolerance.
    #[cfg(feature = "serde")]
    fn belongs_together(&self) -> bool {
        let of_entries = |fault: &Fault| matches!(fault, Fault::NotFinite { .. });
        let (Some(k), Some(moments), Some(margin)) =
            (self.second_moments, self.principal_moments, self.margin)
        else {
            let none =
                (self.second_moments, self.principal_moments, self.margin) == (None, None, None);
            let faults = &self.faults;
            return none
                && !faults.is_empty()
                && faults.iter().all(|fault| of_entries(fault) && fault.is_one());
        };
        let least = k.into_iter().fold(f64::INFINITY, f64::min);
        let sum: f64 = moments.into_iter().map(f64::abs).sum();
        // Smaller moments have fewer digits than the margin.
        let is_margin = if sum > 1e-290 && sum.is_finite() {
            (margin - least / sum).abs() < 1e-9
        } else {
            (-0.5..=0.2).contains(&margin)
        };
        k == second_moments(moments)
            && is_margin
            && self.faults.iter().all(|fault| !of_entries(fault) && fault.is_one())
    }

    /// What is wrong; nothing if the matrix is realizable.
    #[must_use]
    pub fn faults(&self) -> &[Fault] {
        &self.faults
    }
}

#[cfg(feature = "serde")]
impl Fault {
    /// Whether its numbers are at fault, and of a matrix of three rows.
    fn is_one(&self) -> bool {
        let across = |row: usize, column: usize| (1..column).contains(&row) && column <= 3;
        match *self {
            Self::NotFinite { row, column, value } => {
                (1..=3).contains(&row) && (1..=3).contains(&column) && !(value.abs() <= MAX_ENTRY)
            }
            Self::NotSymmetric { row, column, upper, lower, percent } => {
                across(row, column) && upper != lower && (0.0..=201.0).contains(&percent)
            }
            Self::NegativeMoment { axes: Axes::Given | Axes::Principal, axis, moment } => {
                (1..=3).contains(&axis) && moment < 0.0
            }
            Self::Triangle { axes: Axes::Given | Axes::Principal, axis, moments, percent } => {
                let excess = excess_percent(moments);
                axis == largest(moments).0 + 1
                    && excess > 0.0
                    && percent == Some(excess).filter(|p| p.is_finite())
            }
            Self::Product { row, column, product, moment } => {
                across(row, column) && product.abs() > (0.5 * moment).max(0.0)
            }
        }
    }
}

/// min K_k / Σ|I_k|, of numbers far from either end of the range.
fn margin_of(matrix: &InertiaMatrix) -> f64 {
    let size = matrix.matrix().amax();
    if size == 0.0 {
        return 0.0;
    }
    // Two steps, because no float takes the smallest number to 1.
    let step = if size < 1e-150 { 2f64.powi(500) } else { 1.0 };
    let enlarged = matrix.matrix() * step;
    let scaled = enlarged * (if enlarged.amax() < 1e-150 { step } else { 1.0 });
    let axes = InertiaMatrix::symmetrized(&(scaled / scaled.amax())).principal_axes();
    let least = axes.second_moments().into_iter().fold(f64::INFINITY, f64::min);
    least / axes.moments().into_iter().map(f64::abs).sum::<f64>()
}

/// The axis of the largest moment, and the sum of the others.
fn largest(m: [f64; 3]) -> (usize, f64) {
    let axis = (0..3).fold(0, |best, j| if m[j] > m[best] { j } else { best });
    (axis, m[(axis + 1) % 3] + m[(axis + 2) % 3])
}

pub(crate) fn excess_percent(m: [f64; 3]) -> f64 {
    let (axis, rest) = largest(m);
    if m[axis] <= rest {
        0.0
    } else if rest > RELATIVE_TOLERANCE * m[axis] {
        100.0 * ((m[axis] - rest) / rest)
    } else {
        f64::INFINITY
    }
}

fn moment_faults(axes: Axes, moments: [f64; 3], slack: f64, faults: &mut Vec<Fault>) {
    let before = faults.len();
    for (j, &moment) in moments.iter().enumerate() {
        if moment < -slack {
            faults.push(Fault::NegativeMoment { axes, axis: j + 1, moment });
        }
    }
    let (axis, rest) = largest(moments);
    // A negative moment breaks the inequality as well: once is enough.
    if faults.len() == before && moments[axis] - rest > 2.0 * slack {
        let percent = Some(excess_percent(moments)).filter(|p| p.is_finite());
        faults.push(Fault::Triangle { axes, axis: axis + 1, moments, percent });
    }
}

fn product_faults(matrix: &InertiaMatrix, slack: f64, faults: &mut Vec<Fault>) {
    let m = matrix.matrix();
    for (row, column, third) in [(0, 1, 2), (0, 2, 1), (1, 2, 0)] {
        let (product, moment) = (m[(row, column)], m[(third, third)]);
        if product.abs() > (0.5 * moment).max(0.0) + slack {
            faults.push(Fault::Product { row: row + 1, column: column + 1, product, moment });
        }
    }
}

/// Five digits for the eye, fewer where they are zeros.
fn short(x: f64) -> String {
    let exponent = if x == 0.0 { 0 } else { x.abs().log10().floor() as i32 };
    if !(-3..6).contains(&exponent) {
        return format!("{x:.4e}");
    }
    let text = format!("{x:.*}", (4 - exponent).clamp(0, 8) as usize);
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

fn percent(x: f64) -> String {
    if !(1e-2..1e4).contains(&x) { format!("{x:.1e}") } else { format!("{x:.2}") }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = |axes: Axes, axis: usize| match axes {
            Axes::Given => format!("I{axis}{axis} = "),
            Axes::Principal => "principal moment ".to_owned(),
        };
        match *self {
            Self::NotFinite { row, column, value } => {
                write!(
                    f,
                    "entry I{row}{column} = {value:e} kg·m²: it must be finite and at most \
                     {MAX_ENTRY:.1e}"
                )
            }
            Self::NotSymmetric { row, column, upper, lower, percent: p } => write!(
                f,
                "I{row}{column} = {} but I{column}{row} = {} kg·m², {} % of the largest entry apart",
                short(upper),
                short(lower),
                percent(p)
            ),
            Self::NegativeMoment { axes, axis, moment } => {
                write!(f, "{}{} kg·m² is negative", name(axes, axis), short(moment))
            }
            Self::Triangle { axes, axis, moments, percent: p } => {
                let j = axis - 1;
                let others = match j {
                    0 => [1, 2],
                    1 => [0, 2],
                    _ => [0, 1],
                };
                write!(
                    f,
                    "{}{} kg·m² exceeds the sum of the others, {} + {} kg·m²",
                    name(axes, axis),
                    short(moments[j]),
                    short(moments[others[0]]),
                    short(moments[others[1]])
                )?;
                // Of nothing there is no percentage.
                p.map_or(Ok(()), |p| write!(f, ", by {} %", percent(p)))
            }
            Self::Product { row, column, product, moment } => {
                let third = 6 - row - column;
                write!(
                    f,
                    "product |I{row}{column}| = {} kg·m² is larger than half of I{third}{third} = {} kg·m²",
                    short(product.abs()),
                    short(moment)
                )
            }
        }
    }
}

impl fmt::Display for RealizabilityReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((first, rest)) = self.faults.split_first() {
            write!(f, "not realizable: {first}")?;
            for fault in rest {
                write!(f, "; {fault}")?;
            }
            return Ok(());
        }
        let (Some(k), Some(margin)) = (self.second_moments, self.margin) else { return Ok(()) };
        let trace: f64 = k.iter().map(|k| 2.0 * k).sum();
        let zeros = k.iter().filter(|k| **k <= RELATIVE_TOLERANCE * trace).count();
        match zeros {
            0 => write!(
                f,
                "realizable: second moments {}, {}, {} kg·m², margin {} % of the trace",
                short(k[0]),
                short(k[1]),
                short(k[2]),
                percent(100.0 * margin)
            ),
            1 => write!(f, "realizable, on the boundary: a plate"),
            2 => write!(f, "realizable, on the boundary: a rod"),
            _ => write!(f, "realizable, on the boundary: a point"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn diagonal(moments: [f64; 3]) -> Matrix3<f64> {
        Matrix3::from_diagonal(&moments.into())
    }

    fn faults(matrix: Matrix3<f64>) -> Vec<Fault> {
        RealizabilityReport::of(&matrix).faults().to_vec()
    }

    /// What has been found in the wild, one fault each.
    #[test]
    fn every_condition_is_named() {
        let one = Matrix3::<f64>::identity();
        let with = |i, j, value| {
            let mut m = one;
            m[(i, j)] = value;
            m
        };
        for bad in [f64::NAN, f64::INFINITY, 1e308] {
            let found = faults(with(0, 2, bad));
            assert!(matches!(found[..], [Fault::NotFinite { row: 1, column: 3, .. }]), "{found:?}");
        }
        let found = faults(with(1, 2, 0.01));
        assert!(
            matches!(found[..], [Fault::NotSymmetric { row: 2, column: 3, percent, .. }] if (percent - 1.0).abs() < 1e-12)
        );
        let found = faults(diagonal([1.0, -1e-9, 1.0]));
        assert!(
            matches!(found[..], [Fault::NegativeMoment { axis: 2, axes: Axes::Given, .. }]),
            "{found:?}"
        );
        for short in [1e-3, 1e-12] {
            let found = faults(diagonal([1.0, 2.0, 3.0 * (1.0 + short)]));
            let [Fault::Triangle { axis: 3, axes: Axes::Given, percent: Some(percent), .. }] =
                found[..]
            else {
                panic!("{found:?}");
            };
            assert!((percent / (100.0 * short) - 1.0).abs() < 1e-2, "{percent}");
        }
        // Moments that could be, products that could be, together not.
        let leaning = Matrix3::new(100.0, 5.0, 10.0, 5.0, 200.0, 20.0, 10.0, 20.0, 300.0);
        let found = faults(leaning);
        assert!(matches!(found[..], [Fault::Triangle { axes: Axes::Principal, .. }]), "{found:?}");
        let large = Matrix3::new(10.0, 0.0, 0.0, 0.0, 10.0, -6.0, 0.0, -6.0, 10.0);
        let found = faults(large);
        assert!(matches!(found[..], [Fault::Product { row: 2, column: 3, .. }]), "{found:?}");
        let text = RealizabilityReport::of(&large).to_string();
        assert_eq!(
            text,
            "not realizable: product |I23| = 6 kg·m² is larger than half of I11 = 10 kg·m²"
        );
    }

    #[test]
    fn boundary_bodies_are_realizable_and_not_strict() {
        for (moments, name) in
            [([0.0; 3], "point"), ([0.0, 1.0, 1.0], "rod"), ([1.0, 2.0, 3.0], "plate")]
        {
            let report = RealizabilityReport::of(&diagonal(moments));
            assert!(report.is_realizable() && !report.is_strict(), "{name}");
            assert!(report.to_string().ends_with(name), "{report}");
            assert_eq!(report.margin(), Some(0.0));
            assert_eq!(report.excess_percent(), Some(0.0), "{name}");
        }
        let ball = RealizabilityReport::of(&diagonal([1.0; 3]));
        assert!(ball.is_strict());
        assert!((ball.margin().unwrap() - 1.0 / 6.0).abs() < 1e-15);
        assert_eq!(ball.second_moments(), Some([0.5; 3]));
        assert_eq!(
            ball.to_string(),
            "realizable: second moments 0.5, 0.5, 0.5 kg·m², margin 16.67 % of the trace"
        );
    }

    #[test]
    fn without_a_trace_there_is_a_margin_all_the_same() {
        // K₁ = ½ (1 − 2 − 1), of moments that add up to zero.
        let report = RealizabilityReport::of(&diagonal([1.0, 1.0, -2.0]));
        assert_eq!(report.margin(), Some(-0.25));
        assert_eq!(RealizabilityReport::of(&diagonal([0.0, 0.0, -5e-324])).margin(), Some(-0.5));
    }

    proptest::proptest! {
        /// Whole numbers times powers of two, down to the smallest float: margin and verdicts are
        /// those at 1 kg·m².
        #[test]
        fn the_margin_does_not_depend_on_the_unit(
            m in proptest::array::uniform3(-3..60i32),
            p in proptest::array::uniform3(-9..9i32),
            exponent in -1074..1000i32,
        ) {
            let of = |unit: f64| {
                let [a, b, c] = m.map(|x| f64::from(x) * unit);
                let [d, e, f] = p.map(|x| f64::from(x) * unit);
                RealizabilityReport::of(&Matrix3::new(a, d, e, d, b, f, e, f, c))
            };
            let unit = 2f64.powi(exponent / 2) * 2f64.powi(exponent - exponent / 2);
            let (one, other) = (of(1.0), of(unit));
            let (a, b) = (one.margin().unwrap(), other.margin().unwrap());
            proptest::prop_assert!((a - b).abs() < 1e-14 && a >= -0.5 - 1e-14, "{a} {b}");
            proptest::prop_assert_eq!(one.is_realizable(), other.is_realizable());
            proptest::prop_assert_eq!(one.is_strict(), other.is_strict());
        }
    }

    #[test]
    fn a_tolerance_forgives_what_six_digits_lose() {
        let printed = diagonal([0.123_457, 0.234_568, 0.358_026]);
        assert!(!RealizabilityReport::of(&printed).is_realizable());
        assert!(RealizabilityReport::within(&printed, 1e-5).is_realizable());
        for nothing in [f64::NAN, -1.0] {
            assert!(!RealizabilityReport::within(&printed, nothing).is_realizable());
            assert!(
                RealizabilityReport::within(&diagonal([1.0, 2.0, 3.0]), nothing).is_realizable()
            );
        }
    }

    #[test]
    fn sentences_have_no_percentage_of_nothing_and_name_the_limit() {
        assert_eq!(
            RealizabilityReport::of(&diagonal([0.0, 0.0, 1.0])).to_string(),
            "not realizable: I33 = 1 kg·m² exceeds the sum of the others, 0 + 0 kg·m²"
        );
        assert_eq!(
            RealizabilityReport::of(&diagonal([1.0, 1e308, 1.0])).to_string(),
            "not realizable: entry I22 = 1e308 kg·m²: it must be finite and at most 2.8e306"
        );
    }

    #[test]
    fn the_excess_is_that_of_the_principal_moments_at_any_size() {
        for scale in [5e-324, 1e-300, 1.0, 1e305] {
            let excess = |m: [f64; 3]| {
                RealizabilityReport::of(&diagonal(m.map(|x| x * scale))).excess_percent().unwrap()
            };
            assert!((excess([1.0, 1.0, 4.0]) - 100.0).abs() < 1e-12, "{scale:e}");
            assert_eq!(excess([1.0, 1.0, 2.0]), 0.0);
            assert_eq!(excess([0.0, 0.0, 1.0]), f64::INFINITY);
            assert_eq!(excess([-1.0, -1.0, -1.0]), f64::INFINITY);
        }
        // Moments 0, 0 and 3, of which an eigen solver leaves 1e-38 instead of the zeros.
        let ones = RealizabilityReport::of(&Matrix3::repeat(1e-6));
        assert_eq!(ones.excess_percent(), Some(f64::INFINITY));
    }

    proptest! {
        /// No tolerance below that of rounding is another one than that.
        #[test]
        fn a_tolerance_below_rounding_is_that_of_rounding(
            moments in prop::array::uniform2(0.0..5.0f64),
            beyond in -3.0..3.0f64,
            skew in -3.0..3.0f64,
            turn in prop::array::uniform3(-1.0..1.0f64),
            below in prop_oneof![Just(f64::NAN), Just(0.0), -1.0..0.0f64, 0.0..RELATIVE_TOLERANCE],
        ) {
            let [a, b] = moments;
            let rotation = nalgebra::Rotation3::new(turn.into()).into_inner();
            let plate = diagonal([a, b, (a + b) * (1.0 + beyond * RELATIVE_TOLERANCE)]);
            let mut matrix = rotation * plate * rotation.transpose();
            matrix[(0, 1)] += skew * RELATIVE_TOLERANCE * plate.amax();
            let found = RealizabilityReport::within(&matrix, below);
            prop_assert_eq!(found, RealizabilityReport::of(&matrix));
        }

        /// The report and the yes/no question agree, at every scale, and there is always a reason.
        #[test]
        fn reports_agree_with_the_question(
            moments in prop::array::uniform3(-1.0..5.0f64),
            products in prop::array::uniform3(-2.0..2.0f64),
            exponent in -300..300i32,
        ) {
            let scale = 10f64.powi(exponent);
            let m = InertiaMatrix::from_entries(moments.map(|x| x * scale), products.map(|x| x * scale));
            let m = m.unwrap();
            let report = RealizabilityReport::of(m.matrix());
            prop_assert_eq!(report.is_realizable(), m.is_realizable());
            let k = report.second_moments().unwrap();
            let least = k.into_iter().fold(f64::INFINITY, f64::min);
            prop_assert!(report.is_realizable() || least < 0.0);
            prop_assert!(!report.to_string().is_empty());
        }

        #[test]
        fn no_numbers_panic(entries in prop::array::uniform9(prop::num::f64::ANY), tolerance in prop::num::f64::ANY) {
            let report = RealizabilityReport::within(&Matrix3::from_row_slice(&entries), tolerance);
            let _ = (report.to_string(), report.excess_percent(), report.is_strict());
        }

        /// What is written of any matrix reads back, and what is spoilt in it is refused.
        #[cfg(feature = "serde")]
        #[test]
        fn reports_read_back(
            entries in prop_oneof![
                prop::array::uniform9(prop_oneof![-3..4_i32, Just(0)].prop_map(f64::from)),
                prop::array::uniform6(-3..4_i32).prop_map(|e| [0, 1, 2, 1, 3, 4, 2, 4, 5].map(|i| f64::from(e[i]))),
                prop::array::uniform9(prop::num::f64::ANY),
                prop::array::uniform9(prop_oneof![Just(1.0), Just(f64::INFINITY), Just(f64::NEG_INFINITY), Just(f64::NAN)]),
            ],
            exponent in -300..300_i32,
            tolerance in prop_oneof![Just(0.0), Just(1e-6), Just(0.9)],
        ) {
            let matrix = Matrix3::from_row_slice(&entries) * 10_f64.powi(exponent);
            let report = RealizabilityReport::within(&matrix, tolerance);
            let text = serde_json::to_string(&report).unwrap();
            let read = |text: &str| serde_json::from_str::<RealizabilityReport>(text);
            let back = read(&text).map_err(|error| TestCaseError::fail(format!("{error}: {text}")))?;
            prop_assert_eq!(&serde_json::to_string(&back).unwrap(), &text);
            // NaN is not equal to itself.
            if !matrix.iter().any(|x| x.is_nan()) {
                prop_assert_eq!(&back, &report);
            }
            let whole: serde_json::Value = serde_json::from_str(&text).unwrap();
            for (place, bad) in [
                ("/second_moments/0", 1.5e307),
                ("/principal_moments/2", 1.5e307),
                ("/margin", 0.3),
                ("/faults/0/NotSymmetric/row", 3.0),
                ("/faults/0/Triangle/axis", 4.0),
                ("/faults/0/NegativeMoment/moment", 0.0),
                ("/faults/0/NotFinite/column", 0.0),
                ("/faults/0/Product/product", 0.0),
            ] {
                let mut spoilt = whole.clone();
                if let Some(number) = spoilt.pointer_mut(place).filter(|x| x.is_number()) {
                    *number = if number.is_f64() { bad.into() } else { (bad as u64).into() };
                    prop_assert!(read(&spoilt.to_string()).is_err(), "{}: {}", place, text);
                }
            }
        }
    }
}
