//! The density of the joint law of mass, mass centre and inertia.

use gyradius_inertia::{InertiaMatrix, MassProperties, PrincipalAxes};
use nalgebra::UnitQuaternion;
use std::f64::consts::LN_2;

use super::law::{JointScalar, MassPropertiesLaw};
use super::tensor::{Of, Principal};
use crate::density_of_entries::{Bounded, ln_density_of_bounded};
use crate::ln_sum::{ln_product_of_exps, ln_sum};
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
            sum = ln_product_of_exps(&[sum, of_scalar(law, x)?]);
            if law.deviation() > 0.0 {
                scores[i] = self.score(i, law, x);
            }
        }
        let inertia = self.of_inertia(body, mass, scores)?;
        if !self.holds(body) {
            return Some(f64::NEG_INFINITY);
        }
        Some(ln_product_of_exps(&[sum, inertia, -libm::log(self.acceptance().0)]))
    }

    /// The score of a scalar if it is correlated with another.
    fn score(&self, scalar: usize, law: &ScalarLaw, x: f64) -> f64 {
        if self.correlation().has(scalar) { law.score(x) } else { 0.0 }
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
                let copula = self.correlation().ln_copula(&scores)?;
                let unit = InertiaMatrix::new(inertia.matrix() / factor).ok()?;
                let density = [model.ln_density(&unit)?, -6.0 * libm::log(factor), copula];
                Some(ln_product_of_exps(&density))
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
        let tied = (0..3).any(|i| self.correlation().has(SHAPE + i));
        let alone = if tied { 0.0 } else { self.correlation().ln_copula(&scores)? };
        let mut known = true;
        let density = ln_density_of_bounded(
            body.inertia(),
            |squares| {
                let sizes = squares.map(|k| (k / factor).sqrt());
                // |dK/dx| = 2 |x| times the factor, for each.
                let jacobian: f64 =
                    sizes.iter().map(|x| LN_2 + libm::log(*x) + libm::log(factor)).sum();
                // The densities of each law at each size of either sign.
                let mut each = [[[0.0; 2]; 3]; 3];
                for (law, each) in laws.iter().zip(&mut each) {
                    for (size, each) in sizes.into_iter().zip(each) {
                        for (sign, x) in [size, -size].into_iter().enumerate() {
                            let Some(density) = law.ln_density(x) else {
                                known = false;
                                return [f64::NEG_INFINITY; 6];
                            };
                            each[sign] = density;
                        }
                    }
                }
                let orders = if tied {
                    let joint = self.tied(laws, sizes, &each, &mut scores);
                    known = joint.is_some();
                    joint.unwrap_or([f64::NEG_INFINITY; 6])
                } else {
                    let folded = each.map(|law| law.map(|both| ln_sum(&both)));
                    PrincipalAxes::ORDERS.map(|(order, _)| {
                        let [a, b, c] = [0, 1, 2].map(|i| folded[i][order[i]]);
                        ln_product_of_exps(&[a, b, c, alone])
                    })
                };
                // Nothing is there, even where a size is zero and the square's density infinite.
                orders.map(|ln| if ln == f64::NEG_INFINITY { ln } else { ln - jacobian })
            },
            Bounded {
                density: |q: &UnitQuaternion<f64>| {
                    axes.ln_density_of_attitude(q).unwrap_or(f64::NEG_INFINITY)
                },
                at_most: axes.ln_density_at_most(),
            },
        );
        known.then_some(density)
    }

    /// The joint density of three sizes and the copula in each of the orders, both signs of each size added.
    fn tied(
        &self,
        laws: &[ScalarLaw; 3],
        sizes: [f64; 3],
        each: &[[[f64; 2]; 3]; 3],
        scores: &mut [f64; JointScalar::ALL.len()],
    ) -> Option<[f64; 6]> {
        let mut orders = [f64::NEG_INFINITY; 6];
        for ((order, _), sum) in PrincipalAxes::ORDERS.into_iter().zip(&mut orders) {
            let mut terms = [f64::NEG_INFINITY; 8];
            for (signs, term) in terms.iter_mut().enumerate() {
                let sign = |i: usize| signs >> i & 1;
                let parts = [0, 1, 2].map(|i| each[i][order[i]][sign(i)]);
                if parts.contains(&f64::NEG_INFINITY) {
                    continue;
                }
                for (i, law) in laws.iter().enumerate() {
                    let size = sizes[order[i]];
                    let x = if sign(i) == 0 { size } else { -size };
                    scores[SHAPE + i] = self.score(SHAPE + i, law, x);
                }
                let [a, b, c] = parts;
                *term = ln_product_of_exps(&[a, b, c, self.correlation().ln_copula(scores)?]);
            }
            *sum = ln_sum(&terms);
        }
        Some(orders)
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
