"""Laws of mass, mass centre and inertia together."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from gyradius import _core
from gyradius._arrays import CENTRE, LOG_CHOLESKY, form, listed, mapping, numbers, out, real, rows, same_names, text, three
from gyradius._attitude_laws import AttitudeLaw
from gyradius._bodies import MassProperties, Region, body_rows
from gyradius._inertia_laws import InertiaLaw
from gyradius._law import Fit, LawOfBodies, Matrix, known, make, of_kind, picture, short, vector
from gyradius._rng import draws_of
from gyradius._scalar_laws import ScalarLaw, law_of, scalar

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from gyradius._arrays import Real, Size
    from gyradius._rng import RNG


class MassPropertiesLaw(LawOfBodies):
    """A law of mass, mass centre and inertia together.

    `gyradius.law` makes one of plain statements, `MassPropertiesLaw.joint` of laws of its parts, `gyradius.from_estimate` of an
    identification, and `fit` of samples. All draw bodies alone, but for `naive`, which is what people do without them.
    """

    __slots__ = ()
    _kind = "Body"

    @staticmethod
    def joint(
        mass: Any,
        centre: Sequence[Any],
        *,
        gyration_lengths: Sequence[Any] | None = None,
        roots: Sequence[Any] | None = None,
        axes: AttitudeLaw | None = None,
        inertia: InertiaLaw | None = None,
        follows: Real | None = None,
        nominal_mass: Real | None = None,
        correlations: Iterable[tuple[str, str, Real]] | None = (),
        inside: Region | None = None,
    ) -> MassPropertiesLaw:
        """Mass, mass centre and inertia from laws of their own, correlated where it is said.

        Parameters
        ----------
        mass : `ScalarLaw` or number
            kg.
        centre : three of them
            m.
        gyration_lengths, roots : three of them
            Radii of gyration in m, with which the inertia follows the mass, or roots of the second moments in √kg·m; about
            principal axes, which have the attitudes of `axes`.
        axes : AttitudeLaw
            Of the attitudes that take body components to principal components, the conjugate of MuJoCo's ``iquat``: see `fixed_attitude`.
        inertia : InertiaLaw
            In their place, any law whose draws are all bodies.
        follows, nominal_mass : float
            The share of the relative change of the mass, from its nominal value, that the inertia takes. With roots or a law of
            the inertia alone.
        correlations : sequence of (str, str, float)
            Between ``"mass"``, ``"centre1"`` to ``"centre3"`` and ``"shape1"`` to ``"shape3"`` (lengths or roots), each of which must
            vary: a number, or a law without a deviation, has no correlation.
        inside : Region
            Where the matter must be possible: draws that are not are drawn again.

        Examples
        --------
        >>> import gyradius
        >>> law = gyradius.MassPropertiesLaw.joint(
        ...     gyradius.normal(2.4, 0.1),
        ...     [gyradius.normal(0.15, 0.003), 0.0, 0.0],
        ...     gyration_lengths=[gyradius.normal(0.12, 0.006), 0.03, 0.02],
        ...     axes=gyradius.uniform_attitude(),
        ...     correlations=[("mass", "shape1", 0.6)],
        ... )
        >>> links = law.rvs(1000, rng=7)
        >>> bool(links.is_realizable.all())
        True
        """
        kinds: list[tuple[str, Any, type]] = [("axes", axes, AttitudeLaw), ("inertia", inertia, InertiaLaw), ("inside", inside, Region)]
        for name, one, kind in kinds:
            if one is not None:
                of_kind(name, one, kind)
        given = [one is not None for one in (gyration_lengths, roots, inertia)]
        if sum(given) != 1:
            raise ValueError("one of gyration_lengths, roots and inertia must be given")
        given_scalars = {"mass": mass, **{f"centre{i + 1}": law for i, law in enumerate(three("centre", centre))}}
        if inertia is not None:
            if axes is not None:
                raise ValueError("axes: a law of the inertia has its own")
            of: dict[str, Any] = {"model": inertia.form}
        else:
            name = "roots" if gyration_lengths is None else "gyration_lengths"
            given_laws = roots if gyration_lengths is None else gyration_lengths
            if axes is None:
                raise ValueError(f"axes: {name} need a law of attitudes")
            shape = three(name, given_laws)
            given_scalars |= {f"shape{i + 1}": law for i, law in enumerate(shape)}
            laws = [scalar(f"{name}[{i}]", law) for i, law in enumerate(shape)]
            of = {name.replace("_", "-"): {"laws": laws, "axes": axes.form}}
        tensor: dict[str, Any] = {"of": of}
        if follows is None and nominal_mass is not None:
            raise ValueError(f"nominal_mass = {nominal_mass!r}: it goes with follows, which is not given")
        if follows is not None:
            if nominal_mass is None:
                raise ValueError("nominal_mass: follows needs it")
            tensor["follows"] = {"share": real("follows", follows), "nominal_mass_kg": real("nominal_mass", nominal_mass)}
        said: dict[str, Any] = {
            "mass_kg": scalar("mass", mass),
            "mass_centre_m": [scalar(f"centre[{i}]", law) for i, law in enumerate(three("centre", centre))],
            "inertia": tensor,
        }
        pairs = [] if correlations is None else listed("correlations", correlations, "pairs with their correlation, each of two names and a number")
        if pairs:
            said["correlations"] = [_pair(f"correlations[{i}]", pair, given_scalars) for i, pair in enumerate(pairs)]
        if inside is not None:
            said["inside"] = inside.form
        return MassPropertiesLaw.of(said)

    @staticmethod
    def of(said: Mapping[str, Any]) -> MassPropertiesLaw:
        """A joint law as it stands in files."""
        return make(MassPropertiesLaw, "joint", form("", mapping("said", said)))

    @staticmethod
    def log_cholesky(mean: MassProperties | ArrayLike, cov: ArrayLike) -> MassPropertiesLaw:
        """A Gaussian in the ten log-Cholesky coordinates, from their covariance (10, 10) and a body, or their mean (10,).

        See `MassProperties.log_cholesky` for the coordinates.
        """
        coordinates = mean.log_cholesky if isinstance(mean, MassProperties) else mean
        same_names(mean=coordinates, cov=cov)
        centre = vector("mean", coordinates, 10, order=LOG_CHOLESKY)
        return make(MassPropertiesLaw, "log_cholesky", centre, Matrix.of("cov", cov, (10, 10), order=LOG_CHOLESKY))

    @staticmethod
    def maximum_entropy(
        mean: MassProperties,
        *,
        mass_delta: Real,
        centre_std: ArrayLike,
        delta: Real,
        inside: Region | None = None,
    ) -> MassPropertiesLaw:
        """Gamma mass, Gaussian mass centre and Wishart second moments per unit of mass (after Batou & Soize 2012).

        `mass_delta` is the relative deviation of the mass, `delta` the dispersion of the second moments, `centre_std` (3,) in m.
        """
        if inside is not None:
            of_kind("inside", inside, Region)
        region = None if inside is None else json.dumps(inside.form)
        each = numbers("centre_std", centre_std, order=CENTRE)
        centre = vector("centre_std", np.broadcast_to(each, (3,)) if each.ndim == 0 else each, 3)
        deltas = real("mass_delta", mass_delta), real("delta", delta)
        return make(MassPropertiesLaw, "maximum_entropy", ten_of("mean", mean), deltas[0], centre, deltas[1], region)

    @staticmethod
    def pseudo_inertia_wishart(mean: MassProperties, degrees_of_freedom: Real) -> MassPropertiesLaw:
        """The Wishart law of the pseudo-inertia about that of a body."""
        freedom = real("degrees_of_freedom", degrees_of_freedom)
        return make(MassPropertiesLaw, "pseudo_inertia_wishart", ten_of("mean", mean), freedom)

    @staticmethod
    def naive(
        nominal: MassProperties, rule: str, law: ScalarLaw, *, mass: ScalarLaw | None = None, centre: ScalarLaw | None = None
    ) -> MassPropertiesLaw:
        """What people do without regard to what bodies there are, to compare with.

        `rule` is ``"diagonal-factors"``, ``"entry-factors"``, ``"principal-factors"``, ``"entry-noise"`` or ``"scale-all"``; each
        random number is drawn anew from `law`. `mass` is a factor of the mass, `centre` is added to the mass centre.
        """
        given = {"law": law, "mass": mass, "centre": centre}
        laws = [json.dumps(law_of(name, one).form) if name == "law" or one is not None else None for name, one in given.items()]
        return make(MassPropertiesLaw, "naive", ten_of("nominal", nominal), text("rule", rule), *laws)

    def rvs(self, size: Size = None, rng: RNG = None) -> MassProperties:
        """Draws, as `MassProperties` of the shape `size`: see `AttitudeLaw.rvs` for `rng`."""
        draws, shape = draws_of(rng, size)
        return MassProperties._of(self._core.draw(draws).reshape(*shape, 10))

    def logpdf(self, bodies: MassProperties | ArrayLike) -> Any:
        """ln of the density with respect to dm d³c d⁶I in kg, m and kg·m², -inf of what no draw can be.

        A mass that does not scatter, and a coordinate of the mass centre that does not, are left out of dm d³c: two laws can be
        compared by it only if the same numbers scatter in both. A `ValueError` if the law has no density that is known.
        """
        flat, lead = rows("bodies", bodies, (10,), of_bodies=True)
        return out(known(self, "density", self._core.ln_density(flat)), lead)

    @property
    def mean(self) -> MassProperties:
        """The mean of the ten numbers."""
        return MassProperties.of(known(self, "moments", self._core.moments())[0])

    @property
    def cov(self) -> NDArray[np.float64]:
        """(10, 10): the covariance of the ten numbers, in the order of `gyradius.COLUMNS`."""
        return np.array(known(self, "moments", self._core.moments())[1]).reshape(10, 10)

    @property
    def linear_moments(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Mean (10,) and covariance (10, 10) of m, m c and the inertia about the origin."""
        mean, cov = known(self, "moments", self._core.linear_moments())
        return np.array(mean), np.array(cov).reshape(10, 10)

    @staticmethod
    def fit(bodies: MassProperties | ArrayLike) -> Fit[MassPropertiesLaw]:
        """The joint law of samples (n, 10), of 13 bodies or more."""
        return MassPropertiesLaw._fit("joint", _core.fit_bodies(body_rows("bodies", bodies)[0]))

    def _repr_html_(self) -> str:
        return picture(self, self.rvs(500, rng=0))

    def __repr__(self) -> str:
        return short(self)


def _pair(name: str, pair: Any, given: Mapping[str, Any]) -> list[Any]:
    """Two names and their correlation; `given` has what was given for each name."""
    if not isinstance(pair, (list, tuple)) or len(pair) != 3:
        raise ValueError(f"{name} = {pair!r}: it must be two names and a number")
    one, other, value = pair
    names = [text(name, one), text(name, other)]
    said = [*names, real(name, value)]
    for fixed in names:
        law = given.get(fixed)
        if law is not None and not isinstance(law, (ScalarLaw, Mapping)):
            raise ValueError(f"{name} = {pair!r}: {fixed} is the number {law!r}, which does not vary: give it a law, or leave the pair away")
    return said


def ten_of(name: str, body: MassProperties) -> tuple[float, ...]:
    """The ten numbers of one body."""
    if not isinstance(body, MassProperties) or body.shape != ():
        raise ValueError(f"{name} = {body!r}: it must be one MassProperties")
    return tuple(body.array.tolist())
