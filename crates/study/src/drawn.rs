//! Draws of what is uncertain besides the inertias, and the separation that they make.

use gyradius_campaign::{Mix, StreamRng, Streams};
use gyradius_dispersion::ModelDraw;
use gyradius_inertia::InertiaMatrix;
use gyradius_separation::{BodyParameter, Separation, Stack};
use nalgebra::Vector3;
use rand_distr::{Distribution, StandardNormal};

use crate::{
    body::Body,
    failure::RunFailure,
    groups::{BodyLaw, Drawing, Groups},
    scenario::{Dispersions, Each, Joint, Number, Scenario, Size, Target},
    steering::Steering,
};

/// What a model draws: the laws of its bodies, the random streams of its dispersions, one for each quantity, and its groups.
#[derive(Debug)]
pub(crate) struct Draws {
    pub(crate) bodies: Vec<BodyLaw>,
    /// Of each number, and whether a vehicle or a flight draws it.
    streams: Vec<(Streams, Each)>,
    pub(crate) groups: Groups,
}

/// What draws a run takes: of each group, for vehicles or for flights, and steered if the run is.
#[derive(Clone, Copy)]
pub(crate) struct Taken<'a> {
    pub(crate) mix: Mix<'a>,
    pub(crate) size: Size,
    pub(crate) steering: Option<&'a Steering>,
}

impl Taken<'_> {
    /// The number of the stream of what is drawn for a vehicle, or for a flight.
    fn stream(&self, each: Each) -> u64 {
        self.size.stream(each, self.mix.base())
    }
}

impl Draws {
    pub(crate) fn new<T>(
        (seed, model): (u64, &str),
        bodies: Vec<BodyLaw>,
        joint: &Joint<T>,
    ) -> Self {
        let stream = |number: Number<'_>| (Streams::new(seed, model, number.column), number.each);
        let (streams, groups) =
            (joint.numbers().map(stream).collect(), Groups::new(&bodies, joint));
        Self { bodies, streams, groups }
    }

    /// What a run takes of a scenario of this size that draws this.
    pub(crate) fn taken<'a>(&self, drawing: &'a Drawing, size: Size, run: u64) -> Taken<'a> {
        let mix = self.groups.mix(drawing, run, size.fleet());
        Taken { mix, size, steering: drawing.steering() }
    }

    /// The scores of so many runs that are steered, before they are correlated.
    pub(crate) fn steered(&self, drawing: &Drawing, size: Size, runs: u64) -> Vec<Vec<f64>> {
        let Some(steering) = drawing.steering() else { return Vec::new() };
        let of = |run| {
            let taken = self.taken(drawing, size, run);
            steering.of(&self.scores(taken))
        };
        (0..runs).map(of).collect()
    }

    /// The independent scores of a run, in the order of what is dispersed: one from the stream of each, steered if the run is.
    fn scores(&self, taken: Taken<'_>) -> Vec<f64> {
        let each = self.streams.iter().enumerate().map(|(place, (streams, each))| {
            (streams, self.groups.stream_of(place, taken.mix, taken.stream(*each)))
        });
        let mut scores = Vec::with_capacity(self.streams.len());
        Streams::each(each, 1, |rng| scores.push(StandardNormal.sample(rng)));
        if let Some(steering) = taken.steering {
            steering.steer(taken.mix.base(), &mut scores);
        }
        scores
    }

    /// What a run draws: the values of all that has a column, and of each body the inertia at its mass. What is kept to a region is
    /// drawn again, from where its streams stand, until it is there.
    pub(crate) fn run<T>(&self, joint: &Joint<T>, taken: Taken<'_>) -> (Vec<f64>, Vec<ModelDraw>) {
        let Self { bodies, groups, .. } = self;
        let mix = taken.mix;
        let mut scores = self.scores(taken);
        let inertia =
            |(i, body): (usize, &BodyLaw)| groups.inertia(i, mix, taken.stream(body.each), body);
        let mut draws: Vec<ModelDraw> = bodies.iter().enumerate().map(inertia).collect();
        for kept in groups.kept() {
            let (own, body) = (&joint.bodies[kept.body], &bodies[kept.body]);
            let mut again = None;
            loop {
                let values = values(joint, scores.clone());
                if own.holds(&values, &own.inertia(&values, &draws[kept.body], body.own)) {
                    break;
                }
                let (numbers, inertia) = again.get_or_insert_with(|| {
                    let streams = self.streams.iter().enumerate();
                    let own = streams.filter(|(place, _)| kept.numbers.contains(place));
                    let numbers = own.map(|(place, (streams, each))| {
                        let first = groups.stream_of(place, mix, taken.stream(*each));
                        (place, past_first_score(streams.run(first)))
                    });
                    let first = groups.inertia_stream(kept.body, mix, taken.stream(body.each));
                    let mut inertia = body.stream(first);
                    body.law.draw(&mut inertia);
                    (numbers.collect::<Vec<_>>(), inertia)
                });
                for (place, generator) in numbers {
                    scores[*place] = StandardNormal.sample(generator);
                }
                draws[kept.body] = body.law.draw(inertia);
            }
        }
        let mut values = values(joint, scores);
        for ((draw, own), body) in draws.iter_mut().zip(&joint.bodies).zip(bodies) {
            draw.inertia = own.inertia(&values, draw, body.own);
        }
        values.truncate(joint.all.len());
        (values, draws)
    }
}

fn past_first_score(mut generator: StreamRng) -> StreamRng {
    let _: f64 = StandardNormal.sample(&mut generator);
    generator
}

/// The values that scores make: mixed where they are correlated.
fn values<T>(joint: &Joint<T>, scores: Vec<f64>) -> Vec<f64> {
    let mut values = scores;
    joint.correlation.mix(&mut values);
    for (value, number) in values.iter_mut().zip(joint.numbers()) {
        *value = number.law.at_score(*value);
    }
    values
}

/// The places of the starts of loads that are not late among the values of a separation: these start as they should.
pub(crate) fn in_time(scenario: &Scenario, values: &[f64]) -> impl Iterator<Item = usize> {
    let all = scenario.dispersions().all();
    let not_late = all.iter().zip(values).filter(|(_, value)| **value == 0.0);
    not_late.filter_map(move |(d, _)| {
        let Target::Late(load, start) = d.target else { return None };
        all.iter().position(|d| d.target == Target::Load(load, start, 0))
    })
}

/// The values of a separation, of which a load that is not late starts as it should.
pub(crate) fn with_starts(scenario: &Scenario, mut values: Vec<f64>) -> Box<[f64]> {
    let in_time: Vec<usize> = in_time(scenario, &values).collect();
    for place in in_time {
        values[place] = scenario.dispersions().all()[place].nominal;
    }
    values.into()
}

/// From the nominal mass centres of payload and stage to the drawn ones, body axes, m.
pub(crate) fn mass_centres(dispersions: &Dispersions, drawn: &[f64]) -> [Vector3<f64>; 2] {
    let mut centres = [Vector3::zeros(); 2];
    for (d, value) in dispersions.all().iter().zip(drawn) {
        if let Target::Body(body, BodyParameter::MassCentre, i) = d.target {
            centres[body as usize][i] = *value;
        }
    }
    centres
}

/// The separation of a run: the scenario's with drawn values and inertias in the place of its own.
pub(crate) fn separation(
    scenario: &Scenario,
    drawn: &[f64],
    payload: InertiaMatrix,
    stage: InertiaMatrix,
) -> Result<Separation, RunFailure> {
    if drawn.is_empty() {
        return scenario.separation().with_inertias(payload, stage).map_err(RunFailure::from);
    }
    let mut stack = Stack::from(scenario.separation());
    stack.set_inertia(Body::Payload, payload);
    stack.set_inertia(Body::Stage, stage);
    for (d, &value) in scenario.dispersions().all().iter().zip(drawn) {
        put(&mut stack, d.target, value);
    }
    stack.separation().map_err(RunFailure::from)
}

/// Puts a drawn value in the place of the nominal one.
pub(crate) fn put(stack: &mut Stack, target: Target, value: f64) {
    match target {
        Target::Body(body, parameter, i) => stack.set_body(body, parameter, i, value),
        Target::Stack(parameter, i) => stack.set_whole(parameter, i, value),
        Target::Load(load, parameter, i) => stack.set_load(load, parameter, i, value),
        Target::Fails(load) if value != 0.0 => stack.fail_load(load),
        Target::Fails(_) | Target::Late(..) => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gyradius_separation::MovingBody;
    use nalgebra::UnitQuaternion;

    /// The paper's separation with something dispersed, and what the drawn values make of it.
    fn drawn(
        body: &str,
        spring: &str,
        rest: &str,
        values: &[f64],
    ) -> Result<Separation, RunFailure> {
        let text = Scenario::peck_2003().unwrap().to_toml();
        let mut text =
            text.replace("[payload.dispersion]\n", &format!("[payload.dispersion]\n{body}\n"));
        let second = text.match_indices("[[springs]]").nth(1).unwrap().0;
        text.insert_str(second, &format!("[springs.dispersion]\n{spring}\n\n"));
        let scenario = Scenario::from_toml(&format!("{text}\n{rest}")).unwrap();
        assert_eq!(scenario.dispersions().all().len(), values.len());
        let [payload, stage] =
            [scenario.payload(), scenario.stage()].map(|b| *b.nominal().as_inertia_matrix());
        separation(&scenario, values, payload, stage)
    }

    /// From stage point to payload point, inertial axes.
    fn line(separation: &Separation, spring: usize) -> Vector3<f64> {
        let (p, l) = (separation.payload().state(), separation.stage().state());
        separation.springs().nth(spring).unwrap().line(p, l)
    }

    fn near(a: Vector3<f64>, b: [f64; 3]) {
        assert!((a - Vector3::from(b)).norm() < 1e-14, "{a} {b:?}");
    }

    /// The mass centre moves in the structure, which stays where it is.
    #[test]
    fn mass_centres_move_and_pads_stay() {
        let s = drawn("mass_centre_m = 0.1", "", "", &[0.01, -0.02, 0.03]).unwrap();
        near(s.payload().state().position, [0.01, -0.02, 1.03]);
        near(s.springs().next().unwrap().payload_point_m(), [0.99, 1.02, -0.93]);
        near(s.springs().next().unwrap().stage_point_m(), [1.0, 1.0, 0.9]);
        for i in 0..4 {
            near(line(&s, i), [0.0, 0.0, 0.2]);
        }
        // It moves along where the body turns.
        let both = "mass_centre_m = 0.1\nangular_velocity_rad_per_s = 0.1\nattitude_deg = 1.0";
        let values = [0.5, 0.0, 0.0, 0.0, 0.0, 90.0, 0.0, 0.0, 2.0];
        let s = drawn(both, "", "", &values).unwrap();
        near(s.payload().state().position, [0.0, 0.5, 1.0]);
        near(s.payload().state().velocity, [-1.0, 0.0, 0.0]);
    }

    #[test]
    fn springs_take_what_they_draw() {
        let all = "stiffness_percent = 1.0\nstroke_m = 0.01\nfriction_n = { sigma = 1.0, mean = 5.0 }\n\
                   payload_point_m = 0.1\nstage_point_m = 0.1\nstart_s = { sigma = 1.0, mean = 5.0 }\n\
                   failure_probability = 0.5";
        let values = [7e4, 0.11, 3.0, 1.0, 1.1, -0.9, 1.0, 1.1, 0.9, 0.25, 0.0];
        let s = drawn("", all, "", &values).unwrap();
        let spring = *s.springs().next().unwrap();
        assert_eq!(
            [spring.stiffness_n_per_m(), spring.stroke_m(), spring.friction_n()],
            values[..3]
        );
        assert_eq!(spring.start_s(), Some(0.25));
        near(line(&s, 0), [0.0, 0.0, 0.2]);
        let peck = Scenario::peck_2003().unwrap();
        assert!(s.springs().skip(1).eq(peck.separation().springs().skip(1)));
        let mut failed = values;
        failed[10] = 1.0;
        assert!(!drawn("", all, "", &failed).unwrap().springs().next().unwrap().can_push());
        for (i, word) in [(0, "stiffness"), (1, "stroke"), (2, "friction"), (9, "start")] {
            let mut bad = values;
            bad[i] = -1.0;
            let failure = drawn("", all, "", &bad).unwrap_err();
            assert!(
                failure.to_string().starts_with(&format!("spring 1: {word} = -1")),
                "{failure:?}"
            );
            assert_eq!(failure.kind(), "spring 1: impossible");
        }
    }

    /// A tilted line keeps its length and its stage point; its angle is the length of both turns.
    #[test]
    fn lines_of_action_turn_about_the_stage_point() {
        let tilted = |a, b| drawn("", "line_of_action_deg = 1.0", "", &[a, b]).unwrap();
        let nominal = Vector3::new(0.0, 0.0, 0.2);
        for (a, b) in [(0.5, 0.0), (0.0, 0.5), (-0.3, 0.4), (20.0, 70.0), (0.0, 0.0)] {
            let s = tilted(a, b);
            let line = line(&s, 0);
            assert!((line.norm() - 0.2).abs() < 1e-15);
            let angle = line.cross(&nominal).norm().atan2(line.dot(&nominal)).to_degrees();
            assert!((angle - f64::hypot(a, b)).abs() < 1e-12, "{angle}");
            near(s.springs().next().unwrap().stage_point_m(), [1.0, 1.0, 0.9]);
            assert!((s.release_lengths().next().unwrap() - 0.3).abs() < 1e-15);
        }
        // About the stage's axes 1 and 2: right-handed.
        let sin = 0.2 * 0.1_f64.sin();
        assert!((line(&tilted(0.1_f64.to_degrees(), 0.0), 0).y + sin).abs() < 1e-15);
        assert!((line(&tilted(0.0, 0.1_f64.to_degrees()), 0).x - sin).abs() < 1e-15);
    }

    /// A stack that turns is one rigid body about its mass centre.
    #[test]
    fn a_stack_moves_as_one_body() {
        let stack = "[stack.dispersion]\nattitude_deg = 1.0\nangular_velocity_rad_per_s = 0.01";
        let values = [10.0, -20.0, 30.0, 0.01, -0.02, 0.05];
        let s = drawn("", "", stack, &values).unwrap();
        let (p, l) = (s.payload(), s.stage());
        let axes = l.state().attitude;
        assert!(p.state().attitude.angle_to(&axes) < 1e-15);
        let turned =
            UnitQuaternion::from_scaled_axis(Vector3::new(10.0, -20.0, 30.0).map(f64::to_radians));
        assert!(axes.angle_to(&turned) < 1e-15);
        near(p.state().angular_velocity, [0.01, -0.02, 0.05]);
        near(l.state().angular_velocity, [0.01, -0.02, 0.05]);
        let rate = axes * Vector3::new(0.01, -0.02, 0.05);
        let arm = p.state().position - l.state().position;
        assert!((arm - axes * Vector3::z() * 2.0).norm() < 1e-14);
        let relative = p.state().velocity - l.state().velocity;
        assert!((relative - rate.cross(&arm)).norm() < 1e-15);
        assert!((p.momentum() + l.momentum()).norm() < 1e-12);
        // Turned alone, it separates as before, but elsewhere.
        let still = drawn("", "", stack, &[10.0, -20.0, 30.0, 0.0, 0.0, 0.0]).unwrap();
        let settings = gyradius_separation::Settings::default();
        let [a, b] = [&still, Scenario::peck_2003().unwrap().separation()]
            .map(|s| s.run(&settings).unwrap());
        let rates = [&a, &b].map(|o| o.payload().state().angular_velocity);
        assert!((rates[0] - rates[1]).norm() < 1e-12);
        let velocity = a.relative_velocity() - turned * b.relative_velocity();
        assert!(velocity.norm() < 1e-12);
    }

    #[test]
    fn bodies_take_what_they_draw() {
        let all = "mass_kg = 1.0\nposition_m = 0.1\nvelocity_m_per_s = 0.1";
        let values = [9e3, 0.1, 0.2, 1.3, 0.4, 0.5, 0.6];
        let s = drawn(all, "", "", &values).unwrap();
        assert_eq!(s.payload().body().mass_kg(), 9e3);
        near(s.payload().state().position, [0.1, 0.2, 1.3]);
        near(s.payload().state().velocity, [0.4, 0.5, 0.6]);
        near(line(&s, 2), [0.1, 0.2, 0.5]);
        let failure = drawn("mass_kg = 1.0", "", "", &[-5.0]).unwrap_err();
        assert_eq!(failure.kind(), "payload: mass not positive");
        // The pads meet where a body is drawn 0.2 m lower.
        let failure = drawn("position_m = 1.0", "", "", &[0.0, 0.0, 0.8]).unwrap_err();
        assert_eq!(failure.kind(), "points of a spring touch");
    }

    #[test]
    fn an_inertia_that_goes_with_the_mass_is_scaled() {
        let text = Scenario::peck_2003().unwrap().to_toml();
        let text = text.replacen(
            "[payload.dispersion]",
            "[payload.dispersion]\nmass_kg = 1.0\ninertia_follows_mass = true",
            1,
        );
        let scenario = Scenario::from_toml(&text).unwrap();
        let inertia = *scenario.payload().nominal().as_inertia_matrix();
        let [payload, stage] = &scenario.dispersions().joint.bodies[..] else { panic!() };
        let draw = ModelDraw::from(inertia);
        let heavier = payload.inertia(&[11_000.0], &draw, true);
        assert!((heavier.matrix() - inertia.matrix() * 1.1).norm() < 1e-11);
        assert_eq!(payload.inertia(&[-1.0], &draw, true), inertia);
        assert_eq!(stage.inertia(&[11_000.0], &draw, true), inertia);
    }

    /// Position, velocity, attitude and rate of payload and stage.
    fn numbers(bodies: [&MovingBody; 2]) -> Vec<f64> {
        let of = |body: &MovingBody| {
            let s = *body.state();
            let (q, w) = (s.attitude.coords, s.angular_velocity);
            [s.position.as_slice(), s.velocity.as_slice(), q.as_slice(), w.as_slice()].concat()
        };
        bodies.map(of).concat()
    }

    /// Everything dispersed at once, against a program that shares nothing with this one
    /// (`tests/data/dispersed.py`).
    #[test]
    fn dispersed_separations_match_the_reference() {
        let scenario = Scenario::from_toml(include_str!("../tests/data/dispersed.toml")).unwrap();
        let reference = include_str!("../tests/data/dispersed.json");
        let reference: serde_json::Value = serde_json::from_str(reference).unwrap();
        let columns = serde_json::to_value(scenario.dispersions().columns()).unwrap();
        assert_eq!(reference["columns"], columns);
        let settings = gyradius_separation::Settings::default();
        for (i, run) in reference["runs"].as_array().unwrap().iter().enumerate() {
            let list = |key: &str| -> Vec<f64> {
                run[key].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
            };
            let [payload, stage] = ["payload_inertia", "stage_inertia"].map(|key| {
                let e = list(key);
                InertiaMatrix::from_entries([e[0], e[1], e[2]], [e[3], e[4], e[5]]).unwrap()
            });
            let separation = separation(&scenario, &list("drawn"), payload, stage).unwrap();
            let outcome = separation.run(&settings).unwrap();
            let near = |what: &str, found: Vec<f64>, tolerance: f64| {
                let expected = list(what);
                assert_eq!(found.len(), expected.len());
                for (j, (a, b)) in found.iter().zip(&expected).enumerate() {
                    assert!((a - b).abs() < tolerance, "run {i}, {what} {j}: {a} {b}");
                }
            };
            near("start", numbers([separation.payload(), separation.stage()]), 1e-13);
            let releases = outcome.release_times().map(|time| time.unwrap_or(0.0));
            near("release_times_s", releases.collect(), 1e-11);
            near("end", numbers([outcome.payload(), outcome.stage()]), 1e-10);
        }
    }
}
