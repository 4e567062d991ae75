//! Words of a page: runs of text, some of which stand out.

/// How words stand out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Style {
    Plain,
    Strong,
    Emphasis,
    Code,
    /// Beside what matters more.
    Quiet,
    /// A judgement, in its colour.
    Badge(Tone),
}

/// How a judgement sounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// As it should be.
    Good,
    /// As it should be in part.
    Part,
    /// Not as it should be.
    Bad,
    /// Not known.
    Open,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Span {
    pub(crate) text: String,
    pub(crate) style: Style,
    /// What is told where the pointer rests on it.
    pub(crate) tip: Option<String>,
}

/// A line of words, written one after the other: `Text::from("of ").strong("all")`. Whatever characters they
/// hold are shown, and command nothing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Text(Vec<Span>);

impl<T: Into<String>> From<T> for Text {
    fn from(text: T) -> Self {
        Self::default().plain(text)
    }
}

impl Text {
    /// With further words.
    #[must_use]
    pub fn plain(self, text: impl Into<String>) -> Self {
        self.and(Style::Plain, text)
    }

    /// With words that stand out.
    #[must_use]
    pub fn strong(self, text: impl Into<String>) -> Self {
        self.and(Style::Strong, text)
    }

    /// With words that are stressed.
    #[must_use]
    pub fn emphasis(self, text: impl Into<String>) -> Self {
        self.and(Style::Emphasis, text)
    }

    /// With what is typed or read as it is: names of files and columns, commands.
    #[must_use]
    pub fn code(self, text: impl Into<String>) -> Self {
        self.and(Style::Code, text)
    }

    /// With what stands back.
    #[must_use]
    pub fn quiet(self, text: impl Into<String>) -> Self {
        self.and(Style::Quiet, text)
    }

    /// With a judgement.
    #[must_use]
    pub fn badge(self, tone: Tone, text: impl Into<String>) -> Self {
        self.and(Style::Badge(tone), text)
    }

    /// The last words with more that is told where the pointer rests on them, which Markdown leaves out.
    #[must_use]
    pub fn tip(mut self, tip: impl Into<String>) -> Self {
        let tip = tip.into();
        if let Some(last) = self.0.last_mut().filter(|_| !tip.trim().is_empty()) {
            last.tip = Some(tip);
        }
        self
    }

    pub(crate) fn spans(&self) -> &[Span] {
        &self.0
    }

    pub(crate) fn words(&self) -> String {
        self.0.iter().map(|span| span.text.as_str()).collect()
    }

    fn and(mut self, style: Style, text: impl Into<String>) -> Self {
        self.0.push(Span { text: text.into(), style, tip: None });
        self
    }
}
