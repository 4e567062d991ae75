//! Numbers as the animation takes them.

use serde_json::{Value, json};

/// To six digits; what is not finite is zero, which draws.
pub(super) fn short(values: &[f64]) -> Vec<Value> {
    let number = |x: &f64| {
        let text = if x.is_finite() { format!("{x:.5e}") } else { "0".to_owned() };
        // Back from text, for the shortest form of it.
        json!(text.parse::<f64>().unwrap_or(0.0))
    };
    values.iter().map(number).collect()
}
