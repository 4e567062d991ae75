//! Histograms of quantities under several models, in a grid of panels.

use serde::{Deserialize, Serialize};

use crate::bins::Binned;
use crate::data::Sheet;
use crate::legend::{Entry, legend};
use crate::panel::{Cell, Counted, Frame, GUTTER, most_bins, nominal_pen, outline_pen};
use crate::samples::Panel;
use crate::style::{self, MARGIN};
use crate::svg::{Anchor, Look, Svg};
use crate::text::{count, significant};

/// Histograms of quantities under several models, in a grid of panels: bins and counts.
///
/// Bins are those of Freedman and Diaconis, shared by the series of a panel and by the panels of one label, and no more than are
/// wide enough to be seen. The vertical axis counts runs if in every panel all series have as many
/// values, and is a density otherwise. Extreme values that would squeeze the rest are drawn at the
/// edges of the axis, in the colours of their models, and a note says how many they are and how far they
/// go. The colours of the models follow their first appearance, unless an order is [given](Self::in_colours_of).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HistogramGrid {
    title: String,
    columns: usize,
    panels: Vec<Option<Counted>>,
    /// Names in the order of their colours, before all others.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    order: Vec<String>,
}

impl HistogramGrid {
    /// A grid of panels, row by row with so many columns; `None` leaves its place empty.
    #[must_use]
    pub fn new(title: &str, panels: &[Option<Panel<'_>>], columns: usize) -> Self {
        let columns = columns.clamp(1, panels.len().max(1));
        let bins = shared_bins(panels, most_bins(plot(columns).0));
        let counted = |(panel, bins): (&Option<Panel<'_>>, _)| {
            panel.as_ref().map(|panel| Counted::new(panel, bins))
        };
        let panels = panels.iter().zip(bins).map(counted).collect();
        Self { title: title.to_owned(), columns, panels, order: Vec::new() }
    }

    /// The same, with models in the colours that they have in another figure of models in this order.
    #[must_use]
    pub fn in_colours_of<'a>(self, models: impl IntoIterator<Item = &'a str>) -> Self {
        Self { order: models.into_iter().map(str::to_owned).collect(), ..self }
    }

    /// The figure drawn.
    #[must_use]
    pub fn svg(&self) -> String {
        draw(&self.title, &self.panels, self.columns.max(1), &self.order)
    }

    /// Bins and counts, as a sheet for each panel that has any.
    pub(crate) fn sheets(&self) -> Vec<Sheet> {
        self.panels.iter().flatten().filter_map(Counted::sheet).collect()
    }
}

/// The bins of each panel. Panels of one label show one quantity, which can be compared on bins that they share.
fn shared_bins(panels: &[Option<Panel<'_>>], most: usize) -> Vec<Option<Binned>> {
    let mut bins = vec![None; panels.len()];
    for (first, panel) in panels.iter().enumerate() {
        let Some(panel) = panel else { continue };
        let alike: Vec<usize> = (0..panels.len())
            .filter(|i| panels[*i].as_ref().is_some_and(|other| other.label == panel.label))
            .collect();
        if alike.first() != Some(&first) {
            continue;
        }
        let of_all = || alike.iter().filter_map(|i| panels[*i].as_ref());
        let nominal = of_all().find_map(|panel| panel.nominal);
        let shared = Binned::new(of_all().flat_map(|panel| &panel.series), nominal, most);
        let mut next = 0;
        for (i, panel) in alike.iter().zip(of_all()) {
            let own = next..next + panel.series.len();
            next = own.end;
            bins[*i] = shared.as_ref().and_then(|shared| shared.of_series(own));
        }
    }
    bins
}

/// Width and height of a plot among so many columns.
fn plot(columns: usize) -> (f64, f64) {
    match columns {
        1 => (500.0, 220.0),
        2 => (350.0, 160.0),
        _ => (232.0, 122.0),
    }
}

fn draw(title: &str, panels: &[Option<Counted>], columns: usize, order: &[String]) -> String {
    let (width, height) = plot(columns);
    let density = panels.iter().flatten().any(sizes_differ);
    let mut names: Vec<&str> = order.iter().map(String::as_str).collect();
    let cells: Vec<Option<Cell<'_>>> = panels
        .iter()
        .map(|panel| {
            let panel = panel.as_ref()?;
            Some(Cell::new(panel, models(panel, &mut names), density, height))
        })
        .collect();
    let room = cells.iter().flatten().map(Cell::room).fold(22.0, f64::max);
    let pitch = room + width + GUTTER;
    // Half a tick label can stand out on the right of a plot.
    let figure_width = 2.0 * MARGIN + pitch * columns as f64 - GUTTER + 12.0;

    let mut svg = Svg::new();
    let mut y = svg.heading(title, figure_width);
    y = legend(&mut svg, entries(&names, &cells), y + 4.0, figure_width) + 8.0;
    if cells.iter().flatten().next().is_none() {
        let look = Look::new(12.0, style::MUTED).at(Anchor::Middle);
        svg.text(figure_width / 2.0, y + 30.0, look, "no data");
        y += 60.0;
    }
    for row in cells.chunks(columns).filter(|row| row.iter().any(Option::is_some)) {
        let mut bottom = y;
        for (column, cell) in row.iter().enumerate() {
            let Some(cell) = cell else { continue };
            let left = MARGIN + pitch * column as f64 + room;
            let frame = Frame { left, top: y + 18.0, width, height };
            bottom = bottom.max(cell.draw(&mut svg, &frame));
        }
        y = bottom + 16.0;
    }
    svg.finish((figure_width, y), title, &description(panels, density))
}

fn sizes_differ(panel: &Counted) -> bool {
    let mut sizes = panel.series.iter().map(|s| s.values).filter(|&n| n > 0);
    let first = sizes.next();
    sizes.any(|n| Some(n) != first)
}

/// Places of the names of the series among `names`, which grow as needed. Two series of the same
/// name in one panel are two entries.
fn models<'a>(panel: &'a Counted, names: &mut Vec<&'a str>) -> Vec<usize> {
    let mut taken = Vec::new();
    for series in &panel.series {
        let known = (0..names.len()).find(|i| names[*i] == series.name && !taken.contains(i));
        taken.push(known.unwrap_or_else(|| {
            names.push(&series.name);
            names.len() - 1
        }));
    }
    taken
}

fn entries(names: &[&str], cells: &[Option<Cell<'_>>]) -> Vec<Entry> {
    let entry = |name: &str, width: f64, pen: &str, d: &str| {
        let mut swatch = Svg::new();
        swatch.path(pen, d);
        Entry { name: name.to_owned(), width, swatch }
    };
    let shown = |(model, _): &(usize, &&str)| cells.iter().flatten().any(|cell| cell.shows(*model));
    let names = names.iter().enumerate().filter(shown);
    let mut entries: Vec<Entry> = names
        .map(|(model, name)| entry(name, 20.0, &outline_pen(model), "M0 5v-10h20v10"))
        .collect();
    if cells.iter().flatten().any(Cell::marks_nominal) {
        entries.push(entry("nominal", 4.0, &nominal_pen(), "M2 -7v14"));
    }
    entries
}

/// The figure in words.
fn description(panels: &[Option<Counted>], density: bool) -> String {
    let mut text = format!("Histograms, {}.", if density { "density" } else { "runs per bin" });
    for panel in panels.iter().flatten() {
        let told = panel.series.iter().enumerate().map(|(i, series)| {
            let finite = panel.bins.as_ref().map_or(0, |bins| bins.finite[i]);
            format!("{}, {}", series.name, summary(finite, series.quantiles))
        });
        let mut parts: Vec<String> = told.collect();
        if let Some(nominal) = panel.nominal {
            parts.push(format!("nominal {}", significant(nominal, 5)));
        }
        text.push_str(&format!(" {}: {}.", panel.label, parts.join("; ")));
    }
    text
}

fn summary(finite: usize, quantiles: Option<[f64; 3]>) -> String {
    quantiles.map_or_else(
        || "no data".to_owned(),
        |[least, middle, largest]| {
            format!(
                "{} values from {} to {}, median {}",
                count(finite),
                significant(least, 5),
                significant(largest, 5),
                significant(middle, 5)
            )
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{samples::Series, svg::tests::read};

    /// In a figure of any of four models, in any order, each has the colour of its place among all, and the legend names those that are drawn.
    #[test]
    fn models_have_the_colours_of_an_order() {
        let all = ["a1", "b2", "c3", "d4"];
        let values = bell(50, 1.0);
        for first in 0..4 {
            for second in (0..4).filter(|second| *second != first) {
                let series = [first, second].map(|i: usize| Series::new(all[i], &values, 50));
                let label = "x".to_owned();
                let panel = Some(Panel { label, series: series.to_vec(), nominal: None });
                let svg = HistogramGrid::new("", &[panel], 1).in_colours_of(all).svg();
                let seen = read(&svg);
                for (i, name) in all.iter().enumerate() {
                    let is_drawn = i == first || i == second;
                    assert_eq!(svg.contains(style::model(i)), is_drawn, "{first} {second} {i}");
                    assert_eq!(seen.lines().any(|line| line == *name), is_drawn, "{seen}");
                }
            }
        }
    }

    /// Drawn from what was written and read back.
    fn histogram_grid(title: &str, panels: &[Option<Panel<'_>>], columns: usize) -> String {
        let histograms = HistogramGrid::new(title, panels, columns);
        let read = serde_json::from_str(&serde_json::to_string(&histograms).unwrap());
        let svg = histograms.svg();
        assert_eq!(svg, HistogramGrid::svg(&read.unwrap()));
        svg
    }

    fn panel<'a>(values: &[&'a [f64]], nominal: Option<f64>) -> Option<Panel<'a>> {
        let names = ["one", "two", "two"];
        let series =
            values.iter().zip(names).map(|(values, name)| Series::new(name, values, values.len()));
        Some(Panel { label: "wobble (deg)".to_owned(), series: series.collect(), nominal })
    }

    fn bell(n: u32, spread: f64) -> Vec<f64> {
        let uniform = |i: u32, k: u32| f64::from(i.wrapping_mul(k) % 65_521) / 65_521.0 - 0.5;
        (1..=n).map(|i| spread * (uniform(i, 40_503) + uniform(i, 30_011))).collect()
    }

    #[test]
    fn whatever_the_data_there_is_a_figure() {
        let heap = [
            vec![],
            vec![0.0],
            vec![3.5; 100],
            vec![f64::NAN, f64::INFINITY, 1.0],
            vec![f64::MIN, 0.0, f64::MAX],
            vec![1e300, 2e300],
            vec![5e-324, 0.0],
            vec![1.0, 1.0f64.next_up()],
            bell(500, 1e-7).iter().map(|x| x + 1234.5).collect(),
            bell(500, 1.0),
        ];
        let nominals = [None, Some(0.0), Some(f64::NAN), Some(-1e300), Some(1234.5)];
        for (i, a) in heap.iter().enumerate() {
            for b in &heap {
                for nominal in nominals {
                    let values: [&[f64]; 3] = [a, b, &heap[i]];
                    let svg = histogram_grid("", &[panel(&values, nominal), None], i);
                    assert!(read(&svg).contains("wobble (deg)"));
                    assert_eq!(svg, histogram_grid("", &[panel(&values, nominal), None], i));
                }
            }
        }
    }

    #[test]
    fn without_data_the_figure_says_so() {
        for panels in [vec![], vec![None, None], vec![panel(&[], None)], vec![panel(&[&[]], None)]]
        {
            assert!(read(&histogram_grid("Title", &panels, 0)).contains("no data"));
        }
    }

    #[test]
    fn equal_sizes_are_counted_and_others_are_not() {
        let (a, b) = (bell(100, 1.0), bell(200, 1.0));
        let same = read(&histogram_grid("", &[panel(&[&a, &a], None)], 1));
        assert!(same.contains("runs per bin") && !same.contains("density"));
        let other = read(&histogram_grid("", &[panel(&[&a, &b], None)], 1));
        assert!(other.contains("density") && !other.contains("runs per bin"));
    }

    /// Panels of one label have the edges, and each the counts that they have as series of one panel; others have edges of their own.
    #[test]
    fn panels_of_one_label_share_their_bins() {
        let samples: Vec<Vec<f64>> = vec![
            bell(300, 1.0),
            bell(300, 0.1).iter().map(|x| x + 5.0).collect(),
            vec![],
            bell(20, 30.0),
            vec![2.0; 50],
        ];
        for (i, a) in samples.iter().enumerate() {
            for b in &samples {
                let other = Panel { label: "other".to_owned(), ..panel(&[a], None).unwrap() };
                let panels = [panel(&[a], Some(0.5)), Some(other), None, panel(&[b, a], Some(0.5))];
                let grid = HistogramGrid::new("", &panels, 1);
                let bins = |place: usize| grid.panels[place].as_ref().and_then(|p| p.bins.as_ref());
                let together = HistogramGrid::new("", &[panel(&[a, b, a], Some(0.5))], 1);
                let together = together.panels[0].as_ref().and_then(|p| p.bins.as_ref());
                let alone = HistogramGrid::new("", &[panel(&[a], None)], 1);
                assert_eq!(bins(1), alone.panels[0].as_ref().and_then(|p| p.bins.as_ref()), "{i}");
                for (place, series) in [(0, 0..1), (3, 1..3)] {
                    let expected = together.and_then(|all| all.of_series(series));
                    assert_eq!(bins(place), expected.as_ref(), "{i} {place}");
                }
            }
        }
    }

    #[test]
    fn what_is_not_shown_is_told() {
        let mut values = bell(2000, 1.0);
        values.extend([1e6, f64::NAN, f64::NAN]);
        let text = read(&histogram_grid("", &[panel(&[&values], Some(-7.5))], 1));
        for note in ["at the right edge: 1, to ", "not finite: 2", "off the axis: −7.5"] {
            assert!(text.contains(note), "{text}");
        }
    }

    #[test]
    fn the_legend_is_there_once_and_keeps_names_apart() {
        let a = bell(100, 1.0);
        let panels = [panel(&[&a, &a, &a], Some(0.0)), panel(&[&a, &a], Some(0.0))];
        let svg = histogram_grid("", &panels, 2);
        assert_eq!(read(&svg).matches("one").count(), 1);
        assert_eq!(read(&svg).matches("two").count(), 2);
        assert_eq!(read(&svg).matches("nominal").count(), 1);
        assert_eq!(svg.matches(style::model(0)).count(), 2 * 3);
    }

    #[test]
    fn the_description_says_it_in_words() {
        let svg = histogram_grid("", &[panel(&[&[1.0, 2.0, 4.0]], Some(1.5))], 1);
        let words = "wobble (deg): one, 3 values from 1 to 4, median 2; nominal 1.5.";
        assert!(svg.contains(words));
    }

    #[test]
    fn six_panels_are_small() {
        let (a, b) = (bell(2000, 0.1), bell(2000, 2.0));
        let panels: Vec<_> = (0..6).map(|_| panel(&[&a, &b], Some(0.0))).collect();
        let size = histogram_grid("Title", &panels, 3).len();
        assert!(size < 30_000, "{size}");
    }
}
