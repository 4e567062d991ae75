//! What of the bodies may touch, while they are pushed and after that.

use gyradius_clearance::{
    Approach, Clearance, ClearanceError, ClearanceSettings, Coast, FreeBody, Motion, MotionLimits,
    Outline, OutlineError, OutlineShape, RigidState, ShapeClearance,
};
use gyradius_separation::{BodyState, MovingBody, Outcome, Separation, Settings, Step, StepLimits};
use nalgebra::Vector3;

use super::{
    ScenarioError,
    file::{ClearanceFile, ShapeFile},
    limits,
};
use crate::{body::Body, failure::RunFailure};

/// How well the distance is known before the last release, as a share of it, where most are smallest at the start:
/// what counts then is whether they touch.
const ROUGH: f64 = 0.01;

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
    pub(crate) fn about(&self, centres: &[Vector3<f64>; 2]) -> Result<[Outline; 2], RunFailure> {
        let about = |body: Body, outline: &Outline, centre: &Vector3<f64>| {
            outline
                .about(*centre)
                .map_err(|problem| RunFailure::Outline { body: body.name(), problem })
        };
        let [payload, stage] = centres;
        let payload = about(Body::Payload, &self.payload, payload)?;
        Ok([payload, about(Body::Stage, &self.stage, stage)?])
    }

    /// How near the bodies come that part so, with outlines about mass centres that lie so far off the nominal ones, body
    /// axes, m. That it cannot be found fails no run.
    pub(crate) fn watch(
        &self,
        separation: &Separation,
        settings: &Settings,
        outcome: &Outcome,
        centres: &[Vector3<f64>; 2],
    ) -> Result<Result<Watched, ClearanceError>, RunFailure> {
        let outlines = self.about(centres)?;
        let pushed = Pushed::new(separation, settings)?;
        Ok(Watched::new(&outlines, pushed, outcome, self.coast))
    }
}

/// How near the bodies come: from the opening of the clamp to the last release, and over the coast after it.
#[derive(Clone, Debug)]
pub(crate) struct Watched {
    pushed: Clearance,
    /// None if they touch before it.
    coast: Option<Clearance>,
    /// The distance at the opening of the clamp of the shapes that do not touch then, m.
    at_start: Option<f64>,
}

impl Watched {
    fn new(
        outlines: &[Outline; 2],
        mut pushed: Pushed,
        outcome: &Outcome,
        coast_s: f64,
    ) -> Result<Self, ClearanceError> {
        let ([payload, stage], release) = (outlines, outcome.release_time());
        let rough = ClearanceSettings::default().with_relative_tolerance(ROUGH).unwrap_or_default();
        let mut over_push = |to| over(outlines, &mut pushed, [0.0, to], &rough);
        let (at_start, pushed) = (over_push(0.0)?, over_push(release)?);
        let at_start = at_start.closest().map(Approach::distance_m);
        let coast = pushed.contact_s().is_none().then(|| {
            let mut coast = Coast::new(&free(outcome.payload()), &free(outcome.stage()), release);
            let (span, settings) = ([release, release + coast_s], ClearanceSettings::default());
            Clearance::following(&pushed, payload, stage, &mut coast, span, &settings)
        });
        Ok(Self { pushed, coast: coast.transpose()?, at_start })
    }

    /// Of these searches, whatever they have found.
    #[cfg(test)]
    pub(crate) fn of(pushed: Clearance, coast: Option<Clearance>) -> Self {
        Self { pushed, coast, at_start: None }
    }

    /// What counts: the clearance over the coast, but for bodies that touch before it, which would move otherwise from
    /// then on.
    pub(crate) fn clearance(&self) -> &Clearance {
        self.coast.as_ref().unwrap_or(&self.pushed)
    }

    /// After how many looks the search before the last release was given up, if it was and the clearance is that of the coast.
    pub(crate) fn given_up_before(&self) -> Option<usize> {
        let is_stopped = self.coast.is_some() && self.pushed.is_stopped();
        is_stopped.then(|| self.pushed.looks())
    }

    /// Whether a search was given up, so that the bodies may touch where no contact was found.
    pub(crate) fn is_given_up(&self) -> bool {
        self.clearance().is_stopped() || self.given_up_before().is_some()
    }

    /// Where the bodies come nearer before the last release than they were when the clamp opened, and than they are after
    /// it, by more than that is known to.
    pub(crate) fn nearer_before(&self) -> Option<&Approach> {
        let nearest = self.pushed.closest()?;
        let later = self.clearance().closest().map(Approach::distance_m);
        let others = self.at_start.into_iter().chain(later).fold(f64::INFINITY, f64::min);
        (nearest.distance_m() < (1.0 - 2.0 * ROUGH) * others).then_some(nearest)
    }
}

/// The clearance of the outlines of payload and stage over a span of time, s.
fn over<M: Motion>(
    [payload, stage]: &[Outline; 2],
    motion: &mut M,
    [from, to]: [f64; 2],
    settings: &ClearanceSettings,
) -> Result<Clearance, ClearanceError> {
    Clearance::new(payload, stage, motion, from, to, settings)
}

/// The bodies while loads push them, as they were integrated.
struct Pushed(Vec<(Step, StepLimits)>);

impl Pushed {
    fn new(separation: &Separation, settings: &Settings) -> Result<Self, RunFailure> {
        let mut steps = Vec::new();
        separation.follow(settings, 0.0, |step| steps.push((step.clone(), step.limits())))?;
        Ok(Self(steps))
    }

    /// The place of the step at a time; of the first one before it.
    fn place(&self, time_s: f64) -> usize {
        self.0.partition_point(|(step, _)| step.start_s() <= time_s).saturating_sub(1)
    }
}

impl Motion for Pushed {
    fn states(&mut self, time_s: f64) -> Option<[RigidState; 2]> {
        let (step, _) = self.0.get(self.place(time_s)).filter(|_| time_s >= 0.0)?;
        Some(step.states_at(time_s).map(rigid))
    }

    fn limits(&mut self, from_s: f64, to_s: f64) -> MotionLimits {
        let steps = self.0.get(self.place(from_s)..=self.place(to_s)).unwrap_or_default();
        let mut most = MotionLimits::default();
        for (_, step) in steps {
            most.speed = most.speed.max(step.speed_m_per_s);
            most.acceleration = most.acceleration.max(step.acceleration_m_per_s2);
            for i in 0..2 {
                let (speed, growth) =
                    (&mut most.angular_speed[i], &mut most.angular_acceleration[i]);
                *speed = speed.max(step.angular_speed_rad_per_s[i]);
                *growth = growth.max(step.angular_acceleration_rad_per_s2[i]);
            }
        }
        most
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
pub(crate) fn distance_m(outlines: &[Outline; 2], bodies: [&MovingBody; 2]) -> Option<f64> {
    let mut still = Still(bodies.map(|body| rigid(*body.state())));
    let found = over(outlines, &mut still, [0.0; 2], &ClearanceSettings::default()).ok()?;
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

fn rigid(state: BodyState) -> RigidState {
    let BodyState { position, velocity, attitude, angular_velocity } = state;
    RigidState { position, velocity, attitude, angular_velocity }
}

/// The body as nothing pushes it any more.
fn free(moving: &MovingBody) -> FreeBody {
    let body = moving.body();
    FreeBody {
        state: rigid(*moving.state()),
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

#[cfg(test)]
mod tests {
    use crate::{Scenario, run::Case};

    /// Deck and ring, mated, that springs of so short a stroke push apart: by less than a millimetre at the last release they are
    /// mated still and have no clearance, and by more they have that of the last release.
    #[test]
    fn outlines_that_have_not_parted_by_the_last_release_are_mated_in_the_coast() {
        let body = |z: f64| {
            format!(
                "mass_kg = 500.0\ninertia_kg_m2 = [[60.0, 0.0, 0.0], [0.0, 60.0, 0.0], [0.0, 0.0, 60.0]]\n\
                 position_m = [0.0, 0.0, {z:?}]\ndispersion = {{ root_second_moment_variance_kg_m2 = [0.0, 0.0, 0.0], axes = \"fixed\" }}\n"
            )
        };
        for (stroke, others) in
            [(3e-4, ""), (3e-3, ""), (3e-4, ", { points_m = [[0.0, 0.0, 0.0]] }")]
        {
            let text = format!(
                "name = \"deck\"\nruns = 1\nseed = 1\n[payload]\n{}[stage]\n{}\
                 [[springs]]\nstiffness_n_per_m = 1e6\nstroke_m = {stroke:?}\n\
                 payload_point_m = [0.0, 0.0, -1.0]\nstage_point_m = [0.0, 0.0, 0.9]\n\
                 [[models]]\nname = \"own\"\nlaw = \"principal\"\naxes = \"whole-sphere\"\n\
                 [clearance]\ncoast_s = 20.0\n\
                 payload = [{{ hull_m = [[0.5, 0.5, -0.9], [-0.5, 0.5, -0.9], [0.0, -0.5, -0.9]] }}{others}]\n\
                 stage = [{{ ring = {{ centre_m = [0.0, 0.0, 1.1], axis = [0.0, 0.0, 1.0], radius_m = 0.3 }} }}]\n",
                body(1.0),
                body(-1.0)
            );
            let scenario = Scenario::from_toml(&text).unwrap();
            let case = Case::nominal(&scenario);
            let result = scenario.separation().run(scenario.settings());
            let run = case.ended(&scenario, Some(result));
            let end = run.end().unwrap();
            let found = end.closest().map(gyradius_clearance::Approach::distance_m);
            match (stroke < 1e-3, others.is_empty()) {
                (true, true) => {
                    assert_eq!(found, None, "{:?}", end.clearance());
                    assert!(!end.clearance_notes().is_empty());
                }
                (false, true) => assert!((found.unwrap() - stroke).abs() < 1e-6, "{found:?}"),
                // The point on the axis of the ring is 0.3 m from it all around.
                (_, false) => assert!(
                    (found.unwrap() - 0.3_f64.hypot(0.9 + stroke)).abs() < 1e-6,
                    "{found:?}"
                ),
            }
        }
    }
}
