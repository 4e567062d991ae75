//! Draws of the mass properties of a robot's links: as robots in files, and as a table.

mod as_written;
mod drawn_link;
mod folder;
mod inside;
mod pick;
mod summary;
mod table;

use gyradius_campaign::{CampaignError, FormatError, TableError};
use gyradius_estimation::{StatementError, Statements};
use gyradius_formats::{
    Format, Gap, GapKind, LinkProblem, RobotError, RobotFile, RobotLink, WithoutInertia, WriteError,
};
use gyradius_inertia::MassProperties;
use std::sync::{Arc, atomic::AtomicBool};

use drawn_link::{DrawnLink, NotDrawn};

pub use as_written::{as_written, inset};
pub use folder::RobotFolder;
pub use inside::Inside;
pub use summary::LinkSummary;

/// Which draws of which links.
#[derive(Clone, Debug, Default)]
pub struct RobotDrawOptions {
    /// What is stated of every link, about its own nominal numbers.
    pub statements: Statements,
    /// Names of links, in which `*` stands for any characters and `?` for one; all links if there are none.
    pub links: Vec<String>,
    /// Where the matter of each link must be possible; anywhere if not given.
    pub inside: Option<Inside>,
    /// Seed of all random numbers.
    pub seed: u64,
    /// The first draw, from 0.
    pub first: u64,
    /// How many draws.
    pub draws: u64,
    /// How many threads; as many as the machine has if not given.
    pub threads: Option<usize>,
    /// Set from elsewhere to stop.
    pub stop: Option<Arc<AtomicBool>>,
}

/// The draws of a robot, ready to be written.
///
/// What is drawn of a link depends on the seed, the name of the link, its nominal numbers, what is stated, and the number of the draw
/// alone: links that are added, removed or put in another order change no other.
#[derive(Clone, Debug)]
pub struct RobotDraw<'a> {
    robot: &'a RobotFile,
    links: Vec<DrawnLink>,
    left: Vec<(String, LeftBecause)>,
    options: RobotDrawOptions,
}

/// Why a link stays as it is.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LeftBecause {
    /// The file does not say the numbers of its inertia.
    #[error("{0}")]
    NoInertia(WithoutInertia),
    /// It has no mass.
    #[error("a mass of 0 kg")]
    NoMass,
    /// It was not picked.
    #[error("not picked")]
    NotPicked,
    /// Its numbers cannot be told.
    #[error(transparent)]
    Problem(#[from] LinkProblem),
}

impl<'a> RobotDraw<'a> {
    /// Makes the laws of all links that are picked. Nothing is drawn yet.
    ///
    /// # Errors
    /// A name matches no link, or none can be drawn; the nominal numbers of one are those of no body; or the statements
    /// are refused.
    pub fn new(robot: &'a RobotFile, options: RobotDrawOptions) -> Result<Self, RobotDrawError> {
        if let Some(told) = robot.overridden_by() {
            return Err(RobotDrawError::Overridden { told: told.to_owned() });
        }
        let last = options.first.checked_add(options.draws).filter(|last| *last <= MOST);
        if last.is_none() {
            return Err(RobotDrawError::Draws { first: options.first, draws: options.draws });
        }
        let beside = |link: &RobotLink| link.numbers().err().filter(|why| why.is_beside()).cloned();
        let own = robot.links().iter().filter(|link| beside(link).is_none());
        let names: Vec<&str> = own.map(RobotLink::name).collect();
        let without = robot.links_without_inertia().iter();
        let without = without.map(|name| (name.clone(), robot.why_without(name)));
        let without: Vec<_> = without.collect();
        let mut picked = pick::picked(&names, &without, &options.links)?.into_iter();
        let (mut links, mut left) = (Vec::new(), Vec::new());
        let (mut impossible, mut outside) = (Vec::new(), Vec::new());
        let (mut unreadable, mut beyond) = (Vec::new(), Vec::new());
        let is_named = !options.links.is_empty();
        for (index, link) in robot.links().iter().enumerate() {
            let name = link.name().to_owned();
            let drawn = if let Some(problem) = beside(link) {
                // It is not what a name means.
                Err(NotDrawn::Left(problem.into()))
            } else if picked.next().unwrap_or_default() {
                DrawnLink::new(robot, (index, link), is_named, &options)
            } else {
                Err(NotDrawn::Left(LeftBecause::NotPicked))
            };
            match drawn {
                Ok(drawn) => links.push(drawn),
                Err(NotDrawn::Left(why)) => left.push((name, why)),
                Err(NotDrawn::Unreadable(why)) => unreadable.push(format!("\"{name}\": {why}")),
                Err(NotDrawn::Impossible) => impossible.push(name),
                Err(NotDrawn::Beyond(error)) => beyond.push((name, error)),
                Err(NotDrawn::Outside(why)) => outside.push(format!("\"{name}\": {why}")),
            }
        }
        if let Some(inside) = options.inside.filter(|_| !outside.is_empty()) {
            return Err(RobotDrawError::Outside { inside, links: outside.join("; ") });
        }
        if !unreadable.is_empty() {
            return Err(RobotDrawError::Unreadable { links: unreadable.join("; ") });
        }
        if !impossible.is_empty() {
            return Err(RobotDrawError::Impossible { links: impossible.join(", ") });
        }
        if !beyond.is_empty() {
            return Err(RobotDrawError::Statement { links: beyond });
        }
        left.extend(without.into_iter().map(|(name, why)| (name, LeftBecause::NoInertia(why))));
        if links.is_empty() {
            let why = why_nothing(robot, &left);
            return Err(RobotDrawError::Nothing { format: robot.format(), why });
        }
        Ok(Self { robot, links, left, options })
    }

    /// Names of the links that are drawn, in the order of the file.
    pub fn links(&self) -> impl ExactSizeIterator<Item = &str> {
        self.links.iter().map(|link| link.name.as_str())
    }

    /// The links that stay as they are, and why.
    #[must_use]
    pub fn left(&self) -> &[(String, LeftBecause)] {
        &self.left
    }

    /// Mass properties of a link, by its place among [`links`](Self::links), in a draw.
    #[must_use]
    pub fn body(&self, link: usize, draw: u64) -> Option<MassProperties> {
        self.links.get(link).map(|link| link.body(draw))
    }

    /// The robot of a draw, as the bytes of a file.
    ///
    /// # Errors
    /// A number that must change is not in the file.
    pub fn robot(&self, draw: u64) -> Result<Vec<u8>, RobotError> {
        let bodies: Vec<(usize, MassProperties)> =
            self.links.iter().map(|link| (link.index, link.body(draw))).collect();
        self.robot.copy(&bodies)
    }
}

/// Why no link can be drawn, by the first reason that can be mended.
fn why_nothing(robot: &RobotFile, left: &[(String, LeftBecause)]) -> String {
    // What can be mended is told before links without an inertia: macros that are to be expanded, numbers that cannot be read,
    // inertias that stand where none is read, and files that are included, which can be drawn in the place of this one.
    let gap = |kind| robot.gaps().iter().find(move |gap| gap.kind() == kind);
    let (macros, misplaced) = (gap(GapKind::Macros), gap(GapKind::Misplaced));
    let included = gap(GapKind::Included);
    let mut picked = left.iter().filter(|(_, why)| *why != LeftBecause::NotPicked);
    let is_problem = |(_, why): &&(_, _)| matches!(why, LeftBecause::Problem(_));
    let told = |(name, why): &(String, LeftBecause)| format!(": \"{name}\": {why}");
    let of_gap = |gap: &Gap| format!(": line {}: {gap}", gap.line());
    macros
        .map(|gap| format!(": {gap}"))
        .or_else(|| picked.clone().find(is_problem).map(told))
        .or_else(|| misplaced.map(of_gap))
        .or_else(|| {
            Some(of_gap(included?) + "; what is included can be drawn as a file of its own")
        })
        .or_else(|| picked.next().map(told))
        .unwrap_or_default()
}

/// The last draw has a number that a column can hold.
const MOST: u64 = i64::MAX as u64;

/// Why a robot cannot be drawn or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RobotDrawError {
    /// A name matches no link.
    #[error("--links {pattern}: {why}")]
    Pattern {
        /// The name.
        pattern: String,
        /// What the file has.
        why: String,
    },
    /// No link can be drawn.
    #[error("no link of this {format} file has an inertia that can be drawn{why}")]
    Nothing {
        /// Its format.
        format: Format,
        /// Why the first of them cannot.
        why: String,
    },
    /// MuJoCo does not use the numbers as they are written.
    #[error(
        "the compiler of this file has {told}, so that MuJoCo does not use the masses and inertias as they are written: \
         remove this attribute in a copy of the file, and draw the copy"
    )]
    Overridden {
        /// The attribute, as it is written.
        told: String,
    },
    /// Numbers of links that are none.
    #[error("{links}: --links picks others")]
    Unreadable {
        /// The links, and what is wrong.
        links: String,
    },
    /// Nominal numbers that no body has.
    #[error(
        "no body has the inertia of {links}: `gyradius check` says why, and with --repair writes a copy that can be drawn"
    )]
    Impossible {
        /// Names of the links.
        links: String,
    },
    /// Too little of the law of a link is possible in its geometry.
    #[error("--inside {inside}: {links}. --links picks others")]
    Outside {
        /// The region.
        inside: Inside,
        /// The links, and why.
        links: String,
    },
    /// The statements are refused of some links.
    #[error("{}: --links picks others", told(links))]
    Statement {
        /// The links, and why.
        links: Vec<(String, StatementError)>,
    },
    /// The last draw would have a number that is too large.
    #[error("{draws} draws from draw {first} on: the number of the last must be below {MOST}")]
    Draws {
        /// The first.
        first: u64,
        /// How many.
        draws: u64,
    },
    /// A robot cannot be copied.
    #[error(transparent)]
    Robot(#[from] RobotError),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// What is there is the robot itself, by a link perhaps.
    #[error("{path} is what was read: it is not written over")]
    Input {
        /// The file.
        path: String,
    },
    /// What is there is no copy of this robot.
    #[error("{path} is not this robot with other numbers, and is not replaced")]
    Foreign {
        /// The file.
        path: String,
    },
    /// What is in the place of the folder is none.
    #[error("{path} is there and is no folder: a folder for robots, or a table, must be named")]
    NoFolder {
        /// What is there.
        path: String,
    },
    /// A folder cannot be made or read.
    #[error("{path}: {error}")]
    Folder {
        /// The folder.
        path: String,
        /// What the system says.
        error: std::io::Error,
    },
    /// The threads cannot be started, or it was told to stop.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    /// The columns are refused.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The output refuses.
    #[error(transparent)]
    Output(#[from] FormatError),
}

/// Links with what is wrong with each.
fn told(links: &[(String, StatementError)]) -> String {
    let told = links.iter().map(|(name, error)| format!("\"{name}\": {error}"));
    told.collect::<Vec<_>>().join("; ")
}
