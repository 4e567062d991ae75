//! What a model of inertia says of itself to have a name in scenarios.

use gyradius_inertia::{Inertia, InertiaMatrix};

use crate::{EntryMoments, InertiaLaw, ModelParameterError, ModelParameters};

/// Why a model has not the moments that are asked for.
pub(crate) type NoMatch = Box<dyn std::error::Error>;

/// A law that has a name in scenarios, once it stands in the list of `models!`.
pub(crate) trait NamedModel: InertiaLaw + Sized {
    /// In kebab case.
    const NAME: &'static str;
    /// What it is, in a line.
    const DESCRIPTION: &'static str;
    /// Whether no draw can be unrealizable, whatever the parameters.
    const IS_REALIZABLE: bool;
    /// The keys of the parameters without which it is not made.
    const NEEDS: &'static [&'static str];

    /// The parameters that it takes besides, with what they are if a file does not say them.
    fn defaults() -> ModelParameters {
        ModelParameters::default()
    }

    /// The model about a nominal body.
    fn about(nominal: &Inertia, given: &ModelParameters) -> Result<Self, ModelParameterError>;

    /// The model whose entries have this mean and these moments as far as it can, and how far that is.
    fn matched(
        mean: InertiaMatrix,
        moments: &EntryMoments,
    ) -> Result<(Self, &'static str), NoMatch>;
}

/// The [`InertiaLaw`] of a named model whose moments are known.
macro_rules! inertia_law {
    ($law:ty, draws $draw:ty) => {
        impl crate::InertiaLaw for $law {
            fn name(&self) -> std::borrow::Cow<'_, str> {
                <Self as crate::named_model::NamedModel>::NAME.into()
            }

            fn draw(&self, rng: &mut dyn rand::Rng) -> crate::ModelDraw {
                let draw: $draw = self.sample(rng);
                draw.into()
            }

            fn is_realizable_by_construction(&self) -> bool {
                <Self as crate::named_model::NamedModel>::IS_REALIZABLE
            }

            fn expected_moments(&self) -> Option<crate::EntryMoments> {
                Some(crate::KnownMoments::entry_moments(self))
            }

            fn ln_density(&self, inertia: &gyradius_inertia::InertiaMatrix) -> Option<f64> {
                // Its own, which comes before that of the trait.
                <$law>::ln_density(self, inertia)
            }
        }
    };
}
pub(crate) use inertia_law;
