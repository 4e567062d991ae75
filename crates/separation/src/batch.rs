//! Many runs at a time, in vector lanes.

use std::borrow::Borrow;

use crate::{
    Outcome, RunError, Separation, Settings,
    integrator::{Integrate, Integrator},
    track::Track,
    vector::Machine,
};

/// Many separations, several at a time in vector lanes: eight where the machine has AVX-512, else four.
///
/// Each lane has its own time and step; a lane whose run is over takes the next of the queue. An
/// outcome holds the same bits as that of [`Separation::run`], whatever runs beside it. Does not
/// allocate for up to eight springs but when it is made.
///
/// ```
/// # use gyradius_inertia::InertiaMatrix;
/// # use gyradius_separation::{Body, Separation, Spring};
/// # use nalgebra::Vector3;
/// # let inertia = InertiaMatrix::from_entries([5e3, 4e3, 3e3], [0.0; 3])?;
/// # let point = |z| Vector3::new(0.5, 0.0, z);
/// # let spring = Spring::new(1e5, 0.1, point(-0.9), point(0.9))?;
/// # let (payload, stage) = (Body::new(1e4, inertia)?, Body::new(4e3, inertia)?);
/// # let separation =
/// #     Separation::new(payload.at(Vector3::z()), stage.at(-Vector3::z()), &[spring])?;
/// use gyradius_separation::{Batch, Settings};
///
/// let queue: Vec<_> = (0..10).map(|_| separation.clone()).collect();
/// let mut speeds = vec![0.0; queue.len()];
/// Batch::new(Settings::default()).run(&queue, |i, result| {
///     if let Ok(outcome) = result {
///         speeds[i] = outcome.relative_speed();
///     }
/// });
/// let alone = separation.run(&Settings::default())?;
/// assert!(speeds.iter().all(|speed| *speed == alone.relative_speed()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Batch {
    settings: Settings,
    integrator: Box<dyn Integrate>,
}

/// The most lanes that an integrator has.
const MOST: usize = 8;

impl Batch {
    /// For runs with the given settings.
    #[must_use]
    pub fn new(settings: Settings) -> Self {
        // As wide as the machine's registers.
        let integrator: Box<dyn Integrate> = if Machine::new().has_eight() {
            Box::new(Integrator::<MOST>::new(settings))
        } else {
            Box::new(Integrator::<4>::new(settings))
        };
        Self { settings, integrator }
    }

    /// Runs the separations to their last releases. Each result is given with its place in the
    /// queue, in the order in which they end.
    ///
    /// # Errors
    /// Those of [`Separation::run`], run by run: a run that fails does not touch the others.
    pub fn run<S: Borrow<Separation>>(
        &mut self,
        queue: impl IntoIterator<Item = S>,
        mut result: impl FnMut(usize, Result<Outcome, RunError>),
    ) {
        let integrator = &mut *self.integrator;
        let mut queue = queue.into_iter().enumerate();
        let mut slots: [Option<(usize, S, Track)>; MOST] = [const { None }; MOST];
        let lanes = &mut slots[..integrator.width()];
        loop {
            for (lane, slot) in lanes.iter_mut().enumerate() {
                if slot.is_none() {
                    *slot = queue.next().map(|(i, run)| {
                        let track = integrator.load(lane, run.borrow());
                        (i, run, track)
                    });
                }
                if slot.is_none() {
                    integrator.rest(lane);
                }
            }
            if lanes.iter().all(Option::is_none) {
                return;
            }
            integrator.expand();
            for (lane, slot) in lanes.iter_mut().enumerate() {
                let Some((_, run, track)) = slot else { continue };
                let stepped = integrator.step(lane, (*run).borrow(), track);
                let over = stepped.is_err() || track.all_released();
                if over && let Some((i, run, track)) = slot.take() {
                    let state = integrator.state(lane);
                    let outcome = || Outcome::new(run.borrow(), track, &state, &self.settings);
                    result(i, stepped.map(|()| outcome()));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Body, Spring};
    use gyradius_inertia::InertiaMatrix;
    use nalgebra::Vector3;

    /// Bodies and springs of many sizes, some of which fail.
    fn separations() -> Vec<Separation> {
        (0..23)
            .map(|i| {
                let x = f64::from(i);
                let inertia = |a: f64| {
                    let moments = [a, a * (1.0 + 0.01 * x), a * 1.3];
                    InertiaMatrix::from_entries(moments, [0.01 * a, 0.02 * a, -0.03 * a]).unwrap()
                };
                let springs: Vec<_> = (0..=i % 7)
                    .map(|j| {
                        let (s, c) = libm::sincos(f64::from(j) * 2.1 + x);
                        let stiffness = if i == 9 { 1e-3 } else { 1e3 * (1.0 + f64::from(j)) };
                        let at = |z| Vector3::new(s, c, z);
                        let spring = Spring::new(stiffness, 0.1 + 0.01 * x, at(-0.8), at(0.8));
                        let spring = spring.unwrap().with_friction(f64::from(i % 3)).unwrap();
                        match (i + j) % 5 {
                            1 => spring.starting_at(0.02 * f64::from(j)).unwrap(),
                            2 if j > 0 => spring.never_pushing(),
                            _ => spring,
                        }
                    })
                    .collect();
                Separation::new(
                    Body::new(100.0 + x, inertia(40.0)).unwrap().at(Vector3::z()),
                    Body::new(50.0 + 3.0 * x, inertia(25.0)).unwrap().at(-Vector3::z()),
                    &springs,
                )
                .unwrap()
            })
            .collect()
    }

    /// Debug output of floats tells all their bits, and the sign of zero.
    #[test]
    fn outcomes_are_those_of_runs_alone_to_the_bit() {
        let settings = Settings::new(1e-13, 10.0).unwrap();
        let all = separations();
        let alone: Vec<_> = all.iter().map(|s| format!("{:?}", s.run(&settings))).collect();
        assert_eq!(alone.iter().filter(|s| s.starts_with("Err")).count(), 1);
        let mut batch = Batch::new(settings);
        for skip in 0..5 {
            let mut count = 0;
            // Other companions, and lanes that have been used.
            batch.run(&all[skip..], |i, result| {
                count += 1;
                assert_eq!(format!("{result:?}"), alone[skip + i], "run {}", skip + i);
            });
            assert_eq!(count, all.len() - skip);
            batch.run(all.iter().rev(), |i, result| {
                assert_eq!(format!("{result:?}"), alone[all.len() - 1 - i]);
            });
        }
        batch.run(&all[..0], |_, _| panic!("nothing to run"));
    }

    /// Eight lanes on a machine without registers that long, and one, in arrays.
    #[test]
    fn outcomes_are_the_same_to_the_bit_in_any_number_of_lanes() {
        fn all<const W: usize>(machine: Machine) -> Vec<String> {
            let (settings, all) = (Settings::new(1e-13, 10.0).unwrap(), separations());
            let integrator = Box::new(Integrator::<W>::on(machine, settings));
            let mut outcomes = vec![String::new(); all.len()];
            let mut batch = Batch { settings, integrator };
            batch.run(&all, |i, result| outcomes[i] = format!("{result:?}"));
            outcomes
        }
        let four = all::<4>(Machine::new());
        assert_eq!(four, all::<4>(Machine::BASELINE));
        for machine in [Machine::new(), Machine::BASELINE] {
            assert_eq!(four, all::<1>(machine));
            assert_eq!(four, all::<8>(machine));
        }
    }
}
