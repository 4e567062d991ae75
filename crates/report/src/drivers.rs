//! What drives outputs: for each of them the share of its variance that groups of inputs explain, alone and in all.

use crate::Drawing;
use crate::data::{self, Field, Sheet};
use crate::style::{self, MARGIN};
use crate::svg::{Anchor, Look, Svg, px};
use crate::text::{fit, significant};

const WIDTH: f64 = 540.0;
const WIDEST: f64 = 640.0;
/// Room of the names of groups, and of the number after a bar.
const NAMES: f64 = 228.0;
const NUMBER: f64 = 46.0;
const ACROSS: f64 = WIDTH - 2.0 * MARGIN - NAMES - NUMBER;
const ROW: f64 = 27.0;
const BAR: f64 = 8.0;
const TICKS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
/// Groups that are drawn of an output, the largest first.
const MOST: usize = 8;

const TITLE: Look = Look::new(13.5, style::INK).bold();
const TICK: Look = Look::new(12.0, style::MUTED);
const NAME: Look = Look::new(12.5, style::INK).at(Anchor::End);

/// What drives an output.
#[derive(Clone, Debug, PartialEq)]
pub struct DrivenOutput {
    /// What it is called, with its unit.
    pub label: String,
    /// Each group of inputs.
    pub groups: Vec<DrivingGroup>,
}

/// What a group of inputs drives of an output: estimates between 0 and 1, and their intervals.
#[derive(Clone, Debug, PartialEq)]
pub struct DrivingGroup {
    /// What it is called.
    pub name: String,
    /// The share that it explains alone: lower end, estimate, upper end.
    pub first: Option<[f64; 3]>,
    /// The share that would be left if all else were known.
    pub total: Option<[f64; 3]>,
}

impl DrivenOutput {
    /// The groups, those that drive most first.
    #[must_use]
    pub fn ranked(&self) -> Vec<&DrivingGroup> {
        let mut groups: Vec<&DrivingGroup> = self.groups.iter().collect();
        let unknown = f64::NEG_INFINITY;
        let share = |group: &DrivingGroup| group.total.map_or(unknown, |[_, share, _]| share);
        groups.sort_by(|a, b| share(b).total_cmp(&share(a)));
        groups
    }
}

/// The bars of outputs, one below the other.
#[must_use]
pub fn drivers_figure(name: &str, caption: &str, outputs: &[DrivenOutput]) -> Drawing {
    let drawing = Drawing::new(name, caption, svg(caption, outputs));
    drawing.with_numbers(data::json(&outputs.iter().map(sheet).collect::<Vec<_>>()))
}

fn svg(caption: &str, outputs: &[DrivenOutput]) -> String {
    let mut svg = Svg::new();
    let mut top = key(&mut svg, MARGIN);
    for output in outputs {
        top = panel(&mut svg, output, top + 14.0);
    }
    svg.finish_within(WIDEST, (WIDTH, top + MARGIN), caption, &description(outputs))
}

/// What the two bars mean; returns where that ends.
fn key(svg: &mut Svg, top: f64) -> f64 {
    for (place, words) in ["alone (first order)", "with interactions (total)"].iter().enumerate() {
        let x = MARGIN + 170.0 * place as f64;
        svg.path(&pen(place), &format!("M{} {}h22v{BAR}h-22z", px(x), px(top + 2.0)));
        svg.text(x + 29.0, top + 10.5, Look::new(12.0, style::INK), words);
    }
    top + 16.0
}

/// The bar of a share alone, and of that in all.
fn pen(place: usize) -> String {
    let colour = style::model(0);
    match place {
        0 => format!("fill=\"{colour}\""),
        _ => format!(
            "fill=\"{colour}\" fill-opacity=\"0.28\" stroke=\"{colour}\" stroke-width=\"0.8\""
        ),
    }
}

fn panel(svg: &mut Svg, output: &DrivenOutput, top: f64) -> f64 {
    let groups = output.ranked();
    let (shown, rest) = groups.split_at(groups.len().min(MOST));
    svg.text(
        MARGIN,
        top + 12.0,
        TITLE,
        &fit(&output.label, TITLE.size * 1.2, WIDTH - 2.0 * MARGIN),
    );
    let (left, first) = (MARGIN + NAMES, top + 22.0);
    let base = first + ROW * shown.len() as f64;
    let at = |share: f64| left + ACROSS * share.clamp(0.0, 1.0);
    let grid: String =
        TICKS.iter().map(|tick| format!("M{} {}V{}", px(at(*tick)), px(first), px(base))).collect();
    svg.path(&format!("stroke=\"{}\"", style::GRID), &grid);
    for (row, group) in shown.iter().enumerate() {
        let y = first + ROW * row as f64;
        svg.text(left - 8.0, y + 17.0, NAME, &fit(&group.name, NAME.size, NAMES - 8.0));
        let bars = [(0, group.first, y + 5.0), (1, group.total, y + 5.0 + BAR + 1.0)];
        for (place, share, y) in bars {
            let Some([lower, share, upper]) = share else { continue };
            // What is beyond 0 or 1, where no share can be, is drawn there.
            let wide = (at(share) - left).max(0.5);
            svg.path(
                &pen(place),
                &format!("M{} {}h{}v{BAR}h-{}z", px(left), px(y), px(wide), px(wide)),
            );
            let whisker = format!("M{} {}H{}", px(at(lower)), px(y + BAR / 2.0), px(at(upper)));
            svg.path(&format!("stroke=\"{}\" stroke-width=\"1.2\"", style::INK), &whisker);
        }
        let number = group.total.map_or_else(|| "–".to_owned(), |[_, share, _]| told(share));
        svg.text(left + ACROSS + 8.0, y + 17.0, Look::new(12.5, style::INK), &number);
    }
    svg.path(
        &format!("stroke=\"{}\"", style::AXIS),
        &format!("M{} {}V{}", px(left), px(first), px(base)),
    );
    for tick in TICKS {
        svg.text(at(tick), base + 15.0, TICK.at(Anchor::Middle), &format!("{tick}"));
    }
    let mut end = base + 20.0;
    if let Some(text) = others(rest) {
        svg.text(MARGIN, end + 13.0, TICK, &fit(&text, TICK.size, WIDTH - 2.0 * MARGIN));
        end += 18.0;
    }
    end
}

/// What is said of groups that are not drawn, those that drive most first.
fn others(rest: &[&DrivingGroup]) -> Option<String> {
    let (count, unknown) = (rest.len(), rest.iter().filter(|group| group.total.is_none()).count());
    let (groups, shares) = if count == 1 { ("group", "share") } else { ("groups", "shares") };
    let most = rest.first()?.total.map(|[_, share, _]| told(share));
    // As small a number stands for an upper bound, and is one.
    let at_most = |most: String| match most.strip_prefix("< ") {
        Some(bound) => format!("less than {bound}"),
        None => format!("at most {most}"),
    };
    Some(match (most, unknown) {
        (None, _) => format!("{count} more {groups}, of unknown {shares}"),
        (Some(most), 0) if count == 1 => match most.strip_prefix("< ") {
            Some(bound) => format!("1 more group, with a share of less than {bound} in all"),
            None => format!("1 more group, with a share of {most} in all"),
        },
        (Some(most), 0) => format!("{count} more groups, each with {} in all", at_most(most)),
        (Some(most), _) => format!(
            "{count} more groups, {unknown} of unknown shares and each of the others with {} in all",
            at_most(most)
        ),
    })
}

/// A share in two digits after the point, or how small it is, where it is drawn: between 0 and 1.
fn told(share: f64) -> String {
    let share = share.clamp(0.0, 1.0);
    if share > 0.0 && share < 0.005 { "< 0.01".to_owned() } else { format!("{share:.2}") }
}

fn sheet(output: &DrivenOutput) -> Sheet {
    let parts = ["first order", "total"]
        .map(|of| ["lower", "estimate", "upper"].map(|p| format!("{of}, {p}")));
    let row = |group: &DrivingGroup| {
        let numbers = [group.first, group.total].into_iter();
        let numbers =
            numbers.flat_map(|share| [0, 1, 2].map(|i| Field::Number(share.map(|s| s[i]))));
        [Field::words(&group.name)].into_iter().chain(numbers).collect()
    };
    Sheet {
        panel: output.label.clone(),
        columns: [String::from("group")].into_iter().chain(parts.into_iter().flatten()).collect(),
        rows: output.groups.iter().map(row).collect(),
    }
}

/// The figure in words.
fn description(outputs: &[DrivenOutput]) -> String {
    let mut text = String::from("Shares of the variance of outputs that groups of inputs drive.");
    for output in outputs {
        let groups = output.ranked().into_iter().take(3).filter_map(|group| {
            let [_, total, _] = group.total?;
            let alone = group.first.map_or_else(String::new, |[_, share, _]| {
                format!(", {} alone", significant(share, 2))
            });
            Some(format!("{} {} in all{alone}", group.name, significant(total, 2)))
        });
        let groups: Vec<String> = groups.collect();
        text.push_str(&format!(" {}: {}.", output.label, groups.join("; ")));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::svg::tests::read;
    use proptest::prelude::*;

    fn share() -> impl Strategy<Value = Option<[f64; 3]>> {
        prop::option::weighted(0.9, [-0.1..1.1_f64, -0.1..1.1, -0.1..1.1])
    }

    proptest! {
        /// Whatever the numbers and names, there is a figure that reads, with the largest group on top.
        #[test]
        fn figures_read(
            outputs in prop::collection::vec(
                ("[ -~]{0,60}", prop::collection::vec(("[ -~]{0,50}", share(), share()), 0..30)),
                0..5,
            ),
        ) {
            let outputs: Vec<DrivenOutput> = outputs.into_iter().map(|(label, groups)| DrivenOutput {
                label,
                groups: groups.into_iter()
                    .map(|(name, first, total)| DrivingGroup { name, first, total })
                    .collect(),
            }).collect();
            let seen = read(&svg("Drivers", &outputs));
            for output in &outputs {
                let more = output.groups.len().saturating_sub(MOST);
                let said = format!("{more} more group");
                prop_assert!(!seen.contains("than <") && !seen.contains("most <"), "{}", seen);
                prop_assert!(!seen.contains("than unknown"), "{}", seen);
                prop_assert!(more == 0 || seen.contains(&said), "{}", seen);
                let ranked = output.ranked();
                let share = |g: &&DrivingGroup| g.total.map_or(f64::NEG_INFINITY, |t| t[1]);
                prop_assert!(ranked.is_sorted_by(|a, b| share(a) >= share(b)));
            }
            let sheets: Vec<Sheet> = outputs.iter().map(sheet).collect();
            prop_assert!(sheets.iter().all(|s| s.rows.iter().all(|row| row.len() == s.columns.len())));
        }
    }
}
