//! A link of a robot that is drawn, and why one is not.

use super::{
    LeftBecause, RobotDrawOptions,
    as_written::{as_written, inset},
    inside::{self, Inside},
};
use gyradius_campaign::Streams;
use gyradius_estimation::{StatedBody, StatementError};
use gyradius_formats::{RobotFile, RobotLink, judge};
use gyradius_inertia::{Containment, MassProperties, Region};
use nalgebra::Matrix3;
use rand_distr::Distribution;
use std::fmt::Display;

/// What keys the trials of a region.
const TRIALS_MODEL: &str = "robot, trials";
/// How many trials there are.
const TRIALS: u64 = 400;
/// How many of them must be possible in the region of a link, so that draws do not take too long.
const LEAST_HELD: usize = 4;

/// A link that is drawn.
#[derive(Clone, Debug)]
pub(super) struct DrawnLink {
    pub(super) name: String,
    /// Its place among the links of the file.
    pub(super) index: usize,
    pub(super) law: StatedBody,
    pub(super) streams: Streams,
    region: Option<Region>,
}

/// Why a link is not drawn.
#[derive(Debug)]
pub(super) enum NotDrawn {
    /// It stays as it is.
    Left(LeftBecause),
    /// Its numbers are those of nothing.
    Unreadable(String),
    /// Its inertia is no body's.
    Impossible,
    /// What is stated cannot be true of it.
    Beyond(StatementError),
    /// Its matter cannot be where it must be.
    Outside(String),
}

impl DrawnLink {
    /// A link of a robot that was picked, by its place in the file; `is_named` if it was asked for by name.
    ///
    /// # Errors
    /// It is not drawn.
    pub(super) fn new(
        robot: &RobotFile,
        (index, link): (usize, &RobotLink),
        is_named: bool,
        options: &RobotDrawOptions,
    ) -> Result<Self, NotDrawn> {
        let unreadable = |why: &dyn Display| NotDrawn::Unreadable(why.to_string());
        let numbers = match link.numbers() {
            // What was asked for by name, or is a slip, is not passed over.
            Err(problem) if is_named || problem.is_a_slip() => return Err(unreadable(problem)),
            Err(problem) => return Err(NotDrawn::Left(problem.clone().into())),
            Ok(numbers) if numbers.mass_kg() == 0.0 => {
                return Err(NotDrawn::Left(LeftBecause::NoMass));
            }
            Ok(numbers) => numbers,
        };
        // A mass that is none is no matter of the inertia, which alone is repaired.
        if let Some(fault) = judge(&Matrix3::zeros(), Some(numbers.mass_kg()), 0.0).mass_fault() {
            return Err(unreadable(&fault));
        }
        let inertia = as_written(numbers.inertia()).ok_or(NotDrawn::Impossible)?;
        let nominal = MassProperties::new(numbers.mass_kg(), numbers.mass_centre_m(), inertia);
        let nominal = nominal.map_err(|error| unreadable(&error))?;
        let law = StatedBody::new(&options.statements, &nominal).map_err(NotDrawn::Beyond)?;
        let name = link.name().to_owned();
        let streams = Streams::of_draws(options.seed, &name);
        let mut drawn = Self { name, index, law, streams, region: None };
        if let Some(inside) = options.inside {
            drawn.region = Some(drawn.confine(robot, inside).map_err(NotDrawn::Outside)?);
        }
        Ok(drawn)
    }

    /// The region of its geometry, if the law has enough draws that are possible there.
    fn confine(&self, robot: &RobotFile, inside: Inside) -> Result<Region, String> {
        let points = robot.points_m(self.index).map_err(|problem| problem.to_string())?;
        let region = inside.about(&points).map_err(|error| format!("its geometry: {error}"))?;
        let streams = Streams::new(0, TRIALS_MODEL, &self.name);
        // As they are written: a plate is a little thicker than a region without thickness.
        let trial =
            |trial: &u64| inside::holds(&region, &inset(self.law.sample(&mut streams.run(*trial))));
        // A trial in the hull of a round mesh takes milliseconds.
        let held = (0..TRIALS).filter(trial).take(LEAST_HELD).count();
        if held >= LEAST_HELD {
            return Ok(region);
        }
        let nominal = match region.containment(&inset(*self.law.nominal())) {
            Containment::Possible => "and its nominal numbers are",
            Containment::Impossible => "and its nominal numbers are not",
            Containment::Undecided => "and of its nominal numbers it is not known",
        };
        Err(format!("of {TRIALS} draws {held} are possible for matter there, {nominal}"))
    }

    pub(super) fn body(&self, draw: u64) -> MassProperties {
        let mut rng = self.streams.run(draw);
        loop {
            let drawn = inset(self.law.sample(&mut rng));
            // Ends: of the trials enough were held. A joint law's own region would judge what was drawn, and this is what is
            // written, a little inside of it.
            if self.region.as_ref().is_none_or(|region| inside::holds(region, &drawn)) {
                return drawn;
            }
        }
    }
}
