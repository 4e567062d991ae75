//! Measures of a body's spin about an intended axis.

use gyradius_inertia::InertiaMatrix;
use nalgebra::{Unit, Vector3};

use crate::{nutation::Range, spin_axes::SpinAxes};

/// What became of the spin: the measures of Peck (2003, Eq. 32-37), in rad.
///
/// The spin axis s is a direction fixed in the body. a₁ is the principal axis nearest to it,
/// pointing along it (a₁·s ≥ 0), with moment I₁. I₂ and I₃ belong to the next two principal axes in
/// cyclic order (1 → 2 → 3 → 1), each principal axis having the number of the body axis that it is
/// matched to (`InertiaMatrix::principal_axes`): for a spin about body axis 1 they are the moments about
/// the principal axes near body axes 2 and 3, for one about axis 3 those near axes 1 and 2. Neither is
/// the larger by definition. H = Iω and E are angular momentum and rotational energy.
///
/// Where two moments are equal, every axis in their plane is principal, and a₁ may be the projection of s on it; where all
/// three are, a₁ is s. Then the wobble is that angle to the plane, or zero. Moments are equal up to
/// [`RELATIVE_TOLERANCE`](gyradius_inertia::RELATIVE_TOLERANCE) of the largest. So no measure depends on how the body axes
/// lie in the body.
///
/// ```
/// use gyradius_inertia::InertiaMatrix;
/// use gyradius_separation::SpinMetrics;
/// use nalgebra::Vector3;
///
/// // The payload of Peck (2003), Table 1, spun about body axis 1.
/// let inertia = InertiaMatrix::from_entries([5e3, 4e3, 3e3], [20.0, 2.0, -50.0])?;
/// let metrics = SpinMetrics::new(&inertia, &(Vector3::x() * 0.1), &Vector3::x_axis());
/// assert_eq!(metrics.inertia_ratio().map(|ratio| format!("{ratio:.3}")), Some("1.408".to_owned()));
/// assert_eq!(format!("{:.3}", metrics.wobble().to_degrees()), "1.144");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(remote = "Self"))]
pub struct SpinMetrics {
    spin_rate: f64,
    wobble: f64,
    nutation: Option<f64>,
    nutation_2: Option<f64>,
    nutation_3: Option<f64>,
    nutation_bounds: Option<[f64; 2]>,
    cone: Option<f64>,
    inertia_ratio: Option<f64>,
}

impl SpinMetrics {
    /// Of a body with the given inertia and angular velocity (rad/s), both in body axes, meant to
    /// spin about `spin_axis`.
    #[must_use]
    pub fn new(
        inertia: &InertiaMatrix,
        angular_velocity: &Vector3<f64>,
        spin_axis: &Unit<Vector3<f64>>,
    ) -> Self {
        Self::above(inertia, angular_velocity, spin_axis, 0.0)
    }

    /// The same; an angular momentum of at most `rounding` (kg·m²/s) is none.
    pub(crate) fn above(
        inertia: &InertiaMatrix,
        angular_velocity: &Vector3<f64>,
        spin_axis: &Unit<Vector3<f64>>,
        rounding: f64,
    ) -> Self {
        let SpinAxes { axes, moments } = SpinAxes::new(inertia, spin_axis);
        let [a1, ..] = axes;
        let momentum = inertia.matrix() * angular_velocity;
        let turns = momentum.norm() > rounding;
        let nutation = turns.then(|| angle(&a1, &momentum));
        let along = axes.map(|axis| axis.dot(&momentum));
        let range = nutation.and_then(|now| Range::new(moments, along, now));
        let crossing = |i: usize| range.and_then(|range| Some(range.crossings?[i]));
        Self {
            spin_rate: angular_velocity.norm(),
            wobble: angle(spin_axis, &a1),
            nutation,
            nutation_2: crossing(0),
            nutation_3: crossing(1),
            nutation_bounds: range.map(|range| range.bounds),
            cone: turns.then(|| angle(spin_axis, &momentum)),
            inertia_ratio: inertia_ratio(moments),
        }
    }

    /// |ω|, rad/s.
    #[must_use]
    pub fn spin_rate(&self) -> f64 {
        self.spin_rate
    }

    /// Angle between the spin axis and the nearest principal axis (Eq. 33), rad.
    #[must_use]
    pub fn wobble(&self) -> f64 {
        self.wobble
    }

    /// Angle between a₁ and H (Eq. 34), rad, in 0 to π; above π/2 where the body spins backward about a₁.
    /// None if the body does not turn.
    #[must_use]
    pub fn nutation(&self) -> Option<f64> {
        self.nutation
    }

    /// Nutation where the free motion passes the plane of the principal axes 1 and 2 (Eq. 35, θ₂), rad;
    /// one of its two extremes. It lies in 0 to π/2 where H circles a₁, and in π/2 to π where H circles
    /// −a₁, which is a backward spin. None where the extremes mean nothing: the body does not turn, a₁
    /// is the intermediate axis, or H circles another axis than a₁.
    #[must_use]
    pub fn nutation_2(&self) -> Option<f64> {
        self.nutation_2
    }

    /// Nutation where the free motion passes the plane of the principal axes 1 and 3 (Eq. 35, θ₃), rad;
    /// the other extreme.
    #[must_use]
    pub fn nutation_3(&self) -> Option<f64> {
        self.nutation_3
    }

    /// Least and greatest nutation of the free motion, rad: what energy and momentum allow, whatever
    /// axis H circles. Where H circles another axis than a₁, a₁ passes through 90° and the two add up to
    /// 180°. None if the body does not turn. On the separatrix, and at rest on the intermediate axis
    /// itself, the bounds are those of the motion that leaves it.
    #[must_use]
    pub fn nutation_bounds(&self) -> Option<[f64; 2]> {
        self.nutation_bounds
    }

    /// Angle between the spin axis and H (Eq. 36), rad; none if the body does not turn.
    #[must_use]
    pub fn cone(&self) -> Option<f64> {
        self.cone
    }

    /// Inertia ratio σ = 1 + Re √((1 − I₁/I₂)(1 − I₁/I₃)) · sgn(I₁ − I₂) (Eq. 37), roll to pitch: above
    /// 1 for spin about the axis of largest moment, 1 for the intermediate. I₂ and I₃ may change places.
    /// None where I₂ or I₃ is zero: of a rod that spins across its own axis, bodies as near to it as one likes have every
    /// ratio from 1 to 2.
    #[must_use]
    pub fn inertia_ratio(&self) -> Option<f64> {
        self.inertia_ratio
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for SpinMetrics {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        Self::serialize(self, to)
    }
}

/// Angles between 0 and π, and a rate that is not negative. The ratio of a body that cannot exist may be any number.
#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for SpinMetrics {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let read = Self::deserialize(from)?;
        let bounds = read.nutation_bounds.unwrap_or_default();
        let angles = [read.nutation, read.nutation_2, read.nutation_3, read.cone];
        let mut angles = angles.into_iter().flatten().chain(bounds).chain([read.wobble]);
        let sound = angles.all(|angle| (0.0..=std::f64::consts::PI).contains(&angle))
            && bounds[0] <= bounds[1]
            && (0.0..=f64::MAX).contains(&read.spin_rate)
            && read.inertia_ratio.is_none_or(f64::is_finite);
        if sound {
            return Ok(read);
        }
        Err(serde::de::Error::custom(format!(
            "{read:?}: angles must lie between 0 and π, in order where they are bounds, and spin_rate must not be negative"
        )))
    }
}

fn inertia_ratio([i1, i2, i3]: [f64; 3]) -> Option<f64> {
    // Moments are known to a few ε of the largest. Of a body, that moves the product by as much over the smaller of I₂ and I₃.
    let largest = i1.abs().max(i2.abs()).max(i3.abs());
    if i2.abs().min(i3.abs()) <= 1024.0 * f64::EPSILON * largest {
        return None;
    }
    let product = (1.0 - i1 / i2) * (1.0 - i1 / i3);
    Some(if product > 0.0 { 1.0 + product.sqrt().copysign(i1 - i2) } else { 1.0 })
}

/// Angle between a vector and a direction; none for a vector of length zero or that is not finite.
pub(crate) fn angle_of(vector: &Vector3<f64>, direction: &Unit<Vector3<f64>>) -> Option<f64> {
    // Scaled, for squares over- and underflow.
    let scaled = vector / vector.amax();
    scaled.iter().all(|x| x.is_finite()).then(|| angle(&scaled, direction))
}

/// Angle between two directions, accurate near 0 and π, where acos is not.
fn angle(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    libm::atan2(a.cross(b).norm(), a.dot(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const X: Unit<Vector3<f64>> = Unit::new_unchecked(Vector3::new(1.0, 0.0, 0.0));

    fn matrix(moments: [f64; 3], products: [f64; 3]) -> InertiaMatrix {
        InertiaMatrix::from_entries(moments, products).unwrap()
    }

    #[cfg(feature = "serde")]
    proptest! {
        /// Of any body, also of rods, which may have no ratio, and of bodies at rest.
        #[test]
        fn metrics_read_back_to_the_bit(
            roots in prop::array::uniform3(prop_oneof![Just(0.0), 1e-3..1e3]),
            turn in prop::array::uniform3(-4.0..4.0),
            rate in prop::array::uniform3(prop_oneof![Just(0.0), -10.0..10.0]),
        ) {
            let [a, b, c] = roots;
            let axes = *nalgebra::Rotation3::new(Vector3::from(turn)).matrix();
            let diagonal = nalgebra::Matrix3::from_diagonal(&Vector3::new(b + c, a + c, a + b));
            let turned: nalgebra::Matrix3<f64> = axes * diagonal * axes.transpose();
            let inertia = InertiaMatrix::new((turned + turned.transpose()) * 0.5).unwrap();
            let metrics = SpinMetrics::new(&inertia, &Vector3::from(rate), &X);
            let json = serde_json::to_value(metrics).unwrap();
            prop_assert_eq!(serde_json::from_str::<SpinMetrics>(&json.to_string()).unwrap(), metrics);
            for (field, value) in [("wobble", 4.0), ("spin_rate", -1.0), ("cone", -0.1)] {
                let mut bad = json.clone();
                bad[field] = value.into();
                prop_assert!(serde_json::from_value::<SpinMetrics>(bad).is_err(), "{}", field);
            }
        }
    }

    /// One of negative moment has a negative ratio: 1 − √((1 + ½)(1 + ½)).
    #[cfg(feature = "serde")]
    #[test]
    fn metrics_of_a_body_that_cannot_exist_read_back() {
        let metrics = SpinMetrics::new(&matrix([-0.5, 1.0, 1.0], [0.0; 3]), &Vector3::x(), &X);
        assert_eq!(metrics.inertia_ratio(), Some(-0.5));
        let json = serde_json::to_string(&metrics).unwrap();
        assert_eq!(serde_json::from_str::<SpinMetrics>(&json).unwrap(), metrics);
    }

    /// Peck (2003), Results: "the central values … are 1.408 and 1.144°".
    #[test]
    fn the_papers_central_values() {
        let payload = matrix([5000.0, 4000.0, 3000.0], [20.0, 2.0, -50.0]);
        let m = SpinMetrics::new(&payload, &Vector3::x(), &X);
        assert!((m.inertia_ratio().unwrap() - 1.4082601276539386).abs() < 1e-13);
        assert!((m.wobble().to_degrees() - 1.1442306542559595).abs() < 1e-12);
    }

    #[test]
    fn a_body_at_rest_has_no_nutation() {
        let m = SpinMetrics::new(&matrix([3.0, 2.0, 2.5], [0.0; 3]), &Vector3::zeros(), &X);
        assert_eq!((m.nutation(), m.cone(), m.nutation_2()), (None, None, None));
        assert_eq!(m.nutation_bounds(), None);
        assert_eq!(m.wobble(), 0.0);
    }

    #[test]
    fn spin_about_the_intermediate_axis_has_ratio_one_and_no_extremes() {
        let m = SpinMetrics::new(&matrix([2.5, 2.0, 3.0], [0.0; 3]), &Vector3::x(), &X);
        assert_eq!(m.inertia_ratio(), Some(1.0));
        assert_eq!((m.nutation_2(), m.nutation_3()), (None, None));
    }

    proptest! {
        /// A rod of any attitude that spins across itself has no ratio, along itself the ratio 0; one that is a little thick has
        /// what Eq. 37 gives for I₁ = a + c, I₂ = b + c and I₃ = a + b with a above b and c: σ = 1 + Re √((b − c)(b − a) / ((b + c)(b + a))).
        #[test]
        fn rods_across_their_axis_have_no_ratio(
            turn in prop::array::uniform3(-4.0..4.0),
            length in 1e-3..1e3_f64,
            thin in -6.0..-1.0_f64,
            share in 0.0..1.0_f64,
        ) {
            let axes = *nalgebra::Rotation3::new(Vector3::from(turn)).matrix();
            let of = |roots: [f64; 3], along: usize| {
                let moments = Vector3::from(roots).map(|root| roots.iter().sum::<f64>() - root);
                let turned: nalgebra::Matrix3<f64> = axes * nalgebra::Matrix3::from_diagonal(&moments) * axes.transpose();
                let inertia = InertiaMatrix::new((turned + turned.transpose()) * 0.5).unwrap();
                let axis = Unit::new_normalize(axes.column(along).into_owned());
                SpinMetrics::new(&inertia, axis.as_ref(), &axis).inertia_ratio()
            };
            for across in [1, 2] {
                prop_assert_eq!(of([length, 0.0, 0.0], across), None);
            }
            let along = of([length, 0.0, 0.0], 0).unwrap();
            prop_assert!(along.abs() < 1e-13, "{}", along);

            let [b, c] = [share, 1.0 - share].map(|x| x * length * 10.0_f64.powf(thin));
            let expected = 1.0 + ((b - c) * (b - length) / ((b + c) * (b + length))).max(0.0).sqrt();
            let found = of([length, b, c], 1).unwrap();
            prop_assert!((found - expected).abs() < 1e-4, "{} {}", found, expected);
        }
    }

    #[test]
    fn a_disc_and_a_pencil() {
        // Axisymmetric: σ is the plain ratio I₁/I₂, and nutation is constant.
        for (spin, transverse) in [(2.0, 1.5), (0.5, 2.0)] {
            let body = matrix([spin, transverse, transverse], [0.0; 3]);
            let m = SpinMetrics::new(&body, &Vector3::new(1.0, 0.1, -0.2), &X);
            assert!((m.inertia_ratio().unwrap() - spin / transverse).abs() < 1e-15);
            let nutation = m.nutation().unwrap();
            assert!((m.nutation_2().unwrap() - nutation).abs() < 1e-14);
            assert!((m.nutation_3().unwrap() - nutation).abs() < 1e-14);
        }
    }

    #[test]
    fn the_spin_axis_may_be_any_axis_and_the_rate_negative() {
        let s = Unit::new_normalize(Vector3::new(0.0, 0.1, -1.0));
        let m = SpinMetrics::new(&matrix([3.0, 2.0, 2.5], [0.0; 3]), &-Vector3::z(), &s);
        assert!((m.wobble() - 0.1_f64.atan()).abs() < 1e-15);
        assert_eq!(m.nutation(), Some(0.0));
        let backwards = SpinMetrics::new(&matrix([3.0, 2.0, 2.5], [0.0; 3]), &Vector3::z(), &s);
        assert!((backwards.nutation().unwrap() - std::f64::consts::PI).abs() < 1e-15);
        // The axis is the intermediate one, which the body leaves for its opposite.
        for metrics in [m, backwards] {
            assert_eq!(metrics.nutation_bounds(), Some([0.0, std::f64::consts::PI]));
        }
    }

    proptest! {
        /// Eq. 35 as printed, where its arc cosine is well conditioned, and the bounds it means.
        #[test]
        fn extremes_agree_with_the_printed_formula_and_bound_the_nutation(
            i2 in 1.0..4.0f64,
            i3 in 1.0..4.0f64,
            w2 in -0.3..0.3f64,
            w3 in -0.3..0.3f64,
        ) {
            prop_assume!(i2 + i3 > 4.5 && (i2 - i3).abs() < 3.0);
            let i1 = 4.5;
            let body = matrix([i1, i2, i3], [0.0; 3]);
            let w = Vector3::new(1.0, w2, w3);
            let m = SpinMetrics::new(&body, &w, &X);
            let h = body.matrix() * w;
            let (energy2, square) = (w.dot(&h), h.norm_squared());
            let printed = |i: f64| {
                (i1 * (energy2 * i - square) / ((i - i1) * square)).abs().sqrt().acos()
            };
            if let (Some(t2), Some(t3)) = (m.nutation_2(), m.nutation_3()) {
                prop_assert!((t2 - printed(i2)).abs() < 1e-7, "{t2} {}", printed(i2));
                prop_assert!((t3 - printed(i3)).abs() < 1e-7);
                let now = m.nutation().unwrap();
                prop_assert!(now >= t2.min(t3) - 1e-12 && now <= t2.max(t3) + 1e-12);
                let [least, greatest] = m.nutation_bounds().unwrap();
                prop_assert!((least - t2.min(t3)).abs() < 1e-12, "{least} {t2} {t3}");
                prop_assert!((greatest - t2.max(t3)).abs() < 1e-12, "{greatest} {t2} {t3}");
            }
        }
    }
}
