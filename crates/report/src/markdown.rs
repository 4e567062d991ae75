//! Pages as Markdown: what GitHub reads (CommonMark and tables), without HTML in it.

use crate::{
    document::{Block, Document, Section},
    inline::{Style, Text},
    table::{Align, PageCell, PageColumn, PageTable},
    visible::visible,
};

impl Document {
    /// As Markdown as GitHub reads it, without HTML in it; figures are files beside it.
    #[must_use]
    pub fn markdown(&self) -> String {
        let mut out = format!("# {}\n", words(&self.heading, Place::Heading));
        lines(&mut out, "", &inline(&self.lead, Place::Line));
        for below in &self.sections {
            section(&mut out, below, 2);
        }
        out
    }
}

fn section(out: &mut String, section: &Section, level: usize) {
    let heading = words(&section.heading, Place::Heading);
    out.push_str(&format!("\n{} {heading}\n", "#".repeat(level.min(6))));
    section.blocks.iter().for_each(|part| block(out, part, level));
}

fn block(out: &mut String, block: &Block, level: usize) {
    match block {
        Block::Paragraph(text) => lines(out, "", &inline(text, Place::Line)),
        Block::Warning(text) => lines(out, "> ", &inline(text, Place::Line)),
        Block::List(items) => list(out, items),
        Block::Table(of) => table(out, of),
        Block::Figure(figure) => {
            let caption = words(&format!("{}.", figure.caption), Place::Line);
            let alternative = words(&figure.caption, Place::Alternative);
            lines(out, "", &format!("![{alternative}]({})", figure.address()));
            lines(out, "", &caption);
        }
        Block::File(language, text) => {
            let fence = "`".repeat(longest_run(text).max(2) + 1);
            let end = if text.ends_with('\n') || text.is_empty() { "" } else { "\n" };
            lines(out, "", &format!("{fence}{language}\n{}{end}{fence}", visible(text)));
        }
        Block::Section(below) => section(out, below, level + 1),
    }
}

/// A block of its own, if there is anything in it.
fn lines(out: &mut String, mark: &str, text: &str) {
    if !text.is_empty() {
        out.push_str(&format!("\n{mark}{text}\n"));
    }
}

fn list(out: &mut String, items: &[Text]) {
    // Two lists that follow each other are told apart by their marks.
    let last = out.trim_end_matches('\n').rsplit('\n').next();
    let mark = if last.is_some_and(|line| line.starts_with("- ")) { '+' } else { '-' };
    let items = items.iter().map(|item| inline(item, Place::Line));
    for (i, item) in items.filter(|item| !item.is_empty()).enumerate() {
        out.push_str(&format!("{}{mark} {item}\n", if i == 0 { "\n" } else { "" }));
    }
}

fn table(out: &mut String, table: &PageTable) {
    let row = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let label = |column: &PageColumn| match &column.group {
        Some(group) => format!("{}: {}", words(group, Place::Cell), cell(&column.label)),
        None => cell(&column.label),
    };
    let rule = |column: &PageColumn| match column.align {
        Align::Left => "---".to_owned(),
        Align::Right => "---:".to_owned(),
    };
    out.push('\n');
    out.push_str(&row(table.columns.iter().map(label).collect()));
    out.push_str(&row(table.columns.iter().map(rule).collect()));
    for rows in table.rows.chunk_by(|a, b| a.group == b.group) {
        if let Some(group) = rows.first().and_then(|row| row.group.as_ref()) {
            let heading = inline(&Text::default().strong(group), Place::Cell);
            let empty = std::iter::repeat_n(String::new(), table.columns.len() - 1);
            out.push_str(&row(std::iter::once(heading).chain(empty).collect()));
        }
        for of in rows {
            out.push_str(&row(of.cells.iter().map(cell).collect()));
        }
    }
}

/// The lines of a cell one after the other: sentences as they are, others told apart.
fn cell(cell: &PageCell) -> String {
    let mut all = String::new();
    let mut between = "";
    for line in cell.lines() {
        let text = inline(line, Place::Cell);
        if !text.is_empty() {
            all.push_str(between);
            all.push_str(&text);
            between = if one_line(&line.words()).trim_end_matches(' ').ends_with('.') {
                " "
            } else {
                "; "
            };
        }
    }
    all
}

/// Where words stand, which decides what characters command there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    /// From the beginning of a line on.
    Line,
    Heading,
    Cell,
    /// What is told of a figure to those who cannot see it.
    Alternative,
}

fn words(text: &str, place: Place) -> String {
    inline(&Text::from(text), place)
}

fn inline(text: &Text, place: Place) -> String {
    let spans = text.spans().iter().map(|span| (span.style, one_line(&span.text)));
    let spans: Vec<_> = spans.filter(|(_, text)| !text.is_empty()).collect();
    let mut out = String::new();
    for (i, (style, text)) in spans.iter().enumerate() {
        // Spaces at the beginning of a line command, and a second one shows nothing.
        let spaced = out.is_empty() || out.ends_with(' ');
        let text = if spaced { text.trim_start_matches(' ') } else { text };
        let next = spans.get(i + 1).and_then(|(_, text)| text.chars().next());
        match style {
            Style::Plain | Style::Quiet => escape(&mut out, text, place),
            Style::Strong | Style::Badge(_) => mark(&mut out, "**", text, next, place),
            Style::Emphasis => mark(&mut out, "*", text, next, place),
            Style::Code => code(&mut out, text, place),
        }
    }
    out.truncate(out.trim_end_matches(' ').len());
    out
}

/// Without line breaks, and with single spaces.
fn one_line(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in visible(text).chars() {
        match c {
            ' ' | '\n' | '\t' if out.ends_with(' ') => {}
            ' ' | '\n' | '\t' => out.push(' '),
            _ => out.push(c),
        }
    }
    out
}

/// The words with a backslash before every character that would command there.
fn escape(out: &mut String, text: &str, place: Place) {
    for c in text.chars() {
        let begins = place == Place::Line && out.is_empty();
        let number = || !out.is_empty() && out.bytes().all(|b| b.is_ascii_digit());
        let commands = match c {
            '\\' | '`' | '*' | '_' | '<' | '~' | '$' | '&' | '|' => true,
            '[' | ']' if place == Place::Alternative => true,
            // Links, and what they are defined by.
            '[' => begins || out.ends_with(']'),
            '(' | ':' => out.ends_with(']'),
            '#' => begins || place == Place::Heading,
            '-' | '+' | '>' => begins,
            '.' | ')' => place == Place::Line && number(),
            _ => false,
        };
        if commands {
            out.push('\\');
        }
        out.push(c);
    }
}

/// The words between marks of emphasis, where those are read as such: next to a space or to punctuation, or to
/// letters if they themselves end in letters. Elsewhere without.
fn mark(out: &mut String, mark: &str, text: &str, next: Option<char>, place: Place) {
    let fits = |outside: Option<char>, inside: Option<char>| {
        inside.is_some_and(|c| !c.is_whitespace() && (c.is_ascii() || c.is_alphanumeric()))
            && (inside.is_some_and(|c| c.is_ascii_alphanumeric())
                || outside.is_none_or(|c| c == ' ' || c.is_ascii_punctuation()))
    };
    let before = fits(out.chars().last(), text.chars().next());
    if before && fits(next, text.chars().last()) && !out.ends_with('*') {
        out.push_str(mark);
        escape(out, text, place);
        out.push_str(mark);
    } else {
        escape(out, text, place);
    }
}

/// The words between as many backticks as they need. A backslash before a bar is what the cell of a table
/// cannot hold so.
fn code(out: &mut String, text: &str, place: Place) {
    let cell = place == Place::Cell;
    if text.trim_matches(' ').is_empty() || out.ends_with('`') || (cell && text.contains("\\|")) {
        return escape(out, text, place);
    }
    let fence = "`".repeat(longest_run(text) + 1);
    let (inner, space) = (text.trim_matches(' '), |yes: bool| if yes { " " } else { "" });
    let (before, after) = (space(text.starts_with(' ')), space(text.ends_with(' ')));
    let pad = space(inner.starts_with('`') || inner.ends_with('`'));
    let inner = if cell { inner.replace('|', "\\|") } else { inner.to_owned() };
    out.push_str(&format!("{before}{fence}{pad}{inner}{pad}{fence}{after}"));
}

/// How many backticks follow each other at most.
fn longest_run(text: &str) -> usize {
    text.split(|c| c != '`').map(str::len).max().unwrap_or(0)
}
