//! A model of inertia made of plain statements: "moments ± 10 %", "axes within 2°", "mass ± 1 %".

mod amount;
mod curvature;
mod diagnosis;
mod entries;
mod frame;
mod impossible;
pub(crate) mod levenberg_marquardt;
mod nodes;
mod parts;
mod reach;
mod scatter;
mod solve;
mod square_moments;
mod stated_model;
mod task;
mod unknowns;
mod warnings;

use gyradius_inertia::Inertia;

use diagnosis::{Context, Outcome};
use scatter::{Body, Scatter};
use task::{Asked, Task};

pub use amount::{AmountProblem, StatedAmount, StatedAmountError};
pub use parts::{
    Amount, AxesStatement, CentreStatement, MassStatement, MomentsStatement, Part,
    ProductsStatement, StatementError,
};
pub use stated_model::{StatedMass, StatedModel};
pub use warnings::{MissedBecause, StatementWarning};

/// The masses of nominal bodies, kg.
pub(crate) const MASSES_KG: std::ops::RangeInclusive<f64> = 1e-30..=1e30;
/// Traces whose squares, which variances are, do not overflow.
const TRACES: std::ops::RangeInclusive<f64> = 1e-60..=1e60;

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
///   Of entries that are stated it is a part, and is only compared with them. So it is of stated axes, whose turns make the
///   products.
/// * *Products* and *axes* both limit the axes: the turns are never wider than stated, and within that they make the products what is stated.
/// * *Moments* come before *products*: where both cannot be had, the moments are as stated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
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
    /// The law has Gaussian roots k of the second moments, and axes from a radially constrained Gaussian whose
    /// turns about the principal axes are small or not. The statements on the moments open the
    /// deviations of the roots, those on the products the deviations of the turns, and a mass the share
    /// α of it that the inertia follows. Their least squares solution is taken, by Levenberg and Marquardt's
    /// method, of the errors ln(σ/σ_stated) of the deviations that the law has by quadrature: three times the error where
    /// an entry would be surer than stated, but next to nothing of what a product falls short that nothing can make so large, and a
    /// hundred times that of a moment beside stated products. Where independent
    /// roots and turns do not have them, correlations are opened too, and the search starts anew from several of them.
    /// Axes that nothing moves are held to 2e-6 rad and not closer, so that the products of the law scatter by some
    /// millionths of the moments where [`turns`](StatedModel::turns) are zero.
    ///
    /// A mass of relative standard deviation ρ multiplies the whole inertia by 1 + αρz, with a normal
    /// score z: Var I = (1 + α²ρ²) Var I′ + α²ρ² Ī², where I′ is the inertia at the nominal mass and
    /// 0 ≤ α ≤ 1 is as large as the deviations of the second moments allow. It is smaller where a stated deviation
    /// misses by more than 2 % and would miss by less than half of that with a smaller α.
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
    /// use gyradius_estimation::{Amount, AxesStatement, MomentsStatement, Statements};
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
        if let Some(value) = mass_kg.filter(|m| !MASSES_KG.contains(m)) {
            return Err(StatementError::Mass { value });
        }
        let mass = self.mass.map(|mass| mass.relative(mass_kg)).transpose()?;
        let stated = self.stated(nominal, mass_kg)?;
        let body = Body::new(nominal);
        let task = stated.task(body, nominal, mass);
        let solution = task.solve()?;
        let mass = mass.map(|relative| StatedMass::new(relative, solution.follows));
        let centre = self.centre.map(|centre| centre.deviations());
        let model = StatedModel::new(nominal, &body, &stated, mass, centre, solution.scatter)?;
        // What the products would do without a limit of the axes, and alone: asked only where a warning depends on it.
        let short = diagnosis::products_fall_short(&model, &stated);
        let limited = stated.products.is_some() && stated.axes.is_some();
        let without = |asked: bool, task: Task| {
            asked.then(|| Outcome::new(&body, &task.solve()?)).transpose()
        };
        let unlimited = without(limited, Task { axes: None, loose: true, ..task })?;
        let products = Task { moments: Asked::Nothing, axes: None, loose: true, ..task };
        let alone = without(short && stated.moments.is_some(), products)?;
        let with_centre = solution.with_centre;
        let context = Context { body, stated, unlimited, alone, with_centre };
        let warnings = context.warnings(&model);
        Ok(model.with_warnings(warnings))
    }

    /// The numbers that are stated.
    fn stated(&self, nominal: &Inertia, mass_kg: Option<f64>) -> Result<Stated, StatementError> {
        let [i11, i22, i33, ..] = nominal.entries();
        let centre = |centre: CentreStatement| {
            let mass_kg = mass_kg.ok_or(StatementError::NoMass { part: Part::Centre })?;
            Ok(centre.entry_variances(mass_kg))
        };
        Ok(Stated {
            moments: self.moments.map(|m| m.deviations([i11, i22, i33])),
            products: self.products.map(|p| p.deviations()),
            axes: self.axes.map(|axes| axes.deviations()),
            centre: self.centre.map(centre).transpose()?,
        })
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

impl Stated {
    /// What is asked of the inertia, the mass having this relative standard deviation.
    fn task(&self, body: Body, nominal: &Inertia, mass: Option<f64>) -> Task {
        // Where the mass centre alone turns the axes, it adds no less than they scatter where they are held.
        let only_held = self.axes.is_none() && self.products.is_none();
        let held = body.held_variances(&body.second_moments(&Scatter::default()));
        let least = if only_held { held } else { [0.0; 6] };
        let asked = |stated: Option<[f64; 3]>, first: usize, spoken: bool| match stated {
            Some(deviations) => Asked::Stated(deviations),
            None => match self.centre {
                Some(centre) if !spoken => {
                    Asked::Added(std::array::from_fn(|i| centre[first + i].max(least[first + i])))
                }
                _ => Asked::Nothing,
            },
        };
        // Beyond this share the mass alone would move a moment by more than is stated of it.
        let most = |relative: f64| {
            let entries = nominal.entries();
            self.moments.map_or(1.0, |moments| {
                (0..3).fold(1.0, |most: f64, i| {
                    let by_mass = relative * entries[i].abs();
                    if moments[i] < by_mass { most.min(moments[i] / by_mass) } else { most }
                })
            })
        };
        Task {
            body,
            trace: nominal.matrix().trace(),
            moments: asked(self.moments, 0, false),
            // What a mass centre adds to products is a part of what turns the stated axes.
            products: asked(self.products, 3, self.axes.is_some()),
            axes: self.axes.map(|axes| axes.map(|deviation| deviation * deviation)),
            mass: mass.map(|relative| (relative, most(relative))),
            loose: false,
        }
    }
}

#[cfg(test)]
mod tests;
