//! What is to be said of a body in a file: of its inertia, and of the mass that it is said to have.

use gyradius_inertia::RealizabilityReport;
use nalgebra::Matrix3;

/// What is wrong with the mass of a body, whatever its inertia.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MassFault {
    /// Inertia without mass.
    #[error("inertia on a mass of 0 kg")]
    Zero,
    /// A mass below zero.
    #[error("mass = {0} kg: it must not be negative")]
    Negative(f64),
    /// A mass that is infinite or NaN.
    #[error("mass = {0} kg: it must be finite")]
    NotFinite(f64),
}

/// What is worth knowing, and no fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Note {
    /// No mass and no inertia: a frame.
    #[error("no mass and no inertia: a frame, not a body")]
    Massless,
    /// Mass without inertia.
    #[error("no inertia: a point mass, which resists no rotation")]
    PointMass,
    /// The other sign convention would do.
    #[error(
        "a body can have it with the signs of its products flipped, the commonest slip: \
         --repair=flip writes that"
    )]
    FlippedProducts,
}

/// The judgement of one body.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyJudgement {
    report: RealizabilityReport,
    mass_fault: Option<MassFault>,
    note: Option<Note>,
}

impl BodyJudgement {
    /// Whether some distribution of mass has this inertia, by what margin, and if none, why.
    #[must_use]
    pub fn report(&self) -> &RealizabilityReport {
        &self.report
    }

    /// What is wrong with the mass.
    #[must_use]
    pub fn mass_fault(&self) -> Option<MassFault> {
        self.mass_fault
    }

    /// What is worth knowing besides.
    #[must_use]
    pub fn note(&self) -> Option<Note> {
        self.note
    }

    /// Everything that is wrong, a sentence each: nothing if the body can exist.
    pub fn reasons(&self) -> impl Iterator<Item = String> {
        let faults = self.report.faults().iter().map(ToString::to_string);
        faults.chain(self.mass_fault.map(|fault| fault.to_string()))
    }
}

/// The same matrix in the other convention of the signs of products.
pub(crate) fn with_flipped_products(matrix: &Matrix3<f64>) -> Matrix3<f64> {
    matrix.map_with_location(|i, j, x| if i == j || x == 0.0 { x } else { -x })
}

/// Judges an inertia about the mass centre, products as tensor entries, at a tolerance as a share of
/// its trace (see [`RealizabilityReport::within`]), and the mass beside it, if there is one.
#[must_use]
pub fn judge(matrix: &Matrix3<f64>, mass_kg: Option<f64>, tolerance: f64) -> BodyJudgement {
    let report = RealizabilityReport::within(matrix, tolerance);
    let no_inertia = *matrix == Matrix3::zeros();
    let mass_fault = match mass_kg {
        Some(mass) if !mass.is_finite() => Some(MassFault::NotFinite(mass)),
        Some(mass) if mass < 0.0 => Some(MassFault::Negative(mass)),
        Some(mass) if mass == 0.0 && !no_inertia => Some(MassFault::Zero),
        Some(_) | None => None,
    };
    let note = match mass_kg {
        _ if !report.is_realizable() => {
            RealizabilityReport::within(&with_flipped_products(matrix), tolerance)
                .is_realizable()
                .then_some(Note::FlippedProducts)
        }
        Some(mass) if no_inertia && mass > 0.0 && mass.is_finite() => Some(Note::PointMass),
        Some(mass) if no_inertia && mass == 0.0 => Some(Note::Massless),
        Some(_) | None => None,
    };
    BodyJudgement { report, mass_fault, note }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use proptest::prelude::*;

    fn diagonal(d: [f64; 3]) -> Matrix3<f64> {
        Matrix3::from_diagonal(&d.into())
    }

    fn is_possible(matrix: &Matrix3<f64>, tolerance: f64) -> bool {
        judge(matrix, None, tolerance).report().is_realizable()
    }

    #[test]
    fn plates_printed_with_six_digits_are_realizable_and_worse_is_not() {
        assert!(is_possible(&diagonal([0.333333, 0.666666, 1.0]), 1e-6));
        assert!(!is_possible(&diagonal([0.3333, 0.6666, 1.0]), 1e-6));
        assert!(!is_possible(&diagonal([0.333333, 0.666666, 1.0]), 0.0));
    }

    /// Rods and plates in directions that fill the sphere evenly, of sizes that fill a decade: few lie beyond 1e-6, and none
    /// beyond 3e-6.
    #[test]
    fn six_digits_put_few_plates_and_rods_beyond_the_tolerance() {
        const N: u32 = 20_000;
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let six_digits = |x: f64| format!("{x:.5e}").parse::<f64>().unwrap();
        let (mut rods, mut plates) = (0, 0);
        for i in 0..N {
            let part = |step: f64| (f64::from(i) * step).fract();
            let z = 2.0 * (f64::from(i) + 0.5) / f64::from(N) - 1.0;
            let (sin, cos) = (std::f64::consts::TAU * part(GOLDEN)).sin_cos();
            let across = (1.0 - z * z).sqrt();
            let a = Vector3::new(across * cos, across * sin, z);
            let b = a.cross(&Vector3::new(sin, -cos, 0.3)).normalize();
            let size = 10_f64.powf(part(std::f64::consts::SQRT_2));
            let ratio = part(std::f64::consts::E);
            let printed =
                |sigma: Matrix3<f64>| (Matrix3::identity() * sigma.trace() - sigma).map(six_digits);
            let rod = printed(a * a.transpose() * size);
            let plate = printed((a * a.transpose() + b * b.transpose() * ratio) * size);
            rods += u32::from(!is_possible(&rod, 1e-6));
            plates += u32::from(!is_possible(&plate, 1e-6));
            assert!(is_possible(&rod, 3e-6) && is_possible(&plate, 3e-6), "{rod} {plate}");
        }
        let share = |count: u32| f64::from(count) / f64::from(N);
        assert!((share(rods) - 1.0 / 36.0).abs() < 0.003, "{}", share(rods));
        assert!(share(plates) < 0.004, "{}", share(plates));
    }

    #[test]
    fn masses_are_judged_apart() {
        let with = |matrix: Matrix3<f64>, mass| judge(&matrix, Some(mass), 1e-6);
        let judgement = with(diagonal([1.0; 3]), 0.0);
        assert_eq!(judgement.mass_fault(), Some(MassFault::Zero));
        assert!(judgement.report().is_realizable());
        let negative = with(diagonal([1.0; 3]), -1.0);
        assert_eq!(negative.mass_fault(), Some(MassFault::Negative(-1.0)));
        for mass in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
            for matrix in [diagonal([1.0; 3]), Matrix3::zeros()] {
                let judgement = with(matrix, mass);
                let said = format!("mass = {mass} kg: it must be finite");
                assert_eq!(judgement.reasons().collect::<Vec<_>>(), [said]);
                assert_eq!(judgement.note(), None);
            }
        }
        assert_eq!(with(Matrix3::zeros(), -1.0).mass_fault(), Some(MassFault::Negative(-1.0)));
        assert_eq!(with(Matrix3::zeros(), 0.0).note(), Some(Note::Massless));
        assert_eq!(with(Matrix3::zeros(), 1.0).note(), Some(Note::PointMass));
        assert_eq!(with(Matrix3::zeros(), 1.0).mass_fault(), None);
        assert_eq!(judge(&Matrix3::zeros(), None, 1e-6).note(), None, "the mass is not known");
        let both = with(diagonal([1.0, 1.0, 3.0]), 0.0);
        assert_eq!(both.reasons().count(), 2, "one says nothing of the other");
    }

    #[test]
    fn a_wrong_sign_convention_is_noticed() {
        // A rod along (1, 1, 1): Σ = x xᵀ, all products −1 as tensor entries.
        let rod = Matrix3::new(2.0, -1.0, -1.0, -1.0, 2.0, -1.0, -1.0, -1.0, 2.0);
        assert!(is_possible(&rod, 1e-6));
        let flipped = judge(&rod.map(f64::abs), None, 1e-6);
        assert!(!flipped.report().is_realizable());
        assert_eq!(flipped.note(), Some(Note::FlippedProducts));
    }

    proptest! {
        #[test]
        fn nothing_panics(
            nine in prop::array::uniform9(prop::num::f64::ANY),
            mass in prop::num::f64::ANY,
        ) {
            let judgement = judge(&Matrix3::from_row_slice(&nine), Some(mass), 1e-6);
            let possible = (0.0..=f64::MAX).contains(&mass);
            prop_assert!(possible || judgement.mass_fault().is_some(), "{mass}");
            prop_assert!(judgement.report().is_realizable() || judgement.reasons().count() > 0);
        }
    }
}
