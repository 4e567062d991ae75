//! Any law of inertia, also one of a user's own, behind one object-safe trait.

use gyradius_inertia::{Inertia, InertiaMatrix};
use nalgebra::{Matrix3, UnitQuaternion};
use rand::Rng;
use std::{borrow::Cow, fmt::Debug};

use crate::EntryMoments;
use crate::columns::{ColumnsError, common_length};

/// A law of the inertia of a body: what studies and comparisons of models draw from.
///
/// Every law of this crate is one, and so can be a type of your own; a `Box<dyn InertiaLaw>` is any of them. The
/// example `mixture_study` of `gyradius-study` has one, and takes it through a study.
///
/// ```
/// use gyradius_dispersion::{AnyBody, InertiaLaw, Wishart};
/// use gyradius_inertia::{Inertia, InertiaMatrix};
/// use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
///
/// let mean = Inertia::try_from(InertiaMatrix::from_entries([5e3, 4e3, 3e3], [20.0, 2.0, -50.0])?)?;
/// let laws: [Box<dyn InertiaLaw>; 2] =
///     [Box::new(Wishart::new(mean, 0.1)?), Box::new(AnyBody::new(1e3, 1e4)?)];
/// for law in &laws {
///     let body = law.draw(&mut ChaCha8Rng::seed_from_u64(1)).inertia;
///     assert!(law.is_realizable_by_construction() && body.is_realizable());
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait InertiaLaw: Debug + Send + Sync {
    /// What it is called, in kebab case.
    fn name(&self) -> Cow<'_, str>;

    /// A body, and the attitude of its principal axes where the law draws one. It depends on what the generator
    /// gives, and on nothing else.
    fn draw(&self, rng: &mut dyn Rng) -> ModelDraw;

    /// Whether no draw can be unrealizable.
    fn is_realizable_by_construction(&self) -> bool;

    /// Mean and covariance of the entries, where they are known.
    fn expected_moments(&self) -> Option<EntryMoments>;

    /// The estimated share of draws that rejection keeps, where the law is one by rejection.
    fn acceptance(&self) -> Option<f64> {
        None
    }

    /// Whether the attitude of the principal axes is drawn independently of the principal moments, so that the axes of one draw
    /// and the moments of another are a draw too. No, unless a law says so.
    fn has_independent_axes(&self) -> bool {
        false
    }

    /// The logarithm of the density of the entries I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃ in kg·m²; −∞ where no draw can be, so of
    /// a matrix that no body has where every draw is a body. None where the law has no density, or none that is known:
    /// that is so unless a law says otherwise. The density of c·I under a law with all inertias c times as large is that
    /// of I over c⁶.
    ///
    /// ```
    /// use gyradius_dispersion::{InertiaLaw, Wishart};
    /// use gyradius_inertia::{Inertia, InertiaMatrix};
    ///
    /// let mean = Inertia::try_from(InertiaMatrix::from_entries([5.0, 4.0, 3.0], [0.2, 0.1, -0.5])?)?;
    /// let law = Wishart::new(mean, 0.1)?;
    /// let other = InertiaMatrix::from_entries([5.0, 4.0, 3.5], [0.2, 0.1, -0.5])?;
    /// assert!(law.ln_density(&other) < law.ln_density(mean.as_inertia_matrix()));
    /// let impossible = InertiaMatrix::from_entries([5.0, 1.0, 1.0], [0.0; 3])?;
    /// assert_eq!(law.ln_density(&impossible), Some(f64::NEG_INFINITY));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    fn ln_density(&self, inertia: &InertiaMatrix) -> Option<f64> {
        let _ = inertia;
        None
    }

    /// Fills six columns, I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃ in kg·m², with independent draws: those of
    /// [`draw`](Self::draw) unless a law says otherwise.
    ///
    /// # Errors
    /// The columns are not equally long. Nothing has been written or drawn.
    fn draw_columns(
        &self,
        rng: &mut dyn Rng,
        mut columns: [&mut [f64]; 6],
    ) -> Result<(), ColumnsError> {
        for row in 0..common_length(&columns)? {
            let entries = self.draw(rng).inertia.entries();
            for (column, entry) in columns.iter_mut().zip(entries) {
                column[row] = entry;
            }
        }
        Ok(())
    }
}

/// A draw, and the attitude of the principal axes where the model draws one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelDraw {
    /// The inertia in body axes.
    pub inertia: InertiaMatrix,
    /// The attitude that takes body components to principal components, as drawn.
    pub axes: Option<UnitQuaternion<f64>>,
}

crate::written!(
    ModelDraw,
    |draw| {
        inertia: InertiaMatrix = draw.inertia,
        axes: Option<[f64; 4]> = draw.axes.map(|axes| axes.coords.into()),
    },
    ModelDraw { inertia, axes: axes.map(crate::axes::unit).transpose()? }
);

impl ModelDraw {
    /// The principal moments of this draw about the axes of another; itself if one of them has no axes.
    #[must_use]
    pub fn about_axes_of(self, other: &Self) -> Self {
        let (Some(own), Some(axes)) = (self.axes, other.axes) else { return self };
        let (own, turn) = (own.to_rotation_matrix(), axes.to_rotation_matrix());
        let moments = (own.matrix() * self.inertia.matrix() * own.matrix().transpose()).diagonal();
        let inertia = turn.matrix().transpose() * Matrix3::from_diagonal(&moments) * turn.matrix();
        let inertia = InertiaMatrix::new((inertia + inertia.transpose()) * 0.5);
        inertia.map_or(self, |inertia| Self { inertia, axes: Some(axes) })
    }
}

impl From<Inertia> for ModelDraw {
    fn from(inertia: Inertia) -> Self {
        InertiaMatrix::from(inertia).into()
    }
}

impl From<InertiaMatrix> for ModelDraw {
    fn from(inertia: InertiaMatrix) -> Self {
        Self { inertia, axes: None }
    }
}
