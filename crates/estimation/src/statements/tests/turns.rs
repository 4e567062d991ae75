//! Stated turns of the axes, as they are drawn.

use super::*;

/// Narrow axes turn by what is stated, wide ones a little farther, as the documentation says.
#[test]
fn wide_axes_turn_farther_than_stated() {
    let nominal = body([10.0, 8.0, 5.0], [0.0; 3]);
    let mut rng = ChaCha8Rng::seed_from_u64(45);
    for (stated, drawn) in [
        ([2.0, 3.0, 1.0], [2.0, 3.0, 1.0]),
        ([0.0, 0.0, 45.0], [0.0, 0.0, 47.2]),
        ([5.0, 20.0, 40.0], [5.15, 20.75, 41.24]),
    ] {
        let axes = AxesStatement::each(stated, 1.0).unwrap();
        let statements = Statements { axes: Some(axes), ..Statements::default() };
        let model = statements.model(&nominal, None).unwrap();
        let axes = model.law().axes();
        const N: usize = 40_000;
        let mut squares = Vector3::zeros();
        for _ in 0..N {
            let turned = axes.sample(&mut rng).scaled_axis();
            squares += turned.component_mul(&turned);
        }
        for (i, drawn) in drawn.into_iter().enumerate() {
            let found = (squares[i] / N as f64).sqrt().to_degrees();
            assert!((found - drawn).abs() < 0.015 * drawn + 1e-3, "{stated:?}: {found} {drawn}");
        }
    }
}
