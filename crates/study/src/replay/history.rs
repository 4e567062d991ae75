//! The motion of a run, sampled, and as a table.

use gyradius_separation::{AnyLoad, LoadId, LoadState, MovingBody, Outcome, Snapshot, Step};
use nalgebra::{Unit, Vector3};
use std::{borrow::Cow, iter};

use super::grid::{Grid, Part};
use crate::csv;

/// Rows on an even grid at most, about, and numbers in all of them.
const MOST: f64 = 20_000.0;
const NUMBERS: f64 = 1e6;

/// A moment of a run.
#[derive(Clone, Debug)]
pub(crate) struct Moment {
    pub(crate) now: Snapshot,
    /// What happens then, if anything does.
    pub(crate) event: String,
}

/// The motion on grids that are even in time, one to the last release and one from there on, and at every event.
#[derive(Clone, Debug)]
pub(crate) struct History {
    pub(crate) moments: Vec<Moment>,
    /// The same at scattered times; empty where the grids are fine enough for figures.
    scattered: Vec<Moment>,
    /// Which load let go and when, s, in the order of time.
    pub(crate) releases: Vec<(LoadId, f64)>,
    /// Which loads there are.
    pub(crate) loads: Vec<LoadId>,
    /// From when on no load can push, s; none if the run fails before.
    free: Option<f64>,
    /// An angular momentum of the payload up to this is rounding, kg·m²/s.
    rounding: f64,
}

impl History {
    /// Of the steps of a run by loads, and its outcome if it ends well.
    pub(crate) fn new(
        steps: &[Step],
        loads: &[(LoadId, AnyLoad)],
        outcome: Option<&Outcome>,
    ) -> Self {
        let end = steps.last().map_or(0.0, Step::end_s);
        let ids: Vec<LoadId> = loads.iter().map(|(id, _)| *id).collect();
        let mut releases = Vec::new();
        for step in steps {
            releases.extend(step.released().iter().map(|place| (ids[*place], step.end_s())));
        }
        let last = releases.last().map_or(end, |(_, time)| *time);
        let most = MOST.min(NUMBERS / columns(&ids).len() as f64);
        let parts = [(0.0, last), (last, end)].map(|part| Part::new(part, steps, last, most));
        let is_coarse = parts.iter().any(|part| part.is_coarse);
        let (mut moments, mut scattered) = (Vec::<Moment>::new(), Vec::<Moment>::new());
        let [mut even, mut uneven] =
            [false, true].map(|is_scattered| parts.map(|part| Grid::new(part, is_scattered)));
        for step in steps {
            let part = usize::from(step.start_s() >= last);
            let mut due: Vec<(f64, String)> =
                even[part].before(step.end_s()).map(|time| (time, String::new())).collect();
            if is_coarse {
                let times = uneven[part].before(step.end_s());
                scattered
                    .extend(times.map(|time| Moment { now: step.at(time), event: String::new() }));
            }
            for (place, (id, load)) in loads.iter().enumerate() {
                let start = load.start_s().unwrap_or(0.0);
                let starts = start > 0.0 && (step.start_s()..step.end_s()).contains(&start);
                // One that has come to its release length by then does not.
                if starts && step.at(start).loads()[place].is_pushing() {
                    due.push((start, format!("{id} starts")));
                }
            }
            for (place, time) in step.pressed_again() {
                due.push((*time, format!("{} pressed again", ids[*place])));
            }
            if !step.released().is_empty() {
                let released: Vec<_> = step.released().iter().map(|place| ids[*place]).collect();
                due.push((step.end_s(), format!("{} released", together(&released))));
            } else if step.end_s() == end {
                due.push((end, "end".to_owned()));
            }
            due.sort_by(|a, b| a.0.total_cmp(&b.0));
            // One row a moment, also where something happens on the grid.
            due.dedup_by(|later, first| {
                let same = later.0 == first.0;
                if same {
                    let between =
                        if first.1.is_empty() || later.1.is_empty() { "" } else { " and " };
                    first.1 = format!("{}{between}{}", first.1, later.1);
                }
                same
            });
            moments.extend(due.into_iter().map(|(t, event)| Moment { now: step.at(t), event }));
        }
        if is_coarse {
            scattered.extend(moments.last().cloned());
        }
        if let Some(first) = moments.first_mut() {
            first.event.insert_str(0, "clamp opens");
        }
        Self {
            moments,
            scattered,
            releases,
            loads: ids,
            free: outcome.map(Outcome::release_time),
            rounding: outcome.map_or(0.0, Outcome::momentum_rounding),
        }
    }

    /// Moments for figures: at scattered times where those of the table could keep step with a body that turns, and
    /// show nothing of it.
    pub(crate) fn for_figures(&self) -> &[Moment] {
        if self.scattered.is_empty() { &self.moments } else { &self.scattered }
    }

    /// When it ends, s.
    pub(crate) fn end_s(&self) -> f64 {
        self.moments.last().map_or(0.0, |m| m.now.time_s())
    }

    /// From when on no load can push, s; the end if some still do.
    pub(crate) fn pushing_s(&self) -> f64 {
        self.free.unwrap_or_else(|| self.end_s())
    }

    /// The table: a row a moment, columns with units in their names.
    pub(crate) fn csv(&self, spin_axis: &Unit<Vector3<f64>>) -> String {
        let header = columns(&self.loads).into_iter().map(Cow::Owned).collect();
        // As many digits as read back bit for bit, in powers of ten where these are shorter.
        let number = |x: Option<f64>| Cow::Owned(x.map_or_else(String::new, |x| format!("{x:?}")));
        let row = |moment| -> Vec<Cow<'_, str>> {
            let Moment { now, event }: &Moment = moment;
            let values = self.values(now, spin_axis).into_iter().map(number);
            let first = [number(Some(now.time_s())), event.as_str().into()];
            first.into_iter().chain(values).collect()
        };
        csv::table(iter::once(header).chain(self.moments.iter().map(row)))
    }

    fn values(&self, now: &Snapshot, spin_axis: &Unit<Vector3<f64>>) -> Vec<Option<f64>> {
        let mut values = Vec::new();
        for body in [now.payload(), now.stage()] {
            let state = body.state();
            values.extend(state.position.iter().chain(state.velocity.iter()));
            values.extend(state.attitude.coords.iter().chain(state.angular_velocity.iter()));
        }
        for load in now.loads() {
            values.extend([load.compression_m(), load.force_n().norm()]);
            values.extend(load.force_n().iter());
        }
        values.extend(now.momentum().iter().chain(now.angular_momentum().iter()));
        values.extend(energies(now));
        values.push(energies(now).iter().sum());
        let mut values: Vec<_> = values.into_iter().map(Some).collect();
        values.push(self.nutation_deg(now.payload(), spin_axis));
        values
    }

    /// The payload's nutation, deg; none if it does not turn by more than rounding.
    pub(crate) fn nutation_deg(
        &self,
        payload: &MovingBody,
        spin_axis: &Unit<Vector3<f64>>,
    ) -> Option<f64> {
        let turns = payload.spin_angular_momentum().norm() > self.rounding;
        let nutation = payload.spin_metrics(spin_axis).nutation().filter(|_| turns);
        nutation.map(f64::to_degrees)
    }
}

/// Loads that let go together, as in `springs 1 and 2`.
fn together(loads: &[LoadId]) -> String {
    let kinds = loads.chunk_by(|a, b| a.kind == b.kind).map(|of| {
        let numbers: Vec<_> = of.iter().map(|load| (load.number + 1).to_string()).collect();
        let kind = of[0].kind;
        let name = if of.len() > 1 { kind.plural() } else { kind.name() };
        format!("{name} {}", numbers.join(" and "))
    });
    kinds.collect::<Vec<_>>().join(" and ")
}

fn columns(loads: &[LoadId]) -> Vec<String> {
    let mut names = vec!["time_s".to_owned(), "event".to_owned()];
    for body in ["payload", "stage"] {
        let mut three = |what: &str, unit: &str| {
            names.extend((1..=3).map(|i| format!("{body}_{what}{i}_{unit}")));
        };
        three("x", "m");
        three("v", "m_per_s");
        names.extend((1..=4).map(|i| format!("{body}_q{i}")));
        names.extend((1..=3).map(|i| format!("{body}_w{i}_rad_per_s")));
    }
    for load in loads.iter().map(|load| load.column()) {
        names.push(format!("{load}_compression_m"));
        names.push(format!("{load}_force_n"));
        names.extend((1..=3).map(|i| format!("{load}_force_{i}_n")));
    }
    names.extend((1..=3).map(|i| format!("momentum_{i}_kg_m_per_s")));
    names.extend((1..=3).map(|i| format!("angular_momentum_{i}_kg_m2_per_s")));
    let energies = [
        "springs_j",
        "payload_translation_j",
        "payload_rotation_j",
        "stage_translation_j",
        "stage_rotation_j",
        "energy_j",
        "payload_nutation_deg",
    ];
    names.extend(energies.map(str::to_owned));
    names
}

/// Of the loads; of translation (relative to the common mass centre) and rotation of payload and
/// stage, J.
pub(crate) fn energies(now: &Snapshot) -> [f64; 5] {
    let stored = now.loads().iter().map(LoadState::energy_j).sum();
    let [payload, stage] = now.translational_energies_j();
    let rotation = MovingBody::rotational_energy;
    [stored, payload, rotation(now.payload()), stage, rotation(now.stage())]
}

#[cfg(test)]
mod tests {
    use crate::{Replay, Scenario};

    /// A spring that fails is not waited for: the pushing ends with the others'.
    #[test]
    fn failed_springs_do_not_push_on() {
        let text = Scenario::peck_2003().unwrap().to_toml();
        let second = text.match_indices("[[springs]]").nth(1).unwrap().0;
        let (head, tail) = text.split_at(second);
        let text = format!("{head}[springs.dispersion]\nfailure_probability = 1.0\n\n{tail}");
        let text = text.replace("[springs.dispersion]", "start_s = 0.01\n\n[springs.dispersion]");
        // The second is late.
        let third = text.match_indices("[[springs]]").nth(2).unwrap().0;
        let (head, tail) = text.split_at(third);
        let scenario = Scenario::from_toml(&format!("{head}start_s = 0.02\n\n{tail}")).unwrap();
        let replay = Replay::new(&scenario, None, 0, 5.0).unwrap();
        let pushing = replay.history.pushing_s();
        assert_eq!(Some(pushing), crate::Quantity::ReleaseTime.in_row(&replay.row()));
        assert!((replay.history.end_s() - pushing - 5.0).abs() < 1e-12);
        let page = replay.to_string();
        assert!(page.contains("\n  1 never pushes\n  2 starts at 0.020000000 s\n"), "{page}");
        assert!(!page.contains("1 lets go"), "{page}");
        let starts = replay.history.moments.iter().filter(|m| m.event.contains("starts"));
        let starts: Vec<_> = starts.map(|m| (m.now.time_s(), m.event.as_str())).collect();
        assert_eq!(starts, [(0.02, "spring 2 starts")]);
        let rows = replay.history.moments.iter().filter(|m| m.now.time_s() == 0.02);
        assert_eq!(rows.count(), 1, "on the grid too");
        // Nor does the animation draw what does not push.
        let animation = crate::replay::page::html(&replay);
        assert_eq!(animation.matches("\"from\":null").count(), 1);
        assert_eq!(animation.matches("\"from\":0.02,").count(), 1);
        assert_eq!(animation.matches("\"from\":0.0,").count(), 2);
    }

    /// A run in which the points of a spring meet is shown up to there, whether that is in its first step or a later one: the page,
    /// the table and the animation end at the time of the failure.
    #[test]
    fn a_run_in_which_points_meet_is_followed_to_there() {
        let [mut first, mut later] = [0, 0];
        for i in 0..24 {
            // The spring stops what is slower than 0.774597 m/s.
            let speed = 0.7746 + 1e-4 * 1.6_f64.powi(i);
            let body = |name: &str, place: f64, speed: f64| {
                format!(
                    "[{name}]\nmass_kg = 100.0\ninertia_kg_m2 = [[10.0, 0, 0], [0, 10.0, 0], [0, 0, 10.0]]\n\
                     position_m = [0, 0, {place:?}]\nvelocity_m_per_s = [0, 0, {speed:?}]\n\
                     [{name}.dispersion]\nroot_second_moment_variance_kg_m2 = [0.0, 0, 0]\naxes = \"fixed\"\n"
                )
            };
            let text = format!(
                "name = \"meeting\"\nruns = 1\n{}{}[[springs]]\nstiffness_n_per_m = 1000.0\nstroke_m = 0.1\n\
                 payload_point_m = [0, 0, -0.95]\nstage_point_m = [0, 0, 0.95]\n\
                 [[models]]\nname = \"own\"\nlaw = \"principal\"\naxes = \"whole-sphere\"\n",
                body("payload", 1.0, -speed),
                body("stage", -1.0, 0.0)
            );
            let scenario = Scenario::from_toml(&text).unwrap();
            let replay = Replay::new(&scenario, None, 0, 1.0).unwrap();
            let row = replay.row();
            let status = row.status();
            let time = status.split("its points meet at ").nth(1).unwrap();
            let time: f64 = time.split(' ').next().unwrap().parse().unwrap();
            let end = replay.history.end_s();
            assert!((end / time - 1.0).abs() < 1e-14, "{end} {time}");
            let page = replay.to_string();
            assert!(page.contains("followed to ") && !page.contains("never began"), "{page}");
            let springs = replay.history.moments.last().unwrap().now.loads();
            assert!(springs.iter().any(|spring| spring.length_m() < 1e-4), "{springs:?}");
            assert_eq!(replay.film.frames().last().map(|frame| frame.time_s), Some(end));
            let folder = tempfile::tempdir().unwrap();
            assert_eq!(replay.write(folder.path(), false).unwrap().len(), 3);
            let settings = scenario.settings();
            let mut steps = 0;
            let separation = replay.case.separation.as_ref().unwrap();
            separation.follow(settings, 0.0, |_| steps += 1).unwrap_err();
            if steps == 1 { first += 1 } else { later += 1 }
        }
        assert!(first > 2 && later > 2, "{first} {later}");
    }

    /// Up to a horizon that cuts it short, a run has the same events as without it: starts, releases, and springs that are
    /// pressed again.
    #[test]
    fn a_run_that_fails_has_the_events_of_the_run_that_does_not() {
        let body = |name: &str, place: f64, motion: &str| {
            format!(
                "[{name}]\nmass_kg = 100.0\ninertia_kg_m2 = [[10.0, 0, 0], [0, 10.0, 0], [0, 0, 10.0]]\n\
                 position_m = [0, 0, {place:?}]\n{motion}\
                 [{name}.dispersion]\nroot_second_moment_variance_kg_m2 = [0.0, 0, 0]\naxes = \"fixed\"\n"
            )
        };
        let spring = |y: f64, from: f64, to: f64, start: f64| {
            format!(
                "[[springs]]\nstiffness_n_per_m = 0.1\nstroke_m = 0.05\nstart_s = {start:?}\n\
                 payload_point_m = [0, {y:?}, {from:?}]\nstage_point_m = [0, {y:?}, {to:?}]\n"
            )
        };
        let moving =
            "velocity_m_per_s = [0, 0, -0.005]\nangular_velocity_rad_per_s = [2.0, 0, 0]\n";
        let events = |horizon: f64| {
            let text = format!(
                "name = \"cut\"\nruns = 1\n{}{}{}{}[integration]\nhorizon_s = {horizon:?}\n\
                 [[models]]\nname = \"own\"\nlaw = \"principal\"\naxes = \"whole-sphere\"\n",
                body("payload", 1.0, moving),
                body("stage", -1.0, ""),
                spring(0.5, -0.95, 0.95, 0.0),
                spring(0.0, 0.0, 1.9, 5.5),
            );
            let replay = Replay::new(&Scenario::from_toml(&text).unwrap(), None, 0, 0.0).unwrap();
            let moments = replay.history.moments.iter().filter(|moment| !moment.event.is_empty());
            let all = moments.map(|moment| (moment.now.time_s(), moment.event.clone()));
            (replay.row().failure().is_some(), all.collect::<Vec<_>>())
        };
        let (failed, whole) = events(60.0);
        assert!(
            !failed && whole.iter().any(|(_, event)| event == "spring 1 pressed again"),
            "{whole:?}"
        );
        for horizon in (1..32).map(|i| 0.5 * f64::from(i) + 0.01) {
            let (failed, mut cut) = events(horizon);
            let (end, last) = cut.pop().unwrap();
            assert!(
                failed && last == "end" && (end - horizon).abs() < 1e-12,
                "{horizon}: {end} {last}"
            );
            let expected: Vec<_> = whole.iter().filter(|(time, _)| *time < horizon).collect();
            assert_eq!(cut.len(), expected.len(), "{horizon}: {cut:?} {expected:?}");
            for ((time, event), (later, same)) in cut.iter().zip(expected) {
                assert!((time - later).abs() < 1e-9 && event == same, "{horizon}: {event}");
            }
        }
    }

    /// However long the coast, there are as many rows before the last release, and rows enough after it to follow the bodies
    /// as they turn, or as many as there may be.
    #[test]
    fn a_long_coast_takes_no_rows_from_the_springs() {
        let text = Scenario::peck_2003().unwrap().to_toml();
        for (spin, coasts) in [(0.0, &[0.0, 3600.0][..]), (10.0_f64, &[20.0, 1000.0])] {
            let still = "angular_velocity_rad_per_s = [0.0, 0.0, 0.0]";
            let turning = format!("angular_velocity_rad_per_s = [{spin:?}, 0.5, 0.0]");
            let scenario = Scenario::from_toml(&text.replace(still, &turning)).unwrap();
            for coast in coasts {
                let replay = Replay::new(&scenario, None, 0, *coast).unwrap();
                let history = &replay.history;
                let release = history.pushing_s();
                let times: Vec<f64> = history.moments.iter().map(|m| m.now.time_s()).collect();
                assert!(times.windows(2).all(|pair| pair[0] < pair[1]));
                let pushing = times.iter().filter(|time| **time <= release).count();
                assert!((100..300).contains(&pushing), "{coast}: {pushing}");
                let after: Vec<f64> = times.into_iter().filter(|time| *time >= release).collect();
                let longest = after.windows(2).map(|p| p[1] - p[0]).fold(0.0, f64::max);
                assert!(after.len() < 60_000, "{}", after.len());
                assert!(after.len() > 16_000 || longest <= release / 100.0, "{longest}");
                // Where rows could keep step with a body that turns, figures have moments aside of them.
                let is_coarse = longest * spin > super::super::grid::TURN;
                assert_eq!(history.scattered.is_empty(), !is_coarse, "{longest}");
                let gaps: Vec<f64> = history
                    .scattered
                    .windows(2)
                    .map(|p| p[1].now.time_s() - p[0].now.time_s())
                    .collect();
                assert!(gaps.iter().all(|gap| *gap > 0.0 && *gap < 2.0 * longest));
            }
        }
    }
}
