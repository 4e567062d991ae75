//! Pages: every link to a file or a heading of the repository leads somewhere, and the README names the crates.

use std::collections::BTreeSet;

use super::files::{crates, files, read, root};

/// The targets of a page's links, those of code apart.
fn links(page: &str) -> Vec<&str> {
    let prose = page.split("```").step_by(2);
    prose
        .flat_map(|text| text.split("](").skip(1))
        .filter_map(|rest| rest.split(')').next())
        .collect()
}

/// The anchors that GitHub gives the headings of a page.
fn anchors(page: &str) -> BTreeSet<String> {
    let kept = |c: &char| c.is_alphabetic() || c.is_ascii_digit() || ['-', '_', ' '].contains(c);
    let anchor = |heading: &str| {
        let text = heading.trim_start_matches('#').trim().to_lowercase();
        text.chars().filter(kept).map(|c| if c == ' ' { '-' } else { c }).collect()
    };
    let prose = page.split("```").step_by(2).flat_map(str::lines);
    prose.filter(|line| line.starts_with('#')).map(anchor).collect()
}

/// Where a link of a page leads, from the root of the repository.
fn target(page: &str, link: &str) -> String {
    let mut parts: Vec<&str> = page.split('/').collect();
    parts.pop();
    for part in link.split('/') {
        match part {
            "." | "" => {}
            ".." => {
                parts.pop();
            }
            part => parts.push(part),
        }
    }
    parts.join("/")
}

/// Whether a link of a page leads nowhere.
fn is_broken(page: &str, text: &str, link: &str) -> bool {
    let (path, anchor) = link.split_once('#').unwrap_or((link, ""));
    let target = if path.is_empty() { page.to_owned() } else { target(page, path) };
    if !root().join(&target).exists() {
        return true;
    }
    let other = if path.is_empty() || anchor.is_empty() { text.to_owned() } else { read(&target) };
    !anchor.is_empty() && !anchors(&other).contains(anchor)
}

#[test]
fn links_lead_somewhere() {
    let mut count = 0;
    for page in files(".", "md") {
        let text = read(&page);
        for link in links(&text).into_iter().filter(|link| !link.contains("://")) {
            assert!(!is_broken(&page, &text, link), "{page}: {link}");
            count += 1;
        }
    }
    assert!(count > 50);
    for link in ["nowhere.md", "study.md#nowhere", "#nowhere", "../nowhere/study.md"] {
        assert!(is_broken("docs/scenario.md", "# Here", link), "{link}");
    }
    for link in ["study.md", "study.md#the-folder", "#here", "../README.md", "models"] {
        assert!(!is_broken("docs/scenario.md", "# Here", link), "{link}");
    }
}

/// Paths of the repository that a page writes as code.
fn paths(page: &str) -> Vec<&str> {
    let code = page.split('`').skip(1).step_by(2);
    code.filter(|code| ["crates/", "tests/", "docs/", ".ci/"].iter().any(|f| code.starts_with(f)))
        .collect()
}

#[test]
fn paths_in_pages_for_contributors_exist() {
    for page in ["CONTRIBUTING.md", "docs/architecture.md", "docs/reading-the-paper.md"] {
        let text = read(page);
        let paths = paths(&text);
        assert!(paths.len() > 2, "{page}");
        for path in paths {
            assert!(root().join(path).exists(), "{page}: {path}");
        }
    }
}

#[test]
fn every_page_is_linked_from_the_readme_or_from_one_that_is() {
    let mut seen = BTreeSet::new();
    let mut next = vec!["README.md".to_owned()];
    while let Some(page) = next.pop() {
        if page.ends_with(".md") && seen.insert(page.clone()) {
            let text = read(&page);
            let paths = links(&text).into_iter().filter(|link| !link.contains("://"));
            next.extend(paths.map(|link| target(&page, link.split('#').next().unwrap_or(link))));
        }
    }
    let missing: Vec<String> =
        files("docs", "md").into_iter().filter(|p| !seen.contains(p)).collect();
    assert_eq!(missing, [""; 0]);
}

#[test]
fn the_readme_names_every_crate() {
    let readme = read("README.md");
    let rows = readme.lines().filter_map(|line| line.strip_prefix("| [`gyradius"));
    let named: BTreeSet<&str> =
        rows.filter_map(|row| row.split_once("(crates/")?.1.split(')').next()).collect();
    let crates = crates();
    assert_eq!(named, crates.iter().map(String::as_str).collect());
    for name in named {
        let manifest = read(&format!("crates/{name}/Cargo.toml"));
        let package = manifest.split('"').nth(1).unwrap();
        assert!(readme.contains(&format!("| [`{package}`](crates/{name}) |")), "{package}");
    }
}
