//! The same body in another size: a table in other units, or a body a thousand times as heavy.

use super::*;

/// What is stated of moments and products can hardly be had together, so that the search goes through valleys.
fn stated(percent: [f64; 3], share: [f64; 3], mass: Option<f64>, trace: f64) -> Statements {
    let products = share.map(|share| share * trace);
    Statements {
        moments: Some(MomentsStatement::new(Amount::Percent(percent), 1.0).unwrap()),
        products: Some(ProductsStatement::new(products, 1.0).unwrap()),
        mass: mass.map(|percent| MassStatement::percent(percent, 1.0).unwrap()),
        ..Statements::default()
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// The law of a body is that of the same body in another size.
    #[test]
    fn the_size_of_a_body_does_not_matter(
        k in prop::array::uniform3(0.02..1.0_f64),
        turn in prop::array::uniform3(-3.0..3.0_f64),
        percent in prop::array::uniform3(1.0..15.0_f64),
        share in prop::array::uniform3(0.001..0.03_f64),
        mass in prop::option::of(0.5..20.0_f64),
        size in -9.0..9.0_f64,
    ) {
        let q = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
        let factor = libm::exp(2.0 * size);
        let covariances = [1.0, factor].map(|factor| {
            let k = SecondMoments::new(k.map(|k| k * factor)).unwrap();
            let nominal = Inertia::from_second_moments(k, &q).unwrap();
            let stated = stated(percent, share, mass, nominal.matrix().trace());
            let model = stated.model(&nominal, Some(factor)).unwrap();
            model.implied().covariance() / (factor * factor)
        });
        let error = (covariances[1] - covariances[0]).amax() / covariances[0].amax();
        prop_assert!(error < 1e-6, "{error}");
    }
}
