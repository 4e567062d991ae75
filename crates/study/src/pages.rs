//! Every page that the program makes, held against the rules of HTML that its pages could break.

use std::collections::BTreeSet;

use crate::{
    CompareOptions, ModelComparison, Replay, Scenario, compare, model::Model, replay, report,
    study::judged,
};

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

/// The report of a scenario, without its folder.
fn report_of(scenario: &Scenario) -> String {
    let models = Model::all(scenario).unwrap();
    let summary = judged(scenario, &models);
    // The end of a study on the terminal is made of the same.
    assert!(!summary.to_string().contains("[0.00") && !summary.to_string().contains("0 % ["));
    report::report(scenario, &summary).html()
}

/// The paper's study with names that are markup, with what else can be told: outlines, dispersions.
fn full() -> Scenario {
    let text = Scenario::peck_2003().unwrap().to_toml();
    let second = text.match_indices("[[springs]]").nth(1).unwrap().0;
    let (head, tail) = text.split_at(second);
    let text = format!(
        "{head}[springs.dispersion]\nfailure_probability = 0.3\nstart_s = {{ law = \"uniform\", low = 0.0, high = 0.4 }}\n\n{tail}\n\
         [clearance]\npayload = [{{ ring = {{ centre_m = [0.0, 0.0, -1.0], axis = [0.0, 0.0, 1.0], radius_m = 0.6 }} }}]\n\
         stage = [{{ ring = {{ centre_m = [0.0, 0.0, 1.0], axis = [0.0, 0.0, 1.0], radius_m = 0.6 }} }}, \
         {{ points_m = [[1.0, 1.0, 1.2]] }}]\n"
    );
    Scenario::from_toml(&text.replace("title = \"", "title = \"<b>&\\\"</i> ")).unwrap()
}

#[test]
fn reports_are_valid() {
    for runs in [1, 12] {
        check(&report_of(&full().with_runs(runs).unwrap()));
    }
    // Every run fails: the horizon is too short.
    let text = Scenario::peck_2003().unwrap().with_runs(3).unwrap().to_toml();
    let failing = text.replace("horizon_s = 60.0", "horizon_s = 0.01");
    assert_ne!(failing, text);
    check(&report_of(&Scenario::from_toml(&failing).unwrap()));
}

#[test]
fn replays_are_valid() {
    for run in 0..3 {
        let replay = Replay::new(&full(), None, run, 2.0).unwrap();
        check(&replay::page::html(&replay));
    }
}

#[test]
fn comparisons_are_valid() {
    let options = CompareOptions { draws: 60, separations: 4, ..CompareOptions::default() };
    check(&compare::page_of(&ModelComparison::run(&options, &|_| {}).unwrap()));
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
