//! Any law of mass, mass centre and inertia, also one of a user's own, behind one object-safe trait.

use gyradius_inertia::MassProperties;
use rand::Rng;
use std::{borrow::Cow, fmt::Debug};

use super::{TenMoments, TenParameters};
use crate::columns::{ColumnsError, common_length};

/// A law of the ten parameters of a body: what is compared, counted and drawn in bulk.
///
/// [`MassPropertiesLaw`](super::MassPropertiesLaw) is one, and so are its rivals, of which some draw what no body has.
pub trait MassPropertiesModel: Debug + Send + Sync {
    /// What it is called, in kebab case.
    fn name(&self) -> Cow<'_, str>;

    /// Ten numbers. They depend on what the generator gives, and on nothing else.
    fn draw(&self, rng: &mut dyn Rng) -> TenParameters;

    /// Whether no draw can be unrealizable.
    fn is_realizable_by_construction(&self) -> bool;

    /// The natural logarithm of the density at a body with respect to dm d³c dI₁₁ dI₂₂ dI₃₃ dI₁₂ dI₁₃ dI₂₃, in
    /// kg, m and kg·m²; −∞ where none can be. None where the law has no density or it is not known.
    fn ln_density(&self, body: &MassProperties) -> Option<f64> {
        let _ = body;
        None
    }

    /// Mean and covariance of the ten, where they are known.
    fn moments(&self) -> Option<TenMoments> {
        None
    }

    /// Mean and covariance of the ten in which the equations of motion are linear ([`TenParameters::linear`]), where they
    /// are known.
    fn linear_moments(&self) -> Option<TenMoments> {
        None
    }

    /// The share of so many draws that belong to no body; 0 of none.
    fn unrealizable_share(&self, rng: &mut dyn Rng, draws: usize) -> f64 {
        let none = (0..draws).filter(|_| !self.draw(rng).is_realizable()).count();
        none as f64 / draws.max(1) as f64
    }

    /// The share of proposals that rejection keeps, where the law is one by rejection.
    fn acceptance(&self) -> Option<f64> {
        None
    }

    /// Fills ten columns in the order of [`TenParameters::COLUMNS`] with independent draws: those of
    /// [`draw`](Self::draw) unless a law says otherwise.
    ///
    /// # Errors
    /// The columns are not equally long. Nothing has been written or drawn.
    fn draw_columns(
        &self,
        rng: &mut dyn Rng,
        mut columns: [&mut [f64]; 10],
    ) -> Result<(), ColumnsError> {
        for row in 0..common_length(&columns)? {
            let values = self.draw(rng).values();
            for (column, value) in columns.iter_mut().zip(values) {
                column[row] = value;
            }
        }
        Ok(())
    }
}

/// What every law of bodies answers alike: its name, draws by [`Distribution`](rand_distr::Distribution), and that no draw is
/// of no body.
macro_rules! draws_bodies {
    ($name:literal) => {
        fn name(&self) -> std::borrow::Cow<'_, str> {
            $name.into()
        }

        fn draw(&self, rng: &mut dyn rand::Rng) -> $crate::TenParameters {
            let mut rng = rng;
            let body: gyradius_inertia::MassProperties = self.sample(&mut rng);
            body.into()
        }

        fn is_realizable_by_construction(&self) -> bool {
            true
        }
    };
}
pub(super) use draws_bodies;
