"""Numbers of every function that takes them: no bodies in their place, and none that their names contradict."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import gyradius
from gyradius import AttitudeLaw, InertiaLaw, MassProperties, MassPropertiesLaw, ScalarLaw
from gyradius._arrays import LOG_CHOLESKY

BODY = MassProperties(2.0, [0.1, -0.2, 0.3], [[0.2, 0.01, 0.0], [0.01, 0.3, 0.0], [0.0, 0.0, 0.35]])
LAW = gyradius.law(BODY, mass="2%", centre="5mm", moments="5%", axes="1deg")
MANY = LAW.rvs(30, rng=1)
Q = [0.0, 0.0, 0.6, 0.8]
THREE = [0.1, 0.2, 0.3]
TURNS = gyradius.small_rotations(Q, np.eye(3) * 1e-2)
ENTRIES = InertiaLaw.about("wishart", BODY.inertia, delta=0.1)
SIX = [0, 4, 8, 1, 2, 5]

GOOD: dict[str, tuple[Callable[..., Any], dict[str, Any]]] = {
    "AttitudeLaw.fit": (AttitudeLaw.fit, {"q": TURNS.rvs(50, rng=1)}),
    "AttitudeLaw.logpdf": (TURNS.logpdf, {"q": Q}),
    "InertiaLaw.about": (lambda inertia: InertiaLaw.about("wishart", inertia, delta=0.1), {"inertia": BODY.inertia}),
    "InertiaLaw.fit": (InertiaLaw.fit, {"inertia": MANY.inertia}),
    "InertiaLaw.logpdf": (ENTRIES.logpdf, {"inertia": BODY.inertia}),
    "InertiaLaw.matched": (
        lambda **given: InertiaLaw.matched("correlated-entries", **given),
        {"mean": BODY.inertia.ravel()[SIX], "cov": np.eye(6) * 1e-6},
    ),
    "MassProperties": (MassProperties, {"mass": 2.0, "centre": THREE, "inertia": BODY.inertia}),
    "MassProperties.about_point": (
        MassProperties.about_point,
        {"mass": 2.0, "centre": THREE, "inertia": np.eye(3), "point": [0.0, 0.0, 0.0]},
    ),
    "MassProperties.from_log_cholesky": (MassProperties.from_log_cholesky, {"coordinates": BODY.log_cholesky}),
    "MassProperties.from_pseudo_inertia": (MassProperties.from_pseudo_inertia, {"pseudo_inertia": BODY.pseudo_inertia}),
    "MassProperties.inertia_about": (BODY.inertia_about, {"point": THREE}),
    "MassProperties.of": (MassProperties.of, {"array": BODY}),
    "MassProperties.rotated": (BODY.rotated, {"rotation": Q}),
    "MassProperties.transformed": (BODY.transformed, {"rotation": Q, "translation": THREE}),
    "MassProperties.translated": (BODY.translated, {"by": THREE}),
    "MassProperties.with_mass": (BODY.with_mass, {"mass": 3.0}),
    "MassPropertiesLaw.fit": (MassPropertiesLaw.fit, {"bodies": MANY}),
    "MassPropertiesLaw.log_cholesky": (MassPropertiesLaw.log_cholesky, {"mean": BODY.log_cholesky, "cov": np.eye(10) * 1e-4}),
    "MassPropertiesLaw.logpdf": (LAW.logpdf, {"bodies": BODY}),
    "MassPropertiesLaw.maximum_entropy": (
        lambda centre_std: MassPropertiesLaw.maximum_entropy(BODY, mass_delta=0.1, centre_std=centre_std, delta=0.1),
        {"centre_std": [0.01] * 3},
    ),
    "Region.holds": (gyradius.box(sides=3.0).holds, {"bodies": BODY}),
    "ScalarLaw.cdf": (gyradius.normal(1.0, 0.1).cdf, {"x": 1.0}),
    "ScalarLaw.logpdf": (gyradius.normal(1.0, 0.1).logpdf, {"x": 1.0}),
    "ScalarLaw.ppf": (gyradius.normal(1.0, 0.1).ppf, {"q": 0.5}),
    "ScalarLaw.sf": (gyradius.normal(1.0, 0.1).sf, {"x": 1.0}),
    "about_axis": (gyradius.about_axis, {"q": Q, "axis": [0.0, 0.0, 1.0]}),
    "bingham": (gyradius.bingham, {"precision": np.eye(4)}),
    "box": (gyradius.box, {"middle": THREE, "sides": [1.0, 2.0, 3.0], "attitude": Q}),
    "ellipsoid": (gyradius.ellipsoid, {"middle": THREE, "semi_axes": [1.0, 2.0, 3.0], "attitude": Q}),
    "fisher_bingham": (gyradius.fisher_bingham, {"precision": np.eye(4), "linear": np.ones(4)}),
    "fixed_attitude": (gyradius.fixed_attitude, {"q": Q}),
    "from_estimate": (gyradius.from_estimate, {"phi": BODY.linear, "cov": np.eye(10) * 1e-6}),
    "hull": (gyradius.hull, {"points": np.vstack([np.eye(3), np.zeros((1, 3))])}),
    "is_realizable": (gyradius.is_realizable, {"inertia": BODY.inertia}),
    "key": (lambda index: gyradius.key(7, "a", index), {"index": [1, 2]}),
    "log_cholesky": (gyradius.log_cholesky, {"bodies": BODY}),
    "margin": (gyradius.margin, {"inertia": BODY.inertia}),
    "nearest": (gyradius.nearest, {"inertia": BODY.inertia}),
    "principal_axes": (gyradius.principal_axes, {"inertia": BODY.inertia}),
    "pseudo_inertia": (gyradius.pseudo_inertia, {"bodies": BODY}),
    "radially_constrained_gaussian": (gyradius.radially_constrained_gaussian, {"mean": Q, "cov": np.eye(4) * 1e-2}),
    "report": (gyradius.report, {"inertia": BODY.inertia}),
    "small_rotations": (gyradius.small_rotations, {"mean": Q, "cov": np.eye(3) * 1e-2}),
}
"""Everything that takes arrays, with arguments that are right."""


def takers() -> Iterator[tuple[str, str, str]]:
    """What takes arrays, its parameters that are arrays, and their types."""
    for name in gyradius.__all__:
        one = getattr(gyradius, name)
        parts = {name: one}
        if inspect.isclass(one):
            parts |= {f"{name}.{part}": getattr(one, part) for part in vars(one) if not part.startswith("_")}
        for label, part in parts.items():
            if not callable(part) or inspect.isclass(part) and issubclass(part, tuple):
                continue
            for parameter in inspect.signature(part).parameters.values():
                if "ArrayLike" in str(parameter.annotation):
                    yield label, parameter.name, str(parameter.annotation)


TAKERS = sorted(takers())
OF_NUMBERS = [(label, name) for label, name, kind in TAKERS if "MassProperties" not in kind]
OF_BODIES = [(label, name) for label, name, kind in TAKERS if "MassProperties" in kind]


def test_everything_that_takes_arrays_is_here() -> None:
    assert {(label, name) for label, name, _ in TAKERS} == {(label, name) for label, (_, given) in GOOD.items() for name in given}
    for function, given in GOOD.values():
        function(**given)


@pytest.mark.parametrize(("label", "name"), OF_NUMBERS)
@pytest.mark.parametrize("bodies", [BODY, MANY, MANY[:3], MANY[:10], [BODY, BODY], (BODY, [MANY[0]]), [1.0, BODY]])
def test_bodies_are_no_numbers(label: str, name: str, bodies: Any) -> None:
    function, given = GOOD[label]
    with pytest.raises(ValueError, match=f"^{name}: it must be numbers, not MassProperties$"):
        function(**{**given, name: bodies})


@pytest.mark.parametrize(("label", "name"), OF_BODIES)
def test_bodies_are_taken_as_their_numbers(label: str, name: str) -> None:
    function, given = GOOD[label]
    if label == "from_estimate":
        given = {**given, "form": "natural"}
    many = label.endswith("Law.fit")
    asked = MANY if many else BODY
    numbers = asked.log_cholesky if label == "MassPropertiesLaw.log_cholesky" else asked.array
    assert repr(function(**{**given, name: asked})) == repr(function(**{**given, name: numbers}))
    if "mean" not in given and "phi" not in given:
        assert repr(function(**{**given, name: list(MANY)})) == repr(function(**{**given, name: MANY.array}))


@pytest.mark.parametrize(("label", "name"), [(label, name) for label, name, _ in TAKERS])
@pytest.mark.parametrize("wrong", ["x", "1.5", b"x", 1j, {}, object(), [[1.0], [1.0, 2.0]], np.ma.masked_array([1.0, 2.0, 3.0], [0, 1, 0])])
def test_what_is_no_number_is_named_as_it_was_given(label: str, name: str, wrong: Any) -> None:
    function, given = GOOD[label]
    with pytest.raises(ValueError, match=f"^{name}( = .*)?: "):
        function(**{**given, name: wrong})


class InUnits(np.ndarray):
    """An array with a unit of its own, as astropy has them."""

    unit: str | None = "cm"


class Held:
    """Numbers with a unit, as pint has them."""

    def __init__(self, value: Any) -> None:
        self.magnitude = np.asarray(value, dtype=float)

    @property
    def units(self) -> str:
        return "cm"

    def __array__(self, dtype: object = None, copy: object = None) -> np.ndarray:
        return self.magnitude


def of_instance(value: Any) -> Any:
    """An array of which only the object has a unit, as unyt has them."""

    class Unyt(np.ndarray):
        pass

    array = np.asarray(value, dtype=float).view(Unyt)
    array.units = "cm"  # type: ignore[attr-defined]
    return array


@pytest.mark.parametrize(("label", "name"), [(label, name) for label, name, _ in TAKERS])
@pytest.mark.parametrize("kind", [lambda value: np.asarray(value, dtype=float).view(InUnits), Held, of_instance])
@pytest.mark.parametrize("within", [lambda one: one, lambda one: [one], lambda one: ([one, one],)])
def test_numbers_with_a_unit_are_refused(label: str, name: str, kind: Callable[[Any], Any], within: Callable[[Any], Any]) -> None:
    function, given = GOOD[label]
    value = getattr(given[name], "array", given[name])
    with pytest.raises(ValueError, match=f"^{name}( = .*)?: it has the unit cm, and it must be plain numbers, in units of SI"):
        function(**{**given, name: within(kind(value))})


def test_tables_with_a_column_of_units_have_no_unit() -> None:
    pandas = pytest.importorskip("pandas")
    for name in ("unit", "units"):
        table = pandas.DataFrame({name: [1.0, 2.0]})
        assert (gyradius.normal(0.0, 1.0).cdf(table) == gyradius.normal(0.0, 1.0).cdf([[1.0], [2.0]])).all()


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("place", range(3))
@pytest.mark.parametrize(
    ("label", "name"),
    [("MassProperties.translated", "by"), ("MassProperties.transformed", "translation"), ("box", "middle"), ("box", "sides"),
     ("ellipsoid", "middle"), ("ellipsoid", "semi_axes")],
)
def test_places_and_lengths_that_are_not_finite_are_named(label: str, name: str, place: int, wrong: float) -> None:
    function, given = GOOD[label]
    for value in (wrong, -1.0, 0.0) if name in ("sides", "semi_axes") else (wrong,):
        three = np.array([1.0, 2.0, 3.0])
        three[place] = value
        with pytest.raises(ValueError, match=rf"^{name} = \[.*{value}.*\]: (it|each) must be (finite|positive)"):
            function(**{**given, name: three})


@pytest.mark.parametrize("kind", [InertiaLaw.of, MassPropertiesLaw.of, gyradius.Region])
@pytest.mark.parametrize("wrong", [None, np.nan, 1, True, "law", [], [np.nan], b"x", np.zeros(3), BODY, object()])
def test_what_is_no_form_is_named(kind: Callable[[Any], Any], wrong: Any) -> None:
    with pytest.raises(ValueError, match="^(said|form) = .*: it must be a dict, as it stands in files"):
        kind(wrong)


@given(st.integers(0, 2**32 - 1))
def test_a_rotation_of_scipy_turns_regions(seed: int) -> None:
    rotation = pytest.importorskip("scipy.spatial.transform").Rotation.from_quat(np.random.default_rng(seed).normal(size=4))
    for make in (lambda attitude: gyradius.box(sides=THREE, attitude=attitude), lambda q: gyradius.ellipsoid(semi_axes=THREE, attitude=q)):
        assert make(rotation) == make(rotation.as_quat()) != make(None)
    with pytest.raises(ValueError, match=r"^attitude: its shape is \(2, 4\), and it must be \(4,\)"):
        gyradius.box(sides=1.0, attitude=[Q, Q])


class Table:
    """An array with names, as pandas has them: of a table, or of the numbers of one row."""

    name: str | None = None

    def __init__(self, values: Any, index: Any, columns: Any = None) -> None:
        self.values = np.asarray(values)
        self.index = index
        if self.values.ndim > 1:
            self.columns = columns

    def __array__(self, dtype: object = None, copy: object = None) -> np.ndarray:
        return self.values


FIRST = tuple(f"first_moment_{axis}_kg_m" for axis in (1, 2, 3))
LINEAR = (gyradius.COLUMNS[0], *FIRST, *gyradius.COLUMNS[4:])
NAMES = {"natural": gyradius.COLUMNS, "linear": LINEAR, "log-cholesky": LOG_CHOLESKY, "others": tuple("abcdefghij")}


def made(kind: str, phi: Any, cov: Any) -> Any:
    if kind == "log-cholesky":
        return MassPropertiesLaw.log_cholesky(phi, cov)
    return gyradius.from_estimate(phi, cov, form=kind)  # type: ignore[arg-type]


@settings(max_examples=40)
@given(
    st.sampled_from(sorted({*NAMES} - {"others"})),
    st.lists(st.sampled_from([None, *NAMES]), min_size=3, max_size=3),
    st.lists(st.sampled_from(["same", "turned", "two"]), min_size=3, max_size=3),
)
def test_names_of_a_mean_and_its_covariance_agree_with_each_other_and_with_the_form(
    kind: str, said: list[str | None], orders: list[str]
) -> None:
    mean = {"natural": BODY.array, "linear": BODY.linear, "log-cholesky": BODY.log_cholesky}[kind]
    cov = np.diag(np.arange(1.0, 11.0)) * 1e-8

    def names(which: str | None, order: str) -> Sequence[Any]:
        """The names of one axis; whole numbers, as tables have where nothing is said."""
        if which is None:
            return range(10)
        there = list(NAMES[which])
        if order == "turned":
            there.reverse()
        elif order == "two":
            there[4:6] = there[5:3:-1]
        return there

    named = [names(*one) for one in zip(said, orders)]
    phi, table = Table(mean, named[0]), Table(cov, named[1], named[2])
    present = [list(one) for one, which in zip(named, said) if which is not None]
    agree = all(one == present[0] for one in present)
    ours = [one for one, which in zip(present, (which for which in said if which)) if which != "others"]
    fits = all(one == list(NAMES[kind]) for one in ours)
    if agree and fits:
        assert repr(made(kind, phi, table)) == repr(made(kind, mean, cov))
    else:
        with pytest.raises(ValueError, match="^(phi|mean|cov): (its numbers are|its columns must be in the order|.* is none of its numbers)"):
            made(kind, phi, table)


def test_an_estimate_says_which_form_its_numbers_need() -> None:
    mean, cov = LAW.mean, LAW.cov
    with pytest.raises(ValueError, match='^phi: .*: these need form="natural", and form = "linear"'):
        gyradius.from_estimate(mean, cov)
    found = gyradius.from_estimate(mean, cov, form="natural")
    assert np.allclose(found.nearest.array, mean.array, rtol=1e-9, atol=1e-12)
    with pytest.raises(ValueError, match='^cov: .*: these need form="linear", and form = "natural"'):
        gyradius.from_estimate(mean, Table(cov, LINEAR, LINEAR), form="natural")


@given(st.permutations(range(6)), st.permutations(range(6)), st.permutations(range(6)))
def test_six_entries_by_their_names_stand_in_their_order(one: list[int], two: list[int], three: list[int]) -> None:
    names = gyradius.COLUMNS[4:]
    mean, cov = BODY.inertia.ravel()[SIX], np.diag(np.arange(1.0, 7.0)) * 1e-8

    def matched(phi: Any, spread: Any) -> InertiaLaw:
        return InertiaLaw.matched("correlated-entries", phi, spread)

    for first, second, third in ((one, two, three), (one, one, one), (range(6), two, three), (range(6),) * 3):
        orders = [[names[place] for place in order] for order in (first, second, third)]
        named = Table(mean, orders[0]), Table(cov, orders[1], orders[2])
        if all(order == list(names) for order in orders):
            assert matched(*named) == matched(mean, cov)
        else:
            with pytest.raises(ValueError, match="^(mean|cov): (its numbers are called|its columns must be in the order of i11, i22)"):
                matched(*named)


@given(st.sets(st.integers(0, 9), min_size=1), st.randoms())
def test_parts_of_a_table_of_bodies_stand_in_their_order(some: set[int], random: Any) -> None:
    places = sorted(some)
    random.shuffle(places)
    table = Table(MANY.array[:, places], range(30), [gyradius.COLUMNS[place] for place in places])
    function: Callable[..., Any] = {3: lambda given: MassProperties(MANY.mass, given, MANY.inertia), 10: MassProperties.of}.get(
        len(places), lambda given: gyradius.normal(0.0, 1.0).cdf(given)
    )
    if len(places) not in (3, 10) or places == {3: [1, 2, 3], 10: list(range(10))}[len(places)]:
        function(table)
    else:
        with pytest.raises(ValueError, match="^(centre|array): (its columns must be in the order of |.* is none of its numbers)"):
            function(table)


ASKED = {
    "mass": gyradius.COLUMNS[:1],
    **dict.fromkeys(("centre", "by", "translation", "point", "points", "middle", "sides", "semi_axes", "centre_std", "axis"), gyradius.COLUMNS[1:4]),
    "inertia": gyradius.COLUMNS[4:],
    **dict.fromkeys(("array", "bodies"), gyradius.COLUMNS),
    "coordinates": LOG_CHOLESKY,
    **dict.fromkeys(("rotation", "attitude"), ()),
}
"""What the numbers of an argument are called."""


@settings(max_examples=300)
@given(st.sampled_from([one for one in TAKERS if one[1] in ASKED]), st.data())
def test_names_of_other_numbers_are_refused(taker: tuple[str, str, str], data: st.DataObject) -> None:
    label, name, _ = taker
    function, given = GOOD[label]
    value = np.asarray(getattr(given[name], "array", given[name]), dtype=float)
    known = [*dict.fromkeys([*gyradius.COLUMNS, *LINEAR, *LOG_CHOLESKY])]
    count = value.shape[-1] if value.ndim > 0 else 1
    asked, start = list(ASKED[name]), data.draw(st.integers(0, len(known) - count))
    some = st.lists(st.sampled_from(known), min_size=count, max_size=count)
    names = data.draw(st.sampled_from([asked[:count] or known[:count], known[start : start + count]]) | some)
    table = Table(value, names if value.ndim == 1 else range(count), names)
    if value.ndim == 0:
        # One column of a table, which has a name of its own.
        table.name = names[0]
    if names == [one for one in asked if one in names]:
        assert repr(function(**{**given, name: table})) == repr(function(**{**given, name: value}))
    else:
        with pytest.raises(ValueError, match=f"^{name}: (its columns must be in the order of |.* is none of its numbers)"):
            function(**{**given, name: table})


@pytest.mark.parametrize("dtype", [np.float64, np.float32, np.int64])
@pytest.mark.parametrize("entry", [float, np.float64, np.float32, int])
def test_numbers_that_stand_in_a_table_of_objects_are_taken(dtype: Any, entry: Any) -> None:
    plain = (100.0 * MANY.array).astype(dtype)
    objects = np.empty(plain.shape, dtype=object)
    for place in np.ndindex(plain.shape):
        objects[place] = entry(plain[place])
    cdf = gyradius.normal(0.0, 1.0).cdf
    table = Table(objects, range(30), range(10))
    assert (cdf(table) == cdf(plain.astype(entry))).all()
    with pytest.raises(ValueError, match="^x: it must be numbers, not object"):
        cdf(objects)
    for wrong in (None, "1.5", 1j, 10**400, [1.0], BODY):
        objects[3, 4] = wrong
        with pytest.raises(ValueError, match="^x: it must be numbers: "):
            cdf(table)


@given(st.lists(st.integers(-(10**30), 10**30) | st.booleans() | st.floats(-1e30, 1e30), min_size=1), st.booleans())
def test_whole_numbers_of_any_length_are_the_nearest_floats(some: list[Any], alone: bool) -> None:
    value = some[0] if alone else some
    cdf = gyradius.normal(0.0, 1e20).cdf
    assert np.array_equal(cdf(value), cdf(np.array(list(map(float, some)))[0 if alone else ...]))
    with pytest.raises(ValueError, match="^x: it must be numbers: "):
        cdf([value, 10**400] if alone else [*value, 10**400])


def test_tables_of_pandas_that_may_lack_entries_are_tables() -> None:
    pandas = pytest.importorskip("pandas")
    table = pandas.DataFrame(MANY.array, columns=list(gyradius.COLUMNS)).convert_dtypes()
    assert MassProperties.of(table) == MANY
    table.iloc[3, 4] = pandas.NA
    with pytest.raises(ValueError, match="^array: it must be numbers: it has a NAType"):
        MassProperties.of(table)
