//! Any law of inertia, also one of a user's own, behind one object-safe trait.

use gyradius_inertia::{Inertia, InertiaMatrix, RootSecondMoments};
use nalgebra::UnitQuaternion;
use rand::Rng;
use rand_distr::Distribution;
use std::{borrow::Cow, fmt::Debug};

use crate::batch::common_length;
use crate::{
    AnyBody, AttitudeMoments, BasiliskDispersion, ColumnsError, CorrelatedEntries, DispersionModel,
    EntryMoments, EntrywiseGaussian, KnownMoments, LogCholeskyGaussian, ModelDraw,
    PrincipalDispersion, PrincipalDraw, RealizableOnly, RootMoments, Wishart,
};

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

impl From<PrincipalDraw> for ModelDraw {
    fn from(draw: PrincipalDraw) -> Self {
        Self { inertia: draw.inertia.into(), axes: Some(draw.axes) }
    }
}

/// A law by its name, what it draws, whether that is realizable by construction, and its moments.
macro_rules! laws {
    ($($law:ty: $name:literal, $draw:ty, $realizable:literal, $moments:expr;)*) => {$(
        impl InertiaLaw for $law {
            fn name(&self) -> Cow<'_, str> {
                $name.into()
            }

            fn draw(&self, rng: &mut dyn Rng) -> ModelDraw {
                let draw: $draw = self.sample(rng);
                draw.into()
            }

            fn is_realizable_by_construction(&self) -> bool {
                $realizable
            }

            fn expected_moments(&self) -> Option<EntryMoments> {
                let moments: fn(&Self) -> Option<EntryMoments> = $moments;
                moments(self)
            }
        }
    )*};
}
laws! {
    EntrywiseGaussian: "entrywise", InertiaMatrix, false, |law| Some(KnownMoments::entry_moments(law));
    CorrelatedEntries: "correlated-entries", InertiaMatrix, false, |law| Some(KnownMoments::entry_moments(law));
    LogCholeskyGaussian: "log-cholesky", Inertia, true, |law| Some(KnownMoments::entry_moments(law));
    Wishart: "wishart", Inertia, true, |law| Some(KnownMoments::entry_moments(law));
    BasiliskDispersion: "basilisk", InertiaMatrix, false, |law| Some(KnownMoments::entry_moments(law));
    AnyBody: "any-body", Inertia, true, |_| None;
}

impl<K, A> InertiaLaw for PrincipalDispersion<K, A>
where
    K: RootMoments + Distribution<RootSecondMoments> + Debug + Send + Sync,
    A: AttitudeMoments + Distribution<UnitQuaternion<f64>> + Debug + Send + Sync,
{
    fn name(&self) -> Cow<'_, str> {
        "principal".into()
    }

    fn draw(&self, rng: &mut dyn Rng) -> ModelDraw {
        let draw: PrincipalDraw = self.sample(rng);
        draw.into()
    }

    fn is_realizable_by_construction(&self) -> bool {
        true
    }

    fn expected_moments(&self) -> Option<EntryMoments> {
        Some(EntryMoments::of(self))
    }
}

/// Of any law: impossible draws are drawn again.
impl<L: InertiaLaw + Distribution<InertiaMatrix>> InertiaLaw for RealizableOnly<L> {
    fn name(&self) -> Cow<'_, str> {
        format!("realizable-{}", self.law().name()).into()
    }

    fn draw(&self, rng: &mut dyn Rng) -> ModelDraw {
        let draw: Inertia = self.sample(rng);
        draw.into()
    }

    fn is_realizable_by_construction(&self) -> bool {
        true
    }

    fn expected_moments(&self) -> Option<EntryMoments> {
        None
    }

    fn acceptance(&self) -> Option<f64> {
        Some(self.acceptance())
    }
}

impl DispersionModel {
    /// The law inside.
    #[must_use]
    pub fn law(&self) -> &dyn InertiaLaw {
        match self {
            Self::Principal(law) => &**law,
            Self::Entrywise(law) => law,
            Self::CorrelatedEntries(law) => &**law,
            Self::RealizableEntrywise(law) => law,
            Self::RealizableCorrelatedEntries(law) => &**law,
            Self::LogCholesky(law) => &**law,
            Self::Wishart(law) => &**law,
            Self::Basilisk(law) => law,
        }
    }

    /// Mean and covariance of the entries, where they are known: not for a law conditioned by rejection.
    #[must_use]
    pub fn entry_moments(&self) -> Option<EntryMoments> {
        self.law().expected_moments()
    }

    /// The estimated share of draws that rejection keeps, where the model is one by rejection.
    #[must_use]
    pub fn acceptance(&self) -> Option<f64> {
        self.law().acceptance()
    }
}

/// The law inside, which draws many at a time by the vector units where it is the principal one.
impl InertiaLaw for DispersionModel {
    fn name(&self) -> Cow<'_, str> {
        self.law().name()
    }

    fn draw(&self, rng: &mut dyn Rng) -> ModelDraw {
        self.law().draw(rng)
    }

    fn is_realizable_by_construction(&self) -> bool {
        self.law().is_realizable_by_construction()
    }

    fn expected_moments(&self) -> Option<EntryMoments> {
        self.law().expected_moments()
    }

    fn acceptance(&self) -> Option<f64> {
        self.law().acceptance()
    }

    fn draw_columns(
        &self,
        rng: &mut dyn Rng,
        columns: [&mut [f64]; 6],
    ) -> Result<(), ColumnsError> {
        if let Self::Principal(law) = self {
            law.sample_columns(rng, columns)
        } else {
            self.law().draw_columns(rng, columns)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ModelKind, ScalarRoots};
    use gyradius_attitude::UniformAttitude;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    /// Of every kind of model: name, promise, moments and draws are those of the kind and of the law inside.
    #[test]
    fn every_model_is_a_law() {
        let mean = InertiaMatrix::from_entries([5e3, 4e3, 3e3], [20.0, 2.0, -50.0]).unwrap();
        let mean = Inertia::try_from(mean).unwrap();
        let moments = KnownMoments::entry_moments(&Wishart::new(mean, 0.05).unwrap());
        for kind in ModelKind::ALL {
            let model = DispersionModel::matched(kind, &moments).unwrap().into_model();
            let law: Box<dyn InertiaLaw> = Box::new(model.clone());
            assert_eq!(law.name(), kind.name());
            assert_eq!(law.is_realizable_by_construction(), kind.is_realizable_by_construction());
            assert_eq!(law.acceptance().is_some(), law.expected_moments().is_none(), "{kind}");
            let mut rngs = [5, 5].map(ChaCha8Rng::seed_from_u64);
            for _ in 0..50 {
                let expected: ModelDraw = model.sample(&mut rngs[0]);
                assert_eq!(law.draw(&mut rngs[1]), expected, "{kind}");
                let sound = expected.inertia.is_realizable();
                assert!(sound || !law.is_realizable_by_construction(), "{kind}");
            }
        }
    }

    /// Columns are the draws one by one, and unequal ones are refused before anything is drawn.
    #[test]
    fn columns_are_draws() {
        let roots = RootSecondMoments::new([1.0, 2.0, 3.0]).unwrap();
        let roots = ScalarRoots::normal(roots, [0.1; 3]).unwrap();
        let law: &dyn InertiaLaw = &PrincipalDispersion::new(roots, UniformAttitude);
        let mut columns: [[f64; 40]; 6] = [[0.0; 40]; 6];
        let mut rngs = [6, 6].map(ChaCha8Rng::seed_from_u64);
        law.draw_columns(&mut rngs[0], columns.each_mut().map(AsMut::as_mut)).unwrap();
        for row in 0..40 {
            assert_eq!(law.draw(&mut rngs[1]).inertia.entries(), columns.map(|c| c[row]));
        }
        let [a, b, c, d, e, f] = columns.each_mut().map(AsMut::as_mut);
        let f: &mut [f64] = f;
        let unequal: [&mut [f64]; 6] = [a, b, c, d, e, &mut f[..39]];
        assert_eq!(law.draw_columns(&mut rngs[0], unequal).unwrap_err().lengths, [40, 39]);
        assert_eq!(law.draw(&mut rngs[0]), law.draw(&mut rngs[1]));
    }
}
