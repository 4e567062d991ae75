//! The bodies of a run at the moments that its animation shows.

use gyradius_separation::{MovingBody, Separation, Step};

use super::grid::{TURN, fastest};

/// Moments of an animation at most: about three megabytes.
pub(super) const MOST: usize = 10_000;
/// Moments at least while loads push and a little beyond, and afterwards, but for what is over at once.
const HALF: f64 = 130.0;

/// Payload and stage at a moment.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    pub(super) time_s: f64,
    pub(super) payload: MovingBody,
    pub(super) stage: MovingBody,
}

/// The moments that an animation shows: so many that neither body turns far from one to the next, for it goes on evenly
/// between them.
#[derive(Clone, Debug, Default)]
pub(super) struct Film {
    frames: Vec<Frame>,
    /// Whether there are so many that the end is not reached.
    is_cut: bool,
}

impl Film {
    /// Of the steps of a separation. Loads push until `pushing_s`; what happens at `events`, in their order, is shown.
    pub(super) fn new(
        separation: &Separation,
        steps: &[Step],
        pushing_s: f64,
        events: impl Iterator<Item = f64>,
    ) -> Self {
        let end = steps.last().map_or(0.0, Step::end_s);
        let knee = f64::min(1.2 * pushing_s, end);
        let mut events = events.peekable();
        let mut film = Self::default();
        let rates: Vec<f64> = steps.iter().map(fastest).collect();
        let mut next = 0.0;
        for (place, step) in steps.iter().enumerate() {
            while next < step.end_s() {
                film.push(separation, step, next);
                if film.is_cut {
                    return film;
                }
                let part = if next < knee { knee } else { end - knee };
                let coming = steps[place..].iter().zip(&rates[place..]);
                let later = f64::min(next + part / HALF, turned(next, coming));
                while events.next_if(|event| *event <= next).is_some() {}
                let event = events.peek().copied().unwrap_or(f64::INFINITY);
                // A step of time that is none is no reason to stand still.
                next = if later > next { later.min(event) } else { step.end_s() };
            }
        }
        if let Some(step) = steps.last() {
            film.push(separation, step, end);
        }
        film
    }

    fn push(&mut self, separation: &Separation, step: &Step, time_s: f64) {
        if self.frames.len() == MOST {
            self.is_cut = true;
            return;
        }
        let [payload, stage] = step.states_at(time_s);
        let payload = separation.payload().body().moving(payload);
        let stage = separation.stage().body().moving(stage);
        self.frames.push(Frame { time_s, payload, stage });
    }

    /// The moments, in the order of time.
    pub(super) fn frames(&self) -> &[Frame] {
        &self.frames
    }

    /// When it ends although the run goes on, s; none if it shows all.
    pub(super) fn cut_s(&self) -> Option<f64> {
        self.frames.last().filter(|_| self.is_cut).map(|frame| frame.time_s)
    }
}

/// Until when neither body turns too far from a moment on, s: infinity if it does not in these steps, which have these rates.
fn turned<'s>(from: f64, steps: impl Iterator<Item = (&'s Step, &'s f64)>) -> f64 {
    let (mut time, mut left) = (from, TURN);
    for (step, rate) in steps {
        let turn = rate * (step.end_s() - time).max(0.0);
        if turn >= left {
            return time + left / rate;
        }
        left -= turn;
        time = step.end_s();
    }
    f64::INFINITY
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Replay, Scenario};
    use gyradius_separation::Settings;

    /// Bodies that spin, slowly to fast, about axes that they nutate about.
    fn spinning(rate: f64, coast_s: f64) -> Replay {
        let spin = format!("angular_velocity_rad_per_s = [{:?}, {:?}, 0.0]\n", rate, 0.2 * rate);
        let text = Scenario::peck_2003().unwrap().to_toml();
        let text = text.replace("angular_velocity_rad_per_s = [0.0, 0.0, 0.0]\n", &spin);
        assert!(text.contains(&spin), "{text}");
        Replay::new(&Scenario::from_toml(&text).unwrap(), None, 3, coast_s).unwrap()
    }

    /// Halfway between two moments the bodies are where an even motion takes them, however fast they turn and however long
    /// they coast; beyond what is shown, the film says so.
    #[test]
    fn between_the_moments_a_motion_is_even() {
        for (spin, coast) in [(0.0, 0.0), (0.3, 60.0), (6.3, 700.0)] {
            let replay = spinning(spin, coast);
            let film = &replay.film;
            let frames = film.frames();
            assert!(frames.len() > 130 && frames.len() <= MOST, "{}", frames.len());
            let separation = replay.case.separation.as_ref().unwrap();
            let motion = separation.trajectory(&Settings::default(), coast).unwrap();
            let last = frames.last().unwrap().time_s;
            assert_eq!(film.cut_s(), (last < motion.end_s()).then_some(last));
            assert_eq!(film.cut_s().is_some(), spin * coast > 4000.0);
            for pair in frames.windows(2) {
                let [a, b] = pair else { unreachable!() };
                assert!(a.time_s < b.time_s);
                let now = motion.at(0.5 * (a.time_s + b.time_s)).unwrap();
                for (a, b, now) in
                    [(&a.payload, &b.payload, now.payload()), (&a.stage, &b.stage, now.stage())]
                {
                    let [a, b, now] = [a, b, now].map(|body| *body.state());
                    let turned = a.attitude.angle_to(&b.attitude);
                    assert!(turned <= 1.1 * TURN, "{turned}");
                    let between = a.attitude.slerp(&b.attitude, 0.5);
                    assert!(between.angle_to(&now.attitude) < 0.01, "{spin} {coast}");
                    let rate = 0.5 * (a.angular_velocity + b.angular_velocity);
                    let off = (rate - now.angular_velocity).norm();
                    assert!(off < 0.03 * now.angular_velocity.norm() + 1e-3, "{off}");
                }
            }
            // What happens is shown at its time.
            for moment in replay.history.moments.iter().filter(|m| !m.event.is_empty()) {
                let time = moment.now.time_s();
                assert!(time > last || frames.iter().any(|frame| frame.time_s == time), "{time}");
            }
        }
    }

    /// From rest, by a spring that is done long before another: it is not passed over.
    #[test]
    fn a_short_push_is_shown_beside_a_long_one() {
        let body = |z: f64, scale: f64| {
            format!(
                "mass_kg = {:?}\ninertia_kg_m2 = [[{:?}, 0.0, 0.0], [0.0, {:?}, 0.0], [0.0, 0.0, {:?}]]\nposition_m = [0.0, 0.0, {z:?}]\n\
                 dispersion = {{ root_second_moment_variance_kg_m2 = [0.0, 0.0, 0.0], axes = \"fixed\" }}\n",
                500.0 * scale,
                12.0 * scale,
                11.0 * scale,
                9.0 * scale
            )
        };
        let spring = |stiffness: f64, stroke: f64, y: f64| {
            format!(
                "[[springs]]\nstiffness_n_per_m = {stiffness:?}\nstroke_m = {stroke:?}\npayload_point_m = [0.0, {y:?}, -0.9]\nstage_point_m = [0.0, {y:?}, 0.9]\n"
            )
        };
        let text = format!(
            "name = \"two\"\nruns = 1\nseed = 1\n[payload]\n{}[stage]\n{}{}{}[[models]]\nname = \"own\"\nlaw = \"principal\"\naxes = \"whole-sphere\"\n",
            body(1.0, 1.0),
            body(-1.0, 40.0),
            spring(2e4, 0.6, 0.5),
            spring(1.0, 300.0, 0.0)
        );
        let replay = Replay::new(&Scenario::from_toml(&text).unwrap(), None, 0, 5.0).unwrap();
        let frames = replay.film.frames();
        let released = replay.history.releases.iter().map(|(_, time)| *time).fold(1.0, f64::min);
        let before = frames.iter().filter(|frame| frame.time_s < released).count();
        assert!(before >= 2, "{before} before {released}");
        for pair in frames.windows(2) {
            let [a, b] = [&pair[0], &pair[1]].map(|frame| frame.payload.state().attitude);
            assert!(a.angle_to(&b) <= 1.01 * TURN, "{} at {}", a.angle_to(&b), pair[0].time_s);
        }
    }

    /// A page that does not show the whole run says until when it goes, and is not too large to be opened.
    #[test]
    fn a_cut_animation_says_so() {
        for (coast, is_cut) in [(5.0, false), (700.0, true)] {
            let replay = spinning(6.3, coast);
            let page = crate::replay::page::html(&replay);
            assert_eq!(page.contains("The animation ends at "), is_cut);
            assert!(page.len() < 4_000_000, "{} bytes", page.len());
        }
    }
}
