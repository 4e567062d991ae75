//! Mean and covariance of the ten parameters of the joint law, by quadrature over its scalars.

use nalgebra::{SMatrix, SVector};
use std::cell::RefCell;

use super::inside::Inside;
use super::law::MassPropertiesLaw;
use super::scores::{Monomial, Scores};
use super::tensor::{Of, Principal};
use super::{TenMoments, TenSums};
use crate::entry_moments::ENTRIES;
use crate::{AttitudeMoments, EntryMoments, InertiaLaw, SecondMomentStatistics};

/// What the entries of the inertia are linear in: the second moments, or a factor of them all.
enum Size {
    Second([Monomial; 3], [[f64; 6]; 3]),
    Factor(Monomial, [f64; 6]),
}

const MASS: usize = 0;
const CENTRE: usize = 1;
const SHAPE: usize = 4;

impl MassPropertiesLaw {
    /// Mean and covariance of m, c₁, c₂, c₃ and the six entries of the inertia about the mass centre: in closed form or
    /// by quadrature. None of a law that is kept to a region by rejection, of which
    /// [`moments_in_region`](Self::moments_in_region) has estimates, of a model whose own moments are not known, or where a
    /// moment is too large for a number.
    ///
    /// None, too, where lognormal scalars are correlated with scalars of other laws and are so wide, from deviations of about six
    /// times the mean on, that quadrature does not have their own moments to 1e-3. Lognormal scalars that are correlated with each
    /// other alone may have any width.
    #[must_use]
    pub fn moments(&self) -> Option<TenMoments> {
        let one = Monomial::default();
        let mut others = vec![one.times(MASS, 1)];
        others.extend((0..3).map(|i| one.times(CENTRE + i, 1)));
        self.moments_with(
            &others,
            |x| SVector::from([x[0], x[1], x[2], x[3]]),
            |_| SVector::zeros(),
        )
    }

    /// Mean and covariance of the ten in which the equations of motion are linear
    /// ([`TenParameters::linear`](super::TenParameters::linear)): m, m c and the inertia about the origin.
    #[must_use]
    pub fn linear_moments(&self) -> Option<TenMoments> {
        let mass = Monomial::default().times(MASS, 1);
        let mut others = vec![mass];
        others.extend((0..3).map(|i| mass.times(CENTRE + i, 1)));
        others.extend(ENTRIES.map(|(a, b)| mass.times(CENTRE + a, 1).times(CENTRE + b, 1)));
        self.moments_with(
            &others,
            |x| SVector::from([x[0], x[1], x[2], x[3]]),
            // I = tr(P)·1 − P, P = m c cᵀ.
            |x| {
                let p = &x[4..];
                SVector::from([p[1] + p[2], p[0] + p[2], p[0] + p[1], -p[3], -p[4], -p[5]])
            },
        )
    }

    /// Of a law that is kept to a region, sums over the trial draws that were possible in it: their means, deviations and
    /// correlations of m, c and the six entries about the mass centre, with standard errors. None without a region, for
    /// [`moments`](Self::moments) are exact then.
    #[must_use]
    pub fn moments_in_region(&self) -> Option<&TenSums> {
        self.kept_to().map(Inside::sums)
    }

    /// Of ten numbers: four that are linear in `others`, and six entries, to which `added` adds what is linear in them.
    fn moments_with(
        &self,
        others: &[Monomial],
        four: impl Fn(&[f64]) -> SVector<f64, 4>,
        added: impl Fn(&[f64]) -> SVector<f64, 6>,
    ) -> Option<TenMoments> {
        if self.kept_to().is_some() {
            return None;
        }
        let shares = self.shares();
        let scores = Scores {
            laws: self.scalar_laws().collect(),
            correlation: self.correlation(),
            factor: |mass| shares.factor(mass),
            known: RefCell::default(),
        };
        let (size, axes) = self.size(&scores)?;
        let n = others.len();
        let pairs = |f: &Monomial, g: &Monomial| scores.covariance(f, g);
        // Each pair once.
        let own: Vec<Vec<(f64, f64)>> =
            (0..n).map(|i| (0..=i).map(|j| pairs(&others[i], &others[j])).collect()).collect();
        let means: Vec<f64> = own.iter().map(|row| row.last().map_or(0.0, |own| own.0)).collect();
        // Rows of the map from the others and the own entries to the ten.
        let place = |x: &[f64]| {
            let (four, six) = (four(x), added(x));
            SVector::<f64, 10>::from_fn(|i, _| if i < 4 { four[i] } else { six[i - 4] })
        };
        let unit = |i: usize| -> Vec<f64> { (0..n).map(|j| f64::from(u8::from(i == j))).collect() };
        let maps: Vec<SVector<f64, 10>> = (0..n).map(|i| place(&unit(i))).collect();
        let mut mean = place(&means);
        let mut covariance = SMatrix::<f64, 10, 10>::zeros();
        for (i, row) in own.iter().enumerate() {
            for (j, (_, own)) in row.iter().enumerate() {
                let half = maps[i] * maps[j].transpose() * *own;
                covariance += if i == j { half } else { half + half.transpose() };
            }
        }
        // The own entries, and how they go with the others.
        for e in 0..6 {
            mean[4 + e] += axes.mean()[e];
            for f in 0..6 {
                covariance[(4 + e, 4 + f)] += axes.covariance()[(e, f)];
            }
        }
        for i in 0..n {
            let cross: SVector<f64, 6> = match &size {
                Size::Second(moments, forms) => {
                    (0..3).fold(SVector::zeros(), |sum: SVector<f64, 6>, k| {
                        sum + SVector::from(forms[k]) * pairs(&moments[k], &others[i]).1
                    })
                }
                Size::Factor(factor, entries) => {
                    SVector::from(*entries) * pairs(factor, &others[i]).1
                }
            };
            let entries =
                SVector::<f64, 10>::from_fn(|r, _| if r < 4 { 0.0 } else { cross[r - 4] });
            covariance += entries * maps[i].transpose() + maps[i] * entries.transpose();
        }
        let are_numbers = mean.iter().chain(&covariance).all(|x| x.is_finite());
        are_numbers.then(|| TenMoments::unchecked(mean, covariance))
    }

    /// What the entries are linear in, and their own moments.
    fn size<F: Fn(f64) -> f64>(&self, scores: &Scores<'_, F>) -> Option<(Size, EntryMoments)> {
        let factor = Monomial { factor: 1, ..Monomial::default() };
        let second = |principal: &Principal, base: Monomial| {
            let moments: [Monomial; 3] = std::array::from_fn(|k| base.times(SHAPE + k, 2));
            let mean = moments.map(|k| scores.covariance(&k, &k).0);
            let covariance =
                nalgebra::Matrix3::from_fn(|i, j| scores.covariance(&moments[i], &moments[j]).1);
            if !mean.iter().chain(&covariance).all(|x| x.is_finite()) {
                return None;
            }
            let statistics = SecondMomentStatistics::joint(mean, covariance);
            let axes = principal.axes.entry_moments(&statistics);
            Some((Size::Second(moments, principal.axes.expected_forms()), axes))
        };
        match &self.tensor().of {
            Of::GyrationLengths(principal) => second(principal, Monomial::default().times(MASS, 1)),
            Of::Roots(principal) => second(principal, factor),
            Of::Model(model) => {
                let own = model.expected_moments()?;
                let (mean, variance) = scores.covariance(&factor, &factor);
                let square = mean * mean + variance;
                let entries = SVector::<f64, 6>::from(own.mean());
                let covariance =
                    own.covariance() * square + entries * entries.transpose() * variance;
                let moments = EntryMoments::unchecked((entries * mean).into(), covariance);
                Some((Size::Factor(factor, own.mean()), moments))
            }
        }
    }
}
