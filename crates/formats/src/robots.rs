//! URDF, MJCF and SDF: where each keeps its inertias, and what its numbers mean.

use crate::{
    FileBody, FileBodyError, FileProblem, Format, GapKind, MAX_BODIES, Products,
    body::{ENTRIES, NAMES, Number, Reading, shortened},
    error::Refusal,
    frame::defaults,
    gap::Gaps,
    holder::{INERTIAL, is_in_gazebo, is_in_place},
    sdf_words::{has_attributes, truth},
    xml::{MACROS, Node, Tree},
};

/// The format of a file: that of its root element; otherwise that of the form in which its inertias
/// are written, for MuJoCo includes files of any root, and parts of models have others; and if it has
/// none, that of its extension.
///
/// # Errors
/// Nothing tells.
pub(crate) fn format_of(tree: &Tree<'_>, extension: Option<&str>) -> Result<Format, FileProblem> {
    let root = tree.root().name();
    match root {
        "robot" => return Ok(Format::Urdf),
        "mujoco" | "mujocoinclude" => return Ok(Format::Mjcf),
        "sdf" | "gazebo" => return Ok(Format::Sdf),
        _ => {}
    }
    let mut forms = tree.all(INERTIAL).map(form_of);
    let root = shortened(root);
    match (forms.next(), extension) {
        (Some(Some(first)), _) if forms.all(|form| form == Some(first)) => Ok(first),
        (Some(_), Some("xacro")) => Ok(Format::Urdf),
        (Some(_), _) => Err(FileProblem::Unclear { root }),
        (None, Some("urdf" | "xacro")) => Ok(Format::Urdf),
        (None, Some("mjcf")) => Ok(Format::Mjcf),
        (None, Some("sdf" | "world")) => Ok(Format::Sdf),
        (None, _) => Err(FileProblem::Unknown {
            message: format!(
                "its root element is <{root}>, and those of URDF, MJCF and SDF are <robot>, \
                 <mujoco> and <sdf>"
            ),
        }),
    }
}

/// The format that writes an inertia in this way.
fn form_of(inertial: Node<'_, '_>) -> Option<Format> {
    let (mass, inertia) = (inertial.child("mass"), inertial.child("inertia"));
    let is_mjcf = inertial.attribute("mass").is_some() && mass.is_none() && inertia.is_none();
    let is_urdf = inertial.attribute("mass").is_none()
        && mass.is_some_and(|mass| mass.attribute("value").is_some() && !mass.has_text());
    let is_sdf = mass.is_some_and(|mass| mass.has_text() && mass.attribute("value").is_none())
        || inertia.is_some_and(|inertia| inertia.children().any(Node::has_text))
        || (inertial.attribute("mass").is_some() && inertia.is_some());
    match (is_mjcf, is_urdf, is_sdf) {
        (true, false, false) => Some(Format::Mjcf),
        (false, true, false) => Some(Format::Urdf),
        (false, false, true) => Some(Format::Sdf),
        _ => None,
    }
}

/// The bodies of a file, and what of it was not read.
pub(crate) fn read(
    tree: &Tree<'_>,
    format: Format,
    extension: Option<&str>,
    products: Products,
) -> Result<(Vec<FileBody>, Gaps), Refusal> {
    let mut bodies = Vec::new();
    let gaps = each(tree, format, extension, products, |_, body| bodies.push(body))?;
    Ok((bodies, gaps))
}

/// Hands on every body with its element, in the order of the file, and says what of it was not read.
pub(crate) fn each<'t, 'a>(
    tree: &'t Tree<'a>,
    format: Format,
    extension: Option<&str>,
    products: Products,
    mut take: impl FnMut(Node<'t, 'a>, FileBody),
) -> Result<Gaps, Refusal> {
    let has_macros =
        extension == Some(MACROS) || tree.declares_macros() || tree.nodes().any(Node::is_macro);
    let mut bodies = 0;
    let mut gaps = Gaps::default();
    tree.entities().for_each(|line| gaps.add(GapKind::Entities, line));
    for node in tree.nodes() {
        if node.is_macro() {
            gaps.add(GapKind::Macros, node.line());
        } else if node.name() == INERTIAL {
            // The line of the numbers, not of the element around them.
            let line = node.child("inertia").unwrap_or(node).line();
            // What a macro makes of what stands in it is not known.
            if !node.ancestors().any(Node::is_macro) && !is_in_place(node, format) {
                gaps.add(GapKind::Misplaced, line);
                continue;
            }
            let reading = match read_one(node, format, products) {
                Ok(reading) => Ok(reading),
                Err(Trouble::Gap(kind)) => {
                    gaps.add(kind, line);
                    continue;
                }
                Err(Trouble::Body(FileBodyError::Expression { .. })) if has_macros => {
                    gaps.add(GapKind::Macros, line);
                    continue;
                }
                // What is missing is made by the macros in it, which are counted themselves.
                Err(Trouble::Body(FileBodyError::Missing { .. }))
                    if node.descendants().any(Node::is_macro) =>
                {
                    continue;
                }
                Err(Trouble::Body(error)) => Err(error),
            };
            if leaves_to_macros(node, format) {
                continue;
            }
            if bodies == MAX_BODIES {
                return Err(Refusal { line: Some(line), problem: FileProblem::TooManyBodies });
            }
            bodies += 1;
            take(node, FileBody::new(node.name_above(), line, reading));
        } else if includes(node, format) {
            let file = ["file", "href"].iter().find_map(|name| node.attribute(name));
            let file = file.or_else(|| Some(node.child("uri")?.text()));
            gaps.add_file(GapKind::Included, node.line(), file);
        } else if is_stray(node) {
            gaps.add(GapKind::Misplaced, node.line());
        }
    }
    Ok(gaps)
}

/// Why an inertia is not that of a body with numbers.
enum Trouble {
    Gap(GapKind),
    Body(FileBodyError),
}

fn read_one(
    inertial: Node<'_, '_>,
    format: Format,
    products: Products,
) -> Result<Reading, Trouble> {
    let reading = match format {
        Format::Mjcf => mjcf(inertial, products),
        // Gazebo puts what stands in such a block of a URDF file into the model or link that it makes
        // of it as it stands: it is SDF.
        Format::Urdf if is_in_gazebo(inertial) => return sdf_or_computed(inertial, products),
        Format::Sdf => return sdf_or_computed(inertial, products),
        Format::Urdf | Format::Csv | Format::Toml | Format::Json => urdf(inertial, products),
    };
    reading.map_err(Trouble::Body)
}

/// Whether macros in an inertia may give numbers of it for which a default stands otherwise.
fn leaves_to_macros(inertial: Node<'_, '_>, format: Format) -> bool {
    let has_macros = |node: Node<'_, '_>| node.descendants().any(Node::is_macro);
    let of_sdf =
        || !defaults(inertial).is_empty() || inertial.child("inertia").is_some_and(has_macros);
    let moments = ["diaginertia", "fullinertia"];
    has_macros(inertial)
        && match format {
            Format::Sdf => of_sdf(),
            Format::Mjcf => moments.iter().all(|name| inertial.attribute(name).is_none()),
            Format::Urdf => is_in_gazebo(inertial) && of_sdf(),
            Format::Csv | Format::Toml | Format::Json => false,
        }
}

/// Whether an element includes another file.
fn includes(node: Node<'_, '_>, format: Format) -> bool {
    node.name() == "include"
        || (format == Format::Mjcf && node.name() == "model" && node.attribute("file").is_some())
}

/// Whether an element outside all inertias looks like a part of one.
fn is_stray(node: Node<'_, '_>) -> bool {
    let looks = |node: Node<'_, '_>| {
        let is = |name: &str, known: &[&str]| known.iter().any(|k| k.eq_ignore_ascii_case(name));
        is(node.local_name(), &[INERTIAL, "inertia", "ixx"])
            || node.attribute_names().any(|name| is(name, &["ixx", "diaginertia", "fullinertia"]))
    };
    // Of nested ones the outermost is counted.
    looks(node) && !node.ancestors().skip(1).any(|above| above.name() == INERTIAL || looks(above))
}

/// `<mass value=""/>`, `<inertia ixx="" ixy="" ixz="" iyy="" iyz="" izz=""/>`, all required:
/// entries of the inertia matrix in the axes of `<origin>`, whose rotation therefore does not
/// matter here.
fn urdf(inertial: Node<'_, '_>, products: Products) -> Result<Reading, FileBodyError> {
    let missing = |field| FileBodyError::Missing { field };
    let mass = inertial.only_child("mass")?.ok_or(missing("mass"))?;
    let mass = mass.number("value", "mass").ok_or(missing("mass value"))??;
    let inertia = inertial.only_child("inertia")?.ok_or(missing("inertia"))?;
    let mut six = [Number::default(); 6];
    for (number, name) in six.iter_mut().zip(NAMES) {
        *number = inertia.number(name, name).ok_or(missing(name))??;
    }
    Ok(Reading::of_six(Some(mass), &six, products))
}

/// `mass=""` and one of `diaginertia="3 numbers"` and `fullinertia="6 numbers"`, the latter in the
/// order M(1,1), M(2,2), M(3,3), M(1,2), M(1,3), M(2,3). MuJoCo's reference wants one of the two; files
/// without either exist, and mean zeros.
fn mjcf(inertial: Node<'_, '_>, products: Products) -> Result<Reading, FileBodyError> {
    let mass =
        inertial.number("mass", "mass").ok_or(FileBodyError::Missing { field: "mass" })??;
    let (diagonal, full) = (inertial.numbers("diaginertia", 3), inertial.numbers("fullinertia", 6));
    let mut six = [Number::default(); 6];
    match (diagonal, full) {
        (Some(_), Some(_)) => {
            return Err(FileBodyError::Both { first: "diaginertia", second: "fullinertia" });
        }
        (Some(three), None) => six[..3].copy_from_slice(&three?),
        (None, Some(all)) => six.copy_from_slice(&all?),
        (None, None) => {
            // Zeros stand for what is not stated, never for what is spelled in another way.
            let near = |name: &str| name.to_ascii_lowercase().contains("inertia");
            if names_in(inertial).any(near) {
                return Err(FileBodyError::Missing { field: "diaginertia" });
            }
        }
    }
    Ok(Reading::of_six(Some(mass), &six, products))
}

/// `<mass>`, `<inertia><ixx>…`: entries of the inertia matrix ("the product of inertia convention
/// -m x y (not +m x y) is used", says SDFormat 1.10), absent ones being those of the unit matrix,
/// an absent mass 1 kg. In SDFormat 1.0 they are attributes: `<inertial mass=""><inertia ixx=""/>`.
fn sdf(inertial: Node<'_, '_>, products: Products) -> Result<Reading, FileBodyError> {
    const SHAPE: FileBodyError =
        FileBodyError::Shape { field: "inertia", allowed: "ixx, iyy, izz, ixy, ixz and iyz in it" };
    let allowed = has_attributes(inertial);
    let entry = |node: Node<'_, '_>, name| match (node.number(name, name), node.only_child(name)?) {
        (Some(_), Some(_)) => {
            Err(FileBodyError::Both { first: "an attribute", second: "an element" })
        }
        (Some(number), None) if allowed => number.map(Some),
        (Some(_), None) => Err(FileBodyError::Attribute { field: name }),
        (None, Some(element)) => element.number_inside(name).map(Some),
        (None, None) => Ok(None),
    };
    // Defaults stand for what is not stated, never for what is spelled in another way.
    for (name, near) in names_in(inertial).flat_map(|name| ["mass", "inertia"].map(|n| (name, n))) {
        if name != near && name.eq_ignore_ascii_case(near) {
            return Err(FileBodyError::Missing { field: near });
        }
    }
    let inertia = inertial.only_child("inertia")?;
    if inertia.is_some_and(|inertia| {
        inertia.has_text() || names_in(inertia).any(|name| !NAMES.contains(&name))
    }) {
        return Err(SHAPE);
    }
    let mass = entry(inertial, "mass")?.unwrap_or(Number::default_of(1.0));
    let mut six = [Number::default(); 6];
    for ((number, name), (row, column)) in six.iter_mut().zip(NAMES).zip(ENTRIES) {
        let default = Number::default_of(if row == column { 1.0 } else { 0.0 });
        let stated = inertia.map(|inertia| entry(inertia, name)).transpose()?.flatten();
        *number = stated.unwrap_or(default);
    }
    Ok(Reading::of_six(Some(mass), &six, products))
}

/// Whether the simulator computes an inertia of SDF from the shapes.
pub(crate) fn is_computed(inertial: Node<'_, '_>) -> bool {
    inertial.attribute("auto").map(truth) == Some(Some(true))
}

/// What stands there is not used where the simulator computes the inertia from the shapes.
fn sdf_or_computed(inertial: Node<'_, '_>, products: Products) -> Result<Reading, Trouble> {
    if is_computed(inertial) {
        return Err(Trouble::Gap(GapKind::Computed));
    }
    match inertial.attribute("auto").map(truth) {
        Some(None) => Err(Trouble::Body(FileBodyError::Shape {
            field: "auto",
            allowed: "true or false in it",
        })),
        Some(Some(_)) | None => sdf(inertial, products).map_err(Trouble::Body),
    }
}

/// Names of attributes and children, but for those that are none of the format's.
fn names_in<'a>(node: Node<'_, 'a>) -> impl Iterator<Item = &'a str> {
    let all = node.attribute_names().chain(node.children().map(Node::name));
    all.filter(|name| !name.contains(':') && *name != "xmlns")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::Text;

    fn bodies(xml: &str) -> Vec<FileBody> {
        let text = Text::new(xml.as_bytes(), false).unwrap();
        let tree = Tree::parse(&text).unwrap();
        let format = format_of(&tree, None).unwrap();
        read(&tree, format, None, Products::TensorEntries).unwrap().0
    }

    fn six(body: &FileBody) -> [f64; 6] {
        let matrix = body.inertia().unwrap();
        assert_eq!(matrix, &matrix.transpose());
        ENTRIES.map(|entry| matrix[entry])
    }

    const IN_ORDER: [f64; 6] = [10.0, 11.0, 12.0, 0.1, 0.2, 0.3];

    #[test]
    fn each_format_puts_each_number_in_its_place() {
        let urdf = "<robot><link name='a'><inertial><origin rpy='1 2 3'/><mass value='2'/>\n\
                    <inertia ixx='10' ixy='.1' ixz='0.2' iyy='11' iyz='3e-1' izz='+12.'/>\
                    </inertial></link><link name='b'/></robot>";
        let mjcf = "<mujoco><worldbody><body name='a'>\n<inertial pos='0 0 0' mass='2' \
                    fullinertia='10 11 12 .1 .2 .3'/><body name='b'/></body></worldbody></mujoco>";
        let sdf = "<sdf version='1.7'><model name='m'><link name='a'><inertial><mass>2</mass>\n\
                   <inertia><iyz>.3</iyz><ixx> 10 </ixx><ixy>.1</ixy><ixz>.2</ixz><iyy>11</iyy>\
                   <izz>12</izz></inertia></inertial></link></model></sdf>";
        for xml in [urdf, mjcf, sdf] {
            let bodies = bodies(xml);
            assert_eq!(bodies.len(), 1, "{xml}");
            assert_eq!((bodies[0].name(), bodies[0].line()), ("a", 2), "{xml}");
            assert_eq!(bodies[0].mass_kg(), Some(2.0), "{xml}");
            assert_eq!(six(&bodies[0]), IN_ORDER, "{xml}");
        }
    }

    #[test]
    fn defaults_are_those_of_the_format() {
        let sdf = bodies(
            "<sdf><model><link name='a'><inertial/></link><link name='b'><inertial><inertia><iyy>3\
             </iyy></inertia></inertial></link><link name='c'><inertial auto='true'/></link>\
             </model></sdf>",
        );
        assert_eq!(sdf.len(), 2, "an inertial that is computed is not judged");
        assert_eq!((six(&sdf[0]), sdf[0].mass_kg()), ([1.0, 1.0, 1.0, 0.0, 0.0, 0.0], Some(1.0)));
        assert_eq!(six(&sdf[1])[..3], [1.0, 3.0, 1.0]);
        let mjcf = bodies(
            "<mujoco><body><inertial mass='1' diaginertia='1 2 3'/></body>\
             <body><inertial mass='1'/></body></mujoco>",
        );
        assert_eq!(six(&mjcf[0]), [1.0, 2.0, 3.0, 0.0, 0.0, 0.0]);
        assert_eq!(six(&mjcf[1]), [0.0; 6]);
    }

    #[test]
    fn one_bad_body_leaves_the_others_alone() {
        let link = |attributes: &str| {
            format!(
                "<link name='l'><inertial><mass value='1'/><inertia {attributes}/></inertial></link>"
            )
        };
        let xml = format!(
            "<robot>{}{}{}{}<link name='x'><inertial/></link></robot>",
            link("ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'"),
            link("ixx='1' ixy='0' ixz='0' iyy='1' iyz='0'"),
            link("ixx='${m}' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'"),
            link("ixx='1' ixy='0' ixz='0' iyy='nan' iyz='0' izz='1'"),
        );
        let bodies = bodies(&xml);
        let error = |i: usize| bodies[i].inertia().unwrap_err().to_string();
        assert!(bodies[0].inertia().is_ok());
        assert_eq!(error(1), "izz is missing");
        assert!(error(2).contains("an expression"), "{}", error(2));
        assert_eq!(error(3), "iyy = \"nan\": it must be finite");
        assert_eq!(error(4), "mass is missing");
    }

    #[test]
    fn mjcf_wants_one_inertia_and_all_its_numbers() {
        let error = |attributes: &str| {
            let xml = format!("<mujoco><body><inertial {attributes}/></body></mujoco>");
            bodies(&xml)[0].inertia().unwrap_err().to_string()
        };
        assert_eq!(error("diaginertia='1 1 1'"), "mass is missing");
        assert!(error("mass='1' diaginertia='1 1'").contains("there must be 3"));
        assert!(error("mass='1' fullinertia='1 1 1'").contains("there must be 6"));
        assert!(error("mass='1' diaginertia='1 1 1' fullinertia='1 1 1 0 0 0'").contains("both"));
    }
}
