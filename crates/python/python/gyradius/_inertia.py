"""Inertia matrices, many at a time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from gyradius import _core
from gyradius._arrays import INERTIA, SINGLE, ordered, out, own_numbers, real, rows, text

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, DTypeLike, NDArray

    from gyradius._arrays import Real


def is_realizable(inertia: ArrayLike, tolerance: Real | None = None) -> Any:
    """Which inertia matrices some body has.

    A matrix belongs to a body if and only if its second moments ½ tr(I) 1 - I are positive semidefinite: then no
    principal moment exceeds the sum of the other two. Plates, rods and points are bodies.

    Parameters
    ----------
    inertia : array_like, shape (..., 3, 3)
        In kg·m² about any point, with products as tensor entries, I₁₂ = -∫ x₁ x₂ dm.
    tolerance : float, optional
        How far below zero a second moment may be, and how far from symmetric a matrix, as a share of its trace. Less than 1.4e-14, also
        zero, is taken as 1.4e-14: the computation itself rounds by as much. If it is not said,
        64 units in the last place of the type of the array, for rounding: 1.4e-14 in 64 bits and 7.6e-6 in 32 bits. In 16 bits it is
        0.0625, so that a moment may exceed the sum of the others by a tenth: convert such arrays, and state a tolerance. Numbers with
        six digits need 1e-6.

    Returns
    -------
    bool or array of bool, shape (...)
        False too for NaN, infinities and matrices that are not symmetric.

    Examples
    --------
    >>> import numpy as np, gyradius
    >>> gyradius.is_realizable(np.diag([1.0, 2.0, 3.0]))
    True
    >>> gyradius.is_realizable([np.diag([1.0, 2.0, 3.1]), np.diag([1.0, 1.0, 1.0])])
    array([False,  True])
    """
    given = own_numbers("inertia", inertia, order=INERTIA)
    flat, lead = rows("inertia", given, (3, 3))
    found = out(_core.inertia_is_realizable(flat, _tolerance(tolerance, given.dtype)), lead)
    return bool(found) if lead == () else found


def margin(inertia: ArrayLike, *, dtype: DTypeLike | None = None) -> Any:
    """How far inside of what bodies have: the smallest second moment over the sum of the sizes of the principal moments.

    Parameters
    ----------
    inertia : array_like, shape (..., 3, 3)
        In kg·m².
    dtype : optional
        Type of floats of the result.

    Returns
    -------
    float or array, shape (...)
        1/6 for a ball, 0 for plates, rods and points, negative for what no body has; NaN where an entry is not finite, or beyond 2.8e306.

    Examples
    --------
    >>> import numpy as np, gyradius
    >>> round(float(gyradius.margin(np.eye(3))), 6), float(gyradius.margin(np.diag([1.0, 1.0, 2.0])))
    (0.166667, 0.0)
    """
    flat, lead = rows("inertia", inertia, (3, 3))
    return out(_core.inertia_margin(flat), lead, dtype)


PIECE = 1 << 13
"""Matrices that are reported on in one go."""


class Report(NamedTuple):
    """What is right and wrong with inertia matrices, of the shape (...) of what was asked."""

    is_realizable: Any
    """Whether some body has it."""
    margin: Any
    """As `gyradius.margin`."""
    excess_percent: Any
    """By how many percent the largest principal moment exceeds the sum of the other two; 0 if it does not."""
    principal_moments: Any
    """(..., 3) in kg·m², NaN where an entry is not finite, or beyond 2.8e306."""
    second_moments: Any
    """(..., 3) in kg·m² about the principal axes; one that is negative belongs to no body."""
    faults: Any
    """What is wrong, in words: a tuple of texts for each matrix."""

    def __str__(self) -> str:
        if isinstance(self.faults, tuple):
            return "realizable" if self.is_realizable else "not realizable: " + "; ".join(self.faults)
        bad = int(np.size(self.is_realizable) - np.count_nonzero(self.is_realizable))
        return f"{bad} of {np.size(self.is_realizable)} not realizable"


def report(inertia: ArrayLike, tolerance: Real | None = None) -> Report:
    """What is right and wrong with inertia matrices, in numbers and in words.

    Parameters
    ----------
    inertia : array_like, shape (..., 3, 3)
        In kg·m².
    tolerance : float, optional
        As for `is_realizable`.

    Examples
    --------
    >>> import numpy as np, gyradius
    >>> print(gyradius.report(np.diag([1.0, 2.0, 3.3])))
    not realizable: I33 = 3.3 kg·m² exceeds the sum of the others, 1 + 2 kg·m², by 10.00 %
    """
    given = own_numbers("inertia", inertia, order=INERTIA)
    flat, lead = rows("inertia", given, (3, 3))
    allowed = _tolerance(tolerance, given.dtype)
    # In pieces, between which Python sees an interrupt.
    pieces = (flat[first : first + PIECE] for first in range(0, max(len(flat), 1), PIECE))
    found = [one for piece in pieces for one in _core.inertia_report(piece, allowed)]
    nothing = [np.nan] * 3

    def column(place: int, missing: Any, tail: tuple[int, ...] = ()) -> Any:
        values = [missing if one[place] is None else one[place] for one in found]
        return out(np.array(values, dtype=float).reshape(-1, *tail), (*lead, *tail))

    good = np.array([one[0] for one in found], dtype=bool).reshape(lead)
    faults: Any = tuple(found[0][5]) if lead == () else np.empty(len(found), dtype=object)
    if lead != ():
        for place, one in enumerate(found):
            faults[place] = tuple(one[5])
        faults = faults.reshape(lead)
    return Report(
        is_realizable=bool(good) if lead == () else good,
        margin=column(1, np.nan),
        excess_percent=column(2, np.nan),
        principal_moments=column(3, nothing, (3,)),
        second_moments=column(4, nothing, (3,)),
        faults=faults,
    )


def nearest(
    inertia: ArrayLike,
    method: Literal["nearest", "clip-second-moments", "shift-moments"] = "nearest",
    *,
    dtype: DTypeLike | None = None,
) -> NDArray[np.floating[Any]]:
    """The nearest inertia matrices that some body has.

    What a body has to the rounding of 64 bits, 1.4e-14 of the trace, is not moved by a bit, but for an asymmetry that is rounding: both
    entries become their mean. An array in 32 bits is judged so too, and results that are rounded to 32 bits with `dtype` may lie outside
    of what bodies have by 1e-7 of the trace: `is_realizable` of an array in 32 bits allows for it.

    Parameters
    ----------
    inertia : array_like, shape (..., 3, 3)
        In kg·m², symmetric.
    method : str
        ``"nearest"``: smallest Frobenius distance. ``"clip-second-moments"``: negative second moments set to zero.
        ``"shift-moments"``: the same number added to all three moments, which keeps the products.
    dtype : optional
        Type of floats of the result.

    Returns
    -------
    array, shape (..., 3, 3)

    Raises
    ------
    ValueError
        An entry is not finite, a matrix not symmetric, or no body is near.

    Examples
    --------
    >>> import numpy as np, gyradius
    >>> gyradius.nearest(np.diag([1.0, 2.0, 3.3])).diagonal().round(6).tolist()
    [1.1, 2.1, 3.2]
    """
    flat, lead = rows("inertia", inertia, (3, 3))
    return out(_core.inertia_nearest(flat, text("method", method)), (*lead, 3, 3), dtype)


def of_rounded(
    inertia: NDArray[np.float64], beside: NDArray[np.float64] | None = None, dtype: np.dtype[Any] = SINGLE
) -> NDArray[np.float64]:
    """Inertias (n, 3, 3) of numbers that were rounded to this type: the nearest of some body in the place of those that only this rounding
    took from all bodies. `beside` has the traces of the inertias that were rounded, if these follow from others."""
    sizes = np.trace(inertia, axis1=1, axis2=2) if beside is None else beside
    allowed = rounding(dtype) * sizes[:, None, None]
    turned = inertia.transpose(0, 2, 1)
    mean = 0.5 * (inertia + turned)
    is_near = (np.abs(inertia - turned) <= allowed).all(axis=(1, 2))
    # Which adds what is allowed to each of the second moments.
    lost = ~is_realizable(inertia) & is_near & is_realizable(mean + 2.0 * allowed * np.eye(3))
    if not lost.any():
        return inertia
    found = inertia.copy()
    found[lost] = nearest(mean[lost])
    return found


class PrincipalAxes(NamedTuple):
    """Principal moments and axes of inertia matrices.

    `attitude` is the unit quaternion that takes body components to principal components: I = R(q)ᵀ diag(moments) R(q). It is the
    conjugate of what turns principal components into those of the body, as ``body_iquat`` of MuJoCo and `MassProperties.rotated` do.
    `axes` has the principal axes in body components, as columns of a rotation: I = A diag(moments) Aᵀ, so that A = R(q)ᵀ.
    """

    moments: Any
    """(..., 3) in kg·m²."""
    attitude: Any
    """(..., 4): takes body components to principal components."""
    axes: Any
    """(..., 3, 3): the principal axes in body components, as columns."""


def principal_axes(
    inertia: ArrayLike, *, order: str = "xyzw", dtype: DTypeLike | None = None
) -> PrincipalAxes:
    """Principal moments and axes, named so that each axis is the nearest to the body axis of its number.

    The attitude takes body components to principal components, as `fixed_attitude` and all laws of axes take it. MuJoCo's ``iquat``,
    `MassProperties.rotated` and the pose of an inertial frame in a file go the other way: their quaternion is its conjugate, with the
    signs of the first three components changed.

    Parameters
    ----------
    inertia : array_like, shape (..., 3, 3)
        In kg·m², symmetric; of a body or not.
    order : {"xyzw", "wxyz"}
        Of the quaternions: scalar last, or first.
    dtype : optional
        Type of floats of the results.

    Examples
    --------
    >>> import numpy as np, gyradius
    >>> inertia = np.array([[2.0, 0.1, 0.0], [0.1, 3.0, 0.0], [0.0, 0.0, 4.0]])
    >>> found = gyradius.principal_axes(inertia)
    >>> bool(np.allclose(found.axes @ np.diag(found.moments) @ found.axes.T, inertia))
    True
    >>> own = gyradius.MassProperties(1.0, [0.0, 0.0, 0.0], np.diag(found.moments))
    >>> bool(np.allclose(own.rotated(found.attitude * [-1, -1, -1, 1]).inertia, inertia))
    True
    """
    flat, lead = rows("inertia", inertia, (3, 3))
    found = _core.inertia_principal_axes(flat)
    quaternions = found[:, 3:]
    return PrincipalAxes(
        moments=out(np.ascontiguousarray(found[:, :3]), (*lead, 3), dtype),
        attitude=out(ordered(np.ascontiguousarray(quaternions), order), (*lead, 4), dtype),
        axes=out(_transposed_rotation(quaternions), (*lead, 3, 3), dtype),
    )


def _transposed_rotation(xyzw: NDArray[np.float64]) -> NDArray[np.float64]:
    x, y, z, w = xyzw.T
    entries = [
        [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)],
        [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)],
        [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(entries), 2, 0)


def rounding(dtype: np.dtype[Any]) -> float:
    """64 units in the last place of floats of this type, as a share: what results of them are off by at most."""
    return 64.0 * float(np.finfo(dtype).eps)


def _tolerance(tolerance: Real | None, dtype: np.dtype[Any]) -> float | None:
    """What is said; otherwise 64 units in the last place of numbers of this type, of which the compiled part knows those of 64 bits."""
    if tolerance is None:
        return rounding(dtype) if dtype.kind == "f" and dtype.itemsize < 8 else None
    found = real("tolerance", tolerance)
    if not 0.0 <= found < np.inf:
        raise ValueError(f"tolerance = {tolerance!r}: it must be zero or positive, and finite")
    return found
