//! Logarithms of sums and products.

/// Terms below e to the power of this of the largest are no part of the sum of a few.
pub(crate) const NEGLIGIBLE: f64 = -40.0;

/// ln Σ eˣ without over- and underflow; −∞ of none.
pub(crate) fn ln_sum(x: &[f64]) -> f64 {
    let largest = x.iter().fold(f64::NEG_INFINITY, |most, x| if *x > most { *x } else { most });
    if largest.is_infinite() {
        return largest;
    }
    let mut sum = 0.0;
    for x in x {
        let gap = x - largest;
        if gap == 0.0 {
            sum += 1.0;
        } else if gap > NEGLIGIBLE {
            sum += libm::exp(gap);
        }
    }
    if sum == 1.0 { largest } else { largest + libm::log(sum) }
}

/// ln Π eˣ: −∞ where a factor is zero, whatever the others are.
pub(crate) fn ln_product_of_exps(x: &[f64]) -> f64 {
    if x.contains(&f64::NEG_INFINITY) { f64::NEG_INFINITY } else { x.iter().sum() }
}

/// ln Π x of numbers that are not negative, one logarithm for all where their product stays in range.
pub(crate) fn ln_product(x: &[f64]) -> f64 {
    let product: f64 = x.iter().product();
    if product.is_normal() { libm::log(product) } else { x.iter().map(|x| libm::log(*x)).sum() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_those_of_the_numbers() {
        let of = |x: &[f64]| ln_sum(&x.iter().map(|x| x.ln()).collect::<Vec<_>>()).exp();
        assert!((of(&[1.0, 2.0, 0.0, 4.0]) - 7.0).abs() < 1e-14);
        assert!((ln_sum(&[-1e5, -1e5]) - (2.0_f64.ln() - 1e5)).abs() < 1e-10);
        assert_eq!(ln_sum(&[1e300, -1e300]), 1e300);
        assert_eq!(ln_sum(&[f64::NEG_INFINITY; 2]), f64::NEG_INFINITY);
        assert_eq!(ln_sum(&[0.0, f64::INFINITY]), f64::INFINITY);
        assert_eq!(ln_sum(&[]), f64::NEG_INFINITY);
    }

    #[test]
    fn products_are_those_of_the_numbers() {
        assert_eq!(ln_product(&[2.0, 3.0]), 6.0_f64.ln());
        let powers = [1e-200, 1e-200, 1e100, 1e300, 1e300];
        assert!((ln_product(&powers) - 300.0 * 10.0_f64.ln()).abs() < 1e-10);
        assert_eq!(ln_product(&[0.0, 1.0]), f64::NEG_INFINITY);
    }
}
