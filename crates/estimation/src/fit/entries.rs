//! Whether the six entries of the samples have the mean and the covariance that the fitted law gives them.

use gyradius_dispersion::{AttitudeMoments, EntryMoments};
use nalgebra::{DMatrix, DVector, Matrix3, Matrix4, Vector3, Vector4};
use rand::{Rng, RngExt};

use super::{
    AxesFinding, PrincipalFit,
    goodness::bootstrap,
    names::Names,
    relabel::{Relabeling, Sample},
    round::direction,
    simulated::{self, Simulated},
};
use crate::rollup::symmetric::{Matrix6, Six, congruence, mapped};

/// Draws of the law by which the covariances of what is compared are known, to a few per cent; and as many others, which the
/// samples are compared with.
const DRAWS: usize = 4000;
/// Directions in which less of the variance than this is left over by the parameters of the law are not compared.
const LEAST: f64 = 0.05;
/// Parameters that tell no more than others do: a share of variance that is rounding.
const REDUNDANT: f64 = 1e-6;
/// Of the six entries: where they stand.
const ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
/// Six entries and 21 products of two of them.
const COMPARED: usize = 27;

/// What is compared, and the slopes of the ln-likelihood that the fit has made zero, each less what the law expects.
struct Rows<'a> {
    fit: &'a PrincipalFit,
    names: Names<'a>,
    /// Mean, covariance and deviations of the entries about the mean principal axes.
    mean: Six,
    covariance: Matrix6,
    deviations: [f64; 6],
    /// Expectation of p pᵀ and of p, the quaternion from the mean, the scalar part last.
    second: Matrix4<f64>,
    first: Vector4<f64>,
    /// Expectation of 1 − a aᵀ, of each principal axis a.
    across: [[f64; 6]; 3],
}

impl<'a> Rows<'a> {
    fn of(fit: &'a PrincipalFit) -> Self {
        let law = fit.axes.law();
        let turn = simulated::from(&law.mean());
        let moments = EntryMoments::of(&fit.law);
        let axes = congruence(law.mean().to_rotation_matrix().matrix());
        let covariance = mapped(&axes, moments.covariance());
        Self {
            fit,
            names: fit.names(),
            mean: axes * Six::from(moments.mean()),
            covariance,
            deviations: std::array::from_fn(|e| covariance[(e, e)].max(0.0).sqrt()),
            second: turn * law.second_moment() * turn.transpose(),
            first: turn * law.mean_vector(),
            across: law.expected_forms(),
        }
    }

    /// The six entries in deviations, and the products of two of them: about the mean principal axes, so that they are the same
    /// whatever the axes of the body are.
    fn compared(&self, sample: &Sample, row: &mut Vec<f64>) {
        let from_mean = sample.attitude * self.fit.axes.law().mean().inverse();
        let r = *from_mean.to_rotation_matrix().matrix();
        let k = sample.roots.map(|k| k * k);
        let second = r.tr_mul(&(Matrix3::from_diagonal(&Vector3::from(k)) * r));
        let matrix = Matrix3::from_diagonal_element(k.iter().sum()) - second;
        let (mean, covariance, deviations) = (self.mean, self.covariance, self.deviations);
        let over = |x: f64, y: f64| if y > 0.0 { x / y } else { 0.0 };
        let z: [f64; 6] =
            std::array::from_fn(|e| over(matrix[ENTRIES[e]] - mean[e], deviations[e]));
        row.extend(z);
        for e in 0..6 {
            for f in 0..=e {
                let expected = over(over(covariance[(e, f)], deviations[e]), deviations[f]);
                row.push(z[e] * z[f] - expected);
            }
        }
    }

    /// Slopes of the ln-likelihood by the parameters that were fitted: those under each naming, as the namings are likely.
    fn slopes(&self, sample: &Sample, row: &mut Vec<f64>) {
        let law = self.fit.axes.law();
        let back = law.mean().inverse();
        let weights = self.names.weights(sample);
        let total: f64 = weights.iter().sum();
        let mut sums = [0.0; 6 + 13];
        for (g, weight) in Relabeling::all().iter().zip(weights) {
            // What is less likely adds nothing that counts.
            if !(weight > 1e-9 * total) {
                continue;
            }
            let share = weight / total;
            let named = sample.relabeled(g);
            for (axis, root) in self.fit.roots.iter().enumerate() {
                let (m, s) = (root.mean(), root.deviation());
                if s > 0.0 {
                    let k = named.roots[axis];
                    let signed = k * libm::tanh((m / s) * (k / s));
                    sums[2 * axis] += share * (signed - m) / s;
                    sums[2 * axis + 1] += share
                        * (((k / s).powi(2) - 2.0 * (m / s) * (signed / s) + (m / s).powi(2))
                            - 1.0);
                }
            }
            let sums = &mut sums[6..];
            match self.fit.axes.finding() {
                AxesFinding::Free | AxesFinding::Still => {}
                AxesFinding::FreeTurn { axis } => {
                    let a = direction(&named.attitude, axis - 1);
                    let across = Matrix3::identity() - a * a.transpose();
                    for (e, entry) in ENTRIES.iter().enumerate() {
                        sums[e] += share * (across[*entry] - self.across[axis - 1][e]);
                    }
                }
                AxesFinding::Determined => {
                    let p = (named.attitude * back).coords;
                    let q = named.attitude;
                    let ahead = law.ln_density(&q)
                        - law.ln_density(&nalgebra::UnitQuaternion::new_unchecked(-q.into_inner()));
                    let signed = p * libm::tanh(0.5 * ahead) - self.first;
                    let mut n = 0;
                    for i in 0..4 {
                        // The squares add up to one: the last one follows.
                        for j in 0..=i.min(2) {
                            sums[n] += share * (p[i] * p[j] - self.second[(i, j)]);
                            n += 1;
                        }
                        sums[9 + i] += share * signed[i];
                    }
                }
            }
        }
        row.extend(sums);
    }

    fn matrix(&self, samples: impl Iterator<Item = Sample>) -> DMatrix<f64> {
        let mut values = Vec::new();
        let mut count = 0;
        for sample in samples {
            self.compared(&sample, &mut values);
            self.slopes(&sample, &mut values);
            count += 1;
        }
        DMatrix::from_vec(values.len() / count.max(1), count, values)
    }
}

impl PrincipalFit {
    /// p-value of mean and covariance of the six entries, and the least it can be; none where there is nothing to
    /// compare.
    ///
    /// With g the entries and their products, and s the slopes of the ln-likelihood, both less what the law expects,
    /// the part of the mean of g that does not depend on the parameters is that of e = g − Cov(g, s) Cov(s)⁻¹ s, whether
    /// these are known or were fitted (Neyman 1959). Its square in units of its covariance is compared with that
    /// of as many draws.
    pub(super) fn entries_p_value<R: Rng + ?Sized>(
        &self,
        simulated: &Simulated<'_>,
        rng: &mut R,
        tick: &mut dyn FnMut(),
    ) -> Option<(f64, f64)> {
        if self.axes.finding() == AxesFinding::Still {
            return None;
        }
        let rows = Rows::of(self);
        let mut draws = || {
            let drawn: Vec<Sample> = (0..DRAWS).map(|_| simulated.draw(rng)).collect();
            let drawn = rows.matrix(drawn.into_iter());
            let mean = drawn.column_mean();
            DMatrix::from_fn(drawn.nrows(), DRAWS, |i, j| drawn[(i, j)] - mean[i])
        };
        // Covariances suit the draws that they are estimated from better than others, as the samples are.
        let (centred, others) = (draws(), draws());
        let own = rows.matrix(self.samples.iter().copied());
        let covariance = &centred * centred.transpose() / DRAWS as f64;
        let compared = covariance.view((0, 0), (COMPARED, COMPARED)).into_owned();
        let slopes = centred.nrows() - COMPARED;
        let cross = covariance.view((0, COMPARED), (COMPARED, slopes)).into_owned();
        let own_slopes = covariance.view((COMPARED, COMPARED), (slopes, slopes)).into_owned();
        // Cov(s)⁻¹ where it has one, in deviations.
        let scale = own_slopes.diagonal().map(|v| if v > 0.0 { 1.0 / v.sqrt() } else { 0.0 });
        let scale = DMatrix::from_diagonal(&scale);
        let inverse = (&scale * own_slopes * &scale).pseudo_inverse(REDUNDANT).ok()?;
        let slope = cross * &scale * inverse * &scale;
        let left = &compared - &slope * covariance.view((COMPARED, 0), (slopes, COMPARED));
        let eigen = ((&left + left.transpose()) * 0.5).symmetric_eigen();
        let kept: Vec<usize> = (0..COMPARED).filter(|i| eigen.eigenvalues[*i] > LEAST).collect();
        if kept.is_empty() {
            return None;
        }
        let white = DMatrix::from_fn(kept.len(), COMPARED, |i, j| {
            eigen.eigenvectors[(j, kept[i])] / eigen.eigenvalues[kept[i]].sqrt()
        });
        let reduced = |rows: &DMatrix<f64>| {
            &white * (rows.rows(0, COMPARED) - &slope * rows.rows(COMPARED, slopes))
        };
        let n = self.samples.len();
        let observed = n as f64 * reduced(&own).column_mean().norm_squared();
        if !observed.is_finite() {
            return None;
        }
        let law = reduced(&others);
        Some(bootstrap(observed, n, tick, || {
            let mut sum = DVector::zeros(kept.len());
            for _ in 0..n {
                sum += law.column(rng.random_range(0..DRAWS));
            }
            sum.norm_squared() / n as f64
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::AxesFit;
    use gyradius_attitude::{RadiallyConstrainedGaussian, UniformAttitude};
    use gyradius_dispersion::{PrincipalDispersion, ScalarRoots};
    use gyradius_inertia::{Inertia, RootSecondMoments};
    use nalgebra::UnitQuaternion;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use rand_distr::Distribution;

    /// Draws of a fitted law look worse than draws of it as often as they should, and samples of a law of wide axes look
    /// worse than draws of uniform axes whenever they are taken for such.
    #[test]
    fn moments_of_another_law_are_told_from_the_own() {
        const TABLES: usize = 16;
        const N: usize = 300;
        let mean = RootSecondMoments::new([38.0, 37.0, 44.0]).unwrap();
        let roots = ScalarRoots::normal(mean, [2.0, 8.0, 0.2]).unwrap();
        let turns = Matrix3::from_diagonal(&Vector3::new(0.1, 0.6, 0.3));
        let (mut p_values, mut found) = (Vec::new(), 0);
        let mut rng = ChaCha8Rng::seed_from_u64(6);
        let mean: UnitQuaternion<f64> = UniformAttitude.sample(&mut rng);
        let axes = RadiallyConstrainedGaussian::from_rotation_covariance(mean, turns, 0.2).unwrap();
        let truth = PrincipalDispersion::new(roots, axes);
        let samples: Vec<Inertia> = (0..N).map(|_| truth.sample(&mut rng)).collect();
        let fit = PrincipalFit::new(&samples).unwrap();
        assert_eq!(fit.axes.finding(), AxesFinding::Determined);
        let mut uniform = fit.clone();
        uniform.axes = AxesFit::plain(mean, [f64::INFINITY; 3], AxesFinding::Free);
        uniform.law = PrincipalDispersion::new(fit.law.roots().clone(), uniform.axes.law().clone());
        let simulated = Simulated::of(&fit);
        for _ in 0..TABLES {
            let drawn: Vec<Sample> = (0..N).map(|_| simulated.draw(&mut rng)).collect();
            let mut p_value = |fit: &PrincipalFit| {
                let fit = PrincipalFit { samples: drawn.clone(), ..fit.clone() };
                fit.entries_p_value(&Simulated::of(&fit), &mut rng, &mut || {}).unwrap().0
            };
            p_values.push(p_value(&fit));
            found += usize::from(p_value(&uniform) < 0.002);
        }
        assert_eq!(found, TABLES);
        // Of 16, those below a half are 8 ± 2, and none is likely to be below 1 %.
        let below = |limit| p_values.iter().filter(|p| **p < limit).count();
        assert!((2..=14).contains(&below(0.5)) && below(0.01) < 2, "{p_values:?}");
    }
}
