//! Pages of HTML that need nothing but themselves.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::visible::visible;

const STYLE: &str = include_str!("page.css");

/// A page in the style that all have, and in its own, without characters that command how it is shown.
pub fn page(title: &str, style: &str, content: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) (PreEscaped(style)) }
            }
            body { main { (content) } }
        }
    };
    visible(&page.into_string())
}
