//! A sketch of the configuration before the separation, from the scenario alone.

use gyradius_report::{Drawing, SketchBody, SketchShape, SketchView, sketch_figure};
use gyradius_separation::MovingBody;
use nalgebra::Vector3;

use crate::{
    body::Body,
    scenario::{Scenario, ShapeFile},
    solid::{radii, uniform_box},
};

/// Name of the figure.
pub(crate) const CONFIGURATION: &str = "configuration";
/// Corners of a ring.
const CORNERS: u32 = 48;

/// The directions in which a view is right, and up.
struct Directions {
    right: Vector3<f64>,
    up: Vector3<f64>,
}

/// The configuration from the side and from the top: what is up is where the payload goes.
pub(crate) fn sketch(scenario: &Scenario) -> Drawing {
    let away = scenario.separation_direction().map_or_else(Vector3::z, |d| d.into_inner());
    // The axis that is most across.
    let mut across = Vector3::zeros();
    across[away.iamin()] = 1.0;
    let right = (across - away * across.dot(&away)).normalize();
    let side = Directions { right, up: away };
    let top = Directions { right, up: away.cross(&right) };
    let views = [("From the side", side), ("From the payload’s end", top)];
    let views = views.map(|(title, directions)| directions.view(scenario, title));
    let bodies = match scenario.outlines() {
        Some(_) => "Bodies are the outlines of the scenario",
        None => {
            "Bodies are the uniform boxes that have their masses and inertias, which is not their shape"
        }
    };
    let caption = format!(
        "The nominal configuration at the start. {bodies}. Springs are between their pads, with their numbers from 1; the arrows \
         are the inertial axes"
    );
    sketch_figure(CONFIGURATION, &caption, "Configuration", &views)
}

impl Directions {
    fn seen(&self, point: &Vector3<f64>) -> [f64; 2] {
        [point.dot(&self.right), point.dot(&self.up)]
    }

    fn view(&self, scenario: &Scenario, title: &str) -> SketchView {
        let separation = scenario.separation();
        let moving = |body: Body| match body {
            Body::Payload => separation.payload(),
            Body::Stage => separation.stage(),
        };
        let body = |body: Body| {
            let moving = moving(body);
            let shapes = scenario.outlines().map(|outlines| &outlines.shapes()[body as usize]);
            let shapes = match shapes {
                Some(shapes) => shapes.iter().map(|shape| self.shape(shape, moving)).collect(),
                None => vec![self.uniform_box(moving)],
            };
            let mass_centre = self.seen(&moving.state().position);
            SketchBody { name: body.name().to_owned(), mass_centre, shapes }
        };
        let springs = separation.loads().map(|(id, load)| {
            let [payload, stage] = load.points_m();
            let ends = [(Body::Payload, payload), (Body::Stage, stage)];
            let ends = ends.map(|(body, point)| self.seen(&inertial(moving(body), &point)));
            ((id.number + 1).to_string(), ends)
        });
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()].into_iter().zip(["1", "2", "3"]);
        SketchView {
            title: title.to_owned(),
            axes: axes.map(|(axis, name)| (name.to_owned(), self.seen(&axis))).collect(),
            bodies: Body::BOTH.map(body).into(),
            springs: springs.collect(),
        }
    }

    fn shape(&self, shape: &ShapeFile, body: &MovingBody) -> SketchShape {
        let seen = |points: &[[f64; 3]]| {
            points.iter().map(|p| self.seen(&inertial(body, &Vector3::from(*p)))).collect()
        };
        match shape {
            ShapeFile::PointsM(points) => SketchShape::Points(seen(points)),
            ShapeFile::HullM(points) => SketchShape::Hull(seen(points)),
            ShapeFile::Ring { centre_m, axis, radius_m } => {
                let (centre, [one, other]) = (Vector3::from(*centre_m), radii(*axis, *radius_m));
                let corner = |i: u32| {
                    let angle = f64::from(i) / f64::from(CORNERS) * std::f64::consts::TAU;
                    let point = centre + one * libm::cos(angle) + other * libm::sin(angle);
                    self.seen(&inertial(body, &point))
                };
                SketchShape::Closed((0..CORNERS).map(corner).collect())
            }
        }
    }

    fn uniform_box(&self, body: &MovingBody) -> SketchShape {
        let (sides, attitude) = uniform_box(body);
        let corner = |i: u32| {
            let signs = [i & 1, i >> 1 & 1, i >> 2 & 1].map(|bit| f64::from(bit) - 0.5);
            let corner = Vector3::from_fn(|k, _| signs[k] * sides[k]);
            self.seen(&inertial(body, &(attitude * corner)))
        };
        SketchShape::Hull((0..8).map(corner).collect())
    }
}

/// A point of a body, from its mass centre in body axes, in inertial axes.
fn inertial(body: &MovingBody, point: &Vector3<f64>) -> Vector3<f64> {
    let state = body.state();
    state.position + state.attitude * point
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        /// Whatever the direction of separation: both views are at right angles to each other, so that no length is lost, and the top
        /// view looks along the direction.
        #[test]
        fn views_are_at_right_angles(direction in [-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64], outlines in any::<bool>()) {
            prop_assume!(direction.iter().any(|x| x.abs() > 0.1));
            let paper = Scenario::peck_2003().unwrap().to_toml();
            let mut text = paper.replacen("[payload]\n", "[clearance]\npayload = [{ points_m = [[0.5, 0.0, -0.6]] }, { ring = { \
                centre_m = [0.0, 0.0, -0.9], axis = [0.0, 0.0, 2.0], radius_m = 0.7 } }]\nstage = [{ hull_m = [[0.0, 0.0, 0.6], \
                [1.0, 0.0, 0.6], [0.0, 1.0, 0.6]] }]\n[payload]\n", usize::from(outlines));
            text.insert_str(0, &format!("separation_direction = {direction:?}\n"));
            let Ok(scenario) = Scenario::from_toml(&text) else { return Ok(()) };
            let away = scenario.separation_direction().unwrap().into_inner();
            let mut across = Vector3::zeros();
            across[away.iamin()] = 1.0;
            let right = (across - away * across.dot(&away)).normalize();
            let [side, top] = [Directions { right, up: away }, Directions { right, up: away.cross(&right) }];
            let [a, b] = [side.view(&scenario, ""), top.view(&scenario, "")];
            prop_assert_eq!(a.springs.len(), 4);
            for ((place, load), (in_side, in_top)) in
                scenario.separation().loads().zip(a.springs.iter().zip(&b.springs))
            {
                prop_assert_eq!(&in_side.0, &(place.number + 1).to_string());
                let separation = scenario.separation();
                let line = load.line(separation.payload().state(), separation.stage().state());
                let [p, s] = in_side.1;
                let [q, t] = in_top.1;
                let seen = [p[0] - s[0], p[1] - s[1], q[1] - t[1]];
                let norm = seen.iter().map(|x| x * x).sum::<f64>().sqrt();
                prop_assert!((norm - line.norm()).abs() < 1e-9, "{norm} {}", line.norm());
            }
            for ((_, a), (_, b)) in a.axes.iter().zip(&b.axes) {
                let norm = a[0] * a[0] + a[1] * a[1] + b[1] * b[1];
                prop_assert!((norm - 1.0).abs() < 1e-9);
            }
        }
    }
}
