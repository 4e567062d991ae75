"""Shapes, types and attitudes of arrays: everything goes to the compiled part as flat rows of 64-bit floats."""

from __future__ import annotations

import json
import operator
import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar, Union

import numpy as np

from gyradius import _core

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, DTypeLike, NDArray

Whole: TypeAlias = Union[int, np.integer[Any]]
"""A whole number, of Python or of NumPy."""

Real: TypeAlias = Union[float, np.floating[Any], Whole]
"""A number, of Python or of NumPy."""

Size: TypeAlias = Union[Whole, Sequence[Whole], None]
"""How many of something, in what shape; one if it is not said."""

ORDERS = ("xyzw", "wxyz")

NATURAL: tuple[str, ...] = tuple(_core.COLUMNS)

FORMS: dict[str, tuple[str, ...]] = {
    "linear": (NATURAL[0], *(f"first_moment_{axis}_kg_m" for axis in (1, 2, 3)), *NATURAL[4:]),
    "natural": NATURAL,
}
"""What the ten numbers of a body are called in tables, in their order: m, m c and the inertia about the origin, or m, c and that about c."""

LOG_CHOLESKY = ("α", "d₁", "d₂", "d₃", "s₁₂", "s₂₃", "s₁₃", "t₁", "t₂", "t₃")
"""What the ten log-Cholesky coordinates are called."""

NAMED = {*FORMS["natural"], *FORMS["linear"], *LOG_CHOLESKY}
"""All names of numbers of bodies."""

MASS, CENTRE, INERTIA = NATURAL[:1], NATURAL[1:4], NATURAL[4:]

CALLED = {(): MASS, (3,): CENTRE, (6,): INERTIA, (10,): NATURAL, (3, 3): INERTIA, (6, 6): INERTIA, (10, 10): NATURAL}
"""What numbers are called that stand in arrays of such a shape, unless others are asked for; those of other shapes have no names of ours."""

SINGLE = np.dtype(np.float32)
"""Floats of 32 bits."""


def whole(name: str, value: Any, most: int, *, of_float: bool = False) -> int:
    """A whole number from 0 to the greatest that is allowed; with `of_float` also one that is written as ``1e6``."""
    if of_float and isinstance(value, (float, np.floating)) and value.is_integer():
        value = int(value)
    if isinstance(value, (bool, np.bool_)):
        raise ValueError(f"{name} = {value!r}: it must be a whole number")
    try:
        found = operator.index(value)
    except TypeError:
        raise ValueError(f"{name} = {value!r}: it must be a whole number") from None
    if not 0 <= found <= most:
        raise ValueError(f"{name} = {found}: it must be from 0 to 2**{most.bit_length()} - 1")
    return found


def real(name: str, value: Any) -> float:
    """One number."""
    array = numbers(name, value)
    if array.shape != ():
        raise ValueError(f"{name}: its shape is {array.shape}, and it must be one number")
    return float(array)


A = TypeVar("A", bound="NDArray[Any]")


def frozen(array: A) -> A:
    """The array of which nobody else knows, as a view that cannot be made writeable again."""
    memory: Any = array
    while isinstance(memory, np.ndarray):
        memory.flags.writeable = False
        memory = memory.base
    return array.view()


def unmasked(name: str, value: Any, *, of_bodies: bool = False) -> None:
    """Refuses what NumPy would make wrong numbers of: masked entries, of which it takes what stands behind the mask, quantities, of which it
    leaves the unit away, and, unless bodies are asked for, bodies, of which it takes the ten numbers for any others."""
    if isinstance(value, (list, tuple)):
        for one in value:
            # Most are numbers, and there may be millions of them.
            if not isinstance(one, (float, int)):
                unmasked(name, one, of_bodies=of_bodies)
    elif isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
        raise ValueError(f"{name}: some of its entries are masked")
    elif not of_bodies and getattr(type(value), "__array_ufunc__", value) is None:
        # By which a type says to NumPy that its objects are no arrays to compute with.
        raise ValueError(f"{name}: it must be numbers, not {type(value).__name__}")
    else:
        # Arrays may have a unit of their own; of tables only the type tells, since their columns are attributes too.
        of = value if isinstance(value, np.ndarray) else type(value)
        for unit in ("unit", "units"):
            if hasattr(of, unit):
                raise ValueError(f"{name}: it has the unit {getattr(value, unit)}, and it must be plain numbers, in units of SI")


def own_numbers(
    name: str, value: ArrayLike, *, order: Sequence[str] | None = None, of_bodies: bool = False
) -> NDArray[Any]:
    """The value as an array of real numbers of the type that it has; of numbers that are called so, if they have names of ours."""
    if order is not None:
        _own_order(name, value, order)
    unmasked(name, value, of_bodies=of_bodies)
    try:
        array = np.asarray(value)
        if array.dtype == object and not isinstance(value, np.ndarray):
            # NumPy makes objects of the numbers of tables whose columns may lack entries, and of long whole numbers.
            kinds = set(map(type, array.flat)) or {float}
            strange = [kind for kind in kinds if not issubclass(kind, (float, int, np.floating, np.integer))]
            if strange:
                raise TypeError(f"it has a {strange[0].__name__}")
            # Python's whole numbers may be too large for those of NumPy.
            array = array.astype(np.result_type(*(float if issubclass(kind, int) else kind for kind in kinds)))
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(f"{name}: it must be numbers: {error}") from None
    if array.dtype.kind not in "biufc":
        raise ValueError(f"{name}: it must be numbers, not {array.dtype}")
    if array.dtype.kind == "c":
        raise ValueError(f"{name}: it must be real numbers, not {array.dtype}")
    return array


def is_single(array: NDArray[Any]) -> bool:
    """Whether an array has floats of 32 bits, in whatever order of their bytes."""
    return array.dtype.kind == SINGLE.kind and array.dtype.itemsize == SINGLE.itemsize


def numbers(
    name: str, value: ArrayLike, *, order: Sequence[str] | None = None, of_bodies: bool = False
) -> NDArray[np.float64]:
    """The value as an array of aligned 64-bit floats, without a copy where it is one: see `own_numbers`."""
    array = own_numbers(name, value, order=order, of_bodies=of_bodies)
    # What stands at odd addresses, as a field of packed records does, the compiled part cannot read.
    return np.require(array.astype(np.float64, copy=False), requirements="A")


def rows(
    name: str, value: ArrayLike, tail: tuple[int, ...], *, order: Sequence[str] | None = None, of_bodies: bool = False
) -> tuple[NDArray[np.float64], tuple[int, ...]]:
    """An array of shape (..., *tail) as rows, and what the dots stand for: see `own_numbers`."""
    array = numbers(name, value, order=CALLED.get(tail, ()) if order is None else order, of_bodies=of_bodies)
    if array.shape[array.ndim - len(tail) :] != tail or array.ndim < len(tail):
        wanted = ", ".join(["...", *map(str, tail)])
        raise ValueError(f"{name}: its shape is {array.shape}, and it must be ({wanted})")
    lead = array.shape[: array.ndim - len(tail)]
    return np.ascontiguousarray(array).reshape(-1, int(np.prod(tail))), lead


def _own_order(name: str, value: ArrayLike, order: Sequence[str]) -> None:
    """Refuses numbers whose names are those of numbers of bodies, if they are others or stand in another order."""
    # One column of a table has a name of its own.
    alone = getattr(value, "name", None)
    for named in (*names_of(value), *([[alone]] if isinstance(alone, str) else [])):
        if not NAMED.issuperset(named):
            continue
        strange = [one for one in named if one not in order]
        if strange:
            raise ValueError(f"{name}: {strange[0]} is none of its numbers" + (f", which are {', '.join(order)}" if order else ""))
        right = [one for one in order if one in named]
        if named != right:
            known = "gyradius.COLUMNS, as in table[list(gyradius.COLUMNS)]" if right == list(NATURAL) else ", ".join(right)
            raise ValueError(f"{name}: its columns must be in the order of {known}")


def told_form(value: Any) -> str | None:
    """Which ten numbers of bodies these are by their names, if only one form has numbers of such names."""
    named = {one for names in names_of(value) for one in names}
    told = [form for form, other in (("linear", "natural"), ("natural", "linear")) if named & set(FORMS[form]) - set(FORMS[other])]
    return told[0] if len(told) == 1 else None


def same_names(**values: Any) -> None:
    """Refuses a mean and a covariance, by their names, whose numbers have names of which some are others or stand in another order."""
    found = [(name, named) for name, value in values.items() for named in names_of(value)]
    for name, named in found:
        first, expected = found[0]
        if named != expected:
            raise ValueError(f"{name}: its numbers are called {', '.join(named)}, and those of {first} {', '.join(expected)}")


def names_of(value: Any) -> list[list[str]]:
    """The names of the columns of a table, of pandas, polars or Arrow, and of its rows, or of the numbers of one row, where they have names."""
    found = (getattr(value, names, None) for names in ("column_names", "columns", "index"))
    # A list has a method `index`, and the columns of some tables are their values.
    named = (one for one in found if not callable(one) and isinstance(one, Iterable))
    # Most rows have numbers, of which the first says so.
    return [list(names) for names in named if all(isinstance(one, str) for one in names)]


def together(*arrays: tuple[str, ArrayLike, tuple[int, ...]]) -> tuple[list[NDArray[np.float64]], tuple[int, ...]]:
    """Arrays of shapes (..., *tail) as rows, with what the dots stand for broadcast."""
    found = [rows(*one) for one in arrays]
    try:
        lead = np.broadcast_shapes(*(shape for _, shape in found))
    except ValueError:
        said = ", ".join(f"{one[0]} {shape}" for one, (_, shape) in zip(arrays, found))
        raise ValueError(f"shapes that cannot be broadcast: {said}") from None
    wide = []
    for flat, shape in found:
        if shape != lead:
            flat = np.broadcast_to(flat.reshape(*shape, flat.shape[1]), (*lead, flat.shape[1]))
            flat = np.ascontiguousarray(flat).reshape(-1, flat.shape[-1])
        wide.append(flat)
    return wide, lead


def out(flat: NDArray[Any], shape: tuple[int, ...], dtype: DTypeLike | None = None) -> Any:
    """What the compiled part has made, in its shape and type; a number alone where the shape is empty."""
    array = flat.reshape(shape)
    if dtype is not None:
        array = array.astype(floating(dtype), copy=False)
    return array[()] if shape == () else array


def floating(dtype: DTypeLike) -> np.dtype[Any]:
    """The type of results, which must be one of floats."""
    try:
        found = np.dtype(dtype)
    except (TypeError, ValueError) as error:
        raise ValueError(f"dtype = {dtype!r}: {error}") from None
    if not np.issubdtype(found, np.floating):
        raise ValueError(f"dtype = {found}: it must be one of floats")
    return found


def check_order(order: str) -> bool:
    """Whether the scalar comes first in quaternions of this order."""
    if not isinstance(order, str) or order not in ORDERS:
        raise ValueError(f'order = {order!r}: it must be "xyzw" (scalar last) or "wxyz" (scalar first)')
    return order == "wxyz"


def attitudes(name: str, value: ArrayLike, order: str) -> tuple[NDArray[np.float64], tuple[int, ...]]:
    """Quaternions of any norm as rows of norm one, scalar last."""
    first = check_order(order)
    # A rotation of SciPy knows its quaternion.
    as_quat = getattr(value, "as_quat", None)
    if callable(as_quat):
        value, first = as_quat(), False
    flat, lead = rows(name, value, (4,))
    if first:
        flat = flat[:, [1, 2, 3, 0]]
    largest = np.abs(flat).max(axis=1, initial=0.0, keepdims=True)
    if not np.all(np.isfinite(largest) & (largest > 0)):
        place = int(np.argmin((np.isfinite(largest) & (largest > 0))[:, 0]))
        raise ValueError(f"{name}: row {place} = {flat[place]}: it must be finite, and not zero")
    # Of numbers near the ends of the range of floats the norm is beyond it, or of few digits.
    scale = np.where((largest > 1e-150) & (largest < 1e150), 1.0, largest)
    flat, largest = flat / scale, largest / scale
    norm = np.linalg.norm(flat / largest, axis=1, keepdims=True) * largest
    # What has norm one already keeps its bits.
    flat = np.where(np.abs(norm - 1.0) <= 4e-16, flat, flat / norm)
    return np.ascontiguousarray(flat), lead


def ordered(flat: NDArray[np.float64], order: str) -> NDArray[np.float64]:
    """Rows of quaternions, scalar last, in another order."""
    return np.ascontiguousarray(flat[:, [3, 0, 1, 2]]) if check_order(order) else flat


def text(name: str, value: Any) -> str:
    """A text, of characters that UTF-8 has."""
    if not isinstance(value, str):
        raise ValueError(f"{name} = {value!r}: it must be a text")
    try:
        value.encode()
    except UnicodeEncodeError:
        raise ValueError(f"{name} = {value!r}: it must be a text that UTF-8 can hold, without half of a character") from None
    return value


def flag(name: str, value: Any) -> bool:
    """Whether something is so."""
    if not isinstance(value, (bool, np.bool_)):
        raise ValueError(f"{name} = {value!r}: it must be True or False")
    return bool(value)


def folder_or_file(name: str, value: Any) -> Path:
    """A path."""
    path = os.fspath(value) if isinstance(value, (str, os.PathLike)) else value
    if not isinstance(path, str):
        raise ValueError(f"{name} = {value!r}: it must be a path, as a text or a pathlib.Path")
    return Path(path)


def listed(name: str, value: Any, what: str) -> list[Any]:
    """What stands in a list, or in anything that can be gone through once, as an iterator can."""
    wrong = f"{name} = {value!r}: it must be a list of {what}"
    # A text has letters, and a dictionary keys.
    if isinstance(value, (str, bytes, Mapping)):
        raise ValueError(wrong)
    try:
        things = iter(value)
    except TypeError:
        # As of an array without a dimension, or of one body.
        raise ValueError(wrong) from None
    return list(things)


def three(name: str, value: Any) -> list[Any]:
    """Three of something, such as laws."""
    # An array without a dimension is a number.
    is_several = isinstance(value, Sequence) if not isinstance(value, np.ndarray) else value.ndim > 0
    found = list(value) if is_several and not isinstance(value, str) else None
    if found is None or len(found) != 3:
        raise ValueError(f"{name} = {value!r}: there must be 3 laws or numbers")
    return found


def mapping(name: str, value: Any) -> Mapping[str, Any]:
    """What stands in files by names, such as a law."""
    if not isinstance(value, Mapping):
        raise ValueError(f"{name} = {value!r}: it must be a dict, as it stands in files")
    return value


def form(name: str, value: Any) -> str:
    """What is said in words and numbers, as the compiled part takes it."""
    try:
        return json.dumps(_plain(name, value))
    except RecursionError:
        raise ValueError(f"{name or 'form'}: it must be nested less deep") from None


def _plain(name: str, value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(f"{name}.{key}" if name else str(key), one) for key, one in value.items()}
    if isinstance(value, np.ndarray):
        unmasked(name, value)
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [_plain(f"{name}[{place}]", one) for place, one in enumerate(value)]
    if isinstance(value, (bool, str)) or value is None:
        return value
    if isinstance(value, (int, np.integer)):
        return int(value)
    if isinstance(value, (float, np.floating)):
        if not np.isfinite(value):
            raise ValueError(f"{name} = {float(value)}: it must be a finite number")
        return float(value)
    raise ValueError(f"{name} = {value!r}: it must be numbers, texts, lists or dicts")
