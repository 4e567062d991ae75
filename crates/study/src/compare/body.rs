//! A body of a comparison.

use gyradius_campaign::plain;
use gyradius_inertia::{Inertia, InertiaMatrix};

use crate::scenario::{Scenario, ScenarioError};

/// Bodies on which the models differ, with their entries I11, I22, I33, I12, I13, I23 in kg·m²: the
/// payload of Peck (2003), a slender stage, a plate-like panel, a compact bus.
const BUILT_IN: [(&str, [f64; 6]); 4] = [
    ("payload", [5000.0, 4000.0, 3000.0, 20.0, 2.0, -50.0]),
    ("slender-stage", [2000.0, 15_000.0, 15_500.0, 0.0, 0.0, 0.0]),
    ("panel", [500.0, 520.0, 1000.0, 0.0, 0.0, 0.0]),
    ("bus", [900.0, 800.0, 600.0, 0.0, 0.0, 0.0]),
];
/// Largest moments between these keep every square and fourth power in range.
const SIZES: std::ops::RangeInclusive<f64> = 1e-30..=1e30;

/// A body that the models are set up about.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NominalBody {
    name: String,
    inertia: Inertia,
}

impl NominalBody {
    pub(crate) fn new(name: &str, inertia: Inertia) -> Result<Self, ScenarioError> {
        let largest = inertia.principal_axes().moments().into_iter().fold(0.0, f64::max);
        if !SIZES.contains(&largest) {
            return Err(ScenarioError::field(
                format!("body {name}"),
                format!(
                    "largest moment {largest:e} kg·m²: it must lie between {:e} and {:e}",
                    SIZES.start(),
                    SIZES.end()
                ),
            ));
        }
        Ok(Self { name: name.to_owned(), inertia })
    }

    /// A body of a scenario, which has been checked.
    pub(crate) fn of_study(name: &str, inertia: Inertia) -> Self {
        Self { name: name.to_owned(), inertia }
    }

    /// The built-in bodies, or payload and stage of the scenario of a user.
    pub(crate) fn known(scenario: Option<&Scenario>) -> Result<Vec<Self>, ScenarioError> {
        if let Some(scenario) = scenario {
            return Ok(vec![
                Self::new("payload", *scenario.payload().nominal())?,
                Self::new("stage", *scenario.stage().nominal())?,
            ]);
        }
        BUILT_IN.iter().map(|(name, entries)| Self::of_entries(name, entries)).collect()
    }

    /// A body by the name of a known one, or by three moments or six entries with commas between, which are its name
    /// in the same form however they are written: the random streams depend on it.
    pub(crate) fn read(text: &str, known: &[Self]) -> Result<Self, ScenarioError> {
        let text = text.trim();
        if let Some(body) = known.iter().find(|body| body.name == text) {
            return Ok(body.clone());
        }
        let refuse = || {
            let names: Vec<&str> = known.iter().map(|body| body.name.as_str()).collect();
            let problem = format!(
                "{text:?}: it must be {}, or numbers in kg·m²: I11,I22,I33 or I11,I22,I33,I12,I13,I23",
                names.join(", ")
            );
            ScenarioError::field("body", problem)
        };
        let numbers: Result<Vec<f64>, _> =
            text.split(',').map(|number| number.trim().parse::<f64>()).collect();
        let entries = match numbers.as_deref() {
            Ok(&[a, b, c]) => [a, b, c, 0.0, 0.0, 0.0],
            Ok(&[a, b, c, d, e, f]) => [a, b, c, d, e, f],
            _ => return Err(refuse()),
        };
        // Zero has one sign.
        let entries = entries.map(|entry| entry + 0.0);
        let told = if entries[3..] == [0.0; 3] { &entries[..3] } else { &entries[..] };
        Self::of_entries(&told.iter().copied().map(plain).collect::<Vec<_>>().join(","), &entries)
    }

    fn of_entries(name: &str, &[a, b, c, d, e, f]: &[f64; 6]) -> Result<Self, ScenarioError> {
        let refuse = |e: &dyn std::fmt::Display| ScenarioError::field(format!("body {name}"), e);
        let matrix = InertiaMatrix::from_entries([a, b, c], [d, e, f]).map_err(|e| refuse(&e))?;
        Self::new(name, Inertia::try_from(matrix).map_err(|e| refuse(&e))?)
    }

    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    pub(crate) fn inertia(&self) -> &Inertia {
        &self.inertia
    }

    /// Its largest principal moment, kg·m².
    pub(crate) fn largest_moment(&self) -> f64 {
        self.inertia.principal_axes().moments().into_iter().fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn names_and_numbers_are_bodies() {
        let known = NominalBody::known(None).unwrap();
        let names: Vec<&str> = known.iter().map(NominalBody::name).collect();
        assert_eq!(names, ["payload", "slender-stage", "panel", "bus"]);
        assert_eq!(NominalBody::read("bus", &known).unwrap(), known[3]);
        let three = NominalBody::read("5000, 4000,3000", &known).unwrap();
        assert_eq!(three.name(), "5000,4000,3000");
        assert_eq!(three.inertia().entries(), [5000.0, 4000.0, 3000.0, 0.0, 0.0, 0.0]);
        let six = NominalBody::read("5000,4000,3000,20,2,-50", &known).unwrap();
        assert_eq!(six.inertia(), known[0].inertia());

        let scenario = Scenario::peck_2003().unwrap();
        let of_scenario = NominalBody::known(Some(&scenario)).unwrap();
        assert_eq!(of_scenario[0].inertia(), known[0].inertia());
        assert_eq!(of_scenario[1].name(), "stage");
    }

    proptest! {
        /// Bodies that are the same have the same name, on which their draws depend.
        #[test]
        fn a_body_has_one_name_however_its_numbers_are_written(
            size in -20.0..20.0_f64,
            moments in prop::array::uniform3(1.0..1.9_f64),
            product in prop_oneof![Just(0.0), -0.02..0.02_f64],
        ) {
            let known = NominalBody::known(None).unwrap();
            let [a, b, c] = moments.map(|moment| moment * 10.0_f64.powf(size));
            let d = product * 10.0_f64.powf(size);
            let mut texts = vec![
                format!("{a},{b},{c},{d},0,0"),
                format!(" {a:e} , {b:?}, +{c}, {d:e}, -0, 0.0e5 "),
            ];
            if d == 0.0 {
                texts.push(format!("{a},{b},{c}"));
            }
            let bodies: Vec<_> = texts.iter().map(|text| NominalBody::read(text, &known).unwrap()).collect();
            for body in &bodies {
                prop_assert_eq!(body, &bodies[0]);
            }
            // And its name is a way to write it.
            prop_assert_eq!(&NominalBody::read(bodies[0].name(), &known).unwrap(), &bodies[0]);
        }
    }

    #[test]
    fn what_is_no_body_is_refused_by_name() {
        let known = NominalBody::known(None).unwrap();
        for (text, words) in [
            ("", "it must be payload, slender-stage"),
            ("teapot", "\"teapot\": it must be"),
            ("1,2", "I11,I22,I33"),
            ("1,2,3,4", "I11,I22,I33"),
            ("1,2,x", "I11,I22,I33"),
            ("nan,1,1", "NaN"),
            ("inf,1,1", "inf"),
            ("1,1,9", "no body has this inertia"),
            ("0,0,0", "body 0,0,0: largest moment 0e0 kg·m²"),
            ("1e300,1e300,1e300", "body 1e300,1e300,1e300: largest moment 1e300"),
            ("5e-324,5e-324,5e-324", "largest moment"),
            ("-1,-1,-1", "no body has"),
        ] {
            let error = NominalBody::read(text, &known).unwrap_err().to_string();
            assert!(error.contains(words), "{text}: {error}");
        }
    }
}
