//! The pages as a browser shows them: on screens and phones, in the dark and on paper, and what their scripts do.
//!
//! Chromium is asked for what it shows, and `look.js` looks at each page from inside. Where no browser is installed
//! nothing is looked at, and that is said; where one is, every page must have been looked at.

mod pages;
mod rules;

use serde_json::Value;
use std::{
    env, fs,
    io::Read,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    sync::LazyLock,
    thread,
    time::{Duration, Instant},
};

const LOOK: &str = include_str!("look.js");
/// Names of the browser, of which the first that is installed is asked; `CHROMIUM` names another.
const BROWSERS: [&str; 5] =
    ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome"];
/// Where axe-core lies, if it is installed; `AXE_CORE` names another place.
const AXE: &str = "target/axe-core/axe.min.js";
/// Pages are to be sent by mail.
const MOST: usize = 700_000;
/// How often a browser may say nothing in a row.
const SILENT: u32 = 4;
/// Width of a sheet between the margins of the pages, in pixels of a 96th of an inch.
const A4: u32 = 703;
const LETTER: u32 = 725;

/// How a page is shown.
#[derive(Clone, Copy, Debug)]
struct Mode {
    name: &'static str,
    width: u32,
    dark: bool,
    paper: bool,
    /// Whether its scripts are tried as well.
    tried: bool,
    /// Whether axe-core looks at it too, where it is installed.
    axe: bool,
}

const MODES: [Mode; 5] = [
    Mode { name: "screen", width: 1280, dark: false, paper: false, tried: true, axe: false },
    Mode { name: "phone", width: 390, dark: false, paper: false, tried: false, axe: true },
    Mode { name: "dark", width: 1280, dark: true, paper: false, tried: false, axe: false },
    Mode { name: "A4", width: A4, dark: false, paper: true, tried: false, axe: false },
    Mode { name: "Letter", width: LETTER, dark: false, paper: true, tried: false, axe: false },
];

/// What a page said of itself in a mode.
#[derive(Clone, Debug, PartialEq)]
struct Look {
    name: String,
    found: Vec<String>,
}

fn browser() -> Option<PathBuf> {
    if let Some(named) = env::var_os("CHROMIUM") {
        return Some(named.into());
    }
    let folders: Vec<PathBuf> = env::split_paths(&env::var_os("PATH")?).collect();
    let places = BROWSERS.iter().flat_map(|name| folders.iter().map(move |f| f.join(name)));
    places.into_iter().find(|place| place.is_file())
}

fn axe() -> Option<PathBuf> {
    let place = env::var_os("AXE_CORE")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(AXE), PathBuf::from);
    place.is_file().then_some(place)
}

/// Looks at pages in modes, as many as are left in one browser.
fn look(browser: &Path, pages: &[(&str, String)], modes: &[Mode]) -> Vec<Look> {
    let scratch = tempfile::tempdir().unwrap();
    let axe = axe();
    if let Some(axe) = &axe {
        fs::copy(axe, scratch.path().join("axe.min.js")).unwrap();
    }
    let mut left = Vec::new();
    for (i, (page_name, page)) in pages.iter().enumerate() {
        for (k, mode) in modes.iter().enumerate() {
            let name = format!("{page_name}, {}", mode.name);
            let asked = serde_json::json!({
                "name": name, "dark": mode.dark, "paper": mode.paper, "use": mode.tried, "axe": mode.axe,
            });
            let tools =
                if mode.axe && axe.is_some() { "<script src=\"axe.min.js\"></script>" } else { "" };
            // Before the policy of the page, which lets nothing in.
            let with = format!(
                "<head><script>const mode = {asked};</script><script>{LOOK}</script>{tools}"
            );
            let file = format!("{i}-{k}.html");
            fs::write(scratch.path().join(&file), page.replacen("<head>", &with, 1)).unwrap();
            // A replay that is opened at a time stands still.
            let frame = format!(
                "<iframe width=\"{}\" height=\"900\" style=\"border:0\" src=\"{file}#t=0.1\"></iframe>",
                mode.width
            );
            left.push((name, frame));
        }
    }
    // A machine that is busy may leave the browser too little time: what it did not say is asked again, beside fewer others.
    let (mut seen, mut silent): (Vec<Look>, u32) = (Vec::new(), 0);
    while !left.is_empty() {
        let said = asked(browser, scratch.path(), &left);
        left.retain(|(name, _)| said.iter().all(|look| look.name != *name));
        silent = if said.is_empty() { silent + 1 } else { 0 };
        let names = || left.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>();
        assert!(silent < SILENT, "{} says nothing of {:?}", browser.display(), names());
        seen.extend(said);
    }
    seen
}

/// What pages in a folder say, by their frames; nothing of a browser that fails.
fn asked(browser: &Path, folder: &Path, frames: &[(String, String)]) -> Vec<Look> {
    let frames: String = frames.iter().map(|(_, frame)| frame.as_str()).collect();
    let all = folder.join("all.html");
    let page = format!(
        "<!DOCTYPE html><html><head><meta charset=\"utf-8\"></head><body><pre id=\"found\">[]</pre><script>\
         const all = []; addEventListener(\"message\", (event) => {{ all.push(event.data); \
         document.getElementById(\"found\").textContent = JSON.stringify(all); }});</script>{frames}</body></html>"
    );
    fs::write(&all, page).unwrap();
    // Virtual time passes while a picture is encoded, and a page may save many of them.
    let mut child = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"])
        .args(["--allow-file-access-from-files", "--virtual-time-budget=600000", "--dump-dom"])
        .arg(format!("--user-data-dir={}", folder.join("user").display()))
        .arg(format!("file://{}", all.display()))
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut out = child.stdout.take().unwrap();
    let reader = thread::spawn(move || {
        let mut text = Vec::new();
        out.read_to_end(&mut text).map(|_| String::from_utf8_lossy(&text).into_owned())
    });
    let until = Instant::now() + Duration::from_secs(60);
    while child.try_wait().unwrap().is_none() {
        if Instant::now() > until {
            child.kill().unwrap();
        }
        thread::sleep(Duration::from_millis(20));
    }
    let text = reader.join().unwrap().unwrap_or_default();
    let found =
        text.split_once("<pre id=\"found\">").and_then(|(_, rest)| rest.split_once("</pre>"));
    let plain = found.map(|(found, _)| {
        found
            .replace("&lt;", "<")
            .replace("&gt;", ">")
            .replace("&nbsp;", "\u{a0}")
            .replace("&amp;", "&")
    });
    let said: Option<Value> = plain.and_then(|plain| serde_json::from_str(&plain).ok());
    let looks = said.as_ref().and_then(Value::as_array).into_iter().flatten();
    let words = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let look = |look: &Value| Look {
        name: words(&look["name"]),
        found: look["found"].as_array().into_iter().flatten().map(words).collect(),
    };
    looks.map(look).collect()
}

/// A browser that shows pages, or a word that there is none; one that `CHROMIUM` names has to.
fn tried() -> Option<PathBuf> {
    let Some(found) = browser() else {
        println!("skipped: no browser is installed, none of {}", BROWSERS.join(", "));
        return None;
    };
    let scratch = tempfile::tempdir().unwrap();
    let says = "<iframe srcdoc=\"<script>parent.postMessage({name: 'trial', found: []}, '*')</script>\"></iframe>";
    let trial = [("trial".to_owned(), says.to_owned())];
    if (0..SILENT).any(|_| !asked(&found, scratch.path(), &trial).is_empty()) {
        return Some(found);
    }
    assert!(env::var_os("CHROMIUM").is_none(), "{} shows no page", found.display());
    println!("skipped: {} shows no page", found.display());
    None
}

/// The same, tried once for all tests.
fn installed() -> Option<&'static Path> {
    static TRIED: LazyLock<Option<PathBuf>> = LazyLock::new(tried);
    TRIED.as_deref()
}

#[test]
fn every_page_is_shown_as_it_should_be() {
    let Some(browser) = installed() else { return };
    if axe().is_none() {
        println!("without axe-core: {AXE} is not there");
    }
    let pages = pages::all();
    for (name, page) in &pages {
        assert!(page.len() < MOST, "{name} has {} bytes", page.len());
    }
    let mut looks = look(browser, &pages, &MODES);
    looks.retain(|look| !look.found.is_empty());
    assert!(looks.is_empty(), "{looks:#?}");
}

/// What is looked for is found where it is.
#[test]
fn what_is_wrong_is_found() {
    let Some(browser) = installed() else { return };
    let page = |style: &str, body: &str| {
        format!(
            "<!DOCTYPE html><html lang=\"en\"><head><title>t</title><style>body {{ margin: 0 }} {style}</style></head>\
             <body><main><h1>t</h1>{body}</main></body></html>"
        )
    };
    let figure = |size: &str, more: &str| {
        format!(
            "<svg width=\"300\" height=\"60\" viewBox=\"0 0 300 60\" role=\"img\"><title>a</title><desc>b</desc>\
             <text x=\"9\" y=\"20\" font-size=\"{size}\" fill=\"#222\">words</text>{more}</svg>"
        )
    };
    let wide =
        "<table><tbody><tr><td><div style=\"width:2000px\">a</div></td></tr></tbody></table>";
    let sorted = "<table><thead><tr><th scope=\"col\"><button>a</button></th></tr></thead><tbody><tr><td>2</td></tr>\
                  <tr><td>1</td></tr></tbody></table>";
    let other = "<text x=\"12\" y=\"22\" font-size=\"11\" fill=\"#222\">more</text>";
    let cases = [
        ("good", page("", &figure("11", "")), ""),
        ("wide", page("", wide), "clipped: table"),
        (
            "scrolls",
            page(".wide { overflow-x: auto }", &format!("<div class=\"wide\">{wide}</div>")),
            "no key scrolls",
        ),
        ("small", page("", &figure("8", "")), "letters of 8.0 px"),
        ("crowded", page("", &figure("11", other)), "on each other"),
        ("pale", page("p { color: #999 }", "<p>a</p>"), "contrast 2.85"),
        (
            "letters",
            page(
                "",
                "<table><tbody><tr><td style=\"width:1px;word-break:break-all\">abcdefgh</td></tr></tbody></table>",
            ),
            "cut into letters",
        ),
        ("loud", page("", "<script>console.warn(\"a\")</script>"), "console.warn: a"),
        ("broken", page("", "<script>nothing.at.all</script>"), "error: "),
        ("far", page("", "<img alt=\"a\" src=\"far.png\">"), "asks for"),
        ("unsorted", page("", sorted), "is not ascending"),
        (
            "unnamed",
            page("", "<svg viewBox=\"0 0 9 9\" width=\"9\" height=\"9\"></svg>"),
            "a figure has no title",
        ),
    ];
    let pages: Vec<(&str, String)> =
        cases.iter().map(|(name, page, _)| (*name, page.clone())).collect();
    let looks = look(browser, &pages, &MODES[..1]);
    for (name, _, expected) in &cases {
        let own = |look: &&Look| look.name == format!("{name}, screen");
        let look = looks.iter().find(own).unwrap();
        let found = look.found.iter().any(|found| found.contains(expected));
        assert_eq!(look.found.is_empty(), expected.is_empty(), "{look:?}");
        assert!(expected.is_empty() || found, "{expected}: {look:?}");
    }
}
