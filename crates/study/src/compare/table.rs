//! The comparison as CSV: one row for each model, body, level and measure.

use std::fmt::Write;

use super::ModelComparison;

const HEADER: &str = "body,level_percent,reference,model,problem,matched,mean_off,covariance_off,\
                      off_from_draws,acceptance,draws,unrealizable,unrealizable_share,\
                      unrealizable_lower,unrealizable_upper,separations,failed_separations,measure,unit,\
                      n,undefined,mean,deviation,p05,median,p95";

impl ModelComparison {
    /// One row for each body, level, model and measure, in the columns of docs/compare.md; a model
    /// that cannot be made has one row with its reason. Numbers read back bit for bit.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let mut out = format!("{HEADER}\n");
        for body in &self.bodies {
            for level in &body.levels {
                let percent = level.level_percent.map_or_else(String::new, |p| p.to_string());
                let place =
                    format!("{},{percent},{}", quoted(&body.name), self.settings.reference.name());
                if let Some(problem) = &level.problem {
                    let _ = writeln!(out, "{place},,{}{}", quoted(problem), ",".repeat(21));
                }
                for cell in &level.models {
                    let place = format!("{place},{}", cell.model);
                    let Some(r) = &cell.results else {
                        let problem = cell.problem.as_deref().unwrap_or_default();
                        let _ = writeln!(out, "{place},{}{}", quoted(problem), ",".repeat(21));
                        continue;
                    };
                    let u = &r.unrealizable;
                    let place = format!(
                        "{place},,{},{},{},{},{},{},{},{},{},{},{},{}",
                        quoted(&r.matched),
                        r.fit.mean_off,
                        r.fit.covariance_off,
                        r.fit.from_draws,
                        number(r.acceptance),
                        u.of,
                        u.count,
                        u.share,
                        u.interval.lower(),
                        u.interval.upper(),
                        r.separations,
                        r.failed_separations,
                    );
                    for s in &r.spreads {
                        let numbers =
                            [s.mean, s.deviation, s.p05, s.median, s.p95].map(number).join(",");
                        let _ = writeln!(
                            out,
                            "{place},{},{},{},{},{numbers}",
                            s.measure.name(),
                            s.unit,
                            s.n,
                            s.undefined
                        );
                    }
                }
            }
        }
        out
    }
}

fn number(x: Option<f64>) -> String {
    x.map_or_else(String::new, |x| x.to_string())
}

/// A field that may hold commas.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_quoted_where_they_must_be() {
        assert_eq!(quoted("payload"), "payload");
        assert_eq!(quoted("1,2,3"), "\"1,2,3\"");
        assert_eq!(quoted("a \"b\""), "\"a \"\"b\"\"\"");
        assert_eq!(HEADER.split(',').count(), 26);
    }
}
