//! Alerts that say the same of several models or columns, told in one text.

use gyradius_report::{Text, first_names, significant};

use super::{Alert, HEAVY};

/// Outcomes of a model that are named.
const OUTCOMES: usize = 4;
/// Dispersions of a model that are named.
const DISPERSIONS: usize = 8;
/// What is said of events that vehicles draw, as they fly more often than that.
const DRAWN_ONCE: &str = ", drawn once for each vehicle,";
/// Groups of models whose dispersions are named.
const GROUPS: usize = 8;

/// Which outcomes have heavy tails, and what that means.
pub(super) fn heavy_tails(alerts: &[Alert]) -> Text {
    fn of(alert: &Alert) -> Option<(&str, String)> {
        let Alert::HeavyTails { model, outcomes } = alert else { return None };
        let mut heaviest: Vec<&(String, f64)> = outcomes.iter().collect();
        heaviest.sort_by(|a, b| b.1.total_cmp(&a.1));
        let said = heaviest
            .iter()
            .map(|(label, kurtosis)| format!("{label} ({})", significant(*kurtosis, 3)));
        Some((model.as_str(), first_names(said, OUTCOMES)))
    }
    let models: Vec<_> = alerts.iter().filter_map(of).collect();
    of_models("Heavy tails", "in", &models).plain(format!(
        ". A few runs lie far from all others. In brackets is the kurtosis, 3 for a normal distribution; above {HEAVY}, standard \
         deviations are less certain than their intervals say."
    ))
}

/// Which outcomes few runs have, and what that means.
pub(super) fn few_values(alerts: &[Alert]) -> Text {
    fn of(alert: &Alert) -> Option<(&str, String)> {
        let Alert::FewValues { model, outcomes, runs } = alert else { return None };
        let said = outcomes.iter().map(|(label, n)| format!("{label} ({n} of {runs} runs)"));
        Some((model.as_str(), first_names(said, OUTCOMES)))
    }
    let models: Vec<_> = alerts.iter().filter_map(of).collect();
    of_models("Few runs have a value", "of", &models).plain(
        ". Less than half of the runs that did not fail have a value of these outcomes, and their means, standard deviations and \
         percentiles are of these runs alone.",
    )
}

/// A heading, and what is said of each model by its name, behind a word; of one model its name stands in the heading.
fn of_models(heading: &str, before: &str, models: &[(&str, String)]) -> Text {
    if let [(model, said)] = models {
        let mut letters = heading.chars();
        let first = letters.next().map(|first| first.to_lowercase().to_string());
        let heading = format!("{model}: {}{}", first.unwrap_or_default(), letters.as_str());
        return Text::default().strong(heading).plain(format!(" {before} {said}"));
    }
    let told: Vec<String> =
        models.iter().map(|(model, said)| format!(" {model}: {said}")).collect();
    Text::default().strong(heading).plain(":").plain(told.join(";"))
}

/// What is the same in all runs of models.
struct Unmoved<'a> {
    models: Vec<&'a str>,
    runs: u64,
    /// Columns with their values.
    columns: Vec<(&'a str, f64)>,
}

/// Which dispersions moved nothing in the runs of which models.
pub(super) fn unmoved(alerts: &[Alert]) -> Text {
    let mut of_models: Vec<Unmoved<'_>> = Vec::new();
    // Of events that never happened and of those that always did, drawn by runs and by vehicles: probabilities and draws.
    let mut events: [[Vec<(f64, u64)>; 2]; 2] = Default::default();
    let mut is_of_one_vehicle = false;
    for alert in alerts {
        let Alert::Unmoved { model, column, value, runs, vehicles, probability } = alert else {
            continue;
        };
        let own = |of: &&mut Unmoved<'_>| of.models == [model.as_str()] && of.runs == *runs;
        match of_models.iter_mut().find(own) {
            Some(of) => of.columns.push((column, *value)),
            None => {
                let (models, columns) = (vec![model.as_str()], vec![(column.as_str(), *value)]);
                of_models.push(Unmoved { models, runs: *runs, columns });
            }
        }
        let event = probability.map(|probability| (probability, vehicles.unwrap_or(*runs)));
        events[usize::from(*value != 0.0)][usize::from(vehicles.is_some())].extend(event);
        is_of_one_vehicle |= *vehicles == Some(1);
    }
    let mut groups: Vec<Unmoved<'_>> = Vec::new();
    for of in of_models {
        let same = |other: &&mut Unmoved<'_>| other.runs == of.runs && other.columns == of.columns;
        match groups.iter_mut().find(same) {
            Some(group) => group.models.extend(of.models),
            None => groups.push(of),
        }
    }
    let mut text = Text::default().strong("Some dispersions moved nothing").plain(
        ": what is declared as dispersed is the same in all runs, and the results say nothing of what it does.",
    );
    for group in groups.iter().take(GROUPS) {
        let runs = group.runs;
        text = text.plain(format!(" In all {runs} runs of {}: ", group.models.join(", ")));
        for (place, (column, value)) in group.columns.iter().take(DISPERSIONS).enumerate() {
            text = text.plain(if place > 0 { ", " } else { "" }).code(*column);
            text = text.plain(format!(" = {}", significant(*value, 5)));
        }
        let others = group.columns.len().saturating_sub(DISPERSIONS);
        text = text.plain(if others > 0 { format!(" and {others} more.") } else { ".".to_owned() });
    }
    let others: usize = groups.iter().skip(GROUPS).map(|group| group.models.len()).sum();
    if others > 0 {
        text = text.plain(format!(" So it is with others in {others} more models: "));
        text = text.code("summary.json").plain(" has all of them.");
    }
    for (events, seen) in events.iter().zip(["not seen in", "seen in each of"]) {
        for (events, [drawn, runs]) in events.iter().zip([["", "run"], [DRAWN_ONCE, "vehicle"]]) {
            let probabilities = span(events.iter().map(|(probability, _)| *probability));
            let draws = span(events.iter().map(|(_, draws)| *draws as f64));
            let Some((probabilities, draws)) = probabilities.zip(draws) else { continue };
            let plural = if draws == "1" { "" } else { "s" };
            text = text.plain(format!(
                " An event with a probability of {probabilities}{drawn} was {seen} {draws} {runs}{plural}."
            ));
        }
    }
    if is_of_one_vehicle {
        text = text.plain(
            " There is only one vehicle, so that what is drawn once for each vehicle is the same in all of its flights.",
        );
    }
    text
}

/// From the smallest to the largest of numbers; none of none.
fn span(numbers: impl Iterator<Item = f64>) -> Option<String> {
    let ends = numbers.map(|x| [x, x]).reduce(|[a, b], [c, d]| [a.min(c), b.max(d)])?;
    let [least, most] = ends.map(|x| x.to_string());
    Some(if least == most { least } else { format!("{least} to {most}") })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alerts::section;

    /// What heavy tails mean is told once, however many models have them, and of each model which outcomes.
    #[test]
    fn heavy_tails_are_told_once() {
        for models in [1, 2, 5] {
            let outcomes =
                |i: i32| vec![(format!("outcome {i}"), 12.0), (format!("other {i}"), 40.0)];
            let heavy =
                |i: i32| Alert::HeavyTails { model: format!("m{i}"), outcomes: outcomes(i) };
            let (model, kinds) = ("m0".to_owned(), Vec::new());
            let failed = Alert::Failed { model, failed: 1, runs: 2, kinds, first: None };
            let alerts: Vec<Alert> =
                (0..models).map(heavy).flat_map(|of| [of, failed.clone()]).collect();
            let page = gyradius_report::Document::new("t", "h", "l").sections(section(&alerts));
            let page = page.markdown();
            assert_eq!(page.matches("In brackets is the kurtosis").count(), 1, "{page}");
            for i in 0..models {
                assert!(page.contains(&format!("other {i} (40.0), outcome {i} (12.0)")), "{page}");
                assert!(page.contains(&format!("m{i}")));
            }
            assert_eq!(page.matches("runs failed").count(), models as usize);
        }
    }

    /// Dispersions that moved nothing, of any number of models and columns, are told in one box, which names them, says how many more there
    /// are, and of events the probability and the runs.
    #[test]
    fn what_moved_nothing_is_told_once() {
        for models in [1_usize, 2, 3, 9, 24] {
            for columns in [1_usize, 2, 8, 9, 60] {
                for alike in [true, false] {
                    for probability in [None, Some(1e-4)] {
                        let unmoved = |model: usize, column: usize| Alert::Unmoved {
                            model: format!("m{model}"),
                            // Models that are not alike have other columns each.
                            column: format!("c{}_{column}", if alike { 0 } else { model }),
                            value: 0.0,
                            runs: 5000,
                            vehicles: None,
                            probability,
                        };
                        let alerts: Vec<Alert> = (0..models)
                            .flat_map(|model| {
                                (0..columns).map(move |column| unmoved(model, column))
                            })
                            .collect();
                        let page = gyradius_report::Document::new("t", "h", "l")
                            .sections(section(&alerts));
                        let page = page.markdown();
                        assert_eq!(
                            page.matches("Some dispersions moved nothing").count(),
                            1,
                            "{page}"
                        );
                        assert!(page.len() < 4000, "{}", page.len());
                        let clauses = if alike { 1 } else { models };
                        assert_eq!(
                            page.matches("In all 5000 runs of ").count(),
                            clauses.min(8),
                            "{page}"
                        );
                        assert_eq!(page.matches("_0` = 0").count(), clauses.min(8), "{page}");
                        let more = columns.saturating_sub(8);
                        assert_eq!(
                            page.contains(&format!(" and {more} more.")),
                            more > 0,
                            "{page}"
                        );
                        assert_eq!(page.contains("more models"), clauses > 8, "{page}");
                        if alike {
                            assert!(
                                (0..models).all(|model| page.contains(&format!("m{model}"))),
                                "{page}"
                            );
                        }
                        let event =
                            "An event with a probability of 0.0001 was not seen in 5000 runs.";
                        assert_eq!(page.contains(event), probability.is_some(), "{page}");
                    }
                }
            }
        }
    }
}
