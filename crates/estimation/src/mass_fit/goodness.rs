//! Whether samples of bodies look like draws of the joint law that was fitted to them.

use rand::Rng;
use std::fmt;

use super::{MassPropertiesFit, ScalarEstimate};
use crate::fit::{Aspect, independence};

/// The verdict falls when a model that is right would look worse this often.
const SIZE: f64 = 0.05;

/// What of the joint law a test looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "kebab-case"))]
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
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct MassTest {
    aspect: MassAspect,
    p_value: f64,
    resolution: f64,
}

impl MassTest {
    /// What it looks at.
    #[must_use]
    pub fn aspect(&self) -> MassAspect {
        self.aspect
    }

    /// How often samples of the law itself would look worse.
    #[must_use]
    pub fn p_value(&self) -> f64 {
        self.p_value
    }

    /// The smallest p-value that the test can give, zero if it is not by simulation.
    #[must_use]
    pub fn resolution(&self) -> f64 {
        self.resolution
    }
}

/// Whether samples look like draws of the fitted joint law.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct MassAssessment {
    tests: Vec<MassTest>,
}

impl MassAssessment {
    /// The tests, each at its own level.
    #[must_use]
    pub fn tests(&self) -> &[MassTest] {
        &self.tests
    }

    /// How often samples of the law itself would fare worse in any of the tests (Šidák).
    #[must_use]
    pub fn p_value(&self) -> f64 {
        let least = self.tests.iter().map(|t| t.p_value).fold(1.0, f64::min);
        -libm::expm1(self.tests.len() as f64 * libm::log1p(-least))
    }

    /// Whether nothing speaks against the law at 5 %.
    #[must_use]
    pub fn fits(&self) -> bool {
        self.tests.is_empty() || self.p_value() >= SIZE
    }

    /// What speaks against the law: the tests that fail at 5 % though there are several (Šidák).
    pub fn objections(&self) -> impl Iterator<Item = &MassTest> {
        let each = -libm::expm1(libm::log1p(-SIZE) / self.tests.len().max(1) as f64);
        self.tests.iter().filter(move |t| t.p_value < each)
    }
}

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
            tests.extend(p_value.map(|p_value| MassTest { aspect, p_value, resolution: 0.0 }));
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
        tests.extend(own.tests().iter().filter(|test| test.aspect() != Aspect::Roots).map(
            |test| MassTest {
                aspect: MassAspect::Inertia(test.aspect()),
                p_value: test.p_value(),
                resolution: test.resolution(),
            },
        ));
        MassAssessment { tests }
    }
}
