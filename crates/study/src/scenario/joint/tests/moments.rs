//! Joint laws, however they are said, against their exact moments.

use super::*;

/// Roots with a mass that the inertia follows wholly, and lengths with the same numbers, are one law: the same draws but for
/// rounding, with the exact moments of that law.
#[test]
fn two_ways_to_say_a_law_are_one_law() {
    let mass = "axes = \"fixed\"\nmass_percent = 5.0\nmass_centre_m = 0.01\n";
    let spread = [0.01, 0.008, 0.012];
    let variances = spread.map(|s: f64| s * s * MASS);
    let correlations = |size: &str| {
        let size = |i: usize| size.replace('N', &i.to_string());
        format!(
            "[[correlations]]\nbetween = [\"payload_mass_kg\", \"{}\"]\ncoefficient = 0.7\n\
             [[correlations]]\nbetween = [\"{}\", \"{}\"]\ncoefficient = -0.6\n\
             [[correlations]]\nbetween = [\"payload_mass_centre_1_m\", \"{}\"]\ncoefficient = 0.5\n",
            size(1),
            size(2),
            size(3),
            size(3)
        )
    };
    for correlated in [false, true] {
        let rest = |size: &str| if correlated { correlations(size) } else { String::new() };
        let roots = format!(
            "[payload.dispersion]\nroot_second_moment_variance_kg_m2 = {variances:?}\ninertia_follows_mass = true\n{mass}"
        );
        let by_lengths = format!("[payload.dispersion]\ngyration_lengths_m = {spread:?}\n{mass}");
        let a = read(&roots, &rest("payload_root_N_sqrt_kg_m"));
        let b = read(&by_lengths, &rest("payload_gyration_length_N_m"));
        let [a, b] = [&a, &b].map(|scenario| bodies(scenario, 0, 20_000));
        let normal = |mean: f64, sigma: f64| ScalarLaw::normal(mean, sigma).unwrap();
        let nominal = lengths();
        let tensor = TensorLaw::gyration_lengths(
            [0, 1, 2].map(|i| normal(nominal[i], spread[i])),
            fixed_axes(),
        );
        let law = MassPropertiesLaw::new(
            normal(MASS, 0.05 * MASS),
            [0, 1, 2].map(|_| normal(0.0, 0.01)),
            tensor,
        );
        let pairs = [
            (JointScalar::Mass, JointScalar::Shape1, 0.7),
            (JointScalar::Shape2, JointScalar::Shape3, -0.6),
            (JointScalar::Centre1, JointScalar::Shape3, 0.5),
        ];
        let law = law.unwrap();
        let tied = law.clone().with_correlation(&pairs).unwrap();
        let expected = if correlated { &tied } else { &law }.moments().unwrap();
        for bodies in [&a, &b] {
            let worst = worst(&expected, bodies);
            assert!(worst < 5.0, "{correlated} {worst}");
        }
        if correlated {
            // Without the correlations these are not its moments, nor with a mass that it does not follow.
            assert!(worst(&law.moments().unwrap(), &a) > 20.0);
        } else {
            // Each of its own streams where correlated, whose names differ.
            for (a, b) in a.iter().zip(&b) {
                assert!((ten(a) - ten(b)).amax() < 1e-10 * ten(a).amax(), "{a:?} {b:?}");
            }
        }
    }
}

/// Any whole law has the moments that it has by itself, of a body of another nominal mass too, and is drawn in its region.
#[test]
fn whole_laws_are_drawn_as_they_are() {
    let mut rng = ChaCha8Rng::seed_from_u64(61);
    for case in 0..36 {
        let mut pick = |n: usize| rng.random_range(0..n);
        let nominal = lengths();
        let axes: AxesLaw = match pick(3) {
            0 => UniformAttitude.into(),
            1 => fixed_axes().into(),
            _ => {
                let covariance = Matrix4::from_diagonal(&Vector4::new(1e-3, 2e-3, 1e-3, 0.5));
                let mean = fixed_axes().attitude();
                RadiallyConstrainedGaussian::new(mean, covariance).unwrap().into()
            }
        };
        let mut sizes =
            |unit: f64| [0, 1, 2].map(|i| scalar(pick(9), nominal[i] * unit, 0.01 * unit));
        let tensor = match case % 4 {
            0 => TensorLaw::gyration_lengths(sizes(1.0), axes),
            1 => TensorLaw::roots(sizes(MASS.sqrt()), axes),
            2 => TensorLaw::roots(sizes(MASS.sqrt()), axes).with_follows(0.6, 140.0).unwrap(),
            _ => {
                let wishart = Wishart::new(Inertia::try_from(inertia()).unwrap(), 0.1).unwrap();
                TensorLaw::model(wishart).unwrap().with_follows(1.0, 150.0).unwrap()
            }
        };
        let mut pick = |n: usize| rng.random_range(0..n);
        let centre = [0.03, 0.01, 0.2].map(|mean| scalar(pick(9), mean, 0.01));
        let law = MassPropertiesLaw::new(scalar(pick(9), 135.0, 8.0), centre, tensor).unwrap();
        let pairs = [
            (JointScalar::Mass, JointScalar::Centre3, 0.6),
            (JointScalar::Mass, JointScalar::Shape2, -0.7),
            (JointScalar::Shape1, JointScalar::Shape3, 0.5),
        ];
        let pairs = &pairs[..if case % 4 == 3 { 1 } else { 3 }];
        // What does not vary has no correlation.
        let tied = |law: &MassPropertiesLaw, pair| law.clone().with_correlation(&[pair]).is_ok();
        let pairs: Vec<_> = pairs.iter().copied().filter(|pair| tied(&law, *pair)).collect();
        let law = if pick(3) > 0 { law.with_correlation(&pairs).unwrap() } else { law };
        let scenario = with_law(&law, "");
        let again = Scenario::from_toml(&scenario.to_toml()).unwrap();
        assert_eq!(again.to_toml(), scenario.to_toml());
        let drawn = bodies(&scenario, 0, 6000);
        let worst = worst(&law.moments().unwrap(), &drawn);
        // Kurtosis of laws other than normal, and 65 numbers.
        assert!(worst < 7.0, "{case} {worst}\n{}", scenario.to_toml());

        let region = Region::ellipsoid([0.03, 0.0, 0.2], [0.56, 0.6, 0.58]).unwrap();
        let Ok(law) = law.inside(region.clone()) else { continue };
        let scenario = with_law(&law, "");
        let inside = |body: &MassProperties| region.containment(body) == Containment::Possible;
        assert!(bodies(&scenario, 0, 200).iter().all(inside));
        let (_, (share, error)) = Model::all(&scenario).unwrap()[0].kept().next().unwrap();
        let own = law.acceptance();
        assert!((share - own.0).abs() <= 5.0 * (error + own.1), "{share} {own:?}");
    }
}
