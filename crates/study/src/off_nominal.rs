//! Laws whose means are far from the nominal values of the same scenario.

use gyradius_report::significant;
use serde::{Deserialize, Serialize};
use std::fmt;

use crate::{
    off_roots::off_nominal_roots,
    scenario::{Axes, Dispersed, Joint, ScalarLawFile, Scenario, Target, UncertainBody},
};

/// A factor between the mean of a law and the nominal value beside it that nobody means: a decimal point that slipped makes ten, but for
/// the rounding and the spread of the law.
const FAR: f64 = 10.0 * (1.0 - 1e-6);
/// Standard deviations: of a mass centre, since one that a designer moved on purpose may be farther away; of a change, since one of no
/// effect must be as unlikely as this, and one of the size of the nominal value as likely, that the value itself is taken for it.
const DEVIATIONS: f64 = 3.0;
/// A share of the nominal value: the mean of a range that is narrow may be as far away.
const NEAR: f64 = 0.2;
/// A share of the size of a body, which is √(½ tr I ∕ m), the root mean square distance of its matter from the mass centre. A mass
/// centre that is told from another point is usually farther away than that.
const SHARE: f64 = 0.1;
/// Bytes of a law that are written out at most: a longer one, as of many samples, is no advice.
const LONGEST: usize = 400;

/// A law whose mean is far from the nominal value that the same scenario states.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "off_nominal")]
#[non_exhaustive]
pub enum OffNominal {
    /// The law is of the change from the nominal value, and the mean of the change is near the nominal value: the value itself may be meant.
    Change {
        /// The quantity, as the run table has it.
        quantity: String,
        /// Its nominal value.
        nominal: f64,
        /// The mean of the change.
        change: f64,
        /// What the scenario would say if the law were meant to be of the value itself.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        instead: Option<String>,
    },
    /// The mean of what is drawn is ten times the nominal value or more, a tenth of it or less, or of the other sign.
    Value {
        /// The quantity, as the run table has it.
        quantity: String,
        /// Its nominal value.
        nominal: f64,
        /// The mean of what is drawn.
        mean: f64,
    },
    /// The mean of the law of a mass centre is farther from the nominal one than three deviations and a tenth of the size of the body.
    Centre {
        /// The body.
        body: String,
        /// The mean less the nominal mass centre, body axes, m.
        change_m: [f64; 3],
        /// Whether the law is of that change, or of the mass centre itself.
        is_of_change: bool,
    },
}

impl OffNominal {
    /// Those of numbers that are drawn, of the roots and the inertias that bodies have by their own laws with axes that are read so, and of
    /// mass centres; the bodies are those of the joint law, in its order.
    pub(crate) fn all<'a, T: 'a>(
        numbers: impl Iterator<Item = &'a Dispersed<T>>,
        joint: &Joint<T>,
        bodies: &[(&str, &UncertainBody)],
        axes: Option<Axes>,
    ) -> Vec<Self> {
        let mut all: Vec<Self> = numbers.filter_map(Self::of_number).collect();
        for (name, body) in bodies {
            all.extend(of_lengths(name, body));
            let mean = || Some(trace(body.expected_moments(axes?)?.mean()));
            let nominal = trace(body.nominal().as_inertia_matrix().entries());
            let quantity = format!("trace of the inertia of the {name}");
            let of_trace = mean().and_then(|mean| Self::of_value(quantity, nominal, mean));
            let of_axes = off_nominal_roots(name, body).into_iter();
            let of_roots: Vec<Self> = of_axes
                .filter_map(|(root, nominal, mean)| Self::of_value(root, nominal, mean))
                .collect();
            match (of_roots.len(), of_trace) {
                // The whole inertia is, and no axis more than others.
                (0 | 3, Some(of_trace)) => all.push(of_trace),
                (_, Some(_) | None) => all.extend(of_roots),
            }
        }
        for (place, (name, body)) in bodies.iter().enumerate() {
            all.extend(of_centre(joint, place, name, body));
        }
        all
    }

    fn of_number<T>(number: &Dispersed<T>) -> Option<Self> {
        let Dispersed { column, given, nominal, law, each, change, .. } = number;
        let of_change = change.as_ref().and_then(|change| {
            let instead = || {
                let form = change.form.moved(-nominal / change.unit.size());
                let is_law = form.about(*nominal, change.unit).is_ok() && form != change.form;
                let meant = ScalarLawFile { form, drawn: *each }.to_string();
                (is_law && meant.len() <= LONGEST).then(|| format!("{given} = {meant}"))
            };
            let of = [law.mean() - nominal, law.deviation()];
            Self::of_change(column.clone(), *nominal, of, instead)
        });
        of_change.or_else(|| Self::of_value(column.clone(), *nominal, law.mean()))
    }

    /// Of a law of a change, from the mean and the deviation of it.
    fn of_change(
        quantity: String,
        nominal: f64,
        [change, deviation]: [f64; 2],
        instead: impl FnOnce() -> Option<String>,
    ) -> Option<Self> {
        let spread = DEVIATIONS * deviation;
        let is_distinct = change.abs().min(nominal.abs()) > spread;
        let is_near = (change - nominal).abs() <= spread.max(NEAR * nominal.abs());
        let told = is_distinct && is_near;
        told.then(|| Self::Change { quantity, nominal, change, instead: instead() })
    }

    /// Beside a nominal value of zero any mean will do.
    fn of_value(quantity: String, nominal: f64, mean: f64) -> Option<Self> {
        let is_far = nominal != 0.0 && !(1.0 / FAR..=FAR).contains(&(mean / nominal));
        is_far.then_some(Self::Value { quantity, nominal, mean })
    }

    /// What to write in place of the law, with which its message ends, if that is known.
    pub(crate) fn instead(&self) -> Option<&str> {
        match self {
            Self::Change { instead, .. } => instead.as_deref(),
            Self::Value { .. } | Self::Centre { .. } => None,
        }
    }

    /// The body in whose size it is told, if it is.
    pub(crate) fn size_of(&self) -> Option<&str> {
        match self {
            Self::Centre { body, .. } => Some(body),
            Self::Change { .. } | Self::Value { .. } => None,
        }
    }

    /// What it is, in a few words.
    pub(crate) fn title(&self) -> String {
        match self {
            Self::Change { .. } => "A law of a change may be meant of the value itself".to_owned(),
            Self::Value { .. } => "A law is far from the nominal value".to_owned(),
            Self::Centre { body, .. } => {
                format!("The mass centre of the {body} is far from the nominal one")
            }
        }
    }
}

impl Scenario {
    /// Laws whose means are far from the nominal values beside them.
    #[must_use]
    pub fn off_nominal(&self) -> Vec<OffNominal> {
        let all = self.dispersions().all();
        // Of what starts late in some runs the mean is that of those.
        let is_late = |of: Target| {
            all.iter().any(|d| match d.target {
                Target::Late(load, parameter) => Target::Load(load, parameter, 0) == of,
                Target::Body(..) | Target::Stack(..) | Target::Load(..) | Target::Fails(_) => false,
            })
        };
        let numbers = all.iter().filter(|d| !is_late(d.target));
        let bodies = self.bodies().map(|(which, body)| (which.name(), body));
        let axes = self.models().iter().find_map(|model| model.law.own_axes());
        OffNominal::all(numbers, &self.dispersions().joint, &bodies, axes)
    }
}

fn trace(entries: [f64; 6]) -> f64 {
    entries[..3].iter().sum()
}

/// Of the changes of the gyration lengths of a body, where these have laws.
fn of_lengths(name: &str, body: &UncertainBody) -> Vec<OffNominal> {
    let Some((quantity, laws)) = body.changes_of_lengths() else { return Vec::new() };
    let root_kg = body.moving().body().mass_kg().sqrt();
    let nominal = body.nominal().second_moments().roots().values();
    let all = (1..).zip(nominal).zip(laws);
    all.filter_map(|((axis, nominal), law)| {
        let of = [law.mean() - nominal, law.deviation()].map(|root| root / root_kg);
        let quantity = format!("{name}_{quantity}_{axis}_m");
        OffNominal::of_change(quantity, nominal / root_kg, of, || None)
    })
    .collect()
}

/// That the law of the mass centre of a body is far from the nominal one.
fn of_centre<T>(
    joint: &Joint<T>,
    place: usize,
    name: &str,
    body: &UncertainBody,
) -> Option<OffNominal> {
    let centre = joint.bodies.get(place)?.centre;
    let laws = centre.map(|quantity| Some((quantity.nominal, joint.all.get(quantity.place?)?)));
    let change_m = laws.map(|law| law.map_or(0.0, |(nominal, d)| d.law.mean() - nominal));
    let beyond = |(change, law): (&f64, &Option<(f64, &Dispersed<T>)>)| {
        law.is_some_and(|(_, d)| change.abs() > DEVIATIONS * d.law.deviation())
    };
    // What an uncertain axis adds may be chance, and is no part of the distance.
    let far_m = change_m.iter().zip(&laws).map(|axis| if beyond(axis) { *axis.0 } else { 0.0 });
    let distance_m = far_m.fold(0.0, f64::hypot);
    let size_m = (0.5 * trace(body.nominal().as_inertia_matrix().entries())
        / body.moving().body().mass_kg())
    .sqrt();
    let is_far = distance_m > SHARE * size_m;
    let is_of_change =
        body.given_law().is_none() || centre.iter().all(|centre| centre.nominal == 0.0);
    is_far.then(|| OffNominal::Centre { body: name.to_owned(), change_m, is_of_change })
}

/// In four digits, without zeros at the end.
fn short(x: f64) -> String {
    let told = significant(x, 4);
    told.parse::<f64>().map_or(told, |x| x.to_string())
}

impl fmt::Display for OffNominal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Change { quantity, nominal, change, instead } => {
                let [nominal, change, mean] = [*nominal, *change, nominal + change].map(short);
                write!(
                    f,
                    "the nominal value of {quantity} is {nominal}, and its law, which is of the change from that, has a mean of {change}, so \
                     that what is drawn has a mean of {mean}. If the value itself is meant, "
                )?;
                match instead {
                    Some(instead) => write!(f, "write {instead}"),
                    None => f.write_str(
                        "take the nominal value off the numbers of the law that say where it lies (mean, low, mode, high, samples; low of a \
                         Weibull law is 0 if it is not given), and not off its widths and shapes",
                    ),
                }
            }
            Self::Value { quantity, nominal, mean } => write!(
                f,
                "the nominal value of {quantity} is {}, and the mean of its law is {}. Whatever is nominal, and models about the nominal \
                 bodies, go by the former. Is there a digit or a unit too much in one of them?",
                short(*nominal),
                short(*mean)
            ),
            Self::Centre { body, change_m, is_of_change } => {
                let metres = change_m.map(short).join(", ");
                write!(
                    f,
                    "the mean of the law of the mass centre of the {body} is ({metres}) m away from the nominal one, along body axes. "
                )?;
                f.write_str(if *is_of_change {
                    "The law is told from the nominal one; a law that was made elsewhere may tell it from the origin of its own samples. \
                     Then take the nominal mass centre off its means."
                } else {
                    "Both are told from the same origin: is that so of the law, too?"
                })
            }
        }
    }
}
