//! The tree of parts and assemblies.

use gyradius_inertia::{MassProperties, MassPropertiesError};
use rand::Rng;
use rand_distr::Distribution;
use std::collections::BTreeMap;

use super::first_order::FirstOrder;
use super::part::AssemblyPart;

/// A row of a list of parts.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct AssemblyRow {
    /// Its name, unlike all others.
    pub name: String,
    /// The assembly that it belongs to; none for the whole.
    pub parent: Option<String>,
    /// What is stated of a part; none for an assembly, whose numbers come from its parts.
    pub part: Option<AssemblyPart>,
}

/// A whole made of parts, some of which may be put together in assemblies before.
///
/// Nothing of it depends on the order of the rows: parts are summed in the order of their names.
#[derive(Clone, Debug, PartialEq)]
pub struct Assembly {
    /// The last is the whole, and every other stands before the one that it belongs to.
    nodes: Vec<Node>,
    /// Places of the parts, in the order of their names.
    parts: Vec<usize>,
}

#[derive(Clone, Debug, PartialEq)]
struct Node {
    row: AssemblyRow,
    /// Places of what it is made of, in the order of names.
    children: Vec<usize>,
    depth: usize,
    first_order: FirstOrder,
}

impl Assembly {
    /// Puts rows together.
    ///
    /// # Errors
    /// The rows are no tree: none, two of one name, a parent that is no row, several wholes, or rows that belong to
    /// themselves. An assembly has numbers of its own, or nothing to have them from. A sum overflows.
    pub fn new(rows: impl IntoIterator<Item = AssemblyRow>) -> Result<Self, AssemblyError> {
        let mut by_name = BTreeMap::new();
        for row in rows {
            if row.name.is_empty() {
                return Err(AssemblyError::NoName);
            }
            if let Some(first) = by_name.insert(row.name.clone(), row) {
                return Err(AssemblyError::Twice { name: first.name });
            }
        }
        let children = children(&by_name)?;
        let root = root(&by_name)?;
        let mut nodes: Vec<Node> = Vec::with_capacity(by_name.len());
        let mut places: BTreeMap<String, usize> = BTreeMap::new();
        // Down from the whole, and back up: each after what it is made of. Without recursion, for trees may be deep.
        let mut down = vec![(root, 0)];
        let mut order = Vec::new();
        while let Some((name, depth)) = down.pop() {
            down.extend(children.get(&name).into_iter().flatten().map(|c| (c.clone(), depth + 1)));
            order.push((name, depth));
        }
        for (name, depth) in order.into_iter().rev() {
            let inside = children.get(&name).map_or(&[][..], Vec::as_slice);
            let inside: Vec<usize> = inside.iter().filter_map(|c| places.get(c).copied()).collect();
            let Some(row) = by_name.remove(&name) else { continue };
            let first_order = match &row.part {
                Some(part) => part.first_order().clone(),
                None if inside.is_empty() => return Err(AssemblyError::Nothing { name }),
                None => FirstOrder::combined(inside.iter().map(|i| &nodes[*i].first_order))
                    .map_err(|error| AssemblyError::Sum { name: name.clone(), error })?,
            };
            places.insert(name, nodes.len());
            nodes.push(Node { row, children: inside, depth, first_order });
        }
        // What the whole does not lead to belongs to a circle.
        if !by_name.is_empty() {
            return Err(AssemblyError::Circle { names: circle(&by_name) });
        }
        let parts = places.into_values().filter(|i| nodes[*i].row.part.is_some()).collect();
        Ok(Self { nodes, parts })
    }

    /// Name of the whole.
    #[must_use]
    pub fn name(&self) -> &str {
        self.nodes.last().map_or("", |node| &node.row.name)
    }

    /// The parts with their names, in the order of the names.
    pub fn parts(&self) -> impl ExactSizeIterator<Item = (&str, &AssemblyPart)> {
        // Every place in the list is a part's.
        let pairs: Vec<(&str, &AssemblyPart)> = self
            .parts
            .iter()
            .filter_map(|i| {
                Some((self.nodes[*i].row.name.as_str(), self.nodes[*i].row.part.as_ref()?))
            })
            .collect();
        pairs.into_iter()
    }

    /// The whole to first order.
    #[must_use]
    pub fn first_order(&self) -> &FirstOrder {
        // There is a whole in every tree.
        &self.nodes[self.nodes.len() - 1].first_order
    }

    /// The share of each part in the variances of the ten of the whole, to first order, in the order of the names.
    ///
    /// Parts are independent of each other, so that the shares of a number sum to 1. A number that does not vary has none.
    ///
    /// ```
    /// use gyradius_estimation::{Assembly, AssemblyPart, AssemblyRow, PartStatement};
    /// use gyradius_inertia::InertiaMatrix;
    /// use nalgebra::{Matrix3, UnitQuaternion};
    ///
    /// let part = |name: &str, mass_kg: f64, sigma_kg: f64| {
    ///     let mut deviations = [0.0; 10];
    ///     deviations[0] = sigma_kg;
    ///     let part = AssemblyPart::new(PartStatement {
    ///         mass_kg,
    ///         mass_centre_m: [0.0; 3],
    ///         inertia: InertiaMatrix::new(Matrix3::identity())?,
    ///         attitude: UnitQuaternion::identity(),
    ///         deviations,
    ///         inertia_follows_mass: false,
    ///     })?;
    ///     Ok::<_, Box<dyn std::error::Error>>(AssemblyRow { name: name.into(), parent: Some("bus".into()), part: Some(part) })
    /// };
    /// let bus = AssemblyRow { name: "bus".into(), parent: None, part: None };
    /// let whole = Assembly::new([bus, part("battery", 30.0, 0.3)?, part("tank", 50.0, 0.4)?])?;
    /// let mass: Vec<_> = whole.variance_shares().map(|(name, shares)| (name, shares[0])).collect();
    /// // σ² = 0.09 kg² + 0.16 kg².
    /// assert!((mass[0].1.unwrap_or_default() - 0.36).abs() < 1e-12);
    /// assert!((mass[1].1.unwrap_or_default() - 0.64).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn variance_shares(&self) -> impl ExactSizeIterator<Item = (&str, [Option<f64>; 10])> {
        let whole = self.first_order().nominal();
        let added = self.parts().map(|(name, part)| (name, part.first_order().variances_in(whole)));
        let added: Vec<(&str, [f64; 10])> = added.collect();
        // Of what was added, for the sum over levels may differ in the last digits.
        let sums: [f64; 10] =
            std::array::from_fn(|i| added.iter().map(|(_, variances)| variances[i]).sum());
        added.into_iter().map(move |(name, variances)| {
            let share = |i: usize| Some(variances[i] / sums[i]).filter(|share| share.is_finite());
            (name, std::array::from_fn(share))
        })
    }

    /// Everything in the tree from the whole down: depth, name, whether it is a part, and its ten to first order.
    pub fn rows(&self) -> impl Iterator<Item = (usize, &str, bool, &FirstOrder)> {
        let mut down = vec![self.nodes.len() - 1];
        std::iter::from_fn(move || {
            let node = &self.nodes[down.pop()?];
            down.extend(node.children.iter().rev());
            Some((node.depth, node.row.name.as_str(), node.row.part.is_some(), &node.first_order))
        })
    }

    /// Parts that were drawn, in the order of [`parts`](Self::parts), as one: exactly, not to first order.
    ///
    /// # Errors
    /// There is none, or a sum overflows.
    pub fn whole(drawn: &[MassProperties]) -> Result<MassProperties, MassPropertiesError> {
        MassProperties::combined(drawn)
    }

    /// A draw of the whole, with a generator for each part by its name: what a part draws depends on its own alone.
    ///
    /// # Errors
    /// A sum overflows.
    pub fn draw<R: Rng>(
        &self,
        mut generator: impl FnMut(&str) -> R,
    ) -> Result<MassProperties, MassPropertiesError> {
        let drawn: Vec<MassProperties> =
            self.parts().map(|(name, part)| part.sample(&mut generator(name))).collect();
        Self::whole(&drawn)
    }
}

gyradius_dispersion::written!(
    Assembly,
    |whole| { rows: Vec<AssemblyRow> = whole.nodes.iter().map(|node| node.row.clone()).collect(), },
    Assembly::new(rows)?
);

/// The names of what each assembly is made of.
fn children(
    rows: &BTreeMap<String, AssemblyRow>,
) -> Result<BTreeMap<String, Vec<String>>, AssemblyError> {
    let mut children: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for row in rows.values() {
        let Some(parent) = &row.parent else { continue };
        let (name, parent) = (row.name.clone(), parent.clone());
        match rows.get(&parent) {
            None => return Err(AssemblyError::Parent { name, parent }),
            Some(AssemblyRow { part: Some(_), .. }) => {
                return Err(AssemblyError::PartWithChildren { name: parent, child: name });
            }
            Some(_) => children.entry(parent).or_default().push(name),
        }
    }
    Ok(children)
}

/// The names in a circle of rows that all belong to another of them, from the first of these names on: each belongs to
/// the next, and the last to the first.
fn circle(rows: &BTreeMap<String, AssemblyRow>) -> Vec<String> {
    let up = |name: &str| rows.get(name).and_then(|row| row.parent.as_deref());
    let from = |name| std::iter::successors(Some(name), |name: &&str| up(name));
    // As many steps up as there are rows end in the circle.
    let inside = rows.keys().next().and_then(|first| from(first.as_str()).nth(rows.len()));
    let Some(inside) = inside else { return Vec::new() };
    let around: Vec<&str> =
        std::iter::once(inside).chain(from(inside).skip(1).take_while(|n| *n != inside)).collect();
    let first = (0..around.len()).min_by_key(|i| around[*i]).unwrap_or_default();
    around[first..].iter().chain(&around[..first]).map(|name| (*name).to_owned()).collect()
}

/// The name of the one row that belongs to no other.
fn root(rows: &BTreeMap<String, AssemblyRow>) -> Result<String, AssemblyError> {
    let roots: Vec<&String> =
        rows.values().filter(|row| row.parent.is_none()).map(|row| &row.name).collect();
    match roots.as_slice() {
        [root] => Ok((*root).clone()),
        [] if rows.is_empty() => Err(AssemblyError::Empty),
        [] => Err(AssemblyError::Circle { names: circle(rows) }),
        roots => Err(AssemblyError::Wholes { names: roots.iter().map(|s| (*s).clone()).collect() }),
    }
}

/// Why rows are no whole.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AssemblyError {
    /// No rows.
    #[error("there are no parts: there must be at least one")]
    Empty,
    /// A row without a name.
    #[error("a row has no name: every part and every assembly must have one")]
    NoName,
    /// Two rows of one name.
    #[error("name {name:?} stands twice: every name must stand once")]
    Twice {
        /// The name.
        name: String,
    },
    /// A row that belongs to one that does not exist.
    #[error("{name:?} belongs to {parent:?}, which is no row: there must be a row of this name")]
    Parent {
        /// The row.
        name: String,
        /// What it belongs to.
        parent: String,
    },
    /// An assembly that has numbers of its own.
    #[error(
        "{name:?} has numbers of its own and {child:?} belongs to it: an assembly must have none, \
         because its numbers come from its parts. What it has beside them must be a part with a \
         name of its own"
    )]
    PartWithChildren {
        /// The assembly.
        name: String,
        /// One of those that belong to it.
        child: String,
    },
    /// A row with neither numbers nor parts.
    #[error(
        "{name:?} has neither numbers nor parts: it must have numbers, or be left out, or be the parent of other rows, which a column \"parent\" or \
         a table of edges must say, whatever their order, numbers and levels"
    )]
    Nothing {
        /// The row.
        name: String,
    },
    /// Several rows that belong to nothing.
    #[error(
        "{} rows belong to nothing, {}: one must be the whole, and all others belong to it or to \
         its assemblies",
        .names.len(), some(names)
    )]
    Wholes {
        /// Their names.
        names: Vec<String>,
    },
    /// Rows that belong to each other in a circle, or one that belongs to itself.
    #[error("{}: no row may belong to itself, at once or by way of others", around(names))]
    Circle {
        /// Those in the circle, from the first name on: each belongs to the next, and the last to the first.
        names: Vec<String>,
    },
    /// A sum leaves the range of floats.
    #[error("the sum of {name:?}: {error}")]
    Sum {
        /// The assembly.
        name: String,
        /// Why.
        error: MassPropertiesError,
    },
}

impl AssemblyError {
    /// The name of the row that is wrong, if it is one.
    #[must_use]
    pub fn row(&self) -> Option<&str> {
        match self {
            Self::Twice { name }
            | Self::Parent { name, .. }
            | Self::PartWithChildren { name, .. }
            | Self::Nothing { name }
            | Self::Sum { name, .. } => Some(name),
            Self::Circle { names } => names.first().map(String::as_str),
            Self::Wholes { names } => names.get(1).map(String::as_str),
            Self::Empty | Self::NoName => None,
        }
    }
}

/// The first few of some names.
fn some(names: &[String]) -> String {
    let mut text = names.iter().take(5).map(|n| format!("{n:?}")).collect::<Vec<_>>().join(", ");
    if names.len() > 5 {
        text.push_str(", …");
    }
    text
}

/// What belongs to what in a circle of these names.
fn around(names: &[String]) -> String {
    let mut text: Vec<String> = names.iter().take(5).map(|n| format!("{n:?}")).collect();
    if names.len() > 5 {
        text.push("…".to_owned());
    }
    text.extend(names.first().map(|first| format!("{first:?}")));
    text.join(" belongs to ")
}
