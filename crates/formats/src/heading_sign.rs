//! Signs in headings: what they would say of the numbers below them is not read.

/// What is written for minus and plus.
const SIGNS: [char; 13] = ['-', '+', '−', '–', '—', '‐', '‑', '‒', '⁻', '⁺', '﹣', '－', '＋'];

/// A heading with blanks in place of its signs; nothing if it has none. What stands between two words is no sign:
/// `I-xy`, `kg-m²`, `Ixy - kg m²`. Nor is that of an exponent.
pub(crate) fn without_sign(heading: &str) -> Option<String> {
    // Longer texts are none, and would be searched for long.
    if heading.len() > 200 {
        return None;
    }
    let mut plain = String::with_capacity(heading.len());
    let mut has_sign = false;
    for (at, c) in heading.char_indices() {
        let (before, after) = (&heading[..at], &heading[at + c.len_utf8()..]);
        let is_sign = SIGNS.contains(&c)
            && !is_between_words(before, after)
            && !is_of_exponent(before, c, after);
        has_sign |= is_sign;
        plain.push(if is_sign { ' ' } else { c });
    }
    has_sign.then_some(plain)
}

/// Whether a sign is that of the exponent of a number, whose factor no unit may have: `10^-3 kg m2`, `10⁻³`.
fn is_of_exponent(before: &str, sign: char, after: &str) -> bool {
    let is_raised = "⁻⁺".contains(sign);
    let base = before.strip_suffix('^').or_else(|| before.strip_suffix("**"));
    let base = if is_raised { Some(before) } else { base.or(before.strip_suffix("^{")) };
    let is_digit = |c: char| {
        if is_raised { "⁰¹²³⁴⁵⁶⁷⁸⁹".contains(c) } else { c.is_ascii_digit() }
    };
    base.is_some_and(|base| base.ends_with(|c: char| c.is_ascii_digit()))
        && after.starts_with(is_digit)
}

/// Whether a dash between two parts of a heading joins them.
fn is_between_words(before: &str, after: &str) -> bool {
    let is_blank = |c: char| c.is_whitespace() || c == '_';
    let is_skipped = |c: char| is_blank(c) || SIGNS.contains(&c);
    let end = before.trim_end_matches(is_skipped).chars().next_back();
    let start = after.trim_start_matches(is_skipped).chars().next();
    let ends_a_word = |c: char| c.is_alphanumeric() || ")]}\"".contains(c);
    let begins_a_word = |c: char| c.is_alphanumeric() || "([{".contains(c);
    // With a blank before it and none behind it, it belongs to what follows: `Ixy -kg m²`.
    let leans = before.ends_with(is_blank) && !after.starts_with(is_skipped);
    end.is_some_and(ends_a_word) && start.is_some_and(begins_a_word) && !leans
}
