"""Laws of attitudes."""

from __future__ import annotations

import json
import warnings
from typing import TYPE_CHECKING, Any

import numpy as np

from gyradius import _core
from gyradius._arrays import attitudes, check_order, numbers, ordered, out, same_names
from gyradius._law import Fit, Law, known, make, nested, one_attitude, short, vector
from gyradius._rng import draws_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, DTypeLike, NDArray

    from gyradius._arrays import Size
    from gyradius._rng import RNG


SMALL = np.radians(10)
"""Rotations that are smaller in all, rad, have the covariance that is asked for, to a percent."""


class AttitudeLaw(Law):
    """A law of attitudes: made by `uniform_attitude`, `radially_constrained_gaussian`, `small_rotations`, `bingham`,
    `fisher_bingham`, `fixed_attitude` and `about_axis`.

    Quaternions are unit quaternions of which q and -q are the same attitude. Where an attitude is that of principal axes, it
    takes body components to principal components, as ``principal_axes(inertia).attitude`` does, and MuJoCo's ``iquat`` does not: see
    `fixed_attitude`.
    """

    __slots__ = ()
    _kind = "Attitude"

    def rvs(
        self,
        size: Size = None,
        rng: RNG = None,
        *,
        order: str = "xyzw",
        dtype: DTypeLike | None = None,
    ) -> NDArray[np.floating[Any]]:
        """Draws as unit quaternions.

        Parameters
        ----------
        size : int or tuple of ints, optional
            How many; one if it is not said.
        rng : None, int, `numpy.random.SeedSequence`, `numpy.random.Generator` or `gyradius.key`
            Where random numbers come from. Integers and keys give the same bits as Rust and the program, however many draws
            there are, in whatever calls and on however many threads. A generator gives 256 bits, which decide all
            draws of the call.
        order : {"xyzw", "wxyz"}
            Scalar last, or first.
        dtype : optional
            Type of floats of the result. Draws are made in 64 bits.

        Returns
        -------
        array, shape (*size, 4)
        """
        draws, shape = draws_of(rng, size)
        return out(ordered(self._core.draw(draws), order), (*shape, 4), dtype)

    def logpdf(self, q: ArrayLike, *, order: str = "xyzw") -> Any:
        """ln of the density of attitudes (..., 4) with respect to Haar measure: 0 everywhere for the uniform law.

        Less ln 8π² it is the density with respect to small rotation vectors in rad.
        """
        flat, lead = attitudes("q", q, order)
        return out(known(self, "density", self._core.ln_density(flat)), lead)

    @property
    def mean(self) -> NDArray[np.float64]:
        """(4,): the mean attitude, scalar last."""
        return np.array(known(self, "moments", self._core.moments())[0])

    @property
    def cov(self) -> NDArray[np.float64]:
        """(3, 3): the covariance of small rotations about the mean, in rad²."""
        return np.array(known(self, "moments", self._core.moments())[1])

    @staticmethod
    def fit(q: ArrayLike, *, order: str = "xyzw") -> Fit[AttitudeLaw]:
        """A radially constrained Gaussian of attitudes (n, 4), by maximum likelihood.

        The covariance of the turns of the fitted law is ``fit.law.cov``. What ``fit.found`` calls ``turn_covariance_rad2`` is a
        parameter of the law, four times the inverse of the tangent block of Σ⁻¹: it is the covariance of turns that are small where the law
        falls as a Gaussian does, and may be any of wide ones.
        """
        law, found = _core.fit_attitudes(attitudes("q", q, order)[0])
        return Fit(law=make(AttitudeLaw, "of_form", law), found=json.loads(found), fits=None, p_value=None, notes=())

    def __repr__(self) -> str:
        return short(self)


def uniform_attitude() -> AttitudeLaw:
    """All attitudes are equally likely."""
    return make(AttitudeLaw, "of_form", json.dumps({"law": "uniform"}))


def radially_constrained_gaussian(mean: ArrayLike, cov: ArrayLike, *, order: str = "xyzw") -> AttitudeLaw:
    """A Gaussian in the four coordinates of a quaternion, given that its norm is one (Peck 2003).

    Parameters
    ----------
    mean : array_like, shape (4,)
        A quaternion.
    cov : array_like, shape (4, 4)
        Covariance of the four coordinates before the constraint, rows and columns in the order of the quaternion.
    order : {"xyzw", "wxyz"}
        Scalar last, or first.
    """
    same_names(mean=mean, cov=cov)
    matrix, first = numbers("cov", cov), check_order(order)
    if matrix.shape == (4, 4) and first:
        matrix = matrix[np.ix_([1, 2, 3, 0], [1, 2, 3, 0])]
    return make(AttitudeLaw, "gaussian", one_attitude("mean", mean, order), nested("cov", matrix, 4))


def small_rotations(mean: ArrayLike, cov: ArrayLike, *, order: str = "xyzw") -> AttitudeLaw:
    """A radially constrained Gaussian whose small rotations have a covariance (3, 3) in rad².

    A draw is the mean times a small rotation, about the axes that the mean takes components from: body axes, where the attitude is
    that of principal axes. The rotation is twice the vector part of its quaternion, which is the rotation vector where it is small.

    Rotations of more than some 15° about each axis are not small: no more than 180° can be had, and ``law.cov`` is less than what is asked
    for. Of 30° about each axis it has 23°, and it never has more than some 29°.

    Warns
    -----
    UserWarning
        A deviation of the rotations is more than 5 % below what is asked for.
    """
    same_names(cov=cov)
    law = make(AttitudeLaw, "of_small_rotations", one_attitude("mean", mean, order), nested("cov", cov, 3))
    matrix = numbers("cov", cov)
    if matrix.trace() < SMALL**2:
        return law
    asked, frame = np.linalg.eigh(matrix)
    had = np.einsum("ik,ij,jk->k", frame, law.cov, frame)
    short_of = had < 0.95**2 * asked
    if short_of.any():
        degrees = np.degrees(np.sqrt([asked[short_of].max(), had[short_of].max()]))
        warnings.warn(
            f"cov: rotations of {degrees[0]:.3g}° are not small: this law has {degrees[1]:.3g}° there; its cov tells all",
            stacklevel=2,
        )
    return law


def bingham(precision: ArrayLike, *, order: str = "xyzw") -> AttitudeLaw:
    """Bingham's law, with density ∝ exp(-½ qᵀ P q) and P of shape (4, 4)."""
    return fisher_bingham(precision, np.zeros(4), order=order)


def fisher_bingham(precision: ArrayLike, linear: ArrayLike, *, order: str = "xyzw") -> AttitudeLaw:
    """The Fisher-Bingham law, with density ∝ exp(-½ qᵀ P q + bᵀ q), P of shape (4, 4) and b of shape (4,)."""
    same_names(precision=precision, linear=linear)
    matrix, slope, first = numbers("precision", precision), numbers("linear", linear), check_order(order)
    if matrix.shape == (4, 4) and slope.shape == (4,) and first:
        matrix, slope = matrix[np.ix_([1, 2, 3, 0], [1, 2, 3, 0])], slope[[1, 2, 3, 0]]
    return make(AttitudeLaw, "fisher_bingham", nested("precision", matrix, 4), vector("linear", slope, 4))


def fixed_attitude(q: ArrayLike, *, order: str = "xyzw") -> AttitudeLaw:
    """One attitude, which is known.

    As the axes of a body it takes body components to principal components, as ``principal_axes(inertia).attitude`` does. A quaternion
    that goes the other way, such as MuJoCo's ``iquat`` or the pose of an inertial frame in CAD, must be conjugated.

    Examples
    --------
    >>> import numpy as np, gyradius
    >>> iquat = np.array([0.9, 0.1, -0.3, 0.2])  # scalar first, as MuJoCo has it
    >>> axes = gyradius.fixed_attitude(iquat * [1, -1, -1, -1], order="wxyz")
    >>> law = gyradius.InertiaLaw.principal([0.1, 0.2, 0.3], axes)
    >>> own = gyradius.MassProperties(1.0, [0.0, 0.0, 0.0], np.diag([0.13, 0.1, 0.05]))
    >>> bool(np.allclose(law.rvs(rng=7), own.rotated(iquat, order="wxyz").inertia))
    True
    """
    return make(AttitudeLaw, "of_form", json.dumps({"law": "fixed", "attitude": one_attitude("q", q, order)}))


def about_axis(q: ArrayLike, axis: ArrayLike, *, order: str = "xyzw") -> AttitudeLaw:
    """Any turn about a known axis (3,) in body components, from an attitude."""
    return make(AttitudeLaw, "about_axis", one_attitude("q", q, order), vector("axis", axis, 3))
