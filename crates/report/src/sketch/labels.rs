//! Numbers of springs in a view of a sketch, of which no two overlap.

use super::{SketchView, VIEW};
use crate::style;
use crate::svg::{Anchor, Look, Svg};
use crate::text::{fit, width};

const NUMBER: Look = Look::new(12.0, style::INK).bold();
/// Room for the numbers of springs that have one label, of which the last are left out if they need more: at most, and at least where
/// springs stand at the edge of a view.
const WIDEST: f64 = 90.0;
const LEAST: f64 = 40.0;

/// Springs that stand behind each other or so near that their numbers would touch, with one label.
struct Numbered<'a> {
    /// Whether they are left of the middle.
    is_left: bool,
    /// Springs by their places in order, with their names and where they are.
    springs: Vec<(usize, &'a str, [f64; 2])>,
}

/// Where a label is drawn: from its left to its right end, on a baseline.
struct Place {
    text: String,
    left: f64,
    right: f64,
    base: f64,
}

impl Numbered<'_> {
    /// Beside the springs, away from the middle of a view that begins there, and within the view.
    fn place(&self, left: f64) -> Place {
        let names: Vec<&str> = self.springs.iter().map(|(_, name, _)| *name).collect();
        let across = self.springs.iter().map(|(.., at)| at[0]);
        let (outermost, room) = if self.is_left {
            let x = across.fold(f64::INFINITY, f64::min) - 7.0;
            (x, x - left)
        } else {
            let x = across.fold(f64::NEG_INFINITY, f64::max) + 7.0;
            (x, left + VIEW.0 - x)
        };
        // Bold letters are wider, and those of other faces than Helvetica by a tenth more.
        let text = first_that_fit(&names, (room / 1.2).clamp(LEAST, WIDEST));
        let wide = 1.2 * width(&text, NUMBER.size);
        let from = if self.is_left { outermost - wide } else { outermost };
        let from = from.min(left + VIEW.0 - wide).max(left);
        let up: f64 = self.springs.iter().map(|(.., at)| at[1]).sum();
        Place { text, left: from, right: from + wide, base: up / names.len() as f64 + 4.0 }
    }

    fn is_near(&self, [x, y]: [f64; 2]) -> bool {
        let near = |(.., at): &(usize, &str, [f64; 2])| {
            (at[0] - x).abs() < 14.0 && (at[1] - y).abs() < 13.0
        };
        self.springs.first().is_some_and(near)
    }
}

/// The first of names, as many as fit into a width, and whether there are more.
fn first_that_fit(names: &[&str], room: f64) -> String {
    let all = names.join(", ");
    let cut = (1..names.len()).rev().map(|count| format!("{}, …", names[..count].join(", ")));
    let mut texts = std::iter::once(all).chain(cut);
    let fitting = texts.find(|text| width(text, NUMBER.size) <= room);
    // A name alone may be longer than the room.
    fitting.unwrap_or_else(|| fit(&names.join(", "), NUMBER.size, room))
}

impl Place {
    fn touches(&self, other: &Self) -> bool {
        let gap = 3.0;
        let beside = self.right + gap < other.left || other.right + gap < self.left;
        !beside && (self.base - other.base).abs() < 13.0
    }
}

/// Numbers of springs beside them; of those that are behind each other, or whose labels would touch, together.
pub(super) fn draw(
    svg: &mut Svg,
    view: &SketchView,
    left: f64,
    at: impl Fn(&[f64; 2]) -> [f64; 2],
) {
    let mut groups: Vec<Numbered<'_>> = Vec::new();
    for (place, (name, ends)) in view.springs.iter().enumerate() {
        let [a, b] = ends.each_ref().map(&at);
        let half = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
        let (is_left, spring) = (half[0] < left + 0.5 * VIEW.0 - 1.0, (place, name.as_str(), half));
        let same = |group: &&mut Numbered<'_>| group.is_left == is_left && group.is_near(half);
        match groups.iter_mut().find(same) {
            Some(group) => group.springs.push(spring),
            None => groups.push(Numbered { is_left, springs: vec![spring] }),
        }
    }
    let mut apart: Vec<(Numbered<'_>, Place)> = Vec::new();
    for mut group in groups {
        let mut place = group.place(left);
        // A label that has grown may touch another one.
        while let Some(i) = apart.iter().position(|(_, other)| other.touches(&place)) {
            let (mut other, _) = apart.remove(i);
            other.springs.append(&mut group.springs);
            other.springs.sort_unstable_by_key(|(place, ..)| *place);
            group = other;
            place = group.place(left);
        }
        apart.push((group, place));
    }
    for (_, Place { text, left, right, base }) in apart {
        svg.text(0.5 * (left + right), base, NUMBER.at(Anchor::Middle), &text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::WIDTH;
    use crate::sketch::{SketchBody, SketchShape, svg};

    /// Where the numbers of springs stand in a figure: from left to right, and the baseline.
    fn labels(svg: &str) -> Vec<([f64; 2], f64, String)> {
        let number = |text: &str, name: &str| -> f64 {
            let (_, value) = text.split_once(&format!("{name}=\"")).unwrap();
            value.split('"').next().unwrap().parse().unwrap()
        };
        let bold = svg.split("<text ").skip(1).filter(|text| {
            text.contains("font-size=\"12\"") && text.contains("font-weight=\"600\"")
        });
        let label = |text: &str| {
            let (_, words) = text.split_once('>').unwrap();
            let words = words.split("</text>").next().unwrap().to_owned();
            assert!(text.contains("text-anchor=\"middle\""));
            let half = 0.5 * 1.1 * width(&words, NUMBER.size);
            let x = number(text, "x");
            ([x - half, x + half], number(text, "y"), words)
        };
        bold.map(label).collect()
    }

    /// Rings of any number of springs, of small and large radii, seen from above and from the side, alone and with a body beside
    /// them: no two labels stand over each other, none leaves its view, and the first spring always has its number.
    #[test]
    fn labels_do_not_overlap() {
        for count in 1..=64_u32 {
            for radius in [1e-3, 0.05, 0.3, 0.6, 1.0, 2.0] {
                for turned in [0.0, 0.01, 0.4] {
                    let at = |i: u32| {
                        let angle =
                            turned + std::f64::consts::TAU * f64::from(i) / f64::from(count);
                        [radius * angle.cos(), radius * angle.sin()]
                    };
                    let body = SketchBody {
                        name: "payload".to_owned(),
                        mass_centre: [0.0, 0.0],
                        shapes: vec![SketchShape::Points(vec![[-1.0, -1.0], [1.0, 1.0]])],
                    };
                    let seen = |pads: fn([f64; 2]) -> [[f64; 2]; 2]| SketchView {
                        title: "view".to_owned(),
                        axes: Vec::new(),
                        bodies: vec![body.clone()],
                        springs: (0..count).map(|i| ((i + 1).to_string(), pads(at(i)))).collect(),
                    };
                    let above = seen(|[x, y]| [[x, y], [x, y]]);
                    let side = seen(|[x, _]| [[x, 0.0], [x, 0.05]]);
                    let other = seen(|[_, y]| [[y, 0.0], [y, 0.05]]);
                    let labels = labels(&svg("", &[side, above, other]));
                    let said = format!("{count} {radius} {turned}: {labels:?}");
                    for (i, (own, base, _)) in labels.iter().enumerate() {
                        assert!(own[0] >= 0.0 && own[1] <= WIDTH, "{said}");
                        for (other, its, _) in &labels[..i] {
                            let beside = own[1] < other[0] || other[1] < own[0];
                            assert!(beside || (base - its).abs() >= 11.0, "{said}");
                        }
                    }
                    let first =
                        labels.iter().filter(|(.., words)| words.split(", ").next() == Some("1"));
                    assert_eq!(first.count(), 3, "{said}");
                }
            }
        }
    }
}
