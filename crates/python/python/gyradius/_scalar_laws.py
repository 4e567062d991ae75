"""Laws of one number."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from gyradius import _core
from gyradius._arrays import form, numbers, out
from gyradius._law import Law, known
from gyradius._rng import draws_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, DTypeLike

    from gyradius._rng import RNG


class ScalarLaw(Law):
    """A law of one number, in the form that it has in scenarios.

    Parameters
    ----------
    law : str
        ``"normal"``, ``"uniform"``, ``"truncated-normal"``, ``"lognormal"``, ``"triangular"``, ``"beta"``,
        ``"weibull"`` or ``"samples"``.
    **keys
        What the law takes: ``mean``, ``sigma``; ``low``, ``high``; ``mode``; ``alpha``, ``beta``; ``scale``, ``shape``;
        ``samples``.

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
        object.__setattr__(self, "_core", _core.ScalarCore.of_form(said))
        object.__setattr__(self, "_made", ("of_form", (said,)))

    @property
    def mean(self) -> float:
        """The mean."""
        return self._core.mean()

    @property
    def std(self) -> float:
        """The standard deviation."""
        return self._core.deviation()

    def rvs(
        self, size: int | tuple[int, ...] | None = None, rng: RNG = None, *, dtype: DTypeLike | None = None
    ) -> Any:
        """Draws of the shape `size`: see `AttitudeLaw.rvs` for `rng`."""
        draws, shape = draws_of(rng, size)
        return out(self._core.draw(draws), shape, dtype)

    def logpdf(self, x: ArrayLike) -> Any:
        """ln of the density; a `ValueError` if the law has none."""
        array = numbers("x", x)
        return out(known(self, "density", self._core.ln_density(np.ascontiguousarray(array).reshape(-1))), array.shape)

    def cdf(self, x: ArrayLike) -> Any:
        """The share of draws that are at most x."""
        array = numbers("x", x)
        return out(self._core.cdf(np.ascontiguousarray(array).reshape(-1)), array.shape)

    def __repr__(self) -> str:
        said = self.form
        keys = "".join(f", {key}={value!r}" for key, value in said.items() if key != "law")
        return f"ScalarLaw({said['law']!r}{keys})"


def normal(mean: float, sigma: float) -> ScalarLaw:
    """A normal law from its mean and standard deviation."""
    return ScalarLaw("normal", mean=float(mean), sigma=float(sigma))


def uniform(low: float, high: float) -> ScalarLaw:
    """All numbers between two are equally likely."""
    return ScalarLaw("uniform", low=float(low), high=float(high))


def scalar(name: str, value: ScalarLaw | float | Mapping[str, Any]) -> dict[str, Any]:
    """A law of a number, or a number that is known, in the form of files."""
    if isinstance(value, ScalarLaw):
        return value.form
    if isinstance(value, Mapping):
        return ScalarLaw(**value).form
    try:
        return normal(float(value), 0.0).form
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} = {value!r}: it must be a number or a ScalarLaw ({error})") from None
