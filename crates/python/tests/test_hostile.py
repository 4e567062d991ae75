"""What hostile users do: odd types, orders, shapes and sizes, subclasses, arrays that should not be written to."""

from __future__ import annotations

import copy
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import bodies, inertias
from hypothesis import given
from hypothesis import strategies as st

import gyradius
from gyradius import MassProperties

SOME = bodies(np.random.default_rng(5), 6)
MATRICES = inertias(np.random.default_rng(6), 8)


def big_endian(array: np.ndarray) -> np.ndarray:
    return array.astype(array.dtype.newbyteorder(">"))


def strided(array: np.ndarray) -> np.ndarray:
    wide = np.zeros((*array.shape, 3), dtype=array.dtype)
    wide[..., 1] = array
    return wide[..., 1]


def unaligned(array: np.ndarray) -> np.ndarray:
    """Contiguous, but at an odd address, as after a header of one byte."""
    moved = np.frombuffer(b"x" + array.tobytes(), dtype=np.uint8)[1:].view(array.dtype).reshape(array.shape)
    assert not moved.flags.aligned and moved.flags.c_contiguous
    return moved


def locked(array: np.ndarray) -> np.ndarray:
    array = array.copy()
    array.flags.writeable = False
    return array


def endless() -> dict[str, Any]:
    itself: dict[str, Any] = {}
    itself["itself"] = itself
    return itself


class Mine(np.ndarray):
    """A subclass."""


WAYS = {
    "as it is": lambda a: a,
    "lists": lambda a: a.tolist(),
    "big endian": big_endian,
    "strided": strided,
    "in the order of Fortran": np.asfortranarray,
    "backward": lambda a: a[..., ::-1].copy()[..., ::-1],
    "read only": locked,
    "unaligned": unaligned,
    "a subclass": lambda a: a.view(Mine),
    "a masked array without a mask": np.ma.asarray,
    "long double": lambda a: a.astype(np.longdouble),
}


@pytest.mark.parametrize("way", WAYS)
def test_arrays_of_any_make_say_the_same(way: str) -> None:
    made = WAYS[way]
    assert gyradius.is_realizable(made(MATRICES)).tolist() == [True] * 8
    assert (gyradius.margin(made(MATRICES)) == gyradius.margin(MATRICES)).all()
    assert (MassProperties.of(made(SOME.array)).array == SOME.array).all()
    parts = MassProperties(made(np.asarray(SOME.mass)), made(SOME.centre), made(SOME.inertia))
    assert (parts.array == SOME.array).all() and type(parts.centre) is np.ndarray
    q = gyradius.uniform_attitude().rvs(6, rng=1)
    assert (SOME.rotated(made(q)).array == SOME.rotated(q).array).all()
    law, body = gyradius.uniform_attitude(), gyradius.law(SOME[0], mass="5%", moments="10%", axes="2deg")
    assert (law.logpdf(made(q)) == law.logpdf(q)).all()
    assert gyradius.normal(0.0, 1.0).cdf(made(q)).tolist() == gyradius.normal(0.0, 1.0).cdf(q).tolist()
    if way not in ("lists", "long double"):
        index = made(np.arange(6).reshape(2, 3))
        assert (body.rvs(rng=gyradius.key(7, "a", index)).array == body.rvs((2, 3), rng=gyradius.key(7, "a")).array).all()


@pytest.mark.parametrize("dtype", [np.float16, np.float32, np.int8, np.uint64, bool])
def test_narrow_and_whole_numbers_are_numbers(dtype: type) -> None:
    assert gyradius.is_realizable(np.eye(3, dtype=dtype)) is True
    body = MassProperties(dtype(1), np.zeros(3, dtype=dtype), np.eye(3, dtype=dtype))
    assert body == MassProperties(1.0, [0.0] * 3, np.eye(3))
    assert gyradius.nearest(np.eye(3, dtype=dtype)).dtype == np.float64


@pytest.mark.parametrize(
    "wrong",
    [
        np.eye(3, dtype=object),
        np.eye(3, dtype=complex),
        np.zeros((3, 3), dtype=[("a", float)]),
        np.full((3, 3), "1"),
        np.zeros((3, 3), dtype="datetime64[s]"),
        np.zeros((3, 3), dtype="timedelta64[s]"),
        np.ma.masked_array(np.eye(3), mask=np.eye(3, dtype=bool)),
        [[1, 2], [3]],
        [[None] * 3] * 3,
        {"a": 1},
        object(),
        "eye",
        None,
    ],
)
def test_what_is_no_array_of_numbers_is_a_value_error(wrong: Any) -> None:
    for call in (gyradius.is_realizable, gyradius.margin, gyradius.nearest, gyradius.report, gyradius.principal_axes):
        with pytest.raises(ValueError, match="inertia"):
            call(wrong)
    for what in ("mass", "centre", "inertia"):
        parts: dict[str, Any] = {"mass": 1.0, "centre": [0.0] * 3, "inertia": np.eye(3)}
        with pytest.raises(ValueError, match=what):
            MassProperties(**parts | {what: wrong})


@pytest.mark.parametrize("shape", [(0,), (0, 4), (3, 0)])
def test_nothing_is_many_of_nothing(shape: tuple[int, ...]) -> None:
    none = np.zeros((*shape, 3, 3))
    assert gyradius.is_realizable(none).shape == gyradius.margin(none).shape == shape
    assert gyradius.nearest(none).shape == (*shape, 3, 3)
    assert gyradius.principal_axes(none).attitude.shape == (*shape, 4)
    assert gyradius.report(none).faults.shape == shape
    empty = MassProperties(np.zeros(shape), np.zeros(3), np.eye(3))
    assert empty.shape == shape and empty.translated([1, 2, 3]).shape == shape and (empty + empty).shape == shape
    assert empty.is_realizable.shape == shape and empty.log_cholesky.shape == (*shape, 10)
    assert empty.to_mujoco().body_iquat.shape == (*shape, 4)
    assert gyradius.uniform_attitude().rvs(shape, rng=1).shape == (*shape, 4)


@pytest.mark.parametrize("size", [-1, (2, -3), 1.5, "3", (2, "3"), True, 2**48 + 1, (2**40, 2**40), 2**70])
def test_sizes_that_are_none_are_refused(size: Any) -> None:
    for law in (gyradius.uniform_attitude(), gyradius.normal(0, 1), gyradius.law(SOME[0], mass="1%")):
        with pytest.raises(ValueError, match="size"):
            law.rvs(size, rng=1)
    assert gyradius.uniform_attitude().rvs(np.array([2, 3]), rng=1).shape == (2, 3, 4)  # type: ignore[arg-type]
    with pytest.raises(MemoryError):
        gyradius.uniform_attitude().rvs(2**47, rng=1)


@pytest.mark.parametrize("bits", [np.random.MT19937, np.random.PCG64, np.random.PCG64DXSM, np.random.Philox, np.random.SFC64])
def test_generators_of_every_kind(bits: Any) -> None:
    law = gyradius.uniform_attitude()
    rng, same = np.random.Generator(bits(3)), np.random.Generator(bits(3))
    first = law.rvs(5, rng=rng)
    assert (law.rvs(5, rng=same) == first).all() and (law.rvs(5, rng=rng) != first).any()
    for wrong in (bits(3), np.random.RandomState(bits(3))):
        with pytest.raises(ValueError, match="rng"):
            law.rvs(5, rng=wrong)  # type: ignore[arg-type]


def test_what_does_not_change_is_not_changed_through_its_arrays() -> None:
    body, key = SOME[0], gyradius.key(1, "", [1, 2])
    before = hash(body), hash(key), body.array.copy()
    for array in (body.array, body.centre, np.asarray(body), SOME.mass, MassProperties.of(SOME.array).array, key.index):
        assert array is not None
        for way in (lambda a: a.setflags(write=True), lambda a: a.__setitem__((..., 0), 7.0)):
            with pytest.raises(ValueError):
                way(array)
    for again in (copy.deepcopy(body), pickle.loads(pickle.dumps(body))):
        with pytest.raises(ValueError):
            again.array.setflags(write=True)
    assert (hash(body), hash(key)) == before[:2] and (body.array == before[2]).all()
    # What is the user's own stays writeable, and is not looked at again.
    mine = np.array(SOME.array)
    made = MassProperties.of(mine)
    mine[:] = 0.0
    assert (made.array == SOME.array).all()


def test_arrays_of_bodies_as_numpy_asks_for_them() -> None:
    body = SOME[0]
    assert np.asarray(body) is body.array or np.shares_memory(np.asarray(body), body.array)
    assert not np.shares_memory(np.array(body), body.array)
    assert np.asarray(body, dtype=np.float32).dtype == np.float32
    assert body.__array__(copy=True).flags.writeable
    assert np.shares_memory(body.__array__(copy=False), body.array)
    with pytest.raises(ValueError, match="float32"):
        body.__array__(np.dtype(np.float32), copy=False)


@given(st.lists(st.integers(0, 11), min_size=1, max_size=3), st.data())
def test_indices_pick_bodies_and_never_their_numbers(shape: list[int], data: st.DataObject) -> None:
    some = MassProperties.of(np.random.default_rng(1).normal(size=(*shape, 10)))
    numbers = np.arange(np.prod(shape)).reshape(shape)
    one = st.one_of(
        st.integers(-12, 12),
        st.just(Ellipsis),
        st.none(),
        st.slices(4),
        st.lists(st.integers(-3, 3), max_size=3),
        st.just(numbers % 2 == 0),
    )
    place = data.draw(st.one_of(one, st.lists(one, max_size=4).map(tuple)))
    try:
        expected = numbers[place]
    except IndexError:
        with pytest.raises(IndexError):
            some[place]
        return
    found = some[place]
    assert (found.array == some.array.reshape(-1, 10)[expected]).all() and found.shape == np.shape(expected)
    assert not found.array.flags.writeable


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_pictures_leave_out_what_has_no_moments(bad: float) -> None:
    array = np.array(SOME.array)
    array[1, 5] = bad
    page, whole = MassProperties.of(array)._repr_html_(), SOME._repr_html_()
    assert page.count("<circle") <= whole.count("<circle") and "svg" in page
    assert "svg" in MassProperties.of(array[1:2])._repr_html_()


def test_subclasses_stay_what_they_are() -> None:
    class Link(MassProperties):
        """With a method of its own."""

        def doubled(self) -> MassProperties:
            return self + self

    globals()["Link"] = Link
    Link.__qualname__ = "Link"
    link = Link(1.0, [0.0] * 3, np.eye(3))
    for again in (link, pickle.loads(pickle.dumps(link)), copy.deepcopy(link), link.translated([1, 0, 0]), Link.of([link.array] * 2)[0]):
        assert type(again) is Link
    assert link.doubled().mass == 2.0


def test_bodies_are_added_and_are_something() -> None:
    assert sum(SOME) == SOME[0] + SOME[1] + SOME[2] + SOME[3] + SOME[4] + SOME[5]
    assert sum([SOME[0]]) is not None and bool(SOME[0]) and bool(SOME) and not bool(SOME[:0])
    for wrong in (1, 0.0, "0", None, SOME.array):
        with pytest.raises((TypeError, ValueError)):
            wrong + SOME[0]  # type: ignore[operator]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: gyradius.InertiaLaw.of(3), "^said = 3: it must be a dict"),  # type: ignore[arg-type]
        (lambda: gyradius.MassPropertiesLaw.of({"mass_kg": {"law": 3}}), r"mass_kg.*expected a text"),
        (lambda: gyradius.InertiaLaw.of({"model": "wishart", "x": 1}), "unknown key `x`"),
        (lambda: gyradius.Region({"box": 3}), "expected a dictionary"),
        (lambda: gyradius.ScalarLaw("normal", mean="f64", sigma=1.0), 'a text "f64", expected a number'),
        (lambda: gyradius.ScalarLaw("samples", samples=3), "expected a list"),
        (lambda: gyradius.law(SOME[0], mass={}), "^mass: there must be exactly one of"),
        (lambda: gyradius.law(SOME[0], mass={"percent": "a"}), "^mass: .*expected a number"),
        (lambda: gyradius.MassPropertiesLaw.joint(1, 3, roots=[1, 1, 1], axes=gyradius.uniform_attitude()), "centre = 3"),  # type: ignore[arg-type]
        (lambda: gyradius.MassPropertiesLaw.joint({}, [0, 0, 0], roots=[1, 1, 1], axes=gyradius.uniform_attitude()), "mass = {}"),
        (lambda: gyradius.InertiaLaw.principal([1, 1], gyradius.uniform_attitude()), "roots = "),
        (lambda: gyradius.InertiaLaw.principal(np.array(5), gyradius.uniform_attitude()), "roots = "),  # type: ignore[arg-type]
        (lambda: gyradius.InertiaLaw.principal([1, 1, 1], 3), "axes = 3"),  # type: ignore[arg-type]
        (lambda: gyradius.MassPropertiesLaw.naive(SOME[0], "entry-noise", 3), "law = 3"),  # type: ignore[arg-type]
        (lambda: gyradius.nearest(np.eye(3), 3), "method = 3"),  # type: ignore[arg-type]
        (lambda: gyradius.bingham(np.eye(4), order="zyx"), "order = 'zyx'"),
        (lambda: gyradius.uniform_attitude().rvs(dtype="x"), "dtype = 'x'"),
        (lambda: SOME.with_mass([1.0, 2.0]), "broadcast: mass .* bodies"),
        (lambda: MassProperties.about_point([1, 2, 3], np.zeros((2, 3)), np.eye(3)), "broadcast: mass .* centre"),
        (lambda: MassProperties.about_point(1, [0, 0], np.eye(3)), "^centre: its shape"),
        (lambda: gyradius.InertiaLaw.of(endless()), "less deep"),
    ],
)
def test_what_is_wrong_is_said_in_the_words_of_python(call: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('<robot xmlns:xacro="http://ros.org/wiki/xacro" name="a"><xacro:property name="m" value="1"/></robot>', "expand the file first"),
        ('<mujoco><include file="b.xml"/><worldbody/></mujoco>', "not followed"),
    ],
)
def test_robots_of_which_a_part_was_not_read_are_told(text: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / ("a.xacro" if "xacro" in text else "a.xml")
    file.write_text(text, encoding="utf-8")
    with pytest.warns(RuntimeWarning, match=message) as told:
        assert gyradius.load(file) == {}
    assert "gyradius check" not in str(told[0].message)
    with pytest.raises(ValueError, match=message):
        gyradius.load(file, strict=True)


@pytest.mark.parametrize("place", range(3))
@pytest.mark.parametrize("block", ['<gazebo reference="a">{}</gazebo>', '<gazebo><link name="a">{}</link></gazebo>'])
def test_an_inertia_for_gazebo_leaves_its_link_what_it_is(block: str, place: int, tmp_path: Path) -> None:
    six = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    parts = [f'<link name="{name}"><inertial><mass value="2"/>{six}</inertial></link>' for name in "ab"]
    parts.insert(place, block.format("<inertial><mass>3</mass></inertial>"))
    file = tmp_path / "a.urdf"
    file.write_text(f'<robot name="r">{"".join(parts)}</robot>', encoding="utf-8")
    with pytest.warns(RuntimeWarning) as told:
        found = gyradius.load(file)
    assert list(found) == ["a", "b"] and found["a"].mass == 2
    said = [str(one.message) for one in told]
    assert len(said) == 1 and "a: its <inertial> in a block for Gazebo" in said[0] and "left out" not in said[0]
    with pytest.raises(ValueError, match="for Gazebo"):
        gyradius.load(file, strict=True)


def test_bodies_without_a_name_and_an_inertia_are_missed(tmp_path: Path) -> None:
    file = tmp_path / "a.xml"
    inertial = '<inertial pos="0 0 0" mass="1" diaginertia="1 2 2.5"/>'
    for more, name in [("<body/>", "unnamed"), ('<body name=""/>', "unnamed"), ('<flexcomp name="f"/>', "f"), ('<body name="a"/>', "a#2")]:
        file.write_text(f'<mujoco><worldbody><body name="a">{inertial}{more}</body></worldbody></mujoco>', encoding="utf-8")
        assert list(gyradius.load(file)) == ["a"]
        with pytest.raises(ValueError, match=f"{name}: no inertia in the file"):
            gyradius.load(file, strict=True)


def test_links_that_are_left_out_are_told_of(tmp_path: Path) -> None:
    def link(name: str, mass: str, ixx: str = 'ixx="1"') -> str:
        return (
            f'<link name="{name}"><inertial><mass value="{mass}"/>'
            f'<inertia {ixx} iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        )

    file = tmp_path / "a.urdf"
    links = [link("good", "1"), link("heavy", "1kg"), link("flat", "1", ""), '<link name="world"/>']
    file.write_text(f'<robot name="a">{"".join(links)}</robot>', encoding="utf-8")
    with pytest.warns(RuntimeWarning) as told:
        assert list(gyradius.load(file)) == ["good"]
    said = [str(one.message) for one in told]
    assert len(said) == 2 and "heavy is left out" in said[0] and "flat is left out" in said[1]
    with pytest.raises(ValueError, match="heavy: .*flat: .*world: "):
        gyradius.load(file, strict=True)

    file = tmp_path / "a.xml"
    body = '<body name="a"><inertial pos="0 0 0" mass="1" diaginertia="1 2 2.5"/></body>'
    for words in ('settotalmass="5"', 'inertiafromgeom="true"', 'boundmass="3"', 'boundinertia="0.15"'):
        file.write_text(f"<mujoco><compiler {words}/><worldbody>{body}</worldbody></mujoco>", encoding="utf-8")
        told = "MuJoCo raises smaller numbers" if words.startswith("bound") else "MuJoCo takes other numbers"
        with pytest.warns(RuntimeWarning, match=told):
            gyradius.load(file)
        with pytest.raises(ValueError, match=told):
            gyradius.load(file, strict=True)


@given(
    st.lists(st.floats(-1, 1), min_size=4, max_size=4).filter(lambda q: np.linalg.norm(q) > 0.01),
    st.integers(-1074, 1023),
)
def test_quaternions_of_any_size_are_attitudes(q: list[float], power: int) -> None:
    with np.errstate(under="ignore"):
        scaled = np.ldexp(np.array(q), power)
    if not scaled.any():
        return
    # Of what is left of it so near to zero.
    exact = np.ldexp(scaled, -power) if power < -1000 else np.array(q)
    found = np.array(gyradius.fixed_attitude(scaled).form["attitude"])
    assert abs(np.linalg.norm(found) - 1) < 1e-15
    assert np.allclose(found, exact / np.linalg.norm(exact), atol=1e-14)
    assert (SOME.rotated(scaled).mass == SOME.mass).all()


def test_what_is_known_is_its_own_mean() -> None:
    q = np.array([0.5, -0.5, 0.5, 0.5])
    law = gyradius.fixed_attitude(q)
    assert law.mean.tolist() == q.tolist() and (law.cov == np.zeros((3, 3))).all()
    assert (law.rvs(3, rng=1) == q).all()


@pytest.mark.parametrize(
    ("one", "other"),
    [({"axes": "2deg"}, {"axes": "2°"})]
    + [({what: "0.01kgm2"}, {what: said}) for what in ("moments", "products") for said in ("0.01kg·m²", "0.01 kg·m²", "± 0.01 kg m²")]
    + [({"axes": "1deg, 2deg, 3deg"}, {"axes": ["1°", "2 deg", "3°"]})],
)
def test_units_as_they_are_printed(one: dict[str, Any], other: dict[str, Any]) -> None:
    assert gyradius.law(SOME[0], **one) == gyradius.law(SOME[0], **other)


def test_numbers_of_a_body_by_other_names_in_another_order_are_refused() -> None:
    pandas = pytest.importorskip("pandas")
    turned = pandas.DataFrame([SOME.array[0]], columns=list(gyradius.COLUMNS))[list(gyradius.COLUMNS)[::-1]]
    for table in (turned, turned.iloc[0]):
        with pytest.raises(ValueError, match="in the order of gyradius.COLUMNS"):
            MassProperties.of(table)
    assert MassProperties.of(turned[list(gyradius.COLUMNS)].iloc[0]) == SOME[0]
    assert MassProperties.of(pandas.Series(SOME.array[0])) == SOME[0]


def test_tables_of_arrow_are_tables() -> None:
    arrow = pytest.importorskip("pyarrow")
    table = arrow.table({name: SOME.array[:, place] for place, name in enumerate(gyradius.COLUMNS)})
    assert (MassProperties.of(table).array == SOME.array).all()
    with pytest.raises(ValueError, match="in the order of gyradius.COLUMNS"):
        MassProperties.of(table.select(list(gyradius.COLUMNS)[::-1]))


def test_equal_laws_have_equal_hashes() -> None:
    matrices = [np.diag([2.0, 3.0, 4.0]) for _ in range(2)]
    matrices[1][0, 1] = matrices[1][1, 0] = -0.0
    one, other = (gyradius.InertiaLaw.about("wishart", matrix, delta=0.1) for matrix in matrices)
    assert one == other and hash(one) == hash(other)
    assert one != gyradius.InertiaLaw.about("wishart", matrices[0], delta=0.2)


@pytest.mark.parametrize("wrong", ["a", None, [1.0, 2.0], np.eye(2), object(), 1j])
def test_numbers_that_are_none_are_named(wrong: Any) -> None:
    calls: dict[str, Any] = {
        "sigmas": lambda: gyradius.law(SOME[0], mass="5%", sigmas=wrong),
        "mean": lambda: gyradius.normal(wrong, 1.0),
        "sigma": lambda: gyradius.normal(1.0, wrong),
        "low": lambda: gyradius.uniform(wrong, 1.0),
        "high": lambda: gyradius.uniform(0.0, wrong),
        "degrees_of_freedom": lambda: gyradius.MassPropertiesLaw.pseudo_inertia_wishart(SOME[0], wrong),
    }
    if wrong is not None:
        calls["tolerance"] = lambda: gyradius.is_realizable(np.eye(3), wrong)
    for name, call in calls.items():
        with pytest.raises(ValueError, match=name):
            call()
