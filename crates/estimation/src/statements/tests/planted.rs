//! What a law has can be stated: laws that are planted are found again, and the answer is the same about axes of other names and
//! directions.

use super::*;
use crate::turns::law_of_turns;
use gyradius_dispersion::RootLaw;

fn stated(moments: Option<[f64; 3]>, products: Option<[f64; 3]>) -> Statements {
    Statements {
        moments: moments.map(|x| MomentsStatement::new(Amount::Absolute(x), 1.0).unwrap()),
        products: products.map(|x| ProductsStatement::new(x, 1.0).unwrap()),
        ..Statements::default()
    }
}

/// Random laws with independent roots and turns: moments and products that are those of such a law come out, and by independent
/// roots.
#[test]
fn planted_laws_are_found() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let mut log = |least: f64, most: f64| libm::pow(10.0, rng.random_range(least..most));
    let mut had = 0;
    for case in 0..60 {
        let k = [0; 3].map(|_| log(-1.0, 1.0));
        let turn = Vector3::new(log(-3.0, 0.3), -log(-3.0, 0.3), log(-3.0, 0.3));
        let about = UnitQuaternion::from_scaled_axis(turn);
        let nominal = Inertia::from_second_moments(SecondMoments::new(k).unwrap(), &about).unwrap();
        let roots = nominal.second_moments().roots();
        let deviations = roots.values().map(|k| k * log(-2.0, -0.7));
        let turns = [0; 3].map(|_| log(-2.0, -0.9));
        let law = PrincipalDispersion::new(
            ScalarRoots::normal(roots, deviations.map(|d| d * d)).unwrap(),
            law_of_turns(nominal.principal_axes().attitude(), turns.map(|t| t * t)).unwrap(),
        );
        let planted = EntryMoments::of(&law).deviations();
        let [i11, i22, i33, i12, i13, i23] = planted;
        let statements = stated(Some([i11, i22, i33]), Some([i12, i13, i23]));
        let model = statements.model(&nominal, None).unwrap();
        let found = model.implied().deviations();
        for e in 0..6 {
            let small =
                1e-3 * planted[e / 3 * 3..e / 3 * 3 + 3].iter().fold(0.0, |a: f64, b| a.max(*b));
            let off = (found[e] - planted[e]).abs();
            assert!(off < 0.01 * planted[e] + small, "{case}: {planted:?} {found:?}");
        }
        had += usize::from(matches!(model.law().roots(), RootLaw::Independent(_)));
    }
    assert!(had >= 58, "{had} of 60");
}

/// Axes under other names, the second of them with other directions.
const RENAMED: [[[f64; 3]; 3]; 2] = [
    [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]],
];

/// Statements that can be had and that cannot: about axes that are named and pointed otherwise they come to the same.
#[test]
fn names_and_directions_of_axes_make_no_difference() {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    let mut cases = vec![
        (body([26.1, 35.2, 38.7], [-0.5, -1.6, -4.5]), None, Some([0.18, 1.5, 4.26])),
        (body([31.2, 35.7, 33.2], [0.1, -4.5, -2.1]), None, Some([1.08; 3])),
        (
            body([6.611, 9.957, 7.682], [1.119, 2.66, 1.358]),
            Some([0.785, 1.54, 1.02]),
            Some([0.325, 0.752, 0.29]),
        ),
    ];
    for case in 0..12 {
        let k = [0; 3].map(|_| rng.random_range(1.0..9.0));
        let about = UniformAttitude.sample(&mut rng);
        let nominal = Inertia::from_second_moments(SecondMoments::new(k).unwrap(), &about).unwrap();
        let mut three = || [0; 3].map(|_| libm::pow(10.0, rng.random_range(-1.5..0.3)));
        let (moments, products) = (three(), three());
        cases.push((
            nominal,
            Some(moments).filter(|_| case % 3 < 2),
            Some(products).filter(|_| case % 3 > 0),
        ));
    }
    for (nominal, moments, products) in cases {
        let own = stated(moments, products).model(&nominal, None).unwrap();
        for rows in RENAMED {
            let p = Matrix3::from_fn(|i, j| rows[i][j]);
            let names = p.map(f64::abs);
            let of = |x: [f64; 3]| -> [f64; 3] { (names * Vector3::from(x)).into() };
            // Products by the axis that they leave out.
            let pairs = |[a, b, c]: [f64; 3]| {
                let [c, b, a] = of([c, b, a]);
                [a, b, c]
            };
            let renamed = Inertia::new(p * nominal.matrix() * p.transpose()).unwrap();
            let there = stated(moments.map(of), products.map(pairs)).model(&renamed, None).unwrap();
            let [i11, i22, i33, i12, i13, i23] = own.implied().deviations();
            let ([x, y, z], [xy, xz, yz]) = (of([i11, i22, i33]), pairs([i12, i13, i23]));
            let found = there.implied().deviations();
            let largest = found.into_iter().fold(0.0, f64::max);
            for (found, expected) in found.into_iter().zip([x, y, z, xy, xz, yz]) {
                let off = (found - expected).abs();
                assert!(
                    off < 1e-3 * largest,
                    "{nominal:?} {moments:?} {products:?}: {found} {expected}"
                );
            }
        }
    }
}
