//! The groups of inputs that are drawn independently of each other, and what of them a run draws.

use gyradius_campaign::{Designs, Mix, StreamRng, Streams};
use gyradius_dispersion::{InertiaLaw, ModelDraw};
use std::{collections::BTreeMap, sync::Arc};

use crate::{
    fleet::Fleet,
    scenario::{Each, Joint, Number},
    steering::Steering,
};

/// The groups of inputs of a model that are drawn independently of each other.
#[derive(Clone, Debug)]
pub(crate) struct Groups {
    names: Vec<String>,
    /// Of the principal moments and of the axes of each body; the same if they are not drawn independently.
    inertias: Vec<[usize; 2]>,
    /// Of each number that is dispersed; none of the roots of a body whose own law is not drawn.
    dispersed: Vec<Option<usize>>,
    /// Places of the dispersed numbers whose scores can be steered: of those that are not always the same, and not drawn
    /// again.
    scored: Vec<usize>,
    /// Which of these decide an event without others, by their numbers, and its probability.
    events: Vec<(usize, f64)>,
    /// What is drawn together until it is in its region.
    kept: Vec<Kept>,
}

/// What is drawn together until the matter of a body is in its region.
#[derive(Clone, Debug)]
pub(crate) struct Kept {
    /// The place of the body.
    pub(crate) body: usize,
    /// The places of the numbers that are drawn with it.
    pub(crate) numbers: Vec<usize>,
}

/// A body of a model: what it is called, and the law of its inertia.
#[derive(Debug)]
pub(crate) struct BodyLaw {
    pub(crate) name: String,
    pub(crate) law: Arc<dyn InertiaLaw>,
    streams: Streams,
    /// For what the inertia is drawn.
    pub(crate) each: Each,
    /// Whether it is the body's own, so that mass, mass centre and inertia are drawn from their joint law.
    pub(crate) own: bool,
}

impl BodyLaw {
    /// Of a body of this name under a model with this seed and name.
    pub(crate) fn new(
        (seed, model): (u64, &str),
        name: &str,
        law: Arc<dyn InertiaLaw>,
        each: Each,
        own: bool,
    ) -> Self {
        let streams = Streams::new(seed, model, &format!("{name} inertia"));
        Self { name: name.to_owned(), law, streams, each, own }
    }

    /// The stream of random numbers of this number.
    pub(crate) fn stream(&self, number: u64) -> StreamRng {
        self.streams.run(number)
    }
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
    /// Of bodies, and of what else is dispersed: the components of a parameter, and all that is correlated with them, are a
    /// group, and so is all that is drawn of a body with them until its matter is in its region.
    pub(crate) fn new<T>(bodies: &[BodyLaw], joint: &Joint<T>) -> Self {
        let numbers: Vec<Number<'_>> = joint.numbers().collect();
        let count = numbers.len();
        let kept = |body: usize| bodies[body].own && joint.bodies[body].region.is_some();
        let kept: Vec<usize> = (0..bodies.len()).filter(|body| kept(*body)).collect();
        let same = numbers.iter().enumerate().filter_map(|(i, number)| {
            let part_of = |other: &Number<'_>| other.part_of == number.part_of;
            Some((i, numbers[..i].iter().position(part_of)?))
        });
        // Bodies stand behind the numbers.
        let of_kept = kept.iter().flat_map(|body| {
            joint.bodies[*body].numbers().map(move |number| (number, count + body))
        });
        let sets = joint.sets(count + bodies.len(), same.chain(of_kept).collect::<Vec<_>>());
        let is_drawn = |i: usize| joint.root_of(i).is_none_or(|body| bodies[body].own);
        let members = |set: usize| (0..count).filter(|i| sets[*i] == set && is_drawn(*i)).collect();
        let kept: Vec<Kept> = kept
            .into_iter()
            .map(|body| Kept { body, numbers: members(sets[count + body]) })
            .collect();
        let again = |i: &usize| kept.iter().any(|kept| kept.numbers.contains(i));
        let wide = (0..count).filter(|i| numbers[*i].law.deviation() > 0.0 && is_drawn(*i));
        let scored: Vec<usize> = wide.filter(|i| !again(i)).collect();
        let alone = |i: usize| joint.correlation.related().all(|(a, b)| a != i && b != i);
        let events = scored.iter().enumerate().filter(|(_, i)| alone(**i));
        let events = events.filter_map(|(at, i)| Some((at, numbers[*i].law.as_bernoulli()?)));
        let events = events.collect();

        let mut names: Vec<String> = Vec::new();
        let mut of_sets: BTreeMap<usize, usize> = BTreeMap::new();
        let mut inertias: Vec<[usize; 2]> = Vec::new();
        for (place, body) in bodies.iter().enumerate() {
            let (first, name) = (names.len(), &body.name);
            let own = kept.iter().find(|kept| kept.body == place);
            if let Some(own) = own {
                let parts = own.numbers.iter().map(|i| numbers[*i].part_of);
                names.push(called([&*format!("{name} inertia")].into_iter().chain(parts)));
                of_sets.insert(sets[count + place], first);
            } else if body.own && joint.bodies[place].roots.is_some() {
                names.push(format!("{name} axes"));
            } else if body.law.has_independent_axes() {
                names.extend(["roots", "axes"].map(|part| format!("{name} {part}")));
            } else {
                names.push(format!("{name} inertia"));
            }
            inertias.push([first, names.len() - 1]);
        }
        let dispersed = (0..count).map(|i| {
            let group = || {
                let members: Vec<usize> = members(sets[i]);
                names.push(called(members.into_iter().map(|j| numbers[j].part_of)));
                names.len() - 1
            };
            is_drawn(i).then(|| *of_sets.entry(sets[i]).or_insert_with(group))
        });
        let dispersed = dispersed.collect();
        Self { names, inertias, dispersed, scored, events, kept }
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

    /// What is drawn together until it is in its region.
    pub(crate) fn kept(&self) -> &[Kept] {
        &self.kept
    }

    /// The names of the groups with scores that can be steered, and of the others.
    pub(crate) fn by_scores(&self) -> [Vec<String>; 2] {
        let scored =
            |group: usize| self.scored.iter().any(|i| self.dispersed.get(*i) == Some(&Some(group)));
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
        self.dispersed.get(place).copied().flatten().map_or(first, |group| mix.stream(group, first))
    }

    /// The stream of the inertia of the body in a place, if it is drawn together with its axes.
    pub(crate) fn inertia_stream(&self, body: usize, mix: Mix<'_>, first: u64) -> u64 {
        self.inertias.get(body).map_or(first, |[group, _]| mix.stream(*group, first))
    }

    /// The draw of the inertia of the body in a place.
    pub(crate) fn inertia(
        &self,
        body: usize,
        mix: Mix<'_>,
        first: u64,
        own: &BodyLaw,
    ) -> ModelDraw {
        let of = self.inertias.get(body).map(|groups| groups.map(|group| mix.stream(group, first)));
        let [moments, axes] = of.unwrap_or([first; 2]);
        let draw = |number| own.law.draw(&mut own.stream(number));
        if moments == axes { draw(moments) } else { draw(moments).about_axes_of(&draw(axes)) }
    }
}

/// What a group is called: after the parts in it.
fn called<'a>(members: impl Iterator<Item = &'a str>) -> String {
    let mut parts: Vec<&str> = Vec::new();
    for member in members {
        if !parts.contains(&member) {
            parts.push(member);
        }
    }
    let more = parts.len().saturating_sub(3);
    parts.truncate(3);
    let name = parts.join(", ");
    if more > 0 { format!("{name} and {more} more, correlated") } else { name }
}
