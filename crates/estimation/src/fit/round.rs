//! Samples that have two equal moments each: a turn about the third axis changes nothing, so they have none.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::{matching::mean_attitude, relabel::Sample};

/// Second moments nearer than this share of the sum of all are equal, to the six digits that tables carry.
const EQUAL: f64 = 1e-5;

/// About which principal axes all bodies of a sample are round: those about which a turn changes nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Roundness {
    /// About none in every sample.
    No,
    /// About one, counted from 0: the moments about the other two are the same in every sample, to the digits of tables.
    About(usize),
    /// About all: the three moments are the same in every sample.
    Ball,
}

impl Roundness {
    pub(super) fn of(samples: &[Sample]) -> Self {
        let is_round = |axis: &usize| {
            samples.iter().all(|s| {
                let k = s.roots.map(|root| root * root);
                let apart = (k[(axis + 1) % 3] - k[(axis + 2) % 3]).abs();
                apart <= EQUAL * k.iter().sum::<f64>()
            })
        };
        let mut axes = (0..3).filter(is_round);
        match (axes.next(), axes.next()) {
            (None, _) => Self::No,
            (Some(axis), None) => Self::About(axis),
            (Some(_), Some(_)) => Self::Ball,
        }
    }

    /// Whether a turn about this axis changes nothing.
    pub(super) fn is_about(self, axis: usize) -> bool {
        match self {
            Self::No => false,
            Self::About(own) => own == axis,
            Self::Ball => true,
        }
    }
}

/// The direction of a principal axis in the body.
pub(super) fn direction(attitude: &UnitQuaternion<f64>, axis: usize) -> Vector3<f64> {
    attitude.inverse() * Vector3::ith(axis, 1.0)
}

/// The same of the end of the axis that is nearer to a direction.
pub(super) fn direction_near(
    centre: &Vector3<f64>,
    attitude: &UnitQuaternion<f64>,
    axis: usize,
) -> Vector3<f64> {
    let a = direction(attitude, axis);
    a * 1.0_f64.copysign(a.dot(centre))
}

/// The mean attitude, turned by the shortest way so that `axis` has its mean direction in the body, whichever ends are
/// which.
pub(super) fn mean_about(
    samples: &[Sample],
    mean: &UnitQuaternion<f64>,
    axis: usize,
) -> UnitQuaternion<f64> {
    let old = direction(mean, axis);
    let directions = samples.iter().map(|s| direction(&s.attitude, axis));
    let eigen = directions.map(|a| a * a.transpose()).sum::<Matrix3<f64>>().symmetric_eigen();
    let new: Vector3<f64> = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into();
    let new = new * 1.0_f64.copysign(new.dot(&old));
    UnitQuaternion::rotation_between(&old, &new).map_or(*mean, |turn| mean * turn.inverse())
}

/// The samples with the attitudes that are nearest to one another: bodies that are round about one axis differ from their
/// mean by a tilt of that axis alone, bodies with three equal moments not at all. Others are as they were.
pub(super) fn straightened(mut samples: Vec<Sample>) -> Vec<Sample> {
    let round = Roundness::of(&samples);
    if round == Roundness::No {
        return samples;
    }
    let mean = mean_attitude(samples.iter().map(|s| &s.attitude));
    if let Roundness::About(axis) = round {
        let mean = mean_about(&samples, &mean, axis);
        let centre = direction(&mean, axis);
        for sample in &mut samples {
            let a = direction_near(&centre, &sample.attitude, axis);
            if let Some(tilt) = UnitQuaternion::rotation_between(&a, &centre) {
                sample.attitude = mean * tilt;
            }
        }
    } else {
        samples.iter_mut().for_each(|sample| sample.attitude = mean);
    }
    samples
}
