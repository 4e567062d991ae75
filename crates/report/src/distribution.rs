//! The distribution of what a requirement is about, on a probability axis: a line a model, its band, the limit, the tolerance point.

use gyradius_campaign::{
    Bound, DistributionPoint, FailedRuns, Judgement, Looks, Requirement, plain, stated_in_percent,
};
use gyradius_statistics::tail;

use crate::axis::Tick;
use crate::field::{ACROSS, Across, Field, HIGH, band_pen, line_pen, required_pen};
use crate::lines::{mark_pen, marker};
use crate::numbers::{digits_of, with_unit};
use crate::style;
use crate::svg::{Svg, px};
use crate::text::{count, significant};
use crate::{Drawing, JudgedModel};

/// Percentages that an axis may have, the lower half of them.
const PERCENT: [f64; 11] = [1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 0.01, 0.1, 1.0, 5.0, 20.0, 50.0];
/// Of every so manieth point there is a marker, and of the outermost all.
const MARKED: usize = 10;

/// The distribution of what a requirement is about under models, each with what its runs say. Nothing is computed here but places:
/// the numbers are those of the judgements. The unit of the quantity is told where there is one to tell.
#[must_use]
pub fn distribution_figure(
    name: &str,
    caption: &str,
    requirement: &Requirement,
    unit: Option<&str>,
    models: &[JudgedModel<'_>],
) -> Drawing {
    Drawing::new(name, caption, svg(requirement, unit, models))
}

fn svg(requirement: &Requirement, unit: Option<&str>, models: &[JudgedModel<'_>]) -> String {
    let title = format!("Distribution: {}", requirement.name());
    let up = Up::new(requirement, models);
    let (across, beyond) = across(requirement.bound(), models);
    let shares = "share of the runs that are at most this (%), on the axis of a normal law";
    let quantity = with_unit(&requirement.quantity().to_string(), unit.unwrap_or("1"));
    let mut field = Field::linear(&across, &up.ticks(), [&quantity, shares]);
    let confidence = stated_in_percent(requirement.confidence().level());
    let probability = stated_in_percent(requirement.probability());
    for &JudgedModel { name, colour, judgement } in models {
        band(&mut field.plot, colour, judgement, &across, &up);
        field.entry(name, |swatch| {
            swatch.path(&band_pen(colour), "M0 -6h26v12h-26z");
            swatch.path(&line_pen(colour), "M0 0h26");
            swatch.path(&mark_pen(colour), &marker(colour, 13.0, 0.0));
        });
    }
    let limits: Vec<f64> = requirement.bound().limits().collect();
    for limit in limits.iter().filter(|limit| !beyond.contains(limit)) {
        let digits = digits_of(*limit, across.span()).max(5);
        field.limit(across.x(*limit), &format!("limit {}", significant(*limit, digits)));
    }
    let required: String =
        up.required().map(|y| format!("M0 {}h{}", px(y), px(ACROSS))).into_iter().collect();
    field.plot.path(&required_pen(), &required);
    for &JudgedModel { colour, judgement, .. } in models {
        line(&mut field.plot, colour, judgement, &across, &up);
        tolerance(&mut field.plot, colour, judgement, &across, &up);
    }
    let often = models.iter().any(|model| model.judgement.looks() == Looks::Often);
    let of_looks = if often { ", if one looks once" } else { "" };
    let holds =
        format!("shaded: holds the whole distribution with {confidence} confidence{of_looks}");
    field.entry(holds, |swatch| {
        let pen = format!("fill=\"{}\" fill-opacity=\"0.3\"", style::MUTED);
        swatch.path(&pen, "M0 -6h26v12h-26z");
    });
    if !required.is_empty() {
        field.entry(format!("required: {probability}"), |swatch| {
            swatch.path(&required_pen(), "M0 0h26");
        });
    }
    if models.iter().any(|model| model.judgement.tolerance().is_some()) {
        let name =
            format!("tolerance point: {probability} keep this, with {confidence} confidence");
        field.entry(name, |swatch| {
            swatch.path(&format!("fill=\"{}\"", style::INK), &diamond(13.0, 0.0));
        });
    }
    for limit in beyond {
        field.note(format!("The limit {} is far off this axis.", significant(limit, 5)));
    }
    for &JudgedModel { name, judgement, .. } in models {
        failed(name, judgement).into_iter().for_each(|note| field.note(note));
    }
    field.finish(&title, &description(requirement, models))
}

/// The vertical axis: shares by the normal law's quantiles.
struct Up {
    lower: f64,
    upper: f64,
    required: Option<f64>,
}

impl Up {
    fn new(requirement: &Requirement, models: &[JudgedModel<'_>]) -> Self {
        let p = requirement.probability();
        // The share that is at most the limit.
        let required = match requirement.bound() {
            Bound::AtMost(_) => Some(probit(p)),
            Bound::AtLeast(_) => Some(-probit(p)),
            Bound::Between(..) => None,
        };
        let shares = models.iter().flat_map(|model| points(model.judgement)).map(|p| p.share);
        let all = shares.map(probit).chain(required);
        let (lower, upper) = all.fold((-1.4_f64, 1.4_f64), |(l, u), z| (l.min(z), u.max(z)));
        Self { lower: lower - 0.15, upper: upper + 0.15, required }
    }

    /// How far above the foot of the plot.
    fn above(&self, z: f64) -> f64 {
        ((z - self.lower) / (self.upper - self.lower)).clamp(0.0, 1.0) * HIGH
    }

    /// From the top of the plot down.
    fn y(&self, share: f64) -> f64 {
        HIGH - self.above(probit(share))
    }

    fn required(&self) -> Option<f64> {
        self.required.map(|z| HIGH - self.above(z))
    }

    /// From the middle outwards, as many as have room.
    fn ticks(&self) -> Vec<Tick> {
        let mut ticks: Vec<Tick> = Vec::new();
        for percent in PERCENT.iter().rev() {
            let z = probit(percent / 100.0);
            let upper = format!("{}", (100.0 - percent) as f32);
            let upper = if *percent < 1e-4 { format!("100−{percent}") } else { upper };
            for (z, label) in [(z, format!("{percent}")), (-z, upper)] {
                let at = self.above(z);
                let free = ticks.iter().all(|tick| (tick.at - at).abs() > 14.0);
                if (self.lower..=self.upper).contains(&z) && free {
                    ticks.push(Tick { at, label });
                }
            }
        }
        ticks
    }
}

/// The number that a standard normal variable is at most with a probability; infinite for none and all.
fn probit(share: f64) -> f64 {
    if share > 0.5 {
        return -probit(1.0 - share);
    }
    if !(share > 0.0) {
        return f64::NEG_INFINITY;
    }
    let (mut low, mut high) = (-40.0, 0.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        *if tail::normal(-middle) < share { &mut low } else { &mut high } = middle;
    }
    0.5 * (low + high)
}

fn points(judgement: &Judgement) -> &[DistributionPoint] {
    judgement.distribution().map_or(&[], |distribution| distribution.points())
}

/// The horizontal axis, which shows all runs, and the limits that are too far away from them to be shown with them.
fn across(bound: Bound, models: &[JudgedModel<'_>]) -> (Across, Vec<f64>) {
    let span = |values: &mut dyn Iterator<Item = f64>| {
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, u), x| (l.min(x), u.max(x)))
    };
    let of_runs = models.iter().flat_map(|model| points(model.judgement)).map(|p| p.value);
    let tolerances = models.iter().filter_map(|model| model.judgement.tolerance());
    let (lower, upper) = span(&mut of_runs.chain(tolerances.flat_map(Bound::limits)));
    let half = upper / 2.0 - lower / 2.0;
    // Nothing to show but the limits, or one number.
    let is_far = |limit: &f64| {
        half > 0.0 && (lower / 8.0 - limit / 8.0).max(limit / 8.0 - upper / 8.0) > half
    };
    let (far, near): (Vec<f64>, Vec<f64>) = bound.limits().partition(is_far);
    let (lower, upper) =
        span(&mut [lower, upper].into_iter().filter(|x| x.is_finite()).chain(near));
    (if lower <= upper { Across::new(lower, upper) } else { Across::new(0.0, 1.0) }, far)
}

/// The band holds between the points too: below the upper bound of the next, above the lower bound of the one before.
fn band(svg: &mut Svg, colour: usize, judgement: &Judgement, across: &Across, up: &Up) {
    let points = points(judgement);
    if points.is_empty() {
        return;
    }
    let mut d = format!("M0 {}", px(up.y(points[0].upper)));
    for (i, point) in points.iter().enumerate() {
        let next = points.get(i + 1).map_or(1.0, |next| next.upper);
        d.push_str(&format!("H{}V{}", px(across.x(point.value)), px(up.y(next))));
    }
    d.push_str(&format!("H{}", px(ACROSS)));
    for point in points.iter().rev() {
        d.push_str(&format!("V{}H{}", px(up.y(point.lower)), px(across.x(point.value))));
    }
    d.push_str(&format!("V{}H0z", px(HIGH)));
    svg.path(&band_pen(colour), &d);
}

fn line(svg: &mut Svg, colour: usize, judgement: &Judgement, across: &Across, up: &Up) {
    let points = points(judgement);
    let (mut d, mut marks) = (String::new(), String::new());
    for (i, point) in points.iter().enumerate() {
        let (x, y) = (across.x(point.value), up.y(point.share));
        d.push_str(&format!("{}{} {}", if i > 0 { "L" } else { "M" }, px(x), px(y)));
        let outer = i.min(points.len() - 1 - i);
        if outer < 3 || outer.is_multiple_of(MARKED) {
            marks.push_str(&marker(colour, x, y));
        }
    }
    svg.path(&line_pen(colour), &d);
    svg.path(&mark_pen(colour), &marks);
}

/// Where the required share keeps the bound; of two bounds both.
fn tolerance(svg: &mut Svg, colour: usize, judgement: &Judgement, across: &Across, up: &Up) {
    let Some(bound) = judgement.tolerance() else { return };
    let y = up.required().unwrap_or(up.y(0.5));
    let places: Vec<f64> = bound.limits().map(|x| across.x(x)).collect();
    if let [first, last] = places[..] {
        svg.path(&required_pen(), &format!("M{} {}H{}", px(first), px(y), px(last)));
    }
    let pen = format!("fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"1.2\"", style::model(colour));
    let d: String = places.into_iter().map(|x| diamond(x, y)).collect();
    svg.path(&pen, &d);
}

fn diamond(x: f64, y: f64) -> String {
    format!("M{} {}l6.5 6.5l-6.5 6.5l-6.5 -6.5z", px(x), px(y - 6.5))
}

/// What is said of runs that have no finite number.
fn failed(model: &str, judgement: &Judgement) -> Vec<String> {
    let side = match judgement.requirement().bound() {
        Bound::AtLeast(_) => "below",
        Bound::AtMost(_) | Bound::Between(..) => "above",
    };
    let against = format!("count against it: their share lies {side} all numbers");
    let fate = match judgement.requirement().failed_runs() {
        FailedRuns::LeftOut => "are left out",
        FailedRuns::Against => &against,
    };
    let told = |(number, what, fate): (u64, &str, &str)| {
        let [of_them, runs] =
            [number, judgement.runs()].map(|n| count(usize::try_from(n).unwrap_or(usize::MAX)));
        (number > 0).then(|| format!("{model}: {of_them} of {runs} runs {what}, and {fate}."))
    };
    let without = (judgement.runs_without_number(), "failed or have no number", fate);
    let infinite = (judgement.runs_infinite(), "have an infinite number", against.as_str());
    [without, infinite].into_iter().filter_map(told).collect()
}

/// The figure in words.
fn description(requirement: &Requirement, models: &[JudgedModel<'_>]) -> String {
    let mut text = format!(
        "Distribution of {}, which must be {} in {} of {}.",
        requirement.quantity(),
        requirement.bound(),
        stated_in_percent(requirement.probability()),
        requirement.failed_runs().of_which()
    );
    for &JudgedModel { name, judgement, .. } in models {
        let points = points(judgement);
        let ends = points.first().zip(points.last());
        let range = ends.map_or_else(
            || "no numbers".to_owned(),
            |(least, most)| {
                let [least, most] = [least.value, most.value].map(|x| significant(x, 4));
                format!("from {least} to {most}")
            },
        );
        let bound = judgement.tolerance().map_or_else(
            || "no tolerance bound".to_owned(),
            |bound| {
                let told = bound.outwards(requirement.bound(), 4);
                format!(
                    "tolerance bound {}",
                    told.limits().map(plain).collect::<Vec<_>>().join(" and ")
                )
            },
        );
        text.push_str(&format!(" {name}: {range}, {bound}."));
    }
    text
}

#[cfg(test)]
mod tests;
