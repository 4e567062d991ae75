//! What is stated of every link of a robot on the command line, as `--mass 10% --centre 5mm`.

use clap::Args;
use gyradius_estimation::{
    AmountProblem, Part, StatedAmount, StatedAmountError, StatementError, Statements,
};

/// What is stated of every link of a robot.
#[derive(Args, Debug)]
pub(crate) struct StatedArgs {
    /// Of a robot: the mass, ± 10% or ± 0.2kg; the inertia follows it
    #[arg(long, value_name = "AMOUNT", allow_hyphen_values = true, value_parser = amount(StatedAmount::mass), help_heading = ROBOTS)]
    pub(crate) mass: Option<StatedAmount>,

    /// Of a robot: the mass centre along each axis of the link, ± 5mm, or three of them, 5mm,5mm,20mm
    #[arg(long, value_name = "AMOUNT", allow_hyphen_values = true, value_parser = amount(StatedAmount::centre), help_heading = ROBOTS)]
    pub(crate) centre: Option<StatedAmount>,

    /// Of a robot: the moments of inertia about the axes of the link, ± 15%, or three of them; what the mass does to them is a part
    #[arg(long, value_name = "AMOUNT", allow_hyphen_values = true, value_parser = amount(StatedAmount::moments), help_heading = ROBOTS)]
    pub(crate) moments: Option<StatedAmount>,

    /// Of a robot: the rotation about each principal axis, ± 5deg or ± 0.1rad, or three of them
    #[arg(long, value_name = "AMOUNT", allow_hyphen_values = true, value_parser = amount(StatedAmount::axes), help_heading = ROBOTS)]
    pub(crate) axes: Option<StatedAmount>,

    /// Of a robot: how many standard deviations ± stands for in all of these [default: 1]
    #[arg(long, value_name = "K", help_heading = ROBOTS)]
    sigmas: Option<f64>,
}

/// Under which the help has what is for robots alone.
pub(crate) const ROBOTS: &str = "Of robots (URDF, MJCF, SDF)";

/// Reads what follows an option: `clap` says itself which text of which option is refused.
fn amount(
    read: fn(&str) -> Result<StatedAmount, StatedAmountError>,
) -> impl Fn(&str) -> Result<StatedAmount, AmountProblem> + Clone + Send + Sync {
    move |text| read(text).map_err(|refused| refused.problem)
}

impl StatedArgs {
    /// Whether anything is stated.
    pub(crate) fn is_any(&self) -> bool {
        [self.mass, self.centre, self.moments, self.axes].iter().any(Option::is_some)
    }

    /// Whether any of these options is there.
    pub(crate) fn is_given(&self) -> bool {
        self.is_any() || self.sigmas.is_some()
    }

    /// How many standard deviations ± stands for.
    pub(crate) fn sigmas(&self) -> f64 {
        self.sigmas.unwrap_or(1.0)
    }

    /// The statements.
    ///
    /// # Errors
    /// A number is refused; the message names the option.
    pub(crate) fn statements(&self) -> Result<Statements, String> {
        let sigmas = self.sigmas();
        let mass = self.mass.map(|amount| amount.mass_statement(sigmas)).transpose();
        let centre = self.centre.map(|amount| amount.centre_statement(sigmas)).transpose();
        let moments = self.moments.map(|amount| amount.moments_statement(sigmas)).transpose();
        let axes = self.axes.map(|amount| amount.axes_statement(sigmas)).transpose();
        Ok(Statements {
            mass: mass.map_err(|error| of_option(&error, Part::Mass))?,
            centre: centre.map_err(|error| of_option(&error, Part::Centre))?,
            moments: moments.map_err(|error| of_option(&error, Part::Moments))?,
            axes: axes.map_err(|error| of_option(&error, Part::Axes))?,
            products: None,
        })
    }
}

/// What is wrong with what an option states, with its name in the place of the key that a file has.
fn of_option(error: &StatementError, part: Part) -> String {
    let message = error.to_string();
    let (_, why) = message.split_once(": ").unwrap_or(("", &message));
    match error {
        StatementError::Sigmas { value, .. } => format!("--sigmas {value:?}: {why}"),
        _ => format!("--{part}: {why}"),
    }
}
