//! Of which columns a study judges: what comes of a run, whatever it is called, and not which run it is.

use gyradius_campaign::{RunInputs, SimulatorFunction};

use super::{SimulatorScenario, folder};
use crate::{AnyScenario, Options, RareOptions};

/// A quantity and an output of any names, with vehicles and without: what tells which run it is, is judged nowhere, and everything else
/// in requirements, in rules and as an event.
#[test]
fn columns_are_judged_unless_they_tell_which_run_it_is() {
    let folder = folder();
    let out = folder.path().join("out");
    for (input, output) in ["x", "vehicle", "flight"]
        .into_iter()
        .flat_map(|i| ["y", "vehicle", "flight"].map(|o| (i, o)))
    {
        for (vehicles, judged) in [false, true]
            .into_iter()
            .flat_map(|vehicles| [input, output, "run", "vehicle", "flight"].map(|j| (vehicles, j)))
        {
            let size = if vehicles { "vehicles = 30\nflights = 4" } else { "runs = 120" };
            let text = |more: &str| {
                format!(
                    "name = \"judged\"\n{size}\n[simulation]\nfunction = \"again\"\n[[simulation.outputs]]\nname = \"{output}\"\n\
                     [[quantities]]\nname = \"{input}\"\nlaw = {{ law = \"normal\", mean = 0.0, sigma = 1.0 }}\n{more}"
                )
            };
            let (is_taken, is_there) = (input == output, [input, output].contains(&judged));
            let is_place =
                vehicles && ["vehicle", "flight"].iter().any(|p| [input, output].contains(p));
            let given = |more: &str| SimulatorScenario::from_toml(&text(more), folder.path());
            if is_taken || is_place {
                assert!(given("").is_err(), "{input} {output} {vehicles}");
                continue;
            }
            let own = output.to_owned();
            let function = SimulatorFunction::new(move |run: &RunInputs<'_>| {
                Ok(vec![(own.clone(), run.inputs().map(|(_, x)| x).sum::<f64>() + 0.5)])
            });
            let required = format!(
                "[[requirements]]\nquantity = \"{judged}\"\nat_most = 9.0\nprobability = 0.5\nconfidence = 0.9\n"
            );
            let rule = format!("[until]\nrule = \"mean({judged}) within 1\"\nlook_every = 40\n");
            for more in [required, rule] {
                let scenario = given(&more).unwrap().with_function(function.clone()).unwrap();
                let options = Options { force: true, ..Options::to(out.clone()) };
                let study = scenario.study(&options, &|_| {}, &|_| {});
                let told = study.map_or_else(|error| error.to_string(), |_| String::new());
                assert_eq!(told.is_empty(), is_there, "{input} {output} {vehicles} {more} {told}");
                // What there is in its place is named.
                assert!(is_there || told.ends_with(&format!("it has {input}, {output}")), "{told}");
            }
            let rare = AnyScenario::Simulator(Box::new(
                given("").unwrap().with_function(function).unwrap(),
            ));
            let event = format!("{judged} >= 0.1").parse().unwrap();
            let options = RareOptions { per_level: 100, ..RareOptions::default() };
            let found = rare.rare(&event, &options, &|_| {}, &|_| {});
            assert_eq!(found.is_ok(), is_there, "{input} {output} {vehicles} {judged} {found:?}");
        }
    }
}
