//! In which order springs are released, where their energy goes, and how near the bodies come, in words.

use gyradius_report::{Text, interval, optional, percent, significant};

use super::sample;
use crate::{
    quantity::Quantity,
    summary::{ClearanceSummary, ModelSummary},
};

/// In which order the springs of a model are released, and what comes of it; none if no run succeeds.
pub(super) fn told(model: &ModelSummary) -> Option<Text> {
    let releases = &model.releases;
    let pressed = releases.recompressed?;
    let mut text = Text::default().strong(&model.name).plain(": ");
    for (i, order) in releases.orders.iter().take(3).enumerate() {
        let runs = format!(" in {} of the runs", percent(&order.share));
        text = text.plain(if i > 0 { "; " } else { "" });
        text = match &*order.order {
            "" => text.plain("no spring pushed"),
            order => text
                .plain(if i > 0 { "in the order " } else { "the springs released in the order " })
                .code(order),
        };
        text = text.plain(runs);
    }
    let others = if releases.orders.len() > 3 { "; other orders in the rest" } else { "" };
    text = text.plain(format!("{others}. {}", energy(model)));
    if let Some(clearance) = &releases.clearance {
        text = text.plain(format!(" {}", nearest(clearance)));
    }
    if let Some(touch) = releases.recontact {
        text = text.plain(format!(" The bodies touch again in {} of the runs.", percent(&touch)));
    }
    if pressed.count > 0 {
        text = text.plain(format!(
            " A spring was pressed again after its release in {} of the runs.",
            percent(&pressed)
        ));
    }
    Some(text)
}

/// How near the bodies come.
fn nearest(clearance: &ClearanceSummary) -> String {
    let mut text = match (clearance.least_m, clearance.run) {
        (Some(least), Some(run)) => {
            format!("The smallest clearance is {} m (run {run})", significant(least, 4))
        }
        _ => "No run has a clearance".to_owned(),
    };
    if let Some(p01) = clearance.p01_m {
        let p01 = format!("; the 1st percentile of the clearances is {} m", significant(p01, 4));
        let interval = interval(clearance.p01_interval_m, 4);
        text.push_str(format!("{p01} {interval}").trim_end());
    }
    if let Some(p05) = clearance.p05_m {
        text.push_str(&format!(", and the 5th {} m", significant(p05, 4)));
    }
    text.push('.');
    for (note, count) in &clearance.notes {
        let runs = if *count == 1 { "run" } else { "runs" };
        text.push_str(&format!(" In {count} {runs} {note}."));
    }
    text
}

/// Where the energy of the springs goes, on the average.
fn energy(model: &ModelSummary) -> String {
    let mean = |q| sample(model, q).and_then(|s| s.mean);
    let Some(whole) = mean(Quantity::SpringEnergy).filter(|whole| *whole > 0.0) else {
        return String::new();
    };
    let percent = |q| optional(mean(q).map(|part| 100.0 * part / whole), 3);
    format!(
        "Of {} J in the springs {} % go into translation and {} % into rotation of the payload, {} % \
         and {} % of the stage.",
        significant(whole, 4),
        percent(Quantity::PayloadTranslation),
        percent(Quantity::PayloadRotation),
        percent(Quantity::StageTranslation),
        percent(Quantity::StageRotation)
    )
}
