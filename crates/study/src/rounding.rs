//! Whether numbers differ by more than rounding.

use gyradius_separation::{MovingBody, Separation, Settings};
use gyradius_statistics::Survey;

use crate::quantity::Quantity;

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
    payload: SizesOfBody,
    stage: SizesOfBody,
}

/// Those of what a body does. One body may be a million times the other.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SizesOfBody {
    rate_rad_per_s: f64,
    momentum_kg_m2_per_s: f64,
    rotation_j: f64,
    translation_j: f64,
}

impl SizesOfBody {
    const UNKNOWN: Self = Self {
        rate_rad_per_s: 0.0,
        momentum_kg_m2_per_s: 0.0,
        rotation_j: 0.0,
        translation_j: 0.0,
    };
}

impl Sizes {
    const UNKNOWN: Self =
        Self { velocity_m_per_s: 0.0, payload: SizesOfBody::UNKNOWN, stage: SizesOfBody::UNKNOWN };

    /// Of numbers of a column with a unit. An angle may be zero but for rounding, so that it is measured by a degree.
    fn of(&self, column: &str, unit: &str) -> f64 {
        let Self { velocity_m_per_s, payload, stage } = self;
        match Quantity::of_column(column) {
            Some(
                Quantity::RelativeSpeed
                | Quantity::RelativeVelocity1
                | Quantity::RelativeVelocity2
                | Quantity::RelativeVelocity3,
            ) => *velocity_m_per_s,
            Some(
                Quantity::PayloadRate1
                | Quantity::PayloadRate2
                | Quantity::PayloadRate3
                | Quantity::SpinRate,
            ) => payload.rate_rad_per_s,
            Some(
                Quantity::PayloadTipOff1 | Quantity::PayloadTipOff2 | Quantity::PayloadTipOff3,
            ) => payload.rate_rad_per_s.to_degrees(),
            Some(Quantity::StageTipOff1 | Quantity::StageTipOff2 | Quantity::StageTipOff3) => {
                stage.rate_rad_per_s.to_degrees()
            }
            Some(Quantity::Momentum1 | Quantity::Momentum2 | Quantity::Momentum3) => {
                payload.momentum_kg_m2_per_s
            }
            Some(Quantity::PayloadTranslation) => payload.translation_j,
            Some(Quantity::PayloadRotation) => payload.rotation_j,
            Some(Quantity::StageTranslation) => stage.translation_j,
            Some(Quantity::StageRotation) => stage.rotation_j,
            // What is drawn, lengths and times are no sums that cancel.
            Some(_) | None => f64::from(u8::from(unit == "deg")),
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
        let share = unknown.share;
        let left = |rounding: f64, size: f64| size.max(2.0 * rounding / share);
        let velocity_m_per_s = left(outcome.velocity_rounding(), outcome.relative_speed());
        let inverse_mass = |body: &MovingBody| body.body().mass_kg().recip();
        let reduced_mass =
            (inverse_mass(nominal.payload()) + inverse_mass(nominal.stage())).recip();
        let of_body = |place: usize, momentum_rounding: f64| {
            let states = [outcome.start(), [*outcome.payload(), *outcome.stage()]];
            let states = states.map(|state| state[place]);
            let largest = |of: fn(&MovingBody) -> f64| states.iter().map(of).fold(0.0, f64::max);
            let arms = nominal.loads().map(|(_, load)| load.points_m()[place].norm());
            // The loads' impulses go with their arms.
            let exchanged = arms.fold(0.0, f64::max) * outcome.velocity_rounding() * reduced_mass;
            let momentum = momentum_rounding.max(exchanged);
            let moments = states[0].body().inertia().principal_axes().moments();
            let (least, most) =
                moments.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), m| (a.min(*m), b.max(*m)));
            let spin = largest(|b| b.spin_angular_momentum().norm());
            let rate_rad_per_s =
                left(momentum / least, largest(|b| b.state().angular_velocity.norm()));
            // Of an energy I ω²/2, or μ²/m v²/2, so much is left as of ω, or v: I ω δω and the square of what is left.
            let in_motion = reduced_mass.powi(2) * inverse_mass(&states[0]);
            let speed = outcome.relative_speed() + share * velocity_m_per_s;
            SizesOfBody {
                rate_rad_per_s,
                momentum_kg_m2_per_s: left(momentum, spin),
                rotation_j: (spin + most * share * rate_rad_per_s) * rate_rad_per_s,
                translation_j: in_motion * speed * velocity_m_per_s,
            }
        };
        let payload = of_body(0, outcome.momentum_rounding());
        let sizes = Sizes { velocity_m_per_s, payload, stage: of_body(1, 0.0) };
        Self { sizes, ..unknown }
    }

    /// How large numbers of a column with a unit are taken to be, of which the largest is this.
    pub(crate) fn size(self, largest: f64, (column, unit): (&str, &str)) -> f64 {
        largest.abs().max(self.sizes.of(column, unit))
    }

    /// Whether numbers of a column with a unit, from a smallest to a largest one, differ by more than rounding.
    pub(crate) fn is_exceeded(self, minimum: f64, maximum: f64, of: (&str, &str)) -> bool {
        let size = self.size(minimum.abs().max(maximum.abs()), of);
        maximum / size - minimum / size > self.share
    }

    /// Whether the values of a quantity differ by more than rounding.
    pub(crate) fn is_exceeded_in(self, quantity: Quantity, values: &Survey) -> bool {
        let (column, unit) = (quantity.column(), quantity.unit());
        values
            .minimum()
            .zip(values.maximum())
            .is_some_and(|((least, _), (most, _))| self.is_exceeded(least, most, (&column, unit)))
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
            prop_assert_eq!(Rounding::OF_LAST_PLACES.is_exceeded(offset, end, ("x", "1")), units > 16.0);
            prop_assert!(!Rounding::OF_LAST_PLACES.is_exceeded(offset, offset.next_up(), ("x", "1")));
        }
    }
}
