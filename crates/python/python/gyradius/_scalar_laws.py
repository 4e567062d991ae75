"""Laws of one number."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from gyradius import _core
from gyradius._arrays import form, numbers, out, real
from gyradius._law import Law, known
from gyradius._rng import draws_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, DTypeLike, NDArray

    from gyradius._arrays import Real, Size
    from gyradius._rng import RNG


class ScalarLaw(Law):
    """A law of one number, in the form that it has in scenarios.

    Parameters
    ----------
    law : str
        ``"normal"``, ``"uniform"``, ``"truncated-normal"``, ``"lognormal"``, ``"triangular"``, ``"beta"``,
        ``"weibull"``, ``"samples"`` or ``"bernoulli"``.
    **keys
        What the law takes: ``mean``, ``sigma``; ``low``, ``high``; ``mode``; ``alpha``, ``beta``; ``scale``, ``shape``;
        ``samples``; ``probability``.

    Examples
    --------
    >>> import gyradius
    >>> law = gyradius.ScalarLaw("triangular", low=1.0, mode=2.0, high=6.0)
    >>> law.mean
    3.0
    >>> bool(1.0 <= law.rvs(rng=7) <= 6.0)
    True
    """

    __slots__ = ()
    _kind = "Scalar"

    def __init__(self, law: str, **keys: Any) -> None:
        said = form("", {"law": law, **keys})
        core = _core.ScalarCore.of_form(said)
        object.__setattr__(self, "_core", core)
        # Equal laws say the same, however they were said.
        object.__setattr__(self, "_made", ("of_form", (core.form(),)))

    @property
    def mean(self) -> float:
        """The mean."""
        return self._core.mean()

    @property
    def std(self) -> float:
        """The standard deviation."""
        return self._core.deviation()

    def rvs(
        self, size: Size = None, rng: RNG = None, *, dtype: DTypeLike | None = None
    ) -> Any:
        """Draws of the shape `size`: see `AttitudeLaw.rvs` for `rng`."""
        draws, shape = draws_of(rng, size)
        return out(self._core.draw(draws), shape, dtype)

    def logpdf(self, x: ArrayLike) -> Any:
        """ln of the density, NaN of NaN; a `ValueError` if the law has none."""
        array = numbers("x", x)
        flat = np.ascontiguousarray(array).reshape(-1)
        found = known(self, "density", self._core.ln_density(flat))
        return out(np.where(np.isnan(flat), np.nan, found), array.shape)

    def cdf(self, x: ArrayLike) -> Any:
        """The share of draws that are at most x; NaN of NaN."""
        return _of_each("x", x, self._core.cdf)

    def sf(self, x: ArrayLike) -> Any:
        """The share of draws that are greater than x: 1 - cdf, without cancellation far out."""
        return _of_each("x", x, self._core.share_above)

    def ppf(self, q: ArrayLike) -> Any:
        """The smallest number that a share q of draws does not exceed: the inverse of `cdf`.

        The bounds of the law at 0 and 1, infinite or not; NaN outside of these.

        Examples
        --------
        >>> import gyradius
        >>> gyradius.uniform(2.0, 4.0).ppf([0.0, 0.25, 1.0]).tolist()
        [2.0, 2.5, 4.0]
        """
        return _of_each("q", q, self._core.quantile)

    def __repr__(self) -> str:
        said = self.form
        keys = "".join(f", {key}={value!r}" for key, value in said.items() if key != "law")
        return f"ScalarLaw({said['law']!r}{keys})"


def _of_each(name: str, value: ArrayLike, of: Callable[[NDArray[np.float64]], NDArray[np.float64]]) -> Any:
    array = numbers(name, value)
    return out(of(np.ascontiguousarray(array).reshape(-1)), array.shape)


def normal(mean: Real, sigma: Real) -> ScalarLaw:
    """A normal law from its mean and standard deviation."""
    return ScalarLaw("normal", mean=real("mean", mean), sigma=real("sigma", sigma))


def uniform(low: Real, high: Real) -> ScalarLaw:
    """All numbers between two are equally likely."""
    return ScalarLaw("uniform", low=real("low", low), high=real("high", high))


def scalar(name: str, value: ScalarLaw | Real | Mapping[str, Any]) -> dict[str, Any]:
    """A law of a number, or a number that is known, in the form of files."""
    try:
        if isinstance(value, Mapping):
            return json.loads(_core.ScalarCore.of_form(form("", value)).form())
        return value.form if isinstance(value, ScalarLaw) else normal(real(name, value), 0.0).form
    except ValueError as error:
        raise ValueError(f"{name} = {value!r}: it must be a number or a ScalarLaw: {error}") from None


def law_of(name: str, value: object) -> ScalarLaw:
    """A law of a number."""
    if not isinstance(value, ScalarLaw):
        raise ValueError(f"{name} = {value!r}: it must be a ScalarLaw")
    return value
