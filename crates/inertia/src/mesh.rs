//! The body inside a closed surface of triangles.

use std::collections::HashMap;

use nalgebra::Vector3;

use crate::mass_properties::check_vector;
use crate::polyhedron::Polyhedron;
use crate::{MassProperties, MassPropertiesError, Measure, ShapeError};

/// Why triangles do not bound a body.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// There are no triangles.
    #[error("no triangles: a closed surface has at least four")]
    Empty,
    /// A coordinate is NaN, infinite or too large.
    #[error("vertex {vertex}: {error}")]
    Vertex {
        /// Vertex, from 0.
        vertex: usize,
        /// What is wrong with it.
        error: MassPropertiesError,
    },
    /// A triangle names a vertex that there is not.
    #[error("triangle {triangle} names vertex {vertex}: there are {vertices}, counted from 0")]
    Index {
        /// Triangle, from 0.
        triangle: usize,
        /// The vertex it names.
        vertex: usize,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A triangle names a vertex twice.
    #[error("triangle {triangle} names vertex {vertex} twice: it must have three corners")]
    Degenerate {
        /// Triangle, from 0.
        triangle: usize,
        /// The vertex, from 0.
        vertex: usize,
    },
    /// The surface has a hole, or a triangle turned against its neighbour.
    #[error(
        "the edge from vertex {from} to {to} of triangle {triangle} is not used the other way: the \
         surface is open there, or the neighbour is turned"
    )]
    OpenEdge {
        /// Triangle, from 0.
        triangle: usize,
        /// Start of the edge, vertex from 0.
        from: usize,
        /// End of the edge, vertex from 0.
        to: usize,
    },
    /// Two triangles use an edge in the same direction.
    #[error(
        "triangles {first} and {second} both run from vertex {from} to {to}: an edge is used once in \
         each direction"
    )]
    RepeatedEdge {
        /// A triangle, from 0.
        first: usize,
        /// Another one, from 0.
        second: usize,
        /// Start of the edge, vertex from 0.
        from: usize,
        /// End of the edge, vertex from 0.
        to: usize,
    },
    /// All triangles are turned: seen from outside, vertices must run counterclockwise.
    #[error(
        "volume = {volume:e} m³: the surface is inside out; swap two vertices of every triangle"
    )]
    InsideOut {
        /// The volume, m³.
        volume: f64,
    },
    /// The surface encloses nothing, to rounding.
    #[error("volume = {volume:e} m³: it is zero to rounding")]
    NoVolume {
        /// The volume, m³.
        volume: f64,
    },
    /// The enclosed mass has no possible inertia, or is too large.
    #[error("the surface may cross itself: {0}")]
    MassProperties(MassPropertiesError),
}

impl From<MassPropertiesError> for MeshError {
    fn from(error: MassPropertiesError) -> Self {
        Self::MassProperties(error)
    }
}

/// A body of uniform density inside a closed surface of triangles.
///
/// Volume, mass centre and second moments, and with them the integrals of Peck (2003, Eq. 3-4), are sums
/// of tetrahedra between each triangle and a point (Mirtich 1996, doi:10.1080/10867651.1996.10487458, gets the same from surface integrals). The
/// point is the body's own centre, so that they are as good far from the origin as near it, up to
/// the rounding of the vertices themselves.
///
/// ```
/// use gyradius_inertia::TriangleMesh;
///
/// let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
/// let mesh = TriangleMesh::new(&corners, &faces)?;
/// assert!((mesh.volume_m3() - 1.0 / 6.0).abs() < 1e-15);
/// let body = mesh.of_density(2700.0)?;
/// assert!((body.mass_kg() - 450.0).abs() < 1e-12 && (body.mass_centre_m().x - 0.25).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters)]
pub struct TriangleMesh {
    /// The enclosed volume, m³.
    #[getset(get_copy = "pub")]
    volume_m3: f64,
    /// At unit mass.
    body: MassProperties,
}

impl TriangleMesh {
    /// Takes vertices (m, reference frame) and triples of their indices, from 0, counterclockwise
    /// seen from outside. Every edge must be used once in each direction. Several separate
    /// surfaces are allowed, and cavities, whose triangles face into them; crossings are not looked
    /// for. Triangles without area do no harm, and vertices that no triangle names do not count.
    ///
    /// # Errors
    /// A vertex is not finite or too far, an index out of range or repeated in its triangle, an
    /// edge not matched, or the volume negative or zero.
    pub fn new(vertices: &[[f64; 3]], triangles: &[[usize; 3]]) -> Result<Self, MeshError> {
        for (vertex, x) in vertices.iter().enumerate() {
            check_vector("coordinate", &Vector3::from(*x))
                .map_err(|error| MeshError::Vertex { vertex, error })?;
        }
        check_indices(vertices.len(), triangles)?;
        check_edges(triangles)?;
        let polyhedron = Polyhedron::of(vertices, triangles);
        let volume = polyhedron.volume;
        // Below the range of floats it has no digits.
        if polyhedron.is_flat || volume.abs() < f64::MIN_POSITIVE {
            return Err(MeshError::NoVolume { volume });
        }
        if volume < 0.0 {
            return Err(MeshError::InsideOut { volume });
        }
        Ok(Self { volume_m3: volume, body: polyhedron.of_unit_mass()? })
    }

    /// Takes the corners of each triangle (m, reference frame), as STL files list them. Corners
    /// with the same coordinates, to the bit, are one vertex, numbered in the order in which they
    /// first appear.
    ///
    /// # Errors
    /// As [`TriangleMesh::new`].
    pub fn from_corners(triangles: &[[[f64; 3]; 3]]) -> Result<Self, MeshError> {
        let (vertices, triangles) = welded(triangles);
        Self::new(&vertices, &triangles)
    }

    /// Mass properties for a mass in kg, in the frame of the vertices.
    ///
    /// # Errors
    /// The mass is not positive and finite, or the inertia too large.
    pub fn of_mass(&self, mass_kg: f64) -> Result<MassProperties, MassPropertiesError> {
        self.body.with_mass(mass_kg)
    }

    /// Mass properties for a density in kg/m³, in the frame of the vertices.
    ///
    /// # Errors
    /// The density is not positive and finite, or mass or inertia are too large.
    pub fn of_density(&self, density_kg_per_m3: f64) -> Result<MassProperties, ShapeError> {
        Ok(self.of_mass(Measure::Volume(self.volume_m3).mass_kg(density_kg_per_m3)?)?)
    }
}

/// Vertices and triples of indices of triangles that name each corner by its place.
fn welded(triangles: &[[[f64; 3]; 3]]) -> (Vec<[f64; 3]>, Vec<[usize; 3]>) {
    let mut numbers = HashMap::new();
    let mut vertices = Vec::new();
    let mut number = |corner: [f64; 3]| {
        // Adding zero makes −0 and 0 one.
        *numbers.entry(corner.map(|x| (x + 0.0).to_bits())).or_insert_with(|| {
            vertices.push(corner);
            vertices.len() - 1
        })
    };
    let triangles = triangles.iter().map(|triangle| triangle.map(&mut number)).collect();
    (vertices, triangles)
}

fn check_indices(vertices: usize, triangles: &[[usize; 3]]) -> Result<(), MeshError> {
    if triangles.is_empty() {
        return Err(MeshError::Empty);
    }
    for (triangle, &[a, b, c]) in triangles.iter().enumerate() {
        if let Some(vertex) = [a, b, c].into_iter().find(|&i| i >= vertices) {
            return Err(MeshError::Index { triangle, vertex, vertices });
        }
        if a == b || c == a {
            return Err(MeshError::Degenerate { triangle, vertex: a });
        }
        if b == c {
            return Err(MeshError::Degenerate { triangle, vertex: b });
        }
    }
    Ok(())
}

/// Every edge once in each direction; the first offender in the order of vertices is named.
fn check_edges(triangles: &[[usize; 3]]) -> Result<(), MeshError> {
    // Low vertex, high vertex, whether from high to low, triangle: an edge's two uses end up side
    // by side.
    let mut uses: Vec<(usize, usize, bool, usize)> = Vec::with_capacity(3 * triangles.len());
    for (triangle, &[a, b, c]) in triangles.iter().enumerate() {
        uses.extend([(a, b), (b, c), (c, a)].map(|(i, j)| (i.min(j), i.max(j), i > j, triangle)));
    }
    uses.sort_unstable();
    for edge in uses.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let ends = |falling: bool| {
            let (low, high, ..) = edge[0];
            if falling { (high, low) } else { (low, high) }
        };
        if let Some(pair) = edge.windows(2).find(|pair| pair[0].2 == pair[1].2) {
            let (from, to) = ends(pair[0].2);
            let (first, second) = (pair[0].3, pair[1].3);
            return Err(MeshError::RepeatedEdge { first, second, from, to });
        }
        if let &[(.., falling, triangle)] = edge {
            let (from, to) = ends(falling);
            return Err(MeshError::OpenEdge { triangle, from, to });
        }
    }
    Ok(())
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::Shape;
    use proptest::prelude::*;

    /// A body of revolution about axis 3: a point at the bottom, rings (radius, height), and a
    /// point at the top, each ring of `n` vertices.
    pub(crate) fn revolved(bottom: f64, rings: &[[f64; 2]], top: f64, n: usize) -> TriangleMesh {
        let (vertices, triangles) = revolution(bottom, rings, top, n);
        TriangleMesh::new(&vertices, &triangles).unwrap()
    }

    fn revolution(
        bottom: f64,
        rings: &[[f64; 2]],
        top: f64,
        n: usize,
    ) -> (Vec<[f64; 3]>, Vec<[usize; 3]>) {
        let mut vertices = vec![[0.0, 0.0, bottom]];
        for [r, z] in rings {
            for k in 0..n {
                let (sin, cos) = libm::sincos(std::f64::consts::TAU * k as f64 / n as f64);
                vertices.push([r * cos, r * sin, *z]);
            }
        }
        vertices.push([0.0, 0.0, top]);
        let at = |ring: usize, k: usize| 1 + ring * n + k % n;
        let mut triangles = Vec::new();
        for k in 0..n {
            triangles.push([0, at(0, k + 1), at(0, k)]);
            for ring in 1..rings.len() {
                triangles.push([at(ring - 1, k), at(ring - 1, k + 1), at(ring, k)]);
                triangles.push([at(ring - 1, k + 1), at(ring, k + 1), at(ring, k)]);
            }
            triangles.push([
                vertices.len() - 1,
                at(rings.len() - 1, k),
                at(rings.len() - 1, k + 1),
            ]);
        }
        (vertices, triangles)
    }

    const FACES: [[usize; 3]; 12] = [
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];

    fn corners(low: [f64; 3], sides: [f64; 3]) -> Vec<[f64; 3]> {
        (0..8)
            .map(|i| std::array::from_fn(|k| low[k] + if i >> k & 1 == 1 { sides[k] } else { 0.0 }))
            .collect()
    }

    fn inside_out(faces: &[[usize; 3]]) -> Vec<[usize; 3]> {
        faces.iter().map(|&[a, b, c]| [a, c, b]).collect()
    }

    #[test]
    fn a_box_is_exact() {
        let mesh =
            TriangleMesh::new(&corners([-0.5, -1.0, -1.5], [1.0, 2.0, 3.0]), &FACES).unwrap();
        assert_eq!(mesh.volume_m3(), 6.0);
        let found = mesh.of_density(2.0).unwrap();
        let expected = Shape::solid_box([1.0, 2.0, 3.0]).unwrap().of_density(2.0).unwrap();
        assert_eq!(found.mass_kg(), 12.0);
        assert_eq!(found.mass_centre_m(), Vector3::zeros());
        assert!((found.inertia().matrix() - expected.inertia().matrix()).amax() < 1e-14);
    }

    /// Corners that no rounding moves: the distance costs nothing at all. Moments about the
    /// origin would lose twelve digits at the second, and all of them at the third.
    #[test]
    fn far_away_is_as_good_as_near() {
        for distance in [0.0, 1e6, 2f64.powi(50)] {
            let mesh = TriangleMesh::new(
                &corners([distance, -distance, distance], [1.0, 2.0, 3.0]),
                &FACES,
            )
            .unwrap();
            assert!((mesh.volume_m3() - 6.0).abs() < 1e-14);
            let found = mesh.of_mass(12.0).unwrap();
            let expected = Shape::solid_box([1.0, 2.0, 3.0]).unwrap().of_mass(12.0).unwrap();
            assert!((found.inertia().matrix() - expected.inertia().matrix()).amax() < 1e-13);
            let centre = Vector3::new(distance + 0.5, 1.0 - distance, distance + 1.5);
            assert_eq!(found.mass_centre_m(), centre);
        }
    }

    /// Corners that are rounded: nine digits of a metre are left at 1000 km.
    #[test]
    fn what_is_lost_far_away_is_the_rounding_of_corners() {
        let near = corners([0.0; 3], [0.7, 0.9, 1.1]);
        let far: Vec<[f64; 3]> = near.iter().map(|x| x.map(|x| x + 1e6 / 3.0)).collect();
        let of = |vertices: &[[f64; 3]]| {
            *TriangleMesh::new(vertices, &FACES).unwrap().of_mass(1.0).unwrap().inertia().matrix()
        };
        assert!((of(&near) - of(&far)).amax() < 1e-9 * of(&near).amax());
    }

    #[test]
    fn corners_in_one_place_are_one_vertex() {
        let vertices = corners([-0.0, 1e6, -1e-3], [1.0; 3]);
        let soup = FACES.map(|face| face.map(|i| vertices[i]));
        let mesh = TriangleMesh::new(&vertices, &FACES).unwrap();
        assert_eq!(TriangleMesh::from_corners(&soup).unwrap(), mesh);
        let mut signed = soup;
        assert_eq!(signed[0][0][0], 0.0);
        signed[0][0][0] = -0.0;
        assert_eq!(TriangleMesh::from_corners(&signed).unwrap(), mesh);
        signed[0][0][0] = 1e-300;
        assert!(matches!(TriangleMesh::from_corners(&signed), Err(MeshError::OpenEdge { .. })));
        signed[0][0][0] = f64::NAN;
        assert!(matches!(TriangleMesh::from_corners(&signed), Err(MeshError::Vertex { .. })));
        assert_eq!(TriangleMesh::from_corners(&[]), Err(MeshError::Empty));
    }

    #[test]
    fn cavities_are_cut_out() {
        let mut vertices = corners([0.0; 3], [2.0; 3]);
        vertices.extend(corners([0.5, 0.5, 0.25], [0.5; 3]));
        let mut faces = FACES.to_vec();
        faces.extend(inside_out(&FACES).iter().map(|f| f.map(|i| i + 8)));
        let found = TriangleMesh::new(&vertices, &faces).unwrap().of_density(3.0).unwrap();
        let of = |side: f64, centre: [f64; 3]| {
            let solid = Shape::solid_box([side; 3]).unwrap().of_density(3.0).unwrap();
            solid.translated(centre).unwrap()
        };
        let expected = of(2.0, [1.0; 3]).without(&of(0.5, [0.75, 0.75, 0.5])).unwrap();
        assert!((found.inertia().matrix() - expected.inertia().matrix()).amax() < 1e-13);
        assert!((found.mass_centre_m() - expected.mass_centre_m()).amax() < 1e-15);
    }

    #[test]
    fn surfaces_that_bound_nothing_are_refused_by_name() {
        let vertices = corners([0.0; 3], [1.0; 3]);
        let of = |faces: &[[usize; 3]]| TriangleMesh::new(&vertices, faces).unwrap_err();
        assert_eq!(of(&[]), MeshError::Empty);
        let mut faces = FACES;
        faces[3] = [5, 8, 6];
        assert_eq!(of(&faces), MeshError::Index { triangle: 3, vertex: 8, vertices: 8 });
        faces[3] = [5, 6, 6];
        assert_eq!(of(&faces), MeshError::Degenerate { triangle: 3, vertex: 6 });
        // A hole: face 3, [5, 7, 6], is missing.
        let hole: Vec<[usize; 3]> = FACES.iter().copied().filter(|f| *f != FACES[3]).collect();
        assert_eq!(of(&hole), MeshError::OpenEdge { triangle: 2, from: 5, to: 6 });
        // One face turned against its neighbours.
        faces[3] = [5, 6, 7];
        let turned = MeshError::RepeatedEdge { first: 2, second: 3, from: 5, to: 6 };
        assert_eq!(of(&faces), turned);
        // A face twice.
        let twice = MeshError::RepeatedEdge { first: 0, second: 12, from: 1, to: 0 };
        assert_eq!(of(&[&FACES[..], &FACES[..1]].concat()), twice);
        assert_eq!(of(&inside_out(&FACES)), MeshError::InsideOut { volume: -1.0 });
        let bad = corners([0.0, f64::NAN, 0.0], [1.0; 3]);
        assert!(matches!(
            TriangleMesh::new(&bad, &FACES),
            Err(MeshError::Vertex { vertex: 0, .. })
        ));
    }

    #[test]
    fn flat_surfaces_have_no_volume_in_any_place_or_attitude() {
        for (angle, distance) in [(0.0, 0.0), (0.3, 0.0), (1.1, 1e3), (2.0, 1e6)] {
            let q = nalgebra::UnitQuaternion::from_euler_angles(angle, 2.0 * angle, 0.7 * angle);
            let flat: Vec<[f64; 3]> = corners([0.0; 3], [1.0, 1.0, 0.0])
                .iter()
                .map(|x| (q * Vector3::from(*x) + Vector3::repeat(distance)).into())
                .collect();
            match TriangleMesh::new(&flat, &FACES) {
                Err(MeshError::NoVolume { .. }) => {}
                // Rounding of far corners is a volume of its own, of either sign.
                Ok(mesh) => assert!(mesh.volume_m3() < 1e-15 * distance),
                Err(MeshError::InsideOut { volume }) => assert!(-volume < 1e-15 * distance),
                Err(error) => panic!("{error}"),
            }
        }
        // A plate a nanometre thick is a body.
        let thin = TriangleMesh::new(&corners([0.0; 3], [1.0, 1.0, 1e-9]), &FACES).unwrap();
        assert!((thin.volume_m3() * 1e9 - 1.0).abs() < 1e-14);
    }

    #[test]
    fn crossings_with_more_taken_than_there_is_are_refused() {
        // A small body, and a smaller cavity far outside of it.
        let mut vertices = corners([0.0; 3], [1.0; 3]);
        vertices.extend(corners([9.0; 3], [0.9; 3]));
        let mut faces = FACES.to_vec();
        faces.extend(inside_out(&FACES).iter().map(|f| f.map(|i| i + 8)));
        let error = TriangleMesh::new(&vertices, &faces).unwrap_err();
        assert!(error.to_string().starts_with("the surface may cross itself"), "{error}");
    }

    #[test]
    fn sizes_from_atoms_to_galaxies() {
        for size in [1e-90, 1e-30, 1e20, 1e90] {
            let mesh = TriangleMesh::new(&corners([size; 3], [size; 3]), &FACES).unwrap();
            let found = mesh.of_mass(6.0).unwrap().inertia().entries()[0];
            assert!((found / size / size - 1.0).abs() < 1e-13, "{size:e}");
        }
        let tiny = TriangleMesh::new(&corners([0.0; 3], [1e-320; 3]), &FACES);
        assert!(matches!(tiny, Err(MeshError::NoVolume { .. })));
    }

    /// A tether of 20 km and 1 mm, along an axis and turned.
    #[test]
    fn a_tether_is_a_body() {
        let (radius, length) = (5e-4, 2e4);
        let (vertices, faces) = rope(radius, length, 8);
        let straight = TriangleMesh::new(&vertices, &faces).unwrap();
        let area = 4.0 * radius * radius * std::f64::consts::FRAC_PI_4.sin();
        assert!((straight.volume_m3() / (area * length) - 1.0).abs() < 1e-14);
        let q = nalgebra::UnitQuaternion::from_euler_angles(0.3, 0.7, 2.0);
        let turned: Vec<[f64; 3]> =
            vertices.iter().map(|x| (q * Vector3::from(*x)).into()).collect();
        let turned = TriangleMesh::new(&turned, &faces).unwrap();
        // An ulp of 20 km beside a millimetre.
        assert!((turned.volume_m3() / (area * length) - 1.0).abs() < 1e-8);
    }

    /// A prism along axis 3 over a regular polygon, of two rings and two hubs, from 0 up.
    fn rope(radius: f64, length: f64, sides: usize) -> (Vec<[f64; 3]>, Vec<[usize; 3]>) {
        revolution(0.0, &[[radius, 0.0], [radius, length]], length, sides)
    }

    proptest! {
        /// Straight and bent ropes from stout to 1e-8 of their length thick, in any pose and at any
        /// distance: wrong by no more than the rounding of their vertices makes them. Plain sums are
        /// wrong by the square of the slenderness.
        #[test]
        fn slender_bodies_are_as_good_as_their_vertices(
            (slenderness, size, far) in (-8.0..0.0f64, -9.0..9.0f64, -3.0..3.0f64),
            (sides, rings) in (3..9usize, 2..6usize),
            v in prop::array::uniform3(-3.0..3.0f64),
            t in prop::array::uniform3(-1.0..1.0f64),
            (bent, turned) in (any::<bool>(), any::<bool>()),
        ) {
            let [slenderness, length, far] = [slenderness, size, far].map(|x| 10f64.powf(x));
            let radius = slenderness * length;
            let rings: Vec<[f64; 2]> = (0..rings)
                .map(|i| [radius, length * i as f64 / (rings - 1) as f64])
                .collect();
            let (mut vertices, mut faces) = revolution(0.0, &rings, length, sides);
            // Area and second moment of the regular polygon.
            let angle = std::f64::consts::TAU / sides as f64;
            let area = 0.5 * sides as f64 * radius * radius * angle.sin();
            let across = radius * radius * (2.0 + angle.cos()) / 12.0;
            let k = crate::SecondMoments::new([across, across, length * length / 12.0]).unwrap();
            let own = crate::Inertia::from_second_moments(k, &Default::default()).unwrap();
            let mut body = MassProperties::new(1.0, [0.0, 0.0, 0.5 * length], own).unwrap();
            let mut volume = area * length;
            if bent {
                // The same again from the other end, along axis 1: (x, y, z) to (z, x, y).
                let n = vertices.len();
                vertices.extend(vertices.clone().iter().map(|[x, y, z]| [*z + 2.0 * radius, *x, *y]));
                faces.extend(faces.clone().iter().map(|face| face.map(|i| i + n)));
                let k = crate::SecondMoments::new([length * length / 12.0, across, across]).unwrap();
                let other = crate::Inertia::from_second_moments(k, &Default::default()).unwrap();
                let centre = [0.5 * length + 2.0 * radius, 0.0, 0.0];
                let other = MassProperties::new(1.0, centre, other).unwrap();
                body = MassProperties::combined([body, other]).unwrap().with_mass(1.0).unwrap();
                volume *= 2.0;
            }
            let pose = nalgebra::Isometry3::new(
                Vector3::from(t) * if turned { length * far } else { 0.0 },
                Vector3::from(v) * f64::from(u8::from(turned)),
            );
            let place = |x: &[f64; 3]| (pose * nalgebra::Point3::from(*x)).coords.into();
            let vertices: Vec<[f64; 3]> = vertices.iter().map(place).collect();
            let expected = body.transformed(&pose).unwrap();
            // The rounding of a vertex beside the thickness, and that of the polygon's sides.
            let reach = if turned { length * (1.0 + 2.0 * far) } else { radius };
            let bound = 4.0 * f64::EPSILON * (4.0 + reach / radius);
            let found = TriangleMesh::new(&vertices, &faces);
            // Refused only where the vertices do not tell.
            prop_assert!(found.is_ok() || bound > 0.01, "{found:?} {bound:e}");
            let Ok(found) = found else { return Ok(()) };
            prop_assert!((found.volume_m3() / volume - 1.0).abs() < bound, "{} {bound:e}", found.volume_m3() / volume - 1.0);
            let found = found.of_mass(1.0).unwrap();
            let centre = (found.mass_centre_m() - expected.mass_centre_m()).amax();
            prop_assert!(centre < bound * length + 4.0 * f64::EPSILON * reach, "{centre:e}");
            let inertia = (found.inertia().matrix() - expected.inertia().matrix()).amax();
            prop_assert!(inertia < bound * length * length, "{inertia:e}");
        }

        #[test]
        fn turns_with_its_vertices(
            points in prop::array::uniform4(prop::array::uniform3(-1.0..1.0f64)),
            v in prop::array::uniform3(-3.0..3.0f64),
            t in prop::array::uniform3(-9.0..9.0f64),
        ) {
            let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
            let of = |p: &[[f64; 3]]| {
                TriangleMesh::new(p, &faces).or_else(|_| TriangleMesh::new(p, &inside_out(&faces)))
            };
            let mesh = of(&points).unwrap();
            prop_assume!(mesh.volume_m3() > 1e-3);
            // A tetrahedron: Σ_c = m/20 of its corners about their mean, in textbook form.
            let body = mesh.of_mass(20.0).unwrap();
            let mean: Vector3<f64> = points.iter().map(|p| Vector3::from(*p)).sum::<Vector3<f64>>() / 4.0;
            let corners = points.map(|p| (1.0, p));
            let cloud = MassProperties::from_points(corners).unwrap();
            prop_assert!((body.mass_centre_m() - mean).amax() < 1e-14);
            prop_assert!((body.inertia().matrix() - cloud.inertia().matrix()).amax() < 1e-13);

            let pose = nalgebra::Isometry3::new(Vector3::from(t), Vector3::from(v));
            let moved = points.map(|p| (pose * nalgebra::Point3::from(p)).coords.into());
            let moved = of(&moved).unwrap().of_mass(20.0).unwrap();
            let expected = body.transformed(&pose).unwrap();
            prop_assert!((moved.inertia().matrix() - expected.inertia().matrix()).amax() < 1e-11);
            prop_assert!((moved.mass_centre_m() - expected.mass_centre_m()).amax() < 1e-11);
        }

        #[test]
        fn no_input_panics(
            vertices in prop::collection::vec(prop::array::uniform3(prop::num::f64::ANY), 8),
            wide in prop::collection::vec(prop::array::uniform3(-1e100..1e100f64), 8),
            faces in prop::collection::vec(prop::array::uniform3(0..9usize), 0..6),
        ) {
            for vertices in [vertices, wide] {
                for faces in [&faces[..], &FACES[..]] {
                    if let Ok(mesh) = TriangleMesh::new(&vertices, faces) {
                        let _ = (mesh.of_mass(1.0), mesh.of_density(1e300));
                    }
                }
            }
        }
    }
}
