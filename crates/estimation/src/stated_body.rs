//! Mass, mass centre and inertia of a body together, from plain statements about nominal ones.

use gyradius_dispersion::ScalarLaw;
use gyradius_inertia::{Inertia, MassProperties};
use nalgebra::Vector3;
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::{StatedModel, StatementError, StatementWarning, Statements};

/// The lightest body that is drawn, over the nominal mass.
const LIGHTEST: f64 = 1e-3;

/// The joint law of mass, mass centre and inertia that statements make about a nominal body.
///
/// # Definition
/// * The mass is normal about the nominal one, kept above a thousandth of it.
/// * The mass centre is normal along each body axis, independent of all else. The inertia is that about the drawn mass
///   centre, so nothing is added to it for the centre.
/// * The inertia at the nominal mass has the law of [`Statements::model`], and is multiplied by what the mass makes
///   of it, 1 + α(m/m₀ − 1) ([`StatedMass::factor`](crate::StatedMass::factor)).
///
/// Four normal scores are drawn first, of the mass and of the mass centre, whether they are stated or not: a statement
/// more does not change what the others draw.
///
/// # Realizability
/// By construction: a mass above zero, any mass centre, and an inertia that some body has.
///
/// ```
/// use gyradius_estimation::{MassStatement, StatedBody, Statements};
/// use gyradius_inertia::Shape;
/// use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
/// use rand_distr::Distribution;
///
/// let nominal = Shape::sphere(0.1)?.of_mass(2.0)?;
/// let statements = Statements { mass: Some(MassStatement::percent(10.0, 1.0)?), ..Statements::default() };
/// let drawn = StatedBody::new(&statements, &nominal)?.sample(&mut ChaCha8Rng::seed_from_u64(1));
/// let [ratio, moments] = [drawn.mass_kg() / 2.0, drawn.inertia().entries()[0] / nominal.inertia().entries()[0]];
/// assert!((moments - ratio).abs() < 1e-12, "the inertia follows the mass");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct StatedBody {
    nominal: MassProperties,
    mass: Option<ScalarLaw>,
    centre: [f64; 3],
    /// Nothing where the inertia does no more than follow the mass.
    model: Option<StatedModel>,
}

impl StatedBody {
    /// The law of these statements about a nominal body.
    ///
    /// # Errors
    /// The nominal body is out of range, or the statements are refused.
    pub fn new(statements: &Statements, nominal: &MassProperties) -> Result<Self, StatementError> {
        let kilograms = nominal.mass_kg();
        if !(1e-30..=1e30).contains(&kilograms) {
            return Err(StatementError::Mass { value: kilograms });
        }
        let inertia = nominal.inertia();
        let is_point = inertia.matrix().trace() == 0.0;
        let spoken = statements.moments.is_some()
            || statements.products.is_some()
            || statements.axes.is_some();
        let centre = statements.centre.map_or([0.0; 3], |centre| centre.deviations());
        let of_inertia = Statements { centre: None, ..*statements };
        let model = (spoken && !is_point)
            .then(|| of_inertia.model(inertia, Some(kilograms)))
            .transpose()?;
        let relative = statements.mass.map(|mass| mass.relative(Some(kilograms))).transpose()?;
        let mass = relative.filter(|relative| *relative > 0.0).map(|relative| {
            let law = ScalarLaw::truncated_normal(1.0, relative, LIGHTEST, f64::INFINITY);
            law.map_err(|error| StatementError::Law { problem: error.to_string() })
        });
        Ok(Self { nominal: *nominal, mass: mass.transpose()?, centre, model })
    }

    /// The nominal body.
    #[must_use]
    pub fn nominal(&self) -> &MassProperties {
        &self.nominal
    }

    /// The law of the inertia, where more is stated of it than that it follows the mass.
    #[must_use]
    pub fn model(&self) -> Option<&StatedModel> {
        self.model.as_ref()
    }

    /// Contradictions, and what has been left open.
    #[must_use]
    pub fn warnings(&self) -> &[StatementWarning] {
        self.model.as_ref().map_or(&[], StatedModel::warnings)
    }
}

impl Distribution<MassProperties> for StatedBody {
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> MassProperties {
        let mut score = || -> f64 { StandardNormal.sample(rng) };
        let [of_mass, x, y, z] = [score(), score(), score(), score()];
        let ratio = self.mass.as_ref().map_or(1.0, |law| law.at_score(of_mass));
        let centre = self.nominal.mass_centre_m()
            + Vector3::from(self.centre).component_mul(&Vector3::new(x, y, z));
        let (inertia, factor): (Inertia, f64) = match &self.model {
            Some(model) => (
                model.law_at_nominal_mass().sample(rng),
                model.mass().map_or(1.0, |mass| mass.factor(ratio)),
            ),
            None => (*self.nominal.inertia(), ratio),
        };
        let mass = self.nominal.mass_kg() * ratio;
        let drawn = MassProperties::new(mass, centre, inertia);
        let scaled = |drawn: MassProperties| {
            let scaled = if factor == 1.0 { drawn } else { drawn.scaled_density(factor)? };
            MassProperties::new(mass, centre, *scaled.inertia())
        };
        // Mass and trace are in a range in which no factor that is drawn loses digits: there is always a body.
        drawn.and_then(scaled).unwrap_or(self.nominal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Amount, AxesStatement, CentreStatement, MassStatement, MomentsStatement};
    use gyradius_inertia::{InertiaMatrix, SecondMoments};
    use nalgebra::{Quaternion, UnitQuaternion};
    use proptest::{prelude::*, sample::select};
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    /// Any subset of statements.
    fn statements(which: u8, [mass, moments, axes, metres]: [f64; 4]) -> Statements {
        let is = |bit: u8| which & bit != 0;
        Statements {
            mass: is(1).then(|| MassStatement::percent(mass, 1.0).unwrap()),
            moments: is(2)
                .then(|| MomentsStatement::new(Amount::Percent([moments; 3]), 1.0).unwrap()),
            axes: is(4).then(|| AxesStatement::each([axes; 3], 1.0).unwrap()),
            centre: is(8).then(|| CentreStatement::new([metres; 3], 1.0, [0.0; 3]).unwrap()),
            products: None,
        }
    }

    fn body() -> impl Strategy<Value = MassProperties> {
        let second = prop::array::uniform3(select(vec![0.0, 0.2, 1.0, 1.0, 1.3, 3.0]));
        let axes = select(vec![[1.0, 0.0, 0.0, 0.0], [0.9, 0.1, -0.3, 0.2], [0.5, 0.5, 0.5, 0.5]]);
        (1e-4..1e3_f64, second, -9.0..4.0_f64, axes).prop_map(
            |(mass, second, size, [w, x, y, z])| {
                let moments = second.map(|k| k * 10_f64.powf(size));
                let axes = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
                let inertia =
                    Inertia::from_second_moments(SecondMoments::new(moments).unwrap(), &axes)
                        .unwrap();
                MassProperties::new(mass, Vector3::new(0.1, -0.2, 0.3), inertia).unwrap()
            },
        )
    }

    /// Standard deviations of mass and centre, and of the moments, over 2,000 draws.
    fn deviations(law: &StatedBody) -> ([f64; 4], [f64; 3]) {
        let draws: Vec<[f64; 7]> = (0..2000)
            .map(|seed| {
                let drawn = law.sample(&mut ChaCha8Rng::seed_from_u64(seed));
                let [c1, c2, c3]: [f64; 3] = drawn.mass_centre_m().into();
                let [i1, i2, i3, ..] = drawn.inertia().entries();
                [drawn.mass_kg(), c1, c2, c3, i1, i2, i3]
            })
            .collect();
        let n = draws.len() as f64;
        let deviation = |i: usize| {
            let mean = draws.iter().map(|draw| draw[i]).sum::<f64>() / n;
            (draws.iter().map(|draw| (draw[i] - mean).powi(2)).sum::<f64>() / n).sqrt()
        };
        (std::array::from_fn(deviation), std::array::from_fn(|i| deviation(4 + i)))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]

        /// Rods, plates, balls and points too: what comes out is what is stated, or there is a warning.
        #[test]
        fn draws_have_the_deviations_that_are_stated(
            nominal in body(),
            which in 0..16_u8,
            sizes in (1.0..12.0_f64, 1.0..15.0_f64, 0.5..6.0_f64, 1e-4..0.1_f64),
        ) {
            let sizes = [sizes.0, sizes.1, sizes.2, sizes.3];
            let said = statements(which, sizes);
            let law = StatedBody::new(&said, &nominal).unwrap();
            let ([mass, centre @ ..], moments) = deviations(&law);
            let [percent, of_moments, _, metres] = sizes;
            let near = |x: f64, y: f64| (x - y).abs() <= 0.08 * y + 1e-12;
            let stated = if said.mass.is_some() { 0.01 * percent } else { 0.0 };
            prop_assert!(near(mass / nominal.mass_kg(), stated), "{mass} {stated}");
            let stated = if said.centre.is_some() { metres } else { 0.0 };
            prop_assert!(centre.iter().all(|c| near(*c, stated)), "{centre:?} {stated}");
            if said.moments.is_some() && law.warnings().is_empty() {
                for (i, moment) in moments.iter().enumerate() {
                    let entry = nominal.inertia().entries()[i];
                    prop_assert!(near(*moment, 0.01 * of_moments * entry), "{i}: {moments:?}");
                }
            }
        }
    }

    /// What is drawn of one thing does not depend on what is stated of another, but for the inertia that follows.
    #[test]
    fn a_statement_more_changes_no_other_draw() {
        let matrix = InertiaMatrix::from_entries([0.4, 0.5, 0.7], [0.01, -0.02, 0.0]).unwrap();
        let inertia = Inertia::try_from(matrix).unwrap();
        let nominal = MassProperties::new(12.5, Vector3::x(), inertia).unwrap();
        let sizes = [10.0, 15.0, 5.0, 0.005];
        let drawn = |which| {
            let law = StatedBody::new(&statements(which, sizes), &nominal).unwrap();
            law.sample(&mut ChaCha8Rng::seed_from_u64(3))
        };
        for which in 0..16 {
            let one = drawn(which);
            let expected = if which & 1 == 1 { drawn(1).mass_kg() } else { 12.5 };
            assert_eq!(one.mass_kg(), expected);
            let centre = if which & 8 == 8 { drawn(8).mass_centre_m() } else { Vector3::x() };
            assert_eq!(one.mass_centre_m(), centre);
            assert_eq!(one.inertia(), drawn(which & 7).inertia());
        }
    }
}
