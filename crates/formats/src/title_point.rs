//! The point that a title or a comment of a table says inertias are about, of which nothing is read.

use crate::{
    FileProblem,
    body::shortened,
    error::Refusal,
    rows::titles,
    spread::words,
    table_terms::{InertiaPoint, dimension_of},
    text::Text,
    title_words::without_dots,
    units::Dimension,
};

/// What stands between an inertia and its point, and what does with a `to` behind it.
const ABOUT: [&str; 2] = ["about", "wrt"];
const RELATIVE: [&str; 4] = ["relative", "respect", "referenced", "referred"];

/// The same, where anything else may follow: `at launch`.
const AT: [&str; 3] = ["at", "reference", "ref"];

/// Words between that and the point, words before that in a clause of their own, and words behind the point that speak of something else.
const BEFORE: [&str; 4] = ["to", "the", "a", "an"];
const TAKEN: [&str; 8] = ["taken", "given", "measured", "calculated", "is", "are", "all", "not"];
const BEHIND: [&str; 15] = [
    "in",
    "along",
    "parallel",
    "aligned",
    "with",
    "expressed",
    "resolved",
    "for",
    "using",
    "by",
    "from",
    "as",
    "and",
    "is",
    "are",
];

/// Words for the origin of the frame, for a mass centre alone and in two words, and for axes.
const ORIGIN: [&str; 3] = ["origin", "origins", "datum"];
const MASS_CENTRE: [&str; 16] = [
    "cg",
    "cgs",
    "cog",
    "cogs",
    "com",
    "coms",
    "cm",
    "cms",
    "cofg",
    "cofm",
    "centroid",
    "centroids",
    "masscentre",
    "masscenter",
    "barycentre",
    "barycenter",
];
const CENTRE: [&str; 4] = ["centre", "center", "centres", "centers"];
const OF_MASS: [&str; 3] = ["mass", "masses", "gravity"];
const AXES: [&str; 5] = ["axis", "axes", "x", "y", "z"];

/// What may stand beside a mass centre that is that of the row. With any other word, as `vehicle`, it is another one.
const OWN: [&str; 34] = [
    "own",
    "its",
    "their",
    "each",
    "every",
    "individual",
    "respective",
    "corresponding",
    "local",
    "part",
    "parts",
    "component",
    "components",
    "item",
    "items",
    "body",
    "bodies",
    "row",
    "rows",
    "link",
    "links",
    "element",
    "elements",
    "s",
    "of",
    "the",
    "at",
    "through",
    "point",
    "nominal",
    "actual",
    "measured",
    "calculated",
    "computed",
];

/// Why a table is refused, if a line above its header, or a comment below it, says that inertias are about a point other than the one here.
pub(crate) fn refused(text: &Text, header: usize, point: InertiaPoint) -> Result<(), Refusal> {
    match titles(text.as_str(), header).find(|(_, line)| speaks_of_another(line, point)) {
        Some((at, line)) => {
            let point = match point {
                InertiaPoint::MassCentre => "the mass centre of its row",
                InertiaPoint::Origin => "the origin, as in tables with first moments",
            };
            let (said, point) = (shortened(line.trim()), point.to_owned());
            Err(text.refuse(at, FileProblem::TitlePoint { said, point }))
        }
        None => Ok(()),
    }
}

/// Whether a clause names an inertia and then a point other than the one here. Axes are not points: each may go through any.
fn speaks_of_another(line: &str, point: InertiaPoint) -> bool {
    const OPEN: [char; 3] = ['(', '[', '{'];
    let line = without_dots(&line.to_lowercase());
    let clauses: Vec<&str> =
        line.split_inclusive([',', ';', '\t', '|', '(', ')', '[', ']', '{', '}']).collect();
    let split = |clause| words(clause).filter(|word| !word.is_empty()).collect::<Vec<&str>>();
    let mut was_inertia = false;
    clauses.iter().enumerate().any(|(number, clause)| {
        let words = split(clause);
        let inertia = words.iter().position(|word| is_inertia(word));
        let is_behind = was_inertia;
        let is_of_other =
            |word: &&str| matches!(dimension_of(word), Some(Dimension::Mass | Dimension::Length));
        was_inertia = inertia.is_some() || was_inertia && !words.iter().any(is_of_other);
        let joint = |must: bool| {
            let is_joint = |at: usize, word: &str| {
                let has_to = words.get(at + 1) == Some(&"to");
                let is_about = ABOUT.contains(&word) || RELATIVE.contains(&word) && has_to;
                if must { is_about } else { AT.contains(&word) }
            };
            let at =
                (0..words.len()).find(|at| words.get(*at).is_some_and(|w| is_joint(*at, w)))?;
            // `Inertia (about the origin)`, `Inertia, taken at the origin`.
            let is_first = || words.iter().take(at).all(|word| TAKEN.contains(word));
            let is_of_inertia =
                inertia.is_some_and(|inertia| inertia < at) || is_behind && is_first();
            is_of_inertia.then(|| (must, words.split_at(at)))
        };
        let Some((must, (before, [joint, behind @ ..]))) = joint(true).or_else(|| joint(false))
        else {
            return false;
        };
        let start = behind.iter().take_while(|word| BEFORE.contains(word)).count();
        let behind = behind.get(start..).unwrap_or_default();
        // `about (0, 0, 0)`.
        let is_within = behind.is_empty() && clause.ends_with(OPEN);
        let within: Option<Vec<&str>> = is_within.then(|| {
            let rest = clauses.get(number + 1..).unwrap_or_default();
            let inner = rest.iter().take_while(|clause| !clause.ends_with(OPEN));
            let end = inner.clone().position(|clause| clause.ends_with([')', ']', '}']));
            inner.take(end.map_or(1, |end| end + 1)).flat_map(|clause| split(clause)).collect()
        });
        let behind = within.as_deref().unwrap_or(behind);
        // The reference of inertias may be a frame.
        let named = Named::of(behind, must, is_within, *joint == "at" || must);
        named.is(point, must).is_some_and(|is_it| is_it == before.contains(&"not"))
    })
}

/// What words say of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Named {
    MassCentre,
    /// That of something else than the row.
    OtherCentre,
    Origin,
    /// An axis, or a number that is no coordinate: `about 2 kg m2`.
    None,
    Other,
}

impl Named {
    /// Whether it is the point; nothing if no point is named, where `must` says that other words name one.
    fn is(self, point: InertiaPoint, must: bool) -> Option<bool> {
        match self {
            Self::MassCentre => Some(point == InertiaPoint::MassCentre),
            Self::Origin => Some(point == InertiaPoint::Origin),
            Self::OtherCentre => Some(false),
            Self::None => None,
            Self::Other => must.then_some(false),
        }
    }

    /// What words name, where numbers in brackets, or behind words that a point must follow, may be coordinates, and a frame may stand for its origin.
    fn of(words: &[&str], must: bool, is_within: bool, may_be_frame: bool) -> Self {
        let may_be_numbers = must || is_within;
        let end = words.iter().position(|word| BEHIND.contains(word)).unwrap_or(words.len());
        let words = words.get(..end).unwrap_or_default();
        // `an axis through the hinge`.
        let start = words.iter().position(|word| *word == "through").map_or(0, |at| at + 1);
        let words = words.get(start..).unwrap_or_default();
        let has = |list: &[&str]| words.iter().any(|word| list.contains(word));
        let is_frame = words.iter().any(|word| word.starts_with("csys"))
            || has(&["coordinate"]) && has(&["system"]);
        let is_two = has(&CENTRE) && has(&OF_MASS);
        let is_centre = |word: &&str| {
            MASS_CENTRE.contains(word)
                || is_two && (CENTRE.contains(word) || OF_MASS.contains(word))
        };
        match (words.first(), words.iter().position(is_centre)) {
            (None, _) => Self::None,
            (Some(first), _) if first.starts_with(char::is_numeric) => {
                if !may_be_numbers || words.iter().any(|word| word.contains(char::is_alphabetic)) {
                    Self::None
                } else if words.iter().all(|word| word.chars().all(|c| c == '0')) {
                    Self::Origin
                } else if is_within {
                    Self::Other
                } else {
                    Self::None
                }
            }
            (_, Some(at)) if is_of_row(words, at, is_centre) => Self::MassCentre,
            (_, Some(_)) => Self::OtherCentre,
            (_, None) if has(&ORIGIN) || may_be_frame && is_frame => Self::Origin,
            (_, None) if has(&["own"]) => Self::MassCentre,
            (_, None) if has(&AXES) => Self::None,
            (_, None) => Self::Other,
        }
    }
}

/// Whether the mass centre at a place among words is that of the row: `CG of each part`, but not `vehicle CG` or `CG of the vehicle`.
fn is_of_row(words: &[&str], at: usize, is_centre: impl Fn(&&str) -> bool) -> bool {
    let (before, behind) = words.split_at(at);
    let axis = before.iter().rposition(|word| AXES.contains(word));
    let before = before.get(axis.map_or(0, |axis| axis + 1)..).unwrap_or_default();
    let of = behind.iter().rposition(|word| *word == "of");
    let of = of.and_then(|of| behind.get(of + 1..)).unwrap_or_default();
    let whose = of.iter().find(|word| !BEFORE.contains(word));
    before.iter().all(|word| OWN.contains(word))
        && whose.is_none_or(|word| OWN.contains(word) || is_centre(word))
}

/// Whether a word is that of inertias: `inertia`, `MOIs`, `Ixx`, but not `I` or the product of a company.
fn is_inertia(word: &str) -> bool {
    dimension_of(word) == Some(Dimension::Inertia) && !["i", "product", "products"].contains(&word)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::{prelude::*, sample::select};

    proptest! {
        /// Whatever inertias are called, and whatever joins them to the point.
        #[test]
        fn points_are_told_apart(
            mark in select(&["", "# ", "Table 3; ", "Mass in kg, "][..]),
            inertia in select(&["Inertia", "inertias", "Moments of inertia", "MOI", "Inertia tensor", "Ixx, Iyy, Izz", "products of inertia"][..]),
            joint in select(&[" about ", "_about: ", " (about ", ", about ", " w.r.t. ", " with respect to ", " relative to ", " taken about ", " about = "][..]),
            (name, of) in select(&[
                ("the vehicle origin", Some(InertiaPoint::Origin)), ("origin", Some(InertiaPoint::Origin)),
                ("the origin of the body frame", Some(InertiaPoint::Origin)),
                ("CG", Some(InertiaPoint::MassCentre)), ("the mass centre", Some(InertiaPoint::MassCentre)), ("own axes", Some(InertiaPoint::MassCentre)), ("CoM", Some(InertiaPoint::MassCentre)),
                ("the center of gravity of each part", Some(InertiaPoint::MassCentre)), ("the hinge", None), ("point A", None),
            ][..]),
            after in select(&["", "), kg m2", ", CG relative to the origin", "; origin at the CG"][..]),
        ) {
            let line = format!("{mark}{inertia}{joint}{name}{after}");
            for point in [InertiaPoint::MassCentre, InertiaPoint::Origin] {
                prop_assert_eq!(speaks_of_another(&line, point), of != Some(point), "{} {:?}", line, point);
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(3000))]

        /// A mass centre is that of its row by any of its names, unless a word beside it says that it is that of something else.
        #[test]
        fn mass_centres_of_something_else_are_told_apart(
            inertia in select(&["Inertia", "MOIs", "Moments of inertia (kg m2)", "Ixx, Iyy, Izz", "# Mass in kg; inertia", "All inertias are"][..]),
            joint in select(&[" about ", " w.r.t. ", ", taken at ", " referred to ", ": about ", " at ", " (about ", " about axes through "][..]),
            centre in select(&[
                "c.g.", "C.G.", "CG", "CGs", "CofG", "c.o.m.", "centroid", "masscentre",
                "center of mass", "centre-of-mass", "mass center", "centers of gravity",
            ][..]),
            (before, behind, is_own) in select(&[
                ("", "", true), ("the ", "", true), ("its ", "", true), ("each part's ", "", true), ("own ", "", true), ("the ", " of each part", true),
                ("the nominal ", "", true), ("the ", " and aligned with the output coordinate system", true), ("the ", " in the vehicle frame", true), ("", " kg m2", true),
                ("vehicle ", "", false), ("the composite ", "", false), ("the system ", "", false), ("the overall ", "", false), ("the ", " of the vehicle", false),
                ("the ", " of the whole", false), ("S/C ", "", false), ("parent ", "", false), ("combined ", " of the parts", false),
            ][..]),
        ) {
            let line = format!("{inertia}{joint}{before}{centre}{behind}");
            prop_assert_eq!(speaks_of_another(&line, InertiaPoint::MassCentre), !is_own, "{}", line);
        }

        /// An origin may be given by its coordinates, or as that of a coordinate system, and other numbers and frames are no points.
        #[test]
        fn coordinates_are_told_from_numbers(
            inertia in select(&["Inertia", "Moments of inertia (kg m2)", "Mass, MOI"][..]),
            (origin, other) in select(&[
                ("about (0,0,0)", "about (1.5, 0, 0)"), ("relative to [0 0 0]", "relative to (0, 0.2, 0)"), ("about 0,0,0", "about the hinge"), ("wrt (0.0, 0.0, 0.0)", "wrt point (1, 2, 3)"),
                ("referenced to the datum", "not about the CG"), ("taken at the output coordinate system", "about an axis through the hinge"), ("at PRT_CSYS_DEF", "about vehicle CG"),
                ("at CSYS0", "referred to the interface"),
            ][..]),
            none in select(&[
                "about 1%", "is about 2 kg m2 each", "at 0 % fill", "at 0 deg", "referred to in section 3", "relative error 1%", "in reference coordinate system",
                "at launch", "not about the origin", "at launch mass", "referenced drawings", "about the vehicle axes", "about axes parallel to the vehicle frame",
            ][..]),
        ) {
            let is_other = |said: &str, point| speaks_of_another(&format!("{inertia} {said}"), point);
            for (said, centre, first) in [(origin, true, false), (other, true, true)] {
                prop_assert_eq!(is_other(said, InertiaPoint::MassCentre), centre, "{}", said);
                prop_assert_eq!(is_other(said, InertiaPoint::Origin), first && said != "not about the CG", "{}", said);
            }
            prop_assert!(!is_other(none, InertiaPoint::MassCentre), "{}", none);
        }
    }

    #[test]
    fn other_lines_name_no_point() {
        for line in [
            "# Inertia about the x axis",
            "Moments of inertia about principal axes",
            "# Inertia in CM frame",
            "# Inertia at launch",
            "# Mass, inertia, CG relative to the origin",
            "# CG relative to the origin, inertia in kg m2",
            "# Inertia in the vehicle frame, with its origin at the launcher",
            "# What I know about the tank",
            "# products about to be replaced",
            "Inertia,about,Mass",
        ] {
            assert!(!speaks_of_another(line, InertiaPoint::MassCentre), "{line}");
        }
        for line in
            ["Inertia at origin", "MOI reference: datum", "# CG and inertia about the origin"]
        {
            assert!(speaks_of_another(line, InertiaPoint::MassCentre), "{line}");
            assert!(!speaks_of_another(line, InertiaPoint::Origin), "{line}");
        }
    }
}
