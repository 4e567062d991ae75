//! The motion as a power series in time about a state, its coefficients by recurrence (Moore 1966;
//! Jorba & Zou 2005, doi:10.1080/10586458.2005.10128904): Cauchy's rule gives the coefficients of a
//! product, and an equation of motion the next coefficient of what it is the derivative of.
//!
//! Everything is in payload axes. Springs act along the line between their points, so that the
//! torques on the two bodies about a common point cancel: the torque on the stage about its mass
//! centre is −(ρ × F + T), ρ from the stage's mass centre to the payload's, F and T force and torque
//! on the payload.

use smallvec::SmallVec;
use std::f64::consts::LN_2;

use crate::{
    lanes::{Lanes, M3, Packing, V3, WIDTH, add, cross, dot, scale, sub, times},
    products::{Factors, Products, Row, Term},
    vector::{Four, Simd},
};

/// Degree of the series of a state.
pub(crate) const ORDER: usize = 14;
/// Degrees at which an expansion may stop: sooner than at the last where a release ends the step.
pub(crate) const STOPS: [usize; 3] = [5, 9, ORDER];
/// Coefficients of a series.
pub(crate) const TERMS: usize = ORDER + 1;

/// A state: from the stage's mass centre to the payload's and the relative velocity (payload axes),
/// the quaternions from stage to payload and from payload to inertial components, the angular
/// velocities in body axes. The mass centre of the whole moves uniformly and is not integrated.
pub(crate) const STATE: usize = 20;
pub(crate) const OFFSET: usize = 0;
pub(crate) const VELOCITY: usize = 3;
pub(crate) const RELATIVE: usize = 6;
pub(crate) const ATTITUDE: usize = 10;
pub(crate) const PAYLOAD_RATE: usize = 14;
pub(crate) const STAGE_RATE: usize = 17;

/// Springs that a run holds without allocating.
pub(crate) const INLINE_SPRINGS: usize = 8;

/// 1/k.
const INVERSE: [f64; TERMS] = {
    let mut inverse = [0.0; TERMS];
    let mut k = 1;
    while k < TERMS {
        inverse[k] = 1.0 / k as f64;
        k += 1;
    }
    inverse
};

/// k/2.
const HALVES: [f64; 2 * TERMS] = {
    let mut halves = [0.0; 2 * TERMS];
    let mut k = 1;
    while k < 2 * TERMS {
        halves[k] = 0.5 * k as f64;
        k += 1;
    }
    halves
};

/// What a body resists torques with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rotor<const L: usize> {
    pub(crate) inertia: M3<L>,
    pub(crate) inverse: M3<L>,
}

/// Parts of sums that make the coefficients of one order.
#[derive(Clone, Copy, Debug)]
struct Known {
    square: Lanes<WIDTH>,
    slope: Lanes<WIDTH>,
    force: V3<WIDTH>,
}

/// As many springs as there are lanes, and their series.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct SpringSeries {
    /// Zero where a spring no longer pushes.
    pub(crate) stiffness: Lanes<WIDTH>,
    pub(crate) free_length: Lanes<WIDTH>,
    pub(crate) payload_point: V3<WIDTH>,
    pub(crate) stage_point: V3<WIDTH>,
    /// From stage point to payload point, s.
    line: [V3<WIDTH>; TERMS],
    /// s².
    pub(crate) square: [Lanes<WIDTH>; TERMS],
    /// 1/|s|.
    inverse: [Lanes<WIDTH>; TERMS],
    /// Force over length, k(L₀/|s| − 1).
    push: [Lanes<WIDTH>; TERMS],
    known: Known,
    /// That none of them pushes any more.
    lost: bool,
    /// What s² stays below and above as far as the series is good.
    pub(crate) upper: Lanes<WIDTH>,
    pub(crate) lower: Lanes<WIDTH>,
}

/// The series of a state and all that goes into it.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct Expansion<const L: usize>
where
    Lanes<L>: Packing<L>,
{
    pub(crate) state: [Row<L>; TERMS],
    products: [<Lanes<L> as Packing<L>>::Products; TERMS],
    pub(crate) springs: SmallVec<[SpringSeries; INLINE_SPRINGS / WIDTH]>,
    pub(crate) payload: Rotor<L>,
    pub(crate) stage: Rotor<L>,
    /// 1 over what each entry of the state is measured by.
    pub(crate) inverse_scale: [Lanes<L>; STATE],
    /// The radius of convergence, s; zero before the first expansion.
    pub(crate) radius: Lanes<L>,
    /// The share of the radius that a step may take, for each degree to stop at.
    pub(crate) stretch: [f64; STOPS.len()],
    /// How far the series are good for, s.
    pub(crate) reach: Lanes<L>,
    /// The degrees that they have come to; coefficients beyond are left over.
    pub(crate) order: [usize; L],
    /// The state there.
    pub(crate) end: Row<L>,
    /// 1/m of the payload plus 1/m of the stage.
    pub(crate) inverse_mass: Lanes<L>,
}

/// The part of a product's coefficient of order k that comes of those between the first and the
/// newest: it waits for nothing. A macro, for closures are not sure to be inlined.
macro_rules! known {
    ($simd:expr, $term:path, $y:expr, $products:expr, $k:expr) => {{
        let mut sum = Term::zero($simd);
        if $k > 1 {
            let (y, products) = (&$y[1..$k], &$products[1..$k]);
            let other = y.iter().zip(products).rev();
            for ((ya, a), (yb, b)) in y.iter().zip(products).zip(other) {
                sum = Term::plus(sum, $term($simd, Factors(ya, a), Factors(yb, b)));
            }
        }
        sum
    }};
}

/// The rest of it.
macro_rules! whole {
    ($simd:expr, $known:expr, $term:path, $first:expr, $newest:expr) => {
        Term::plus(
            $known,
            match $first {
                Some(first) => {
                    Term::plus($term($simd, first, $newest), $term($simd, $newest, first))
                }
                None => $term($simd, $newest, $newest),
            },
        )
    };
}

/// A few neighbouring entries of a state.
#[inline(always)]
pub(crate) fn part<T: Copy, const N: usize>(state: &[T; STATE], at: usize) -> [T; N] {
    std::array::from_fn(|i| state[at + i])
}

impl SpringSeries {
    pub(crate) fn new() -> Self {
        let (zero, vector) = (Lanes::ZERO, [Lanes::ZERO; 3]);
        Self {
            stiffness: zero,
            free_length: zero,
            payload_point: vector,
            stage_point: vector,
            line: [vector; TERMS],
            square: [zero; TERMS],
            inverse: [zero; TERMS],
            push: [zero; TERMS],
            known: Known { square: zero, slope: zero, force: vector },
            lost: true,
            upper: zero,
            lower: zero,
        }
    }

    /// What goes into the coefficients of order k and waits for nothing.
    #[inline(always)]
    fn prepare<S: Simd>(&mut self, simd: S, k: usize) {
        let load = |x: &Lanes<WIDTH>| Four::load(simd, x);
        let zero = Four::splat(simd, 0.0);
        let mut square = zero;
        for j in 1..k.div_ceil(2) {
            let ([x, y, z], [u, v, w]) = (&self.line[j], &self.line[k - j]);
            square = square + (load(x) * load(u) + load(y) * load(v) + load(z) * load(w));
        }
        square = square + square;
        if k > 0 && k.is_multiple_of(2) {
            let [x, y, z] = &self.line[k / 2];
            square = square + (load(x) * load(x) + load(y) * load(y) + load(z) * load(z));
        }
        self.known.square = square.store();
        self.lost = self.stiffness.0.iter().all(|s| *s == 0.0);
        let (mut slope, mut force) = (zero, [zero; 3]);
        if k > 1 && !self.lost {
            let weights = HALVES[k + 1..2 * k].iter().rev();
            let known = self.square[1..k].iter().zip(self.inverse[1..k].iter().rev()).zip(weights);
            let forces = self.push[1..k].iter().zip(self.line[1..k].iter().rev());
            for (((s, u), weight), (push, [x, y, z])) in known.zip(forces) {
                slope = slope + load(s) * load(u) * Four::splat(simd, *weight);
                let push = load(push);
                let [a, b, c] = force;
                force = [a + load(x) * push, b + load(y) * push, c + load(z) * push];
            }
        }
        self.known.slope = slope.store();
        self.known.force = force.map(Four::store);
    }

    /// The coefficients of order k of the forces on the payload, zero once a spring is lost.
    #[inline(always)]
    fn expand(&mut self, k: usize, offset: &V3<WIDTH>, rotation: &M3<WIDTH>) -> V3<WIDTH> {
        let mut line = sub(*offset, times(rotation, &self.stage_point));
        if k == 0 {
            line = add(line, self.payload_point);
        }
        self.line[k] = line;
        let ends = dot(&self.line[0], &line);
        let square = if k == 0 { ends } else { self.known.square + (ends + ends) };
        self.square[k] = square;
        if self.lost {
            return [Lanes::ZERO; 3];
        }
        let one = Lanes::splat(1.0);
        let inverse = if k == 0 {
            // A lost spring may come to length zero.
            self.stiffness.zip(one / square.sqrt(), |k, x| if k == 0.0 { 0.0 } else { x })
        } else {
            // u = (s²)^(−1/2): s² u' = −½ (s²)' u.
            let u = self.inverse[0];
            (self.known.slope + square * (u * HALVES[k])) * (u * u * -INVERSE[k])
        };
        self.inverse[k] = inverse;
        let mut push = self.free_length * inverse;
        if k == 0 {
            push -= one;
        }
        let push = self.stiffness * push;
        self.push[k] = push;
        let ends = scale(self.line[0], push);
        if k == 0 { ends } else { add(add(self.known.force, scale(line, self.push[0])), ends) }
    }
}

impl<const L: usize> Expansion<L>
where
    Lanes<L>: Packing<L>,
{
    pub(crate) fn new() -> Self {
        let vector = [Lanes::ZERO; 3];
        let rotor = Rotor { inertia: [vector; 3], inverse: [vector; 3] };
        Self {
            state: [[Lanes::ZERO; STATE]; TERMS],
            products: [Products::ZERO; TERMS],
            springs: SmallVec::new(),
            payload: rotor,
            stage: rotor,
            inverse_scale: [Lanes::ZERO; STATE],
            radius: Lanes::ZERO,
            stretch: [0.0; STOPS.len()],
            reach: Lanes::ZERO,
            order: [ORDER; L],
            end: [Lanes::ZERO; STATE],
            inverse_mass: Lanes::ZERO,
        }
    }

    /// Expands the motion about the state in `state[0]`: this evaluates the equations of motion, for
    /// all coefficients at once.
    ///
    /// A lane stops at a low degree if a spring lets go before its series ceases to be good. Whether
    /// it does depends on nothing but the lane.
    #[inline(always)]
    pub(crate) fn expand<S: Simd>(&mut self, simd: S) {
        let top = self.expand_lanes(simd);
        for lane in 0..L {
            let beyond = self.order[lane] + 1..=top;
            for row in &mut self.state[beyond] {
                for x in row {
                    x.0[lane] = 0.0;
                }
            }
            // Lanes differ where springs have the lanes of their runs.
            let beyond = self.order[lane]..top;
            for springs in &mut self.springs {
                for square in &mut springs.square[beyond.clone()] {
                    square.0[lane] = 0.0;
                }
            }
        }
        self.end = self.state[top];
        for row in self.state[..top].iter().rev() {
            for (end, x) in self.end.iter_mut().zip(row) {
                *end = *end * self.reach + *x;
            }
        }
        let reach = self.reach.spread();
        for springs in &mut self.springs {
            let (mut power, mut up, mut down) = (reach, Lanes::ZERO, Lanes::ZERO);
            for square in &springs.square[1..top] {
                let term = *square * power;
                up += term.map(|x| if x > 0.0 { x } else { 0.0 });
                down += term.map(|x| if x < 0.0 { x } else { 0.0 });
                power = power * reach;
            }
            springs.upper = springs.square[0] + up;
            springs.lower = springs.square[0] + down;
        }
    }

    /// To the degrees that the lanes need, of which it returns the highest.
    #[inline(always)]
    fn expand_lanes<S: Simd>(&mut self, simd: S) -> usize {
        let before = self.radius;
        let mut under_way = [true; L];
        let mut from = 0;
        for (stop, stretch) in STOPS.into_iter().zip(self.stretch) {
            for k in from..stop {
                self.expand_once(simd, k);
            }
            from = stop;
            let mut stops = [true; L];
            if stop < ORDER {
                // The radius seldom grows much from one step to the next, and takes time to find.
                stops = self.releases_within(before * (2.0 * stretch), stop);
                if !stops.iter().any(|x| *x) {
                    continue;
                }
            }
            let radius = self.radius(stop);
            let reach = radius * stretch;
            let ends = self.releases_within(reach, stop);
            for lane in 0..L {
                if under_way[lane] && stops[lane] && (ends[lane] || stop == ORDER) {
                    under_way[lane] = false;
                    self.radius.0[lane] = radius.0[lane];
                    self.reach.0[lane] = reach.0[lane];
                    self.order[lane] = stop;
                }
            }
            if !under_way.iter().any(|x| *x) {
                return stop;
            }
        }
        ORDER
    }

    /// Whether a spring reaches its free length by a time, as far as the coefficients below an order
    /// tell.
    #[inline(always)]
    fn releases_within(&self, time: Lanes<L>, order: usize) -> [bool; L] {
        let mut released = Lanes::ZERO;
        let time = time.spread();
        for springs in &self.springs {
            let mut sum = Lanes::ZERO;
            for term in springs.square[..order].iter().rev() {
                sum = sum * time + *term;
            }
            let beyond = sum.zip(springs.free_length, |s, l| if s >= l * l { 1.0 } else { 0.0 });
            let pushes = springs.stiffness.map(|k| if k == 0.0 { 0.0 } else { 1.0 });
            released = released.collect(beyond * pushes);
        }
        released.0.map(|x| x > 0.0)
    }

    /// From the coefficients up to k of the state to those of order k + 1.
    #[inline(always)]
    fn expand_once<S: Simd>(&mut self, simd: S, k: usize) {
        type Of<const L: usize> = <Lanes<L> as Packing<L>>::Products;
        let (y, (products, newest)) = (&mut self.state, self.products.split_at_mut(k));
        let newest = &mut newest[0];
        for springs in &mut self.springs {
            springs.prepare(simd, k);
        }
        let squares = known!(simd, Of::<L>::squares, y, products, k);
        let crosses = known!(simd, Of::<L>::crosses, y, products, k);
        let gyration = known!(simd, Of::<L>::gyration, y, products, k);
        let relative = known!(simd, Of::<L>::relative, y, products, k);
        let attitude = known!(simd, Of::<L>::attitude, y, products, k);
        let moment = known!(simd, Of::<L>::moment, y, products, k);
        let torque = known!(simd, Of::<L>::torque, y, products, k);

        let (y, next) = y.split_at_mut(k + 1);
        let (row, next) = (&y[k], &mut next[0]);
        let momenta = [
            times(&self.payload.inertia, &part(row, PAYLOAD_RATE)),
            times(&self.stage.inertia, &part(row, STAGE_RATE)),
        ];
        newest.set_motion(simd, row, &momenta);
        let first = products.first().map(|first| Factors(&y[0], first));
        let rotation = rotation(
            &Of::<L>::of_squares(&whole!(
                simd,
                squares,
                Of::<L>::squares,
                first,
                Factors(row, newest)
            )),
            k,
        );
        newest.set_rotation(simd, &rotation);
        let (mut force, mut spring_torque) = ([Lanes::ZERO; 3], [Lanes::ZERO; 3]);
        let (arm, turn) = (
            part::<_, 3>(row, OFFSET).map(Packing::spread),
            rotation.map(|row| row.map(Packing::spread)),
        );
        for springs in &mut self.springs {
            let push = springs.expand(k, &arm, &turn);
            let moment = cross(&springs.payload_point, &push);
            force = std::array::from_fn(|i| force[i].collect(push[i]));
            spring_torque = std::array::from_fn(|i| spring_torque[i].collect(moment[i]));
        }
        newest.set_force(simd, &force);
        let moment =
            Of::<L>::of_vector(&whole!(simd, moment, Of::<L>::moment, first, Factors(row, newest)));
        newest.set_reaction(&add(moment, spring_torque).map(|x| -x));

        let stage_torque =
            Of::<L>::of_vector(&whole!(simd, torque, Of::<L>::torque, first, Factors(row, newest)));
        let crosses = whole!(simd, crosses, Of::<L>::crosses, first, Factors(row, newest));
        let gyration = whole!(simd, gyration, Of::<L>::gyration, first, Factors(row, newest));
        let [offset, velocity, payload_turn, stage_turn] = Of::<L>::of_crosses(&crosses, &gyration);
        let relative = whole!(simd, relative, Of::<L>::relative, first, Factors(row, newest));
        let attitude = whole!(simd, attitude, Of::<L>::attitude, first, Factors(row, newest));
        let [relative, attitude] = [relative, attitude].map(|x| Of::<L>::of_turn(&x));

        let step = INVERSE[k + 1];
        put(next, OFFSET, &add(part(row, VELOCITY), offset), step);
        put(next, VELOCITY, &add(scale(force, self.inverse_mass), velocity), step);
        put(next, RELATIVE, &relative, 0.5 * step);
        put(next, ATTITUDE, &attitude, 0.5 * step);
        let payload_turn = times(&self.payload.inverse, &add(spring_torque, payload_turn));
        put(next, PAYLOAD_RATE, &payload_turn, step);
        let stage_turn = times(&self.stage.inverse, &add(stage_torque, stage_turn));
        put(next, STAGE_RATE, &stage_turn, step);
    }

    /// The radius of convergence as the last two coefficients up to an order tell it, each entry
    /// measured by its scale: of both, for series of even or odd functions have every other one.
    #[inline(always)]
    fn radius(&self, order: usize) -> Lanes<L> {
        let (mut last, mut previous) = (Lanes::ZERO, Lanes::ZERO);
        // NaN stays, which `f64::max` would pass over.
        let larger = |m: f64, x: f64| if x.abs() <= m { m } else { x.abs() };
        let rows = self.state[order].iter().zip(&self.state[order - 1]);
        for ((x, y), scale) in rows.zip(&self.inverse_scale) {
            last = last.zip(*x * *scale, larger);
            previous = previous.zip(*y * *scale, larger);
        }
        let n = order as f64;
        last = last.map(|x| inverse_root(x, n));
        previous = previous.map(|x| inverse_root(x, n - 1.0));
        last.zip(previous, |a, b| if a < b { a } else { b })
    }
}

/// About x^(−1/n), to 1 %: a step need not be exact.
#[inline(always)]
fn inverse_root(x: f64, n: f64) -> f64 {
    const LEAST: f64 = 1e-290;
    // Added, it leaves the nearest integer in the lowest bits.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    let x = if x < LEAST { LEAST } else { x };
    // The logarithm to base 2 is the exponent and, to ±0.043, the mantissa.
    let log = x.to_bits() as f64 / 4_503_599_627_370_496.0 - 1022.957;
    let y = -log / n;
    let whole = (y + ROUND) - ROUND;
    let f = y - whole;
    let power = f64::from_bits(((1023.0 + whole) as u64) << 52);
    // Infinity and NaN come out as NaN.
    power * (1.0 + f * (LN_2 + f * (0.2402 + f * 0.0555))) + x * 0.0
}

#[inline(always)]
fn put<const N: usize, const L: usize>(
    row: &mut [Lanes<L>; STATE],
    at: usize,
    values: &[Lanes<L>; N],
    factor: f64,
) {
    for (x, v) in row[at..at + N].iter_mut().zip(values) {
        *x = *v * factor;
    }
}

/// The rotation matrix, from the coefficients of order k of squares of the quaternion.
#[inline(always)]
fn rotation<const L: usize>(squares: &[Lanes<L>; 9], k: usize) -> M3<L> {
    let [xx, yy, zz, xy, xz, yz, wx, wy, wz] = *squares;
    let one = Lanes::splat(if k == 0 { 1.0 } else { 0.0 });
    let double = |x: Lanes<L>| x + x;
    [
        [one - double(yy + zz), double(xy - wz), double(xz + wy)],
        [double(xy + wz), one - double(xx + zz), double(yz - wx)],
        [double(xz - wy), double(yz + wx), one - double(xx + yy)],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn roots_are_about_right(e in -290.0..308.0f64, n in 4..20_u32) {
            let (x, n) = (libm::pow(10.0, e), f64::from(n));
            let exact = libm::pow(x, -1.0 / n);
            prop_assert!((inverse_root(x, n) / exact - 1.0).abs() < 0.01);
        }
    }

    #[test]
    fn roots_of_nothing_and_of_no_number() {
        assert!(inverse_root(0.0, 13.0) > 1e20);
        assert!(inverse_root(f64::NAN, 13.0).is_nan());
        assert!(!(inverse_root(f64::INFINITY, 13.0) > 0.0));
    }
}
