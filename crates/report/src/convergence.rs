//! How the share of runs that fail a requirement comes to rest with the number of runs: a line a model, with its interval.

use gyradius_campaign::{ConvergencePoint, Looks, Requirement, stated_in_percent};
use gyradius_statistics::Interval;
use std::collections::BTreeSet;

use crate::axis::{Spacing, Tick, Units, decades, ticks};
use crate::field::{ACROSS, Field, HIGH, band_pen, line_pen, required_pen};
use crate::lines::{mark_pen, marker};
use crate::style;
use crate::svg::px;
use crate::text::significant;
use crate::{Drawing, JudgedModel};

/// The share of runs that fail a requirement among the first so many, under models. Nothing is computed here but places: the numbers
/// are those of the judgements. Where a rule looked at the runs while they were done stand marks along the bottom, at how many counted then.
#[must_use]
pub fn convergence_figure(
    name: &str,
    caption: &str,
    requirement: &Requirement,
    models: &[JudgedModel<'_>],
) -> Drawing {
    Drawing::new(name, caption, svg(requirement, models))
}

fn svg(requirement: &Requirement, models: &[JudgedModel<'_>]) -> String {
    let title = format!("Convergence: {}", requirement.name());
    let allowed = 1.0 - requirement.probability();
    let estimates = || models.iter().flat_map(|model| model.judgement.convergence());
    let last = models.iter().filter_map(|model| model.judgement.convergence().last());
    // Wide intervals of a few runs leave the plot, so that what matters can be read.
    let top = last.map(|e| 1.8 * e.interval.upper()).fold(2.2 * allowed, f64::max);
    let top = 100.0 * top.min(1.02);
    let units = Units::for_range(0.0, top);
    let spacing = Spacing { length: HIGH, most: 6, side_by_side: None, whole: false };
    let up = ticks(0.0, units.of(top), spacing).into_iter();
    let up: Vec<Tick> =
        up.map(|tick| Tick { at: tick.at / units.of(top) * HIGH, ..tick }).collect();
    let y = |share: f64| px(HIGH - (100.0 * share / top).clamp(0.0, 1.0) * HIGH);

    let (first, end) = range(estimates().map(|e| (e.runs as f64).log10()));
    let place = |log: f64| (log - first) / (end - first) * ACROSS;
    let x = |e: &ConvergencePoint| place((e.runs as f64).log10());
    let across = decades([first, end]).into_iter();
    let across: Vec<Tick> = across.map(|tick| Tick { at: place(tick.at), ..tick }).collect();

    let shares = format!("share of the runs that fail it (%)  {}", units.note());
    let mut field = Field::new(&across, &up, ["runs that count", shares.trim_end()]);
    for &JudgedModel { name, colour, judgement } in models {
        let estimates = judgement.convergence();
        let corner = |e: &ConvergencePoint, by: f64, share: f64| {
            format!("{} {}", px((x(e) + by).clamp(0.0, ACROSS)), y(share))
        };
        // The interval of a single number of runs is a bar, for a band would have no width.
        let sides: &[f64] = if estimates.len() == 1 { &[-5.0, 5.0] } else { &[0.0] };
        let edge = |share: fn(&Interval) -> f64| {
            let corners = estimates.iter().flat_map(move |e| sides.iter().map(move |by| (e, *by)));
            corners.map(|(e, by)| corner(e, by, share(&e.interval))).collect::<Vec<_>>()
        };
        let band: Vec<String> = edge(Interval::upper)
            .into_iter()
            .chain(edge(Interval::lower).into_iter().rev())
            .collect();
        if !band.is_empty() {
            field.plot.path(&band_pen(colour), &format!("M{}z", band.join("L")));
        }
        field.entry(name, |swatch| {
            swatch.path(&band_pen(colour), "M0 -6h26v12h-26z");
            swatch.path(&line_pen(colour), "M0 0h26");
            swatch.path(&mark_pen(colour), &marker(colour, 13.0, 0.0));
        });
    }
    field.plot.path(&required_pen(), &format!("M0 {}h{}", y(allowed), px(ACROSS)));
    let mut above = Vec::new();
    for &JudgedModel { name, colour, judgement } in models {
        let (mut d, mut marks) = (String::new(), String::new());
        let all = judgement.convergence().iter();
        let at = |e: &ConvergencePoint| [place((e.runs as f64).log10()), 100.0 * e.failing / top];
        let points: Vec<[f64; 2]> = all.map(at).collect();
        for pair in points.windows(2) {
            // What is above the plot is not in it, nor is the line that leads there.
            if let Some(ends) = below_top(pair[0], pair[1]) {
                let [from, to] = ends.map(|[x, y]| format!("{} {}", px(x), px(HIGH - y * HIGH)));
                d.push_str(&format!("M{from}L{to}"));
            }
        }
        for [x, up] in points.iter().filter(|[_, up]| *up <= 1.0) {
            marks.push_str(&marker(colour, *x, HIGH - up * HIGH));
        }
        if let Some(highest) =
            points.iter().map(|[_, up]| *up).filter(|up| *up > 1.0).reduce(f64::max)
        {
            let highest = significant(highest * top, 3);
            above.push(format!("{name}: up to {highest} % in the first runs, above this axis."));
        }
        field.plot.path(&line_pen(colour), &d);
        field.plot.path(&mark_pen(colour), &marks);
    }
    // Where models leave out different runs, each has its own.
    let looks = models.iter().flat_map(|model| model.judgement.counted_at_looks());
    let looks: BTreeSet<u64> = looks.copied().collect();
    if !looks.is_empty() {
        let ticks = looks.iter().map(|runs| place((*runs as f64).log10()));
        // Where the looks before the first estimate would stand is no place.
        let ticks = ticks.filter(|at| (0.0..=ACROSS).contains(at));
        let d: String = ticks.map(|at| format!("M{} {}v-9", px(at), px(HIGH))).collect();
        let pen = format!("stroke=\"{}\" stroke-width=\"2\"", style::MUTED);
        field.plot.path(&pen, &d);
        field.entry("looks of the rule", |swatch| swatch.path(&pen, "M13 6v-12"));
    }
    field.entry(format!("allowed: {}", stated_in_percent(allowed)), |swatch| {
        swatch.path(&required_pen(), "M0 0h26");
    });
    let confidence = stated_in_percent(requirement.confidence().level());
    let often = models.iter().any(|model| model.judgement.looks() == Looks::Often);
    let intervals =
        if often { "intervals that hold together" } else { "interval at each number of runs" };
    field.entry(format!("shaded: {confidence} {intervals}"), |swatch| {
        let pen = format!("fill=\"{}\" fill-opacity=\"0.3\"", style::MUTED);
        swatch.path(&pen, "M0 -6h26v12h-26z");
    });
    if estimates().any(|e| 100.0 * e.interval.upper() > top) {
        above.push("Intervals of the first runs go on above this axis.".to_owned());
    }
    if estimates().next().is_none() {
        above.push("No run counts, so that there is no share to show.".to_owned());
    }
    above.into_iter().for_each(|note| field.note(note));
    field.finish(&title, &description(models))
}

/// From where to where an axis is on which these are, the logarithms of numbers of runs: half a decade at least, which always
/// holds a tick, with room to each side.
pub(crate) fn range(logs: impl Iterator<Item = f64>) -> (f64, f64) {
    let (first, end) =
        logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, u), x| (l.min(x), u.max(x)));
    if first > end {
        return (1.0, 2.0);
    }
    let room = (first + 0.5 - end).max(0.0);
    (first - 0.25 * room, end + 0.75 * room)
}

/// What of the line between two points, whose heights are shares of the plot's, is not above the plot.
fn below_top(a: [f64; 2], b: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    // Where the line crosses the upper edge.
    let edge = || [a[0] + (b[0] - a[0]) * (1.0 - a[1]) / (b[1] - a[1]), 1.0];
    match (a[1] <= 1.0, b[1] <= 1.0) {
        (true, true) => Some([a, b]),
        (true, false) => Some([a, edge()]),
        (false, true) => Some([edge(), b]),
        (false, false) => None,
    }
}

/// The figure in words.
fn description(models: &[JudgedModel<'_>]) -> String {
    let mut text = "Share of the runs that fail it, against the number of runs.".to_owned();
    for &JudgedModel { name, judgement, .. } in models {
        let told: Vec<String> = judgement
            .convergence()
            .iter()
            .rev()
            .step_by(6)
            .map(|e| format!("{} % of {}", significant(100.0 * e.failing, 3), e.runs))
            .collect();
        let told = if told.is_empty() { "no run counts".to_owned() } else { told.join(", ") };
        text.push_str(&format!(" {name}: {told}."));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever the numbers of runs are, they are on the axis, and so is a tick.
    #[test]
    fn every_axis_has_a_tick() {
        for few in 1..400_u32 {
            for many in few..400 {
                let logs = [few, many].map(|runs| f64::from(runs).log10());
                let (first, end) = range(logs.into_iter());
                assert!(first <= logs[0] && logs[1] <= end, "{few} {many}");
                assert!(!decades([first, end]).is_empty(), "{few} {many}");
            }
        }
        assert_eq!(range(std::iter::empty()), (1.0, 2.0));
    }
}
