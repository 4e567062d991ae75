//! What a model of statements gives rise to: contradictions, and what has been left open.

use gyradius_dispersion::{RootLaw, RootMoments};
use nalgebra::Matrix3;

use super::{
    MissedBecause, Stated, StatedModel, StatementError, StatementWarning,
    entries::Forms,
    impossible::impossible_share,
    scatter::{Body, Scatter},
    task::Solution,
};
use crate::turns::FIXED;

/// Stated and implied deviations that differ by no more than this share are the same.
const AGREE: f64 = 0.03;
/// And by no more than this share of the largest one stated.
const SMALL: f64 = 1e-4;
/// Of what a mass centre adds, by no more than this share of the largest one beside it: the search hardly counts it.
const SMALL_BESIDE: f64 = 1e-3;
/// A moment that is stated not to scatter is still up to this share of the trace, and one that is not larger is none.
const STILL: f64 = 1e-6;
/// A share of impossible bodies that is worth a word.
const IMPOSSIBLE: f64 = 1e-3;
/// Roots nearer to zero than this many deviations.
const FLAT: f64 = 2.0;
/// A shift of a moment, as a share of it, that is worth a word.
const SHIFT: f64 = 0.01;

/// What a model was made of.
pub(super) struct Context {
    pub(super) body: Body,
    pub(super) stated: Stated,
    /// What comes out without a limit of the axes, where axes and products are stated.
    pub(super) unlimited: Option<Outcome>,
    /// What the products do alone, where moments are stated as well and products fall short.
    pub(super) alone: Option<Outcome>,
    /// Deviations that a mass centre would give entries beside everything else, kg·m².
    pub(super) with_centre: [Option<f64>; 6],
}

/// What a solution comes to.
pub(super) struct Outcome {
    /// Deviations of the rotations, rad; infinite where a turn may be any.
    turns: [f64; 3],
    /// Deviations of the entries, kg·m².
    entries: [f64; 6],
}

impl Outcome {
    pub(super) fn new(body: &Body, solution: &Solution) -> Result<Self, StatementError> {
        let scatter = &solution.scatter;
        Ok(Self {
            turns: scatter.rotation_variances().map(f64::sqrt),
            entries: body.moments(scatter, &body.law(scatter)?).deviations(),
        })
    }
}

impl Context {
    /// The warnings of a model.
    pub(super) fn warnings(&self, model: &StatedModel) -> Vec<StatementWarning> {
        let stated = &self.stated;
        let mut warnings = said_nothing_of(model, stated);
        warnings.extend(axes_without_effect(model, stated));
        warnings.extend(follows_in_part(model, stated));
        if matches!(model.law_at_nominal_mass().roots(), RootLaw::CorrelatedGaussian(_)) {
            warnings.push(StatementWarning::Correlated);
        }
        warnings.extend(centre_alone(model, stated));
        warnings.extend(self.centre_missed(model));
        if let (Some(axes), Some(unlimited)) = (stated.axes, &self.unlimited) {
            let differ = |a: f64, b: f64| !((a - b).abs() <= 0.1 * a.max(b));
            if (0..3).any(|j| differ(axes[j], unlimited.turns[j])) {
                let (products, turns) = (unlimited.turns, model.turns());
                warnings.push(StatementWarning::AxesAndProducts { axes, products, turns });
            }
        }
        for (axis, turn) in (1..).zip(model.turns()) {
            if !turn.is_finite() {
                warnings.push(StatementWarning::Free { axis });
            }
        }
        warnings.extend(self.missed(model));
        warnings.extend(of_outcome(model));
        warnings
    }

    /// The entries that do not have what the mass centre would give them.
    fn centre_missed(&self, model: &StatedModel) -> Vec<StatementWarning> {
        let implied = model.implied().deviations();
        // Axes that are held still turn what scatters by as much.
        let held = FIXED * model.nominal().matrix().trace();
        let mut warnings = Vec::new();
        for three in [0..3, 3..6] {
            let wanted = &self.with_centre[three.clone()];
            let largest = wanted.iter().flatten().copied().fold(0.0, f64::max);
            for (entry, wanted) in three.zip(wanted) {
                let Some(wanted) = *wanted else { continue };
                let off = (implied[entry] - wanted).abs();
                if off > (AGREE * wanted).max(SMALL_BESIDE * largest).max(held) {
                    let implied = implied[entry];
                    warnings.push(StatementWarning::CentreMissed { entry, wanted, implied });
                }
            }
        }
        warnings
    }

    /// The entries that do not have the stated deviation, and why.
    fn missed(&self, model: &StatedModel) -> Vec<StatementWarning> {
        let trace = model.nominal().matrix().trace();
        let deviations = model.implied().deviations();
        let mut warnings = Vec::new();
        for (first, three) in [(0, self.stated.moments), (3, self.stated.products)] {
            let Some(three) = three else { continue };
            let small = SMALL * three.into_iter().fold(0.0, f64::max) + 1e-8 * trace;
            for (entry, stated) in (first..).zip(three) {
                let implied = deviations[entry];
                let still = if entry < 3 { STILL } else { FIXED } * trace;
                let small = if stated == 0.0 { small.max(still) } else { small };
                if (implied - stated).abs() > (AGREE * stated).max(small) {
                    let because = if implied > stated {
                        self.why_more(model, entry, stated)
                    } else {
                        self.why_less(model, entry, stated)
                    };
                    warnings.push(StatementWarning::Missed { entry, stated, implied, because });
                }
            }
        }
        warnings
    }

    fn why_more(&self, model: &StatedModel, entry: usize, stated: f64) -> MissedBecause {
        let scatter = *model.scatter();
        let nearly = 0.9 * stated;
        let resting = Scatter { roots: Matrix3::zeros(), ..scatter };
        let resting = self.body.second_moments(&resting);
        let by_axes = self.body.forms(&scatter).variances(&resting)[entry].sqrt();
        let still = Forms::still(&self.body.attitude);
        let by_moments = still.variances(&self.body.second_moments(&scatter))[entry].sqrt();
        let mass = model.mass().map_or(0.0, |mass| mass.factor_deviation());
        let by_mass = mass * model.nominal().entries()[entry].abs();
        let of_axes = (by_axes, MissedBecause::Axes { alone: by_axes });
        let of_mass = (by_mass, MissedBecause::Mass { alone: by_mass });
        let of_moments = (by_moments, MissedBecause::Moments { alone: by_moments });
        let (each, other) = if entry < 3 {
            (vec![of_axes, of_mass], MissedBecause::Tied)
        } else {
            (vec![of_axes, of_mass, of_moments], MissedBecause::Together)
        };
        let largest = each.into_iter().max_by(|(a, _), (b, _)| a.total_cmp(b));
        // What moves it beyond what is stated, and is most of what comes out.
        let implied = model.implied().deviations()[entry];
        let enough = largest.filter(|(alone, _)| *alone > nearly && *alone > 0.5 * implied);
        enough.map_or(other, |(_, because)| because)
    }

    /// What keeps a product from more: whatever it would gain the most without.
    fn why_less(&self, model: &StatedModel, entry: usize, stated: f64) -> MissedBecause {
        if entry < 3 {
            return MissedBecause::Tied;
        }
        let binding = self.stated.axes.is_some_and(|axes| {
            let turns = model.turns().into_iter().zip(axes);
            turns.into_iter().any(|(turn, limit)| turn >= (1.0 - AGREE) * limit)
        });
        // With the moments as they are stated, and with nothing else stated.
        let implied = model.implied().deviations()[entry];
        let of = |outcome: Option<&Outcome>, least: f64| {
            outcome.map_or(least, |it| it.entries[entry].clamp(least, stated.max(least)))
        };
        let unlimited = of(self.unlimited.as_ref().filter(|_| binding), implied);
        let alone = of(self.alone.as_ref(), unlimited);
        let gains = [
            (stated - alone, MissedBecause::Rotations),
            (alone - unlimited, MissedBecause::MomentsLimit),
            (unlimited - implied, MissedBecause::AxesLimit),
        ];
        let largest = gains.into_iter().max_by(|(a, _), (b, _)| a.total_cmp(b));
        largest.map_or(MissedBecause::Rotations, |(_, because)| because)
    }
}

/// Whether a product is surer than stated.
pub(super) fn products_fall_short(model: &StatedModel, stated: &Stated) -> bool {
    let implied = model.implied().deviations();
    let short = |(i, product): (usize, f64)| implied[3 + i] < (1.0 - AGREE) * product;
    stated.products.is_some_and(|products| products.into_iter().enumerate().any(short))
}

/// What the statements leave open.
fn said_nothing_of(model: &StatedModel, stated: &Stated) -> Vec<StatementWarning> {
    let mut warnings = Vec::new();
    if stated.moments.is_none() && stated.centre.is_none() && model.mass().is_none() {
        warnings.push(StatementWarning::FixedMoments);
    }
    if stated.products.is_none() && stated.axes.is_none() && stated.centre.is_none() {
        warnings.push(StatementWarning::FixedAxes);
    }
    warnings
}

/// A turn changes nothing where the two moments that it mixes are equal, and stay so: all three of a ball, and one of a body of revolution.
fn axes_without_effect(model: &StatedModel, stated: &Stated) -> Option<StatementWarning> {
    let axes = stated.axes?;
    let k = model.nominal().second_moments().values();
    let most = STILL * model.nominal().matrix().trace();
    let scatter = model.law_at_nominal_mass().roots().second_moment_statistics().variances();
    let does_nothing = |axis: &usize| {
        let [m, n] = [(axis + 1) % 3, (axis + 2) % 3];
        (k[m] - k[n]).abs() <= most && [m, n].iter().all(|i| scatter[*i].sqrt() <= most)
    };
    let mut turned = (0..3).filter(|axis| axes[*axis] > 0.0).peekable();
    (turned.peek().is_some() && turned.all(|axis| does_nothing(&axis)))
        .then_some(StatementWarning::AxesWithoutEffect)
}

/// Where the inertia cannot wholly follow the mass, the moment that would be moved most beyond what is
/// stated of it.
fn follows_in_part(model: &StatedModel, stated: &Stated) -> Option<StatementWarning> {
    let mass = model.mass().filter(|mass| mass.inertia_follows() < 1.0)?;
    let (moments, entries) = (stated.moments?, model.nominal().entries());
    let alone = |e: usize| mass.relative_deviation() * entries[e].abs();
    let entry =
        (0..3).max_by(|&a, &b| (alone(a) * moments[b]).total_cmp(&(alone(b) * moments[a])))?;
    Some(StatementWarning::FollowsInPart {
        share: mass.inertia_follows(),
        entry,
        alone: alone(entry),
        stated: moments[entry],
    })
}

/// What the mass centre alone does may not exceed what is stated of the whole: of an entry, or of the axes, which turn a product
/// of which nothing else is stated.
fn centre_alone(model: &StatedModel, stated: &Stated) -> Vec<StatementWarning> {
    let Some(centre) = stated.centre else { return Vec::new() };
    let alone = centre.map(f64::sqrt);
    let implied = model.implied().deviations();
    let little = SMALL_BESIDE * alone[3..].iter().copied().fold(0.0, f64::max);
    let little = little.max(FIXED * model.nominal().matrix().trace());
    let mut warnings = Vec::new();
    for (entry, stated_of_it) in model.stated().into_iter().enumerate() {
        let (alone, implied) = (alone[entry], implied[entry]);
        match stated_of_it {
            Some(stated) => {
                // By less than a thousandth, nobody sees it.
                if alone > stated * 1.001 {
                    warnings.push(StatementWarning::Alone { entry, alone, stated });
                }
            }
            None => {
                let more = alone > implied + (AGREE * alone).max(little);
                if entry >= 3 && stated.axes.is_some() && more {
                    warnings.push(StatementWarning::CentreBesideAxes { entry, alone, implied });
                }
            }
        }
    }
    warnings
}

/// What the law itself has of note.
fn of_outcome(model: &StatedModel) -> Vec<StatementWarning> {
    let (nominal, implied) = (model.nominal(), model.implied());
    let mut warnings = Vec::new();
    if let [Some(a), Some(b), Some(c), ..] = model.stated() {
        let share = impossible_share(nominal, [a, b, c]);
        if share > IMPOSSIBLE {
            warnings.push(StatementWarning::Impossible { share });
        }
    }
    let roots = nominal.second_moments().roots().values();
    for (axis, (root, deviation)) in (1..).zip(roots.into_iter().zip(model.root_deviations())) {
        let ratio = root / deviation;
        if ratio < FLAT {
            warnings.push(StatementWarning::Flat { axis, ratio });
        }
    }
    let k = nominal.second_moments().values();
    // The mass multiplies all moments alike, and makes none the larger one.
    let moments = model.law_at_nominal_mass().roots().second_moment_statistics();
    let (scatter, c) = (moments.variances(), moments.covariance());
    for [m, n] in [[0, 1], [0, 2], [1, 2]] {
        // A uniform turn is told.
        if !model.turns()[3 - m - n].is_finite() {
            continue;
        }
        if (k[m] - k[n]).abs() < (scatter[m] + scatter[n] - 2.0 * c[(m, n)]).max(0.0).sqrt() {
            warnings.push(StatementWarning::EqualMoments { axes: [m + 1, n + 1] });
        }
    }
    for entry in 0..3 {
        let (x, mean) = (nominal.entries()[entry], implied.mean()[entry]);
        let shift = (mean - x) / x;
        let none = STILL * nominal.matrix().trace();
        if x.abs() <= none {
            // Of next to nothing, a share says nothing.
            if mean - x > none {
                warnings.push(StatementWarning::Raised { entry, mean });
            }
        } else if shift.abs() > SHIFT {
            warnings.push(StatementWarning::Shifted { entry, percent: 100.0 * shift });
        }
    }
    warnings
}
