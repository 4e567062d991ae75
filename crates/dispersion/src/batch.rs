//! Draws in batches, into columns.

use gyradius_attitude::{
    AboutAxis, FisherBingham, MeanHalf, RadiallyConstrainedGaussian, UniformAttitude,
};
use gyradius_inertia::RootSecondMoments;
use nalgebra::UnitQuaternion;
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::columns::{ColumnsError, common_length};
use crate::{
    AxesLaw, CorrelatedRoots, EmpiricalRoots, FixedAttitude, IndependentRoots, JacobianTwice,
    PrincipalDispersion, RootLaw, ScalarRoots, WithMoments,
};

/// Draws made at a time: few enough for the first-level cache.
pub(crate) const CHUNK: usize = 128;

/// A law of roots that can draw the squares of many at a time.
pub trait BatchRoots: Distribution<RootSecondMoments> {
    /// Fills three columns of one length with K₁, K₂, K₃ of independent draws, kg·m². What is beyond
    /// the shortest is left as it is. The values are those of [`sample`](Distribution::sample) one by one
    /// unless a law says otherwise.
    fn squares_into<R: Rng + ?Sized>(&self, rng: &mut R, columns: [&mut [f64]; 3]) {
        squares_one_by_one(self, rng, columns);
    }
}

fn squares_one_by_one<L: Distribution<RootSecondMoments> + ?Sized, R: Rng + ?Sized>(
    law: &L,
    rng: &mut R,
    [first, second, third]: [&mut [f64]; 3],
) {
    for ((a, b), c) in first.iter_mut().zip(second).zip(third) {
        [*a, *b, *c] = law.sample(rng).squared().values();
    }
}

/// Three normal laws are drawn root by root, the first for all, then the second and the third: other values
/// than one by one.
impl BatchRoots for ScalarRoots {
    fn squares_into<R: Rng + ?Sized>(&self, rng: &mut R, columns: [&mut [f64]; 3]) {
        let Some(normal) = self.as_normal() else { return squares_one_by_one(self, rng, columns) };
        let length = columns.iter().map(|c| c.len()).min().unwrap_or(0);
        for (column, [mean, variance]) in columns.into_iter().zip(normal) {
            let deviation = variance.sqrt();
            for k in &mut column[..length] {
                // Within range: the constructor leaves room for forty deviations.
                let z: f64 = StandardNormal.sample(rng);
                let root = mean + deviation * z;
                *k = root * root;
            }
        }
    }
}

impl BatchRoots for CorrelatedRoots {}
impl BatchRoots for EmpiricalRoots {}
impl<L: Distribution<f64>> BatchRoots for IndependentRoots<L> {}

impl<L: BatchRoots> BatchRoots for WithMoments<L> {
    fn squares_into<R: Rng + ?Sized>(&self, rng: &mut R, columns: [&mut [f64]; 3]) {
        self.law().squares_into(rng, columns);
    }
}

impl BatchRoots for RootLaw {
    fn squares_into<R: Rng + ?Sized>(&self, rng: &mut R, columns: [&mut [f64]; 3]) {
        match self {
            Self::CorrelatedGaussian(law) => law.squares_into(rng, columns),
            Self::Independent(law) => law.squares_into(rng, columns),
            Self::Empirical(law) => law.squares_into(rng, columns),
        }
    }
}

/// A law of attitudes that can draw many at a time.
pub trait BatchAttitudes: Distribution<UnitQuaternion<f64>> {
    /// Fills a slice with independent draws. The values are those of [`sample`](Distribution::sample) one
    /// by one unless a law says otherwise.
    fn attitudes_into<R: Rng + ?Sized>(&self, rng: &mut R, out: &mut [UnitQuaternion<f64>]) {
        out.fill_with(|| self.sample(rng));
    }
}

macro_rules! own_batches {
    ($($law:ty),*) => {$(
        /// By the law's own `sample_into`: other values than one by one.
        impl BatchAttitudes for $law {
            fn attitudes_into<R: Rng + ?Sized>(
                &self,
                rng: &mut R,
                out: &mut [UnitQuaternion<f64>],
            ) {
                self.sample_into(rng, out);
            }
        }
    )*};
}
own_batches!(RadiallyConstrainedGaussian, FisherBingham, UniformAttitude);

/// A batch of the whole law, draws of the far half drawn again one by one: other values than one by
/// one.
impl BatchAttitudes for MeanHalf {
    fn attitudes_into<R: Rng + ?Sized>(&self, rng: &mut R, out: &mut [UnitQuaternion<f64>]) {
        self.whole().sample_into(rng, out);
        for q in out.iter_mut() {
            if !self.whole().in_mean_half(q) {
                *q = self.sample(rng);
            }
        }
    }
}

impl BatchAttitudes for JacobianTwice {}
impl BatchAttitudes for FixedAttitude {}
impl BatchAttitudes for AboutAxis {}

impl BatchAttitudes for AxesLaw {
    fn attitudes_into<R: Rng + ?Sized>(&self, rng: &mut R, out: &mut [UnitQuaternion<f64>]) {
        match self {
            Self::WholeSphere(law) => law.attitudes_into(rng, out),
            Self::MeanHalf(law) => law.attitudes_into(rng, out),
            Self::JacobianTwice(law) => law.attitudes_into(rng, out),
            Self::Uniform(law) => law.attitudes_into(rng, out),
            Self::Fixed(law) => law.attitudes_into(rng, out),
            Self::FisherBingham(law) => law.attitudes_into(rng, out),
            Self::AboutAxis(law) => law.attitudes_into(rng, out),
        }
    }
}

impl<K: BatchRoots, A: BatchAttitudes> PrincipalDispersion<K, A> {
    /// Fills six columns, I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃ in kg·m², with independent draws: every row is a
    /// body.
    ///
    /// Roots and axes are drawn many at a time and put together by the machine's vector units, a few
    /// times as fast as one by one. The values are others than those of
    /// [`sample`](Distribution::sample), and the same on every machine. Draws are made 128 at a
    /// time, so that of two batches the longer begins with the shorter as far as that has whole chunks.
    ///
    /// # Errors
    /// The columns are not equally long. Nothing has been written or drawn.
    ///
    /// ```
    /// use gyradius_attitude::UniformAttitude;
    /// use gyradius_dispersion::{ScalarRoots, PrincipalDispersion};
    /// use gyradius_inertia::RootSecondMoments;
    /// use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    ///
    /// let roots = ScalarRoots::normal(RootSecondMoments::new([10.0, 20.0, 30.0])?, [0.5; 3])?;
    /// let law = PrincipalDispersion::new(roots, UniformAttitude);
    /// let mut columns = vec![vec![0.0; 1000]; 6];
    /// let mut slices = columns.iter_mut().map(Vec::as_mut_slice);
    /// let slices = std::array::from_fn(|_| slices.next().unwrap_or_default());
    /// law.sample_columns(&mut ChaCha8Rng::seed_from_u64(1), slices)?;
    /// assert!(columns[0].iter().all(|i11| *i11 > 0.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn sample_columns<R: Rng + ?Sized>(
        &self,
        rng: &mut R,
        mut columns: [&mut [f64]; 6],
    ) -> Result<(), ColumnsError> {
        let length = common_length(&columns)?;
        let mut squares = [[0.0; CHUNK]; 3];
        let mut attitudes = [UnitQuaternion::identity(); CHUNK];
        let mut start = 0;
        while start < length {
            let n = CHUNK.min(length - start);
            let [a, b, c] = &mut squares;
            self.roots().squares_into(rng, [&mut a[..n], &mut b[..n], &mut c[..n]]);
            self.axes().attitudes_into(rng, &mut attitudes[..n]);
            let out = columns.each_mut().map(|column| &mut column[start..start + n]);
            assemble(&squares, &attitudes, out);
            start += n;
        }
        Ok(())
    }
}

/// The entries of inertias with these second moments and principal axes, of which each row is a body.
pub(crate) fn assemble(
    squares: &[[f64; CHUNK]; 3],
    attitudes: &[UnitQuaternion<f64>; CHUNK],
    out: [&mut [f64]; 6],
) {
    pulp::Arch::new().dispatch(Assemble { squares, attitudes, out });
}

/// I = tr(Σ)·1 − Σ, Σ = Σ_k K_k r_k r_kᵀ, for a chunk.
struct Assemble<'a> {
    squares: &'a [[f64; CHUNK]; 3],
    attitudes: &'a [UnitQuaternion<f64>; CHUNK],
    out: [&'a mut [f64]; 6],
}

impl pulp::WithSimd for Assemble<'_> {
    type Output = ();

    // A loop that is compiled for every set of vector instructions: sums and products only, never
    // fused, so that every machine gets the same values.
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let n = self.out[0].len().min(CHUNK);
        let mut q = [[0.0; CHUNK]; 4];
        let [x, y, z, w] = &mut q;
        for ((((attitude, x), y), z), w) in self.attitudes[..n].iter().zip(x).zip(y).zip(z).zip(w) {
            (*x, *y, *z, *w) = (attitude.i, attitude.j, attitude.k, attitude.w);
        }
        let mut all = [[0.0; CHUNK]; 6];
        for i in 0..CHUNK {
            let (x, y, z, w) = (q[0][i], q[1][i], q[2][i], q[3][i]);
            let (xx, yy, zz, ww) = (x * x, y * y, z * z, w * w);
            let (xy, xz, yz) = (2.0 * x * y, 2.0 * x * z, 2.0 * y * z);
            let (wx, wy, wz) = (2.0 * w * x, 2.0 * w * y, 2.0 * w * z);
            let r = [
                [(ww + xx) - (yy + zz), xy - wz, xz + wy],
                [xy + wz, (ww + yy) - (xx + zz), yz - wx],
                [xz - wy, yz + wx, (ww + zz) - (xx + yy)],
            ];
            let k = [self.squares[0][i], self.squares[1][i], self.squares[2][i]];
            let sigma = |a: usize, b: usize| {
                k[0] * (r[0][a] * r[0][b]) + k[1] * (r[1][a] * r[1][b]) + k[2] * (r[2][a] * r[2][b])
            };
            let (s11, s22, s33) = (sigma(0, 0), sigma(1, 1), sigma(2, 2));
            all[0][i] = s22 + s33;
            all[1][i] = s11 + s33;
            all[2][i] = s11 + s22;
            all[3][i] = -sigma(0, 1);
            all[4][i] = -sigma(0, 2);
            all[5][i] = -sigma(1, 2);
        }
        for (column, values) in self.out.into_iter().zip(&all) {
            column.copy_from_slice(&values[..n]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::KnownMoments;
    use gyradius_inertia::{Inertia, InertiaMatrix};
    use nalgebra::{Matrix4, Vector4};
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    fn fill<K: BatchRoots, A: BatchAttitudes>(
        law: &PrincipalDispersion<K, A>,
        seed: u64,
        n: usize,
    ) -> [Vec<f64>; 6] {
        let mut columns = std::array::from_fn(|_| vec![f64::NAN; n]);
        let rng = &mut ChaCha8Rng::seed_from_u64(seed);
        law.sample_columns(rng, columns.each_mut().map(Vec::as_mut_slice)).unwrap();
        columns
    }

    fn laws() -> (ScalarRoots, RadiallyConstrainedGaussian) {
        let roots = RootSecondMoments::new([2.0, -1.0, 0.3]).unwrap();
        let mean = UnitQuaternion::from_euler_angles(0.3, 0.2, -0.5);
        let covariance = Matrix4::from_diagonal(&Vector4::new(0.02, 0.1, 0.3, 0.8));
        (
            ScalarRoots::normal(roots, [0.1, 0.2, 0.05]).unwrap(),
            RadiallyConstrainedGaussian::new(mean, covariance).unwrap(),
        )
    }

    fn check<K, A>(what: &str, law: &PrincipalDispersion<K, A>, seed: u64)
    where
        K: BatchRoots + crate::RootMoments,
        A: BatchAttitudes + crate::AttitudeMoments,
    {
        const N: usize = 100_000;
        let columns = fill(law, seed, N);
        let moments = law.entry_moments();
        for e in 0..6 {
            let mean = moments.mean()[e];
            let sample = columns[e].iter().sum::<f64>() / N as f64;
            let z = (sample - mean) / (moments.covariance()[(e, e)] / N as f64).sqrt();
            assert!(z.abs() < 4.0 || (sample - mean).abs() < 1e-10, "{what}: mean {e}: {z}");
            for f in 0..=e {
                let product =
                    |i: usize| (columns[e][i] - mean) * (columns[f][i] - moments.mean()[f]);
                let average = (0..N).map(product).sum::<f64>() / N as f64;
                let spread = (0..N).map(|i| (product(i) - average).powi(2)).sum::<f64>() / N as f64;
                let gap = average - moments.covariance()[(e, f)];
                let z = gap / (spread / N as f64).sqrt();
                assert!(z.abs() < 4.0 || gap.abs() < 1e-10, "{what}: covariance {e}{f}: {z}");
            }
        }
        let row = |i: usize| -> [f64; 6] { std::array::from_fn(|e| columns[e][i]) };
        for [i11, i22, i33, i12, i13, i23] in (0..N).map(row) {
            let matrix = InertiaMatrix::from_entries([i11, i22, i33], [i12, i13, i23]).unwrap();
            assert!(matrix.is_realizable(), "{what}: {matrix:?}");
        }
    }

    fn uniform(bounds: [[f64; 2]; 3]) -> ScalarRoots {
        ScalarRoots::new(bounds.map(|[a, b]| crate::ScalarLaw::uniform(a, b).unwrap())).unwrap()
    }

    #[test]
    fn batches_have_the_moments_and_are_bodies() {
        let (roots, axes) = laws();
        check("whole", &PrincipalDispersion::new(roots.clone(), axes.clone()), 1);
        check("half", &PrincipalDispersion::new(roots.clone(), MeanHalf::new(axes.clone())), 2);
        check("uniform", &PrincipalDispersion::new(roots.clone(), UniformAttitude), 3);
        let fixed = FixedAttitude::new(axes.mean());
        check("fixed", &PrincipalDispersion::new(roots.clone(), fixed), 4);
        let law = RootLaw::from(uniform([[1.0, 2.0], [0.0, 0.0], [-1.0, 1.0]]));
        check("any", &PrincipalDispersion::new(law, AxesLaw::from(axes)), 5);
    }

    /// The same roots and axes make the same bodies, to rounding.
    #[test]
    fn bodies_are_put_together_as_one_by_one() {
        let q = UnitQuaternion::from_euler_angles(1.0, -0.4, 2.0);
        let law = PrincipalDispersion::new(
            RootLaw::from(uniform([[2.0, 3.0], [1.0, 1.5], [0.0, 1.0]])),
            FixedAttitude::new(q),
        );
        let columns = fill(&law, 6, 1000);
        let mut rng = ChaCha8Rng::seed_from_u64(6);
        let row = |i: usize| -> [f64; 6] { std::array::from_fn(|e| columns[e][i]) };
        for row in (0..1000).map(row) {
            let one: Inertia = law.sample(&mut rng);
            for (x, y) in one.entries().into_iter().zip(row) {
                assert!((x - y).abs() < 2e-13, "{x} {y}");
            }
        }
    }

    #[test]
    fn any_length_is_filled_and_long_batches_begin_with_short_ones() {
        let (roots, axes) = laws();
        let law = PrincipalDispersion::new(roots, axes);
        let long = fill(&law, 7, 1000);
        for n in [0, 1, 127, 128, 129, 640] {
            let short = fill(&law, 7, n);
            assert!(short.iter().flatten().all(|x| x.is_finite()));
            let whole = n / CHUNK * CHUNK;
            for e in 0..6 {
                assert_eq!(short[e][..whole], long[e][..whole]);
            }
        }
    }

    #[test]
    fn unequal_columns_are_refused() {
        let (roots, axes) = laws();
        let law = PrincipalDispersion::new(roots, axes);
        let mut columns: [Vec<f64>; 6] = std::array::from_fn(|e| vec![0.0; 10 + e / 5]);
        let rng = &mut ChaCha8Rng::seed_from_u64(1);
        let error = law.sample_columns(rng, columns.each_mut().map(Vec::as_mut_slice)).unwrap_err();
        assert_eq!(error.lengths, [10, 11]);
        assert!(columns[0].iter().all(|x| *x == 0.0));
    }
}
