//! How far each product can be moved beside what else is stated, and how far axes may turn.

use nalgebra::{DMatrix, DVector, RowDVector, Vector3};

use super::{
    entries::{forms, moved_by_turns},
    task::{Asked, Task},
};

/// v/(1 + 8v) of a rotation with the variance v that may be any.
pub(super) const MOST_TURN: f64 = 0.125;
/// Beyond this share of a bound, rounding.
const ROUNDING: f64 = 1e-9;

/// The largest deviation, kg·m², that each product can have to first order, with turns no wider than is stated of them and second moments
/// that scatter if anything is asked of the moments, where no other entry has more than is asked of it; infinite where no products are
/// stated.
///
/// # Derivation
/// Small turns about the principal axes and changes of the second moments, t together, move entry e by aₑ·t, so that it has the variance
/// aₑᵀ V aₑ with their covariance V. The largest one under bounds aᵢᵀ V aᵢ ≤ bᵢ² is the square of the largest aₑ·t under |aᵢ·t| ≤ bᵢ: with
/// V = t tᵀ it is had, and with the multipliers μ of that linear program, aₑ = Σ μᵢ aᵢ, Cauchy and Schwarz give
/// (aₑᵀ V aₑ)^½ ≤ Σ |μᵢ| (aᵢᵀ V aᵢ)^½ ≤ Σ |μᵢ| bᵢ. It is had where as many bounds are met as there are unknowns.
pub(super) fn reach(task: &Task) -> [f64; 3] {
    let Asked::Stated(products) = task.products else { return [f64::INFINITY; 3] };
    let attitude = &task.body.attitude;
    let k = Vector3::from(task.body.roots.squared().values());
    let widest = Vector3::from(most_turns(task));
    let scatters = task.moments != Asked::Nothing;
    let moments = task.moments.variances().map(|v| v.max(task.least(task.moments)).sqrt());
    let largest_moment = moments.into_iter().fold(0.0, f64::max);
    // Turns in shares of the widest, and second moments in shares of the largest deviation, so that numbers are of one size.
    let row = |(turned, form): ([Vector3<f64>; 3], Vector3<f64>)| {
        let turned = Vector3::from(turned.map(|form| form.dot(&k))).component_mul(&widest);
        let scattered = form * largest_moment;
        let both = turned.iter().chain(scattered.iter().filter(|_| scatters));
        RowDVector::from_vec(both.copied().collect())
    };
    let rows: Vec<_> = moved_by_turns(attitude).into_iter().zip(forms(attitude)).map(row).collect();
    let unknowns = rows[0].len();
    let axis = |axis: usize| RowDVector::from_fn(unknowns, |_, at| f64::from(u8::from(at == axis)));
    let mut bounds: Vec<(RowDVector<f64>, f64)> = (0..3).map(|turn| (axis(turn), 1.0)).collect();
    if scatters {
        bounds.extend((0..3).map(|e| (rows[e].clone(), moments[e])));
    }
    let least = task.least(task.products).sqrt();
    [0, 1, 2].map(|product| {
        let others = (0..3).filter(|other| *other != product);
        let others = others.map(|other| (rows[3 + other].clone(), products[other].max(least)));
        let bounds: Vec<_> = bounds.iter().cloned().chain(others).collect();
        largest(&rows[3 + product], &bounds)
    })
}

/// The largest c·t under |a·t| ≤ b for each of these.
fn largest(c: &RowDVector<f64>, bounds: &[(RowDVector<f64>, f64)]) -> f64 {
    let unknowns = c.len();
    let is_within = |t: &DVector<f64>| {
        bounds.iter().all(|(a, b)| (a * t)[0].abs() <= b + ROUNDING * (b + a.norm()))
    };
    let mut most = 0.0_f64;
    for met in (0..1_u32 << bounds.len()).filter(|met| met.count_ones() as usize == unknowns) {
        let met: Vec<_> =
            (0..).zip(bounds).filter(|(i, _)| met >> i & 1 == 1).map(|(_, b)| b).collect();
        let rows: Vec<_> = met.iter().map(|(a, _)| a.clone()).collect();
        let Some(inverse) = DMatrix::from_rows(&rows).try_inverse() else { continue };
        // The other half are these the other way round.
        for signs in 0..1_u32 << (unknowns - 1) {
            let signed = |i: usize, _| if signs >> i & 1 == 1 { -met[i].1 } else { met[i].1 };
            let t = &inverse * DVector::from_fn(unknowns, signed);
            if is_within(&t) {
                most = most.max((c * &t)[0].abs());
            }
        }
    }
    most
}

/// The most of each rotation.
pub(super) fn most_turns(task: &Task) -> [f64; 3] {
    task.axes.unwrap_or([f64::INFINITY; 3]).map(turn)
}

/// d with d² = v/(1 + 8v): a bounded measure of a rotation of any variance.
pub(super) fn turn(variance: f64) -> f64 {
    if variance.is_finite() {
        (variance / (1.0 + variance / MOST_TURN)).sqrt()
    } else {
        MOST_TURN.sqrt()
    }
}
