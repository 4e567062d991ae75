//! Where the runs of a simulator fail: runs that failed have no outputs, but what they drew.

use super::{folder, quantity, scenario, uniform};
use crate::{Options, write_report};
use std::fs;

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
