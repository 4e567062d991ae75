//! Between which angles a body that turns freely nutates.

/// The angles between the first principal axis a₁ and the angular momentum H that the free motion goes
/// through, rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Range {
    /// The least and the greatest.
    pub(crate) bounds: [f64; 2],
    /// Where H passes the planes of axes 1 and 2, and of axes 1 and 3: the same two, in this order.
    /// None where H does not circle a₁ or −a₁, or does so for no reason but equal moments.
    pub(crate) crossings: Option<[f64; 2]>,
}

impl Range {
    /// Of a body with the given principal moments and components of momentum along their axes, at
    /// `now` (rad) from the first. None if it does not turn. Moments that are equal must be the same number: where
    /// rounding told them apart, the body would need ages to go through the range.
    ///
    /// # Algorithm
    /// Energy and momentum leave the squares of the components a straight line, with the direction
    /// (I₁(I₃ − I₂), I₂(I₁ − I₃), I₃(I₂ − I₁)), of which the motion covers all that has no negative
    /// square (Landau & Lifshitz, Mechanics, §37). The ends are where a square is zero. They are found
    /// from where the body is, so that a small nutation is no difference of large numbers. If the first
    /// square reaches zero its component changes sign, and the axis is met from both sides: H circles
    /// another axis. Else the ends are where the third and the second square are zero, the crossings
    /// of the two planes, which is Eq. 35 of Peck (2003).
    pub(crate) fn new(moments: [f64; 3], momentum: [f64; 3], now: f64) -> Option<Self> {
        let largest = momentum.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        if !(largest > 0.0 && momentum.iter().all(|x| x.is_finite())) {
            return None;
        }
        let h = momentum.map(|x| x / largest);
        let squares = h.map(|x| x * x);
        let scale = moments.iter().fold(0.0_f64, |m, x| m.max(*x));
        let [a, b, c] = moments.map(|x| x / scale);
        let line = [a * (c - b), b * (a - c), c * (b - a)];

        // The end of the line on which the sign is taken: the angle there, and whose square vanishes.
        let end = |sign: f64| {
            let falling = (0..3).filter(|&i| sign * line[i] < 0.0);
            let room = |i: usize| squares[i] / line[i].abs();
            let zero = falling.min_by(|&i, &j| room(i).total_cmp(&room(j)));
            let at = |i: usize| match zero {
                Some(zero) if i == zero => 0.0,
                Some(zero) => (squares[i] + sign * room(zero) * line[i]).max(0.0),
                // A body of three equal moments stays where it is.
                None => squares[i],
            };
            let along = at(0).sqrt().copysign(h[0]);
            (libm::atan2((at(1) + at(2)).sqrt(), along), zero)
        };
        let ends = [end(1.0), end(-1.0)];
        let turns_over = ends.iter().any(|(_, zero)| *zero == Some(0));
        let angles = ends.iter().flat_map(|(angle, _)| {
            let other = if turns_over { std::f64::consts::PI - angle } else { *angle };
            [*angle, other]
        });
        // Rounding of the ends must not leave out where the body is.
        let bounds =
            angles.fold([now, now], |[least, greatest], x| [least.min(x), greatest.max(x)]);
        let steady = (a - b) * (a - c) > 0.0;
        let where_zero =
            |i: usize| ends.iter().find(|(_, z)| *z == Some(i)).map(|(angle, _)| *angle);
        let crossings = match (where_zero(2), where_zero(1)) {
            (Some(second), Some(third)) if steady && !turns_over => Some([second, third]),
            _ => None,
        };
        Some(Self { bounds, crossings })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// The bounds of the motion, seen from where it is.
    fn bounds(moments: [f64; 3], h: [f64; 3]) -> Option<[f64; 2]> {
        let now = h[1].hypot(h[2]).atan2(h[0]);
        Range::new(moments, h, now).map(|range| range.bounds)
    }

    /// Euler's equations by many small steps of Runge-Kutta: the range that the nutation has.
    fn watched(moments: [f64; 3], momentum: [f64; 3]) -> [f64; 2] {
        let [a, b, c] = moments;
        let rate = |h: [f64; 3]| {
            [
                h[1] * h[2] * (1.0 / c - 1.0 / b),
                h[2] * h[0] * (1.0 / a - 1.0 / c),
                h[0] * h[1] * (1.0 / b - 1.0 / a),
            ]
        };
        let plus = |h: [f64; 3], k: [f64; 3], dt: f64| std::array::from_fn(|i| h[i] + k[i] * dt);
        let (mut h, dt) = (momentum, 2e-3);
        let (mut least, mut greatest) = (PI, 0.0_f64);
        for _ in 0..40_000 {
            let k1 = rate(h);
            let k2 = rate(plus(h, k1, 0.5 * dt));
            let k3 = rate(plus(h, k2, 0.5 * dt));
            let k4 = rate(plus(h, k3, dt));
            h = std::array::from_fn(|i| {
                h[i] + dt / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i])
            });
            let angle = h[1].hypot(h[2]).atan2(h[0]);
            (least, greatest) = (least.min(angle), greatest.max(angle));
        }
        [least, greatest]
    }

    /// All orders of the moments, and momentum about every axis: the axis may be the least, the
    /// intermediate or the greatest, and H may circle it or another one.
    #[test]
    fn bounds_are_those_of_the_motion() {
        let m = [1.0, 1.4, 2.0];
        for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
            let moments = order.map(|i| m[i]);
            for h in [[3.0, 0.3, 0.5], [-3.0, 0.4, 0.2], [0.3, 3.0, 0.4], [0.2, -0.5, 3.0]] {
                let [least, greatest] = bounds(moments, h).unwrap();
                let seen = watched(moments, h);
                // A step passes by an extreme at some distance.
                assert!((least - seen[0]).abs() < 2e-5, "{moments:?} {h:?}: {least} {seen:?}");
                assert!(
                    (greatest - seen[1]).abs() < 2e-5,
                    "{moments:?} {h:?}: {greatest} {seen:?}"
                );
                assert!(least <= seen[0] + 1e-9 && greatest >= seen[1] - 1e-9);
            }
        }
    }

    #[test]
    fn closed_cases() {
        // Axisymmetric about the axis: constant.
        let [least, greatest] = bounds([3.0, 2.0, 2.0], [1.0, 0.3, 0.4]).unwrap();
        assert!((least - 0.5_f64.atan()).abs() < 1e-15 && (greatest - least).abs() < 1e-15);
        // A sphere.
        let [least, greatest] = bounds([2.0; 3], [1.0, 1.0, 0.0]).unwrap();
        assert!((least - PI / 4.0).abs() < 1e-15 && least == greatest);
        // Axisymmetric about another axis, which H circles: from θ to π − θ.
        let [least, greatest] = bounds([2.0, 2.0, 3.0], [3.0, 0.0, 4.0]).unwrap();
        assert!((least - (4.0_f64 / 3.0).atan()).abs() < 1e-15);
        assert!((least + greatest - PI).abs() < 1e-15);
        // Steady turns about principal axes.
        assert_eq!(bounds([1.0, 2.0, 3.0], [7.0, 0.0, 0.0]), Some([0.0, 0.0]));
        assert_eq!(bounds([1.0, 2.0, 3.0], [-7.0, 0.0, 0.0]), Some([PI, PI]));
        assert_eq!(bounds([1.0, 2.0, 3.0], [0.0, 0.0, 7.0]), Some([FRAC_PI_2, FRAC_PI_2]));
    }

    /// sin θ at the ends is h₂√(1 + …)/H, however small.
    #[test]
    fn small_nutation_has_all_its_digits() {
        let (moments, small) = ([3.0, 2.0, 1.0], 1e-12);
        let [least, greatest] = bounds(moments, [1.0, 0.0, small]).unwrap();
        // The square of h₂ per that of h₃ on the line: 2(3 − 1) for 1(3 − 2).
        assert!((least / small - 1.0).abs() < 1e-12, "{least}");
        assert!((greatest / small - 2.0).abs() < 1e-12, "{greatest}");
        let huge = bounds(moments.map(|x| x * 1e200), [1e200, 0.0, 1e188]).unwrap();
        assert!((huge[1] / greatest - 1.0).abs() < 1e-12);
    }

    #[test]
    fn what_does_not_turn_has_none() {
        assert_eq!(bounds([1.0, 2.0, 3.0], [0.0; 3]), None);
        assert_eq!(bounds([1.0, 2.0, 3.0], [f64::NAN, 0.0, 1.0]), None);
        assert_eq!(bounds([1.0, 2.0, 3.0], [f64::INFINITY, 0.0, 1.0]), None);
    }
}
