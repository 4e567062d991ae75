//! A body of a scenario, and how uncertain it is.

use gyradius_attitude::{MeanHalf, RadiallyConstrainedGaussian, UniformAttitude};
use gyradius_dispersion::{
    AxesLaw, CorrelatedRoots, EmpiricalRoots, FixedAttitude, JacobianTwice, JacobianTwiceError,
    PrincipalDispersion, RootLaw, ScalarLaw, ScalarRoots, ScalarRootsError,
};
use gyradius_inertia::{Inertia, RootSecondMoments};
use gyradius_separation::{Body, BodyState, MovingBody};
use nalgebra::{Matrix3, Matrix4, Quaternion, UnitQuaternion};

use super::{
    Axes, ScenarioError,
    file::{AxesLawFile, BodyFile, DispersionFile, RootsFile},
    law,
};

/// A body in its state at the start, and how uncertain its inertia is.
#[derive(Clone, Debug)]
pub(crate) struct UncertainBody {
    nominal: Inertia,
    moving: MovingBody,
    roots: RootLaw,
    axes: BodyAxes,
}

/// How the principal axes of a body scatter.
#[derive(Clone, Debug)]
enum BodyAxes {
    Gaussian(Box<RadiallyConstrainedGaussian>),
    Uniform,
    Fixed,
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

        let place = at("dispersion");
        let roots = roots(&place, &file.dispersion, nominal.second_moments().roots())?;
        let mean = nominal.principal_axes().attitude();
        let axes = axes(&place, &file.dispersion, mean)?;
        Ok(Self { nominal, moving: body.moving(state), roots, axes })
    }

    pub(crate) fn nominal(&self) -> &Inertia {
        &self.nominal
    }

    pub(crate) fn moving(&self) -> &MovingBody {
        &self.moving
    }

    /// The Gaussian that the axes are from, if they are from one.
    pub(crate) fn gaussian_axes(&self) -> Option<&RadiallyConstrainedGaussian> {
        match &self.axes {
            BodyAxes::Gaussian(law) => Some(law),
            BodyAxes::Uniform | BodyAxes::Fixed => None,
        }
    }

    /// The attitude that the axes scatter about.
    pub(crate) fn mean_axes(&self) -> UnitQuaternion<f64> {
        match &self.axes {
            BodyAxes::Gaussian(law) => law.mean(),
            BodyAxes::Uniform | BodyAxes::Fixed => self.nominal.principal_axes().attitude(),
        }
    }

    /// The principal dispersion of the body, the axes read as a model wants them.
    pub(crate) fn principal(
        &self,
        axes: Axes,
    ) -> Result<PrincipalDispersion<RootLaw, AxesLaw>, JacobianTwiceError> {
        let law: AxesLaw = match (&self.axes, axes) {
            (BodyAxes::Uniform, _) => UniformAttitude.into(),
            (BodyAxes::Fixed, _) => FixedAttitude::new(self.mean_axes()).into(),
            (BodyAxes::Gaussian(law), Axes::WholeSphere) => (**law).clone().into(),
            (BodyAxes::Gaussian(law), Axes::MeanHalf) => MeanHalf::new((**law).clone()).into(),
            (BodyAxes::Gaussian(law), Axes::JacobianTwice) => {
                JacobianTwice::new((**law).clone())?.into()
            }
        };
        Ok(PrincipalDispersion::new(self.roots.clone(), law))
    }
}

const VARIANCE: &str = "root_second_moment_variance_kg_m2";
const COVARIANCE: &str = "root_second_moment_covariance_kg_m2";
const BOUNDS: &str = "root_second_moment_bounds_sqrt_kg_m";
const SAMPLES: &str = "root_second_moment_samples_sqrt_kg_m";
const LAWS: &str = "root_second_moment_laws_sqrt_kg_m";

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
    let (law, takes): (&str, &[&str]) = match file.roots {
        RootsFile::Gaussian => ("roots = \"gaussian\"", &[VARIANCE]),
        RootsFile::CorrelatedGaussian => ("roots = \"correlated-gaussian\"", &[COVARIANCE]),
        RootsFile::Uniform => ("roots = \"uniform\"", &[VARIANCE]),
        RootsFile::Lognormal => ("roots = \"lognormal\"", &[VARIANCE]),
        RootsFile::TruncatedGaussian => ("roots = \"truncated-gaussian\"", &[VARIANCE, BOUNDS]),
        RootsFile::Independent => ("roots = \"independent\"", &[LAWS]),
        RootsFile::Empirical => ("roots = \"empirical\"", &[SAMPLES]),
    };
    for (field, given) in [
        (VARIANCE, file.root_second_moment_variance_kg_m2.is_some()),
        (COVARIANCE, file.root_second_moment_covariance_kg_m2.is_some()),
        (BOUNDS, file.root_second_moment_bounds_sqrt_kg_m.is_some()),
        (SAMPLES, file.root_second_moment_samples_sqrt_kg_m.is_some()),
        (LAWS, file.root_second_moment_laws_sqrt_kg_m.is_some()),
    ] {
        if given && !takes.contains(&field) {
            let problem = format!("{law} does not take it, but {}", takes.join(" and "));
            return Err(ScenarioError::field(format!("{place}.{field}"), problem));
        }
    }
    let variances = || needed(place, VARIANCE, law, file.root_second_moment_variance_kg_m2);
    let refused = |field: &str, e: &dyn std::fmt::Display| {
        ScenarioError::field(format!("{place}.{field}"), e)
    };
    Ok(match file.roots {
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
    match (file.axes, file.axes_covariance) {
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
