//! Headings of columns that would change the numbers of a row, and are not read.

use crate::{
    spread::{parted, words},
    table_terms::dimension_of,
    unit_words::is_for_units,
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
const BESIDE_REFERENCES: [&str; 11] =
    ["of", "taken", "given", "the", "point", "and", "axis", "axes", "matrix", "with", "to"];

/// Words for a number of parts, with any words beside them but those of something else that is told of parts or counted.
const AMOUNTS: [&str; 11] = [
    "count",
    "instances",
    "anzahl",
    "menge",
    "stückzahl",
    "qpa",
    "cantidad",
    "aantal",
    "antal",
    "数量",
    "количество",
];

/// Whether a word is one of them, or a quantity: in full, in another language as `quantité`, or without some of its letters, as `qty`, `qnty` and `qté`.
fn is_amount(word: &str) -> bool {
    let mut rest = "quantity".chars();
    let mut has = |letter: char| {
        rest.any(|c| c == if letter == 'é' || letter == 'e' { 'y' } else { letter })
    };
    let is_short = word.starts_with('q') && word.chars().count() > 2 && word.chars().all(&mut has);
    let is_long = ["quantit", "quantid"].iter().any(|begin| word.starts_with(begin));
    is_short || is_long || AMOUNTS.contains(&word)
}
/// What counts parts where something is told of which there are so many each: `Number per S/C`, `Pcs/vehicle`.
const EACH: [&str; 12] =
    ["no", "nr", "num", "number", "nos", "pc", "pcs", "pieces", "units", "ea", "off", "instances"];
/// Those of them that a stroke may stand behind for `per`: a `number/name` is none.
const EACH_BEFORE_STROKE: [&str; 4] = ["pc/", "pcs/", "pieces/", "units/"];
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

const KINDS: [Words; 14] = [
    // Before counts: `units` alone are those of the row.
    (
        Unread::Unit,
        &[&UNITS],
        &["of", "for", "the", "and", "in", "used", "system", "measure", "measurement"],
    ),
    (Unread::Unit, &[&["cad", "model", "file"], &UNITS], &["of", "the"]),
    // A factor would make other units of those of the columns.
    (Unread::Unit, &[&[INERTIA, "mass", "unit", "units", "scale"], &["factor"]], &["to", "si"]),
    // A `part number` names a part, and a `number of parts` counts it.
    (Unread::Count, &[&["number", "num", "nos", "occurrences", "replicas"]], &[]),
    (
        Unread::Count,
        &[
            &["no", "nr", "num", "number", "nos"],
            &["in"],
            &[
                "assembly",
                "assy",
                "set",
                "vehicle",
                "spacecraft",
                "satellite",
                "aircraft",
                "stage",
                "unit",
            ],
        ],
        &["the", "per"],
    ),
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
    (
        Unread::Reference,
        &[&[INERTIA], &["point", "around", "referred", "csys"]],
        &BESIDE_REFERENCES,
    ),
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
        let marks = [
            ("u.o.m", "uom"),
            ("u/m", "uom"),
            ("w.r.t", "wrt"),
            ("@", " at "),
            ("'", ""),
            ("’", ""),
            ("кол-во", "количество"),
        ];
        let mut plain =
            marks.iter().fold(heading.to_owned(), |text, (from, to)| text.replace(from, to));
        if EACH_BEFORE_STROKE.iter().any(|each| plain.starts_with(each)) {
            plain = plain.replacen('/', " per ", 1);
        }
        if plain.starts_with("# ") {
            plain.replace_range(..1, "no");
        }
        let one = |word| match dimension_of(word) {
            Some(Dimension::Inertia) => INERTIA,
            // In any language.
            None if is_for_units(word) && !UNITS.contains(&word) => "unit",
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
        let is_of_parts = |(at, word): (usize, &&str)| {
            let is_unit = all.get(at + 1).is_some_and(|next| UNITS.contains(next));
            is_amount(word) && !is_unit && !(*word == "count" && is_of_other(at))
        };
        let is_each = matches!(*all, [first, "per", _, ..] if EACH.contains(&first));
        let is_other_amount = all.iter().any(|word| OTHER_AMOUNTS.contains(word));
        if (is_each || all.iter().enumerate().any(is_of_parts)) && !is_other_amount {
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
mod tests;
