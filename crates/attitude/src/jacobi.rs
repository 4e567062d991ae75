//! Eigenvalues of small symmetric matrices that keep small ones relatively accurate.

use nalgebra::SMatrix;

/// Eigenvalues and eigenvectors (columns, det = +1) of a symmetric matrix by cyclic Jacobi
/// rotations, stopped only when every off-diagonal entry is negligible beside *its own* two
/// diagonal entries. For a positive definite matrix that keeps the small eigenvalues relatively
/// accurate, however large the others are (Demmel & Veselić 1992, doi:10.1137/0613074).
pub(crate) fn eigen<const N: usize>(matrix: &SMatrix<f64, N, N>) -> ([f64; N], SMatrix<f64, N, N>) {
    const SWEEPS: usize = 30;
    let mut a = *matrix;
    let mut v = SMatrix::identity();
    for _ in 0..SWEEPS {
        let mut rotated = false;
        for (p, q) in (0..N).flat_map(|p| (p + 1..N).map(move |q| (p, q))) {
            let apq = a[(p, q)];
            let scale = a[(p, p)].abs().sqrt() * a[(q, q)].abs().sqrt();
            if apq.abs() <= 1e-3 * f64::EPSILON * scale || apq == 0.0 {
                continue;
            }
            rotated = true;
            let theta = 0.5 * (a[(q, q)] - a[(p, p)]) / apq;
            let t = 1.0_f64.copysign(theta) / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            a[(p, p)] -= t * apq;
            a[(q, q)] += t * apq;
            a[(p, q)] = 0.0;
            a[(q, p)] = 0.0;
            for r in (0..N).filter(|&r| r != p && r != q) {
                let (arp, arq) = (a[(r, p)], a[(r, q)]);
                a[(r, p)] = c * arp - s * arq;
                a[(r, q)] = s * arp + c * arq;
                a[(p, r)] = a[(r, p)];
                a[(q, r)] = a[(r, q)];
            }
            for r in 0..N {
                let (vrp, vrq) = (v[(r, p)], v[(r, q)]);
                v[(r, p)] = c * vrp - s * vrq;
                v[(r, q)] = s * vrp + c * vrq;
            }
        }
        if !rotated {
            break;
        }
    }
    (std::array::from_fn(|i| a[(i, i)]), v)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix4, Vector4};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn graded_matrices_keep_their_small_eigenvalues(
            d in prop::array::uniform4(-4.0..4.0f64),
            o in prop::array::uniform6(-0.2..0.2f64),
        ) {
            // D A D with a well-conditioned A: the reference inverts first, which exchanges the
            // roles of large and small.
            let d = Vector4::from(d.map(|x| 10f64.powf(x)));
            let a = Matrix4::new(
                1.0, o[0], o[1], o[2], o[0], 1.0, o[3], o[4],
                o[1], o[3], 1.0, o[5], o[2], o[4], o[5], 1.0,
            );
            let outer = Matrix4::from_diagonal(&d);
            let m = outer * a * outer;
            let inner = Matrix4::from_diagonal(&d.map(|x| 1.0 / x));
            let inverse = inner * a.try_inverse().unwrap() * inner;
            let mut direct = eigen(&m).0;
            let mut reciprocal = eigen(&inverse).0.map(|x| 1.0 / x);
            direct.sort_by(f64::total_cmp);
            reciprocal.sort_by(f64::total_cmp);
            for (x, y) in direct.iter().zip(reciprocal) {
                prop_assert!((x / y - 1.0).abs() < 1e-12, "{direct:?} {reciprocal:?}");
            }
        }

        #[test]
        fn reconstructs(x in prop::array::uniform16(-1.0..1.0f64)) {
            let m = Matrix4::from_row_slice(&x);
            let m = m + m.transpose();
            let (values, v) = eigen(&m);
            let back = v * Matrix4::from_diagonal(&Vector4::from(values)) * v.transpose();
            prop_assert!((back - m).amax() < 1e-14);
            prop_assert!((v * v.transpose() - Matrix4::identity()).amax() < 1e-14);
        }
    }
}
