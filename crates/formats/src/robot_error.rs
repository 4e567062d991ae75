//! Why a robot, or one of its links, cannot be read or written.

use crate::{FileBodyError, FileError, Format};

/// Why the numbers of one link cannot be told or written; those of its neighbours can.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinkProblem {
    /// A number is missing, or none.
    #[error(transparent)]
    Body(#[from] FileBodyError),
    /// It stands beside the link's own, for Gazebo.
    #[error("its <inertial> in a block for Gazebo is for Gazebo alone")]
    Gazebo,
    /// Another one of the link stands before it.
    #[error("it is a second <inertial> of its link, and simulators read the first alone")]
    Second,
    /// It is one of several of its body, in MJCF.
    #[error(
        "its body has more than one <inertial>: MuJoCo refuses the file or, where they stand in frames, takes the last"
    )]
    Several,
    /// A macro of xacro may give its pose.
    #[error(
        "its pose may be given by a macro in it, which is not expanded: expand the file first, with `xacro file.xacro > file.urdf`"
    )]
    Macro,
    /// Its frame is given in another one than the link's.
    #[error("its pose is relative to \"{frame}\": it must be that in the link")]
    RelativeTo {
        /// The other frame.
        frame: String,
    },
    /// Another file may say whether angles are degrees, and about which axes they turn.
    #[error(
        "its axes are given by angles. Whether these are degrees and about which axes they turn may be said in another file, which is \
         not read: give a `quat` instead, or a <compiler> with angle and eulerseq after the last <include>"
    )]
    Angles,
    /// The compiler says of angles what is neither degrees nor radians.
    #[error(
        "its axes are given by angles, and the compiler has angle=\"{word}\": it must be degree or \
         radian"
    )]
    AngleUnit {
        /// What it says, shortened.
        word: String,
    },
    /// A quaternion in a URDF file of a version that has none.
    #[error(
        "its axes are given by quat_xyzw, over which readers of URDF of version \"{version}\" pass: give <robot version=\"1.1\">, or rpy \
         instead"
    )]
    QuaternionVersion {
        /// The version that the file states, shortened, or 1.0 if it states none.
        version: String,
    },
    /// A word that is none of those that are known.
    #[error("{field} = \"{value}\": it must be {allowed}")]
    Word {
        /// The attribute.
        field: &'static str,
        /// What it holds, shortened.
        value: String,
        /// What it may hold.
        allowed: &'static str,
    },
    /// An orientation that is none.
    #[error("{field} is no orientation")]
    Orientation {
        /// The field.
        field: &'static str,
    },
    /// Numbers beyond computing with.
    #[error("its inertia is too large to be computed with, or not symmetric")]
    OutOfRange,
    /// A number that must change is not there as such.
    #[error("its {field} is not written in the file, or not as a plain number")]
    NoPlace {
        /// The field.
        field: &'static str,
    },
}

impl LinkProblem {
    /// Whether it is that of an inertia beside the one that counts for the link, which may have numbers all the same.
    #[must_use]
    pub fn is_beside(&self) -> bool {
        matches!(self, Self::Gazebo | Self::Second)
    }

    /// Whether something is there and is not what it must be, which nobody means: what is missing, or said in another
    /// way, is no slip.
    #[must_use]
    pub fn is_a_slip(&self) -> bool {
        match self {
            Self::Body(error) => match error {
                FileBodyError::NotFinite { .. }
                | FileBodyError::NotANumber { .. }
                | FileBodyError::NotPlain { .. }
                | FileBodyError::Expression { .. }
                | FileBodyError::Count { .. }
                | FileBodyError::Shape { .. }
                | FileBodyError::Word { .. }
                | FileBodyError::Attribute { .. }
                | FileBodyError::Unread { .. }
                | FileBodyError::Key { .. }
                | FileBodyError::Several { .. }
                | FileBodyError::Both { .. } => true,
                FileBodyError::Missing { .. } => false,
            },
            Self::Orientation { .. }
            | Self::AngleUnit { .. }
            | Self::QuaternionVersion { .. }
            | Self::Word { .. }
            | Self::Several
            | Self::OutOfRange => true,
            Self::Gazebo
            | Self::Second
            | Self::Macro
            | Self::RelativeTo { .. }
            | Self::Angles
            | Self::NoPlace { .. } => false,
        }
    }
}

/// Why a robot cannot be read or copied.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RobotError {
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// A table, a list.
    #[error("{format} files hold no robot: it must be URDF, MJCF or SDF")]
    Format {
        /// Its format.
        format: Format,
    },
    /// There is no such link.
    #[error("link {index}: the file has {links} links with inertia, counted from 0")]
    Index {
        /// The index.
        index: usize,
        /// How many there are.
        links: usize,
    },
    /// A link cannot be told or written.
    #[error("line {line}: \"{name}\": {problem}")]
    Link {
        /// Its name.
        name: String,
        /// Its line.
        line: usize,
        /// What is wrong.
        problem: LinkProblem,
    },
    /// The copy reads back as something else than was meant.
    #[error("the copy does not read back: nothing was written")]
    ReadsBackWrong,
}
