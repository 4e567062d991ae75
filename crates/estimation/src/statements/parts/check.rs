//! That statements are about their body: what a person who knows the body would not say.

use gyradius_inertia::Inertia;

use super::{MOST_TRACES, Part, StatementError};
use crate::Statements;

impl Statements {
    /// Refuses what only a slip can be: no statement at all, moments or products of which one standard
    /// deviation is more than ten times the trace of the nominal inertia, and a mass of which it is more
    /// than the nominal mass.
    ///
    /// [`model`](Self::model) makes a model of such statements, as far as there is one. A
    /// [`StatedBody`](crate::StatedBody) refuses them itself, but takes no statement at all for a body that does not scatter.
    ///
    /// # Errors
    /// As said, and a mass in kg without the nominal mass.
    ///
    /// ```
    /// use gyradius_estimation::{ProductsStatement, Statements};
    /// use gyradius_inertia::{Inertia, InertiaMatrix};
    ///
    /// let body = Inertia::try_from(InertiaMatrix::from_entries([5.0, 4.0, 3.0], [0.0; 3])?)?;
    /// assert!(Statements::default().check(&body, None).is_err());
    /// // In g·mm², by mistake.
    /// let products = Some(ProductsStatement::new([5e7; 3], 1.0)?);
    /// assert!(Statements { products, ..Statements::default() }.check(&body, None).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn check(&self, nominal: &Inertia, mass_kg: Option<f64>) -> Result<(), StatementError> {
        let Self { moments, products, axes, mass, centre } = self;
        if let (None, None, None, None, None) = (moments, products, axes, mass, centre) {
            return Err(StatementError::Nothing);
        }
        self.within(nominal, mass_kg)
    }

    /// Refuses deviations that are beyond the body: the one place where these limits stand.
    pub(crate) fn within(
        &self,
        nominal: &Inertia,
        mass_kg: Option<f64>,
    ) -> Result<(), StatementError> {
        let Self { moments, products, mass, axes: _, centre: _ } = self;
        let [i11, i22, i33, ..] = nominal.entries();
        let trace = nominal.matrix().trace();
        let of_entries = [
            (Part::Moments, moments.map(|moments| moments.deviations([i11, i22, i33]))),
            (Part::Products, products.map(|products| products.deviations())),
        ];
        for (part, deviations) in of_entries {
            let deviations = deviations.unwrap_or_default();
            if let Some(&deviation) = deviations.iter().find(|d| **d > MOST_TRACES * trace) {
                return Err(StatementError::BeyondBody { part, deviation, trace });
            }
        }
        let relative = mass.map(|mass| mass.relative(mass_kg)).transpose()?;
        match (relative, mass_kg) {
            (Some(relative), Some(mass)) if relative > 1.0 => {
                Err(StatementError::BeyondMass { deviation: relative * mass, mass })
            }
            _ => Ok(()),
        }
    }
}
