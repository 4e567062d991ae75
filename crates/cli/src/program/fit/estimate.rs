//! `gyradius fit --estimate`: the realizable laws of an estimate of the ten parameters.

use gyradius_dispersion::MassPropertiesLaw;
use gyradius_estimation::{EstimateDistance, EstimatedBody, TenEstimate, TenForm};
use gyradius_formats::TenMomentsFile;
use nalgebra::{SMatrix, SVector};
use serde::Serialize;
use std::{error::Error, fmt::Write, path::Path};

use super::{FitArgs, report::wrapped};
use crate::program::{
    args::{Form, ParametersArg},
    number::short,
    output,
};

/// Grows when a field changes its meaning or goes; new fields may come without it.
const SCHEMA: u32 = 1;

#[derive(Serialize)]
struct Document {
    schema: u32,
    version: &'static str,
    file: String,
    parameters: TenForm,
    moved: f64,
    nearest: BodyJson,
    joint: Option<LawJson<MassPropertiesLaw>>,
    log_cholesky: Option<LawJson<GaussianJson>>,
}

/// The body of the mean, or the nearest.
#[derive(Serialize)]
struct BodyJson {
    mass_kg: f64,
    mass_centre_m: [f64; 3],
    inertia_kg_m2: [[f64; 3]; 3],
}

#[derive(Serialize)]
struct LawJson<L> {
    law: L,
    exact: bool,
    distance: EstimateDistance,
}

#[derive(Serialize)]
struct GaussianJson {
    mean: [f64; 10],
    covariance: [[f64; 10]; 10],
}

/// Whether both the mean is that of a body, and a law has the moments.
pub(super) fn run(arguments: &FitArgs, path: &Path) -> Result<bool, Box<dyn Error>> {
    let name = path.display();
    let told = |error: &dyn std::fmt::Display| format!("{name}: {error}");
    let file = TenMomentsFile::read(path).map_err(|error| told(&error))?;
    let form = form(arguments.parameters, file.parameters()).map_err(|error| told(&error))?;
    let covariance = SMatrix::from_fn(|i, j| file.covariance()[i][j]);
    let estimate = TenEstimate::new(form, SVector::from(*file.mean()), covariance);
    let estimate = estimate.map_err(|error| told(&error))?;
    let body = EstimatedBody::new(&estimate).map_err(|error| told(&error))?;
    let document = document(path, form, &body);
    let json = serde_json::to_string_pretty(&document)? + "\n";
    let mut text = String::new();
    write_text(&mut text, path, &estimate, &body)?;
    if let Some(target) = output::file_of(arguments.fragment.output.as_deref()) {
        text += &output::write_beside(target, &json, path, arguments.fragment.force)?;
    }
    match arguments.fragment.format {
        Form::Json => output::print_json(&json)?,
        Form::Text => output::print(&text)?,
    }
    let exact = body.log_cholesky().is_some_and(|law| law.1.is_exact())
        || body.joint().is_some_and(|law| law.1.is_exact());
    Ok(exact && body.moved() == 0.0)
}

/// What the ten are: as the command says, or the file.
fn form(asked: Option<ParametersArg>, said: Option<&str>) -> Result<TenForm, String> {
    let of = |word: &str| match word {
        "linear" => Ok(TenForm::Linear),
        "natural" => Ok(TenForm::Natural),
        other => Err(format!("parameters = {other:?}: they are \"linear\" or \"natural\"")),
    };
    match (asked.map(TenForm::from), said.map(of).transpose()?) {
        (Some(asked), Some(said)) if asked != said => {
            let word = |form| match form {
                TenForm::Linear => "linear",
                TenForm::Natural => "natural",
            };
            let (asked, said) = (word(asked), word(said));
            Err(format!(
                "--parameters {asked}, and the file says parameters = {said:?}: it must be one of them, and the \
                 option can be left out"
            ))
        }
        (Some(form), _) | (None, Some(form)) => Ok(form),
        (None, None) => {
            Err("neither the file nor --parameters says whether the ten are linear or natural"
                .to_owned())
        }
    }
}

fn document(path: &Path, parameters: TenForm, body: &EstimatedBody) -> Document {
    let nearest = body.nearest();
    Document {
        schema: SCHEMA,
        version: env!("CARGO_PKG_VERSION"),
        file: path.display().to_string(),
        parameters,
        moved: body.moved(),
        nearest: BodyJson {
            mass_kg: nearest.mass_kg(),
            mass_centre_m: nearest.mass_centre_m().into(),
            inertia_kg_m2: (*nearest.inertia()).into(),
        },
        joint: body.joint().map(|(law, distance)| LawJson {
            law: law.clone(),
            exact: distance.is_exact(),
            distance: *distance,
        }),
        log_cholesky: body.log_cholesky().map(|(law, distance)| {
            let covariance = law.covariance();
            let covariance = std::array::from_fn(|i| std::array::from_fn(|j| covariance[(i, j)]));
            let law = GaussianJson { mean: law.mean(), covariance };
            LawJson { law, exact: distance.is_exact(), distance: *distance }
        }),
    }
}

fn write_text(
    out: &mut String,
    path: &Path,
    estimate: &TenEstimate,
    body: &EstimatedBody,
) -> std::fmt::Result {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    writeln!(out, "Laws by gyradius {} of the estimate in {name}", env!("CARGO_PKG_VERSION"))?;
    let moved = if body.moved() > 0.0 {
        format!(
            "the mean belongs to no body: the nearest is {} standard deviations away, in the metric of the covariance",
            short(body.moved())
        )
    } else {
        "the mean belongs to a body".to_owned()
    };
    for line in wrapped(&moved) {
        writeln!(out, "{line}")?;
    }
    let joint = body.joint().map(|law| law.1);
    let log = body.log_cholesky().map(|law| law.1);
    writeln!(
        out,
        "\n                                  estimate              joint law         log-Cholesky law"
    )?;
    writeln!(
        out,
        "                            mean    deviation      mean  deviation       mean  deviation"
    )?;
    let cell = |value: Option<Option<f64>>, unit: &str| match value.flatten() {
        Some(value) => format!("{value:+.2}{unit}"),
        None => "-".to_owned(),
    };
    for (i, column) in estimate.form().columns().iter().enumerate() {
        let of = |distance: Option<EstimateDistance>| {
            [
                cell(distance.map(|d| d.means()[i]), " σ"),
                cell(distance.map(|d| d.deviation_percents()[i]), " %"),
            ]
        };
        let [a, b] = of(joint);
        let [c, d] = of(log);
        let (mean, deviation) = (short(estimate.mean()[i]), short(estimate.deviations()[i]));
        writeln!(out, "  {column:<20}{mean:>10}{deviation:>13}{a:>10}{b:>11}{c:>11}{d:>11}")?;
    }
    let pair = |of: &dyn Fn(&EstimateDistance) -> f64| {
        [joint, log].map(|d| d.map_or_else(|| "-".to_owned(), |d| short(of(&d))))
    };
    let [a, b] = pair(&EstimateDistance::mahalanobis);
    writeln!(out, "  {:<43}{a:>21}{b:>22}", "Mahalanobis distance of the mean")?;
    let [a, b] = pair(&EstimateDistance::correlation);
    writeln!(out, "  {:<43}{a:>21}{b:>22}", "largest difference of a correlation")?;
    for (name, distance) in [("joint law", joint), ("log-Cholesky law", log)] {
        let said = match distance {
            None => "there is none",
            Some(d) if d.is_exact() => "mean and covariance are those of the estimate",
            Some(_) => {
                "mean and covariance are as near to those of the estimate as was found, see above"
            }
        };
        writeln!(out, "{name}: {said}")?;
    }
    writeln!(out, "the laws themselves: --format json, or -o FILE")
}
