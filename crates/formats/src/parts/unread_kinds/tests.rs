//! Headings of columns that would change the numbers of a row, in every spelling, and those of something else.

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

/// In whatever letters and languages a quantity is written, and of whatever it is each.
#[test]
fn quantities_are_known_in_short_and_per_whole() {
    for word in [
        "Qty",
        "Q'ty",
        "Q’ty",
        "Qnty",
        "Qtty",
        "Qnt",
        "Quan.",
        "Quant.",
        "QUANTITY",
        "Quantité",
        "Qté",
        "Quantità",
        "Quantidade",
        "Cantidad",
        "Aantal",
        "Antal",
        "Anzahl",
        "数量",
        "Кол-во",
        "QPA",
    ] {
        for beside in ["", " per vehicle", "/assy", " (total)", " req'd"] {
            let heading = format!("{word}{beside}");
            assert_eq!(Unread::of(&heading), Some(Unread::Count), "{heading}");
        }
        for beside in [" unit", " price", " checked"] {
            let heading = format!("{word}{beside}");
            assert_eq!(Unread::of(&heading), None, "{heading}");
        }
    }
    for whole in ["S/C", "vehicle", "veh", "assy", "spacecraft", "ship set", "rocket"] {
        for each in ["#", "No.", "Number", "Nos.", "Pcs", "Pieces", "Units", "EA", "Off", "pc"] {
            let heading = format!("{each} per {whole}");
            assert_eq!(Unread::of(&heading), Some(Unread::Count), "{heading}");
        }
        for each in ["Pcs", "pieces", "Units", "pc"] {
            let heading = format!("{each}/{whole}");
            assert_eq!(Unread::of(&heading), Some(Unread::Count), "{heading}");
        }
    }
    for heading in ["Nos.", "No. req'd", "No. in assy", "No. in the set", "Occurrences"] {
        assert_eq!(Unread::of(heading), Some(Unread::Count), "{heading}");
    }
    for heading in [
        "Part nos.",
        "Serial nos",
        "No. in figure",
        "number/name",
        "N/A",
        "No/yes",
        "per unit",
        "Quality",
        "Quasar",
        "QA",
        "Q",
        "quote",
        "quarter",
        "query",
        "No. of drawing",
        "Units",
        "kg per m",
        "Number in drawing",
        "quaternion",
    ] {
        assert_ne!(Unread::of(heading), Some(Unread::Count), "{heading}");
    }
}

/// Whatever is counted: parts, or something that they have.
#[test]
fn a_count_is_of_what_stands_beside_it() {
    let others = ["triangle", "node", "mesh", "pin", "cell", "vertex", "tooth", "wire", "face"];
    let parts = ["", "part", "item", "instance", "component", "body", "vehicle", "flight", "BOM"];
    for (words, kind) in [(others, None), (parts, Some(Unread::Count))] {
        for word in words {
            for form in ["W count", "W_COUNT", "Count of W", "count of the W", "W count per part"] {
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
        let acronym = words[0].to_uppercase() + &words[1..].iter().map(capital).collect::<String>();
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
