//! The density of the joint law of mass, mass centre and inertia.

use gyradius_inertia::{InertiaMatrix, MassProperties, PrincipalAxes};
use nalgebra::UnitQuaternion;
use std::f64::consts::LN_2;

use super::law::{JointScalar, MassPropertiesLaw};
use super::tensor::{Of, Principal};
use crate::density_of_entries::ln_density_of_entries;
use crate::ln_sum::ln_sum;
use crate::{AttitudeMoments, InertiaLaw, ScalarLaw};

/// A number that does not vary is itself to this share.
const SAME: f64 = 1e-12;
const SHAPE: usize = JointScalar::Shape1 as usize;

impl MassPropertiesLaw {
    /// The logarithm of the density at a body with respect to dm d³c dI₁₁ dI₂₂ dI₃₃ dI₁₂ dI₁₃ dI₂₃, the inertia about the
    /// mass centre, in kg, m and kg·m²; −∞ where no draw can be. A mass or a coordinate of the mass centre that does not
    /// vary is left out of the measure, and the density is −∞ where the body has another. None where the inertia has no
    /// density: a size or the axes do not vary, or its model has none.
    ///
    /// With respect to the ten in which the equations of motion are linear ([`TenParameters::linear`]) it is smaller by
    /// 3 ln m. Of a law that is kept to a region it has the error of the [`acceptance`](Self::acceptance).
    ///
    /// [`TenParameters::linear`]: super::TenParameters::linear
    #[must_use]
    pub fn ln_density(&self, body: &MassProperties) -> Option<f64> {
        let mass = body.mass_kg();
        let mut scores = [0.0; JointScalar::ALL.len()];
        let centre: [f64; 3] = body.mass_centre_m().into();
        let scalars = std::iter::once(mass).chain(centre);
        let mut sum = 0.0;
        for (i, (law, x)) in self.scalar_laws().zip(scalars).enumerate() {
            sum += of_scalar(law, x)?;
            if law.deviation() > 0.0 {
                scores[i] = self.score(i, law, x);
            }
        }
        let inertia = self.of_inertia(body, mass, scores)?;
        if !self.holds(body) {
            return Some(f64::NEG_INFINITY);
        }
        if sum == f64::NEG_INFINITY {
            return Some(sum);
        }
        Some(sum + inertia - libm::log(self.acceptance().0))
    }

    /// The score of a scalar if it is correlated with another.
    fn score(&self, scalar: usize, law: &ScalarLaw, x: f64) -> f64 {
        if self.copula().has(scalar) { law.score(x) } else { 0.0 }
    }

    /// The density of the entries, and of the copula.
    fn of_inertia(
        &self,
        body: &MassProperties,
        mass: f64,
        scores: [f64; JointScalar::ALL.len()],
    ) -> Option<f64> {
        let inertia = body.inertia();
        match &self.tensor().of {
            Of::GyrationLengths(principal) => self.of_principal(body, principal, mass, scores),
            Of::Roots(principal) => {
                self.of_principal(body, principal, self.shares().factor(mass), scores)
            }
            Of::Model(model) => {
                let factor = self.shares().factor(mass);
                let copula = self.copula().ln_copula(&scores)?;
                let unit = InertiaMatrix::new(inertia.matrix() / factor).ok()?;
                Some(model.ln_density(&unit)? - 6.0 * libm::log(factor) + copula)
            }
        }
    }

    /// Of second moments that are the squares of three scalars times a factor.
    fn of_principal(
        &self,
        body: &MassProperties,
        Principal { laws, axes }: &Principal,
        factor: f64,
        mut scores: [f64; JointScalar::ALL.len()],
    ) -> Option<f64> {
        axes.ln_density_of_attitude(&UnitQuaternion::identity())?;
        let tied = (0..3).any(|i| self.copula().has(SHAPE + i));
        let alone = if tied { 0.0 } else { self.copula().ln_copula(&scores)? };
        let mut known = true;
        let density = ln_density_of_entries(
            body.inertia(),
            |squares| {
                // |dK/dx| = 2 |x| times the factor, for each.
                let sizes = squares.map(|k| (k / factor).sqrt());
                let jacobian: f64 =
                    sizes.iter().map(|x| LN_2 + libm::log(*x) + libm::log(factor)).sum();
                // The densities of each law at each size of either sign, and the scores.
                let mut each = [[[0.0; 2]; 3]; 3];
                let mut score = [[[0.0; 2]; 3]; 3];
                for (i, law) in laws.iter().enumerate() {
                    for (j, size) in sizes.into_iter().enumerate() {
                        for (sign, x) in [size, -size].into_iter().enumerate() {
                            let Some(density) = law.ln_density(x) else {
                                known = false;
                                return [f64::NEG_INFINITY; 6];
                            };
                            each[i][j][sign] = density;
                            if tied && density > f64::NEG_INFINITY {
                                score[i][j][sign] = self.score(SHAPE + i, law, x);
                            }
                        }
                    }
                }
                PrincipalAxes::ORDERS.map(|(order, _)| {
                    let mut terms = [f64::NEG_INFINITY; 8];
                    for (signs, term) in terms.iter_mut().enumerate() {
                        let at = |i: usize| (i, order[i], signs >> i & 1);
                        let parts = [0, 1, 2].map(|i| {
                            let (i, j, sign) = at(i);
                            scores[SHAPE + i] = score[i][j][sign];
                            each[i][j][sign]
                        });
                        if parts.contains(&f64::NEG_INFINITY) {
                            continue;
                        }
                        let copula =
                            if tied { self.copula().ln_copula(&scores) } else { Some(alone) };
                        let Some(copula) = copula else {
                            known = false;
                            continue;
                        };
                        *term = parts.iter().sum::<f64>() + copula;
                    }
                    let sum = ln_sum(&terms);
                    // Nothing is there, even where a size is zero and the square's density infinite.
                    if sum == f64::NEG_INFINITY { sum } else { sum - jacobian }
                })
            },
            |q| axes.ln_density_of_attitude(q).unwrap_or(f64::NEG_INFINITY),
        );
        known.then_some(density)
    }
}

/// Of a scalar that may not vary.
fn of_scalar(law: &ScalarLaw, x: f64) -> Option<f64> {
    if law.deviation() > 0.0 {
        return law.ln_density(x);
    }
    let mean = law.mean();
    let same = (x - mean).abs() <= SAME * mean.abs();
    Some(if same { 0.0 } else { f64::NEG_INFINITY })
}
