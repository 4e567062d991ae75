//! URDF, MJCF and SDF: where each keeps its inertias, and what its numbers mean.

use crate::{
    Body, BodyError, FileProblem, Format, MAX_BODIES, Products,
    body::{ENTRIES, NAMES, Number, Reading},
    text::Refusal,
    xml::{Node, Tree},
};

/// The format of a root element.
pub(crate) fn format_of(root: &str) -> Option<Format> {
    match root {
        "robot" => Some(Format::Urdf),
        "mujoco" | "mujocoinclude" => Some(Format::Mjcf),
        "sdf" | "gazebo" => Some(Format::Sdf),
        _ => None,
    }
}

pub(crate) fn read(
    tree: &Tree<'_>,
    format: Format,
    products: Products,
) -> Result<Vec<Body>, Refusal> {
    let mut bodies = Vec::new();
    for node in tree.all("inertial") {
        if bodies.len() == MAX_BODIES {
            return Err(Refusal { line: Some(node.line()), problem: FileProblem::TooManyBodies });
        }
        let reading = match format {
            Format::Mjcf => mjcf(node, products),
            // Computed by the simulator from the shapes: what stands there is not used.
            Format::Sdf if node.attribute("auto").is_some_and(|a| a == "true" || a == "1") => {
                continue;
            }
            Format::Sdf => sdf(node, products),
            _ => urdf(node, products),
        };
        // The line of the numbers, not of the element around them.
        let line = node.child("inertia").unwrap_or(node).line();
        bodies.push(Body::new(node.name_above(), line, reading));
    }
    Ok(bodies)
}

/// `<mass value=""/>`, `<inertia ixx="" ixy="" ixz="" iyy="" iyz="" izz=""/>`, all required:
/// entries of the inertia matrix in the axes of `<origin>`, whose rotation therefore does not
/// matter here.
fn urdf(inertial: Node<'_, '_>, products: Products) -> Result<Reading, BodyError> {
    let missing = |field| BodyError::Missing { field };
    let mass = inertial.child("mass").ok_or(missing("mass"))?;
    let mass = mass.number("value", "mass").ok_or(missing("mass value"))??;
    let inertia = inertial.child("inertia").ok_or(missing("inertia"))?;
    let mut six = [Number::default(); 6];
    for (number, name) in six.iter_mut().zip(NAMES) {
        *number = inertia.number(name, name).ok_or(missing(name))??;
    }
    Ok(Reading::of_six(Some(mass), &six, products))
}

/// `mass=""` and one of `diaginertia="3 numbers"` and `fullinertia="6 numbers"`, the latter in the
/// order M(1,1), M(2,2), M(3,3), M(1,2), M(1,3), M(2,3). MuJoCo's reference wants one of the two; files
/// without either exist, and mean zeros.
fn mjcf(inertial: Node<'_, '_>, products: Products) -> Result<Reading, BodyError> {
    let mass = inertial.number("mass", "mass").ok_or(BodyError::Missing { field: "mass" })??;
    let (diagonal, full) = (inertial.numbers("diaginertia", 3), inertial.numbers("fullinertia", 6));
    let mut six = [Number::default(); 6];
    match (diagonal, full) {
        (Some(_), Some(_)) => {
            return Err(BodyError::Both { first: "diaginertia", second: "fullinertia" });
        }
        (Some(three), None) => six[..3].copy_from_slice(&three?),
        (None, Some(all)) => six.copy_from_slice(&all?),
        (None, None) => {}
    }
    Ok(Reading::of_six(Some(mass), &six, products))
}

/// `<mass>`, `<inertia><ixx>…`: entries of the inertia matrix ("the product of inertia convention
/// -m x y (not +m x y) is used", says SDFormat 1.10), absent ones being those of the unit matrix,
/// an absent mass 1 kg.
fn sdf(inertial: Node<'_, '_>, products: Products) -> Result<Reading, BodyError> {
    let mass = match inertial.child("mass") {
        Some(mass) => mass.number_inside("mass")?,
        None => Number::default_of(1.0),
    };
    let inertia = inertial.child("inertia");
    let mut six = [Number::default(); 6];
    for ((number, name), (row, column)) in six.iter_mut().zip(NAMES).zip(ENTRIES) {
        *number = match inertia.and_then(|inertia| inertia.child(name)) {
            Some(entry) => entry.number_inside(name)?,
            None => Number::default_of(if row == column { 1.0 } else { 0.0 }),
        };
    }
    Ok(Reading::of_six(Some(mass), &six, products))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::Text;

    fn bodies(xml: &str) -> Vec<Body> {
        let text = Text::new(xml.as_bytes(), false).unwrap();
        let tree = Tree::parse(&text).unwrap();
        let format = format_of(tree.root()).unwrap();
        read(&tree, format, Products::TensorEntries).unwrap()
    }

    fn six(body: &Body) -> [f64; 6] {
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
