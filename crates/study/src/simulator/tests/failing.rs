//! Where the runs of a simulator fail: runs that failed have no outputs, but what they drew.

use gyradius_campaign::{ForeignTable, Judgement, RunInputs, SimulatorFunction};
use std::fs;

use super::{SimulatorReplay, folder, quantity, scenario, uniform};
use crate::{AnyScenario, Options, put_together, write_report};

#[test]
fn a_campaign_tells_where_its_runs_fail() {
    let folder = folder();
    let other = quantity("z", "{ law = \"normal\", mean = 1.0, sigma = 0.1 }");
    let required = "\n[[requirements]]\nname = \"near\"\nquantity = \"y\"\nat_most = 0.95\nprobability = 0.9\nconfidence = 0.9\n";
    for (left_out, told) in [("", true), ("failed_runs = \"left-out\"\n", false)] {
        let text = uniform() + &other + required + left_out;
        let scenario = scenario(&text, folder.path()).with_runs(700).unwrap();
        let out = folder.path().join(format!("out-{told}"));
        let options = Options::to(out.clone());
        scenario.study(&options, &|_| {}, &|_| {}).unwrap();
        let page = fs::read_to_string(out.join("report.md")).unwrap();
        assert_eq!(page.contains("## Where runs fail"), told, "{page}");
        assert!(page.contains("Rank correlations of inputs and outcomes"), "{page}");
        if told {
            let at = page.find("## Where runs fail").unwrap();
            let section = &page[at..page.find("Rank correlations of inputs").unwrap()];
            // All failures in the highest tenth of what was sent.
            assert!(section.contains("`x`") && !section.contains("`z`"), "{section}");
        }
        write_report(&out, None, true).unwrap();
        assert_eq!(fs::read_to_string(out.join("report.md")).unwrap(), page);
    }
}

/// Runs that answer with an infinite number, among runs that answer with none: the former count although failed runs are left out, in a
/// study, in one of shards, in its report made again, and in its tables judged by themselves; and each can be replayed.
#[test]
fn infinite_answers_are_not_left_out() {
    let folder = folder();
    let required = "\n[[requirements]]\nname = \"near\"\nquantity = \"abs(y)\"\nat_most = 2.0\nprobability = 0.95\nconfidence = 0.9\nfailed_runs = \"left-out\"\n";
    let command = "command = [\"sh\", \"answer.sh\"]\ntimeout_s = 60.0\n";
    let text = (uniform() + required).replace(command, "function = \"infinite at times\"\n");
    // 21 answers of each kind.
    let answer = |run: &RunInputs<'_>| {
        let y = match run.run() % 33 {
            5 => f64::INFINITY,
            6 => f64::NEG_INFINITY,
            7 => f64::NAN,
            8 => return Err("no licence".to_owned()),
            _ => run.input("x").ok_or("no x")?,
        };
        Ok(vec![("y".to_owned(), y)])
    };
    let scenario = scenario(&text, folder.path())
        .with_runs(21 * 33)
        .unwrap()
        .with_function(SimulatorFunction::new(answer))
        .unwrap();
    let whole = folder.path().join("whole");
    scenario.study(&Options::to(whole.clone()), &|_| {}, &|_| {}).unwrap();
    let shards = folder.path().join("shards");
    let any = AnyScenario::Simulator(Box::new(scenario.clone()));
    for shard in ["2/2", "1/2"] {
        let options = Options::to(shards.clone());
        any.run_shard(&options, shard.parse().unwrap(), &|_| {}, &|_| {}).unwrap();
    }
    put_together(&shards, &Options::default(), &|_| {}).unwrap();
    for out in [&whole, &shards] {
        let summary = fs::read_to_string(out.join("summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
        let judged: Judgement = serde_json::from_value(summary["requirements"][0].clone()).unwrap();
        assert_eq!((judged.runs_infinite(), judged.failures()), (42, 42), "{summary}");
        assert_eq!((judged.runs(), judged.counted()), (21 * 33, 21 * 31));
        let page = fs::read_to_string(out.join("report.md")).unwrap();
        assert!(page.contains("42 of 693 have an infinite number: counted against it"), "{page}");
        // The first of them is the worst run, with the words to see it again.
        let worst = &page[page.find("The worst runs").unwrap()..];
        assert!(worst.contains("| 5 | infinite | – |"), "{worst}");
        assert!(worst.contains("study.replay(5, model="), "{worst}");
        assert_eq!(judged.first_infinite(), [5, 6, 38, 39, 71, 72, 104, 105, 137, 138]);
        let told = judged.to_string();
        assert!(
            told.contains("count against it: 5, 6, 38, 39, 71, 72, 104, 105, 137, 138, …"),
            "{told}"
        );
        write_report(out, None, true).unwrap();
        assert_eq!(fs::read_to_string(out.join("report.md")).unwrap(), page);
        let runs = fs::read_dir(out.join("runs")).unwrap().next().unwrap().unwrap().path();
        let table = ForeignTable::open(&runs).unwrap();
        let of_table = Judgement::of_table(&[judged.requirement().clone()], &table).unwrap();
        assert_eq!(of_table, [judged]);
        for run in [5, 6, 7, 8] {
            let mut replay = SimulatorReplay::new(&scenario, None, run).unwrap();
            replay.hold_against(out).unwrap();
            assert!(replay.to_string().contains("failed: "), "{replay}");
        }
    }
}
