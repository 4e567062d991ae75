//! Whether samples of bodies look like draws of the joint law that was fitted to them.

use rand::Rng;
use std::fmt;

use super::{MassPropertiesFit, ScalarEstimate};
use crate::{
    assessment::{Goodness, Test},
    fit::{Aspect, FitTest, independence},
};

/// What of the joint law a test looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum MassAspect {
    /// The distribution of the mass.
    Mass {
        /// Which law it has.
        law: ScalarEstimate,
    },
    /// The distribution of a coordinate of the mass centre.
    Centre {
        /// Axis, from 1.
        axis: usize,
    },
    /// Something of the inertia of one kilogram, of which roots are gyration lengths.
    Inertia(Aspect),
    /// That the axes are independent of mass and mass centre.
    Axes,
}

impl fmt::Display for MassAspect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mass { law } => write!(f, "the mass is {law}"),
            Self::Centre { axis } => write!(f, "mass centre {axis} is normal"),
            Self::Inertia(Aspect::Root { axis }) => write!(f, "gyration length {axis} is normal"),
            Self::Inertia(Aspect::RootsAndAxes) => {
                f.write_str("gyration lengths and axes are independent")
            }
            Self::Inertia(aspect) => aspect.fmt(f),
            Self::Axes => f.write_str("mass, mass centre and axes are independent"),
        }
    }
}

/// One test of the joint law.
pub type MassTest = Test<MassAspect>;

/// Whether samples look like draws of the fitted joint law.
pub type MassAssessment = Goodness<MassAspect>;

impl MassPropertiesFit {
    /// Tests whether the samples look like draws of the law: each scalar by Anderson and Darling's test with estimated
    /// parameters, the inertia of one kilogram as [`PrincipalFit::assess`](crate::PrincipalFit::assess) does, but for the
    /// independence of its lengths, which the law need not have; and that the axes are independent of mass and mass centre, by
    /// Bartlett's test of correlations.
    pub fn assess<R: Rng + ?Sized>(&self, rng: &mut R) -> MassAssessment {
        self.assess_with(rng, &|_| {})
    }

    /// The same, and reports how many samples it has simulated, of
    /// [`PrincipalFit::simulations`](crate::PrincipalFit::simulations) at most.
    pub fn assess_with<R: Rng + ?Sized>(
        &self,
        rng: &mut R,
        progress: &dyn Fn(u64),
    ) -> MassAssessment {
        let mut tests = Vec::new();
        let mut exact = |aspect, p_value: Option<f64>| {
            tests.extend(p_value.map(|p_value| MassTest::new(aspect, p_value, 0.0)));
        };
        exact(MassAspect::Mass { law: self.mass.kind() }, self.mass.p_value());
        for (i, centre) in self.centre.iter().enumerate() {
            exact(MassAspect::Centre { axis: i + 1 }, centre.p_value());
        }
        let place = self.place_scores();
        if !self.has_free_axes() && !place.is_empty() {
            let turns = self.lengths.turns();
            let p_value = independence(&place, &turns, self.count());
            exact(MassAspect::Axes, (!turns.is_empty()).then_some(p_value));
        }
        let own = self.lengths.assess_with(rng, progress);
        // Correlated lengths are a part of the joint law, and move the entries.
        let asked = |test: &&FitTest| !matches!(test.aspect(), Aspect::Roots | Aspect::Entries);
        tests.extend(own.tests().iter().filter(asked).map(|test| {
            let aspect = MassAspect::Inertia(test.aspect());
            MassTest::new(aspect, test.p_value(), test.resolution())
        }));
        MassAssessment::new(tests)
    }
}
