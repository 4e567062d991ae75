//! What several tests share.

use gyradius_inertia::InertiaMatrix;
use gyradius_separation::{Body, BodyState, MovingBody, Outcome, Separation, Spring};
use nalgebra::{UnitQuaternion, Vector3};

pub(crate) fn inertia(moments: [f64; 3], products: [f64; 3]) -> InertiaMatrix {
    InertiaMatrix::from_entries(moments, products).unwrap()
}

/// Peck (2003), Table 1.
pub(crate) fn paper() -> Separation {
    let payload = inertia([5e3, 4e3, 3e3], [20.0, 2.0, -50.0]);
    let stage = inertia([6.7e3, 6.7e3, 2e3], [0.0, 20.0, -20.0]);
    let spring = |k: f64, x: f64, y: f64| {
        Spring::new(k, 0.1, Vector3::new(x, y, -0.9), Vector3::new(x, y, 0.9)).unwrap()
    };
    Separation::new(
        Body::new(1e4, payload).unwrap().at(Vector3::z()),
        Body::new(4e3, stage).unwrap().at(-Vector3::z()),
        &[
            spring(1e5, 1.0, 1.0),
            spring(1e5, -1.0, 1.0),
            spring(3e4, 1.0, -1.0),
            spring(3e4, -1.0, -1.0),
        ],
    )
    .unwrap()
}

/// Three skewed springs between two bodies that turn and move.
pub(crate) fn skewed() -> Separation {
    let payload = inertia([50.0, 40.0, 30.0], [2.0, 1.0, -3.0]);
    let stage = inertia([35.0, 30.0, 22.0], [-1.0, 2.0, 0.5]);
    let spring = |k: f64, stroke: f64, p: [f64; 3], l: [f64; 3]| {
        Spring::new(k, stroke, p.into(), l.into()).unwrap()
    };
    let state = |z: f64, turn: [f64; 3], v: [f64; 3], w: [f64; 3]| BodyState {
        position: Vector3::new(3.0, -1.0, z),
        velocity: v.into(),
        attitude: UnitQuaternion::new(turn.into()),
        angular_velocity: w.into(),
    };
    Separation::new(
        Body::new(120.0, payload).unwrap().moving(state(
            0.7,
            [0.02, -0.05, 0.4],
            [0.1, 0.02, 0.03],
            [0.03, -0.2, 0.3],
        )),
        Body::new(80.0, stage).unwrap().moving(state(
            -0.6,
            [-0.03, 0.01, 0.1],
            [0.1, 0.03, 0.0],
            [-0.1, 0.02, 0.25],
        )),
        &[
            spring(3e3, 0.12, [0.5, 0.1, -0.5], [0.4, 0.2, 0.4]),
            spring(2e3, 0.10, [-0.3, 0.4, -0.5], [-0.2, 0.4, 0.45]),
            spring(2.5e3, 0.15, [-0.1, -0.5, -0.55], [-0.2, -0.4, 0.4]),
        ],
    )
    .unwrap()
}

/// A payload of the given inertia that turns freely: the springs act at the mass centres.
pub(crate) fn tumbling(moments: [f64; 3], state: BodyState) -> Separation {
    let spring = Spring::new(1.0, 0.01, Vector3::zeros(), Vector3::zeros()).unwrap();
    Separation::new(
        Body::new(1.0, inertia(moments, [0.0; 3])).unwrap().moving(state),
        Body::new(1.0, inertia([1.0; 3], [0.0; 3])).unwrap().at(-Vector3::z()),
        &[spring],
    )
    .unwrap()
}

/// The same bodies and states with each body's state changed.
pub(crate) fn moved(
    separation: &Separation,
    change: impl Fn(BodyState) -> BodyState,
    springs: &[Spring],
) -> Separation {
    let body = |b: &MovingBody| b.body().moving(change(*b.state()));
    Separation::new(body(separation.payload()), body(separation.stage()), springs).unwrap()
}

/// |a − b| over |b|.
pub(crate) fn relative(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    (a - b).norm() / b.norm()
}

/// Largest relative difference of what two outcomes say: angular velocities, relative velocity, and
/// attitudes in radians; and of release times, s.
pub(crate) fn differences(a: &Outcome, b: &Outcome) -> (f64, f64) {
    let bodies = [(a.payload(), b.payload()), (a.stage(), b.stage())].map(|(a, b)| {
        let (a, b) = (a.state(), b.state());
        relative(&a.angular_velocity, &b.angular_velocity).max(a.attitude.angle_to(&b.attitude))
    });
    let velocity = relative(&a.relative_velocity(), &b.relative_velocity());
    let times =
        a.release_times().flatten().zip(b.release_times().flatten()).map(|(a, b)| (a - b).abs());
    (bodies[0].max(bodies[1]).max(velocity), times.fold(0.0, f64::max))
}

/// Slope and correlation of the logarithms of pairs.
pub(crate) fn log_fit(points: &[(f64, f64)]) -> (f64, f64) {
    let logs: Vec<_> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let n = logs.len() as f64;
    let (mx, my) = logs.iter().fold((0.0, 0.0), |m, e| (m.0 + e.0 / n, m.1 + e.1 / n));
    let (sxy, sxx, syy) = logs.iter().fold((0.0, 0.0, 0.0), |s, e| {
        let (x, y) = (e.0 - mx, e.1 - my);
        (s.0 + x * y, s.1 + x * x, s.2 + y * y)
    });
    (sxy / sxx, sxy / (sxx * syy).sqrt())
}
