use serde::{Deserialize, Serialize};

/// A scenario as it stands in a TOML file, defaults filled in. Units are in the names.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ScenarioFile {
    pub(crate) name: String,
    #[serde(default = "default_runs")]
    pub(crate) runs: u64,
    #[serde(default = "default_seed")]
    pub(crate) seed: u64,
    #[serde(default = "default_spin_axis")]
    pub(crate) spin_axis: [f64; 3],
    pub(crate) payload: BodyFile,
    pub(crate) stage: BodyFile,
    #[serde(default)]
    pub(crate) integration: IntegrationFile,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) source: Option<SourceFile>,
    pub(crate) springs: Vec<SpringFile>,
    pub(crate) models: Vec<ModelFile>,
    #[serde(default)]
    pub(crate) comparisons: Vec<ComparisonFile>,
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
    pub(crate) dispersion: DispersionFile,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct DispersionFile {
    pub(crate) root_second_moment_variance_kg_m2: [f64; 3],
    pub(crate) axes_covariance: [[f64; 4]; 4],
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SpringFile {
    pub(crate) stiffness_n_per_m: f64,
    pub(crate) stroke_m: f64,
    pub(crate) payload_point_m: [f64; 3],
    pub(crate) stage_point_m: [f64; 3],
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct IntegrationFile {
    pub(crate) relative_tolerance: f64,
    pub(crate) horizon_s: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ModelFile {
    pub(crate) name: String,
    pub(crate) law: LawFile,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) axes: Option<AxesFile>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) payload_deviation_kg_m2: Option<[[f64; 3]; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) stage_deviation_kg_m2: Option<[[f64; 3]; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) matched_to: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum LawFile {
    Principal,
    Entrywise,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum AxesFile {
    WholeSphere,
    MeanHalf,
    JacobianTwice,
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
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) inertia_ratio: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) wobble_deg: Option<f64>,
}

impl Default for IntegrationFile {
    fn default() -> Self {
        let settings = gyradius_separation::Settings::default();
        Self { relative_tolerance: settings.relative_tolerance(), horizon_s: settings.horizon_s() }
    }
}

fn default_runs() -> u64 {
    2000
}

fn default_seed() -> u64 {
    1
}

fn default_spin_axis() -> [f64; 3] {
    [1.0, 0.0, 0.0]
}

fn default_attitude() -> [f64; 4] {
    [0.0, 0.0, 0.0, 1.0]
}
