//! A scenario as it stands in a TOML file.

use gyradius_campaign::{Requirement, Until};
use gyradius_dispersion::{MassPropertiesLaw, ScalarLawForm};
use gyradius_inertia::Region;
use gyradius_separation::{BodyParameter, LoadId, Spring, StackParameter};
use serde::{Deserialize, Serialize};

use super::{
    ScenarioError,
    as_given::AsGiven,
    each::Each,
    follows::Follows,
    frame::framed_file,
    law::{GivenLaw, VectorLawFile},
    load::{self, GivenLoad, LoadFile},
    model_file::ModelFile,
    scalar::ScalarLawFile,
};

framed_file! {
    /// A scenario as it stands in a TOML file, defaults filled in. Units are in the names.
    ScenarioFile, LOOK_EVERY, {
        #[serde(default = "default_spin_axis")]
        pub(crate) spin_axis: [f64; 3],
        /// Inertial axes; the force of the springs at the start if not given.
        pub(crate) separation_direction: Option<[f64; 3]>,
        /// Inertial axes; the spin axis at the start if not given.
        pub(crate) momentum_direction: Option<[f64; 3]>,
        pub(crate) payload: BodyFile,
        pub(crate) stage: BodyFile,
        pub(crate) stack: Option<StackFile>,
        #[serde(default)]
        pub(crate) integration: IntegrationFile,
        pub(crate) source: Option<SourceFile>,
        pub(crate) clearance: Option<ClearanceFile>,
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        pub(crate) springs: Vec<LoadFile<Spring>>,
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        pub(crate) correlations: Vec<CorrelationFile>,
        pub(crate) models: Vec<ModelFile>,
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        pub(crate) requirements: Vec<Requirement>,
        #[serde(default)]
        pub(crate) comparisons: Vec<ComparisonFile>,
    }
}

pub(super) const VARIANCE: &str = "root_second_moment_variance_kg_m2";
pub(super) const COVARIANCE: &str = "root_second_moment_covariance_kg_m2";
pub(super) const BOUNDS: &str = "root_second_moment_bounds_sqrt_kg_m";
pub(super) const SAMPLES: &str = "root_second_moment_samples_sqrt_kg_m";
pub(super) const LAWS: &str = "root_second_moment_laws_sqrt_kg_m";
pub(super) const LENGTHS: &str = "gyration_lengths_m";
pub(super) const INSIDE: &str = "inside";
pub(super) const FOLLOWS: &str = "inertia_follows_mass";

/// Runs between looks, if nothing is said: some hundredths of a second.
const LOOK_EVERY: u64 = 1000;

impl ScenarioFile {
    /// The loads between the bodies and which they are, kind by kind, in the order of the fields that hold them.
    pub(crate) fn loads(&self) -> impl Iterator<Item = (LoadId, &dyn GivenLoad)> {
        load::given(&self.springs)
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct BodyFile {
    pub(crate) mass_kg: f64,
    pub(crate) inertia_kg_m2: [[f64; 3]; 3],
    pub(crate) position_m: [f64; 3],
    #[serde(default)]
    pub(crate) velocity_m_per_s: [f64; 3],
    /// Scalar last; takes body components to inertial components.
    #[serde(default = "default_attitude")]
    pub(crate) body_to_inertial: [f64; 4],
    #[serde(default)]
    pub(crate) angular_velocity_rad_per_s: [f64; 3],
    #[serde(default)]
    pub(crate) dispersion: DispersionFile,
    /// Of mass, mass centre and inertia, in the place of what the dispersion says of them.
    pub(crate) law: Option<AsGiven<MassPropertiesLaw>>,
}

/// A law of the roots and one of the axes; which fields go with which law is checked later, so that
/// the message can say it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct DispersionFile {
    /// For what the inertia is drawn, whichever the model.
    #[serde(default, skip_serializing_if = "Each::is_flight")]
    pub(crate) inertia_drawn: Each,
    /// Filled in unless gyration lengths or a whole law say it.
    pub(crate) roots: Option<RootsFile>,
    pub(crate) root_second_moment_variance_kg_m2: Option<[f64; 3]>,
    pub(crate) root_second_moment_covariance_kg_m2: Option<[[f64; 3]; 3]>,
    pub(crate) root_second_moment_bounds_sqrt_kg_m: Option<[[f64; 2]; 3]>,
    pub(crate) root_second_moment_samples_sqrt_kg_m: Option<Vec<[f64; 3]>>,
    /// Of the roots themselves, not of changes.
    pub(crate) root_second_moment_laws_sqrt_kg_m: Option<[ScalarLawForm; 3]>,
    /// Of changes from the nominal lengths, m.
    pub(crate) gyration_lengths_m: Option<[ScalarLawForm; 3]>,
    /// Filled in unless a whole law says it.
    pub(crate) axes: Option<AxesLawFile>,
    pub(crate) axes_covariance: Option<[[f64; 4]; 4]>,
    /// Where the matter is, body axes.
    pub(crate) inside: Option<AsGiven<Region>>,
    pub(crate) mass_kg: Option<ScalarLawFile>,
    pub(crate) mass_percent: Option<ScalarLawFile>,
    #[serde(default, skip_serializing_if = "Follows::not_at_all")]
    pub(crate) inertia_follows_mass: Option<Follows>,
    pub(crate) mass_centre_m: Option<VectorLawFile>,
    pub(crate) position_m: Option<VectorLawFile>,
    pub(crate) velocity_m_per_s: Option<VectorLawFile>,
    pub(crate) attitude_deg: Option<VectorLawFile>,
    pub(crate) angular_velocity_rad_per_s: Option<VectorLawFile>,
}

/// The two bodies as long as they are one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StackFile {
    pub(crate) dispersion: Option<StackDispersionFile>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StackDispersionFile {
    pub(crate) attitude_deg: Option<VectorLawFile>,
    pub(crate) angular_velocity_rad_per_s: Option<VectorLawFile>,
}

/// One coefficient for every pair of those named.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CorrelationFile {
    pub(crate) between: Vec<String>,
    pub(crate) coefficient: f64,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum RootsFile {
    #[default]
    Gaussian,
    CorrelatedGaussian,
    Uniform,
    Lognormal,
    TruncatedGaussian,
    Independent,
    Empirical,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum AxesLawFile {
    #[default]
    RadiallyConstrainedGaussian,
    Uniform,
    Fixed,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ClearanceFile {
    #[serde(default = "default_coast")]
    pub(crate) coast_s: f64,
    pub(crate) payload: Vec<ShapeFile>,
    pub(crate) stage: Vec<ShapeFile>,
}

/// As given: what is made of it need not have the same bits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", try_from = "ShapeTable")]
pub(crate) enum ShapeFile {
    PointsM(Vec<[f64; 3]>),
    HullM(Vec<[f64; 3]>),
    Ring { centre_m: [f64; 3], axis: [f64; 3], radius_m: f64 },
}

/// As it is read: an enum would not name a key that it does not know.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ShapeTable {
    points_m: Option<Vec<[f64; 3]>>,
    hull_m: Option<Vec<[f64; 3]>>,
    ring: Option<RingFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RingFile {
    centre_m: [f64; 3],
    axis: [f64; 3],
    radius_m: f64,
}

impl TryFrom<ShapeTable> for ShapeFile {
    type Error = &'static str;

    fn try_from(table: ShapeTable) -> Result<Self, Self::Error> {
        match (table.points_m, table.hull_m, table.ring) {
            (Some(points), None, None) => Ok(Self::PointsM(points)),
            (None, Some(points), None) => Ok(Self::HullM(points)),
            (None, None, Some(RingFile { centre_m, axis, radius_m })) => {
                Ok(Self::Ring { centre_m, axis, radius_m })
            }
            _ => Err("there must be exactly one of points_m, hull_m, ring"),
        }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct IntegrationFile {
    pub(crate) relative_tolerance: f64,
    pub(crate) horizon_s: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ComparisonFile {
    pub(crate) title: String,
    pub(crate) physical: String,
    pub(crate) naive: String,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SourceFile {
    pub(crate) title: String,
    pub(crate) inertia_ratio: Option<f64>,
    pub(crate) wobble_deg: Option<f64>,
}

impl Default for IntegrationFile {
    fn default() -> Self {
        let settings = gyradius_separation::Settings::default();
        Self { relative_tolerance: settings.relative_tolerance(), horizon_s: settings.horizon_s() }
    }
}

fn default_coast() -> f64 {
    60.0
}

fn default_spin_axis() -> [f64; 3] {
    [1.0, 0.0, 0.0]
}

fn default_attitude() -> [f64; 4] {
    [0.0, 0.0, 0.0, 1.0]
}

impl DispersionFile {
    /// Fills in what is not said, unless a whole law says it.
    pub(crate) fn fill(&mut self, law: Option<&AsGiven<MassPropertiesLaw>>) {
        if law.is_some() {
            return;
        }
        if self.gyration_lengths_m.is_none() {
            self.roots.get_or_insert_default();
        }
        self.axes.get_or_insert_default();
    }

    /// The keys that say something of the roots, and whether they are given.
    fn of_roots(&self) -> [(&'static str, bool); 6] {
        [
            ("roots", self.roots.is_some()),
            (VARIANCE, self.root_second_moment_variance_kg_m2.is_some()),
            (COVARIANCE, self.root_second_moment_covariance_kg_m2.is_some()),
            (BOUNDS, self.root_second_moment_bounds_sqrt_kg_m.is_some()),
            (SAMPLES, self.root_second_moment_samples_sqrt_kg_m.is_some()),
            (LAWS, self.root_second_moment_laws_sqrt_kg_m.is_some()),
        ]
    }

    /// A key of the roots other than that of their kind that is given and that a kind does not take.
    pub(crate) fn not_taken(&self, takes: &[&str]) -> Option<&'static str> {
        let [_, others @ ..] = self.of_roots();
        let not = others.into_iter().find(|(key, given)| *given && !takes.contains(key));
        not.map(|(key, _)| key)
    }

    /// A key that is given and says what gyration lengths say.
    pub(crate) fn beside_lengths(&self) -> Option<&'static str> {
        let wholly = |follows: Follows| follows.share() == 1.0;
        let follows = (FOLLOWS, self.inertia_follows_mass.is_some_and(|own| !wholly(own)));
        self.of_roots().into_iter().chain([follows]).find(|(_, given)| *given).map(|(key, _)| key)
    }

    /// A key that is given and says what a whole law of mass, mass centre and inertia says.
    pub(crate) fn beside_law(&self) -> Option<&'static str> {
        let others = [
            (LENGTHS, self.gyration_lengths_m.is_some()),
            ("axes", self.axes.is_some()),
            ("axes_covariance", self.axes_covariance.is_some()),
            (INSIDE, self.inside.is_some()),
            ("mass_kg", self.mass_kg.is_some()),
            ("mass_percent", self.mass_percent.is_some()),
            (FOLLOWS, self.inertia_follows_mass.is_some()),
            ("mass_centre_m", self.mass_centre_m.is_some()),
        ];
        self.of_roots().into_iter().chain(others).find(|(_, given)| *given).map(|(key, _)| key)
    }

    /// A key that is given and says something that depends on the nominal mass.
    pub(crate) fn needs_mass(&self) -> Option<&'static str> {
        let keys = [
            (LENGTHS, self.gyration_lengths_m.is_some()),
            (INSIDE, self.inside.is_some()),
            ("mass_kg", self.mass_kg.is_some()),
            ("mass_percent", self.mass_percent.is_some()),
        ];
        keys.into_iter().find(|(_, given)| *given).map(|(key, _)| key)
    }

    pub(crate) fn given(&self, parameter: BodyParameter) -> GivenLaw<'_> {
        let vector = match parameter {
            BodyParameter::Mass => {
                return GivenLaw::Number(self.mass_kg.as_ref(), self.mass_percent.as_ref());
            }
            BodyParameter::MassCentre => &self.mass_centre_m,
            BodyParameter::Position => &self.position_m,
            BodyParameter::Velocity => &self.velocity_m_per_s,
            BodyParameter::Attitude => &self.attitude_deg,
            BodyParameter::AngularVelocity => &self.angular_velocity_rad_per_s,
        };
        GivenLaw::Vector(vector.as_ref())
    }
}

impl StackDispersionFile {
    pub(crate) fn given(&self, parameter: StackParameter) -> GivenLaw<'_> {
        let vector = match parameter {
            StackParameter::Attitude => &self.attitude_deg,
            StackParameter::AngularVelocity => &self.angular_velocity_rad_per_s,
        };
        GivenLaw::Vector(vector.as_ref())
    }
}
