//! The groups of inputs that are drawn independently of each other, and what of them a run draws.

use gyradius_campaign::{Designs, Mix, Streams};
use gyradius_dispersion::{InertiaLaw, ModelDraw};
use std::sync::Arc;

use crate::{
    fleet::Fleet,
    scenario::{Dispersed, Joint},
    steering::Steering,
};

/// The groups of inputs of a model that are drawn independently of each other.
#[derive(Clone, Debug)]
pub(crate) struct Groups {
    names: Vec<String>,
    /// Of the principal moments and of the axes of each body; the same if they are not drawn independently.
    inertias: Vec<[usize; 2]>,
    /// Of each number that is dispersed.
    dispersed: Vec<usize>,
    /// Places of the dispersed numbers whose scores can be steered: of those that are not always the same.
    scored: Vec<usize>,
    /// Which of these decide an event without others, by their numbers, and its probability.
    events: Vec<(usize, f64)>,
}

/// What the runs of a simulation draw.
#[derive(Clone, Debug, Default)]
pub(crate) enum Drawing {
    /// What the runs of a study draw.
    #[default]
    Plain,
    /// The designs that exchange groups of inputs.
    Exchanging,
    /// For each run and each group the draw of this number.
    Given(Arc<[Vec<u64>]>),
    /// What plain runs draw, but for scores from another law.
    Steered(Arc<Steering>),
}

impl Drawing {
    /// The law that scores are drawn from, if it is not their own.
    pub(crate) fn steering(&self) -> Option<&Steering> {
        match self {
            Self::Steered(steering) => Some(steering),
            Self::Plain | Self::Exchanging | Self::Given(_) => None,
        }
    }
}

impl Groups {
    /// Of bodies with names and laws, and of what else is dispersed: the components of a parameter, and all that is
    /// correlated with them, are a group.
    pub(crate) fn new<'a, T>(
        bodies: impl IntoIterator<Item = (&'a str, &'a dyn InertiaLaw)>,
        joint: &Joint<T>,
    ) -> Self {
        let wide = joint.all.iter().enumerate().filter(|(_, d)| d.law.deviation() > 0.0);
        let scored: Vec<usize> = wide.map(|(place, _)| place).collect();
        let alone =
            |place: usize| joint.correlation.related().all(|(a, b)| a != place && b != place);
        let events = scored.iter().enumerate().filter(|(_, place)| alone(**place));
        let events =
            events.filter_map(|(i, place)| Some((i, joint.all[*place].law.as_bernoulli()?)));
        let events = events.collect();
        let (names, inertias, dispersed) = (Vec::new(), Vec::new(), Vec::new());
        let mut groups = Self { names, inertias, dispersed, scored, events };
        for (body, law) in bodies {
            let first = groups.names.len();
            if law.has_independent_axes() {
                groups.names.extend(["roots", "axes"].map(|part| format!("{body} {part}")));
            } else {
                groups.names.push(format!("{body} inertia"));
            }
            groups.inertias.push([first, groups.names.len() - 1]);
        }
        // The first of those that hang together stands for all.
        let mut leader: Vec<usize> = (0..joint.all.len()).collect();
        let same = joint.all.iter().enumerate().filter_map(|(i, d)| {
            Some((i, joint.all[..i].iter().position(|other| other.part_of == d.part_of)?))
        });
        for (a, b) in same.chain(joint.correlation.related()).collect::<Vec<_>>() {
            let (a, b) = (leader[a], leader[b]);
            leader.iter_mut().filter(|of| **of == a.max(b)).for_each(|of| *of = a.min(b));
        }
        let mut places: Vec<Option<usize>> = vec![None; leader.len()];
        for (i, &of) in leader.iter().enumerate() {
            let place = *places[of].get_or_insert_with(|| {
                let members = (i..leader.len()).filter(|j| leader[*j] == of);
                groups.names.push(name(members.map(|j| &joint.all[j])));
                groups.names.len() - 1
            });
            groups.dispersed.push(place);
        }
        groups
    }

    /// With one more.
    pub(crate) fn and(mut self, name: &str) -> Self {
        self.names.push(name.to_owned());
        self
    }

    /// What they are called.
    pub(crate) fn names(&self) -> &[String] {
        &self.names
    }

    /// The places, among all numbers that are dispersed, of those whose scores can be steered.
    pub(crate) fn scored(&self) -> &[usize] {
        &self.scored
    }

    /// Which of these decide an event without others, by their numbers, and its probability.
    pub(crate) fn events(&self) -> &[(usize, f64)] {
        &self.events
    }

    /// The names of the groups with scores that can be steered, and of the others.
    pub(crate) fn by_scores(&self) -> [Vec<String>; 2] {
        let scored =
            |group: usize| self.scored.iter().any(|i| self.dispersed.get(*i) == Some(&group));
        [true, false].map(|wanted| {
            let names = self.names.iter().enumerate();
            names.filter(|(i, _)| scored(*i) == wanted).map(|(_, name)| name.clone()).collect()
        })
    }

    /// The runs in which they are exchanged.
    pub(crate) fn designs(&self) -> Designs {
        Designs::new(self.names.len())
    }

    /// Which draws a run takes; where groups are exchanged, each base run is the first flight of a vehicle of its own.
    pub(crate) fn mix<'d>(&self, drawing: &'d Drawing, run: u64, fleet: Option<Fleet>) -> Mix<'d> {
        let flights = fleet.map_or(1, Fleet::flights);
        match drawing {
            Drawing::Plain => Mix::plain(run),
            Drawing::Exchanging => {
                let mix = self.designs().of(run);
                mix.at(mix.base().saturating_mul(flights))
            }
            Drawing::Steered(steering) => {
                Mix::plain(steering.first().saturating_add(run).saturating_mul(flights))
            }
            Drawing::Given(draws) => {
                let of_run = usize::try_from(run).ok().and_then(|run| draws.get(run));
                Mix::given(run.saturating_mul(flights), of_run.map_or(&[], Vec::as_slice))
            }
        }
    }

    /// The stream of the number in a place of what is dispersed.
    pub(crate) fn stream_of(&self, place: usize, mix: Mix<'_>, first: u64) -> u64 {
        self.dispersed.get(place).map_or(first, |group| mix.stream(*group, first))
    }

    /// The draw of the inertia of the body in a place.
    pub(crate) fn inertia(
        &self,
        body: usize,
        mix: Mix<'_>,
        first: u64,
        (law, streams): (&dyn InertiaLaw, &Streams),
    ) -> ModelDraw {
        let of = self.inertias.get(body).map(|groups| groups.map(|group| mix.stream(group, first)));
        let [moments, axes] = of.unwrap_or([first; 2]);
        let draw = law.draw(&mut streams.run(moments));
        if moments == axes { draw } else { draw.about_axes_of(&law.draw(&mut streams.run(axes))) }
    }
}

/// What a group is called: after the parameters in it.
fn name<'a, T: 'a>(members: impl Iterator<Item = &'a Dispersed<T>>) -> String {
    let mut parts: Vec<String> = Vec::new();
    for member in members {
        let part = member.part_of.replace('_', " ");
        if !parts.contains(&part) {
            parts.push(part);
        }
    }
    let more = parts.len().saturating_sub(3);
    parts.truncate(3);
    let name = parts.join(", ");
    if more > 0 { format!("{name} and {more} more, correlated") } else { name }
}
