//! Headings of the ten numbers: mass, mass centre or first moments, and inertia.

use crate::{
    body::{entry_of, lower_of},
    heading_sign::without_sign,
    parts::heading::{Group, VALUES, group, is_spread},
    spread,
    units::{BadUnit, Dimension, Unit, longest_name},
};

/// What a table has beside mass and inertia.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TenCentre {
    /// The mass centre, m.
    MassCentre,
    /// The first moments m c, kg·m.
    FirstMoments,
}

/// What a column holds.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TenHeading {
    /// Which of the ten.
    pub(crate) place: usize,
    /// Of which kind the second to the fourth are.
    pub(crate) centre: Option<TenCentre>,
    pub(crate) unit: Result<Unit, BadUnit>,
}

impl TenHeading {
    /// Nothing if a heading is of none of the ten, or of how uncertain one is. A sign is left out, for whoever reads
    /// the column to refuse.
    pub(crate) fn of(text: &str) -> Option<Self> {
        // Longer texts are none, and would be searched for names for long.
        if text.len() > 200 || spread::is_marked(text) || is_spread(text) {
            return None;
        }
        let unsigned = without_sign(text);
        let text = unsigned.as_deref().unwrap_or(text);
        let ((place, centre, is_letter), tail) = longest_name(text, known)?;
        let unit = tail.unit(Self::dimension(place, centre))?;
        // A letter that a word begins with is not the mass.
        let is_word = match &unit {
            Ok(_) => tail.text().starts_with(char::is_alphabetic),
            Err(bad) => !bad.is_certain,
        };
        (!(is_letter && is_word)).then_some(Self { place, centre, unit })
    }

    /// What messages call it.
    pub(crate) fn field(&self) -> &'static str {
        field(self.place, self.centre)
    }

    /// What one of the ten is measured in.
    fn dimension(place: usize, centre: Option<TenCentre>) -> Dimension {
        match (place, centre) {
            (_, Some(centre)) => centre.dimension(),
            (0, None) => Dimension::Mass,
            (_, None) => Dimension::Inertia,
        }
    }
}

impl TenCentre {
    /// What messages call the three.
    pub(crate) fn fields(self) -> [&'static str; 3] {
        match self {
            Self::MassCentre => [VALUES[1], VALUES[2], VALUES[3]],
            Self::FirstMoments => ["first_moment_1", "first_moment_2", "first_moment_3"],
        }
    }

    /// What the ten are called with it.
    pub(crate) fn parameters(self) -> &'static str {
        match self {
            Self::MassCentre => "natural",
            Self::FirstMoments => "linear",
        }
    }

    pub(crate) fn dimension(self) -> Dimension {
        match self {
            Self::MassCentre => Dimension::Length,
            Self::FirstMoments => Dimension::FirstMoment,
        }
    }
}

/// What messages call one of the ten, with a centre of a kind.
pub(crate) fn field(place: usize, centre: Option<TenCentre>) -> &'static str {
    match centre {
        Some(centre) if (1..=3).contains(&place) => centre.fields()[place - 1],
        Some(_) | None => VALUES[place],
    }
}

/// The place of a name, what kind of centre it is of, and whether it is but a letter.
fn known(name: &str) -> Option<(usize, Option<TenCentre>, bool)> {
    if name == "mass" || name == "m" {
        return Some((0, None, name == "m"));
    }
    if let Some(axis) = ["firstmoment", "mc", "h"].iter().find_map(|word| name.strip_prefix(word)) {
        let place = match axis {
            "x" | "1" => 1,
            "y" | "2" => 2,
            "z" | "3" => 3,
            _ => return None,
        };
        return Some((place, Some(TenCentre::FirstMoments), false));
    }
    // The tensor is symmetric.
    if let Some(entry) = entry_of(name).or_else(|| lower_of(name).map(|product| 3 + product)) {
        return Some((4 + entry, None, false));
    }
    match group(name)? {
        Group(place @ 1..=3, 1) => Some((place, Some(TenCentre::MassCentre), false)),
        Group(..) => None,
    }
}
