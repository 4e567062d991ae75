//! What of two shapes can be compared at once, and what is proven of it.

use nalgebra::Vector3;

use crate::{
    arc::{Arc, RingAndHull, Turning},
    circle::{Curve, CurveAndRing},
    convex::{Nearest, gap_along, nearest},
    motion::{Frame, MotionLimits},
    outline::{Kind, OutlineShape, Ring, farthest},
};

/// Most that a direction is turned over a span or an arc, rad.
const MOST_TURN: f64 = 0.5;

/// A distance that was seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    pub(crate) distance: f64,
    pub(crate) time: f64,
    /// Payload and stage, body axes.
    pub(crate) points: [Vector3<f64>; 2],
    /// Where they meet: points have to move by this at least before they part.
    pub(crate) depth: f64,
}

/// A convex part of each body, a ring with a point or a ring, a ring with a hull.
enum Pair<'a> {
    Convex([&'a [Vector3<f64>]; 2]),
    Circular(Box<CurveAndRing>),
    Mixed(RingAndHull<'a>),
}

/// A pair, and how far from the mass centres it reaches.
pub(crate) struct Part<'a> {
    pair: Pair<'a>,
    radii: [f64; 2],
}

/// What a look at an instant gave.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Look {
    pub(crate) seen: Seen,
    /// At the instant of the frame no distance is below this.
    pub(crate) at_least: f64,
    /// From stage to payload, of any length.
    pub(crate) direction: Vector3<f64>,
    /// Rate of its unit vector, 1/s.
    pub(crate) turning: Vector3<f64>,
    /// Derivative of the unit vector from the hull to the ring by the angle on the ring.
    pub(crate) by_angle: Vector3<f64>,
}

/// All that has to be looked at for two shapes.
pub(crate) fn parts<'a>(payload: &'a OutlineShape, stage: &'a OutlineShape) -> Vec<Part<'a>> {
    let hulls = |kind: &'a Kind| -> Vec<&'a [Vector3<f64>]> {
        match kind {
            Kind::Points(p) => p.chunks(1).collect(),
            Kind::Hull(p) => vec![p],
            Kind::Ring(_) => Vec::new(),
        }
    };
    let with_ring = |ring: &'a Ring, ring_body: usize, other: &'a Kind| -> Vec<Pair<'a>> {
        let circular =
            |curve| Pair::Circular(Box::new(CurveAndRing { curve, ring: *ring, ring_body }));
        match other {
            // The smaller as the curve: the harmonics grow with it, and rounding with them.
            Kind::Ring(r) if r.radius > ring.radius => {
                let (curve, ring_body) = (Curve::ring(ring), 1 - ring_body);
                vec![Pair::Circular(Box::new(CurveAndRing { curve, ring: *r, ring_body }))]
            }
            Kind::Ring(r) => vec![circular(Curve::ring(r))],
            Kind::Points(p) => p.iter().map(|p| circular(Curve::point(p))).collect(),
            Kind::Hull(p) if p.len() == 1 => vec![circular(Curve::point(&p[0]))],
            Kind::Hull(hull) => vec![Pair::Mixed(RingAndHull { ring, ring_body, hull })],
        }
    };
    let pairs = match (payload.kind(), stage.kind()) {
        (Kind::Ring(ring), other) => with_ring(ring, 0, other),
        (other, Kind::Ring(ring)) => with_ring(ring, 1, other),
        (a, b) => {
            let stage_hulls = hulls(b);
            let all = hulls(a).into_iter().flat_map(|p| stage_hulls.iter().map(move |q| [p, *q]));
            all.map(Pair::Convex).collect()
        }
    };
    let whole = [payload.bounding_radius_m(), stage.bounding_radius_m()];
    let radii = |pair: &Pair<'_>| match pair {
        Pair::Convex(points) => points.map(farthest),
        _ => whole,
    };
    pairs.into_iter().map(|pair| Part { radii: radii(&pair), pair }).collect()
}

impl Part<'_> {
    /// Largest distances from the mass centres.
    pub(crate) fn radii(&self) -> [f64; 2] {
        self.radii
    }

    /// By how much rounding may change a distance.
    pub(crate) fn rounding(&self, distance: f64) -> f64 {
        let by_position = 1e-14 * (distance + self.radii[0] + self.radii[1]);
        match &self.pair {
            Pair::Circular(pair) => by_position.max(pair.rounding(distance)),
            _ => by_position,
        }
    }

    /// Up to which distance rounding may be all of it, m.
    pub(crate) fn untold(&self) -> f64 {
        match &self.pair {
            Pair::Circular(pair) => pair.untold(),
            Pair::Convex(_) | Pair::Mixed(_) => 0.0,
        }
    }

    /// Whether it is looked at arc by arc.
    pub(crate) fn has_arcs(&self) -> bool {
        matches!(self.pair, Pair::Mixed(_))
    }

    /// Half the length of an arc, m.
    pub(crate) fn arc_length(&self, arc: &Arc) -> f64 {
        match &self.pair {
            Pair::Mixed(pair) => pair.ring.radius * arc.half,
            _ => 0.0,
        }
    }

    /// The distance at an instant; on a ring and a hull, that of the middle of the arc from the hull.
    ///
    /// `hint`: about from stage to payload; zero where nothing is known. `known`: what a distance has
    /// to be below to be of interest.
    pub(crate) fn look(
        &self,
        frame: &Frame,
        arc: &Arc,
        hint: &Vector3<f64>,
        time: f64,
        known: f64,
        tolerance: f64,
    ) -> Look {
        let hint = if *hint == Vector3::zeros() { frame.offset } else { *hint };
        let from_hulls = |n: &Nearest| Look {
            seen: Seen { distance: n.distance(), time, points: n.points, depth: n.depth },
            at_least: n.at_least,
            direction: if n.gap == Vector3::zeros() { hint } else { n.gap },
            turning: n.turning,
            by_angle: Vector3::zeros(),
        };
        match &self.pair {
            Pair::Convex(points) => from_hulls(&nearest(frame, *points, &hint)),
            Pair::Mixed(pair) => {
                let (sin, cos) = libm::sincos(arc.middle);
                let point = [pair.ring.point(cos, sin)];
                let points: [&[Vector3<f64>]; 2] =
                    if pair.ring_body == 0 { [&point, pair.hull] } else { [pair.hull, &point] };
                let found = nearest(frame, points, &hint);
                Look {
                    by_angle: found.following(&pair.tangent(frame, arc), pair.ring_body),
                    ..from_hulls(&found)
                }
            }
            Pair::Circular(pair) => {
                let fine = 0.1 * tolerance;
                let found = pair.nearer(frame, known, fine);
                let (distance, points) = found.unwrap_or((known, [Vector3::zeros(); 2]));
                Look {
                    seen: Seen { distance, time, points, depth: 0.0 },
                    at_least: (distance - 2.0 * fine).max(0.0),
                    direction: hint,
                    turning: Vector3::zeros(),
                    by_angle: Vector3::zeros(),
                }
            }
        }
    }

    /// By how much every distance on the arc between the two times, from the frame's, is proven to be
    /// above `target`, if that is positive; how far below the proof ends, if it is negative. By the
    /// bound on the rate, and along the direction of the nearest points.
    ///
    /// The direction turns along with the edge or face that it stands on, and along the arc; where it
    /// would turn far it is held back, for any direction gives a bound.
    pub(crate) fn excess(
        &self,
        frame: &Frame,
        limits: &MotionLimits,
        arc: &Arc,
        look: &Look,
        times: [f64; 2],
        target: f64,
    ) -> f64 {
        // No distance is negative.
        if target <= 0.0 {
            return -target;
        }
        let span = times[0].abs().max(times[1].abs());
        let by_rate =
            look.at_least - limits.rate(self.radii) * span - self.arc_length(arc) - target;
        if by_rate >= 0.0 {
            return by_rate;
        }
        if let Pair::Circular(pair) = &self.pair {
            let proven = pair.stays_beyond(frame, limits, times, target);
            return if proven { 0.0 } else { by_rate };
        }
        // Points stray from uniform motion.
        let needed = target + 0.5 * limits.second(self.radii) * span * span;
        let normal = look.direction / look.direction.norm();
        let held = |v: &Vector3<f64>, reach: f64| v * (MOST_TURN / (v.norm() * reach)).min(1.0);
        let by_time = held(&look.turning, span);
        let along = match &self.pair {
            Pair::Mixed(pair) => {
                let around = pair.surrounded(frame, limits, span) - target;
                if around >= 0.0 {
                    return around;
                }
                let normal = if pair.ring_body == 0 { normal } else { -normal };
                let by_time = if pair.ring_body == 0 { by_time } else { -by_time };
                let by_angle = held(&look.by_angle, arc.half);
                pair.excess(frame, arc, &Turning { normal, by_angle, by_time }, times, needed)
            }
            Pair::Convex(points) => {
                let normals = times.map(|t| normal + by_time * t);
                let gaps = gap_along(frame, *points, &normals, times);
                // |n + n_τ τ| ≤ 1 + ½ n_τ² τ².
                let grown = times.map(|t| needed * (1.0 + 0.5 * by_time.norm_squared() * t * t));
                (gaps[0] - grown[0]).min(gaps[1] - grown[1])
            }
            Pair::Circular(_) => f64::NEG_INFINITY,
        };
        // Between the two times it is concave but for the product of turning and velocity.
        let width = times[1] - times[0];
        let bend = 0.25 * by_time.norm() * limits.rate(self.radii) * width * width;
        // The maximum passes over a NaN: a direction that is none.
        by_rate.max(along - bend)
    }
}
