//! What of the bodies may touch after the separation.

use gyradius_clearance::{
    Approach, Clearance, ClearanceError, ClearanceSettings, Coast, FreeBody, Motion, MotionLimits,
    Outline, OutlineError, OutlineShape, RigidState, ShapeClearance,
};
use gyradius_separation::{MovingBody, Outcome};
use nalgebra::Vector3;

use super::{
    ScenarioError,
    file::{ClearanceFile, ShapeFile},
    limits,
};
use crate::{body::Body, failure::Failure};

/// What of the bodies may touch, and how long it is watched.
#[derive(Clone, Debug)]
pub(crate) struct Outlines {
    payload: Outline,
    stage: Outline,
    coast: f64,
    /// As written, payload and stage.
    shapes: [Vec<ShapeFile>; 2],
}

impl Outlines {
    pub(crate) fn new(file: &ClearanceFile) -> Result<Self, ScenarioError> {
        let coast = file.coast_s;
        if !(coast > 0.0 && coast <= limits::COAST) {
            let problem = format!("{coast:?}: it must be positive and at most {:e}", limits::COAST);
            return Err(ScenarioError::field("clearance.coast_s", problem));
        }
        let outline = |body: &str, shapes: &[ShapeFile]| {
            let shapes = shapes.iter().enumerate().map(|(i, file)| {
                shape(file).map_err(|e| {
                    let key = shape_key(file, &e);
                    ScenarioError::field(format!("clearance.{body}[{}].{key}", i + 1), e)
                })
            });
            Outline::new(shapes.collect::<Result<Vec<_>, _>>()?)
                .map_err(|e| ScenarioError::field(format!("clearance.{body}"), e))
        };
        let payload = outline("payload", &file.payload)?;
        let stage = outline("stage", &file.stage)?;
        let shapes = [file.payload.clone(), file.stage.clone()];
        Ok(Self { payload, stage, coast, shapes })
    }

    /// The shapes of payload and stage, from the nominal mass centres.
    pub(crate) fn shapes(&self) -> &[Vec<ShapeFile>; 2] {
        &self.shapes
    }

    /// How long they are watched, s.
    pub(crate) fn coast_s(&self) -> f64 {
        self.coast
    }

    /// The outlines of payload and stage about mass centres that lie so far off the nominal ones, body axes, m.
    pub(crate) fn about(&self, centres: &[Vector3<f64>; 2]) -> Result<[Outline; 2], Failure> {
        let about = |body: Body, outline: &Outline, centre: &Vector3<f64>| {
            outline.about(*centre).map_err(|source| Failure::Outline { body: body.name(), source })
        };
        let [payload, stage] = centres;
        let payload = about(Body::Payload, &self.payload, payload)?;
        Ok([payload, about(Body::Stage, &self.stage, stage)?])
    }

    /// The clearance over the coast after the last release, of outlines about mass centres that lie
    /// so far off the nominal ones, body axes, m. That it cannot be found fails no run.
    pub(crate) fn clearance(
        &self,
        outcome: &Outcome,
        centres: &[Vector3<f64>; 2],
    ) -> Result<Result<Clearance, ClearanceError>, Failure> {
        let [payload, stage] = self.about(centres)?;
        let from = outcome.release_time();
        let mut coast = Coast::new(&free(outcome.payload()), &free(outcome.stage()), from);
        let settings = ClearanceSettings::default();
        let to = from + self.coast;
        Ok(Clearance::new(&payload, &stage, &mut coast, from, to, &settings))
    }
}

impl ShapeFile {
    /// What it is, in a word.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::PointsM(_) => "points",
            Self::HullM(_) => "hull",
            Self::Ring { .. } => "ring",
        }
    }
}

/// The distance of the outlines of payload and stage at an instant, m: 0 where any of their shapes touch. None if it
/// cannot be found.
pub(crate) fn distance_m([payload, stage]: &[Outline; 2], bodies: [&MovingBody; 2]) -> Option<f64> {
    let mut still = Still(bodies.map(rigid));
    let settings = ClearanceSettings::default();
    let found = Clearance::new(payload, stage, &mut still, 0.0, 0.0, &settings).ok()?;
    let distance = |shapes: &ShapeClearance| {
        let apart = shapes.closest().map(Approach::distance_m);
        if shapes.is_mated() { Some(0.0) } else { apart }
    };
    found.shapes().iter().filter_map(distance).reduce(f64::min)
}

/// Bodies that stay where they are.
struct Still([RigidState; 2]);

impl Motion for Still {
    fn states(&mut self, _: f64) -> Option<[RigidState; 2]> {
        Some(self.0)
    }

    fn limits(&mut self, _: f64, _: f64) -> MotionLimits {
        MotionLimits::default()
    }
}

fn rigid(moving: &MovingBody) -> RigidState {
    let state = moving.state();
    RigidState {
        position: state.position,
        velocity: state.velocity,
        attitude: state.attitude,
        angular_velocity: state.angular_velocity,
    }
}

/// The body as nothing pushes it any more.
fn free(moving: &MovingBody) -> FreeBody {
    let body = moving.body();
    FreeBody {
        state: rigid(moving),
        inertia: *body.inertia().matrix(),
        inverse_inertia: *body.inverse_inertia(),
        principal_moments: body.inertia().principal_axes().moments(),
    }
}

fn shape(file: &ShapeFile) -> Result<OutlineShape, OutlineError> {
    let vectors = |p: &[[f64; 3]]| p.iter().map(|x| Vector3::from(*x)).collect::<Vec<_>>();
    match file {
        ShapeFile::PointsM(p) => OutlineShape::points(&vectors(p)),
        ShapeFile::HullM(p) => OutlineShape::hull(&vectors(p)),
        ShapeFile::Ring { centre_m, axis, radius_m } => {
            OutlineShape::ring((*centre_m).into(), (*axis).into(), *radius_m)
        }
    }
}

/// The key of what is wrong with a shape.
fn shape_key(file: &ShapeFile, error: &OutlineError) -> &'static str {
    match (file, error) {
        (ShapeFile::PointsM(_), _) => "points_m",
        (ShapeFile::HullM(_), _) => "hull_m",
        (ShapeFile::Ring { .. }, OutlineError::Coordinate { .. }) => "ring.centre_m",
        (ShapeFile::Ring { .. }, OutlineError::Axis { .. }) => "ring.axis",
        (ShapeFile::Ring { .. }, OutlineError::Radius { .. }) => "ring.radius_m",
        (ShapeFile::Ring { .. }, _) => "ring",
    }
}
