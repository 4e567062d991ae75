//! What lengths of springs come to within a step, as polynomials in time.

use std::borrow::Borrow;

use crate::{
    RunError, Separation,
    integrator::Integrator,
    layout::ORDER,
    polynomial::first_zero,
    separation::TOUCHING,
    state,
    track::{Fate, Track},
};

/// A spring that is shorter than its free length by more than this share of its stroke pushes no
/// more but is reported.
const RECOMPRESSED: f64 = 1e-9;

impl Integrator {
    /// The square of a spring's length less that of its free length, times a sign, less an offset,
    /// as a polynomial on [0, 1] for [0, h].
    pub(crate) fn gap(
        &self,
        lane: usize,
        spring: usize,
        h: f64,
        sign: f64,
        offset: f64,
    ) -> [f64; ORDER] {
        let order = self.expansion.order[lane];
        let series = &self.expansion.springs[spring];
        let free = series.free_length.0[lane];
        let mut power = sign;
        let mut gap = [0.0; ORDER];
        for (term, of) in gap.iter_mut().zip(&series.terms[..order]) {
            *term = of.square.0[lane] * power;
            power *= h;
        }
        gap[0] -= sign * free * free + offset;
        gap
    }

    /// The coefficients that there are.
    pub(crate) fn known<'a>(&self, lane: usize, polynomial: &'a [f64; ORDER]) -> &'a [f64] {
        &polynomial[..self.expansion.order[lane]]
    }

    /// That the points of a spring do not come together within a step. Where they fly straight at each
    /// other the equations of motion do not notice.
    pub(crate) fn check_apart<S: Borrow<Separation>>(
        &self,
        lane: usize,
        track: &Track<S>,
        spring: usize,
        taken: f64,
    ) -> Result<(), RunError> {
        let run = track.separation.borrow();
        let touching = (TOUCHING * run.springs()[spring].stroke_m()).powi(2);
        let series = &self.expansion.springs[spring];
        // The terms that bring them nearer do not suffice, most often.
        if series.lower.0[lane] > touching {
            return Ok(());
        }
        let free = run.free_lengths()[spring];
        let mut nearness = self.gap(lane, spring, taken, -1.0, 0.0);
        nearness[0] += touching - free * free;
        match first_zero(self.known(lane, &nearness)) {
            Some(x) => Err(RunError::PadsMeet {
                spring: spring + 1,
                time: track.time + x * taken,
                speed: -state::gap(run, &self.at(lane, 0.999 * x * taken), spring).rate,
            }),
            None => Ok(()),
        }
    }

    /// Notes released springs that a step makes shorter than their free length.
    pub(crate) fn note_recompression<S: Borrow<Separation>>(
        &self,
        lane: usize,
        track: &mut Track<S>,
        taken: f64,
    ) {
        if !(taken > 0.0) {
            return;
        }
        let run = track.separation.borrow();
        for (i, fate) in track.springs.iter_mut().enumerate() {
            if let Fate::Released { recompressed: recompressed @ None, .. } = fate {
                let slack =
                    2.0 * run.free_lengths()[i] * RECOMPRESSED * run.springs()[i].stroke_m();
                let series = &self.expansion.springs[i];
                let free = run.free_lengths()[i];
                if series.lower.0[lane] > free * free - slack {
                    continue;
                }
                let gap = self.gap(lane, i, taken, -1.0, slack);
                *recompressed = first_zero(self.known(lane, &gap)).map(|x| track.time + x * taken);
            }
        }
    }
}
