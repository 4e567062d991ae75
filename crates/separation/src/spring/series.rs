//! The series of springs, one of each run at a time.
//!
//! In payload axes the line of a spring is s = ρ + p − R l (Peck 2003, Eq. 29), ρ the offset of the mass centres, R the
//! rotation from stage to payload, p and l the points. The force on the payload is (u − k) s with u = k L₀ (s²)^(−1/2). That
//! power obeys s² u' = −½ (s²)' u, which gives its coefficients one after the other,
//!
//! > s₀² u_n = −(1/n) Σ_(j = 1 … n) (n − j/2) (s²)_j u_(n−j),
//!
//! so that no square root is taken but the first. Sums of two series that hold their own terms twice take each
//! pair of orders j and n − j once.

use std::ops::Range;

use super::SeatedSpring;
use crate::{
    lanes::{Lanes, M3, V3},
    layout::{INVERSE, TERMS},
    load::{Seated, Series},
    products::{cross, load},
    vector::{Register, Simd},
};

/// k/4.
const QUARTERS: [f64; 4 * TERMS] = {
    let mut quarters = [0.0; 4 * TERMS];
    let mut k = 1;
    while k < 4 * TERMS {
        quarters[k] = 0.25 * k as f64;
        k += 1;
    }
    quarters
};

/// Coefficients of one order.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpringTerm<const W: usize> {
    /// From stage point to payload point, s.
    line: V3<W>,
    /// s².
    pub(super) square: Lanes<W>,
    /// k L₀/|s|: less k, the force over the length.
    push: Lanes<W>,
}

/// As many springs as there are lanes, and their series.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct SpringSeries<const W: usize> {
    pub(super) terms: [SpringTerm<W>; TERMS],
    /// Zero where a spring does not push.
    pub(super) stiffness: Lanes<W>,
    /// The stiffness of those that push, and of those that do not.
    pub(super) built: Lanes<W>,
    pub(super) stroke: Lanes<W>,
    pub(super) release_length: Lanes<W>,
    payload_point: V3<W>,
    stage_point: V3<W>,
    /// What s² stays below and above as far as the series is good.
    pub(super) upper: Lanes<W>,
    pub(super) lower: Lanes<W>,
    /// Force over the length, of order 0.
    first_push: Lanes<W>,
    /// 1/s² of order 0, zero for springs that do not push.
    inverse_square: Lanes<W>,
    /// Half of the push of order 0.
    half_push: Lanes<W>,
    /// What there is of the sums of the order under way.
    slope: Lanes<W>,
    force: V3<W>,
    /// That none of them pushes any more.
    lost: bool,
}

#[inline(always)]
fn dot<S: Simd>(a: &[Register<S>; 3], b: &[Register<S>; 3]) -> Register<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl<const W: usize> Series<W> for SpringSeries<W> {
    type Load = SeatedSpring;

    fn new() -> Self {
        let (zero, vector) = (Lanes::ZERO, [Lanes::ZERO; 3]);
        Self {
            terms: [SpringTerm { line: vector, square: zero, push: zero }; TERMS],
            stiffness: zero,
            built: zero,
            stroke: zero,
            release_length: zero,
            payload_point: vector,
            stage_point: vector,
            upper: zero,
            lower: zero,
            first_push: zero,
            inverse_square: zero,
            half_push: zero,
            slope: zero,
            force: vector,
            lost: true,
        }
    }

    fn set(&mut self, lane: usize, seated: &SeatedSpring) {
        let spring = seated.load();
        self.built.0[lane] = spring.stiffness_n_per_m();
        self.stroke.0[lane] = spring.stroke_m();
        self.release_length.0[lane] = seated.release_length_m();
        for axis in 0..3 {
            self.payload_point[axis].0[lane] = spring.payload_point_m()[axis];
            self.stage_point[axis].0[lane] = spring.stage_point_m()[axis];
        }
    }

    /// Of the lines, by Eq. 29, and of s²: what `known` has summed, and twice the ends of Cauchy's sum.
    #[inline(always)]
    fn stretch<S: Simd>(&mut self, simd: S, k: usize, offset: &V3<W>, rotation: &M3<W>) {
        if k == 0 {
            self.lost = self.stiffness.0.iter().all(|s| *s == 0.0);
        }
        let (square, slope, force) = self.known(simd, k);
        self.slope = slope.store();
        self.force = force.map(Register::store);
        let (offset, point) = (load(simd, offset), load(simd, &self.stage_point));
        let mut line: [_; 3] =
            std::array::from_fn(|i| offset[i] - dot(&load(simd, &rotation[i]), &point));
        if k == 0 {
            let point = load(simd, &self.payload_point);
            line = std::array::from_fn(|i| line[i] + point[i]);
            self.terms[0].line = line.map(Register::store);
            self.terms[0].square = dot(&line, &line).store();
        } else {
            self.terms[k].line = line.map(Register::store);
            let ends = dot(&load(simd, &self.terms[0].line), &line);
            self.terms[k].square = (square + (ends + ends)).store();
        }
    }

    #[inline(always)]
    fn push<S: Simd>(&mut self, simd: S, k: usize) -> Option<[V3<W>; 2]> {
        if self.lost {
            return None;
        }
        if k == 0 {
            self.start();
        }
        let first = load(simd, &self.terms[0].line);
        let newest = &mut self.terms[k];
        let before = Register::load(simd, &self.first_push);
        let force = if k == 0 {
            first.map(|x| x * before)
        } else {
            // The recurrence of u: what `known` has summed, and the term j = k, k − k/2 times (s²)_k u_0.
            let half = Register::load(simd, &self.half_push) * Register::splat(simd, k as f64);
            let factor =
                Register::load(simd, &self.inverse_square) * Register::splat(simd, -INVERSE[k]);
            let slope =
                Register::load(simd, &self.slope) + Register::load(simd, &newest.square) * half;
            let push = slope * factor;
            newest.push = push.store();
            let (force, line) = (load(simd, &self.force), load(simd, &newest.line));
            std::array::from_fn(|i| (force[i] + line[i] * before) + first[i] * push)
        };
        let moment = cross(&load(simd, &self.payload_point), &force);
        Some([force.map(Register::store), moment.map(Register::store)])
    }

    #[inline(always)]
    fn ends_within(&self, time: Lanes<W>, order: usize) -> Lanes<W> {
        let mut sum = Lanes::ZERO;
        for term in self.terms[..order].iter().rev() {
            sum = sum * time + term.square;
        }
        let beyond = sum.zip(self.release_length, |s, l| if s >= l * l { 1.0 } else { 0.0 });
        beyond * self.stiffness.map(|k| if k == 0.0 { 0.0 } else { 1.0 })
    }

    /// A power of time grows with time: at any time within the reach, s² is at most its first coefficient
    /// plus the terms that are positive at the end of the reach, and at least that plus the negative ones.
    #[inline(always)]
    fn bound(&mut self, reach: Lanes<W>, order: usize) {
        let (mut power, mut up, mut down) = (reach, Lanes::ZERO, Lanes::ZERO);
        for term in &self.terms[1..order] {
            let term = term.square * power;
            up += term.map(|x| if x > 0.0 { x } else { 0.0 });
            down += term.map(|x| if x < 0.0 { x } else { 0.0 });
            power = power * reach;
        }
        self.upper = self.terms[0].square + up;
        self.lower = self.terms[0].square + down;
    }

    #[inline(always)]
    fn forget(&mut self, lane: usize, orders: Range<usize>) {
        for term in &mut self.terms[orders] {
            term.square.0[lane] = 0.0;
        }
    }
}

impl<const W: usize> SpringSeries<W> {
    /// What goes into the coefficients of order k of s², of the force and of the slope that the push
    /// is found from, and waits for nothing.
    #[inline(always)]
    fn known<S: Simd>(&self, simd: S, k: usize) -> (Register<S>, Register<S>, [Register<S>; 3]) {
        let zero = Register::splat(simd, 0.0);
        let (mut square, mut slope, mut force) = (zero, zero, [zero; 3]);
        if k < 2 {
            return (square, slope, force);
        }
        let terms = &self.terms[1..k];
        let pairs = terms.len() / 2;
        let (low, high) = (&terms[..pairs], &terms[terms.len() - pairs..]);
        if self.lost {
            for i in 0..pairs {
                let (a, b) = (&low[i], &high[pairs - 1 - i]);
                square = square + dot(&load(simd, &a.line), &load(simd, &b.line));
            }
        } else {
            // The weights k − j/2 of order j, and of order k − j.
            let (down, up) = (&QUARTERS[4 * k - 2 * pairs..4 * k], &QUARTERS[2 * k..4 * k]);
            for i in 0..pairs {
                let (a, b) = (&low[i], &high[pairs - 1 - i]);
                let (line, other) = (load(simd, &a.line), load(simd, &b.line));
                square = square + dot(&line, &other);
                let [push, pushed] = load(simd, &[a.push, b.push]);
                force = std::array::from_fn(|x| force[x] + (push * other[x] + pushed * line[x]));
                let weights = [down[down.len() - 2 - 2 * i], up[2 * i + 2]];
                let [heavy, light] = weights.map(|w| Register::splat(simd, w));
                let [s, t] = load(simd, &[a.square, b.square]);
                slope = slope + (s * pushed * heavy + t * push * light);
            }
        }
        square = square + square;
        if terms.len() % 2 == 1 {
            let middle = &terms[pairs];
            let line = load(simd, &middle.line);
            square = square + dot(&line, &line);
            if !self.lost {
                let push = Register::load(simd, &middle.push);
                force = std::array::from_fn(|x| force[x] + push * line[x]);
                let weight = Register::splat(simd, QUARTERS[3 * k]);
                slope = slope + Register::load(simd, &middle.square) * push * weight;
            }
        }
        (square, slope, force)
    }

    /// The pushes of order 0.
    #[inline(always)]
    fn start(&mut self) {
        // A lost spring may come to length zero.
        let of = |x: Lanes<W>| self.stiffness.zip(x, |k, x| if k == 0.0 { 0.0 } else { x });
        let inverse = of(Lanes::splat(1.0) / self.terms[0].square.sqrt());
        self.inverse_square = inverse * inverse;
        let push = self.stiffness * (self.release_length * inverse);
        self.terms[0].push = push;
        self.half_push = push * 0.5;
        self.first_push = self.stiffness * (self.release_length * inverse - Lanes::splat(1.0));
    }
}
