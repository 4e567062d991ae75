//! Amounts with units in text, as `10%`, `5mm` or `1deg,1deg,3deg`, and what they state of a body.

use crate::{
    Amount, AxesStatement, CentreStatement, MassStatement, MomentsStatement, ProductsStatement,
    StatementError,
};

/// One number with its unit, or three with commas between them: what ± stands for in a statement.
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
    values: [f64; 3],
    is_percent: bool,
}

impl StatedAmount {
    /// Of a mass: `%`, `kg` or `g`.
    ///
    /// # Errors
    /// The text is not such an amount; the error says what must be written.
    pub fn mass(text: &str) -> Result<Self, StatedAmountError> {
        amounts(text, &[PERCENT, ("kg", Some(1.0)), ("g", Some(1e-3))], 1)
    }

    /// Of a mass centre along the body axes: `mm`, `cm` or `m`.
    ///
    /// # Errors
    /// The text is not such an amount; the error says what must be written.
    pub fn centre(text: &str) -> Result<Self, StatedAmountError> {
        amounts(text, &[("mm", Some(1e-3)), ("cm", Some(1e-2)), ("m", Some(1.0))], 3)
    }

    /// Of the moments of inertia about the body axes: `%` or `kgm2`, also written `kg·m²`.
    ///
    /// # Errors
    /// The text is not such an amount; the error says what must be written.
    pub fn moments(text: &str) -> Result<Self, StatedAmountError> {
        amounts(text, &[&[PERCENT], &INERTIA[..]].concat(), 3)
    }

    /// Of the products of inertia I₁₂, I₁₃, I₂₃: `kgm2`, also written `kg·m²`.
    ///
    /// # Errors
    /// The text is not such an amount; the error says what must be written.
    pub fn products(text: &str) -> Result<Self, StatedAmountError> {
        amounts(text, &INERTIA, 3)
    }

    /// Of the rotation about the principal axes: `deg` or `rad`; `°` is `deg`.
    ///
    /// # Errors
    /// The text is not such an amount; the error says what must be written.
    pub fn axes(text: &str) -> Result<Self, StatedAmountError> {
        let units = [("deg", Some(1.0)), ("°", Some(1.0)), ("rad", Some(1_f64.to_degrees()))];
        amounts(text, &units, 3)
    }

    /// States it of the mass, as so many standard deviations; only what [`mass`](Self::mass) has read makes sense.
    ///
    /// # Errors
    /// The number is not allowed.
    pub fn mass_statement(self, sigmas: f64) -> Result<MassStatement, StatementError> {
        match self.is_percent {
            true => MassStatement::percent(self.values[0], sigmas),
            false => MassStatement::kg(self.values[0], sigmas),
        }
    }

    /// States it of the mass centre: see [`centre`](Self::centre).
    ///
    /// # Errors
    /// A number is not allowed.
    pub fn centre_statement(self, sigmas: f64) -> Result<CentreStatement, StatementError> {
        CentreStatement::new(self.values, sigmas, [0.0; 3])
    }

    /// States it of the moments: see [`moments`](Self::moments).
    ///
    /// # Errors
    /// A number is not allowed.
    pub fn moments_statement(self, sigmas: f64) -> Result<MomentsStatement, StatementError> {
        let amount = match self.is_percent {
            true => Amount::Percent(self.values),
            false => Amount::Absolute(self.values),
        };
        MomentsStatement::new(amount, sigmas)
    }

    /// States it of the products: see [`products`](Self::products).
    ///
    /// # Errors
    /// A number is not allowed.
    pub fn products_statement(self, sigmas: f64) -> Result<ProductsStatement, StatementError> {
        ProductsStatement::new(self.values, sigmas)
    }

    /// States it of the axes, about each: see [`axes`](Self::axes).
    ///
    /// # Errors
    /// A number is not allowed.
    pub fn axes_statement(self, sigmas: f64) -> Result<AxesStatement, StatementError> {
        AxesStatement::each(self.values, sigmas)
    }
}

/// Why a text is not an amount with its unit. The text itself is told by who has read it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StatedAmountError {
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
fn amounts(text: &str, units: &[Unit], most: usize) -> Result<StatedAmount, StatedAmountError> {
    let parts: Vec<&str> = text.split(',').collect();
    if parts.len() != 1 && parts.len() != most {
        return Err(StatedAmountError::Count { most });
    }
    let mut read = Vec::with_capacity(most);
    for part in parts {
        let part = part.trim().trim_start_matches('±').trim_start();
        let unit = units.iter().find(|unit| part.ends_with(unit.0));
        let allowed =
            || StatedAmountError::Unit { allowed: units.iter().map(|unit| unit.0).collect() };
        let (unit, factor) = unit.ok_or_else(allowed)?;
        let number = part.strip_suffix(unit).unwrap_or(part).trim_end();
        let number: f64 = number.parse().map_err(|_| allowed())?;
        if !(number >= 0.0 && number.is_finite()) {
            return Err(StatedAmountError::Number { value: number });
        }
        read.push((number * factor.unwrap_or(1.0), factor.is_none()));
    }
    let is_percent = read[0].1;
    if read.iter().any(|one| one.1 != is_percent) {
        return Err(StatedAmountError::Mixed);
    }
    // The constructors of the statements check how large the numbers are.
    let values = std::array::from_fn(|i| read.get(i).unwrap_or(&read[0]).0);
    Ok(StatedAmount { values, is_percent })
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
        let count = |most| StatedAmountError::Count { most };
        let unit = |allowed: &[&'static str]| StatedAmountError::Unit { allowed: allowed.to_vec() };
        let number = |value| StatedAmountError::Number { value };
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
            (StatedAmount::moments, "5%,1kgm2,1kgm2", StatedAmountError::Mixed),
            (StatedAmount::axes, "five deg", angles.clone()),
            (StatedAmount::axes, "", angles),
            (StatedAmount::products, "5%", inertias.clone()),
            (StatedAmount::products, "5kg", inertias),
            (StatedAmount::mass, "-1kg", number(-1.0)),
            (StatedAmount::centre, "infmm", number(f64::INFINITY)),
            (StatedAmount::axes, "1deg,-1deg,1deg", number(-1.0)),
        ] {
            assert_eq!(read(text).unwrap_err(), expected, "{text}");
        }
        let refused = StatedAmount::mass("nan%").unwrap_err();
        assert!(matches!(refused, StatedAmountError::Number { value } if value.is_nan()));
    }
}
