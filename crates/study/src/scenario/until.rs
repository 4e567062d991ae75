//! Until when the runs of a scenario go on, as it stands in a file.

use gyradius_campaign::{StoppingRule, Until};
use serde::{Deserialize, Serialize};

use super::{ScenarioError, parse, vehicles::Size};
use crate::fleet::Fleet;

/// The table `until` of a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct UntilFile {
    rule: StoppingRule,
    /// Filled in if there were more runs before than the rule would have asked for.
    #[serde(default, deserialize_with = "parse::some_whole")]
    first_look: Option<u64>,
    /// Filled in.
    #[serde(default, deserialize_with = "parse::some_whole")]
    look_every: Option<u64>,
    /// Filled in: the runs of the scenario.
    #[serde(default, deserialize_with = "parse::some_whole")]
    most_runs: Option<u64>,
}

const FIELD: &str = "until";

impl UntilFile {
    /// That of a scenario, with another rule, or looked at after another number of runs, if these are said. The first look stays that of the
    /// rule that it was filled in for.
    pub(crate) fn again(
        own: Option<&Self>,
        rule: Option<StoppingRule>,
        look_every: Option<u64>,
    ) -> Result<Self, ScenarioError> {
        let rule = rule.or_else(|| own.map(|own| own.rule.clone())).ok_or_else(|| {
            let alone = "it goes with until, which is neither given nor in the scenario";
            ScenarioError::field("look_every", alone)
        })?;
        let look_every = look_every.or_else(|| own?.look_every);
        let first_look = own.filter(|own| own.rule == rule).and_then(|own| own.first_look);
        Ok(Self { rule, first_look, look_every, most_runs: own.and_then(|own| own.most_runs) })
    }

    /// The runs of a scenario that says how many there may be, and not how many there are.
    pub(crate) fn runs(given: Option<&Self>, keys: [Option<u64>; 3]) -> [Option<u64>; 3] {
        match (given.and_then(|until| until.most_runs), keys) {
            (Some(most), [None, None, None]) => [Some(most), None, None],
            (_, keys) => keys,
        }
    }

    /// With another greatest number of runs.
    pub(crate) fn with_most_runs(self, runs: u64) -> Self {
        Self { most_runs: Some(runs), ..self }
    }

    /// With no look before so many runs.
    pub(crate) fn with_first_look(self, runs: Option<u64>) -> Self {
        Self { first_look: runs, ..self }
    }

    /// Fills in what is not said, of a scenario of this size; `usual` is how many runs there are between looks if nothing is
    /// said.
    pub(crate) fn fill(
        &mut self,
        size: Size,
        usual: u64,
        requirements: usize,
    ) -> Result<Until, ScenarioError> {
        let refused = |key: &str, problem: String| {
            Err(ScenarioError::field(format!("{FIELD}.{key}"), problem))
        };
        if requirements == 0 && self.rule.needs_requirements() {
            let problem = format!("“{}”: there must be requirements for that", self.rule);
            return refused("rule", problem);
        }
        let flights = size.fleet().map_or(1, Fleet::flights);
        let every = *self.look_every.get_or_insert(usual.next_multiple_of(flights));
        let most = *self.most_runs.get_or_insert(size.runs());
        let stated = self.first_look.map(|first| ("first_look", first));
        for (key, number) in [("look_every", every), ("most_runs", most)].into_iter().chain(stated)
        {
            if !number.is_multiple_of(flights) {
                let problem = format!(
                    "{number}: it must be a multiple of {flights}, the flights of a vehicle"
                );
                return refused(key, problem);
            }
        }
        if most < size.runs() {
            let problem = format!("{most}: it must be at least runs, which is {}", size.runs());
            return refused("most_runs", problem);
        }
        size.of_all(most).map_err(|problem| ScenarioError::field("until.most_runs", problem))?;
        let until = Until::new(self.rule.clone(), every, most)
            .and_then(|until| until.with_first_look(self.first_look));
        until.map_err(|error| ScenarioError::field(FIELD, error))
    }
}

#[cfg(test)]
mod tests {
    use crate::Scenario;

    /// With any number of flights: looks are at whole vehicles, and at one at least.
    #[test]
    fn looks_are_at_whole_vehicles() {
        let peck = Scenario::peck_2003().unwrap().to_toml();
        let rest: Vec<&str> = peck.lines().filter(|line| !line.starts_with("runs =")).collect();
        for flights in 1..6 {
            for (key, number) in ["first_look", "look_every", "most_runs"]
                .into_iter()
                .flat_map(|key| (0..40).map(move |number| (key, number)))
            {
                let size = format!("vehicles = 1\nflights = {flights}");
                let rule = "rule = \"mean(nutation_deg) within 1\"";
                let text =
                    format!("{size}\n{}\n[until]\n{rule}\n{key} = {number}\n", rest.join("\n"));
                let given = Scenario::from_toml(&text);
                assert_eq!(given.is_ok(), number > 0 && number % flights == 0, "{text}");
                let refused = given.map_or_else(|error| error.to_string(), |_| key.to_owned());
                assert!(refused.contains(key), "{refused}");
            }
        }
    }

    /// Another rule, or another number of runs between looks, leaves the rest as the scenario has it.
    #[test]
    fn what_is_not_said_of_a_rule_is_that_of_the_scenario() {
        let peck = Scenario::peck_2003().unwrap().to_toml();
        let rest: Vec<&str> = peck.lines().filter(|line| !line.starts_with("runs =")).collect();
        const OWN: &str = "mean(nutation_deg) within 1";
        let most = [("runs = 60", Some(200)), ("", Some(200)), ("runs = 60", None)];
        let looks =
            [None, Some(20)].into_iter().flat_map(|every| [(every, None), (every, Some(50))]);
        for ((own, most), (looks, first_look)) in
            most.into_iter().flat_map(|most| looks.clone().map(move |looks| (most, looks)))
        {
            let line = |key, number: Option<u64>| {
                number.map_or(String::new(), |number| format!("{key} = {number}\n"))
            };
            let [most_runs, looked] = [line("most_runs", most), line("look_every", looks)];
            let first = line("first_look", first_look);
            let until = format!("[until]\nrule = \"{OWN}\"\n{most_runs}{looked}{first}");
            let text = format!("{own}\n{}\n{until}", rest.join("\n"));
            for look_every in [None, Some(40)] {
                for rule in [None, Some(OWN), Some("mean(cone_deg) within 2")] {
                    let given = rule.map(|rule| rule.parse().unwrap());
                    let scenario = Scenario::from_toml(&text).unwrap();
                    let scenario = scenario.with_until(given, look_every).unwrap();
                    let again = Scenario::from_toml(&scenario.to_toml()).unwrap();
                    for scenario in [&scenario, &again] {
                        let until = scenario.until().unwrap();
                        assert_eq!(until.most_runs(), most.unwrap_or(60), "{text}");
                        assert_eq!(until.rule().to_string(), rule.unwrap_or(OWN), "{text}");
                        let first = until.looks().next();
                        let every = look_every.or(looks).unwrap_or(1000);
                        // That of another rule is not this one's.
                        let said = first_look.filter(|_| rule.is_none_or(|rule| rule == OWN));
                        assert_eq!(until.first_look(), said, "{text}");
                        let expected = said.unwrap_or(every).min(until.most_runs());
                        assert_eq!(first, Some(expected), "{text}");
                    }
                    // A number of runs that is said is the greatest.
                    let fewer = scenario.with_runs(90).unwrap();
                    assert_eq!(fewer.until().unwrap().most_runs(), 90);
                }
            }
        }
    }
}
