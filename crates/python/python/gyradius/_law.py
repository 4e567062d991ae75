"""What all laws have in common: frozen objects in the manner of `scipy.stats`."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np

from gyradius import _core
from gyradius._arrays import attitudes, rows

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


L = TypeVar("L", bound="Law")


class Law:
    """What all laws have in common: they do not change, and are equal if they are made alike."""

    __slots__ = ("_core", "_made")

    _core: Any
    _made: tuple[str, tuple[Any, ...]]

    def __init__(self) -> None:
        raise TypeError(f"laws are made by functions: see help(gyradius.{type(self).__name__})")

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
        return again, (type(self), *self._made)

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return self._made == other._made

    def __hash__(self) -> int:
        # Zero and minus zero are equal.
        return hash((type(self), repr(self._made).replace("-0.0", "0.0")))

    @property
    def form(self) -> dict[str, Any]:
        """The law as it stands in files, JSON and scenarios."""
        found = self._core.form()
        if found is None:
            raise ValueError(f"{self!r} has no form in files")
        return json.loads(found)


class LawOfBodies(Law):
    """What laws of inertias and laws of bodies have in common."""

    __slots__ = ()

    @property
    def cov(self) -> NDArray[np.float64]:
        """The covariance of what is drawn."""
        raise NotImplementedError

    @property
    def std(self) -> NDArray[np.float64]:
        """The standard deviations of the numbers of which `cov` is the covariance."""
        return np.sqrt(np.diag(self.cov))

    @property
    def name(self) -> str:
        """What kind of law it is; of a model of the inertia what it is called in scenarios."""
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

    @classmethod
    def _fit(cls: type[L], how: str, fitted: tuple[str, str, bool, float, list[str]]) -> Fit[L]:
        law, found, fits, p_value, notes = fitted
        return Fit(make(cls, how, law), json.loads(found), fits, p_value, tuple(notes))


def again(kind: type[Law], how: str, arguments: tuple[Any, ...]) -> Law:
    """A law from how it was made, for pickles."""
    core = getattr(getattr(_core, f"{kind._kind}Core"), how)(*map(given, arguments))  # type: ignore[attr-defined]
    return kind._of(core, how, *arguments)


def make(kind: type[L], how: str, *arguments: Any) -> L:
    """A law by what the compiled part calls the way to make it."""
    return again(kind, how, arguments)  # type: ignore[return-value]


def given(argument: Any) -> Any:
    """Matrices are kept as nested tuples, so that laws can be compared, and given as arrays where rows are asked for."""
    if isinstance(argument, Matrix):
        return np.array(argument)
    return argument


class Matrix(tuple):  # type: ignore[type-arg]
    """A matrix as nested tuples."""

    __slots__ = ()

    @classmethod
    def of(cls, name: str, value: ArrayLike, shape: tuple[int, ...], *, order: Sequence[str] | None = None) -> Matrix:
        flat, lead = rows(name, value, shape, order=order)
        if lead != ():
            raise ValueError(f"{name}: its shape is {np.shape(value)}, and it must be {shape}")
        return cls(map(tuple, flat.reshape(shape).tolist()))


def vector(name: str, value: ArrayLike, size: int, *, order: Sequence[str] | None = None) -> tuple[float, ...]:
    """One vector of so many numbers, which are called so, if they have names of ours."""
    flat, lead = rows(name, value, (size,), order=order)
    if lead != ():
        raise ValueError(f"{name}: its shape is {np.shape(value)}, and it must be ({size},)")
    return tuple(flat[0].tolist())


def nested(name: str, value: ArrayLike, size: int) -> tuple[tuple[float, ...], ...]:
    """One square matrix."""
    return tuple(Matrix.of(name, value, (size, size)))


def one_attitude(name: str, value: ArrayLike, order: str) -> tuple[float, ...]:
    """One quaternion of norm one, scalar last."""
    flat, lead = attitudes(name, value, order)
    if lead != ():
        raise ValueError(f"{name}: its shape is {(*lead, 4)}, and it must be (4,)")
    return tuple(flat[0].tolist())


def of_kind(name: str, value: object, kind: type) -> None:
    """Refuses what is not of a kind, such as a law of attitudes."""
    if not isinstance(value, kind):
        called = kind.__name__
        raise ValueError(f"{name} = {value!r}: it must be {'an' if called[0] in 'AEIO' else 'a'} {called}")


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
        """Whether nothing speaks against the law at 5 %; None where it was not tested."""
        self.p_value = p_value
        """How likely samples of the law are as far from it as these."""
        self.notes = notes
        """What was noticed, in words."""

    def __repr__(self) -> str:
        said = "" if self.fits is None else f", fits={self.fits}, p_value={self.p_value:.3g}"
        return f"<Fit of {self.law!r}{said}>"


def known(law: Law, what: str, value: Any) -> Any:
    """What is known of a law."""
    if value is None:
        raise ValueError(
            f"{what}: not known of {law!r}, or it has none; of a law within a region (inside=) they are not known: take draws"
        )
    return value


def picture(law: Law, drawn: Any) -> str:
    """Draws of a law in the triangle of bodies."""
    from gyradius._figure import triangle

    return triangle([(f"{type(law).__name__} {law._core.name()}", drawn)], repr(law))


def short(law: Law) -> str:
    """A law in a line."""
    how, arguments = law._made
    short = ", ".join(text if len(text) < 60 else text[:57] + "..." for text in map(repr, arguments))
    return f"<{type(law).__name__} {how}({short})>"
