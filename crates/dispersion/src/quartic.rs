//! Quartic forms of the attitude about a mean quaternion, and their covariances under a law of attitudes.

use gyradius_attitude::CentralMoments;
use nalgebra::Vector4;

/// Monomials of four variables of degree up to 2 and up to 4.
const QUADRATIC: usize = 15;
const QUARTIC: usize = 70;

/// Exponents in the order of the degree, so that those of quadratic polynomials come first.
const EXPONENTS: [[usize; 4]; QUARTIC] = {
    let mut all = [[0; 4]; QUARTIC];
    let (mut next, mut degree) = (0, 0);
    while degree <= 4 {
        let mut code = 0;
        while code < 5 * 5 * 5 * 5 {
            let n = [code / 125, code / 25 % 5, code / 5 % 5, code % 5];
            if n[0] + n[1] + n[2] + n[3] == degree {
                all[next] = n;
                next += 1;
            }
            code += 1;
        }
        degree += 1;
    }
    assert!(next == QUARTIC);
    all
};

/// Where the product of two monomials of degree up to 2 stands.
const PRODUCTS: [[usize; QUADRATIC]; QUADRATIC] = {
    let mut products = [[0; QUADRATIC]; QUADRATIC];
    let mut i = 0;
    while i < QUADRATIC {
        let mut j = 0;
        while j < QUADRATIC {
            products[i][j] = place(sum(EXPONENTS[i], EXPONENTS[j]));
            j += 1;
        }
        i += 1;
    }
    products
};

const fn sum(a: [usize; 4], b: [usize; 4]) -> [usize; 4] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]]
}

const fn place(n: [usize; 4]) -> usize {
    let mut place = 0;
    loop {
        let own = EXPONENTS[place];
        if own[0] == n[0] && own[1] == n[1] && own[2] == n[2] && own[3] == n[3] {
            return place;
        }
        place += 1;
    }
}

/// A quadratic polynomial of δ, by its coefficients.
#[derive(Clone, Copy)]
pub(crate) struct Quadratic([f64; QUADRATIC]);

impl Quadratic {
    /// The quadratic form with this polar form, f(u, u) at u = V(m + δ): f(u, v) is bilinear and symmetric.
    pub(crate) fn about(
        moments: &CentralMoments,
        polar: impl Fn(&Vector4<f64>, &Vector4<f64>) -> f64,
    ) -> Self {
        let axes: [Vector4<f64>; 4] = std::array::from_fn(|j| moments.axes().column(j).into());
        let mean = moments.axes() * moments.mean();
        let mut coefficients = [0.0; QUADRATIC];
        coefficients[0] = polar(&mean, &mean);
        for i in 0..4 {
            let mut own = [0; 4];
            own[i] = 1;
            coefficients[place(own)] = 2.0 * polar(&axes[i], &mean);
            for j in 0..4 {
                let mut both = own;
                both[j] += 1;
                coefficients[place(both)] += polar(&axes[i], &axes[j]);
            }
        }
        Self(coefficients)
    }

    pub(crate) fn times(&self, other: &Self) -> Quartic {
        let mut product = [0.0; QUARTIC];
        for (a, places) in self.0.iter().zip(&PRODUCTS) {
            for (b, &place) in other.0.iter().zip(places) {
                product[place] += a * b;
            }
        }
        Quartic(product)
    }
}

/// A polynomial of δ of degree up to 4, by its coefficients.
#[derive(Clone, Copy)]
pub(crate) struct Quartic([f64; QUARTIC]);

impl Quartic {
    pub(crate) const ZERO: Self = Self([0.0; QUARTIC]);

    /// This plus so many times another.
    pub(crate) fn plus(mut self, factor: f64, other: &Self) -> Self {
        for (own, other) in self.0.iter_mut().zip(&other.0) {
            *own += factor * other;
        }
        self
    }

    /// The sum of the products of the coefficients.
    pub(crate) fn dot(&self, other: &Self) -> f64 {
        self.0.iter().zip(&other.0).map(|(a, b)| a * b).sum()
    }
}

/// The moments of the 70 monomials that quartic polynomials are made of.
pub(crate) struct Means(Quartic);

impl Means {
    pub(crate) fn new(moments: &CentralMoments) -> Self {
        Self(Quartic(EXPONENTS.map(|n| moment(moments, n))))
    }

    pub(crate) fn of(&self, polynomial: &Quartic) -> f64 {
        self.0.dot(polynomial)
    }
}

/// The moments of the products of each two of the 70 monomials.
pub(crate) struct Products(Box<[[f64; QUARTIC]; QUARTIC]>);

impl Products {
    pub(crate) fn new(moments: &CentralMoments) -> Self {
        let mut all = Box::new([[0.0; QUARTIC]; QUARTIC]);
        for i in 0..QUARTIC {
            for j in 0..=i {
                all[i][j] = moment(moments, sum(EXPONENTS[i], EXPONENTS[j]));
                all[j][i] = all[i][j];
            }
        }
        Self(all)
    }

    /// For each of these polynomials what the coefficients of another are multiplied with, and summed, in the expectation of the
    /// product of the two.
    pub(crate) fn against<const N: usize>(&self, all: &[Quartic; N]) -> [Quartic; N] {
        let mut products = [Quartic::ZERO; N];
        for (product, own) in products.iter_mut().zip(all) {
            for (row, coefficient) in self.0.iter().zip(&own.0) {
                for (sum, moment) in product.0.iter_mut().zip(row) {
                    *sum += moment * coefficient;
                }
            }
        }
        products
    }
}

/// Of a degree that is kept: the sum of two of at most 4.
fn moment(moments: &CentralMoments, exponents: [usize; 4]) -> f64 {
    moments.of(exponents).unwrap_or(f64::NAN)
}
