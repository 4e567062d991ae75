//! Products of the runs of a batch, one in each lane.

use crate::{
    lanes::{Lanes, M3, V3, WIDTH},
    layout::{ATTITUDE, OFFSET, PAYLOAD_RATE, RELATIVE, STAGE_RATE, VELOCITY},
    products::{Coefficients, Products, Row, cross, load, load_part},
    vector::{Four, Simd},
};

/// Of the runs of a batch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Batched {
    /// ω_L − ω_P and ω_L + ω_P.
    rates: [V3<WIDTH>; 2],
    momenta: [V3<WIDTH>; 2],
    rotation: M3<WIDTH>,
    force: V3<WIDTH>,
    reaction: V3<WIDTH>,
}

type Pair = Coefficients<Batched, WIDTH>;

impl Products<WIDTH> for Batched {
    type Squares<S: Simd> = [Four<S>; 9];
    // As many sums at a time as there are registers for.
    type Turn<S: Simd> = [Four<S>; 4];
    type Crosses<S: Simd> = [Four<S>; 9];
    type Gyration<S: Simd> = [Four<S>; 3];
    type Vector<S: Simd> = [Four<S>; 3];

    const ZERO: Self = {
        let zero = [Lanes::ZERO; 3];
        Self {
            rates: [zero; 2],
            momenta: [zero; 2],
            rotation: [zero; 3],
            force: zero,
            reaction: zero,
        }
    };

    #[inline(always)]
    fn set_motion<S: Simd>(&mut self, simd: S, state: &Row<WIDTH>) {
        let l: [Four<S>; 3] = load_part(simd, state, STAGE_RATE);
        let p: [Four<S>; 3] = load_part(simd, state, PAYLOAD_RATE);
        self.rates =
            [[0, 1, 2].map(|i| (l[i] - p[i]).store()), [0, 1, 2].map(|i| (l[i] + p[i]).store())];
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
