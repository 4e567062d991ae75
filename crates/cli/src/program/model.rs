//! `gyradius model`: a nominal inertia and plain statements, and what they come to.

use gyradius_dispersion::{MassPropertiesLaw, TenMoments, TenParameters, TenSpread, TenSums};
use gyradius_estimation::{
    AxesStatement, CentreStatement, MassStatement, MomentsStatement, ProductsStatement, StatedBody,
    StatedModel, Statements,
};
use gyradius_formats::read_text;
use gyradius_inertia::{Inertia, InertiaMatrix, MassProperties, Region};
use gyradius_study::{Fragment, FragmentBody, parse_toml};
use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use serde::{Deserialize, Serialize};
use std::{error::Error, fmt::Write};

use crate::program::{
    args::ModelArgs,
    fit::{FragmentJson, wrapped},
    number::{short, with_error},
    output,
};

/// Bytes of the largest file that is read: such files have a few lines.
const MAX_BYTES: u64 = 1 << 20;

/// The file. Its parts check themselves.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Stated {
    nominal: Nominal,
    moments: Option<MomentsStatement>,
    products: Option<ProductsStatement>,
    axes: Option<AxesStatement>,
    mass: Option<MassStatement>,
    centre: Option<CentreStatement>,
    inside: Option<Region>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Nominal {
    inertia_kg_m2: Option<[[f64; 3]; 3]>,
    radii_of_gyration_m: Option<[f64; 3]>,
    mass_kg: Option<f64>,
    mass_centre_m: Option<[f64; 3]>,
}

/// What the statements come to.
#[derive(Debug)]
struct Told {
    model: StatedModel,
    /// Mass, mass centre and inertia together, where there is a nominal mass.
    body: Option<StatedBody>,
}

/// Grows when a field changes its meaning or goes; new fields may come without it.
const SCHEMA: u32 = 1;

/// Entries in the order 11, 22, 33, 12, 13, 23.
#[derive(Serialize)]
struct Document {
    schema: u32,
    version: &'static str,
    nominal_kg_m2: [f64; 6],
    stated_deviation_kg_m2: [Option<f64>; 6],
    implied_deviation_kg_m2: [f64; 6],
    implied_mean_kg_m2: [f64; 6],
    implied_covariance_kg2_m4: [[f64; 6]; 6],
    /// About the principal axes; null where any turn is.
    turn_deviation_rad: [Option<f64>; 3],
    warnings: Vec<String>,
    fragment: FragmentJson,
    /// The joint law of mass, mass centre and inertia; null without a nominal mass.
    law: Option<LawJson>,
}

/// Ten numbers in the order of the columns.
#[derive(Serialize)]
struct LawJson {
    columns: [&'static str; 10],
    mean: Option<[f64; 10]>,
    deviation: Option<[f64; 10]>,
    covariance: Option<[[f64; 10]; 10]>,
    /// Standard errors where draws are kept to a region, of which these are estimates; null where they are exact.
    mean_error: Option<[f64; 10]>,
    deviation_error: Option<[f64; 10]>,
    /// The share of draws that the region keeps, and its standard error; 1 and 0 without one.
    acceptance: [f64; 2],
    mass_properties_law: serde_json::Value,
}

/// Runs the verb.
pub(crate) fn model(arguments: &ModelArgs) -> Result<(), Box<dyn Error>> {
    let file = arguments.file.display();
    let text = read_text(&arguments.file, MAX_BYTES)
        .map_err(|error| format!("cannot read {file}: {error}"))?;
    let told = stated(&text).map_err(|error| format!("{file}: {error}"))?;
    let body = FragmentBody::from(arguments.fragment.body);
    let fragment = fragment(body, &told).map_err(|error| format!("{file}: {error}"))?;
    let json = || json(&told, body, &fragment);
    output::write(
        &arguments.fragment,
        &arguments.file,
        &report(arguments, &told),
        &json,
        &fragment,
    )?;
    Ok(())
}

/// What the text of a file states; an error names the key.
fn stated(text: &str) -> Result<Told, String> {
    let Stated { nominal, moments, products, axes, mass, centre, inside } =
        parse_toml(text).map_err(|error| error.to_string())?;
    let Nominal { inertia_kg_m2, radii_of_gyration_m, mass_kg, mass_centre_m } = nominal;
    let (key, rows) = match (inertia_kg_m2, radii_of_gyration_m, mass_kg) {
        (Some(rows), None, _) => ("inertia_kg_m2", rows),
        (None, Some(radii), Some(mass)) => ("radii_of_gyration_m", of_radii(mass, radii)?),
        (None, Some(_), None) => {
            return Err("nominal.radii_of_gyration_m: it needs nominal.mass_kg".to_owned());
        }
        (Some(_), Some(_), _) | (None, None, _) => {
            return Err("nominal: it must have inertia_kg_m2, or mass_kg and radii_of_gyration_m, and not both".to_owned());
        }
    };
    if mass_kg.is_none() && mass_centre_m.is_some() {
        return Err("nominal.mass_centre_m: it needs nominal.mass_kg".to_owned());
    }
    let inertia = Inertia::try_from(rows).map_err(|error| format!("nominal.{key}: {error}"))?;
    let statements = Statements { moments, products, axes, mass, centre };
    let model = statements
        .check(&inertia, mass_kg)
        .and_then(|()| statements.model(&inertia, mass_kg))
        .map_err(|error| error.to_string())?;
    let nominal = mass_kg.map(|mass| {
        MassProperties::new(mass, mass_centre_m.unwrap_or_default(), inertia)
            .map_err(|error| format!("nominal.mass_centre_m: {error}"))
    });
    let body = nominal
        .transpose()?
        .map(|nominal| StatedBody::of(model.clone(), &nominal).map_err(|error| error.to_string()));
    let mut body = body.transpose()?;
    if let Some(region) = inside {
        let open = body.take().ok_or("inside: it needs nominal.mass_kg")?;
        body = Some(open.inside(region).map_err(|error| format!("inside: {error}"))?);
    }
    Ok(Told { model, body })
}

/// The inertia of a mass with these radii of gyration about the body axes, m k².
fn of_radii(mass_kg: f64, radii: [f64; 3]) -> Result<[[f64; 3]; 3], String> {
    if let Some(radius) = radii.iter().find(|radius| !(**radius >= 0.0 && radius.is_finite())) {
        return Err(format!(
            "nominal.radii_of_gyration_m: {radius:?}: it must be a finite number, and not negative"
        ));
    }
    if !(mass_kg > 0.0 && mass_kg.is_finite()) {
        return Err(format!(
            "nominal.mass_kg: {mass_kg:?}: it must be a finite number, and positive"
        ));
    }
    let mut rows = [[0.0; 3]; 3];
    for (axis, radius) in radii.into_iter().enumerate() {
        rows[axis][axis] = mass_kg * radius * radius;
    }
    Ok(rows)
}

/// The nominal mass, the inertia at it, the mass that it goes with, the mass centre, and the region, from the nominal mass
/// centre.
fn fragment(
    body: FragmentBody,
    Told { model, body: stated }: &Told,
) -> Result<Fragment, Box<dyn Error>> {
    let mut fragment = Fragment::new(body, model.nominal(), model.law_at_nominal_mass())?;
    if let Some(stated) = stated {
        fragment = fragment.with_nominal_mass(stated.nominal().mass_kg())?;
    }
    if let Some(mass) = model.mass() {
        let percent = 100.0 * mass.relative_deviation();
        fragment = fragment.with_mass(percent, mass.inertia_follows())?;
    }
    if let Some(metres) = model.centre_deviations() {
        fragment = fragment.with_mass_centre(metres)?;
    }
    let region = stated.as_ref().and_then(|body| Some((body.nominal(), body.law().region()?)));
    if let Some((nominal, region)) = region {
        let back = Translation3::from(-nominal.mass_centre_m());
        let by = Isometry3::from_parts(back, UnitQuaternion::identity());
        fragment = fragment.with_inside(region.transformed(&by)?);
    }
    Ok(fragment)
}

fn report(arguments: &ModelArgs, told: &Told) -> String {
    let mut out = String::new();
    let file = arguments.file.file_name().unwrap_or_default().to_string_lossy();
    // Writing to a string does not fail.
    let _ = write_report(&mut out, &file, told);
    out
}

fn write_report(out: &mut String, file: &str, Told { model, body }: &Told) -> std::fmt::Result {
    writeln!(out, "Made by gyradius {} of the statements in {file}\n", env!("CARGO_PKG_VERSION"))?;
    writeln!(out, "kg·m²          nominal    deviation: stated    implied    correlations")?;
    let nominal = model.nominal().entries();
    let deviations = model.implied().deviations();
    let covariance = model.implied().covariance();
    for (e, name) in InertiaMatrix::ENTRY_NAMES.iter().enumerate() {
        let stated = model.stated()[e].map_or_else(|| "-".to_owned(), short);
        let [nominal, implied] = [nominal[e], deviations[e]].map(short);
        write!(out, "  {name}{nominal:>17}{stated:>21}{implied:>11}")?;
        for f in 0..e {
            let space = if f == 0 { "    " } else { " " };
            let scale = deviations[e] * deviations[f];
            let r = if scale > 0.0 { covariance[(e, f)] / scale } else { 0.0 };
            // No sign before what rounds to zero.
            let r = if r.abs() < 0.005 { 0.0 } else { r };
            write!(out, "{space}{r:>5.2}")?;
        }
        writeln!(out)?;
    }
    write!(out, "\nturns about principal axes 1, 2, 3 (1σ):")?;
    for (i, turn) in model.turns().iter().enumerate() {
        out.push_str(if i == 0 { " " } else { ", " });
        if turn.is_finite() {
            write!(out, "{}°", short(turn.to_degrees()))?
        } else {
            out.push_str("any")
        }
    }
    let roots = model.nominal().second_moments().roots().values();
    let scatter = model.root_deviations();
    // The fragment has those at the nominal mass, beside the mass.
    let follows = model.mass().is_some_and(|mass| mass.inertia_follows() > 0.0);
    let with = if follows { " with what the mass does to them" } else { "" };
    write!(out, "\nroots of the second moments{with}, √kg·m:")?;
    for k in 0..3 {
        let comma = if k == 0 { "" } else { "," };
        write!(out, "{comma} {} ± {}", short(roots[k]), short(scatter[k]))?;
    }
    out.push('\n');
    if let Some(mass) = model.mass() {
        let percent = short(100.0 * mass.relative_deviation());
        let share = short(mass.inertia_follows());
        writeln!(out, "mass: ± {percent} %; the inertia takes {share} of its relative change")?;
    }
    if let Some(centre) = model.centre_deviations() {
        let [x, y, z] = centre.map(|x| short(1e3 * x));
        writeln!(
            out,
            "mass centre: ± {x}, {y}, {z} mm along the body axes, independent of the inertia"
        )?;
    }
    if let Some(law) = body.as_ref().map(StatedBody::law).filter(|law| law.region().is_some()) {
        let (share, error) = law.acceptance();
        let [percent, error_percent] = [share, error].map(|x| short(100.0 * x));
        // An error of none would say that the share is known.
        let possible = if error > 0.0 {
            format!("{percent} ± {error_percent} % are possible")
        } else {
            "all that were tried are possible".to_owned()
        };
        let line = format!(
            "inside: of the draws without the region {possible} for matter there, and only such are drawn; the deviations \
             above are those without it"
        );
        for line in wrapped(&line).into_iter().chain(wrapped(&in_region(law))) {
            writeln!(out, "{line}")?;
        }
    }
    for warning in model.warnings() {
        for line in wrapped(&format!("warning: {warning}")) {
            writeln!(out, "{line}")?;
        }
    }
    Ok(())
}

/// The deviations of draws that are kept to a region.
fn in_region(law: &MassPropertiesLaw) -> String {
    let drawn = law.moments_in_region();
    let Some((drawn, spread)) = drawn.and_then(|drawn| Some((drawn, drawn.spread()?))) else {
        return String::new();
    };
    let size = |i: usize| with_error(spread.deviation[i], Some(spread.deviation_error[i]));
    let list = |range: std::ops::Range<usize>| range.map(size).collect::<Vec<_>>().join(", ");
    format!(
        "deviations with it, by {} draws: mass {} kg; mass centre {} m; moments {} kg·m²; products {} kg·m²",
        drawn.count(),
        list(0..1),
        list(1..4),
        list(4..7),
        list(7..10)
    )
}

fn json(
    Told { model, body: stated }: &Told,
    body: FragmentBody,
    fragment: &Fragment,
) -> serde_json::Result<String> {
    let implied = model.implied();
    let covariance = implied.covariance();
    serde_json::to_string_pretty(&Document {
        schema: SCHEMA,
        version: env!("CARGO_PKG_VERSION"),
        nominal_kg_m2: model.nominal().entries(),
        stated_deviation_kg_m2: model.stated(),
        implied_deviation_kg_m2: implied.deviations(),
        implied_mean_kg_m2: implied.mean(),
        implied_covariance_kg2_m4: std::array::from_fn(|i| {
            std::array::from_fn(|j| covariance[(i, j)])
        }),
        turn_deviation_rad: model.turns().map(|t| t.is_finite().then_some(t)),
        warnings: model.warnings().iter().map(ToString::to_string).collect(),
        fragment: FragmentJson::of(&body.to_string(), fragment),
        law: stated.as_ref().map(law_json).transpose()?,
    })
}

fn law_json(body: &StatedBody) -> serde_json::Result<LawJson> {
    let law = body.law();
    let moments = law.moments();
    let moments = moments.as_ref();
    let drawn = law.moments_in_region();
    let spread = drawn.and_then(TenSums::spread);
    let exact = moments.map(|moments| {
        std::array::from_fn(|i| std::array::from_fn(|j| moments.covariance()[(i, j)]))
    });
    let estimated = spread.as_ref().map(|TenSpread { deviation: d, correlation, .. }| {
        std::array::from_fn(|i| std::array::from_fn(|j| d[i] * d[j] * correlation[i][j]))
    });
    Ok(LawJson {
        columns: TenParameters::COLUMNS,
        mean: moments.map(|m| (*m.mean()).into()).or_else(|| drawn?.mean()),
        deviation: moments.map(TenMoments::deviations).or(spread.as_ref().map(|s| s.deviation)),
        covariance: exact.or(estimated),
        mean_error: spread.as_ref().map(|spread| spread.mean_error),
        deviation_error: spread.as_ref().map(|spread| spread.deviation_error),
        acceptance: law.acceptance().into(),
        mass_properties_law: serde_json::to_value(law)?,
    })
}

#[cfg(test)]
mod tests;
