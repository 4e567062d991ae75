//! Numbers as an engineer writes them.

/// Four significant digits, and no more zeros than it needs.
pub(crate) fn short(x: f64) -> String {
    let size = x.abs();
    if size != 0.0 && !(1e-4..1e6).contains(&size) {
        let text = format!("{x:.3e}");
        let Some((digits, exponent)) = text.split_once('e') else { return text };
        let digits = digits.trim_end_matches('0').trim_end_matches('.');
        return format!("{digits}e{exponent}");
    }
    let decimals = if size == 0.0 { 0 } else { (3.0 - size.log10().floor()).max(0.0) as usize };
    let text = format!("{x:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// A value as exact as its standard error, which has two digits: `40.02 ± 0.031`.
pub(crate) fn with_error(x: f64, error: Option<f64>) -> String {
    let Some(error) = error.filter(|e| *e > 0.0 && e.is_finite()) else { return short(x) };
    let place = error.log10().floor() as i32;
    if !(-6..=4).contains(&place) {
        return format!("{x:.4e} ± {error:.1e}");
    }
    let decimals = (1 - place).max(0) as usize;
    format!("{x:.decimals$} ± {error:.decimals$}")
}

/// A probability: two digits, and not zero.
pub(crate) fn probability(p: f64) -> String {
    if p < 1e-99 {
        "< 1e-99".to_owned()
    } else if p < 0.001 {
        format!("{p:.0e}")
    } else {
        format!("{p:.3}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (x, text) in [
            (0.0, "0"),
            (1.0, "1"),
            (0.012345, "0.01235"),
            (1234.56, "1235"),
            (300.0, "300"),
            (1e-7, "1e-7"),
            (1.25e9, "1.25e9"),
            (-0.5, "-0.5"),
            (123456.0, "123456"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(short(x), text);
        }
    }

    #[test]
    fn errors_set_the_digits() {
        for (x, error, text) in [
            (40.0213, Some(0.0312), "40.021 ± 0.031"),
            (40.0213, Some(123.4), "40 ± 123"),
            (1.5, None, "1.5"),
            (1.5, Some(0.0), "1.5"),
            (1.5, Some(1e-9), "1.5000e0 ± 1.0e-9"),
        ] {
            assert_eq!(with_error(x, error), text);
        }
    }
}
