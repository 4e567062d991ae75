//! The figures of a study, numbered as in the paper.

use gyradius_report::{AttitudeSpheres, Cloud, Figure, HistogramGrid, Panel, Picture, Series};
use rayon::prelude::*;
use std::{collections::BTreeSet, iter};

use crate::{
    body::{Body, Entry},
    compare::EVERY_MODEL,
    configuration::CONFIGURATION,
    decisions, drivers,
    quantity::Quantity,
    scenario::{Comparison, Scenario},
    seen::Seen,
    summary::Summary,
};

const ATTITUDES: &str = "figure-1-attitudes";
/// Of two models that are compared, whose names follow.
const RATIO_AND_WOBBLE: &str = "figure-4-7";
const INERTIA_OF_PAYLOAD: &str = "figure-5-8-payload";
const INERTIA_OF_STAGE: &str = "figure-5-8-stage";
const ANGLES: &str = "figure-6-9";
const CLEARANCE: &str = "clearance";

/// How the names of the figures of each comparison end: by its two models. Where two would be the same, also on a disk that
/// does not tell `A` from `a`, later ones have a number too; names of models may hold `-vs-` and end in numbers.
fn pairs(scenario: &Scenario) -> Vec<String> {
    let models: Vec<&str> = scenario.model_names().collect();
    let mut taken = BTreeSet::new();
    let own = |comparison: &Comparison| {
        let pair = format!("{}-vs-{}", models[comparison.physical], models[comparison.naive]);
        let numbered = (2_usize..).map(|number| format!("{pair}-{number}"));
        let mut free = iter::once(pair.clone()).chain(numbered);
        free.find(|name| taken.insert(name.to_lowercase())).unwrap_or(pair)
    };
    scenario.comparisons().iter().map(own).collect()
}

fn of_pair(name: &str, pair: &str) -> String {
    format!("{name}-{pair}")
}

/// The names of all figures that a study of a scenario may have: known before the runs, so that what is
/// in their way is.
pub(crate) fn names(scenario: &Scenario) -> Vec<String> {
    let mut names = [ATTITUDES, CLEARANCE, EVERY_MODEL, CONFIGURATION].map(str::to_owned).to_vec();
    for pair in pairs(scenario) {
        let paired = [RATIO_AND_WOBBLE, INERTIA_OF_PAYLOAD, INERTIA_OF_STAGE, ANGLES];
        names.extend(paired.map(|name| of_pair(name, &pair)));
    }
    names.extend(decisions::figure_names(scenario.requirements()));
    names.extend(drivers::figure_names(scenario.drivers(), scenario.model_names()));
    names
}

pub(crate) fn of_study(scenario: &Scenario, summary: &Summary, runs: &[Seen]) -> Vec<Figure> {
    // Other vehicles have no figures of the paper to be compared with.
    let numbered = |what: &str, number: &str| match scenario.source() {
        Some(_) => format!("{what} ({number})"),
        None => what.to_owned(),
    };
    let names = pairs(scenario);
    let pairs = scenario.comparisons().par_iter().zip(&names).flat_map(|(comparison, pair)| {
        let (physical, naive) = (&runs[comparison.physical], &runs[comparison.naive]);
        let title = |what: &str| format!("{what}: {} and {}", physical.model(), naive.model());
        let grid = |name: &str, what: &str, quantities: &[Option<Quantity>], columns: usize| {
            let panel = |quantity: &Option<Quantity>| {
                let quantity = (*quantity)?;
                Some(Panel {
                    label: quantity.label_with_unit(),
                    series: [physical, naive].map(|seen| series(seen, quantity)).to_vec(),
                    nominal: summary.nominal_value(quantity),
                })
            };
            let panels: Vec<Option<Panel<'_>>> = quantities.iter().map(panel).collect();
            Figure {
                name: of_pair(name, pair),
                caption: format!("{}. {}", comparison.title, title(what)),
                picture: Picture::Histograms(
                    HistogramGrid::new(&title(what), &panels, columns)
                        .in_colours_of(scenario.model_names()),
                ),
            }
        };
        let first = vec![Some(Quantity::InertiaRatio), Some(Quantity::Wobble)];
        let angles = [Quantity::Wobble, Quantity::Nutation, Quantity::Cone].map(Some);
        let inertia = |body: Body| {
            let what = format!("Inertia of the {}, in matrix order", body.name());
            (numbered(&what, "Figures 5 and 8"), matrix_order(body).to_vec())
        };
        let [(payload, of_payload), (stage, of_stage)] = Body::BOTH.map(inertia);
        let figures = [
            (RATIO_AND_WOBBLE, numbered("Inertia ratio and wobble", "Figures 4 and 7"), first, 2),
            (INERTIA_OF_PAYLOAD, payload, of_payload, 3),
            (INERTIA_OF_STAGE, stage, of_stage, 3),
            (
                ANGLES,
                numbered("Wobble, nutation and coning", "Figures 6 and 9"),
                angles.to_vec(),
                3,
            ),
        ];
        let figures = figures
            .par_iter()
            .map(|(name, what, quantities, columns)| grid(name, what, quantities, *columns));
        figures.collect::<Vec<_>>()
    });
    let first = attitudes(scenario, runs, &numbered).into_iter();
    let last = clearance(scenario, summary, runs).into_iter();
    first.chain(pairs.collect::<Vec<_>>()).chain(last).chain(summary.every_model.figure()).collect()
}

/// How near the bodies come: a comparison a panel, and each model that is not compared.
fn clearance(scenario: &Scenario, summary: &Summary, runs: &[Seen]) -> Option<Figure> {
    let found = |i: &usize| runs[*i].quantity(Quantity::Clearance).is_some_and(|s| s.n() > 0);
    let compared = scenario.comparisons().iter().map(|c| vec![c.physical, c.naive]);
    let mut groups: Vec<Vec<usize>> = compared.collect();
    let alone = |i: &usize| !groups.iter().flatten().any(|compared| compared == i);
    let alone: Vec<Vec<usize>> = (0..runs.len()).filter(alone).map(|i| vec![i]).collect();
    groups.extend(alone);
    let panels: Vec<Option<Panel<'_>>> = groups
        .into_iter()
        .filter(|group| group.iter().any(found))
        .map(|group| {
            Some(Panel {
                label: Quantity::Clearance.label_with_unit(),
                series: group.into_iter().map(|i| series(&runs[i], Quantity::Clearance)).collect(),
                nominal: summary.nominal_value(Quantity::Clearance),
            })
        })
        .collect();
    let columns = if panels.len() > 4 { 3 } else { 2 };
    let title = "Smallest distance of payload and stage after the last release";
    (!panels.is_empty()).then(|| Figure {
        name: CLEARANCE.to_owned(),
        caption: format!("{title}; runs in which they touch again are at 0"),
        picture: Picture::Histograms(
            HistogramGrid::new(title, &panels, columns).in_colours_of(scenario.model_names()),
        ),
    })
}

/// Figure 1 for every model that draws attitudes.
fn attitudes(
    scenario: &Scenario,
    runs: &[Seen],
    numbered: &impl Fn(&str, &str) -> String,
) -> Option<Figure> {
    let drawn = runs.iter().filter(|seen| !seen.attitudes.is_empty());
    let mean = scenario.payload().mean_axes();
    let clouds: Vec<Cloud<'_>> =
        drawn.map(|seen| Cloud { name: seen.model(), attitudes: &seen.attitudes, mean }).collect();
    if clouds.is_empty() {
        return None;
    }
    let title = numbered("Principal axes of the payload", "Figure 1");
    Some(Figure {
        name: ATTITUDES.to_owned(),
        caption: format!(
            "{title}. Random attitudes of each model, as the tips of the unit axes on the sphere; of many, \
             some that are evenly spaced in run order"
        ),
        picture: Picture::Attitudes(AttitudeSpheres::new(&title, &clouds)),
    })
}

/// The values of the runs that are kept of a model.
fn series(seen: &Seen, quantity: Quantity) -> Series<'_> {
    Series::surveyed(seen.model(), seen.quantity(quantity), seen.runs())
}

/// The upper triangle, symmetric entries omitted.
fn matrix_order(body: Body) -> [Option<Quantity>; 9] {
    use Entry::{I11, I12, I13, I22, I23, I33};
    [Some(I11), Some(I12), Some(I13), None, Some(I22), Some(I23), None, None, Some(I33)]
        .map(|entry| entry.map(|e| Quantity::entry(body, e)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Options, Study};
    use gyradius_report::file_of;

    /// Whatever the models are called, the figures of a study have different names, also where `A` is `a`; and the study is finished.
    #[test]
    fn figures_have_names_of_their_own() {
        let paper = Scenario::peck_2003().unwrap().to_toml();
        let paper = &paper[..paper.find("[[models]]").unwrap()];
        // Of few pieces, so that names are often the same when they are put together.
        let pieces =
            ["a", "A-vs-b", "c", "b-vs-c", "b", "c-2", "vs-c", "c-vs-a", "a-vs-c", "b-vs-c-2"];
        let text = |from: usize, by: usize| {
            let names: Vec<&str> = (0..5).map(|i| pieces[(from + by * i) % pieces.len()]).collect();
            let mut text = format!(
                "{paper}[[models]]\nname = \"own\"\nlaw = \"principal\"\naxes = \"whole-sphere\"\n"
            );
            for name in &names {
                text += &format!(
                    "[[models]]\nname = {name:?}\nlaw = \"wishart\"\nmatched_to = \"own\"\n"
                );
            }
            for (i, physical) in names.iter().enumerate() {
                for (j, naive) in names.iter().enumerate().filter(|(j, _)| *j != i) {
                    text += &format!(
                        "[[comparisons]]\ntitle = \"{i} {j}\"\nphysical = {physical:?}\nnaive = {naive:?}\n"
                    );
                }
            }
            text
        };
        let (mut checked, mut numbered) = (0, 0);
        for from in 0..pieces.len() {
            for by in [1, 3, 7, 9] {
                let Ok(scenario) = Scenario::from_toml(&text(from, by)) else { continue };
                let all = names(&scenario);
                let different: BTreeSet<String> =
                    all.iter().map(|name| name.to_lowercase()).collect();
                assert_eq!(different.len(), all.len(), "{all:?}");
                checked += 1;
                let plain = |c: &Comparison| {
                    let models: Vec<&str> = scenario.model_names().collect();
                    format!("{}-vs-{}", models[c.physical], models[c.naive])
                };
                let plain: Vec<String> = scenario.comparisons().iter().map(plain).collect();
                numbered += usize::from(plain != pairs(&scenario));
            }
        }
        assert!(checked > 10 && numbered > 3, "{checked} {numbered}");
    }

    /// Scenarios with figures of every kind: each file of a figure is announced before the runs, and a file of
    /// the user's in its place is found then, in every place, and left alone.
    #[test]
    fn what_is_in_the_way_of_a_figure_is_found_before_the_runs() {
        let paper = Scenario::peck_2003().unwrap().to_toml();
        let outlines = "[clearance]\npayload = [{ points_m = [[0.0, 0.0, -0.6]] }]\n\
                        stage = [{ points_m = [[0.0, 0.0, 0.6]] }]\n[payload]\n";
        let other =
            "\n[[comparisons]]\ntitle = \"another\"\nphysical = \"proposed\"\nnaive = \"naive\"\n";
        let alone = paper[..paper.find("[[comparisons]]").unwrap()].to_owned();
        for text in [
            paper.clone(),
            paper.replacen("[payload]\n", outlines, 1) + other,
            alone.replacen("[payload]\n", outlines, 1),
        ] {
            let scenario = Scenario::from_toml(&text).unwrap().with_runs(6).unwrap();
            let names: Vec<String> = names(&scenario).iter().map(|name| file_of(name)).collect();
            let scratch = tempfile::tempdir().unwrap();
            let options = |place: &str| Options::to(scratch.path().join(place));
            let study = Study::run(&scenario, &options("free"), &|_| {}).unwrap();
            let mut written = 0;
            for entry in std::fs::read_dir(study.folder().join("figures")).unwrap() {
                let name = format!("figures/{}", entry.unwrap().file_name().to_str().unwrap());
                assert!(names.contains(&name), "{name}");
                written += 1;
            }
            assert!(written > 1);
            for (i, name) in names.iter().enumerate() {
                let options = Options { force: true, ..options(&format!("taken-{i}")) };
                let mine = options.out.as_ref().unwrap().join(name);
                std::fs::create_dir_all(mine.parent().unwrap()).unwrap();
                std::fs::write(&mine, "mine").unwrap();
                let begun = std::sync::atomic::AtomicBool::new(false);
                let begin = |_| begun.store(true, std::sync::atomic::Ordering::Relaxed);
                let error = Study::run(&scenario, &options, &begin).unwrap_err().to_string();
                assert!(error.contains(name), "{error}");
                assert!(!begun.into_inner(), "{name}");
                assert_eq!(std::fs::read_to_string(&mine).unwrap(), "mine");
            }
        }
    }
}
