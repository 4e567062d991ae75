"""How often a Cholesky factor of the pseudo-inertia in single precision exists for flat plates.

Recipes that randomize an inertia by J' = (U L)(U L)ᵀ need the factor L of the pseudo-inertia J = L Lᵀ about the origin
of the link, which they make of mass, mass centre, principal moments and principal axes. J of a flat plate is singular,
and rounding decides whether the last roots exist.
"""

from __future__ import annotations

import numpy as np

EYE = np.eye(3)


def factor(matrices: np.ndarray) -> np.ndarray:
    """Lower triangular L of matrices = L Lᵀ, shape (n, 4, 4), in the precision of the matrices; not finite where a root
    is that of a negative number."""
    lower = np.zeros_like(matrices)
    with np.errstate(invalid="ignore", divide="ignore"):
        for column in range(4):
            for row in range(column, 4):
                done = np.sum(lower[:, row, :column] * lower[:, column, :column], axis=1, dtype=matrices.dtype)
                rest = matrices[:, row, column] - done
                lower[:, row, column] = np.sqrt(rest) if row == column else rest / lower[:, column, column]
    return lower


def pseudo_inertia(mass: np.ndarray, centre: np.ndarray, moments: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """Pseudo-inertias about the origin of the link, shape (n, 4, 4), in the precision of what is given: masses (n,),
    mass centres (n, 3), principal moments (n, 3) and principal axes in the columns of (n, 3, 3)."""
    result = np.empty((len(mass), 4, 4), mass.dtype)
    about_centre = np.einsum("nij,nj,nkj->nik", axes, moments, axes)
    eye = EYE.astype(mass.dtype)
    square = np.sum(centre * centre, axis=1)[:, None, None] * eye - centre[:, :, None] * centre[:, None, :]
    about_origin = about_centre + mass[:, None, None] * square
    trace = np.trace(about_origin, axis1=1, axis2=2, dtype=mass.dtype)
    result[:, :3, :3] = trace[:, None, None] / 2 * eye - about_origin
    result[:, :3, 3] = result[:, 3, :3] = mass[:, None] * centre
    result[:, 3, 3] = mass
    return result


def plates(rng: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Mass, mass centre, principal moments and axes of n flat plates: 1 kg, sides of 0.05 to 0.5 m, turned at random,
    the mass centre within 0.1 m of the origin of the link along each axis."""
    sides = rng.uniform(0.05, 0.5, (n, 2)) ** 2 / 12
    moments = np.column_stack([sides[:, 1], sides[:, 0], sides.sum(axis=1)])
    axes = np.linalg.qr(rng.standard_normal((n, 3, 3)))[0]
    return np.ones(n), rng.uniform(-0.1, 0.1, (n, 3)), moments, axes


def not_finite(rng: np.random.Generator, n: int) -> float:
    """The share of n flat plates whose factor is not finite in single precision."""
    single = [array.astype(np.float32) for array in plates(rng, n)]
    return 1.0 - np.mean(np.isfinite(factor(pseudo_inertia(*single))).all(axis=(1, 2)))
