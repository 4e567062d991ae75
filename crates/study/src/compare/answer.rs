//! The answer of a comparison in a few sentences, which stands first on its page.

use gyradius_dispersion::ModelKind;
use gyradius_report::{Text, significant};

use super::{
    BodyResult, LevelResult, ModelComparison,
    contest::Results,
    figures_of_models::capital,
    measure::Measure,
    text::{heading, kinds},
};

/// A share of draws from which on a model is said to fail.
const OFTEN: f64 = 0.01;
/// What is told of the spread.
const TOLD: [Measure; 3] = [Measure::InertiaRatio, Measure::Wobble, Measure::Nutation];

/// Which models draw what no body has, and how much depends on the choice of the others.
pub(super) fn answer(comparison: &ModelComparison) -> Vec<Text> {
    let told = TOLD.into_iter().filter_map(|measure| disagreement(comparison, measure));
    [impossible(comparison)].into_iter().chain(told).collect()
}

/// What models found, with the places where they did.
fn results(
    comparison: &ModelComparison,
) -> impl Iterator<Item = (&BodyResult, &LevelResult, ModelKind, &Results)> {
    comparison.bodies.iter().flat_map(|body| {
        body.levels.iter().flat_map(move |level| {
            let found = move |kind| Some((body, level, kind, level.cell(kind)?.results.as_ref()?));
            kinds(body).into_iter().filter_map(found)
        })
    })
}

fn impossible(comparison: &ModelComparison) -> Text {
    let is_drawn = |kind: &ModelKind| results(comparison).any(|(_, _, of, _)| of == *kind);
    let kinds: Vec<ModelKind> =
        comparison.settings.models.iter().copied().filter(is_drawn).collect();
    let said: Vec<String> = kinds.iter().filter_map(|kind| draws_of(comparison, *kind)).collect();
    if kinds.is_empty() {
        return Text::default().strong("Nothing was drawn. ").plain(
            "None of the models exists for these bodies at these levels. The reasons are said below.",
        );
    }
    if said.is_empty() {
        return Text::default().strong("Every draw is a body. ").plain(
            "None of the models drew a matrix that no body has at these levels. That a model never can is said below.",
        );
    }
    Text::default().strong("Some models draw matrices that no body has: ").plain(format!(
        "{}. {}",
        said.join(". "),
        if said.len() < kinds.len() {
            "The others drew none."
        } else {
            "There is no other model here."
        }
    ))
}

/// How many impossible matrices a model draws, and from which level on it does so often; nothing if it draws none.
fn draws_of(comparison: &ModelComparison, kind: ModelKind) -> Option<String> {
    let all = || results(comparison).filter(|(_, _, of, _)| *of == kind);
    let (body, level, _, most) =
        all().max_by(|a, b| a.3.unrealizable.share.total_cmp(&b.3.unrealizable.share))?;
    if most.unrealizable.count == 0 {
        return None;
    }
    let percent = significant(100.0 * most.unrealizable.share, 2);
    let mut text = format!("{} up to {percent} % ({}, {})", kind.name(), body.name, heading(level));
    let often = all().filter(|(_, _, _, r)| r.unrealizable.share >= OFTEN);
    let first = often
        .filter_map(|(body, level, _, _)| Some((body, level.level_percent?)))
        .min_by(|a, b| a.1.total_cmp(&b.1));
    if let Some((body, level)) = first {
        text.push_str(&format!(
            "; at least one draw in a hundred from {level} % on ({})",
            body.name
        ));
    }
    Some(text)
}

/// Where models that have the covariance asked for differ most, and by how much.
fn disagreement(comparison: &ModelComparison, measure: Measure) -> Option<Text> {
    let mut widest: Option<(f64, String)> = None;
    for body in &comparison.bodies {
        for level in &body.levels {
            let of = |kind: ModelKind| {
                let results = level.cell(kind)?.results.as_ref().filter(|r| !r.fit.is_poor())?;
                let value = results.spread(measure)?.headline()?;
                (value > 0.0 && value.is_finite()).then_some((value, kind))
            };
            let found: Vec<(f64, ModelKind)> = kinds(body).into_iter().filter_map(of).collect();
            let by = |a: &&(f64, ModelKind), b: &&(f64, ModelKind)| a.0.total_cmp(&b.0);
            let (Some(low), Some(high)) = (found.iter().min_by(by), found.iter().max_by(by)) else {
                continue;
            };
            let ratio = high.0 / low.0;
            if low.1 == high.1 || widest.as_ref().is_some_and(|(most, _)| *most >= ratio) {
                continue;
            }
            let number = |(value, kind): &(f64, ModelKind)| {
                let unit = if measure.unit() == "1" { "" } else { measure.unit() };
                let number = format!("{} {unit}", significant(*value, 3));
                format!("{} by {}", number.trim_end(), kind.name())
            };
            let place = format!(
                "{} against {} ({}, {})",
                number(low),
                number(high),
                body.name,
                heading(level)
            );
            widest = Some((ratio, place));
        }
    }
    let (ratio, place) = widest?;
    let what = format!("{}. ", capital(measure));
    let text = format!(
        "Models with like covariance differ by a factor of {} at most: {place}.",
        significant(ratio, 2)
    );
    Some(Text::default().strong(what).plain(text))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CompareOptions;

    fn said(models: Vec<ModelKind>, levels_percent: Vec<f64>) -> Vec<String> {
        said_of(["slender-stage", "bus"].map(str::to_owned).into(), models, levels_percent)
    }

    fn said_of(
        bodies: Vec<String>,
        models: Vec<ModelKind>,
        levels_percent: Vec<f64>,
    ) -> Vec<String> {
        let options = CompareOptions {
            bodies,
            levels_percent,
            models,
            draws: 400,
            separations: 0,
            ..CompareOptions::default()
        };
        let found = ModelComparison::run(&options, &|_| {}).unwrap();
        answer(&found).iter().map(|text| format!("{text:?}")).collect()
    }

    #[test]
    fn what_is_told_first_is_what_the_tables_say() {
        let both = said(vec![ModelKind::Principal, ModelKind::ENTRYWISE], vec![1.0, 50.0]);
        assert!(
            both[0].contains("entrywise up to") && both[0].contains("(slender-stage, 50 %)"),
            "{both:?}"
        );
        assert!(both[0].contains("The others drew none"), "{both:?}");
        // Inertia ratio and wobble; there are no separations, and no nutation.
        assert_eq!(both.len(), 3, "{both:?}");
        assert!(both[1].contains("by principal") && both[1].contains("by entrywise"), "{both:?}");
        // One model has nothing to differ from, and draws bodies alone.
        let one = said(vec![ModelKind::Principal], vec![1.0, 50.0]);
        assert_eq!(one.len(), 1);
        assert!(one[0].contains("Every draw is a body"), "{one:?}");
        let bad = said(vec![ModelKind::ENTRYWISE], vec![50.0]);
        assert!(bad[0].contains("no other model") && bad[0].contains("from 50 % on"), "{bad:?}");
        // No such law is about a rod; a model that does not exist is not one that draws bodies alone.
        let rod = || vec!["0,7,7".to_owned()];
        let none = said_of(rod(), vec![ModelKind::LogCholesky], vec![1.0]);
        assert!(none.len() == 1 && none[0].contains("Nothing was drawn"), "{none:?}");
        let naive = said_of(rod(), vec![ModelKind::LogCholesky, ModelKind::ENTRYWISE], vec![1.0]);
        assert!(naive[0].contains("no other model"), "{naive:?}");
    }
}
