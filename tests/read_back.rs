//! Every law, fit and result of the libraries that is written reads back to the bit, and corrupted ones are refused.

use gyradius_attitude::{
    AboutAxis, FisherBingham, HypersphericalAngles, MeanHalf, RadiallyConstrainedGaussian,
    UniformAttitude,
};
use gyradius_dispersion::{
    AnyBody, AxesLaw, BasiliskDispersion, CorrelatedEntries, CorrelatedRoots, Correlation,
    DispersionModel, EmpiricalRoots, EntrywiseGaussian, FixedAttitude, IndependentRoots,
    InertiaLaw, JacobianTwice, JointScalar, KnownMoments, LogCholeskyGaussian, LogCholeskyTen,
    MassPropertiesLaw, MaximumEntropy, NaiveBody, NaiveRule, PrincipalDispersion, PrincipalDraw,
    PseudoInertiaWishart, RealizableOnly, RootLaw, RootMoments, ScalarLaw, ScalarRoots,
    TenParameters, TenSums, TensorLaw, Wishart, WithMoments,
};
use gyradius_estimation::{
    Amount, Assembly, AssemblyPart, AssemblyRow, AxesStatement, CentreStatement, EstimatedBody,
    MassChoice, MassPropertiesFit, MassStatement, MomentsStatement, PartStatement, PrincipalFit,
    ProductsStatement, StatedBody, Statements, TenEstimate, TenForm,
};
use gyradius_inertia::{
    Inertia, InertiaMatrix, LogCholesky, MassProperties, PseudoInertia, RealizabilityReport,
    Region, Repair, RepairMethod, RootSecondMoments, Shape,
};
use gyradius_statistics::{
    Acceptance, BinEdges, Confidence, ConfidenceSequence, Deviation, FixedWidth, GoodnessOfFit,
    Histogram, ImportanceSampling, Moments, PairSeparation, Proportion, QuantileCells,
    RankCorrelation, ScoreSearch, SequentialAcceptance, SobolSums, SortedSample, SteeredSampling,
    SubsetSimulation, SuccessByDecile, ToleranceSide,
};
use nalgebra::{SMatrix, UnitQuaternion, Vector3, Vector4};
use proptest::prelude::*;
use rand::RngExt;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use serde::{Serialize, de::DeserializeOwned};
use serde_json::Value;
use std::{any::type_name, fmt::Debug};

/// Numbers that nearly nothing takes.
const EXTREME: [f64; 4] = [1e308, -1e308, -1.5, 0.125];

/// Writes and reads a value, to the bit; then spoils it in one place after another. No place takes what is of another kind, and
/// every number is refused when it is too large, negative or no whole one, but those under keys that may have any.
fn check<T>(value: &T, any: &[&str])
where
    T: Serialize + DeserializeOwned + PartialEq + Debug,
{
    let name = type_name::<T>();
    let text = serde_json::to_string(value).unwrap();
    let read = |text: &str| serde_json::from_str::<T>(text);
    let back = read(&text).unwrap_or_else(|error| panic!("{name}: {error}: {text}"));
    assert_eq!(back, *value, "{name}");
    assert_eq!(serde_json::to_string(&back).unwrap(), text, "{name}");
    let whole: Value = serde_json::from_str(&text).unwrap();
    let mut places = Vec::new();
    leaves(&whole, String::new(), &mut places);
    // Of long lists, some places.
    let step = places.len().div_ceil(60).max(1);
    for place in places.iter().step_by(step) {
        let with = |bad: Value| {
            let mut spoilt = whole.clone();
            *spoilt.pointer_mut(place).unwrap() = bad;
            read(&spoilt.to_string())
        };
        let nested = serde_json::json!([[["none such"]]]);
        assert!(with(nested).is_err(), "{name}{place} takes what is of another kind");
        let is_number = whole.pointer(place).unwrap().is_number();
        if is_number && !any.iter().any(|key| place.contains(key)) {
            let refused = EXTREME.iter().any(|extreme| with((*extreme).into()).is_err());
            assert!(refused, "{name}{place} takes any number: {text}");
        }
    }
}

/// Places of what is neither a list nor an object nor missing.
fn leaves(value: &Value, place: String, found: &mut Vec<String>) {
    match value {
        Value::Null => {}
        Value::Bool(_) | Value::Number(_) | Value::String(_) => found.push(place),
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(i, x)| leaves(x, format!("{place}/{i}"), found));
        }
        Value::Object(keys) => {
            keys.iter().for_each(|(key, x)| leaves(x, format!("{place}/{key}"), found));
        }
    }
}

/// Checks each of some values, with the keys under which any number will do.
macro_rules! check_each {
    ($($value:expr $(, any $key:literal)*;)+) => {
        $(check(&$value, &[$($key),*]);)+
    };
}

/// Random numbers for laws.
struct Random(ChaCha8Rng);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0.random_range(low..high)
    }

    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    fn attitude(&mut self) -> UnitQuaternion<f64> {
        UniformAttitude.sample(&mut self.0)
    }

    fn covariance<const N: usize>(&mut self, size: f64) -> SMatrix<f64, N, N> {
        let root = SMatrix::<f64, N, N>::from_fn(|_, _| size * self.normal());
        let square = root * root.transpose() + SMatrix::identity() * (size * size);
        (square + square.transpose()) * 0.5
    }

    fn body(&mut self) -> MassProperties {
        let inertia: Inertia = AnyBody::new(1.0, 10.0).unwrap().sample(&mut self.0);
        MassProperties::new(self.between(0.5, 3.0), Vector3::new(0.1, 0.0, -0.2), inertia).unwrap()
    }

    fn axes(&mut self) -> RadiallyConstrainedGaussian {
        let covariance = self.covariance::<4>(0.05);
        RadiallyConstrainedGaussian::new(self.attitude(), covariance).unwrap()
    }

    fn scalar(&mut self) -> ScalarLaw {
        let (low, width) = (self.between(1.0, 2.0), self.between(0.01, 0.2));
        match self.0.random_range(0..4) {
            0 => ScalarLaw::normal(low, width),
            1 => ScalarLaw::uniform(low, low + width),
            2 => ScalarLaw::lognormal(low, width),
            _ => ScalarLaw::truncated_normal(low, width, 0.9 * low, f64::INFINITY),
        }
        .unwrap()
    }

    fn scalars(&mut self) -> [ScalarLaw; 3] {
        std::array::from_fn(|_| self.scalar())
    }

    fn roots(&mut self) -> RootSecondMoments {
        RootSecondMoments::new(std::array::from_fn(|_| self.between(1.0, 3.0))).unwrap()
    }

    fn joint(&mut self) -> MassPropertiesLaw {
        let tensor = TensorLaw::gyration_lengths(self.scalars(), self.axes());
        let law = MassPropertiesLaw::new(self.scalar(), self.scalars(), tensor).unwrap();
        let pairs = [(JointScalar::ALL[0], JointScalar::ALL[5], self.between(-0.9, 0.9))];
        law.with_correlation(&pairs).unwrap()
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]

    #[test]
    fn bodies(seed in any::<u64>()) {
        let mut random = Random(ChaCha8Rng::seed_from_u64(seed));
        let body = random.body();
        let inertia = *body.inertia();
        let wild = InertiaMatrix::from_entries([1.0, 2.0, 5.0], [0.1, 0.2, random.normal()]).unwrap();
        check_each! {
            body, any "mass_centre";
            inertia;
            wild;
            inertia.second_moments();
            inertia.second_moments().roots();
            inertia.second_moments().radii_of_gyration(2.0).unwrap();
            inertia.principal_axes(), any "moments";
            PseudoInertia::of(&body).unwrap();
            LogCholesky::of(&body).unwrap(), any "/";
            Repair::new(&wild, RepairMethod::Nearest).unwrap();
            RealizabilityReport::of(wild.matrix());
            body.equivalent_box().unwrap();
            body.equivalent_ellipsoid().unwrap();
            Region::solid_box([0.0; 3], [1.0, 2.0, 3.0]).unwrap();
            Shape::cone(random.between(0.1, 1.0), 1.0).unwrap();
            Shape::cone(random.between(0.1, 1.0), 1.0).unwrap().measure();
            Shape::disc(random.between(0.1, 1.0)).unwrap().measure();
            Shape::rod(random.between(0.1, 1.0)).unwrap().measure();
        }
    }

    #[test]
    fn attitudes(seed in any::<u64>()) {
        let mut random = Random(ChaCha8Rng::seed_from_u64(seed));
        let law = random.axes();
        let narrow = RadiallyConstrainedGaussian::from_rotation_covariance(
            random.attitude(), random.covariance::<3>(1e-4), 1e9,
        ).unwrap();
        let linear = Vector4::from_fn(|_, _| random.normal());
        let draws: Vec<_> = (0..60).map(|_| law.sample(&mut random.0)).collect();
        check_each! {
            law;
            narrow;
            MeanHalf::new(law.clone());
            FisherBingham::new(random.covariance::<4>(2.0), linear).unwrap();
            AboutAxis::new(random.attitude(), Vector3::z_axis());
            HypersphericalAngles::from(&random.attitude());
            UniformAttitude;
            RadiallyConstrainedGaussian::fit(&draws).unwrap(), any "radial", any "likelihood", any "errors", any "turn_covariance", any "convergence";
        }
    }

    #[test]
    fn laws_of_inertia(seed in any::<u64>()) {
        let mut random = Random(ChaCha8Rng::seed_from_u64(seed));
        let inertia = *random.body().inertia();
        let deviations = std::array::from_fn(|_| random.between(0.0, 0.2));
        let entrywise = EntrywiseGaussian::new(inertia, deviations).unwrap();
        let correlated = CorrelatedRoots::new(random.roots(), random.covariance::<3>(0.1)).unwrap();
        let principal = PrincipalDispersion::new(ScalarRoots::new(random.scalars()).unwrap(), random.axes());
        let draw: PrincipalDraw = principal.sample(&mut random.0);
        let wishart = Wishart::new(inertia, random.between(0.01, 0.5)).unwrap();
        let samples: Vec<_> = (0..3).map(|_| random.roots()).collect();
        check_each! {
            random.scalar(), any "mean", any "high";
            entrywise;
            RealizableOnly::new(entrywise).unwrap();
            CorrelatedEntries::new(inertia, random.covariance::<6>(0.01)).unwrap();
            LogCholeskyGaussian::new([0.5; 6], random.covariance::<6>(0.1)).unwrap();
            wishart;
            BasiliskDispersion::new(inertia, 0.1, [-0.2, 0.3], 0.1).unwrap(), any "bounds";
            AnyBody::new(1.0, 2.0).unwrap();
            correlated;
            EmpiricalRoots::new(&samples).unwrap();
            IndependentRoots::new(random.scalars()).unwrap(), any "/";
            WithMoments::new(correlated, correlated.second_moment_statistics());
            RootLaw::from(correlated);
            correlated.second_moment_statistics();
            wishart.entry_moments();
            principal.clone(), any "laws_sqrt_kg_m";
            draw;
            InertiaLaw::draw(&principal, &mut random.0);
            DispersionModel::from(wishart);
            FixedAttitude::new(random.attitude());
            AxesLaw::from(random.axes());
            AxesLaw::from(AboutAxis::new(random.attitude(), Vector3::y_axis()));
            AxesLaw::from(FisherBingham::new(random.covariance::<4>(2.0), Vector4::new(1.0, 0.0, -0.3, 2.0)).unwrap());
            JacobianTwice::new(random.axes()).unwrap();
            Correlation::new(&[(0, 2, random.between(-1.0, 1.0)), (1, 4, 0.3)]).unwrap();
        }
    }

    #[test]
    fn laws_of_bodies(seed in any::<u64>()) {
        let mut random = Random(ChaCha8Rng::seed_from_u64(seed));
        let body = random.body();
        let joint = random.joint();
        let scalar = ScalarLaw::uniform(0.5, 1.5).unwrap();
        let mut sums = TenSums::about([0.0; 10], [1.0; 10]);
        (0..9).for_each(|_| sums.add(TenParameters::from(joint.sample(&mut random.0)).values()));
        let region = Region::ellipsoid([0.0; 3], [9.0; 3]).unwrap();
        check_each! {
            joint.clone(), any "/";
            joint.moments().unwrap(), any "mean";
            LogCholeskyTen::about(&body, random.covariance::<10>(0.05)).unwrap();
            MaximumEntropy::new(&body, 0.1, [0.01; 3], 0.2).unwrap().inside(region).unwrap(), any "mass_centre";
            PseudoInertiaWishart::new(&body, random.between(10.0, 99.0)).unwrap();
            NaiveBody::new(body, NaiveRule::EntryNoise, scalar.clone()).unwrap().with_mass_factor(scalar).unwrap(), any "mass_centre";
            TenParameters::from(body), any "mass";
            sums.spread().unwrap(), any "/";
        }
    }

    #[test]
    fn statistics(seed in any::<u64>()) {
        let mut random = Random(ChaCha8Rng::seed_from_u64(seed));
        let confidence = Confidence::new(random.between(0.5, 0.999)).unwrap();
        let [x, y]: [Vec<f64>; 2] = std::array::from_fn(|_| (0..40).map(|_| random.normal()).collect());
        let failed: Vec<bool> = x.iter().map(|x| *x > 0.7).collect();
        let sorted = SortedSample::new(&x).unwrap();
        let rank = RankCorrelation::new(&x, &y).unwrap();
        let rule = Acceptance::new(0.9, confidence).unwrap();
        let cells = [&x, &y].map(|column| QuantileCells::new(column, 3).unwrap());
        let mut sobol = SobolSums::new(1).unwrap();
        let mut weights = ImportanceSampling::new();
        for (x, y) in x.iter().zip(&y) {
            sobol.push(Some(*x), Some(*y), &[Some(x * y)]).unwrap();
            weights.push(*x, *y > 0.0).unwrap();
        }
        let mut search = ScoreSearch::new(1, 100).unwrap();
        while !search.is_done() {
            search.tell(&vec![(vec![0.5], -1.0); 100]).unwrap();
        }
        let mut steered = SteeredSampling::new(&search).unwrap();
        for (x, y) in x.iter().zip(&y) {
            steered.push(&[*x], *y).unwrap();
        }
        let subset = SubsetSimulation::new(2, 100, 2).unwrap();
        let excess = |draws: &[u64]| (draws[0] % 97) as f64 - 50.0;
        check_each! {
            confidence;
            Moments::new(&x).unwrap(), any "skewness", any "kurtosis";
            Deviation::new(&x).unwrap();
            Moments::new(&x).unwrap().mean_interval(confidence), any "upper";
            sorted.clone(), any "/";
            BinEdges::freedman_diaconis(&[&sorted]).unwrap();
            Histogram::new(&sorted, &BinEdges::freedman_diaconis(&[&sorted]).unwrap());
            GoodnessOfFit::kolmogorov_smirnov(&sorted, |_| 0.5).unwrap();
            Proportion::new(3, 40).unwrap();
            FixedWidth::new(0.1, confidence).unwrap();
            cells[0].clone();
            rank;
            rank.estimate(confidence), any "value", any "upper";
            PairSeparation::new(&cells[0], &cells[1], &failed).unwrap();
            SuccessByDecile::new(&x, &failed, confidence).unwrap();
            rule;
            SequentialAcceptance::new(rule);
            ConfidenceSequence::about(0.2, confidence).unwrap();
            rule.verdict(3, 40).unwrap();
            rule.tolerance(ToleranceSide::AtMost, 40, 0), any "confidence";
            sobol.finish(confidence).unwrap(), any "mean", any "value", any "upper";
            weights.finish(confidence).unwrap(), any "upper", any "warnings";
            steered.law().clone();
            steered.finish(confidence).unwrap(), any "upper", any "warnings";
            subset.run(&excess, confidence).unwrap(), any "upper", any "warnings";
        }
    }

    #[test]
    fn fits_and_estimates(seed in any::<u64>()) {
        let mut random = Random(ChaCha8Rng::seed_from_u64(seed));
        let joint = random.joint();
        let bodies: Vec<MassProperties> = (0..40).map(|_| joint.sample(&mut random.0)).collect();
        let inertias: Vec<Inertia> = bodies.iter().map(|body| *body.inertia()).collect();
        let fit = PrincipalFit::new(&inertias).unwrap();
        let of_bodies = MassPropertiesFit::new(&bodies, MassChoice::default()).unwrap();
        let moments = joint.moments().unwrap();
        let estimate = TenEstimate::new(TenForm::Natural, *moments.mean(), *moments.covariance()).unwrap();
        check_each! {
            fit.roots()[0];
            fit.axes().clone(), any "covariance", any "errors", any "radial", any "isotropy", any "second_lobe";
            fit.assess(&mut random.0);
            fit.notes(), any "/";
            fit, any "/";
            of_bodies.assess(&mut random.0);
            of_bodies, any "/";
            estimate.clone(), any "mean";
            EstimatedBody::new(&estimate).unwrap(), any "/";
        }
    }

    #[test]
    fn statements_and_assemblies(seed in any::<u64>()) {
        let mut random = Random(ChaCha8Rng::seed_from_u64(seed));
        let body = random.body();
        let statements = Statements {
            moments: Some(MomentsStatement::new(Amount::Percent([5.0; 3]), 3.0).unwrap()),
            products: Some(ProductsStatement::new([0.02; 3], 1.0).unwrap()),
            axes: seed.is_multiple_of(2).then(|| AxesStatement::each([2.0; 3], 1.0).unwrap()),
            mass: Some(MassStatement::percent(random.between(0.1, 20.0), 1.0).unwrap()),
            centre: Some(CentreStatement::new([0.01; 3], 1.0, [0.0; 3]).unwrap()),
        };
        let part = AssemblyPart::new(PartStatement {
            mass_kg: body.mass_kg(),
            mass_centre_m: [0.0, 1.0, 2.0],
            inertia: (*body.inertia()).into(),
            attitude: random.attitude(),
            deviations: [0.01; 10],
            inertia_follows_mass: seed.is_multiple_of(3),
        }).unwrap();
        let row = |name: &str, part| AssemblyRow {
            name: name.to_owned(),
            parent: (name != "whole").then(|| "whole".to_owned()),
            part,
        };
        let rows = [row("whole", None), row("a", Some(part.clone())), row("b", Some(part.clone()))];
        let whole = Assembly::new(rows).unwrap();
        check_each! {
            statements.model(body.inertia(), Some(body.mass_kg())).unwrap(), any "/";
            StatedBody::new(&statements, &body).unwrap(), any "/";
            part;
            whole.first_order().clone(), any "mass_centre";
            whole;
        }
    }
}
