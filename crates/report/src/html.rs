//! Pages as HTML.

use maud::{Markup, PreEscaped, html};

use crate::{
    document::{Block, Document, Section},
    figure::Drawing,
    inline::{Style, Text, Tone},
    page::page,
    paper::{Part, parts},
    table::{Align, PageCell, PageColumn, PageTable},
};

impl Document {
    /// As HTML that needs nothing but itself, figures included.
    #[must_use]
    pub fn html(&self) -> String {
        let content = html! {
            h1 { (self.heading) }
            p.lead { (text(&self.lead)) }
            @for below in &self.sections { (section(below, 2)) }
        };
        page(&self.title, "", &content)
    }
}

fn section(section: &Section, level: usize) -> Markup {
    let heading = html! {
        @match level {
            2 => h2 { (section.heading) },
            3 => h3 { (section.heading) },
            _ => h4 { (section.heading) },
        }
    };
    let blocks = html! { @for part in &section.blocks { (block(part, section, level)) } };
    html! {
        @if section.folded {
            details { summary { (heading) } (blocks) }
        } @else if section.boxed {
            div.box { (heading) (blocks) }
        } @else {
            (heading) (blocks)
        }
    }
}

fn block(block: &Block, within: &Section, level: usize) -> Markup {
    html! {
        @match block {
            Block::Paragraph(words) => p { (text(words)) },
            Block::Warning(words) => p.warning { (text(words)) },
            Block::List(items) => ul { @for item in items { li { (text(item)) } } },
            Block::Table(of) => (table(of, &within.heading)),
            Block::Figure(drawing) => (figure(drawing)),
            Block::File(_, text) => pre { (text) },
            Block::Section(below) => (section(below, level + 1)),
        }
    }
}

fn figure(figure: &Drawing) -> Markup {
    html! {
        figure id=(figure.name) {
            // Made by this program, every text in it escaped.
            div.picture { (PreEscaped(&figure.svg)) }
            @if let Some(numbers) = &figure.numbers {
                script.numbers type="application/json" { (PreEscaped(numbers)) }
            }
            figcaption { (figure.caption) ". " a href=(figure.address()) { code { (figure.file()) } } }
        }
    }
}

fn text(text: &Text) -> Markup {
    html! {
        @for span in text.spans() {
            @let (words, tip) = (&span.text, span.tip.as_ref());
            @match span.style {
                Style::Plain if tip.is_none() => (words),
                Style::Plain => span title=[tip] { (words) },
                Style::Strong => strong title=[tip] { (words) },
                Style::Emphasis => em title=[tip] { (words) },
                Style::Code => code title=[tip] { (words) },
                Style::Quiet => small title=[tip] { (words) },
                Style::Badge(tone) => span class={ "badge " (class(tone)) } title=[tip] { (words) },
            }
        }
    }
}

fn class(tone: Tone) -> &'static str {
    match tone {
        Tone::Good => "good",
        Tone::Part => "part",
        Tone::Bad => "bad",
        Tone::Open => "open",
    }
}

/// As a whole for screens, and where it is wider than a sheet of paper in parts for paper.
fn table(table: &PageTable, caption: &str) -> Markup {
    let parts = parts(table);
    let all: Vec<usize> = (0..table.columns.len()).collect();
    html! {
        @if let [whole] = parts.as_slice() {
            div.wide { (part(table, whole, caption)) }
        } @else {
            @let em = parts.iter().map(|part| part.em).fold(0.0, f64::max);
            div.wide.screen { (part(table, &Part { columns: all, em }, caption)) }
            @for of in &parts { div.paper { (part(table, of, caption)) } }
        }
    }
}

fn part(table: &PageTable, part: &Part, caption: &str) -> Markup {
    let columns: Vec<&PageColumn> = part.columns.iter().map(|i| &table.columns[*i]).collect();
    let of_words = columns.iter().all(|column| column.align == Align::Left);
    html! {
        table class=[of_words.then_some("words")] style={ "--em:" (part.em.ceil()) } {
            @if !caption.trim().is_empty() { caption { (caption) } }
            thead { (head(&columns)) }
            @if table.rows.is_empty() { tbody {} }
            @for rows in table.rows.chunk_by(|a, b| a.group == b.group) {
                tbody {
                    @if let Some(group) = rows.first().and_then(|row| row.group.as_ref()) {
                        tr.group { th colspan=(columns.len()) scope="rowgroup" { (group) } }
                    }
                    @for row in rows {
                        tr class=[row.quiet.then_some("quiet")] {
                            @for (i, of) in part.columns.iter().map(|i| &row.cells[*i]).enumerate() {
                                @if i == 0 {
                                    th scope="row" { (cell(of)) }
                                } @else {
                                    td class=[class_of(&columns, i)] { (cell(of)) }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// One row, or two where columns share a heading.
fn head(columns: &[&PageColumn]) -> Markup {
    let shared = columns.iter().any(|column| column.group.is_some());
    let groups = columns.chunk_by(|a, b| a.group.is_some() && a.group == b.group);
    let below = columns.iter().enumerate().filter(|(_, column)| column.group.is_some());
    html! {
        tr {
            @for group in groups {
                @match group[0] {
                    PageColumn { group: Some(heading), .. } =>
                        th.first colspan=(group.len()) scope="colgroup" { (heading) },
                    column => th class=[left(column)] rowspan=[shared.then_some(2)] scope="col" { (cell(&column.label)) },
                }
            }
        }
        @if shared {
            tr { @for (i, column) in below { th class=[class_of(columns, i)] scope="col" { (cell(&column.label)) } } }
        }
    }
}

fn left(column: &PageColumn) -> Option<&'static str> {
    (column.align == Align::Left).then_some("left")
}

/// What is told apart: words, and the first of the columns that share a heading.
fn class_of(columns: &[&PageColumn], i: usize) -> Option<&'static str> {
    let before = i.checked_sub(1).and_then(|before| columns[before].group.as_ref());
    let first = columns[i].group.is_some() && columns[i].group.as_ref() != before;
    left(columns[i]).or(first.then_some("first"))
}

fn cell(cell: &PageCell) -> Markup {
    html! {
        @match cell.lines() {
            [line] => (text(line)),
            lines => @for line in lines { p { (text(line)) } },
        }
    }
}
