//! Whether numbers differ by more than rounding.

use gyradius_separation::{MovingBody, Separation, Settings};

/// A share of the numbers, below which a spread is rounding: of numbers that are found in as many steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rounding {
    share: f64,
    sizes: Sizes,
}

/// How large numbers are at least whose share is taken, for all that they are sums of may cancel; zero where nothing is known of that.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sizes {
    velocity_m_per_s: f64,
    rate_rad_per_s: f64,
    momentum_kg_m2_per_s: f64,
    energy_j: f64,
}

impl Sizes {
    const UNKNOWN: Self = Self {
        velocity_m_per_s: 0.0,
        rate_rad_per_s: 0.0,
        momentum_kg_m2_per_s: 0.0,
        energy_j: 0.0,
    };

    /// Of numbers of a unit. An angle may be zero but for rounding, so that it is measured by a degree.
    fn of(&self, unit: &str) -> f64 {
        match unit {
            "deg" => 1.0,
            "m/s" => self.velocity_m_per_s,
            "rad/s" => self.rate_rad_per_s,
            "deg/s" => self.rate_rad_per_s.to_degrees(),
            "kg·m²/s" => self.momentum_kg_m2_per_s,
            "J" => self.energy_j,
            // What is drawn, lengths and times are no sums that cancel.
            _ => 0.0,
        }
    }
}

impl Rounding {
    /// Of what comes of separations, which are integrated, but for what may cancel.
    pub(crate) const OF_SEPARATIONS: Self = Self { share: 1e-11, sizes: Sizes::UNKNOWN };
    /// Of what a simulator answers, or a law draws: some units in the last place. Beside an offset, such as a date in seconds, small
    /// differences may be all that matters, and nobody but the simulator knows.
    pub(crate) const OF_LAST_PLACES: Self =
        Self { share: 16.0 * f64::EPSILON, sizes: Sizes::UNKNOWN };

    /// Of what comes of separations that differ from this one by what is drawn. Springs in symmetry leave of a rate what they gave
    /// and took again, to rounding: numbers are measured by what this separation leaves and by what its own arithmetic can leave of
    /// them, which two runs may have with either sign. If it fails, that is not known.
    pub(crate) fn of_separations(nominal: &Separation, settings: &Settings) -> Self {
        let unknown = Self::OF_SEPARATIONS;
        let Ok(outcome) = nominal.run(settings) else { return unknown };
        let bodies = [nominal.payload(), nominal.stage()];
        let points = nominal.loads().flat_map(|(_, load)| load.points_m());
        let arm = points.map(|point| point.norm()).fold(0.0, f64::max);
        let inverse_mass: f64 = bodies.iter().map(|body| body.body().mass_kg().recip()).sum();
        let momentum =
            outcome.momentum_rounding().max(arm * outcome.velocity_rounding() / inverse_mass);
        let moments = bodies.map(|body| body.body().inertia().principal_axes().moments());
        let least = moments.as_flattened().iter().copied().fold(f64::INFINITY, f64::min);
        let states = [outcome.start(), [*outcome.payload(), *outcome.stage()]];
        let largest =
            |of: fn(&MovingBody) -> f64| states.as_flattened().iter().map(of).fold(0.0, f64::max);
        let left = |rounding: f64, size: f64| size.max(2.0 * rounding / unknown.share);
        let sizes = Sizes {
            velocity_m_per_s: left(outcome.velocity_rounding(), outcome.relative_speed()),
            rate_rad_per_s: left(momentum / least, largest(|b| b.state().angular_velocity.norm())),
            momentum_kg_m2_per_s: left(momentum, largest(|b| b.spin_angular_momentum().norm())),
            energy_j: nominal.stored_energy().max(largest(MovingBody::rotational_energy)),
        };
        Self { sizes, ..unknown }
    }

    /// How large numbers of a unit are taken to be, of which the largest is this.
    pub(crate) fn size(self, largest: f64, unit: &str) -> f64 {
        largest.abs().max(self.sizes.of(unit))
    }

    /// Whether numbers of a unit from a smallest to a largest one differ by more than rounding.
    pub(crate) fn is_exceeded(self, minimum: f64, maximum: f64, unit: &str) -> bool {
        let size = self.size(minimum.abs().max(maximum.abs()), unit);
        maximum / size - minimum / size > self.share
    }

    /// Whether a standard deviation is more than rounding of numbers of this size.
    pub(crate) fn is_exceeded_by(self, deviation: f64, size: f64) -> bool {
        deviation > self.share * size
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Whatever the offset: what differs by more than some units in the last place varies, and what differs by one does not.
        #[test]
        fn offsets_hide_nothing_of_a_simulator(offset in -1e12..1e12_f64, spread in -8..8_i32) {
            let spread = 10_f64.powi(spread);
            let end = offset + spread;
            let units = (end - offset).abs() / (offset.abs().max(end.abs()) * f64::EPSILON);
            prop_assume!((units - 16.0).abs() > 2.0);
            prop_assert_eq!(Rounding::OF_LAST_PLACES.is_exceeded(offset, end, "1"), units > 16.0);
            prop_assert!(!Rounding::OF_LAST_PLACES.is_exceeded(offset, offset.next_up(), "1"));
        }
    }
}
