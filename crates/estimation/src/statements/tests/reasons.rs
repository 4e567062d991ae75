//! Why a product does not come out as it is stated: what is named would let it come nearer if it were not stated.

use super::*;

/// Random bodies about random axes, of which axes, products and mostly moments are stated.
#[test]
fn what_keeps_a_product_from_more_is_what_it_would_gain_by() {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    let mut told = [0; 3];
    for _ in 0..24 {
        let k = [0; 3].map(|_| rng.random_range(1.0..10.0));
        let attitude = UniformAttitude.sample(&mut rng);
        let nominal =
            Inertia::from_second_moments(SecondMoments::new(k).unwrap(), &attitude).unwrap();
        let degrees = [0; 3].map(|_| libm::pow(10.0, rng.random_range(-1.0..1.3)));
        let sizes = [0; 3].map(|_| libm::pow(10.0, rng.random_range(-2.0..0.5)));
        let share = libm::pow(10.0, rng.random_range(-2.0..1.5));
        let statements = Statements {
            axes: Some(AxesStatement::each(degrees, 1.0).unwrap()),
            products: Some(ProductsStatement::new(sizes, 1.0).unwrap()),
            moments: percent(share).filter(|_| rng.random_bool(0.8)),
            ..Statements::default()
        };
        let model = statements.model(&nominal, None).unwrap();
        let without = Statements { axes: None, ..statements };
        let alone = Statements { moments: None, ..without };
        let of = |statements: &Statements, entry: usize| {
            let model = statements.model(&nominal, None).unwrap();
            model.implied().deviations()[entry].min(sizes[entry - 3])
        };
        for warning in model.warnings() {
            let StatementWarning::Missed { entry, stated, implied, because } = *warning else {
                continue;
            };
            let most = 0.1 * (stated - implied).max(0.0);
            match because {
                MissedBecause::AxesLimit => {
                    told[0] += 1;
                    let reached = model.turns().into_iter().zip(degrees);
                    assert!(reached.into_iter().any(|(t, limit)| t > 0.96 * limit.to_radians()));
                    assert!(of(&without, entry) - implied > most, "{warning}");
                }
                MissedBecause::MomentsLimit => {
                    told[1] += 1;
                    assert!(statements.moments.is_some());
                    assert!(of(&alone, entry) - implied > most, "{warning}");
                }
                MissedBecause::Rotations => {
                    told[2] += 1;
                    assert!(stated - of(&alone, entry) > 3.0 * most, "{warning}");
                }
                MissedBecause::Axes { .. }
                | MissedBecause::Moments { .. }
                | MissedBecause::Mass { .. }
                | MissedBecause::Together
                | MissedBecause::Tied => {}
            }
        }
    }
    assert!(told.into_iter().all(|count| count >= 3), "{told:?}");
}

/// What is said to move an entry more than it may is most of what comes out, and draws of it alone scatter so.
#[test]
fn what_moves_an_entry_more_moves_it_alone() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut told = [0; 2];
    for round in 0..90 {
        let k = [0; 3].map(|_| rng.random_range(1.0..10.0));
        let about = UniformAttitude.sample(&mut rng);
        let nominal = Inertia::from_second_moments(SecondMoments::new(k).unwrap(), &about).unwrap();
        // Its axes by the size of their moments.
        let (second_moments, attitude) =
            (nominal.second_moments(), nominal.principal_axes().attitude());
        let axes = libm::pow(10.0, rng.random_range(-1.0..1.0));
        let statements = Statements {
            axes: Some(AxesStatement::each([axes; 3], 1.0).unwrap()),
            products: [Some(0.0), Some(1e-3), None][round % 3].and_then(|x| products(x, 1.0)),
            moments: percent(libm::pow(10.0, rng.random_range(-1.0..1.0))),
            ..Statements::default()
        };
        let model = statements.model(&nominal, None).unwrap();
        for warning in model.warnings() {
            let StatementWarning::Missed { entry, implied, because, .. } = *warning else {
                continue;
            };
            let (roots, turns) = model.law().clone().into_parts();
            let mut deviation = |draw: &mut dyn FnMut(&mut ChaCha8Rng) -> Inertia| {
                let draws: Vec<f64> =
                    (0..20_000).map(|_| draw(&mut rng).entries()[entry]).collect();
                let mean = draws.iter().sum::<f64>() / 20_000.0;
                (draws.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 19_999.0).sqrt()
            };
            let (alone, found) = match because {
                MissedBecause::Axes { alone } => {
                    told[0] += 1;
                    let of = |q| Inertia::from_second_moments(second_moments, &q).unwrap();
                    (alone, deviation(&mut |rng| of(turns.sample(rng))))
                }
                MissedBecause::Moments { alone } => {
                    told[1] += 1;
                    let of = |k: RootSecondMoments| {
                        Inertia::from_second_moments(k.squared(), &attitude).unwrap()
                    };
                    (alone, deviation(&mut |rng| of(roots.sample(rng))))
                }
                _ => continue,
            };
            assert!(alone > 0.5 * implied && alone < 1.01 * implied, "{warning}");
            assert!((found / alone - 1.0).abs() < 0.1, "{warning}: {found:e}");
        }
    }
    assert!(told.into_iter().all(|count| count >= 3), "{told:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// The mass multiplies all moments alike: however much it scatters, the axes of no body mean less for it.
    #[test]
    fn the_mass_makes_no_moments_equal(
        k in prop::array::uniform3(1.0..100.0_f64),
        turn in prop::array::uniform3(-3.0..3.0_f64),
        degrees in prop::option::of(prop::array::uniform3(0.05..5.0_f64)),
        percent in 1.0..100.0_f64,
    ) {
        let q = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
        let nominal = Inertia::from_second_moments(SecondMoments::new(k).unwrap(), &q).unwrap();
        let mass = Some(MassStatement::percent(percent, 1.0).unwrap());
        let axes = degrees.map(|degrees| AxesStatement::each(degrees, 1.0).unwrap());
        let model = Statements { mass, axes, ..Statements::default() }.model(&nominal, None).unwrap();
        let is_it = |w: &&StatementWarning| matches!(w, StatementWarning::EqualMoments { .. });
        prop_assert_eq!(model.warnings().iter().find(is_it), None);
    }
}
