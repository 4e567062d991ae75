//! Pages of any content, read back from Markdown and from HTML: the same words in the same places.

use proptest::prelude::*;
use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd};

use crate::{
    Document, Drawing, PageCell, PageTable, Section, Text, Tone, document::Block,
    svg::tests::unescape, table::Align,
};

/// What a reader of Markdown sees, with single spaces.
#[derive(Clone, Debug, PartialEq)]
enum Seen {
    Heading(usize, String),
    Paragraph(String),
    Warning(String),
    List(Vec<String>),
    /// Whether columns are of numbers, and rows of cells.
    Table(Vec<bool>, Vec<Vec<String>>),
    /// Name or address, and caption.
    Figure(String, String),
    File(String),
}

/// What commands in HTML, in Markdown, or in both, between words.
fn nasty() -> impl Strategy<Value = String> {
    let piece = prop_oneof![
        4 => prop::sample::select(vec![
            "|", "<", ">", "*", "**", "_", "__", "`", "``", "```", "&", "&amp;", "&#35;", "[", "]", "(", ")", "[x]", "](y)",
            "]: z", "#", "# ", "-", "- ", "+ ", "1.", "2) ", "~~", "~~~", "\\", "\\|", "$", "!", "![", "=", "===", "---", ":",
            "<b>", "</p>", "<!--", "\"", "'", "\n", "\n\n", "\t", "    ", "  ", "https://x.y", "{#a}", "^", "@", ".", "%",
            "\u{a0}", "\u{2009}", "é", "ω₁", "°", "…", "·", "−", "\u{202e}", "\u{2028}", "\0", "\u{1b}", "\u{1f680}",
        ]).prop_map(str::to_owned),
        3 => "[a-z0-9]{1,4}",
        2 => Just(" ".to_owned()),
        1 => any::<char>().prop_map(String::from),
    ];
    prop::collection::vec(piece, 0..7).prop_map(|pieces| pieces.concat())
}

fn text() -> impl Strategy<Value = Text> {
    let span = (nasty(), 0_usize..8, prop::option::of(nasty()));
    prop::collection::vec(span, 0..5).prop_map(|spans| {
        spans.into_iter().fold(Text::default(), |text, (words, style, tip)| {
            let text = match style {
                0..3 => text.plain(words),
                3 => text.strong(words),
                4 => text.emphasis(words),
                5 => text.code(words),
                6 => text.quiet(words),
                _ => text.badge(Tone::Part, words),
            };
            tip.into_iter().fold(text, Text::tip)
        })
    })
}

fn table() -> impl Strategy<Value = PageTable> {
    let cell = || prop::collection::vec(text(), 0..3).prop_map(PageCell::from_iter);
    (1_usize..5, 0_usize..5).prop_flat_map(move |(columns, rows)| {
        let cells = prop::collection::vec(prop::collection::vec(cell(), columns), rows);
        let labels = prop::collection::vec((cell(), 0..4, nasty()), columns);
        (cells, labels, any::<bool>(), nasty()).prop_map(|(cells, labels, grouped, heading)| {
            let mut table = PageTable::of(&cells).quiet(|row| row.len() == 2);
            for (i, (label, kind, group)) in labels.into_iter().enumerate() {
                let of = move |row: &Vec<PageCell>| row[i].clone();
                table = match kind {
                    0 => table.words(label, of),
                    1 => table.numbers_of(&group, label, of),
                    2 => table.numbers_of("shared", label, of),
                    _ => table.numbers(label, of),
                };
            }
            let half = cells.len() / 2;
            let upper = |row: &Vec<PageCell>| cells[..half].iter().any(|of| std::ptr::eq(of, row));
            if grouped {
                table =
                    table.groups(|row| if upper(row) { heading.clone() } else { "b".to_owned() });
            }
            table.into()
        })
    })
}

fn figure() -> impl Strategy<Value = Drawing> {
    ("[a-z .%()é|]{1,6}", nasty()).prop_map(|(name, caption)| Drawing {
        name: format!("a{name}"),
        svg: "<svg></svg>\n".to_owned(),
        numbers: caption.len().is_multiple_of(2).then(|| "[]".to_owned()),
        caption,
    })
}

fn section() -> impl Strategy<Value = Section> {
    let block = prop_oneof![
        text().prop_map(Block::Paragraph),
        text().prop_map(Block::Warning),
        prop::collection::vec(text(), 1..4).prop_map(Block::List),
        table().prop_map(Block::Table),
        figure().prop_map(Block::Figure),
        nasty().prop_map(|text| Block::File("toml", text)),
    ];
    let leaf = (nasty(), any::<[bool; 2]>(), prop::collection::vec(block.boxed(), 0..5));
    let leaf = leaf.prop_map(|(heading, [folded, boxed], blocks)| Section {
        heading,
        folded,
        boxed,
        blocks,
    });
    leaf.prop_recursive(2, 6, 2, |inner| {
        (inner.clone(), prop::collection::vec(inner, 0..2))
            .prop_map(|(section, below)| section.sections(below))
    })
}

fn document() -> impl Strategy<Value = Document> {
    let sections = prop::collection::vec(section(), 0..4);
    (nasty(), nasty(), text(), sections).prop_map(|(title, heading, lead, sections)| {
        Document::new(title, heading, lead).sections(sections)
    })
}

/// The words of a page as they are meant: without what is no sign, and with single spaces.
fn plain(text: &str) -> String {
    // Ends of lines in HTML and Markdown are spaces; other spaces are signs.
    let text = crate::visible(text);
    text.split([' ', '\n', '\t']).filter(|word| !word.is_empty()).collect::<Vec<_>>().join(" ")
}

fn words(text: &Text) -> String {
    plain(&text.words())
}

/// The lines of a cell, told apart.
fn cell(cell: &PageCell) -> String {
    let lines = cell.lines().iter().map(words).filter(|line| !line.is_empty());
    let join = |all: String, line: String| match all.chars().last() {
        None => line,
        Some('.') => format!("{all} {line}"),
        Some(_) => format!("{all}; {line}"),
    };
    lines.fold(String::new(), join)
}

fn meant(document: &Document) -> Vec<Seen> {
    let mut seen = vec![Seen::Heading(1, plain(&document.heading))];
    seen.push(Seen::Paragraph(words(&document.lead)));
    document.sections.iter().for_each(|section| meant_of(&mut seen, section, 2));
    // What says nothing is not there.
    seen.retain(|seen| match seen {
        Seen::Paragraph(text) | Seen::Warning(text) => !text.is_empty(),
        Seen::List(items) => !items.is_empty(),
        Seen::Heading(..) | Seen::Table(..) | Seen::Figure(..) | Seen::File(_) => true,
    });
    seen
}

fn meant_of(seen: &mut Vec<Seen>, section: &Section, level: usize) {
    seen.push(Seen::Heading(level, plain(&section.heading)));
    for block in &section.blocks {
        match block {
            Block::Paragraph(text) => seen.push(Seen::Paragraph(words(text))),
            Block::Warning(text) => seen.push(Seen::Warning(words(text))),
            Block::List(items) => {
                let items = items.iter().map(words).filter(|item| !item.is_empty());
                seen.push(Seen::List(items.collect()));
            }
            Block::Table(table) => {
                let numbers = table.columns.iter().map(|c| c.align == Align::Right).collect();
                let label = |group: &Option<String>, label: &PageCell| match group {
                    Some(group) => plain(&format!("{}: {}", plain(group), cell(label))),
                    None => cell(label),
                };
                let head = table.columns.iter().map(|c| label(&c.group, &c.label)).collect();
                let mut rows: Vec<Vec<String>> = vec![head];
                let mut group = None;
                for row in &table.rows {
                    if row.group != group {
                        group.clone_from(&row.group);
                        let mut cells = vec![String::new(); table.columns.len()];
                        cells[0] = plain(&row.group.clone().unwrap_or_default());
                        rows.push(cells);
                    }
                    rows.push(row.cells.iter().map(cell).collect());
                }
                seen.push(Seen::Table(numbers, rows));
            }
            Block::Figure(figure) => {
                let caption = plain(&figure.caption);
                seen.push(Seen::Figure(figure.file(), caption));
                seen.push(Seen::Paragraph(plain(&format!("{}.", figure.caption))));
            }
            Block::File(_, text) => seen.push(Seen::File(crate::visible(text))),
            Block::Section(below) => meant_of(seen, below, level + 1),
        }
    }
}

/// What an independent reader of Markdown sees.
fn read_markdown(markdown: &str) -> Vec<Seen> {
    let options = Options::ENABLE_TABLES
        | Options::ENABLE_STRIKETHROUGH
        | Options::ENABLE_TASKLISTS
        | Options::ENABLE_FOOTNOTES
        | Options::ENABLE_MATH;
    let mut seen = Vec::new();
    let mut text = String::new();
    let (mut warning, mut items, mut rows, mut numbers, mut figure) =
        (false, Vec::new(), Vec::new(), Vec::new(), None);
    for event in Parser::new_ext(markdown, options) {
        let all = |text: &mut String| plain(&std::mem::take(text));
        match event {
            Event::Text(more) | Event::Code(more) => text.push_str(&more),
            Event::SoftBreak => text.push(' '),
            Event::Start(tag) => match tag {
                Tag::BlockQuote(_) => warning = true,
                Tag::Table(columns) => {
                    let right =
                        |a: &pulldown_cmark::Alignment| *a == pulldown_cmark::Alignment::Right;
                    numbers = columns.iter().map(right).collect();
                }
                Tag::TableHead | Tag::TableRow => rows.push(Vec::new()),
                Tag::Image { dest_url, .. } => figure = Some(percent_decoded(&dest_url)),
                Tag::Paragraph
                | Tag::Heading { .. }
                | Tag::CodeBlock(_)
                | Tag::List(None)
                | Tag::Item
                | Tag::TableCell
                | Tag::Emphasis
                | Tag::Strong => {}
                tag => panic!("{tag:?} in {markdown}"),
            },
            Event::End(tag) => match tag {
                TagEnd::Heading(level) => seen.push(Seen::Heading(level as usize, all(&mut text))),
                TagEnd::Paragraph => match figure.take() {
                    Some(file) => seen.push(Seen::Figure(file, all(&mut text))),
                    None if warning => seen.push(Seen::Warning(all(&mut text))),
                    None => seen.push(Seen::Paragraph(all(&mut text))),
                },
                TagEnd::BlockQuote(_) => warning = false,
                TagEnd::CodeBlock => seen.push(Seen::File(std::mem::take(&mut text))),
                TagEnd::Item => items.push(all(&mut text)),
                TagEnd::List(_) => seen.push(Seen::List(std::mem::take(&mut items))),
                TagEnd::TableCell => rows.last_mut().unwrap().push(all(&mut text)),
                TagEnd::Table => {
                    seen.push(Seen::Table(std::mem::take(&mut numbers), std::mem::take(&mut rows)))
                }
                _ => {}
            },
            event => panic!("{event:?} in {markdown}"),
        }
    }
    seen
}

fn percent_decoded(address: &str) -> String {
    let mut bytes = Vec::new();
    let mut rest = address.bytes();
    while let Some(b) = rest.next() {
        let mut digit = || char::from(rest.next().unwrap()).to_digit(16).unwrap() as u8;
        bytes.push(if b == b'%' { 16 * digit() + digit() } else { b });
    }
    String::from_utf8(bytes).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    #[test]
    fn markdown_reads_back(document in document()) {
        let markdown = document.markdown();
        let mut meant = meant(&document);
        // A file ends with a line break.
        for seen in &mut meant {
            if let Seen::File(text) = seen && !text.is_empty() && !text.ends_with('\n') {
                text.push('\n');
            }
        }
        prop_assert_eq!(read_markdown(&markdown), meant, "{}", markdown);
    }
}

/// The elements of a page that hold words, and where rows of tables end, if every element is closed in order and
/// every character escaped.
fn read_html(html: &str) -> Vec<(String, String)> {
    const WORDS: [&str; 12] =
        ["title", "h1", "h2", "h3", "h4", "caption", "p", "li", "th", "td", "figcaption", "pre"];
    let mut rest = html.strip_prefix("<!DOCTYPE html>").unwrap();
    let (mut open, mut seen, mut text) = (Vec::new(), Vec::new(), String::new());
    while let Some((before, after)) = rest.split_once('<') {
        text.push_str(&unescape(before));
        let (tag, after) = after.split_once('>').unwrap();
        rest = after;
        let element = tag.trim_start_matches('/').split(' ').next().unwrap();
        // What is said on paper once more is held by tests of its own, and the script by those of browsers.
        for (hidden, end) in [("script", "</script>"), ("div class=\"paper\"", "</table></div>")] {
            if tag.starts_with(hidden) {
                rest = rest.split_once(end).unwrap().1;
            }
        }
        if element == "script" || tag == "div class=\"paper\"" {
            continue;
        }
        assert!(tag.matches('"').count() % 2 == 0 && !tag.contains("\"\""), "{tag}");
        let line = element == "p" && (open.contains(&"td") || open.contains(&"th"));
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(element));
            if line {
                text.push(' ');
            } else if element == "pre" {
                seen.push((element.to_owned(), text.clone()));
            } else if element == "tr" || WORDS.contains(&element) {
                seen.push((element.to_owned(), plain(&text)));
            }
        } else if element != "meta" {
            open.push(element);
        }
        if !line && (WORDS.contains(&element) || tag == "/tr") {
            text.clear();
        }
    }
    assert!(open.is_empty());
    seen
}

/// The same, as it is meant.
fn meant_as_html(document: &Document) -> Vec<(String, String)> {
    let mut seen = vec![
        ("title", plain(&document.title)),
        ("h1", plain(&document.heading)),
        ("p", words(&document.lead)),
    ];
    document.sections.iter().for_each(|section| elements(&mut seen, section, 0));
    seen.into_iter().map(|(element, text)| (element.to_owned(), text)).collect()
}

fn elements(seen: &mut Vec<(&str, String)>, section: &Section, depth: usize) {
    seen.push((["h2", "h3", "h4", "h4"][depth], plain(&section.heading)));
    let cell =
        |cell: &PageCell| plain(&cell.lines().iter().map(words).collect::<Vec<_>>().join(" "));
    for block in &section.blocks {
        match block {
            Block::Paragraph(text) | Block::Warning(text) => seen.push(("p", words(text))),
            Block::List(items) => seen.extend(items.iter().map(|item| ("li", words(item)))),
            Block::Table(table) => {
                if !section.heading.trim().is_empty() {
                    seen.push(("caption", plain(&section.heading)));
                }
                let (mut first, mut second) = (Vec::new(), Vec::new());
                let mut group = None;
                for column in &table.columns {
                    match &column.group {
                        None => first.push(("th", cell(&column.label))),
                        Some(heading) => {
                            second.push(("th", cell(&column.label)));
                            if column.group != group {
                                first.push(("th", plain(heading)));
                            }
                        }
                    }
                    group.clone_from(&column.group);
                }
                seen.extend(first.into_iter().chain([("tr", String::new())]));
                if !second.is_empty() {
                    seen.extend(second.into_iter().chain([("tr", String::new())]));
                }
                let mut group = None;
                for row in &table.rows {
                    if row.group != group {
                        group.clone_from(&row.group);
                        seen.push(("th", plain(row.group.as_ref().unwrap())));
                        seen.push(("tr", String::new()));
                    }
                    let elements = ["th"].into_iter().chain(std::iter::repeat("td"));
                    seen.extend(elements.zip(row.cells.iter().map(cell)));
                    seen.push(("tr", String::new()));
                }
            }
            Block::Figure(figure) => {
                let caption = format!("{}. {}", figure.caption, figure.file());
                seen.push(("figcaption", plain(&caption)));
            }
            Block::File(_, text) => seen.push(("pre", crate::visible(text))),
            Block::Section(below) => elements(seen, below, depth + 1),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    #[test]
    fn html_reads_back(document in document()) {
        prop_assert_eq!(read_html(&document.html()), meant_as_html(&document));
    }
}
