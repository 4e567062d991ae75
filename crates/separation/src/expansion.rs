//! The motion as a power series in time about a state, its coefficients by recurrence (Moore 1966;
//! Jorba & Zou 2005, doi:10.1080/10586458.2005.10128904): Cauchy's rule gives the coefficients of a
//! product, and an equation of motion the next coefficient of what it is the derivative of.
//!
//! Everything is in payload axes. Loads act on both bodies along one line, so that the torques on the
//! two bodies about a common point cancel: the torque on the stage about its mass centre is
//! −(ρ × F + T), ρ from the stage's mass centre to the payload's, F and T force and torque on the payload.
//!
//! With the angular momenta h = I ω, the angular rates ω_P and ω_L, and R from stage to payload,
//!
//! > ρ' = v + ρ × ω_P,  v' = F/μ + v × ω_P,  I_P ω_P' = T + h_P × ω_P,  I_L ω_L' = −Rᵀ(ρ × F + T) + h_L × ω_L,
//! > 2q' = q ∘ ω_L − ω_P ∘ q (stage to payload),  2Q' = Q ∘ ω_P (payload to inertial).

use crate::{
    lanes::{Lanes, M3, add, scale, times},
    layout::{
        ATTITUDE, INVERSE, OFFSET, ORDER, PAYLOAD_RATE, RELATIVE, STAGE_RATE, STATE, STOPS, TERMS,
        VELOCITY, part,
    },
    loads::LoadSeries,
    products::{Coefficients, Products, Row},
    root::inverse_root,
    vector::{Register, Simd},
};

/// What a body resists torques with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rotor<const W: usize> {
    pub(crate) inertia: M3<W>,
    pub(crate) inverse: M3<W>,
}

/// The series of a state and all that goes into it.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct Expansion<const W: usize> {
    pub(crate) terms: [Coefficients<W>; TERMS],
    pub(crate) loads: LoadSeries<W>,
    pub(crate) payload: Rotor<W>,
    pub(crate) stage: Rotor<W>,
    /// 1 over what each entry of the state is measured by.
    pub(crate) inverse_scale: [Lanes<W>; STATE],
    /// The radius of convergence, s; zero before the first expansion.
    pub(crate) radius: Lanes<W>,
    /// The share of the radius that a step may take, for each degree to stop at.
    pub(crate) stretch: [f64; STOPS.len()],
    /// How far the series are good for, s.
    pub(crate) reach: Lanes<W>,
    /// The degrees that they have come to; coefficients beyond are left over.
    pub(crate) order: [usize; W],
    /// The state there.
    pub(crate) end: Row<W>,
    /// 1/m of the payload plus 1/m of the stage.
    pub(crate) inverse_mass: Lanes<W>,
    /// Lanes that hold a run: the others wait for none and keep none waiting.
    pub(crate) busy: [bool; W],
}

/// The coefficient of a product by Cauchy's rule, of the order that coefficients are given to. What
/// waits for the newest of the second factor comes last.
#[inline(always)]
fn cauchy<S: Simd, const W: usize, const N: usize>(
    simd: S,
    of: &[Coefficients<W>],
    term: impl Fn(S, &Coefficients<W>, &Coefficients<W>) -> [Register<S>; N],
) -> [Register<S>; N] {
    let mut sum = [Register::splat(simd, 0.0); N];
    for (a, b) in of.iter().rev().zip(of) {
        sum = plus(sum, term(simd, a, b));
    }
    sum
}

#[inline(always)]
fn plus<S: Simd, const N: usize>(a: [Register<S>; N], b: [Register<S>; N]) -> [Register<S>; N] {
    std::array::from_fn(|i| a[i] + b[i])
}

impl<const W: usize> Expansion<W> {
    #[inline(always)]
    pub(crate) fn new(stretch: [f64; STOPS.len()]) -> Self {
        let vector = [Lanes::ZERO; 3];
        let rotor = Rotor { inertia: [vector; 3], inverse: [vector; 3] };
        Self {
            terms: [Coefficients { state: [Lanes::ZERO; STATE], products: Products::ZERO }; TERMS],
            loads: LoadSeries::new(),
            payload: rotor,
            stage: rotor,
            inverse_scale: [Lanes::ZERO; STATE],
            radius: Lanes::ZERO,
            stretch,
            reach: Lanes::ZERO,
            order: [ORDER; W],
            end: [Lanes::ZERO; STATE],
            inverse_mass: Lanes::ZERO,
            busy: [false; W],
        }
    }

    /// Expands the motion about the state in `terms[0]`: this evaluates the equations of motion, for
    /// all coefficients at once.
    ///
    /// A lane stops at a low degree if a load ends before its series ceases to be good. Whether
    /// it does depends on nothing but the lane.
    #[inline(always)]
    pub(crate) fn expand<S: Simd>(&mut self, simd: S) {
        let top = self.expand_lanes(simd);
        let busy = self.busy;
        for lane in (0..W).filter(|lane| busy[*lane]) {
            let beyond = self.order[lane] + 1..=top;
            for term in &mut self.terms[beyond] {
                for x in &mut term.state {
                    x.0[lane] = 0.0;
                }
            }
            self.loads.forget(lane, self.order[lane]..top);
        }
        // As many sums at a time as there are registers for.
        const SUMS: usize = STATE / 2;
        for at in [0, SUMS] {
            let mut sum: [_; SUMS] = part(&self.terms[top].state, at);
            for term in self.terms[..top].iter().rev() {
                sum = std::array::from_fn(|i| sum[i] * self.reach + term.state[at + i]);
            }
            self.end[at..at + SUMS].copy_from_slice(&sum);
        }
        self.loads.bound(self.reach, top);
    }

    /// To the degrees that the lanes need, of which it returns the highest.
    #[inline(always)]
    fn expand_lanes<S: Simd>(&mut self, simd: S) -> usize {
        let before = self.radius;
        let mut under_way = self.busy;
        let mut from = 0;
        for (stop, stretch) in STOPS.into_iter().zip(self.stretch) {
            for k in from..stop {
                self.expand_once(simd, k);
            }
            from = stop;
            let mut stops = [true; W];
            if stop < ORDER {
                // The radius seldom grows much from one step to the next, and takes time to find.
                stops = self.ends_within(before * (2.0 * stretch), stop);
                if !stops.iter().zip(&under_way).any(|(stops, under_way)| *stops && *under_way) {
                    continue;
                }
            }
            let radius = self.radius(stop);
            let reach = radius * stretch;
            let ends = self.ends_within(reach, stop);
            for lane in 0..W {
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

    /// Whether a load comes to its end by a time, as far as the coefficients below an order tell.
    #[inline(always)]
    fn ends_within(&mut self, time: Lanes<W>, order: usize) -> [bool; W] {
        self.loads.ends_within(time, order).0.map(|x| x > 0.0)
    }

    /// From the coefficients up to k of the state to those of order k + 1.
    #[inline(always)]
    fn expand_once<S: Simd>(&mut self, simd: S, k: usize) {
        let newest = &mut self.terms[k];
        newest.products.set_motion(simd, &newest.state);
        let (step, velocity) = (INVERSE[k + 1], part(&newest.state, VELOCITY));
        // Loops that wait for nothing stand between those that wait for what came last, and what comes
        // of them is put away: all registers are for the sums.
        let attitude = Products::of_turn(&cauchy(simd, &self.terms[..=k], Products::attitude));
        put(&mut self.terms[k + 1].state, ATTITUDE, &attitude, 0.5 * step);

        let rotation = rotation(&squares(simd, &self.terms[..=k]), k);
        let newest = &mut self.terms[k];
        newest.products.rotation = rotation;
        let arm = part(&newest.state, OFFSET);
        newest.products.momenta = [
            times(&self.payload.inertia, &part(&newest.state, PAYLOAD_RATE)),
            times(&self.stage.inertia, &part(&newest.state, STAGE_RATE)),
        ];
        self.loads.stretch(simd, k, &arm, &rotation);

        let crosses = cauchy(simd, &self.terms[..=k], Products::crosses);
        let [offset, acceleration, payload_turn] = Products::of_crosses(&crosses);
        let next = &mut self.terms[k + 1].state;
        put(next, OFFSET, &add(velocity, offset), step);
        put(next, VELOCITY, &acceleration, 1.0);
        put(next, PAYLOAD_RATE, &payload_turn, 1.0);

        let [force, torque] = self.loads.push(simd, k);
        self.terms[k].products.force = force;
        let next = &mut self.terms[k + 1].state;
        let acceleration = add(scale(force, self.inverse_mass), part(next, VELOCITY));
        put(next, VELOCITY, &acceleration, step);
        let payload_turn = add(torque, part(next, PAYLOAD_RATE));
        put(next, PAYLOAD_RATE, &times(&self.payload.inverse, &payload_turn), step);

        let gyration = cauchy(simd, &self.terms[..=k], Products::gyration);
        let stage_turn = gyration.map(Register::store);
        put(&mut self.terms[k + 1].state, STAGE_RATE, &stage_turn, 1.0);

        let moment = cauchy(simd, &self.terms[..=k], Products::moment).map(Register::store);
        self.terms[k].products.reaction = add(moment, torque).map(|x| -x);

        let relative = Products::of_turn(&cauchy(simd, &self.terms[..=k], Products::relative));
        put(&mut self.terms[k + 1].state, RELATIVE, &relative, 0.5 * step);

        let torque = cauchy(simd, &self.terms[..=k], Products::torque).map(Register::store);
        let next = &mut self.terms[k + 1].state;
        let stage_turn = add(torque, part(next, STAGE_RATE));
        put(next, STAGE_RATE, &times(&self.stage.inverse, &stage_turn), step);
    }

    /// The radius of convergence as the last two coefficients up to an order tell it, each entry
    /// measured by its scale: of both, for series of even or odd functions have every other one. No more than the loads
    /// tell of theirs.
    #[inline(always)]
    fn radius(&self, order: usize) -> Lanes<W> {
        let (mut last, mut previous) = (Lanes::ZERO, Lanes::ZERO);
        // NaN stays, which `f64::max` would pass over.
        let larger = |m: f64, x: f64| if x.abs() <= m { m } else { x.abs() };
        let rows = self.terms[order].state.iter().zip(&self.terms[order - 1].state);
        for ((x, y), scale) in rows.zip(&self.inverse_scale) {
            last = last.zip(*x * *scale, larger);
            previous = previous.zip(*y * *scale, larger);
        }
        let n = order as f64;
        last = last.map(|x| inverse_root(x, n));
        previous = previous.map(|x| inverse_root(x, n - 1.0));
        let radius = last.zip(previous, |a, b| if a < b { a } else { b });
        // In this order, for NaN stays.
        radius.zip(self.loads.radius(order), |a, b| if b < a { b } else { a })
    }
}

#[inline(always)]
fn put<const W: usize, const N: usize>(
    row: &mut Row<W>,
    at: usize,
    values: &[Lanes<W>; N],
    factor: f64,
) {
    for (x, v) in row[at..at + N].iter_mut().zip(values) {
        *x = *v * factor;
    }
}

/// The coefficients of order k of squares of the quaternion from stage to payload.
#[inline(always)]
fn squares<S: Simd, const W: usize>(simd: S, terms: &[Coefficients<W>]) -> [Lanes<W>; 9] {
    let half = terms.len() / 2;
    let (low, high) = (&terms[..half], &terms[terms.len() - half..]);
    let zero = [Register::splat(simd, 0.0); 9];
    let mut pairs = zero;
    for (a, b) in low.iter().zip(high.iter().rev()) {
        pairs = plus(pairs, Products::squares(simd, a, b));
    }
    let own = match terms.len() % 2 {
        0 => zero,
        _ => Products::own_squares(simd, &terms[half]),
    };
    Products::of_squares(&pairs, &own)
}

/// The rotation matrix, from the coefficients of order k of squares of the quaternion.
#[inline(always)]
fn rotation<const W: usize>(squares: &[Lanes<W>; 9], k: usize) -> M3<W> {
    let [xx, yy, zz, xy, xz, yz, wx, wy, wz] = *squares;
    let one = Lanes::splat(if k == 0 { 1.0 } else { 0.0 });
    let double = |x: Lanes<W>| x + x;
    [
        [one - double(yy + zz), double(xy - wz), double(xz + wy)],
        [double(xy + wz), one - double(xx + zz), double(yz - wx)],
        [double(xz - wy), double(yz + wx), one - double(xx + yy)],
    ]
}
