//! Products below the diagonal of the tensor, which say again what those above it do.

use super::error::PartsProblem;
use super::heading::{Column, Heading, VALUES};
use super::row::Cells;
use crate::{
    body::{LOWER, Number, shortened},
    rows::is_blank,
};

/// How far two of them may be from each other, of the larger one: units are converted.
const ROUNDED: f64 = 1e-9;

impl Cells<'_> {
    /// That those of a row are those above the diagonal, as the columns say them.
    pub(super) fn agrees_below(&self, above: [f64; 3]) -> Result<(), PartsProblem> {
        for ((column, heading), cell) in self.columns.with(self.cells) {
            let Heading::Column(Column::Below(product, unit)) = *column else { continue };
            if is_blank(cell) {
                continue;
            }
            let (field, above) = (VALUES[7 + product], above[product]);
            let below = Number::parse(LOWER[product][0], cell, None)?.value * unit.unwrap_or(1.0);
            if (below - above).abs() > ROUNDED * below.abs().max(above.abs()) {
                let first = format!("{} = {}", shortened(heading), shortened(cell));
                let second = format!("{field} = {above:?} kg·m²");
                return Err(PartsProblem::Contradiction { first, second });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::read;
    use proptest::prelude::*;

    proptest! {
        /// The half below the diagonal says the same as the one above it, in any unit, or the row is refused.
        #[test]
        fn both_halves_are_one_tensor(
            products in prop::array::uniform3(prop_oneof![Just(0.0), -0.5..0.5_f64]),
            (at, by) in (0_usize..3, prop_oneof![Just(0.0), Just(-2.0), -0.4..0.4_f64]),
            order in Just([0_usize, 1, 2]).prop_shuffle(),
            (names, si) in prop::sample::select(vec![
                (["Iyx", "Izx", "Izy"], 1.0), (["I21", "I_31", "i32"], 1.0), (["Iyx [kg m2]", "Izx [kg m2]", "Izy [kg m2]"], 1.0),
                (["Iyx [g m2]", "Izx [g m2]", "Izy [g m2]"], 1e-3),
            ]),
            is_blank: bool,
        ) {
            let mut below = products;
            below[at] += if by == -2.0 { -2.0 * below[at] } else { by };
            let cells = order.map(|i| if is_blank { String::new() } else { (below[i] / si).to_string() });
            let [xy, xz, yz] = products;
            let unit = " [kg m2]";
            let text = format!(
                "name,mass [kg],Cx [m],Cy [m],Cz [m],Ixx{unit},Iyy{unit},Izz{unit},Ixy{unit},Ixz{unit},Iyz{unit},products,{}\n\
                 a,1,0,0,0,5,5,5,{xy},{xz},{yz},tensor,{}\n",
                order.map(|i| names[i]).join(","), cells.join(","),
            );
            let is_same = is_blank || below == products;
            let found = read(&text);
            prop_assert_eq!(found.is_ok(), is_same, "{}{:?}", text, found);
            match found {
                Ok(table) => {
                    prop_assert!(table.passed_over().is_empty());
                    let entries = table.rows()[0].numbers().map(|numbers| numbers.inertia().entries());
                    prop_assert_eq!(&entries.unwrap()[3..], &products);
                }
                Err(error) => prop_assert!(error.to_string().contains("contradict each other"), "{}", error),
            }
        }
    }
}
