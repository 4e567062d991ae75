//! The numbers that Peck (2003) prints, and those that an independent program finds for its laws.

use gyradius_attitude::MeanHalf;
use gyradius_dispersion::{EntryMoments, JacobianTwice, PrincipalDispersion, ScalarRoots};
use gyradius_inertia::Inertia;
use gyradius_separation::Settings;
use gyradius_statistics::Deviation;
use gyradius_study::{Options, Quantity, Scenario, Study};
use gyradius_tests::{PaperBody, paper_separation};
use nalgebra::{UnitQuaternion, Vector3};
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::Distribution;

const DRAWS: usize = 200_000;

/// Relative standard error of the reference values below.
const REFERENCE_ERROR: f64 = 5e-4;

/// Deviations of I11, I22, I33, I12, I13, I23 in kg·m² by importance sampling with 8e6 draws in a
/// program that shares nothing with this one.
struct Reference {
    payload: [f64; 6],
    stage: [f64; 6],
}

/// Eq. 26, both lobes.
const WHOLE: Reference = Reference {
    payload: [41.863, 37.55, 36.6, 49.285, 97.492, 20.79],
    stage: [15.757, 8.231, 17.697, 7.196, 212.52, 96.297],
};
/// The half sphere around the mean.
const HALF: Reference = Reference {
    payload: [41.84, 37.525, 36.593, 48.755, 97.494, 9.955],
    stage: [15.751, 8.229, 17.701, 6.986, 212.241, 96.183],
};
/// The half sphere around the mean, the Jacobian counted twice.
const TWICE: Reference = Reference {
    payload: [42.503, 37.607, 37.336, 54.192, 131.068, 10.804],
    stage: [20.856, 8.731, 23.884, 9.206, 292.725, 128.468],
};
/// Table 2, payload.
const TABLE_2_PAYLOAD: [f64; 6] = [42.8518, 38.6060, 37.3169, 54.3897, 133.1674, 10.8535];
/// Table 2, upper stage.
const TABLE_2_STAGE: [f64; 6] = [24.1620, 8.8193, 27.298, 10.3127, 322.0596, 140.7391];

/// The deviations of the entries over many draws, with their relative standard errors.
fn deviations<A: Distribution<UnitQuaternion<f64>>>(body: &PaperBody, axes: A) -> [(f64, f64); 6] {
    let law = PrincipalDispersion::new(body.roots.clone(), axes);
    let mut rng = ChaCha8Rng::seed_from_u64(2003);
    let mut entries: [Vec<f64>; 6] = Default::default();
    for _ in 0..DRAWS {
        let inertia: Inertia = law.sample(&mut rng);
        for (column, entry) in entries.iter_mut().zip(inertia.entries()) {
            column.push(entry);
        }
    }
    entries.map(|values| {
        let d = Deviation::new(&values).unwrap();
        (d.standard_deviation(), ((d.kurtosis() - 1.0) / (4.0 * DRAWS as f64)).sqrt())
    })
}

fn assert_agree(what: &str, found: [(f64, f64); 6], expected: [f64; 6]) {
    for (entry, ((found, error), expected)) in found.into_iter().zip(expected).enumerate() {
        let z = (found / expected - 1.0) / error.hypot(REFERENCE_ERROR);
        assert!(z.abs() < 4.0, "{what}, entry {entry}: {found}, expected {expected}, z = {z}");
    }
}

fn assert_near(what: &str, found: [(f64, f64); 6], expected: [f64; 6], share: f64) {
    for (entry, ((found, _), expected)) in found.into_iter().zip(expected).enumerate() {
        let error = found / expected - 1.0;
        assert!(error.abs() < share, "{what}, entry {entry}: off by {:.1} %", 100.0 * error);
    }
}

#[test]
fn deviations_of_the_law_as_derived() {
    for (body, expected) in
        [(PaperBody::payload(), WHOLE.payload), (PaperBody::stage(), WHOLE.stage)]
    {
        assert_agree("whole sphere", deviations(&body, body.axes.clone()), expected);
        // And without sampling.
        let law = PrincipalDispersion::new(body.roots, body.axes.clone());
        for (found, expected) in EntryMoments::of(&law).deviations().iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 4.0 * REFERENCE_ERROR);
        }
    }
}

#[test]
fn deviations_of_the_half_around_the_mean() {
    for (body, expected) in [(PaperBody::payload(), HALF.payload), (PaperBody::stage(), HALF.stage)]
    {
        assert_agree("mean half", deviations(&body, MeanHalf::new(body.axes.clone())), expected);
    }
}

#[test]
fn table_2_is_the_jacobian_counted_twice() {
    let (payload, stage) = (PaperBody::payload(), PaperBody::stage());
    let twice = |body: &PaperBody| JacobianTwice::new(body.axes.clone()).unwrap();
    let found = deviations(&payload, twice(&payload));
    assert_agree("Jacobian twice, payload", found, TWICE.payload);
    assert_near("Table 2, payload", found, TABLE_2_PAYLOAD, 0.04);
    let found = deviations(&stage, twice(&stage));
    assert_agree("Jacobian twice, stage", found, TWICE.stage);
    // The printed stage is up to 14 % above every reading that has been tried.
    assert_near("Table 2, stage", found, TABLE_2_STAGE, 0.15);
}

/// Negative controls: neither the law as derived nor its half around the mean is Table 2.
#[test]
fn table_2_is_no_other_law() {
    let payload = PaperBody::payload();
    let i13 = |found: [(f64, f64); 6]| found[4].0 / TABLE_2_PAYLOAD[4];
    assert!(i13(deviations(&payload, payload.axes.clone())) < 0.75);
    assert!(i13(deviations(&payload, MeanHalf::new(payload.axes.clone()))) < 0.75);
}

/// "The central values … are 1.408 and 1.144°" (Results).
#[test]
fn central_values() {
    let outcome = paper_separation().run(&Settings::default()).unwrap();
    let metrics = outcome.spin_metrics(&Vector3::x_axis());
    assert_eq!(format!("{:.3}", metrics.inertia_ratio().unwrap()), "1.408");
    assert_eq!(format!("{:.3}", metrics.wobble().to_degrees()), "1.144");
    // Not in the paper: by an independent program in 200-bit arithmetic.
    assert!((metrics.cone().unwrap().to_degrees() - 0.15728853520067088).abs() < 1e-11);
    assert!((metrics.spin_rate() - 0.15931016529387138).abs() < 1e-12);
}

/// Eq. 31 prints 0.75 for the third root of the payload: not what Table 2 was made with.
#[test]
fn the_printed_variance_is_a_misprint() {
    let payload = PaperBody::payload();
    let i11 = |variance| {
        let roots =
            ScalarRoots::normal(payload.nominal.second_moments().roots(), [0.125, 0.1, variance])
                .unwrap();
        let law = PrincipalDispersion::new(roots, payload.axes.clone());
        EntryMoments::of(&law).deviations()[0]
    };
    assert!((i11(0.75) - 99.1).abs() < 0.1);
    assert!((i11(0.075) - TABLE_2_PAYLOAD[0]).abs() < 1.0);
}

/// Shares of the far half by quadrature in an independent program.
#[test]
fn the_second_lobe_holds_what_it_should() {
    for (body, expected) in
        [(PaperBody::payload(), 0.034_593_286_568_583), (PaperBody::stage(), 0.055_090_885_834_5)]
    {
        let mut rng = ChaCha8Rng::seed_from_u64(26);
        let far = (0..DRAWS).filter(|_| !body.axes.in_mean_half(&body.axes.sample(&mut rng)));
        let found = far.count() as f64 / DRAWS as f64;
        let z = (found - expected) / (expected * (1.0 - expected) / DRAWS as f64).sqrt();
        assert!(z.abs() < 4.0, "{found}, expected {expected}, z = {z}");
    }
}

/// How much more the naive models vary, from the run tables of a study, against an independent
/// program's 20,000 runs a model (bootstrap standard error about 0.8 %).
#[test]
fn ratios_of_deviations() {
    let quantities = [
        Quantity::InertiaRatio,
        Quantity::Cone,
        Quantity::Nutation,
        Quantity::Wobble,
        Quantity::SpinRate,
    ];
    let pairs = [
        ("naive", "published", [1.809, 1.251, 1.087, 1.075, 1.033]),
        ("naive-matched", "proposed", [1.705, 1.007, 0.987, 0.984, 0.927]),
    ];
    let scratch = tempfile::tempdir().unwrap();
    let scenario = Scenario::peck_2003().unwrap().with_runs(5000).unwrap();
    let options = Options { out: Some(scratch.path().join("study")), ..Options::default() };
    let study = Study::run(&scenario, &options, &|_| {}).unwrap();
    let deviation = |model: &str, quantity: Quantity| {
        let tables = study.tables().unwrap();
        let table = tables.iter().find(|t| t.model() == model).unwrap();
        Deviation::new(&quantity.in_table(table)).unwrap()
    };
    for (naive, physical, expected) in pairs {
        for (quantity, expected) in quantities.into_iter().zip(expected) {
            let (n, p) = (deviation(naive, quantity), deviation(physical, quantity));
            let error = [&n, &p].map(|d| (d.kurtosis() - 1.0) / (4.0 * d.n() as f64));
            let spread = (error[0] + error[1] + 0.008_f64.powi(2)).sqrt();
            let z = (n.ratio(&p) / expected - 1.0) / spread;
            assert!(z.abs() < 4.0, "{naive}/{physical} {quantity:?}: {}, z = {z}", n.ratio(&p));
        }
    }
}
