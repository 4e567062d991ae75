//! The products of series that the equations of motion are made of, term by term: how the
//! coefficients of two orders go into one of their product.
//!
//! Runs abreast have one lane each. A run alone has several numbers of its own in the lanes, laid out
//! so that the same operations come in the same order: it gets the same bits. Where it multiplies by
//! zeros instead of leaving a term out, sums start from +0 and stay as they are.

use std::fmt::Debug;

use crate::{
    expansion::{ATTITUDE, OFFSET, PAYLOAD_RATE, RELATIVE, STAGE_RATE, STATE, VELOCITY, part},
    lanes::{Lanes, M3, V3, WIDTH},
    vector::{Four, Simd},
};

/// The coefficients of one order of a state.
pub(crate) type Row<const L: usize> = [Lanes<L>; STATE];

/// What sums are made of.
pub(crate) trait Term<S>: Copy {
    fn zero(simd: S) -> Self;
    fn plus(self, other: Self) -> Self;
}

impl<const N: usize, S: Simd> Term<S> for [Four<S>; N] {
    #[inline(always)]
    fn zero(simd: S) -> Self {
        [Four::splat(simd, 0.0); N]
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        std::array::from_fn(|i| self[i] + other[i])
    }
}

/// The coefficients of one order: of a state, and of what else goes into products.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(crate) struct Coefficients<P, const L: usize> {
    pub(crate) state: Row<L>,
    pub(crate) products: P,
}

/// Coefficients of one order of what is not in the state, and the terms they make.
pub(crate) trait Products<const L: usize>: Copy + Debug {
    type Squares<S: Simd>: Term<S>;
    type Turn<S: Simd>: Term<S>;
    type Crosses<S: Simd>: Term<S>;
    type Gyration<S: Simd>: Term<S>;
    type Vector<S: Simd>: Term<S>;

    const ZERO: Self;
    /// From the state.
    fn set_motion<S: Simd>(&mut self, simd: S, state: &Row<L>);
    /// The angular momenta about the mass centres, body axes.
    fn set_momenta<S: Simd>(&mut self, simd: S, state: &Row<L>, momenta: &[V3<L>; 2]);
    /// Takes stage components to payload components.
    fn set_rotation<S: Simd>(&mut self, simd: S, rotation: &M3<L>);
    /// On the payload, payload axes.
    fn set_force<S: Simd>(&mut self, simd: S, force: &V3<L>);
    /// On the stage, −(ρ × F + T), payload axes.
    fn set_reaction(&mut self, reaction: &V3<L>);

    /// Of the quaternion from stage to payload: of two orders, either way round.
    fn squares<S: Simd>(s: S, a: &Coefficients<Self, L>, b: &Coefficients<Self, L>)
    -> Self::Squares<S>;
    /// Of one order by itself.
    fn own_squares<S: Simd>(s: S, a: &Coefficients<Self, L>) -> Self::Squares<S>;
    /// xx, yy, zz, xy, xz, yz, xw, yw, zw.
    fn of_squares<S: Simd>(pairs: &Self::Squares<S>, own: &Self::Squares<S>) -> [Lanes<L>; 9];

    /// 2q̇ of the quaternion from stage to payload, q ∘ ω_L − ω_P ∘ q, by ω_L − ω_P and ω_L + ω_P.
    fn relative<S: Simd>(s: S, a: &Coefficients<Self, L>, b: &Coefficients<Self, L>) -> Self::Turn<S>;
    /// 2q̇ of the quaternion from payload to inertial, q ∘ ω_P.
    fn attitude<S: Simd>(s: S, a: &Coefficients<Self, L>, b: &Coefficients<Self, L>) -> Self::Turn<S>;
    fn of_turn<S: Simd>(sum: &Self::Turn<S>) -> [Lanes<L>; 4];

    /// Offset, velocity and angular momentum of the payload, each × the rate of its axes.
    fn crosses<S: Simd>(s: S, a: &Coefficients<Self, L>, b: &Coefficients<Self, L>)
    -> Self::Crosses<S>;
    /// The angular momentum of the stage × the rate of its axes, if not among the former.
    fn gyration<S: Simd>(
        s: S,
        a: &Coefficients<Self, L>,
        b: &Coefficients<Self, L>,
    ) -> Self::Gyration<S>;
    fn of_crosses<S: Simd>(sum: &Self::Crosses<S>) -> [V3<L>; 3];
    fn of_gyration<S: Simd>(crosses: &Self::Crosses<S>, sum: &Self::Gyration<S>) -> V3<L>;

    /// ρ × F.
    fn moment<S: Simd>(s: S, a: &Coefficients<Self, L>, b: &Coefficients<Self, L>) -> Self::Vector<S>;
    /// The reaction in stage axes.
    fn torque<S: Simd>(s: S, a: &Coefficients<Self, L>, b: &Coefficients<Self, L>) -> Self::Vector<S>;
    fn of_vector<S: Simd>(sum: &Self::Vector<S>) -> V3<L>;
}

#[inline(always)]
fn load<const N: usize, S: Simd>(simd: S, x: &[Lanes<WIDTH>; N]) -> [Four<S>; N] {
    std::array::from_fn(|i| Four::load(simd, &x[i]))
}

#[inline(always)]
fn load_part<const N: usize, S: Simd>(simd: S, x: &Row<WIDTH>, at: usize) -> [Four<S>; N] {
    std::array::from_fn(|i| Four::load(simd, &x[at + i]))
}

/// The same number in all lanes.
#[inline(always)]
fn broad<const N: usize, S: Simd>(simd: S, x: &Row<1>, at: usize) -> [Four<S>; N] {
    std::array::from_fn(|i| Four::splat(simd, x[at + i].0[0]))
}

#[inline(always)]
fn cross<S: Simd>(a: &[Four<S>; 3], b: &[Four<S>; 3]) -> [Four<S>; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Of runs abreast.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Abreast {
    /// ω_L − ω_P and ω_L + ω_P.
    rates: [V3<WIDTH>; 2],
    momenta: [V3<WIDTH>; 2],
    rotation: M3<WIDTH>,
    force: V3<WIDTH>,
    reaction: V3<WIDTH>,
}

type Pair = Coefficients<Abreast, WIDTH>;

impl Products<WIDTH> for Abreast {
    type Squares<S: Simd> = [Four<S>; 9];
    // As many sums at a time as there are registers for.
    type Turn<S: Simd> = [Four<S>; 4];
    type Crosses<S: Simd> = [Four<S>; 9];
    type Gyration<S: Simd> = [Four<S>; 3];
    type Vector<S: Simd> = [Four<S>; 3];

    const ZERO: Self = {
        let zero = [Lanes::ZERO; 3];
        Self { rates: [zero; 2], momenta: [zero; 2], rotation: [zero; 3], force: zero, reaction: zero }
    };

    #[inline(always)]
    fn set_motion<S: Simd>(&mut self, simd: S, state: &Row<WIDTH>) {
        let l: [Four<S>; 3] = load_part(simd, state, STAGE_RATE);
        let p: [Four<S>; 3] = load_part(simd, state, PAYLOAD_RATE);
        self.rates = [[0, 1, 2].map(|i| (l[i] - p[i]).store()), [0, 1, 2].map(|i| (l[i] + p[i]).store())];
    }

    #[inline(always)]
    fn set_momenta<S: Simd>(&mut self, _: S, _: &Row<WIDTH>, momenta: &[V3<WIDTH>; 2]) {
        self.momenta = *momenta;
    }

    #[inline(always)]
    fn set_rotation<S: Simd>(&mut self, _: S, rotation: &M3<WIDTH>) {
        self.rotation = *rotation;
    }

    #[inline(always)]
    fn set_force<S: Simd>(&mut self, _: S, force: &V3<WIDTH>) {
        self.force = *force;
    }

    #[inline(always)]
    fn set_reaction(&mut self, reaction: &V3<WIDTH>) {
        self.reaction = *reaction;
    }

    #[inline(always)]
    fn squares<S: Simd>(s: S, a: &Pair, b: &Pair) -> Self::Squares<S> {
        let [x, y, z, w] = load_part(s, &a.state, RELATIVE);
        let [bx, by, bz, bw] = load_part(s, &b.state, RELATIVE);
        [
            x * bx,
            y * by,
            z * bz,
            x * by + bx * y,
            x * bz + bx * z,
            y * bz + by * z,
            x * bw + bx * w,
            y * bw + by * w,
            z * bw + bz * w,
        ]
    }

    #[inline(always)]
    fn own_squares<S: Simd>(s: S, a: &Pair) -> Self::Squares<S> {
        let [x, y, z, w] = load_part(s, &a.state, RELATIVE);
        [x * x, y * y, z * z, x * y, x * z, y * z, x * w, y * w, z * w]
    }

    #[inline(always)]
    fn of_squares<S: Simd>(pairs: &Self::Squares<S>, own: &Self::Squares<S>) -> [Lanes<WIDTH>; 9] {
        // Doubling is exact, whenever it is done.
        let sum = |i: usize| if i < 3 { pairs[i] + pairs[i] } else { pairs[i] };
        std::array::from_fn(|i| (sum(i) + own[i]).store())
    }

    #[inline(always)]
    fn relative<S: Simd>(simd: S, a: &Pair, b: &Pair) -> Self::Turn<S> {
        let [x, y, z, w] = load_part(simd, &a.state, RELATIVE);
        let [d, s] = b.products.rates.map(|x| load(simd, &x));
        [
            y * s[2] + (w * d[0] - z * s[1]),
            (z * s[0] + w * d[1]) - x * s[2],
            (x * s[1] - y * s[0]) + w * d[2],
            (x * d[0] + y * d[1]) + z * d[2],
        ]
    }

    #[inline(always)]
    fn attitude<S: Simd>(s: S, a: &Pair, b: &Pair) -> Self::Turn<S> {
        let [i, j, k, r] = load_part(s, &a.state, ATTITUDE);
        let [u, v, t] = load_part(s, &b.state, PAYLOAD_RATE);
        [
            (u * r - v * k) + t * j,
            (u * k + v * r) - t * i,
            (v * i - u * j) + t * r,
            (u * i + v * j) + t * k,
        ]
    }

    #[inline(always)]
    fn of_turn<S: Simd>(sum: &Self::Turn<S>) -> [Lanes<WIDTH>; 4] {
        let [x, y, z, w] = sum.map(Four::store);
        // The sign was left out.
        [x, y, z, Lanes::ZERO - w]
    }

    #[inline(always)]
    fn crosses<S: Simd>(s: S, a: &Pair, b: &Pair) -> Self::Crosses<S> {
        let rate = load_part(s, &b.state, PAYLOAD_RATE);
        let [x, y, z] = cross(&load_part(s, &a.state, OFFSET), &rate);
        let [u, v, w] = cross(&load_part(s, &a.state, VELOCITY), &rate);
        let [l, m, n] = cross(&load(s, &a.products.momenta[0]), &rate);
        [x, y, z, u, v, w, l, m, n]
    }

    #[inline(always)]
    fn gyration<S: Simd>(s: S, a: &Pair, b: &Pair) -> Self::Gyration<S> {
        cross(&load(s, &a.products.momenta[1]), &load_part(s, &b.state, STAGE_RATE))
    }

    #[inline(always)]
    fn of_crosses<S: Simd>(sum: &Self::Crosses<S>) -> [V3<WIDTH>; 3] {
        let [a, b, c, d, e, f, g, h, i] = sum.map(Four::store);
        [[a, b, c], [d, e, f], [g, h, i]]
    }

    #[inline(always)]
    fn of_gyration<S: Simd>(_: &Self::Crosses<S>, sum: &Self::Gyration<S>) -> V3<WIDTH> {
        sum.map(Four::store)
    }

    #[inline(always)]
    fn moment<S: Simd>(s: S, a: &Pair, b: &Pair) -> Self::Vector<S> {
        cross(&load_part(s, &a.state, OFFSET), &load(s, &b.products.force))
    }

    #[inline(always)]
    fn torque<S: Simd>(s: S, a: &Pair, b: &Pair) -> Self::Vector<S> {
        let (m, v) = (&a.products.rotation, load(s, &b.products.reaction));
        let [x, y, z] = [load(s, &m[0]), load(s, &m[1]), load(s, &m[2])];
        std::array::from_fn(|i| x[i] * v[0] + y[i] * v[1] + z[i] * v[2])
    }

    #[inline(always)]
    fn of_vector<S: Simd>(sum: &Self::Vector<S>) -> V3<WIDTH> {
        sum.map(Four::store)
    }
}

/// Of a run alone.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(crate) struct Alone {
    /// Offset, velocity and the momenta side by side, and the rates of their axes.
    carried: V3<WIDTH>,
    rates: V3<WIDTH>,
    /// The quaternions: what ω_P has to be multiplied with, by component of ω_P; the other, plain.
    attitude: V3<WIDTH>,
    relative: Lanes<WIDTH>,
    /// What the components of the quaternion from stage to payload have to be multiplied with.
    turn: [Lanes<WIDTH>; 4],
    /// Rows.
    rotation: V3<WIDTH>,
    /// yzx and zxy.
    offset: [Lanes<WIDTH>; 2],
    force: [Lanes<WIDTH>; 2],
    reaction: V3<1>,
}

type One = Coefficients<Alone, 1>;

/// Numbers to be loaded together are stored together, which the machine wants.
#[inline(always)]
fn pack<S: Simd>(simd: S, x: [f64; WIDTH]) -> Lanes<WIDTH> {
    Four::load(simd, &Lanes(x)).store()
}

#[inline(always)]
fn turned_about<S: Simd>(simd: S, v: &V3<1>) -> [Lanes<WIDTH>; 2] {
    let [x, y, z] = v.map(|x| x.0[0]);
    [pack(simd, [y, z, x, 0.0]), pack(simd, [z, x, y, 0.0])]
}

impl Products<1> for Alone {
    type Squares<S: Simd> = [Four<S>; 3];
    type Turn<S: Simd> = [Four<S>; 1];
    type Crosses<S: Simd> = [Four<S>; 3];
    type Gyration<S: Simd> = [Four<S>; 0];
    type Vector<S: Simd> = [Four<S>; 1];

    const ZERO: Self = {
        let zero = Lanes::ZERO;
        Self {
            carried: [zero; 3],
            rates: [zero; 3],
            attitude: [zero; 3],
            relative: zero,
            turn: [zero; 4],
            rotation: [zero; 3],
            offset: [zero; 2],
            force: [zero; 2],
            reaction: [Lanes::ZERO; 3],
        }
    };

    #[inline(always)]
    fn set_motion<S: Simd>(&mut self, simd: S, state: &Row<1>) {
        let y = state.map(|x| x.0[0]);
        let (p, l): ([_; 3], [_; 3]) = (part(&y, PAYLOAD_RATE), part(&y, STAGE_RATE));
        let d: [_; 3] = std::array::from_fn(|i| l[i] - p[i]);
        let s: [_; 3] = std::array::from_fn(|i| l[i] + p[i]);
        let [i, j, k, r] = part(&y, ATTITUDE);
        self.attitude =
            [pack(simd, [r, k, -j, -i]), pack(simd, [-k, r, i, -j]), pack(simd, [j, -i, r, -k])];
        self.relative = pack(simd, part(&y, RELATIVE));
        self.turn = [
            pack(simd, [0.0, -s[2], s[1], -d[0]]),
            pack(simd, [s[2], 0.0, -s[0], -d[1]]),
            pack(simd, [-s[1], s[0], 0.0, -d[2]]),
            pack(simd, [d[0], d[1], d[2], 0.0]),
        ];
        self.offset = turned_about(simd, &part(state, OFFSET));
    }

    #[inline(always)]
    fn set_momenta<S: Simd>(&mut self, simd: S, state: &Row<1>, momenta: &[V3<1>; 2]) {
        let y = state.map(|x| x.0[0]);
        let [m, n] = momenta.map(|m| m.map(|x| x.0[0]));
        let (p, l): ([_; 3], [_; 3]) = (part(&y, PAYLOAD_RATE), part(&y, STAGE_RATE));
        self.carried = [0, 1, 2].map(|i| pack(simd, [y[OFFSET + i], y[VELOCITY + i], m[i], n[i]]));
        self.rates = [0, 1, 2].map(|i| pack(simd, [p[i], p[i], p[i], l[i]]));
    }

    #[inline(always)]
    fn set_rotation<S: Simd>(&mut self, simd: S, rotation: &M3<1>) {
        self.rotation = rotation.map(|[x, y, z]| pack(simd, [x.0[0], y.0[0], z.0[0], 0.0]));
    }

    #[inline(always)]
    fn set_force<S: Simd>(&mut self, simd: S, force: &V3<1>) {
        self.force = turned_about(simd, force);
    }

    #[inline(always)]
    fn set_reaction(&mut self, reaction: &V3<1>) {
        self.reaction = *reaction;
    }

    #[inline(always)]
    fn squares<S: Simd>(s: S, a: &One, b: &One) -> Self::Squares<S> {
        let [p, q] = load(s, &[a.products.relative, b.products.relative]);
        let (x, y) = (broad::<3, S>(s, &a.state, RELATIVE), broad::<3, S>(s, &b.state, RELATIVE));
        std::array::from_fn(|i| x[i] * q + y[i] * p)
    }

    #[inline(always)]
    fn own_squares<S: Simd>(s: S, a: &One) -> Self::Squares<S> {
        let q = Four::load(s, &a.products.relative);
        broad::<3, S>(s, &a.state, RELATIVE).map(|x| x * q)
    }

    #[inline(always)]
    fn of_squares<S: Simd>(pairs: &Self::Squares<S>, own: &Self::Squares<S>) -> [Lanes<1>; 9] {
        let sum = pairs.plus(*own);
        let [[xx, xy, xz, xw], [_, yy, yz, yw], [_, _, zz, zw]] = sum.map(|x| x.store().0);
        [xx, yy, zz, xy, xz, yz, xw, yw, zw].map(|x| Lanes([x]))
    }

    #[inline(always)]
    fn relative<S: Simd>(s: S, a: &One, b: &One) -> Self::Turn<S> {
        let ([x, y, z, w], turn) = (broad(s, &a.state, RELATIVE), load(s, &b.products.turn));
        [(x * turn[0] + y * turn[1]) + (z * turn[2] + w * turn[3])]
    }

    #[inline(always)]
    fn attitude<S: Simd>(s: S, a: &One, b: &One) -> Self::Turn<S> {
        let ([u, v, t], q) = (broad(s, &b.state, PAYLOAD_RATE), load(s, &a.products.attitude));
        [(u * q[0] + v * q[1]) + t * q[2]]
    }

    #[inline(always)]
    fn of_turn<S: Simd>(sum: &Self::Turn<S>) -> [Lanes<1>; 4] {
        sum[0].store().0.map(|x| Lanes([x]))
    }

    #[inline(always)]
    fn crosses<S: Simd>(s: S, a: &One, b: &One) -> Self::Crosses<S> {
        cross(&load(s, &a.products.carried), &load(s, &b.products.rates))
    }

    #[inline(always)]
    fn gyration<S: Simd>(_: S, _: &One, _: &One) -> Self::Gyration<S> {
        []
    }

    #[inline(always)]
    fn of_crosses<S: Simd>(sum: &Self::Crosses<S>) -> [V3<1>; 3] {
        let sum = sum.map(|x| x.store().0);
        [0, 1, 2].map(|i| sum.map(|x| Lanes([x[i]])))
    }

    #[inline(always)]
    fn of_gyration<S: Simd>(crosses: &Self::Crosses<S>, _: &Self::Gyration<S>) -> V3<1> {
        crosses.map(|x| Lanes([x.store().0[3]]))
    }

    #[inline(always)]
    fn moment<S: Simd>(s: S, a: &One, b: &One) -> Self::Vector<S> {
        let (offset, force) = (load(s, &a.products.offset), load(s, &b.products.force));
        [offset[0] * force[1] - offset[1] * force[0]]
    }

    #[inline(always)]
    fn torque<S: Simd>(s: S, a: &One, b: &One) -> Self::Vector<S> {
        let [x, y, z] = b.products.reaction.map(|x| Four::splat(s, x.0[0]));
        let rows = load(s, &a.products.rotation);
        [rows[0] * x + rows[1] * y + rows[2] * z]
    }

    #[inline(always)]
    fn of_vector<S: Simd>(sum: &Self::Vector<S>) -> V3<1> {
        let [sum] = sum.map(|x| x.store().0);
        std::array::from_fn(|i| Lanes([sum[i]]))
    }
}
