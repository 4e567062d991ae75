//! Products of a run alone: numbers of its own side by side in the lanes.

use crate::{
    lanes::{Lanes, M3, V3, WIDTH},
    layout::{ATTITUDE, OFFSET, PAYLOAD_RATE, RELATIVE, STAGE_RATE, VELOCITY, part},
    products::{Coefficients, Products, Row, Term, cross, load},
    vector::{Four, Simd},
};

/// The same number in all lanes.
#[inline(always)]
fn broad<const N: usize, S: Simd>(simd: S, x: &Row<1>, at: usize) -> [Four<S>; N] {
    std::array::from_fn(|i| Four::splat(simd, x[at + i].0[0]))
}

/// Of a run alone.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(crate) struct Single {
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

type One = Coefficients<Single, 1>;

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

impl Products<1> for Single {
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
