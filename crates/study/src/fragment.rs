//! The part of a scenario that holds the uncertainty of one body.

use gyradius_attitude::{RadiallyConstrainedGaussian, RcgError};
use gyradius_dispersion::{
    CorrelatedRoots, CorrelatedRootsError, PrincipalDispersion, RootLaw, ScalarLaw, ScalarLawForm,
    ScalarRoots, ScalarRootsError,
};
use gyradius_inertia::{Inertia, RealizabilityError, Region};
/// Which body of a scenario a [`Fragment`] is for.
pub use gyradius_separation::Role as FragmentBody;
use nalgebra::{Matrix3, Matrix4};
use std::fmt;

/// Two mean attitudes nearer than this, rad, are one to any study.
const SAME: f64 = 1e-6;

/// Why a law cannot be written into a scenario.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FragmentError {
    /// The nominal inertia does not read back.
    #[error("nominal inertia: {0}")]
    Inertia(RealizabilityError),
    /// The variances of the roots do not read back.
    #[error(transparent)]
    Roots(#[from] ScalarRootsError),
    /// The covariance of the roots does not read back.
    #[error(transparent)]
    CorrelatedRoots(#[from] CorrelatedRootsError),
    /// The roots are samples of triples.
    #[error(
        "roots: samples of triples are not written; laws of single roots and Gaussian ones are"
    )]
    RootLaw,
    /// The covariance of the axes does not read back.
    #[error("axes: {0}")]
    Axes(RcgError),
    /// The mass or the mass centre do not read back.
    #[error("{field} = {value:?}: it must be finite and not negative, and a share at most one")]
    Beside {
        /// The key in the scenario.
        field: &'static str,
        /// Its value.
        value: f64,
    },
    /// The law is about other axes than those of the nominal inertia.
    #[error(
        "the mean of the axes lies {degrees:.1e}° from the principal axes of the nominal inertia, \
         which is where a scenario puts it"
    )]
    Mean {
        /// The angle between them.
        degrees: f64,
    },
}

impl From<RcgError> for FragmentError {
    fn from(error: RcgError) -> Self {
        Self::Axes(error)
    }
}

impl From<RealizabilityError> for FragmentError {
    fn from(error: RealizabilityError) -> Self {
        Self::Inertia(error)
    }
}

/// The part of a scenario file that says how uncertain the inertia of a body is: nominal inertia,
/// variances or covariance of the roots, covariance of the axes, and where they are known, mass and mass
/// centre. Written by `Display` as TOML, every number so that
/// it reads back bit for bit.
///
/// A scenario takes the mean roots and the mean axes from the nominal inertia; the fragment is
/// checked to give the law back when it is read so.
///
/// ```
/// use gyradius_attitude::RadiallyConstrainedGaussian;
/// use gyradius_dispersion::{ScalarRoots, PrincipalDispersion};
/// use gyradius_inertia::{Inertia, InertiaMatrix};
/// use gyradius_study::{Fragment, FragmentBody};
/// use nalgebra::Matrix3;
///
/// let nominal = Inertia::try_from(InertiaMatrix::from_entries([5e3, 4e3, 3e3], [20.0, 2.0, -50.0])?)?;
/// let roots = ScalarRoots::normal(nominal.second_moments().roots(), [0.125, 0.1, 0.075])?;
/// let axes = RadiallyConstrainedGaussian::from_rotation_covariance(
///     nominal.principal_axes().attitude(),
///     Matrix3::identity() * 1e-3,
///     0.01,
/// )?;
/// let law = PrincipalDispersion::new(roots, axes);
/// let fragment = Fragment::new(FragmentBody::Payload, &nominal, &law)?;
/// assert!(fragment.to_string().starts_with("[payload]\ninertia_kg_m2 = [\n"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Fragment {
    body: FragmentBody,
    nominal_mass: Option<f64>,
    inertia: [[f64; 3]; 3],
    roots: Roots,
    covariance: [[f64; 4]; 4],
    mass: Option<Mass>,
    mass_centre: Option<[f64; 3]>,
    inside: Option<Region>,
}

/// A mass ([`ScalarLaw::positive`]), and how far the inertia goes with it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Mass {
    percent: f64,
    follows: f64,
}

#[derive(Clone, Debug, PartialEq)]
enum Roots {
    Variances([f64; 3]),
    Covariance([[f64; 3]; 3]),
    Laws(Box<[ScalarLaw; 3]>),
}

impl Fragment {
    /// Of a law about a nominal inertia.
    ///
    /// # Errors
    /// The roots are samples of triples, what a scenario would read is not allowed, or is another law: its
    /// mean axes are not the principal axes of the nominal inertia.
    pub fn new<K: Clone + Into<RootLaw>>(
        body: FragmentBody,
        nominal: &Inertia,
        law: &PrincipalDispersion<K, RadiallyConstrainedGaussian>,
    ) -> Result<Self, FragmentError> {
        let inertia: [[f64; 3]; 3] = (*nominal).into();
        let roots = match law.roots().clone().into() {
            RootLaw::Independent(roots) => match roots.as_normal() {
                Some(normal) => Roots::Variances(normal.map(|[_, variance]| variance)),
                None => Roots::Laws(Box::new(roots.laws().clone())),
            },
            RootLaw::CorrelatedGaussian(roots) => {
                let c = roots.covariance();
                Roots::Covariance(std::array::from_fn(|i| std::array::from_fn(|j| c[(i, j)])))
            }
            RootLaw::Empirical(_) => return Err(FragmentError::RootLaw),
        };
        let covariance = law.axes().covariance();
        let covariance = std::array::from_fn(|i| std::array::from_fn(|j| covariance[(i, j)]));
        let fragment = Self {
            body,
            nominal_mass: None,
            inertia,
            roots,
            covariance,
            mass: None,
            mass_centre: None,
            inside: None,
        };

        // As a scenario reads it.
        let read = Inertia::try_from(inertia)?;
        let mean = read.second_moments().roots();
        match &fragment.roots {
            &Roots::Variances(v) => ScalarRoots::normal(mean, v).map(|_| ())?,
            &Roots::Covariance(c) => {
                CorrelatedRoots::new(mean, Matrix3::from_fn(|i, j| c[i][j])).map(|_| ())?;
            }
            // Read as they are written, about no mean.
            Roots::Laws(_) => {}
        }
        let mean = read.principal_axes().attitude();
        RadiallyConstrainedGaussian::new(mean, Matrix4::from_fn(|i, j| covariance[i][j]))?;
        let off = mean.angle_to(&law.axes().mean());
        if !(off < SAME) {
            return Err(FragmentError::Mean { degrees: off.to_degrees() });
        }
        Ok(fragment)
    }

    /// With the nominal mass, kg, of which other numbers may be shares.
    ///
    /// # Errors
    /// It is not positive and finite.
    pub fn with_nominal_mass(self, mass_kg: f64) -> Result<Self, FragmentError> {
        if !(mass_kg > 0.0 && mass_kg <= 1e30) {
            return Err(FragmentError::Beside { field: "mass_kg", value: mass_kg });
        }
        Ok(Self { nominal_mass: Some(mass_kg), ..self })
    }

    /// With a mass of this standard deviation ([`ScalarLaw::positive`]), in percent of the nominal mass, of whose relative
    /// change the inertia takes the share `follows`, from 0 to 1. The law of the fragment is then that of the inertia at the
    /// nominal mass.
    ///
    /// # Errors
    /// The percentage is negative, or one of them not finite or out of range.
    pub fn with_mass(self, percent: f64, follows: f64) -> Result<Self, FragmentError> {
        let refused = |field, value| Err(FragmentError::Beside { field, value });
        match (percent, follows) {
            (p, _) if !(0.0..=1e30).contains(&p) => refused("mass_percent", p),
            (_, f) if !(0.0..=1.0).contains(&f) => refused("inertia_follows_mass", f),
            (percent, follows) => Ok(Self { mass: Some(Mass { percent, follows }), ..self }),
        }
    }

    /// With a normal mass centre of these standard deviations along body axes 1, 2, 3, m, about the nominal one.
    ///
    /// # Errors
    /// A deviation is negative or not finite.
    pub fn with_mass_centre(self, metres: [f64; 3]) -> Result<Self, FragmentError> {
        match metres.iter().find(|m| !(0.0..=1e30).contains(*m)) {
            Some(&value) => Err(FragmentError::Beside { field: "mass_centre_m", value }),
            None => Ok(Self { mass_centre: Some(metres), ..self }),
        }
    }

    /// With a region, in body axes from the nominal mass centre, that holds all matter of the body.
    #[must_use]
    pub fn with_inside(self, region: Region) -> Self {
        Self { inside: Some(region), ..self }
    }

    /// The nominal mass, kg, if it is known.
    #[must_use]
    pub fn nominal_mass(&self) -> Option<f64> {
        self.nominal_mass
    }

    /// Standard deviation of the mass in percent, and the share of its relative change that the inertia takes.
    #[must_use]
    pub fn mass(&self) -> Option<(f64, f64)> {
        self.mass.map(|mass| (mass.percent, mass.follows))
    }

    /// Standard deviations of the mass centre along body axes 1, 2, 3, m.
    #[must_use]
    pub fn mass_centre(&self) -> Option<[f64; 3]> {
        self.mass_centre
    }

    /// Nominal inertia by rows, kg·m².
    #[must_use]
    pub fn inertia(&self) -> [[f64; 3]; 3] {
        self.inertia
    }

    /// Variances of the roots, kg·m², if they are independent.
    #[must_use]
    pub fn root_variances(&self) -> Option<[f64; 3]> {
        match self.roots {
            Roots::Variances(v) => Some(v),
            Roots::Covariance(_) | Roots::Laws(_) => None,
        }
    }

    /// Covariance of the roots by rows, kg·m², if they are correlated.
    #[must_use]
    pub fn root_covariance(&self) -> Option<[[f64; 3]; 3]> {
        match self.roots {
            Roots::Variances(_) | Roots::Laws(_) => None,
            Roots::Covariance(c) => Some(c),
        }
    }

    /// Covariance of the axes by rows, in ℝ⁴, scalar last.
    #[must_use]
    pub fn axes_covariance(&self) -> [[f64; 4]; 4] {
        self.covariance
    }
}

impl fmt::Display for Fragment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let body = self.body;
        writeln!(f, "[{body}]")?;
        if let Some(mass_kg) = self.nominal_mass {
            writeln!(f, "mass_kg = {mass_kg:?}")?;
        }
        writeln!(f, "inertia_kg_m2 = [")?;
        for row in self.inertia {
            writeln!(f, "    {row:?},")?;
        }
        writeln!(f, "]\n\n[{body}.dispersion]")?;
        match &self.roots {
            Roots::Variances(v) => writeln!(f, "root_second_moment_variance_kg_m2 = {v:?}")?,
            Roots::Covariance(c) => {
                writeln!(f, "roots = \"correlated-gaussian\"")?;
                writeln!(f, "root_second_moment_covariance_kg_m2 = [")?;
                for row in c {
                    writeln!(f, "    {row:?},")?;
                }
                writeln!(f, "]")?;
            }
            Roots::Laws(laws) => {
                writeln!(f, "roots = \"independent\"\nroot_second_moment_laws_sqrt_kg_m = [")?;
                for law in laws.iter() {
                    writeln!(f, "    {},", ScalarLawForm::from(law.clone()))?;
                }
                writeln!(f, "]")?;
            }
        }
        writeln!(f, "axes_covariance = [")?;
        for row in self.covariance {
            writeln!(f, "    {row:?},")?;
        }
        writeln!(f, "]")?;
        if let Some(Mass { percent, follows }) = self.mass {
            let law = ScalarLaw::positive(100.0, percent).map_err(|_| fmt::Error)?;
            match law.as_normal() {
                Some(_) => writeln!(f, "mass_percent = {percent:?}")?,
                None => {
                    let name = law.name();
                    writeln!(f, "mass_percent = {{ law = {name:?}, sigma = {percent:?} }}")?;
                }
            }
            if follows == 1.0 {
                writeln!(f, "inertia_follows_mass = true")?;
            } else if follows > 0.0 {
                writeln!(f, "inertia_follows_mass = {follows:?}")?;
            }
        }
        if let Some(metres) = self.mass_centre {
            writeln!(f, "mass_centre_m = {metres:?}")?;
        }
        match &self.inside {
            Some(region) => {
                // A region is a table: always written.
                let region = toml::Value::try_from(region).map_err(|_| fmt::Error)?;
                writeln!(f, "inside = {region}")
            }
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Scenario,
        scenario::{Axes, UncertainBody},
    };
    use gyradius_dispersion::{AxesLaw, DispersionModel, EmpiricalRoots};
    use nalgebra::UnitQuaternion;

    type Law = PrincipalDispersion<ScalarRoots, RadiallyConstrainedGaussian>;

    fn law(moments: [f64; 3], turn: UnitQuaternion<f64>) -> (Inertia, Law) {
        let nominal = Inertia::from_principal_moments(moments, &turn).unwrap();
        let roots = nominal.second_moments().roots();
        let axes = RadiallyConstrainedGaussian::from_rotation_covariance(
            nominal.principal_axes().attitude(),
            Matrix3::new(4e-4, 1e-4, 0.0, 1e-4, 1e-4, 0.0, 0.0, 0.0, 9e-4),
            0.01,
        );
        let roots = ScalarRoots::normal(roots, [0.1, 0.2, 0.0]).unwrap();
        (nominal, PrincipalDispersion::new(roots, axes.unwrap()))
    }

    /// The paper's scenario with its payload taken out and the fragment pasted in.
    fn pasted(fragment: &Fragment) -> String {
        let scenario = Scenario::peck_2003().unwrap().to_toml();
        let mut keep = true;
        let mut text = String::new();
        for line in scenario.lines() {
            if line.starts_with('[') {
                keep = !line.starts_with("[payload");
            }
            if keep {
                text.push_str(line);
                text.push('\n');
            }
        }
        let fragment = fragment.to_string();
        let state = "\nmass_kg = 1e4\nposition_m = [0.0, 0.0, 1.0]\n\n[payload.dispersion]";
        format!("{text}\n{}", fragment.replace("\n[payload.dispersion]", state))
    }

    fn principal(body: &UncertainBody) -> PrincipalDispersion<RootLaw, AxesLaw> {
        let law = body.law(Axes::WholeSphere).unwrap();
        let DispersionModel::Principal(law) = law else { panic!("{law:?}") };
        *law
    }

    /// A region is read back, whatever it is.
    #[test]
    fn a_scenario_reads_the_region_back() {
        let (nominal, law) = law([5000.0, 4000.0, 3000.0], UnitQuaternion::identity());
        let by = nalgebra::Isometry3::new([0.1, 0.0, 0.2].into(), [0.3, 0.0, 0.1].into());
        let corners: Vec<[f64; 3]> =
            (0..8).map(|i| [0, 1, 2].map(|k| if i >> k & 1 == 0 { -1.5 } else { 1.5 })).collect();
        for region in [
            Region::ellipsoid([0.0; 3], [2.0, 2.0, 2.5]).unwrap().transformed(&by).unwrap(),
            Region::solid_box([0.0, 0.1, 0.0], [1.5; 3]).unwrap(),
            Region::hull(&corners).unwrap(),
        ] {
            let fragment = Fragment::new(FragmentBody::Payload, &nominal, &law).unwrap();
            let fragment = fragment.with_mass(1.0, 1.0).unwrap().with_inside(region);
            let scenario = Scenario::from_toml(&pasted(&fragment));
            let text = scenario.unwrap_or_else(|e| panic!("{e}\n{fragment}")).to_toml();
            assert!(text.contains("[payload.dispersion.inside"), "{text}");
        }
    }

    #[test]
    fn a_scenario_reads_the_same_law_back() {
        for turn in [UnitQuaternion::identity(), UnitQuaternion::from_euler_angles(0.1, 0.3, -0.5)]
        {
            let (nominal, law) = law([5000.0, 4000.0, 3000.0], turn);
            let fragment = Fragment::new(FragmentBody::Payload, &nominal, &law).unwrap();
            let scenario = Scenario::from_toml(&pasted(&fragment)).unwrap();
            let body = scenario.payload();
            assert_eq!(body.nominal(), &nominal);
            let read = principal(body);
            let RootLaw::Independent(roots) = read.roots() else { panic!("{read:?}") };
            assert_eq!(roots.as_normal().unwrap().map(|n| n[1]), [0.1, 0.2, 0.0]);
            let axes = body.gaussian_axes().unwrap();
            assert_eq!(axes.covariance(), law.axes().covariance());
            assert!(axes.mean().angle_to(&law.axes().mean()) < 1e-12);
        }
    }

    #[test]
    fn correlated_roots_are_read_back_too() {
        let (nominal, law) = law([5000.0, 4000.0, 3000.0], UnitQuaternion::identity());
        let c = Matrix3::new(0.1, 0.05, -0.01, 0.05, 0.2, 0.1, -0.01, 0.1, 0.3);
        let roots = CorrelatedRoots::new(nominal.second_moments().roots(), c).unwrap();
        let law = PrincipalDispersion::new(roots, law.axes().clone());
        let fragment = Fragment::new(FragmentBody::Payload, &nominal, &law).unwrap();
        assert_eq!(fragment.root_variances(), None);
        let scenario = Scenario::from_toml(&pasted(&fragment)).unwrap();
        let read = principal(scenario.payload());
        let RootLaw::CorrelatedGaussian(roots) = read.roots() else { panic!("{read:?}") };
        assert_eq!(*roots.covariance(), c);

        let samples = EmpiricalRoots::from_values(&[[30.0, 40.0, 50.0]]).unwrap();
        let law = PrincipalDispersion::new(samples, law.axes().clone());
        let refused = Fragment::new(FragmentBody::Payload, &nominal, &law);
        assert_eq!(refused.unwrap_err(), FragmentError::RootLaw);
    }

    /// Of any kind, to the bit.
    #[test]
    fn laws_of_single_roots_are_read_back() {
        let (nominal, gaussian) = law([5000.0, 4000.0, 3000.0], UnitQuaternion::identity());
        let k = nominal.second_moments().roots();
        for roots in [
            ScalarRoots::uniform(k, [0.1; 3]),
            ScalarRoots::lognormal(k, [0.1; 3]),
            ScalarRoots::truncated_normal(k, [0.3; 3], [[30.0, f64::INFINITY]; 3]),
            ScalarRoots::new([
                ScalarLaw::triangular(30.0, 31.0, 33.3).unwrap(),
                ScalarLaw::beta(40.0, 1e2 / 3.0 + 10.0, 2.0, 0.7).unwrap(),
                ScalarLaw::weibull(50.0, 0.1, 2.0).unwrap(),
            ]),
            ScalarRoots::new([
                ScalarLaw::samples(&[54.0, 53.0, 53.1 / 3.0]).unwrap(),
                ScalarLaw::normal(44.0, 0.3).unwrap(),
                ScalarLaw::bernoulli(0.5).unwrap(),
            ]),
        ] {
            let law = PrincipalDispersion::new(roots.unwrap(), gaussian.axes().clone());
            let fragment = Fragment::new(FragmentBody::Payload, &nominal, &law).unwrap();
            let scenario = Scenario::from_toml(&pasted(&fragment)).unwrap();
            let read = principal(scenario.payload());
            assert_eq!(*read.roots(), RootLaw::Independent(law.roots().clone()));
            let again = Scenario::from_toml(&scenario.to_toml()).unwrap();
            assert_eq!(again.to_toml(), scenario.to_toml());
        }
    }

    /// A narrow mass is a number, a wide one a lognormal law; a study reads the mean and the deviation that are stated.
    #[test]
    fn a_mass_of_any_width_reads_back() {
        let (nominal, law) = law([5000.0, 4000.0, 3000.0], UnitQuaternion::identity());
        for percent in [0.0, 1.0, 12.5, 12.6, 33.3, 100.0, 1000.0] {
            let fragment = Fragment::new(FragmentBody::Payload, &nominal, &law).unwrap();
            let text = pasted(&fragment.with_mass(percent, 1.0).unwrap());
            assert_eq!(text.contains("mass_percent = {"), percent > 12.5, "{text}");
            let scenario = Scenario::from_toml(&text).unwrap();
            let all = scenario.dispersions().all();
            let mass = &all.iter().find(|one| one.column == "payload_mass_kg").unwrap().law;
            assert!(
                (mass.mean() - 1e4).abs() < 1e-8
                    && (mass.deviation() - 100.0 * percent).abs() < 1e-8
            );
        }
    }

    #[test]
    fn a_law_about_other_axes_is_refused() {
        let (nominal, _) = law([5000.0, 4000.0, 3000.0], UnitQuaternion::identity());
        let (_, other) =
            law([5000.0, 4000.0, 3000.0], UnitQuaternion::from_euler_angles(0.1, 0.0, 0.0));
        let error = Fragment::new(FragmentBody::Stage, &nominal, &other).unwrap_err();
        assert!(matches!(error, FragmentError::Mean { .. }), "{error}");
        assert!(error.to_string().contains("5.7e0°"), "{error}");
    }
}
