//! A body of a scenario, and how uncertain it is.

use gyradius_attitude::{MeanHalf, RadiallyConstrainedGaussian, UniformAttitude};
use gyradius_dispersion::{
    AxesLaw, CorrelatedRoots, DispersionModel, EmpiricalRoots, EntryMoments, FixedAttitude,
    InertiaLaw, JacobianTwice, JacobianTwiceError, JointScalar, LawUnit, MassPropertiesLaw,
    PrincipalDispersion, RootLaw, ScalarLaw, ScalarLawForm, ScalarRoots, ScalarRootsError,
    TensorLaw, TensorParts,
};
use gyradius_inertia::{Inertia, Region, RootSecondMoments};
use gyradius_separation::{Body, BodyState, MovingBody};
use nalgebra::{Matrix3, Matrix4, Quaternion, SMatrix, UnitQuaternion};
use std::sync::OnceLock;

use super::{
    Axes, ScenarioError,
    as_given::AsGiven,
    file::{
        AxesLawFile, BOUNDS, BodyFile, COVARIANCE, DispersionFile, LAWS, LENGTHS, RootsFile,
        SAMPLES, VARIANCE,
    },
    follows::Follows,
    law,
};
use crate::folded::FoldedRoot;

/// What a length and a root are called.
const LENGTH: &str = "gyration_length";
const ROOT: &str = "root";

/// A body in its state at the start, and how uncertain its mass properties are.
#[derive(Clone, Debug)]
pub(crate) struct UncertainBody {
    nominal: Inertia,
    moving: MovingBody,
    inertia: BodyInertia,
    /// The share of the mass's relative change that the inertia takes, and the mass at which its law holds, kg.
    follows: (f64, f64),
    region: Option<Region>,
    /// That of mass, mass centre and inertia, if it is given as a whole.
    law: Option<MassPropertiesLaw>,
    /// How the roots are correlated.
    correlated: Vec<(JointScalar, JointScalar, f64)>,
    /// Mean and covariance of the entries as models read the axes. A contour integral, and several models ask for them.
    moments: [OnceLock<Option<EntryMoments>>; Axes::COUNT],
}

/// How uncertain the inertia of a body is at its nominal mass.
#[derive(Clone, Debug)]
enum BodyInertia {
    /// Roots, from lengths or not, about axes.
    Principal { roots: Box<RootLaw>, lengths: bool, axes: BodyAxes },
    /// Any model.
    Model(DispersionModel),
}

/// How the principal axes of a body scatter.
#[derive(Clone, Debug)]
enum BodyAxes {
    Gaussian(Box<RadiallyConstrainedGaussian>),
    Uniform,
    Fixed,
    /// As a whole law says, in another way.
    Given(Box<AxesLaw>),
}

impl UncertainBody {
    pub(crate) fn new(name: &str, file: &BodyFile) -> Result<Self, ScenarioError> {
        let at = |field: &str| format!("{name}.{field}");
        let nominal = Inertia::try_from(file.inertia_kg_m2)
            .map_err(|e| ScenarioError::field(at("inertia_kg_m2"), e))?;
        let body = Body::new(file.mass_kg, nominal).map_err(|e| {
            let field = match e {
                gyradius_separation::BodyError::Mass { .. } => "mass_kg",
                _ => "inertia_kg_m2",
            };
            ScenarioError::field(at(field), e)
        })?;
        let attitude = Quaternion::from(nalgebra::Vector4::from(file.body_to_inertial));
        if !((attitude.norm() - 1.0).abs() < 1e-6) {
            let problem = format!(
                "{:?}: it must be a unit quaternion, scalar last, to six digits",
                file.body_to_inertial
            );
            return Err(ScenarioError::field(at("body_to_inertial"), problem));
        }
        let vectors = [
            ("position_m", file.position_m),
            ("velocity_m_per_s", file.velocity_m_per_s),
            ("angular_velocity_rad_per_s", file.angular_velocity_rad_per_s),
        ];
        for (field, values) in vectors {
            if !values.iter().all(|x| x.is_finite()) {
                let problem = format!("{values:?}: every entry must be finite");
                return Err(ScenarioError::field(at(field), problem));
            }
        }
        let state = BodyState {
            position: file.position_m.into(),
            velocity: file.velocity_m_per_s.into(),
            attitude: UnitQuaternion::new_normalize(attitude),
            angular_velocity: file.angular_velocity_rad_per_s.into(),
        };

        let (place, d) = (at("dispersion"), &file.dispersion);
        let law = file.law.as_ref().map(|given| given.said().clone());
        let (inertia, follows) = if let Some(law) = &law {
            if let Some(key) = d.beside_law() {
                let problem = format!("there is {} already: one of the two says it", at("law"));
                return Err(ScenarioError::field(format!("{place}.{key}"), problem));
            }
            of_law(&at("law"), law.tensor(), file.mass_kg)?
        } else {
            let mean = nominal.second_moments().roots();
            let roots = match &d.gyration_lengths_m {
                Some(forms) => lengths(&place, d, forms, mean, file.mass_kg)?,
                None => roots(&place, d, mean)?,
            };
            let lengths = d.gyration_lengths_m.is_some();
            let axes = axes(&place, d, nominal.principal_axes().attitude())?;
            let share =
                if lengths { 1.0 } else { d.inertia_follows_mass.map_or(0.0, Follows::share) };
            let roots = Box::new(roots);
            (BodyInertia::Principal { roots, lengths, axes }, (share, file.mass_kg))
        };
        let inside = d.inside.as_ref().map(AsGiven::said);
        let region = inside.or_else(|| law.as_ref()?.region()).cloned();
        let moving = body.moving(state);
        Ok(Self {
            nominal,
            moving,
            inertia,
            follows,
            region,
            law,
            correlated: Vec::new(),
            moments: Default::default(),
        })
    }

    pub(crate) fn nominal(&self) -> &Inertia {
        &self.nominal
    }

    pub(crate) fn moving(&self) -> &MovingBody {
        &self.moving
    }

    /// The share of the mass's relative change that the inertia takes, and the mass at which its law holds, kg.
    pub(crate) fn follows(&self) -> (f64, f64) {
        self.follows
    }

    /// Where the matter is, body axes, if it is said.
    pub(crate) fn region(&self) -> Option<&Region> {
        self.region.as_ref()
    }

    /// The law of mass, mass centre and inertia, if it is given as a whole.
    pub(crate) fn given_law(&self) -> Option<&MassPropertiesLaw> {
        self.law.as_ref()
    }

    /// The law of the roots at the nominal mass, and what they are called and in which unit; nothing of models without such.
    pub(crate) fn roots(&self) -> Option<(&RootLaw, [&'static str; 2])> {
        match &self.inertia {
            BodyInertia::Principal { roots, lengths, .. } => {
                Some((roots, if *lengths { [LENGTH, "m"] } else { [ROOT, "sqrt_kg_m"] }))
            }
            BodyInertia::Model(_) => None,
        }
    }

    /// What the roots can be called as numbers of their own, in which unit, and their laws, if each has its own.
    pub(crate) fn root_numbers(&self) -> Option<([&'static str; 2], &[ScalarLaw; 3])> {
        let (roots, name) = self.roots()?;
        Some((name, independent(roots)?))
    }

    /// What the gyration lengths are called, and the laws of the roots that they make at the nominal mass, if changes of lengths are given.
    pub(crate) fn changes_of_lengths(&self) -> Option<(&'static str, &[ScalarLaw; 3])> {
        match (&self.inertia, &self.law) {
            (BodyInertia::Principal { roots, lengths: true, .. }, None) => {
                Some((LENGTH, independent(roots)?))
            }
            (BodyInertia::Principal { .. } | BodyInertia::Model(_), _) => None,
        }
    }

    /// Roots of the body, which has this name, whose laws lie below zero; nothing of models without such.
    pub(crate) fn folded(&self, body: &str) -> Vec<FoldedRoot> {
        self.roots().map_or_else(Vec::new, |(roots, [called, _])| {
            FoldedRoot::of(body, called, roots.folded_shares())
        })
    }

    /// With roots that are correlated so; coefficients of other scalars are passed over.
    pub(crate) fn correlate_roots(&mut self, pairs: &[(JointScalar, JointScalar, f64)]) {
        let root = |scalar: JointScalar| scalar as usize >= JointScalar::Shape1 as usize;
        let of_roots = pairs.iter().filter(|(a, b, _)| root(*a) && root(*b));
        self.correlated = of_roots.copied().collect();
        self.moments = Default::default();
    }

    /// Whether roots are correlated.
    pub(crate) fn has_correlated_roots(&self) -> bool {
        !self.correlated.is_empty()
    }

    /// The Gaussian that the axes are from, if they are from one.
    pub(crate) fn gaussian_axes(&self) -> Option<&RadiallyConstrainedGaussian> {
        match &self.inertia {
            BodyInertia::Principal { axes: BodyAxes::Gaussian(law), .. } => Some(law),
            BodyInertia::Principal { .. } | BodyInertia::Model(_) => None,
        }
    }

    /// The attitude that the axes scatter about.
    pub(crate) fn mean_axes(&self) -> UnitQuaternion<f64> {
        let nominal = || self.nominal.principal_axes().attitude();
        self.gaussian_axes().map_or_else(nominal, RadiallyConstrainedGaussian::mean)
    }

    /// The law of the inertia at the nominal mass, the axes read as a model wants them, and the roots as if they were not
    /// correlated.
    pub(crate) fn law(&self, axes: Axes) -> Result<DispersionModel, JacobianTwiceError> {
        match &self.inertia {
            BodyInertia::Model(model) => Ok(model.clone()),
            BodyInertia::Principal { roots, axes: own, .. } => {
                let axes = self.axes(own, axes)?;
                Ok(PrincipalDispersion::new((**roots).clone(), axes).into())
            }
        }
    }

    /// Mean and covariance of the entries at the nominal mass, those of correlated roots too.
    pub(crate) fn expected_moments(&self, axes: Axes) -> Option<EntryMoments> {
        *self.moments[axes as usize].get_or_init(|| self.integrated_moments(axes))
    }

    fn integrated_moments(&self, axes: Axes) -> Option<EntryMoments> {
        if self.correlated.is_empty() {
            return self.law(axes).ok()?.expected_moments();
        }
        let constant = |value| ScalarLaw::normal(value, 0.0).ok();
        let centre = [constant(0.0)?, constant(0.0)?, constant(0.0)?];
        let law =
            MassPropertiesLaw::new(constant(self.follows.1)?, centre, self.tensor(axes).ok()?);
        let moments = law.ok()?.with_correlation(&self.correlated).ok()?.moments()?;
        let mean = std::array::from_fn(|i| moments.mean()[4 + i]);
        let covariance: SMatrix<f64, 6, 6> = moments.covariance().fixed_view::<6, 6>(4, 4).into();
        EntryMoments::new(mean, covariance).ok()
    }

    /// The law of the inertia as a part of a joint law, at the nominal mass.
    pub(crate) fn tensor(&self, axes: Axes) -> Result<TensorLaw, Box<dyn std::error::Error>> {
        if let BodyInertia::Principal { roots, axes: own, .. } = &self.inertia
            && let Some(laws) = independent(roots)
        {
            return Ok(TensorLaw::roots(laws.clone(), self.axes(own, axes)?));
        }
        Ok(TensorLaw::model(self.law(axes)?)?)
    }

    /// The axes as a model wants them.
    fn axes(&self, own: &BodyAxes, axes: Axes) -> Result<AxesLaw, JacobianTwiceError> {
        Ok(match (own, axes) {
            (BodyAxes::Uniform, _) => UniformAttitude.into(),
            (BodyAxes::Fixed, _) => FixedAttitude::new(self.mean_axes()).into(),
            (BodyAxes::Given(law), _) => (**law).clone(),
            (BodyAxes::Gaussian(law), Axes::WholeSphere) => (**law).clone().into(),
            (BodyAxes::Gaussian(law), Axes::MeanHalf) => MeanHalf::new((**law).clone()).into(),
            (BodyAxes::Gaussian(law), Axes::JacobianTwice) => {
                JacobianTwice::new((**law).clone())?.into()
            }
        })
    }
}

/// The laws of roots that each have their own.
fn independent(roots: &RootLaw) -> Option<&[ScalarLaw; 3]> {
    match roots {
        RootLaw::Independent(roots) => Some(roots.laws()),
        RootLaw::CorrelatedGaussian(_) | RootLaw::Empirical(_) => None,
    }
}

/// What a whole law says of the inertia at the mass at which it holds, and how the inertia goes with the mass.
fn of_law(
    field: &str,
    tensor: &TensorLaw,
    mass_kg: f64,
) -> Result<(BodyInertia, (f64, f64)), ScenarioError> {
    let follows = tensor.follows().unwrap_or((0.0, mass_kg));
    let principal = |roots: RootLaw, lengths, axes: &AxesLaw| {
        let axes = match axes {
            AxesLaw::WholeSphere(law) => BodyAxes::Gaussian(Box::new(law.clone())),
            other => BodyAxes::Given(Box::new(other.clone())),
        };
        BodyInertia::Principal { roots: Box::new(roots), lengths, axes }
    };
    let roots = |laws: [ScalarLaw; 3]| {
        let roots = ScalarRoots::new(laws);
        roots.map_err(|e| ScenarioError::field(format!("{field}.inertia"), e))
    };
    Ok(match tensor.parts() {
        TensorParts::GyrationLengths { laws, axes } => {
            let unit = LawUnit::of(mass_kg.sqrt());
            let [a, b, c] = laws.each_ref().map(|length| {
                let refused = |e| law::refused(&format!("{field}.inertia"), &e);
                ScalarLawForm::from(length.clone()).about(0.0, unit).map_err(refused)
            });
            (principal(roots([a?, b?, c?])?.into(), true, axes), (1.0, mass_kg))
        }
        TensorParts::Roots { laws, axes } => {
            (principal(roots(laws.clone())?.into(), false, axes), follows)
        }
        TensorParts::Model(DispersionModel::Principal(law)) => {
            (principal(law.roots().clone(), false, law.axes()), follows)
        }
        TensorParts::Model(model) => (BodyInertia::Model(model.clone()), follows),
    })
}

/// Gyration lengths about the nominal ones, as the roots that a body of the nominal mass has by them.
fn lengths(
    place: &str,
    file: &DispersionFile,
    forms: &[ScalarLawForm; 3],
    mean: RootSecondMoments,
    mass_kg: f64,
) -> Result<RootLaw, ScenarioError> {
    if let Some(key) = file.beside_lengths() {
        let problem = format!(
            "there is {place}.{LENGTHS} already, of which the inertia follows, wholly with the mass: one of the two says it"
        );
        return Err(ScenarioError::field(format!("{place}.{key}"), problem));
    }
    let unit = LawUnit::of(mass_kg.sqrt());
    let law = |i: usize| {
        let field = format!("{place}.{LENGTHS}[{}]", i + 1);
        let law = law::about(&forms[i], &field, mean.values()[i], unit)?;
        // Of a plate half of the lengths about zero are negative, and are folded: more than that nobody means.
        let negative = law.cdf(-f64::MIN_POSITIVE);
        if negative > 0.5 + 1e-9 {
            let problem = format!(
                "the length is negative in {:.1} % of the draws: it must not be in more than half of them",
                100.0 * negative
            );
            return Err(ScenarioError::field(field, problem));
        }
        Ok(law)
    };
    let roots = ScalarRoots::new([law(0)?, law(1)?, law(2)?]);
    Ok(roots.map_err(|e| ScenarioError::field(format!("{place}.{LENGTHS}"), e))?.into())
}

/// A field that a law needs.
fn needed<T>(place: &str, field: &str, law: &str, value: Option<T>) -> Result<T, ScenarioError> {
    value.ok_or_else(|| {
        ScenarioError::field(format!("{place}.{field}"), format!("missing: {law} needs it"))
    })
}

fn roots(
    place: &str,
    file: &DispersionFile,
    mean: RootSecondMoments,
) -> Result<RootLaw, ScenarioError> {
    let kind = file.roots.unwrap_or_default();
    let (law, takes): (&str, &[&str]) = match kind {
        RootsFile::Gaussian => ("roots = \"gaussian\"", &[VARIANCE]),
        RootsFile::CorrelatedGaussian => ("roots = \"correlated-gaussian\"", &[COVARIANCE]),
        RootsFile::Uniform => ("roots = \"uniform\"", &[VARIANCE]),
        RootsFile::Lognormal => ("roots = \"lognormal\"", &[VARIANCE]),
        RootsFile::TruncatedGaussian => ("roots = \"truncated-gaussian\"", &[VARIANCE, BOUNDS]),
        RootsFile::Independent => ("roots = \"independent\"", &[LAWS]),
        RootsFile::Empirical => ("roots = \"empirical\"", &[SAMPLES]),
    };
    if let Some(field) = file.not_taken(takes) {
        let problem = format!("{law} does not take it, but {}", takes.join(" and "));
        return Err(ScenarioError::field(format!("{place}.{field}"), problem));
    }
    let variances = || needed(place, VARIANCE, law, file.root_second_moment_variance_kg_m2);
    let refused = |field: &str, e: &dyn std::fmt::Display| {
        ScenarioError::field(format!("{place}.{field}"), e)
    };
    Ok(match kind {
        RootsFile::Gaussian => {
            ScalarRoots::normal(mean, variances()?).map_err(|e| refused(VARIANCE, &e))?.into()
        }
        RootsFile::CorrelatedGaussian => {
            let c = needed(place, COVARIANCE, law, file.root_second_moment_covariance_kg_m2)?;
            CorrelatedRoots::new(mean, Matrix3::from_fn(|i, j| c[i][j]))
                .map_err(|e| refused(COVARIANCE, &e))?
                .into()
        }
        RootsFile::Uniform => {
            ScalarRoots::uniform(mean, variances()?).map_err(|e| refused(VARIANCE, &e))?.into()
        }
        RootsFile::Lognormal => {
            ScalarRoots::lognormal(mean, variances()?).map_err(|e| refused(VARIANCE, &e))?.into()
        }
        RootsFile::TruncatedGaussian => {
            let bounds = needed(place, BOUNDS, law, file.root_second_moment_bounds_sqrt_kg_m)?;
            ScalarRoots::truncated_normal(mean, variances()?, bounds)
                .map_err(|e| {
                    let variance = matches!(e, ScalarRootsError::Variance { .. });
                    refused(if variance { VARIANCE } else { BOUNDS }, &e)
                })?
                .into()
        }
        RootsFile::Independent => {
            let forms = needed(place, LAWS, law, file.root_second_moment_laws_sqrt_kg_m.as_ref())?;
            let law = |i: usize| {
                ScalarLaw::try_from(forms[i].clone())
                    .map_err(|e| law::refused(&format!("{place}.{LAWS}[{}]", i + 1), &e))
            };
            ScalarRoots::new([law(0)?, law(1)?, law(2)?]).map_err(|e| refused(LAWS, &e))?.into()
        }
        RootsFile::Empirical => {
            let samples = file.root_second_moment_samples_sqrt_kg_m.as_ref();
            let samples = needed(place, SAMPLES, law, samples)?;
            EmpiricalRoots::from_values(samples).map_err(|e| refused(SAMPLES, &e))?.into()
        }
    })
}

fn axes(
    place: &str,
    file: &DispersionFile,
    mean: UnitQuaternion<f64>,
) -> Result<BodyAxes, ScenarioError> {
    let field = format!("{place}.axes_covariance");
    match (file.axes.unwrap_or_default(), file.axes_covariance) {
        (AxesLawFile::RadiallyConstrainedGaussian, covariance) => {
            let law = "axes = \"radially-constrained-gaussian\"";
            let covariance = needed(place, "axes_covariance", law, covariance)?;
            let covariance = Matrix4::from_fn(|i, j| covariance[i][j]);
            let law = RadiallyConstrainedGaussian::new(mean, covariance)
                .map_err(|e| ScenarioError::field(field, e))?;
            Ok(BodyAxes::Gaussian(Box::new(law)))
        }
        (AxesLawFile::Uniform, None) => Ok(BodyAxes::Uniform),
        (AxesLawFile::Fixed, None) => Ok(BodyAxes::Fixed),
        (AxesLawFile::Uniform | AxesLawFile::Fixed, Some(_)) => {
            let problem = "axes = \"uniform\" and \"fixed\" do not take it";
            Err(ScenarioError::field(field, problem))
        }
    }
}
