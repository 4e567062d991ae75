//! The figure of a run: rates, nutation, spring forces and energies against time.

use nalgebra::Vector3;

use super::{
    Replay,
    history::{Moment, energies},
};
use crate::loads::Short;
use gyradius_report::{Chart, Curve, Hue, time_charts};

/// How far beyond the last release the left half and the energies show, relative.
const BEYOND: f64 = 1.15;

/// Colours of the bodies and of the springs, in every chart and in the animation.
const PAYLOAD: Hue = Hue::Series(0);
const STAGE: Hue = Hue::Series(1);
const SPRINGS: Hue = Hue::Series(2);

/// Loads in turn have the colours that no body has.
fn load_hue(place: usize) -> Hue {
    Hue::Series(2 + place % 4)
}

pub(super) fn svg(replay: &Replay) -> String {
    let history = &replay.history;
    let (end, pushing) = (history.end_s(), history.pushing_s());
    let near = f64::min(BEYOND * pushing, end);
    let curve = |name: String, hue: Hue, of: &dyn Fn(&Moment) -> Option<f64>| Curve {
        name,
        hue,
        points: history
            .for_figures()
            .iter()
            .filter_map(|m| Some((m.now.time_s(), of(m)?)))
            .collect(),
    };
    let rates = |stage: bool| -> Vec<Curve> {
        let rate = move |m: &Moment, i: usize| {
            let body = if stage { m.now.stage() } else { m.now.payload() };
            Some(body.state().angular_velocity[i].to_degrees())
        };
        let name = |i: usize| ["ω₁", "ω₂", "ω₃"][i].to_owned();
        (0..3).map(|i| curve(name(i), Hue::Axis(i), &move |m| rate(m, i))).collect()
    };
    let axis = replay.scenario.spin_axis();
    let nutation = || {
        vec![curve("payload".to_owned(), PAYLOAD, &|m| history.nutation_deg(m.now.payload(), axis))]
    };
    let forces = history.loads.iter().enumerate();
    // None of them has the colour of a body.
    let forces = forces
        .map(|(i, load)| {
            let force = move |m: &Moment| Some(m.now.loads()[i].force_n().norm());
            curve(Short(*load).to_string(), load_hue(i), &force)
        })
        .collect();
    let kinds = [
        ("springs", SPRINGS),
        ("payload moves", PAYLOAD),
        ("payload turns", PAYLOAD),
        ("stage moves", STAGE),
        ("stage turns", STAGE),
    ];
    let parts = |of: &[usize]| -> Vec<Curve> {
        let part = |i: usize| {
            curve(kinds[i].0.to_owned(), kinds[i].1, &move |m| Some(energies(&m.now)[i]))
        };
        of.iter().map(|i| part(*i)).collect()
    };
    let distance = |m: &Moment| -> Option<f64> {
        let between: Vector3<f64> =
            m.now.payload().state().position - m.now.stage().state().position;
        Some(between.norm())
    };
    let chart = |label: &str, curves: Vec<Curve>, until: f64| Chart {
        label: label.to_owned(),
        curves,
        until,
    };
    let both = |label: &str, curves: &dyn Fn() -> Vec<Curve>| {
        [chart(label, curves(), near), chart(label, curves(), end)]
    };
    let apart = vec![curve(String::new(), Hue::Ink, &distance)];
    let mut charts = vec![
        chart("spring forces (N)", forces, near),
        chart("distance of the mass centres (m)", apart, end),
    ];
    charts.extend(both("payload rates (deg/s)", &|| rates(false)));
    charts.extend(both("stage rates (deg/s)", &|| rates(true)));
    charts.extend(both("nutation (deg)", &nutation));
    // Of rotation, too, nothing changes after the last release.
    charts.push(chart("energy (J)", parts(&[0, 1, 3]), near));
    charts.push(chart("energy of rotation (J)", parts(&[2, 4]), near));
    let title = format!("{}: {}, run {}", replay.scenario.name(), replay.model, replay.row().run());
    let marks: Vec<_> =
        history.releases.iter().map(|(load, time)| (Short(*load).to_string(), *time)).collect();
    time_charts(&title, &charts, &marks)
}
