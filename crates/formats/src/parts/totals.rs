//! Rows of a list of parts that sum up others: counted as parts, they would be counted twice.

use gyradius_statistics::{SummaryNames, least_summed};

use super::row::{PartNumbers, PartRow};

/// How far the numbers of a total may be from those of its parts, whatever their digits.
const ROUNDED: f64 = 1e-3;

/// How far rounding may move a mass, at most, and, in sizes of the whole, a coordinate: one that is written in few digits may have no more.
const MOST_ROUNDED: [f64; 2] = [0.01, 0.02];

/// What a row weighs and where, and how far both may be from that if they were rounded to the digits that stand there.
#[derive(Clone, Copy, Debug)]
struct Weight {
    mass: f64,
    centre: [f64; 3],
    mass_off: f64,
    centre_off: [f64; 3],
    speaks_of_a_sum: bool,
}

impl Weight {
    /// `size` is the greatest coordinate of a mass centre, m.
    fn of(row: &PartRow, numbers: &PartNumbers, size: f64) -> Self {
        let (mass, [half, halves @ ..]) = (numbers.mass_kg(), numbers.half_places());
        Self {
            mass,
            centre: numbers.mass_centre_m(),
            mass_off: half.min(MOST_ROUNDED[0] * mass.abs()),
            centre_off: halves.map(|half| half.min(MOST_ROUNDED[1] * size)),
            speaks_of_a_sum: least(row).is_some(),
        }
    }
}

/// Some rows together.
#[derive(Clone, Debug, Default)]
struct Sum {
    count: usize,
    mass: f64,
    first_moments: [f64; 3],
    /// The squares of how far the masses may be off, and these times the coordinate and its square.
    mass_squares: f64,
    first_squares: [f64; 3],
    second_squares: [f64; 3],
    /// The squares of how far the first moments may be off as the coordinates are.
    centre_squares: [f64; 3],
    has_sums: bool,
}

impl Sum {
    fn of<'a>(rows: impl IntoIterator<Item = &'a Weight>) -> Self {
        let mut sum = Self::default();
        rows.into_iter().for_each(|row| sum.add(row));
        sum
    }

    fn add(&mut self, row: &Weight) {
        self.count += 1;
        self.mass += row.mass;
        let square = row.mass_off * row.mass_off;
        self.mass_squares += square;
        for axis in 0..3 {
            let (x, off) = (row.centre[axis], row.mass * row.centre_off[axis]);
            self.first_moments[axis] += row.mass * x;
            self.first_squares[axis] += square * x;
            self.second_squares[axis] += square * x * x;
            self.centre_squares[axis] += off * off;
        }
        self.has_sums |= row.speaks_of_a_sum;
    }

    /// How far a sum may be off by all rows, of the squares of how far each may be: each by an even law, so that three standard deviations are the square
    /// root of three times the sum of squares, and so many numbers are never off by more than the root of so many times that sum.
    fn off(&self, squares: f64) -> f64 {
        (squares * self.count.min(3) as f64).sqrt()
    }

    /// Whether a row has the mass of these, to rounding.
    fn has_mass(&self, row: &Weight) -> bool {
        let off = row.mass_off + self.off(self.mass_squares);
        row.mass > 0.0 && (self.mass - row.mass).abs() <= off.max(ROUNDED * row.mass)
    }

    /// The same with the mass centre.
    fn is_same(&self, row: &Weight, size: f64) -> bool {
        let is_near = |axis: usize| {
            let x = row.centre[axis];
            let of_masses = self.second_squares[axis] - 2.0 * x * self.first_squares[axis]
                + x * x * self.mass_squares;
            let off = self.mass * row.centre_off[axis]
                + self.off(self.centre_squares[axis] + of_masses.max(0.0));
            let apart = (self.first_moments[axis] - self.mass * x).abs();
            apart <= off.max(ROUNDED * row.mass * size)
        };
        self.has_mass(row) && (0..3).all(is_near)
    }

    /// Whether it weighs more than a row, and will if positive masses are added to it.
    fn is_heavier(&self, row: &Weight) -> bool {
        let off = row.mass_off + self.off(self.mass_squares) + ROUNDED * row.mass;
        self.mass - row.mass > off
    }
}

/// What each row of a list weighs, if it has numbers.
pub(super) struct Totals {
    weights: Vec<Option<Weight>>,
    size: f64,
}

impl Totals {
    pub(super) fn of(rows: &[PartRow]) -> Self {
        let size = size(rows);
        let weight = |row: &PartRow| Some(Weight::of(row, row.numbers()?, size));
        Self { weights: rows.iter().map(weight).collect(), size }
    }

    /// Whether a row has mass and mass centre of some others together.
    pub(super) fn is_of(&self, row: usize, parts: &[usize]) -> bool {
        let weight = |at: &usize| self.weights.get(*at)?.as_ref();
        let sum = Sum::of(parts.iter().filter_map(weight));
        weight(&row).is_some_and(|own| sum.is_same(own, self.size))
    }
}

/// How many rows a row must have the sum of to be taken for it, if it speaks of one.
fn least(row: &PartRow) -> Option<usize> {
    row.labels().filter_map(least_summed).min()
}

/// The first row with numbers that says that it sums up others, or speaks of a sum and has that of the rows just above or below it, and what it says.
pub(super) fn named(rows: &[PartRow]) -> Option<(&PartRow, &str)> {
    let size = size(rows);
    let with_weight = |row| Some((row, Weight::of(row, row.numbers()?, size)));
    let all: Vec<(&PartRow, Weight)> = rows.iter().filter_map(with_weight).collect();
    // A list with a part of no mass or less is refused for that.
    let are_parts = all.iter().all(|(_, weight)| weight.mass > 0.0);
    let mut names: Vec<SummaryNames> = Vec::new();
    for (at, (row, own)) in all.iter().enumerate() {
        names.resize_with(row.labels().count(), SummaryNames::default);
        let sums_up =
            |(label, names): (_, &mut SummaryNames)| names.sums_up(label).then_some(label);
        if let Some(label) = row.labels().zip(&mut names).find_map(sums_up) {
            return Some((row, label));
        }
        let Some(least) = least(row).filter(|_| are_parts) else { continue };
        let (above, below) = (&all[..at], &all[at + 1..]);
        let weight = |(_, weight): &(&PartRow, Weight)| *weight;
        if is_sum(above.iter().rev().map(weight), least, own, size)
            || is_sum(below.iter().map(weight), least, own, size)
        {
            let label = row.labels().find(|label| least_summed(label).is_some());
            return label.map(|label| (*row, label));
        }
    }
    None
}

/// Rows that have mass and mass centre of all rows above them together, but for such rows, or, the first one, of all below it.
pub(super) fn like_totals(rows: &[PartRow]) -> Vec<&PartRow> {
    let size = size(rows);
    let with_weight = |row| Some((row, Weight::of(row, row.numbers()?, size)));
    let all: Vec<(&PartRow, Weight)> = rows.iter().filter_map(with_weight).collect();
    let (mut found, mut above) = (Vec::new(), Sum::default());
    for (at, (row, own)) in all.iter().enumerate() {
        let below = || Sum::of(all[1..].iter().map(|(_, weight)| weight));
        let of_all = at == 0 && all.len() > 2 && below().is_same(own, size);
        if of_all || above.count >= 2 && above.is_same(own, size) {
            found.push(*row);
        } else {
            above.add(own);
        }
    }
    found
}

/// Whether a row is the sum of so many or more of the first of some parts. Where a name can be nothing else than that of a sum, the mass of two or more
/// rows is enough if none of them speaks of a sum: lists of sums alone hold equal masses. Where it may be that of a part, `total pressure sensor`, the rows
/// must be other parts.
fn is_sum(parts: impl Iterator<Item = Weight>, least: usize, of: &Weight, size: f64) -> bool {
    let mut sum = Sum::default();
    for part in parts {
        sum.add(&part);
        // Lists of 60,000 parts are not summed up once for each part.
        if sum.is_heavier(of) {
            return false;
        }
        let is_certain = least == 1;
        let by_mass = is_certain && sum.count > 1 && !sum.has_sums && sum.has_mass(of);
        let may_be_sum = sum.count >= least && (is_certain || !sum.has_sums);
        if by_mass || may_be_sum && sum.is_same(of, size) {
            return true;
        }
    }
    false
}

/// The greatest coordinate of a mass centre, m.
fn size(rows: &[PartRow]) -> f64 {
    let numbers = rows.iter().filter_map(PartRow::numbers);
    numbers.flat_map(PartNumbers::mass_centre_m).fold(0.0, |size: f64, x| size.max(x.abs()))
}

#[cfg(test)]
mod tests {
    use super::super::tests::read;
    use super::*;
    use proptest::prelude::*;

    const HEAD: &str = "name,mass,Cx,Cy,Cz,Ixx,Iyy,Izz\n";

    /// Masses and places of some parts, as a spreadsheet computes them.
    fn parts(count: std::ops::Range<usize>) -> impl Strategy<Value = Vec<(f64, [f64; 3])>> {
        prop::collection::vec((1.0..50.0f64, prop::array::uniform3(-1.0..3.0f64)), count)
    }

    /// A row that shows so many decimals of mass and mass centre.
    fn row(name: &str, (mass, c): (f64, [f64; 3]), [of_mass, of_centre]: [usize; 2]) -> String {
        let [x, y, z] = c.map(|x| format!("{x:.of_centre$}"));
        format!("{name},{mass:.of_mass$},{x},{y},{z},50,50,40\n")
    }

    fn total(parts: &[(f64, [f64; 3])]) -> (f64, [f64; 3]) {
        let mass: f64 = parts.iter().map(|(mass, _)| mass).sum();
        let of = |axis: usize| parts.iter().map(|(m, c)| m * c[axis]).sum::<f64>() / mass;
        (mass, [of(0), of(1), of(2)])
    }

    proptest! {
        /// That sums are given up where they are heavier changes no answer: half of these rows are sums.
        #[test]
        fn what_is_heavier_is_no_sum(
            parts in parts(1..12),
            (summed, least, of_some, off) in (1..12_usize, 1..3_usize, any::<bool>(), 0.98..1.02f64),
            (rounding, has_sums) in (prop::array::uniform2(0.0..0.01f64), any::<bool>()),
        ) {
            let weight = |(mass, centre): (f64, [f64; 3])| Weight {
                mass, centre, mass_off: rounding[0] * mass, centre_off: [rounding[1]; 3], speaks_of_a_sum: has_sums,
            };
            let (mass, centre) = if of_some { total(&parts[..summed.min(parts.len())]) } else { parts[0] };
            let of = weight((off * mass, centre));
            let parts: Vec<Weight> = parts.iter().map(|part| weight(*part)).collect();
            let is_one = |count: &usize| {
                let sum = Sum::of(&parts[..*count]);
                let by_mass = least == 1 && *count > 1 && !has_sums && sum.has_mass(&of);
                by_mass || *count >= least && (least == 1 || !has_sums) && sum.is_same(&of, 1.0)
            };
            let expected = (1..=parts.len()).any(|count| is_one(&count));
            prop_assert_eq!(is_sum(parts.iter().copied(), least, &of, 1.0), expected);
        }

        /// Parts that are called masses, and those of which some may be sums by their digits, are no sums, in whatever digits: whole kilograms on a
        /// beam, and balance masses opposite to each other.
        #[test]
        fn lumped_masses_are_no_sums(
            masses in prop::collection::vec((1_u32..12, -30_i32..30), 2..40),
            [of_mass, of_centre] in prop::array::uniform2(0_usize..3),
            name in prop::sample::select(vec!["Mass", "lumped mass", "ballast mass", "Balance mass", "tip mass", "total pressure sensor", "mean block"]),
            place in any::<prop::sample::Index>(),
        ) {
            let mut parts: Vec<(f64, [f64; 3])> =
                masses.iter().map(|(mass, x)| (f64::from(*mass), [f64::from(*x) / 10.0, 0.0, 0.0])).collect();
            // One is exactly the sum of those above it.
            let place = 1 + place.index(parts.len());
            parts.insert(place, total(&parts[..place]));
            let list = parts.iter().enumerate().map(|(i, part)| row(&format!("{name} {i}"), *part, [of_mass, of_centre])).collect::<String>();
            prop_assert!(read(&format!("{HEAD}{list}")).is_ok(), "{}", list);
        }

        /// A sum that stands above its parts is one, too.
        #[test]
        fn a_sum_may_stand_above_its_parts(
            (before, of, after) in (parts(0..4), parts(2..6), parts(0..4)),
            decimals in prop::array::uniform2(2_usize..6),
            name in prop::sample::select(vec!["Bus total", "Subtotal bus", "Gesamtmasse Bus", "Teilsumme", "Tot. bus", "Launch mass", "Subtot"]),
        ) {
            let rows = |parts: &[(f64, [f64; 3])], name: &str| {
                parts.iter().enumerate().map(|(i, part)| row(&format!("{name} {i}"), *part, decimals)).collect::<String>()
            };
            let sum = row(name, total(&of), decimals);
            let parts = [rows(&before, "a"), rows(&of, "b"), rows(&after, "c")];
            let plain = read(&format!("{HEAD}{}", parts.concat()));
            prop_assert!(plain.is_ok(), "{:?}", plain);
            let [before, of, after] = parts;
            let refused = read(&format!("{HEAD}{before}{sum}{of}{after}"));
            let refused = refused.map(|_| ()).map_err(|error| error.to_string()).unwrap_err();
            prop_assert!(refused.contains("which sums up others"), "{}", refused);
        }

        /// A total is one in whatever digits it and its parts are shown, and no part of a list is one.
        #[test]
        fn a_total_is_seen_in_the_digits_of_a_spreadsheet(
            parts in parts(2..9),
            decimals in prop::array::uniform2(2_usize..6),
            (of_parts, at) in (prop::option::of(3_usize..6), any::<prop::sample::Index>()),
        ) {
            let shown = of_parts.map_or(decimals, |more| [more; 2]);
            let rows = |parts: &[(f64, [f64; 3])], name: &str| {
                parts.iter().enumerate().map(|(i, part)| row(&format!("{name} {i}"), *part, shown)).collect::<String>()
            };
            // Names that speak of a mass or a sum are names of parts as well.
            for name in ["part", "tank mass", "total pressure sensor"] {
                let list = read(&format!("{HEAD}{}", rows(&parts, name)));
                let list = list.map_err(|error| TestCaseError::fail(format!("{}{error}", rows(&parts, name))))?;
                prop_assert!(list.like_totals().is_empty(), "{}", rows(&parts, name));
            }
            let of_all = total(&parts);
            let list = |name: &str| format!("{HEAD}{}{}", rows(&parts, "part"), row(name, of_all, decimals));
            let table = read(&list("craft")).unwrap();
            let found: Vec<&str> = table.like_totals().iter().map(|row| row.name()).collect();
            prop_assert_eq!(found, ["craft"], "{}", list("craft"));
            for name in ["Bus total", "dry mass of the craft"] {
                let found = read(&list(name));
                prop_assert!(found.is_err(), "{}", list(name));
            }
            // The mass alone decides where the name can be nothing else, and only there.
            let mut elsewhere = of_all;
            elsewhere.1[at.index(3)] += 0.5;
            let list = |name: &str| format!("{HEAD}{}{}", rows(&parts, "part"), row(name, elsewhere, decimals));
            prop_assert!(read(&list("Sum of the bus")).is_err(), "{}", list("Sum of the bus"));
            for name in ["craft", "dry mass of the craft"] {
                let table = read(&list(name)).map_err(|error| TestCaseError::fail(error.to_string()))?;
                prop_assert!(table.like_totals().is_empty());
            }
        }
    }

    /// Of a spreadsheet that shows two decimals.
    #[test]
    fn two_decimals_of_a_total_tell_it() {
        let list = "A,10,1,2,3,1,1,1\nB,1,1.5,2,3,1,1,1\nC,5,0,0,0,1,1,1\n";
        for (total, is_refused) in [("Bus total", true), ("Launch mass", true), ("Bus", false)] {
            let found = read(&format!("{HEAD}{list}{total},16,0.72,1.38,2.06,50,50,40\n"));
            assert_eq!(found.is_err(), is_refused, "{total}");
            let like = found.map(|table| table.like_totals().len());
            assert_eq!(like.unwrap_or(1), 1, "{total}");
        }
        // Sums alone are a list of parts, of equal masses, too.
        let sums = "ADCS total,12,1,2,3,1,1,1\nEPS total,5,0,0,0,1,1,1\nBus total,17,9,9,9,1,1,1\n";
        assert!(read(&format!("{HEAD}{sums}")).is_ok());
    }

    /// A column beside the names may say it: descriptions, an index, or the first one.
    #[test]
    fn a_total_may_say_so_beside_its_name() {
        for heading in ["Description", "Item", "id", "element", "No."] {
            for word in ["TOTAL", "Subtotal", "Bus total", "Mean", "panel"] {
                let head = format!("{heading},name,mass,Cx,Cy,Cz,Ixx,Iyy,Izz");
                let text = format!(
                    "{head}\na,A-1,4,0,0,0,1,1,1\nb,A-2,6,0,0,0,1,1,1\n{word},A-3,10,0,0,0,1,1,1\n"
                );
                match read(&text) {
                    Ok(_) => assert_eq!(word, "panel", "{text}"),
                    Err(error) => {
                        let said = format!(
                            "line 4: {word}: the name is that of a row which sums up others"
                        );
                        assert!(error.to_string().starts_with(&said) && word != "panel", "{error}");
                    }
                }
            }
        }
    }
}
