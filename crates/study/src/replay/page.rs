//! The animation of a run: one page of HTML that needs nothing but itself.

use gyradius_clearance::{Clearance, Outline};
use gyradius_report::{page, significant};
use gyradius_separation::{MovingBody, Separation};
use maud::{PreEscaped, html};
use serde_json::{Value, json};

use super::{
    Replay,
    film::{self, Frame},
    outlines::{self, short},
};
use crate::{column::REALIZABLE, drawn, loads::Short, scenario::distance_m, solid::uniform_box};

const SCRIPT: &str = include_str!("page.js");
const STYLE: &str = include_str!("page.css");
/// Loads drawn at most.
const LOADS: usize = 200;

pub(crate) fn html(replay: &Replay) -> String {
    let name = replay.scenario.name();
    let (model, run) = (&replay.model, replay.row().run());
    let flight = replay.scenario.fleet().map(|fleet| format!(" {}", fleet.told(run)));
    let flight = flight.unwrap_or_default();
    // JSON in a script must not end it.
    let data = data(replay).to_string().replace('<', "\\u003c");
    let outlines = replay.scenario.outlines().is_some();
    let mut loads = replay.case.separation.iter().flat_map(Separation::loads);
    let late_or_failed = loads.any(|(_, load)| load.start_s() != Some(0.0));
    let content = html! {
        h1 { "Run " (run) (flight) " of " (model) }
        p.lead {
            "Scenario " strong { (name) } ": payload and stage, seen from their common mass centre. "
            @if outlines {
                "Each is drawn by its outline, as the scenario gives it."
            } @else {
                "Each is drawn as the uniform box that has its mass and inertia, which is not its shape; boxes may overlap."
                @if replay.row().flag(REALIZABLE) == Some(false) {
                    " No distribution of mass has the inertia drawn: boxes are flat where they would be less."
                }
            }
        }
        @if replay.row().failure().is_some() { p.warning { (replay.row().status()) } }
        @if let Some(cut) = replay.film.cut_s() {
            p.warning {
                "The animation ends at " (significant(cut, 4)) " s, and the run at " (significant(replay.history.end_s(), 4)) " s: it has \
                 room for " (film::MOST) " moments, from one of which to the next neither body may turn by more than about 20°. "
                code { "history.csv" } " and " code { "history.svg" } " have the whole run."
            }
        }
        div.view {
            div.scene { canvas #scene tabindex="0" role="img" aria-label="Payload, stage and springs in three dimensions" {} }
            div #charts {}
        }
        div.slider {
            input #time type="range" min="0" max="1000" step="any" value="0" aria-label="time";
            div #marks {}
        }
        div.controls {
            button #play type="button" { "Pause" }
            button #last type="button" { "Previous event" }
            button #back type="button" { "Step back" }
            button #on type="button" { "Step" }
            button #next type="button" { "Next event" }
            button #reset type="button" { "Reset" }
            output #clock {}
            label { "speed " select #speed {} }
            @if outlines { label { input #boxes type="checkbox" value="on"; " boxes of the same inertia" } }
        }
        p.key {
            span.payload { "payload" } " " span.stage { "stage" } " "
            span.spring { "springs that push" } " "
            @if late_or_failed { span.failed { "✕ never pushes" } " " span.late { "late: has not started yet" } " " }
            span.momentum { "angular momentum of the payload" } " "
            span.spin { "spin axis" } " "
            @if replay.clearance.is_some() { span.nearest { "where they come nearest" } " " }
            span.one { "1" } " " span.two { "2" } " " span.three { "3" } " body axes"
        }
        div.wide { table.now { caption { "At the time shown" } tbody #now {} } }
        p { small {
            "Drag to turn, wheel or two fingers to zoom. Keys: space to stop and go, comma and full stop for a step, [ and ] for \
             the previous and the next event, r to reset; arrows, + and − turn and zoom the scene once it is chosen."
        } }
        @if !replay.history.releases.is_empty() {
            p { small { "Marks on the slider, and dashed lines in the charts, show when each spring is released, by its number. Where the last \
                 release is in the first quarter of the time, the first half of the slider and of the charts goes up to 1.2 times the time of that release." } }
        }
        script { (PreEscaped("const data = ")) (PreEscaped(data)) (PreEscaped(";\n")) (PreEscaped(SCRIPT)) }
    };
    page(&format!("{name}: {model}, run {run}{flight}"), STYLE, &content)
}

/// What the script draws. Numbers have as many digits as can be seen.
fn data(replay: &Replay) -> Value {
    let history = &replay.history;
    let centres = drawn::mass_centres(replay.scenario.dispersions(), &replay.case.drawn);
    let outlines = replay.scenario.outlines();
    let shapes = outlines.and_then(|outlines| outlines.about(&centres).ok());
    let shown = replay.film.frames();
    let frames: Vec<Value> = shown.iter().map(|f| frame(replay, f, shapes.as_ref())).collect();
    let end = shown.last().map_or(0.0, |frame| frame.time_s);
    let separation = replay.case.separation.as_ref().ok();
    let loads: Vec<Value> = separation
        .iter()
        .flat_map(|s| s.loads())
        .take(LOADS)
        .map(|(id, load)| {
            let released = history.releases.iter().find(|(released, _)| *released == id);
            // Of a run that fails some still push at its end.
            let pushes =
                released.is_some() || (load.can_push() && replay.row().failure().is_some());
            let [payload, stage] = load.points_m();
            json!({
                "name": Short(id).to_string(),
                "label": id.to_string(),
                "late": pushes && load.start_s().is_some_and(|start| start > 0.0),
                "p": short(payload.as_slice()),
                "s": short(stage.as_slice()),
                "from": load.start_s().filter(|_| pushes),
                "free": released.map(|(_, time)| time),
            })
        })
        .collect();
    let bodies = separation.map(|s| [cuboid(s.payload()), cuboid(s.stage())]);
    let outlines = outlines.map(|outlines| {
        let shapes = outlines.shapes();
        [0, 1].map(|i| outlines::drawn(&shapes[i], &centres[i]))
    });
    let closest = replay.clearance.as_ref().and_then(Clearance::closest).map(|c| {
        json!({
            "t": c.time_s(),
            "d": short(&[c.distance_m()])[0],
            "p": short(c.payload_point_m().as_slice()),
            "s": short(c.stage_point_m().as_slice()),
        })
    });
    json!({
        "outlines": outlines,
        "closest": closest,
        "frames": frames,
        "springs": loads,
        "boxes": bodies.map_or_else(Vec::new, Vec::from),
        "spin": short(replay.scenario.spin_axis().as_slice()),
        "releases": history.releases.iter().filter(|(_, time)| *time <= end).take(LOADS).map(|(load, time)| {
            json!([Short(*load).to_string(), time, load.to_string()])
        }).collect::<Vec<_>>(),
    })
}

/// Time, then of payload and stage position, attitude and rates (deg/s), then the payload's angular
/// momentum (inertial axes), nutation (deg) and the distance of the outlines (m), null where there is none.
fn frame(replay: &Replay, now: &Frame, outlines: Option<&[Outline; 2]>) -> Value {
    let Frame { time_s, payload, stage } = now;
    let (mp, ml) = (payload.body().mass_kg(), stage.body().mass_kg());
    let (p, l) = (payload.state().position, stage.state().position);
    // From the common mass centre.
    let positions = [(p - l) * (ml / (mp + ml)), (l - p) * (mp / (mp + ml))];
    let mut values = Vec::new();
    for (body, position) in [payload, stage].into_iter().zip(positions) {
        let state = body.state();
        values.extend(position.iter().chain(state.attitude.coords.iter()));
        values.extend(state.angular_velocity.iter().map(|w| w.to_degrees()));
    }
    values.extend(payload.inertial_spin_angular_momentum().iter());
    let nutation = replay.history.nutation_deg(payload, replay.scenario.spin_axis());
    let apart = outlines.and_then(|outlines| distance_m(outlines, [payload, stage]));
    // Times with all their digits: of a late release, the sixth is longer than the push.
    let mut values: Vec<Value> = std::iter::once(json!(time_s)).chain(short(&values)).collect();
    values.extend([nutation, apart].map(|x| x.map_or(Value::Null, |x| short(&[x])[0].clone())));
    Value::Array(values)
}

/// The uniform box with the mass and inertia of a body.
fn cuboid(body: &MovingBody) -> Value {
    let (sides, attitude) = uniform_box(body);
    let (sides, attitude) = (short(&sides), short(attitude.coords.as_slice()));
    json!({ "sides": sides, "q": attitude })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scenario;
    use nalgebra::{Quaternion, UnitQuaternion, Vector3};

    fn three(values: &Value, from: usize) -> Vector3<f64> {
        Vector3::from_fn(|i, _| values[from + i].as_f64().unwrap())
    }

    /// From positions and attitudes of every frame alone.
    #[test]
    fn the_outlines_are_as_far_apart_as_their_points() {
        let points = [
            [[0.4, -0.3, -0.8], [1.0, 1.0, -0.2], [-1.3, 0.2, 0.1]],
            [[1.0, 1.0, 0.9], [-0.5, 0.3, 0.7], [0.2, -1.0, 0.2]],
        ];
        let text = format!(
            "{}\n[clearance]\npayload = [{{ points_m = {:?} }}]\nstage = [{{ points_m = {:?} }}]\n",
            Scenario::peck_2003().unwrap().to_toml(),
            points[0],
            points[1]
        );
        let replay = Replay::new(&Scenario::from_toml(&text).unwrap(), None, 3, 30.0).unwrap();
        let data = data(&replay);
        let frames = data["frames"].as_array().unwrap();
        for frame in frames {
            let placed = [0, 1].map(|body| {
                let at = 1 + 10 * body;
                let [x, y, z, w] = [3, 4, 5, 6].map(|i| frame[at + i].as_f64().unwrap());
                let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
                points[body].map(|p| three(frame, at) + turn * Vector3::from(p))
            });
            let pairs =
                placed[0].iter().flat_map(|p| placed[1].iter().map(move |s| (p - s).norm()));
            let (least, found) = (pairs.fold(f64::INFINITY, f64::min), frame[25].as_f64().unwrap());
            assert!((least - found).abs() < 1e-4 * least.max(1.0), "{frame}: {least}");
        }
        assert!(frames.len() > 100);
        // Without outlines there is no such distance.
        let paper = Replay::new(&Scenario::peck_2003().unwrap(), None, 3, 1.0).unwrap();
        assert!(super::data(&paper)["frames"][0][25].is_null());
    }
}
