//! Amounts with units on the command line, as `10%`, `5mm` or `1deg,1deg,3deg`, and what they state of a body.

use clap::Args;
use gyradius_estimation::{
    Amount, AxesStatement, CentreStatement, MassStatement, MomentsStatement, StatementError,
    Statements,
};

/// What is stated of every link of a robot.
#[derive(Args, Debug)]
pub(crate) struct StatedArgs {
    /// Of a robot: the mass, ± 10% or ± 0.2kg; the inertia follows it
    #[arg(long, value_name = "AMOUNT", value_parser = mass, help_heading = ROBOTS)]
    pub(crate) mass: Option<Stated>,

    /// Of a robot: the mass centre along each axis of the link, ± 5mm, or three of them, 5mm,5mm,20mm
    #[arg(long, value_name = "AMOUNT", value_parser = centre, help_heading = ROBOTS)]
    pub(crate) centre: Option<Stated>,

    /// Of a robot: the moments of inertia about the axes of the link, ± 15%, or three of them; what the mass does to them is a part
    #[arg(long, value_name = "AMOUNT", value_parser = moments, help_heading = ROBOTS)]
    pub(crate) moments: Option<Stated>,

    /// Of a robot: the rotation about each principal axis, ± 5deg or ± 0.1rad, or three of them
    #[arg(long, value_name = "AMOUNT", value_parser = axes, help_heading = ROBOTS)]
    pub(crate) axes: Option<Stated>,

    /// Of a robot: how many standard deviations ± stands for in all of these
    #[arg(long, value_name = "K", default_value_t = 1.0, help_heading = ROBOTS)]
    pub(crate) sigmas: f64,
}

/// Under which the help has what is for robots alone.
pub(crate) const ROBOTS: &str = "Of robots (URDF, MJCF, SDF)";

/// Three numbers in a unit of the program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stated {
    values: [f64; 3],
    is_percent: bool,
}

/// A unit as it is written, and how much of the program's unit it is; nothing of percent.
type Unit = (&'static str, Option<f64>);

const PERCENT: Unit = ("%", None);

fn mass(text: &str) -> Result<Stated, String> {
    amounts(text, &[PERCENT, ("kg", Some(1.0)), ("g", Some(1e-3))], 1)
}

fn centre(text: &str) -> Result<Stated, String> {
    amounts(text, &[("mm", Some(1e-3)), ("cm", Some(1e-2)), ("m", Some(1.0))], 3)
}

fn moments(text: &str) -> Result<Stated, String> {
    amounts(text, &[PERCENT, ("kgm2", Some(1.0))], 3)
}

fn axes(text: &str) -> Result<Stated, String> {
    amounts(text, &[("deg", Some(1.0)), ("rad", Some(1_f64.to_degrees()))], 3)
}

/// One amount, or as many as there may be, with commas between them.
fn amounts(text: &str, units: &[Unit], most: usize) -> Result<Stated, String> {
    let names: Vec<&str> = units.iter().map(|unit| unit.0).collect();
    let parts: Vec<&str> = text.split(',').collect();
    if parts.len() != 1 && parts.len() != most {
        let more =
            if most > 1 { format!(", or {most} with commas between them") } else { String::new() };
        return Err(format!("it must be one number with its unit{more}"));
    }
    let mut read = Vec::with_capacity(most);
    for part in parts {
        let part = part.trim().trim_start_matches('±').trim_start();
        let unit = units.iter().find(|unit| part.ends_with(unit.0));
        let allowed = || format!("it must be a number and its unit, {}", names.join(" or "));
        let (unit, factor) = unit.ok_or_else(allowed)?;
        let number = part.strip_suffix(unit).unwrap_or(part).trim_end();
        let number: f64 = number.parse().map_err(|_| allowed())?;
        read.push((number * factor.unwrap_or(1.0), factor.is_none()));
    }
    let is_percent = read[0].1;
    if read.iter().any(|one| one.1 != is_percent) {
        return Err("percent and another unit do not go together".to_owned());
    }
    // The constructors of the statements check the numbers.
    let values = std::array::from_fn(|i| read.get(i).unwrap_or(&read[0]).0);
    Ok(Stated { values, is_percent })
}

impl StatedArgs {
    /// Whether anything is stated.
    pub(crate) fn is_any(&self) -> bool {
        [self.mass, self.centre, self.moments, self.axes].iter().any(Option::is_some)
    }

    /// The statements.
    pub(crate) fn statements(&self) -> Result<Statements, StatementError> {
        let sigmas = self.sigmas;
        let mass = |stated: Stated| match stated.is_percent {
            true => MassStatement::percent(stated.values[0], sigmas),
            false => MassStatement::kg(stated.values[0], sigmas),
        };
        let moments = |stated: Stated| {
            let amount = match stated.is_percent {
                true => Amount::Percent(stated.values),
                false => Amount::Absolute(stated.values),
            };
            MomentsStatement::new(amount, sigmas)
        };
        let centre = |stated: Stated| CentreStatement::new(stated.values, sigmas, [0.0; 3]);
        Ok(Statements {
            mass: self.mass.map(mass).transpose()?,
            centre: self.centre.map(centre).transpose()?,
            moments: self.moments.map(moments).transpose()?,
            axes: self.axes.map(|axes| AxesStatement::each(axes.values, sigmas)).transpose()?,
            products: None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amounts_have_units() {
        let values = |read: Result<Stated, String>| read.unwrap().values;
        assert_eq!(values(mass("10%")), [10.0; 3]);
        assert!(mass("10 %").unwrap().is_percent && !mass("2kg").unwrap().is_percent);
        assert_eq!(values(mass("±200 g"))[0], 0.2);
        assert_eq!(values(centre("5mm")), [0.005; 3]);
        assert_eq!(values(centre("1cm, 5mm,2e-1m")), [0.01, 0.005, 0.2]);
        assert!((values(axes("0.1rad"))[0].to_radians() - 0.1).abs() < 1e-16);
        assert_eq!(values(moments("1e-3kgm2,1kgm2,2kgm2")), [1e-3, 1.0, 2.0]);
        for (read, text) in [
            (mass as fn(&str) -> Result<Stated, String>, "10"),
            (mass, "10%,10%,10%"),
            (mass, "%"),
            (centre, "5"),
            (centre, "5%"),
            (centre, "5mm,5mm"),
            (moments, "5%,1kgm2,1kgm2"),
            (axes, "five deg"),
            (axes, ""),
        ] {
            assert!(read(text).is_err(), "{text}");
        }
    }
}
