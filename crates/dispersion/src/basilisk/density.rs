//! The density of the entries under Basilisk's dispersion.

use gyradius_inertia::{InertiaMatrix, PrincipalAxes};
use nalgebra::UnitQuaternion;
use std::f64::consts::{PI, TAU};

use super::BasiliskDispersion;
use crate::density_of_entries::{Bounded, LN_ATTITUDES, in_orders, ln_density_of_labels};
use crate::ln_sum::ln_sum;
use crate::normal::{self, LN_ROOT_TAU};

/// Most whole turns to either side that an angle of the largest deviation, 2π, can have made.
const TURNS: usize = 9;

/// At θ = ±π/2, where the Euler angles are not unique, the density of attitudes is infinite, beside it large: cos θ is
/// known to rounding.
const LEAST_COSINE: f64 = f64::EPSILON;

impl BasiliskDispersion {
    /// The logarithm of the density of I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃ in kg·m², of matrices that no body has too.
    ///
    /// None where a deviation is zero, and where the bounds can be reached, because draws are then put on them with a
    /// probability above zero. None too where the nominal matrix has products of inertia: there is a density, but which
    /// rotations lead to a given matrix is known in closed form for a diagonal one alone, where they are those to its
    /// principal axes.
    ///
    /// Each of these rotations is made by two triples of Euler angles and by whole turns of each angle, with dω = |cos θ|
    /// dψ dθ dφ.
    #[must_use]
    pub fn ln_density(&self, inertia: &InertiaMatrix) -> Option<f64> {
        let (nominal, deviation) = (self.nominal.entries(), self.diagonal_deviation);
        let [low, high] = self.bounds;
        if !(deviation > 0.0 && self.angle_deviation > 0.0 && nominal[3..] == [0.0; 3]) {
            return None;
        }
        if normal::below(low / deviation) > 0.0 || normal::above(high / deviation) > 0.0 {
            return None;
        }
        let axes: PrincipalAxes = inertia.principal_axes();
        let ln_peak = -3.0 * (libm::log(deviation) + LN_ROOT_TAU);
        let ln_moments = in_orders(axes.moments(), |moments| {
            let square = |i: usize| {
                let z = (moments[i] - nominal[i]) / deviation;
                z * z
            };
            ln_peak - 0.5 * (square(0) + square(1) + square(2))
        });
        Some(ln_density_of_labels(
            &axes,
            ln_moments,
            // Two triples, all the turns, and the least cosine.
            Bounded {
                density: |q: &_| self.ln_haar_density(q),
                at_most: self.ln_angles() + 4.0 - libm::log(LEAST_COSINE),
            },
        ))
    }

    /// Of the attitude of the principal axes, R(q) = Cᵀ, normalised to one.
    fn ln_haar_density(&self, attitude: &UnitQuaternion<f64>) -> f64 {
        let r = attitude.to_rotation_matrix();
        let c = |i: usize, j: usize| r[(j, i)];
        let psi = libm::atan2(c(0, 1), c(0, 0));
        let cos = (c(0, 0) * c(0, 0) + c(0, 1) * c(0, 1)).sqrt().max(LEAST_COSINE);
        let theta = libm::atan2(-c(0, 2), cos);
        let phi = libm::atan2(c(1, 2), c(2, 2));
        // The other triple turns by π about the first axis and the third, and θ the other way round.
        let one = self.ln_angle(psi) + self.ln_angle(theta) + self.ln_angle(phi);
        let other = self.ln_angle(psi + PI) + self.ln_angle(PI - theta) + self.ln_angle(phi + PI);
        let both = ln_sum(&[one, other]);
        if both == f64::NEG_INFINITY { both } else { both + self.ln_angles() - libm::log(cos) }
    }

    /// ln of what the three angles' shares are to be multiplied by.
    fn ln_angles(&self) -> f64 {
        LN_ATTITUDES - 3.0 * (libm::log(self.angle_deviation) + LN_ROOT_TAU)
    }

    /// ln of the density of an angle, whole turns apart being one, over its value at the peak for small deviations.
    fn ln_angle(&self, angle: f64) -> f64 {
        let sigma = self.angle_deviation;
        let least = angle - TAU * (angle / TAU).round();
        // ln of what is n turns away is (2π)² n(n − 1)/(2σ²) or more below that of the least.
        let near = |n: &usize| (n * (n - 1)) as f64 <= 2.1 * sigma * sigma;
        let count = (1..=TURNS).filter(near).count();
        let mut terms = [f64::NEG_INFINITY; 2 * TURNS + 1];
        for (turn, term) in terms[..2 * count + 1].iter_mut().enumerate() {
            let z = (least + TAU * (turn as f64 - count as f64)) / sigma;
            *term = -0.5 * z * z;
        }
        ln_sum(&terms[..2 * count + 1])
    }
}
