//! A body as a file gives it, and its entries.

use nalgebra::Matrix3;

use crate::FileBodyError;

/// Names of the six entries, in the order of [`ENTRIES`].
pub(crate) const NAMES: [&str; 6] = ["ixx", "iyy", "izz", "ixy", "ixz", "iyz"];

/// Row and column of the six entries.
pub(crate) const ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

/// Which of the six a name means.
pub(crate) fn entry_of(name: &str) -> Option<usize> {
    let plain = match name {
        "i11" => "ixx",
        "i22" => "iyy",
        "i33" => "izz",
        "i12" => "ixy",
        "i13" => "ixz",
        "i23" => "iyz",
        other => other,
    };
    NAMES.iter().position(|known| *known == plain)
}

/// The names of the products below the diagonal, in the order of those above it.
pub(crate) const LOWER: [[&str; 2]; 3] = [["iyx", "i21"], ["izx", "i31"], ["izy", "i32"]];

/// Which of them a name means.
pub(crate) fn lower_of(name: &str) -> Option<usize> {
    LOWER.iter().position(|names| names.contains(&name))
}

/// What the products of inertia in a file are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Products {
    /// Entries of the inertia matrix: I₁₂ = −∫ x₁x₂ dm.
    #[default]
    TensorEntries,
    /// Positive integrals, as some CAD programs print them: ∫ x₁x₂ dm.
    Integrals,
}

impl Products {
    pub(crate) fn sign(self) -> f64 {
        match self {
            Self::TensorEntries => 1.0,
            Self::Integrals => -1.0,
        }
    }

    /// How files spell it.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::TensorEntries => "tensor",
            Self::Integrals => "integrals",
        }
    }

    /// What the cell of a table says; nothing if it is blank.
    pub(crate) fn of_cell(text: &str) -> Result<Option<Self>, FileBodyError> {
        match text.trim().to_lowercase().as_str() {
            "" => Ok(None),
            "-" => Ok(Some(Self::TensorEntries)),
            "+" => Ok(Some(Self::Integrals)),
            word => Self::parse(word).map(Some).ok_or_else(|| FileBodyError::Word {
                field: "products",
                value: shortened(word),
                allowed: "tensor, integrals, - or +",
            }),
        }
    }

    /// What a word of a file means.
    pub(crate) fn parse(word: &str) -> Option<Self> {
        [Self::TensorEntries, Self::Integrals].into_iter().find(|one| one.name() == word)
    }
}

/// Where a number stands in the text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    pub(crate) start: usize,
    pub(crate) end: usize,
}

/// A finite number and where it stands, unless it stands nowhere, like a default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Number {
    pub(crate) value: f64,
    pub(crate) place: Option<Place>,
}

impl Number {
    pub(crate) fn default_of(value: f64) -> Self {
        Self { value, place: None }
    }

    /// Reads a number with blanks around it; `start` is where `raw` stands in the text.
    pub(crate) fn parse(
        field: &'static str,
        raw: &str,
        start: Option<usize>,
    ) -> Result<Self, FileBodyError> {
        let trimmed = raw.trim_start();
        let skipped = raw.len() - trimmed.len();
        let digits = trimmed.trim_end();
        match digits.parse::<f64>() {
            Ok(value) if value.is_finite() => {
                let place = start.map(|start| {
                    let start = start + skipped;
                    Place { start, end: start + digits.len() }
                });
                Ok(Self { value, place })
            }
            Ok(_) => Err(FileBodyError::NotFinite { field, value: shortened(digits) }),
            Err(_) if is_expression(digits) => {
                Err(FileBodyError::Expression { field, value: shortened(digits) })
            }
            Err(_) => Err(FileBodyError::NotANumber { field, value: shortened(digits) }),
        }
    }

    /// Reads exactly `allowed` numbers with blanks between them.
    pub(crate) fn parse_list(
        field: &'static str,
        raw: &str,
        start: Option<usize>,
        allowed: usize,
    ) -> Result<Vec<Self>, FileBodyError> {
        let found = raw.split_ascii_whitespace().count();
        if found != allowed {
            if is_expression(raw) {
                return Err(FileBodyError::Expression { field, value: shortened(raw) });
            }
            return Err(FileBodyError::Count { field, found, allowed });
        }
        let origin = raw.as_ptr() as usize;
        raw.split_ascii_whitespace()
            .map(|word| {
                Self::parse(field, word, start.map(|at| at + (word.as_ptr() as usize - origin)))
            })
            .collect()
    }
}

/// Whether xacro would make something else of a text.
fn is_expression(text: &str) -> bool {
    text.contains("${") || text.contains("$(")
}

/// At most 40 characters of what a file holds, for a message.
pub(crate) fn shortened(text: &str) -> String {
    let mut short: String = text.chars().take(40).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short
}

/// What a file says of one body.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Reading {
    pub(crate) mass_kg: Option<f64>,
    /// Where the mass stands.
    pub(crate) mass_place: Option<Place>,
    /// kg·m², products as tensor entries.
    pub(crate) matrix: Matrix3<f64>,
    /// kg·m² of one unit of the file.
    pub(crate) unit: f64,
    /// Where the entries stand, row by row.
    pub(crate) places: [[Option<Place>; 3]; 3],
    pub(crate) products: Products,
}

impl Reading {
    /// Of six entries in the order of [`ENTRIES`], as the file has them.
    pub(crate) fn of_six(mass: Option<Number>, six: &[Number; 6], products: Products) -> Self {
        let mut nine = [[Number::default(); 3]; 3];
        for (number, (i, j)) in six.iter().zip(ENTRIES) {
            nine[i][j] = *number;
            nine[j][i] = *number;
        }
        Self::of_nine(mass, &nine, products)
    }

    /// Of a full matrix, row by row, as the file has it.
    pub(crate) fn of_nine(
        mass: Option<Number>,
        nine: &[[Number; 3]; 3],
        products: Products,
    ) -> Self {
        let matrix = Matrix3::from_fn(|i, j| {
            let value = nine[i][j].value;
            if i == j { value } else { products.sign() * value }
        });
        Self {
            mass_kg: mass.map(|m| m.value),
            mass_place: mass.and_then(|m| m.place),
            matrix,
            unit: 1.0,
            places: nine.map(|row| row.map(|number| number.place)),
            products,
        }
    }

    /// The same numbers in other units than kg and kg·m².
    pub(crate) fn in_units(self, mass: f64, inertia: f64) -> Self {
        Self {
            mass_kg: self.mass_kg.map(|m| m * mass),
            matrix: self.matrix * inertia,
            unit: inertia,
            ..self
        }
    }
}

/// One body of a file: its name, where it stands, and its inertia, if that could be read.
#[derive(Clone, Debug, PartialEq)]
pub struct FileBody {
    name: String,
    line: usize,
    reading: Result<Reading, FileBodyError>,
    summary: Option<String>,
}

impl FileBody {
    pub(crate) fn new(name: String, line: usize, reading: Result<Reading, FileBodyError>) -> Self {
        Self { name, line, reading, summary: None }
    }

    /// The same, of a row in which one cell may say that it sums up others.
    pub(crate) fn summing_up(mut self, cell: Option<&str>) -> Self {
        self.summary = cell.map(str::to_owned);
        self
    }

    /// The cell that says that a row of a table sums up others, as `Total` does, if one says so: it may be a body, and is no
    /// sample or part beside them.
    #[must_use]
    pub fn summary(&self) -> Option<&str> {
        self.summary.as_deref()
    }

    /// Name of the link, body or row; empty if the file gives none.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Line of the inertia in the file, from 1.
    #[must_use]
    pub fn line(&self) -> usize {
        self.line
    }

    /// Mass, if the file gives one, in kg.
    #[must_use]
    pub fn mass_kg(&self) -> Option<f64> {
        self.reading.as_ref().ok()?.mass_kg
    }

    /// The inertia about the mass centre, in kg·m², with products as tensor entries, whatever the file's
    /// units and convention.
    ///
    /// # Errors
    /// It could not be read.
    pub fn inertia(&self) -> Result<&Matrix3<f64>, FileBodyError> {
        self.reading.as_ref().map(|reading| &reading.matrix).map_err(Clone::clone)
    }

    pub(crate) fn reading(&self) -> Option<&Reading> {
        self.reading.as_ref().ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_know_their_place() {
        let number = Number::parse("ixx", " \t1.5e-3\n", Some(10)).unwrap();
        assert_eq!(number.value, 1.5e-3);
        assert_eq!(number.place, Some(Place { start: 12, end: 18 }));
        let list = Number::parse_list("diaginertia", " 1  2 3", Some(100), 3).unwrap();
        assert_eq!(list[1].place, Some(Place { start: 104, end: 105 }));
    }

    #[test]
    fn what_is_no_number_is_named() {
        let error = |raw| Number::parse("ixx", raw, None).unwrap_err().to_string();
        assert_eq!(
            error("1,5"),
            "ixx = \"1,5\" is not a number: decimal commas are not read, and neither are commas between thousands: a point must stand before decimals, and nothing between other digits"
        );
        assert_eq!(error(""), "ixx = \"\" is not a number");
        assert!(error("${m * r}").contains("xacro"));
        for raw in ["nan", "-inf", "1e999"] {
            assert!(error(raw).contains("must be finite"), "{raw}");
        }
        assert!(error(&"é".repeat(1000)).len() < 150);
        let error = Number::parse_list("diaginertia", "1 2", None, 3).unwrap_err();
        assert_eq!(error.to_string(), "diaginertia has 2 values: there must be 3");
    }

    #[test]
    fn integrals_become_tensor_entries() {
        let six = [1.0, 2.0, 3.0, 0.1, 0.2, 0.3].map(Number::default_of);
        let tensor = Reading::of_six(None, &six, Products::TensorEntries).matrix;
        let flipped = Reading::of_six(None, &six, Products::Integrals).matrix;
        assert_eq!((tensor[(0, 1)], tensor[(2, 0)], tensor[(1, 2)]), (0.1, 0.2, 0.3));
        assert_eq!((flipped[(1, 0)], flipped[(0, 2)], flipped[(2, 1)]), (-0.1, -0.2, -0.3));
        assert_eq!(flipped.diagonal(), tensor.diagonal());
    }
}
