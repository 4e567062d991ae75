//! Nonlinear least squares within bounds, for a dozen unknowns of any size.

use nalgebra::{DMatrix, DVector};

use super::curvature::Curvature;

/// Times that a step is shortened before it counts as none.
const SHORTER: usize = 12;
/// The step of differences, as a share of the size of an unknown.
const STEP: f64 = 1e-5;
/// The damping at first, and how it changes.
const DAMPING: f64 = 1e-3;
const LESS: f64 = 0.1;
const LEAST_DAMPING: f64 = 1e-9;
const MORE: f64 = 5.0;

/// When the search ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    /// Steps at most.
    steps: usize,
    /// A step that takes less than this share off the cost is the last one, unless a bound cut it short.
    worth: f64,
    /// Whether the curvature of the residuals counts, which is worth it where they stay large.
    curved: bool,
}

impl Effort {
    pub(crate) const FULL: Self = Self { steps: 200, worth: 3e-4, curved: false };
    /// Until next to nothing is gained.
    pub(crate) const FINE: Self = Self { steps: 200, worth: 1e-5, curved: true };
    /// To see which of many starts is worth it.
    pub(crate) const SHORT: Self = Self { steps: 15, worth: 3e-2, curved: false };
}

/// Sum of squared residuals.
pub(crate) trait Problem {
    /// The unknowns and what is worked out of them.
    type Point: Clone;

    /// The unknowns at a point.
    fn values(&self, point: &Self::Point) -> DVector<f64>;
    /// The point with these unknowns, next to another one. They are within the bounds.
    fn at(&self, values: DVector<f64>, near: &Self::Point) -> Self::Point;
    /// What is to be small.
    fn residuals(&self, point: &Self::Point) -> DVector<f64>;
    /// The bounds of each unknown, and its size.
    fn range(&self, point: &Self::Point, unknown: usize) -> Range;
}

/// Where an unknown may be.
pub(crate) struct Range {
    pub(crate) least: f64,
    pub(crate) most: f64,
    pub(crate) unit: f64,
}

/// The least sum of squares that is found downhill from a point (Levenberg 1944, Marquardt 1963, doi:10.1137/0111030).
/// Unknowns at a bound stay there while the slope leads beyond it; a start that is beyond one begins at it.
pub(crate) fn least_squares<P: Problem>(
    problem: &P,
    start: P::Point,
    effort: Effort,
) -> (P::Point, f64) {
    let mut point = inside(problem, start);
    let mut residuals = problem.residuals(&point);
    let mut cost = residuals.norm_squared();
    let mut damping = DAMPING;
    let mut curvature = effort.curved.then(|| Curvature::new(problem.values(&point).len()));
    for _ in 0..effort.steps {
        let values = problem.values(&point);
        let ranges: Vec<_> = (0..values.len()).map(|i| problem.range(&point, i)).collect();
        let mut slopes = DMatrix::zeros(residuals.len(), values.len());
        for (i, range) in ranges.iter().enumerate() {
            let step = STEP * range.unit;
            let inward = if values[i] + step > range.most { -1.0 } else { 1.0 };
            let mut beside = values.clone();
            beside[i] += inward * step;
            // As far as it really went, in floating point.
            let step = beside[i] - values[i];
            let there = problem.residuals(&problem.at(beside, &point));
            slopes.set_column(i, &((there - &residuals) / step));
        }
        let down = slopes.tr_mul(&residuals) * -1.0;
        let held: Vec<bool> = (0..values.len())
            .map(|i| {
                let Range { least, most, .. } = ranges[i];
                (values[i] <= least && down[i] < 0.0) || (values[i] >= most && down[i] > 0.0)
            })
            .collect();
        let normal = slopes.tr_mul(&slopes);
        let curved = curvature.as_mut().map(|it| &normal + it.at(&values, &slopes, &residuals));
        let mut next = None;
        for _ in 0..SHORTER {
            let to = |normal| within(&values, &ranges, normal, &down, &held, damping);
            // The sum may be curved downward here, where only the step of Gauss and Newton leads down.
            let Some(there) = curved.as_ref().and_then(to).or_else(|| to(&normal)) else { break };
            let arrives = |i: usize| {
                let Range { least, most, .. } = ranges[i];
                there[i] != values[i] && (there[i] == least || there[i] == most)
            };
            // A step that a bound cut short says little of what the next one gains.
            let is_whole = !(0..values.len()).any(arrives);
            let there = problem.at(there, &point);
            let residuals = problem.residuals(&there);
            let lower = residuals.norm_squared();
            if lower < cost {
                next = Some((there, residuals, lower, is_whole));
                damping = (damping * LESS).max(LEAST_DAMPING);
                break;
            }
            damping *= MORE;
        }
        let mut last = true;
        if let Some((there, at, lower, is_whole)) = next {
            last = is_whole && lower > (1.0 - effort.worth) * cost;
            (point, residuals, cost) = (there, at, lower);
        }
        if last {
            // A step that what was learned of the curvature led astray says nothing of the others.
            match &mut curvature {
                Some(curvature) if curvature.has_learned() => {
                    curvature.forget();
                    damping = DAMPING;
                }
                Some(_) | None => break,
            }
        }
    }
    (point, cost)
}

/// The nearest point within the bounds.
fn inside<P: Problem>(problem: &P, point: P::Point) -> P::Point {
    let values = problem.values(&point);
    let nearest = DVector::from_fn(values.len(), |i, _| {
        let Range { least, most, .. } = problem.range(&point, i);
        values[i].clamp(least, most)
    });
    if nearest == values { point } else { problem.at(nearest, &point) }
}

/// Where a damped step leads. Unknowns that it would take beyond a bound go to that bound, and the others are solved for
/// again, as often as one leaves: cut off alone, a step may lead uphill however short it is.
fn within(
    values: &DVector<f64>,
    ranges: &[Range],
    normal: &DMatrix<f64>,
    down: &DVector<f64>,
    held: &[bool],
    damping: f64,
) -> Option<DVector<f64>> {
    let units: Vec<f64> = ranges.iter().map(|range| range.unit).collect();
    let mut open: Vec<usize> = (0..held.len()).filter(|i| !held[*i]).collect();
    let mut there = values.clone();
    loop {
        let right = down - normal * (&there - values);
        let step = damped(normal, &right, &open, &units, damping)?;
        let mut inside = Vec::with_capacity(open.len());
        for (&i, step) in open.iter().zip(&step) {
            let reached = values[i] + step;
            let Range { least, most, .. } = ranges[i];
            if reached < least || reached > most {
                there[i] = reached.clamp(least, most);
            } else {
                inside.push((i, reached));
            }
        }
        if inside.len() == open.len() {
            inside.into_iter().for_each(|(i, reached)| there[i] = reached);
            return Some(there);
        }
        open = inside.into_iter().map(|(i, _)| i).collect();
    }
}

/// The solution of (N + λ max(N) 1) x = g over some unknowns, in units of their sizes. Levenberg's damping, not Marquardt's,
/// which lets go of the unknowns that do little: in narrow valleys, where deviations cancel, it hardly gets on.
fn damped(
    normal: &DMatrix<f64>,
    down: &DVector<f64>,
    open: &[usize],
    units: &[f64],
    damping: f64,
) -> Option<Vec<f64>> {
    let matrix = DMatrix::from_fn(open.len(), open.len(), |a, b| {
        normal[(open[a], open[b])] * units[open[a]] * units[open[b]]
    });
    let size = matrix.diagonal().iter().copied().fold(0.0, f64::max);
    let matrix = matrix / size + DMatrix::from_diagonal_element(open.len(), open.len(), damping);
    let right = DVector::from_fn(open.len(), |a, _| down[open[a]] * units[open[a]] / size);
    let solution = matrix.cholesky()?.solve(&right);
    let step: Vec<f64> = open.iter().zip(&solution).map(|(i, x)| x * units[*i]).collect();
    step.iter().all(|x| x.is_finite()).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand::RngExt;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    /// Residuals as a function of the unknowns, all of which lie between two bounds.
    struct Within<F> {
        residuals: F,
        bounds: [f64; 2],
    }

    impl<F: Fn(&DVector<f64>) -> DVector<f64>> Problem for Within<F> {
        type Point = DVector<f64>;

        fn values(&self, point: &DVector<f64>) -> DVector<f64> {
            point.clone()
        }

        fn at(&self, values: DVector<f64>, _: &DVector<f64>) -> DVector<f64> {
            values
        }

        fn residuals(&self, point: &DVector<f64>) -> DVector<f64> {
            (self.residuals)(point)
        }

        fn range(&self, _: &DVector<f64>, _: usize) -> Range {
            let [least, most] = self.bounds;
            Range { least, most, unit: 1.0 }
        }
    }

    /// |Ax − b|² between zero and a bound.
    fn boxed(a: DMatrix<f64>, b: DVector<f64>, most: f64) -> impl Problem<Point = DVector<f64>> {
        Within { residuals: move |x: &DVector<f64>| &a * x - &b, bounds: [0.0, most] }
    }

    /// The same residuals without bounds.
    fn free(
        residuals: impl Fn(&DVector<f64>) -> DVector<f64>,
    ) -> impl Problem<Point = DVector<f64>> {
        Within { residuals, bounds: [f64::NEG_INFINITY, f64::INFINITY] }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(8_000))]

        /// Nothing within the bounds is better, tried along every unknown and towards random points.
        #[test]
        fn nothing_allowed_is_better(
            a in prop::collection::vec(-1.0..1.0f64, 20),
            b in prop::collection::vec(-1.0..1.0f64, 5),
            others in prop::collection::vec(prop::array::uniform4(0.0..1.0f64), 20),
            most in 0.05..3.0f64,
            start in prop_oneof![Just([0.5; 4]), prop::array::uniform4(-1.0..2.0f64)],
        ) {
            let a = DMatrix::from_vec(5, 4, a);
            prop_assume!(a.clone().svd(false, false).singular_values.min() > 0.05);
            let problem = boxed(a, DVector::from_vec(b), most);
            let (x, cost) = least_squares(&problem, DVector::from_row_slice(&start) * most, Effort::FULL);
            prop_assert!(x.iter().all(|x| (0.0..=most).contains(x)));
            for other in &others {
                let other = DVector::from_row_slice(other) * most;
                for share in [1e-2, 0.1, 1.0] {
                    let y = &x + (&other - &x) * share;
                    let there = problem.residuals(&y).norm_squared();
                    prop_assert!(there > cost * (1.0 - 2.0 * Effort::FULL.worth) - 1e-9, "{there} {cost}");
                }
            }
        }
    }

    /// The first step leads beyond both bounds, and what is left of it gains next to nothing.
    #[test]
    fn the_corner_beyond_a_valley_is_found() {
        let a = DMatrix::from_row_slice(2, 2, &[-0.75, -1.0, 0.0, -0.5]);
        let problem = boxed(a, DVector::from_vec(vec![0.5, -0.25]), 0.5);
        let (x, cost) = least_squares(&problem, DVector::from_element(2, 0.25), Effort::FULL);
        assert!(x.amax() == 0.0 && cost == 0.3125, "{x} {cost}");
    }

    /// Of 500 problems of what cannot be had, with curved residuals that are large at the least sum, those whose search ends where more can be
    /// had downhill.
    fn unfinished(effort: Effort) -> usize {
        const WHOLE: Effort = Effort { steps: 5000, worth: 0.0, curved: false };
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut is_unfinished = || {
            let a = DMatrix::from_fn(8, 5, |_, _| rng.random_range(-1.0..1.0));
            let b = DVector::from_fn(8, |_, _| rng.random_range(-3.0..3.0));
            let problem = free(|x| (&a * x).map(|x| x + x * x) - &b);
            let (x, cost) = least_squares(&problem, DVector::zeros(5), effort);
            cost > 1.001 * least_squares(&problem, x, WHOLE).1
        };
        (0..500).filter(|_| is_unfinished()).count()
    }

    /// Large residuals are brought down to where the sum is flat, which Gauss's and Newton's steps do not do alone.
    #[test]
    fn the_curvature_of_large_residuals_counts() {
        let without = unfinished(Effort { curved: false, ..Effort::FINE });
        let with = unfinished(Effort::FINE);
        assert!(4 * with < without && with < 5, "{with} and {without} of 500");
    }

    /// The valley of Rosenbrock (1960, doi:10.1093/comjnl/3.3.175).
    #[test]
    fn a_narrow_valley_is_followed_to_its_end() {
        let valley = free(|x| DVector::from_vec(vec![10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]]));
        let (x, cost) = least_squares(&valley, DVector::from_vec(vec![-1.2, 1.0]), Effort::FULL);
        assert!(cost < 1e-9 && (x[0] - 1.0).abs() < 1e-4, "{x} {cost}");
    }
}
