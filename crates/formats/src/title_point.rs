//! The point that a title or a comment of a table says inertias are about, of which nothing is read.

use crate::{
    FileProblem,
    body::shortened,
    error::Refusal,
    rows::titles,
    spread::words,
    table_terms::{InertiaPoint, dimension_of},
    text::Text,
    units::Dimension,
};

/// What stands between an inertia and its point.
const ABOUT: [&str; 4] = ["about", "wrt", "relative", "respect"];

/// The same, where anything else may follow: `at launch`.
const AT: [&str; 3] = ["at", "reference", "ref"];

/// Words for the origin of the frame, and for a mass centre.
const ORIGIN: [&str; 2] = ["origin", "datum"];
const MASS_CENTRE: [&str; 5] = ["cg", "cog", "com", "cm", "own"];

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
    let line = line.to_lowercase().replace("w.r.t", "wrt");
    let mut was_inertia = false;
    line.split([',', ';', '\t', '|', '(', ')', '[', ']', '{', '}']).any(|clause| {
        let words: Vec<&str> = words(clause).filter(|word| !word.is_empty()).collect();
        let inertia = words.iter().position(|word| is_inertia(word));
        // `Inertia (about the origin)`.
        let start = if was_inertia { Some(0) } else { inertia };
        was_inertia = inertia.is_some();
        let of = |list: &[&str]| {
            let at = words.iter().position(|word| list.contains(word))?;
            let is_of_inertia = inertia.is_some_and(|inertia| inertia < at);
            (is_of_inertia || start == Some(at)).then(|| words.split_at(at + 1).1)
        };
        match (of(&ABOUT), of(&AT)) {
            (Some(behind), _) => !behind.is_empty() && !is_about(behind, point, true),
            (None, Some(behind)) => !is_about(behind, point, false),
            (None, None) => false,
        }
    })
}

/// Whether words name the point, or none, where `must` says that they are sure to name one.
fn is_about(words: &[&str], point: InertiaPoint, must: bool) -> bool {
    let has = |list: &[&str]| words.iter().any(|word| list.contains(word));
    let has_centre = has(&MASS_CENTRE)
        || has(&["centre", "center", "centres", "centers"]) && has(&["mass", "gravity"]);
    let has_axis = has(&["axis", "axes", "x", "y", "z"]);
    let (is_point, is_other) = match point {
        InertiaPoint::MassCentre => (has_centre, has(&ORIGIN)),
        InertiaPoint::Origin => (has(&ORIGIN) && !has_centre, has_centre),
    };
    is_point || !is_other && (has_axis || !must)
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
