//! The products of series that the equations of motion are made of, term by term: how the
//! coefficients of two orders go into one of their product.

use crate::{
    lanes::{Lanes, M3, V3},
    layout::{ATTITUDE, OFFSET, PAYLOAD_RATE, RELATIVE, STAGE_RATE, STATE, VELOCITY},
    vector::{Register, Simd},
};

/// The coefficients of one order of a state.
pub(crate) type Row<const W: usize> = [Lanes<W>; STATE];

/// The coefficients of one order: of a state, and of what else goes into products.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(crate) struct Coefficients<const W: usize> {
    pub(crate) state: Row<W>,
    pub(crate) products: Products<W>,
}

/// Coefficients of one order of what is not in the state, and the terms they make.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Products<const W: usize> {
    /// ω_L − ω_P and ω_L + ω_P.
    rates: [V3<W>; 2],
    /// The angular momenta about the mass centres, body axes.
    pub(crate) momenta: [V3<W>; 2],
    /// Takes stage components to payload components.
    pub(crate) rotation: M3<W>,
    /// On the payload, payload axes.
    pub(crate) force: V3<W>,
    /// On the stage, −(ρ × F + T), payload axes.
    pub(crate) reaction: V3<W>,
}

impl<const W: usize> Products<W> {
    pub(crate) const ZERO: Self = {
        let zero = [Lanes::ZERO; 3];
        Self {
            rates: [zero; 2],
            momenta: [zero; 2],
            rotation: [zero; 3],
            force: zero,
            reaction: zero,
        }
    };

    /// From the state.
    #[inline(always)]
    pub(crate) fn set_motion<S: Simd>(&mut self, simd: S, state: &Row<W>) {
        let l: [Register<S>; 3] = load_part(simd, state, STAGE_RATE);
        let p: [Register<S>; 3] = load_part(simd, state, PAYLOAD_RATE);
        self.rates =
            [[0, 1, 2].map(|i| (l[i] - p[i]).store()), [0, 1, 2].map(|i| (l[i] + p[i]).store())];
    }

    /// Of the quaternion from stage to payload: of two orders, either way round.
    #[inline(always)]
    pub(crate) fn squares<S: Simd>(
        s: S,
        a: &Coefficients<W>,
        b: &Coefficients<W>,
    ) -> [Register<S>; 9] {
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

    /// Of one order by itself.
    #[inline(always)]
    pub(crate) fn own_squares<S: Simd>(s: S, a: &Coefficients<W>) -> [Register<S>; 9] {
        let [x, y, z, w] = load_part(s, &a.state, RELATIVE);
        [x * x, y * y, z * z, x * y, x * z, y * z, x * w, y * w, z * w]
    }

    /// xx, yy, zz, xy, xz, yz, xw, yw, zw.
    #[inline(always)]
    pub(crate) fn of_squares<S: Simd>(
        pairs: &[Register<S>; 9],
        own: &[Register<S>; 9],
    ) -> [Lanes<W>; 9] {
        // Doubling is exact, whenever it is done.
        let sum = |i: usize| if i < 3 { pairs[i] + pairs[i] } else { pairs[i] };
        std::array::from_fn(|i| (sum(i) + own[i]).store())
    }

    /// 2q̇ of the quaternion from stage to payload, q ∘ ω_L − ω_P ∘ q, by ω_L − ω_P and ω_L + ω_P.
    #[inline(always)]
    pub(crate) fn relative<S: Simd>(
        simd: S,
        a: &Coefficients<W>,
        b: &Coefficients<W>,
    ) -> [Register<S>; 4] {
        let [x, y, z, w] = load_part(simd, &a.state, RELATIVE);
        let [d, s] = b.products.rates.map(|x| load(simd, &x));
        [
            y * s[2] + (w * d[0] - z * s[1]),
            (z * s[0] + w * d[1]) - x * s[2],
            (x * s[1] - y * s[0]) + w * d[2],
            (x * d[0] + y * d[1]) + z * d[2],
        ]
    }

    /// 2q̇ of the quaternion from payload to inertial, q ∘ ω_P.
    #[inline(always)]
    pub(crate) fn attitude<S: Simd>(
        s: S,
        a: &Coefficients<W>,
        b: &Coefficients<W>,
    ) -> [Register<S>; 4] {
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
    pub(crate) fn of_turn<S: Simd>(sum: &[Register<S>; 4]) -> [Lanes<W>; 4] {
        let [x, y, z, w] = sum.map(Register::store);
        // The sign was left out.
        [x, y, z, Lanes::ZERO - w]
    }

    /// Offset, velocity and angular momentum of the payload, each × the rate of its axes.
    #[inline(always)]
    pub(crate) fn crosses<S: Simd>(
        s: S,
        a: &Coefficients<W>,
        b: &Coefficients<W>,
    ) -> [Register<S>; 9] {
        let rate = load_part(s, &b.state, PAYLOAD_RATE);
        let [x, y, z] = cross(&load_part(s, &a.state, OFFSET), &rate);
        let [u, v, w] = cross(&load_part(s, &a.state, VELOCITY), &rate);
        let [l, m, n] = cross(&load(s, &a.products.momenta[0]), &rate);
        [x, y, z, u, v, w, l, m, n]
    }

    /// The angular momentum of the stage × the rate of its axes.
    #[inline(always)]
    pub(crate) fn gyration<S: Simd>(
        s: S,
        a: &Coefficients<W>,
        b: &Coefficients<W>,
    ) -> [Register<S>; 3] {
        cross(&load(s, &a.products.momenta[1]), &load_part(s, &b.state, STAGE_RATE))
    }

    #[inline(always)]
    pub(crate) fn of_crosses<S: Simd>(sum: &[Register<S>; 9]) -> [V3<W>; 3] {
        let [a, b, c, d, e, f, g, h, i] = sum.map(Register::store);
        [[a, b, c], [d, e, f], [g, h, i]]
    }

    /// ρ × F.
    #[inline(always)]
    pub(crate) fn moment<S: Simd>(
        s: S,
        a: &Coefficients<W>,
        b: &Coefficients<W>,
    ) -> [Register<S>; 3] {
        cross(&load_part(s, &a.state, OFFSET), &load(s, &b.products.force))
    }

    /// The reaction in stage axes.
    #[inline(always)]
    pub(crate) fn torque<S: Simd>(
        s: S,
        a: &Coefficients<W>,
        b: &Coefficients<W>,
    ) -> [Register<S>; 3] {
        let (m, v) = (&a.products.rotation, load(s, &b.products.reaction));
        let [x, y, z] = [load(s, &m[0]), load(s, &m[1]), load(s, &m[2])];
        std::array::from_fn(|i| x[i] * v[0] + y[i] * v[1] + z[i] * v[2])
    }
}

#[inline(always)]
pub(crate) fn load<const W: usize, const N: usize, S: Simd>(
    simd: S,
    x: &[Lanes<W>; N],
) -> [Register<S>; N] {
    std::array::from_fn(|i| Register::load(simd, &x[i]))
}

#[inline(always)]
pub(crate) fn load_part<const W: usize, const N: usize, S: Simd>(
    simd: S,
    x: &Row<W>,
    at: usize,
) -> [Register<S>; N] {
    std::array::from_fn(|i| Register::load(simd, &x[at + i]))
}

#[inline(always)]
pub(crate) fn cross<S: Simd>(a: &[Register<S>; 3], b: &[Register<S>; 3]) -> [Register<S>; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
