//! Tests of a fitted model, and the verdict of several of them together.

/// The verdict falls when a model that is right would look worse this often.
const SIZE: f64 = 0.05;

/// One test of a model that was fitted to samples, of what `A` names.
#[derive(Clone, Copy, Debug, PartialEq, getset::CopyGetters)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[getset(get_copy = "pub")]
pub struct Test<A> {
    #[getset(skip)]
    aspect: A,
    /// How often samples of the model itself would look worse.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::read::probability"))]
    p_value: f64,
    /// The smallest p-value that the test can give, zero if it is not by simulation.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "crate::read::probability"))]
    resolution: f64,
}

impl<A: Copy> Test<A> {
    pub(crate) fn new(aspect: A, p_value: f64, resolution: f64) -> Self {
        Self { aspect, p_value, resolution }
    }

    /// What it looks at.
    #[must_use]
    pub fn aspect(&self) -> A {
        self.aspect
    }
}

/// Whether samples look like draws of the model that was fitted to them: tests of what `A` names.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Goodness<A> {
    tests: Vec<Test<A>>,
}

impl<A: Copy> Goodness<A> {
    pub(crate) fn new(tests: Vec<Test<A>>) -> Self {
        Self { tests }
    }

    /// The tests, each at its own level.
    #[must_use]
    pub fn tests(&self) -> &[Test<A>] {
        &self.tests
    }

    /// How often samples of the model itself would fare worse in any of the tests: Šidák's
    /// 1 − (1 − min p)ᵐ for m tests, which are independent of each other for many samples; 1 where there is nothing to test.
    #[must_use]
    pub fn p_value(&self) -> f64 {
        if self.tests.is_empty() {
            return 1.0;
        }
        let least = self.tests.iter().map(|t| t.p_value).fold(1.0, f64::min);
        -libm::expm1(self.tests.len() as f64 * libm::log1p(-least))
    }

    /// Whether nothing speaks against the model at 5 %.
    #[must_use]
    pub fn fits(&self) -> bool {
        self.p_value() >= SIZE
    }

    /// What speaks against the model: the tests that fail at 5 % though there are several (Šidák).
    pub fn objections(&self) -> impl Iterator<Item = &Test<A>> {
        let each = -libm::expm1(libm::log1p(-SIZE) / self.tests.len().max(1) as f64);
        self.tests.iter().filter(move |t| t.p_value < each)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// A verdict falls exactly where one of its tests objects, and one test is its own verdict.
        #[test]
        fn verdicts_are_those_of_their_tests(p_values in prop::collection::vec(0.0..=1.0_f64, 0..8)) {
            let tests = p_values.iter().enumerate().map(|(i, p)| Test::new(i, *p, 0.0)).collect();
            let verdict = Goodness::<usize>::new(tests);
            let m = p_values.len() as i32;
            let least = p_values.iter().copied().fold(1.0, f64::min);
            let expected = if m == 0 { 1.0 } else { 1.0 - (1.0 - least).powi(m) };
            prop_assert!((verdict.p_value() - expected).abs() < 1e-12);
            let objections: Vec<usize> = verdict.objections().map(Test::aspect).collect();
            prop_assert_eq!(verdict.fits(), objections.is_empty());
            for (i, p) in p_values.iter().enumerate() {
                prop_assert_eq!(objections.contains(&i), 1.0 - (1.0 - p).powi(m) < SIZE);
            }
        }
    }
}
