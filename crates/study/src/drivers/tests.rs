//! What is told of the outputs of separations whose numbers some runs have not, though none failed.

use gyradius_statistics::SobolIndex;
use proptest::prelude::*;
use std::fs;

use crate::{Options, Scenario, Study, subject::Subject};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]

    /// Whatever the share of runs in which a spring fails, so that it has no release: every number and flag that is not drawn is among the outputs or
    /// those left out, with what a requirement is about, and the page names those of which more than 1 % of the base runs are left out.
    #[test]
    fn every_outcome_is_driven_or_named(
        failing in prop_oneof![Just(0.0), 0.0..0.02, 0.02..0.5_f64],
        quantity in prop::sample::select(vec!["spring_1_release_s", "payload_i11", "realizable"]),
    ) {
        let text = Scenario::peck_2003().unwrap().to_toml();
        let (springs, _) = text.split_once("[[models]]").unwrap();
        let dispersed = format!("[springs.dispersion]\nstiffness_percent = 2.0\nfailure_probability = {failing}\n\n[[springs]]");
        let (before, first) = springs.split_once("[[springs]]").unwrap();
        let springs = format!("{before}[[springs]]{}", first.replacen("[[springs]]", &dispersed, 1));
        let required = format!(
            "[[requirements]]\nname = \"it\"\nquantity = \"{quantity}\"\nat_most = 0.9\nprobability = 0.5\nconfidence = 0.9\n"
        );
        let model = "[[models]]\nname = \"own\"\nlaw = \"principal\"\naxes = \"whole-sphere\"\n";
        let text = format!("{springs}{required}{model}");
        let scenario = Scenario::from_toml(&text).unwrap().with_runs(60).unwrap().with_drivers(200).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let study = Study::run(&scenario, &Options::to(out.clone()), &|_| {}).unwrap();
        let page = fs::read_to_string(out.join("report.md")).unwrap();
        let drivers = &study.summary().head.drivers[0];
        prop_assert_eq!(drivers.failed, 0);
        let asked = scenario.outcomes().into_iter().chain([quantity.to_owned()]);
        for name in asked {
            let driven = drivers.outputs.iter().any(|driven| driven.output == name);
            prop_assert!(driven != drivers.left_out.contains(&name), "{}", name);
        }
        let page = page.replace('\\', "");
        let line = page.lines().find(|line| line.contains("of the base runs are left out of an index")).unwrap_or_default();
        let mut told = 0;
        for driven in &drivers.outputs {
            let left_out = driven.indices.groups().iter().map(SobolIndex::left_out).max().unwrap();
            let share = 100.0 * left_out as f64 / 200.0;
            told += usize::from(share > 1.0);
            if driven.output == "spring_1_release_s" && driven.unit.is_some() {
                prop_assert_eq!(line.contains(&format!("spring_1_release_s (s) ({share:.0} %)")), share > 1.0, "{}", line);
            }
        }
        prop_assert_eq!(line.is_empty(), told == 0, "{} {}", told, line);
    }
}
