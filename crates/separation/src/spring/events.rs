//! What lengths of springs come to within a step, as polynomials in time.

use super::series::SpringSeries;
use crate::{layout::ORDER, load::Events, polynomial::first_zero, spring::TOUCHING};

/// A spring that is shorter than its release length by more than this share of its stroke pushes no
/// more but is reported.
const RECOMPRESSED: f64 = 1e-9;
/// A spring whose squared length stays below this share of that of its release length does not come to it,
/// whatever the rounding.
const NEAR: f64 = 1.0 - 1e-9;

impl<const W: usize> Events for SpringSeries<W> {
    fn act(&mut self, lane: usize, acts: bool) {
        self.stiffness.0[lane] = if acts { self.built.0[lane] } else { 0.0 };
    }

    fn may_end(&self, lane: usize) -> bool {
        let free = self.release_length.0[lane];
        !(self.upper.0[lane] < free * free)
    }

    fn may_all_but_end(&self, lane: usize) -> bool {
        self.upper.0[lane] >= NEAR * self.release_length.0[lane].powi(2)
    }

    fn end(&self, lane: usize, order: usize, step: f64) -> Option<f64> {
        self.crossing(lane, order, step, 1.0, 0.0)
    }

    fn loses_direction(&self, lane: usize, order: usize, step: f64) -> Option<f64> {
        let touching = (TOUCHING * self.stroke.0[lane]).powi(2);
        // The terms that bring the points nearer do not suffice, most often.
        if self.lower.0[lane] > touching {
            return None;
        }
        let free = self.release_length.0[lane];
        let mut nearness = self.gap(lane, order, step, -1.0, 0.0);
        nearness[0] += touching - free * free;
        first_zero(&nearness[..order])
    }

    fn comes_back(&self, lane: usize, order: usize, step: f64) -> Option<f64> {
        let free = self.release_length.0[lane];
        let slack = 2.0 * free * RECOMPRESSED * self.stroke.0[lane];
        if self.lower.0[lane] > free * free - slack {
            return None;
        }
        self.crossing(lane, order, step, -1.0, slack)
    }
}

impl<const W: usize> SpringSeries<W> {
    /// The square of a spring's length less that of its release length, times a sign, less an offset,
    /// as a polynomial on [0, 1] for [0, step].
    fn gap(&self, lane: usize, order: usize, step: f64, sign: f64, offset: f64) -> [f64; ORDER] {
        let free = self.release_length.0[lane];
        let mut power = sign;
        let mut gap = [0.0; ORDER];
        for (term, of) in gap.iter_mut().zip(&self.terms[..order]) {
            *term = of.square.0[lane] * power;
            power *= step;
        }
        gap[0] -= sign * free * free + offset;
        gap
    }

    /// Where that first reaches zero.
    fn crossing(
        &self,
        lane: usize,
        order: usize,
        step: f64,
        sign: f64,
        offset: f64,
    ) -> Option<f64> {
        first_zero(&self.gap(lane, order, step, sign, offset)[..order])
    }
}
