mod nonnegative;
mod parts;
mod warnings;

use gyradius_attitude::RadiallyConstrainedGaussian;
use gyradius_inertia::Inertia;
use nalgebra::{Matrix3, SMatrix, SVector, UnitQuaternion, Vector3};

use crate::{
    CorrelatedRoots, EntryMoments, GaussianRoots, PrincipalDispersion, RootLaw, turns::law_of_turns,
};
use nonnegative::{UNKNOWNS, least_squares};

pub use parts::{
    Amount, AxesStatement, CentreStatement, MassStatement, MomentsStatement, Part,
    ProductsStatement, StatementError,
};
pub use warnings::StatementWarning;

/// The entries in the order I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃.
const ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
/// Rounds in which the scatter of the moments settles what turns do to the products.
const ROUNDS: usize = 30;
/// A deviation stated as zero counts as this share of the trace.
const ZERO: f64 = 1e-9;
/// Traces whose squares, which variances are, do not overflow.
const TRACES: std::ops::RangeInclusive<f64> = 1e-60..=1e60;

/// What engineers say of an inertia, and nothing they do not: every part may be left out.
///
/// [`model`](Self::model) makes the model of Peck (2003) of them.
///
/// # Rules
/// * *Moments* and *products* are the diagonal and the other entries of the matrix in body axes, with
///   everything that moves them, mass and mass centre included.
/// * *Axes* are turns about the principal axes.
/// * *Mass* and *centre* speak for those entries of which nothing else is said: the whole inertia
///   grows with the mass, all its entries together, and the mass centre adds what parallel axes add.
///   Of entries that are stated they are part, and are only compared with them.
/// * *Products* and *axes* both limit the axes: about each axis the tighter one holds.
/// * Of what nothing is said does not scatter, with a warning.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Statements {
    /// “Moments ± 10 % (1σ)”.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub moments: Option<MomentsStatement>,
    /// “Products within ± 50 kg·m² (3σ)”.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub products: Option<ProductsStatement>,
    /// “Axes within 2°”.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub axes: Option<AxesStatement>,
    /// “Mass ± 1 %”.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub mass: Option<MassStatement>,
    /// “Centre of mass ± 10 mm”.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub centre: Option<CentreStatement>,
}

/// The model that statements make, and what they come to.
#[derive(Clone, Debug)]
pub struct StatedModel {
    nominal: Inertia,
    law: PrincipalDispersion<RootLaw, RadiallyConstrainedGaussian>,
    root_deviations: [f64; 3],
    turns: [f64; 3],
    stated: [Option<f64>; 6],
    implied: EntryMoments,
    warnings: Vec<StatementWarning>,
}

impl Statements {
    /// The model of a nominal inertia and, if it is known, its mass.
    ///
    /// # Algorithm
    /// The variance of an entry is linear in the variances w_k of the second moments K_k and, for
    /// small turns φ_j about the principal axes, in u_j = E[sin² 2φ_j]/4:
    ///
    /// Var I_ab = Σ_k (δ_ab − r_ka r_kb)² w_k + Σ_j D_ab,j² E[(ΔI_j)²] u_j,
    ///
    /// with R(q) = (r_ka) of the nominal body, D_j the symmetric product of the two axes that turn j
    /// mixes, ΔI_j the difference of their moments, E[(ΔI_j)²] = ΔI_j² + w_a + w_b. The stated variances
    /// give up to six equations, of which the non-negative least squares solution is taken, each in
    /// units of what is stated, and repeated until E[(ΔI)²] has settled. What a mass moves by the share
    /// ρ is left out there and added as ρ²K_i K_j to the covariance of the second moments. Then the
    /// covariance C of the roots from Cov(K_i, K_j) = 4k̄_i k̄_j C_ij + 2C_ij², and the variance of φ from u = (1 − e^{−8 Var φ})/8; u ≥ 1/8 is a turn of
    /// which nothing is known. What comes out is computed back by quadrature, not by this
    /// approximation: [`StatedModel::implied`].
    ///
    /// # Limits
    /// Three K_k that are independent but for the mass cannot have any three variances of the
    /// moments. What cannot be had is said in a warning.
    ///
    /// # Errors
    /// The mass is needed and not given or not positive, or the nominal body is a point or out of
    /// range.
    ///
    /// ```
    /// use gyradius_dispersion::{Amount, AxesStatement, MomentsStatement, Statements};
    /// use gyradius_inertia::{Inertia, InertiaMatrix};
    ///
    /// let payload = InertiaMatrix::from_entries([5000.0, 4000.0, 3000.0], [20.0, 2.0, -50.0])?;
    /// let statements = Statements {
    ///     moments: Some(MomentsStatement::new(Amount::Absolute([40.0; 3]), 1.0)?),
    ///     axes: Some(AxesStatement::each([2.0; 3], 3.0)?),
    ///     ..Statements::default()
    /// };
    /// let model = statements.model(&Inertia::try_from(payload)?, None)?;
    /// let [i11, .., i23] = model.implied().deviations();
    /// assert!((i11 / 40.0 - 1.0).abs() < 0.01);
    /// // A third of 2° over the difference of two moments.
    /// assert!((i23 / (1000.0 * (2_f64 / 3.0).to_radians()) - 1.0).abs() < 0.02);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn model(
        &self,
        nominal: &Inertia,
        mass_kg: Option<f64>,
    ) -> Result<StatedModel, StatementError> {
        let trace = nominal.matrix().trace();
        if !TRACES.contains(&trace) {
            return Err(StatementError::Nominal { trace });
        }
        if let Some(value) = mass_kg.filter(|m| !(*m > 0.0 && *m <= 1e30)) {
            return Err(StatementError::Mass { value });
        }
        let body = Body::of(nominal);
        let beside = self.beside(nominal, mass_kg)?;
        let mut warnings = Vec::new();

        let entries = nominal.entries();
        let [i11, i22, i33, ..] = entries;
        let moments = self.moments.map(|m| m.deviations([i11, i22, i33]));
        let products = self.products.map(|p| p.deviations());
        let stated: [Option<f64>; 6] = std::array::from_fn(|e| match e {
            0..3 => moments.map(|m| m[e]),
            _ => products.map(|p| p[e - 3]),
        });
        // What mass and centre alone do may not exceed what is stated of the whole.
        if let Some((mass, centre)) = beside {
            for (e, stated) in stated.iter().enumerate() {
                for (part, alone) in [(Part::Mass, mass[e]), (Part::Centre, centre[e])] {
                    let alone = alone.sqrt();
                    if let Some(stated) = stated.filter(|s| alone > *s * (1.0 + 1e-9)) {
                        warnings.push(StatementWarning::Alone { part, entry: e, alone, stated });
                    }
                }
            }
        }
        let common = match self.mass {
            Some(mass) if moments.is_none() => mass.relative(mass_kg)?,
            _ => 0.0,
        };
        let target: [Option<Target>; 6] = std::array::from_fn(|e| {
            let whole = stated[e].map(|s| s * s).or_else(|| {
                let (mass, centre) = beside?;
                // Of products beside stated axes nothing else need be said.
                (e < 3 || self.axes.is_none()).then(|| mass[e] + centre[e])
            });
            let mass = (common * entries[e]).powi(2);
            whole.map(|whole| Target { rest: (whole - mass).max(0.0), whole })
        });
        if target[..3].iter().all(Option::is_none) {
            warnings.push(StatementWarning::FixedMoments);
        }

        let (mut variances, mut mixing) = body.solve(&target, common, None);
        if let Some(axes) = self.axes {
            let allowed = axes.deviations().map(|s| mixing_of(s * s));
            let both = if self.products.is_some() {
                let tighter = std::array::from_fn(|j| mixing[j].min(allowed[j]));
                let said = axes.deviations();
                let by_products = mixing.map(|u| variance_of(u).sqrt());
                if (0..3).any(|j| {
                    let (a, b) = (said[j], by_products[j]);
                    !((a - b).abs() <= 0.1 * a.max(b)) && body.turns[j].gap > 0.0
                }) {
                    warnings.push(StatementWarning::AxesAndProducts {
                        axes: said,
                        products: by_products,
                    });
                }
                tighter
            } else {
                allowed
            };
            (variances, mixing) = body.solve(&target, common, Some(both));
        } else if target[3..].iter().all(Option::is_none) {
            warnings.push(StatementWarning::FixedAxes);
        }

        let turns = mixing.map(variance_of);
        for (j, variance) in turns.iter().enumerate() {
            if !variance.is_finite() {
                warnings.push(StatementWarning::Free { axis: j + 1 });
            }
        }
        let law =
            |problem: &dyn std::fmt::Display| StatementError::Law { problem: problem.to_string() };
        let (roots, root_deviations) = roots(nominal, variances, common).map_err(|e| law(&e))?;
        let axes = law_of_turns(body.attitude, turns).map_err(|e| law(&e))?;
        let law = PrincipalDispersion::new(roots, axes);
        let implied = EntryMoments::of(&law);
        // “Within” is a limit: products that stated axes keep smaller are within it.
        let limited = self.axes.is_some();
        let model = StatedModel {
            nominal: *nominal,
            law,
            root_deviations,
            turns,
            stated,
            implied,
            warnings,
        };
        Ok(StatedModel { warnings: StatementWarning::of_outcome(&model, limited), ..model })
    }

    /// Variances of the six entries from mass and from mass centre, if either is stated.
    #[allow(clippy::type_complexity, reason = "two lists of six")]
    fn beside(
        &self,
        nominal: &Inertia,
        mass_kg: Option<f64>,
    ) -> Result<Option<([f64; 6], [f64; 6])>, StatementError> {
        if self.mass.is_none() && self.centre.is_none() {
            return Ok(None);
        }
        let mass = match self.mass {
            Some(mass) => {
                let relative = mass.relative(mass_kg)?;
                nominal.entries().map(|x| (relative * x).powi(2))
            }
            None => [0.0; 6],
        };
        let centre = match self.centre {
            Some(centre) => centre
                .entry_variances(mass_kg.ok_or(StatementError::NoMass { part: Part::Centre })?),
            None => [0.0; 6],
        };
        Ok(Some((mass, centre)))
    }
}

impl StatedModel {
    /// The nominal inertia.
    #[must_use]
    pub fn nominal(&self) -> &Inertia {
        &self.nominal
    }

    /// The law.
    #[must_use]
    pub fn law(&self) -> &PrincipalDispersion<RootLaw, RadiallyConstrainedGaussian> {
        &self.law
    }

    /// Deviations of the roots of the second moments, √kg·m. Their means are those of the nominal
    /// inertia.
    #[must_use]
    pub fn root_deviations(&self) -> [f64; 3] {
        self.root_deviations
    }

    /// Standard deviations of the turns about principal axes 1, 2, 3, rad; infinite where nothing
    /// is known of one.
    #[must_use]
    pub fn turns(&self) -> [f64; 3] {
        self.turns.map(f64::sqrt)
    }

    /// Deviations of the six entries as stated, kg·m², in the order 11, 22, 33, 12, 13, 23.
    #[must_use]
    pub fn stated(&self) -> [Option<f64>; 6] {
        self.stated
    }

    /// Mean and covariance of the six entries under the law, by quadrature.
    #[must_use]
    pub fn implied(&self) -> &EntryMoments {
        &self.implied
    }

    /// Contradictions, and what has been left open.
    #[must_use]
    pub fn warnings(&self) -> &[StatementWarning] {
        &self.warnings
    }
}

/// The variance of an entry.
#[derive(Clone, Copy, Debug)]
struct Target {
    /// Without what a mass contributes to all.
    rest: f64,
    whole: f64,
}

/// Gaussian roots about a nominal body and their deviations, such that the second moments have the variances
/// `independent` and the relative deviation `common` beside.
fn roots(
    nominal: &Inertia,
    independent: [f64; 3],
    common: f64,
) -> Result<(RootLaw, [f64; 3]), Box<dyn std::error::Error>> {
    let mean = nominal.second_moments().roots();
    let k = mean.values();
    // The variance v of a root: 4k²v + 2v² is that of its square.
    let of_root = |square: f64, variance: f64| {
        let half = 0.5 * variance;
        if half > 0.0 { half / (square + (square * square + half).sqrt()) } else { 0.0 }
    };
    let shared = of_root(1.0, common * common);
    let rest: [f64; 3] = std::array::from_fn(|i| {
        if !(independent[i] > 0.0) {
            return 0.0;
        }
        let square = k[i] * k[i];
        let whole = of_root(square, independent[i] + (common * square).powi(2));
        (whole - shared * square).max(0.0)
    });
    if common == 0.0 {
        return Ok((GaussianRoots::new(mean, rest)?.into(), rest.map(f64::sqrt)));
    }
    let k = Vector3::from(k);
    let covariance = k * k.transpose() * shared + Matrix3::from_diagonal(&Vector3::from(rest));
    let deviations = covariance.diagonal().map(f64::sqrt).into();
    Ok((CorrelatedRoots::new(mean, covariance)?.into(), deviations))
}

/// What a turn about a principal axis mixes.
#[derive(Clone, Copy, Debug)]
struct Turn {
    /// Difference of the two moments, zero if it is rounding.
    gap: f64,
    /// Squares of the entries of a_a a_bᵀ + a_b a_aᵀ.
    squares: [f64; 6],
}

/// The nominal body as the equations see it.
struct Body {
    attitude: UnitQuaternion<f64>,
    /// (δ_ab − r_ka r_kb)² of each entry and k.
    shares: [[f64; 3]; 6],
    turns: [Turn; 3],
    zero: f64,
}

impl Body {
    fn of(nominal: &Inertia) -> Self {
        let axes = nominal.principal_axes();
        let attitude = axes.attitude();
        let r: Matrix3<f64> = *attitude.to_rotation_matrix().matrix();
        let moments = axes.moments();
        let trace = nominal.matrix().trace();
        let shares = ENTRIES.map(|(a, b)| {
            let delta = if a == b { 1.0 } else { 0.0 };
            [0, 1, 2].map(|k| (delta - r[(k, a)] * r[(k, b)]).powi(2))
        });
        let turns = [0, 1, 2].map(|j| {
            let (m, n) = ((j + 1) % 3, (j + 2) % 3);
            let (p, q): (Vector3<f64>, Vector3<f64>) = (r.row(m).transpose(), r.row(n).transpose());
            let gap = (moments[m] - moments[n]).abs();
            Turn {
                gap: if gap > ZERO * trace { gap } else { 0.0 },
                squares: ENTRIES.map(|(a, b)| (p[a] * q[b] + q[a] * p[b]).powi(2)),
            }
        });
        Self { attitude, shares, turns, zero: ZERO * trace }
    }

    /// Variances of the second moments beside their common relative deviation, and the mixing u of the
    /// three turns, which may be given.
    fn solve(
        &self,
        target: &[Option<Target>; 6],
        common: f64,
        given: Option<[f64; 3]>,
    ) -> ([f64; 3], [f64; 3]) {
        let (mut variances, mut mixing) = ([0.0; 3], given.unwrap_or([0.0; 3]));
        for _ in 0..ROUNDS {
            let squares: [f64; 3] = std::array::from_fn(|j| {
                let scatter = variances[(j + 1) % 3] + variances[(j + 2) % 3];
                self.turns[j].gap.powi(2) * (1.0 + common * common) + scatter
            });
            let mut a = SMatrix::<f64, 6, UNKNOWNS>::zeros();
            let mut b = SVector::<f64, 6>::zeros();
            for (e, target) in target.iter().enumerate() {
                let Some(target) = target else { continue };
                let unit = target.whole.max(self.zero * self.zero);
                b[e] = target.rest / unit;
                for k in 0..3 {
                    a[(e, k)] = self.shares[e][k] / unit;
                    let turned = self.turns[k].squares[e] * squares[k] / unit;
                    match given {
                        Some(mixing) => b[e] -= turned * mixing[k],
                        None => a[(e, 3 + k)] = turned,
                    }
                }
            }
            // With the turns given, only the moments are left to be solved for.
            if given.is_some() {
                for e in 3..6 {
                    a.row_mut(e).fill(0.0);
                    b[e] = 0.0;
                }
            }
            let x = least_squares(&a, &b);
            let next = [x[0], x[1], x[2]];
            let moved = (0..3).any(|k| (next[k] - variances[k]).abs() > 1e-9 * next[k]);
            variances = next;
            if given.is_none() {
                mixing = [x[3], x[4], x[5]];
            }
            if !moved {
                break;
            }
        }
        (variances, mixing)
    }
}

/// E[sin² 2φ]/4 of a Gaussian angle.
fn mixing_of(variance: f64) -> f64 {
    -0.125 * libm::expm1(-8.0 * variance)
}

/// The variance of a Gaussian angle with E[sin² 2φ]/4 = u; infinite from 1/8 on.
fn variance_of(mixing: f64) -> f64 {
    if mixing < 0.125 { -0.125 * libm::log1p(-8.0 * mixing) } else { f64::INFINITY }
}

#[cfg(test)]
mod tests;
