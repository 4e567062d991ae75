//! Lists whose assemblies have numbers, written in every way, and lists that look like them and are none.

use super::super::tests::read;
use proptest::prelude::*;

const NUMBERS: &str = "mass,Cx,Cy,Cz,Ixx,Iyy,Izz";

/// Parts of some assemblies: mass and place.
fn assemblies() -> impl Strategy<Value = Vec<Vec<(f64, f64)>>> {
    let part = (1.0..50.0_f64, -3.0..3.0_f64);
    prop::collection::vec(prop::collection::vec(part, 2..5), 1..4)
}

fn numbers((mass, x): (f64, f64)) -> String {
    format!("{mass:.4},{x:.4},0,0,9,9,9")
}

fn total(parts: &[(f64, f64)]) -> (f64, f64) {
    let mass: f64 = parts.iter().map(|(mass, _)| mass).sum();
    (mass, parts.iter().map(|(mass, x)| mass * x).sum::<f64>() / mass)
}

/// A list with a row for each assembly above its parts, each written from its name and that of its assembly.
fn list(
    assemblies: &[Vec<(f64, f64)>],
    header: &str,
    factor: f64,
    line: impl Fn(&str, &str) -> String,
) -> String {
    let mut text = format!("{header},{NUMBERS}\n");
    for (i, parts) in assemblies.iter().enumerate() {
        let (name, (mass, x)) = (format!("unit {i}"), total(parts));
        text += &format!("{},{}\n", line(&name, ""), numbers((factor * mass, x)));
        for (j, part) in parts.iter().enumerate() {
            text += &format!("{},{}\n", line(&format!("part {i}.{j}"), &name), numbers(*part));
        }
    }
    text
}

fn is_refused(text: &str) -> Result<(), TestCaseError> {
    let error = read(text).map(|_| ()).map_err(|error| error.to_string());
    let said = "says that the row belongs to \"unit 0\"";
    prop_assert!(error.as_ref().is_err_and(|error| error.contains(said)), "{}{:?}", text, error);
    Ok(())
}

proptest! {
    /// An assembly with numbers is refused, whatever the heading of the tree is, if it weighs what its parts weigh, and whatever it weighs
    /// if the heading speaks of a tree. Otherwise the column says something else, or nobody knows.
    #[test]
    fn a_column_of_names_of_rows_is_a_tree(
        (assemblies, factor) in (assemblies(), prop::sample::select(vec![1.0, 1.3, 0.2])),
        (heading, is_of_tree) in prop::sample::select(vec![
            ("Parent assembly", true), ("Parent name", true), ("Parent ID", true), ("Parent Assy", true), ("NextAssembly", true),
            ("NHA", true), ("Next Higher Assembly", true), ("Belongs to", true), ("Assembly", true), ("assy no.", true),
            ("Used on", false), ("Baugruppe", false), ("Группа", false), ("x", false), ("Attached to", false), ("Assembled after", false),
        ]),
        is_behind: bool,
    ) {
        let header = if is_behind { format!("name,{heading}") } else { format!("{heading},name") };
        let line = |name: &str, parent: &str| if is_behind { format!("{name},{parent}") } else { format!("{parent},{name}") };
        let text = list(&assemblies, &header, factor, line);
        if is_of_tree || factor == 1.0 {
            is_refused(&text)?;
        } else {
            prop_assert!(read(&text).is_ok(), "{}{:?}", text, read(&text));
        }
    }

    /// Indented names and paths are a tree as well; so are the marks of an outline, whatever the assemblies weigh.
    #[test]
    fn indented_names_are_a_tree(
        (assemblies, factor) in (assemblies(), prop::sample::select(vec![1.0, 1.3, 0.2])),
        (mark, is_outline) in prop::sample::select(vec![
            ("  ", false), (" ", false), ("\t", false), ("\u{a0}\u{a0}", false), ("- ", false), ("— ", false), ("* ", false), ("-- ", false),
            (".. ", true), ("..", true), (". ", true), ("> ", true), (">>", true), ("├─ ", true), ("└── ", true), ("|-- ", true), ("· ", true),
            ("/", false), ("\\", false), (" / ", false),
        ]),
        (is_quoted, is_second) in (any::<bool>(), any::<bool>()),
    ) {
        let line = |name: &str, parent: &str| {
            let name = match parent {
                "" => name.to_owned(),
                _ if mark.contains(['/', '\\']) => format!("{parent}{mark}{name}"),
                _ => format!("{mark}{name}"),
            };
            let name = if is_quoted { format!("\"{name}\"") } else { name };
            if is_second { format!("x,{name}") } else { name }
        };
        let text = list(&assemblies, if is_second { "Note,name" } else { "name" }, factor, line);
        if is_outline || factor == 1.0 {
            is_refused(&text)?;
        } else {
            prop_assert!(read(&text).is_ok(), "{}{:?}", text, read(&text));
        }
    }

    /// Lists of parts alone are read, whatever else says which group a part is of, where it hangs, or which other it looks like.
    #[test]
    fn lists_of_parts_alone_are_read(
        parts in prop::collection::vec((1.0..50.0_f64, -3.0..3.0_f64, any::<prop::sample::Index>()), 2..12),
        name in prop::sample::select(vec!["N", "-N panel", "+N panel", ".5 in bolt N", "bus/N", "A/N", "*N", "N-", "<N>", "  N", "- N"]),
        heading in prop::sample::select(vec!["Attached to", "Mirror of", "Mates with", "Material", "Note", "Parent", "Assembly", "Group"]),
        of in prop::sample::select(vec!["other", "self", "group", "number", "none"]),
    ) {
        let names: Vec<String> = (0..parts.len()).map(|i| name.replace('N', &format!("Y{i}"))).collect();
        let mut text = format!("name,{heading},{NUMBERS}\n");
        for (i, (mass, x, other)) in parts.iter().enumerate() {
            let cell = match of {
                "other" => names[other.index(parts.len())].trim().to_owned(),
                "self" => names[0].trim().to_owned(),
                "group" => "Structure".to_owned(),
                "number" => format!("{i}"),
                _ => String::new(),
            };
            text += &format!("{},{cell},{}\n", names[i], numbers((*mass, *x)));
        }
        // Under these headings, the names of others are those of what they belong to.
        prop_assume!(heading != "Parent" && !(heading == "Assembly" && of == "other"));
        prop_assert!(read(&text).is_ok(), "{}{:?}", text, read(&text));
    }
}
