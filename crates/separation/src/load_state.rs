//! A load at a moment.

use nalgebra::Vector3;

/// A load at a moment.
///
/// ```
/// # use gyradius_inertia::InertiaMatrix;
/// # use gyradius_separation::{Body, Separation, Spring};
/// # use nalgebra::Vector3;
/// # let inertia = InertiaMatrix::from_entries([5e3, 4e3, 3e3], [0.0; 3])?;
/// # let point = |z| Vector3::new(0.5, 0.0, z);
/// # let spring = Spring::new(1e5, 0.1, point(-0.9), point(0.9))?;
/// # let (payload, stage) = (Body::new(1e4, inertia)?, Body::new(4e3, inertia)?);
/// # let separation =
/// #     Separation::new(payload.at(Vector3::z()), stage.at(-Vector3::z()), &[spring])?;
/// use gyradius_separation::Settings;
///
/// let trajectory = separation.trajectory(&Settings::default(), 0.0)?;
/// let spring = trajectory.at(0.0).ok_or("the start")?.loads()[0];
/// assert!(spring.is_pushing());
/// assert!((spring.force_n().z - 1e4).abs() < 1e-9);
/// assert!((spring.energy_j() - 500.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadState {
    pub(crate) pushing: bool,
    pub(crate) length: f64,
    pub(crate) compression: f64,
    pub(crate) force: Vector3<f64>,
    pub(crate) energy: f64,
}

impl LoadState {
    /// Whether it has started and has not yet let go.
    #[must_use]
    pub fn is_pushing(&self) -> bool {
        self.pushing
    }

    /// Distance of its two points, m.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.length
    }

    /// How far it is short of its end, m, whether it pushes or not: of a spring, its
    /// [release length](crate::Separation::release_lengths) less its length.
    #[must_use]
    pub fn compression_m(&self) -> f64 {
        self.compression
    }

    /// Force on the payload, inertial axes, N; that on the stage is its opposite. Zero once it
    /// has let go, and before it starts.
    #[must_use]
    pub fn force_n(&self) -> Vector3<f64> {
        self.force
    }

    /// Energy that it can still give, J: what friction will take of the stored energy left out. Zero
    /// once it has let go, and before it starts.
    #[must_use]
    pub fn energy_j(&self) -> f64 {
        self.energy
    }
}
