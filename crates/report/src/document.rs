//! Pages as data: sections of words, tables and figures, written as HTML and as Markdown.

use crate::{Drawing, inline::Text, table::PageTable};

/// A page, of which every form is made.
///
/// ```
/// use gyradius_report::{Document, PageTable, Section, Text};
///
/// let runs = [("naive", 0.031), ("physical", 0.012)];
/// let table = PageTable::of(&runs)
///     .words("model", |run| run.0)
///     .numbers("wobble (deg)", |run| format!("{}", run.1));
/// let page = Document::new("Wobble", "Wobble after separation", Text::from("Two ").strong("models"))
///     .section(Section::new("Results").table(table));
/// assert!(page.markdown().contains("| naive | 0.031 |"));
/// assert!(page.html().contains("<th scope=\"row\">naive</th>"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Document {
    pub(crate) title: String,
    pub(crate) heading: String,
    pub(crate) lead: Text,
    pub(crate) sections: Vec<Section>,
}

/// A heading and what stands below it.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    pub(crate) heading: String,
    /// Whether it is shown when it is asked for.
    pub(crate) folded: bool,
    /// Whether it stands in a box: what is to be read first.
    pub(crate) boxed: bool,
    pub(crate) blocks: Vec<Block>,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Block {
    Paragraph(Text),
    Warning(Text),
    List(Vec<Text>),
    Table(PageTable),
    Figure(Drawing),
    /// A file as it is, in a language.
    File(&'static str, String),
    Section(Section),
}

impl Document {
    /// A page with a title, which a browser shows and keeps, a heading, and what it is about.
    #[must_use]
    pub fn new(
        title: impl Into<String>,
        heading: impl Into<String>,
        lead: impl Into<Text>,
    ) -> Self {
        let (title, heading, lead) = (title.into(), heading.into(), lead.into());
        Self { title, heading, lead, sections: Vec::new() }
    }

    /// With more of what it is about: what stands out, and what follows.
    #[must_use]
    pub fn noting(self, strong: impl Into<String>, plain: impl Into<String>) -> Self {
        Self { lead: self.lead.strong(strong).plain(plain), ..self }
    }

    /// With another section.
    #[must_use]
    pub fn section(self, section: Section) -> Self {
        self.sections([section])
    }

    /// With further sections, if there are any.
    #[must_use]
    pub fn sections(mut self, sections: impl IntoIterator<Item = Section>) -> Self {
        self.sections.extend(sections);
        self
    }

    /// With sections before all others, if there are any.
    #[must_use]
    pub fn led_by(mut self, sections: impl IntoIterator<Item = Section>) -> Self {
        self.sections.splice(0..0, sections);
        self
    }

    /// The files that its forms are written to, under a name.
    #[must_use]
    pub fn pages(name: &str) -> [String; 2] {
        ["html", "md"].map(|form| format!("{name}.{form}"))
    }

    /// All that is written of it, names and contents: its figures, and its [`pages`](Self::pages).
    pub fn files(&self, name: &str) -> impl Iterator<Item = (String, String)> {
        let pages = Self::pages(name).into_iter().zip([self.html(), self.markdown()]);
        let figures = self.sections.iter().flat_map(Section::drawings);
        figures.map(|figure| (figure.file(), figure.svg.clone())).chain(pages)
    }
}

impl Section {
    /// A section without anything in it.
    #[must_use]
    pub fn new(heading: impl Into<String>) -> Self {
        Self { heading: heading.into(), folded: false, boxed: false, blocks: Vec::new() }
    }

    /// A section that is shown when it is asked for.
    #[must_use]
    pub fn folded(heading: impl Into<String>) -> Self {
        Self { folded: true, ..Self::new(heading) }
    }

    /// The same in a box: what is to be read first.
    #[must_use]
    pub fn boxed(self) -> Self {
        Self { boxed: true, ..self }
    }

    /// With a paragraph.
    #[must_use]
    pub fn paragraph(self, text: impl Into<Text>) -> Self {
        self.and(Block::Paragraph(text.into().with_signs()))
    }

    /// With what must not be overlooked, a paragraph each.
    #[must_use]
    pub fn warnings<T: Into<Text>>(self, texts: impl IntoIterator<Item = T>) -> Self {
        let signed = texts.into_iter().map(|text| text.into().with_signs());
        signed.fold(self, |section, text| section.and(Block::Warning(text)))
    }

    /// With a list, if there is anything in it.
    #[must_use]
    pub fn list<T: Into<Text>>(self, items: impl IntoIterator<Item = T>) -> Self {
        let items: Vec<Text> = items.into_iter().map(|item| item.into().with_signs()).collect();
        if items.is_empty() { self } else { self.and(Block::List(items)) }
    }

    /// With a table.
    #[must_use]
    pub fn table(self, table: impl Into<PageTable>) -> Self {
        self.and(Block::Table(table.into()))
    }

    /// With figures.
    #[must_use]
    pub fn figures(self, figures: impl IntoIterator<Item = Drawing>) -> Self {
        figures.into_iter().fold(self, |section, figure| section.and(Block::Figure(figure)))
    }

    /// With a file as it is, in a language.
    #[must_use]
    pub fn file(self, language: &'static str, text: impl Into<String>) -> Self {
        self.and(Block::File(language, text.into()))
    }

    /// With sections below it, if there are any.
    #[must_use]
    pub fn sections(self, sections: impl IntoIterator<Item = Self>) -> Self {
        sections.into_iter().fold(self, |section, below| section.and(Block::Section(below)))
    }

    fn and(mut self, block: Block) -> Self {
        self.blocks.push(block);
        self
    }

    fn drawings(&self) -> Box<dyn Iterator<Item = &Drawing> + '_> {
        Box::new(self.blocks.iter().flat_map(|block| -> Box<dyn Iterator<Item = &Drawing>> {
            match block {
                Block::Figure(figure) => Box::new(std::iter::once(figure)),
                Block::Section(section) => section.drawings(),
                Block::Paragraph(_)
                | Block::Warning(_)
                | Block::List(_)
                | Block::Table(_)
                | Block::File(..) => Box::new(std::iter::empty()),
            }
        }))
    }
}
