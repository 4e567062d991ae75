//! The elements of an XML file in the order they stand, with byte positions.
//!
//! Namespaces are not resolved, for files expanded from xacro keep prefixes that nobody declares: an element without a prefix, or
//! with that of the root, is one of the format, and any other is a macro of xacro or somebody's own.

use quick_xml::{
    Reader,
    events::{BytesStart, Event},
};
use std::{borrow::Cow, collections::BTreeSet};

use crate::{
    FileBodyError, FileProblem, MAX_ATTRIBUTES, MAX_DEPTH,
    body::{Number, Place, shortened},
    entities::{entities_in, is_character},
    error::Refusal,
    text::Text,
};

#[derive(Debug)]
struct Attribute<'a> {
    name: &'a str,
    value: Cow<'a, str>,
    /// Where the value stands; nowhere if it is written with entities.
    start: Option<usize>,
    /// From its name to the quote after its value.
    whole: Option<Place>,
}

/// An element, its attributes, and the text in it.
#[derive(Debug)]
pub(crate) struct Element<'a> {
    /// Its name as it is written.
    written: &'a str,
    /// Its name without the prefix of the root.
    name: &'a str,
    start: usize,
    /// Where its content begins, if it has an end tag.
    inside: Option<usize>,
    /// Where its `/>` stands, if it has none.
    closed: Option<usize>,
    parent: Option<usize>,
    /// Index after its last descendant.
    end: usize,
    /// Where it ends.
    after: usize,
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
    /// Where references to entities stand that the file declares itself.
    entities: Vec<usize>,
    /// The prefixes that are declared for macros.
    macros: BTreeSet<&'a str>,
}

/// The usual prefix of macros, and a part of what any other is declared as.
pub(crate) const MACROS: &str = "xacro";

/// The prefix of a name, empty if there is none, and the name after it.
fn parts(name: &str) -> (&str, &str) {
    name.split_once(':').unwrap_or(("", name))
}

impl<'a> Tree<'a> {
    pub(crate) fn parse(source: &'a Text) -> Result<Self, Refusal> {
        let text = source.as_str();
        let mut reader = Reader::from_str(text);
        let mut tree =
            Self { source, elements: Vec::new(), entities: Vec::new(), macros: BTreeSet::new() };
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
                    tree.elements[index].inside = usize::try_from(reader.buffer_position()).ok();
                    open.push(index);
                    if open.len() > MAX_DEPTH {
                        return Err(source.refuse(before, FileProblem::TooDeep));
                    }
                }
                Event::Empty(tag) => {
                    let index = tree.push(&tag, open.last().copied(), before)?;
                    let after = usize::try_from(reader.buffer_position()).ok();
                    tree.elements[index].closed = after.and_then(|after| after.checked_sub(2));
                    tree.elements[index].after = after.unwrap_or(before);
                }
                Event::End(_) => {
                    // That there is one, and of this name, the reader has checked.
                    if let Some(index) = open.pop() {
                        let after = usize::try_from(reader.buffer_position());
                        tree.elements[index].end = tree.elements.len();
                        tree.elements[index].after = after.unwrap_or(before);
                    }
                }
                Event::Text(part) => tree.add_text(&part, &open, before)?,
                Event::CData(part) => tree.add_text(&part, &open, before)?,
                Event::GeneralRef(reference) => match open.last() {
                    Some(index) => {
                        tree.elements[*index].broken = true;
                        if !is_character(&reference) {
                            tree.entities.push(before);
                        }
                    }
                    None => return Err(source.malformed(before, "a reference outside the root")),
                },
                Event::Eof => break,
                Event::Comment(_) | Event::Decl(_) | Event::PI(_) | Event::DocType(_) => {}
            }
        }
        if let Some(index) = open.last() {
            let Element { written, start, .. } = tree.elements[*index];
            return Err(source.malformed(start, format!("<{}> is not closed", shortened(written))));
        }
        if tree.elements.is_empty() {
            return Err(source.malformed(0, "there is no element"));
        }
        tree.macros = tree.macro_prefixes();
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
            // What is not expanded stands as it is, and is told.
            let value = quick_xml::escape::unescape(raw).unwrap_or(Cow::Borrowed(raw));
            let at = source.offset_of(raw).unwrap_or(before);
            self.entities.extend(std::iter::repeat_n(at, entities_in(raw)));
            let start = if value == raw { source.offset_of(raw) } else { None };
            let name = self.own(attribute.key.as_ref());
            let whole = source.offset_of(name).zip(source.offset_of(raw));
            let whole = whole.map(|(start, value)| Place { start, end: value + raw.len() + 1 });
            attributes.push(Attribute { name, value, start, whole });
        }
        let index = self.elements.len();
        let written = self.own(tag.name().as_ref());
        let root = self.elements.first().map_or(written, |root| root.written);
        let is_own = parts(written).0 == parts(root).0;
        self.elements.push(Element {
            written,
            name: if is_own { parts(written).1 } else { written },
            start: before,
            inside: None,
            closed: None,
            parent,
            end: index + 1,
            after: before,
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

    /// The root element.
    pub(crate) fn root(&self) -> Node<'_, 'a> {
        Node { tree: self, index: 0 }
    }

    /// All elements.
    pub(crate) fn nodes(&self) -> impl Iterator<Item = Node<'_, 'a>> {
        (0..self.elements.len()).map(|index| Node { tree: self, index })
    }

    /// All elements of this name.
    pub(crate) fn all(&self, name: &str) -> impl Iterator<Item = Node<'_, 'a>> {
        self.nodes().filter(move |node| node.name() == name)
    }

    /// An attribute of the last element of this name that has it.
    pub(crate) fn said(&self, element: &str, attribute: &str) -> Option<&str> {
        self.all(element).filter_map(|node| node.attribute(attribute)).last()
    }

    /// Lines of the references to entities that the file declares itself, which are not expanded.
    pub(crate) fn entities(&self) -> impl Iterator<Item = usize> {
        self.entities.iter().map(|at| self.source.line(*at))
    }

    /// Whether a prefix is declared for macros, which says that the file is written with xacro.
    pub(crate) fn declares_macros(&self) -> bool {
        !self.macros.is_empty()
    }

    fn macro_prefixes(&self) -> BTreeSet<&'a str> {
        let attributes = self.elements.iter().flat_map(|element| &element.attributes);
        let declared = attributes.filter_map(|attribute| {
            let prefix = attribute.name.strip_prefix("xmlns:")?;
            attribute.value.contains(MACROS).then_some(prefix)
        });
        declared.collect()
    }
}

/// An element in its tree.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node<'t, 'a> {
    tree: &'t Tree<'a>,
    index: usize,
}

impl PartialEq for Node<'_, '_> {
    /// Of one tree: the same element.
    fn eq(&self, other: &Self) -> bool {
        self.index == other.index
    }
}

impl<'t, 'a> Node<'t, 'a> {
    fn element(self) -> &'t Element<'a> {
        &self.tree.elements[self.index]
    }

    /// Its name in the format: without the prefix of the root, and with any other, so that it is none of the format's then.
    pub(crate) fn name(self) -> &'a str {
        self.element().name
    }

    /// Its name after any prefix.
    pub(crate) fn local_name(self) -> &'a str {
        parts(self.element().written).1
    }

    /// Whether it is a macro of xacro.
    pub(crate) fn is_macro(self) -> bool {
        let prefix = self.prefix();
        // Old versions knew their elements without a prefix, and no format has one of this name.
        prefix == MACROS || self.tree.macros.contains(prefix) || self.name() == "insert_block"
    }

    /// The prefix of its name, empty if it has none.
    pub(crate) fn prefix(self) -> &'a str {
        parts(self.element().written).0
    }

    pub(crate) fn line(self) -> usize {
        self.tree.source.line(self.element().start)
    }

    /// From its beginning to its end.
    pub(crate) fn place(self) -> Place {
        Place { start: self.element().start, end: self.element().after }
    }

    pub(crate) fn parent(self) -> Option<Self> {
        Some(Self { tree: self.tree, index: self.element().parent? })
    }

    pub(crate) fn children(self) -> impl Iterator<Item = Self> {
        self.descendants().filter(move |node| node.element().parent == Some(self.index))
    }

    /// What stands in it at any depth.
    pub(crate) fn descendants(self) -> impl Iterator<Item = Self> {
        (self.index + 1..self.element().end).map(move |index| Self { tree: self.tree, index })
    }

    /// The first child of this name.
    pub(crate) fn child(self, name: &str) -> Option<Self> {
        self.children().find(|node| node.name() == name)
    }

    /// As [`child`](Self::child), where the format has one at most: readers of files with two do not agree which counts.
    pub(crate) fn only_child(self, name: &'static str) -> Result<Option<Self>, FileBodyError> {
        let mut named = self.children().filter(|node| node.name() == name);
        let child = named.next();
        if named.next().is_some() {
            Err(FileBodyError::Several { element: name })
        } else {
            Ok(child)
        }
    }

    /// This element and those around it, from the inside.
    pub(crate) fn ancestors(self) -> impl Iterator<Item = Self> {
        std::iter::successors(Some(self), |node| node.parent())
    }

    pub(crate) fn attribute_names(self) -> impl Iterator<Item = &'a str> {
        self.element().attributes.iter().map(|attribute| attribute.name)
    }

    /// The text in it, up to its first child.
    pub(crate) fn text(self) -> &'a str {
        self.element().text.trim()
    }

    /// Whether there is text in it, or what may be some.
    pub(crate) fn has_text(self) -> bool {
        !self.element().text.is_empty() || self.element().broken
    }

    fn find(self, name: &str) -> Option<&'t Attribute<'a>> {
        self.element().attributes.iter().find(|a| a.name == name)
    }

    pub(crate) fn attribute(self, name: &str) -> Option<&'t str> {
        self.find(name).map(|a| &*a.value)
    }

    /// The name of the body around: of a link, a body, a macro, or the link that a block for Gazebo
    /// refers to; empty if there is none.
    pub(crate) fn name_above(self) -> String {
        let key = |node: &Self| match node.name() {
            "link" | "body" => Some("name"),
            "gazebo" => Some("reference"),
            _ => (node.local_name() == "macro").then_some("name"),
        };
        let found = self.ancestors().skip(1).find_map(|node| Some((node, key(&node)?)));
        found.and_then(|(node, key)| node.attribute(key)).unwrap_or_default().to_owned()
    }

    /// The number in an attribute, if the attribute is there.
    pub(crate) fn number(
        self,
        name: &str,
        field: &'static str,
    ) -> Option<Result<Number, FileBodyError>> {
        self.find(name).map(|a| Number::parse(field, &a.value, a.start))
    }

    /// The numbers in an attribute, if the attribute is there.
    pub(crate) fn numbers(
        self,
        name: &'static str,
        allowed: usize,
    ) -> Option<Result<Vec<Number>, FileBodyError>> {
        self.find(name).map(|a| Number::parse_list(name, &a.value, a.start, allowed))
    }

    /// An attribute with its name and quotes, if it is there.
    pub(crate) fn whole(self, name: &str) -> Option<Place> {
        self.find(name)?.whole
    }

    /// Where an attribute more can be written, after a blank.
    pub(crate) fn after_name(self) -> usize {
        self.element().start + 1 + self.element().written.len()
    }

    /// Where a child more can be written: in an element without an end tag, before its `/>`.
    pub(crate) fn inside(self) -> Option<usize> {
        self.element().inside.or(self.element().closed)
    }

    /// Where `/>` stands that ends this element, and the end tag that it stands for.
    pub(crate) fn closed(self) -> Option<(usize, String)> {
        Some((self.element().closed?, format!("</{}>", self.element().written)))
    }

    /// The numbers that are the text of this element.
    pub(crate) fn numbers_inside(
        self,
        field: &'static str,
        allowed: usize,
    ) -> Result<Vec<Number>, FileBodyError> {
        let text = self.plain_text(field)?;
        Number::parse_list(field, text, self.tree.source.offset_of(text), allowed)
    }

    /// The number that is the text of this element.
    pub(crate) fn number_inside(self, field: &'static str) -> Result<Number, FileBodyError> {
        let text = self.plain_text(field)?;
        Number::parse(field, text, self.tree.source.offset_of(text))
    }

    /// The text of this element where there is nothing else in it; programs do not agree on what the rest means.
    fn plain_text(self, field: &'static str) -> Result<&'a str, FileBodyError> {
        let element = self.element();
        if !element.broken {
            return Ok(element.text);
        }
        let inside = element.inside.unwrap_or(element.after)..element.after;
        let inside = self.tree.source.as_str().get(inside).unwrap_or_default();
        let content = inside.rsplit_once("</").map_or(inside, |(content, _)| content).trim();
        Err(FileBodyError::NotPlain { field, value: shortened(content) })
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
        assert_eq!(tree.root().name(), "a");
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
