//! Every page that the program makes, held against the rules of HTML that its pages could break.

use gyradius_study::{Options, Scenario, Study};
use std::collections::BTreeSet;

use super::pages;

/// Elements without content.
const VOID: [&str; 6] = ["meta", "br", "input", "link", "img", "hr"];
/// Elements that may stand in a paragraph.
const PHRASING: [&str; 21] = [
    "a", "b", "br", "button", "canvas", "code", "em", "i", "img", "input", "label", "output",
    "select", "small", "span", "strong", "sub", "sup", "svg", "script", "option",
];
/// Elements whose content is phrasing.
const LINES: [&str; 16] = [
    "p", "h1", "h2", "h3", "h4", "span", "strong", "em", "small", "code", "caption", "button",
    "label", "pre", "title", "output",
];
/// Elements that a folded section is called by.
const HEADINGS: [&str; 3] = ["h2", "h3", "h4"];

/// An open element.
struct Open {
    name: String,
    children: Vec<String>,
    /// Of a table: columns taken from rows above, and the width of its rows.
    spans: Vec<usize>,
    width: Option<usize>,
}

/// Panics where a page breaks a rule: elements that are not closed in order, attributes twice or empty, an
/// `id` twice, characters that are not escaped, children that an element may not have, rows of different
/// width in a table.
fn check(page: &str) {
    let mut rest = page.strip_prefix("<!DOCTYPE html>").expect("a document type");
    let mut open: Vec<Open> = Vec::new();
    let (mut ids, mut links, mut level) = (BTreeSet::new(), BTreeSet::new(), 0);
    let mut cells = 0_usize;
    while !rest.is_empty() {
        let (text, after) = rest.split_at(rest.find('<').unwrap_or(rest.len()));
        let plain =
            text.replace("&amp;", "").replace("&lt;", "").replace("&gt;", "").replace("&quot;", "");
        assert!(!plain.contains(['&', '>']), "not escaped: {text:?}");
        let parent = open.last().map_or("", |o| o.name.as_str());
        let structural = ["html", "table", "thead", "tbody", "tr", "ul", "select", ""];
        assert!(text.trim().is_empty() || !structural.contains(&parent), "{text:?} in {parent}");
        let Some(after) = after.strip_prefix('<') else { break };
        let (tag, after) = after.split_once('>').expect("a tag ends");
        rest = after;
        if let Some(name) = tag.strip_prefix('/') {
            let closed = open.pop().expect("nothing is open");
            assert_eq!(closed.name, name);
            close(&closed, open.iter_mut().rev().find(|o| o.name == "table"), cells);
            continue;
        }
        let alone = tag.ends_with('/');
        let (name, attributes) = read(tag.trim_end_matches('/'));
        for (key, value) in &attributes {
            let may_be_empty = ["d", "value"].contains(&key.as_str());
            assert!(!value.trim().is_empty() || may_be_empty, "{key} of {name} is empty");
            if let Some(id) = value.strip_prefix('#').filter(|_| key == "href") {
                links.insert(id.to_owned());
            }
            let whole = key == "href" && value.contains(':') || key == "src";
            assert!(!whole, "{name} leads out of the folder: {value}");
            assert!(key != "id" || ids.insert(value.clone()), "id {value} twice");
            let scopes = ["row", "col", "rowgroup", "colgroup"];
            assert!(key != "scope" || (name == "th" && scopes.contains(&value.as_str())));
        }
        if let Some(deep) = name.strip_prefix('h').and_then(|deep| deep.parse::<u32>().ok()) {
            assert!(deep <= level + 1, "{name} after a heading of level {level}");
            level = deep;
        }
        let keys: BTreeSet<_> = attributes.iter().map(|(key, _)| key).collect();
        assert_eq!(keys.len(), attributes.len(), "an attribute of {name} twice");
        let svg = name == "svg" || open.iter().any(|o| o.name == "svg");
        if let Some(parent) = open.last_mut().filter(|_| !svg || name == "svg") {
            allowed(&parent.name, &name, &parent.children);
            parent.children.push(name.clone());
        }
        let number = |key: &str| {
            let found = attributes.iter().find(|(k, _)| k == key);
            found.map_or(1, |(_, value)| value.parse::<usize>().expect(key))
        };
        if name == "tr" {
            cells = 0;
        }
        if name == "td" || name == "th" {
            let table =
                open.iter_mut().rev().find(|o| o.name == "table").expect("a cell in a table");
            for _ in 0..number("colspan") {
                // Columns that a cell above takes are not its own.
                while table.spans.get(cells).is_some_and(|rows| *rows > 0) {
                    cells += 1;
                }
                if table.spans.len() <= cells {
                    table.spans.resize(cells + 1, 0);
                }
                table.spans[cells] = number("rowspan");
                cells += 1;
            }
        }
        if name == "script" || name == "style" {
            let end = format!("</{name}>");
            rest = rest.split_once(&end).expect("its end").1;
        } else if !alone && !VOID.contains(&name.as_str()) {
            open.push(Open { name, children: Vec::new(), spans: Vec::new(), width: None });
        }
    }
    assert!(links.is_subset(&ids), "{links:?} lead nowhere");
    assert!(open.is_empty(), "not closed: {}", open.last().map_or("", |o| &o.name));
}

fn close(closed: &Open, table: Option<&mut Open>, cells: usize) {
    let count = |name: &str| closed.children.iter().filter(|c| *c == name).count();
    match closed.name.as_str() {
        "tr" => {
            let table = table.expect("a row in a table");
            // What cells above still take on the right counts.
            let width =
                table.spans.iter().rposition(|rows| *rows > 0).map_or(0, |i| i + 1).max(cells);
            let expected = *table.width.get_or_insert(width);
            assert_eq!(width, expected, "rows of different width");
            table.spans.iter_mut().for_each(|rows| *rows = rows.saturating_sub(1));
        }
        "thead" | "tbody" => {
            let table = table.expect("rows in a table");
            assert!(table.spans.iter().all(|rows| *rows == 0), "a cell reaches out of its rows");
        }
        "table" => assert!(count("thead") <= 1 && count("tbody") >= 1, "{:?}", closed.children),
        "html" => assert_eq!(closed.children, ["head", "body"]),
        "head" => assert_eq!((count("title"), count("meta")), (1, 3)),
        "body" => assert_eq!(closed.children, ["a", "main", "script"]),
        "main" => assert_eq!(count("h1"), 1),
        "details" => assert_eq!((closed.children[0].as_str(), count("summary")), ("summary", 1)),
        "figure" => {
            assert!(count("figcaption") == 1 && closed.children.last().unwrap() == "figcaption")
        }
        "ul" => assert!(count("li") > 0),
        _ => {}
    }
}

fn allowed(parent: &str, name: &str, before: &[String]) {
    let only = |names: &[&str]| assert!(names.contains(&name), "{name} in {parent}");
    match parent {
        "table" => {
            only(&["caption", "colgroup", "thead", "tbody"]);
            assert!(name != "thead" || !before.iter().any(|b| b == "tbody"), "a head after a body");
        }
        "thead" | "tbody" => only(&["tr"]),
        "tr" => only(&["td", "th"]),
        "ul" => only(&["li"]),
        "select" => only(&["option"]),
        "head" => only(&["meta", "title", "style"]),
        "summary" => only(&HEADINGS),
        line if LINES.contains(&line) => only(&PHRASING),
        _ => {
            let inner =
                ["li", "td", "th", "tr", "thead", "tbody", "option", "summary", "figcaption"];
            let fits = matches!((parent, name), ("details", "summary") | ("figure", "figcaption"));
            assert!(!inner.contains(&name) || fits, "{name} in {parent}");
        }
    }
}

/// The name of a tag and its attributes, unquoted ones and bare ones refused.
fn read(tag: &str) -> (String, Vec<(String, String)>) {
    let (name, mut pairs) = tag.split_once(char::is_whitespace).unwrap_or((tag, ""));
    assert!(name.chars().all(|c| c.is_ascii_alphanumeric()), "{tag}");
    let mut attributes = Vec::new();
    while !pairs.trim().is_empty() {
        let (key, rest) = pairs.trim_start().split_once("=\"").unwrap_or_else(|| panic!("{tag}"));
        let (value, rest) = rest.split_once('"').unwrap_or_else(|| panic!("{tag}"));
        assert!(key.chars().all(|c| c.is_ascii_alphabetic() || "-:".contains(c)), "{tag}");
        assert!(rest.is_empty() || rest.starts_with(char::is_whitespace), "{tag}");
        attributes.push((key.to_owned(), value.to_owned()));
        pairs = rest;
    }
    (name.to_owned(), attributes)
}

/// What the program makes, of a study of one run and of one in which every run fails, too.
#[test]
fn every_page_keeps_the_rules() {
    pages::all().iter().for_each(|(_, page)| check(page));
    let paper = Scenario::peck_2003().unwrap();
    // The horizon is too short.
    let failing = paper.to_toml().replace("horizon_s = 60.0", "horizon_s = 0.01");
    assert_ne!(failing, paper.to_toml());
    let failing = Scenario::from_toml(&failing).unwrap().with_runs(3).unwrap();
    for scenario in [paper.with_runs(1).unwrap(), failing] {
        let scratch = tempfile::tempdir().unwrap();
        let study =
            Study::run(&scenario, &Options::to(scratch.path().join("out")), &|_| {}).unwrap();
        check(&std::fs::read_to_string(study.folder().join("report.html")).unwrap());
        // The end of a study on the terminal is made of the same.
        let told = study.summary().to_string();
        assert!(!told.contains("[0.00") && !told.contains("0 % ["), "{told}");
    }
}

/// The rules do refuse what they are about.
#[test]
fn bad_pages_are_refused() {
    let page = |body: &str| {
        format!(
            "<!DOCTYPE html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"v\"><meta name=\"w\">\
             <title>t</title></head><body><a href=\"#c\">c</a><main id=\"c\"><h1>t</h1>{body}</main>\
             <script>a</script></body></html>"
        )
    };
    check(&page(
        "<table><thead><tr><th>a</th></tr></thead><tbody><tr><td>b</td></tr></tbody></table>",
    ));
    let row = "<tr><td>b</td></tr>";
    for bad in [
        format!("<table><tbody>{row}</tbody><thead>{row}</thead></table>"),
        format!("<table><thead>{row}</thead><tbody>{row}</tbody><thead>{row}</thead></table>"),
        format!("<table><tbody>{row}<tr><td>b</td><td>c</td></tr></tbody></table>"),
        "<table><tbody><tr><td rowspan=\"2\">b</td></tr></tbody></table>".to_owned(),
        "<p><div>a</div></p>".to_owned(),
        "<p id=\"a\">a</p><p id=\"a\">a</p>".to_owned(),
        "<p title=\"\">a</p>".to_owned(),
        "<p>a & b</p>".to_owned(),
        "<ul><p>a</p></ul>".to_owned(),
        "<p>a".to_owned(),
        "<p title=a>a</p>".to_owned(),
        "<p hidden>a</p>".to_owned(),
        "<details><summary><p>a</p></summary></details>".to_owned(),
        "<h3>a</h3>".to_owned(),
        "<a href=\"https://example.org\">a</a>".to_owned(),
        "<a href=\"#nowhere\">a</a>".to_owned(),
    ] {
        let refused = std::panic::catch_unwind(|| check(&page(&bad)));
        assert!(refused.is_err(), "{bad}");
    }
}
