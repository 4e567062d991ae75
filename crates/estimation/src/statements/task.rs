//! What is asked of the scatter of a body, and how far a scatter is from it.

use nalgebra::Matrix3;

use super::{
    entries::Forms,
    scatter::{Body, Scatter},
};

/// Of relative errors of deviations, stated moments count this much more beside products: what is
/// stated of the products may not make the moments more certain than they are stated.
const MOMENTS_FIRST: f64 = 100.0;
/// An entry that is surer than stated is this much worse than one that is less sure.
const SURER: f64 = 3.0;
/// What a product falls short that nothing can make so large counts this much.
const BEYOND_REACH: f64 = 0.02;
/// What a mass centre adds counts this much less beside what is stated.
const ADDED_LAST: f64 = 1.0 / 30.0;
/// Deviations below this share of the largest beside them count as this share.
const SMALL: f64 = 3e-4;
/// The same of what a mass centre adds, where the smaller ones are without interest.
const SMALL_BESIDE: f64 = 0.3;
/// A moment that is stated not to scatter: deviations below this share of the largest stated moment hardly count. No Gaussian roots
/// hold one moment wholly while another scatters, for second moments are their squares, and logarithms of what is left beside zero
/// would outweigh the other moments.
const STILL: f64 = 0.1;
/// A deviation of zero counts as this share of the trace.
const ZERO: f64 = 1e-9;

/// What is asked of a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task {
    pub(super) body: Body,
    pub(super) trace: f64,
    pub(super) moments: Asked,
    pub(super) products: Asked,
    /// Variances of the rotations about the principal axes, rad²: as they are, or, beside products, at most.
    pub(super) axes: Option<[f64; 3]>,
    /// The relative deviation of the mass, and the largest share of it that the inertia may take.
    pub(super) mass: Option<(f64, f64)>,
    /// Rotations that do nothing are any, not none.
    pub(super) loose: bool,
}

/// What is asked of three entries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Asked {
    /// Nothing: they move as the rest moves them.
    Nothing,
    /// They have these deviations, kg·m², everything included.
    Stated([f64; 3]),
    /// Beside everything else, these variances come on top, (kg·m²)².
    Added([f64; 3]),
}

/// A scatter, what its axes do to the entries, and the share of the mass that the inertia follows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub(super) scatter: Scatter,
    pub(super) forms: Forms,
    pub(super) follows: f64,
}

/// The best scatter that was found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solution {
    pub(super) scatter: Scatter,
    /// The share of the mass's relative change that the inertia takes.
    pub(super) follows: f64,
    /// The deviations that a mass centre would give entries beside everything else, kg·m².
    pub(super) with_centre: [Option<f64>; 6],
}

/// What is asked of an entry, and what it has: variances, (kg·m²)².
#[derive(Clone, Copy, Debug)]
pub(super) struct Compared {
    pub(super) entry: usize,
    pub(super) wanted: f64,
    pub(super) found: f64,
    /// The variance below which none matters.
    least: f64,
    /// How much an error counts.
    pub(super) counts: f64,
}

impl Compared {
    /// The relative error of the deviation, where it is small. In logarithms, so that errors of entries that cannot be
    /// had do not outweigh all others.
    fn error(&self) -> f64 {
        0.5 * libm::log((self.found + self.least) / (self.wanted + self.least))
    }

    /// What that costs where all that is asked may be had: the farther from it, the more.
    pub(super) fn even_cost(&self) -> f64 {
        let error = self.error();
        if error < 0.0 { SURER * error } else { error }
    }

    /// What that costs beside other errors, with how far each product can be moved. What it falls short beyond that hardly counts: it would make the
    /// others many times what is stated of them.
    pub(super) fn cost(&self, reach: &[f64; 3]) -> f64 {
        let cost = self.even_cost();
        let Some(reach) = self.entry.checked_sub(3).and_then(|product| reach.get(product)) else {
            return cost;
        };
        let had = (reach * reach).max(self.found);
        if cost >= 0.0 || had >= self.wanted {
            return cost;
        }
        let beyond = SURER * Self { found: had, ..*self }.error();
        cost + (BEYOND_REACH - 1.0) * beyond
    }
}

impl Task {
    pub(super) fn first_variance(&self) -> f64 {
        match self.moments {
            Asked::Nothing => 0.0,
            Asked::Stated(_) | Asked::Added(_) => {
                0.5 * self.moments.mean_variance().max(self.zero())
            }
        }
    }

    pub(super) fn zero(&self) -> f64 {
        (ZERO * self.trace).powi(2)
    }

    /// What the axes do to the entries. Where none is asked for a product, axes that nothing moves do nothing.
    pub(super) fn forms(&self, scatter: &Scatter) -> Forms {
        if self.products == Asked::Nothing && scatter.rotations.amax() == 0.0 {
            Forms::still(&self.body.attitude)
        } else {
            self.body.forms(scatter)
        }
    }

    /// What is asked of each entry at a point, and what it has there.
    pub(super) fn compare(&self, at: &Point) -> Vec<Compared> {
        let k = self.body.second_moments(&at.scatter);
        let (means, found) = (at.forms.means(&k), at.forms.variances(&k));
        let held = self.body.held_variances(&k);
        let still = Scatter { roots: Matrix3::zeros(), ..at.scatter };
        // Axes and roots that scatter for nothing but the mass centre are what it adds, and no ground to add it on.
        let by_axes = match (self.axes, self.products) {
            (None, Asked::Added(_)) => [0.0; 6],
            (None, Asked::Nothing | Asked::Stated(_)) | (Some(_), _) => {
                at.forms.variances(&self.body.second_moments(&still))
            }
        };
        let by_roots = match self.moments {
            Asked::Added(_) => [0.0; 6],
            Asked::Nothing | Asked::Stated(_) => Forms::still(&self.body.attitude).variances(&k),
        };
        let relative =
            self.mass.map_or([0.0; 2], |(relative, most)| [at.follows, most].map(|x| relative * x));
        let [by_mass, most_by_mass] = relative.map(|x| x * x);
        // Wherever the search goes: only products open the turns.
        let axes_are_as_stated = self.axes.is_some() && self.products == Asked::Nothing;
        let both = self.moments.is_stated() && self.products.is_stated();
        let any = self.moments.is_stated() || self.products.is_stated();
        let mut compared = Vec::new();
        for (first_entry, asked, rest) in [(0, self.moments, by_axes), (3, self.products, by_roots)]
        {
            let least = self.least(asked);
            let still = asked.variances().into_iter().fold(least, f64::max) * (STILL * STILL);
            let with = |by_mass: f64, e: usize, v: f64| {
                v * (1.0 + by_mass) + by_mass * means[e] * means[e]
            };
            let with_mass = |e: usize, v: f64| with(by_mass, e, v);
            for e in first_entry..first_entry + 3 {
                let (wanted, found, counts) = match asked {
                    Asked::Nothing => continue,
                    Asked::Stated(deviations) => {
                        let first = if both && e < 3 { MOMENTS_FIRST } else { 1.0 };
                        let stated = deviations[e - first_entry].powi(2);
                        // Axes are stated, too: where they alone are more, there is no less, and the inertia follows the
                        // mass no less for it.
                        if e < 3 && axes_are_as_stated && by_axes[e] > stated {
                            let given = with(most_by_mass, e, (found[e] - by_roots[e]).max(0.0));
                            let wanted = if stated > 0.0 { given } else { stated };
                            (wanted, with(most_by_mass, e, found[e]), first)
                        } else {
                            (stated, with_mass(e, found[e]), first)
                        }
                    }
                    Asked::Added(variances) => {
                        let last = if any { ADDED_LAST } else { 1.0 };
                        let wanted = with_mass(e, rest[e] + variances[e - first_entry]);
                        (wanted, with_mass(e, found[e]), last)
                    }
                };
                // Nor may roots that are open for the mass centre alone scatter for the products.
                let is_beyond = e < 3 && !asked.is_stated() && found > wanted;
                let counts =
                    if is_beyond && self.products.is_stated() { MOMENTS_FIRST } else { counts };
                let is_still = e < 3 && wanted == 0.0 && asked.is_stated();
                let (wanted, least) = if is_still {
                    (wanted, still.max(least))
                } else {
                    // No law has less than axes that are held.
                    (wanted.max(held[e] * (1.0 + by_mass)), least)
                };
                compared.push(Compared { entry: e, wanted, found, least, counts });
            }
        }
        compared
    }

    /// The variance below which none of three entries matters. What a mass centre adds to moments is of second order where it adds products,
    /// and the turns of the axes for these move the moments by more: all six that it adds to are of one size.
    pub(super) fn least(&self, asked: Asked) -> f64 {
        let share = if asked.is_added() { SMALL_BESIDE } else { SMALL };
        let is_beside = |of: &Asked| *of == asked || (of.is_added() && asked.is_added());
        let beside = [self.moments, self.products].into_iter().filter(is_beside);
        let variances = beside.flat_map(|of| of.variances());
        (variances.fold(0.0, f64::max) * (share * share)).max(self.zero())
    }

    /// The largest error.
    pub(super) fn worst(&self, at: &Point) -> f64 {
        self.compare(at).iter().fold(0.0, |worst, it| it.error().abs().max(worst))
    }
}

impl Asked {
    pub(super) fn is_stated(&self) -> bool {
        matches!(self, Self::Stated(_))
    }

    fn is_added(&self) -> bool {
        matches!(self, Self::Added(_))
    }

    pub(super) fn variances(&self) -> [f64; 3] {
        match *self {
            Self::Nothing => [0.0; 3],
            Self::Stated(deviations) => deviations.map(|d| d * d),
            Self::Added(variances) => variances,
        }
    }

    pub(super) fn mean_variance(&self) -> f64 {
        self.variances().iter().sum::<f64>() / 3.0
    }
}

#[cfg(test)]
mod tests {
    use crate::{
        AxesStatement, CentreStatement, ProductsStatement, Statements, statements::tests::by_axes,
    };
    use gyradius_inertia::{Inertia, SecondMoments};
    use nalgebra::{UnitQuaternion, Vector3};
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        /// A mass centre that is nearly known adds what it adds, also where the axes do not let the products be what is stated.
        #[test]
        fn a_small_uncertainty_of_the_centre_adds_little(
            k in prop::array::uniform3(1.0..100.0_f64),
            turn in prop::array::uniform3(-3.0..3.0_f64),
            products in prop::array::uniform3(0.0..50.0_f64),
            degrees in prop::array::uniform3(0.05..2.0_f64),
            centre in 1e-5..3e-3_f64,
        ) {
            let q = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
            let nominal = Inertia::from_second_moments(SecondMoments::new(k).unwrap(), &q).unwrap();
            let centre = CentreStatement::new([centre; 3], 1.0, [1.0, 0.0, 0.0]).unwrap();
            let with = Statements {
                products: Some(ProductsStatement::new(products, 1.0).unwrap()),
                axes: Some(AxesStatement::each(degrees, 1.0).unwrap()),
                centre: Some(centre),
                ..Statements::default()
            };
            let model = with.model(&nominal, Some(50.0)).unwrap();
            for (found, most) in model.turns().iter().zip(degrees) {
                prop_assert!(*found <= most.to_radians() * (1.0 + 1e-6), "{found} {most}");
            }
            // Moments move as the axes move them, and as the centre adds.
            let axes = by_axes(&model);
            for e in 0..3 {
                let found = model.implied().deviations()[e];
                let (axes, added) = (axes[e], centre.entry_variances(50.0)[e].sqrt());
                let most = 1.1 * axes + 3.0 * added + 1e-4 * nominal.matrix().trace();
                prop_assert!(found < most, "{e}: {found} {axes} {added}");
            }
        }

        /// A mass centre that is off across the arm adds a product, and to the moments next to nothing: the product comes out.
        #[test]
        fn a_centre_across_the_arm_adds_its_product(
            k in prop::array::uniform3(1.0..10.0_f64),
            axes in prop::sample::select(vec![[0, 1], [1, 0], [0, 2], [2, 0], [1, 2], [2, 1]]),
            arm in 0.3..3.0_f64,
            turn in 0.003..0.1_f64,
        ) {
            let [a, b] = axes;
            // So far off that the axes turn by so much.
            let gap = (k[a] - k[b]).abs();
            prop_assume!(gap > 0.3);
            let mass = 10.0;
            let off = turn * gap / (mass * arm);
            let nominal = Inertia::from_second_moments(
                SecondMoments::new(k).unwrap(),
                &UnitQuaternion::identity(),
            ).unwrap();
            let along = |axis: usize, x: f64| std::array::from_fn(|i| if i == axis { x } else { 0.0 });
            let centre = CentreStatement::new(along(a, off), 1.0, along(b, arm)).unwrap();
            let model = Statements { centre: Some(centre), ..Statements::default() };
            let model = model.model(&nominal, Some(mass)).unwrap();
            let product = 2 + a + b;
            let (found, wanted) = (model.implied().deviations()[product], mass * arm * off);
            prop_assert!((found / wanted - 1.0).abs() < 0.03, "{found} {wanted}");
        }
    }
}
