//! The law of the inertia of a part: realizable in every draw, also of plates, rods and points.

use gyradius_dispersion::LogCholeskyGaussian;
use gyradius_inertia::{Inertia, InertiaMatrix, Repair, RepairMethod};
use nalgebra::{Matrix3, Vector3};
use rand::Rng;
use rand_distr::Distribution;

use super::free_correlations::{FLOOR, nearest_covariance};
use super::nearest_law::NearestLaw;
use super::scaled_correlations::ScaledCorrelations;
use super::symmetric::{
    Matrix6, Six, congruence, inertia_of_second_moments, mapped, second_moments_of_inertia, six,
};

/// Second moments below this share of the largest are none.
const NONE: f64 = 1e-9;

/// What relative difference of a deviation is told of, where those below this share of the largest count as that.
const SAME: f64 = 0.01;
const LEAST: f64 = 0.1;

/// If no covariance comes nearer to the stated deviations than this share of the largest, none has them.
const NEAR: f64 = 0.05;

/// How much the square of a correlation weighs beside that of a relative difference of a deviation: independence is mostly
/// nobody's statement, deviations are.
const CORRELATION: f64 = 0.01;

/// Σ = T S Tᵀ with T Tᵀ the second moments of the mean body and S random, positive definite, of mean one.
///
/// Where the mean body is a plate, T has two columns; where it is a rod, one: a matrix Σ ⪰ 0 of mean Σ̄ has Σ n = 0
/// wherever Σ̄ n = 0, so that no other draws have this mean.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SecondMomentLaw {
    mean: Inertia,
    draws: Draws,
    /// How many second moments are not zero: 3, 2 of a plate, 1 of a rod, 0 of a point.
    rank: usize,
    /// Whether a covariance of matrices of this rank has the stated deviations.
    possible: bool,
    covariance: Matrix6,
}

/// How Σ is drawn.
#[derive(Clone, Debug, PartialEq)]
enum Draws {
    /// Not at all.
    Fixed,
    /// T and S.
    Relative(Box<(Matrix3<f64>, LogCholeskyGaussian)>),
    /// By its diagonal and its correlations.
    Scaled(Box<ScaledCorrelations>),
}

impl SecondMomentLaw {
    /// Of a mean and a covariance of I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃, as nearly as is found. Of plates and rods, only the
    /// deviations count, and correlations are those that bring the law nearest.
    pub(super) fn new(mean: &Inertia, covariance: &Matrix6) -> Option<Self> {
        let axes = mean.principal_axes();
        let mut sorted: Vec<(f64, Vector3<f64>)> = mean
            .second_moments()
            .values()
            .into_iter()
            .zip(axes.axes().matrix().column_iter().map(nalgebra::Matrix::into_owned))
            .collect();
        sorted.sort_by(|a, b| b.0.total_cmp(&a.0));
        let largest = sorted[0].0;
        let rank = sorted.iter().filter(|(k, _)| *k > NONE * largest && *k > 0.0).count();
        let is_fixed = covariance.amax() == 0.0;
        let fixed = Self {
            mean: *mean,
            draws: Draws::Fixed,
            rank,
            possible: rank > 0 || is_fixed,
            covariance: Matrix6::zeros(),
        };
        if rank == 0 || is_fixed {
            return Some(fixed);
        }
        let (mut out, mut back) = (Matrix3::zeros(), Matrix3::zeros());
        for (i, (k, axis)) in sorted[..rank].iter().enumerate() {
            out.set_column(i, &(axis * k.sqrt()));
            back.set_row(i, &(axis.transpose() / k.sqrt()));
        }
        let entries = inertia_of_second_moments() * congruence(&out);
        let relative = |NearestLaw { law, scale, covariance }| {
            // What is beyond the rank does not vary, and `out` leaves it away.
            let draws = Draws::Relative(Box::new((out * scale, law)));
            Self { draws, covariance: mapped(&entries, &covariance), ..fixed.clone() }
        };
        if rank < 3 {
            let deviations = deviations_of(covariance);
            let nearest = nearest_covariance(&entries, &deviations);
            let possible = has(&mapped(&entries, &nearest), &deviations);
            return NearestLaw::new(&nearest).map(|law| Self { possible, ..relative(law) });
        }
        let absolute = mapped(&second_moments_of_inertia(), covariance);
        let stated = mapped(&congruence(&back), &absolute);
        if let Some(law) = NearestLaw::exact(&stated) {
            return Some(relative(law));
        }
        let nominal = six(&mean.as_inertia_matrix().second_moment_matrix());
        let deviations = deviations_of(covariance);
        let scaled = |absolute: &Matrix6| {
            let law = ScaledCorrelations::new(&nominal, absolute)?;
            let covariance = mapped(&inertia_of_second_moments(), &law.covariance());
            Some(Self { draws: Draws::Scaled(Box::new(law)), covariance, ..fixed.clone() })
        };
        // Each has its limits: what comes nearest to what is stated is taken.
        let laws = [
            scaled(&absolute),
            scaled(&with_free_moments(&nominal, &absolute, &deviations)),
            NearestLaw::new(&stated).map(relative),
        ];
        let off = |law: &Self| law.off(covariance, &deviations);
        laws.into_iter().flatten().min_by(|a, b| off(a).total_cmp(&off(b)))
    }

    /// How far it is from what is stated: a sum of squares of relative differences of the deviations, and of differences
    /// of the correlations.
    fn off(&self, stated: &Matrix6, deviations: &[f64; 6]) -> f64 {
        let largest = deviations.iter().copied().fold(0.0, f64::max);
        let size = |e: usize| deviations[e].max(FLOOR * largest);
        let found = deviations_of(&self.covariance);
        let square = |e: usize| ((found[e] - deviations[e]) / size(e)).powi(2);
        let pair = |e: usize, f: usize| {
            let gap = self.covariance[(e, f)] - stated[(e, f)];
            CORRELATION * (gap / (size(e) * size(f))).powi(2)
        };
        (0..6).map(|e| square(e) + (0..e).map(|f| pair(e, f)).sum::<f64>()).sum()
    }

    pub(super) fn mean(&self) -> &Inertia {
        &self.mean
    }

    pub(super) fn rank(&self) -> usize {
        self.rank
    }

    /// Whether any law of such bodies can have the stated deviations, as far as their covariance tells.
    pub(super) fn is_possible(&self) -> bool {
        self.possible
    }

    /// Covariance of the entries that the law has.
    pub(super) fn covariance(&self) -> &Matrix6 {
        &self.covariance
    }
}

impl Distribution<Inertia> for SecondMomentLaw {
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> Inertia {
        loop {
            let sigma = match &self.draws {
                Draws::Fixed => return self.mean,
                Draws::Relative(law) => {
                    let (out, law) = &**law;
                    let drawn: Inertia = law.sample(rng);
                    out * drawn.as_inertia_matrix().second_moment_matrix() * out.transpose()
                }
                Draws::Scaled(law) => law.sample(rng),
            };
            let inertia = Matrix3::identity() * sigma.trace() - sigma;
            // Never refused within forty deviations.
            if let Some(body) = body(&((inertia + inertia.transpose()) * 0.5)) {
                return body;
            }
        }
    }
}

/// The deviations of a covariance, of which rounding may have made a variance negative.
pub(super) fn deviations_of(covariance: &Matrix6) -> [f64; 6] {
    std::array::from_fn(|e| covariance[(e, e)].max(0.0).sqrt())
}

/// Whether a covariance has the stated deviations, as nearly as a search finds them.
fn has(covariance: &Matrix6, stated: &[f64; 6]) -> bool {
    let largest = stated.iter().copied().fold(0.0, f64::max);
    deviations_of(covariance).iter().zip(stated).all(|(it, is)| (it - is).abs() <= NEAR * largest)
}

/// The entries whose deviations are not those stated, each with the deviation that it has.
pub(super) fn missed(
    covariance: &Matrix6,
    stated: &[f64; 6],
) -> impl Iterator<Item = (usize, f64)> {
    let largest = stated.iter().copied().fold(0.0, f64::max);
    let found = deviations_of(covariance);
    let stated = *stated;
    let is_missed = move |(e, found): &(usize, f64)| {
        (found - stated[*e]).abs() > SAME * stated[*e].max(LEAST * largest)
    };
    found.into_iter().enumerate().filter(is_missed)
}

/// The covariance of Σ with moments of inertia of the same deviations that are not independent, but correlated so that no
/// Σᵢᵢ scatters more, beside its mean, than they ask for.
fn with_free_moments(nominal: &Six, covariance: &Matrix6, deviations: &[f64; 6]) -> Matrix6 {
    let scale = Six::from_fn(|e, _| if e < 3 { nominal[e] } else { 0.0 });
    let scale = Matrix6::from_diagonal(&scale);
    let [a, b, c, ..] = *deviations;
    let moments = [a, b, c, 0.0, 0.0, 0.0];
    let free = nearest_covariance(&(inertia_of_second_moments() * scale), &moments);
    let free = mapped(&scale, &free);
    Matrix6::from_fn(|e, f| if e < 3 && f < 3 { free[(e, f)] } else { covariance[(e, f)] })
}

/// The body of a matrix that is one but for rounding.
fn body(matrix: &Matrix3<f64>) -> Option<Inertia> {
    let matrix = InertiaMatrix::new(*matrix).ok()?;
    Inertia::try_from(matrix).ok().or_else(|| {
        Repair::new(&matrix, RepairMethod::Nearest).ok().map(|repair| *repair.inertia())
    })
}
