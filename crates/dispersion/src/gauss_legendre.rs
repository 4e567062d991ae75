//! The rule of Gauss and Legendre for integrals.

/// Nodes and weights of Gauss and Legendre's rule of 16 points on [−1, 1], the positive half.
pub(crate) const RULE: [[f64; 2]; 8] = [
    [0.09501250983763744, 0.1894506104550685],
    [0.2816035507792589, 0.18260341504492358],
    [0.45801677765722737, 0.16915651939500254],
    [0.6178762444026438, 0.14959598881657674],
    [0.755404408355003, 0.12462897125553388],
    [0.8656312023878318, 0.09515851168249279],
    [0.9445750230732326, 0.062253523938647894],
    [0.9894009349916499, 0.027152459411754096],
];

/// The nodes and weights of the rule on [from, to].
pub(crate) fn panel(from: f64, to: f64, mut at: impl FnMut(f64, f64)) {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    for [node, weight] in RULE {
        at(middle - half * node, half * weight);
        at(middle + half * node, half * weight);
    }
}
