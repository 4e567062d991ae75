//! From the scatter of second moments and axes to laws of roots and attitudes that have it.

use gyradius_attitude::{RadiallyConstrainedGaussian, RcgError};
use gyradius_inertia::RootSecondMoments;
use nalgebra::{Matrix3, Quaternion, SymmetricEigen, UnitQuaternion, Vector3};

use super::{
    StatementError,
    body::{Body, Scatter, variance_of},
};
use crate::{
    CorrelatedRoots, EntryMoments, GaussianRoots, PrincipalDispersion, RootLaw, RootMoments,
    turns::{chart_variances, law_of_turns_about},
};

/// The model of Peck (2003), with roots that may be correlated.
pub(super) type Law = PrincipalDispersion<RootLaw, RadiallyConstrainedGaussian>;

/// Correlations that are nothing but the cost of having them.
const INDEPENDENT: f64 = 0.01;
/// Variances below this share of the largest are nothing but the barrier.
const STILL: f64 = 1e-9;

/// Variances of rotations, rad², up to which the quick rule is as good as exact, and good to a percent.
const NARROW: f64 = 0.04;
const MODERATE: f64 = 0.3;
/// Nodes and weights of the Gauss-Hermite rule of seven points for a standard normal variable (Abramowitz & Stegun
/// 1964, table 25.10, x√2 and w/√π), from the middle outwards.
const HERMITE: [(f64, f64); 4] = [
    (0.0, 0.457_142_857_142_857_1),
    (1.154_405_394_739_968_2, 0.240_123_178_605_012_72),
    (2.366_759_410_734_541, 0.030_757_123_967_586_498),
    (3.750_439_717_725_742, 5.482_688_559_722_178e-4),
];
/// Nodes of the trapezoidal rule along the widest rotation.
const NODES: i32 = 32;
/// Standard deviations that it reaches, at most once round.
const REACH: f64 = 7.5;

/// Law, deviations of the roots in √kg·m, and variances of the rotations about the principal axes in
/// rad², infinite where nothing is known of one.
pub(super) struct Scattered {
    pub(super) law: Law,
    pub(super) root_deviations: [f64; 3],
    pub(super) rotations: [f64; 3],
    /// Unit axes of the independent rotations, body axes, their variances in rad² and the radial
    /// variance, as the law of the axes has them.
    about: [Vector3<f64>; 3],
    variances: [f64; 3],
    radial_variance: f64,
}

impl Scattered {
    /// Of a body that scatters like this.
    pub(super) fn new(
        body: &Body,
        roots: RootSecondMoments,
        scatter: &Scatter,
    ) -> Result<Self, StatementError> {
        let law =
            |problem: &dyn std::fmt::Display| StatementError::Law { problem: problem.to_string() };
        let (roots, root_deviations) = roots_with(roots, &scatter.moments).map_err(|e| law(&e))?;
        let axes = Axes::with(body, &scatter.mixing);
        let attitudes = axes.law(body).map_err(|e| law(&e))?;
        let (variances, radial_variance) = chart_variances(axes.variances);
        Ok(Self {
            law: PrincipalDispersion::new(roots, attitudes),
            root_deviations,
            rotations: axes.rotations,
            about: std::array::from_fn(|i| axes.about.row(i).transpose()),
            variances,
            radial_variance,
        })
    }

    /// Moments of the entries: by a quick rule where at most one rotation is wide, which is nearly always.
    pub(super) fn moments(&self) -> EntryMoments {
        self.moments_up_to(NARROW)
    }

    /// The same to a percent of a deviation, by the quick rule where two rotations are moderately wide.
    pub(super) fn rough_moments(&self) -> EntryMoments {
        self.moments_up_to(MODERATE)
    }

    fn moments_up_to(&self, wide: f64) -> EntryMoments {
        match self.nodes(wide) {
            Some(nodes) => {
                let k = self.law.roots().second_moment_statistics();
                EntryMoments::by_quadrature(&k, nodes)
            }
            None => EntryMoments::of(&self.law),
        }
    }

    /// Weighted attitudes m ⊗ x of the law of x = (z, w) on the sphere, z being half a rotation vector.
    ///
    /// Along the widest rotation i, z_i and w go round a circle, (z_i, w) = r(sin α, cos α) with
    /// r² = 1 − z_j² − z_l², and surface measure is dα dz_j dz_l: Gauss-Hermite rules along z_j and z_l,
    /// the trapezoidal rule along α. `None` where a second rotation has a variance beyond `second`.
    fn nodes(&self, second: f64) -> Option<Vec<(f64, UnitQuaternion<f64>)>> {
        let v = self.variances;
        let wide = (0..3).fold(0, |widest, i| if v[i] > v[widest] { i } else { widest });
        let (j, l) = ((wide + 1) % 3, (wide + 2) % 3);
        if v[j].max(v[l]) > second {
            return None;
        }
        let reach = (REACH * 0.5 * v[wide].sqrt()).min(std::f64::consts::PI);
        let mean = self.law.axes().mean();
        let mut nodes = Vec::with_capacity(49 * NODES as usize);
        for (zj, weight_j) in hermite(0.5 * v[j].sqrt()) {
            for (zl, weight_l) in hermite(0.5 * v[l].sqrt()) {
                let r = (1.0 - zj * zj - zl * zl).max(0.0).sqrt();
                for step in 0..NODES {
                    // Between the ends, so that those of a whole round are not counted twice.
                    let share = f64::from(2 * step + 1) / f64::from(NODES) - 1.0;
                    let (sin, cos) = libm::sincos(reach * share);
                    let (zi, w) = (r * sin, r * cos);
                    let exponent =
                        4.0 * zi * zi / v[wide] + (w - 1.0) * (w - 1.0) / self.radial_variance;
                    let z = self.about[wide] * zi + self.about[j] * zj + self.about[l] * zl;
                    let turn = UnitQuaternion::new_normalize(Quaternion::new(w, z.x, z.y, z.z));
                    let weight = weight_j * weight_l * libm::exp(-0.5 * exponent);
                    nodes.push((weight, mean * turn));
                }
            }
        }
        Some(nodes)
    }
}

/// Points of a normal variable of this standard deviation, and their weights.
fn hermite(deviation: f64) -> impl Iterator<Item = (f64, f64)> {
    (-3_i32..=3).map(move |i| {
        let (point, weight) = HERMITE[i.unsigned_abs() as usize];
        (deviation * f64::from(i.signum()) * point, weight)
    })
}

/// Gaussian roots whose squares have the covariance C: independent ones, if C leaves it so. A
/// covariance that no squares of Gaussians have is reduced to one that they have.
fn roots_with(
    mean: RootSecondMoments,
    covariance: &Matrix3<f64>,
) -> Result<(RootLaw, [f64; 3]), Box<dyn std::error::Error>> {
    let k = mean.values();
    let largest = covariance.diagonal().max();
    let moves = |i: usize| covariance[(i, i)] > STILL * largest;
    let correlated = (0..3).any(|i| {
        (0..i).any(|j| {
            let scale = covariance[(i, i)] * covariance[(j, j)];
            moves(i) && moves(j) && covariance[(i, j)].abs() > INDEPENDENT * scale.sqrt()
        })
    });
    // Cov(K_i, K_j) = 4k̄_i k̄_j c + 2c² of roots with the covariance c.
    let root = |i: usize, j: usize| {
        let (product, half) = (k[i] * k[j], 0.5 * covariance[(i, j)]);
        let below = product + (product * product + half).max(0.0).sqrt();
        if below > 0.0 { half / below } else { 0.0 }
    };
    let variances: [f64; 3] =
        std::array::from_fn(|i| if moves(i) { root(i, i).max(0.0) } else { 0.0 });
    if !correlated {
        return Ok((GaussianRoots::new(mean, variances)?.into(), variances.map(f64::sqrt)));
    }
    let with = |share: f64| {
        Matrix3::from_fn(|i, j| match (i == j, moves(i) && moves(j)) {
            (true, _) => variances[i],
            (false, true) => share * root(i, j),
            (false, false) => 0.0,
        })
    };
    // The largest share of the correlations that some roots have.
    let (mut has, mut has_not) = (0.0, 1.0);
    let mut law = CorrelatedRoots::new(mean, with(has_not));
    if law.is_err() {
        for _ in 0..40 {
            let share = 0.5 * (has + has_not);
            if CorrelatedRoots::new(mean, with(share)).is_ok() {
                has = share;
            } else {
                has_not = share;
            }
        }
        law = CorrelatedRoots::new(mean, with(has));
    }
    Ok((law?.into(), variances.map(f64::sqrt)))
}

/// How axes scatter: by independent rotations about the rows of `about`, body axes.
struct Axes {
    about: Matrix3<f64>,
    /// rad², infinite where nothing is known.
    variances: [f64; 3],
    /// The same about the principal axes.
    rotations: [f64; 3],
}

impl Axes {
    /// With this mixing of the rotations about the principal axes. Each keeps its own variance; wide
    /// ones, whose mixing is not linear, are independent of the others.
    fn with(body: &Body, mixing: &Matrix3<f64>) -> Self {
        let largest = mixing.diagonal().max();
        let rotations: Vector3<f64> = mixing.diagonal().map(|u| variance_of(u.max(0.0)));
        let covaries = |i: usize, j: usize| {
            let scale = (mixing[(i, i)] * mixing[(j, j)]).sqrt();
            rotations[i].max(rotations[j]) < NARROW
                && mixing[(i, j)].abs() > INDEPENDENT * scale.max(STILL * largest)
        };
        // The principal axes, unless the rotations about them are correlated.
        let (directions, variances) = if covaries(0, 1) || covaries(0, 2) || covaries(1, 2) {
            let eigen = SymmetricEigen::new(Matrix3::from_fn(|i, j| {
                if i == j {
                    // Wide ones beside have their place in the law's own variances below.
                    rotations[i].min(2.0 * NARROW)
                } else if covaries(i, j) {
                    let size = rotations[i] * rotations[j] / (mixing[(i, i)] * mixing[(j, j)]);
                    mixing[(i, j)] * size.sqrt()
                } else {
                    0.0
                }
            }));
            let own = |i: usize| {
                let wide = (0..3)
                    .find(|&j| rotations[j] >= NARROW && eigen.eigenvectors[(j, i)].abs() > 0.5);
                wide.map_or(eigen.eigenvalues[i].max(0.0), |j| rotations[j])
            };
            (eigen.eigenvectors, [own(0), own(1), own(2)])
        } else {
            (Matrix3::identity(), rotations.into())
        };
        let about = directions.transpose() * body.attitude.to_rotation_matrix().matrix();
        Self { about, variances, rotations: rotations.into() }
    }

    fn law(&self, body: &Body) -> Result<RadiallyConstrainedGaussian, RcgError> {
        law_of_turns_about(body.attitude, &self.about, self.variances)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RootMoments;
    use proptest::prelude::*;

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
            let f = Matrix3::from_row_slice(&f);
            let c = f * f.transpose() * 10_f64.powf(size);
            let (law, deviations) = roots_with(mean, &c).unwrap();
            let found = *law.second_moment_statistics().covariance();
            for i in 0..3 {
                prop_assert!(deviations[i] >= 0.0);
                for j in 0..3 {
                    let scale = (c[(i, i)] * c[(j, j)]).sqrt();
                    let near = if i == j { 1e-8 } else { 0.011 + 0.3 * size.exp2() };
                    let gap = (found[(i, j)] - c[(i, j)]).abs();
                    prop_assert!(gap <= near * scale, "{i}{j} {gap:e} {found} {c}");
                }
            }
        }

        /// The quick way and the exact one.
        #[test]
        fn quick_moments_are_exact(
            k in prop::array::uniform3(0.1..3.0f64),
            f in prop::array::uniform9(-1.0..1.0f64),
            size in -8.0..-1.7f64,
            wide in prop::option::of(0.0..0.13f64),
            scatter in 0.0..0.1f64,
        ) {
            let k = gyradius_inertia::SecondMoments::new(k).unwrap();
            let q = UnitQuaternion::from_scaled_axis(Vector3::new(0.5, 0.4, 2.0));
            let nominal = gyradius_inertia::Inertia::from_second_moments(k, &q).unwrap();
            let f = Matrix3::from_row_slice(&f);
            let mut mixing = f * f.transpose() * (10_f64.powf(size) / f.norm_squared());
            if let Some(wide) = wide {
                mixing = Matrix3::from_diagonal(&mixing.diagonal());
                mixing[(1, 1)] = wide;
            }
            let moments = Matrix3::from_diagonal_element(scatter * scatter);
            let scatter = Scatter { moments, mixing };
            let roots = nominal.second_moments().roots();
            let scattered = Scattered::new(&Body::new(&nominal), roots, &scatter).unwrap();
            prop_assert!(scattered.nodes(NARROW).is_some());
            let (quick, exact) = (scattered.moments(), EntryMoments::of(&scattered.law));
            let (a, b) = (quick.covariance(), exact.covariance());
            for e in 0..6 {
                prop_assert!((quick.mean()[e] - exact.mean()[e]).abs() < 1e-7);
                for f in 0..6 {
                    let scale = (b[(e, e)] * b[(f, f)]).sqrt() + 1e-9 * b.amax();
                    let gap = (a[(e, f)] - b[(e, f)]).abs();
                    prop_assert!(gap <= 1e-5 * scale, "{e}{f} {gap:e} {scale:e} {mixing}");
                }
            }
        }

        /// Rotations have the covariance, in any frame.
        #[test]
        fn rotations_have_the_covariance(
            turn in prop::array::uniform3(-3.0..3.0f64),
            f in prop::array::uniform9(-1.0..1.0f64),
        ) {
            let k = gyradius_inertia::SecondMoments::new([1.0, 2.0, 4.0]).unwrap();
            let q = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
            let body = Body::new(&gyradius_inertia::Inertia::from_second_moments(k, &q).unwrap());
            let f = Matrix3::from_row_slice(&f);
            let u = f * f.transpose() * 1e-5 + Matrix3::identity() * 1e-6;
            let axes = Axes::with(&body, &u);
            let law = axes.law(&body).unwrap();
            let r = body.attitude.to_rotation_matrix();
            let found = r.matrix() * law.rotation_covariance() * r.matrix().transpose();
            prop_assert!((found - u).amax() < 2e-3 * u.amax(), "{found} {u}");
            for j in 0..3 {
                prop_assert!((axes.rotations[j] / u[(j, j)] - 1.0).abs() < 1e-3);
            }
        }
    }
}
