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

    /// The same with signs of numbers as they are set: − before what is less than zero. What is typed stays as it is.
    pub(crate) fn with_signs(mut self) -> Self {
        for span in self.0.iter_mut().filter(|span| span.style != Style::Code) {
            span.text = with_signs(&span.text);
            span.tip = span.tip.take().map(|tip| with_signs(&tip));
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

/// A text with − before numbers that are less than zero: not within words and powers of ten, nor between numbers.
pub(crate) fn with_signs(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut left = text.chars().peekable();
    while let Some(c) = left.next() {
        let begins = out.chars().last().is_none_or(|before| " [(".contains(before));
        let is_sign = c == '-' && begins && left.peek().is_some_and(char::is_ascii_digit);
        out.push(if is_sign { '−' } else { c });
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_of_numbers_are_set_and_nothing_else_is() {
        for (text, set) in [
            ("-1.632", "−1.632"),
            ("[-1.2e-7, -3]", "[−1.2e-7, −3]"),
            ("-0.1 … 2 (-3.1 σ)", "−0.1 … 2 (−3.1 σ)"),
            ("model-2", "model-2"),
            ("2003-01-02", "2003-01-02"),
            ("- 1 –", "- 1 –"),
            ("-inf of -x", "-inf of -x"),
        ] {
            assert_eq!(with_signs(text), set);
        }
        let typed = Text::from("-1").tip("-2").code("--run -3").with_signs();
        assert_eq!(
            (typed.words().as_str(), typed.spans()[0].tip.as_deref()),
            ("−1--run -3", Some("−2"))
        );
    }
}
