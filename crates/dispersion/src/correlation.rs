//! Correlation coefficients that belong together.

use nalgebra::DMatrix;

/// Rounding that an eigenvalue may carry: coefficients come from files with so many digits.
const ROUNDING: f64 = 1e-9;

/// Coefficients that are not correlations.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("pair {}, ({}, {}): {problem}", pair + 1, quantities[0], quantities[1])]
#[non_exhaustive]
pub struct CorrelationError {
    /// Which of the pairs given is wrong, from 0; the message counts from 1.
    pub pair: usize,
    /// Its two quantities, by the numbers that were given.
    pub quantities: [usize; 2],
    /// What is wrong with it.
    pub problem: CorrelationProblem,
}

/// What is wrong with the coefficient of a pair, for who names the pair himself.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CorrelationProblem {
    /// The coefficient is outside [−1, 1] or NaN.
    #[error("coefficient = {value:?}: it must lie in [-1, 1]")]
    Coefficient {
        /// The coefficient.
        value: f64,
    },
    /// It is of a quantity with itself.
    #[error("it must be of two different quantities")]
    NoPair,
    /// It is of the same two quantities as another.
    #[error("these two have been given a coefficient before")]
    Twice,
    /// Some combination of the quantities would have a negative variance, to which this coefficient does most.
    #[error(
        "coefficient = {value:?} contradicts the others: together they have an eigenvalue of \
         {eigenvalue:.3}, and none may be negative"
    )]
    Indefinite {
        /// The coefficient.
        value: f64,
        /// The smallest eigenvalue of the matrix.
        eigenvalue: f64,
    },
}

/// Correlations of standard normal scores.
///
/// # Definition
/// Scores z of independent streams become L z, L Lᵀ the matrix of the coefficients with ones on its
/// diagonal. For normal laws the coefficients are the correlations of the values; for others the
/// values' are somewhat smaller in magnitude (a Gaussian copula).
///
/// # Algorithm
/// Cholesky's factor without pivoting, so that a quantity which is correlated with none keeps its
/// score, and its coming or going leaves the others as they are, to the bit. Pivots of nothing but
/// rounding count as zero: the matrix may be singular.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Correlation {
    /// Indices of the quantities that are correlated at all, rising.
    members: Vec<usize>,
    /// Rows of L, each up to its diagonal.
    rows: Vec<Vec<f64>>,
}

crate::written!(
    Correlation,
    |own| { members: Vec<usize> = own.members.clone(), factor: Vec<Vec<f64>> = own.rows.clone(), },
    {
        let is_row = |(i, row): (usize, &Vec<f64>)| {
            let square = row.iter().map(|x| x * x).sum::<f64>();
            row.len() == i + 1 && row[i] >= 0.0 && (square - 1.0).abs() < 1e-6
        };
        let fit = factor.len() == members.len() && factor.iter().enumerate().all(is_row);
        if !(fit && members.is_sorted_by(|a, b| a < b)) {
            return Err("factor: it must be lower triangular, a row of length one a member".into());
        }
        Correlation { members, rows: factor }
    }
);

impl Correlation {
    /// Coefficients of pairs of quantities, which are numbered from 0; others are not correlated.
    ///
    /// # Errors
    /// A coefficient is outside [−1, 1], a pair is none or comes twice, or the matrix is not positive
    /// semidefinite.
    pub fn new(pairs: &[(usize, usize, f64)]) -> Result<Self, CorrelationError> {
        let refused = |pair: usize, problem| {
            let (a, b, _) = pairs[pair];
            Err(CorrelationError { pair, quantities: [a, b], problem })
        };
        for (pair, &(a, b, value)) in pairs.iter().enumerate() {
            if !(value.abs() <= 1.0) {
                return refused(pair, CorrelationProblem::Coefficient { value });
            }
            if a == b {
                return refused(pair, CorrelationProblem::NoPair);
            }
            if pairs[..pair].iter().any(|&(c, d, _)| (c, d) == (a, b) || (d, c) == (a, b)) {
                return refused(pair, CorrelationProblem::Twice);
            }
        }
        // What a coefficient of zero ties stays as it is.
        let tied: Vec<usize> = (0..pairs.len()).filter(|pair| pairs[*pair].2 != 0.0).collect();
        let mut members: Vec<usize> =
            tied.iter().flat_map(|pair| [pairs[*pair].0, pairs[*pair].1]).collect();
        members.sort_unstable();
        members.dedup();
        let place = |index: usize| members.partition_point(|m| *m < index);
        let n = members.len();
        let mut matrix = DMatrix::<f64>::identity(n, n);
        for pair in &tied {
            let (a, b, value) = pairs[*pair];
            matrix[(place(a), place(b))] = value;
            matrix[(place(b), place(a))] = value;
        }
        if n > 0 {
            let eigen = matrix.clone().symmetric_eigen();
            let least = eigen.eigenvalues.imin();
            let eigenvalue = eigen.eigenvalues[least];
            if !(eigenvalue >= -ROUNDING * n as f64) {
                let v = eigen.eigenvectors.column(least);
                let part = |pair: usize| {
                    let (a, b, value) = pairs[pair];
                    value * v[place(a)] * v[place(b)]
                };
                let worst = tied.iter().min_by(|a, b| part(**a).total_cmp(&part(**b)));
                let pair = worst.copied().unwrap_or(0);
                let value = pairs[pair].2;
                return refused(pair, CorrelationProblem::Indefinite { value, eigenvalue });
            }
        }
        let mut rows: Vec<Vec<f64>> = Vec::with_capacity(n);
        for i in 0..n {
            let mut row: Vec<f64> = Vec::with_capacity(i + 1);
            for j in 0..i {
                let known: f64 = row.iter().zip(&rows[j]).map(|(a, b)| a * b).sum();
                let pivot = rows[j][j];
                row.push(if pivot > 0.0 { (matrix[(i, j)] - known) / pivot } else { 0.0 });
            }
            let rest = 1.0 - row.iter().map(|x| x * x).sum::<f64>();
            row.push(if rest > ROUNDING * n as f64 { rest.sqrt() } else { 0.0 });
            rows.push(row);
        }
        Ok(Self { members, rows })
    }

    /// Makes independent scores of all quantities correlated ones.
    ///
    /// # Panics
    /// Never: quantities beyond the end of the scores are left out.
    pub fn mix(&self, scores: &mut [f64]) {
        // From the last: a row needs the independent scores of those before it.
        for (&member, row) in self.members.iter().zip(&self.rows).rev() {
            let terms = row.iter().zip(&self.members);
            let sum = terms.map(|(l, &m)| l * scores.get(m).copied().unwrap_or(0.0)).sum();
            if let Some(score) = scores.get_mut(member) {
                *score = sum;
            }
        }
    }

    /// Whether a quantity is correlated with another.
    #[must_use]
    pub fn has(&self, quantity: usize) -> bool {
        self.members.binary_search(&quantity).is_ok()
    }

    /// The coefficient of two quantities: 1 of one with itself, 0 of those that are not correlated.
    #[must_use]
    pub fn coefficient(&self, a: usize, b: usize) -> f64 {
        if a == b {
            return 1.0;
        }
        let row = |index: usize| {
            let place = self.members.binary_search(&index).ok()?;
            self.rows.get(place)
        };
        match (row(a), row(b)) {
            (Some(a), Some(b)) => a.iter().zip(b).map(|(x, y)| x * y).sum(),
            (None, _) | (_, None) => 0.0,
        }
    }

    /// The logarithm of the density of the copula at correlated scores: that of the joint density over the product of
    /// those of each. None where some combination of the quantities does not vary.
    ///
    /// # Panics
    /// Never: quantities beyond the end of the scores have the score zero.
    #[must_use]
    pub fn ln_copula(&self, scores: &[f64]) -> Option<f64> {
        let score = |member: usize| scores.get(member).copied().unwrap_or(0.0);
        // u = L⁻¹ z.
        let mut independent: Vec<f64> = Vec::with_capacity(self.rows.len());
        let mut sum = 0.0;
        for (&member, row) in self.members.iter().zip(&self.rows) {
            let (&pivot, before) = row.split_last()?;
            if !(pivot > 0.0) {
                return None;
            }
            let known: f64 = before.iter().zip(&independent).map(|(l, u)| l * u).sum();
            let z = score(member);
            let u = (z - known) / pivot;
            independent.push(u);
            sum += 0.5 * (z - u) * (z + u) - libm::log(pivot);
        }
        Some(sum)
    }

    /// Pairs of quantities by which all that depend on each other hang together: a quantity without a pair is independent of
    /// all others.
    pub fn related(&self) -> impl Iterator<Item = (usize, usize)> {
        let members = &self.members;
        self.rows.iter().zip(members).flat_map(move |(row, &own)| {
            let others = row.iter().zip(members);
            others
                .filter(move |(l, other)| **l != 0.0 && **other != own)
                .map(move |(_, &other)| (own, other))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use rand_distr::{Distribution, StandardNormal};

    /// Sample correlations, Fisher's z below 4, those that are zero too.
    #[test]
    fn correlations_are_recovered() {
        const N: usize = 20_000;
        let pairs = [(0, 2, 0.8), (2, 3, -0.5), (5, 4, 0.99)];
        let law = Correlation::new(&pairs).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let mut sums = [[0.0; 6]; 6];
        for _ in 0..N {
            let mut z: [f64; 6] = std::array::from_fn(|_| StandardNormal.sample(&mut rng));
            law.mix(&mut z);
            for i in 0..6 {
                for j in 0..6 {
                    sums[i][j] += z[i] * z[j];
                }
            }
        }
        for i in 0..6 {
            let z = (sums[i][i] - N as f64) / (2.0 * N as f64).sqrt();
            assert!(z.abs() < 4.0, "variance {i}: {z}");
            for j in 0..i {
                let found = sums[i][j] / (sums[i][i] * sums[j][j]).sqrt();
                let given = pairs.iter().find(|(a, b, _)| (*a, *b) == (i, j) || (*b, *a) == (i, j));
                let given = given.map_or(0.0, |p| p.2);
                let z = (found.atanh() - given.atanh()) * (N as f64).sqrt();
                assert!(z.abs() < 4.0, "{i} {j}: {found}");
            }
        }
    }

    proptest! {
        /// Rows have length 1 and their products are the coefficients, of any matrix of rank 2 and more.
        #[test]
        fn factors_multiply_to_the_matrix(
            vectors in prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 2..6),
            flat in any::<bool>(),
        ) {
            let vectors: Vec<_> = vectors
                .into_iter()
                .map(|[x, y, z]| nalgebra::Vector3::new(x, y, if flat { 0.0 } else { z }))
                .filter(|v| v.norm() > 0.1)
                .map(|v| v.normalize())
                .collect();
            let mut pairs = Vec::new();
            for i in 0..vectors.len() {
                for j in 0..i {
                    pairs.push((i, j, vectors[i].dot(&vectors[j]).clamp(-1.0, 1.0)));
                }
            }
            let law = Correlation::new(&pairs).unwrap();
            for &(i, j, value) in &pairs {
                let found: f64 = law.rows[i].iter().zip(&law.rows[j]).map(|(a, b)| a * b).sum();
                prop_assert!((found - value).abs() < 1e-4, "{} {}", found, value);
                let length: f64 = law.rows[i].iter().map(|a| a * a).sum();
                prop_assert!((length - 1.0).abs() < 1e-7);
            }
        }
    }

    /// What is correlated with nothing neither changes nor is changed.
    #[test]
    fn strangers_leave_each_other_alone() {
        let few = Correlation::new(&[(0, 1, 0.3), (1, 2, 0.4)]).unwrap();
        let more = Correlation::new(&[(0, 2, 0.3), (1, 5, 0.9), (2, 4, 0.4)]).unwrap();
        let (mut a, mut b) = ([0.1, -0.7, 1.3], [0.1, 9.0, -0.7, 0.55, 1.3, 8.0]);
        few.mix(&mut a);
        more.mix(&mut b);
        assert_eq!([b[0], b[2], b[4]], a);
        assert_eq!(b[3], 0.55);
        assert_eq!(a[0], 0.1);
        let mut same = [0.3, 0.4];
        Correlation::new(&[(0, 1, 1.0)]).unwrap().mix(&mut same);
        assert_eq!(same, [0.3, 0.3]);
        Correlation::new(&[(0, 1, -1.0)]).unwrap().mix(&mut same);
        assert_eq!(same, [0.3, -0.3]);
        Correlation::default().mix(&mut same);
        few.mix(&mut []);
    }

    #[test]
    fn bad_coefficients_are_named() {
        let error = |pairs: &[(usize, usize, f64)]| Correlation::new(pairs).unwrap_err();
        for value in [1.1, -2.0, f64::NAN] {
            let found = error(&[(0, 1, 0.5), (0, 2, value)]);
            assert!(matches!(found.problem, CorrelationProblem::Coefficient { .. }), "{found}");
            let said = format!("pair 2, (0, 2): coefficient = {value:?}: it must lie in [-1, 1]");
            assert_eq!(found.to_string(), said);
        }
        let itself = error(&[(3, 3, 0.5)]).to_string();
        assert_eq!(itself, "pair 1, (3, 3): it must be of two different quantities");
        let twice = error(&[(0, 1, 0.5), (1, 0, 0.5)]).to_string();
        assert_eq!(twice, "pair 2, (1, 0): these two have been given a coefficient before");
        let contradiction = error(&[(7, 8, 0.1), (0, 1, 0.9), (1, 2, 0.9), (0, 2, -0.9)]);
        let CorrelationProblem::Indefinite { eigenvalue, .. } = contradiction.problem else {
            panic!("{contradiction}")
        };
        assert!((eigenvalue + 0.8).abs() < 1e-12, "{contradiction}");
    }

    proptest! {
        /// Wherever the pairs stand that contradict each other, the one that is named is one of them, with its place, its
        /// quantities and its coefficient.
        #[test]
        fn the_pair_that_contradicts_is_named(
            before in 0usize..4, size in 0.6..1.0f64, sign in any::<bool>(), start in 0usize..9,
        ) {
            let sign = if sign { 1.0 } else { -1.0 };
            let mut pairs: Vec<(usize, usize, f64)> =
                (0..before).map(|i| (20 + 2 * i, 21 + 2 * i, 0.5)).collect();
            let [a, b, c] = [start, start + 1, start + 2];
            pairs.extend([(a, b, sign * size), (b, c, size), (a, c, -sign * size)]);
            let error = Correlation::new(&pairs).unwrap_err();
            let (one, other, value) = pairs[error.pair];
            prop_assert!(error.pair >= before && error.quantities == [one, other]);
            let start = format!("pair {}, ({one}, {other}): coefficient = {value:?} contradicts", error.pair + 1);
            prop_assert!(error.to_string().starts_with(&start), "{}", error);
        }
    }
}
