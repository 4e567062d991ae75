"""Mass, mass centre and inertia together, of one body or of many."""

from __future__ import annotations

import errno
import html
import json
import os
import warnings
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from gyradius import _core
from gyradius._arrays import (
    CENTRE,
    INERTIA,
    LOG_CHOLESKY,
    NATURAL,
    SINGLE,
    attitudes,
    flag,
    floating,
    folder_or_file,
    frozen,
    is_single,
    mapping,
    numbers,
    ordered,
    out,
    own_numbers,
    rows,
    together,
)
from gyradius._arrays import form as _form
from gyradius._inertia import is_realizable, of_rounded, rounding
from gyradius._law import one_attitude

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, DTypeLike, NDArray

COLUMNS: tuple[str, ...] = NATURAL
"""What the ten numbers of a body are called, in their order; the last six are in kg·m²."""

CELL = np.dtype((np.void, 80))
"""The ten numbers of a body as one."""

ENTRIES = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))

MATRIX = (4, 7, 8, 7, 5, 9, 8, 9, 6)
"""Where the nine entries of the inertia stand among the ten numbers."""


class MujocoBodies(NamedTuple):
    """Bodies as MuJoCo holds them, in a model's arrays of the same names."""

    body_mass: Any
    """(...) in kg."""
    body_ipos: Any
    """(..., 3): the mass centre in the frame of the body, in m."""
    body_inertia: Any
    """(..., 3): principal moments in kg·m²."""
    body_iquat: Any
    """(..., 4): the attitude of the principal axes in the frame of the body, scalar first."""


class MassProperties:
    """Mass, mass centre and inertia of one body, or of an array of bodies.

    Ten numbers a body, in the last axis of `array`: mass in kg, mass centre in m in the axes of the body, and the
    entries 11, 22, 33, 12, 13, 23 of the inertia about the mass centre in kg·m², products as tensor entries. They need not be
    those of a body: `is_realizable` says which are, and what computes with bodies refuses the others. Of inertias and pseudo-inertias
    in 32 bits, whose rounding takes about half of all plates out of what bodies have, those that lie outside by no more than this
    rounding, 7.6e-6 of the trace that was given, are replaced by the nearest that some body has. Of inertias about another point, see `about_point`.

    Parameters
    ----------
    mass : array_like, shape (...)
        kg.
    centre : array_like, shape (..., 3)
        m, in the axes of the body.
    inertia : array_like, shape (..., 3, 3)
        kg·m² about the mass centre, symmetric.

    Examples
    --------
    >>> import numpy as np, gyradius
    >>> rod = gyradius.MassProperties(2.0, [0.5, 0.0, 0.0], np.diag([0.0, 1 / 6, 1 / 6]))
    >>> float(rod.inertia_about([0.0, 0.0, 0.0])[1, 1].round(6))
    0.666667
    >>> two = rod + rod.translated([1.0, 0.0, 0.0])
    >>> float(two.mass), two.centre.tolist()
    (4.0, [1.0, 0.0, 0.0])
    """

    __slots__ = ("_array",)
    # An array and bodies have no sum, of which NumPy would make one of ten numbers.
    __array_ufunc__ = None

    _array: NDArray[np.float64]

    def __init__(self, mass: ArrayLike, centre: ArrayLike, inertia: ArrayLike) -> None:
        given = own_numbers("inertia", inertia, order=INERTIA)
        parts, lead = together(("mass", mass, ()), ("centre", centre, (3,)), ("inertia", given, (3, 3)))
        if is_single(given):
            parts[2] = of_rounded(parts[2].reshape(-1, 3, 3)).reshape(-1, 9)
        self._set(_core.body_of_parts(*parts).reshape(*lead, 10))

    def _set(self, array: NDArray[np.float64]) -> None:
        object.__setattr__(self, "_array", frozen(array))

    @classmethod
    def of(cls, array: MassProperties | ArrayLike) -> MassProperties:
        """The bodies of an array of shape (..., 10), in the order of `gyradius.COLUMNS`."""
        return cls._named("array", array)

    @classmethod
    def _named(cls, name: str, bodies: MassProperties | ArrayLike) -> MassProperties:
        flat, lead = body_rows(name, bodies)
        return cls._of(flat.copy().reshape(*lead, 10))

    @classmethod
    def _of(cls, array: NDArray[np.float64]) -> MassProperties:
        made = object.__new__(cls)
        made._set(array)
        return made

    @classmethod
    def about_point(
        cls, mass: ArrayLike, centre: ArrayLike, inertia: ArrayLike, point: ArrayLike = (0.0, 0.0, 0.0)
    ) -> MassProperties:
        """The bodies of which the inertia is known about another point than the mass centre, such as the origin.

        Far from the point the rounding of what is given, 1.4e-14 of its trace in 64 bits, is much of the inertia about the mass centre: what
        lies outside of what bodies have by no more than this is replaced by the nearest that some body has.
        """
        given = own_numbers("inertia", inertia, order=INERTIA)
        known = ("mass", mass, ()), ("centre", centre, (3,)), ("inertia", given, (3, 3)), ("point", point, (3,))
        (m, c, i, p), lead = together(*known)
        # What is not finite, or becomes so, is no body, of which `is_realizable` tells.
        with np.errstate(invalid="ignore", over="ignore"):
            at = c - p
            square = (at * at).sum(axis=-1)[:, None, None] * np.eye(3)
            moved = m[:, :, None] * (square - at[:, :, None] * at[:, None, :])
            own = of_rounded(i.reshape(-1, 3, 3) - moved, i[:, ::4].sum(axis=1), SINGLE if is_single(given) else i.dtype)
        return cls(m.reshape(lead), c.reshape(*lead, 3), own.reshape(*lead, 3, 3))

    @classmethod
    def from_pseudo_inertia(cls, pseudo_inertia: ArrayLike) -> MassProperties:
        """The bodies of pseudo-inertias ∫ (x, 1)(x, 1)ᵀ dm of shape (..., 4, 4)."""
        given = own_numbers("pseudo_inertia", pseudo_inertia)
        flat, lead = rows("pseudo_inertia", given, (4, 4))
        if is_single(given):
            flat = _of_rounded_pseudo_inertia(flat.reshape(-1, 4, 4)).reshape(-1, 16)
        return cls._of(_core.body_from_pseudo_inertia(flat).reshape(*lead, 10))

    @classmethod
    def from_log_cholesky(cls, coordinates: ArrayLike) -> MassProperties:
        """The bodies of log-Cholesky coordinates of shape (..., 10): see `log_cholesky`."""
        flat, lead = rows("coordinates", coordinates, (10,), order=LOG_CHOLESKY)
        return cls._of(_core.body_from_log_cholesky(flat).reshape(*lead, 10))

    @property
    def array(self) -> NDArray[np.float64]:
        """The ten numbers, shape (..., 10), in the order of `gyradius.COLUMNS`; read only."""
        return self._array

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        array = self._array if dtype is None else self._array.astype(dtype, copy=False)
        if copy is False and array is not self._array:
            raise ValueError(f"dtype = {array.dtype}: without a copy it must be float64")
        return array.copy() if copy else array

    @property
    def shape(self) -> tuple[int, ...]:
        """Of the array of bodies: empty for one."""
        return self._array.shape[:-1]

    @property
    def mass(self) -> Any:
        """(...) in kg; a number alone of one body."""
        return self._array[..., 0][()]

    @property
    def centre(self) -> NDArray[np.float64]:
        """(..., 3): the mass centre in m."""
        return self._array[..., 1:4]

    @property
    def inertia(self) -> NDArray[np.float64]:
        """(..., 3, 3): about the mass centre in kg·m²."""
        # In the order of C, which what takes matrices need not copy.
        return np.take(self._array, MATRIX, axis=-1).reshape(*self.shape, 3, 3)

    @property
    def is_realizable(self) -> Any:
        """Which of them are bodies: a mass above zero, finite numbers, and an inertia that some body has."""
        fine = (self.mass > 0) & np.isfinite(self._array).all(axis=-1)
        found = fine & is_realizable(self.inertia)
        return bool(found) if self.shape == () else found

    @property
    def pseudo_inertia(self) -> NDArray[np.float64]:
        """(..., 4, 4): ∫ (x, 1)(x, 1)ᵀ dm, in kg·m², kg·m and kg."""
        return _core.body_pseudo_inertia(self._flat()).reshape(*self.shape, 4, 4)

    @property
    def log_cholesky(self) -> NDArray[np.float64]:
        """(..., 10): α, d₁, d₂, d₃, s₁₂, s₂₃, s₁₃, t₁, t₂, t₃ of Rucker & Wensing (2022), doi:10.1109/LRA.2022.3144517.

        Plates, rods and points lie at infinity and are refused.
        """
        return _core.body_log_cholesky(self._flat()).reshape(*self.shape, 10)

    @property
    def linear(self) -> NDArray[np.float64]:
        """(..., 10): m, m c, and the inertia about the origin, in which the equations of motion are linear."""
        about = self.inertia_about(np.zeros(3))
        entries = np.stack([about[..., a, b] for a, b in ENTRIES], axis=-1)
        return np.concatenate([self._array[..., :1], self._array[..., :1] * self.centre, entries], axis=-1)

    def inertia_about(self, point: ArrayLike) -> NDArray[np.float64]:
        """(..., 3, 3): the inertia about a point in m, (..., 3), in kg·m²."""
        (bodies, points), lead = together(("bodies", self._array, (10,)), ("point", point, (3,)))
        return _core.body_inertia_about(bodies, points).reshape(*lead, 3, 3)

    def translated(self, by: ArrayLike) -> MassProperties:
        """The bodies moved by (..., 3) in m; the axes stay."""
        return self._posed((0.0, 0.0, 0.0, 1.0), "by", by, "xyzw")

    def rotated(self, rotation: ArrayLike, *, order: str = "xyzw") -> MassProperties:
        """The bodies turned about the origin by quaternions (..., 4), or a `scipy.spatial.transform.Rotation`."""
        return self._posed(rotation, "translation", (0.0, 0.0, 0.0), order)

    def transformed(self, rotation: ArrayLike, translation: ArrayLike, *, order: str = "xyzw") -> MassProperties:
        """The bodies turned about the origin and then moved: what they are in a frame in which theirs has this pose."""
        return self._posed(rotation, "translation", translation, order)

    def _posed(self, rotation: ArrayLike, name: str, translation: ArrayLike, order: str) -> MassProperties:
        turns, shape = attitudes("rotation", rotation, order)
        (turn, move), lead = together(("rotation", turns.reshape(*shape, 4), (4,)), (name, translation, (3,)))
        strange = move[~np.isfinite(move).all(axis=1)]
        if len(strange):
            raise ValueError(f"{name} = {strange[0].tolist()}: it must be finite")
        pose = np.concatenate([turn, move], axis=1).reshape(*lead, 7)
        (bodies, pose), lead = together(("bodies", self._array, (10,)), ("pose", pose, (7,)))
        return self._of(_core.body_transform(bodies, pose).reshape(*lead, 10))

    def __add__(self, other: object) -> MassProperties:
        """Two bodies, described in one frame, as one."""
        return self._with(other, _core.body_add)

    def __radd__(self, other: object) -> MassProperties:
        # `sum` begins with zero.
        return self if isinstance(other, int) and other == 0 else NotImplemented

    def __sub__(self, other: object) -> MassProperties:
        """What is left of a body without a part."""
        return self._with(other, _core.body_subtract)

    def _with(self, other: object, what: Any) -> MassProperties:
        if not isinstance(other, MassProperties):
            return NotImplemented
        (one, two), lead = together(("bodies", self._array, (10,)), ("bodies", other._array, (10,)))
        return self._of(what(one, two).reshape(*lead, 10))

    def sum(self) -> MassProperties:
        """All of them, described in one frame, as one body."""
        if not self._flat().size:
            raise ValueError("no bodies to add: there must be at least one")
        flat = self._of(self._flat())
        while flat.shape[0] > 1:
            half = flat.shape[0] // 2
            pairs = (flat[:half] + flat[half : 2 * half])._array
            flat = self._of(np.concatenate([pairs, flat._array[2 * half :]]))
        return flat[0]

    def with_mass(self, mass: ArrayLike) -> MassProperties:
        """The same bodies of another density: the inertia follows the mass."""
        (new, old), lead = together(("mass", mass, ()), ("bodies", self._array, (10,)))
        wrong = new[~((new > 0) & np.isfinite(new))]
        if wrong.size:
            raise ValueError(f"mass = {wrong[0]}: it must be positive and finite")
        if not np.all(old[:, :1] > 0):
            raise ValueError("mass: a body of no mass has no density that could change")
        changed = np.concatenate([new, old[:, 1:4], old[:, 4:] * (new / old[:, :1])], axis=1)
        return self._of(changed.reshape(*lead, 10))

    def to_mujoco(self, dtype: DTypeLike | None = None) -> MujocoBodies:
        """As MuJoCo holds them: mass, place, principal moments, and quaternion with the scalar first."""
        found = _core.body_to_principal(self._flat())
        kind = np.dtype(np.float64) if dtype is None else floating(dtype)
        return MujocoBodies(
            body_mass=out(found[:, 0].copy(), self.shape, kind),
            body_ipos=self.centre.astype(kind),
            # Rounding may leave less than nothing of a moment of a rod.
            body_inertia=out(np.maximum(found[:, 1:4], 0.0), (*self.shape, 3), kind),
            body_iquat=out(ordered(found[:, 4:], "wxyz"), (*self.shape, 4), kind),
        )

    def _flat(self) -> NDArray[np.float64]:
        return np.ascontiguousarray(self._array.reshape(-1, 10))

    def __getitem__(self, place: Any) -> MassProperties:
        if self.shape == ():
            raise TypeError("one body has no parts to pick from")
        if type(place) is int:
            return self._of(self._array[place].copy())
        # A body is one cell, so that no index reaches the ten numbers.
        cells = self._array.view(CELL)[..., 0]
        try:
            picked = np.asarray(cells[place])
        except IndexError as error:
            raise IndexError(f"{error}; pick bodies, and their numbers from `array`") from None
        return self._of(picked[..., None].copy().view(np.float64))

    def __len__(self) -> int:
        if self.shape == ():
            raise TypeError("one body has no length")
        return self.shape[0]

    def __bool__(self) -> bool:
        # One body is something, although it has no length; of an array, as of a list.
        return self.shape == () or self.shape[0] > 0

    def __iter__(self) -> Iterator[MassProperties]:
        return (self[place] for place in range(len(self)))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, MassProperties):
            return NotImplemented
        return np.array_equal(self._array, other._array)

    def __hash__(self) -> int:
        # -0.0 is 0.0.
        return hash((self.shape, (self._array + 0.0).tobytes()))

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{name}: mass properties do not change")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"{name}: mass properties do not change")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self).of, (self._array,)

    def _repr_html_(self) -> str:
        from gyradius._figure import triangle

        if self.shape == ():
            return f"<pre>{html.escape(repr(self))}</pre>"
        return triangle([(repr(self).strip("<>"), self)], "Mass properties")

    def __repr__(self) -> str:
        if self.shape != ():
            return f"<MassProperties of {' x '.join(map(str, self.shape))} bodies>"
        centre, inertia = self.centre.tolist(), self.inertia.tolist()
        return f"MassProperties(mass={float(self.mass)!r}, centre={centre!r}, inertia={inertia!r})"


class Region:
    """Where the matter of a body is: made by `box`, `ellipsoid` and `hull`."""

    __slots__ = ("_form",)

    _form: str

    def __init__(self, form: dict[str, Any]) -> None:
        object.__setattr__(self, "_form", _core.checked_region(_form("", mapping("form", form))))

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{name}: a region does not change")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"{name}: a region does not change")

    @property
    def form(self) -> dict[str, Any]:
        """As it stands in files."""
        return json.loads(self._form)

    def holds(self, bodies: MassProperties | ArrayLike) -> Any:
        """Whether matter inside can have the mass properties: 1 if it can, 0 if not, and NaN where neither was shown."""
        flat, lead = body_rows("bodies", bodies)
        return out(_core.region_holds(self._form, flat), lead)

    def __eq__(self, other: object) -> bool:
        return self._form == other._form if isinstance(other, Region) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._form)

    def __reduce__(self) -> tuple[Any, ...]:
        return Region, (self.form,)

    def __repr__(self) -> str:
        return f"Region({self.form!r})"


def box(middle: ArrayLike = (0.0, 0.0, 0.0), *, sides: ArrayLike, attitude: ArrayLike | None = None) -> Region:
    """A box that holds all the matter of a body.

    Parameters
    ----------
    middle : array_like, shape (3,)
        m, in the axes of the body.
    sides : array_like, shape (3,)
        Whole lengths in m.
    attitude : array_like, shape (4,), optional
        The quaternion, scalar last, or the `scipy.spatial.transform.Rotation`, that turns the box from the axes of the body.
    """
    half = (0.5 * _lengths("sides", sides)).tolist()
    return Region({"box": {"middle_m": _three("middle", middle).tolist(), "half_sides_m": half, **_turn(attitude)}})


def ellipsoid(
    middle: ArrayLike = (0.0, 0.0, 0.0), *, semi_axes: ArrayLike, attitude: ArrayLike | None = None
) -> Region:
    """An ellipsoid that holds all the matter of a body, from its middle and semi-axes in m: see `box`."""
    form = {"middle_m": _three("middle", middle).tolist(), "semi_axes_m": _lengths("semi_axes", semi_axes).tolist()}
    return Region({"ellipsoid": {**form, **_turn(attitude)}})


def hull(points: ArrayLike) -> Region:
    """The convex hull of points in m, shape (n, 3), such as the vertices of a mesh."""
    array = numbers("points", points, order=CENTRE)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"points: its shape is {array.shape}, and it must be (n, 3)")
    return Region({"hull": {"points_m": array.tolist()}})


def _three(name: str, value: ArrayLike) -> NDArray[np.float64]:
    array = numbers(name, value, order=CENTRE)
    if array.shape not in ((), (3,)):
        raise ValueError(f"{name}: its shape is {array.shape}, and it must be (3,)")
    array = np.broadcast_to(array, (3,))
    if not np.all(np.isfinite(array)):
        raise ValueError(f"{name} = {array.tolist()}: it must be finite")
    return array


def _lengths(name: str, value: ArrayLike) -> NDArray[np.float64]:
    array = _three(name, value)
    if not np.all(array > 0):
        raise ValueError(f"{name} = {array.tolist()}: each must be positive")
    return array


def _turn(attitude: ArrayLike | None) -> dict[str, Any]:
    return {} if attitude is None else {"attitude": one_attitude("attitude", attitude, "xyzw")}


def load(path: str | os.PathLike[str], *, strict: bool = False) -> dict[str, MassProperties]:
    """The bodies of a robot by the names of its links.

    Parameters
    ----------
    path : str or path
        A URDF, MJCF or SDF file.
    strict : bool
        Whether links without mass properties that can be told, such as those that are said by shapes and a density, are an
        error. Otherwise they are left out, with a warning if the file has numbers of them that cannot be read.

    Returns
    -------
    dict of str to MassProperties
        In the order of the file, in the frame of each link. As they are in the file: `is_realizable` says whether they belong
        to a body. A `RuntimeWarning` tells of macros that are not expanded and of files that are not followed, in which there may be more
        links, of inertias for Gazebo alone in a URDF file, and of words such as `settotalmass="5"` of MJCF with which a simulator takes other
        numbers; with `strict` it is an error. `laws` makes the laws of all of them.

    Raises
    ------
    OSError
        The file cannot be read: `FileNotFoundError`, `IsADirectoryError`, `PermissionError`.
    ValueError
        It is no robot, or its text is malformed.
    """
    file = folder_or_file("path", path)
    if file.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    is_strict = flag("strict", strict)
    found, unread = _core.load_robot(file)
    if is_strict:
        bad = [f"{name}: {why}" for name, ten, why, _ in found if ten is None] + unread
        if bad:
            raise ValueError(f"{path}: {'; '.join(bad)}")
    left_out = [f"{name} is left out: {why}" for name, _, why, is_told in found if is_told]
    for what in unread + left_out:
        warnings.warn(f"{path}: {what}", RuntimeWarning, stacklevel=2)
    return {name: MassProperties.of(ten) for name, ten, *_ in found if ten is not None}


def pseudo_inertia(bodies: MassProperties | ArrayLike) -> NDArray[np.float64]:
    """The pseudo-inertias ∫ (x, 1)(x, 1)ᵀ dm of bodies, or of an array (..., 10): shape (..., 4, 4)."""
    return MassProperties._named("bodies", bodies).pseudo_inertia


def log_cholesky(bodies: MassProperties | ArrayLike) -> NDArray[np.float64]:
    """The log-Cholesky coordinates of bodies, or of an array (..., 10): shape (..., 10). See `MassProperties.log_cholesky`."""
    return MassProperties._named("bodies", bodies).log_cholesky


def body_rows(name: str, bodies: MassProperties | ArrayLike) -> tuple[NDArray[np.float64], tuple[int, ...]]:
    """The ten numbers of bodies as rows, of floats of 32 bits with what `of_rounded` makes of the inertias, and the shape of the bodies."""
    given = own_numbers(name, bodies, order=NATURAL, of_bodies=True)
    flat, lead = rows(name, given, (10,))
    if is_single(given):
        rounded = of_rounded(flat[:, MATRIX].reshape(-1, 3, 3))
        flat = np.concatenate([flat[:, :4], *(rounded[:, i, j, None] for i, j in ENTRIES)], axis=1)
    return flat, lead


def _exchanged(matrices: NDArray[np.float64], share: float) -> NDArray[np.float64]:
    """Inertias of second moments, with the share 1; second moments of inertias, with the share 1/2."""
    return share * np.trace(matrices, axis1=1, axis2=2)[:, None, None] * np.eye(3) - matrices


def _of_rounded_pseudo_inertia(matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Pseudo-inertias (n, 4, 4) of numbers that were rounded to 32 bits, with what `of_rounded` makes of the inertias about mass centres.

    What is no pseudo-inertia for another reason stays as it is.
    """
    mass = matrices[:, 3, 3]
    turned = matrices.transpose(0, 2, 1)
    # Entries have different units: what they are sums of is no larger than this.
    roots = np.sqrt(np.abs(np.diagonal(matrices, axis1=1, axis2=2)))
    is_near = np.abs(matrices - turned) <= rounding(SINGLE) * roots[:, :, None] * roots[:, None, :]
    fine = np.isfinite(matrices).all(axis=(1, 2)) & is_near.all(axis=(1, 2)) & (mass > 0)
    found = matrices.copy()
    if fine.any():
        mean = 0.5 * (matrices + turned)[fine]
        about, first, mass = mean[:, :3, :3], mean[:, :3, 3], mass[fine, None, None]
        of_centre = first[:, :, None] * first[:, None, :] / mass
        own = _exchanged(about - of_centre, 1.0)
        body = of_rounded(own, 2.0 * np.trace(about, axis1=1, axis2=2))
        mean[:, :3, :3] += _exchanged(body - own, 0.5)
        found[fine] = mean
    return found


__all__ = [
    "COLUMNS",
    "MassProperties",
    "MujocoBodies",
    "Region",
    "box",
    "ellipsoid",
    "hull",
    "load",
    "log_cholesky",
    "pseudo_inertia",
]
