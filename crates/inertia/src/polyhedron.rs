//! Volume, mass centre and second moments inside a closed surface of triangles.

use nalgebra::{Matrix3, Vector3};

use crate::double::Double;
use crate::second_moment_matrix::{inertia_of, remainder};
use crate::{MassProperties, MassPropertiesError};

/// Volume, centre and second moments inside a closed surface of triangles, which may be inside out.
pub(crate) struct Polyhedron {
    /// Volume, m³; negative if inside out.
    pub(crate) volume: f64,
    /// Whether the rounding of the vertices could have made the volume; then the rest means nothing.
    pub(crate) is_flat: bool,
    centre: Vector3<f64>,
    /// Σ_c/m, m².
    sigma: Matrix3<f64>,
}

impl Polyhedron {
    /// Of triangles whose indices are in range, at vertices within
    /// [`MAX_LENGTH`](crate::MAX_LENGTH).
    pub(crate) fn of(vertices: &[[f64; 3]], triangles: &[[usize; 3]]) -> Self {
        let corners = |t: &[usize; 3]| t.map(|i| Vector3::from(vertices[i]));
        let mut low = Vector3::repeat(f64::INFINITY);
        let mut high = -low;
        for corner in triangles.iter().flat_map(corners) {
            (low, high) = (low.inf(&corner), high.sup(&corner));
        }
        // A power of two below the size, so that scaling rounds nothing and no power of a
        // coordinate over- or underflows; zero for subnormal sizes.
        let unit = f64::from_bits((high - low).max().to_bits() & 0x7FF0_0000_0000_0000);
        if unit == 0.0 {
            let (centre, sigma) = (low, Matrix3::zeros());
            return Self { volume: 0.0, is_flat: true, centre, sigma };
        }
        let middle = low + (high - low) * 0.5;
        let about_middle = |corner: Vector3<f64>| {
            [0, 1, 2].map(|i| Double::difference(corner[i], middle[i]).over_power(unit))
        };
        let sums = Sums::of(triangles.iter().map(|t| corners(t).map(about_middle)));
        // Half a unit in the last place for a vertex where it is, and four for a body that was
        // turned. A vertex moved by δ moves the volume by δ times a third of the areas beside it.
        let place = low.abs().sup(&high.abs()) * (0.5 * f64::EPSILON);
        let rounding = (place + (high - low) * (4.0 * f64::EPSILON)) / unit;
        // Negated because of infinity times zero.
        let is_flat = !(sums.volume.value().abs() > 3.0 * rounding.dot(&sums.area));
        let (centre, sigma) =
            if is_flat { (Vector3::zeros(), Matrix3::zeros()) } else { sums.centre_and_sigma() };
        Self {
            volume: sums.volume.value() / 6.0 * unit * unit * unit,
            is_flat,
            centre: middle + centre * unit,
            sigma: sigma * unit * unit,
        }
    }

    /// The body of 1 kg, evenly filled.
    pub(crate) fn of_unit_mass(&self) -> Result<MassProperties, MassPropertiesError> {
        let matrix = inertia_of(&self.sigma);
        MassProperties::new(1.0, self.centre, remainder(matrix, matrix.amax())?)
    }
}

/// Sums over tetrahedra between each triangle and the origin.
///
/// In a slender body of length L and thickness r they cancel to (r/L)² of their terms, in a turned
/// one also within a term: to r²/L² = 1e-16 at a kilometre of rope. With 32 digits enough are left.
struct Sums {
    /// Six times the volume.
    volume: Double,
    /// 24 times the first moment.
    first: [Double; 3],
    /// 120 times the second: 11, 22, 33, 12, 13, 23.
    second: [Double; 6],
    /// Twice the area of the surface seen along each axis, both sides counted.
    area: Vector3<f64>,
}

/// Rows and columns of the six entries of a symmetric matrix.
const ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

impl Sums {
    fn of(triangles: impl Iterator<Item = [[Double; 3]; 3]>) -> Self {
        let zero = Double::ZERO;
        let mut sums =
            Self { volume: zero, first: [zero; 3], second: [zero; 6], area: Vector3::zeros() };
        for [a, b, c] in triangles {
            let (e, f) = ([0, 1, 2].map(|i| b[i] - a[i]), [0, 1, 2].map(|i| c[i] - a[i]));
            let normal = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| e[i] * f[j] - e[j] * f[i]);
            let volume = a[0] * normal[0] + a[1] * normal[1] + a[2] * normal[2];
            sums.volume = sums.volume + volume;
            let corners = [0, 1, 2].map(|i| a[i] + b[i] + c[i]);
            for (first, corner) in sums.first.iter_mut().zip(corners) {
                *first = *first + corner * volume;
            }
            // ∫ x xᵀ dV = V/20 (s sᵀ + a aᵀ + b bᵀ + c cᵀ) with s = a + b + c.
            for (second, (i, j)) in sums.second.iter_mut().zip(ENTRIES) {
                let squares = corners[i] * corners[j] + a[i] * a[j] + b[i] * b[j] + c[i] * c[j];
                *second = *second + squares * volume;
            }
            sums.area += Vector3::from(normal.map(|n| n.value().abs()));
        }
        sums
    }

    /// The mass centre, and Σ_c/m about it.
    fn centre_and_sigma(&self) -> (Vector3<f64>, Matrix3<f64>) {
        let centre = self.first.map(|first| first.over(Double::from(4.0) * self.volume));
        let mut sigma = Matrix3::zeros();
        for (second, (i, j)) in self.second.iter().zip(ENTRIES) {
            let about_origin = second.over(Double::from(20.0) * self.volume);
            let entry = (about_origin - centre[i] * centre[j]).value();
            (sigma[(i, j)], sigma[(j, i)]) = (entry, entry);
        }
        (centre.map(Double::value).into(), sigma)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;
    use proptest::prelude::*;

    /// ∫ x xᵀ over the tetrahedron of the unit vectors: 1/60 on the diagonal, 1/120 beside it
    /// (∫ x^p y^q z^r = p! q! r! / (p + q + r + 3)!).
    #[test]
    fn the_unit_tetrahedron() {
        let corners: [Vector3<f64>; 3] = [Vector3::x(), Vector3::y(), Vector3::z()];
        let corners = corners.map(|x| [0, 1, 2].map(|i| Double::from(x[i])));
        let sums = Sums::of([corners].into_iter());
        assert_eq!(sums.volume, Double::from(1.0));
        assert_eq!(sums.first, [Double::from(1.0); 3]);
        assert_eq!(sums.second, [2.0, 2.0, 2.0, 1.0, 1.0, 1.0].map(Double::from));
    }

    const FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

    /// A needle whose centre is a quarter along it, not in the middle.
    #[test]
    fn a_needle() {
        let vertices = [[0.0; 3], [1e3, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let needle = Polyhedron::of(&vertices, &FACES);
        assert!((needle.volume * 6e-3 - 1.0).abs() < 1e-15, "{}", needle.volume);
        assert_eq!(needle.centre, Vector3::new(250.0, 0.25, 0.25));
        // Σ_c/m of a tetrahedron is 1/20 of its corners' about their mean.
        assert!((needle.sigma[(0, 0)] / 37500.0 - 1.0).abs() < 1e-15);
        assert!((needle.sigma[(1, 1)] * 80.0 / 3.0 - 1.0).abs() < 1e-14, "{}", needle.sigma);
    }

    /// A body of 1 m and a speck of it 1000 km away: the middle is far from both, and plain moments
    /// about it would leave four digits.
    #[test]
    fn moments_about_the_middle_keep_the_digits_of_those_about_the_mass_centre() {
        let tetrahedron = |at: f64, size: f64| {
            let x = at + size;
            vec![[at; 3], [x, at, at], [at, x, at], [at, at, x]]
        };
        let (far, small) = (2f64.powi(20), 2f64.powi(-20));
        let of = |vertices: &[[f64; 3]], faces: &[[usize; 3]]| {
            let polyhedron = Polyhedron::of(vertices, faces);
            polyhedron.of_unit_mass().unwrap().with_mass(polyhedron.volume).unwrap()
        };
        let (body, speck) = (tetrahedron(0.0, 1.0), tetrahedron(far, small));
        let all = [body.clone(), speck.clone()].concat();
        let faces = [FACES, FACES.map(|face| face.map(|i| i + 4))].concat();
        let parts = [of(&body, &FACES), of(&speck, &FACES)];
        let expected = MassProperties::combined(parts).unwrap();
        let found = of(&all, &faces);
        assert!((found.mass_centre_m() - expected.mass_centre_m()).amax() < 1e-10);
        let error = (found.inertia().matrix() - expected.inertia().matrix()).amax();
        assert!(error < 1e-9 * expected.inertia().matrix().amax(), "{error:e}");
    }

    proptest! {
        /// Points of a plane, up to their rounding.
        #[test]
        fn flat_is_flat_in_any_attitude(
            points in prop::array::uniform4(prop::array::uniform2(-1.0..1.0f64)),
            v in prop::array::uniform3(-3.0..3.0f64),
            exponent in -60..60i32,
        ) {
            let q = UnitQuaternion::from_scaled_axis(Vector3::from(v));
            let scale = 10f64.powi(exponent);
            let flat = points.map(|[x, y]| (q * Vector3::new(scale * x, scale * y, 0.0)).into());
            prop_assert!(Polyhedron::of(&flat, &FACES).is_flat);
            // The control: a hundred-thousandth of thickness is not flat.
            let mut thick = points.map(|[x, y]| [x, y, 0.0]);
            thick[3][2] = 1e-5;
            let [a, b, c] = [0, 1, 2].map(|i| Vector3::from(thick[i]));
            prop_assume!((b - a).cross(&(c - a)).norm() > 1e-3);
            let thick = thick.map(|x| (q * Vector3::from(x) * scale).into());
            prop_assert!(!Polyhedron::of(&thick, &FACES).is_flat);
        }
    }
}
