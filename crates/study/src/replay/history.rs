//! The motion of a run, sampled, and as a table.

use gyradius_report::round_below;
use gyradius_separation::{AnyLoad, LoadId, LoadState, MovingBody, Outcome, Snapshot, Step};
use nalgebra::{Unit, Vector3};
use std::{borrow::Cow, iter};

use crate::csv;

/// Rows on the even grid at most, and numbers in all of them.
const MOST: f64 = 20_000.0;
const NUMBERS: f64 = 1e6;
/// Rows to the last release, about.
const PUSHING: f64 = 100.0;

/// A moment of a run.
#[derive(Clone, Debug)]
pub(crate) struct Moment {
    pub(crate) now: Snapshot,
    /// What happens then, if anything does.
    pub(crate) event: String,
}

/// The motion on an even grid in time and at every event.
#[derive(Clone, Debug)]
pub(crate) struct History {
    pub(crate) moments: Vec<Moment>,
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
        let recompressed: Vec<_> = outcome.into_iter().flat_map(Outcome::recompressed).collect();
        let end = steps.last().map_or(0.0, Step::end_s);
        let ids: Vec<LoadId> = loads.iter().map(|(id, _)| *id).collect();
        let mut releases = Vec::new();
        for step in steps {
            releases.extend(step.released().iter().map(|place| (ids[*place], step.end_s())));
        }
        let last = releases.last().map_or(end, |(_, time)| *time);
        let most = MOST.min(NUMBERS / columns(&ids).len() as f64);
        let interval = round_below(f64::max(last / PUSHING, end / most));
        let mut moments: Vec<Moment> = Vec::new();
        let mut next = 0_u32;
        for step in steps {
            let mut due: Vec<(f64, String)> = Vec::new();
            // A grid of multiples, not of sums.
            while f64::from(next) * interval < step.end_s() {
                due.push((f64::from(next) * interval, String::new()));
                next += 1;
            }
            for (place, (id, load)) in loads.iter().enumerate() {
                let start = load.start_s().unwrap_or(0.0);
                let starts = start > 0.0 && (step.start_s()..step.end_s()).contains(&start);
                // One that has come to its free length by then does not.
                if starts && step.at(start).loads()[place].is_pushing() {
                    due.push((start, format!("{id} starts")));
                }
            }
            for (place, time) in &recompressed {
                if (step.start_s()..step.end_s()).contains(time) {
                    due.push((*time, format!("{} pressed again", ids[*place])));
                }
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
        if let Some(first) = moments.first_mut() {
            first.event.insert_str(0, "clamp opens");
        }
        Self {
            moments,
            releases,
            loads: ids,
            free: outcome.map(Outcome::release_time),
            rounding: outcome.map_or(0.0, Outcome::momentum_rounding),
        }
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
}
