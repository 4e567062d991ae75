//! A sketch of bodies and what pushes them apart, in views side by side to one scale.

mod labels;

use crate::Drawing;
use crate::field::{TICK, WIDTH};
use crate::legend::{Entry, legend};
use crate::numbers::round_below;
use crate::style::{self, MARGIN};
use crate::svg::{Anchor, Look, Svg, px};
use crate::text::{fit, significant};

const NAME: Look = Look::new(12.5, style::INK).bold();
/// Room for a view: all of it, and what is left around the bodies for numbers.
const VIEW: (f64, f64) = (222.0, 250.0);
const ROOM: f64 = 26.0;
/// From the top of a view to that of the one below it, with room for its axes.
const PITCH: f64 = VIEW.1 + 42.0;
/// The place of springs among the colours of models, after those of the bodies.
const SPRINGS: usize = 2;

/// Bodies and springs as they are seen from a direction: coordinates in m, to the right and up.
#[derive(Clone, Debug, PartialEq)]
pub struct SketchView {
    /// Where it is seen from.
    pub title: String,
    /// Names of axes, and where they point.
    pub axes: Vec<(String, [f64; 2])>,
    /// The bodies.
    pub bodies: Vec<SketchBody>,
    /// Names of springs, and where their pads are.
    pub springs: Vec<(String, [[f64; 2]; 2])>,
}

/// A body.
#[derive(Clone, Debug, PartialEq)]
pub struct SketchBody {
    /// Its name; a name has the same colour in all views.
    pub name: String,
    /// Its mass centre.
    pub mass_centre: [f64; 2],
    /// What it looks like.
    pub shapes: Vec<SketchShape>,
}

/// A part of a body.
#[derive(Clone, Debug, PartialEq)]
pub enum SketchShape {
    /// Points.
    Points(Vec<[f64; 2]>),
    /// What points enclose: their convex hull.
    Hull(Vec<[f64; 2]>),
    /// A line that closes.
    Closed(Vec<[f64; 2]>),
}

/// A figure of views side by side, to one scale, with a bar that tells it.
#[must_use]
pub fn sketch_figure(name: &str, caption: &str, title: &str, views: &[SketchView]) -> Drawing {
    Drawing::new(name, caption, svg(title, views))
}

fn svg(title: &str, views: &[SketchView]) -> String {
    let mut svg = Svg::new();
    let y = svg.heading(title, WIDTH);
    let y = legend(&mut svg, entries(views), y + 4.0, WIDTH) + 10.0;
    // Pixels per metre.
    let scales = views.iter().map(|view| Extent::of(view).scale());
    let scale = scales.fold(f64::INFINITY, f64::min);
    let scale = if scale.is_finite() { scale } else { 1.0 };
    for (place, view) in views.iter().enumerate() {
        let left = MARGIN + (VIEW.0 + 12.0) * (place % 2) as f64;
        let top = y + PITCH * (place / 2) as f64;
        draw(&mut svg, view, (left, top), scale);
    }
    let y = y + PITCH * views.len().div_ceil(2) as f64;
    let metres = round_below(120.0 / scale);
    let d = format!("M{} {}v8m0 -4h{}m0 -4v8", px(MARGIN), px(y), px(metres * scale));
    svg.path(&format!("stroke=\"{}\" stroke-width=\"1.4\"", style::INK), &d);
    svg.text(
        MARGIN + metres * scale + 8.0,
        y + 8.0,
        TICK,
        &format!("{} m", significant(metres, 1)),
    );
    svg.finish_within(640.0, (WIDTH, y + 20.0), title, &description(views))
}

/// What a view spans.
struct Extent {
    low: [f64; 2],
    high: [f64; 2],
}

impl Extent {
    fn of(view: &SketchView) -> Self {
        let mut extent = Self { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };
        let bodies = view.bodies.iter();
        let shapes = bodies.clone().flat_map(|body| &body.shapes).flat_map(SketchShape::points);
        let springs = view.springs.iter().flat_map(|(_, ends)| ends);
        for point in shapes.chain(springs).chain(bodies.map(|body| &body.mass_centre)) {
            for (i, x) in point.iter().enumerate().filter(|(_, x)| x.is_finite()) {
                extent.low[i] = extent.low[i].min(*x);
                extent.high[i] = extent.high[i].max(*x);
            }
        }
        extent
    }

    /// The scale at which it fills its place.
    fn scale(&self) -> f64 {
        let room = [VIEW.0 - 2.0 * ROOM, VIEW.1 - 2.0 * ROOM];
        let scale = |i: usize| room[i] / (self.high[i] - self.low[i]);
        let scale = scale(0).min(scale(1));
        if scale > 0.0 { scale } else { f64::INFINITY }
    }

    fn middle(&self) -> [f64; 2] {
        [0, 1].map(|i| {
            let middle = 0.5 * self.low[i] + 0.5 * self.high[i];
            if middle.is_finite() { middle } else { 0.0 }
        })
    }
}

impl SketchShape {
    fn points(&self) -> &[[f64; 2]] {
        match self {
            Self::Points(points) | Self::Hull(points) | Self::Closed(points) => points,
        }
    }
}

fn entries(views: &[SketchView]) -> Vec<Entry> {
    let mut entries = Vec::new();
    let bodies = views.first().map_or(&[][..], |view| &view.bodies[..]);
    for (i, body) in bodies.iter().enumerate() {
        let mut swatch = Svg::new();
        swatch.path(&body_pen(i), "M0 -6h20v12h-20z");
        entries.push(Entry { name: body.name.clone(), width: 20.0, swatch });
    }
    let mut swatch = Svg::new();
    mass_centre(&mut swatch, [7.0, 0.0], style::INK);
    entries.push(Entry { name: "mass centre".to_owned(), width: 14.0, swatch });
    if views.iter().any(|view| !view.springs.is_empty()) {
        let mut swatch = Svg::new();
        spring(&mut swatch, [[3.0, 0.0], [23.0, 0.0]]);
        entries.push(Entry {
            name: "springs by their numbers, pads".to_owned(),
            width: 26.0,
            swatch,
        });
    }
    entries
}

fn body_pen(place: usize) -> String {
    let colour = style::model(place);
    format!("fill=\"{colour}\" fill-opacity=\"0.12\" stroke=\"{colour}\" stroke-width=\"1.3\"")
}

/// A circle of which two quarters are filled.
fn mass_centre(svg: &mut Svg, [x, y]: [f64; 2], colour: &str) {
    let at = format!("M{} {}", px(x), px(y));
    let circle = format!("M{} {}a5 5 0 1 0 10 0a5 5 0 1 0 -10 0", px(x - 5.0), px(y));
    svg.path(&format!("fill=\"#ffffff\" stroke=\"{colour}\" stroke-width=\"1.2\""), &circle);
    let quarters = format!("{at}h5a5 5 0 0 0 -5 -5z{at}h-5a5 5 0 0 0 5 5z");
    svg.path(&format!("fill=\"{colour}\""), &quarters);
}

/// A line between two pads.
fn spring(svg: &mut Svg, [from, to]: [[f64; 2]; 2]) {
    let colour = style::model(SPRINGS);
    let line = format!("M{} {}L{} {}", px(from[0]), px(from[1]), px(to[0]), px(to[1]));
    svg.path(&format!("stroke=\"{colour}\" stroke-width=\"2.2\""), &line);
    let pad = |[x, y]: [f64; 2]| format!("M{} {}h6v6h-6z", px(x - 3.0), px(y - 3.0));
    svg.path(&format!("fill=\"{colour}\""), &(pad(from) + &pad(to)));
}

fn draw(svg: &mut Svg, view: &SketchView, (left, top): (f64, f64), scale: f64) {
    svg.text(left, top + 10.0, NAME, &fit(&view.title, NAME.size, VIEW.0));
    let middle = Extent::of(view).middle();
    let centre = [left + 0.5 * VIEW.0, top + 14.0 + 0.5 * VIEW.1];
    let at = |p: &[f64; 2]| {
        // Farther than a sheet is off it.
        let place = |x: f64| if x.is_finite() { x.clamp(-9999.0, 9999.0) } else { 0.0 };
        [
            place(centre[0] + (p[0] - middle[0]) * scale),
            place(centre[1] - (p[1] - middle[1]) * scale),
        ]
    };
    for (i, body) in view.bodies.iter().enumerate() {
        for shape in &body.shapes {
            let points: Vec<[f64; 2]> = shape.points().iter().map(at).collect();
            match shape {
                SketchShape::Points(_) => {
                    let dot =
                        |[x, y]: &[f64; 2]| format!("M{} {}h4v4h-4z", px(x - 2.0), px(y - 2.0));
                    let dots: String = points.iter().map(dot).collect();
                    svg.path(&format!("fill=\"{}\"", style::model(i)), &dots);
                }
                SketchShape::Hull(_) => svg.path(&body_pen(i), &closed(&hull(points))),
                SketchShape::Closed(_) => svg.path(&body_pen(i), &closed(&points)),
            }
        }
    }
    for (_, ends) in &view.springs {
        spring(svg, ends.each_ref().map(at));
    }
    for (i, body) in view.bodies.iter().enumerate() {
        mass_centre(svg, at(&body.mass_centre), style::model(i));
    }
    labels::draw(svg, view, left, at);
    axes(svg, &view.axes, (left, top + VIEW.1 + 40.0));
}

/// Arrows of the axes that are not seen from their end, in a corner.
fn axes(svg: &mut Svg, axes: &[(String, [f64; 2])], (left, base): (f64, f64)) {
    const LENGTH: f64 = 24.0;
    let origin = [left + 30.0, base - 22.0];
    for (i, (name, [right, up])) in axes.iter().enumerate() {
        if !(right.abs().max(up.abs()) > 0.2) {
            continue;
        }
        let colour = style::AXES[i % style::AXES.len()];
        let tip = [origin[0] + LENGTH * right, origin[1] - LENGTH * up];
        let d = format!("M{} {}L{} {}", px(origin[0]), px(origin[1]), px(tip[0]), px(tip[1]));
        svg.path(&format!("stroke=\"{}\" stroke-width=\"1.8\"", colour.pen), &d);
        let look = Look::new(12.0, colour.words).bold().at(Anchor::Middle);
        svg.text(origin[0] + 1.4 * LENGTH * right, origin[1] - 1.4 * LENGTH * up + 4.0, look, name);
    }
}

fn closed(points: &[[f64; 2]]) -> String {
    let all: Vec<String> = points.iter().map(|[x, y]| format!("{} {}", px(*x), px(*y))).collect();
    if all.is_empty() { String::new() } else { format!("M{}z", all.join("L")) }
}

/// Corners of the convex hull, one after the other (Andrew 1979, doi:10.1016/0020-0190(79)90072-3).
fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let turns = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    let chain = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..]
                && !(turns(a, b, point) > 0.0)
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let lower = chain(&mut points.iter().copied());
    let upper = chain(&mut points.iter().rev().copied());
    let corners: Vec<[f64; 2]> = lower.into_iter().chain(upper).collect();
    if corners.is_empty() { points.into_iter().take(1).collect() } else { corners }
}

/// The figure in words.
fn description(views: &[SketchView]) -> String {
    let Some(view) = views.first() else { return "No bodies.".to_owned() };
    let bodies: Vec<&str> = view.bodies.iter().map(|body| body.name.as_str()).collect();
    let titles: Vec<&str> = views.iter().map(|view| view.title.as_str()).collect();
    let springs = view.springs.len();
    format!("{} and {springs} springs: {}.", bodies.join(", "), titles.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::svg::tests::read;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = [f64; 2]> {
        let number = prop_oneof![
            8 => -3.0..3.0,
            1 => prop::sample::select(vec![0.0, 1e300, -1e300, 5e-324, f64::NAN, f64::INFINITY, f64::MAX]),
        ];
        [number.clone(), number]
    }

    fn view() -> impl Strategy<Value = SketchView> {
        let points = || prop::collection::vec(point(), 0..9);
        let shape = prop_oneof![
            points().prop_map(SketchShape::Points),
            points().prop_map(SketchShape::Hull),
            points().prop_map(SketchShape::Closed),
        ];
        let body = (point(), prop::collection::vec(shape, 0..3));
        let bodies = prop::collection::vec(body, 0..3);
        (bodies, prop::collection::vec([point(), point()], 0..9), [point(), point()]).prop_map(
            |(bodies, springs, axes)| SketchView {
                title: "from the <side>".to_owned(),
                axes: axes
                    .into_iter()
                    .zip(["1", "2"])
                    .map(|(at, name)| (name.to_owned(), at))
                    .collect(),
                bodies: bodies
                    .into_iter()
                    .map(|(mass_centre, shapes)| SketchBody {
                        name: "body".to_owned(),
                        mass_centre,
                        shapes,
                    })
                    .collect(),
                springs: springs
                    .into_iter()
                    .zip(1..)
                    .map(|(ends, n): (_, u32)| (n.to_string(), ends))
                    .collect(),
            },
        )
    }

    proptest! {
        /// Any bodies in any number of views: well-formed, and every spring has its number.
        #[test]
        fn any_bodies_give_a_sketch(views in prop::collection::vec(view(), 0..4)) {
            let seen = read(&svg("a <title>", &views));
            prop_assert!(seen.contains("a <title>") && seen.contains(" m\n"));
        }

        /// The hull encloses all its points, and its corners are points.
        #[test]
        fn the_hull_encloses_its_points(points in prop::collection::vec([-9_i8..9, -9_i8..9], 3..30)) {
            let points: Vec<[f64; 2]> = points.into_iter().map(|p| p.map(f64::from)).collect();
            let corners = hull(points.clone());
            prop_assert!(corners.iter().all(|corner| points.contains(corner)));
            for (i, a) in corners.iter().enumerate() {
                let b = corners[(i + 1) % corners.len()];
                for p in &points {
                    let turn = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
                    prop_assert!(turn >= 0.0, "{:?} {:?} {:?}", a, b, p);
                }
            }
        }
    }

    /// A square seen from the side fills its place, and springs that stand behind each other have their numbers together.
    #[test]
    fn bodies_fill_their_place() {
        let square = vec![[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let body = SketchBody {
            name: "payload".to_owned(),
            mass_centre: [0.0, 0.0],
            shapes: vec![SketchShape::Hull(square)],
        };
        let spring = |name: &str, x: f64| (name.to_owned(), [[x, -1.0], [x, -0.5]]);
        let view = SketchView {
            title: "side".to_owned(),
            axes: vec![("1".to_owned(), [1.0, 0.0]), ("2".to_owned(), [0.0, 0.0])],
            bodies: vec![body],
            springs: vec![spring("1", -0.8), spring("2", 0.8), spring("3", -0.8)],
        };
        assert!((Extent::of(&view).scale() - (VIEW.0 - 2.0 * ROOM) / 2.0).abs() < 1e-9);
        let seen = read(&svg("", &[view]));
        assert!(seen.contains("\n1, 3\n") && seen.contains("\n2\n"), "{seen}");
        // The axis that is seen from its end has no arrow.
        assert_eq!(seen.matches("\n1\n").count(), 1, "{seen}");
        assert!(seen.ends_with(" m\n"), "{seen}");
    }
}
