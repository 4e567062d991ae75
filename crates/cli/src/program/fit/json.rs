//! The report of a fit as JSON.

use gyradius_dispersion::EntryMoments;
use gyradius_estimation::{Aspect, Assessment, AxesFinding, PrincipalFit, RootEstimate};
use gyradius_study::Fragment;
use serde::Serialize;

use super::{
    FitArgs,
    joint::{Joint, JointJson},
    table::Table,
};

/// Grows when a field changes its meaning or goes; new fields may come without it.
const SCHEMA: u32 = 1;

#[derive(Serialize)]
struct Document {
    schema: u32,
    version: &'static str,
    file: String,
    samples: usize,
    set_aside: usize,
    rounded: usize,
    unused_columns: Vec<String>,
    unread: Vec<String>,
    matching: MatchingJson,
    roots: Vec<RootJson>,
    axes: AxesJson,
    nominal_inertia_kg_m2: [[f64; 3]; 3],
    entry_deviation_kg_m2: DeviationJson,
    fits: bool,
    p_value: f64,
    verdict: String,
    tests: Vec<TestJson>,
    notes: Vec<String>,
    fragment: FragmentJson,
    #[serde(skip_serializing_if = "Option::is_none")]
    joint: Option<JointJson>,
}

#[derive(Serialize)]
struct MatchingJson {
    reordered: usize,
    turned_round: usize,
    doubtful: usize,
    converged: bool,
}

#[derive(Serialize)]
struct RootJson {
    law: &'static str,
    mean_sqrt_kg_m: f64,
    deviation_sqrt_kg_m: f64,
    mean_error_sqrt_kg_m: Option<f64>,
    deviation_error_sqrt_kg_m: Option<f64>,
}

#[derive(Serialize)]
struct AxesJson {
    finding: &'static str,
    /// Scalar last.
    mean: [f64; 4],
    mean_covariance_rad2: Option<[[f64; 3]; 3]>,
    turn_covariance_rad2: [[f64; 3]; 3],
    turn_covariance_errors_rad2: Option<[[f64; 3]; 3]>,
    second_lobe: Option<f64>,
    converged: bool,
}

/// Order 11, 22, 33, 12, 13, 23.
#[derive(Serialize)]
struct DeviationJson {
    samples: [f64; 6],
    fit: [f64; 6],
}

#[derive(Serialize)]
struct TestJson {
    aspect: String,
    p_value: f64,
    resolution: f64,
}

#[derive(Serialize)]
pub(crate) struct FragmentJson {
    body: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    mass_kg: Option<f64>,
    inertia_kg_m2: [[f64; 3]; 3],
    /// Null where the roots are correlated.
    root_second_moment_variance_kg_m2: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    root_second_moment_covariance_kg_m2: Option<[[f64; 3]; 3]>,
    axes_covariance: [[f64; 4]; 4],
    #[serde(skip_serializing_if = "Option::is_none")]
    mass_percent: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    inertia_follows_mass: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mass_centre_m: Option<[f64; 3]>,
    toml: String,
}

impl FragmentJson {
    pub(crate) fn of(body: &str, fragment: &Fragment) -> Self {
        Self {
            body: body.to_owned(),
            mass_kg: fragment.nominal_mass(),
            inertia_kg_m2: fragment.inertia(),
            root_second_moment_variance_kg_m2: fragment.root_variances(),
            root_second_moment_covariance_kg_m2: fragment.root_covariance(),
            axes_covariance: fragment.axes_covariance(),
            mass_percent: fragment.mass().map(|(percent, _)| percent),
            inertia_follows_mass: fragment.mass().map(|(_, share)| share),
            mass_centre_m: fragment.mass_centre(),
            toml: fragment.to_string(),
        }
    }
}

/// One object, described in docs/fit.md.
pub(super) fn text(
    arguments: &FitArgs,
    table: &Table,
    fit: &PrincipalFit,
    moments: &EntryMoments,
    assessment: &Assessment,
    fragment: &Fragment,
    joint: Option<&Joint>,
) -> serde_json::Result<String> {
    let rows = |m: nalgebra::Matrix3<f64>| -> [[f64; 3]; 3] {
        std::array::from_fn(|i| std::array::from_fn(|j| m[(i, j)]))
    };
    let matching = fit.matching();
    let axes = fit.axes();
    let document = Document {
        schema: SCHEMA,
        version: env!("CARGO_PKG_VERSION"),
        file: arguments.table().display().to_string(),
        samples: fit.count(),
        set_aside: table.aside,
        rounded: table.rounded,
        unused_columns: table.unused.clone(),
        unread: table.unread.clone(),
        matching: MatchingJson {
            reordered: matching.swapped,
            turned_round: matching.flipped,
            doubtful: matching.doubtful,
            converged: matching.converged,
        },
        roots: fit
            .roots()
            .iter()
            .map(|root| RootJson {
                law: match root.law() {
                    RootEstimate::Gaussian => "gaussian",
                    RootEstimate::Folded => "folded-gaussian",
                    RootEstimate::Constant => "constant",
                    _ => "other",
                },
                mean_sqrt_kg_m: root.mean(),
                deviation_sqrt_kg_m: root.deviation(),
                mean_error_sqrt_kg_m: root.errors().map(|e| e[0]),
                deviation_error_sqrt_kg_m: root.errors().map(|e| e[1]),
            })
            .collect(),
        axes: AxesJson {
            finding: match axes.finding() {
                AxesFinding::Determined => "determined",
                AxesFinding::Still => "still",
                AxesFinding::FreeTurn { axis: 1 } => "free-turn-about-1",
                AxesFinding::FreeTurn { axis: 2 } => "free-turn-about-2",
                AxesFinding::FreeTurn { .. } => "free-turn-about-3",
                AxesFinding::Free => "free",
                _ => "other",
            },
            mean: axes.law().mean().coords.into(),
            mean_covariance_rad2: axes.mean_covariance().map(rows),
            turn_covariance_rad2: rows(axes.turn_covariance()),
            turn_covariance_errors_rad2: axes.turn_errors().map(rows),
            second_lobe: axes.second_lobe(),
            converged: axes.converged(),
        },
        nominal_inertia_kg_m2: (*fit.nominal()).into(),
        entry_deviation_kg_m2: DeviationJson {
            samples: fit.sample_deviations(),
            fit: moments.deviations(),
        },
        fits: assessment.fits(),
        p_value: assessment.p_value(),
        verdict: assessment.to_string(),
        tests: assessment
            .tests()
            .iter()
            .map(|test| TestJson {
                aspect: match test.aspect() {
                    Aspect::Root { axis } => format!("root-{axis}"),
                    Aspect::Roots => "roots-independent".to_owned(),
                    Aspect::Axes => "axes".to_owned(),
                    Aspect::Turn => "turn".to_owned(),
                    Aspect::Tilt => "tilt".to_owned(),
                    Aspect::RootsAndAxes => "roots-and-axes-independent".to_owned(),
                    Aspect::Entries => "entries".to_owned(),
                    _ => "other".to_owned(),
                },
                p_value: test.p_value(),
                resolution: test.resolution(),
            })
            .collect(),
        notes: fit.notes().iter().map(ToString::to_string).collect(),
        fragment: FragmentJson::of(
            &gyradius_study::FragmentBody::from(arguments.fragment.body).to_string(),
            fragment,
        ),
        joint: joint.map(Joint::json),
    };
    serde_json::to_string_pretty(&document)
}
