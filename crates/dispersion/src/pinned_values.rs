//! The first draws of every law, pinned to the bit.
//!
//! Studies are run again from a seed, and results are compared across versions and machines. So the values
//! that a seed gives are part of what this crate promises. A change that makes one of these tests fail
//! alters results: it needs a **values** entry in the changelog, and the lists that the test prints
//! take the place of those below. A law that is added to one of the enumerations does not compile
//! without a line here.

use gyradius_attitude::{
    AboutAxis, FisherBingham, MeanHalf, RadiallyConstrainedGaussian, UniformAttitude,
};
use gyradius_inertia::{Inertia, InertiaMatrix, RootSecondMoments};
use nalgebra::{Matrix3, Matrix4, SMatrix, UnitQuaternion, Vector3, Vector4};
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::{Distribution, Exp};

use crate::*;

const SEED: u64 = 2003;

/// Collects what differs, so that one run of the tests tells all.
struct Pinned {
    differing: String,
}

impl Pinned {
    fn check(&mut self, what: &str, found: &[f64], pinned: &[f64]) {
        let same = found.len() == pinned.len()
            && found.iter().zip(pinned).all(|(a, b)| a.to_bits() == b.to_bits());
        if !same {
            self.differing += &format!("{what} => {found:?}\n");
        }
    }

    fn finish(self) {
        assert!(self.differing.is_empty(), "values have changed:\n{}", self.differing);
    }
}

/// A test of every variant of an enumeration: laws of it, and what `$draw` makes of them one after the
/// other from one generator. The match has no wildcard: a variant without a line does not compile.
macro_rules! pinned {
    ($test:ident: $of:ty as $name:ident by $inner:expr, $draw:expr;
     $($variant:ident: $laws:expr => $values:expr;)*) => {
        #[test]
        fn $test() {
            fn name(law: &$of) -> &'static str {
                match $inner(law) {
                    $($name::$variant { .. } => stringify!($variant),)*
                }
            }
            let mut pinned = Pinned { differing: String::new() };
            $(
                let mut rng = ChaCha8Rng::seed_from_u64(SEED);
                let mut found: Vec<f64> = Vec::new();
                for law in $laws {
                    assert_eq!(name(&law), stringify!($variant));
                    $draw(&law, &mut rng, &mut found);
                }
                let values: &[f64] = &$values;
                pinned.check(stringify!($variant), &found, values);
            )*
            pinned.finish();
        }
    };
}

fn itself<T>(law: &T) -> &T {
    law
}

fn mean() -> RootSecondMoments {
    RootSecondMoments::new([30.0, 40.0, 50.0]).unwrap()
}

fn body() -> Inertia {
    Inertia::try_from(
        InertiaMatrix::from_entries([5000.0, 4000.0, 3000.0], [20.0, 2.0, -50.0]).unwrap(),
    )
    .unwrap()
}

/// The law of the axes in Peck (2003), with its second lobe.
fn paper() -> RadiallyConstrainedGaussian {
    let covariance = Matrix4::from_diagonal(&Vector4::new(2e-5, 6e-4, 6e-4, 0.6));
    RadiallyConstrainedGaussian::new(body().principal_axes().attitude(), covariance).unwrap()
}

/// A narrow lobe.
fn narrow() -> RadiallyConstrainedGaussian {
    let mean = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(0.9, 0.1, -0.2, 0.3));
    RadiallyConstrainedGaussian::from_rotation_covariance(mean, Matrix3::identity() * 1e-4, 0.01)
        .unwrap()
}

fn covariance() -> SMatrix<f64, 6, 6> {
    SMatrix::from_fn(|i, j| if i == j { 4.0 } else { 1.0 })
}

/// Three draws one by one, then five at once, of which the first two are kept.
fn roots(law: &RootLaw, rng: &mut ChaCha8Rng, found: &mut Vec<f64>) {
    for _ in 0..3 {
        found.extend(law.sample(rng).values());
    }
    let mut columns = [[0.0; 5]; 3];
    law.squares_into(rng, columns.each_mut().map(AsMut::as_mut));
    found.extend(columns.iter().flat_map(|c| &c[..2]));
}

pinned! {
    roots_are_pinned: RootLaw as RootLaw by itself, roots;
    CorrelatedGaussian: [
        CorrelatedRoots::new(mean(), Matrix3::from_fn(|i, j| if i == j { 2.0 } else { 1.0 }))
            .unwrap()
            .into(),
    ] => [
        29.060744715927658, 40.23958618225275, 51.06666493906503, 31.55498875532408,
        38.896155360239796, 50.25088606621369, 28.611967223699725, 37.114673640608316,
        50.21120230044338, 858.1306078964493, 881.7755961438816, 1689.3801181708125,
        1649.995881859114, 2510.7000613788255, 2692.0071789906274,
    ];
    Independent: [ScalarRoots::uniform(mean(), [1.0, 2.0, 3.0]).unwrap().into()] => [
        29.28272885863443, 41.9235859079182, 52.017516338635296, 31.545843403512155,
        38.491055652620815, 50.413115527809225, 28.650287230832717, 37.70683277329112,
        52.453849234166405, 879.023382282427, 888.5540047077959, 1679.119405424721,
        1659.321738653736, 2485.9587720983454, 2753.3519909648376,
    ];
    Empirical: [
        EmpiricalRoots::from_values(&[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]])
            .unwrap()
            .into(),
    ] => [1.0, 2.0, 3.0, 1.0, 2.0, 3.0, 7.0, 8.0, 9.0, 49.0, 49.0, 64.0, 64.0, 81.0, 81.0];
}

/// Roots of one kind of scalar law, each with a generator of its own. Further kinds are pinned where they are
/// declared.
#[test]
fn independent_roots_are_pinned() {
    let mut pinned = Pinned { differing: String::new() };
    let mut check = |what: &str, laws: &[ScalarRoots], values: &[f64]| {
        let mut rng = ChaCha8Rng::seed_from_u64(SEED);
        let mut found: Vec<f64> = Vec::new();
        for law in laws {
            roots(&law.clone().into(), &mut rng, &mut found);
        }
        pinned.check(what, &found, values);
    };
    check(
        "Normal",
        &[ScalarRoots::normal(mean(), [1.0, 2.0, 3.0]).unwrap()],
        &[
            29.335846219367152,
            40.81892958473242,
            51.94983195950733,
            31.099543093558484,
            37.82761682370864,
            50.1507570415386,
            29.018512611368887,
            37.469693196451566,
            52.45348301851105,
            870.2906003670337,
            972.6984442028545,
            1779.1156630341256,
            1613.4027706516097,
            2890.83204998594,
            2573.230862026235,
        ],
    );
    check(
        "Uniform",
        &[ScalarRoots::uniform(mean(), [1.0, 2.0, 3.0]).unwrap()],
        &[
            29.28272885863443,
            41.9235859079182,
            52.017516338635296,
            31.545843403512155,
            38.491055652620815,
            50.413115527809225,
            28.650287230832717,
            37.70683277329112,
            52.453849234166405,
            879.023382282427,
            888.5540047077959,
            1679.119405424721,
            1659.321738653736,
            2485.9587720983454,
            2753.3519909648376,
        ],
    );
    check(
        "Lognormal",
        &[ScalarRoots::lognormal(mean(), [1.0, 2.0, 3.0]).unwrap()],
        &[
            29.327036002783608,
            40.801616081767605,
            51.9565770469054,
            31.102350532128035,
            37.86253971456578,
            50.12087570371567,
            29.018541002697322,
            37.52535842002453,
            52.48242303326502,
            869.5762745407523,
            886.1591768576991,
            1738.0095267524289,
            1670.8916669407317,
            2493.2482208098663,
            2778.290631556344,
        ],
    );
    check(
        "Truncated",
        &[
            [[29.0, 32.0], [40.1, 40.2], [52.0, f64::INFINITY]],
            [[-f64::INFINITY, 30.0], [37.0, 37.1], [0.0, 47.0]],
        ]
        .map(|bounds| ScalarRoots::truncated_normal(mean(), [1.0; 3], bounds).unwrap()),
        &[
            29.335846219367152,
            40.1892650329234,
            53.21089017201551,
            30.08703961851454,
            40.111037148469634,
            52.99271237641687,
            31.188113828874847,
            40.14765650015481,
            52.43483272619981,
            907.1070447574285,
            848.7841561856245,
            1609.9989378055288,
            1610.5511329187154,
            2774.9148030167535,
            2719.7641955160757,
            29.34253298576508,
            37.093072291010465,
            46.85920911608484,
            29.691846214457982,
            37.0181423440356,
            46.66256046164546,
            28.79079483812226,
            37.00037537318712,
            45.797726898157286,
            809.5048786213699,
            888.7634633204577,
            1371.489878166526,
            1372.2143941959528,
            2206.6209792596082,
            2166.2389432920613,
        ],
    );
    check(
        "Bernoulli",
        &[ScalarRoots::new([0.2, 0.5, 0.9].map(|p| ScalarLaw::bernoulli(p).unwrap())).unwrap()],
        &[0.0, 1.0, 1.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0],
    );
    pinned.finish();
}

/// Two draws one by one, then five at once, of which the first is kept; scalar last.
fn attitudes(law: &AxesLaw, rng: &mut ChaCha8Rng, found: &mut Vec<f64>) {
    for _ in 0..2 {
        found.extend(law.sample(rng).coords.iter());
    }
    let mut batch = [UnitQuaternion::identity(); 5];
    law.attitudes_into(rng, &mut batch);
    found.extend(batch[0].coords.iter());
}

pinned! {
    axes_are_pinned: AxesLaw as AxesLaw by itself, attitudes;
    WholeSphere: [paper(), narrow()].map(AxesLaw::from) => [
        0.021965911483072403, 0.028758510586040027, -0.022771830476938124, 0.9990855271388531,
        0.018066374509621824, -0.023413415392294475, -0.013311779122679175, 0.9994739689598399,
        0.03471992616398125, 0.024202240214117023, 0.010462757182450282, 0.9990492024960167,
        0.10584265630177851, -0.20729297844823902, 0.31049522801033125, 0.9216396620023759,
        0.09555935806267174, -0.20841252286244294, 0.3067385490298888, 0.9237662539516154,
        0.10460800422742107, -0.20655213977255749, 0.3074068195338797, 0.9229812708343537,
    ];
    MeanHalf: [paper(), narrow()].map(|law| AxesLaw::from(MeanHalf::new(law))) => [
        0.021965911483072403, 0.028758510586040027, -0.022771830476938124, 0.9990855271388531,
        0.018066374509621824, -0.023413415392294475, -0.013311779122679175, 0.9994739689598399,
        0.03471992616398125, 0.024202240214117023, 0.010462757182450282, 0.9990492024960167,
        0.10584265630177851, -0.20729297844823902, 0.31049522801033125, 0.9216396620023759,
        0.09555935806267174, -0.20841252286244294, 0.3067385490298888, 0.9237662539516154,
        0.10460800422742107, -0.20655213977255749, 0.3074068195338797, 0.9229812708343537,
    ];
    JacobianTwice: [AxesLaw::from(JacobianTwice::new(paper()).unwrap())] => [
        0.02238186988055523, 0.021592796574304525, 0.01840619418785426, 0.9993467941872178,
        0.025771001853144352, -0.03377603018206228, -0.062006127235560225, 0.9971711364825363,
        0.027272065310772385, -0.04214810422259577, -0.03654124856396445, 0.9980703927667189,
    ];
    Uniform: [AxesLaw::from(UniformAttitude)] => [
        -0.36825331736519773, 0.3210772847171893, 0.624186793829993, 0.6096636104413626,
        -0.6010448164946564, 0.03405668731735921, -0.3840344164072436, -0.7000734515953453,
        0.5714809724343668, 0.42764278347002715, -0.4931432976007662, -0.4973337269107336,
    ];
    Fixed: [AxesLaw::from(FixedAttitude::new(narrow().mean()))] => [
        0.10259783520851541, -0.20519567041703082, 0.3077935056255462, 0.9233805168766387,
        0.10259783520851541, -0.20519567041703082, 0.3077935056255462, 0.9233805168766387,
        0.10259783520851541, -0.20519567041703082, 0.3077935056255462, 0.9233805168766387,
    ];
    FisherBingham: [AxesLaw::from(FisherBingham::new(Matrix4::identity() * 3.0, Vector4::new(0.5, 0.0, -1.0, 2.0)).unwrap())] => [
        0.8789628235336395, 0.223162582308498, 0.17574945560342903, 0.3830599764505204,
        -0.0884445790103085, -0.22240712882592562, -0.9233070456668078, 0.30036099099771374,
        0.7510285066560651, 0.009766027203908595, 0.18639942220730196, 0.6333372421572864,
    ];
    AboutAxis: [AxesLaw::from(AboutAxis::new(narrow().mean(), Vector3::z_axis()))] => [
        -0.2121815847251186, 0.0872384895038064, 0.3748292856639367, -0.898260222686775,
        -0.0699809859077511, -0.21848167099037752, 0.8653879706943859, 0.4455020552478791,
        -0.11404180324183262, 0.19906291985379787, -0.25506334983589574, -0.9393141692868916,
    ];
}

/// Two draws, and the axes where the model draws them.
fn model(law: &DispersionModel, rng: &mut ChaCha8Rng, found: &mut Vec<f64>) {
    for _ in 0..2 {
        let draw: ModelDraw = law.sample(rng);
        found.extend(draw.inertia.entries());
        if let Some(axes) = draw.axes {
            found.extend(axes.coords.iter());
        }
    }
}

fn entrywise() -> EntrywiseGaussian {
    EntrywiseGaussian::new(body(), [400.0, 300.0, 200.0, 10.0, 20.0, 30.0]).unwrap()
}

fn correlated() -> CorrelatedEntries {
    CorrelatedEntries::new(body(), covariance() * 1e4).unwrap()
}

pinned! {
    models_are_pinned: DispersionModel as DispersionModel by itself, model;
    Principal: [PrincipalDispersion::new(
        ScalarRoots::normal(mean(), [1.0, 2.0, 3.0]).unwrap(),
        paper(),
    ).into()] => [
        4362.494116077428, 3558.1646923020794, 2530.465044561994, -44.529857906008345,
        2.3681585368398204, -61.67554693359426, 0.029853493066303305, 0.0007479515456296172,
        0.027719703899217928, 0.9991695689601267, 4178.030545903463, 3208.0841716831965,
        2562.661037425171, 18.159541899442143, -15.735322884302407, -39.47942676053523,
        0.03024959792475008, -0.00481013514609743, -0.00971206192170437, 0.9994836168134504,
    ];
    Entrywise: [entrywise().into()] => [
        4734.338487746861, 4173.721198803574, 3225.1472013392186, 30.995430935584842,
        -28.72213750582381, -47.38881144456374, 4607.405044547555, 3463.240870218533,
        3283.303816237906, 15.006881337882291, 25.76227657749698, -50.651916197869745,
    ];
    CorrelatedEntries: [correlated().into()] => [
        4867.16924387343, 4078.9288626099296, 3202.813010810005, 250.52419645336272,
        -228.22667928771736, -15.358721735088906, 4803.7025222737775, 3604.4491021403765,
        3150.3959236217042, -146.98810528644805, 135.07585311078498, -113.41274311706599,
    ];
    RealizableEntrywise: [RealizableOnly::new(entrywise()).unwrap().into()] => [
        4734.338487746861, 4173.721198803574, 3225.1472013392186, 30.995430935584842,
        -28.72213750582381, -47.38881144456374, 4607.405044547555, 3463.240870218533,
        3283.303816237906, 15.006881337882291, 25.76227657749698, -50.651916197869745,
    ];
    RealizableCorrelatedEntries: [RealizableOnly::new(correlated()).unwrap().into()] => [
        4867.16924387343, 4078.9288626099296, 3202.813010810005, 250.52419645336272,
        -228.22667928771736, -15.358721735088906, 4803.7025222737775, 3604.4491021403765,
        3150.3959236217042, -146.98810528644805, 135.07585311078498, -113.41274311706599,
    ];
    LogCholesky: [LogCholeskyGaussian::about(&body(), covariance() * 1e-3).unwrap().into()] => [
        5512.782067708815, 4329.958640640667, 3021.5797908034106, 17.150965875689007,
        1.4927261799074978, -49.06005181177044, 4856.970693642951, 4182.691395617447,
        2440.9255113535, 19.756525037663103, 3.249256337944144, -54.85263442357256,
    ];
    Wishart: [Wishart::new(body(), 0.1).unwrap().into()] => [
        4861.907922361965, 3643.0743987693922, 3129.6334649527043, 99.64289909538675,
        152.8424549946012, -214.2470611597477, 5110.101921948201, 4080.0316230541634,
        2956.821663388653, 15.845628742995178, 71.81842790951002, -97.73220801765578,
    ];
    Basilisk: [
        BasiliskDispersion::new(body(), 50.0, BasiliskDispersion::NO_BOUNDS, 0.02).unwrap().into(),
    ] => [
        4965.470402173406, 4028.3506655118154, 3058.2115767518685, -2.2736864986334258,
        -57.76872926044916, -51.67784591790604, 4949.24262335295, 3911.0859601699794,
        3071.9631461414133, 31.543255230134093, 47.15677673130167, -48.876806864583735,
    ];
}

/// What stands in no enumeration.
#[test]
fn the_rest_is_pinned() {
    let mut pinned = Pinned { differing: String::new() };
    let rng = || ChaCha8Rng::seed_from_u64(SEED);

    let bodies: AnyBody = AnyBody::new(1e-3, 1e3).unwrap();
    let draw: Inertia = bodies.sample(&mut rng());
    pinned.check(
        "AnyBody",
        &draw.entries(),
        &[
            30.786520215995168,
            36.12848828220282,
            37.200719138457735,
            9.004684204417504,
            8.639938628905814,
            -0.1322961889659362,
        ],
    );

    let independent = IndependentRoots::new([Exp::new(1.0).unwrap(); 3]).unwrap();
    pinned.check(
        "IndependentRoots",
        &independent.sample(&mut rng()).values(),
        &[0.5269776590495993, 0.4431009522600597, 1.6183838275154037],
    );

    let mut scores = [1.0, -0.5, 0.25];
    Correlation::new(&[(0, 1, 0.3), (1, 2, -0.6)]).unwrap().mix(&mut scores);
    pinned.check("Correlation", &scores, &[1.0, -0.17696960070847284, 0.5088426615201358]);

    // More rows than are drawn at a time.
    let law =
        PrincipalDispersion::new(ScalarRoots::normal(mean(), [1.0, 2.0, 3.0]).unwrap(), paper());
    let mut columns = [[0.0; 130]; 6];
    law.sample_columns(&mut rng(), columns.each_mut().map(AsMut::as_mut)).unwrap();
    let rows: Vec<f64> = [0, 129].iter().flat_map(|i| columns.map(|c| c[*i])).collect();
    pinned.check(
        "sample_columns",
        &rows,
        &[
            4204.593378885596,
            3370.8440191769023,
            2558.179028649546,
            25.83779843737828,
            -35.27604456034686,
            -49.70512136548241,
            4329.625550446788,
            3552.9057938370074,
            2646.641632218688,
            -64.57196798775684,
            -31.989978266661378,
            -43.4763066909957,
        ],
    );
    pinned.finish();
}
