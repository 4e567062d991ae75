//! Attitudes as the tips of the principal axes on the unit sphere of body directions.

use std::collections::BTreeSet;

use nalgebra::{Complex, Quaternion, UnitQuaternion, Vector3, Vector4};
use serde::{Deserialize, Serialize};

use crate::legend::{Entry, legend};
use crate::style::{self, MARGIN};
use crate::svg::{Anchor, Look, Svg, px};
use crate::text::{count, fit};

/// A sample of attitudes under one model.
///
/// Each takes body components to principal components, `v_P = R(q)·v_B`.
#[derive(Debug, Clone, Copy)]
pub struct Cloud<'a> {
    /// Name of the model, above its sphere.
    pub name: &'a str,
    /// The attitudes; those not finite are left out, and counted in a note.
    pub attitudes: &'a [UnitQuaternion<f64>],
    /// The mean attitude, whose axes are marked.
    pub mean: UnitQuaternion<f64>,
}

/// Attitudes under several models, a sphere each, three in a row at most: the tips of the three principal
/// axes in body components, the rows of `R(q)`, seen from afar from a direction that is stated.
///
/// Tips on the far side are fainter; the axes of the mean attitude are spokes that end in a ring.
/// Of many attitudes some are kept and drawn, evenly spaced in the sample, and the figure says how many.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AttitudeSpheres {
    title: String,
    clouds: Vec<Kept>,
}

/// What is kept of a cloud.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Kept {
    name: String,
    /// How many attitudes there are, and how many of them are not finite.
    all: usize,
    not_finite: usize,
    /// Scalar last; none if it is not finite.
    mean: Option<[f64; 4]>,
    /// Those that are drawn, scalar last.
    drawn: Vec<[f64; 4]>,
}

impl AttitudeSpheres {
    /// Keeps what is drawn of these clouds.
    #[must_use]
    pub fn new(title: &str, clouds: &[Cloud<'_>]) -> Self {
        let most = (MOST / clouds.len().max(1)).clamp(1, MOST_ON_ONE);
        let keep = |cloud: &Cloud<'_>| {
            let sound: Vec<[f64; 4]> = cloud.attitudes.iter().filter_map(components).collect();
            let drawn = sound.len().min(most);
            Kept {
                name: cloud.name.to_owned(),
                all: cloud.attitudes.len(),
                not_finite: cloud.attitudes.len() - sound.len(),
                mean: components(&cloud.mean),
                drawn: (0..drawn).map(|i| sound[i * sound.len() / drawn]).collect(),
            }
        };
        Self { title: title.to_owned(), clouds: clouds.iter().map(keep).collect() }
    }

    /// The figure drawn.
    #[must_use]
    pub fn svg(&self) -> String {
        draw(&self.title, &self.clouds)
    }
}

/// The components of an attitude whose axes can be drawn, scalar last.
fn components(attitude: &UnitQuaternion<f64>) -> Option<[f64; 4]> {
    tips(attitude).map(|_| attitude.coords.into())
}

/// The most attitudes drawn in one figure and on one sphere: what a page can carry.
const MOST: usize = 9000;
const MOST_ON_ONE: usize = 2000;
/// Dots of one colour are spread over so many translucent layers, so that crowds look darker.
const LAYERS: usize = 6;
const NAME: Look = Look::new(13.0, style::INK).at(Anchor::Middle).bold();
const NOTE: Look = Look::new(11.0, style::MUTED).at(Anchor::Middle);
/// Azimuth and elevation of the viewer, in degrees of the body axes.
const AZIMUTH: i32 = 35;
const ELEVATION: i32 = 28;

fn draw(title: &str, clouds: &[Kept]) -> String {
    let columns = clouds.len().clamp(1, 3);
    let radius = [190.0, 165.0, 125.0][columns - 1];
    let pitch = 2.0 * radius * 1.22;
    let figure_width = 2.0 * MARGIN + pitch * columns as f64;

    let mut svg = Svg::new();
    let mut y = svg.heading(title, figure_width);
    if clouds.is_empty() {
        svg.text(figure_width / 2.0, y + 40.0, NOTE, "no data");
        return svg.finish((figure_width, y + 70.0), title, "No data.");
    }
    y = legend(&mut svg, entries(), y + 4.0, figure_width);
    for row in clouds.chunks(columns) {
        for (column, cloud) in row.iter().enumerate() {
            let x = MARGIN + pitch * (column as f64 + 0.5);
            let sphere = Sphere::new((x, y + 40.0 + 1.1 * radius), radius);
            svg.text(x, y + 26.0, NAME, &fit(&cloud.name, NAME.size, 0.9 * pitch));
            let note = sphere.draw(&mut svg, cloud);
            svg.text(x, y + 62.0 + 2.1 * radius, NOTE, &note);
        }
        y += 2.1 * radius + 72.0;
    }
    let view = format!(
        "Orthographic view from azimuth {AZIMUTH}°, elevation {ELEVATION}° in body axes x, y, z."
    );
    svg.text(figure_width / 2.0, y + 10.0, NOTE, &fit(&view, NOTE.size, figure_width));
    y += 22.0;
    svg.finish((figure_width, y), title, &description(clouds, &view))
}

fn description(clouds: &[Kept], view: &str) -> String {
    let mut text = "Tips of the principal axes on the unit sphere.".to_owned();
    for cloud in clouds {
        text.push_str(&format!(" {}: {} attitudes.", cloud.name, count(cloud.all)));
    }
    format!("{text} {view}")
}

fn entries() -> Vec<Entry> {
    let dot = |name: &str, colour: &str, opacity: f64| {
        let mut swatch = Svg::new();
        let pen = format!(
            "stroke=\"{colour}\" stroke-opacity=\"{opacity}\" stroke-width=\"8\" \
             stroke-linecap=\"round\""
        );
        swatch.path(&pen, "M4 0h0");
        Entry { name: name.to_owned(), width: 8.0, swatch }
    };
    let [first, second, third] = style::AXES.map(|colour| colour.pen);
    let mut mean = Svg::new();
    spoke(&mut mean, style::INK, (0.0, 0.0), (18.0, 0.0), true);
    vec![
        dot("principal axis 1", first, 1.0),
        dot("axis 2", second, 1.0),
        dot("axis 3", third, 1.0),
        Entry { name: "mean".to_owned(), width: 22.0, swatch: mean },
        dot("far side", style::INK, 0.2),
    ]
}

/// A line from the centre that ends in a ring around the tip.
fn spoke(svg: &mut Svg, colour: &str, from: (f64, f64), to: (f64, f64), near: bool) {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = (dx * dx + dy * dy).sqrt();
    let ring = RING.min(length);
    let share = if length > 0.0 { 1.0 - ring / length } else { 0.0 };
    let dashes = if near { "" } else { " stroke-dasharray=\"3 3\"" };
    let line = format!(
        "M{} {}L{} {}",
        px(from.0),
        px(from.1),
        px(from.0 + dx * share),
        px(from.1 + dy * share)
    );
    let circle = circle(to, RING);
    let pen = format!("stroke=\"{colour}\" stroke-width=\"1.5\"");
    svg.path("stroke=\"#ffffff\" stroke-width=\"2.9\" stroke-opacity=\"0.7\"", &circle);
    svg.path(&pen, &circle);
    svg.path(&(pen + dashes), &line);
}

const RING: f64 = 3.2;

fn circle(centre: (f64, f64), radius: f64) -> String {
    let (r, d) = (px(radius), px(2.0 * radius));
    format!("M{} {}a{r} {r} 0 1 1 {d} 0a{r} {r} 0 1 1 -{d} 0", px(centre.0 - radius), px(centre.1))
}

/// A unit sphere on the page.
struct Sphere {
    centre: (f64, f64),
    radius: f64,
    /// Body components of the page's right and up and of the direction to the viewer.
    view: [Vector3<f64>; 3],
}

/// A direction on the page, and whether it is on the side of the viewer.
type Spot = ((f64, f64), bool);

impl Sphere {
    fn new(centre: (f64, f64), radius: f64) -> Self {
        let (sa, ca) = sin_cos(AZIMUTH);
        let (se, ce) = sin_cos(ELEVATION);
        let view = [
            Vector3::new(-sa, ca, 0.0),
            Vector3::new(-se * ca, -se * sa, ce),
            Vector3::new(ce * ca, ce * sa, se),
        ];
        Self { centre, radius, view }
    }

    fn spot(&self, direction: &Vector3<f64>) -> Spot {
        let [right, up, near] = self.view.map(|axis| axis.dot(direction));
        let (x, y) = self.centre;
        ((x + self.radius * right, y - self.radius * up), near >= 0.0)
    }

    /// Draws the sphere with its cloud; returns what to say about the number of attitudes.
    fn draw(&self, svg: &mut Svg, cloud: &Kept) -> String {
        let tips = |components: &[f64; 4]| {
            tips(&UnitQuaternion::new_unchecked(Quaternion::from(Vector4::from(*components))))
        };
        let chosen: Vec<[Vector3<f64>; 3]> = cloud.drawn.iter().filter_map(tips).collect();
        let mean = cloud.mean.as_ref().and_then(tips);

        svg.path("fill=\"#fafafa\"", &circle(self.centre, self.radius));
        for near in [false, true] {
            self.graticule(svg, near);
            for (axis, colour) in style::AXES.iter().enumerate() {
                self.dots(svg, chosen.iter().map(|tips| tips[axis]), colour.pen, near);
            }
        }
        svg.path(&format!("stroke=\"{}\"", style::AXIS), &circle(self.centre, self.radius));
        self.body_axes(svg);
        for (tip, colour) in mean.iter().flatten().zip(style::AXES) {
            let (to, near) = self.spot(tip);
            spoke(svg, colour.pen, self.centre, to, near);
        }

        let mut note = match (cloud.all.saturating_sub(cloud.not_finite), cloud.drawn.len()) {
            (0, _) => "no data".to_owned(),
            (1, _) => "1 attitude".to_owned(),
            (n, m) if n == m => format!("{} attitudes", count(n)),
            (n, m) => format!("{} of {} attitudes drawn", count(m), count(n)),
        };
        if cloud.not_finite > 0 {
            note.push_str(&format!("; {} not finite", count(cloud.not_finite)));
        }
        note
    }

    /// Meridians and parallels every 30° of the body axes, on one side.
    fn graticule(&self, svg: &mut Svg, near: bool) {
        let direction = |longitude: i32, latitude: i32| {
            let (sl, cl) = sin_cos(longitude);
            let (sb, cb) = sin_cos(latitude);
            Vector3::new(cb * cl, cb * sl, sb)
        };
        let mut d = String::new();
        let mut curve = |points: &mut dyn Iterator<Item = Vector3<f64>>| {
            let mut pen = "M";
            for point in points {
                let ((x, y), side) = self.spot(&point);
                if side == near {
                    d.push_str(&format!("{pen}{} {}", px(x), px(y)));
                    pen = "L";
                } else {
                    pen = "M";
                }
            }
        };
        for longitude in (0..360).step_by(30) {
            // Only every third meridian reaches the pole, where all would make a blot.
            let end = if longitude % 90 == 0 { 90 } else { 80 };
            curve(&mut (-end..=end).step_by(4).map(|latitude| direction(longitude, latitude)));
        }
        for latitude in (-60..=60).step_by(30) {
            curve(&mut (0..=360).step_by(4).map(|longitude| direction(longitude, latitude)));
        }
        let colour = if near { "#cfcfcf" } else { "#e9e9e9" };
        svg.path(&format!("stroke=\"{colour}\" stroke-width=\"0.7\""), &d);
    }

    fn dots(
        &self,
        svg: &mut Svg,
        tips: impl Iterator<Item = Vector3<f64>>,
        colour: &str,
        near: bool,
    ) {
        let mut layers = vec![BTreeSet::new(); LAYERS];
        for (i, tip) in tips.enumerate() {
            let ((x, y), side) = self.spot(&tip);
            if side == near {
                layers[i % LAYERS].insert(((x * 10.0).round() as i32, (y * 10.0).round() as i32));
            }
        }
        let opacity = if near { 0.55 } else { 0.16 };
        let pen = format!(
            "stroke=\"{colour}\" stroke-opacity=\"{opacity}\" stroke-width=\"1.9\" \
             stroke-linecap=\"round\""
        );
        svg.group(&pen, |svg| {
            for layer in layers {
                svg.path("", &trail(layer));
            }
        });
    }

    /// The positive body axes, where they leave the sphere.
    fn body_axes(&self, svg: &mut Svg) {
        const LABEL: Look = Look::new(12.5, style::INK).at(Anchor::Middle);
        let axes = [(Vector3::x(), "x"), (Vector3::y(), "y"), (Vector3::z(), "z")];
        let mut d = String::new();
        for (axis, _) in &axes {
            let ((x0, y0), _) = self.spot(axis);
            let ((x1, y1), _) = self.spot(&(axis * 1.14));
            d.push_str(&format!("M{} {}L{} {}", px(x0), px(y0), px(x1), px(y1)));
        }
        svg.path(&format!("stroke=\"{}\"", style::INK), &d);
        // A halo keeps the letters legible amid dots.
        svg.group("stroke=\"#ffffff\" stroke-width=\"3\" paint-order=\"stroke\"", |svg| {
            for (axis, name) in &axes {
                let ((x, y), _) = self.spot(&(axis * 1.22));
                svg.text(x, y + 4.0, LABEL, name);
            }
        });
    }
}

/// Sine and cosine of whole degrees: powers of one degree, as `std` may differ between platforms.
fn sin_cos(degrees: i32) -> (f64, f64) {
    let degree = Complex::new(0.999_847_695_156_391_3, 0.017_452_406_437_283_51);
    let turned = degree.powu(degrees.rem_euclid(360).unsigned_abs());
    (turned.im, turned.re)
}

/// The principal axes in body components; `None` if not finite.
fn tips(attitude: &UnitQuaternion<f64>) -> Option<[Vector3<f64>; 3]> {
    let inverse = attitude.inverse();
    let tips = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| inverse * axis);
    let unit = tips.map(|tip| tip.try_normalize(0.0).unwrap_or(tip));
    unit.iter().all(|tip| (tip.norm() - 1.0).abs() < 1e-6).then_some(unit)
}

/// Dots, given in tenths of a pixel, as a path of lines of no length.
fn trail(dots: BTreeSet<(i32, i32)>) -> String {
    let tenths = |n: i32| px(f64::from(n) / 10.0);
    let mut d = String::new();
    let mut pen: Option<(i32, i32)> = None;
    for (x, y) in dots {
        match pen {
            None => d.push_str(&format!("M{} {}h0", tenths(x), tenths(y))),
            Some((a, b)) => d.push_str(&format!("m{} {}h0", tenths(x - a), tenths(y - b))),
        }
        pen = Some((x, y));
    }
    d
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::svg::tests::read;

    /// Drawn from what was written and read back.
    fn attitude_spheres(title: &str, clouds: &[Cloud<'_>]) -> String {
        let spheres = AttitudeSpheres::new(title, clouds);
        let read = serde_json::from_str(&serde_json::to_string(&spheres).unwrap());
        let svg = spheres.svg();
        assert_eq!(svg, AttitudeSpheres::svg(&read.unwrap()));
        svg
    }

    fn spread(n: u32) -> Vec<UnitQuaternion<f64>> {
        let angle = |i: u32, k: u32| f64::from(i.wrapping_mul(k) % 65_521) / 65_521.0 * 6.0;
        let euler = |i| (angle(i, 40_503), angle(i, 30_011), angle(i, 12_007));
        (1..=n).map(euler).map(|(a, b, c)| UnitQuaternion::from_euler_angles(a, b, c)).collect()
    }

    fn cloud(attitudes: &[UnitQuaternion<f64>]) -> Cloud<'_> {
        Cloud { name: "a <model>", attitudes, mean: UnitQuaternion::identity() }
    }

    #[test]
    fn tips_are_the_principal_axes_in_body_components() {
        // Principal components from body components: the rows of R are the principal axes.
        let q = UnitQuaternion::from_euler_angles(0.1, -0.7, 2.0);
        let matrix = q.to_rotation_matrix();
        for (k, tip) in tips(&q).unwrap().iter().enumerate() {
            assert!((matrix.matrix().row(k).transpose() - tip).norm() < 1e-15);
        }
    }

    #[test]
    fn the_view_is_from_where_it_says() {
        let sphere = Sphere::new((200.0, 100.0), 50.0);
        let viewer = sphere.view[2];
        let azimuth = viewer.y.atan2(viewer.x).to_degrees();
        assert!((azimuth - f64::from(AZIMUTH)).abs() < 1e-12);
        assert!((viewer.z.asin().to_degrees() - f64::from(ELEVATION)).abs() < 1e-12);
        // A right-handed view: the nearest point is in the middle, z points up.
        assert!((sphere.view[0].cross(&sphere.view[1]) - viewer).norm() < 1e-15);
        let ((x, y), near) = sphere.spot(&viewer);
        assert!((x - 200.0).hypot(y - 100.0) < 1e-12 && near && !sphere.spot(&-viewer).1);
        let ((x, y), _) = sphere.spot(&Vector3::z());
        assert!((x - 200.0).abs() < 1e-12 && y < 100.0);
    }

    #[test]
    fn whatever_the_attitudes_there_is_a_figure() {
        let strange = [f64::NAN, f64::INFINITY, 0.0, 1e300, 1e-300]
            .map(|w| UnitQuaternion::new_unchecked(Quaternion::new(w, 0.0, 0.0, 0.0)));
        for mean in strange.into_iter().chain([UnitQuaternion::identity()]) {
            let one = [mean];
            let clouds = [Cloud { mean, ..cloud(&strange) }, cloud(&[]), cloud(&one)];
            let svg = attitude_spheres("a & b", &clouds);
            assert_eq!(svg, attitude_spheres("a & b", &clouds));
            let text = read(&svg);
            assert!(text.contains("no data") && text.contains("a <model>"), "{text}");
        }
        assert!(read(&attitude_spheres("", &[])).contains("no data"));
    }

    #[test]
    fn numbers_drawn_and_left_out_are_told() {
        let mut attitudes = spread(1500);
        assert!(read(&attitude_spheres("", &[cloud(&attitudes)])).contains("1500 attitudes"));
        attitudes.extend(spread(8500));
        attitudes.push(UnitQuaternion::new_unchecked(Quaternion::new(f64::NAN, 0.0, 0.0, 0.0)));
        let text = read(&attitude_spheres("", &[cloud(&attitudes)]));
        assert!(text.contains("2000 of 10\u{2009}000 attitudes drawn; 1 not finite"), "{text}");
    }

    #[test]
    fn figures_are_small() {
        let attitudes = spread(2000);
        let svg = attitude_spheres("", &[cloud(&attitudes)]);
        assert!(svg.len() < 110_000, "{}", svg.len());
        let attitudes = spread(4000);
        let svg = attitude_spheres("", &[cloud(&attitudes); 3]);
        assert!(svg.len() < 350_000, "{}", svg.len());
    }

    #[test]
    fn degrees_are_degrees() {
        for degrees in -400..400 {
            let ((s, c), (sin, cos)) =
                (sin_cos(degrees), f64::from(degrees).to_radians().sin_cos());
            assert!((s - sin).abs() < 1e-13 && (c - cos).abs() < 1e-13, "{degrees}");
        }
    }

    #[test]
    fn dots_are_drawn_where_they_are() {
        let dots = BTreeSet::from([(15, 20), (15, 31), (7, 40)]);
        assert_eq!(trail(dots), "M0.7 4h0m0.8 -2h0m0 1.1h0");
        assert_eq!(trail(BTreeSet::new()), "");
    }
}
