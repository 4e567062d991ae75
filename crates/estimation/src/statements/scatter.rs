//! How a body scatters about the nominal one: its roots, and its axes by turns.

use std::error::Error;

use gyradius_attitude::RadiallyConstrainedGaussian;
use gyradius_dispersion::{
    CorrelatedRoots, EntryMoments, PrincipalDispersion, RootLaw, ScalarRoots,
    SecondMomentStatistics,
};
use gyradius_inertia::{Inertia, RootSecondMoments};
use nalgebra::{Matrix3, SymmetricEigen, UnitQuaternion};

use super::{
    StatementError,
    entries::Forms,
    nodes::{Rule, Turns},
};
use crate::turns::{chart_variances, law_of_turns_about};

/// The model of Peck (2003), with roots that may be correlated.
pub(super) type Law = PrincipalDispersion<RootLaw, RadiallyConstrainedGaussian>;

/// A turn of this variance, rad², may be any: what its law moves is that of a uniform one to a percent.
const ANY: f64 = 10.0;
/// Variances of a second rotation, rad², up to which the rule of nodes is exact for every purpose.
const NARROW: f64 = 0.04;

/// A nominal body, by what scatters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body {
    pub(super) attitude: UnitQuaternion<f64>,
    pub(super) roots: RootSecondMoments,
}

/// Covariances of Gaussian roots in kg·m², and of rotations about the principal axes in rad².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Scatter {
    #[cfg_attr(feature = "serde", serde(rename = "root_covariance_kg_m2"))]
    pub(super) roots: Matrix3<f64>,
    #[cfg_attr(feature = "serde", serde(rename = "rotation_covariance_rad2"))]
    pub(super) rotations: Matrix3<f64>,
}

impl Scatter {
    /// Variances of the rotations about the principal axes, rad², infinite where a turn may be any.
    /// Two free turns leave the third one free, too.
    pub(super) fn rotation_variances(&self) -> [f64; 3] {
        let variances = self.rotations.diagonal();
        match variances.iter().filter(|v| !(**v < ANY)).count() {
            0 | 1 => variances.map(|v| if v < ANY { v } else { f64::INFINITY }).into(),
            _ => [f64::INFINITY; 3],
        }
    }
}

impl Body {
    pub(super) fn new(nominal: &Inertia) -> Self {
        Self {
            attitude: nominal.principal_axes().attitude(),
            roots: nominal.second_moments().roots(),
        }
    }

    /// Mean and covariance of the second moments.
    pub(super) fn second_moments(&self, scatter: &Scatter) -> SecondMomentStatistics {
        SecondMomentStatistics::of_gaussian_roots(self.roots, &scatter.roots)
    }

    /// What the axes do to the entries, to a percent of a deviation.
    pub(super) fn forms(&self, scatter: &Scatter) -> Forms {
        Forms::over(&self.turns(scatter), Rule::QUICK)
    }

    /// What axes that nothing moves add to the variances of the entries of bodies with these second moments: no law has less.
    pub(super) fn held_variances(&self, k: &SecondMomentStatistics) -> [f64; 6] {
        Forms::held(&self.attitude).variances(k)
    }

    /// Moments of the entries of the law that scatters so.
    pub(super) fn moments(&self, scatter: &Scatter, law: &Law) -> EntryMoments {
        let turns = self.turns(scatter);
        let mut variances = turns.variances;
        variances.sort_by(f64::total_cmp);
        if variances[1] > NARROW {
            EntryMoments::of(law)
        } else {
            EntryMoments::by_quadrature(&self.second_moments(scatter), turns.nodes(Rule::FINE))
        }
    }

    /// The law that scatters so.
    pub(super) fn law(&self, scatter: &Scatter) -> Result<Law, StatementError> {
        self.try_law(scatter).map_err(|e| StatementError::Law { problem: e.to_string() })
    }

    fn try_law(&self, scatter: &Scatter) -> Result<Law, Box<dyn Error>> {
        let c = &scatter.roots;
        let independent = *c == Matrix3::from_diagonal(&c.diagonal());
        let roots: RootLaw = if independent {
            ScalarRoots::normal(self.roots, c.diagonal().into())?.into()
        } else {
            CorrelatedRoots::new(self.roots, *c)?.into()
        };
        let (about, variances) = self.independent_turns(scatter);
        let axes = law_of_turns_about(self.attitude, &about, variances)?;
        Ok(PrincipalDispersion::new(roots, axes))
    }

    /// The law of the axes as quadrature takes it.
    fn turns(&self, scatter: &Scatter) -> Turns {
        let (about, variances) = self.independent_turns(scatter);
        let (variances, radial_variance) = chart_variances(variances);
        let about = std::array::from_fn(|i| about.row(i).transpose());
        Turns { mean: self.attitude, about, variances, radial_variance }
    }

    /// The axes of independent rotations as rows, in body axes, and their variances, rad².
    fn independent_turns(&self, scatter: &Scatter) -> (Matrix3<f64>, [f64; 3]) {
        let r = *self.attitude.to_rotation_matrix().matrix();
        let mut v = scatter.rotations;
        let any = scatter.rotation_variances().map(f64::is_infinite);
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            if any[i] || any[j] {
                (v[(i, j)], v[(j, i)]) = (0.0, 0.0);
            }
        }
        if v == Matrix3::from_diagonal(&v.diagonal()) {
            return (r, scatter.rotation_variances());
        }
        let eigen = SymmetricEigen::new(v);
        let variance = |v: f64| if v < ANY { v.max(0.0) } else { f64::INFINITY };
        (eigen.eigenvectors.transpose() * r, eigen.eigenvalues.map(variance).into())
    }
}

/// Gaussian roots whose squares have this covariance, (kg·m²)²; of correlations that no squares have, the largest
/// share that they have.
pub(super) fn roots_of(mean: RootSecondMoments, moments: &Matrix3<f64>) -> Matrix3<f64> {
    let k = mean.values();
    // The smaller of the two solutions of Cov(K_i, K_j) = 4 k̄_i k̄_j c + 2c².
    let root = |i: usize, j: usize| {
        let (product, half) = (k[i] * k[j], 0.5 * moments[(i, j)]);
        let below = product + (product * product + half).max(0.0).sqrt();
        if below > 0.0 { half / below } else { 0.0 }
    };
    let with = |share: f64| {
        Matrix3::from_fn(|i, j| if i == j { root(i, i).max(0.0) } else { share * root(i, j) })
    };
    let has = |share: f64| CorrelatedRoots::new(mean, with(share)).is_ok();
    let (mut least, mut most) = (0.0, 1.0);
    if has(most) {
        return with(most);
    }
    for _ in 0..40 {
        let share = 0.5 * (least + most);
        if has(share) {
            least = share;
        } else {
            most = share;
        }
    }
    with(least)
}

#[cfg(test)]
mod tests {
    use super::*;
    use gyradius_dispersion::RootMoments;
    use nalgebra::Vector3;
    use proptest::prelude::*;

    fn body(k: [f64; 3], turn: [f64; 3]) -> Body {
        let k = gyradius_inertia::SecondMoments::new(k).unwrap();
        let q = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
        Body::new(&Inertia::from_second_moments(k, &q).unwrap())
    }

    fn covariance(f: [f64; 9], size: f64) -> Matrix3<f64> {
        let f = Matrix3::from_row_slice(&f);
        f * f.transpose() * (size / f.norm_squared().max(0.01))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        /// Squares of the roots have the covariance, wherever roots can have it.
        #[test]
        fn squares_have_the_covariance(
            k in prop::array::uniform3(0.5..10.0f64),
            f in prop::array::uniform9(-1.0..1.0f64),
            size in -12.0..-1.0f64,
        ) {
            let mean = RootSecondMoments::new(k).unwrap();
            let c = covariance(f, 10_f64.powf(size));
            let roots = CorrelatedRoots::new(mean, roots_of(mean, &c)).unwrap();
            let found = *roots.second_moment_statistics().covariance();
            for i in 0..3 {
                for j in 0..3 {
                    let scale = (c[(i, i)] * c[(j, j)]).sqrt();
                    let near = if i == j { 1e-8 } else { 1e-6 + 0.3 * size.exp2() };
                    let gap = (found[(i, j)] - c[(i, j)]).abs();
                    prop_assert!(gap <= near * scale, "{i}{j} {gap:e} {found} {c}");
                }
            }
        }

        /// Quadrature against the law's own moments: the fine rule, and the quick one that the search uses, of narrow
        /// turns, of one that is wide and of all wide.
        #[test]
        fn quadrature_is_exact(
            k in prop::array::uniform3(0.1..3.0f64),
            f in prop::array::uniform9(-1.0..1.0f64),
            size in -8.0..0.5f64,
            wide in prop::option::of(0.1..60.0f64),
            scatter in prop::array::uniform9(-0.1..0.1f64),
        ) {
            let body = body(k, [0.5, 0.4, 2.0]);
            let mut rotations = covariance(f, 10_f64.powf(size));
            if let Some(wide) = wide {
                rotations = Matrix3::from_diagonal(&rotations.diagonal());
                rotations[(1, 1)] = wide;
            }
            let roots = Matrix3::from_row_slice(&scatter);
            let scatter = Scatter { roots: roots * roots.transpose(), rotations };
            let law = body.law(&scatter).unwrap();
            let (fine, exact) = (body.moments(&scatter, &law), EntryMoments::of(&law));
            let forms = body.forms(&scatter);
            let quick = forms.variances(&body.second_moments(&scatter));
            let (a, b) = (fine.covariance(), exact.covariance());
            for e in 0..6 {
                prop_assert!((fine.mean()[e] - exact.mean()[e]).abs() < 1e-5);
                for f in 0..6 {
                    let scale = (b[(e, e)] * b[(f, f)]).sqrt() + 1e-9 * b.amax();
                    let gap = (a[(e, f)] - b[(e, f)]).abs();
                    prop_assert!(gap <= 1e-4 * scale, "{e}{f} {gap:e} {scale:e} {rotations}");
                }
                let off = (quick[e] / b[(e, e)]).sqrt() - 1.0;
                let least = 1e-9 * b.amax();
                prop_assert!(off.abs() < 0.01 || quick[e].max(b[(e, e)]) < least, "{e} {off} {rotations}");
            }
        }

        /// Rotations have the covariance, in any frame.
        #[test]
        fn rotations_have_the_covariance(
            turn in prop::array::uniform3(-3.0..3.0f64),
            f in prop::array::uniform9(-1.0..1.0f64),
        ) {
            let body = body([1.0, 2.0, 4.0], turn);
            let rotations = covariance(f, 1e-5) + Matrix3::identity() * 1e-6;
            let law = body.law(&Scatter { roots: Matrix3::zeros(), rotations }).unwrap();
            let r = body.attitude.to_rotation_matrix();
            let found = r.matrix() * law.axes().rotation_covariance() * r.matrix().transpose();
            let off = (found - rotations).amax();
            prop_assert!(off < 1e-3 * rotations.amax(), "{found} {rotations}");
        }
    }
}
