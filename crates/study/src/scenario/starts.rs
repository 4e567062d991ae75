//! That every load of a separation starts before the horizon, at which all runs end.

use gyradius_separation::{Separation, Settings};

use super::load;
use crate::ScenarioError;

/// Refuses a load that can push and starts at the horizon or later: every run would fail.
pub(super) fn check(separation: &Separation, settings: &Settings) -> Result<(), ScenarioError> {
    let horizon = settings.horizon_s();
    for (id, load) in separation.loads().filter(|(_, load)| load.can_push()) {
        if let Some(start) = load.start_s().filter(|start| *start >= horizon) {
            let problem = format!(
                "{start:?} s: it must be before the horizon, {horizon:?} s, at which every run ends; \
                 integration.horizon_s may be longer"
            );
            return Err(ScenarioError::field(format!("{}.start_s", load::key(id)), problem));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::Scenario;

    /// A spring that starts at the horizon or later acts in no run, unless it never acts: its friction is beyond its force.
    #[test]
    fn springs_start_before_the_horizon() {
        let text = include_str!("peck-2003.toml");
        for horizon in [1e-3_f64, 0.5, 60.0, 1e5] {
            let starts = [
                0.0,
                0.5 * horizon,
                horizon.next_down(),
                horizon,
                horizon.next_up(),
                2.0 * horizon,
            ];
            for (spring, start) in (0..4).flat_map(|spring| starts.map(|start| (spring, start))) {
                for never in [false, true] {
                    let mut table: toml::Table = toml::from_str(text).unwrap();
                    let mut integration = toml::Table::new();
                    integration.insert("horizon_s".to_owned(), horizon.into());
                    table.insert("integration".to_owned(), integration.into());
                    let late = table["springs"][spring].as_table_mut().unwrap();
                    late.insert("start_s".to_owned(), start.into());
                    if never {
                        late.insert("friction_n".to_owned(), 1e12.into());
                    }
                    let given = Scenario::from_toml(&toml::to_string(&table).unwrap());
                    let refused = given.as_ref().err().map(ToString::to_string);
                    let of_start = refused.filter(|message| message.contains("start_s"));
                    let field =
                        format!("springs[{}].start_s: {start:?} s: it must be before", spring + 1);
                    let told = of_start.as_ref().is_some_and(|message| message.starts_with(&field));
                    assert_eq!(told, start >= horizon && !never, "{start} {horizon} {of_start:?}");
                    assert_eq!(of_start.is_some(), told, "{of_start:?}");
                }
            }
        }
    }
}
