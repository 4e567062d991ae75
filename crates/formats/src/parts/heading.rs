//! What the columns of a list of parts hold.

use gyradius_inertia::Shape;

use super::unread_kinds::Unread;
use crate::{
    body::{entry_of, lower_of},
    heading_sign::without_sign,
    product_heading::is_unread_product,
    spread,
    units::{BadUnit, Dimension, Unit, longest_name, squeezed},
};

/// The ten numbers, as messages call them.
pub(crate) const VALUES: [&str; 10] =
    ["mass", "centre_x", "centre_y", "centre_z", "ixx", "iyy", "izz", "ixy", "ixz", "iyz"];

/// The radii of gyration, as messages call them.
pub(super) const GYRATION: [&str; 3] = ["kx", "ky", "kz"];

/// Their standard deviations, and those of three at once, as messages call them: absolute, and in percent.
const DEVIATIONS: [(Group, &str, &str); 13] = [
    (Group(0, 1), "sigma_mass", "mass_percent"),
    (Group(1, 1), "sigma_centre_x", "centre_x_percent"),
    (Group(2, 1), "sigma_centre_y", "centre_y_percent"),
    (Group(3, 1), "sigma_centre_z", "centre_z_percent"),
    (Group(4, 1), "sigma_ixx", "ixx_percent"),
    (Group(5, 1), "sigma_iyy", "iyy_percent"),
    (Group(6, 1), "sigma_izz", "izz_percent"),
    (Group(7, 1), "sigma_ixy", "ixy_percent"),
    (Group(8, 1), "sigma_ixz", "ixz_percent"),
    (Group(9, 1), "sigma_iyz", "iyz_percent"),
    (Group(1, 3), "sigma_centre", "centre_percent"),
    (Group(4, 3), "sigma_moments", "moments_percent"),
    (Group(7, 3), "sigma_products", "products_percent"),
];

/// What messages call the standard deviation of some of the ten.
pub(super) fn deviation(group: Group, scale: Scale) -> &'static str {
    let found = DEVIATIONS.iter().find(|(known, ..)| *known == group);
    found.map_or("standard deviation", |(_, absolute, percent)| match scale {
        Scale::Unit(_) => absolute,
        Scale::Percent => percent,
    })
}

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Column {
    Name,
    Parent,
    /// Products are entries of the tensor, or integrals.
    Products,
    Point,
    Shape,
    Follows,
    /// A component of the quaternion, scalar last.
    Attitude(usize),
    /// One of the ten, and its unit in SI, if one is stated.
    Value(usize, Option<f64>),
    /// A product below the diagonal, from 0, and its unit in SI, if one is stated.
    Below(usize, Option<f64>),
    /// The radius of gyration about an axis, and its unit in SI, if one is stated.
    Gyration(usize, Option<f64>),
    /// The standard deviation of some of the ten.
    Deviation(Group, Scale),
}

/// Some of the ten: from, and how many.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Group(pub(crate) usize, pub(crate) usize);

/// What a standard deviation is in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Scale {
    /// In a unit that is so much in SI, if one is stated.
    Unit(Option<f64>),
    /// In percent of the value.
    Percent,
}

/// What a heading means.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Heading {
    Column(Column),
    /// A size of a shape, by its name, and its unit in SI, if one is stated.
    Size(&'static str, Option<f64>),
    /// A size of a shape, by its name, and what follows and is no unit that is read.
    SizeUnit(&'static str, BadUnit),
    /// A number of the ten or a standard deviation, as messages call it, and what follows and is no unit that is read.
    Unit(&'static str, BadUnit),
    /// It looks like a product of inertia, and its name does not tell its sign.
    Product,
    /// A number of the ten or a standard deviation, with a sign in the heading.
    Signed,
    /// It looks like a standard deviation, and is none.
    NoDeviation,
    /// It looks like a standard deviation of a size of a shape, which has none.
    SizeDeviation,
    /// It may hold something that would change the numbers of the row, and that is not read.
    Unread(Unread),
    Other,
}

impl Column {
    /// What a number is in, and its unit in SI, if one is stated. A percentage and a word have none.
    fn unit(&mut self) -> Option<(Dimension, &mut Option<f64>)> {
        match self {
            Self::Value(i, unit) => Some((Group(*i, 1).dimension(), unit)),
            Self::Below(_, unit) => Some((Dimension::Inertia, unit)),
            Self::Gyration(_, unit) => Some((Dimension::Length, unit)),
            Self::Deviation(group, Scale::Unit(unit)) => Some((group.dimension(), unit)),
            Self::Deviation(_, Scale::Percent)
            | Self::Name
            | Self::Parent
            | Self::Products
            | Self::Point
            | Self::Shape
            | Self::Follows
            | Self::Attitude(_) => None,
        }
    }

    /// With the unit that a column has where it states none.
    fn stated(mut self) -> Self {
        if let Some((_, unit)) = self.unit() {
            unit.get_or_insert(1.0);
        }
        self
    }
}

impl Group {
    fn dimension(self) -> Dimension {
        match self.0 {
            0 => Dimension::Mass,
            1..=3 => Dimension::Length,
            _ => Dimension::Inertia,
        }
    }
}

impl Heading {
    /// Whether its cells are numbers.
    pub(super) fn is_number(&self) -> bool {
        let is_attitude = matches!(self, Self::Column(Column::Attitude(_)));
        is_attitude || self.is_percent() || self.dimension().is_some()
    }

    pub(super) fn is_percent(&self) -> bool {
        matches!(self, Self::Column(Column::Deviation(_, Scale::Percent)))
    }

    /// What a column of numbers is in, and its unit in SI, if one is stated.
    pub(super) fn dimension(&self) -> Option<(Dimension, Option<f64>)> {
        match *self {
            Self::Column(mut column) => column.unit().map(|(dimension, unit)| (dimension, *unit)),
            Self::Size(_, unit) => Some((Dimension::Length, unit)),
            _ => None,
        }
    }

    /// Whether two columns hold the same, in the same unit.
    pub(crate) fn says_the_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Column(one), Self::Column(other)) => one.stated() == other.stated(),
            (Self::Size(one, _), Self::Size(other, _)) => one == other,
            _ => self == other,
        }
    }

    /// The first among some columns of numbers in a unit that is not of SI, if this one is a number that states no unit: nobody knows
    /// then whether it is in SI. Columns of other kinds count, too: beside lb and in, an inertia may be in lb·in².
    pub(crate) fn unit_it_lacks(&self, beside: &[Self]) -> Option<usize> {
        let (_, None) = self.dimension()? else { return None };
        let is_in_other = |other: &Self| {
            let stated = other.dimension().and_then(|(_, unit)| unit);
            stated.is_some_and(|si| si != 1.0)
        };
        beside.iter().position(is_in_other)
    }

    /// Why the unit of a column is not read, if it is a number's. Beside a column of the number, its name with other
    /// words is another column.
    pub(crate) fn bad_unit(&self, beside: &[Self]) -> Option<(&'static str, &BadUnit)> {
        let (field, bad) = match self {
            Self::Unit(field, bad) => (field, bad),
            Self::SizeUnit(field, bad) => return Some((field, bad)),
            _ => return None,
        };
        let is_held = beside.iter().any(
            |other| matches!(other, Self::Column(Column::Value(i, _)) if VALUES[*i] == *field),
        );
        (bad.is_certain || !is_held).then_some((*field, bad))
    }

    /// Whether it must be a product, and one of the three is not in a column that is read.
    pub(crate) fn is_lost_product(&self, beside: &[Self]) -> bool {
        *self == Self::Product && !Self::are_products_read(beside)
    }

    /// Whether the three products above the diagonal are in columns that are read.
    fn are_products_read(columns: &[Self]) -> bool {
        let is_read = |product: usize| {
            let holds =
                |other: &Self| matches!(other, Self::Column(Column::Value(i, _)) if *i == product);
            columns.iter().any(holds)
        };
        (7..10).all(is_read)
    }

    /// With products below the diagonal in place of those above it that no column holds: the tensor is symmetric. Where one of the three is in
    /// neither half, those below are not read.
    pub(super) fn with_one_half(columns: Vec<Self>) -> Vec<Self> {
        let holds = |wanted: usize| {
            columns
                .iter()
                .any(|other| matches!(other, Self::Column(Column::Value(i, _)) if *i == wanted))
        };
        let above = |column: &Self| match *column {
            Self::Column(Column::Below(product, unit)) if !holds(7 + product) => {
                Self::Column(Column::Value(7 + product, unit))
            }
            ref other => other.clone(),
        };
        let whole: Vec<Self> = columns.iter().map(above).collect();
        if Self::are_products_read(&whole) {
            whole
        } else {
            columns.into_iter().map(Self::without_products).collect()
        }
    }

    /// What it means beside no products above the diagonal.
    fn without_products(self) -> Self {
        match self {
            Self::Column(Column::Below(..)) => Self::Product,
            other => other,
        }
    }

    pub(crate) fn of(text: &str) -> Self {
        // Longer texts are none.
        if text.len() > 200 {
            return Self::Other;
        }
        if let Some(found) = without_sign(text).and_then(|plain| quantity(&plain)) {
            return match found {
                Self::Column(_) if spread::has_typed_mark(text) => Self::NoDeviation,
                Self::Column(_) => Self::Signed,
                other => other,
            };
        }
        let found = word(&squeezed(text)).map(Self::Column).or_else(|| quantity(text));
        if let Some(Self::Column(column)) = found {
            return Self::Column(column);
        }
        if let Some(radius) = gyration(text) {
            return radius;
        }
        if let Some(unread) = Unread::of(text) {
            return Self::Unread(unread);
        }
        if let Some(found) = found {
            return found;
        }
        let is_deviation = spread::is_marked(text) || spread::has_typed_mark(text);
        if is_deviation || is_spread(text) || spread::is_alone(text) {
            Self::NoDeviation
        } else if is_unread_product(text) {
            Self::Product
        } else if names_size(text) && spread::has_word(text) {
            Self::SizeDeviation
        } else {
            size(text).unwrap_or(Self::Other)
        }
    }

    /// What it means in a table without shapes.
    pub(crate) fn without_shapes(self) -> Self {
        match self {
            Self::Size(..) | Self::SizeUnit(..) | Self::SizeDeviation => Self::Other,
            other => other,
        }
    }
}

/// Whether a heading speaks of how uncertain one of the ten numbers is, as `mass_std`, `I_xx sd`, `massSD` and `dmass`.
pub(crate) fn is_spread(text: &str) -> bool {
    let (small, parted) = (text.to_lowercase(), spread::parted(text));
    let words: Vec<&str> = spread::words(&parted).collect();
    let is_number = |words: &[&str]| group(&words.concat()).is_some();
    const INERTIAS: [&str; 7] = ["inertia", "inertias", "moi", "mois", "poi", "pois", "tensor"];
    let names_number = words.chunks(1).any(is_number)
        || words.windows(2).any(is_number)
        || words.iter().any(|word| INERTIAS.contains(word));
    // A letter beside it is no number: `varx` may be anything.
    let is_name = |name: &str| name.len() > 1 && group(name).is_some();
    let is_one_word = || spread::words(&small).flat_map(spread::beside_word).any(is_name);
    // Behind it they are limits, and before it, or behind a product, signs.
    let is_limit = match words.split_last() {
        Some((&("plus" | "minus"), name)) => group(&name.concat()).is_some_and(|group| group.0 < 7),
        _ => false,
    };
    (spread::has_word(text) && names_number) || is_limit || is_one_word() || is_difference(&small)
}

/// Whether a heading has the name of a size of a shape, and other words beside it.
fn names_size(text: &str) -> bool {
    let parted = spread::parted(text);
    let words: Vec<&str> = spread::words(&parted).filter(|word| !word.is_empty()).collect();
    let is_size = |words: &[&str]| known_size(&words.concat()).is_some();
    (1..=3).any(|count| words.windows(count).any(is_size))
}

/// Whether it is, in small letters, the name of one of the ten after what stands for a difference or an uncertainty:
/// `dmass`, `δmass`, `u(mass)`.
fn is_difference(text: &str) -> bool {
    const MARKS: [&str; 5] = ["delta", "d", "δ", "∆", "u"];
    // Without these, `m` may be the metre of a unit: `dm`, `um`.
    const OF_LETTER: [&str; 2] = ["δm", "∆m"];
    let begins = |c: char| c.is_alphabetic() || c == '∆';
    if !MARKS.iter().any(|mark| text.trim_start_matches(|c| !begins(c)).starts_with(mark)) {
        return false;
    }
    let of = |name: &str| {
        if OF_LETTER.contains(&name) {
            return Some(Group(0, 1));
        }
        let rests = MARKS.iter().filter_map(|mark| name.strip_prefix(mark));
        rests.filter_map(group).find(|group| group.1 == 1)
    };
    let Some((group, tail)) = longest_name(text, of) else { return false };
    match tail.unit(group.dimension()) {
        Some(Ok(_)) => true,
        Some(Err(bad)) => bad.is_certain,
        None => false,
    }
}

fn word(plain: &str) -> Option<Column> {
    match plain {
        "name" | "id" | "part" | "body" | "link" | "component" => Some(Column::Name),
        "parent" => Some(Column::Parent),
        "products" | "poiconv" => Some(Column::Products),
        "ipoint" | "point" => Some(Column::Point),
        "shape" => Some(Column::Shape),
        "inertiafollowsmass" => Some(Column::Follows),
        "attitudex" | "qx" | "quatx" | "quaternionx" => Some(Column::Attitude(0)),
        "attitudey" | "qy" | "quaty" | "quaterniony" => Some(Column::Attitude(1)),
        "attitudez" | "qz" | "quatz" | "quaternionz" => Some(Column::Attitude(2)),
        "attitudew" | "qw" | "quatw" | "quaternionw" => Some(Column::Attitude(3)),
        _ => None,
    }
}

/// Whether a heading may be that of the names, in a list where no other is: its rank, of which the lowest counts wherever the column stands.
pub(super) fn rank_as_name(text: &str) -> Option<usize> {
    let known =
        ["partname", "itemname", "componentname", "bodyname", "item", "element", "description"];
    let plain = squeezed(text);
    known.iter().position(|word| *word == plain)
}

/// A product below the diagonal, if its unit is read: `Iyx [kg m2]`.
fn below(text: &str) -> Option<Heading> {
    let (product, tail) = longest_name(text, lower_of)?;
    let unit = tail.unit(Dimension::Inertia)?.ok()?;
    let stated = (!unit.text.is_empty()).then_some(unit.si);
    Some(Heading::Column(Column::Below(product, stated)))
}

/// A radius of gyration: `kx_m`, `Ky [in]`, `radius of gyration z`.
fn gyration(text: &str) -> Option<Heading> {
    let axis = |plain: &str| match plain {
        "x" | "xx" | "1" => Some(0),
        "y" | "yy" | "2" => Some(1),
        "z" | "zz" | "3" => Some(2),
        _ => None,
    };
    let known = |plain: &str| {
        let before = ["radiusofgyration", "gyrationradius", "gyradius", "rg", "k"];
        before.iter().find_map(|word| axis(plain.strip_prefix(word)?))
    };
    match length(text, known)? {
        (axis, Ok(unit)) => Some(Heading::Column(Column::Gyration(axis, unit))),
        (axis, Err(bad)) => Some(Heading::SizeUnit(GYRATION[axis], bad)),
    }
}

/// A length by its name: what it is, and its unit in SI, if one is stated, or what follows and is certain to be no unit.
fn length<T>(
    text: &str,
    known: impl Fn(&str) -> Option<T>,
) -> Option<(T, Result<Option<f64>, BadUnit>)> {
    let (found, tail) = longest_name(text, known)?;
    let unit = match tail.unit(Dimension::Length)? {
        Ok(unit) => Ok((!unit.text.is_empty()).then_some(unit.si)),
        Err(bad) if bad.is_certain => Err(bad),
        Err(_) => return None,
    };
    Some((found, unit))
}

/// A size of a shape: `radius_mm`, `Height [in]`.
fn size(text: &str) -> Option<Heading> {
    match length(text, known_size)? {
        (size, Ok(unit)) => Some(Heading::Size(size, unit)),
        (size, Err(bad)) => Some(Heading::SizeUnit(size, bad)),
    }
}

/// The size of a shape that is written so without its unit.
fn known_size(plain: &str) -> Option<&'static str> {
    let name = |size: &'static str| size.strip_suffix("_m").unwrap_or(size);
    Shape::SIZES.iter().copied().find(|size| squeezed(name(size)) == plain)
}

/// A number of the ten or its deviation: `mass_kg`, `sigma_ixx`, `mass_sigma_kg`, `moments_percent`.
fn quantity(text: &str) -> Option<Heading> {
    if let Some(found) = letter(text).or_else(|| below(text)) {
        return Some(found);
    }
    let ((group, is_deviation), tail) = longest_name(text, number)?;
    if ["percent", "%"].contains(&squeezed(tail.text()).as_str()) {
        return Some(Heading::Column(Column::Deviation(group, Scale::Percent)));
    }
    let stated = |unit: Unit| (!unit.text.is_empty()).then_some(unit.si);
    match (tail.unit(group.dimension())?, group) {
        (Ok(unit), _) if is_deviation => {
            Some(Heading::Column(Column::Deviation(group, Scale::Unit(stated(unit)))))
        }
        (Err(bad), _) if is_deviation => {
            Some(Heading::Unit(deviation(group, Scale::Unit(None)), bad))
        }
        (Ok(unit), Group(first, 1)) => Some(Heading::Column(Column::Value(first, stated(unit)))),
        // `mass product of inertia xy` is no mass.
        (Err(bad), Group(..7, 1))
            if !bad.is_certain && !is_spread(text) && is_unread_product(text) =>
        {
            Some(Heading::Product)
        }
        (Err(bad), Group(first, 1))
            if !spread::is_marked(text) && !spread::has_typed_mark(text) && !is_spread(text) =>
        {
            Some(Heading::Unit(VALUES[first], bad))
        }
        (Ok(_) | Err(_), Group(..)) => None,
    }
}

/// A mass by its letter alone, with a unit of mass or none: `m (kg)`. A letter that a word begins with is none.
fn letter(text: &str) -> Option<Heading> {
    let ((), tail) = longest_name(text, |name| (name == "m").then_some(()))?;
    let unit = tail.unit(Dimension::Mass)?.ok()?;
    let is_letter = !tail.text().starts_with(char::is_alphabetic);
    let stated = (!unit.text.is_empty()).then_some(unit.si);
    is_letter.then_some(Heading::Column(Column::Value(0, stated)))
}

/// A name of one of the ten, or of some of them, and whether it is of their deviation.
fn number(plain: &str) -> Option<(Group, bool)> {
    let before = plain.strip_prefix("sigma");
    let rest = before.unwrap_or(plain);
    let after = rest.strip_suffix("sigma");
    let group = group(after.unwrap_or(rest))?;
    Some((group, before.is_some() || after.is_some()))
}

pub(crate) fn group(name: &str) -> Option<Group> {
    let of = |plain: &str| match plain {
        "x" | "1" => Some(Group(1, 1)),
        "y" | "2" => Some(Group(2, 1)),
        "z" | "3" => Some(Group(3, 1)),
        "" => Some(Group(1, 3)),
        _ => None,
    };
    match name {
        "mass" => Some(Group(0, 1)),
        "moments" => Some(Group(4, 3)),
        "products" => Some(Group(7, 3)),
        "cx" | "cy" | "cz" => of(&name[1..]),
        _ => {
            let centre = ["masscentre", "centre", "masscenter", "center", "com", "cog", "cg"];
            let of_centre = centre.iter().find_map(|word| of(name.strip_prefix(word)?));
            // `X CG`, with the axis first.
            let after = ["com", "cog", "cg", "bar"];
            let of_axis = || match name.split_at_checked(1)? {
                (axis @ ("x" | "y" | "z"), word) if after.contains(&word) => of(axis),
                _ => None,
            };
            let of_centre = of_centre.or_else(of_axis);
            of_centre.or_else(|| entry_of(name).map(|entry| Group(4 + entry, 1)))
        }
    }
}

#[cfg(test)]
mod tests;
