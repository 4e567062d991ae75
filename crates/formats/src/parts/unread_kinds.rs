//! Headings of columns that would change the numbers of a row, and are not read.

use crate::{
    spread::{parted, words},
    table_terms::dimension_of,
    units::Dimension,
};

/// What would change the numbers of a row, and is not read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unread {
    /// How many parts a row is.
    Count,
    /// An angle by which the part is turned, or another form of its attitude.
    Turn,
    /// A growth allowance of the mass.
    Growth,
    /// The unit of a row.
    Unit,
    /// The point that the inertia is about, or the frame that it is in.
    Reference,
    /// Which sign products have.
    Sign,
}

/// A kind: words that a heading of it has, one of each list and in this order, and words that may stand beside them. With any other
/// word, it is a heading of something else, as `pitch diameter`.
type Words = (Unread, &'static [&'static [&'static str]], &'static [&'static str]);

/// What any word of the inertia is here, as `moi`, `products` and `ixx`.
const INERTIA: &str = "inertia";

/// Words for the point or the frame of an inertia, and what may stand beside them.
const REFERENCES: [&str; 9] =
    ["about", "at", "reference", "ref", "frame", "origin", "wrt", "relative", "respect"];
const BESIDE_REFERENCES: [&str; 10] =
    ["of", "taken", "the", "point", "and", "axis", "axes", "matrix", "with", "to"];

/// Words for a number of parts, with any words beside them but those of something else that is told of parts or counted.
const AMOUNTS: [&str; 11] = [
    "qty",
    "quantity",
    "quantities",
    "count",
    "instances",
    "anzahl",
    "menge",
    "stückzahl",
    "quantité",
    "qté",
    "qte",
];
const OTHER_AMOUNTS: [&str; 26] = [
    "spare", "spares", "price", "cost", "costs", "currency", "eur", "usd", "check", "checked",
    "verified", "approved", "by", "date", "stock", "order", "ordered", "note", "notes", "comment",
    "remarks", "kg", "g", "lb", "lbs", "lbm",
];
/// What a count of parts counts, before it or behind `of`: a `triangle count` is one of something else.
const COUNTED: [&str; 27] = [
    "part",
    "parts",
    "item",
    "items",
    "instance",
    "instances",
    "unit",
    "units",
    "component",
    "components",
    "body",
    "bodies",
    "piece",
    "pieces",
    "copy",
    "copies",
    "assembly",
    "assy",
    "set",
    "vehicle",
    "flight",
    "bom",
    "total",
    "identical",
    "required",
    "used",
    "installed",
];
/// Behind one of them, the unit of the amount: `quantity unit`.
const UNITS: [&str; 3] = ["unit", "units", "uom"];

const KINDS: [Words; 10] = [
    // Before counts: `units` alone are those of the row.
    (
        Unread::Unit,
        &[&UNITS],
        &["of", "for", "the", "and", "in", "used", "system", "measure", "measurement"],
    ),
    // A `part number` names a part, and a `number of parts` counts it.
    (Unread::Count, &[&["number", "num"]], &[]),
    (
        Unread::Count,
        &[
            &["no", "nr", "num", "number", "n"],
            &[
                "parts",
                "items",
                "bodies",
                "components",
                "identical",
                "per",
                "of",
                "required",
                "reqd",
                "req",
                "used",
                "installed",
                "fitted",
            ],
        ],
        &["the", "in", "assembly", "assy", "set", "item", "total"],
    ),
    (
        Unread::Count,
        &[&[
            "amount",
            "multiplier",
            "mult",
            "pcs",
            "pieces",
            "multiplicity",
            "copies",
            "ea",
            "off",
            "units",
            "stk",
            "stück",
        ]],
        &[
            "no", "nr", "num", "number", "n", "of", "part", "parts", "total", "per", "assembly",
            "assy", "set", "item", "items", "the", "in", "unit",
        ],
    ),
    (
        Unread::Turn,
        &[&[
            "roll",
            "pitch",
            "yaw",
            "euler",
            "rpy",
            "rot",
            "rotx",
            "roty",
            "rotz",
            "rotation",
            "rx",
            "ry",
            "rz",
            "theta",
            "phi",
            "psi",
            "angle",
            "angles",
            "clocking",
            "tilt",
            "attitude",
            "azimuth",
            "elevation",
            "orientation",
            "quat",
            "quaternion",
            "dcm",
            "q0",
            "q1",
            "q2",
            "q3",
            "q4",
            "dcm11",
            "dcm12",
            "dcm13",
            "dcm21",
            "dcm22",
            "dcm23",
            "dcm31",
            "dcm32",
            "dcm33",
            "r11",
            "r12",
            "r13",
            "r21",
            "r22",
            "r23",
            "r31",
            "r32",
            "r33",
        ]],
        &[
            "deg", "degree", "degrees", "rad", "radians", "x", "y", "z", "w", "1", "2", "3",
            "about", "axis", "xyz", "zyx", "matrix",
        ],
    ),
    (
        Unread::Growth,
        &[&["mga", "growth", "contingency", "margin"]],
        &[
            "mass",
            "allowance",
            "percent",
            "pct",
            "kg",
            "g",
            "lb",
            "factor",
            "with",
            "incl",
            "including",
            "and",
        ],
    ),
    (Unread::Reference, &[&[INERTIA], &REFERENCES], &BESIDE_REFERENCES),
    (Unread::Reference, &[&["about"]], &["taken", "the", "point"]),
    (Unread::Sign, &[&["sign", "signs"]], &["of", "the", INERTIA, "convention"]),
    (Unread::Sign, &[&[INERTIA], &["sign", "signs", "convention", "conv"]], &["of", "the"]),
];

impl Unread {
    /// What a heading holds of this kind. A capital may begin a word, as in `MassUnit` and `MOIAbout`.
    pub(crate) fn of(heading: &str) -> Option<Self> {
        let inner = [("UoM", "uom"), ("MoI", "moi"), ("PoI", "poi")];
        let heading =
            inner.iter().fold(heading.to_owned(), |text, (from, to)| text.replace(from, to));
        let readings = [parted(&heading), parted(&acronyms_apart(&heading))];
        readings.iter().find_map(|reading| Self::of_words(reading))
    }

    /// The same of a heading in small letters.
    fn of_words(heading: &str) -> Option<Self> {
        // What is written with marks between its letters is one word.
        let marks = [("u.o.m", "uom"), ("u/m", "uom"), ("w.r.t", "wrt")];
        let plain =
            marks.iter().fold(heading.to_owned(), |text, (from, to)| text.replace(from, to));
        let one = |word| match dimension_of(word) {
            Some(Dimension::Inertia) => INERTIA,
            Some(Dimension::Mass | Dimension::Length | Dimension::FirstMoment) | None => word,
        };
        let all: Vec<&str> = words(&plain).filter(|word| !word.is_empty()).map(one).collect();
        let is_of = |(kind, lists, beside): &&Words| {
            let mut rest = all.iter();
            let is_key = |word: &&str| lists.iter().any(|keys| keys.contains(word));
            // Units may be those of anything.
            let is_measured = |word: &&str| *kind == Self::Unit && dimension_of(word).is_some();
            lists.iter().all(|keys| rest.any(|word| keys.contains(word)))
                && all.iter().all(|word| is_key(word) || is_measured(word) || beside.contains(word))
        };
        let is_of_other = |count: usize| {
            let (before, behind) = (all[..count].last(), &all[count + 1..]);
            let mut of = behind.iter().skip(1).filter(|word| **word != "the");
            let counted = if behind.first() == Some(&"of") { of.next() } else { before };
            counted.is_some_and(|word| !COUNTED.contains(word))
        };
        let is_amount = |(at, word): (usize, &&str)| {
            let is_unit = all.get(at + 1).is_some_and(|next| UNITS.contains(next));
            AMOUNTS.contains(word) && !is_unit && !(*word == "count" && is_of_other(at))
        };
        let is_other_amount = all.iter().any(|word| OTHER_AMOUNTS.contains(word));
        if all.iter().enumerate().any(is_amount) && !is_other_amount {
            return Some(Self::Count);
        }
        KINDS.iter().find(is_of).map(|(kind, ..)| *kind)
    }
}

/// With a blank between capitals and a word of small letters behind them that begins with a capital: `MOIAbout` becomes `MOI About`, and `CGx` and `MOIs`
/// stay as they are.
fn acronyms_apart(heading: &str) -> String {
    let letters: Vec<char> = heading.chars().collect();
    let is_small = |at: usize| letters.get(at).is_some_and(|c| c.is_lowercase());
    let is_capital = |at: usize| letters.get(at).is_some_and(|c| c.is_uppercase());
    let mut apart = String::with_capacity(heading.len() + 8);
    for (at, letter) in letters.iter().enumerate() {
        let follows = at.checked_sub(1).is_some_and(is_capital);
        if follows && is_capital(at) && is_small(at + 1) && is_small(at + 2) {
            apart.push(' ');
        }
        apart.push(*letter);
    }
    apart
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_of_something_else_are_none() {
        for (heading, kind) in [
            ("Qty", Unread::Count),
            ("Total Qty", Unread::Count),
            ("No. of units", Unread::Count),
            ("# off", Unread::Count),
            ("Anzahl", Unread::Count),
            ("Rot X (deg)", Unread::Turn),
            ("theta_z", Unread::Turn),
            ("q1", Unread::Turn),
            ("clocking angle [deg]", Unread::Turn),
            ("Tilt (deg)", Unread::Turn),
            ("attitude", Unread::Turn),
            ("MGA %", Unread::Growth),
            ("mass with margin [kg]", Unread::Growth),
            ("unit", Unread::Unit),
            ("Units", Unread::Unit),
            ("length unit", Unread::Unit),
            ("inertia_units", Unread::Unit),
            ("unit of mass", Unread::Unit),
            ("Ixx units", Unread::Unit),
            ("ixx_unit", Unread::Unit),
            ("I_yz units", Unread::Unit),
            ("I unit", Unread::Unit),
            ("u.o.m.", Unread::Unit),
            ("U/M", Unread::Unit),
            ("MOI (UoM)", Unread::Unit),
            ("Unit of measure", Unread::Unit),
            ("system of units", Unread::Unit),
            ("Number of parts", Unread::Count),
            ("n_parts", Unread::Count),
            ("No. of items per assembly", Unread::Count),
            ("number", Unread::Count),
            ("Num.", Unread::Count),
            ("number of", Unread::Count),
            ("number per set", Unread::Count),
            ("multiplier", Unread::Count),
            ("mult", Unread::Count),
            ("Amount", Unread::Count),
            ("unit qty", Unread::Count),
            ("Qty per unit", Unread::Count),
            ("R11", Unread::Turn),
            ("rotation matrix", Unread::Turn),
            ("inertia about", Unread::Reference),
            ("MOI ref. point", Unread::Reference),
            ("moments about the point", Unread::Reference),
            ("about", Unread::Reference),
            ("about point", Unread::Reference),
            ("Inertia Ref", Unread::Reference),
            ("inertia reference", Unread::Reference),
            ("MOI reference", Unread::Reference),
            ("Inertia at", Unread::Reference),
            ("MOI at", Unread::Reference),
            ("inertia_frame", Unread::Reference),
            ("POI ref. axes", Unread::Reference),
            ("sign", Unread::Sign),
            ("POI sign", Unread::Sign),
            ("Sign of products", Unread::Sign),
            ("product convention", Unread::Sign),
            ("Qty per vehicle", Unread::Count),
            ("QTY PER S/C", Unread::Count),
            ("Qty required", Unread::Count),
            ("Flight qty", Unread::Count),
            ("BOM quantity", Unread::Count),
            ("Instance count", Unread::Count),
            ("No. required", Unread::Count),
            ("number used", Unread::Count),
            ("Stückzahl", Unread::Count),
            ("Moment of inertia about", Unread::Reference),
            ("Ixx about", Unread::Reference),
            ("inertia tensor about", Unread::Reference),
            ("Inertia w.r.t.", Unread::Reference),
            ("inertia relative to", Unread::Reference),
            ("MOI with respect to the origin", Unread::Reference),
            ("Ixy sign", Unread::Sign),
        ] {
            assert_eq!(Unread::of(heading), Some(kind), "{heading}");
        }
        for heading in [
            "pitch diameter [mm]",
            "Roll number",
            "Rotation speed rpm",
            "yaw actuator id",
            "attitude sensor",
            "thermal margin",
            "growth rate",
            "margin notes",
            "Quantity unit price",
            "count verified by",
            "Quantity unit",
            "Qty UoM",
            "quantity (kg)",
            "Qty check",
            "pieces drawing",
            "part number",
            "item number",
            "assembly no.",
            "parts number",
            "serial number",
            "No.",
            "n",
            "amount paid",
            "unit price",
            "R1",
            "R110",
            "inertia class",
            "about the supplier",
            "reference",
            "frame",
            "signed by",
            "moments",
            "material",
            "",
            "#",
            "x",
        ] {
            assert_eq!(Unread::of(heading), None, "{heading}");
        }
    }

    /// Whatever is counted: parts, or something that they have.
    #[test]
    fn a_count_is_of_what_stands_beside_it() {
        let others = ["triangle", "node", "mesh", "pin", "cell", "vertex", "tooth", "wire", "face"];
        let parts =
            ["", "part", "item", "instance", "component", "body", "vehicle", "flight", "BOM"];
        for (words, kind) in [(others, None), (parts, Some(Unread::Count))] {
            for word in words {
                for form in
                    ["W count", "W_COUNT", "Count of W", "count of the W", "W count per part"]
                {
                    let heading = form.replace('W', word);
                    assert_eq!(Unread::of(&heading), kind, "{heading}");
                }
            }
        }
        // What is counted may be left out.
        for heading in ["count", "Count per vehicle", "Count per part"] {
            assert_eq!(Unread::of(heading), Some(Unread::Count), "{heading}");
        }
        for heading in ["Spare Qty", "Qty (spares)", "spare_quantity", "Spare parts count"] {
            assert_eq!(Unread::of(heading), None, "{heading}");
        }
    }

    /// Words that stand apart, are joined by marks, or begin with capitals say the same.
    #[test]
    fn words_of_a_heading_may_begin_with_capitals() {
        for (words, kind) in [
            (&["mass", "unit"][..], Unread::Unit),
            (&["length", "unit"], Unread::Unit),
            (&["inertia", "units"], Unread::Unit),
            (&["unit", "of", "mass"], Unread::Unit),
            (&["number", "of", "parts"], Unread::Count),
            (&["no", "off"], Unread::Count),
            (&["n", "parts"], Unread::Count),
            (&["part", "qty"], Unread::Count),
            (&["qty", "per", "vehicle"], Unread::Count),
            (&["num", "instances"], Unread::Count),
            (&["roll", "deg"], Unread::Turn),
            (&["euler", "x"], Unread::Turn),
            (&["rot", "x"], Unread::Turn),
            (&["rotation", "matrix"], Unread::Turn),
            (&["mass", "margin"], Unread::Growth),
            (&["growth", "factor"], Unread::Growth),
            (&["inertia", "about"], Unread::Reference),
            (&["moi", "about", "point"], Unread::Reference),
            (&["poi", "sign"], Unread::Sign),
            (&["products", "sign"], Unread::Sign),
            (&["sign", "convention"], Unread::Sign),
        ] {
            let capital = |word: &&str| {
                let (first, rest) = word.split_at(1);
                format!("{}{rest}", first.to_uppercase())
            };
            let pascal = words.iter().map(capital).collect::<String>();
            let camel = words[0].to_owned() + &words[1..].iter().map(capital).collect::<String>();
            let acronym =
                words[0].to_uppercase() + &words[1..].iter().map(capital).collect::<String>();
            // One letter after capitals may belong to them.
            let is_apart = words.len() == 1 || words[1].len() > 2;
            for heading in
                [words.join(" "), words.join("_"), words.join(" ").to_uppercase(), pascal, camel]
            {
                assert_eq!(Unread::of(&heading), Some(kind), "{heading}");
            }
            assert!(!is_apart || Unread::of(&acronym) == Some(kind), "{acronym}");
        }
    }
}
