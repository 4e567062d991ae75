//! Names of rows that sum up others, and names of parts that look like them.

use super::*;

/// The words of a name in any letters, with what stands beside them and between them, are one name.
#[test]
fn each_word_is_a_name_with_what_stands_beside_it() {
    for key in SUMS.into_iter().chain(STATISTICS) {
        for beside in BESIDE.into_iter().chain([""]) {
            for name in [
                format!("{key} {beside}"),
                format!("{beside}-{key}:"),
                format!("{key} ({beside})").to_uppercase(),
                format!(" {beside}_{key} + 3σ"),
                format!("{key} - 3 sigma {beside}"),
            ] {
                assert_eq!(Kind::of(&name), Kind::Summary, "{name}");
            }
            let part = format!("{key} {beside} antenna");
            assert_eq!(Kind::of(&part), Kind::Other, "{part}");
        }
    }
}

#[test]
fn names_of_sums_are_told_from_those_of_parts() {
    for name in [
        "Total",
        "TOTAL:",
        "Grand total",
        "Sub-total",
        "Total mass (kg)",
        "Sum",
        "Σ",
        "∑",
        "Average",
        "std dev",
        "St. Dev.",
        "Standard deviation",
        "Standard Error",
        "Sample Variance",
        "Confidence Level(95.0%)",
        "total of all parts",
        "Gesamtsumme",
        "Tot.",
        "Insgesamt",
        "Mean value",
        "Max",
        "TOTAL DRY MASS",
        "3σ",
        "3-sigma",
        "mean+3σ",
        "99.7th percentile",
        "percentile 95",
        "Écart-type",
        "1st quartile",
        "99.73 percentile",
        "Mean (n=50)",
        "Average (50 runs)",
        "Mean over all runs",
        "Ave.",
        "STDEV.S",
        "stdev_p",
        "Stdabw",
        "RSS",
        "µ+3σ",
        "μ - 3σ",
        "95% CI of the mean",
    ] {
        assert_eq!(Kind::of(name), Kind::Summary, "{name}");
    }
    for name in [
        "5%",
        "95 %",
        "99,7%",
        ".5%",
        "95 pct",
        "99.73th",
        "99.7th",
        "P99.73",
        "p 0.135",
        "95% CI",
        "Lower 95%",
        "95 percent of runs",
        "COV %",
        "COV (%)",
        "Uncertainty",
        "Tolerance",
        "REQUIREMENT",
    ] {
        assert_eq!(Kind::of(name), Kind::Share, "{name}");
    }
    for name in [
        "",
        "12",
        "1.5",
        "%",
        "total station",
        "sump",
        "Max-Q sensor",
        "mass",
        "dry mass",
        "meander line",
        "bus",
        "Summer",
        "average joe",
        "launch adapter",
        "standard",
        "dev",
        "totaliser",
        "mean 3 antenna",
        "max 9",
        "sigma 2",
        "P95",
        "5% fill",
        "1st",
        "P1.5 antenna",
        "p",
        "s",
        "50 runs",
        "max s",
        "upper limit",
        "cover",
        "tolerance ring",
        "nominal tank",
        "Delta",
    ] {
        assert_eq!(Kind::of(name), Kind::Other, "{name}");
    }
    assert_eq!(Kind::of(&"total ".repeat(50)), Kind::Other);
}

/// A sum with something added to it is one, whatever it weighs; a margin alone, and a part with one, are parts.
#[test]
fn sums_with_margins_are_sums() {
    let sums = [
        "Total",
        "Grand total",
        "Bus total",
        "Total mass (kg)",
        "Launch mass",
        "Bus dry mass",
        "Subtotal of bus",
        "Gesamtmasse",
    ];
    let parts =
        ["Bus", "Total pressure sensor", "Launch mass simulator", "Ballast mass", "Tank", ""];
    for (names, kind) in [(&sums[..], Kind::Summary), (&parts[..], Kind::Other)] {
        for name in names {
            for with in ["incl.", "including", "w/", "with", "+", "(with", "&", "20 %", "inkl."] {
                for added in [
                    "margin",
                    "system margin",
                    "MGA",
                    "growth allowance",
                    "contingency",
                    "30% margin",
                    "Reserve",
                ] {
                    let name = format!("{name} {with} {added}");
                    assert_eq!(Kind::of(&name), kind, "{name}");
                    assert_eq!(Kind::of(&name.to_uppercase()), kind, "{name}");
                }
            }
        }
    }
    for name in ["Total MEV", "Total (CBE)", "Total NTE mass", "Predicted total mass"] {
        assert_eq!(Kind::of(name), Kind::Summary, "{name}");
    }
    for name in
        ["Total margin", "System margin", "Total mass growth allowance", "Launch mass margin"]
    {
        assert_eq!(Kind::of(name), Kind::Other, "{name}");
    }
}

#[test]
fn a_share_is_a_summary_below_other_names_only() {
    let found = |names: &[&str]| {
        let mut column = SummaryNames::default();
        names.iter().map(|name| column.sums_up(name)).collect::<Vec<_>>()
    };
    assert_eq!(found(&["0", "1", "5%", "95%"]), [false, false, true, true]);
    for word in ASIDE {
        assert_eq!(found(&["a", "b", word, "Mean"]), [false, false, true, true], "{word}");
        assert_eq!(found(&[word, word, "Mean"]), [false, false, true], "{word}");
    }
    assert_eq!(found(&["5%", "95%", "Mean"]), [false, false, true]);
}

#[test]
fn names_that_can_only_be_sums_are_told_from_others() {
    for part in ["a", "bus", "Bus 2", "solar array", "tank (full)"] {
        for name in [
            format!("{part} subtotal"),
            format!("Subtotal {part}"),
            format!("Sub-total of {part}"),
            format!("Sum of {part}"),
            format!("{part} total"),
            format!("{part} TOTAL MASS (kg)"),
            format!("Total for {part}"),
            format!("total dry mass of the {part}"),
            format!("{part}: sum"),
            format!("Summe von {part}"),
            format!("Zwischensumme {part}"),
            format!("{part} insgesamt"),
            format!("Subtot {part}"),
        ] {
            assert_eq!(least_summed(&name), Some(1), "{name}");
        }
        for name in [
            format!("total pressure sensor of {part}"),
            format!("sum amplifier, {part}"),
            format!("Total {part}"),
            format!("{part} launch mass"),
            format!("dry mass of {part}"),
        ] {
            assert_eq!(least_summed(&name), Some(2), "{name}");
        }
        for name in [
            part.to_owned(),
            format!("mean 3 antenna {part}"),
            format!("{part} mass"),
            format!("balance mass {part}"),
        ] {
            assert_eq!(least_summed(&name), None, "{name}");
        }
    }
}
