"""Laws of numbers, attitudes, inertias and bodies: frozen objects in the manner of `scipy.stats`."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Generic, Literal, NamedTuple, TypeVar

import numpy as np

from gyradius import _core
from gyradius._arrays import attitudes, form, numbers, ordered, out, rows
from gyradius._bodies import MassProperties, Region
from gyradius._rng import streams

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, DTypeLike, NDArray

    from gyradius._rng import RNG

L = TypeVar("L", bound="Law")


class Law:
    """What all laws have in common: they do not change, and are equal if they are made alike."""

    __slots__ = ("_core", "_made")

    _core: Any
    _made: tuple[str, tuple[Any, ...]]

    @classmethod
    def _of(cls: type[L], core: Any, how: str, *arguments: Any) -> L:
        law = object.__new__(cls)
        object.__setattr__(law, "_core", core)
        object.__setattr__(law, "_made", (how, arguments))
        return law

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{name}: a law does not change")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"{name}: a law does not change")

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (type(self), *self._made)

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return self._made == other._made

    def __hash__(self) -> int:
        return hash((type(self), repr(self._made)))

    @property
    def form(self) -> dict[str, Any]:
        """The law as it stands in files, JSON and scenarios."""
        found = self._core.form()
        if found is None:
            raise ValueError(f"{self!r} has no form in files")
        return json.loads(found)


def _again(kind: type[Law], how: str, arguments: tuple[Any, ...]) -> Law:
    """A law from how it was made, for pickles."""
    core = getattr(getattr(_core, f"{kind._kind}Core"), how)(*map(_given, arguments))  # type: ignore[attr-defined]
    return kind._of(core[0] if isinstance(core, tuple) else core, how, *arguments)


def _make(kind: type[L], how: str, *arguments: Any) -> L:
    return _again(kind, how, arguments)  # type: ignore[return-value]


def _given(argument: Any) -> Any:
    """Matrices are kept as nested tuples, so that laws can be compared, and given as arrays where rows are asked for."""
    if isinstance(argument, _Matrix):
        return np.array(argument)
    return argument


class _Matrix(tuple):  # type: ignore[type-arg]
    __slots__ = ()

    @classmethod
    def of(cls, name: str, value: ArrayLike, shape: tuple[int, ...]) -> _Matrix:
        flat, lead = rows(name, value, shape)
        if lead != ():
            raise ValueError(f"{name}: its shape is {np.shape(value)}, and it must be {shape}")
        return cls(map(tuple, flat.reshape(shape).tolist()))


def _vector(name: str, value: ArrayLike, size: int) -> tuple[float, ...]:
    flat, lead = rows(name, value, (size,))
    if lead != ():
        raise ValueError(f"{name}: its shape is {np.shape(value)}, and it must be ({size},)")
    return tuple(flat[0].tolist())


def _nested(name: str, value: ArrayLike, size: int) -> tuple[tuple[float, ...], ...]:
    return tuple(_Matrix.of(name, value, (size, size)))


def _one_attitude(name: str, value: ArrayLike, order: str) -> tuple[float, ...]:
    flat, lead = attitudes(name, value, order)
    if lead != ():
        raise ValueError(f"{name}: it must be one quaternion, of shape (4,)")
    return tuple(flat[0].tolist())


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
        stream, places, shape = streams(rng, size)
        return out(self._core.draw(stream, _count(shape), places), shape, dtype)

    def logpdf(self, x: ArrayLike) -> Any:
        """ln of the density; a `ValueError` if the law has none."""
        array = numbers("x", x)
        return out(_known(self, self._core.ln_density(np.ascontiguousarray(array).reshape(-1))), array.shape)

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


def _scalar(name: str, value: ScalarLaw | float | Mapping[str, Any]) -> dict[str, Any]:
    """A law of a number, or a number that is known, in the form of files."""
    if isinstance(value, ScalarLaw):
        return value.form
    if isinstance(value, Mapping):
        return ScalarLaw(**value).form
    try:
        return normal(float(value), 0.0).form
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} = {value!r}: it must be a number or a ScalarLaw ({error})") from None


class AttitudeLaw(Law):
    """A law of attitudes: made by `uniform_attitude`, `radially_constrained_gaussian`, `small_rotations`, `bingham`,
    `fisher_bingham`, `fixed_attitude` and `about_axis`.

    Quaternions are unit quaternions of which q and -q are the same attitude. Where an attitude is that of principal axes, it
    takes body components to principal components.
    """

    __slots__ = ()
    _kind = "Attitude"

    def rvs(
        self,
        size: int | tuple[int, ...] | None = None,
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
        stream, places, shape = streams(rng, size)
        return out(ordered(self._core.draw(stream, _count(shape), places), order), (*shape, 4), dtype)

    def logpdf(self, q: ArrayLike, *, order: str = "xyzw") -> Any:
        """ln of the density of attitudes (..., 4) with respect to Haar measure: 0 everywhere for the uniform law.

        Less ln 8π² it is the density with respect to small rotation vectors in rad.
        """
        flat, lead = attitudes("q", q, order)
        return out(_known(self, self._core.ln_density(flat)), lead)

    @property
    def mean(self) -> NDArray[np.float64]:
        """(4,): the mean attitude, scalar last."""
        return np.array(_known(self, self._core.moments())[0])

    @property
    def cov(self) -> NDArray[np.float64]:
        """(3, 3): the covariance of small rotations about the mean, in rad²."""
        return np.array(_known(self, self._core.moments())[1])

    @staticmethod
    def fit(q: ArrayLike, *, order: str = "xyzw") -> Fit[AttitudeLaw]:
        """A radially constrained Gaussian of attitudes (n, 4), by maximum likelihood."""
        law, found = _core.fit_attitudes(attitudes("q", q, order)[0])
        return Fit(law=_make(AttitudeLaw, "of_form", law), found=json.loads(found), fits=None, p_value=None, notes=())

    def __repr__(self) -> str:
        return _repr(self)


def uniform_attitude() -> AttitudeLaw:
    """All attitudes are equally likely."""
    return _make(AttitudeLaw, "of_form", json.dumps({"law": "uniform"}))


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
    matrix = numbers("cov", cov)
    if matrix.shape == (4, 4) and order == "wxyz":
        matrix = matrix[np.ix_([1, 2, 3, 0], [1, 2, 3, 0])]
    return _make(AttitudeLaw, "gaussian", _one_attitude("mean", mean, order), _nested("cov", matrix, 4))


def small_rotations(mean: ArrayLike, cov: ArrayLike, *, order: str = "xyzw") -> AttitudeLaw:
    """A radially constrained Gaussian whose small rotations about the mean have a covariance (3, 3) in rad²."""
    return _make(AttitudeLaw, "of_small_rotations", _one_attitude("mean", mean, order), _nested("cov", cov, 3))


def bingham(precision: ArrayLike, *, order: str = "xyzw") -> AttitudeLaw:
    """Bingham's law, with density ∝ exp(-½ qᵀ P q) and P of shape (4, 4)."""
    return fisher_bingham(precision, np.zeros(4), order=order)


def fisher_bingham(precision: ArrayLike, linear: ArrayLike, *, order: str = "xyzw") -> AttitudeLaw:
    """The Fisher-Bingham law, with density ∝ exp(-½ qᵀ P q + bᵀ q), P of shape (4, 4) and b of shape (4,)."""
    matrix, vector = numbers("precision", precision), numbers("linear", linear)
    if matrix.shape == (4, 4) and vector.shape == (4,) and order == "wxyz":
        matrix, vector = matrix[np.ix_([1, 2, 3, 0], [1, 2, 3, 0])], vector[[1, 2, 3, 0]]
    return _make(AttitudeLaw, "fisher_bingham", _nested("precision", matrix, 4), _vector("linear", vector, 4))


def fixed_attitude(q: ArrayLike, *, order: str = "xyzw") -> AttitudeLaw:
    """One attitude, which is known."""
    return _make(AttitudeLaw, "of_form", json.dumps({"law": "fixed", "attitude": _one_attitude("q", q, order)}))


def about_axis(q: ArrayLike, axis: ArrayLike, *, order: str = "xyzw") -> AttitudeLaw:
    """Any turn about a known axis (3,) in body components, from an attitude."""
    return _make(AttitudeLaw, "about_axis", _one_attitude("q", q, order), _vector("axis", axis, 3))


class InertiaLaw(Law):
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
            One that has a form in files: not a Fisher-Bingham law, nor turns about an axis.
        """
        if len(roots) != 3:
            raise ValueError(f"roots: {len(roots)} laws, and there must be 3")
        laws = [_scalar(f"roots[{i}]", law) for i, law in enumerate(roots)]
        said = {"model": "principal", "roots": {"law": "independent", "laws_sqrt_kg_m": laws}, "axes": axes.form}
        return InertiaLaw.of(said)

    @staticmethod
    def of(said: Mapping[str, Any]) -> InertiaLaw:
        """A law as it stands in files."""
        return _make(InertiaLaw, "of_form", form("", said))

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
        return _make(InertiaLaw, "about", kind, tuple(flat[0].tolist()), form("", parameters))

    @staticmethod
    def matched(kind: str, mean: ArrayLike, cov: ArrayLike) -> InertiaLaw:
        """The model of a kind whose six entries have this mean (6,) and covariance (6, 6), as far as the kind can."""
        return _make(InertiaLaw, "matched", kind, _vector("mean", mean, 6), _Matrix.of("cov", cov, (6, 6)))

    @staticmethod
    def kinds() -> dict[str, dict[str, Any]]:
        """The models by their names: what each is, whether every draw is a body, and which parameters `about` needs."""
        found = _core.InertiaCore.kinds()
        return {
            name: {"description": text, "realizable": realizable, "needs": tuple(needs)}
            for name, text, realizable, needs in found
        }

    def rvs(
        self, size: int | tuple[int, ...] | None = None, rng: RNG = None, *, dtype: DTypeLike | None = None
    ) -> NDArray[np.floating[Any]]:
        """Draws, shape (*size, 3, 3) in kg·m²: see `AttitudeLaw.rvs` for `rng`."""
        stream, places, shape = streams(rng, size)
        return out(self._core.draw(stream, _count(shape), places), (*shape, 3, 3), dtype)

    def logpdf(self, inertia: ArrayLike) -> Any:
        """ln of the density of matrices (..., 3, 3) with respect to their six entries in kg·m².

        -inf of what no draw can be. A `ValueError` if the law has no density that is known.
        """
        flat, lead = rows("inertia", inertia, (3, 3))
        return out(_known(self, self._core.ln_density(flat)), lead)

    @property
    def mean(self) -> NDArray[np.float64]:
        """(3, 3) in kg·m²."""
        entries = np.array(_known(self, self._core.moments())[0])
        return entries[[0, 3, 4, 3, 1, 5, 4, 5, 2]].reshape(3, 3)

    @property
    def cov(self) -> NDArray[np.float64]:
        """(6, 6): covariance of the entries 11, 22, 33, 12, 13, 23 in (kg·m²)²."""
        return np.array(_known(self, self._core.moments())[1]).reshape(6, 6)

    @property
    def std(self) -> NDArray[np.float64]:
        """(6,): standard deviations of the entries in kg·m²."""
        return np.sqrt(np.diag(self.cov))

    @property
    def name(self) -> str:
        """What the model is called in scenarios."""
        return self._core.name()

    @property
    def is_realizable(self) -> bool:
        """Whether no draw can be of no body, whatever is drawn."""
        return self._core.is_realizable_by_construction()

    @property
    def acceptance(self) -> float:
        """The share of proposals that are kept: 1 where there is no rejection."""
        found = self._core.acceptance()
        return 1.0 if found is None else found

    @staticmethod
    def fit(inertia: ArrayLike) -> Fit[InertiaLaw]:
        """The law of Peck (2003) of samples (n, 3, 3), of 13 bodies or more."""
        law, found, fits, p_value, notes = _core.fit_inertias(rows("inertia", inertia, (3, 3))[0])
        made = _make(InertiaLaw, "of_form", law)
        return Fit(law=made, found=json.loads(found), fits=fits, p_value=p_value, notes=tuple(notes))

    def _repr_html_(self) -> str:
        return _picture(self, self.rvs(500, rng=0))

    def __repr__(self) -> str:
        return _repr(self)


class MassPropertiesLaw(Law):
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
        follows: float | None = None,
        nominal_mass: float | None = None,
        correlations: Sequence[tuple[str, str, float]] = (),
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
        inertia : InertiaLaw
            In their place, any law whose draws are all bodies.
        follows, nominal_mass : float
            The share of the relative change of the mass, from its nominal value, that the inertia takes. With roots or a law of
            the inertia alone.
        correlations : sequence of (str, str, float)
            Between ``"mass"``, ``"centre1"`` to ``"centre3"`` and ``"shape1"`` to ``"shape3"`` (lengths or roots).
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
        given = [one is not None for one in (gyration_lengths, roots, inertia)]
        if sum(given) != 1:
            raise ValueError("one of gyration_lengths, roots and inertia must be given")
        if inertia is not None:
            if axes is not None:
                raise ValueError("axes: a law of the inertia has its own")
            of: dict[str, Any] = {"model": inertia.form}
        else:
            name = "roots" if gyration_lengths is None else "gyration_lengths"
            three: Sequence[Any] = roots if gyration_lengths is None else gyration_lengths  # type: ignore[assignment]
            if axes is None:
                raise ValueError(f"axes: {name} need a law of attitudes")
            if len(three) != 3:
                raise ValueError(f"{name}: {len(three)} laws, and there must be 3")
            laws = [_scalar(f"{name}[{i}]", law) for i, law in enumerate(three)]
            of = {name.replace("_", "-"): {"laws": laws, "axes": axes.form}}
        tensor: dict[str, Any] = {"of": of}
        if follows is not None:
            if nominal_mass is None:
                raise ValueError("nominal_mass: follows needs it")
            tensor["follows"] = {"share": float(follows), "nominal_mass_kg": float(nominal_mass)}
        if len(centre) != 3:
            raise ValueError(f"centre: {len(centre)} laws, and there must be 3")
        said: dict[str, Any] = {
            "mass_kg": _scalar("mass", mass),
            "mass_centre_m": [_scalar(f"centre[{i}]", law) for i, law in enumerate(centre)],
            "inertia": tensor,
        }
        if correlations:
            said["correlations"] = [[one, other, float(value)] for one, other, value in correlations]
        if inside is not None:
            said["inside"] = inside.form
        return MassPropertiesLaw.of(said)

    @staticmethod
    def of(said: Mapping[str, Any]) -> MassPropertiesLaw:
        """A joint law as it stands in files."""
        return _make(MassPropertiesLaw, "joint", form("", said))

    @staticmethod
    def log_cholesky(mean: MassProperties | ArrayLike, cov: ArrayLike) -> MassPropertiesLaw:
        """A Gaussian in the ten log-Cholesky coordinates, from their covariance (10, 10) and a body, or their mean (10,).

        See `MassProperties.log_cholesky` for the coordinates.
        """
        coordinates = mean.log_cholesky if isinstance(mean, MassProperties) else mean
        return _make(MassPropertiesLaw, "log_cholesky", _vector("mean", coordinates, 10), _Matrix.of("cov", cov, (10, 10)))

    @staticmethod
    def maximum_entropy(
        mean: MassProperties,
        *,
        mass_delta: float,
        centre_std: ArrayLike,
        delta: float,
        inside: Region | None = None,
    ) -> MassPropertiesLaw:
        """Gamma mass, Gaussian mass centre and Wishart second moments per unit of mass (after Batou & Soize 2012).

        `mass_delta` is the relative deviation of the mass, `delta` the dispersion of the second moments, `centre_std` (3,) in m.
        """
        region = None if inside is None else json.dumps(inside.form)
        centre = _vector("centre_std", np.broadcast_to(numbers("centre_std", centre_std), (3,)), 3)
        return _make(MassPropertiesLaw, "maximum_entropy", _ten(mean), float(mass_delta), centre, float(delta), region)

    @staticmethod
    def pseudo_inertia_wishart(mean: MassProperties, degrees_of_freedom: float) -> MassPropertiesLaw:
        """The Wishart law of the pseudo-inertia about that of a body."""
        return _make(MassPropertiesLaw, "pseudo_inertia_wishart", _ten(mean), float(degrees_of_freedom))

    @staticmethod
    def naive(
        nominal: MassProperties, rule: str, law: ScalarLaw, *, mass: ScalarLaw | None = None, centre: ScalarLaw | None = None
    ) -> MassPropertiesLaw:
        """What people do without regard to what bodies there are, to compare with.

        `rule` is ``"diagonal-factors"``, ``"entry-factors"``, ``"principal-factors"``, ``"entry-noise"`` or ``"scale-all"``; each
        random number is drawn anew from `law`. `mass` is a factor of the mass, `centre` is added to the mass centre.
        """
        laws = [None if one is None else json.dumps(one.form) for one in (law, mass, centre)]
        return _make(MassPropertiesLaw, "naive", _ten(nominal), rule, *laws)

    def rvs(self, size: int | tuple[int, ...] | None = None, rng: RNG = None) -> MassProperties:
        """Draws, as `MassProperties` of the shape `size`: see `AttitudeLaw.rvs` for `rng`."""
        stream, places, shape = streams(rng, size)
        return MassProperties._of(self._core.draw(stream, _count(shape), places).reshape(*shape, 10))

    def logpdf(self, bodies: MassProperties | ArrayLike) -> Any:
        """ln of the density with respect to dm d³c d⁶I in kg, m and kg·m², -inf of what no draw can be.

        A `ValueError` if the law has no density that is known.
        """
        flat, lead = rows("bodies", bodies, (10,))
        return out(_known(self, self._core.ln_density(flat)), lead)

    @property
    def mean(self) -> MassProperties:
        """The mean of the ten numbers."""
        return MassProperties.of(_known(self, self._core.moments())[0])

    @property
    def cov(self) -> NDArray[np.float64]:
        """(10, 10): the covariance of the ten numbers, in the order of `gyradius.COLUMNS`."""
        return np.array(_known(self, self._core.moments())[1]).reshape(10, 10)

    @property
    def std(self) -> NDArray[np.float64]:
        """(10,): the standard deviations of the ten numbers."""
        return np.sqrt(np.diag(self.cov))

    @property
    def linear_moments(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Mean (10,) and covariance (10, 10) of m, m c and the inertia about the origin."""
        mean, cov = _known(self, self._core.linear_moments())
        return np.array(mean), np.array(cov).reshape(10, 10)

    @property
    def name(self) -> str:
        """What kind of law it is."""
        return self._core.name()

    @property
    def is_realizable(self) -> bool:
        """Whether no draw can be of no body, whatever is drawn."""
        return self._core.is_realizable_by_construction()

    @property
    def acceptance(self) -> float:
        """The share of proposals that are kept: 1 where there is no rejection."""
        found = self._core.acceptance()
        return 1.0 if found is None else found

    @staticmethod
    def fit(bodies: MassProperties | ArrayLike) -> Fit[MassPropertiesLaw]:
        """The joint law of samples (n, 10), of 13 bodies or more."""
        law, found, fits, p_value, notes = _core.fit_bodies(rows("bodies", bodies, (10,))[0])
        made = _make(MassPropertiesLaw, "joint", law)
        return Fit(law=made, found=json.loads(found), fits=fits, p_value=p_value, notes=tuple(notes))

    def _repr_html_(self) -> str:
        return _picture(self, self.rvs(500, rng=0).inertia)

    def __repr__(self) -> str:
        return _repr(self)


class Fit(Generic[L]):
    """What was fitted to samples."""

    __slots__ = ("fits", "found", "law", "notes", "p_value")

    def __init__(
        self, law: L, found: dict[str, Any], fits: bool | None, p_value: float | None, notes: tuple[str, ...]
    ) -> None:
        self.law = law
        """The law."""
        self.found = found
        """Estimates and their standard errors, by name."""
        self.fits = fits
        """Whether nothing speaks against the law at 1 %; None where it was not tested."""
        self.p_value = p_value
        """How likely samples of the law are as far from it as these."""
        self.notes = notes
        """What was noticed, in words."""

    def __repr__(self) -> str:
        said = "" if self.fits is None else f", fits={self.fits}, p_value={self.p_value:.3g}"
        return f"<Fit of {self.law!r}{said}>"


class Estimate(NamedTuple):
    """The laws of bodies that are as near as can be to an estimate of the ten parameters."""

    law: MassPropertiesLaw
    """The nearer of the two below."""
    nearest: MassProperties
    """The nearest body to the mean, in the metric of the covariance."""
    moved: float
    """How far that is, in standard deviations: 0 if the mean is that of a body."""
    joint: MassPropertiesLaw | None
    """Of mass, mass centre, gyration lengths and axes."""
    joint_distance: dict[str, Any] | None
    """How far its moments are from those of the estimate."""
    log_cholesky: MassPropertiesLaw | None
    """A Gaussian in the log-Cholesky coordinates."""
    log_cholesky_distance: dict[str, Any] | None
    """How far its moments are from those of the estimate."""


def from_estimate(phi: ArrayLike, cov: ArrayLike, *, form: Literal["linear", "natural"] = "linear") -> Estimate:
    """The laws of bodies with the mean and covariance of an estimate, as nearly as any have them.

    Parameters
    ----------
    phi : array_like, shape (10,)
        The estimate; it may be that of no body.
    cov : array_like, shape (10, 10)
        Its covariance.
    form : {"linear", "natural"}
        ``"linear"``: m, m c, and the inertia about the origin, as identification gives them. ``"natural"``: mass, mass centre, and
        the inertia about it.
    """
    if form not in ("linear", "natural"):
        raise ValueError(f'form = {form!r}: it must be "linear" or "natural"')
    covariance = np.array(_Matrix.of("cov", cov, (10, 10)))
    nearest, moved, joint, log_cholesky = _core.from_estimate(_vector("phi", phi, 10), covariance, form == "linear")
    laws: list[tuple[MassPropertiesLaw | None, dict[str, Any] | None]] = []
    laws.append((None, None) if joint is None else (_make(MassPropertiesLaw, "joint", joint[0]), json.loads(joint[1])))
    if log_cholesky is None:
        laws.append((None, None))
    else:
        mean, flat, distance = log_cholesky
        made = MassPropertiesLaw.log_cholesky(mean, np.reshape(flat, (10, 10)))
        laws.append((made, json.loads(distance)))
    known = [(law, distance) for law, distance in laws if law is not None and distance is not None]
    if not known:
        raise ValueError("no law of bodies is near the estimate")
    best = min(known, key=lambda one: (not one[1]["is_exact"], one[1]["mahalanobis"] + one[1]["correlation"]))
    return Estimate(best[0], MassProperties.of(nearest), moved, *laws[0], *laws[1])


def law(
    body: MassProperties,
    *,
    mass: Any = None,
    centre: Any = None,
    moments: Any = None,
    products: Any = None,
    axes: Any = None,
    inside: Region | None = None,
    sigmas: float = 1.0,
) -> StatedLaw:
    """The law of mass, mass centre and inertia that plain statements make about a body.

    A statement more does not change what the others draw. What nothing is said of stays as it is, but the inertia follows the
    mass. Every draw is a body.

    Parameters
    ----------
    body : MassProperties
        One body: the nominal one.
    mass : str
        ± ``"5%"``, ``"0.2kg"`` or ``"30g"``.
    centre : str
        Along each axis, ± ``"1cm"``, ``"5mm"`` or ``"0.01m"``, or three of them, ``"5mm, 5mm, 2cm"``.
    moments : str
        Of inertia about the axes of the body, ± ``"10%"`` or ``"0.3kgm2"``, or three; what the mass does to them is a part.
    products : str
        Of inertia, ± ``"0.01kgm2"``, or three, of 12, 13 and 23.
    axes : str
        The rotation about each principal axis, ± ``"2deg"`` or ``"0.03rad"``, or three.
    inside : Region
        Where all matter must be possible: `box`, `ellipsoid` or `hull`.
    sigmas : float
        How many standard deviations ± stands for in all of these.

    Each statement may also be a dict as in the file of `gyradius model`, such as ``{"percent": 10, "sigmas": 3}``.

    Returns
    -------
    StatedLaw
        A `MassPropertiesLaw` with `warnings`: what cannot be had, and why.

    Examples
    --------
    >>> import numpy as np, gyradius
    >>> link = gyradius.MassProperties(2.0, [0.1, 0.0, 0.0], np.diag([0.002, 0.01, 0.011]))
    >>> law = gyradius.law(link, mass="5%", centre="1cm", moments="10%", axes="2deg")
    >>> draws = law.rvs(4096, rng=7)
    >>> draws.inertia.shape, bool(draws.is_realizable.all())
    ((4096, 3, 3), True)
    """
    if not isinstance(body, MassProperties) or body.shape != ():
        raise ValueError("body: it must be one MassProperties")

    def said(name: str, value: Any) -> str | None:
        if value is None:
            return None
        if isinstance(value, (list, tuple)) and all(isinstance(one, str) for one in value):
            value = ",".join(value)
        if isinstance(value, (str, Mapping)):
            return form(name, value)
        raise ValueError(f'{name} = {value!r}: it must be a text with a unit, such as "5%", or a dict as in a file')

    core, warnings = _core.stated_law(
        _ten(body),
        said("mass", mass),
        said("centre", centre),
        said("moments", moments),
        said("products", products),
        said("axes", axes),
        float(sigmas),
        None if inside is None else json.dumps(inside.form),
    )
    made = StatedLaw._of(core, "joint", core.form())
    object.__setattr__(made, "_warnings", tuple(warnings))
    return made


class StatedLaw(MassPropertiesLaw):
    """The law of mass, mass centre and inertia that statements make: see `gyradius.law`."""

    __slots__ = ("_warnings",)

    _warnings: tuple[str, ...]

    @property
    def warnings(self) -> tuple[str, ...]:
        """What of the statements cannot be had, and why, and what was left open."""
        return self._warnings

    def __reduce__(self) -> tuple[Any, ...]:
        return _stated_again, (*self._made[1], self._warnings)


def _stated_again(form: str, warnings: tuple[str, ...]) -> StatedLaw:
    made = StatedLaw._of(_core.BodyCore.joint(form), "joint", form)
    object.__setattr__(made, "_warnings", warnings)
    return made


def _ten(body: MassProperties) -> tuple[float, ...]:
    if not isinstance(body, MassProperties) or body.shape != ():
        raise ValueError("it must be one MassProperties")
    return tuple(body.array.tolist())


def _count(shape: tuple[int, ...]) -> int:
    count = 1
    for one in shape:
        count *= one
    if count > 2**48:
        raise ValueError(f"size = {shape}: too many")
    return count


def _known(law: Law, value: Any) -> Any:
    if value is None:
        raise ValueError(f"it is not known of {law!r}")
    return value


def _picture(law: InertiaLaw | MassPropertiesLaw, inertia: NDArray[Any]) -> str:
    from gyradius._figure import triangle

    return triangle([(f"{type(law).__name__} {law.name}", inertia)], repr(law))


def _repr(law: Law) -> str:
    how, arguments = law._made
    short = ", ".join(text if len(text) < 60 else text[:57] + "..." for text in map(repr, arguments))
    return f"<{type(law).__name__} {how}({short})>"


__all__ = [
    "AttitudeLaw",
    "Estimate",
    "Fit",
    "InertiaLaw",
    "Law",
    "MassPropertiesLaw",
    "ScalarLaw",
    "StatedLaw",
    "about_axis",
    "bingham",
    "fisher_bingham",
    "fixed_attitude",
    "from_estimate",
    "law",
    "normal",
    "radially_constrained_gaussian",
    "small_rotations",
    "uniform",
    "uniform_attitude",
]
