//! The motion as a power series in time about a state, its coefficients by recurrence (Moore 1966;
//! Jorba & Zou 2005, doi:10.1080/10586458.2005.10128904): Cauchy's rule gives the coefficients of a
//! product, and an equation of motion the next coefficient of what it is the derivative of.
//!
//! Everything is in payload axes. Springs act along the line between their points, so that the
//! torques on the two bodies about a common point cancel: the torque on the stage about its mass
//! centre is −(ρ × F + T), ρ from the stage's mass centre to the payload's, F and T force and torque
//! on the payload.

use smallvec::SmallVec;

use crate::lanes::{Lanes, M3, Packing, V3, WIDTH, add, cross, dot, scale, sub, times, transposed};

/// Degree of the series of a state.
pub(crate) const ORDER: usize = 14;
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

/// What a body resists torques with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rotor<const L: usize> {
    pub(crate) inertia: M3<L>,
    pub(crate) inverse: M3<L>,
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
}

/// Coefficients of what the equations of motion are made of.
#[derive(Clone, Copy, Debug)]
struct Parts<const L: usize> {
    /// Takes stage components to payload components.
    rotation: M3<L>,
    force: V3<L>,
    /// −(ρ × F + T), payload axes.
    reaction: V3<L>,
    /// Angular momenta about the mass centres, body axes.
    payload_momentum: V3<L>,
    stage_momentum: V3<L>,
    /// ω_L − ω_P and ω_L + ω_P, each component in the axes of its body.
    rate_difference: V3<L>,
    rate_sum: V3<L>,
}

/// The series of a state and all that goes into it.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct Expansion<const L: usize> {
    pub(crate) state: [[Lanes<L>; STATE]; TERMS],
    parts: [Parts<L>; TERMS],
    pub(crate) springs: SmallVec<[SpringSeries; INLINE_SPRINGS / WIDTH]>,
    pub(crate) payload: Rotor<L>,
    pub(crate) stage: Rotor<L>,
    /// 1 over what each entry of the state is measured by.
    pub(crate) inverse_scale: [Lanes<L>; STATE],
    /// The radius of convergence, s.
    pub(crate) radius: Lanes<L>,
    /// 1/m of the payload plus 1/m of the stage.
    pub(crate) inverse_mass: Lanes<L>,
}

/// The coefficient of order k of a bilinear function of two series.
#[inline(always)]
fn product<A, B, const N: usize, const L: usize>(
    a: &[A; TERMS],
    b: &[B; TERMS],
    k: usize,
    f: impl Fn(&A, &B) -> [Lanes<L>; N],
) -> [Lanes<L>; N] {
    let mut sum = [Lanes::ZERO; N];
    for (a, b) in a[..=k].iter().zip(b[..=k].iter().rev()) {
        sum = add(sum, f(a, b));
    }
    sum
}

/// The coefficient of order k of the square of a vector.
#[inline(always)]
fn square<const L: usize>(a: &[V3<L>; TERMS], k: usize) -> Lanes<L> {
    let mut sum = Lanes::ZERO;
    for j in 0..k.div_ceil(2) {
        sum += dot(&a[j], &a[k - j]);
    }
    sum += sum;
    if k.is_multiple_of(2) { sum + dot(&a[k / 2], &a[k / 2]) } else { sum }
}

/// A few neighbouring entries of a state.
#[inline(always)]
pub(crate) fn part<T: Copy, const N: usize>(state: &[T; STATE], at: usize) -> [T; N] {
    std::array::from_fn(|i| state[at + i])
}

/// ½ q ∘ ω, and ½ (q ∘ ω_L − ω_P ∘ q) if given ω_L − ω_P and ω_L + ω_P.
#[inline(always)]
fn turned<const L: usize>(q: &[Lanes<L>; 4], w: &V3<L>, sum: &V3<L>) -> [Lanes<L>; 4] {
    let v = [q[0], q[1], q[2]];
    let [x, y, z] = add(scale(*w, q[3]), cross(&v, sum));
    [x, y, z, -dot(&v, w)]
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
        }
    }

    /// The coefficients of order k of the forces on the payload, zero once a spring is lost.
    #[inline(always)]
    fn expand(&mut self, k: usize, offset: &V3<WIDTH>, rotation: &M3<WIDTH>) -> V3<WIDTH> {
        let mut line = sub(*offset, times(rotation, &self.stage_point));
        if k == 0 {
            line = add(line, self.payload_point);
        }
        self.line[k] = line;
        let square = square(&self.line, k);
        self.square[k] = square;
        if self.stiffness.0.iter().all(|s| *s == 0.0) {
            return [Lanes::ZERO; 3];
        }
        let one = Lanes::splat(1.0);
        self.inverse[k] = if k == 0 {
            one / square.sqrt()
        } else {
            // u = (s²)^(−1/2): s² u' = −½ (s²)' u.
            let mut sum = Lanes::ZERO;
            for j in 1..=k {
                let weight = k as f64 - 0.5 * j as f64;
                sum += self.square[j] * self.inverse[k - j] * weight;
            }
            let u = self.inverse[0];
            -(sum * (u * u)) * INVERSE[k]
        };
        let mut push = self.free_length * self.inverse[k];
        if k == 0 {
            push -= one;
        }
        // A lost spring may come to length zero.
        self.push[k] = self.stiffness.zip(push, |k, x| if k == 0.0 { 0.0 } else { k * x });
        product(&self.push, &self.line, k, |a, b| scale(*b, *a))
    }
}

impl<const L: usize> Expansion<L>
where
    Lanes<L>: Packing,
{
    pub(crate) fn new() -> Self {
        let vector = [Lanes::ZERO; 3];
        let rotor = Rotor { inertia: [vector; 3], inverse: [vector; 3] };
        let parts = Parts {
            rotation: [vector; 3],
            force: vector,
            reaction: vector,
            payload_momentum: vector,
            stage_momentum: vector,
            rate_difference: vector,
            rate_sum: vector,
        };
        Self {
            state: [[Lanes::ZERO; STATE]; TERMS],
            parts: [parts; TERMS],
            springs: SmallVec::new(),
            payload: rotor,
            stage: rotor,
            inverse_scale: [Lanes::ZERO; STATE],
            radius: Lanes::ZERO,
            inverse_mass: Lanes::ZERO,
        }
    }

    /// Expands the motion about the state in `state[0]`: this evaluates the equations of motion, for
    /// all coefficients at once.
    #[inline(always)]
    pub(crate) fn expand(&mut self) {
        for k in 0..ORDER {
            self.expand_once(k);
        }
        self.radius = self.radius();
    }

    /// From the coefficients up to k of the state to those of order k + 1.
    #[inline(always)]
    fn expand_once(&mut self, k: usize) {
        let (y, parts) = (&mut self.state, &mut self.parts);
        let rotation = rotation(y, k);
        let offset = part(&y[k], OFFSET);
        let (mut force, mut torque) = ([Lanes::ZERO; 3], [Lanes::ZERO; 3]);
        let (arm, turn) =
            (offset.map(Packing::spread), rotation.map(|row| row.map(Packing::spread)));
        for springs in &mut self.springs {
            let push = springs.expand(k, &arm, &turn);
            let moment = cross(&springs.payload_point, &push);
            force = std::array::from_fn(|i| force[i].collect(push[i]));
            torque = std::array::from_fn(|i| torque[i].collect(moment[i]));
        }
        let (payload_rate, stage_rate) = (part(&y[k], PAYLOAD_RATE), part(&y[k], STAGE_RATE));
        parts[k].rotation = rotation;
        parts[k].force = force;
        parts[k].payload_momentum = times(&self.payload.inertia, &payload_rate);
        parts[k].stage_momentum = times(&self.stage.inertia, &stage_rate);
        parts[k].rate_difference = sub(stage_rate, payload_rate);
        parts[k].rate_sum = add(stage_rate, payload_rate);
        let moment = product(y, parts, k, |y, p| cross(&part(y, OFFSET), &p.force));
        parts[k].reaction = add(moment, torque).map(|x| -x);

        let stage_torque = product(parts, parts, k, |a, b| transposed(&a.rotation, &b.reaction));
        let gyroscopic: [_; 6] = product(y, parts, k, |y, p| {
            join(
                cross(&part(y, PAYLOAD_RATE), &p.payload_momentum),
                cross(&part(y, STAGE_RATE), &p.stage_momentum),
            )
        });
        let [a, b, c, d, e, f] = gyroscopic;
        let payload_turn = times(&self.payload.inverse, &sub(torque, [a, b, c]));
        let stage_turn = times(&self.stage.inverse, &sub(stage_torque, [d, e, f]));

        // Derivatives in axes that turn.
        let carried: [_; 6] = product(y, y, k, |a, b| {
            let w = part(a, PAYLOAD_RATE);
            join(cross(&part(b, OFFSET), &w), cross(&part(b, VELOCITY), &w))
        });
        let [a, b, c, d, e, f] = carried;
        let velocity = add(part(&y[k], VELOCITY), [a, b, c]);
        let acceleration = add(scale(force, self.inverse_mass), [d, e, f]);
        let attitude = product(y, y, k, |q, w| {
            let w = part(w, PAYLOAD_RATE);
            turned(&part(q, ATTITUDE), &w, &w)
        });
        let relative = product(y, parts, k, |q, p| {
            turned(&part(q, RELATIVE), &p.rate_difference, &p.rate_sum)
        });

        let step = INVERSE[k + 1];
        let next = &mut y[k + 1];
        put(next, OFFSET, &velocity, step);
        put(next, VELOCITY, &acceleration, step);
        put(next, RELATIVE, &relative, 0.5 * step);
        put(next, ATTITUDE, &attitude, 0.5 * step);
        put(next, PAYLOAD_RATE, &payload_turn, step);
        put(next, STAGE_RATE, &stage_turn, step);
    }

    /// The radius of convergence as the last two coefficients tell it, each entry measured by its
    /// scale: of both, for series of even or odd functions have every other one.
    #[inline(always)]
    fn radius(&self) -> Lanes<L> {
        let [last, previous] = [ORDER, ORDER - 1].map(|order| {
            let mut largest = Lanes::ZERO;
            for (x, s) in self.state[order].iter().zip(&self.inverse_scale) {
                // NaN stays, which `f64::max` would pass over.
                largest = largest.zip(*x * *s, |m, x| if x.abs() <= m { m } else { x.abs() });
            }
            largest.map(|x| inverse_root(x, order as u32))
        });
        last.zip(previous, |a, b| if a < b { a } else { b })
    }
}

/// About x^(−1/n), to 1 %: a step need not be exact.
#[inline(always)]
fn inverse_root(x: f64, n: u32) -> f64 {
    // The exponent divided by −n, then Newton's iteration for y⁻ⁿ = x.
    const ONE: u64 = 1023 << 52;
    const LEAST: f64 = 1e-290;
    let x = if x < LEAST { LEAST } else { x };
    let n64 = u64::from(n);
    let mut y = f64::from_bits((ONE + ONE / n64).saturating_sub(x.to_bits() / n64));
    for _ in 0..3 {
        let mut power = y;
        for _ in 1..n {
            power *= y;
        }
        y += y * (1.0 - x * power) / f64::from(n);
    }
    y
}

#[inline(always)]
fn join<T: Copy>(a: [T; 3], b: [T; 3]) -> [T; 6] {
    [a[0], a[1], a[2], b[0], b[1], b[2]]
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

/// The rotation matrix of the relative attitude.
#[inline(always)]
fn rotation<const L: usize>(y: &[[Lanes<L>; STATE]; TERMS], k: usize) -> M3<L> {
    let [xx, yy, zz, xy, xz, yz, wx, wy, wz] = product(y, y, k, |a, b| {
        let [x, y, z, w]: [_; 4] = part(a, RELATIVE);
        let [bx, by, bz, _]: [_; 4] = part(b, RELATIVE);
        [x * bx, y * by, z * bz, x * by, x * bz, y * bz, w * bx, w * by, w * bz]
    });
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
        fn roots_are_about_right(e in -290.0..290.0f64, n in 8..20_u32) {
            let x = libm::pow(10.0, e);
            let exact = libm::pow(x, -1.0 / f64::from(n));
            prop_assert!((inverse_root(x, n) / exact - 1.0).abs() < 0.01);
        }
    }

    #[test]
    fn roots_of_nothing_and_of_no_number() {
        assert!(inverse_root(0.0, 13) > 1e20);
        assert!(inverse_root(f64::NAN, 13).is_nan());
        assert!(!(inverse_root(f64::INFINITY, 13) > 0.0));
    }
}
