//! The separation of Peck (2003), put together from the library crates: Table 1, Eq. 30 and
//! Eq. 31 (with 0.075 where 0.75 is printed).

use gyradius_attitude::RadiallyConstrainedGaussian;
use gyradius_dispersion::ScalarRoots;
use gyradius_inertia::{Inertia, InertiaMatrix};
use gyradius_separation::{Body, Separation, Spring};
use nalgebra::{Matrix4, Vector3, Vector4};

/// One of the paper's two bodies.
#[derive(Clone, Debug)]
pub struct PaperBody {
    /// Its nominal inertia.
    pub nominal: Inertia,
    /// The law of the roots of its second moments.
    pub roots: ScalarRoots,
    /// The law of its principal axes.
    pub axes: RadiallyConstrainedGaussian,
}

impl PaperBody {
    fn new(moments: [f64; 3], products: [f64; 3], variances: [f64; 3]) -> Self {
        let valid = "the paper's values are valid";
        let matrix = InertiaMatrix::from_entries(moments, products).expect(valid);
        let nominal = Inertia::try_from(matrix).expect(valid);
        let covariance = Matrix4::from_diagonal(&Vector4::new(2e-5, 6e-4, 6e-4, 0.6));
        let mean = nominal.principal_axes().attitude();
        Self {
            nominal,
            roots: ScalarRoots::normal(nominal.second_moments().roots(), variances).expect(valid),
            axes: RadiallyConstrainedGaussian::new(mean, covariance).expect(valid),
        }
    }

    /// The spacecraft.
    #[must_use]
    pub fn payload() -> Self {
        Self::new([5000.0, 4000.0, 3000.0], [20.0, 2.0, -50.0], [0.125, 0.1, 0.075])
    }

    /// The upper stage.
    #[must_use]
    pub fn stage() -> Self {
        Self::new([6700.0, 6700.0, 2000.0], [0.0, 20.0, -20.0], [0.0067, 0.0067, 0.002])
    }
}

/// The nominal separation.
#[must_use]
pub fn paper_separation() -> Separation {
    let valid = "the paper's values are valid";
    let spring = |stiffness, x, y| {
        Spring::new(stiffness, 0.1, Vector3::new(x, y, -0.9), Vector3::new(x, y, 0.9)).expect(valid)
    };
    let payload = Body::new(10_000.0, PaperBody::payload().nominal).expect(valid);
    let stage = Body::new(4_000.0, PaperBody::stage().nominal).expect(valid);
    let springs = [(1e5, 1.0, 1.0), (1e5, -1.0, 1.0), (3e4, 1.0, -1.0), (3e4, -1.0, -1.0)];
    Separation::new(
        payload.at(Vector3::z()),
        stage.at(-Vector3::z()),
        &springs.map(|(k, x, y)| spring(k, x, y)),
    )
    .expect(valid)
}

// The example of the repository's README compiles.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

#[cfg(doctest)]
#[doc = include_str!("../docs/models/mass-properties.md")]
struct MassPropertiesPage;
