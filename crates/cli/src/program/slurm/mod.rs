//! `gyradius slurm`: the script that does a study on a Slurm cluster.

mod script;
mod shards;

use gyradius_formats::NewFile;
use gyradius_study::{AnyScenario, Fleet, Options};
use std::{
    env,
    error::Error,
    ffi::OsString,
    fs,
    io::{self, Write},
    path::{Path, PathBuf, absolute},
    time::Duration,
};

use crate::program::{
    args::SlurmArgs,
    draw_output::refuse_input,
    output::{file_of, print, say, to_standard_output},
    study::stated,
};
use script::{Limits, Script};
use shards::{LARGEST_ARRAY, choose};

/// Runs the verb, in a program that certain words call.
pub(crate) fn slurm(arguments: &SlurmArgs, called: Vec<OsString>) -> Result<(), Box<dyn Error>> {
    let scenario = stated(&arguments.scenario)?;
    if let Some(file) = arguments.scenario.file() {
        stays(file)?;
    }
    if let Some(problem) = scenario.check_shards()? {
        say(&format!(
            "warning: no run can be done on this machine, nor on any that is like it: {problem}"
        ));
    }
    let script = script(arguments, called, &scenario)?.to_string();
    let Some(path) = file_of(arguments.output.as_deref()) else {
        return Ok(to_standard_output(&script)?);
    };
    if let Some(input) = arguments.scenario.file() {
        refuse_input(path, input)?;
    }
    let mut file = NewFile::create(path, arguments.force)?;
    let written = file.write_all(script.as_bytes());
    written.map_err(|error| format!("cannot write {}: {error}", path.display()))?;
    file.finish()?;
    print(&format!("wrote {}: bash submits it\n", path.display()))?;
    Ok(())
}

fn script(
    arguments: &SlurmArgs,
    called: Vec<OsString>,
    scenario: &AnyScenario,
) -> Result<Script, Box<dyn Error>> {
    let threads = arguments.threads;
    let (shards, forecast) = match (arguments.shards, &arguments.time) {
        // Nothing else depends on the time.
        (Some(shards), Some(_)) => (shards, None),
        (shards, _) => {
            let options = Options { threads: Some(threads as usize), ..Options::default() };
            let forecast = scenario.forecast(&options)?;
            let time_of = |runs: u64| forecast.time_of(runs);
            let Some(total) = forecast.time() else {
                return Err(
                    "--shards and --time: nobody but you knows how long a run of your simulator takes, so that both must be \
                     given, as --shards 20 --time 2:00:00"
                        .into(),
                );
            };
            let least = |shards| scenario.planned_shares(shards).into_iter().min().unwrap_or(0);
            let smallest = |shards| time_of(least(shards)).unwrap_or(total);
            (shards.unwrap_or_else(|| choose(total, &smallest)), Some(forecast))
        }
    };
    let shares = scenario.planned_shares(shards);
    let idle = shares.iter().filter(|runs| **runs == 0).count();
    if idle > 0 {
        return Err(format!(
            "--shards {shards}: runs are done in blocks, and there are {}: no more shards than that",
            shares.len() - idle
        )
        .into());
    }
    if shards > LARGEST_ARRAY {
        say(&format!(
            "{shards} shards: the MaxArraySize of the cluster must be larger (scontrol show config), and is \
             {} where nobody set it",
            LARGEST_ARRAY + 1
        ));
    }
    let models = scenario.models() as u64;
    let largest = shares.into_iter().max().unwrap_or(0);
    let shard_time = forecast.and_then(|forecast| forecast.time_of(largest));
    let limits = match &arguments.time {
        Some(time) => Limits::both(time),
        None => Limits::of(shard_time.unwrap_or(Duration::MAX), scenario.runs() * models),
    };
    let out: PathBuf = place(&arguments.out)?;
    let logs = match &arguments.logs {
        Some(logs) => outside(logs, &arguments.out)?,
        None => beside(&out)?,
    };
    is_folder("--out", &out)?;
    is_folder("--logs", &logs)?;
    Ok(Script {
        name: scenario.name().to_owned(),
        models,
        program: if called.is_empty() { vec![env::current_exe()?.into()] } else { called },
        folder: env::current_dir()?,
        scenario: arguments.scenario.file().map(place).transpose()?,
        runs: scenario.runs(),
        vehicles: scenario.fleet().map(Fleet::vehicles),
        seed: arguments.scenario.seed,
        out,
        logs,
        threads,
        shards,
        shard_time,
        limits,
        max_tasks: arguments.max_tasks,
        partition: arguments.partition.clone(),
        account: arguments.account.clone(),
        mem: arguments.mem.clone(),
    })
}

/// A path that means the same in every folder, without a slash at its end.
fn place(path: &Path) -> io::Result<PathBuf> {
    Ok(absolute(path)?.components().collect())
}

/// That a scenario can be read again by each task.
fn stays(scenario: &Path) -> Result<(), String> {
    // /dev/stdin can be a regular file, and in each task another one.
    let is_of_process = absolute(scenario)
        .is_ok_and(|path| ["/dev", "/proc"].iter().any(|own| path.starts_with(own)));
    if !is_of_process && fs::metadata(scenario).is_ok_and(|there| there.is_file()) {
        return Ok(());
    }
    Err(format!(
        "--scenario {}: each task must read it again, and it is not a file that stays: write the scenario to one first",
        scenario.display()
    ))
}

/// That a place is or can become a folder, as far as is seen from this machine.
fn is_folder(flag: &str, place: &Path) -> Result<(), String> {
    let there = place.ancestors().find(|above| fs::symlink_metadata(above).is_ok());
    match there {
        Some(there) if !there.is_dir() => Err(format!(
            "{flag} {}: {} is not a folder",
            place.display(),
            if there == place { "it".to_owned() } else { there.display().to_string() }
        )),
        _ => Ok(()),
    }
}

/// The folder of the logs that was asked for, which is not in that of the study.
fn outside(logs: &Path, out: &Path) -> Result<PathBuf, Box<dyn Error>> {
    let place_of_logs = place(logs)?;
    if real(&place_of_logs).starts_with(real(&place(out)?)) {
        return Err(format!(
            "--logs {}: it is in the folder of the study, {}, which holds what the study writes and not its logs; name a folder that \
             is not in it, or leave out --logs",
            logs.display(),
            out.display()
        )
        .into());
    }
    Ok(place_of_logs)
}

/// A path without links, as far as its folders are there.
fn real(path: &Path) -> PathBuf {
    let there = path.ancestors().find_map(|above| Some((fs::canonicalize(above).ok()?, above)));
    let below = there.and_then(|(real, above)| Some(real.join(path.strip_prefix(above).ok()?)));
    below.unwrap_or_else(|| path.to_owned())
}

/// The folder of the logs beside that of the study, which belongs to the study.
fn beside(out: &Path) -> Result<PathBuf, String> {
    let name = out.file_name().ok_or_else(|| {
        format!(
            "--out {}: it ends with no name, so that --logs must say where the logs go",
            out.display()
        )
    })?;
    let mut name = name.to_owned();
    name.push("-slurm");
    Ok(out.with_file_name(name))
}
