//! The principal law with given mean and covariance of the entries, to first order.

use gyradius_attitude::RadiallyConstrainedGaussian;
use gyradius_inertia::{Inertia, InertiaMatrix, PrincipalAxes, RootSecondMoments};
use nalgebra::{Matrix3, SMatrix, SVector};

use crate::entry_moments::{ENTRIES, OF_SUMS};
use crate::named_model::{NamedModel, NoMatch};
use crate::principal::NAME;
use crate::{
    AxesLaw, CorrelatedRoots, EntryMoments, KnownMoments, ModelParameterError, ModelParameters,
    PrincipalDispersion, RootLaw,
};

/// Moments that differ by no more than this share of the largest are the same, about whose axes no turn is seen.
const ALIKE: f64 = 1e-9;
/// The radial variance of axes whose second lobe is empty, whatever the turns.
const RADIAL: f64 = 0.01;
/// Largest standard deviation of a turn, rad: beyond, turns say nothing of products any more.
const MAX_TURN: f64 = 1.0;

type Principal = PrincipalDispersion<RootLaw, AxesLaw>;

impl NamedModel for Principal {
    const NAME: &'static str = NAME;
    const DESCRIPTION: &'static str = "squared roots of second moments about random principal axes";
    const IS_REALIZABLE: bool = true;
    const NEEDS: &'static [&'static str] = &[];

    fn about(_: &Inertia, _: &ModelParameters) -> Result<Self, ModelParameterError> {
        let problem = "it is made of a law of roots and a law of axes, and of no parameters";
        Err(ModelParameterError::new(NAME, &problem))
    }

    fn matched(
        mean: InertiaMatrix,
        moments: &EntryMoments,
    ) -> Result<(Self, &'static str), NoMatch> {
        const WHAT: &str =
            "mean, covariance of the principal moments and of the axes, to first order";
        let body = Inertia::try_from(mean)?;
        Ok((principal(&body, moments)?, WHAT))
    }
}

/// Gaussian roots with full covariance about a radially constrained Gaussian of the axes.
fn principal(body: &Inertia, moments: &EntryMoments) -> Result<Principal, NoMatch> {
    const STEPS: usize = 12;
    let (mean, covariance) = (moments.mean(), moments.covariance());
    let axes = body.principal_axes();
    let to_principal = turn(&axes);
    let target_mean = to_principal * SVector::<f64, 6>::from(mean);
    let target = to_principal * covariance * to_principal.transpose();
    let rounding = rounding_of_products(&to_principal, moments);
    // What the first-order law is asked for, corrected by what comes out.
    let mut asked_mean: [f64; 3] = [target_mean[0], target_mean[1], target_mean[2]];
    let mut asked_moments: Matrix3<f64> = target.fixed_view::<3, 3>(0, 0).into();
    let mut asked_products: Matrix3<f64> = target.fixed_view::<3, 3>(3, 3).into();
    let mut best: Option<(f64, Principal)> = None;
    for _ in 0..STEPS {
        let law = first_order(&axes, asked_mean, &asked_moments, (&asked_products, &rounding));
        let law = match (law, &best) {
            (Ok(law), _) => law,
            (Err(_), Some(_)) => break,
            (Err(error), None) => return Err(error),
        };
        let found = law.entry_moments();
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

/// Roots with the moments' covariance; axes that turn as the products ask for, of whose variances these are rounding.
fn first_order(
    axes: &PrincipalAxes,
    [i1, i2, i3]: [f64; 3],
    moments: &Matrix3<f64>,
    (products, rounding): (&Matrix3<f64>, &[f64; 3]),
) -> Result<Principal, NoMatch> {
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
            if differences[a].abs() > ALIKE * size && differences[b].abs() > ALIKE * size {
                turns[(2 - a, 2 - b)] = products[(a, b)] / (differences[a] * differences[b]);
            }
        }
        let deviation = turns[(2 - a, 2 - a)].max(0.0).sqrt();
        let varies = products[(a, a)] > rounding[a];
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
    Ok(PrincipalDispersion::new(roots.into(), axes.into()))
}

/// The variances that arithmetic may leave of products in principal axes: of those in body axes, and of the sums of the turn.
fn rounding_of_products(turn: &SMatrix<f64, 6, 6>, moments: &EntryMoments) -> [f64; 3] {
    let own = SVector::<f64, 6>::from(moments.rounding().map(f64::sqrt));
    let turn = turn.abs();
    let (own, sums) = (turn * own, turn * moments.covariance().abs() * turn.transpose());
    [3, 4, 5].map(|e| own[e] * own[e] + OF_SUMS * sums[(e, e)])
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
