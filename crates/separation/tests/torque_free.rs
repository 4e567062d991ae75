//! Free rotation against closed forms, and against the tumbling brick of NASA's check cases.

use crate::common::{relative, tumbling};
use gyradius_separation::{BodyState, Settings};
use nalgebra::{UnitQuaternion, Vector3};
use std::f64::consts::FRAC_PI_2;

/// Complete elliptic integral K from the complementary parameter 1 − m, by the arithmetic-geometric
/// mean (Abramowitz & Stegun 1964, 17.6).
fn complete(m1: f64) -> f64 {
    let (mut a, mut b) = (1.0, m1.sqrt());
    for _ in 0..40 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    FRAC_PI_2 / a
}

/// Jacobi's sn, cn and dn of u, from the complementary parameter 1 − m, which says what m near 1
/// cannot (Abramowitz & Stegun 1964, 16.4).
fn jacobi(u: f64, m1: f64) -> [f64; 3] {
    let m = 1.0 - m1;
    let (mut a, mut b) = (1.0_f64, m1.sqrt());
    let mut ratios = Vec::new();
    for _ in 0..40 {
        let c = 0.5 * (a - b);
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
        ratios.push(c / a);
        if c.abs() < 1e-17 {
            break;
        }
    }
    let mut angle = u * a * 2.0_f64.powi(ratios.len() as i32);
    for ratio in ratios.iter().rev() {
        angle = 0.5 * (angle + (ratio * angle.sin()).asin());
    }
    let (sn, cn) = angle.sin_cos();
    [sn, cn, (m1 + m * cn * cn).sqrt()]
}

/// Values of the GNU Scientific Library's tests (`specfunc/test_sf.c`), and A&S, table 17.1.
#[test]
fn elliptic_functions_have_their_published_values() {
    for (u, m, expected) in [
        (0.5, 0.5, [0.470_750_473_655_657_3, 0.882_266_394_890_440_3, 0.942_972_425_777_385_7]),
        (1.0, 0.3, [0.818_770_714_534_488_9, 0.574_120_646_746_554_9, 0.893_803_308_959_082_3]),
        (1.0, 0.6, [0.794_938_839_336_578, 0.606_689_576_071_827_8, 0.787_936_130_043_881_4]),
    ] {
        for (found, expected) in jacobi(u, 1.0 - m).iter().zip(expected) {
            assert!((found - expected).abs() < 2e-15, "({u}|{m}): {found} {expected}");
        }
    }
    assert!((complete(0.5) - 1.854_074_677_301_372).abs() < 1e-15);
    // Quarter period, and the separatrix, where sn is tanh.
    let [sn, cn, dn] = jacobi(complete(0.3), 0.3);
    assert!((sn - 1.0).abs() < 1e-15 && cn.abs() < 1e-15 && (dn - 0.3_f64.sqrt()).abs() < 1e-15);
    assert!((jacobi(1.2, 1e-30)[0] - 1.2_f64.tanh()).abs() < 1e-15);
}

/// Free rotation about three different axes (Landau & Lifshitz, Mechanics, §37).
struct Free {
    moments: [f64; 3],
    amplitudes: [f64; 3],
    rate: f64,
    m1: f64,
    /// Axes 1 and 3 change roles where H² < 2E I₂.
    about_third: bool,
    start: f64,
}

impl Free {
    /// With ω₂ = 0, ω₁ and ω₃ positive at the argument 0; starts at another, in quarter periods.
    fn new(moments: [f64; 3], w1: f64, w3: f64, quarters: f64) -> Self {
        let [i1, i2, i3] = moments;
        // H² − 2E I₁ and 2E I₃ − H², free of cancellation.
        let (low, high) = (i3 * (i3 - i1) * w3 * w3, i1 * (i3 - i1) * w1 * w1);
        let about_third = i3 * (i3 - i2) * w3 * w3 > i1 * (i2 - i1) * w1 * w1;
        let product = i1 * i2 * i3;
        let (rate, m1, w2) = if about_third {
            let k1 = (i3 - i2) * low;
            let m1 = (i3 - i1) * (i3 * (i3 - i2) * w3 * w3 - i1 * (i2 - i1) * w1 * w1) / k1;
            ((k1 / product).sqrt(), m1, (high / (i2 * (i3 - i2))).sqrt())
        } else {
            let k1 = (i2 - i1) * high;
            let m1 = (i3 - i1) * (i1 * (i2 - i1) * w1 * w1 - i3 * (i3 - i2) * w3 * w3) / k1;
            ((k1 / product).sqrt(), m1, (low / (i2 * (i2 - i1))).sqrt())
        };
        let start = quarters * complete(m1);
        Self { moments, amplitudes: [w1, w2, w3], rate, m1, about_third, start }
    }

    fn rates(&self, time: f64) -> Vector3<f64> {
        let [sn, cn, dn] = jacobi(self.start + self.rate * time, self.m1);
        let [w1, w2, w3] = self.amplitudes;
        if self.about_third {
            Vector3::new(w1 * cn, w2 * sn, w3 * dn)
        } else {
            Vector3::new(w1 * dn, w2 * sn, w3 * cn)
        }
    }

    /// Body to axes of which the third is the angular momentum: Euler angles 3-1-3, the precession
    /// by Simpson's rule on the closed form.
    fn attitude(&self, time: f64) -> UnitQuaternion<f64> {
        let momentum = |t: f64| self.rates(t).component_mul(&Vector3::from(self.moments));
        let speed = |t: f64| {
            let (w, l) = (self.rates(t), momentum(t));
            l.norm() * (l.x * w.x + l.y * w.y) / (l.x * l.x + l.y * l.y)
        };
        let n = 40_000;
        let h = time / f64::from(n);
        let sum: f64 = (0..=n)
            .map(|i| {
                let weight = if i == 0 || i == n { 1.0 } else { 2.0 + 2.0 * f64::from(i % 2) };
                weight * speed(f64::from(i) * h)
            })
            .sum();
        let l = momentum(time);
        let nutation = l.x.hypot(l.y).atan2(l.z);
        let turn = |axis, angle| UnitQuaternion::from_axis_angle(&axis, angle);
        turn(Vector3::z_axis(), sum * h / 3.0)
            * turn(Vector3::x_axis(), nutation)
            * turn(Vector3::z_axis(), l.x.atan2(l.y))
    }
}

#[test]
fn triaxial_bodies_follow_jacobis_functions() {
    let moments = [1.0, 2.0, 2.7];
    // ω₁/ω₃ on the separatrix.
    let edge = (2.7_f64 * 0.7 / 1.0).sqrt();
    for (name, w1, w3, quarters, duration) in [
        ("about the largest axis", 0.3, 1.1, 0.3, 40.0),
        ("about the smallest axis", 1.2, 0.2, -0.6, 40.0),
        ("a little beyond the separatrix", 0.9 * edge * (1.0 - 1e-6), 0.9, -1.0, 60.0),
        ("a little within the separatrix", 0.9 * edge * (1.0 + 1e-6), 0.9, 0.0, 60.0),
        // Spin about the intermediate axis that turns over, and over again.
        ("Dzhanibekov", 1.5 * edge * (1.0 - 1e-9), 1.5, -1.0, 60.0),
    ] {
        let free = Free::new(moments, w1, w3, quarters);
        let start = BodyState {
            attitude: free.attitude(0.0),
            angular_velocity: free.rates(0.0),
            ..BodyState::default()
        };
        let tightest = Settings::new(1e-14, 60.0).unwrap();
        let trajectory = tumbling(moments, start).trajectory(&tightest, duration).unwrap();
        let mut flips = 0;
        let mut side = free.rates(0.0).y.signum();
        // Rounding of the start changes m1, and with it the period, by its share of m1.
        let allowed = 2e-12 + 30.0 * f64::EPSILON / free.m1;
        for i in 1..=200 {
            let time = duration * f64::from(i) / 200.0;
            let state = *trajectory.at(time).unwrap().payload().state();
            let error = (state.angular_velocity - free.rates(time)).norm();
            assert!(error < allowed, "{name} at {time} s: {error:e} rad/s, m1 = {:e}", free.m1);
            if i % 50 == 0 {
                let error = state.attitude.angle_to(&free.attitude(time));
                assert!(error < 30.0 * allowed, "{name} at {time} s: {error:e} rad");
            }
            if free.rates(time).y.signum() != side {
                side = -side;
                flips += 1;
            }
        }
        assert!(flips >= 2, "{name}: {flips} flips");
    }
}

/// ω turns about the axis at Ω = (I₃/I₁ − 1)ω₃; the attitude is a turn about H and one about the axis.
#[test]
fn axisymmetric_bodies_cone() {
    for (transverse, axial) in [(2.0, 3.5), (3.0, 0.4), (2.0, 2.0)] {
        let w = Vector3::new(0.3, -0.1, 0.8);
        let attitude = UnitQuaternion::from_euler_angles(0.3, -0.2, 1.0);
        let start = BodyState { attitude, angular_velocity: w, ..BodyState::default() };
        let separation = tumbling([transverse, transverse, axial], start);
        let trajectory = separation.trajectory(&Settings::default(), 50.0).unwrap();
        let momentum = attitude * Vector3::new(transverse * w.x, transverse * w.y, axial * w.z);
        for i in 0..=100 {
            let time = 0.5 * f64::from(i);
            let spin = (1.0 - axial / transverse) * w.z * time;
            let about_axis = UnitQuaternion::new(Vector3::z() * spin);
            let expected =
                UnitQuaternion::new(momentum * (time / transverse)) * attitude * about_axis;
            let state = *trajectory.at(time).unwrap().payload().state();
            assert!(state.attitude.angle_to(&expected) < 1e-11, "{time}");
            let rates = about_axis.inverse() * w;
            assert!(relative(&state.angular_velocity, &rates) < 1e-11, "{time}");
        }
    }
}

/// NESC 6-DOF check case Atmos 02, a tumbling brick without damping (NASA/TM-2015-218675): rates of
/// the body with respect to inertial axes, deg/s, as two of the five published simulations have them;
/// the others are 5e-5 deg/s off and more. The case's gravity and rotating Earth exert no torque and
/// do not enter; only rates are compared.
#[test]
fn nasas_tumbling_brick() {
    const SLUG_FT2: f64 = 1.355_817_948_331_400_4;
    let moments = [0.001_894_220, 0.006_211_019, 0.007_194_665].map(|i| i * SLUG_FT2);
    let rates = Vector3::new(10.0, 20.0, 30.0).map(f64::to_radians);
    let start = BodyState { angular_velocity: rates, ..BodyState::default() };
    let trajectory = tumbling(moments, start).trajectory(&Settings::default(), 35.0).unwrap();
    let mut worst = 0.0_f64;
    for (time, expected) in [
        (5.0, [-16.939485149, 9.631939377, 33.406628079]),
        (10.0, [-2.418902222, -23.552569520, 28.128592630]),
        (15.0, [18.437254314, 2.386880299, 34.310705612]),
        (20.0, [-5.422734680, 22.715930576, 28.608281747]),
        (25.0, [-15.184088701, -13.617799501, 32.416796198]),
        (30.0, [12.618390776, -17.397474762, 31.119588887]),
    ] {
        let state = *trajectory.at(time).unwrap().payload().state();
        let found = state.angular_velocity.map(f64::to_degrees);
        let error = (found - Vector3::from(expected)).amax();
        worst = worst.max(error);
        assert!(error < 1e-9, "{time} s: {error:e} deg/s");
    }
    println!("largest difference {worst:e} deg/s");
}
