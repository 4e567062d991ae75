//! Branch and bound over time for the smallest distance of two shapes, and for the first contact.

use nalgebra::Vector3;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::{
    arc::Arc,
    error::ClearanceError,
    motion::{Frame, Motion, MotionLimits},
    outline::OutlineShape,
    part::{Look, Part, Seen, parts},
    settings::ClearanceSettings,
};

/// Nodes looked at before a search ends with what it has, and says so. Where little is to be proven, as of a hull in a ring that is a few
/// micrometres wider, there may be as many.
const MOST_NODES: usize = 2_000_000;
/// Arcs that a ring is cut into first.
const ARCS: usize = 8;
/// Halvings of a span after whose start nothing is to come nearer: to a ten-millionth.
const HALVINGS: usize = 24;
/// Arcs looked at in the first instant before the rest is left to the search over time.
const MOST_LEAVES: usize = 20_000;

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

/// The smallest distance over a span.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Smallest {
    pub(crate) seen: Seen,
    /// Proven to be a lower bound.
    pub(crate) at_least: f64,
}

/// The search for two shapes.
pub(crate) struct Search<'a, M> {
    motion: &'a mut M,
    parts: Vec<Part<'a>>,
    tolerance: f64,
    /// Of the distance.
    relative: f64,
    touch: f64,
    heap: BinaryHeap<Node>,
    nodes: usize,
    most_nodes: usize,
    /// Whether it ended before all was proven.
    is_stopped: bool,
}

impl<'a, M: Motion> Search<'a, M> {
    pub(crate) fn new(
        motion: &'a mut M,
        payload: &'a OutlineShape,
        stage: &'a OutlineShape,
        settings: &ClearanceSettings,
    ) -> Self {
        let parts = parts(payload, stage);
        // Large rings that touch may be seen apart by what rounding is, and twice that for the minimum to be found in.
        let untold = parts.iter().map(Part::untold).fold(0.0, f64::max);
        let touch = settings.touch_m().max((2.0 * untold).min(0.4 * settings.parted_m()));
        Self {
            motion,
            parts,
            tolerance: settings.tolerance_m(),
            relative: settings.relative_tolerance(),
            touch,
            heap: BinaryHeap::new(),
            nodes: 0,
            most_nodes: MOST_NODES,
            is_stopped: false,
        }
    }

    /// Distance up to which these shapes touch, m.
    pub(crate) fn touch(&self) -> f64 {
        self.touch
    }

    /// Nodes looked at so far.
    pub(crate) fn nodes(&self) -> usize {
        self.nodes
    }

    /// Whether it ended before all was proven: there may be a smaller distance, or an earlier contact.
    pub(crate) fn is_stopped(&self) -> bool {
        self.is_stopped
    }

    /// For how long from `time` on the points seen there stay nearer to each other than `parted`,
    /// whatever the motion until `to`: they move uniformly but for their accelerations.
    pub(crate) fn together(
        &mut self,
        seen: &Seen,
        time: f64,
        to: f64,
        parted: f64,
    ) -> Result<f64, ClearanceError> {
        let limits = self.limits(time, to)?;
        let frame = self.frame(time)?;
        let arms = [0, 1].map(|i| frame.rotation[i] * seen.points[i]);
        let gap = frame.offset + arms[0] - arms[1];
        let velocity =
            frame.velocity + frame.rate[0].cross(&arms[0]) - frame.rate[1].cross(&arms[1]);
        let (room, speed) = (parted - gap.norm(), velocity.norm());
        let second = limits.second([arms[0].norm(), arms[1].norm()]);
        // |gap| + speed s + ½ second s² = parted.
        let span = 2.0 * room / (speed + (speed * speed + 2.0 * second * room.max(0.0)).sqrt());
        Ok(span.max(0.0))
    }

    /// Bound on the rate of the distance over a span.
    pub(crate) fn rate(&mut self, from: f64, to: f64) -> Result<f64, ClearanceError> {
        let limits = self.limits(from, to)?;
        Ok(self.parts.iter().map(|p| limits.rate(p.radii())).fold(0.0, f64::max))
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
            if self.parts[part].has_arcs() {
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

    /// The smallest distance at `from` to within the tolerance, where over a span most are smallest. Gets
    /// the search of [from, to] ready to go on.
    pub(crate) fn begin(&mut self, from: f64, to: f64) -> Result<Seen, ClearanceError> {
        self.start(from, to, 0.0);
        let frame = self.frame(from)?;
        let limits = self.limits(from, to)?;
        let first: Vec<Node> = self.heap.drain().collect();
        let mut best: Option<Seen> = None;
        let mut waiting = Vec::with_capacity(2 * first.len());
        for (group, node) in first.iter().enumerate() {
            let known = best.map_or(f64::INFINITY, |b| b.distance);
            let part = &self.parts[node.part];
            let look = part.look(&frame, &node.arc, &node.hint, from, known, self.tolerance);
            keep(&mut best, &look.seen);
            waiting.push((group, node.arc, look));
        }
        let Some(mut best) = best else {
            return Err(ClearanceError::Motion { time: from });
        };
        self.nodes += first.len();
        // Arcs are halved until none can be nearer than the nearest found; the nearest of all goes first.
        waiting.sort_unstable_by(|a, b| b.2.seen.distance.total_cmp(&a.2.seen.distance));
        let mut leaves = Vec::with_capacity(4 * first.len());
        while let Some((group, arc, look)) = waiting.pop() {
            let part = &self.parts[first[group].part];
            let target = best.distance - self.slack(part, best.distance);
            let small = part.arc_length(&arc) < 1e-2 * self.tolerance;
            let nearer = || part.excess(&frame, &limits, &arc, &look, [0.0; 2], target) < 0.0;
            if !(part.has_arcs() && leaves.len() < MOST_LEAVES && nearer()) {
                leaves.push((group, arc, look));
            } else if small {
                // Nothing but the search over time could tell more.
                self.heap.push(Node { arc, hint: look.direction, ..first[group] });
            } else {
                let halves = arc.halves().map(|arc| {
                    let hint = &look.direction;
                    let look = part.look(&frame, &arc, hint, from, best.distance, self.tolerance);
                    (group, arc, look)
                });
                self.nodes += 2;
                halves.iter().for_each(|(_, _, look)| keep_seen(&mut best, &look.seen));
                let [a, b] = halves;
                let ordered = if a.2.seen.distance < b.2.seen.distance { [b, a] } else { [a, b] };
                waiting.extend(ordered);
            }
        }
        if from < to {
            self.skip(&frame, &limits, &first, &leaves, best.distance)?;
        }
        Ok(best)
    }

    /// Leaves out of the search what is proven from the first instant on: for each node the longest span
    /// from its start, by halves, on which no leaf of it comes nearer.
    fn skip(
        &mut self,
        frame: &Frame,
        limits: &MotionLimits,
        first: &[Node],
        leaves: &[(usize, Arc, Look)],
        best: f64,
    ) -> Result<(), ClearanceError> {
        let mut end = None;
        let mut open: Vec<Node> = Vec::with_capacity(first.len());
        for node in first {
            // Nodes of a part are next to each other.
            let to = match end {
                Some((part, to)) if part == node.part => to,
                _ => self.clear_after(node, best)?,
            };
            end = Some((node.part, to));
            open.push(Node { to, ..*node });
        }
        let mut spans: Vec<f64> = open.iter().map(|n| n.to - n.from).collect();
        for (group, arc, look) in leaves {
            let node = &open[*group];
            let part = &self.parts[node.part];
            let target = best - self.slack(part, best);
            let proves = |s: &f64| part.excess(frame, limits, arc, look, [0.0, *s], target) >= 0.0;
            let span = &mut spans[*group];
            if *span == 0.0 || proves(span) {
                continue;
            }
            let shortest = *span * 0.5_f64.powi(HALVINGS as i32);
            *span = if proves(&shortest) {
                let halves = std::iter::successors(Some(0.5 * *span), |s| Some(0.5 * s));
                halves.take(HALVINGS).find(proves).unwrap_or(shortest)
            } else {
                0.0
            };
        }
        for (node, span) in open.into_iter().zip(spans) {
            if span < node.to - node.from {
                self.heap.push(Node { from: node.from + span, ..node });
            }
        }
        Ok(())
    }

    /// From when on the spheres around the bodies are too far apart to matter, by halves.
    fn clear_after(&mut self, node: &Node, best: f64) -> Result<f64, ClearanceError> {
        let part = &self.parts[node.part];
        let [r0, r1] = part.radii();
        let reach = r0 + r1 + best - self.slack(part, best);
        let mut end = node.to;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (node.from + end);
            let least = self.motion.least_offset(middle, node.to);
            if !(least.ok_or(ClearanceError::Motion { time: middle })? >= reach) {
                break;
            }
            end = middle;
        }
        Ok(end)
    }

    /// Goes on after [`Search::begin`]: the smallest distance of the span to within the tolerance, or
    /// some distance at which the shapes touch. `best` is the smallest known.
    pub(crate) fn finish(&mut self, mut best: Seen) -> Result<Smallest, ClearanceError> {
        // What could not be decided for lack of digits.
        let mut undecided = f64::INFINITY;
        while let Some(node) = self.heap.pop() {
            if best.distance <= self.touch {
                return Ok(Smallest { seen: best, at_least: 0.0 });
            }
            let target = best.distance - self.slack(&self.parts[node.part], best.distance);
            if node.bound >= target {
                continue;
            }
            self.nodes += 1;
            if self.nodes > self.most_nodes {
                self.is_stopped = true;
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

    /// The first time on [from, known.time] at which the shapes touch, `known` being one.
    pub(crate) fn first_contact(&mut self, from: f64, known: Seen) -> Result<Seen, ClearanceError> {
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
            if self.nodes > self.most_nodes {
                self.is_stopped = true;
                break;
            }
            let node = Node { to: node.to.min(earliest.time), ..node };
            // A hair more than the touch counts as such: what lies between is not to be split for ever.
            let target = self.touch + 1e-3 * self.touch;
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
        // Above the touch it leaves room for a contact to be found.
        let room = 0.5 * (distance - self.touch).max(0.0);
        self.tolerance.max(part.rounding(distance).max(self.relative * distance).min(room))
    }

    /// Looks at the middle of a node: proves that it holds nothing below `target`, or splits it.
    /// `known`: what a distance has to be below to be of interest.
    fn examine(&mut self, node: &Node, target: f64, known: f64) -> Result<Step, ClearanceError> {
        let (middle, half) = (0.5 * (node.from + node.to), 0.5 * (node.to - node.from));
        let limits = self.limits(node.from, node.to)?;
        let unknown = ClearanceError::Motion { time: middle };
        let [r0, r1] = self.parts[node.part].radii();
        let by_spheres = self.motion.least_offset(node.from, node.to).ok_or(unknown)? - r0 - r1;
        if by_spheres >= target {
            return Ok(Step::Proven);
        }
        let tiny = !(half > 1e-15 * node.from.abs().max(node.to.abs()));
        if !tiny && self.motion.offset(middle).ok_or(unknown)?.norm() - r0 - r1 > known {
            // Nothing of interest in the middle: no need to know the attitudes.
            let node = Node { bound: node.bound.max(by_spheres), ..*node };
            return Ok(Step::Split(halves(&node, middle), None));
        }
        let frame = self.frame(middle)?;
        let part = &self.parts[node.part];
        let look = part.look(&frame, &node.arc, &node.hint, middle, known, self.tolerance);
        // The smallest distance may be this one.
        let seen = look.seen.distance;
        let target =
            if known.is_finite() { target.min(seen - self.slack(part, seen)) } else { target };
        let excess =
            |arc: &Arc, span: f64| part.excess(&frame, &limits, arc, &look, [-span, span], target);
        let whole = excess(&node.arc, half);
        if whole >= 0.0 {
            return Ok(Step::Split([None; 2], Some(look)));
        }
        let stray = limits.rate(part.radii()) * half;
        let width = part.arc_length(&node.arc);
        // A hundredth of the tolerance: what is left of the node cannot matter.
        if (tiny || stray < 1e-2 * self.tolerance) && width < 1e-2 * self.tolerance {
            let at_least = (look.at_least - stray - width).max(0.0);
            return Ok(Step::Tiny(Look { at_least, ..look }));
        }
        let bound = node.bound.max(target + whole).max(by_spheres);
        let point = Arc { half: 0.0, ..node.arc };
        // The arc is cut where that gains more than cutting the span.
        let by_arc = width > 0.0 && (tiny || excess(&point, half) > excess(&node.arc, 0.0));
        let node = Node { bound, hint: look.direction, ..*node };
        let children = if by_arc {
            node.arc.halves().map(|arc| Some(Node { arc, ..node }))
        } else if excess(&node.arc, 0.5 * half) >= 0.0 {
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
    // Of two that meet the deeper.
    if seen.distance < best.distance || (seen.distance == best.distance && seen.depth > best.depth)
    {
        *best = *seen;
    }
}

#[cfg(test)]
mod tests;
