//! The elements of an XML file in the order they stand, with byte positions.
//!
//! Namespaces are not resolved: files expanded from xacro keep prefixes that nobody declares.

use quick_xml::{
    Reader,
    events::{BytesStart, Event},
};
use std::borrow::Cow;

use crate::{
    BodyError, FileProblem, MAX_ATTRIBUTES, MAX_DEPTH,
    body::{Number, shortened},
    text::{Refusal, Text},
};

#[derive(Debug)]
struct Attribute<'a> {
    name: &'a str,
    value: Cow<'a, str>,
    /// Where the value stands; nowhere if it is written with entities.
    start: Option<usize>,
}

/// An element, its attributes, and the text in it.
#[derive(Debug)]
pub(crate) struct Element<'a> {
    name: &'a str,
    start: usize,
    parent: Option<usize>,
    /// Index after its last descendant.
    end: usize,
    attributes: Vec<Attribute<'a>>,
    text: &'a str,
    /// More text after a child, or entities in it.
    broken: bool,
}

/// All elements, in document order.
#[derive(Debug)]
pub(crate) struct Tree<'a> {
    source: &'a Text,
    elements: Vec<Element<'a>>,
}

impl<'a> Tree<'a> {
    pub(crate) fn parse(source: &'a Text) -> Result<Self, Refusal> {
        let text = source.as_str();
        let mut reader = Reader::from_str(text);
        let mut tree = Self { source, elements: Vec::new() };
        let mut open: Vec<usize> = Vec::new();
        loop {
            let before = usize::try_from(reader.buffer_position()).unwrap_or(text.len());
            let event = reader.read_event().map_err(|error| {
                let at = usize::try_from(reader.error_position()).unwrap_or(before);
                source.malformed(at, error)
            })?;
            match event {
                Event::Start(tag) => {
                    let index = tree.push(&tag, open.last().copied(), before)?;
                    open.push(index);
                    if open.len() > MAX_DEPTH {
                        return Err(source.refuse(before, FileProblem::TooDeep));
                    }
                }
                Event::Empty(tag) => {
                    tree.push(&tag, open.last().copied(), before)?;
                }
                Event::End(_) => {
                    // That there is one, and of this name, the reader has checked.
                    if let Some(index) = open.pop() {
                        tree.elements[index].end = tree.elements.len();
                    }
                }
                Event::Text(part) => tree.add_text(&part, &open, before)?,
                Event::CData(part) => tree.add_text(&part, &open, before)?,
                Event::GeneralRef(_) => match open.last() {
                    Some(index) => tree.elements[*index].broken = true,
                    None => return Err(source.malformed(before, "a reference outside the root")),
                },
                Event::Eof => break,
                Event::Comment(_) | Event::Decl(_) | Event::PI(_) | Event::DocType(_) => {}
            }
        }
        if let Some(index) = open.last() {
            let Element { name, start, .. } = tree.elements[*index];
            return Err(source.malformed(start, format!("<{}> is not closed", shortened(name))));
        }
        if tree.elements.is_empty() {
            return Err(source.malformed(0, "there is no element"));
        }
        Ok(tree)
    }

    fn push(
        &mut self,
        tag: &BytesStart<'_>,
        parent: Option<usize>,
        before: usize,
    ) -> Result<usize, Refusal> {
        let source = self.source;
        if parent.is_none() && !self.elements.is_empty() {
            return Err(source.malformed(before, "there is more than one root element"));
        }
        let mut attributes = Vec::new();
        for attribute in tag.attributes() {
            let attribute = attribute.map_err(|error| {
                // Its position is one within the tag.
                let message = error.to_string();
                source.malformed(before, message.split_once(": ").map_or(&*message, |(_, m)| m))
            })?;
            if attributes.len() == MAX_ATTRIBUTES {
                return Err(source.refuse(before, FileProblem::TooManyAttributes));
            }
            let raw = self.own(&attribute.value);
            let value = quick_xml::escape::unescape(raw).unwrap_or(Cow::Borrowed(raw));
            let start = if value == raw { source.offset_of(raw) } else { None };
            attributes.push(Attribute { name: self.own(attribute.key.as_ref()), value, start });
        }
        let index = self.elements.len();
        self.elements.push(Element {
            name: self.own(tag.name().as_ref()),
            start: before,
            parent,
            end: index + 1,
            attributes,
            text: "",
            broken: false,
        });
        Ok(index)
    }

    /// The part of the source that an event shows, with the lifetime of the source.
    fn own(&self, part: &str) -> &'a str {
        let whole = self.source.as_str();
        self.source
            .offset_of(part)
            .and_then(|start| whole.get(start..start + part.len()))
            .unwrap_or_default()
    }

    fn add_text(&mut self, part: &str, open: &[usize], before: usize) -> Result<(), Refusal> {
        if part.trim_ascii().is_empty() {
            return Ok(());
        }
        let part = self.own(part);
        let Some(index) = open.last() else {
            let at = self.source.offset_of(part.trim_ascii_start()).unwrap_or(before);
            return Err(self.source.malformed(at, "there is text outside the root element"));
        };
        let element = &mut self.elements[*index];
        if element.text.is_empty() {
            element.text = part;
        } else {
            element.broken = true;
        }
        Ok(())
    }

    /// Name of the root element.
    pub(crate) fn root(&self) -> &'a str {
        self.elements[0].name
    }

    /// All elements of this name.
    pub(crate) fn all(&self, name: &str) -> impl Iterator<Item = Node<'_, 'a>> {
        (0..self.elements.len())
            .filter(move |index| self.elements[*index].name == name)
            .map(|index| Node { tree: self, index })
    }
}

/// An element in its tree.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node<'t, 'a> {
    tree: &'t Tree<'a>,
    index: usize,
}

impl<'t, 'a> Node<'t, 'a> {
    fn element(self) -> &'t Element<'a> {
        &self.tree.elements[self.index]
    }

    pub(crate) fn name(self) -> &'a str {
        self.element().name
    }

    pub(crate) fn line(self) -> usize {
        self.tree.source.line(self.element().start)
    }

    pub(crate) fn parent(self) -> Option<Self> {
        Some(Self { tree: self.tree, index: self.element().parent? })
    }

    /// The first child of this name.
    pub(crate) fn child(self, name: &str) -> Option<Self> {
        (self.index + 1..self.element().end)
            .map(|index| Self { tree: self.tree, index })
            .find(|node| node.element().parent == Some(self.index) && node.name() == name)
    }

    fn find(self, name: &str) -> Option<&'t Attribute<'a>> {
        self.element().attributes.iter().find(|a| a.name == name)
    }

    pub(crate) fn attribute(self, name: &str) -> Option<&'t str> {
        self.find(name).map(|a| &*a.value)
    }

    /// The name of the body around: of a link, a body or a macro, empty if it has none.
    pub(crate) fn name_above(self) -> String {
        let mut node = self.parent();
        while let Some(above) = node {
            if matches!(above.name(), "link" | "body" | "xacro:macro") {
                return above.attribute("name").unwrap_or_default().to_owned();
            }
            node = above.parent();
        }
        String::new()
    }

    /// The number in an attribute, if the attribute is there.
    pub(crate) fn number(
        self,
        name: &str,
        field: &'static str,
    ) -> Option<Result<Number, BodyError>> {
        self.find(name).map(|a| Number::parse(field, &a.value, a.start))
    }

    /// The numbers in an attribute, if the attribute is there.
    pub(crate) fn numbers(
        self,
        name: &'static str,
        allowed: usize,
    ) -> Option<Result<Vec<Number>, BodyError>> {
        self.find(name).map(|a| Number::parse_list(name, &a.value, a.start, allowed))
    }

    /// The number that is the text of this element.
    pub(crate) fn number_inside(self, field: &'static str) -> Result<Number, BodyError> {
        let element = self.element();
        if element.broken {
            return Err(BodyError::NotANumber { field, value: shortened(element.text) });
        }
        Number::parse(field, element.text, self.tree.source.offset_of(element.text))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(xml: &str) -> (Option<usize>, String) {
        let text = Text::new(xml.as_bytes(), false).unwrap();
        let Refusal { line, problem } = Tree::parse(&text).unwrap_err();
        (line, problem.to_string())
    }

    #[test]
    fn elements_attributes_and_texts_have_their_places() {
        let xml = "<a>\n <b c='1 &amp; 2' d=\"3\"> 4 <!-- five --></b><b/></a>";
        let text = Text::new(xml.as_bytes(), false).unwrap();
        let tree = Tree::parse(&text).unwrap();
        assert_eq!(tree.root(), "a");
        let b = tree.all("b").next().unwrap();
        assert_eq!((b.line(), b.attribute("c"), tree.all("b").count()), (2, Some("1 & 2"), 2));
        let place = b.number("d", "d").unwrap().unwrap().place.unwrap();
        assert_eq!(&xml[place.start..place.end], "3");
        let place = b.number_inside("b").unwrap().place.unwrap();
        assert_eq!(&xml[place.start..place.end], "4");
        assert!(b.find("c").unwrap().start.is_none(), "an entity has no place");
    }

    #[test]
    fn malformed_files_are_refused_with_their_line() {
        for (xml, line, words) in [
            ("<a>\n<b>\n</a>", 3, "expected"),
            ("<a>\n<b>\n", 2, "<b> is not closed"),
            ("<a>\n<b c='1' c='2'/></a>", 2, "duplicate"),
            ("<a>\n<b c=1/></a>", 2, "enclosed in"),
            ("<a>\n<b c/></a>", 2, "="),
            ("<a/>\n<b/>", 2, "more than one root"),
            ("<a/>\ntext", 2, "outside the root"),
            ("text", 1, "outside the root"),
            ("<!-- nothing -->", 1, "no element"),
            ("<a>\n<!-- open </a>", 2, "comment"),
            ("<a>\n</a></a>", 2, "does not match"),
        ] {
            let (at, message) = refusal(xml);
            assert!(message.contains(words), "{xml}: {message}");
            assert_eq!(at, Some(line), "{xml}: {message}");
        }
    }

    #[test]
    fn depth_and_attributes_are_limited() {
        let deep = |n: usize| format!("{}{}", "<a>".repeat(n), "</a>".repeat(n));
        assert!(refusal(&deep(MAX_DEPTH + 1)).1.contains("deeper than 256"));
        let text = Text::new(deep(MAX_DEPTH).as_bytes(), false).unwrap();
        assert!(Tree::parse(&text).is_ok());
        let wide: String = (0..300).map(|i| format!(" a{i}=''")).collect();
        assert!(refusal(&format!("<a{wide}/>")).1.contains("more than 256 attributes"));
    }

    #[test]
    fn undeclared_prefixes_are_no_error() {
        let text = Text::new(b"<robot><xacro:if value='1'/></robot>", false).unwrap();
        assert!(Tree::parse(&text).is_ok());
    }
}
