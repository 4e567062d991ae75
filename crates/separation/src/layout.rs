//! Where the entries of a state that is integrated stand, and to which degree its series go.

/// Degree of the series of a state.
pub(crate) const ORDER: usize = 14;
/// Degrees at which an expansion may stop: sooner than at the last where a release ends the step.
pub(crate) const STOPS: [usize; 3] = [5, 9, ORDER];
/// Coefficients of a series.
pub(crate) const TERMS: usize = ORDER + 1;

/// A state: from the stage's mass centre to the payload's and the relative velocity (payload axes),
/// the quaternions from stage to payload and from payload to inertial components, the angular
/// velocities in body axes. The mass centre of the whole moves uniformly and is not integrated.
pub(crate) const STATE: usize = 20;
pub(crate) const OFFSET: usize = 0;
pub(crate) const VELOCITY: usize = 3;
pub(crate) const RELATIVE: usize = 6;
pub(crate) const ATTITUDE: usize = 10;
pub(crate) const PAYLOAD_RATE: usize = 14;
pub(crate) const STAGE_RATE: usize = 17;

/// Loads that a run holds without allocating.
pub(crate) const INLINE_LOADS: usize = 8;

/// 1/k.
pub(crate) const INVERSE: [f64; TERMS] = {
    let mut inverse = [0.0; TERMS];
    let mut k = 1;
    while k < TERMS {
        inverse[k] = 1.0 / k as f64;
        k += 1;
    }
    inverse
};

/// A few neighbouring entries of a state.
#[inline(always)]
pub(crate) fn part<T: Copy, const N: usize>(state: &[T; STATE], at: usize) -> [T; N] {
    std::array::from_fn(|i| state[at + i])
}
