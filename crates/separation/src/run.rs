use crate::{
    Outcome, Separation,
    dop853::{Step, next_factor, step},
    dynamics::{Dynamics, Gap, N, State, bodies, initial_state, normalize, time_scale, tolerances},
};

/// Steps after which a separation is given up: a hundred thousand times what one takes.
const MAX_STEPS: u32 = 2_000_000;

/// Corrections to a landing below this share of a step are made along the tangent: what that
/// neglects is the square.
const LINEAR: f64 = 1e-8;

/// Why settings are refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SettingsError {
    /// The tolerance is out of range.
    #[error("relative tolerance = {value:e}: it must lie in [1e-14, 1e-3]")]
    Tolerance {
        /// The tolerance.
        value: f64,
    },
    /// The horizon is not positive and finite.
    #[error("horizon = {value} s: it must be positive and finite")]
    Horizon {
        /// The horizon, s.
        value: f64,
    },
}

/// How to integrate.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "Fields", into = "Fields")
)]
pub struct Settings {
    relative_tolerance: f64,
    horizon: f64,
}

impl Settings {
    /// Tolerance of one step, relative to the motion that the springs can bring about, and the time
    /// in s by which the last spring must have let go.
    ///
    /// # Errors
    /// The tolerance is outside [1e-14, 1e-3], or the horizon not positive and finite.
    pub fn new(relative_tolerance: f64, horizon_s: f64) -> Result<Self, SettingsError> {
        if !(1e-14..=1e-3).contains(&relative_tolerance) {
            return Err(SettingsError::Tolerance { value: relative_tolerance });
        }
        if !(horizon_s > 0.0 && horizon_s.is_finite()) {
            return Err(SettingsError::Horizon { value: horizon_s });
        }
        Ok(Self { relative_tolerance, horizon: horizon_s })
    }

    /// Tolerance of one step.
    #[must_use]
    pub fn relative_tolerance(&self) -> f64 {
        self.relative_tolerance
    }

    /// Latest release of the last spring, s.
    #[must_use]
    pub fn horizon_s(&self) -> f64 {
        self.horizon
    }
}

impl Default for Settings {
    /// Tolerance 1e-13, with which halving it moves no outcome by 1e-9 of itself; horizon 60 s.
    fn default() -> Self {
        Self { relative_tolerance: 1e-13, horizon: 60.0 }
    }
}

/// The serialized form.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Fields {
    relative_tolerance: f64,
    horizon_s: f64,
}

#[cfg(feature = "serde")]
impl TryFrom<Fields> for Settings {
    type Error = SettingsError;

    fn try_from(f: Fields) -> Result<Self, SettingsError> {
        Self::new(f.relative_tolerance, f.horizon_s)
    }
}

#[cfg(feature = "serde")]
impl From<Settings> for Fields {
    fn from(settings: Settings) -> Self {
        Self { relative_tolerance: settings.relative_tolerance, horizon_s: settings.horizon }
    }
}

/// Why a separation could not be followed to its end.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// Springs are still in contact at the horizon.
    #[error("springs {springs:?} had not let go after {horizon} s")]
    NotReleased {
        /// The springs, from 1.
        springs: Vec<usize>,
        /// The horizon, s.
        horizon: f64,
    },
    /// Steps have become too small or too many, or the state is no longer finite.
    #[error("integration failed at {time} s: the motion there is too violent to follow")]
    TooViolent {
        /// When, s.
        time: f64,
    },
}

pub(crate) fn run(separation: &Separation, settings: &Settings) -> Result<Outcome, RunError> {
    let mut integration = Integration {
        dynamics: Dynamics::new(separation),
        scale: tolerances(separation, settings.relative_tolerance),
        evaluations: 0,
        steps: 0,
    };
    let mut release_times = vec![0.0; separation.springs().len()];
    let mut state = initial_state(separation);
    let mut slope = integration.derivative(&state);
    let mut time = 0.0;
    let start = 0.1 * time_scale(separation);
    let mut h = start;
    while !integration.dynamics.all_released() {
        if time >= settings.horizon {
            return Err(RunError::NotReleased {
                springs: integration.dynamics.active_numbers(),
                horizon: settings.horizon,
            });
        }
        // Relative to the motion, not to the time since the start.
        if !(h > 1e-13 * start) || integration.steps > MAX_STEPS {
            return Err(RunError::TooViolent { time });
        }
        let trial = integration.step(&state, &slope, h);
        if !(trial.error <= 1.0) {
            h *= if trial.error.is_finite() { next_factor(trial.error) } else { 0.25 };
            continue;
        }
        let mut next = trial.state;
        let mut next_slope = integration.derivative(&next);
        let mut taken = h;
        match integration.crossing((&state, &slope), (&next, &next_slope), h) {
            Crossing::None => h *= next_factor(trial.error),
            Crossing::Hidden => {
                h *= 0.5;
                continue;
            }
            Crossing::Near(guess) => {
                (taken, next, next_slope) = integration.land(&state, &slope, guess, h);
                integration.dynamics.release_longest(&next, &next_slope, |index| {
                    release_times[index] = time + taken;
                });
                // A force that ends with a kink leaves the step size be.
                next_slope = integration.derivative(&next);
            }
        }
        time += taken;
        state = next;
        slope = next_slope;
        normalize(&mut state);
    }
    let (payload, stage) = bodies(separation, &state, time);
    let Integration { steps, evaluations, .. } = integration;
    Ok(Outcome { release_times, payload, stage, steps, evaluations })
}

struct Integration {
    dynamics: Dynamics,
    scale: State,
    evaluations: u32,
    steps: u32,
}

/// What a step does to the springs.
enum Crossing {
    None,
    /// A spring reaches its free length about so far into the step.
    Near(f64),
    /// A spring may have reached its free length and come back within the step.
    Hidden,
}

impl Integration {
    fn derivative(&mut self, state: &State) -> State {
        self.evaluations += 1;
        self.dynamics.derivative(state)
    }

    fn step(&mut self, state: &State, slope: &State, h: f64) -> Step<N> {
        self.steps += 1;
        self.evaluations += 11;
        let dynamics = &self.dynamics;
        step(&mut |y| dynamics.derivative(y), state, slope, h, &self.scale)
    }

    fn crossing(&self, from: (&State, &State), to: (&State, &State), h: f64) -> Crossing {
        let mut earliest = f64::INFINITY;
        let mut hidden = false;
        let before = self.dynamics.gaps(from.0, from.1);
        for (a, b) in before.zip(self.dynamics.gaps(to.0, to.1)) {
            if b.value >= 0.0 {
                earliest = earliest.min(Quintic::new(a, b, h).root());
            } else if a.rate > 0.0 && b.rate < 0.0 {
                hidden |= Quintic::new(a, b, h).rises_above_zero();
            }
        }
        if hidden {
            Crossing::Hidden
        } else if earliest < f64::INFINITY {
            Crossing::Near(earliest * h)
        } else {
            Crossing::None
        }
    }

    /// Steps to where the first spring reaches its free length: each trial is a full step from
    /// `state`, so that the release is as accurate as the integration and not as an interpolant.
    fn land(&mut self, state: &State, slope: &State, guess: f64, h: f64) -> (f64, State, State) {
        let (mut low, mut high) = (0.0, h);
        let mut x = guess;
        loop {
            let next = self.step(state, slope, x).state;
            let next_slope = self.derivative(&next);
            // The first crossing of any spring is the first zero of the largest gap.
            let gaps = self.dynamics.gaps(&next, &next_slope);
            let lead = gaps.reduce(|a, b| if b.value > a.value { b } else { a });
            let Some(gap) = lead else {
                return (x, next, next_slope);
            };
            if gap.value > 0.0 {
                high = x;
            } else {
                low = x;
            }
            let correction = -gap.value / gap.rate;
            let newton = x + correction;
            if gap.rate > 0.0 && correction.abs() <= LINEAR * h {
                // What is left is so little that the tangent carries it, to a rounding.
                let shifted = std::array::from_fn(|i| next[i] + correction * next_slope[i]);
                let slope = self.derivative(&shifted);
                return (newton, shifted, slope);
            }
            let better = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if !(low < better && better < high) {
                return (x, next, next_slope);
            }
            x = better;
        }
    }
}

/// The quintic through value, slope and curvature of a gap at both ends of a step, on [0, 1].
struct Quintic([f64; 6]);

impl Quintic {
    fn new(a: Gap, b: Gap, h: f64) -> Self {
        let (a1, b1) = (a.rate * h, b.rate * h);
        let (a2, b2) = (0.5 * a.acceleration * h * h, 0.5 * b.acceleration * h * h);
        let d0 = b.value - a.value - a1 - a2;
        let d1 = b1 - a1 - 2.0 * a2;
        let d2 = b2 - a2;
        Self([
            a.value,
            a1,
            a2,
            10.0 * d0 - 4.0 * d1 + d2,
            -15.0 * d0 + 7.0 * d1 - 2.0 * d2,
            6.0 * d0 - 3.0 * d1 + d2,
        ])
    }

    fn at(&self, x: f64) -> f64 {
        self.0.iter().rev().fold(0.0, |sum, c| sum * x + c)
    }

    /// A zero in (0, 1), negative before it.
    fn root(&self) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if self.at(middle) < 0.0 { low = middle } else { high = middle }
        }
        high
    }

    fn rises_above_zero(&self) -> bool {
        (1..32).any(|i| self.at(f64::from(i) / 32.0) >= 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_checked() {
        for bad in [0.0, -1.0, 1e-15, 0.1, f64::NAN] {
            assert!(matches!(Settings::new(bad, 1.0), Err(SettingsError::Tolerance { .. })));
        }
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(Settings::new(1e-9, bad), Err(SettingsError::Horizon { .. })));
        }
        assert_eq!(Settings::new(1e-13, 60.0).unwrap(), Settings::default());
    }

    #[test]
    fn quintics_interpolate_quintics() {
        let p = |x: f64| -1.0 + x + 0.5 * x.powi(3) + 2.0 * x.powi(5);
        let gap = |x: f64| Gap {
            value: p(x),
            rate: 1.0 + 1.5 * x * x + 10.0 * x.powi(4),
            acceleration: 3.0 * x + 40.0 * x.powi(3),
        };
        let q = Quintic::new(gap(0.2), gap(1.2), 1.0);
        for i in 0..=10 {
            let x = f64::from(i) / 10.0;
            assert!((q.at(x) - p(0.2 + x)).abs() < 1e-13);
        }
        assert!(p(0.2 + q.root()).abs() < 1e-11);
    }
}
