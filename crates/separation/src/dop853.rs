//! The explicit Runge-Kutta pair of order 8(5,3) of Dormand and Prince, with the coefficients and
//! the error estimate of Hairer, Nørsett & Wanner, *Solving Ordinary Differential Equations I*
//! (2nd ed., Springer 1993, §II.10). For equations that do not depend on time.

const STAGES: usize = 12;

/// Weights of the stages in the argument of each stage.
const A: [&[(usize, f64)]; STAGES] = [
    &[],
    &[(0, 0.05260015195876773)],
    &[(0, 0.0197250569845379), (1, 0.0591751709536137)],
    &[(0, 0.02958758547680685), (2, 0.08876275643042054)],
    &[(0, 0.2413651341592667), (2, -0.8845494793282861), (3, 0.924834003261792)],
    &[(0, 0.037037037037037035), (3, 0.17082860872947386), (4, 0.12546768756682242)],
    &[(0, 0.037109375), (3, 0.17025221101954405), (4, 0.06021653898045596), (5, -0.017578125)],
    &[
        (0, 0.03709200011850479),
        (3, 0.17038392571223998),
        (4, 0.10726203044637328),
        (5, -0.015319437748624402),
        (6, 0.008273789163814023),
    ],
    &[
        (0, 0.6241109587160757),
        (3, -3.3608926294469414),
        (4, -0.868219346841726),
        (5, 27.59209969944671),
        (6, 20.154067550477894),
        (7, -43.48988418106996),
    ],
    &[
        (0, 0.47766253643826434),
        (3, -2.4881146199716677),
        (4, -0.590290826836843),
        (5, 21.230051448181193),
        (6, 15.279233632882423),
        (7, -33.28821096898486),
        (8, -0.020331201708508627),
    ],
    &[
        (0, -0.9371424300859873),
        (3, 5.186372428844064),
        (4, 1.0914373489967295),
        (5, -8.149787010746927),
        (6, -18.52006565999696),
        (7, 22.739487099350505),
        (8, 2.4936055526796523),
        (9, -3.0467644718982196),
    ],
    &[
        (0, 2.273310147516538),
        (3, -10.53449546673725),
        (4, -2.0008720582248625),
        (5, -17.9589318631188),
        (6, 27.94888452941996),
        (7, -2.8589982771350235),
        (8, -8.87285693353063),
        (9, 12.360567175794303),
        (10, 0.6433927460157636),
    ],
];
/// Weights of the stages in the step, order 8.
const B: &[(usize, f64)] = &[
    (0, 0.054293734116568765),
    (5, 4.450312892752409),
    (6, 1.8915178993145003),
    (7, -5.801203960010585),
    (8, 0.3111643669578199),
    (9, -0.1521609496625161),
    (10, 0.20136540080403034),
    (11, 0.04471061572777259),
];
/// Weights in the difference to the embedded formula of order 3.
const E3: &[(usize, f64)] = &[
    (0, -0.18980075407240762),
    (5, 4.450312892752409),
    (6, 1.8915178993145003),
    (7, -5.801203960010585),
    (8, -0.4226823213237919),
    (9, -0.1521609496625161),
    (10, 0.20136540080403034),
    (11, 0.02265179219836082),
];
/// Weights in the difference to the embedded formula of order 5.
const E5: &[(usize, f64)] = &[
    (0, 0.01312004499419488),
    (5, -1.2251564463762044),
    (6, -0.4957589496572502),
    (7, 1.6643771824549864),
    (8, -0.35032884874997366),
    (9, 0.3341791187130175),
    (10, 0.08192320648511571),
    (11, -0.022355307863886294),
];

/// One step tried from a state: where it leads and how wrong that may be.
pub(crate) struct Step<const N: usize> {
    pub(crate) state: [f64; N],
    /// Estimated error over tolerance: at most 1 for a step to be kept.
    pub(crate) error: f64,
}

/// Tries a step of length `h` from `state`, whose derivative is `slope`. Each error is measured in
/// units of its `scale`.
#[inline]
pub(crate) fn step<const N: usize>(
    f: &mut impl FnMut(&[f64; N]) -> [f64; N],
    state: &[f64; N],
    slope: &[f64; N],
    h: f64,
    scale: &[f64; N],
) -> Step<N> {
    let mut k = [[0.0; N]; STAGES];
    k[0] = *slope;
    for stage in 1..STAGES {
        let mut y = [0.0; N];
        for &(j, a) in A[stage] {
            accumulate(&mut y, a, &k[j]);
        }
        for (y, s) in y.iter_mut().zip(state) {
            *y = s + h * *y;
        }
        k[stage] = f(&y);
    }
    let combine = |weights: &[(usize, f64)]| {
        let mut sum = [0.0; N];
        for &(j, w) in weights {
            accumulate(&mut sum, w, &k[j]);
        }
        sum
    };
    let (increment, e3, e5) = (combine(B), combine(E3), combine(E5));
    let (mut third, mut fifth) = (0.0, 0.0);
    for i in 0..N {
        third += (e3[i] / scale[i]).powi(2);
        fifth += (e5[i] / scale[i]).powi(2);
    }
    let error = if fifth > 0.0 {
        h.abs() * fifth / ((fifth + 0.01 * third) * N as f64).sqrt()
    } else {
        // Zero, or not a number, which must not pass for zero.
        fifth
    };
    Step { state: std::array::from_fn(|i| state[i] + h * increment[i]), error }
}

/// The factor by which the next step is to differ from this one.
pub(crate) fn next_factor(error: f64) -> f64 {
    // Bounds and safety factor of Hairer, Nørsett & Wanner.
    if error == 0.0 { 6.0 } else { (0.9 * libm::pow(error, -0.125)).clamp(1.0 / 3.0, 6.0) }
}

#[inline]
fn accumulate<const N: usize>(sum: &mut [f64; N], weight: f64, term: &[f64; N]) {
    for (s, t) in sum.iter_mut().zip(term) {
        *s += weight * t;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn integrate(steps: u32, f: &mut impl FnMut(&[f64; 2]) -> [f64; 2], time: f64) -> [f64; 2] {
        let h = time / f64::from(steps);
        let mut y = [1.0, 0.0];
        for _ in 0..steps {
            let slope = f(&y);
            y = step(f, &y, &slope, h, &[1.0; 2]).state;
        }
        y
    }

    /// Order conditions: each stage is consistent, and B sums to one, E to zero.
    #[test]
    fn coefficients_are_consistent() {
        let sum = |w: &[(usize, f64)]| w.iter().map(|x| x.1).sum::<f64>();
        assert!((sum(B) - 1.0).abs() < 1e-14);
        assert!(sum(E3).abs() < 1e-14 && sum(E5).abs() < 1e-14);
        let nodes: Vec<f64> = A.iter().map(|row| sum(row)).collect();
        // Quadrature conditions Σ b c^q = 1/(q+1) up to order 8.
        for q in 0..8 {
            let moment: f64 = B.iter().map(|&(j, b)| b * nodes[j].powi(q)).sum();
            assert!((moment - 1.0 / f64::from(q + 1)).abs() < 1e-13, "order {}", q + 1);
        }
    }

    /// The error of a nonlinear pendulum falls with the eighth power of the step.
    #[test]
    fn converges_at_order_eight() {
        let mut f = |y: &[f64; 2]| [y[1], -y[0].sin()];
        let exact = integrate(2000, &mut f, 6.0);
        let errors: Vec<(f64, f64)> = [8, 12, 16, 24, 32]
            .map(|n| {
                let y = integrate(n, &mut f, 6.0);
                let error = (y[0] - exact[0]).hypot(y[1] - exact[1]);
                (f64::from(n).ln(), error.ln())
            })
            .to_vec();
        let n = errors.len() as f64;
        let (mx, my) = errors.iter().fold((0.0, 0.0), |m, e| (m.0 + e.0 / n, m.1 + e.1 / n));
        let (sxy, sxx) = errors.iter().fold((0.0, 0.0), |s, e| {
            (s.0 + (e.0 - mx) * (e.1 - my), s.1 + (e.0 - mx) * (e.0 - mx))
        });
        let slope = sxy / sxx;
        assert!((-9.5..-7.5).contains(&slope), "{slope} {errors:?}");
    }

    #[test]
    fn not_a_number_is_not_a_small_error() {
        let mut f = |_: &[f64; 2]| [f64::NAN, 0.0];
        assert!(!(step(&mut f, &[0.0; 2], &[0.0; 2], 1.0, &[1.0; 2]).error <= 1.0));
    }
}
