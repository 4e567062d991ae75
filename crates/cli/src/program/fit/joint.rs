//! The joint law of mass, mass centre and inertia beside the fit of the inertia.

use gyradius_dispersion::{JointScalar, MassPropertiesLaw};
use gyradius_estimation::{
    MassAssessment, MassChoice, MassPropertiesFit, MassPropertiesFitError, MassTies, RootEstimate,
    ScalarFit, Tie,
};
use gyradius_inertia::MassProperties;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use serde::Serialize;
use std::fmt::Write;

use super::{SEED, report::wrapped};
use crate::program::{
    number::{probability, short, with_error},
    progress,
};

/// The fit and what is said of it.
pub(super) struct Joint {
    fit: MassPropertiesFit,
    assessment: MassAssessment,
}

/// As an object.
#[derive(Serialize)]
pub(super) struct JointJson {
    mass_kg: ScalarFit,
    mass_centre_m: [ScalarFit; 3],
    gyration_lengths_m: Vec<LengthJson>,
    inertia_power_of_mass: Option<Tie>,
    mass_and_length_correlations: Option<[Option<Tie>; 3]>,
    fits: bool,
    p_value: f64,
    tests: Vec<TestJson>,
    law: MassPropertiesLaw,
}

#[derive(Serialize)]
struct LengthJson {
    law: String,
    mean: f64,
    deviation: f64,
    errors: Option<[f64; 2]>,
}

#[derive(Serialize)]
struct TestJson {
    aspect: String,
    p_value: f64,
    resolution: f64,
}

impl Joint {
    pub(super) fn new(bodies: &[MassProperties]) -> Result<Self, MassPropertiesFitError> {
        let fit = MassPropertiesFit::new(bodies, MassChoice::default())?;
        let mut rng = ChaCha8Rng::seed_from_u64(SEED);
        let assessment =
            progress::show(fit.lengths().simulations(), "simulated tables", |report| {
                fit.assess_with(&mut rng, report)
            });
        Ok(Self { fit, assessment })
    }

    pub(super) fn json(&self) -> JointJson {
        let fit = &self.fit;
        JointJson {
            mass_kg: *fit.mass(),
            mass_centre_m: *fit.centre(),
            gyration_lengths_m: fit
                .lengths()
                .roots()
                .iter()
                .map(|root| LengthJson {
                    law: root.law().to_string(),
                    mean: root.mean(),
                    deviation: root.deviation(),
                    errors: root.errors(),
                })
                .collect(),
            inertia_power_of_mass: fit.ties().map(MassTies::power),
            mass_and_length_correlations: fit.ties().map(|ties| *ties.correlations()),
            fits: self.assessment.fits(),
            p_value: self.assessment.p_value(),
            tests: self
                .assessment
                .tests()
                .iter()
                .map(|test| TestJson {
                    aspect: test.aspect().to_string(),
                    p_value: test.p_value(),
                    resolution: test.resolution(),
                })
                .collect(),
            law: fit.law().clone(),
        }
    }

    /// Lines that follow those of the inertia alone.
    pub(super) fn text(&self) -> String {
        let mut out = String::new();
        // Writing to a string does not fail.
        let _ = self.write(&mut out);
        out
    }

    fn write(&self, out: &mut String) -> std::fmt::Result {
        let fit = &self.fit;
        writeln!(out, "\njoint law of mass, mass centre and inertia")?;
        writeln!(
            out,
            "                                       mean            deviation        law"
        )?;
        let mut row =
            |name: &str, mean: f64, deviation: f64, errors: Option<[f64; 2]>, law: &str| {
                let mean = with_error(mean, errors.map(|e| e[0]));
                let deviation = if deviation > 0.0 {
                    with_error(deviation, errors.map(|e| e[1]))
                } else {
                    "0".to_owned()
                };
                writeln!(out, "  {name:<21}{mean:>21}  {deviation:>19}        {law}")
            };
        let scalar =
            |fit: &ScalarFit| (fit.mean(), fit.deviation(), fit.errors(), fit.kind().to_string());
        let (mean, deviation, errors, law) = scalar(fit.mass());
        row("mass, kg", mean, deviation, errors, &law)?;
        for (i, centre) in fit.centre().iter().enumerate() {
            let (mean, deviation, errors, law) = scalar(centre);
            row(&format!("mass centre {}, m", i + 1), mean, deviation, errors, &law)?;
        }
        for (k, root) in fit.lengths().roots().iter().enumerate() {
            let deviation =
                if root.law() == RootEstimate::Constant { 0.0 } else { root.deviation() };
            let law = root.law().to_string();
            row(
                &format!("gyration length {}, m", k + 1),
                root.mean(),
                deviation,
                root.errors(),
                &law,
            )?;
        }
        if let Some(ties) = fit.ties() {
            let power = ties.power();
            let said = format!(
                "the inertia goes with the mass to the power {:.3} (95 %: {:.3} to {:.3}): 1 where it follows the mass, 0 \
                 where it does not depend on it",
                power.estimate(),
                power.low(),
                power.high()
            );
            writeln!(out)?;
            for line in wrapped(&said) {
                writeln!(out, "{line}")?;
            }
            for (k, correlation) in ties.correlations().iter().enumerate() {
                if let Some(c) = correlation {
                    writeln!(
                        out,
                        "  correlation of ln mass with ln of gyration length {}: {:.3} (95 %: {:.3} to {:.3})",
                        k + 1,
                        c.estimate(),
                        c.low(),
                        c.high()
                    )?;
                }
            }
        }
        self.write_correlations(out)?;
        writeln!(out, "\ndoes the joint law fit?                      p")?;
        for test in self.assessment.tests() {
            let bound = test.resolution() > 0.0 && test.p_value() <= test.resolution();
            let p = if bound {
                format!("≤ {}", test.resolution())
            } else {
                probability(test.p_value())
            };
            writeln!(out, "  {:<42} {p}", test.aspect().to_string())?;
        }
        let verdict = if self.assessment.fits() {
            format!("nothing speaks against it (p = {:.2})", self.assessment.p_value())
        } else {
            let against: Vec<String> =
                self.assessment.objections().map(|test| test.aspect().to_string()).collect();
            format!("it does not fit, which these tests refuse: {}", against.join("; "))
        };
        for line in wrapped(&format!("verdict on the joint law: {verdict}")) {
            writeln!(out, "{line}")?;
        }
        writeln!(out, "the joint law itself: --format json, under joint.law")
    }

    /// Those of the scalars that are larger than chance.
    fn write_correlations(&self, out: &mut String) -> std::fmt::Result {
        const NAMES: [&str; 7] = [
            "mass",
            "mass centre 1",
            "mass centre 2",
            "mass centre 3",
            "gyration length 1",
            "gyration length 2",
            "gyration length 3",
        ];
        let chance = 2.0 / (self.fit.count() as f64).sqrt();
        let correlation = self.fit.law().correlation();
        for (i, name) in NAMES.iter().enumerate().take(JointScalar::ALL.len()) {
            for (j, other) in NAMES.iter().enumerate().skip(i + 1) {
                let c = correlation.coefficient(i, j);
                if c.abs() > chance {
                    writeln!(out, "  correlation of {name} and {other}: {}", short(c))?;
                }
            }
        }
        Ok(())
    }
}
