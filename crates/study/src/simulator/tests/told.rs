//! What the page tells of runs that failed: first, by kind, and at each requirement.

use gyradius_campaign::{RunInputs, SimulatorFunction};
use gyradius_inertia::{InertiaMatrix, RealizabilityReport};
use proptest::prelude::*;
use std::{collections::BTreeMap, fs};

use super::{SimulatorScenario, folder};
use crate::Options;

const SCENARIO: &str = "name = \"told\"\nseed = 5\n[simulation]\nfunction = \"counts\"\n[[simulation.outputs]]\nname = \"y\"\n\
    [[quantities]]\nname = \"x\"\nlaw = { law = \"uniform\", low = 0.0, high = 1.0 }\n";
const KINDS: [&str; 9] = ["ice", "fog", "rain", "hail", "snow", "sand", "wind", "dust", "heat"];

/// Why the run with this draw fails; none if it does not.
fn reason(x: f64, failing: f64) -> Option<&'static str> {
    // Kinds of very different frequency.
    (x < failing).then(|| KINDS[((x / failing).sqrt() * KINDS.len() as f64) as usize])
}

/// Where a scenario declares a unit of an output, it stands at bound, margin, worst runs and the axis; and where the outputs of a
/// requirement have several, none does.
#[test]
fn units_are_told_of_requirements() {
    for (y, z, told) in [("m", "m", true), ("m", "s", false), ("1", "1", false)] {
        let folder = folder();
        let text = format!(
            "runs = 80\n{SCENARIO}[[requirements]]\nname = \"low\"\nquantity = \"norm(y, z)\"\nat_most = 0.9\n\
             probability = 0.6\nconfidence = 0.9\n"
        );
        let outputs = format!(
            "name = \"y\"\nunit = \"{y}\"\n[[simulation.outputs]]\nname = \"z\"\nunit = \"{z}\"\n[[quant"
        );
        let text = text.replacen("name = \"y\"\n[[quant", &outputs, 1);
        let twice = SimulatorFunction::new(move |run: &RunInputs<'_>| {
            let x = run.input("x").ok_or("no x")?;
            Ok(vec![("y".to_owned(), x), ("z".to_owned(), 0.0)])
        });
        let scenario = SimulatorScenario::from_toml(&text, folder.path()).unwrap();
        let scenario = scenario.with_function(twice).unwrap();
        let out = folder.path().join("out");
        scenario.study(&Options::to(out.clone()), &|_| {}, &|_| {}).unwrap();
        let page = fs::read_to_string(out.join("report.md")).unwrap();
        let line = page.lines().find(|line| line.starts_with("| **low**")).unwrap();
        assert_eq!(line.contains("at most 0.9 m, in"), told, "{line}");
        let cells: Vec<&str> = line.split(" | ").collect();
        assert_eq!([cells[4], cells[5]].iter().all(|cell| cell.contains(" m")), told, "{line}");
        let worst = page
            .lines()
            .find(|line| line.contains("gyradius replay") || line.contains("study.replay"));
        assert_eq!(worst.unwrap().matches(" m |").count(), if told { 2 } else { 0 }, "{worst:?}");
        let figure = fs::read_to_string(out.join("figures/distribution-1.svg")).unwrap();
        assert_eq!(figure.contains("norm(y, z) (m)"), told);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// From no failed run to nothing else, left out or counted: the page says how many, why, and of which runs its shares are.
    #[test]
    fn no_failed_run_is_passed_over(
        runs in 1..300_u64,
        failing in prop_oneof![1 => Just(0.0), 4 => 0.0..1.0, 1 => Just(1.0)],
        left_out: bool,
    ) {
        let folder = folder();
        let fate = if left_out { "left-out" } else { "against" };
        let required = format!(
            "[[requirements]]\nname = \"low\"\nquantity = \"y\"\nat_most = 0.9\nprobability = 0.6\nconfidence = 0.9\n\
             failed_runs = \"{fate}\"\n"
        );
        let text = format!("runs = {runs}\n{SCENARIO}{required}");
        let counts = SimulatorFunction::new(move |run: &RunInputs<'_>| {
            let x = run.input("x").ok_or("no x")?;
            reason(x, failing).map_or_else(|| Ok(vec![("y".to_owned(), x)]), |why| Err(why.to_owned()))
        });
        let scenario = SimulatorScenario::from_toml(&text, folder.path()).unwrap();
        let scenario = scenario.with_function(counts).unwrap();
        let out = folder.path().join("out");
        let study = scenario.study(&Options::to(out.clone()), &|_| {}, &|_| {}).unwrap();
        let page = fs::read_to_string(out.join("report.md")).unwrap();

        let table = study.tables().unwrap().remove(0);
        let mut kinds: BTreeMap<&str, u64> = BTreeMap::new();
        for x in table.values("x").unwrap() {
            if let Some(why) = reason(x, failing) {
                *kinds.entry(why).or_default() += 1;
            }
        }
        let failed: u64 = kinds.values().sum();
        let terminal = study.summary().to_string();
        let first = format!("> **all: {failed} of {runs} runs failed** and are left out");
        prop_assert_eq!(page.contains(&first), failed > 0, "{}", page);
        prop_assert_eq!(page.matches("runs failed").count(), usize::from(failed > 0));
        let mut counts: Vec<u64> = kinds.values().copied().collect();
        counts.sort_unstable_by(|a, b| b.cmp(a));
        for (why, count) in &kinds {
            let told = [&page, &terminal].map(|text| text.contains(&format!("{count} × simulator: {why}")));
            // Those as frequent as the sixth may stand behind it.
            let sure = kinds.len() <= 6 || *count > counts[5];
            prop_assert!(told[0] == told[1] && (told[0] || !sure), "{count} {why} {terminal}");
        }
        if kinds.len() > 6 {
            let rest: u64 = counts[5..].iter().sum();
            let last = format!("and {rest} more failed runs of {} other kinds", kinds.len() - 5);
            prop_assert!(page.contains(&last) && terminal.contains(&last), "{last}\n{terminal}");
        }
        let (of, what) = if left_out {
            ("the runs that have a number", "left out")
        } else {
            ("all runs", "counted against it")
        };
        let share_of = format!("in 60 % of {of}, with 90 % confidence");
        prop_assert!(page.contains(&share_of), "{page}");
        let without = format!("{failed} of {runs} have no number: {what}");
        prop_assert_eq!(page.contains(&without), failed > 0);
        prop_assert_eq!(page.contains("A run has no number if it failed"), failed > 0);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Page and terminal say all that the row of the first run that failed says of why.
    #[test]
    fn the_first_failure_is_told_in_full(limit in 0.1..1.0, runs in 1_u64..700, threads in 1_usize..3) {
        let folder = folder();
        let fails = SimulatorFunction::new(move |run: &RunInputs<'_>| {
            let x = run.input("x").ok_or("no x")?;
            if x > limit { Err(format!("diverged at {x:?} s")) } else { Ok(vec![("y".to_owned(), x)]) }
        });
        let text = format!("runs = {runs}\n{SCENARIO}");
        let scenario = SimulatorScenario::from_toml(&text, folder.path()).unwrap();
        let scenario = scenario.with_function(fails).unwrap();
        let out = folder.path().join("out");
        let options = Options { threads: Some(threads), ..Options::to(out.clone()) };
        let study = scenario.study(&options, &|_| {}, &|_| {}).unwrap();
        let page = fs::read_to_string(out.join("report.md")).unwrap();
        let terminal = study.summary().to_string();
        let x = study.tables().unwrap().remove(0).values("x").unwrap();
        let first = x.iter().position(|x| *x > limit);
        for text in [&page, &terminal] {
            match first {
                Some(run) => {
                    let told = format!("the first, run {run}: simulator: diverged at {:?} s", x[run]);
                    prop_assert!(text.contains(&told), "{told}\n{text}");
                }
                None => prop_assert!(!text.contains("the first, run"), "{text}"),
            }
        }
    }
}

/// Outputs whose variance few runs carry are named where their drivers are told, and no others.
#[test]
fn drivers_of_what_seldom_happens_are_warned_of() {
    let folder = folder();
    let flags = SimulatorFunction::new(|run: &RunInputs<'_>| {
        let x = run.input("x").ok_or("no x")?;
        let flag = |limit: f64| f64::from(u8::from(x > limit));
        Ok(vec![
            ("y".to_owned(), x),
            ("seldom".to_owned(), flag(0.99)),
            ("often".to_owned(), flag(0.3)),
        ])
    });
    let outputs =
        "[[simulation.outputs]]\nname = \"seldom\"\n[[simulation.outputs]]\nname = \"often\"\n";
    let required = |limit: f64| {
        format!(
            "[[requirements]]\nname = \"up to {limit}\"\nquantity = \"y\"\nat_most = {limit}\nprobability = 0.5\nconfidence = 0.9\n"
        )
    };
    let text = SCENARIO.replace("[[quantities]]", &format!("{outputs}[[quantities]]"));
    let text = format!("runs = 100\ndrivers = 300\n{text}{}{}", required(0.5), required(0.98));
    let scenario = SimulatorScenario::from_toml(&text, folder.path()).unwrap();
    let scenario = scenario.with_function(flags).unwrap();
    let out = folder.path().join("out");
    scenario.study(&Options::to(out.clone()), &|_| {}, &|_| {}).unwrap();
    let page = fs::read_to_string(out.join("report.md")).unwrap();
    let warning = page.lines().find(|line| line.contains("too few runs count")).unwrap();
    assert!(
        warning.contains("in fails: up to 0.98 (") && warning.contains("seldom ("),
        "{warning}"
    );
    assert!(warning.contains("of the 600 runs") && !warning.contains("often ("), "{warning}");
    assert!(!warning.contains("up to 0.5") && !warning.contains(" y ("), "{warning}");
    // Beside the bars, too, where the others have no such mark.
    let figure = fs::read_to_string(out.join("figures/drivers-all.svg")).unwrap();
    assert!(figure.contains("fails: up to 0.98, too few runs count"), "{figure}");
    assert!(!figure.contains("up to 0.5, too few") && !figure.contains("y, too few"), "{figure}");
}

/// Runs that failed are done again after a rule had looked at them, and would have ended them before: what the page says of the looks is
/// true of them and of those before.
#[test]
fn looks_before_failed_runs_were_done_again_are_not_denied() {
    let (mut sooner, mut as_before) = (0, 0);
    for within in [0.03, 0.05, 0.08, 0.1] {
        // Runs that fail are those of the lowest draws, without which fewer runs are enough, or any.
        for any in [false, true] {
            let folder = folder();
            let text = format!(
                "runs = 3000\n{SCENARIO}[until]\nrule = \"mean(y) within {within}\"\nlook_every = 20\n"
            );
            let out = folder.path().join("out");
            let study = |retry_failed: bool| {
                let function = SimulatorFunction::new(move |run: &RunInputs<'_>| {
                    let x = run.input("x").ok_or("no x")?;
                    let fails = if any { (1000.0 * x).fract() < 0.4 } else { x < 0.4 };
                    if fails && !retry_failed {
                        Err("no licence".into())
                    } else {
                        Ok(vec![("y".to_owned(), x)])
                    }
                });
                let scenario = SimulatorScenario::from_toml(&text, folder.path()).unwrap();
                let scenario = scenario.with_function(function).unwrap();
                let options = Options { retry_failed, ..Options::to(out.clone()) };
                let study = scenario.study(&options, &|_| {}, &|_| {}).unwrap();
                let ended = study.summary().head.ended.clone().unwrap();
                (ended, fs::read_to_string(out.join("report.md")).unwrap())
            };
            let (before, page) = study(false);
            assert!(!page.contains("look that counts"), "{page}");
            let (after, page) = study(true);
            assert!(after.runs >= before.runs && !page.contains("before the rule was asked"));
            let first = after.until.first_look();
            let said = format!(
                "The first look that counts is at {} runs of each model, as the scenario says",
                before.runs
            );
            assert_eq!(page.contains(&said), first.is_some(), "{page}");
            let ended = ["look that counts; there", "looks that count; there"];
            assert_eq!(ended.iter().any(|words| page.contains(words)), first.is_some(), "{page}");
            assert_eq!(after.looks()[0], first.unwrap_or(20));
            sooner += usize::from(first.is_some());
            as_before += usize::from(first.is_none());
        }
    }
    assert!(sooner > 0 && as_before > 0, "{sooner} {as_before}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Of any outputs, some of which are constant: the first six that vary are in the figure of drivers, all that vary in the table and
    /// among the rank correlations, and those that do not are named.
    #[test]
    fn every_output_is_driven_or_named(constant in prop::collection::vec(any::<bool>(), 1..10)) {
        let folder = folder();
        let names: Vec<String> = (0..constant.len()).map(|i| format!("out{i}")).collect();
        let more: Vec<String> = names.iter().map(|name| format!("[[simulation.outputs]]\nname = \"{name}\"\n")).collect();
        let text = SCENARIO.replace("[[simulation.outputs]]\nname = \"y\"\n", &more.concat());
        let all: Vec<(String, bool)> = names.into_iter().zip(constant).collect();
        let own = all.clone();
        let function = SimulatorFunction::new(move |run: &RunInputs<'_>| {
            let x = run.input("x").ok_or("no x")?;
            Ok(own.iter().map(|(name, constant)| (name.clone(), if *constant { 1.0 } else { x })).collect())
        });
        let scenario = SimulatorScenario::from_toml(&format!("runs = 60\ndrivers = 100\n{text}"), folder.path()).unwrap();
        let out = folder.path().join("out");
        let study = scenario.with_function(function).unwrap();
        let study = study.study(&Options::to(out.clone()), &|_| {}, &|_| {}).unwrap();
        let drivers = &study.summary().head.drivers[0];
        let of = |constant: bool| all.iter().filter(move |own| own.1 == constant).map(|(name, _)| name.as_str()).collect::<Vec<_>>();
        prop_assert_eq!(drivers.outputs.iter().map(|driven| driven.output.as_str()).collect::<Vec<_>>(), of(false));
        prop_assert_eq!(&drivers.left_out, &of(true));
        let page = fs::read_to_string(out.join("report.md")).unwrap();
        if !of(false).is_empty() {
            let figure = fs::read_to_string(out.join("figures/drivers-all.svg")).unwrap();
            for (place, name) in of(false).into_iter().enumerate() {
                prop_assert_eq!(figure.contains(name), place < 6, "{}", name);
                prop_assert!(page.contains(&format!("{name}, all")), "{} {}", name, page);
            }
            let named = format!("the same in all of these runs but for rounding, or missing: {}", of(true).join(", "));
            prop_assert_eq!(page.contains(&named), !of(true).is_empty(), "{}", page);
            prop_assert_eq!(page.contains("A figure has 6 outputs at most"), of(false).len() > 6);
        }
    }
}

/// Numbers of any size are written in a few digits, on every page and figure and on the terminal.
#[test]
fn no_number_has_hundreds_of_digits() {
    for size in [1e300, 1e-300, 1e17] {
        let folder = folder();
        let large = SimulatorFunction::new(move |run: &RunInputs<'_>| {
            let x = run.input("x").ok_or("no x")?;
            Ok(vec![("y".to_owned(), size * x)])
        });
        let limits = [0.5, 0.9999].map(|share| {
            let limit = share * size;
            format!("[[requirements]]\nquantity = \"y\"\nat_most = {limit:e}\nprobability = 0.6\nconfidence = 0.9\n")
        });
        let text = format!("runs = 200\ndrivers = 100\n{SCENARIO}{}{}", limits[0], limits[1]);
        let scenario = SimulatorScenario::from_toml(&text, folder.path()).unwrap();
        let scenario = scenario.with_function(large).unwrap();
        let out = folder.path().join("out");
        let study = scenario.study(&Options::to(out.clone()), &|_| {}, &|_| {}).unwrap();
        let page = fs::read_to_string(out.join("report.md")).unwrap();
        // The scenario stands last, as TOML writes it.
        let (page, _) = page.split_once("## Inputs").unwrap();
        let mut said = vec![study.summary().to_string(), page.to_owned()];
        said.extend(
            study.summary().head.requirements.iter().map(|judged| judged.judgement.to_string()),
        );
        for figure in fs::read_dir(out.join("figures")).unwrap() {
            said.push(fs::read_to_string(figure.unwrap().path()).unwrap());
        }
        for text in said {
            // Fingerprints and paths of figures are made of letters and signs too.
            let long = text
                .split(|c: char| !c.is_ascii_digit() && c != '.')
                .find(|digits| digits.len() > 25);
            assert_eq!(long, None);
        }
    }
}

/// A simulator may be sent bodies that cannot exist: how many of them are near the boundary or beyond it is what the rows say.
#[test]
fn impossible_bodies_are_told() {
    for (deviation, few) in [(0.01, true), (1.0, false)] {
        let folder = folder();
        let simple = SimulatorFunction::new(|run: &RunInputs<'_>| {
            Ok(vec![("y".to_owned(), run.input("x").ok_or("no x")?)])
        });
        let bodies = format!(
            "[[bodies]]\nname = \"h\"\nmass_kg = 10.0\ninertia_kg_m2 = [[1.0, 0.0, 0.0], [0.0, 1.2, 0.0], [0.0, 0.0, 0.9]]\n\
             [[models]]\nname = \"entries\"\nlaw = \"entrywise\"\nh_deviation_kg_m2 = [[{deviation}, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]\n"
        );
        let scenario =
            SimulatorScenario::from_toml(&format!("runs = 400\n{SCENARIO}{bodies}"), folder.path());
        let scenario = scenario.unwrap().with_function(simple).unwrap();
        let out = folder.path().join("out");
        let study = scenario.study(&Options::to(out.clone()), &|_| {}, &|_| {}).unwrap();
        let entries = ["h_i11", "h_i22", "h_i33", "h_i12", "h_i13", "h_i23"];
        let table = study.runs()[0].table().unwrap();
        let columns = entries.map(|name| table.numbers(name).unwrap());
        let near = (0..400).filter(|run| {
            let [a, b, c, d, e, f] = columns.map(|column| column.get(*run).unwrap());
            let matrix = InertiaMatrix::from_entries([a, b, c], [d, e, f]).unwrap();
            RealizabilityReport::of(matrix.matrix()).margin().unwrap() < 0.01
        });
        let near = near.count();
        assert_eq!(near == 0, few, "{near}");
        let page = fs::read_to_string(out.join("report.md")).unwrap();
        assert_eq!(page.contains("of the drawn inertias of the h are near the boundary"), !few);
        assert_eq!(page.contains(&format!("({near} of 400)")), !few, "{near}");
    }
}
