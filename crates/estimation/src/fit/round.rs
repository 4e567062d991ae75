//! Samples that have two equal moments each: a turn about the third axis changes nothing, so they have none.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::{matching::mean_attitude, relabel::Sample};

/// Second moments nearer than this share of the sum of all are equal, to the six digits that tables carry.
const EQUAL: f64 = 1e-5;

/// About which axes the bodies are round: whether the moments about the other two are the same in every sample, to the
/// digits of tables.
pub(super) fn round_axes(samples: &[Sample]) -> [bool; 3] {
    [0, 1, 2].map(|axis| {
        samples.iter().all(|s| {
            let k = s.roots.map(|root| root * root);
            (k[(axis + 1) % 3] - k[(axis + 2) % 3]).abs() <= EQUAL * k.iter().sum::<f64>()
        })
    })
}

/// The direction of a principal axis in the body.
pub(super) fn direction(attitude: &UnitQuaternion<f64>, axis: usize) -> Vector3<f64> {
    attitude.inverse() * Vector3::ith(axis, 1.0)
}

/// The mean attitude, turned by the shortest way so that `axis` has its mean direction in the body, whichever ends are
/// which.
pub(super) fn mean_about(samples: &[Sample], axis: usize) -> UnitQuaternion<f64> {
    let mean = mean_attitude(samples.iter().map(|s| &s.attitude));
    let old = direction(&mean, axis);
    let directions = samples.iter().map(|s| direction(&s.attitude, axis));
    let eigen = directions.map(|a| a * a.transpose()).sum::<Matrix3<f64>>().symmetric_eigen();
    let new: Vector3<f64> = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into();
    let new = new * 1.0_f64.copysign(new.dot(&old));
    UnitQuaternion::rotation_between(&old, &new).map_or(mean, |turn| mean * turn.inverse())
}

/// The samples with the attitudes that are nearest to one another: bodies that are round about one axis differ from their
/// mean by a tilt of that axis alone, bodies with three equal moments not at all. Others are as they were.
pub(super) fn straightened(mut samples: Vec<Sample>) -> Vec<Sample> {
    let round = round_axes(&samples);
    let Some(axis) = (0..3).find(|axis| round[*axis]) else { return samples };
    if round.iter().filter(|round| **round).count() > 1 {
        let attitude = mean_attitude(samples.iter().map(|s| &s.attitude));
        samples.iter_mut().for_each(|sample| sample.attitude = attitude);
        return samples;
    }
    let mean = mean_about(&samples, axis);
    let centre = direction(&mean, axis);
    for sample in &mut samples {
        let a = direction(&sample.attitude, axis);
        let a = a * 1.0_f64.copysign(a.dot(&centre));
        if let Some(tilt) = UnitQuaternion::rotation_between(&a, &centre) {
            sample.attitude = mean * tilt;
        }
    }
    samples
}
