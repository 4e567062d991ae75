//! The scatter that gives the entries the deviations that are asked for, as nearly as any does that is found.

use super::{
    StatementError,
    frame::Frame,
    levenberg_marquardt::{Effort, least_squares},
    task::{Asked, Point, Solution, Task},
    unknowns::{ROOTS, ROOTS_BESIDE, SHARE, TURN_ANGLES, TURNS, Trial, UNKNOWNS, Unknowns, Values},
};

/// Relative errors of deviations up to which what is asked is had.
const MET: f64 = 4e-3;
/// A share of the most that the inertia can follow, which may be the most.
const NEARLY: f64 = 0.95;
/// The inertia follows the mass wholly up to this relative error of a deviation, and less only for a largest error that is
/// this share of the one that there is else.
const SMALL_MISS: f64 = 0.02;
const WORTH_LESS: f64 = 0.5;

/// Times that the search starts anew about the best, while that is better.
const AGAIN: usize = 4;
/// Another start is worth its law if it takes this share off the cost.
const WORTH: f64 = 0.01;
/// Correlations from which the search starts anew.
const START: f64 = 0.7;
/// Their signs.
const SIGNS: [[f64; 3]; 4] =
    [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
/// Starts all over the unknowns, and how far apart they are, in units of each unknown.
const ANYWHERE: u32 = 100;
const WIDE: f64 = 1.5;
/// The same without correlations, where deviations of very different size may be what is asked.
const INDEPENDENT: u32 = 16;
const VERY_WIDE: f64 = 3.0;
/// Where the nearest of these starts costs less after some steps, what is asked may well be had.
const WITHIN_REACH: f64 = 0.1;
/// Starts all about the best, and how far they are from it.
const ABOUT: u32 = 24;
const NEAR: [f64; 2] = [1.0, 0.3];
/// Of these, the best are followed after some steps.
const FOLLOWED: usize = 8;

impl Task {
    /// The best scatter that is found, which does not depend on how the axes of the body are named and pointed.
    pub(super) fn solve(&self) -> Result<Solution, StatementError> {
        let frame = Frame::of(self);
        Ok(frame.back(&frame.task(self)?.best()))
    }

    /// The inertia follows the mass wholly, unless what is stated comes out far nearer if it follows less.
    fn best(&self) -> Solution {
        let mut best = self.search(false);
        let most = self.mass.map_or(0.0, |(_, most)| most);
        let miss = self.worst(&best);
        if most > 0.0 && self.moments.is_stated() && miss > SMALL_MISS {
            let mut less = self.search(true);
            // Nearly wholly is wholly, where nothing is lost by it.
            let wholly = Point { follows: most, ..less };
            let loses_nothing = || self.worst(&wholly) < self.worst(&less).max(MET);
            if less.follows > NEARLY * most && loses_nothing() {
                less = wholly;
            }
            if self.worst(&less) < WORTH_LESS * miss {
                best = less;
            }
        }
        let mut with_centre = [None; 6];
        for it in self.compare(&best) {
            let asked = if it.entry < 3 { self.moments } else { self.products };
            if !asked.is_stated() {
                with_centre[it.entry] = Some(it.wanted.sqrt());
            }
        }
        Solution { scatter: best.scatter, follows: best.follows, with_centre }
    }

    /// Searches with independent roots and rotations, and with correlated ones where these do not do.
    fn search(&self, shares: bool) -> Point {
        let mut unknowns = Unknowns::new(self, shares);
        let mut best = unknowns.downhill(unknowns.guess);
        unknowns.independently(&mut best);
        if unknowns.misses(&best) {
            unknowns = unknowns.correlated();
            best = unknowns.with_correlations(best);
        }
        // Where the moments cannot be had, the products may be, beside the moments as they are: the errors of the
        // moments, which count for so much more, hide those of the products.
        if self.has_valleys() && self.worst(&best.0.at) > MET {
            let mut moments = [0.0; 3];
            for it in self.compare(&best.0.at).iter().filter(|it| it.entry < 3) {
                moments[it.entry] = it.found.sqrt();
            }
            let held = Self { moments: Asked::Stated(moments), ..*self };
            let beside = unknowns.of(&held);
            best = beside.downhill(best.0.x);
            let around = beside.around(&best.0.x);
            beside.improve(&mut best, &around);
        }
        best.0.at
    }

    /// Whether the moments count for so much more than the products that the way to both is a narrow valley.
    fn has_valleys(&self) -> bool {
        self.moments.is_stated() && self.products.is_stated()
    }
}

/// The search.
impl Unknowns<'_> {
    /// The best trial downhill from here, and its cost.
    fn downhill(&self, x: Values) -> (Trial, f64) {
        self.steps(x, Effort::FULL)
    }

    fn steps(&self, x: Values, effort: Effort) -> (Trial, f64) {
        let start = self.trial(x);
        if self.open.is_empty() {
            return (start, 0.0);
        }
        least_squares(self, start, effort)
    }

    fn misses(&self, best: &(Trial, f64)) -> bool {
        self.task.worst(&best.0.at) > MET
    }

    /// Takes the first start that does, or the best of them, if it is better.
    fn improve(&self, best: &mut (Trial, f64), starts: &[Values]) {
        self.improve_by(Effort::FULL, best, starts);
    }

    fn improve_by(&self, effort: Effort, best: &mut (Trial, f64), starts: &[Values]) {
        for start in starts {
            if !self.misses(best) {
                return;
            }
            let found = self.steps(*start, effort);
            if !self.misses(&found) || found.1 < (1.0 - WORTH) * best.1 {
                *best = found;
            }
        }
    }

    /// The same from where these starts lead if all errors count alike: if what is asked can be had, it is had there.
    fn improve_evenly(&self, best: &mut (Trial, f64), starts: &[Values]) {
        let even = self.evenly();
        for start in starts {
            if !self.misses(best) {
                return;
            }
            let there = even.downhill(*start);
            self.improve(best, &[there.0.x]);
            // What is asked may be had within rounding of its numbers, and not where the moments are had to the last digit.
            if self.misses(best) && !self.misses(&there) {
                *best = there;
            }
        }
    }

    /// The best with independent roots and rotations, from all over them.
    fn independently(&self, best: &mut (Trial, f64)) {
        if self.task.has_valleys() {
            self.improve_evenly(best, &[self.guess]);
        }
        if self.misses(best) {
            let (nearest, _) = self.evenly().nearest(INDEPENDENT, VERY_WIDE);
            self.improve_evenly(best, &nearest);
        }
    }

    /// The best with correlations: from where independent roots and rotations came to and where they began, then
    /// from anywhere.
    fn with_correlations(&self, independent: (Trial, f64)) -> (Trial, f64) {
        let guess = self.guess;
        // None of them still.
        let mut again = self.expressed(&independent.0, 1e-4);
        for turn in TURNS..TURN_ANGLES {
            again[turn] = again[turn].max(0.1 * guess[turn]);
        }
        let mut best = independent;
        best.0.x = self.expressed(&independent.0, 1e-12);
        // Of several laws that do, the one that the moments have alone, if the turns can be beside it.
        if self.task.moments.is_stated() && self.task.products != Asked::Nothing {
            let alone = Task { products: Asked::Nothing, ..*self.task };
            let mut beside = independent.0;
            beside.at.scatter.roots = alone.search(self.open.contains(&SHARE)).scatter.roots;
            let mut start = self.expressed(&beside, 1e-12);
            start[TURNS..TURN_ANGLES].copy_from_slice(&again[TURNS..TURN_ANGLES]);
            self.improve(&mut best, &[start]);
        }
        self.improve(&mut best, &[again, guess]);
        if self.task.has_valleys() {
            self.improve_evenly(&mut best, &[again, guess]);
            if self.misses(&best) {
                let (nearest, cost) = self.evenly().nearest(ANYWHERE, WIDE);
                if cost < WITHIN_REACH {
                    self.improve_evenly(&mut best, &nearest);
                }
            }
        }
        if self.misses(&best) {
            let (nearest, _) = self.nearest(ANYWHERE, WIDE);
            self.improve_by(Effort::FINE, &mut best, &nearest);
        }
        for _ in 0..AGAIN {
            let before = best.1;
            let around = self.around(&best.0.x);
            self.improve_by(Effort::FINE, &mut best, &around);
            for near in NEAR {
                let (nearest, _) = self.nearest_about(best.0.x, ABOUT, near);
                self.improve_by(Effort::FINE, &mut best, &nearest);
            }
            if best.1 == before {
                break;
            }
        }
        self.refine(&mut best);
        best
    }

    /// Follows the valley in which the best lies, while that is worth it.
    fn refine(&self, best: &mut (Trial, f64)) {
        for _ in 0..AGAIN {
            if !self.misses(best) {
                return;
            }
            let found = self.steps(best.0.x, Effort::FINE);
            let is_worth_it = found.1 < (1.0 - WORTH) * best.1;
            if found.1 < best.1 {
                *best = found;
            }
            if !is_worth_it {
                return;
            }
        }
    }

    /// Where some steps lead from points all over the unknowns: the best of them, and the least of their costs.
    fn nearest(&self, count: u32, wide: f64) -> (Vec<Values>, f64) {
        let mut centre = self.guess;
        if self.open.contains(&ROOTS_BESIDE) {
            centre[ROOTS..ROOTS_BESIDE].fill(0.0);
        }
        self.nearest_about(centre, count, wide)
    }

    /// The same from points all about this one.
    fn nearest_about(&self, centre: Values, count: u32, wide: f64) -> (Vec<Values>, f64) {
        let starts = self.all_about(centre, count, wide);
        let mut found: Vec<_> = starts.map(|x| self.steps(x, Effort::SHORT)).collect();
        found.sort_by(|a, b| a.1.total_cmp(&b.1));
        let least = found.first().map_or(f64::INFINITY, |it| it.1);
        (found.into_iter().take(FOLLOWED).map(|it| it.0.x).collect(), least)
    }

    /// Points of the open unknowns all about this one: multiples of √p, p prime, modulo 1 (Richtmyer 1951).
    fn all_about(&self, centre: Values, count: u32, wide: f64) -> impl Iterator<Item = Values> {
        const PRIMES: [u16; UNKNOWNS] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41];
        let independent = !self.open.contains(&ROOTS_BESIDE);
        (1..=count).map(move |n| {
            let mut x = centre;
            for &i in &self.open {
                let part = f64::from(n) * f64::from(PRIMES[i]).sqrt();
                let off = wide * (2.0 * (part - part.floor()) - 1.0);
                match i {
                    TURNS..TURN_ANGLES => x[i] *= libm::exp(off),
                    ROOTS..ROOTS_BESIDE if independent => x[i] *= libm::exp(off),
                    SHARE => (),
                    _ => x[i] += off,
                }
            }
            x
        })
    }

    /// Correlations of every pair of signs on top.
    fn around(&self, x: &Values) -> [Values; 4] {
        let open = |first: &usize| self.open.contains(first);
        SIGNS.map(|signs| {
            let mut start = *x;
            for first in [ROOTS_BESIDE, TURN_ANGLES].into_iter().filter(open) {
                for (i, sign) in (first..).zip(signs) {
                    start[i] += sign * START;
                }
            }
            start
        })
    }
}
