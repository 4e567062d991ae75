//! What is told of the distance of two outlines over a span of time.

use nalgebra::Vector3;

use crate::{
    error::ClearanceError, motion::Motion, outline::Outline, part::Seen, search::Search,
    settings::ClearanceSettings,
};

/// Clearance of payload and stage over a span of time, shape by shape.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Clearance {
    shapes: Vec<ShapeClearance>,
    #[cfg_attr(feature = "serde", serde(rename = "undecided_from_s"))]
    undecided: Option<f64>,
    /// Whether a search ended before all was proven.
    #[cfg_attr(feature = "serde", serde(default, rename = "is_stopped"))]
    stopped: bool,
    looks: usize,
}

impl Clearance {
    /// The smallest distance of two outlines over [from, to] (s), and whether they touch.
    ///
    /// # Definition
    /// For each shape of the payload and each of the stage, the least distance of their points over
    /// the span, exact to the tolerance and with the proof of it; they touch when it is at most the
    /// touch of the settings, and what comes after the first contact does not count, for then the
    /// motion would be another one.
    ///
    /// Shapes that touch when the span begins are mated: rings on each other, pads on springs. They
    /// count from when they have parted, and a later contact is a recontact. Their smallest distance
    /// is that of parting, which says nothing of the bodies: [`Clearance::closest`] takes none but
    /// their contacts.
    ///
    /// A motion that ends before the span does ([`Motion::known_until_s`]) is followed to its end;
    /// [`Clearance::undecided_from_s`] says so if the rest of the span could tell something else.
    ///
    /// # Algorithm
    /// Branch and bound over time; see `docs/models/clearance.md`.
    ///
    /// # Errors
    /// The span is none, or the motion not known at its start or not finite on it.
    pub fn new<M: Motion>(
        payload: &Outline,
        stage: &Outline,
        motion: &mut M,
        from_s: f64,
        to_s: f64,
        settings: &ClearanceSettings,
    ) -> Result<Self, ClearanceError> {
        Self::over([payload, stage], motion, [from_s, to_s], settings, |_| false)
    }

    /// As [`new`](Self::new), over the span that follows one of the same outlines: shapes that touched when that began, and
    /// had not parted when it ended, are mated still, however little they are apart by then.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn following<M: Motion>(
        before: &Self,
        payload: &Outline,
        stage: &Outline,
        motion: &mut M,
        [from_s, to_s]: [f64; 2],
        settings: &ClearanceSettings,
    ) -> Result<Self, ClearanceError> {
        let together: Vec<[usize; 2]> = before
            .shapes
            .iter()
            .filter(|shapes| shapes.counts_from.is_none())
            .map(|shapes| [shapes.payload_shape, shapes.stage_shape])
            .collect();
        let is_mated = |shapes| together.contains(&shapes);
        Self::over([payload, stage], motion, [from_s, to_s], settings, is_mated)
    }

    /// `is_mated` tells of which shapes of payload and stage it is known before.
    fn over<M: Motion>(
        [payload, stage]: [&Outline; 2],
        motion: &mut M,
        [from_s, to_s]: [f64; 2],
        settings: &ClearanceSettings,
        is_mated: impl Fn([usize; 2]) -> bool,
    ) -> Result<Self, ClearanceError> {
        if !(from_s.is_finite() && to_s.is_finite() && from_s <= to_s) {
            return Err(ClearanceError::Span { from: from_s, to: to_s });
        }
        // The start itself has to be known.
        let until = motion.known_until_s().min(to_s).max(from_s);
        let mut shapes = Vec::with_capacity(payload.shapes().len() * stage.shapes().len());
        let (mut looks, mut stopped) = (0, false);
        for (i, p) in payload.shapes().iter().enumerate() {
            for (j, s) in stage.shapes().iter().enumerate() {
                let mut search = Search::new(motion, p, s, settings);
                let mut found =
                    shape_clearance(&mut search, [from_s, until], settings, is_mated([i, j]))?;
                (found.payload_shape, found.stage_shape) = (i, j);
                looks += search.nodes();
                stopped |= search.is_stopped();
                shapes.push(found);
            }
        }
        let mut found = Self { shapes, undecided: None, stopped, looks };
        if until < to_s && !found.is_final(payload, stage, motion, [until, to_s]) {
            found.undecided = Some(until);
        }
        Ok(found)
    }

    /// Whether the rest of the span cannot tell something else than what was found: the bodies have
    /// touched already, or the spheres around them stay farther apart than they have come.
    fn is_final<M: Motion>(
        &self,
        payload: &Outline,
        stage: &Outline,
        motion: &mut M,
        [from, to]: [f64; 2],
    ) -> bool {
        if self.contact_s().is_some() {
            return true;
        }
        let Some(least) = motion.least_offset(from, to) else { return false };
        let reach = payload.bounding_radius_m() + stage.bounding_radius_m();
        let nearest = self.closest().map_or(0.0, Approach::distance_m);
        let parted = self.shapes.iter().all(|s| s.counts_from.is_some());
        parted && least - reach > nearest
    }

    /// Every shape of the payload with every shape of the stage, the payload's in the outer order.
    #[must_use]
    pub fn shapes(&self) -> &[ShapeClearance] {
        &self.shapes
    }

    /// The closest approach of all shapes: the first contact in time of any two, mated ones after
    /// having parted, with distance 0; where there is none, the smallest distance of two that are not
    /// mated. None where all are mated and do not touch again: their distance as they part is no
    /// clearance.
    #[must_use]
    pub fn closest(&self) -> Option<&Approach> {
        self.closest_shapes().and_then(ShapeClearance::closest)
    }

    /// The shapes whose approach is the closest.
    #[must_use]
    pub fn closest_shapes(&self) -> Option<&ShapeClearance> {
        let first = |of: fn(&ShapeClearance) -> Option<f64>| {
            let all = self.shapes.iter().filter_map(|s| Some((of(s)?, s)));
            all.reduce(|a, b| if b.0 < a.0 { b } else { a }).map(|(_, shapes)| shapes)
        };
        let apart = |s: &ShapeClearance| s.closest.filter(|_| !s.mated).map(|a| a.distance);
        first(|s| s.contact).or_else(|| first(apart))
    }

    /// From when on the bodies could come nearer, or touch, and this is not known, s: where the motion
    /// ends before the span does. None if the whole span is decided.
    #[must_use]
    pub fn undecided_from_s(&self) -> Option<f64> {
        self.undecided
    }

    /// Whether a search was given up before all was proven, after two million looks at two shapes: the distance and the contact that it
    /// has are there, but the bodies may come nearer, to [`Approach::at_least_m`], or touch earlier.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.stopped
    }

    /// When any shapes first touch, mated ones after having parted, s.
    #[must_use]
    pub fn contact_s(&self) -> Option<f64> {
        self.shapes.iter().filter_map(|s| s.contact).reduce(f64::min)
    }

    /// Instants and spans looked at.
    #[must_use]
    pub fn looks(&self) -> usize {
        self.looks
    }
}

/// The closest that two shapes come.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields, remote = "Self"))]
pub struct Approach {
    #[cfg_attr(feature = "serde", serde(rename = "distance_m"))]
    distance: f64,
    #[cfg_attr(feature = "serde", serde(rename = "at_least_m"))]
    at_least: f64,
    #[cfg_attr(feature = "serde", serde(rename = "time_s"))]
    time: f64,
    #[cfg_attr(feature = "serde", serde(rename = "points_m"))]
    points: [Vector3<f64>; 2],
}

impl Approach {
    /// Their distance, m; 0 if they touch.
    #[must_use]
    pub fn distance_m(&self) -> f64 {
        self.distance
    }

    /// Proven lower bound on the smallest distance, m: below [`Approach::distance_m`] by the
    /// tolerance.
    #[must_use]
    pub fn at_least_m(&self) -> f64 {
        self.at_least
    }

    /// When, s: of the first contact if they touch.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.time
    }

    /// Where on the payload, from its mass centre, body axes, m.
    #[must_use]
    pub fn payload_point_m(&self) -> Vector3<f64> {
        self.points[0]
    }

    /// Where on the stage, from its mass centre, body axes, m.
    #[must_use]
    pub fn stage_point_m(&self) -> Vector3<f64> {
        self.points[1]
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for Approach {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        Self::serialize(self, to)
    }
}

/// A distance that is none below its own bound.
#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for Approach {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let read = Self::deserialize(from)?;
        let points = read.points.iter().flatten();
        let is_finite = [read.distance, read.time].iter().chain(points).all(|x| x.is_finite());
        if is_finite && read.distance >= 0.0 && read.at_least <= read.distance {
            return Ok(read);
        }
        Err(serde::de::Error::custom(format!(
            "{read:?}: the numbers must be finite, and the distance not negative and not below at_least_m"
        )))
    }
}

/// What becomes of the distance of one shape of the payload from one of the stage.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct ShapeClearance {
    payload_shape: usize,
    stage_shape: usize,
    mated: bool,
    #[cfg_attr(feature = "serde", serde(rename = "counts_from_s"))]
    counts_from: Option<f64>,
    closest: Option<Approach>,
    #[cfg_attr(feature = "serde", serde(rename = "contact_s"))]
    contact: Option<f64>,
}

impl ShapeClearance {
    /// Which shape of the payload's outline, from 0.
    #[must_use]
    pub fn payload_shape(&self) -> usize {
        self.payload_shape
    }

    /// Which shape of the stage's outline, from 0.
    #[must_use]
    pub fn stage_shape(&self) -> usize {
        self.stage_shape
    }

    /// Whether they touch at the start of the span, or have not parted since they did: they count from when they have parted.
    #[must_use]
    pub fn is_mated(&self) -> bool {
        self.mated
    }

    /// From when on the distance counts, s: the start of the span, or when they have parted. None
    /// if they touch at the start and do not part.
    #[must_use]
    pub fn counts_from_s(&self) -> Option<f64> {
        self.counts_from
    }

    /// The closest they come while it counts; none if it never does.
    #[must_use]
    pub fn closest(&self) -> Option<&Approach> {
        self.closest.as_ref()
    }

    /// When they first touch while it counts, s.
    #[must_use]
    pub fn contact_s(&self) -> Option<f64> {
        self.contact
    }
}

/// Steps in which no parting of mated shapes can be missed.
const MOST_STEPS: usize = 20_000;
/// Even steps in the rest of the span.
const MOST_EVEN_STEPS: usize = 5000;

fn shape_clearance<M: Motion>(
    search: &mut Search<'_, M>,
    [from, to]: [f64; 2],
    settings: &ClearanceSettings,
    is_mated: bool,
) -> Result<ShapeClearance, ClearanceError> {
    let touch = search.touch();
    let mut first = search.begin(from, to)?;
    let mated = is_mated || first.distance <= touch;
    let start = if mated { parting(search, from, to, settings)? } else { Some(from) };
    let mut result = ShapeClearance {
        payload_shape: 0,
        stage_shape: 0,
        mated,
        counts_from: start,
        closest: None,
        contact: None,
    };
    let Some(start) = start else {
        return Ok(result);
    };
    if mated {
        first = search.begin(start, to)?;
    }
    let smallest = search.finish(first)?;
    let Seen { distance, time, points, .. } = smallest.seen;
    if distance <= touch {
        let Seen { time, points, .. } = search.first_contact(start, smallest.seen)?;
        result.closest = Some(Approach { distance: 0.0, at_least: 0.0, time, points });
        result.contact = Some(time);
    } else {
        result.closest = Some(Approach { distance, at_least: smallest.at_least, time, points });
    }
    Ok(result)
}

/// When shapes that touch have parted. Steps that they need at least for what is missing: all of the
/// bodies at their rate, or the nearest points as they move. Where there would be too many, even
/// steps.
fn parting<M: Motion>(
    search: &mut Search<'_, M>,
    from: f64,
    to: f64,
    settings: &ClearanceSettings,
) -> Result<Option<f64>, ClearanceError> {
    let rate = search.rate(from, to)?;
    let mut time = from;
    let mut shortest = 0.0;
    for step in 0.. {
        // Half a touch short is parted: the last bit would take for ever.
        let seen = search.begin(time, time)?;
        let missing = settings.parted_m() - seen.distance + seen.depth;
        if missing <= 0.5 * settings.touch_m() {
            return Ok(Some(time));
        }
        if step == MOST_STEPS {
            shortest = (to - time) / MOST_EVEN_STEPS as f64;
        }
        let together = search.together(&seen, time, to, settings.parted_m())?;
        let next = time + (missing / rate).max(together).max(shortest);
        if !(next < to) {
            break;
        }
        // The last bit of a time is less than a motion can tell.
        time = next.max(time.next_up());
    }
    Ok(None)
}
