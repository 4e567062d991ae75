"""Laws of the inertia alone."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from gyradius import _core
from gyradius._arrays import INERTIA, form, is_single, mapping, out, own_numbers, rows, same_names, text, three
from gyradius._attitude_laws import AttitudeLaw
from gyradius._inertia import of_rounded
from gyradius._law import Fit, LawOfBodies, Matrix, known, make, of_kind, picture, short, vector
from gyradius._rng import draws_of
from gyradius._scalar_laws import scalar

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, DTypeLike, NDArray

    from gyradius._arrays import Size
    from gyradius._rng import RNG


# A mean that is nearer, in deviations, is the one that was asked for.
_EXACT = 1e-3


class InertiaLaw(LawOfBodies):
    """A law of the inertia of a body about its mass centre: made by `principal`, `about`, `matched` and `fit`.

    The entries have the order 11, 22, 33, 12, 13, 23, in kg·m².
    """

    __slots__ = ()
    _kind = "Inertia"

    @staticmethod
    def principal(roots: Sequence[Any], axes: AttitudeLaw) -> InertiaLaw:
        """Roots of the second moments from three laws of numbers in √kg·m, and principal axes from a law of attitudes
        (Peck 2003): every draw is a body.

        Parameters
        ----------
        roots : sequence of three `ScalarLaw` or numbers
        axes : AttitudeLaw
            Of the attitudes q that take body components to principal components, so that a draw is R(q)ᵀ diag(moments) R(q): see
            `fixed_attitude`.
        """
        of_kind("axes", axes, AttitudeLaw)
        laws = [scalar(f"roots[{i}]", law) for i, law in enumerate(three("roots", roots))]
        said = {"model": "principal", "roots": {"law": "independent", "laws_sqrt_kg_m": laws}, "axes": axes.form}
        return InertiaLaw.of(said)

    @staticmethod
    def of(said: Mapping[str, Any]) -> InertiaLaw:
        """A law as it stands in files."""
        return make(InertiaLaw, "of_form", form("", mapping("said", said)))

    @staticmethod
    def about(kind: str, inertia: ArrayLike, **parameters: Any) -> InertiaLaw:
        """A model by its name about a nominal inertia (3, 3), with the parameters that it has in scenarios.

        ``InertiaLaw.kinds()`` lists the names and what each needs.

        Examples
        --------
        >>> import numpy as np, gyradius
        >>> law = gyradius.InertiaLaw.about("wishart", np.diag([5.0, 4.0, 3.0]), delta=0.1)
        >>> bool(gyradius.is_realizable(law.rvs(100, rng=7)).all())
        True
        """
        flat, lead = rows("inertia", inertia, (3, 3))
        if lead != ():
            raise ValueError("inertia: it must be one matrix, of shape (3, 3)")
        return make(InertiaLaw, "about", text("kind", kind), tuple(flat[0].tolist()), form("", parameters))

    @staticmethod
    def matched(kind: str, mean: ArrayLike, cov: ArrayLike) -> InertiaLaw:
        """The model of a kind whose six entries have this mean (6,) and covariance (6, 6), as far as the kind can.

        `correlated-entries` has them, and `log-cholesky` where such a law is found: of the widest spreads none is, nor of covariances that are
        nearly singular, and a `RuntimeWarning` tells of the law to first order that is taken in its place. What the other kinds have is seen in `mean` and `cov`.
        """
        same_names(mean=mean, cov=cov)
        sought = vector("mean", mean, 6)
        law = make(InertiaLaw, "matched", text("kind", kind), sought, Matrix.of("cov", cov, (6, 6)))
        if kind == "log-cholesky":
            deviations = np.sqrt(np.diag(np.asarray(cov, dtype=float)))
            gap = np.abs(law.mean[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]] - sought)
            off = float(np.max(np.divide(gap, deviations, out=np.zeros(6), where=deviations > 0)))
            if off > _EXACT:
                what = f"no log-cholesky law is found with this mean and covariance: of the one to first order the mean is off by {off:.2g} deviations"
                warnings.warn(what, RuntimeWarning, stacklevel=2)
        return law

    @staticmethod
    def kinds() -> dict[str, dict[str, Any]]:
        """The models by their names: what each is, whether every draw is a body, and which parameters `about` needs."""
        found = _core.InertiaCore.kinds()
        return {
            name: {"description": text, "realizable": realizable, "needs": tuple(needs)}
            for name, text, realizable, needs in found
        }

    def rvs(
        self, size: Size = None, rng: RNG = None, *, dtype: DTypeLike | None = None
    ) -> NDArray[np.floating[Any]]:
        """Draws, shape (*size, 3, 3) in kg·m²: see `AttitudeLaw.rvs` for `rng`."""
        draws, shape = draws_of(rng, size)
        return out(self._core.draw(draws), (*shape, 3, 3), dtype)

    def logpdf(self, inertia: ArrayLike) -> Any:
        """ln of the density of matrices (..., 3, 3) with respect to their six entries in kg·m².

        -inf of what no draw can be. A `ValueError` if the law has no density that is known.
        """
        flat, lead = rows("inertia", inertia, (3, 3))
        return out(known(self, "density", self._core.ln_density(flat)), lead)

    @property
    def mean(self) -> NDArray[np.float64]:
        """(3, 3) in kg·m²."""
        entries = np.array(known(self, "moments", self._core.moments())[0])
        return entries[[0, 3, 4, 3, 1, 5, 4, 5, 2]].reshape(3, 3)

    @property
    def cov(self) -> NDArray[np.float64]:
        """(6, 6): covariance of the entries 11, 22, 33, 12, 13, 23 in (kg·m²)²."""
        return np.array(known(self, "moments", self._core.moments())[1]).reshape(6, 6)

    @staticmethod
    def fit(inertia: ArrayLike) -> Fit[InertiaLaw]:
        """The law of Peck (2003) of samples (n, 3, 3), of 13 bodies or more."""
        given = own_numbers("inertia", inertia, order=INERTIA)
        flat, _ = rows("inertia", given, (3, 3))
        if is_single(given):
            flat = of_rounded(flat.reshape(-1, 3, 3)).reshape(-1, 9)
        return InertiaLaw._fit("of_form", _core.fit_inertias(flat))

    def _repr_html_(self) -> str:
        return picture(self, self.rvs(500, rng=0))

    def __repr__(self) -> str:
        return short(self)
