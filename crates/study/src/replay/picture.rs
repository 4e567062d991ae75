//! The figure of a run: rates, nutation, spring forces and energies against time.

use nalgebra::Vector3;

use super::{
    Replay,
    history::{Moment, energies},
};
use crate::loads::Short;
use gyradius_report::{Chart, Colours, Curve, time_charts};

/// How far beyond the last release the left half shows, relative.
const BEYOND: f64 = 1.15;

pub(super) fn svg(replay: &Replay) -> String {
    let history = &replay.history;
    let (end, pushing) = (history.end_s(), history.pushing_s());
    let near = f64::min(BEYOND * pushing, end);
    let curve = |name: String, of: &dyn Fn(&Moment) -> Option<f64>| Curve {
        name,
        points: history.moments.iter().filter_map(|m| Some((m.now.time_s(), of(m)?))).collect(),
    };
    let rates = |stage: bool| -> Vec<Curve> {
        let rate = move |m: &Moment, i: usize| {
            let body = if stage { m.now.stage() } else { m.now.payload() };
            Some(body.state().angular_velocity[i].to_degrees())
        };
        let name = |i: usize| ["ω₁", "ω₂", "ω₃"][i].to_owned();
        (0..3).map(|i| curve(name(i), &move |m| rate(m, i))).collect()
    };
    let axis = replay.scenario.spin_axis();
    let nutation =
        || vec![curve("payload".to_owned(), &|m| history.nutation_deg(m.now.payload(), axis))];
    let forces = history.loads.iter().enumerate();
    let forces = forces
        .map(|(i, load)| {
            curve(Short(*load).to_string(), &move |m| Some(m.now.loads()[i].force_n().norm()))
        })
        .collect();
    let kinds = ["springs", "payload moves", "payload turns", "stage moves", "stage turns"];
    let parts = |of: &[usize]| -> Vec<Curve> {
        of.iter()
            .map(|&i| curve(kinds[i].to_owned(), &move |m| Some(energies(&m.now)[i])))
            .collect()
    };
    let distance = |m: &Moment| -> Option<f64> {
        let between: Vector3<f64> =
            m.now.payload().state().position - m.now.stage().state().position;
        Some(between.norm())
    };
    let chart = |label: &str, colours: Colours, curves: Vec<Curve>, until: f64| Chart {
        label: label.to_owned(),
        colours,
        curves,
        until,
    };
    let both = |label: &str, colours: Colours, curves: &dyn Fn() -> Vec<Curve>| {
        [chart(label, colours, curves(), near), chart(label, colours, curves(), end)]
    };
    let mut charts = vec![
        chart("spring forces (N)", Colours::Series, forces, near),
        chart(
            "distance of the mass centres (m)",
            Colours::Series,
            vec![curve(String::new(), &distance)],
            end,
        ),
    ];
    charts.extend(both("payload rates (deg/s)", Colours::Axes, &|| rates(false)));
    charts.extend(both("stage rates (deg/s)", Colours::Axes, &|| rates(true)));
    charts.extend(both("nutation (deg)", Colours::Series, &nutation));
    charts.push(chart("energy (J)", Colours::Series, parts(&[0, 1, 3]), near));
    charts.push(chart("energy of rotation (J)", Colours::Series, parts(&[2, 4]), near));
    let title = format!("{}: {}, run {}", replay.scenario.name(), replay.model, replay.row().run());
    let marks: Vec<_> =
        history.releases.iter().map(|(load, time)| (Short(*load).to_string(), *time)).collect();
    time_charts(&title, &charts, &marks)
}
