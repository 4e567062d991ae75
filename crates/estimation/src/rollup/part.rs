//! A part: what is stated of its mass, mass centre and inertia, and the law that draws come from.

#[cfg(feature = "serde")]
use gyradius_dispersion::FixedAttitude;
use gyradius_dispersion::{MassPropertiesModel, TenParameters};
use gyradius_inertia::{
    Inertia, InertiaMatrix, MassProperties, MassPropertiesError, RealizabilityError, Repair,
    RepairMethod,
};
use nalgebra::{SMatrix, UnitQuaternion, Vector3};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};
use std::borrow::Cow;

use super::finding::{PartFinding, products};
use super::first_order::{FirstOrder, TEN_UNITS};
use super::second_moment_law::{SecondMomentLaw, deviations_of, missed};
use super::symmetric::{Matrix6, Six, congruence, mapped};

/// How far below zero a second moment may lie, in traces of the inertia: files carry about six digits.
const ROUNDING: f64 = 1e-6;
/// Largest mass (kg), coordinate (m) and entry of the inertia (kg·m²), so that no draw leaves the range of floats.
const MOST: [f64; 3] = [1e30, 1e15, 1e60];
/// Smallest mass, kg.
const LEAST_MASS: f64 = 1e-30;
/// Largest deviation of a mass, in masses, and of the entries of an inertia, in its traces.
const MOST_RELATIVE_DEVIATION: f64 = 10.0;
/// Largest deviation of a coordinate, m.
const MOST_CENTRE_DEVIATION: f64 = 1e4;
/// An entry that moves by less than this share of the one that moves most is fixed: its correlations mean nothing.
const FIXED: f64 = 0.01;
/// A correlation of entries stated as independent that is worth a word.
const APART: f64 = 0.2;

/// What is stated of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartStatement {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Mass centre in the frame of the whole, m.
    pub mass_centre_m: [f64; 3],
    /// Inertia about the mass centre in the part's own axes, kg·m², products as tensor entries.
    pub inertia: InertiaMatrix,
    /// The rotation that takes the part's own axes to those of the whole.
    pub attitude: UnitQuaternion<f64>,
    /// Standard deviations of mass, mass centre (axes of the whole), I₁₁, I₂₂, I₃₃, I₁₂, I₁₃, I₂₃ (the part's own axes), all
    /// independent.
    pub deviations: [f64; 10],
    /// Whether the inertia is proportional to the mass, as that of a given shape is. The deviations of the inertia are
    /// then those at the nominal mass.
    pub inertia_follows_mass: bool,
}

/// A part of an assembly: a law of its mass properties.
///
/// Every draw is a body that could be built. The mass is lognormal, the mass centre Gaussian; the inertia is a Gaussian in
/// log-Cholesky coordinates of its second moments, relative to the nominal ones. All three have the stated means exactly; mass
/// and mass centre have the stated deviations exactly, and the inertia has them where a law of this kind does
/// ([`findings`](Self::findings) says where not).
#[derive(Clone, Debug, PartialEq, getset::Getters)]
pub struct AssemblyPart {
    /// What was stated.
    #[getset(get = "pub")]
    statement: PartStatement,
    /// The nominal body in the frame of the whole, and the covariance of its ten numbers as stated.
    #[getset(get = "pub")]
    first_order: FirstOrder,
    inertia: SecondMomentLaw,
    /// Mean and deviation of the logarithm of the mass in nominal masses.
    logarithm: [f64; 2],
    findings: Vec<PartFinding>,
}

impl AssemblyPart {
    /// Checks what is stated and finds the law.
    ///
    /// # Errors
    /// A number is not finite or out of range, a deviation negative, or the inertia no body's by more than rounding (10⁻⁶ of its
    /// trace).
    pub fn new(statement: PartStatement) -> Result<Self, PartError> {
        check(&statement)?;
        let mut findings = Vec::new();
        let own = body_of(&statement.inertia, &mut findings)?;
        let six: [f64; 6] = std::array::from_fn(|e| statement.deviations[4 + e]);
        let covariance = Matrix6::from_diagonal(&Six::from(six).map(|sigma| sigma * sigma));
        let inertia = SecondMomentLaw::new(&own, &covariance).ok_or(PartError::TooWide)?;
        judge(&mut findings, &inertia, &six);
        let relative = statement.deviations[0] / statement.mass_kg;
        if relative > 1.0 {
            findings.push(PartFinding::Mass { relative });
        }
        let centre = Vector3::from(statement.mass_centre_m);
        let turned = own.rotated(&statement.attitude)?;
        let nominal = MassProperties::new(statement.mass_kg, centre, turned)?;
        let first_order = as_stated(&statement, nominal, &covariance);
        let variance = libm::log1p(relative * relative);
        let logarithm = [-0.5 * variance, variance.sqrt()];
        Ok(Self { statement, first_order, inertia, logarithm, findings })
    }

    /// What of the stated deviations no body can have, or the law of the draws has not.
    #[must_use]
    pub fn findings(&self) -> &[PartFinding] {
        &self.findings
    }

    /// Whether draws differ: some deviation is stated. All draws of a part that does not vary are the same to the bit.
    #[must_use]
    pub fn varies(&self) -> bool {
        self.statement.deviations != [0.0; 10]
    }

    /// Whether ten independent Gaussian numbers with the stated means and deviations, drawn once, are a body's: what is
    /// commonly done instead.
    pub fn naive_draw_is_possible<R: Rng + ?Sized>(&self, rng: &mut R) -> bool {
        let mut normal = || -> f64 { StandardNormal.sample(rng) };
        let mass = self.statement.mass_kg + self.statement.deviations[0] * normal();
        let mean = self.inertia.mean().entries();
        let [a, b, c, d, e, f] =
            std::array::from_fn(|i| mean[i] + self.statement.deviations[4 + i] * normal());
        // Where the mass centre is does not matter.
        let ten = TenParameters::from_values([mass, 0.0, 0.0, 0.0, a, b, c, d, e, f]);
        ten.is_ok_and(|ten| ten.is_realizable())
    }

    /// A draw; none if it leaves the range of floats, which none within forty deviations does.
    fn try_draw<R: Rng + ?Sized>(&self, rng: &mut R) -> Option<MassProperties> {
        let mut normal = || -> f64 { StandardNormal.sample(rng) };
        let PartStatement { mass_kg, deviations, attitude, inertia_follows_mass, .. } =
            &self.statement;
        let [shift, spread] = self.logarithm;
        let factor = libm::exp(shift + spread * normal());
        let centre = Vector3::from_fn(|axis, _| {
            self.statement.mass_centre_m[axis] + deviations[1 + axis] * normal()
        });
        let mut inertia = self.inertia.sample(rng);
        if *attitude != UnitQuaternion::identity() {
            inertia = inertia.rotated(attitude).ok()?;
        }
        let mass = mass_kg * factor;
        if *inertia_follows_mass && factor != 1.0 {
            return MassProperties::new(*mass_kg, centre, inertia).ok()?.with_mass(mass).ok();
        }
        MassProperties::new(mass, centre, inertia).ok()
    }
}

gyradius_dispersion::written!(
    PartStatement,
    |part| {
        mass_kg: f64 = part.mass_kg,
        mass_centre_m: [f64; 3] = part.mass_centre_m,
        inertia_kg_m2: InertiaMatrix = part.inertia,
        axes: FixedAttitude = part.attitude.into(),
        deviations: [f64; 10] = part.deviations,
        inertia_follows_mass: bool = part.inertia_follows_mass,
    },
    {
        let (inertia, attitude) = (inertia_kg_m2, axes.attitude());
        let part = PartStatement {
            mass_kg,
            mass_centre_m,
            inertia,
            attitude,
            deviations,
            inertia_follows_mass,
        };
        check(&part)?;
        part
    }
);

gyradius_dispersion::written!(
    AssemblyPart,
    |part| { statement: PartStatement = part.statement, },
    AssemblyPart::new(statement)?
);

impl Distribution<MassProperties> for AssemblyPart {
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> MassProperties {
        loop {
            if let Some(body) = self.try_draw(rng) {
                return body;
            }
        }
    }
}

impl MassPropertiesModel for AssemblyPart {
    fn name(&self) -> Cow<'_, str> {
        "part".into()
    }

    fn draw(&self, rng: &mut dyn Rng) -> TenParameters {
        self.sample(rng).into()
    }

    fn is_realizable_by_construction(&self) -> bool {
        true
    }
}

/// Every number in range.
fn check(statement: &PartStatement) -> Result<(), PartError> {
    let PartStatement { mass_kg, mass_centre_m, inertia, deviations, .. } = statement;
    let [x, y, z] = *mass_centre_m;
    let [i11, i22, i33, i12, i13, i23] = inertia.entries();
    let values = [*mass_kg, x, y, z, i11, i22, i33, i12, i13, i23];
    let most = |i: usize| MOST[usize::from(i > 0) + usize::from(i > 3)];
    if !(*mass_kg >= LEAST_MASS && *mass_kg <= MOST[0]) {
        return Err(PartError::Mass { value: *mass_kg });
    }
    for i in 0..10 {
        if !(values[i].abs() <= most(i)) {
            let (field, unit) = (TenParameters::COLUMNS[i], TEN_UNITS[i]);
            return Err(PartError::Value { field, value: values[i], most: most(i), unit });
        }
        let value = deviations[i];
        let most = match i {
            0 => MOST_RELATIVE_DEVIATION * mass_kg,
            1..=3 => MOST_CENTRE_DEVIATION,
            // Of what has no inertia, there is a finding.
            _ if i11 + i22 + i33 > 0.0 => MOST_RELATIVE_DEVIATION * (i11 + i22 + i33),
            _ => most(i),
        };
        if !(value >= 0.0 && value <= most) {
            let (field, unit) = (TenParameters::COLUMNS[i], TEN_UNITS[i]);
            return Err(PartError::Deviation { field, value, most, unit });
        }
    }
    Ok(())
}

/// The body of a matrix, which rounding may have made impossible.
fn body_of(
    matrix: &InertiaMatrix,
    findings: &mut Vec<PartFinding>,
) -> Result<Inertia, RealizabilityError> {
    Inertia::try_from(*matrix).or_else(|error| {
        let axes = matrix.principal_axes();
        let (k, size) =
            (axes.second_moments(), axes.moments().iter().map(|i| i.abs()).sum::<f64>());
        if k.iter().any(|k| *k < -ROUNDING * size) {
            return Err(error);
        }
        let repair = Repair::new(matrix, RepairMethod::Nearest)?;
        findings.push(PartFinding::Rounded { relative_distance: repair.relative_distance() });
        Ok(*repair.inertia())
    })
}

/// What the law of the inertia has not of what is stated.
fn judge(findings: &mut Vec<PartFinding>, law: &SecondMomentLaw, stated: &[f64; 6]) {
    findings.extend(products(law.mean().as_inertia_matrix(), stated));
    let moved: Vec<(&'static str, f64, f64)> = missed(law.covariance(), stated)
        .map(|(e, found)| (InertiaMatrix::ENTRY_NAMES[e], stated[e], found))
        .collect();
    if !moved.is_empty() {
        if !law.is_possible() {
            findings.push(PartFinding::Flat { dimensions: law.rank() });
        }
        findings.push(PartFinding::Moved { entries: moved });
    }
    let found = deviations_of(law.covariance());
    // What hardly moves has nothing to be correlated with.
    let least = FIXED * found.iter().copied().fold(0.0, f64::max);
    let moves = |e: &usize| found[*e] > least;
    let pairs = (0..6).filter(moves).flat_map(|e| (0..e).filter(moves).map(move |f| (f, e)));
    let correlation = |(e, f): (usize, usize)| law.covariance()[(e, f)] / (found[e] * found[f]);
    let strongest = pairs
        .map(|pair| (pair, correlation(pair)))
        .filter(|(_, correlation)| correlation.abs() > APART)
        .max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()));
    if let Some(((e, f), correlation)) = strongest {
        let entries = [e, f].map(|entry| InertiaMatrix::ENTRY_NAMES[entry]);
        findings.push(PartFinding::Correlated { entries, correlation });
    }
}

/// The covariance of the ten as stated, in the axes of the whole.
fn as_stated(statement: &PartStatement, nominal: MassProperties, inertia: &Matrix6) -> FirstOrder {
    let mut covariance = SMatrix::<f64, 10, 10>::zeros();
    for i in 0..4 {
        covariance[(i, i)] = statement.deviations[i].powi(2);
    }
    let rotation = statement.attitude.to_rotation_matrix();
    let mut turned = mapped(&congruence(rotation.matrix()), inertia);
    if statement.inertia_follows_mass {
        let mut slope = Six::zeros();
        slope.copy_from_slice(&nominal.inertia().entries());
        slope /= statement.mass_kg;
        let variance = covariance[(0, 0)];
        turned += slope * slope.transpose() * variance;
        covariance.fixed_view_mut::<6, 1>(4, 0).copy_from(&(slope * variance));
        covariance.fixed_view_mut::<1, 6>(0, 4).copy_from(&(slope.transpose() * variance));
    }
    covariance.fixed_view_mut::<6, 6>(4, 4).copy_from(&turned);
    FirstOrder::new(nominal, covariance)
}

/// Why a part is refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PartError {
    /// The mass is not positive, or out of range.
    #[error("mass = {value:?} kg: it must lie between {LEAST_MASS:e} and {:e} kg", MOST[0])]
    Mass {
        /// The value, kg.
        value: f64,
    },
    /// A number is NaN, infinite or too large.
    #[error("{field} = {value:?} {unit}: it must be finite and at most {most:e} {unit}")]
    Value {
        /// Which of the ten.
        field: &'static str,
        /// The value.
        value: f64,
        /// The largest magnitude that is taken.
        most: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// A deviation is negative, NaN, infinite or too large.
    #[error(
        "standard deviation of {field} = {value:?} {unit}: it must lie between 0 and {most:e} {unit}"
    )]
    Deviation {
        /// Of which of the ten.
        field: &'static str,
        /// The value.
        value: f64,
        /// The largest that is taken.
        most: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// The inertia belongs to no body.
    #[error(transparent)]
    Inertia(#[from] RealizabilityError),
    /// The numbers together leave the range of floats.
    #[error(transparent)]
    MassProperties(#[from] MassPropertiesError),
    /// No law was found.
    #[error("the deviations of the inertia are so wide that no law of it was found")]
    TooWide,
}
