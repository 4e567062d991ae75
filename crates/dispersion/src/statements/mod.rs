//! A model of inertia made of plain statements: "moments ± 10 %", "axes within 2°", "mass ± 1 %".

mod body;
mod diagnosis;
mod law;
mod least_squares;
mod parts;
mod solve;
mod stated_model;
mod warnings;

use gyradius_inertia::Inertia;

use body::{Body, mixing_of};
use solve::{Asked, Solution, Task};

pub use parts::{
    Amount, AxesStatement, CentreStatement, MassStatement, MomentsStatement, Part,
    ProductsStatement, StatementError,
};
pub use stated_model::{StatedMass, StatedModel};
pub use warnings::{MissedBecause, StatementWarning};

/// Traces whose squares, which variances are, do not overflow.
const TRACES: std::ops::RangeInclusive<f64> = 1e-60..=1e60;
/// A model that misses by no more than this, in squared relative errors of variances, meets the statements.
const MET: f64 = 1e-4;
/// Halvings of the share of the mass that the inertia follows, where it cannot follow wholly.
const HALVINGS: usize = 8;

/// What engineers say of an inertia, and nothing that they do not say: every part may be left out.
///
/// [`model`](Self::model) makes the model of Peck (2003) of them.
///
/// # Rules
/// * *Moments* and *products* are the diagonal and the other entries of the matrix in body axes, with
///   everything that moves them, mass and mass centre included.
/// * *Axes* are rotations about the principal axes.
/// * What nothing is said of does not scatter, but for what the stated parts force: moments alone leave
///   the axes still, and products or axes alone leave the principal moments still.
/// * *Mass*: the inertia grows with the mass, all its entries together. Where the moments are stated as
///   well, this is a part of what is stated of them, and the inertia follows the mass as far as the
///   statements allow.
/// * *Centre*: the mass centre adds what parallel axes add to those entries of which nothing is stated.
///   Of entries that are stated it is a part, and is only compared with them.
/// * *Products* and *axes* both limit the axes: about each axis the tighter one holds.
/// * *Moments* come before *products*: where both cannot be had, the moments are as stated.
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

impl Statements {
    /// The model of a nominal inertia and, if it is known, its mass.
    ///
    /// # Algorithm
    /// To first order the variance of an entry is linear in the covariance C of the second moments
    /// K_k and in that of small rotations φ_j about the principal axes, U = Cov(sin 2φ)/4:
    ///
    /// Var I_ab = gᵀC g + Σ_jl d_j d_l E[ΔI_j ΔI_l] U_jl,
    ///
    /// with R(q) = (r_ka) of the nominal body, g_k = δ_ab − r_ka r_kb, d_j the entry ab of the symmetric product of
    /// the two axes that rotation j mixes, and ΔI_j the difference of their moments, which scatters:
    /// E[ΔI_j ΔI_l] follows from C. Statements on the moments open C, those on the products open U,
    /// and the least squares solution with both positive semidefinite is taken, each variance in
    /// units of what is stated. Second moments and rotations are independent of each other wherever
    /// they can be: covariances have a small cost. What the law that this makes gives beyond the linear equations is
    /// found by quadrature and taken off what is stated, until what is stated comes out.
    ///
    /// A mass of relative standard deviation ρ multiplies the whole inertia by 1 + αρz, with a normal
    /// score z: Var I = (1 + α²ρ²) Var I′ + α²ρ² Ī², where I′ is the inertia at the nominal mass and
    /// 0 ≤ α ≤ 1 is as large as the stated moments and products allow.
    ///
    /// # Limits
    /// No body can have some combinations of deviations, and no principal axes independent of the
    /// moments others. What cannot be had is said in a warning, with the reason.
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
        let body = Body::new(nominal);
        let entries = nominal.entries();
        let [i11, i22, i33, ..] = entries;
        let stated = Stated {
            moments: self.moments.map(|m| m.deviations([i11, i22, i33])),
            products: self.products.map(|p| p.deviations()),
            axes: self.axes.map(|axes| axes.deviations()),
            centre: match self.centre {
                Some(centre) => Some(centre.entry_variances(
                    mass_kg.ok_or(StatementError::NoMass { part: Part::Centre })?,
                )),
                None => None,
            },
        };
        let mass = self.mass.map(|mass| mass.relative(mass_kg)).transpose()?;
        let solved = match mass {
            Some(relative) => stated.following(&body, nominal, relative)?,
            None => Solved { solution: stated.solve(&body, nominal, 0.0)?, follows: 0.0 },
        };
        // What the products alone would allow.
        let unlimited = match (stated.products, stated.axes) {
            (Some(_), Some(_)) => {
                let products = Stated { axes: None, ..stated };
                let factor = mass.unwrap_or(0.0) * solved.follows;
                let solution = products.solve(&body, nominal, factor)?;
                Some(solution.scattered.rotations.map(f64::sqrt))
            }
            _ => None,
        };
        let mass = mass.map(|relative| StatedMass::new(relative, solved.follows));
        let centre = self.centre.map(|centre| centre.deviations());
        let model = StatedModel::new(nominal, &body, &stated, mass, centre, solved.solution)?;
        let warnings = diagnosis::warnings(&model, &body, &stated, unlimited);
        Ok(model.with_warnings(warnings))
    }
}

/// What is stated, as standard deviations in kg·m² and rad, and the variances that the mass centre adds.
#[derive(Clone, Copy, Debug)]
struct Stated {
    moments: Option<[f64; 3]>,
    products: Option<[f64; 3]>,
    axes: Option<[f64; 3]>,
    centre: Option<[f64; 6]>,
}

/// A solution, and the share of the mass's relative change that the inertia takes.
struct Solved {
    solution: Solution,
    follows: f64,
}

impl Stated {
    /// What is asked of the inertia at the nominal mass, if the mass moves it all by a factor of this
    /// relative standard deviation.
    fn task(&self, nominal: &Inertia, factor: f64) -> Task {
        let nominal = nominal.entries();
        let square = factor * factor;
        let asked = |stated: Option<[f64; 3]>, first: usize, spoken: bool| match stated {
            Some(deviations) => {
                let units = deviations.map(|deviation| deviation * deviation / (1.0 + square));
                let by_mass = |i: usize| square * nominal[first + i].powi(2) / (1.0 + square);
                let variances = std::array::from_fn(|i| (units[i] - by_mass(i)).max(0.0));
                Asked::Stated { variances, units }
            }
            None => match self.centre {
                Some(centre) if !spoken => {
                    Asked::Added(std::array::from_fn(|i| centre[first + i] / (1.0 + square)))
                }
                _ => Asked::Nothing,
            },
        };
        Task {
            moments: asked(self.moments, 0, false),
            // Of the products beside stated axes nothing else need be said.
            products: asked(self.products, 3, self.axes.is_some()),
            axes: self.axes.map(|axes| axes.map(|deviation| mixing_of(deviation * deviation))),
        }
    }

    /// The law of the inertia at the nominal mass.
    fn solve(
        &self,
        body: &Body,
        nominal: &Inertia,
        factor: f64,
    ) -> Result<Solution, StatementError> {
        let task = self.task(nominal, factor);
        let whole = task.solve(body, nominal)?;
        let (Asked::Stated { .. }, Asked::Added(products)) = (task.moments, task.products) else {
            return Ok(whole);
        };
        if whole.cost <= MET {
            return Ok(whole);
        }
        // What the mass centre does to the products turns the axes, which may move the moments more than
        // is stated of them: then it does so in part only.
        let without = Task { products: Asked::Nothing, ..task }.solve(body, nominal)?;
        for share in [1.0, 0.5, 0.25, 0.125] {
            let products = Asked::Added(products.map(|variance| share * variance));
            let part = Task { products, ..task }.solve(body, nominal)?;
            if part.cost <= without.cost + MET {
                return Ok(part);
            }
        }
        Ok(without)
    }

    /// The inertia follows a mass of this relative deviation as far as it can without what is stated
    /// being missed by more than it would be anyway.
    fn following(
        &self,
        body: &Body,
        nominal: &Inertia,
        relative: f64,
    ) -> Result<Solved, StatementError> {
        let entries = nominal.entries();
        let solve = |follows: f64| {
            let solution = self.solve(body, nominal, follows * relative)?;
            Ok::<_, StatementError>(Solved { solution, follows })
        };
        let Some(moments) = self.moments else { return solve(1.0) };
        // Beyond this share the mass alone would move a moment by more than is stated of it.
        let most = (0..3).fold(1.0, |most: f64, i| {
            let by_mass = relative * entries[i].abs();
            if moments[i] < by_mass { most.min(moments[i] / by_mass) } else { most }
        });
        let wholly = solve(most)?;
        if wholly.solution.cost <= MET || most == 0.0 {
            return Ok(wholly);
        }
        let mut best = solve(0.0)?;
        let allowed = best.solution.cost + MET;
        if wholly.solution.cost <= allowed {
            return Ok(wholly);
        }
        let mut too_much = most;
        for _ in 0..HALVINGS {
            let half = solve(0.5 * (best.follows + too_much))?;
            if half.solution.cost <= allowed {
                best = half;
            } else {
                too_much = half.follows;
            }
        }
        Ok(best)
    }
}

#[cfg(test)]
mod tests;
