//! Studies in which things go wrong.

use gyradius_study::{
    CampaignError, Kept, Options, Quantity, Replay, Rows, Scenario, Study, StudyError, Table,
};
use std::{
    fs,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

fn run(text: &str) -> (Study, tempfile::TempDir) {
    let scratch = tempfile::tempdir().unwrap();
    let scenario = Scenario::from_toml(text).unwrap().with_runs(300).unwrap();
    let options = Options { out: Some(scratch.path().join("study")), ..Options::default() };
    (Study::run(&scenario, &options, &|_| {}).unwrap(), scratch)
}

fn paper() -> String {
    Scenario::peck_2003().unwrap().to_toml()
}

/// A failed run is a row with its reason; it stops nothing and is counted.
#[test]
fn runs_that_fail_are_rows_with_a_reason() {
    // Deviations as large as the moments: many draws cannot even turn.
    let text = paper().replace("[42.8518, 54.3897, 133.1674]", "[5000.0, 54.3897, 133.1674]");
    assert_ne!(text, paper());
    let (study, _scratch) = run(&text);
    let tables = study.tables().unwrap();
    let naive = tables.iter().find(|t| t.model() == "naive").unwrap();
    let failed: Vec<_> = naive.rows().filter(|r| r.status() != "ok").collect();
    assert!((10..290).contains(&failed.len()), "{} failed", failed.len());
    for row in &failed {
        assert!(row.status().starts_with("payload: inertia with principal moments"));
        assert!(row.flag("realizable") == Some(false));
        assert_eq!(Quantity::Cone.in_row(row), None);
        assert!(Quantity::SpinRate.in_row(row).is_none());
    }
    assert_eq!(naive.len(), 300);
    assert_eq!(Quantity::Wobble.in_table(naive).len(), 300 - failed.len());

    let table = study.summary().to_string();
    assert!(table.contains(&format!("naive: {} of 300 runs failed", failed.len())), "{table}");
    let report = fs::read_to_string(study.folder().join("report.html")).unwrap();
    assert!(report.contains(&format!("{} of 300 runs failed", failed.len())));
    let kind = format!("{} × payload: inertia not positive definite", failed.len());
    assert!(report.contains(&kind) && table.contains(&kind), "counted by kind");
    // And those of the other models did not.
    assert!(study.tables().unwrap()[0].rows().all(|r| r.status() == "ok"));
}

/// Where no run succeeds there is nothing to summarise, and the study says so.
#[test]
fn a_study_in_which_everything_fails_still_ends() {
    let (study, _scratch) = run(&paper().replace("horizon_s = 60.0", "horizon_s = 0.001"));
    for table in &study.tables().unwrap() {
        assert!(table.rows().all(|r| r.status().contains("had not let go after 0.001 s")));
    }
    assert!(study.summary().to_string().contains("300 of 300 runs failed"));
}

/// One run, or bodies that do not vary, leave no deviation to speak of.
#[test]
fn a_single_run_and_fixed_bodies_have_no_deviation() {
    let scratch = tempfile::tempdir().unwrap();
    let scenario = Scenario::peck_2003().unwrap().with_runs(1).unwrap();
    let options = Options { out: Some(scratch.path().join("study")), ..Options::default() };
    let study = Study::run(&scenario, &options, &|_| {}).unwrap();
    assert!(study.summary().to_string().contains('–'));

    let fixed = "payload_deviation_kg_m2 = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]";
    let text: String = paper()
        .lines()
        .map(|line| if line.starts_with("payload_deviation") { fixed } else { line })
        .map(|line| format!("{line}\n"))
        .collect();
    let (study, _scratch) = run(&text);
    let tables = study.tables().unwrap();
    let naive = tables.iter().find(|t| t.model() == "naive").unwrap();
    let wobble = Quantity::Wobble.in_table(naive);
    assert!(wobble.iter().all(|w| *w == wobble[0]));
}

/// Texts of the user are text in the report.
#[test]
fn what_users_write_is_escaped() {
    let text = paper().replace("title = \"As published\"", "title = \"<script>alert(1)</script>\"");
    let (study, _scratch) = run(&text);
    let report = fs::read_to_string(study.folder().join("report.html")).unwrap();
    assert!(!report.contains("<script>alert") && report.contains("&lt;script&gt;alert(1)"));
}

/// Outlines that come near and touch again: an outcome of a run, not its failure.
#[test]
fn recontact_is_an_outcome() {
    // An arm of the payload that sweeps towards a plate on the stage as both turn about x.
    let outlines = |reach: f64, plate: f64| {
        format!(
            "[clearance]\ncoast_s = 30.0\n\
             payload = [{{ points_m = [[0.0, {reach:?}, -0.9]] }}]\n\
             stage = [{{ hull_m = [[-{plate:?}, -{plate:?}, 0.5], [{plate:?}, -{plate:?}, 0.5], [0.0, {plate:?}, 0.5]] }}]\n\n"
        )
    };
    let at = |reach: f64, plate: f64| {
        paper().replacen("[payload]", &format!("{}[payload]", outlines(reach, plate)), 1)
    };
    let (study, _scratch) = run(&at(-5.0, 8.0));
    for table in &study.tables().unwrap() {
        assert!(table.rows().all(|r| r.status() == "ok"));
        let (clearance, touch) =
            (Quantity::Clearance.in_table(table), Quantity::RecontactTime.in_table(table));
        assert_eq!(clearance.len(), 300);
        assert_eq!(touch.len(), 300, "the arm turns into the stage");
        assert!(clearance.iter().all(|c| *c == 0.0));
    }
    let report = fs::read_to_string(study.folder().join("report.html")).unwrap();
    assert!(report.contains("The bodies touch again in all (over 98.77 %) of the runs"));
    let replay = Replay::open(study.folder(), None, 5, 0.0).unwrap().to_string();
    assert!(replay.contains("clearance") && replay.contains("recontact"), "{replay}");

    // A short arm over a small plate stays clear: they are nearest at the start of the coast.
    let (study, _scratch) = run(&at(-0.5, 1.0));
    let tables = study.tables().unwrap();
    let table = &tables[0];
    assert_eq!(Quantity::RecontactTime.in_table(table).len(), 0);
    let clearance = Quantity::Clearance.in_table(table);
    assert!(clearance.iter().all(|c| (0.5..1.0).contains(c)), "{clearance:?}");
    let summary = fs::read_to_string(study.folder().join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["models"][0]["releases"]["recontact"]["count"], 0);
    // How near they come, in which run, and the picture of it.
    let told = &summary["models"][0]["releases"]["clearance"];
    let least = clearance.iter().copied().fold(f64::INFINITY, f64::min);
    assert_eq!(told["least_m"], least);
    let nearest = table.rows().find(|r| Quantity::Clearance.in_row(r) == Some(least)).unwrap();
    assert_eq!(told["run"], nearest.run());
    let p01 = told["p01_m"].as_f64().unwrap();
    assert!(clearance.iter().filter(|c| **c < p01).count() <= clearance.len() / 100 + 1);
    let report = fs::read_to_string(study.folder().join("report.html")).unwrap();
    assert!(
        report.contains("The smallest clearance is") && report.contains("figures/clearance.svg")
    );
    let replay = Replay::open(study.folder(), None, nearest.run(), 2.0).unwrap();
    let words = replay.to_string();
    assert!(words.contains("payload 1 (points) and stage 1 (hull)"), "{words}");
    let folder = study.folder().join("replay");
    replay.write(&folder, false).unwrap();
    let page = fs::read_to_string(folder.join("animation.html")).unwrap();
    assert!(page.contains("\"hull\":") && page.contains("\"closest\":{") && page.len() < 200_000);
}

#[test]
fn an_outline_that_cannot_be_placed_fails_its_run() {
    // About one mass centre in three pushes it over the edge of what can be computed with.
    let clearance = "[clearance]\npayload = [{ points_m = [[0.0, 0.0, -0.5]] }]\n\
                     stage = [{ points_m = [[0.0, 0.0, 0.5]] }]\n\n[payload]";
    // The strokes are long enough for the springs to be followed farther than that.
    let text = paper().replace("stroke_m = 0.1", "stroke_m = 1.0");
    let text = text.replacen("[payload]", clearance, 1).replacen(
        "[payload.dispersion]",
        "[payload.dispersion]\nmass_centre_m = [0.0, { law = \"uniform\", low = -1.5e6, high = 1.5e6 }, 0.0]",
        1,
    );
    let (study, _scratch) = run(&text);
    for table in &study.tables().unwrap() {
        let failed: Vec<_> = table.rows().filter(|r| r.failure().is_some()).collect();
        assert!((50..250).contains(&failed.len()), "{}", failed.len());
        for row in failed {
            let status = row.status();
            assert!(status.starts_with("payload: outline: points_m has coordinate"), "{status}");
        }
    }
}

/// A study that is told to stop after its runs, while results are put together or rows are left out, leaves what was there, and goes on.
#[test]
fn a_study_stops_after_its_runs_too() {
    let scratch = tempfile::tempdir().unwrap();
    let scenario = Scenario::peck_2003().unwrap().with_runs(40).unwrap();
    let out = Some(scratch.path().join("study"));
    let options = Options { out, ..Options::default() };
    let whole = Study::run(&scenario, &options, &|_| {}).unwrap();
    let rows = |study: &Study| study.tables().unwrap().iter().map(Table::len).collect::<Vec<_>>();
    assert_eq!(rows(&whole), [40; 4]);
    let stop = Some(Arc::new(AtomicBool::new(true)));
    let stopped = Options { stop, ..options.clone() };
    let reduced = scenario.clone().with_kept(&Kept::new(Rows::None, None));
    let error = Study::run(&reduced, &stopped, &|_| {}).unwrap_err();
    assert!(matches!(error, StudyError::Campaign(CampaignError::Stopped)), "{error}");
    assert_eq!(rows(&Study::run(&scenario, &options, &|_| {}).unwrap()), [40; 4]);
    // The same when the last run sets it: nothing is put in place, and no run is lost.
    let more = scenario.with_runs(50).unwrap();
    let stop = Arc::new(AtomicBool::new(false));
    let last = |done: u64| stop.fetch_or(done == 200, Ordering::Relaxed);
    let stopped = Options { stop: Some(Arc::clone(&stop)), threads: Some(1), ..options.clone() };
    let error = Study::run(&more, &stopped, &|done| {
        last(done);
    });
    assert!(matches!(error, Err(StudyError::Campaign(CampaignError::Stopped))));
    assert!(
        fs::read_to_string(whole.folder().join("scenario.toml")).unwrap().contains("runs = 40")
    );
    assert_eq!(rows(&Study::run(&more, &options, &|_| {}).unwrap()), [50; 4]);
}
