//! Mass, mass centre and inertia of a body together, from plain statements about nominal ones.

use gyradius_dispersion::{
    FixedAttitude, MassPropertiesLaw, MassPropertiesLawError, PrincipalDispersion, RootMoments,
    ScalarLaw, TensorLaw, Wishart,
};
use gyradius_inertia::{MassProperties, Region};
use rand::Rng;
use rand_distr::Distribution;

use crate::{StatedModel, StatementError, StatementWarning, Statements, statements::MASSES_KG};

/// The joint law of mass, mass centre and inertia that statements make about a nominal body.
///
/// # Definition
/// A [`MassPropertiesLaw`]:
/// * The mass is normal about the nominal one; where it scatters by more than an eighth, lognormal with the nominal one as
///   its mean ([`ScalarLaw::positive`]).
/// * The mass centre is normal along each body axis, independent of all else. The inertia is that about the drawn mass
///   centre, so nothing is added to it for the centre.
/// * The inertia at the nominal mass has the law of [`Statements::model`], with fixed axes if none of them scatter and as it is
///   if nothing of it scatters, and is multiplied by what the mass makes of it, 1 + α(m/m₀ − 1) ([`StatedMass::factor`](crate::StatedMass::factor)).
///
/// A statement more does not change what the others draw.
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
#[derive(Clone, Debug, PartialEq, getset::Getters)]
#[getset(get = "pub")]
pub struct StatedBody {
    /// The nominal body.
    nominal: MassProperties,
    /// The joint law.
    law: MassPropertiesLaw,
    /// Nothing where the inertia does no more than follow the mass.
    #[getset(skip)]
    model: Option<StatedModel>,
    /// Of what is stated of the inertia of a point, which no model is made of.
    #[getset(skip)]
    of_point: Option<StatementWarning>,
}

impl StatedBody {
    /// The law of these statements about a nominal body.
    ///
    /// # Errors
    /// The nominal body is out of range, or the statements are refused: an arm of the mass centre, which has no meaning here, and a
    /// standard deviation that is beyond this body, more than its mass, or of moments and products more than ten times the trace of its
    /// inertia.
    pub fn new(statements: &Statements, nominal: &MassProperties) -> Result<Self, StatementError> {
        let kilograms = nominal.mass_kg();
        if !MASSES_KG.contains(&kilograms) {
            return Err(StatementError::Mass { value: kilograms });
        }
        if let Some(arm) = statements.centre.and_then(|centre| centre.arm()) {
            return Err(StatementError::ArmBesideCentre { arm });
        }
        let inertia = nominal.inertia();
        statements.within(inertia, Some(kilograms))?;
        let is_point = inertia.matrix().trace() == 0.0;
        let spoken = statements.moments.is_some()
            || statements.products.is_some()
            || statements.axes.is_some();
        let of_inertia = Statements { centre: None, ..*statements };
        let model = (spoken && !is_point)
            .then(|| of_inertia.model(inertia, Some(kilograms)))
            .transpose()?;
        let relative = statements.mass.map(|mass| mass.relative(Some(kilograms))).transpose()?;
        let centre = statements.centre.map_or([0.0; 3], |centre| centre.deviations());
        let law = Self::law_of(nominal, relative.unwrap_or(0.0), centre, model.as_ref())
            .map_err(|error| StatementError::Law { problem: error.to_string() })?;
        let of_point = (spoken && is_point).then_some(StatementWarning::Point);
        Ok(Self { nominal: *nominal, law, model, of_point })
    }

    /// The law of a model that statements have made, with the mass and the mass centre that were stated with it, about a
    /// nominal body. What an uncertain mass centre adds to an inertia that was measured about another point is in the
    /// model; the mass centre itself is drawn independently.
    ///
    /// # Errors
    /// Numbers at the ends of the range of floats.
    pub fn of(model: StatedModel, nominal: &MassProperties) -> Result<Self, StatementError> {
        let relative = model.mass().map_or(0.0, |mass| mass.relative_deviation());
        let centre = model.centre_deviations().unwrap_or_default();
        let law = Self::law_of(nominal, relative, centre, Some(&model))
            .map_err(|error| StatementError::Law { problem: error.to_string() })?;
        Ok(Self { nominal: *nominal, law, model: Some(model), of_point: None })
    }

    fn law_of(
        nominal: &MassProperties,
        relative: f64,
        centre: [f64; 3],
        model: Option<&StatedModel>,
    ) -> Result<MassPropertiesLaw, MassPropertiesLawError> {
        let kilograms = nominal.mass_kg();
        let mass = ScalarLaw::positive(kilograms, relative * kilograms);
        let at = nominal.mass_centre_m();
        let of_axis = |i: usize| ScalarLaw::normal(at[i], centre[i]);
        let share = match model {
            Some(model) => model.mass().map_or(0.0, |mass| mass.inertia_follows()),
            None => 1.0,
        };
        let tensor = Self::tensor_of(nominal, model)?.with_follows(share, kilograms)?;
        MassPropertiesLaw::new(mass?, [of_axis(0)?, of_axis(1)?, of_axis(2)?], tensor)
    }

    /// The law of the inertia at the nominal mass. That of a model with axes that do not scatter has them turn by 2e-6 rad,
    /// for it must have a density; here they are fixed.
    fn tensor_of(
        nominal: &MassProperties,
        model: Option<&StatedModel>,
    ) -> Result<TensorLaw, MassPropertiesLawError> {
        if let Some(model) = model {
            let law = model.law_at_nominal_mass();
            if model.turns() != [0.0; 3] {
                return Ok(TensorLaw::model(law.clone())?);
            }
            let roots = law.roots().clone();
            if roots.second_moment_statistics().covariance().amax() > 0.0 {
                let axes = FixedAttitude::new(model.nominal().principal_axes().attitude());
                return Ok(TensorLaw::model(PrincipalDispersion::new(roots, axes))?);
            }
        }
        // A law without scatter gives the inertia to the bit.
        let still = Wishart::new(*nominal.inertia(), 0.0);
        let still = still.map_err(|_| MassPropertiesLawError::NoBodies { bodies: 0 })?;
        Ok(TensorLaw::model(still)?)
    }

    /// The same with draws of which the matter can lie in a region.
    ///
    /// # Errors
    /// The law has a region already, or next to no draw is possible in the region.
    pub fn inside(self, region: Region) -> Result<Self, StatementError> {
        let law = self.law.inside(region);
        let law = law.map_err(|error| StatementError::Law { problem: error.to_string() })?;
        Ok(Self { law, ..self })
    }

    /// The law of the inertia, where more is stated of it than that it follows the mass.
    #[must_use]
    pub fn model(&self) -> Option<&StatedModel> {
        self.model.as_ref()
    }

    /// Contradictions, and what has been left open.
    #[must_use]
    pub fn warnings(&self) -> &[StatementWarning] {
        self.model.as_ref().map_or(self.of_point.as_slice(), StatedModel::warnings)
    }
}

impl Distribution<MassProperties> for StatedBody {
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> MassProperties {
        self.law.sample(rng)
    }
}

gyradius_dispersion::written!(
    StatedBody,
    |body| {
        nominal: MassProperties = body.nominal,
        law: MassPropertiesLaw = body.law.clone(),
        model: Option<StatedModel> = body.model.clone(),
        #[serde(default, skip_serializing_if = "Option::is_none")]
        of_point: Option<StatementWarning> = body.of_point,
    },
    StatedBody { nominal, law, model, of_point }
);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Amount, AxesStatement, CentreStatement, MassStatement, MomentsStatement, ProductsStatement,
    };
    use gyradius_inertia::{Inertia, InertiaMatrix, SecondMoments, Shape};
    use nalgebra::{Quaternion, UnitQuaternion, Vector3};
    use proptest::{prelude::*, sample::select};
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

    /// An arm says where an inertia was measured, and here it is about the mass centre as drawn.
    #[test]
    fn an_arm_is_refused() {
        let nominal = Shape::sphere(0.1).unwrap().of_mass(2.0).unwrap();
        let of = |arm: [f64; 3]| {
            let centre = Some(CentreStatement::new([0.01; 3], 1.0, arm).unwrap());
            StatedBody::new(&Statements { centre, ..Statements::default() }, &nominal)
        };
        let error = of([0.0, 0.0, 1.5]).unwrap_err();
        assert_eq!(error, StatementError::ArmBesideCentre { arm: [0.0, 0.0, 1.5] });
        let text = error.to_string();
        assert!(text.starts_with("centre.arm_m = [0.0, 0.0, 1.5]: it must be left out"), "{text}");
        assert!(!text.contains("  "), "{text}");
        assert!(of([0.0; 3]).is_ok());
    }

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
        let second = prop_oneof![
            4 => prop::array::uniform3(select(vec![0.0, 0.2, 1.0, 1.0, 1.3, 3.0])),
            1 => select(vec![[0.0; 3], [1.0; 3]]),
        ];
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
            for warning in law.warnings() {
                let text = warning.to_string();
                prop_assert!(!text.contains("inf") && !text.contains("NaN"), "{text}");
            }
            // What has no effect is told, and nothing else is said to have none.
            let trace = nominal.inertia().matrix().trace();
            let says = |told| law.warnings().contains(&told);
            let of_inertia = said.moments.is_some() || said.axes.is_some();
            prop_assert_eq!(says(StatementWarning::Point), of_inertia && trace == 0.0);
            let [a, b, c] = nominal.inertia().principal_axes().moments();
            let is_ball = trace > 0.0 && a.max(b).max(c) - a.min(b).min(c) < 1e-9 * trace;
            let unturned = said.axes.is_some() && said.moments.is_none() && is_ball;
            prop_assert_eq!(says(StatementWarning::AxesWithoutEffect), unturned);
            let ([mass, centre @ ..], moments) = deviations(&law);
            let [percent, of_moments, _, metres] = sizes;
            let near = |x: f64, y: f64| (x - y).abs() <= 0.08 * y + 1e-12;
            let stated = if said.mass.is_some() { 0.01 * percent } else { 0.0 };
            prop_assert!(near(mass / nominal.mass_kg(), stated), "{mass} {stated}");
            let stated = if said.centre.is_some() { metres } else { 0.0 };
            prop_assert!(centre.iter().all(|c| near(*c, stated)), "{centre:?} {stated}");
            if of_inertia && trace == 0.0 || unturned && said.mass.is_none() {
                prop_assert!(moments.iter().all(|moment| *moment <= 1e-12 * trace), "{moments:?}");
            }
            if said.moments.is_some() && law.warnings().is_empty() {
                for (i, moment) in moments.iter().enumerate() {
                    let entry = nominal.inertia().entries()[i];
                    prop_assert!(near(*moment, 0.01 * of_moments * entry), "{i}: {moments:?}");
                }
            }
        }
    }

    proptest! {
        /// However wide: the law has the mean and the deviation that are stated, and so have its draws.
        #[test]
        fn a_wide_mass_is_as_stated(nominal in body(), percent in 0.1..100.0_f64) {
            let mass = Some(MassStatement::percent(percent, 1.0).unwrap());
            let law = StatedBody::new(&Statements { mass, ..Statements::default() }, &nominal).unwrap();
            let kilograms = nominal.mass_kg();
            let near = |x: f64, y: f64| (x - y).abs() <= 1e-12 * y;
            prop_assert!(near(law.law().mass().mean(), kilograms));
            prop_assert!(near(law.law().mass().deviation(), 0.01 * percent * kilograms));
        }
    }

    proptest! {
        /// Of amounts with units as of percent, whatever the size of the body: what `gyradius model` refuses is refused, and nothing else.
        #[test]
        fn what_is_beyond_the_body_is_refused(
            nominal in body(),
            part in 0..4_u8,
            share in -2.0..2.0_f64,
            sigmas in 0.2..8.0_f64,
        ) {
            let share = 10_f64.powf(share);
            let (mass, trace) = (nominal.mass_kg(), nominal.inertia().matrix().trace());
            let of_body = 10.0 * trace * share * sigmas;
            let said = match part {
                0 => Statements {
                    mass: MassStatement::kg(mass * share * sigmas, sigmas).ok(),
                    ..Statements::default()
                },
                1 => Statements {
                    mass: MassStatement::percent(100.0 * share.min(0.99) * sigmas, sigmas).ok(),
                    ..Statements::default()
                },
                2 => Statements {
                    moments: MomentsStatement::new(Amount::Absolute([0.0, of_body, 0.0]), sigmas).ok(),
                    ..Statements::default()
                },
                _ => Statements {
                    products: ProductsStatement::new([0.0, 0.0, of_body], sigmas).ok(),
                    ..Statements::default()
                },
            };
            let about = said.check(nominal.inertia(), Some(mass));
            prop_assert_eq!(about.is_err(), part != 1 && share > 1.0 && (part == 0 || trace > 0.0));
            if part >= 2 && share <= 1.0 {
                // Such wide laws are found with much trouble, and are asked for elsewhere.
                return Ok(());
            }
            prop_assert_eq!(StatedBody::new(&said, &nominal).err(), about.err());
        }
    }

    #[test]
    fn draws_of_a_wide_mass_are_as_stated() {
        let nominal = Shape::solid_box([0.1, 0.2, 0.3]).unwrap().of_mass(2.0).unwrap();
        let law = StatedBody::new(&statements(3, [50.0, 50.0, 0.0, 0.0]), &nominal).unwrap();
        let n = 40_000;
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let drawn: Vec<_> = (0..n).map(|_| law.sample(&mut rng)).collect();
        let check = |of: &dyn Fn(&MassProperties) -> f64| {
            let ratios = drawn.iter().map(|body| of(body) / of(&nominal));
            let mean = ratios.clone().sum::<f64>() / f64::from(n);
            let square = ratios.map(|x| (x - mean).powi(2)).sum::<f64>() / f64::from(n);
            // Five standard errors of a lognormal law: its kurtosis is about 9.
            assert!(
                (mean - 1.0).abs() < 0.0125 && (square.sqrt() - 0.5).abs() < 0.02,
                "{mean} {square}"
            );
        };
        check(&MassProperties::mass_kg);
        (0..3).for_each(|i| check(&|body| body.inertia().entries()[i]));
    }

    /// Where the axes are not stated to scatter, or to scatter by nothing, every draw has those of the nominal body, and products of
    /// zero stay zero; where the moments do not either, it has the nominal inertia, to the bit.
    #[test]
    fn axes_that_do_not_scatter_are_those_of_the_nominal_body() {
        let tilted = UnitQuaternion::from_euler_angles(0.3, -0.2, 1.0);
        let (upright, second) = (UnitQuaternion::identity(), [0.1, 0.2, 0.35]);
        let still = AxesStatement::each([0.0; 3], 1.0).unwrap();
        for (attitude, mass, moments, axes) in [tilted, upright].into_iter().flat_map(|attitude| {
            [None, Some(10.0)].into_iter().flat_map(move |mass| {
                [None, Some(0.0), Some(12.0)].into_iter().flat_map(move |moments| {
                    [None, Some(still)].map(move |axes| (attitude, mass, moments, axes))
                })
            })
        }) {
            let inertia =
                Inertia::from_second_moments(SecondMoments::new(second).unwrap(), &attitude)
                    .unwrap();
            let nominal = MassProperties::new(2.0, Vector3::zeros(), inertia).unwrap();
            let said = Statements {
                mass: mass.map(|percent| MassStatement::percent(percent, 1.0).unwrap()),
                moments: moments.map(|percent| {
                    MomentsStatement::new(Amount::Percent([percent; 3]), 1.0).unwrap()
                }),
                axes,
                ..Statements::default()
            };
            let law = StatedBody::new(&said, &nominal).unwrap();
            let mut turned = 0_f64;
            for seed in 0..50 {
                let drawn = law.sample(&mut ChaCha8Rng::seed_from_u64(seed));
                let matrix = drawn.inertia().matrix();
                let ratio = drawn.mass_kg() / 2.0;
                match (moments, mass) {
                    (Some(0.0), _) | (None, None) => assert_eq!(drawn.inertia(), &inertia),
                    (None, Some(_)) => assert!((matrix - inertia.matrix() * ratio).amax() < 1e-15),
                    (Some(_), _) => assert!((matrix - inertia.matrix()).amax() > 1e-6),
                }
                let r = attitude.to_rotation_matrix();
                let own = r.matrix() * matrix * r.matrix().transpose();
                let products = [own[(0, 1)], own[(0, 2)], own[(1, 2)]];
                turned = products.into_iter().fold(turned, |most, x| most.max(x.abs()));
            }
            let rounding = if attitude == upright { 0.0 } else { 1e-15 };
            assert!(turned <= rounding, "{mass:?} {moments:?} {axes:?}: {turned:e}");
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
