//! Draws of a fitted law that do not depend on the last digits of its parameters.

use gyradius_attitude::{FisherBingham, Method, RadiallyConstrainedGaussian};
use gyradius_dispersion::ScalarRoots;
use nalgebra::{Matrix3, Matrix4, Quaternion, Rotation3, UnitQuaternion, Vector3, Vector4};
use rand::Rng;
use rand_distr::Distribution;

use super::{AxesFinding, AxesFit, PrincipalFit, relabel::Sample};
use crate::turns::law_of_turns;

/// The last digit of Σ⁻¹, as a share of its largest entry, 2⁻²⁴, and within which limits it is. On unit quaternions an entry that
/// is off by so much changes the density by as large a share at most, a thousandth, which no test sees.
const LAST_DIGIT: f64 = 1.0 / (1_u64 << 24) as f64;
const DIGITS: [f64; 2] = [1.0 / (1_u64 << 20) as f64, 1.0 / (1_u64 << 9) as f64];
/// Variances of turns that are told by so many steps a factor of two.
const STEPS: f64 = (1_u64 << 24) as f64;

/// The law that a fit is simulated from.
#[derive(Clone, Debug)]
pub(super) struct Simulated<'a> {
    roots: &'a ScalarRoots,
    axes: Axes<'a>,
}

/// The last digits of the parameters change the order of the cells of the sphere by which wide axes are drawn, and the
/// principal axes of a law that is uniform, and then all draws are others: the same table in other units would have another
/// verdict.
#[derive(Clone, Debug)]
enum Axes<'a> {
    /// Draws that move with the parameters.
    AsFitted(&'a RadiallyConstrainedGaussian),
    Rounded {
        /// The law of q ⊗ m⁻¹.
        from_mean: Box<FisherBingham>,
        mean: UnitQuaternion<f64>,
    },
    /// Of axes that stay but for turns about one or two directions, Σ⁻¹ has no digits left beside those that stay.
    Still {
        /// Of s ⊗ q ⊗ m⁻¹ ⊗ s⁻¹, which turns about the coordinate axes.
        along: Box<RadiallyConstrainedGaussian>,
        /// s.
        frame: UnitQuaternion<f64>,
        mean: UnitQuaternion<f64>,
    },
}

impl<'a> Simulated<'a> {
    pub(super) fn of(fit: &'a PrincipalFit) -> Self {
        let law = fit.axes.law();
        let axes = if law.method() == Method::Chart {
            None
        } else if fit.axes.finding() == AxesFinding::Still {
            still(&fit.axes)
        } else {
            rounded(law)
        };
        Self { roots: fit.law.roots(), axes: axes.unwrap_or(Axes::AsFitted(law)) }
    }

    /// A draw of the law, named as the law names it.
    pub(super) fn draw<R: Rng + ?Sized>(&self, rng: &mut R) -> Sample {
        let roots = self.roots.sample(rng).values().map(f64::abs);
        let attitude = match &self.axes {
            Axes::AsFitted(law) => law.sample(rng),
            Axes::Rounded { from_mean, mean } => from_mean.sample(rng) * mean,
            Axes::Still { along, frame, mean } => {
                frame.inverse() * along.sample(rng) * frame * mean
            }
        };
        Sample { roots, attitude }
    }
}

/// About the mean, which draws move with, so that Σ⁻¹ alone is rounded.
fn rounded<'a>(law: &RadiallyConstrainedGaussian) -> Option<Axes<'a>> {
    let mean = law.mean();
    let turn = from(&mean);
    let precision = turn * law.precision() * turn.transpose();
    let precision = (precision + precision.transpose()) * 0.5;
    let [least, most] = DIGITS;
    // A power of two, which the last digits of the largest entry do not change.
    let digit = libm::exp2(libm::log2(LAST_DIGIT * precision.amax()).ceil()).clamp(least, most);
    // Without the signs of zeros.
    let precision = precision.map(|x| (x / digit).round() * digit + 0.0);
    // The mean is the identity there.
    let linear: Vector4<f64> = precision.column(3).into();
    let law = FisherBingham::new(precision, linear).ok()?;
    Some(Axes::Rounded { from_mean: Box::new(law), mean })
}

/// The directions of the turns, the widest first, are those that draws move with, so that the variances alone are rounded.
fn still<'a>(axes: &AxesFit) -> Option<Axes<'a>> {
    let mean = axes.law().mean();
    let eigen = axes.turn_covariance().symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let [first, second] = [order[0], order[1]].map(|i| {
        let direction: Vector3<f64> = eigen.eigenvectors.column(i).into();
        direction * 1.0_f64.copysign(direction[direction.iamax()])
    });
    let rows = [first, second, first.cross(&second)].map(|row| row.transpose());
    let to_frame = Rotation3::from_matrix_unchecked(Matrix3::from_rows(&rows));
    let frame = UnitQuaternion::from_rotation_matrix(&to_frame) * mean.inverse();
    let variances = order.map(|i| {
        let log = libm::log2(eigen.eigenvalues[i].max(f64::MIN_POSITIVE));
        libm::exp2((log * STEPS).round() / STEPS)
    });
    let along = law_of_turns(UnitQuaternion::identity(), variances).ok()?;
    Some(Axes::Still { along: Box::new(along), frame, mean })
}

/// The matrix that takes the coordinates of q to those of q ⊗ m⁻¹, in which it is linear.
pub(super) fn from(mean: &UnitQuaternion<f64>) -> Matrix4<f64> {
    let back = mean.inverse().into_inner();
    Matrix4::from_columns(
        &[0, 1, 2, 3].map(|i| (Quaternion::from(Vector4::ith(i, 1.0)) * back).coords),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::tests::any_attitude;
    use rand::RngExt;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    /// A law of axes about any mean, 0.6° to 60° wide in each of any three directions.
    fn any_law(rng: &mut ChaCha8Rng) -> RadiallyConstrainedGaussian {
        let (mean, frame) = (any_attitude(rng), any_attitude(rng).to_rotation_matrix());
        let each = [0; 3].map(|_| libm::pow(10.0, rng.random_range(-4.0..0.0)));
        let turns = frame.inverse().matrix()
            * Matrix3::from_diagonal(&Vector3::from(each))
            * frame.matrix();
        let turns = (turns + turns.transpose()) * 0.5;
        let radial = libm::pow(10.0, rng.random_range(-2.0..0.0));
        RadiallyConstrainedGaussian::from_rotation_covariance(mean, turns, radial).unwrap()
    }

    /// Laws narrow in some directions and wide in others: draws have the moments of the law, and are the same but for rounding
    /// when the last digits of the parameters change.
    #[test]
    fn draws_are_those_of_the_law_and_do_not_depend_on_its_last_digits() {
        const LAWS: u64 = 40;
        const N: usize = 20_000;
        let (mut by_cells, mut moved) = (0, 0);
        for seed in 0..LAWS {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let law = any_law(&mut rng);
            let mut noise = || 1.0 + 2e-16 * (rng.random_range(-1..2_i32) as f64);
            let mut covariance = law.covariance().map(|x| x * noise());
            covariance.fill_lower_triangle_with_upper_triangle();
            let mean = Quaternion::from(law.mean().coords.map(|x| x * noise()));
            let mean = UnitQuaternion::new_normalize(mean);
            let other = RadiallyConstrainedGaussian::new(mean, covariance).unwrap();
            let Some(axes) =
                [&law, &other].iter().map(|law| rounded(law)).collect::<Option<Vec<_>>>()
            else {
                panic!("{seed}: {law:?}");
            };
            by_cells += usize::from(law.method() == Method::Cells);
            let roots = ScalarRoots::normal(
                gyradius_inertia::RootSecondMoments::new([3.0, 4.0, 5.0]).unwrap(),
                [0.1; 3],
            );
            let roots = roots.unwrap();
            let draws = |axes: &Axes<'_>| -> Vec<Vector4<f64>> {
                let mut rng = ChaCha8Rng::seed_from_u64(1);
                let simulated = Simulated { roots: &roots, axes: axes.clone() };
                (0..N).map(|_| simulated.draw(&mut rng).attitude.coords).collect()
            };
            let (one, two) = (draws(&axes[0]), draws(&axes[1]));
            moved += usize::from(one.iter().zip(&two).any(|(a, b)| (a - b).amax() > 1e-6));
            let found: Matrix4<f64> = one.iter().map(|q| q * q.transpose() / N as f64).sum();
            // An entry is the mean of N products between −1 and 1.
            let error = (found - law.second_moment()).amax();
            assert!(error < 4.0 / (N as f64).sqrt(), "{seed}: {error}");
        }
        assert!(by_cells > LAWS as usize / 2, "the test must have laws to round: {by_cells}");
        // A last digit may happen to be where rounding turns.
        assert!(moved <= 2, "{moved} of {LAWS}");
    }
}
