//! Branch and bound over time for the smallest distance of two shapes, and for the first contact.

use nalgebra::Vector3;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::circle::{Arc, Curve, CurveAndRing};
use super::convex::{Nearest, direction, gap_along, nearest};
use super::motion::{Frame, Motion, MotionLimits};
use super::outline::{Kind, Ring, Shape, farthest};
use super::report::ClearanceError;

/// Nodes looked at before a search ends with what it has. Far above any case met.
const MOST_NODES: usize = 2_000_000;
/// Arcs that a ring is cut into first.
const ARCS: usize = 8;
/// Most that a direction is turned over a span, rad.
const MOST_TURN: f64 = 0.5;
/// Halvings of a span after whose start nothing is to come nearer: to a ten-millionth.
const HALVINGS: usize = 24;

/// What can be compared at once: a convex part of each body, a ring with a point or a ring, a ring
/// with a hull.
enum Pair<'a> {
    Convex([&'a [Vector3<f64>]; 2]),
    Circular(Box<CurveAndRing>),
    RingAndHull { ring: &'a Ring, ring_body: usize, hull: &'a [Vector3<f64>] },
}

struct Part<'a> {
    pair: Pair<'a>,
    radii: [f64; 2],
}

/// A part over a span of time, and over an arc where the part is a ring and a hull.
#[derive(Clone, Copy)]
struct Node {
    part: usize,
    from: f64,
    to: f64,
    /// No distance in it is below this.
    bound: f64,
    arc: Arc,
    /// About from stage to payload.
    hint: Vector3<f64>,
    /// Of two nodes the smaller comes first.
    rank: f64,
}

impl Ord for Node {
    fn cmp(&self, other: &Self) -> Ordering {
        // A heap gives its largest first. Of equals the shorter goes first: it is nearer its end.
        let length = |n: &Self| n.to - n.from;
        other.rank.total_cmp(&self.rank).then_with(|| length(other).total_cmp(&length(self)))
    }
}

impl PartialOrd for Node {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Node {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Node {}

/// A distance that was seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    pub(crate) distance: f64,
    pub(crate) time: f64,
    /// Payload and stage, body axes.
    pub(crate) points: [Vector3<f64>; 2],
}

/// The smallest distance over a span.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Smallest {
    pub(crate) seen: Seen,
    /// Proven to be a lower bound.
    pub(crate) at_least: f64,
}

/// What a look at a node gave.
struct Look {
    seen: Seen,
    /// At the instant of the frame no distance is below this.
    at_least: f64,
    direction: Vector3<f64>,
    /// Rate of its unit vector, 1/s.
    turning: Vector3<f64>,
}

/// The search for two shapes.
pub(crate) struct Search<'a, M> {
    motion: &'a mut M,
    parts: Vec<Part<'a>>,
    tolerance: f64,
    heap: BinaryHeap<Node>,
    nodes: usize,
}

impl<'a, M: Motion> Search<'a, M> {
    pub(crate) fn new(
        motion: &'a mut M,
        payload: &'a Shape,
        stage: &'a Shape,
        tolerance: f64,
    ) -> Self {
        let parts = parts(payload, stage);
        Self { motion, parts, tolerance, heap: BinaryHeap::new(), nodes: 0 }
    }

    /// Nodes looked at so far.
    pub(crate) fn nodes(&self) -> usize {
        self.nodes
    }

    /// Bound on the rate of the distance over a span.
    pub(crate) fn rate(&mut self, from: f64, to: f64) -> Result<f64, ClearanceError> {
        let limits = self.limits(from, to)?;
        Ok(self.parts.iter().map(|p| limits.rate(p.radii)).fold(0.0, f64::max))
    }

    fn limits(&mut self, from: f64, to: f64) -> Result<MotionLimits, ClearanceError> {
        let limits = self.motion.limits(from, to);
        if limits.are_valid() { Ok(limits) } else { Err(ClearanceError::Limits { time: from }) }
    }

    fn frame(&mut self, time: f64) -> Result<Frame, ClearanceError> {
        let states = self.motion.states(time);
        states.as_ref().and_then(Frame::new).ok_or(ClearanceError::Motion { time })
    }

    /// Puts the span on the heap for every part; the bounds are zero, the ranks given.
    fn start(&mut self, from: f64, to: f64, rank: f64) {
        self.heap.clear();
        for part in 0..self.parts.len() {
            let hint = Vector3::zeros();
            let whole = Arc { middle: 0.0, half: std::f64::consts::PI };
            let node = Node { part, from, to, bound: 0.0, arc: whole, hint, rank };
            if matches!(self.parts[part].pair, Pair::RingAndHull { .. }) {
                let half = std::f64::consts::PI / ARCS as f64;
                for i in 0..ARCS {
                    let arc = Arc { middle: half * (2 * i + 1) as f64, half };
                    self.heap.push(Node { arc, ..node });
                }
            } else {
                self.heap.push(node);
            }
        }
    }

    /// The smallest distance on [from, to], to within the tolerance; or some distance of at most
    /// `enough`.
    pub(crate) fn smallest(
        &mut self,
        from: f64,
        to: f64,
        enough: f64,
    ) -> Result<Smallest, ClearanceError> {
        self.start(from, to, 0.0);
        let frame = self.frame(from)?;
        // The start of the span, where most distances are smallest. Then what may be skipped after it.
        let first: Vec<Node> = self.heap.drain().collect();
        let mut best: Option<Seen> = None;
        let mut looks = Vec::with_capacity(first.len());
        for node in &first {
            let known = best.map_or(f64::INFINITY, |b| b.distance);
            let look = self.parts[node.part].look(&frame, node, from, known, self.tolerance);
            self.nodes += 1;
            keep(&mut best, &look.seen);
            looks.push(look);
        }
        let Some(mut best) = best else {
            return Err(ClearanceError::Motion { time: from });
        };
        let instant = from == to;
        let limits = self.limits(from, to)?;
        for (mut node, look) in first.into_iter().zip(&looks) {
            let part = &self.parts[node.part];
            if instant && !matches!(part.pair, Pair::RingAndHull { .. }) {
                // There is nothing but this look.
                continue;
            }
            let target = best.distance - self.slack(part, best.distance);
            node.hint = look.direction;
            // Longest span from the start on which nothing comes nearer, by halves.
            let length = to - from;
            let halvings = if length > 0.0 { HALVINGS } else { 1 };
            let proven = std::iter::successors(Some(length), |span| Some(0.5 * span))
                .take(halvings)
                .find(|&span| part.proves(&frame, &limits, &node, look, [0.0, span], target));
            if proven != Some(length) {
                node.from = from + proven.unwrap_or(0.0);
                self.heap.push(node);
            }
        }
        // What could not be decided for lack of digits.
        let mut undecided = f64::INFINITY;
        while let Some(node) = self.heap.pop() {
            if best.distance <= enough {
                return Ok(Smallest { seen: best, at_least: 0.0 });
            }
            let target = best.distance - self.slack(&self.parts[node.part], best.distance);
            if node.bound >= target {
                continue;
            }
            self.nodes += 1;
            if self.nodes > MOST_NODES {
                undecided = undecided.min(node.bound);
                break;
            }
            match self.examine(&node, target, best.distance)? {
                Step::Proven => {}
                Step::Tiny(look) => {
                    keep_seen(&mut best, &look.seen);
                    undecided = undecided.min(look.at_least);
                }
                Step::Split(children, look) => {
                    if let Some(look) = look {
                        keep_seen(&mut best, &look.seen);
                    }
                    for child in children.into_iter().flatten() {
                        self.heap.push(Node { rank: child.bound, ..child });
                    }
                }
            }
        }
        let slack = self.parts.iter().map(|p| self.slack(p, best.distance)).fold(0.0, f64::max);
        let at_least = (best.distance - slack).min(undecided).max(0.0);
        Ok(Smallest { seen: best, at_least })
    }

    /// The first time on [from, known.time] at which the distance is at most `touch`, `known` being one.
    pub(crate) fn first_contact(
        &mut self,
        from: f64,
        known: Seen,
        touch: f64,
    ) -> Result<Seen, ClearanceError> {
        let mut earliest = known;
        self.start(from, known.time, from);
        // By when the distance may have changed by a tenth of the tolerance.
        let moment = 0.1 * self.tolerance / self.rate(from, known.time)?;
        while let Some(node) = self.heap.pop() {
            let resolution = moment.max(1e-13 * (1.0 + node.from.abs()));
            if !(node.from < earliest.time - resolution) {
                break;
            }
            self.nodes += 1;
            if self.nodes > MOST_NODES {
                break;
            }
            let node = Node { to: node.to.min(earliest.time), ..node };
            // A hair more than the touch counts as such: what lies between is not to be split for ever.
            let target = touch + 1e-3 * touch;
            let (children, look) = match self.examine(&node, target, f64::INFINITY)? {
                Step::Proven => continue,
                Step::Tiny(look) => ([None; 2], Some(look)),
                Step::Split(children, look) => (children, look),
            };
            if let Some(look) = look
                && look.seen.distance <= target
                && look.seen.time < earliest.time
            {
                earliest = look.seen;
            }
            for child in children.into_iter().flatten() {
                if child.from < earliest.time {
                    self.heap.push(Node { rank: child.from, ..child });
                }
            }
        }
        Ok(earliest)
    }

    /// Tolerance of a distance: as asked for, and not less than rounding of the positions.
    fn slack(&self, part: &Part<'_>, distance: f64) -> f64 {
        self.tolerance.max(1e-14 * (distance + part.radii[0] + part.radii[1]))
    }

    /// Looks at the middle of a node: proves that it holds nothing below `target`, or splits it.
    /// `known`: what a distance has to be below to be of interest.
    fn examine(&mut self, node: &Node, target: f64, known: f64) -> Result<Step, ClearanceError> {
        let (middle, half) = (0.5 * (node.from + node.to), 0.5 * (node.to - node.from));
        let limits = self.limits(node.from, node.to)?;
        let [r0, r1] = self.parts[node.part].radii;
        let apart =
            self.motion.offset(middle).ok_or(ClearanceError::Motion { time: middle })?.norm()
                - r0
                - r1;
        let by_spheres = apart - limits.speed * half;
        if by_spheres >= target {
            return Ok(Step::Proven);
        }
        let tiny = !(half > 1e-14 * (1.0 + middle.abs()));
        if apart > known && !tiny {
            // Nothing of interest in the middle: no need to know the attitudes.
            let node = Node { bound: node.bound.max(by_spheres), ..*node };
            return Ok(Step::Split(halves(&node, middle), None));
        }
        let frame = self.frame(middle)?;
        let part = &self.parts[node.part];
        let look = part.look(&frame, node, middle, known, self.tolerance);
        // The smallest distance may be this one.
        let target = target.min(if known.is_finite() {
            look.seen.distance - self.slack(part, look.seen.distance)
        } else {
            target
        });
        if part.proves(&frame, &limits, node, &look, [-half, half], target) {
            return Ok(Step::Split([None; 2], Some(look)));
        }
        let stray = limits.rate(part.radii) * half;
        let width = part.arc_length(node);
        // A hundredth of the tolerance: what is left of the node cannot matter.
        if (tiny || stray < 1e-2 * self.tolerance) && width < 1e-2 * self.tolerance {
            return Ok(Step::Tiny(Look {
                at_least: (look.at_least - stray - width).max(0.0),
                ..look
            }));
        }
        let span = [-half, half];
        let bound = part.bound(&frame, &limits, &node.arc, &look, span);
        let point = Arc { half: 0.0, ..node.arc };
        // The arc is cut where that gains more than cutting the span.
        let by_arc = width > 0.0
            && (tiny
                || part.bound(&frame, &limits, &point, &look, span)
                    > part.bound(&frame, &limits, &node.arc, &look, [0.0; 2]));
        let bound = node.bound.max(bound).max(by_spheres);
        let node = Node { bound, hint: look.direction, ..*node };
        let children = if by_arc {
            let half = 0.5 * node.arc.half;
            let arc = |sign: f64| Arc { middle: node.arc.middle + sign * half, half };
            [Some(Node { arc: arc(-1.0), ..node }), Some(Node { arc: arc(1.0), ..node })]
        } else if part.proves(&frame, &limits, &node, &look, [-0.5 * half, 0.5 * half], target) {
            // The middle half is done with.
            let before = Node { to: middle - 0.5 * half, ..node };
            [Some(before), Some(Node { from: middle + 0.5 * half, ..node })]
        } else {
            halves(&node, middle)
        };
        Ok(Step::Split(children, Some(look)))
    }
}

/// What became of a node.
enum Step {
    Proven,
    Tiny(Look),
    Split([Option<Node>; 2], Option<Look>),
}

fn halves(node: &Node, middle: f64) -> [Option<Node>; 2] {
    [Some(Node { to: middle, ..*node }), Some(Node { from: middle, ..*node })]
}

fn keep(best: &mut Option<Seen>, seen: &Seen) {
    match best {
        Some(best) => keep_seen(best, seen),
        None => *best = Some(*seen),
    }
}

fn keep_seen(best: &mut Seen, seen: &Seen) {
    if seen.distance < best.distance {
        *best = *seen;
    }
}

fn parts<'a>(payload: &'a Shape, stage: &'a Shape) -> Vec<Part<'a>> {
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
            Kind::Ring(r) => vec![circular(Curve::ring(r))],
            Kind::Points(p) => p.iter().map(|p| circular(Curve::point(p))).collect(),
            Kind::Hull(p) if p.len() == 1 => vec![circular(Curve::point(&p[0]))],
            Kind::Hull(hull) => vec![Pair::RingAndHull { ring, ring_body, hull }],
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
    /// The distance at an instant; on a ring and a hull, that of the middle of the arc from the hull.
    fn look(&self, frame: &Frame, node: &Node, time: f64, known: f64, tolerance: f64) -> Look {
        let hint = if node.hint == Vector3::zeros() { frame.offset } else { node.hint };
        let from_hulls = |n: Nearest| Look {
            seen: Seen { distance: n.distance(), time, points: n.points },
            at_least: n.at_least,
            direction: if n.gap == Vector3::zeros() { hint } else { n.gap },
            turning: n.turning,
        };
        match &self.pair {
            Pair::Convex(points) => from_hulls(nearest(frame, *points, &hint)),
            Pair::RingAndHull { ring, ring_body, hull } => {
                let (sin, cos) = libm::sincos(node.arc.middle);
                let point = [ring.point(cos, sin)];
                let points: [&[Vector3<f64>]; 2] =
                    if *ring_body == 0 { [&point, hull] } else { [hull, &point] };
                from_hulls(nearest(frame, points, &hint))
            }
            Pair::Circular(pair) => {
                let fine = 0.1 * tolerance;
                match pair.nearer(frame, known, fine) {
                    Some((distance, points)) => Look {
                        seen: Seen { distance, time, points },
                        at_least: (distance - 2.0 * fine).max(0.0),
                        direction: hint,
                        turning: Vector3::zeros(),
                    },
                    None => Look {
                        seen: Seen { distance: known, time, points: [Vector3::zeros(); 2] },
                        at_least: known - 2.0 * fine,
                        direction: hint,
                        turning: Vector3::zeros(),
                    },
                }
            }
        }
    }

    /// Half the length of the arc of a node.
    fn arc_length(&self, node: &Node) -> f64 {
        match &self.pair {
            Pair::RingAndHull { ring, .. } => ring.radius * node.arc.half,
            _ => 0.0,
        }
    }

    /// Whether nothing in the node comes nearer than `target` between the two times, from the frame's.
    fn proves(
        &self,
        frame: &Frame,
        limits: &MotionLimits,
        node: &Node,
        look: &Look,
        times: [f64; 2],
        target: f64,
    ) -> bool {
        match &self.pair {
            Pair::Circular(pair) => {
                let span = times[0].abs().max(times[1].abs());
                target <= 0.0
                    || look.at_least - limits.rate(self.radii) * span >= target
                    || pair.stays_beyond(frame, limits, times, target)
            }
            _ => self.bound(frame, limits, &node.arc, look, times) >= target,
        }
    }

    /// No distance is below this on the arc between the two times, from the frame's: by the bound on
    /// its rate, and along the direction of the nearest points.
    fn bound(
        &self,
        frame: &Frame,
        limits: &MotionLimits,
        arc: &Arc,
        look: &Look,
        times: [f64; 2],
    ) -> f64 {
        let span = times[0].abs().max(times[1].abs());
        let by_rate = look.at_least - limits.rate(self.radii) * span;
        // The direction turns along with the edge or face that it stands on; where it would turn far it
        // is held back, for any direction gives a bound.
        let normal = look.direction / look.direction.norm();
        let turns = look.turning.norm();
        let turning = look.turning * (MOST_TURN / (turns * span)).min(1.0);
        let turns = turns.min(MOST_TURN / span);
        let normals = times.map(|t| normal + turning * t);
        let (by_rate, along) = match &self.pair {
            Pair::Convex(points) => (by_rate, gap_along(frame, *points, &normals, times)),
            Pair::RingAndHull { ring, ring_body, hull } => {
                // The hull along the normal, and the arc in place of a hull.
                let centre: [Vector3<f64>; 1] = [Vector3::zeros()];
                let points: [&[Vector3<f64>]; 2] =
                    if *ring_body == 0 { [&centre, hull] } else { [hull, &centre] };
                let mut gaps = gap_along(frame, points, &normals, times);
                let sign = if *ring_body == 0 { -1.0 } else { 1.0 };
                for k in 0..2 {
                    let d = direction(frame, *ring_body, &normals[k], times[k]) * sign;
                    gaps[k] -= arc.farthest_along(ring, &d);
                }
                (by_rate - ring.radius * arc.half, gaps)
            }
            Pair::Circular(_) => return by_rate,
        };
        // Between the two times it is concave but for the product of turning and velocity; points stray
        // from uniform motion; and the normals have grown.
        let width = times[1] - times[0];
        let stray = 0.25 * turns * limits.rate(self.radii) * width * width;
        let growth = (1.0 + turns * turns * span * span).sqrt();
        let least = along[0].min(along[1]) - stray;
        let least = if least > 0.0 { least / growth } else { least };
        // The maximum passes over a NaN: a direction that is none.
        by_rate.max(least - 0.5 * limits.second(self.radii) * span * span)
    }
}
