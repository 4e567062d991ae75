//! What every model is matched to.

use gyradius_attitude::RadiallyConstrainedGaussian;
use gyradius_dispersion::{
    DispersionModel, EntryMoments, InertiaLaw, ModelKind, PrincipalDispersion, ScalarRoots,
};
use gyradius_inertia::{Inertia, InertiaMatrix, RootSecondMoments};
use nalgebra::{Matrix3, SMatrix};
use serde::Serialize;
use std::{error::Error, sync::Arc};

use super::{body::NominalBody, fit::Fit};

/// The radial variance of axes whose second lobe is empty.
const RADIAL: f64 = 0.01;

/// What a level of uncertainty u means.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Reference {
    /// The moments of a law of bodies, the paper's: second moments K_k that are independent, with the
    /// nominal means and the same relative deviation, and principal axes that turn by u rad about each
    /// axis, by less where u is large. The relative deviation is such that the principal moment that varies most has a deviation
    /// of u times the largest moment.
    #[default]
    Principal,
    /// Six independent entries about the nominal ones, each with a deviation of u times the largest
    /// moment: what is assumed in common practice. No body need be able to vary so.
    Entries,
}

impl Reference {
    /// Its name on the command line and in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Principal => "principal",
            Self::Entries => "entries",
        }
    }

    /// What a level means, in a sentence.
    pub(crate) fn meaning(self) -> &'static str {
        match self {
            Self::Principal => {
                "At level u the second moments K of the reference law have the nominal means and one \
                 relative deviation, such that the principal moment that varies most has a deviation of \
                 u times the largest moment; its principal axes turn by u rad (1σ) about each axis while u is \
                 below 20 %, and by less above: by 0.41 rad at 50 %, by 0.50 rad at 100 %. Every model is given the mean and covariance of its six entries, as far as its kind can have \
                 them."
            }
            Self::Entries => {
                "At level u the six entries have the nominal means and independent deviations of u times \
                 the largest moment. Every model is given this mean and covariance, as far as its kind \
                 can have them."
            }
        }
    }

    /// The reference at a level, a share of the largest moment.
    pub(crate) fn at(self, body: &NominalBody, level: f64) -> Result<Target, Box<dyn Error>> {
        let nominal = body.inertia();
        match self {
            Self::Principal => {
                let law = principal(nominal, level)?;
                let moments = EntryMoments::of(&law);
                Ok(Target::of_law(Arc::new(law), moments))
            }
            Self::Entries => {
                let variance = (level * body.largest_moment()).powi(2);
                let covariance = SMatrix::<f64, 6, 6>::from_diagonal_element(variance);
                Ok(Target::of_moments(EntryMoments::new(nominal.entries(), covariance)?))
            }
        }
    }
}

/// The paper's law with Gaussian roots about the nominal body.
pub(super) fn principal(
    nominal: &Inertia,
    level: f64,
) -> Result<PrincipalDispersion<ScalarRoots, RadiallyConstrainedGaussian>, Box<dyn Error>> {
    let axes = nominal.principal_axes();
    let k = nominal.second_moments().values();
    let of_moments = [k[1].hypot(k[2]), k[0].hypot(k[2]), k[0].hypot(k[1])];
    let largest = axes.moments().into_iter().fold(0.0, f64::max);
    let relative = level * largest / of_moments.into_iter().fold(0.0, f64::max);
    // E K = k̄² + c and Var K = 4k̄²c + 2c²; with Var K = (ρ E K)², k̄² = E K √(1 − ρ²/2). As ρ ≤ √2 u, this
    // is real to u = 1.
    let square = 0.5 * relative * relative;
    let share = (1.0 - square).max(0.0).sqrt();
    let roots = ScalarRoots::normal(
        RootSecondMoments::new(k.map(|k| (k * share).sqrt()))?,
        k.map(|k| k * square / (1.0 + share)),
    )?;
    let turns = Matrix3::from_diagonal_element(level * level);
    let axes =
        RadiallyConstrainedGaussian::from_rotation_covariance(axes.attitude(), turns, RADIAL)?;
    Ok(PrincipalDispersion::new(roots, axes))
}

/// Deviations of entries up to this share of the largest entry are those of a body that is known exactly.
const EXACT: f64 = 1e-12;

/// Moments that models are to have, and the law that has them, if they come from one.
#[derive(Clone, Debug)]
pub(crate) struct Target {
    moments: EntryMoments,
    law: Option<Arc<dyn InertiaLaw>>,
}

/// A model that is to have the moments of a target.
pub(crate) struct Candidate {
    pub(crate) law: Arc<dyn InertiaLaw>,
    /// Its own moments, where they are known.
    pub(crate) moments: Option<EntryMoments>,
    /// What of the target's moments it was given.
    pub(crate) matched: &'static str,
}

impl Target {
    /// A law and its moments.
    pub(crate) fn of_law(law: Arc<dyn InertiaLaw>, moments: EntryMoments) -> Self {
        Self { moments, law: Some(law) }
    }

    /// Moments that come from no law of an inertia alone.
    pub(crate) fn of_moments(moments: EntryMoments) -> Self {
        Self { moments, law: None }
    }

    /// The same, if it is no body that is known exactly, to rounding: of such a body there is no covariance to be matched.
    pub(crate) fn uncertain(self) -> Result<Self, String> {
        let largest = |entries: [f64; 6]| entries.into_iter().map(f64::abs).fold(0.0, f64::max);
        if largest(self.moments.deviations()) > EXACT * largest(self.moments.mean()) {
            Ok(self)
        } else {
            Err("the inertia is not dispersed where the mass is nominal, so that there is no covariance to match".to_owned())
        }
    }

    pub(crate) fn moments(&self) -> &EntryMoments {
        &self.moments
    }

    /// The model of a kind.
    pub(crate) fn model(&self, kind: ModelKind) -> Result<Candidate, String> {
        if let Some(law) = self.law.as_ref().filter(|law| law.name() == kind.name()) {
            return Ok(Candidate {
                law: Arc::clone(law),
                moments: Some(self.moments),
                matched: "the reference itself",
            });
        }
        let found = DispersionModel::matched(kind, &self.moments).map_err(|e| e.problem)?;
        let matched = found.what();
        let model = found.into_model();
        let moments = model.entry_moments();
        // A first-order match far outside its range is none.
        let fit = moments.map(|moments| Fit::known(&moments, &self.moments));
        match fit {
            Some(fit) if !fit.is_near() => Err(format!(
                "a match to first order misses: the covariance comes out {} times too large",
                gyradius_report::significant(1.0 + fit.covariance_off, 2)
            )),
            _ => Ok(Candidate { law: Arc::new(model), moments, matched }),
        }
    }

    /// Why no law of bodies has these moments, where that can be shown: in the principal axes of the
    /// mean, E Σ_ab² must not exceed E Σ_aa Σ_bb, for Σ ⪰ 0.
    pub(crate) fn impossible(&self) -> Option<String> {
        if self.law.as_ref().is_some_and(|law| law.is_realizable_by_construction()) {
            return None;
        }
        let [i11, i22, i33, i12, i13, i23] = self.moments.mean();
        let mean = InertiaMatrix::from_entries([i11, i22, i33], [i12, i13, i23]).ok()?;
        let axes = mean.principal_axes();
        let r = axes.attitude().to_rotation_matrix();
        let k = axes.second_moments();
        let forms = second_moment_forms(r.matrix());
        let covariance = |a: usize, b: usize| {
            (forms[a].transpose() * self.moments.covariance() * forms[b])[(0, 0)]
        };
        [(0, 1, 3), (0, 2, 4), (1, 2, 5)].into_iter().find_map(|(a, b, product)| {
            let room = k[a] * k[b] + covariance(a, b);
            let taken = covariance(product, product);
            // The mean product is zero in principal axes.
            (taken > room * (1.0 + 1e-9)).then(|| {
                let deviation = gyradius_report::significant(taken.sqrt(), 3);
                if room > 0.0 {
                    let most = gyradius_report::significant(room.sqrt(), 3);
                    format!(
                        "no law of bodies has these moments: a product of inertia with a deviation of \
                         {deviation} kg·m², of which at most {most} is possible beside these moments"
                    )
                } else {
                    "no law of bodies has these moments: two second moments that are never negative \
                     cannot covary so"
                        .to_owned()
                }
            })
        })
    }
}

/// The entries 11, 22, 33, 12, 13, 23 of R Σ Rᵀ as linear forms in the six entries of I.
fn second_moment_forms(r: &Matrix3<f64>) -> [nalgebra::SVector<f64, 6>; 6] {
    const ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
    ENTRIES.map(|(a, b)| {
        nalgebra::SVector::from_fn(|e, _| {
            let (k, l) = ENTRIES[e];
            let mut unit = Matrix3::zeros();
            unit[(k, l)] = 1.0;
            unit[(l, k)] = 1.0;
            let sigma = Matrix3::from_diagonal_element(0.5 * unit.trace()) - unit;
            (r * sigma * r.transpose())[(a, b)]
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use gyradius_dispersion::KnownMoments;
    use gyradius_dispersion::RootMoments;

    fn body(name: &str) -> NominalBody {
        NominalBody::read(name, &NominalBody::known(None).unwrap()).unwrap()
    }

    /// A level is what the documentation says, up to 100 %.
    #[test]
    fn the_largest_deviation_of_a_moment_is_the_level() {
        for name in ["payload", "slender-stage", "panel", "bus", "1,1,1", "0,7,7"] {
            let body = body(name);
            for level in [0.01, 0.2, 1.0] {
                let law = principal(body.inertia(), level).unwrap();
                let [v1, v2, v3] = law.roots().second_moment_statistics().variances();
                let largest = (v2 + v3).max(v1 + v3).max(v1 + v2).sqrt();
                let error = largest / (level * body.largest_moment()) - 1.0;
                assert!(error.abs() < 1e-12, "{name} {level}: {error:e}");
                let k = body.inertia().second_moments().values();
                for (found, k) in law.roots().second_moment_statistics().mean().iter().zip(k) {
                    assert!((found - k).abs() < 1e-9 * (1.0 + k), "{name} {level}");
                }
            }
        }
    }

    /// Axes turn by u rad: small, the products vary by u times the differences of the moments.
    #[test]
    fn small_turns_are_the_level() {
        let target = Reference::Principal.at(&body("slender-stage"), 0.001).unwrap();
        let deviations = target.moments().deviations();
        for (found, difference) in deviations[3..].iter().zip([13_000.0, 13_500.0, 500.0]) {
            assert!((found / (0.001 * difference) - 1.0).abs() < 1e-3, "{deviations:?}");
        }
    }

    /// Independent entries of a slender stage cannot vary by 10 %: |I23| would have to exceed what the
    /// two small second moments leave. The bound by hand: s² ≤ K₂K₃ − s²/4.
    #[test]
    fn moments_that_no_body_has_are_told() {
        let slender = body("slender-stage");
        let limit = (0.8_f64 * 1250.0 * 750.0).sqrt() / 15_500.0;
        let told = |level| Reference::Entries.at(&slender, level).unwrap().impossible();
        assert_eq!(told(0.999 * limit), None);
        let words = told(1.001 * limit).unwrap();
        assert!(words.contains("no law of bodies has these moments"), "{words}");
        assert!(told(0.5).unwrap().contains("no law"));
        for level in [0.01, 0.5, 1.0] {
            assert_eq!(Reference::Principal.at(&slender, level).unwrap().impossible(), None);
        }
    }

    /// The same in any frame.
    #[test]
    fn impossible_moments_are_so_in_any_frame() {
        let slender = body("slender-stage");
        let law = principal(slender.inertia(), 0.3).unwrap().entry_moments();
        // The law's own moments, without the law: possible, so never called impossible.
        let target = Target { moments: law, law: None };
        assert_eq!(target.impossible(), None);
        let turned = slender
            .inertia()
            .rotated(&nalgebra::UnitQuaternion::from_euler_angles(0.3, 0.2, 0.9))
            .unwrap();
        let turned = NominalBody::new("turned", turned).unwrap();
        assert!(Reference::Entries.at(&turned, 0.1).unwrap().impossible().is_some());
    }
}
