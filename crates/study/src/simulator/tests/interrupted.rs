//! Studies that were interrupted: what is told of them, and that a report of them changes nothing of what may follow.

use gyradius_campaign::{RunInputs, SimulatorFunction};
use proptest::prelude::*;
use std::{
    fs,
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
};

use super::{
    BODY, MODELS, SimulatorScenario, files, folder,
    function::{COMMAND, FUNCTION, answer},
    scenario, uniform,
};
use crate::{CampaignError, Options, Status, StudyError, put_together};

/// Flights of a vehicle, where there are vehicles.
const FLIGHTS: u64 = 5;

/// A scenario of so many runs that waits for a function, of one model or of two, with so many flights of each vehicle or without vehicles;
/// with more keys, and more tables.
pub(super) fn waiting(
    folder: &Path,
    models: bool,
    (runs, flights): (u64, Option<u64>),
    [keys, tables]: [&str; 2],
) -> SimulatorScenario {
    let mut text = uniform().replace(COMMAND, FUNCTION);
    if models {
        text += "\n[[bodies]]\nname = \"hub\"";
        text += &(BODY.replace("DISPERSION", "mass_percent = 1.0") + MODELS);
    }
    let size = match flights {
        Some(flights) => format!("vehicles = {}\nflights = {flights}", runs.div_ceil(flights)),
        None => format!("runs = {runs}"),
    };
    let text = text.replace("runs = 300", &size);
    scenario(&format!("{keys}\n{text}{tables}"), folder)
}

/// Does runs with a function on one thread until so many were begun, and is stopped then; whether it was, or was done before.
pub(super) fn interrupted(
    waiting: &SimulatorScenario,
    function: SimulatorFunction,
    out: &Path,
    after: u64,
) -> bool {
    let (stop, calls) = (Arc::new(AtomicBool::new(false)), AtomicU64::new(0));
    let own = Arc::clone(&stop);
    let function = SimulatorFunction::new(move |run: &RunInputs<'_>| {
        own.fetch_or(calls.fetch_add(1, Ordering::Relaxed) + 1 >= after, Ordering::Relaxed);
        function.run(run)
    });
    let options = Options { stop: Some(stop), threads: Some(1), ..Options::to(out.to_owned()) };
    let scenario = waiting.clone().with_function(function).unwrap();
    match scenario.study(&options, &|_| {}, &|_| {}) {
        Ok(_) => false,
        Err(StudyError::Campaign(CampaignError::Stopped)) => true,
        Err(other) => panic!("{other}"),
    }
}

fn interrupt(waiting: &SimulatorScenario, out: &Path, after: u64) {
    assert!(interrupted(waiting, answer(), out, after));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Interrupted anywhere, of one model or two, with vehicles or without: a report of runs that a rule is to end says how many runs are there
    /// of every model, and counts the looks at these.
    #[test]
    fn a_report_meanwhile_counts_what_is_there(
        models: bool,
        vehicles: bool,
        after in 1_u64..2500,
        look_every in prop::sample::select(vec![50_u64, 255, 520]),
    ) {
        let folder = folder();
        let out = folder.path().join("out");
        let until = format!("\n[until]\nrule = \"mean(y) within 0.00001\"\nlook_every = {}\n", look_every / FLIGHTS * FLIGHTS);
        let flights = vehicles.then_some(FLIGHTS);
        let waiting = waiting(folder.path(), models, (3000, flights), ["", &until]);
        interrupt(&waiting, &out, after);
        let Ok(status) = Status::read(&out) else {
            // No block was finished, and nothing is left.
            prop_assert!(!out.exists());
            return Ok(());
        };
        let first_missing = status.missing.iter().map(|missing| missing.range().start).min().unwrap();
        let put = put_together(&out, &Options::default(), &|_| {});
        if status.models.iter().any(|model| model.finished == 0) {
            prop_assert!(matches!(put, Err(StudyError::Absent { .. })), "{put:?}");
        } else {
            put.unwrap();
            let summary = fs::read_to_string(out.join("summary.json")).unwrap();
            let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
            let looks = waiting.until().unwrap().looks().filter(|look| *look <= first_missing).count();
            let ended = &summary["ended"];
            prop_assert_eq!((&ended["runs"], &ended["looks"]), (&first_missing.into(), &looks.into()));
            let page = fs::read_to_string(out.join("report.md")).unwrap();
            let told = format!("so far there are {first_missing} of every model");
            prop_assert!(page.contains(&told), "{}", page);
        }
    }

    /// Whether a report was made of an interrupted study or not, in an empty folder or beside a complete study: the same numbers of runs go
    /// on, with the same results, and the others are refused for the same reason.
    #[test]
    fn a_report_meanwhile_changes_nothing_of_what_may_follow(
        complete in prop::option::of(Just(300_u64)),
        vehicles: bool,
        after in 1_u64..1000,
        runs in prop::sample::select(vec![200_u64, 300, 400, 520, 900, 3000]),
    ) {
        let folder = folder();
        let flights = vehicles.then_some(FLIGHTS);
        let given = |runs: u64| {
            waiting(folder.path(), false, (runs, flights), ["", ""]).with_function(answer()).unwrap()
        };
        let out = folder.path().join("out");
        let follow = |report: bool| {
            let options = Options { threads: Some(1), ..Options::to(out.clone()) };
            if let Some(complete) = complete {
                given(complete).study(&options, &|_| {}, &|_| {}).unwrap();
            }
            interrupt(&waiting(folder.path(), false, (3000, flights), ["", ""]), &out, after);
            if report {
                // There may be no block yet.
                let _ = put_together(&out, &options, &|_| {});
            }
            let followed = given(runs).study(&options, &|_| {}, &|_| {});
            let told = followed.map(|_| files(&out.join("runs"))).map_err(|error| error.to_string());
            fs::remove_dir_all(&out).unwrap();
            told
        };
        prop_assert_eq!(follow(false), follow(true));
    }
}
