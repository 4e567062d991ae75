use nalgebra::Matrix3;

/// Eigenvalues and eigenvectors (columns) of a symmetric matrix by cyclic Jacobi rotations
/// (Golub & Van Loan, *Matrix Computations*, 4th ed., §8.5).
///
/// Closed forms lose half the digits where eigenvalues are close, which inertia matrices are all
/// the time; Jacobi does not, and uses square roots only, so that it gives the same bits
/// everywhere. The eigenvectors form a rotation: det = +1. A diagonal matrix returns unchanged
/// with the identity.
pub(crate) fn eigen(matrix: &Matrix3<f64>) -> ([f64; 3], Matrix3<f64>) {
    // Convergence is quadratic: four sweeps are the rule, and sixteen never happen.
    const SWEEPS: usize = 16;
    let size = matrix.amax();
    if size == 0.0 {
        return ([0.0; 3], Matrix3::identity());
    }
    let mut a = matrix.map(|x| x / size);
    let mut v = Matrix3::identity();
    for _ in 0..SWEEPS {
        let mut rotated = false;
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let apq = a[(p, q)];
            // Below this an off-diagonal entry moves no eigenvalue by a rounding.
            if apq.abs() <= 1e-3 * f64::EPSILON {
                continue;
            }
            rotated = true;
            let theta = (a[(q, q)] - a[(p, p)]) / (2.0 * apq);
            let t = 1.0_f64.copysign(theta) / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            a[(p, p)] -= t * apq;
            a[(q, q)] += t * apq;
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
    ([a[(0, 0)] * size, a[(1, 1)] * size, a[(2, 2)] * size], v)
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
