"""Where random numbers come from: one stream for each draw, whatever else is drawn."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, TypeAlias, Union

import numpy as np

from gyradius import _core
from gyradius._arrays import Size, Whole, frozen, text, unmasked, whole

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

MOST = 2**64 - 1

MOST_DRAWS = 2**48
"""More draws than any memory holds."""


class key:  # noqa: N801 - it is written as a function is
    """The random numbers of draws that do not depend on what else is drawn.

    Draw `i` under a term comes from a stream of its own, which the seed, the term and `i` decide: not how many draws there
    are, in what order, in how many calls or on how many threads. `rng=7` is `rng=key(7)`, and the links of a robot that
    `gyradius draw robot.urdf --seed 7` writes have their names as terms.

    Parameters
    ----------
    seed : int
        From 0 to 2**64 - 1.
    term : str
        What is drawn: the name of a link, of a quantity. Draws of different terms are independent.
    index : int or array of ints, optional
        Which draws: environment numbers, say. The draws then have the shape of `index`. Without it they are 0, 1, 2, ...

    Examples
    --------
    >>> import gyradius
    >>> axes = gyradius.uniform_attitude()
    >>> ten = axes.rvs(10, rng=gyradius.key(7, "forearm"))
    >>> bool((axes.rvs(rng=gyradius.key(7, "forearm", [3, 9])) == ten[[3, 9]]).all())
    True
    """

    __slots__ = ("index", "seed", "term")

    seed: int
    term: str
    index: NDArray[np.uint64] | None

    def __init__(self, seed: Whole, term: str = "", index: ArrayLike | None = None) -> None:
        object.__setattr__(self, "seed", whole("seed", seed, MOST))
        object.__setattr__(self, "term", text("term", term))
        object.__setattr__(self, "index", None if index is None else _places(index))

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{name}: a key does not change")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"{name}: a key does not change")

    def __reduce__(self) -> tuple[Any, ...]:
        return key, (self.seed, self.term, self.index)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, key):
            return NotImplemented
        same = (self.seed, self.term) == (other.seed, other.term)
        if self.index is None or other.index is None:
            return same and self.index is other.index
        return same and np.array_equal(self.index, other.index)

    def __hash__(self) -> int:
        return hash((self.seed, self.term, None if self.index is None else self.index.tobytes()))

    def __repr__(self) -> str:
        index = "" if self.index is None else f", index={np.array2string(self.index, threshold=6)}"
        return f"key({self.seed}, {self.term!r}{index})"


RNG: TypeAlias = Union[None, Whole, np.random.SeedSequence, np.random.Generator, key]
"""What random numbers may come from."""


def _places(index: ArrayLike) -> NDArray[np.uint64]:
    unmasked("index", index)
    try:
        array = np.asarray(index)
    except ValueError as error:
        raise ValueError(f"index: it must be whole numbers: {error}") from None
    # NumPy makes floats of whole numbers, some of which are above 2**63, and objects of those above 2**64.
    if array.dtype in (np.float64, np.object_) and not isinstance(index, np.ndarray):
        exact = np.asarray(index, dtype=object)
        if exact.size and all(isinstance(one, (int, np.integer)) for one in exact.flat):
            for one in exact.flat:
                whole("index", one, 2**64 - 1)
            array = exact.astype(np.uint64)
    if not np.issubdtype(array.dtype, np.integer):
        if array.size:
            raise ValueError(f"index: it must be whole numbers, not {array.dtype}")
        array = array.astype(np.uint64)
    if array.size and array.min() < 0:
        raise ValueError(f"index: {array.min()} is below 0")
    return frozen(np.array(array, dtype=np.uint64, order="C"))


def shape_of(size: Size) -> tuple[int, ...]:
    """What NumPy takes a size for."""
    if size is None:
        return ()
    sizes = tuple(size) if isinstance(size, (tuple, list)) or isinstance(size, np.ndarray) and size.ndim == 1 else (size,)
    for one in sizes:
        if isinstance(one, (bool, np.bool_)) or not isinstance(one, (int, np.integer)) or one < 0:
            raise ValueError(f"size = {size!r}: it must be a whole number that is not negative, or a tuple of such")
    return tuple(int(one) for one in sizes)


def draws_of(rng: RNG, size: Size) -> tuple[_core.Draws, tuple[int, ...]]:
    """Draws with their random numbers, and their shape."""
    shape = shape_of(size)
    if isinstance(rng, key) and rng.index is not None:
        if size is not None and shape != rng.index.shape:
            raise ValueError(f"size = {size!r}: the index of the key has the shape {rng.index.shape}")
        return _core.Draws.at(rng.seed, rng.term, rng.index.reshape(-1)), rng.index.shape
    count = math.prod(shape)
    if count > MOST_DRAWS:
        raise ValueError(f"size = {shape}: too many")
    if isinstance(rng, key):
        return _core.Draws.first(rng.seed, rng.term, count), shape
    if rng is None:
        rng = np.random.SeedSequence()
    if isinstance(rng, np.random.SeedSequence):
        return _core.Draws.of_key(_bytes(rng.generate_state(8, np.uint32)), count), shape
    if isinstance(rng, np.random.Generator):
        words = rng.integers(0, MOST, size=4, dtype=np.uint64, endpoint=True)
        return _core.Draws.of_key(_bytes(words), count), shape
    if isinstance(rng, (int, np.integer)) and not isinstance(rng, (bool, np.bool_)):
        return _core.Draws.first(whole("rng", rng, MOST), "", count), shape
    allowed = "None, a whole number, a SeedSequence, a Generator or a gyradius.key"
    raise ValueError(f"rng = {rng!r}: it must be {allowed}")


def _bytes(words: NDArray[Any]) -> bytes:
    return words.astype(words.dtype.newbyteorder("<")).tobytes()
