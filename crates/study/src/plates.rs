//! The figures of a study, numbered as in the paper.

use nalgebra::UnitQuaternion;

use crate::{
    figures::{Cloud, Panel, Series, attitude_spheres, histogram_grid},
    quantity::{Body, Entry, Quantity},
    scenario::Scenario,
    summary::Summary,
    table::RunTable,
};

/// A figure with what it shows.
#[derive(Clone, Debug)]
pub(crate) struct Plate {
    /// Name of its file, without the ending.
    pub(crate) name: String,
    pub(crate) caption: String,
    pub(crate) svg: String,
}

pub(crate) fn of_study(scenario: &Scenario, summary: &Summary, tables: &[RunTable]) -> Vec<Plate> {
    // Other vehicles have no figures of the paper to be compared with.
    let numbered = |what: &str, number: &str| match scenario.source() {
        Some(_) => format!("{what} ({number})"),
        None => what.to_owned(),
    };
    let mut plates: Vec<Plate> = attitudes(scenario, tables, &numbered).into_iter().collect();
    for comparison in scenario.comparisons() {
        let (physical, naive) = (&tables[comparison.physical], &tables[comparison.naive]);
        let pair = format!("{}-vs-{}", physical.model(), naive.model());
        let title = |what: &str| format!("{what}: {} and {}", physical.model(), naive.model());
        let grid = |name: &str, what: &str, quantities: &[Option<Quantity>], columns: usize| {
            let samples: Vec<Option<[Vec<f64>; 2]>> = quantities
                .iter()
                .map(|q| q.map(|q| [physical.values(q), naive.values(q)]))
                .collect();
            let panels: Vec<Option<Panel<'_>>> = quantities
                .iter()
                .zip(&samples)
                .map(|(quantity, samples)| {
                    let (quantity, [a, b]) = ((*quantity)?, samples.as_ref()?);
                    Some(Panel {
                        label: axis_label(quantity),
                        series: vec![
                            Series {
                                name: physical.model(),
                                values: a,
                                runs: physical.rows().len(),
                            },
                            Series { name: naive.model(), values: b, runs: naive.rows().len() },
                        ],
                        nominal: summary.nominal_value(quantity),
                    })
                })
                .collect();
            Plate {
                name: format!("{name}-{pair}"),
                caption: format!("{}. {}", comparison.title, title(what)),
                svg: histogram_grid(&title(what), &panels, columns),
            }
        };
        plates.push(grid(
            "figure-4-7",
            &numbered("Inertia ratio and wobble", "Figures 4 and 7"),
            &[Some(Quantity::InertiaRatio), Some(Quantity::Wobble)],
            2,
        ));
        plates.push(grid(
            "figure-5-8-payload",
            &numbered("Inertia of the payload, in matrix order", "Figures 5 and 8"),
            &matrix_order(Body::Payload),
            3,
        ));
        plates.push(grid(
            "figure-5-8-stage",
            &numbered("Inertia of the stage, in matrix order", "Figures 5 and 8"),
            &matrix_order(Body::Stage),
            3,
        ));
        plates.push(grid(
            "figure-6-9",
            &numbered("Wobble, nutation and coning", "Figures 6 and 9"),
            &[Some(Quantity::Wobble), Some(Quantity::Nutation), Some(Quantity::Cone)],
            3,
        ));
    }
    plates.extend(clearance(scenario, summary, tables));
    plates.extend(summary.every_model.plate());
    plates
}

/// How near the bodies come: a comparison a panel, or a model where nothing is compared.
fn clearance(scenario: &Scenario, summary: &Summary, tables: &[RunTable]) -> Option<Plate> {
    let samples: Vec<Vec<f64>> = tables.iter().map(|t| t.values(Quantity::Clearance)).collect();
    let compared = scenario.comparisons().iter().map(|c| vec![c.physical, c.naive]);
    let mut groups: Vec<Vec<usize>> = compared.collect();
    if groups.is_empty() {
        groups = (0..tables.len()).map(|i| vec![i]).collect();
    }
    let panels: Vec<Option<Panel<'_>>> = groups
        .into_iter()
        .filter(|group| group.iter().any(|i| !samples[*i].is_empty()))
        .map(|group| {
            let series = |i: usize| Series {
                name: tables[i].model(),
                values: &samples[i],
                runs: tables[i].rows().len(),
            };
            Some(Panel {
                label: axis_label(Quantity::Clearance),
                series: group.into_iter().map(series).collect(),
                nominal: summary.nominal_value(Quantity::Clearance),
            })
        })
        .collect();
    let title = "Smallest distance of payload and stage after the last release";
    (!panels.is_empty()).then(|| Plate {
        name: "clearance".to_owned(),
        caption: format!("{title}; runs in which they touch again are at 0"),
        svg: histogram_grid(title, &panels, if panels.len() > 4 { 3 } else { 2 }),
    })
}

/// Figure 1 for every model that draws attitudes.
fn attitudes(
    scenario: &Scenario,
    tables: &[RunTable],
    numbered: &impl Fn(&str, &str) -> String,
) -> Option<Plate> {
    let drawn: Vec<(&RunTable, Vec<UnitQuaternion<f64>>)> = tables
        .iter()
        .map(|t| (t, t.rows().iter().filter_map(|r| r.axes(Body::Payload)).collect::<Vec<_>>()))
        .filter(|(_, attitudes)| !attitudes.is_empty())
        .collect();
    let mean = scenario.payload().mean_axes();
    let clouds: Vec<Cloud<'_>> = drawn
        .iter()
        .map(|(table, attitudes)| Cloud { name: table.model(), attitudes, mean })
        .collect();
    if drawn.is_empty() {
        return None;
    }
    let title = numbered("Principal axes of the payload", "Figure 1");
    Some(Plate {
        name: "figure-1-attitudes".to_owned(),
        caption: format!(
            "{title}. Random attitudes of each model, as the tips of the unit axes on the sphere; of many, \
             some that are evenly spaced in run order"
        ),
        svg: attitude_spheres(&title, &clouds),
    })
}

fn axis_label(quantity: Quantity) -> String {
    match quantity.unit() {
        "1" => quantity.label().into_owned(),
        unit => format!("{} ({unit})", quantity.label()),
    }
}

/// The upper triangle, symmetric entries omitted.
fn matrix_order(body: Body) -> [Option<Quantity>; 9] {
    use Entry::{I11, I12, I13, I22, I23, I33};
    [Some(I11), Some(I12), Some(I13), None, Some(I22), Some(I23), None, None, Some(I33)]
        .map(|entry| entry.map(|e| body.entry(e)))
}
