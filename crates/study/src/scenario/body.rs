use gyradius_attitude::RadiallyConstrainedGaussian;
use gyradius_dispersion::GaussianRoots;
use gyradius_inertia::Inertia;
use gyradius_separation::{Body, BodyState, MovingBody};
use nalgebra::{Matrix4, Quaternion, UnitQuaternion};

use super::{ScenarioError, file::BodyFile};

/// A body in its state at the start, and how uncertain its inertia is.
#[derive(Clone, Debug)]
pub(crate) struct UncertainBody {
    nominal: Inertia,
    moving: MovingBody,
    roots: GaussianRoots,
    axes: RadiallyConstrainedGaussian,
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

        let variances = file.dispersion.root_second_moment_variance_kg_m2;
        let roots =
            GaussianRoots::new(nominal.second_moments().roots(), variances).map_err(|e| {
                ScenarioError::field(at("dispersion.root_second_moment_variance_kg_m2"), e)
            })?;
        let covariance = file.dispersion.axes_covariance;
        let covariance = Matrix4::from_fn(|i, j| covariance[i][j]);
        let mean = nominal.principal_axes().attitude();
        let axes = RadiallyConstrainedGaussian::new(mean, covariance)
            .map_err(|e| ScenarioError::field(at("dispersion.axes_covariance"), e))?;
        Ok(Self { nominal, moving: body.moving(state), roots, axes })
    }

    pub(crate) fn nominal(&self) -> &Inertia {
        &self.nominal
    }

    pub(crate) fn moving(&self) -> &MovingBody {
        &self.moving
    }

    pub(crate) fn roots(&self) -> &GaussianRoots {
        &self.roots
    }

    pub(crate) fn axes(&self) -> &RadiallyConstrainedGaussian {
        &self.axes
    }
}
