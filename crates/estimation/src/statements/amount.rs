//! Amounts with units in text, as `10%`, `5mm` or `1deg,1deg,3deg`, and what they state of a body.

use crate::{
    Amount, AxesStatement, CentreStatement, MassStatement, MomentsStatement, Part,
    ProductsStatement, StatementError,
};

/// One number with its unit, or three with commas between them: what ± stands for in a statement.
///
/// It is an amount of one part, as which it was read, and states nothing of another.
///
/// ```
/// use gyradius_estimation::{StatedAmount, StatedBody, Statements};
/// use gyradius_inertia::Shape;
///
/// let statements = Statements {
///     mass: Some(StatedAmount::mass("10%")?.mass_statement(3.0)?),
///     centre: Some(StatedAmount::centre("5mm, 5mm, 2cm")?.centre_statement(3.0)?),
///     ..Statements::default()
/// };
/// let body = StatedBody::new(&statements, &Shape::sphere(0.1)?.of_mass(2.0)?)?;
/// assert!((body.law().mass().deviation() - 0.2 / 3.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StatedAmount {
    /// Of what it was read.
    part: Part,
    /// In %, or in the unit of the part's statement.
    values: [f64; 3],
    is_percent: bool,
}

impl StatedAmount {
    /// Of a mass: `%`, `kg` or `g`.
    ///
    /// # Errors
    /// The text is not such an amount; the error says what must be written.
    pub fn mass(text: &str) -> Result<Self, StatedAmountError> {
        amounts(Part::Mass, text, &[PERCENT, ("kg", Some(1.0)), ("g", Some(1e-3))], 1)
    }

    /// Of a mass centre along the body axes: `mm`, `cm` or `m`.
    ///
    /// # Errors
    /// The text is not such an amount; the error says what must be written.
    pub fn centre(text: &str) -> Result<Self, StatedAmountError> {
        amounts(Part::Centre, text, &[("mm", Some(1e-3)), ("cm", Some(1e-2)), ("m", Some(1.0))], 3)
    }

    /// Of the moments of inertia about the body axes: `%` or `kgm2`, also written `kg·m²`.
    ///
    /// # Errors
    /// The text is not such an amount; the error says what must be written.
    pub fn moments(text: &str) -> Result<Self, StatedAmountError> {
        amounts(Part::Moments, text, &[&[PERCENT], &INERTIA[..]].concat(), 3)
    }

    /// Of the products of inertia I₁₂, I₁₃, I₂₃: `kgm2`, also written `kg·m²`.
    ///
    /// # Errors
    /// The text is not such an amount; the error says what must be written.
    pub fn products(text: &str) -> Result<Self, StatedAmountError> {
        amounts(Part::Products, text, &INERTIA, 3)
    }

    /// Of the rotation about the principal axes: `deg` or `rad`; `°` is `deg`.
    ///
    /// # Errors
    /// The text is not such an amount; the error says what must be written.
    pub fn axes(text: &str) -> Result<Self, StatedAmountError> {
        let units = [("deg", Some(1.0)), ("°", Some(1.0)), ("rad", Some(1_f64.to_degrees()))];
        amounts(Part::Axes, text, &units, 3)
    }

    /// States it of the mass, as so many standard deviations.
    ///
    /// # Errors
    /// The number is not allowed, or [`mass`](Self::mass) has not read it.
    pub fn mass_statement(self, sigmas: f64) -> Result<MassStatement, StatementError> {
        self.of(Part::Mass)?;
        match self.is_percent {
            true => MassStatement::percent(self.values[0], sigmas),
            false => MassStatement::kg(self.values[0], sigmas),
        }
    }

    /// States it of the mass centre.
    ///
    /// # Errors
    /// A number is not allowed, or [`centre`](Self::centre) has not read them.
    pub fn centre_statement(self, sigmas: f64) -> Result<CentreStatement, StatementError> {
        self.of(Part::Centre)?;
        CentreStatement::new(self.values, sigmas, [0.0; 3])
    }

    /// States it of the moments.
    ///
    /// # Errors
    /// A number is not allowed, or [`moments`](Self::moments) has not read them.
    pub fn moments_statement(self, sigmas: f64) -> Result<MomentsStatement, StatementError> {
        self.of(Part::Moments)?;
        let amount = match self.is_percent {
            true => Amount::Percent(self.values),
            false => Amount::Absolute(self.values),
        };
        MomentsStatement::new(amount, sigmas)
    }

    /// States it of the products.
    ///
    /// # Errors
    /// A number is not allowed, or [`products`](Self::products) has not read them.
    pub fn products_statement(self, sigmas: f64) -> Result<ProductsStatement, StatementError> {
        self.of(Part::Products)?;
        ProductsStatement::new(self.values, sigmas)
    }

    /// States it of the axes, about each.
    ///
    /// # Errors
    /// A number is not allowed, or [`axes`](Self::axes) has not read them.
    pub fn axes_statement(self, sigmas: f64) -> Result<AxesStatement, StatementError> {
        self.of(Part::Axes)?;
        AxesStatement::each(self.values, sigmas)
    }

    /// Refuses it if it is of another part, whose numbers would be taken in the wrong unit.
    fn of(self, part: Part) -> Result<(), StatementError> {
        let Self { part: read_of, values, is_percent } = self;
        if read_of == part {
            return Ok(());
        }
        let unit = match (is_percent, read_of) {
            (true, _) => "%",
            (false, Part::Mass) => "kg",
            (false, Part::Centre) => "m",
            (false, Part::Moments | Part::Products) => "kg·m²",
            (false, Part::Axes) => "deg",
        };
        Err(StatementError::OtherPart { part, read_of, values, unit })
    }
}

/// A text that is not an amount with its unit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{part} = {text:?}: {problem}")]
#[non_exhaustive]
pub struct StatedAmountError {
    /// Of what it should be an amount.
    pub part: Part,
    /// The text.
    pub text: String,
    /// What is wrong with it.
    pub problem: AmountProblem,
}

/// Why a text is not an amount with its unit, for who says himself which text, as a command line does.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AmountProblem {
    /// There are neither one nor as many amounts as there may be.
    #[error("it must be one number with its unit{}", or_more(*most))]
    Count {
        /// How many there may be.
        most: usize,
    },
    /// A part is not a number with one of the units that are allowed.
    #[error("it must be a number and its unit, {}", allowed.join(" or "))]
    Unit {
        /// The units.
        allowed: Vec<&'static str>,
    },
    /// A number is negative, NaN or infinite.
    #[error("it must be finite and not negative")]
    Number {
        /// The number.
        value: f64,
    },
    /// One part is in percent, another is not.
    #[error("percent and another unit do not go together")]
    Mixed,
}

fn or_more(most: usize) -> String {
    if most > 1 { format!(", or {most} with commas between them") } else { String::new() }
}

/// A unit as it is written, and how much of the program's unit it is; nothing of percent.
type Unit = (&'static str, Option<f64>);

const PERCENT: Unit = ("%", None);

const INERTIA: [Unit; 3] = [("kgm2", Some(1.0)), ("kg·m²", Some(1.0)), ("kg m²", Some(1.0))];

/// One amount, or as many as there may be, with commas between them.
fn amounts(
    part: Part,
    text: &str,
    units: &[Unit],
    most: usize,
) -> Result<StatedAmount, StatedAmountError> {
    match read(text, units, most) {
        Ok((values, is_percent)) => Ok(StatedAmount { part, values, is_percent }),
        Err(problem) => Err(StatedAmountError { part, text: text.to_owned(), problem }),
    }
}

/// The numbers in the units of statements, and whether they are in percent.
fn read(text: &str, units: &[Unit], most: usize) -> Result<([f64; 3], bool), AmountProblem> {
    let parts: Vec<&str> = text.split(',').collect();
    if parts.len() != 1 && parts.len() != most {
        return Err(AmountProblem::Count { most });
    }
    let mut read = Vec::with_capacity(most);
    for part in parts {
        let part = part.trim().trim_start_matches('±').trim_start();
        let unit = units.iter().find(|unit| part.ends_with(unit.0));
        let allowed = || AmountProblem::Unit { allowed: units.iter().map(|unit| unit.0).collect() };
        let (unit, factor) = unit.ok_or_else(allowed)?;
        let number = part.strip_suffix(unit).unwrap_or(part).trim_end();
        let number: f64 = number.parse().map_err(|_| allowed())?;
        if !(number >= 0.0 && number.is_finite()) {
            return Err(AmountProblem::Number { value: number });
        }
        read.push((number * factor.unwrap_or(1.0), factor.is_none()));
    }
    let is_percent = read[0].1;
    if read.iter().any(|one| one.1 != is_percent) {
        return Err(AmountProblem::Mixed);
    }
    // The constructors of the statements check how large the numbers are.
    let values = std::array::from_fn(|i| read.get(i).unwrap_or(&read[0]).0);
    Ok((values, is_percent))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amounts_have_units() {
        let values = |read: Result<StatedAmount, StatedAmountError>| read.unwrap().values;
        assert_eq!(values(StatedAmount::mass("10%")), [10.0; 3]);
        assert!(
            StatedAmount::mass("10 %").unwrap().is_percent
                && !StatedAmount::mass("2kg").unwrap().is_percent
        );
        assert_eq!(values(StatedAmount::mass("±200 g"))[0], 0.2);
        assert_eq!(values(StatedAmount::centre("5mm")), [0.005; 3]);
        assert_eq!(values(StatedAmount::centre("1cm, 5mm,2e-1m")), [0.01, 0.005, 0.2]);
        assert!((values(StatedAmount::axes("0.1rad"))[0].to_radians() - 0.1).abs() < 1e-16);
        assert_eq!(values(StatedAmount::moments("1e-3kgm2,1kgm2,2kgm2")), [1e-3, 1.0, 2.0]);
        assert_eq!(values(StatedAmount::products("5 kgm2")), [5.0; 3]);
        let count = |most| AmountProblem::Count { most };
        let unit = |allowed: &[&'static str]| AmountProblem::Unit { allowed: allowed.to_vec() };
        let number = |value| AmountProblem::Number { value };
        let (masses, lengths) = (unit(&["%", "kg", "g"]), unit(&["mm", "cm", "m"]));
        let angles = unit(&["deg", "°", "rad"]);
        let inertias = unit(&["kgm2", "kg·m²", "kg m²"]);
        for (read, text, expected) in [
            (StatedAmount::mass as fn(&str) -> _, "10", masses.clone()),
            (StatedAmount::mass, "10%,10%,10%", count(1)),
            (StatedAmount::mass, "%", masses),
            (StatedAmount::centre, "5", lengths.clone()),
            (StatedAmount::centre, "5%", lengths),
            (StatedAmount::centre, "5mm,5mm", count(3)),
            (StatedAmount::moments, "5%,1kgm2,1kgm2", AmountProblem::Mixed),
            (StatedAmount::axes, "five deg", angles.clone()),
            (StatedAmount::axes, "", angles),
            (StatedAmount::products, "5%", inertias.clone()),
            (StatedAmount::products, "5kg", inertias),
            (StatedAmount::mass, "-1kg", number(-1.0)),
            (StatedAmount::centre, "infmm", number(f64::INFINITY)),
            (StatedAmount::axes, "1deg,-1deg,1deg", number(-1.0)),
        ] {
            let refused = read(text).unwrap_err();
            assert_eq!((refused.text.as_str(), refused.problem), (text, expected), "{text}");
        }
        let refused = StatedAmount::mass("nan%").unwrap_err().problem;
        assert!(matches!(refused, AmountProblem::Number { value } if value.is_nan()));
    }

    #[test]
    fn what_is_refused_is_told_with_its_part() {
        for (read, text, told) in [
            (
                StatedAmount::mass as fn(&str) -> _,
                "5mm",
                r#"mass = "5mm": it must be a number and its unit, % or kg or g"#,
            ),
            (StatedAmount::mass, "-5kg", r#"mass = "-5kg": it must be finite and not negative"#),
            (
                StatedAmount::axes,
                "1deg,2deg",
                r#"axes = "1deg,2deg": it must be one number with its unit, or 3 with commas between them"#,
            ),
            (
                StatedAmount::moments,
                "5%,1kgm2,1kgm2",
                r#"moments = "5%,1kgm2,1kgm2": percent and another unit do not go together"#,
            ),
        ] {
            assert_eq!(read(text).unwrap_err().to_string(), told);
        }
    }

    /// Every amount of every unit, of every part: it states something of its own alone.
    #[test]
    fn an_amount_states_nothing_of_another_part() {
        type Refusal = fn(StatedAmount) -> Option<StatementError>;
        let state: [(Part, Refusal); 5] = [
            (Part::Mass, |amount| amount.mass_statement(1.0).err()),
            (Part::Centre, |amount| amount.centre_statement(1.0).err()),
            (Part::Moments, |amount| amount.moments_statement(1.0).err()),
            (Part::Products, |amount| amount.products_statement(1.0).err()),
            (Part::Axes, |amount| amount.axes_statement(1.0).err()),
        ];
        for (amount, own, unit) in [
            (StatedAmount::mass("10%"), Part::Mass, "%"),
            (StatedAmount::mass("10g"), Part::Mass, "kg"),
            (StatedAmount::centre("5mm"), Part::Centre, "m"),
            (StatedAmount::moments("10%"), Part::Moments, "%"),
            (StatedAmount::moments("1kgm2"), Part::Moments, "kg·m²"),
            (StatedAmount::products("1kgm2"), Part::Products, "kg·m²"),
            (StatedAmount::axes("2deg"), Part::Axes, "deg"),
        ] {
            let amount = amount.unwrap();
            for (part, refused) in state.map(|(part, state)| (part, state(amount))) {
                let (read_of, values) = (own, amount.values);
                let other = StatementError::OtherPart { part, read_of, values, unit };
                assert_eq!(refused, (part != own).then_some(other), "{part} of {own}");
            }
        }
        let refused = StatedAmount::mass("10%").unwrap().axes_statement(1.0).unwrap_err();
        assert_eq!(
            refused.to_string(),
            "axes: an amount of the axes is needed, and [10.0, 10.0, 10.0] % was read as one of the mass"
        );
    }
}
