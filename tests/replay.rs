//! One run again: the same bits as in the study, and a history that keeps what physics keeps.

use gyradius_study::{Options, Quantity, Replay, ReplayError, ResultsError, Scenario, Study};
use std::{collections::HashMap, fs, path::Path};

/// When a spring lets go, springs from 0.
fn release(spring: usize) -> Quantity {
    Quantity::of_column(&format!("spring_{}_release_s", spring + 1)).unwrap()
}

fn paper() -> String {
    Scenario::peck_2003().unwrap().to_toml()
}

fn study(text: &str, runs: u64, out: &Path) -> Study {
    let scenario = Scenario::from_toml(text).unwrap().with_runs(runs).unwrap();
    let options = Options { out: Some(out.to_owned()), ..Options::default() };
    Study::run(&scenario, &options, &|_| {}).unwrap()
}

/// Failed runs and good ones, of all models: the rows are those of the study, which runs them side by
/// side in batches.
#[test]
fn rows_are_those_of_the_study_bit_for_bit() {
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path().join("study");
    // Deviations as large as the moments: many draws cannot even turn.
    let text = paper().replace("[42.8518, 54.3897, 133.1674]", "[5000.0, 54.3897, 133.1674]");
    let study = study(&text, 70, &out);
    let (mut failed, mut good) = (0, 0);
    for table in &study.tables().unwrap() {
        for run in [0, 1, 7, 63, 64, 69] {
            let replay = Replay::open(&out, Some(table.model()), run, 0.0).unwrap();
            let row = table.row(run as usize).unwrap();
            // Debug output of floats tells all their bits, and the sign of zero.
            assert_eq!(format!("{:?}", replay.row()), format!("{row:?}"));
            assert!(replay.to_string().contains("bit for bit"), "{replay}");
            if row.failure().is_some() { failed += 1 } else { good += 1 }
        }
    }
    assert!(failed > 1 && good > 10, "{failed} failed");
    // The first model is that of the scenario.
    let replay = Replay::open(&out, None, 3, 0.0).unwrap();
    assert_eq!(replay.model(), "proposed");
    // A failed run that never began has nothing to show, and says why.
    let tables = study.tables().unwrap();
    let naive = tables.iter().find(|t| t.model() == "naive").unwrap();
    let run = naive.rows().find(|r| r.failure().is_some()).unwrap().run();
    let replay = Replay::open(&out, Some("naive"), run, 0.0).unwrap();
    assert!(replay.to_string().contains("status: payload: inertia with principal moments"));
    assert_eq!(replay.write(&scratch.path().join("never"), false).unwrap().len(), 0);
    assert!(!scratch.path().join("never").exists());
}

/// A run that does not end is followed to where it fails.
#[test]
fn a_run_that_fails_under_way_has_a_history() {
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path().join("study");
    study(&paper().replace("horizon_s = 60.0", "horizon_s = 0.2"), 3, &out);
    let replay = Replay::open(&out, None, 1, 5.0).unwrap();
    assert!(replay.row().status().contains("had not let go after 0.2 s"), "{replay}");
    let files = replay.write(&scratch.path().join("replay"), false).unwrap();
    let table = table(&files[0]);
    assert_eq!(table["time_s"].last(), Some(&0.2));
    let page = fs::read_to_string(&files[2]).unwrap();
    assert!(page.contains("had not let go after 0.2 s"));
}

/// Whoever looks for the reason of a failure sees all that was drawn, how far out it is, and from what.
#[test]
fn a_replay_tells_what_was_drawn() {
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path().join("study");
    let text = paper().replacen(
        "[payload.dispersion]",
        "[payload.dispersion]\nmass_percent = 60.0\nmass_centre_m = [0.0, 0.0, 0.01]",
        1,
    );
    let study = study(&text, 60, &out);
    let tables = study.tables().unwrap();
    let table = &tables[0];
    let mass = table.values("payload_mass_kg").unwrap();
    let centre = table.values("payload_mass_centre_3_m").unwrap();
    let failed = table.rows().position(|row| row.failure().is_some()).unwrap();
    for run in [failed, failed + 1] {
        let page = Replay::open(&out, None, run as u64, 0.0).unwrap().to_string();
        let line = |name: &str| {
            let line = page.lines().find(|line| line.trim_start().starts_with(name));
            let words = line.unwrap_or_else(|| panic!("{page}")).split_whitespace();
            words.skip(1).map(|x| x.parse().unwrap_or(f64::NAN)).collect::<Vec<f64>>()
        };
        let [drawn, nominal, sigmas] = line("payload_mass_kg")[..] else { panic!("{page}") };
        assert!((drawn / mass[run] - 1.0).abs() < 1e-6 && nominal == 1e4, "{page}");
        assert!((sigmas - (mass[run] - 1e4) / 6e3).abs() < 0.006, "{page}");
        let [drawn, nominal, sigmas] = line("payload_mass_centre_3_m")[..] else {
            panic!("{page}")
        };
        assert!((drawn / centre[run] - 1.0).abs() < 1e-6 && nominal == 0.0, "{page}");
        assert!((sigmas - centre[run] / 0.01).abs() < 0.006, "{page}");
        // What does not vary is no deviation away from anything.
        assert!(line("payload_mass_centre_1_m")[2].is_nan(), "{page}");
    }
}

/// Columns of numbers by name; events are left out.
fn table(path: &Path) -> HashMap<String, Vec<f64>> {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let names: Vec<_> = lines.next().unwrap().split(',').collect();
    let mut columns: HashMap<String, Vec<f64>> = HashMap::new();
    for line in lines {
        let cells: Vec<_> = line.split(',').collect();
        assert_eq!(cells.len(), names.len(), "{line}");
        for (name, cell) in names.iter().zip(cells).filter(|(name, _)| **name != "event") {
            let value = if cell.is_empty() { f64::NAN } else { cell.parse().unwrap() };
            columns.entry((*name).to_owned()).or_default().push(value);
        }
    }
    columns
}

#[test]
fn a_history_keeps_energy_and_momenta_and_ends_as_the_row_says() {
    let scratch = tempfile::tempdir().unwrap();
    let moving = paper().replacen(
        "velocity_m_per_s = [0.0, 0.0, 0.0]",
        "velocity_m_per_s = [0.3, -0.1, 0.2]",
        1,
    );
    assert_ne!(moving, paper());
    let scenario = Scenario::from_toml(&moving).unwrap().with_runs(20).unwrap();
    let replay = Replay::new(&scenario, Some("naive"), 11, 2.0).unwrap();
    let folder = scratch.path().join("replay");
    let files = replay.write(&folder, false).unwrap();
    let table = table(&files[0]);
    let times = &table["time_s"];
    assert!(times.len() > 200 && times.windows(2).all(|pair| pair[0] < pair[1]));
    assert_eq!(times[0], 0.0);
    let row = replay.row();
    let end = Quantity::ReleaseTime.in_row(&row).unwrap() + 2.0;
    assert!((times.last().unwrap() - end).abs() < 1e-12);

    let steady = |name: &str, size: f64| {
        let column = &table[name];
        for value in column {
            assert!((value - column[0]).abs() <= 1e-11 * size, "{name}: {value} {}", column[0]);
        }
    };
    steady("energy_j", table["energy_j"][0]);
    for i in 1..=3 {
        steady(&format!("momentum_{i}_kg_m_per_s"), 1e4);
        steady(&format!("angular_momentum_{i}_kg_m2_per_s"), 1e4);
    }
    // The columns add up: energy from its parts, force from stiffness and compression, attitudes of
    // unit norm, momentum from the velocities.
    for k in 0..times.len() {
        let at = |name: &str| table[name][k];
        let parts = ["springs", "payload_translation", "payload_rotation"];
        let parts = parts.into_iter().chain(["stage_translation", "stage_rotation"]);
        let sum: f64 = parts.map(|part| at(&format!("{part}_j"))).sum();
        assert!((sum - at("energy_j")).abs() < 1e-9);
        for (spring, stiffness) in [(1, 1e5), (2, 1e5), (3, 3e4), (4, 3e4)] {
            let released = release(spring - 1).in_row(&row).unwrap();
            let force = at(&format!("spring_{spring}_force_n"));
            let components = (1..=3).map(|i| at(&format!("spring_{spring}_force_{i}_n")));
            let norm = components.map(|f| f * f).sum::<f64>().sqrt();
            assert!((norm - force).abs() < 1e-9 * stiffness);
            if times[k] > released {
                assert_eq!(force, 0.0);
            } else {
                let expected = stiffness * at(&format!("spring_{spring}_compression_m"));
                assert!((force - expected).abs() < 1e-9 * stiffness, "{force} {expected}");
            }
        }
        let momentum = 1e4 * at("payload_v1_m_per_s") + 4e3 * at("stage_v1_m_per_s");
        assert!((momentum - at("momentum_1_kg_m_per_s")).abs() < 1e-8);
        let norm: f64 = (1..=4).map(|i| at(&format!("stage_q{i}")).powi(2)).sum();
        assert!((norm - 1.0).abs() < 1e-14);
    }
    // Every release is a row, at its time to the bit, and after the last the rates are the outcome's.
    let text = fs::read_to_string(&files[0]).unwrap();
    for spring in 0..4 {
        let time = release(spring).in_row(&row).unwrap();
        let event = format!("\n{time:?},spring {} released,", spring + 1);
        assert!(text.contains(&event), "{event}");
    }
    let last = Quantity::ReleaseTime.in_row(&row).unwrap();
    let k = times.iter().position(|time| *time == last).unwrap();
    let rate = Quantity::PayloadRate2.in_row(&row).unwrap();
    assert!((table["payload_w2_rad_per_s"][k] - rate).abs() < 1e-15);
    assert_eq!(text.lines().nth(1).unwrap().split(',').nth(1), Some("clamp opens"));
    assert!(text.lines().last().unwrap().contains(",end,"));

    let page = fs::read_to_string(&files[2]).unwrap();
    assert!(page.len() < 200_000, "{} bytes", page.len());
    for outside in ["http:", "https:", "src=", "@import", "url("] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert!(fs::metadata(&files[1]).unwrap().len() < 200_000);
}

/// The page stays small with many springs, and markup in names stays text.
#[test]
fn animations_are_small() {
    let scratch = tempfile::tempdir().unwrap();
    let base = paper();
    let (at, models) = (base.find("[[springs]]").unwrap(), base.find("[[models]]").unwrap());
    let springs: String = (0..300)
        .map(|i| {
            let (s, c) = (f64::from(i) * 0.7).sin_cos();
            format!(
                "[[springs]]\nstiffness_n_per_m = 1e3\nstroke_m = 0.1\npayload_point_m = [{c:?}, {s:?}, \
                 -0.9]\nstage_point_m = [{c:?}, {s:?}, 0.9]\n\n"
            )
        })
        .collect();
    let text = format!("{}{springs}{}", &base[..at], &base[models..]);
    let scenario = Scenario::from_toml(&text).unwrap();
    let replay = Replay::new(&scenario, Some("naive"), 0, 3600.0).unwrap();
    let files = replay.write(&scratch.path().join("replay"), false).unwrap();
    let page = fs::read_to_string(&files[2]).unwrap();
    assert!(page.len() < 4_000_000, "{} bytes", page.len());
    // And the table within bounds.
    let size = fs::metadata(&files[0]).unwrap().len();
    assert!(size < 60_000_000, "{size} bytes");
}

#[test]
fn what_cannot_be_replayed_is_named() {
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path().join("study");
    study(&paper(), 5, &out);
    let error = |model: Option<&str>, run: u64, coast: f64| {
        Replay::open(&out, model, run, coast).unwrap_err().to_string()
    };
    assert_eq!(error(None, 5, 0.0), "run 5: the runs are numbered from 0 to 4");
    assert_eq!(
        error(Some("naif"), 0, 0.0),
        "model: \"naif\": the scenario has proposed, published, naive, naive-matched"
    );
    for coast in [-1.0, f64::NAN, f64::INFINITY, 1e9] {
        assert!(error(None, 0, coast).contains("it must lie between 0 and 3600"));
    }
    let of = |path: &Path| Replay::open(path, None, 0, 0.0).unwrap_err();
    assert!(of(&scratch.path().join("nowhere")).to_string().contains("there is no such study"));
    assert!(of(scratch.path()).to_string().contains("it holds no study"));

    // A table that says otherwise in the last bit of a number, or is not there.
    let table = out.join("runs/proposed/000000000-000000004.parquet");
    let bytes = fs::read(&table).unwrap();
    let wobble = Quantity::Wobble.in_row(&Replay::open(&out, None, 0, 0.0).unwrap().row()).unwrap();
    let at = bytes.windows(8).position(|w| w == wobble.to_le_bytes()).unwrap();
    let mut changed = bytes.clone();
    changed[at] ^= 1;
    fs::write(&table, changed).unwrap();
    let message = of(&out).to_string();
    assert!(message.contains("wobble_deg of the run is"), "{message}");
    fs::write(&table, &bytes[..bytes.len() / 2]).unwrap();
    assert!(matches!(of(&out), ReplayError::Table { .. }));
    fs::remove_file(&table).unwrap();
    assert!(matches!(of(&out), ReplayError::Table { .. }));
    fs::write(&table, bytes).unwrap();
    assert!(Replay::open(&out, None, 0, 0.0).is_ok());

    // A scenario that was changed afterwards, another version, a summary that is none.
    let (scenario, summary) = (out.join("scenario.toml"), out.join("summary.json"));
    let text = fs::read_to_string(&scenario).unwrap();
    fs::write(&scenario, text.replace("mass_kg = 10000.0", "mass_kg = 10001.0")).unwrap();
    assert!(matches!(of(&out), ReplayError::Study(ResultsError::Fingerprint { .. })));
    fs::write(&scenario, text).unwrap();
    let text = fs::read_to_string(&summary).unwrap();
    let old = text.replace("\"gyradius_version\": \"", "\"gyradius_version\": \"0.0.");
    fs::write(&summary, old).unwrap();
    assert!(of(&out).to_string().contains("the study was made by gyradius 0.0."));
    for bad in ["", "{}", "[1, 2", "\u{0}"] {
        fs::write(&summary, bad).unwrap();
        assert!(matches!(of(&out), ReplayError::Study(ResultsError::Study { .. })), "{bad}");
    }
}

#[test]
fn nothing_of_the_users_is_overwritten() {
    let scratch = tempfile::tempdir().unwrap();
    let folder = scratch.path().join("replay");
    let scenario = Scenario::peck_2003().unwrap().with_runs(3).unwrap();
    let replay = |run| Replay::new(&scenario, None, run, 1.0).unwrap();
    replay(0).write(&folder, false).unwrap();
    // The same again is no harm.
    replay(0).write(&folder, false).unwrap();
    let page = folder.join("animation.html");
    let before = fs::read(&page).unwrap();
    let error = replay(1).write(&folder, false).unwrap_err();
    assert!(matches!(error, ReplayError::Write(_)) && error.to_string().contains("--force"));
    assert!(fs::read(&page).unwrap() == before);
    replay(1).write(&folder, true).unwrap();
    assert!(fs::read(&page).unwrap() != before);
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 3, "no drafts are left");
    let file = scratch.path().join("file");
    fs::write(&file, "mine").unwrap();
    assert!(matches!(replay(0).write(&file, true), Err(ReplayError::Write(_))));
    assert_eq!(fs::read_to_string(&file).unwrap(), "mine");
}
