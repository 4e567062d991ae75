//! Models with given mean and covariance of the entries.

use gyradius_attitude::RadiallyConstrainedGaussian;
use gyradius_inertia::{Inertia, InertiaMatrix, PrincipalAxes, RootSecondMoments};
use nalgebra::{Matrix3, SMatrix, SVector};

use crate::entry_moments::ENTRIES;
use crate::second_moment_matrix::inertia_map;
use crate::{
    BasiliskDispersion, CorrelatedEntries, CorrelatedRoots, DispersionModel, EntryMoments,
    EntrywiseGaussian, KnownMoments, LogCholeskyGaussian, ModelKind, PrincipalDispersion,
    RealizableOnly, Wishart,
};

/// Deviations below this share of the largest entry are rounding, and none.
const ROUNDING: f64 = 1e-9;
/// The radial variance of axes whose second lobe is empty, whatever the turns.
const RADIAL: f64 = 0.01;
/// Largest standard deviation of a turn, rad: beyond, turns say nothing of products any more.
const MAX_TURN: f64 = 1.0;

/// Why no model of a kind has given moments.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{kind}: {problem}")]
pub struct MatchError {
    /// The kind of model.
    pub kind: ModelKind,
    /// What is wrong.
    pub problem: String,
}

/// A model made to have given moments, as far as its kind can.
#[derive(Clone, Debug)]
pub struct Matched {
    model: DispersionModel,
    what: &'static str,
}

impl Matched {
    /// The model.
    #[must_use]
    pub fn model(&self) -> &DispersionModel {
        &self.model
    }

    /// The model.
    #[must_use]
    pub fn into_model(self) -> DispersionModel {
        self.model
    }

    /// What of the moments it has, in words.
    #[must_use]
    pub fn what(&self) -> &'static str {
        self.what
    }
}

impl DispersionModel {
    /// The model of a kind whose six entries have the given mean and covariance, as far as its kind can;
    /// [`Matched::what`] says how far.
    ///
    /// | kind | matched |
    /// |---|---|
    /// | `entrywise` | mean and six deviations; no correlation |
    /// | `correlated-entries` | mean and covariance |
    /// | `realizable-…` | as above *before* rejection, which moves both |
    /// | `log-cholesky` | mean and covariance; to first order where no such law has them |
    /// | `wishart` | mean, and E‖Σ − Σ̄‖² |
    /// | `basilisk` | nominal matrix; variances summed over moments and over products |
    /// | `principal` | Gaussian roots and axes: mean, covariance of the principal moments, covariance of turns, the last two to first order |
    ///
    /// # Errors
    /// The mean belongs to no body where the kind needs one, or no law of the kind is this wide.
    ///
    /// ```
    /// use gyradius_dispersion::{DispersionModel, KnownMoments, ModelKind, Wishart};
    /// use gyradius_inertia::{Inertia, InertiaMatrix};
    ///
    /// let mean = InertiaMatrix::from_entries([5000.0, 4000.0, 3000.0], [20.0, 2.0, -50.0])?;
    /// let moments = Wishart::new(Inertia::try_from(mean)?, 0.05)?.entry_moments();
    /// for kind in ModelKind::ALL {
    ///     let matched = DispersionModel::matched(kind, &moments)?;
    ///     println!("{kind}: {}", matched.what());
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn matched(kind: ModelKind, moments: &EntryMoments) -> Result<Matched, MatchError> {
        let fail =
            |problem: &dyn std::fmt::Display| MatchError { kind, problem: format!("{problem}") };
        let [i11, i22, i33, i12, i13, i23] = moments.mean();
        let mean =
            InertiaMatrix::from_entries([i11, i22, i33], [i12, i13, i23]).map_err(|e| fail(&e))?;
        let body = || Inertia::try_from(mean).map_err(|e| fail(&e));
        let covariance = without_rounding(moments);
        let entrywise = || {
            let deviations = std::array::from_fn(|e| covariance[(e, e)].sqrt());
            EntrywiseGaussian::new(mean, deviations).map_err(|e| fail(&e))
        };
        let correlated = || CorrelatedEntries::new(mean, covariance).map_err(|e| fail(&e));
        let (model, what): (Self, _) = match kind {
            ModelKind::Entrywise => {
                (entrywise()?.into(), "mean and deviations of the six entries, no correlation")
            }
            ModelKind::CorrelatedEntries => {
                (correlated()?.into(), "mean and covariance of the six entries")
            }
            ModelKind::RealizableEntrywise => (
                RealizableOnly::new(entrywise()?).map_err(|e| fail(&e))?.into(),
                "mean and deviations of the six entries before rejection",
            ),
            ModelKind::RealizableCorrelatedEntries => (
                RealizableOnly::new(correlated()?).map_err(|e| fail(&e))?.into(),
                "mean and covariance of the six entries before rejection",
            ),
            ModelKind::LogCholesky => {
                let moments = EntryMoments::unchecked(moments.mean(), covariance);
                if let Ok(law) = LogCholeskyGaussian::matched(&moments) {
                    (law.into(), "mean and covariance of the six entries")
                } else {
                    body()?;
                    let law = LogCholeskyGaussian::linearised(&moments).map_err(|e| fail(&e))?;
                    (law.into(), "mean and covariance of the six entries, to first order")
                }
            }
            ModelKind::Wishart => {
                let law = wishart(body()?, &covariance).map_err(|e| fail(&e))?;
                (law.into(), "mean, and the mean square of the change of the second moments")
            }
            ModelKind::Basilisk => {
                let law = basilisk(mean, &covariance).map_err(|e| fail(&e))?;
                (law.into(), "nominal matrix; variances summed over moments and over products")
            }
            ModelKind::Principal => {
                let law = principal(&body()?, moments.mean(), &covariance).map_err(|e| fail(&e))?;
                (law, "mean, covariance of the principal moments and of the axes, to first order")
            }
        };
        Ok(Matched { model, what })
    }
}

/// The covariance with what is rounding set to zero.
fn without_rounding(moments: &EntryMoments) -> SMatrix<f64, 6, 6> {
    let size = moments.mean().iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let c = moments.covariance();
    let varies = |e: usize| c[(e, e)] > (ROUNDING * size).powi(2);
    SMatrix::from_fn(|e, f| if varies(e) && varies(f) { c[(e, f)] } else { 0.0 })
}

fn wishart(
    mean: Inertia,
    covariance: &SMatrix<f64, 6, 6>,
) -> Result<Wishart, Box<dyn std::error::Error>> {
    let sigma = mean.as_inertia_matrix().second_moment_matrix();
    let map = inertia_map().try_inverse().ok_or("no second moments")?;
    let spread = map * covariance * map.transpose();
    // Products count twice in the norm of a matrix.
    let square: f64 = (0..6).map(|e| spread[(e, e)] * if e < 3 { 1.0 } else { 2.0 }).sum();
    let size = sigma.norm_squared() + sigma.trace() * sigma.trace();
    if square == 0.0 {
        return Ok(Wishart::new(mean, 0.0)?);
    }
    Ok(Wishart::new(mean, 2.0 * (square / size).sqrt())?)
}

fn basilisk(
    mean: InertiaMatrix,
    covariance: &SMatrix<f64, 6, 6>,
) -> Result<BasiliskDispersion, Box<dyn std::error::Error>> {
    const STEPS: usize = 100;
    let sums = |c: &SMatrix<f64, 6, 6>| {
        let of = |range: std::ops::Range<usize>| range.map(|e| c[(e, e)]).sum::<f64>();
        (of(0..3), of(3..6))
    };
    let (moments, products) = sums(covariance);
    let (mut diagonal, mut angle) = (moments / 3.0, 1e-4);
    if products == 0.0 {
        angle = 0.0;
    }
    let none = BasiliskDispersion::NO_BOUNDS;
    let rounding = 64.0 * f64::EPSILON * mean.matrix().amax().powi(2);
    for _ in 0..STEPS {
        let law = BasiliskDispersion::new(mean, diagonal.sqrt(), none, angle)?;
        let found = sums(law.entry_moments().covariance());
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-6 * b + rounding;
        if close(found.0, moments) && close(found.1, products) {
            return Ok(law);
        }
        diagonal = (diagonal + (moments - found.0) / 3.0).max(0.0);
        if products > 0.0 {
            if !(found.1 > 0.0) {
                break;
            }
            angle *= (products / found.1).sqrt().clamp(0.1, 10.0);
        }
        if angle > MAX_TURN {
            break;
        }
    }
    Err("no turn of the axes by small angles gives the products this spread: the moments of the body \
         are too alike, or their own spread is smaller than the turns make it"
        .into())
}

/// Gaussian roots with full covariance about a radially constrained Gaussian of the axes.
fn principal(
    body: &Inertia,
    mean: [f64; 6],
    covariance: &SMatrix<f64, 6, 6>,
) -> Result<DispersionModel, Box<dyn std::error::Error>> {
    const STEPS: usize = 12;
    let axes = body.principal_axes();
    let to_principal = turn(&axes);
    let target_mean = to_principal * SVector::<f64, 6>::from(mean);
    let target = to_principal * covariance * to_principal.transpose();
    // What the first-order law is asked for, corrected by what comes out.
    let mut asked_mean: [f64; 3] = [target_mean[0], target_mean[1], target_mean[2]];
    let mut asked_moments: Matrix3<f64> = target.fixed_view::<3, 3>(0, 0).into();
    let mut asked_products: Matrix3<f64> = target.fixed_view::<3, 3>(3, 3).into();
    let mut best: Option<(f64, DispersionModel)> = None;
    for _ in 0..STEPS {
        let law = first_order(&axes, asked_mean, &asked_moments, &asked_products);
        let law = match (law, &best) {
            (Ok(law), _) => law,
            (Err(_), Some(_)) => break,
            (Err(error), None) => return Err(error),
        };
        let Some(found) = law.entry_moments() else { break };
        let found_mean = to_principal * SVector::<f64, 6>::from(found.mean());
        let found = to_principal * found.covariance() * to_principal.transpose();
        let gap = target - found;
        let off = gap.fixed_view::<3, 3>(0, 0).amax().max(gap.fixed_view::<3, 3>(3, 3).amax())
            / covariance.amax().max(f64::MIN_POSITIVE)
            + (target_mean - found_mean).fixed_rows::<3>(0).amax() / target_mean.amax();
        match &best {
            Some((least, _)) if off >= *least => break,
            _ => best = Some((off, law)),
        }
        if off < 1e-9 {
            break;
        }
        for (asked, gap) in asked_mean.iter_mut().zip((target_mean - found_mean).iter()) {
            *asked += gap;
        }
        asked_moments += gap.fixed_view::<3, 3>(0, 0);
        asked_products += gap.fixed_view::<3, 3>(3, 3);
    }
    best.map(|(_, law)| law).ok_or_else(|| "no law was found".into())
}

/// Roots with the moments' covariance; axes that turn as the products ask for.
fn first_order(
    axes: &PrincipalAxes,
    [i1, i2, i3]: [f64; 3],
    moments: &Matrix3<f64>,
    products: &Matrix3<f64>,
) -> Result<DispersionModel, Box<dyn std::error::Error>> {
    // K = ½ (ΣI)·1 − I.
    let map = Matrix3::new(-0.5, 0.5, 0.5, 0.5, -0.5, 0.5, 0.5, 0.5, -0.5);
    let k = map * nalgebra::Vector3::new(i1, i2, i3);
    let spread = map * moments * map.transpose();
    // E K = k̄² + c, Var K = 4k̄²c + 2c²: k̄⁴ = (E K)² − ½ Var K.
    let mut roots = [0.0; 3];
    for i in 0..3 {
        let fourth = k[i] * k[i] - 0.5 * spread[(i, i)];
        if !(k[i] >= 0.0 && fourth >= 0.0) {
            return Err(format!(
                "K_{} of mean {:.3e} kg·m² and deviation {:.3e} kg·m²: the square of no Gaussian is \
                 this wide",
                i + 1,
                k[i],
                spread[(i, i)].sqrt()
            )
            .into());
        }
        roots[i] = fourth.sqrt().sqrt();
    }
    let covariance = Matrix3::from_fn(|i, j| {
        let both = roots[i] * roots[j];
        // 2c² + 4 k̄_i k̄_j c = Cov, without cancellation.
        let c = 0.5 * spread[(i, j)];
        let root = (both * both + c).max(0.0).sqrt();
        if root + both > 0.0 { c / (both + root) } else { 0.0 }
    });
    let roots = CorrelatedRoots::new(RootSecondMoments::new(roots)?, covariance)?;

    // To first order products change by the differences of the moments times the turns, and the
    // turns about axes 3, 2, 1 belong to the products 12, 13, 23.
    let differences = [-(i1 - i2), i1 - i3, -(i2 - i3)];
    let size = i1.max(i2).max(i3);
    let mut turns = Matrix3::zeros();
    for a in 0..3 {
        for b in 0..3 {
            if differences[a].abs() > 1e-9 * size && differences[b].abs() > 1e-9 * size {
                turns[(2 - a, 2 - b)] = products[(a, b)] / (differences[a] * differences[b]);
            }
        }
        let deviation = turns[(2 - a, 2 - a)].max(0.0).sqrt();
        let varies = products[(a, a)] > (ROUNDING * size).powi(2);
        if deviation > MAX_TURN || (varies && deviation == 0.0) {
            return Err(format!(
                "{} varies by {:.3e} kg·m² in principal axes: no small turn of the axes does that, for \
                 the two moments are too alike",
                InertiaMatrix::ENTRY_NAMES[3 + a],
                products[(a, a)].sqrt()
            )
            .into());
        }
    }
    // The law needs a definite covariance; what is fixed gets next to nothing.
    for a in 0..3 {
        turns[(a, a)] = turns[(a, a)].max(1e-13);
    }
    // Principal to body axes.
    let r = axes.attitude().to_rotation_matrix();
    let turns = r.matrix().tr_mul(&turns) * r.matrix();
    let turns = (turns + turns.transpose()) * 0.5;
    let axes =
        RadiallyConstrainedGaussian::from_rotation_covariance(axes.attitude(), turns, RADIAL)?;
    Ok(PrincipalDispersion::new(roots, axes).into())
}

/// The linear map from the six entries in body axes to those in principal axes.
fn turn(axes: &PrincipalAxes) -> SMatrix<f64, 6, 6> {
    let r = axes.attitude().to_rotation_matrix();
    let mut map = SMatrix::zeros();
    for (column, (k, l)) in ENTRIES.into_iter().enumerate() {
        let mut unit = Matrix3::zeros();
        unit[(k, l)] = 1.0;
        unit[(l, k)] = 1.0;
        let turned = r.matrix() * unit * r.matrix().transpose();
        for (row, (i, j)) in ENTRIES.into_iter().enumerate() {
            map[(row, column)] = turned[(i, j)];
        }
    }
    map
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ScalarRoots;
    use crate::entry_moments::tests::check_entries;
    use nalgebra::Matrix4;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use rand_distr::Distribution;

    fn paper(spread: f64) -> PrincipalDispersion<ScalarRoots, RadiallyConstrainedGaussian> {
        let mean = InertiaMatrix::from_entries([5.0, 4.0, 3.0], [0.3, 0.2, -0.5]).unwrap();
        let mean = Inertia::try_from(mean).unwrap();
        let roots = mean.second_moments().roots();
        let variances = roots.values().map(|k| (0.5 * spread * k).powi(2));
        PrincipalDispersion::new(
            ScalarRoots::normal(roots, variances).unwrap(),
            RadiallyConstrainedGaussian::new(
                mean.principal_axes().attitude(),
                Matrix4::identity() * (0.25 * spread * spread),
            )
            .unwrap(),
        )
    }

    fn matched(kind: ModelKind, moments: &EntryMoments) -> DispersionModel {
        DispersionModel::matched(kind, moments).unwrap().into_model()
    }

    #[test]
    fn every_kind_has_what_it_says() {
        for spread in [0.01, 0.1, 0.2] {
            let target = paper(spread).entry_moments();
            let (mean, covariance) = (target.mean(), target.covariance());
            for kind in ModelKind::ALL {
                let model = matched(kind, &target);
                assert_eq!(model.kind(), kind);
                let Some(found) = model.entry_moments() else {
                    assert!(model.acceptance().unwrap() > 0.1);
                    continue;
                };
                let gap = (0..6).map(|e| (found.mean()[e] - mean[e]).abs()).fold(0.0, f64::max);
                let off = (found.covariance() - covariance).amax() / covariance.amax();
                let trace = |c: &SMatrix<f64, 6, 6>| c.diagonal().sum();
                let total = trace(found.covariance()) / trace(covariance) - 1.0;
                let (allowed_mean, allowed_off) = match kind {
                    ModelKind::CorrelatedEntries | ModelKind::LogCholesky => (1e-8, 1e-8),
                    ModelKind::Principal => (1e-3 * spread, 0.01),
                    // The trace of the covariance of all nine is that of six plus three more.
                    ModelKind::Wishart => (1e-12, 3.0),
                    ModelKind::Entrywise => (1e-12, 1.0),
                    _ => (4.0 * spread * spread, 3.0),
                };
                assert!(gap <= allowed_mean, "{kind} {spread}: mean off by {gap:e}");
                assert!(off <= allowed_off, "{kind} {spread}: covariance off by {off:e}");
                if matches!(kind, ModelKind::Entrywise | ModelKind::Basilisk) {
                    assert!(total.abs() < 1e-5, "{kind} {spread}: {total:e}");
                }
            }
        }
    }

    #[test]
    fn wishart_has_the_mean_square_of_the_second_moments() {
        let target = paper(0.1).entry_moments();
        let found = matched(ModelKind::Wishart, &target).entry_moments().unwrap();
        let map = inertia_map().try_inverse().unwrap();
        let square = |c: &SMatrix<f64, 6, 6>| {
            let c = map * c * map.transpose();
            c.diagonal().sum() + c.fixed_view::<3, 3>(3, 3).trace()
        };
        let (a, b) = (square(found.covariance()), square(target.covariance()));
        assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
    }

    #[test]
    fn draws_have_the_moments_that_the_model_says() {
        let target = paper(0.1).entry_moments();
        for (i, kind) in ModelKind::ALL.into_iter().enumerate() {
            let model = matched(kind, &target);
            if let Some(moments) = model.entry_moments() {
                let seed = 150 + i as u64;
                check_entries::<InertiaMatrix>(kind.name(), &moments, &model, seed);
            }
            let mut rng = ChaCha8Rng::seed_from_u64(160);
            if kind.is_realizable_by_construction() {
                assert!((0..1000).all(|_| {
                    Distribution::<InertiaMatrix>::sample(&model, &mut rng).is_realizable()
                }));
            }
        }
    }

    #[test]
    fn nothing_varies_where_nothing_is_to() {
        let fixed = EntryMoments::new(paper(0.1).entry_moments().mean(), SMatrix::zeros()).unwrap();
        for kind in ModelKind::ALL {
            let found = matched(kind, &fixed);
            let mut rng = ChaCha8Rng::seed_from_u64(161);
            let draw: InertiaMatrix = found.sample(&mut rng);
            for (x, y) in draw.entries().iter().zip(fixed.mean()) {
                assert!((x - y).abs() < 1e-5, "{kind}: {x} {y}");
            }
        }
    }

    #[test]
    fn what_cannot_be_matched_is_said() {
        let target = paper(0.1).entry_moments();
        let wide = EntryMoments::new(target.mean(), target.covariance() * 1e6).unwrap();
        for kind in [ModelKind::Wishart, ModelKind::Principal] {
            let error = DispersionModel::matched(kind, &wide).unwrap_err();
            assert!(error.to_string().starts_with(kind.name()), "{error}");
        }
        let mut impossible = target.mean();
        impossible[0] = 50.0;
        let impossible = EntryMoments::new(impossible, *target.covariance()).unwrap();
        for kind in ModelKind::ALL {
            let needs_a_body = !matches!(
                kind,
                ModelKind::Entrywise | ModelKind::CorrelatedEntries | ModelKind::Basilisk
            );
            assert_eq!(
                DispersionModel::matched(kind, &impossible).is_err(),
                needs_a_body,
                "{kind}"
            );
        }
    }

    #[cfg(feature = "serde")]
    #[test]
    fn models_serialize_with_their_names() {
        let target = paper(0.1).entry_moments();
        for kind in ModelKind::ALL {
            let model = matched(kind, &target);
            let json = serde_json::to_string(&model).unwrap();
            assert!(json.contains(&format!(r#""model":"{kind}""#)), "{json}");
            let back: DispersionModel = serde_json::from_str(&json).unwrap();
            assert_eq!(serde_json::to_string(&back).unwrap().len(), json.len());
            let mut rngs = [1, 1].map(ChaCha8Rng::seed_from_u64);
            let a: InertiaMatrix = model.sample(&mut rngs[0]);
            let b: InertiaMatrix = back.sample(&mut rngs[1]);
            assert!((a.matrix() - b.matrix()).amax() < 1e-9, "{kind}");
        }
    }
}
