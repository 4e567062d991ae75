//! `gyradius fit`: which samples, what is said of the fit, and the exit code.

mod estimate;
mod joint;
mod json;
mod report;
mod table;

use gyradius_dispersion::EntryMoments;
use gyradius_estimation::PrincipalFit;
use gyradius_formats::Products;
use gyradius_study::Fragment;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use std::{error::Error, process::ExitCode};

use crate::program::{
    REFUSED,
    args::FitArgs,
    output::{self, complain},
    progress,
};

pub(crate) use json::FragmentJson;
pub(crate) use report::wrapped;

/// What the program returns when samples speak against the model.
const DOUBTED: u8 = 1;
/// Seed of the simulations behind the verdict: the same table has the same verdict.
pub(super) const SEED: u64 = 2003;

/// Runs the verb.
pub(crate) fn fit(arguments: &FitArgs) -> ExitCode {
    match run(arguments) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(DOUBTED),
        Err(error) => {
            complain(error);
            ExitCode::from(REFUSED)
        }
    }
}

/// Whether nothing speaks against the model.
fn run(arguments: &FitArgs) -> Result<bool, Box<dyn Error>> {
    let products =
        if arguments.flip_products { Products::Integrals } else { Products::TensorEntries };
    if let Some(path) = &arguments.estimate {
        return estimate::run(arguments, path);
    }
    let path = arguments.table();
    let form = arguments.parameters.map(Into::into);
    let table = table::read(path, products, form, arguments.skip_impossible)?;
    let file = path.display();
    let fit = PrincipalFit::new(&table.samples)
        .map_err(|error| table.refused(path, error.sample(), &error))?;
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let assessment = progress::show(fit.simulations(), "simulated tables", |report| {
        fit.assess_with(&mut rng, report)
    });
    let fragment = Fragment::new(arguments.fragment.body.into(), fit.nominal(), fit.law())
        .map_err(|error| format!("{file}: {error}"))?;
    let moments = EntryMoments::of(fit.law());
    let joint = table.bodies.as_deref().map(joint::Joint::new).transpose();
    let joint = joint.map_err(|error| table.refused(path, error.body(), &error))?;
    let mut report = report::text(arguments, &table, &fit, &moments, &assessment);
    report.push_str(&joint.as_ref().map_or_else(String::new, joint::Joint::text));
    let json =
        || json::text(arguments, &table, &fit, &moments, &assessment, &fragment, joint.as_ref());
    output::write(&arguments.fragment, path, &report, &json, &fragment)?;
    Ok(assessment.fits())
}
