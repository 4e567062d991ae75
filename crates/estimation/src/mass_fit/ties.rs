//! How the inertia of samples goes with their mass.

use gyradius_inertia::Inertia;
use gyradius_statistics::Confidence;

use crate::fit::{PrincipalFit, RootEstimate};

/// Deviations within which 95 % of a normal law lie.
const NORMAL_95: f64 = 1.959_963_984_540_054;
/// What scatters by less than this, relative, does not.
const STILL: f64 = 1e-9;

/// An estimate with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[getset(get_copy = "pub")]
pub struct Tie {
    /// The estimate.
    estimate: f64,
    /// The lower end.
    low: f64,
    /// The upper end.
    high: f64,
}

/// Whether the inertia follows the mass.
///
/// The inertia of a body whose shape does not depend on its mass is proportional to it, and its gyration lengths are not correlated with
/// it. An inertia that does not depend on the mass has lengths that go with m^(−½).
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters, getset::Getters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MassTies {
    /// The power of the mass with which the trace of the inertia goes, by regression of the logarithms: 1 where the
    /// inertia follows the mass, 0 where it does not depend on it.
    #[getset(get_copy = "pub")]
    power: Tie,
    /// The correlations of ln m with the logarithms of the gyration lengths; none of a length that does not vary or is zero.
    #[getset(get = "pub")]
    correlations: [Option<Tie>; 3],
}

impl MassTies {
    /// Of masses, inertias of one kilogram, and these fitted; none if the mass does not vary.
    pub(super) fn of(masses: &[f64], inertias: &[Inertia], lengths: &PrincipalFit) -> Option<Self> {
        let masses = Centred::of(masses.iter().map(|m| libm::log(*m)))?;
        let sizes = inertias.iter().map(|i| libm::log(i.matrix().trace()));
        let n = inertias.len() as f64;
        let power = match Centred::of(sizes) {
            None => Tie { estimate: 1.0, low: 1.0, high: 1.0 },
            Some(sizes) => {
                let slope = masses.product(&sizes) / masses.square();
                let rest = (sizes.square() - slope * slope * masses.square()).max(0.0);
                let error = (rest / (n - 2.0) / masses.square()).sqrt();
                let reach = Confidence::default().errors(n - 2.0) * error;
                let estimate = 1.0 + slope;
                Tie { estimate, low: estimate - reach, high: estimate + reach }
            }
        };
        let correlations = std::array::from_fn(|k| {
            let root = lengths.roots()[k];
            let values = lengths.sample_roots(k);
            if root.law() == RootEstimate::Constant || values.iter().any(|x| !(*x > 0.0)) {
                return None;
            }
            let values = Centred::of(values.into_iter().map(libm::log))?;
            let sizes = (masses.square() * values.square()).sqrt();
            let estimate = (masses.product(&values) / sizes).clamp(-1.0, 1.0);
            // Fisher's z.
            let (z, reach) = (libm::atanh(estimate), NORMAL_95 / (n - 3.0).sqrt());
            Some(Tie { estimate, low: libm::tanh(z - reach), high: libm::tanh(z + reach) })
        });
        Some(Self { power, correlations })
    }
}

/// Numbers less their mean, which vary.
struct Centred(Vec<f64>);

impl Centred {
    fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        let values: Vec<f64> = values.collect();
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let centred = Self(values.into_iter().map(|x| x - mean).collect());
        ((centred.square() / n).sqrt() > STILL).then_some(centred)
    }

    fn product(&self, other: &Self) -> f64 {
        self.0.iter().zip(&other.0).map(|(x, y)| x * y).sum()
    }

    fn square(&self) -> f64 {
        self.product(self)
    }
}
