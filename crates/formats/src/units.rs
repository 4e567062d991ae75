//! Units in tables: what stands after the name of a number in a heading, and how much it is in SI.

use crate::body::shortened;

/// Units of mass, and what they are in kg.
pub(crate) const MASSES: [(&str, f64); 9] = [
    ("kg", 1.0),
    ("g", 1e-3),
    ("mg", 1e-6),
    ("t", 1e3),
    ("lb", 0.453_592_37),
    ("lbs", 0.453_592_37),
    ("lbm", 0.453_592_37),
    ("slug", 14.593_902_937_206_36),
    ("slugs", 14.593_902_937_206_36),
];

/// Units of length, and what their squares are in m².
pub(crate) const LENGTHS: [(&str, f64); 7] = [
    ("m", 1.0),
    ("cm", 1e-4),
    ("mm", 1e-6),
    ("in", 6.4516e-4),
    ("inch", 6.4516e-4),
    ("inches", 6.4516e-4),
    ("ft", 0.092_903_04),
];

/// What a unit measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Dimension {
    Mass,
    Length,
    /// Mass times length.
    FirstMoment,
    Inertia,
}

impl Dimension {
    pub(crate) const ALL: [Self; 4] = [Self::Mass, Self::Length, Self::FirstMoment, Self::Inertia];
}

/// A unit as it is written, nothing where none is stated, and how much it is in SI.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Unit {
    pub(crate) text: String,
    pub(crate) si: f64,
}

impl Unit {
    /// That of SI, which nothing states.
    pub(crate) fn none() -> Self {
        Self { text: String::new(), si: 1.0 }
    }

    /// The unit in a text that holds nothing else.
    pub(crate) fn of(text: &str, dimension: Dimension) -> Result<Self, UnitProblem> {
        let is_inch_mark = text.contains('"');
        let text = text.trim_matches(|c| is_between(c) || MARKS.contains(&c));
        let plain = plain(text);
        let mut readings = dimension.readings(&plain);
        if readings.is_empty() {
            readings = dimension.readings(plain.strip_prefix("in ").unwrap_or_default());
        }
        match readings.as_slice() {
            _ if plain.is_empty() && !is_inch_mark => Ok(Self::none()),
            // Capitals do not tell a megagram from a milligram.
            _ if text.contains("MG") => Err(UnitProblem::Unknown { allowed: dimension.known() }),
            [] => Err(UnitProblem::Unknown { allowed: dimension.known() }),
            [(_, si)] => Ok(Self { text: text.to_owned(), si: *si }),
            [(first, _), (second, _), ..] => {
                Err(UnitProblem::Ambiguous { first: first.clone(), second: second.clone() })
            }
        }
    }
}

/// The unit of some columns that are in one: of those that state none too.
#[derive(Clone, Debug, Default)]
pub(crate) struct SharedUnit {
    /// The heading of the first column.
    first: Option<String>,
    stated: Option<Stated>,
}

/// What the first column says that states a unit.
#[derive(Clone, Debug)]
struct Stated {
    name: &'static str,
    heading: String,
    unit: Unit,
}

impl SharedUnit {
    /// With what the column of a number states; why not, if another states another.
    pub(crate) fn with(
        &mut self,
        name: &'static str,
        heading: &str,
        unit: Unit,
    ) -> Result<(), String> {
        self.first.get_or_insert_with(|| shortened(heading));
        if unit.text.is_empty() {
            return Ok(());
        }
        let stated = || Stated { name, heading: shortened(heading), unit: unit.clone() };
        let first = self.stated.get_or_insert_with(stated);
        if first.unit.si == unit.si {
            return Ok(());
        }
        let (known, first, stated) = (&first.unit.text, first.name, unit.text);
        Err(format!("{first} is in {known} but {name} in {stated}: one unit for all"))
    }

    pub(crate) fn si(&self) -> f64 {
        self.stated.as_ref().map_or(1.0, |stated| stated.unit.si)
    }

    /// Whether there are columns, and none states a unit.
    pub(crate) fn is_lacking(&self) -> bool {
        self.first.is_some() && self.stated.is_none()
    }

    /// The headings of a column that states no unit, nor any other that is in one with it, and of one that states another than that of SI, if
    /// there are both: nobody knows then whether the first is in SI.
    pub(crate) fn lacking(all: &[&Self]) -> Option<(String, String)> {
        let is_other = |stated: &&Stated| stated.unit.si != 1.0;
        let other = all.iter().find_map(|one| one.stated.as_ref().filter(is_other))?;
        let lacking = all.iter().filter(|one| one.stated.is_none());
        let heading = lacking.filter_map(|one| one.first.clone()).next()?;
        Some((heading, other.heading.clone()))
    }
}

impl Dimension {
    /// Every unit that a text without marks may be, and what it is in SI. A blank counts: it ends a word.
    fn readings(self, plain: &str) -> Vec<(String, f64)> {
        let masses = || MASSES.iter().map(|(name, kg)| (*name, *kg));
        let lengths = || LENGTHS.iter().map(|(name, m2)| (*name, *m2));
        let whole = |(name, _): &(&str, f64)| *name == plain;
        let products = |power: &'static str| {
            masses().flat_map(move |mass| lengths().map(move |length| (mass, length))).filter(
                move |((mass, _), (length, _))| {
                    let rest = plain.strip_prefix(mass).map(str::trim_start);
                    let rest = rest.and_then(|rest| rest.strip_prefix(length));
                    rest.is_some_and(|rest| rest.trim_start() == power)
                },
            )
        };
        match self {
            Self::Mass => masses().filter(whole).map(|(name, kg)| (name.to_owned(), kg)).collect(),
            Self::Length => {
                lengths().filter(whole).map(|(name, m2)| (name.to_owned(), m2.sqrt())).collect()
            }
            Self::FirstMoment => products("")
                .map(|((mass, kg), (length, m2))| (format!("{mass}·{length}"), kg * m2.sqrt()))
                .collect(),
            Self::Inertia => products("2")
                .map(|((mass, kg), (length, m2))| (format!("{mass}·{length}²"), kg * m2))
                .collect(),
        }
    }

    /// The units that are known, as messages list them.
    fn known(self) -> String {
        let masses = || listed(MASSES.iter().map(|(name, _)| (*name).to_owned()));
        let lengths =
            |power: &str| listed(LENGTHS.iter().map(|(name, _)| format!("{name}{power}")));
        match self {
            Self::Mass => masses(),
            Self::Length => lengths(""),
            Self::FirstMoment => format!("{}, times {}", masses(), lengths("")),
            Self::Inertia => format!("{}, times {}", masses(), lengths("²")),
        }
    }
}

/// Some words in a sentence: `kg, g or t`.
fn listed(names: impl Iterator<Item = String>) -> String {
    let names: Vec<String> = names.collect();
    match names.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => names.concat(),
    }
}

/// What stands in a heading after the name of a number.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tail<'a>(&'a str);

/// The longest name at the beginning of a heading that is known, and what stands after it.
pub(crate) fn longest_name<T>(
    heading: &str,
    known: impl Fn(&str) -> Option<T>,
) -> Option<(T, Tail<'_>)> {
    let ends = heading.char_indices().rev().map(|(at, c)| at + c.len_utf8());
    let mut parts = ends.map(|at| heading.split_at(at));
    parts.find_map(|(name, rest)| {
        let found = name.ends_with(char::is_alphanumeric).then(|| known(&squeezed(name)))??;
        // What ends a quotation is no mark of an inch.
        let is_quoted = name.matches('"').count() % 2 == 1;
        Some((found, Tail(rest.strip_prefix('"').filter(|_| is_quoted).unwrap_or(rest))))
    })
}

/// What marks that a unit follows.
const MARKS: [char; 8] = ['[', '(', '{', '/', ',', ':', ';', '='];

impl<'a> Tail<'a> {
    /// As it is written.
    pub(crate) fn text(self) -> &'a str {
        self.0
    }

    /// Whether the name ends here, and is not the beginning of a longer word.
    pub(crate) fn is_apart(self) -> bool {
        !self.0.starts_with(char::is_alphanumeric)
    }

    /// The unit, or why it is none. Nothing where the name is only the beginning of a word, as in `massive`.
    pub(crate) fn unit(self, dimension: Dimension) -> Option<Result<Unit, BadUnit>> {
        let bad = |problem| {
            let rest = self.0.trim_start_matches(|c| is_between(c) && !MARKS.contains(&c));
            let is_certain =
                rest.starts_with(MARKS) || matches!(problem, UnitProblem::Ambiguous { .. });
            let mut text = self.0.trim_matches(|c| is_between(c) || MARKS.contains(&c));
            // Only the mark of an inch is nothing but marks.
            let is_certain = is_certain || text.is_empty();
            if text.is_empty() {
                text = "\"";
            }
            let text = text.to_owned();
            (is_certain || self.is_apart()).then_some(BadUnit { text, problem, is_certain })
        };
        match Unit::of(self.0, dimension) {
            Ok(unit) => Some(Ok(unit)),
            Err(problem) => bad(problem).map(Err),
        }
    }
}

/// What stands after the name of a number and is no unit that is read.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BadUnit {
    pub(crate) text: String,
    pub(crate) problem: UnitProblem,
    /// Whether it must be meant as a unit, because it stands in brackets, say. Else it may be words that make
    /// another column of it: `mass_source`.
    pub(crate) is_certain: bool,
}

impl BadUnit {
    /// The same with the column that it stands in, and what messages call the number.
    pub(crate) fn of(self, heading: &str, field: &'static str) -> UnitError {
        let (heading, unit) = (shortened(heading), shortened(&self.text));
        UnitError { heading, field, unit, problem: self.problem }
    }
}

/// A column of a number whose unit is not read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("column {heading:?}: {field} is in {unit:?}: {problem}")]
pub struct UnitError {
    heading: String,
    field: &'static str,
    unit: String,
    problem: UnitProblem,
}

impl UnitError {
    /// The heading of the column, shortened.
    #[must_use]
    pub fn heading(&self) -> &str {
        &self.heading
    }

    /// The number.
    #[must_use]
    pub fn field(&self) -> &'static str {
        self.field
    }

    /// What stands in the place of a unit, shortened.
    #[must_use]
    pub fn unit(&self) -> &str {
        &self.unit
    }

    /// What is wrong with it.
    #[must_use]
    pub fn problem(&self) -> &UnitProblem {
        &self.problem
    }
}

/// Why a unit is not read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum UnitProblem {
    /// None that is known.
    #[error("it must be in {allowed}")]
    Unknown {
        /// The units that are known.
        allowed: String,
    },
    /// Written without a separator, it may be two.
    #[error("this may be {first} or {second}, and a separator must say which, as it does here")]
    Ambiguous {
        /// One of them.
        first: String,
        /// The other.
        second: String,
    },
    /// With a minus or a plus before it.
    #[error(
        "it must not have a sign: a line \"# products = integrals\" above the header, or a column products, says \
         which sign products have"
    )]
    Sign,
}

/// What may stand between the letters of a name, and between the parts of a unit.
fn is_between(c: char) -> bool {
    c.is_whitespace() || "_-*·⋅×^.()[]{}\"".contains(c)
}

/// A name without what may stand between its letters: `I_xx` becomes `ixx`.
pub(crate) fn squeezed(text: &str) -> String {
    text.to_lowercase().chars().filter(|c| !is_between(*c)).collect()
}

/// A unit in small letters, with a blank for whatever stands between its parts: `kg·m²` becomes `kg m2`.
fn plain(text: &str) -> String {
    // A capital M is a million: Mg is a tonne, and no milligram.
    let text = text.replace("Mg", "t").to_lowercase().replace('²', "2");
    let parts = text.split(is_between).filter(|part| !part.is_empty());
    parts.collect::<Vec<_>>().join(" ")
}
