//! Whether two files are one robot with other mass properties.

use crate::{edit::is_same_but_numbers, holder::INERTIAL, text::Text, xml::Tree};

/// Whether two files are the same but for numbers and for what stands in elements `<inertial>`: copies of one robot
/// are, whichever of their numbers were drawn. Comments count.
#[must_use]
pub fn is_same_robot(one: &[u8], other: &[u8]) -> bool {
    is_same_but_numbers(one, other)
        || match (without_inertials(one), without_inertials(other)) {
            (Some(one), Some(other)) => is_same_but_numbers(one.as_bytes(), other.as_bytes()),
            (Some(_) | None, _) => false,
        }
}

/// The text with an empty element in the place of every `<inertial>`, and the comments in it after that.
fn without_inertials(bytes: &[u8]) -> Option<String> {
    let text = Text::new(bytes, false).ok()?;
    let tree = Tree::parse(&text).ok()?;
    let (mut out, mut done) = (String::new(), 0);
    for node in tree.all(INERTIAL) {
        let place = node.place();
        // One inside of another is gone with it.
        if place.start >= done {
            out += text.as_str().get(done..place.start)?;
            out += "<inertial/>";
            let inside = text.as_str().get(place.start..place.end)?;
            let comments = inside.split("<!--").skip(1).filter_map(|rest| rest.split_once("-->"));
            out.extend(comments.map(|(comment, _)| comment));
            done = place.end;
        }
    }
    out += text.as_str().get(done..)?;
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mass_properties_alone_may_differ() {
        let robot = |inertial: &str| {
            format!("<robot name=\"a\"><link name=\"b\">{inertial}<visual/></link></robot>")
        };
        let same = [
            "<inertial/>",
            "<inertial mass='1'/>",
            "<inertial>\n<mass value=\"2\"/></inertial>",
            "<inertial><inertial><origin/></inertial>x</inertial>",
        ];
        for (one, other) in same.iter().flat_map(|a| same.map(|b| (a, b))) {
            assert!(is_same_robot(robot(one).as_bytes(), robot(other).as_bytes()), "{one} {other}");
        }
        let others = [
            "",
            "<inertial/><inertial/>",
            "<inertial><!-- mine --></inertial>",
            "<inertial/> ",
            "<inertia/>",
            "<inertial>",
            "<!-- <inertial/> -->",
        ];
        for (one, other) in others.iter().flat_map(|a| same.map(|b| (a, b))) {
            assert!(
                !is_same_robot(robot(one).as_bytes(), robot(other).as_bytes()),
                "{one} {other}"
            );
        }
        assert!(is_same_robot(b"1 a", b"2 a") && !is_same_robot(b"a", b"b"));
    }
}
