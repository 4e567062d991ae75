//! Eigenvalues and eigenvectors of a symmetric 3×3 matrix in closed form.

use nalgebra::{Matrix3, Vector3};

/// Eigenvalues and eigenvectors (columns, det = +1) of a symmetric matrix.
///
/// The eigenvalue that lies farther from the others is a simple root of the characteristic cubic and
/// keeps all digits; its eigenvector is a cross product. The other two follow from the 2×2 block across
/// it by one rotation, which is exact however close they are, where the closed form of all three
/// (Smith 1961, doi:10.1145/355578.366316) would lose half the digits. What rounding leaves off the
/// diagonal goes by Jacobi rotations (Golub & Van Loan, *Matrix Computations*, 4th ed., §8.5). Square
/// roots and the four operations only, so that every machine has the same bits. A diagonal matrix
/// returns unchanged with the identity.
pub(crate) fn eigen(matrix: &Matrix3<f64>) -> ([f64; 3], Matrix3<f64>) {
    let size = size(matrix);
    if size == 0.0 {
        return ([0.0; 3], Matrix3::identity());
    }
    // A power of two, so that nothing is rounded; the matrix then is of size 1 to 2.
    let (lift, unlift) =
        if size < 1e-290 { (2_f64.powi(600), 2_f64.powi(-600)) } else { (1.0, 1.0) };
    let exponent = (size * lift).to_bits() >> 52;
    let (up, down) = (f64::from_bits(exponent << 52), f64::from_bits((2046 - exponent) << 52));
    let a = if size < 1e-290 { matrix * lift * down } else { matrix * down };
    let (mut d, mut v) = (a, Matrix3::identity());
    if !is_diagonal(&d) {
        if let Some(found) = guess(&a) {
            (d, v) = found;
        }
        if !is_diagonal(&d) {
            (d, v) = jacobi(d, v);
        }
    }
    ([d[(0, 0)], d[(1, 1)], d[(2, 2)]].map(|x| x * up * unlift), v)
}

/// The largest magnitude of the entries of a finite symmetric matrix.
#[inline]
pub(crate) fn size(m: &Matrix3<f64>) -> f64 {
    // In pairs, and by a comparison that need not care for NaN: `amax` waits for each of nine.
    let larger = |x: f64, y: f64| if x > y { x } else { y };
    let entry = |i, j| m[(i, j)].abs();
    larger(
        larger(larger(entry(0, 0), entry(1, 1)), larger(entry(0, 1), entry(0, 2))),
        larger(entry(2, 2), entry(1, 2)),
    )
}

/// Off the diagonal of a matrix of size one to two, this moves no eigenvalue by a rounding.
const NEGLIGIBLE: f64 = 4.0 * f64::EPSILON;

#[inline]
fn is_diagonal(a: &Matrix3<f64>) -> bool {
    a[(0, 1)].abs().max(a[(0, 2)].abs()).max(a[(1, 2)].abs()) <= NEGLIGIBLE
}

/// Eigenvectors to rounding, and the matrix in their axes; none for a multiple of the identity.
#[inline]
fn guess(a: &Matrix3<f64>) -> Option<(Matrix3<f64>, Matrix3<f64>)> {
    let mean = (a[(0, 0)] + a[(1, 1)] + a[(2, 2)]) * (1.0 / 3.0);
    let (b11, b22, b33) = (a[(0, 0)] - mean, a[(1, 1)] - mean, a[(2, 2)] - mean);
    let (b12, b13, b23) = (a[(0, 1)], a[(0, 2)], a[(1, 2)]);
    let (s12, s13, s23) = (b12 * b12, b13 * b13, b23 * b23);
    let square =
        (b11 * b11 + b22 * b22 + b33 * b33) * (1.0 / 6.0) + (s12 + s13 + s23) * (1.0 / 3.0);
    if square < 1e-28 {
        return None;
    }
    let scale = square.sqrt();
    let determinant =
        b11 * (b22 * b33 - s23) - b12 * (b12 * b33 - b13 * b23) + b13 * (b12 * b23 - b13 * b22);
    // Eigenvalues of the deviator are 2 scale cos φ with cos 3φ = r: the isolated one has the sign of
    // r, and x = its magnitude over the scale solves x³ − 3x = 2|r|, √3 ≤ x ≤ 2.
    let r = determinant / square / scale;
    let half = (0.5 * r.abs()).min(1.0);
    // A polynomial to 8e-6, and Halley's method once.
    let x = (1.732_058_68 + half * 0.332_890_75)
        + (half * half) * ((-0.092_173_82 + half * 0.035_545_72) - (half * half) * 0.008_329_21);
    let (f, g) = (x * (x * x - 3.0) - 2.0 * half, x * x - 1.0);
    let x = x - f * g / (3.0 * g * g - x * f);
    let isolated = (x * scale).copysign(r);
    let (m11, m22, m33) = (b11 - isolated, b22 - isolated, b33 - isolated);
    let rows =
        [Vector3::new(m11, b12, b13), Vector3::new(b12, m22, b23), Vector3::new(b13, b23, m33)];
    // Any two rows that are not parallel have the eigenvector as their cross product.
    let (mut v, mut square) = (Vector3::zeros(), 0.0);
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        let cross = rows[i].cross(&rows[j]);
        if cross.norm_squared() > square {
            (v, square) = (cross, cross.norm_squared());
        }
    }
    if square == 0.0 {
        return None;
    }
    // Here and below, roots and quotients are arranged not to wait for each other: they take most of
    // the time.
    let length = square.sqrt();
    // Two directions across it without a square root (Duff et al. 2017, JCGT 6(1)).
    let sign = 1.0_f64.copysign(v.z);
    let m = -length / (length.copysign(v.z) + v.z);
    v *= 1.0 / length;
    let xy = v.x * v.y * m;
    let u = Vector3::new(1.0 + sign * v.x * v.x * m, sign * xy, -sign * v.x);
    let w = Vector3::new(xy, sign + v.y * v.y * m, -v.y);
    let (au, aw, av) = (a * u, a * w, a * v);
    let (p, q, pq) = (u.dot(&au), w.dot(&aw), u.dot(&aw));
    let (s, c, shift) = rotation(p, q, pq);
    let axes = Matrix3::from_columns(&[u * c - w * s, u * s + w * c, v]);
    let (e1, e2) = (axes.column(0).dot(&av), axes.column(1).dot(&av));
    let d = Matrix3::new(p - shift, 0.0, e1, 0.0, q + shift, e2, e1, e2, v.dot(&av));
    Some((d, axes))
}

/// Sine and cosine of the rotation that takes off the entry pq between the diagonal entries p and q,
/// and by how much these move apart.
fn rotation(p: f64, q: f64, pq: f64) -> (f64, f64, f64) {
    if pq.abs() < 1e-100 {
        // Nothing beside a matrix of size one, and its square could vanish.
        return (0.0, 1.0, 0.0);
    }
    let (x, y) = ((q - p).abs(), (2.0 * pq).copysign(pq * (q - p)));
    let adjacent = x + (x * x + y * y).sqrt();
    let square = adjacent * adjacent + y * y;
    let scale = square.sqrt() * (1.0 / square);
    (y * scale, adjacent * scale, y / adjacent * pq)
}

/// Cyclic Jacobi rotations of a symmetric matrix of size one that is a in the axes v, to a diagonal
/// one.
#[cold]
fn jacobi(mut a: Matrix3<f64>, mut v: Matrix3<f64>) -> (Matrix3<f64>, Matrix3<f64>) {
    // Convergence is quadratic: four sweeps are the rule, and sixteen never happen.
    const SWEEPS: usize = 16;
    for _ in 0..SWEEPS {
        let mut rotated = false;
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let apq = a[(p, q)];
            if apq.abs() <= NEGLIGIBLE {
                continue;
            }
            rotated = true;
            let (s, c, shift) = rotation(a[(p, p)], a[(q, q)], apq);
            a[(p, p)] -= shift;
            a[(q, q)] += shift;
            a[(p, q)] = 0.0;
            a[(q, p)] = 0.0;
            let r = 3 - p - q;
            let (arp, arq) = (a[(r, p)], a[(r, q)]);
            a[(r, p)] = c * arp - s * arq;
            a[(r, q)] = s * arp + c * arq;
            a[(p, r)] = a[(r, p)];
            a[(q, r)] = a[(r, q)];
            for k in 0..3 {
                let (vp, vq) = (v[(k, p)], v[(k, q)]);
                v[(k, p)] = c * vp - s * vq;
                v[(k, q)] = s * vp + c * vq;
            }
        }
        if !rotated {
            break;
        }
    }
    (a, v)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use proptest::prelude::*;

    #[test]
    fn diagonal_matrices_return_as_they_are() {
        let (values, vectors) = eigen(&Matrix3::from_diagonal(&Vector3::new(3.0, 5.0, 4.0)));
        assert_eq!(values, [3.0, 5.0, 4.0]);
        assert_eq!(vectors, Matrix3::identity());
    }

    /// Equal moments across an isolated one, coupled by an entry whose square vanishes: gave NaN.
    #[test]
    fn an_entry_too_small_to_square_is_nothing() {
        for tiny in [5e-324, 1e-200, 1e-170, 1e-110, 1e-20] {
            let m = Matrix3::new(0.5, tiny, 0.0, tiny, 1.0, 0.5, 0.0, 0.5, 1.0);
            let mut found = eigen(&m).0;
            found.sort_by(f64::total_cmp);
            for (a, b) in found.iter().zip([0.5, 0.5, 1.5]) {
                assert!((a - b).abs() < 1e-15, "{tiny:e}: {found:?}");
            }
        }
    }

    /// Matrices in random frames, with moments apart and next to equal, against 60 digits (mpmath
    /// `eigsy` of the entries as they stand): three units in the last place of the trace at most.
    #[test]
    fn nearly_equal_moments_keep_their_digits() {
        for (e, exact) in reference() {
            let m = Matrix3::new(e[0], e[3], e[4], e[3], e[1], e[5], e[4], e[5], e[2]);
            let mut found = eigen(&m).0;
            found.sort_by(f64::total_cmp);
            for (a, b) in found.iter().zip(exact) {
                let ulps = (a - b).abs() / (f64::EPSILON * m.trace());
                assert!(ulps < 3.0, "{e:?}: {a} {b}, {ulps} ulp");
            }
        }
    }

    #[rustfmt::skip]
    fn reference() -> Vec<([f64; 6], [f64; 3])> {
        vec![
            ([2.091180241605673, 2.613499453188469, 1.295320305205858, 0.27830256973285283, 0.44435471671022037, 0.5333499053426166], [1.0, 2.0, 3.0]),
            ([2.924077923779776, 1.686599991340923, 1.3893220848793009, -0.0720292189085668, -0.2927888843163034, 0.49654095049031827], [0.9999999999999999, 2.0, 3.0]),
            ([1.4710309186890596, 1.020094679442668, 1.5089744018682723, -0.09713527858809201, -0.4896098101116428, 0.10090859411363574], [0.9999999999999999, 1.0001, 2.0]),
            ([1.043283746207102, 1.3970656739624112, 1.5597505798304867, -0.13094426136233053, 0.15554406937222195, -0.47141486614939043], [1.0, 1.0001, 2.0]),
            ([1.4510170198721977, 1.0482903844815281, 1.5006926056462742, 0.14757975776124435, -0.4752061419906685, -0.15549481764728787], [0.9999999999999999, 1.00000001, 2.0]),
            ([1.2343273672774377, 1.1954254525620958, 1.5702471901604667, 0.21399423050826252, 0.3655468708152919, 0.333827521815134], [1.0, 1.00000001, 2.0]),
            ([1.0675943377706718, 1.1890358171930135, 1.7433698450373145, -0.11303871406675174, 0.2241597474875306, -0.37486467709403887], [0.9999999999999999, 1.000000000001, 2.0]),
            ([1.8468055594364177, 1.0612457636319788, 1.0919486769326037, 0.22773505030039923, 0.27903879803468906, 0.07504310050603126], [1.0, 1.000000000001, 2.0]),
            ([1.1524973738131399, 1.4295077426088523, 1.4179948935780078, -0.25592733364772785, 0.2524739944449435, -0.4237122154268224], [1.0, 1.00000001, 2.0]),
            ([1.0306885838345334, 1.0208046235952766, 1.94850680257019, -0.0252678535734026, 0.17061162330074672, -0.1404753413918595], [1.0, 1.00000001, 2.0]),
            ([0.9999999987151331, 0.9999999971674745, 1.0000000041173922, -1.91205570756694e-09, 4.831603721617412e-09, 7.72568100880905e-09], [0.99999999, 1.0, 1.00000001]),
            ([1.0000000000854332, 0.9999999935266859, 1.0000000063878807, -8.086871480385734e-10, 2.5331512343881782e-09, 7.1813030378794405e-09], [0.99999999, 0.9999999999999999, 1.00000001]),
            ([1.000000000000064, 0.9999999999978316, 1.0000000000001044, 1.015182032581358e-13, -2.2313495942058938e-13, -1.6067953300212057e-12], [0.999999999997, 1.0, 1.000000000001]),
            ([1.0000000000007556, 0.9999999999974671, 0.9999999999997773, 4.785007339384225e-13, 2.5122797262340864e-13, 1.0909516930192088e-12], [0.999999999997, 1.0, 1.000000000001]),
            ([1.0000965593893707, 0.9990448224977397, 1.0008586181128893, 0.00012583020352997925, -0.0003437323073471681, 0.00019120261667793297], [0.999, 1.0, 1.001]),
            ([1.0004008748237478, 0.9996144163297187, 0.9999847088465333, -0.0007229187306211287, 0.00013182234389251196, -0.0005524552229179789], [0.999, 1.0, 1.001]),
            ([0.8016114597563678, 0.6391655697800562, 0.5592229804635759, 0.267554512611131, 0.2957111938159166, -0.39880763870769026], [2.6006331194630917e-17, 1.0, 1.00000001]),
            ([0.9951906149973571, 0.9553397789740853, 0.049469616028557595, -0.014655670085486273, 0.06761267229934957, 0.20603616112067252], [4.838878038067971e-18, 1.0, 1.00000001]),
            ([0.9523950485359812, 0.2751313519426632, 0.7724745995213556, 0.1857615051848968, -0.10407370295428768, 0.4061108585640861], [9.999999999560603e-07, 1.0, 1.0]),
            ([0.9332870454014253, 0.7144621458774688, 0.35225180872110595, -0.13801838246498502, -0.20787783834766457, -0.43006584210970106], [9.999999999804246e-07, 1.0, 1.0]),
            ([0.6923691609345273, 0.5909689190516105, 0.7166619400138621, -0.35472605584591865, 0.2952347030465178, 0.3404321931599761], [9.999999995644386e-09, 1.0, 1.00000001]),
            ([0.03520774462345838, 0.9717087885213798, 0.9930834868551618, 0.16521242671003253, 0.08168845559425134, -0.013988454719015279], [1.0000000000643495e-08, 1.0, 1.00000001]),
            ([3.617427995308292, 4.383751773194048, 3.9988202314976604, -0.463379375305271, 0.7518502975262664, -0.2705302342119968], [3.0, 4.0, 5.0]),
            ([3.4704962118125753, 4.414871220326902, 4.1146325678605224, 0.04512909136095208, -0.6620227452600363, -0.5717278561378378], [3.0, 4.0, 5.0]),
            ([826.9933631735944, 911.1572681720652, 263.3483686543404, 123.97717177719255, -356.9940164864166, 255.82431744675236], [1.4999999999999911, 999.999, 1000.0]),
            ([287.18613893494967, 899.6899333542419, 814.6229277108084, 267.3982578621312, -363.50956689292013, 136.3631438710331], [1.500000000000026, 999.999, 1000.0]),
        ]
    }

    proptest! {
        #[test]
        fn reconstructs(
            d in prop::array::uniform3(-1.0..1.0f64),
            o in prop::array::uniform3(-1.0..1.0f64),
            exponent in -300..300i32,
        ) {
            let scale = 10f64.powi(exponent);
            let m = Matrix3::new(d[0], o[0], o[1], o[0], d[1], o[2], o[1], o[2], d[2]) * scale;
            let (values, v) = eigen(&m);
            let back = v * Matrix3::from_diagonal(&Vector3::from(values)) * v.transpose();
            prop_assert!((back - m).amax() <= 1e-14 * scale);
            prop_assert!((v * v.transpose() - Matrix3::identity()).amax() < 1e-14);
            prop_assert!((v.determinant() - 1.0).abs() < 1e-14);
        }
    }
}
