"""Mass properties against clouds of points, which are summed here."""

from __future__ import annotations

import copy
import pickle
from pathlib import Path

import numpy as np
import pytest
from conftest import URDF, bodies, inertias, rotations
from hypothesis import given, settings
from hypothesis import strategies as st

import gyradius
from gyradius import MassProperties


def of_points(mass: np.ndarray, place: np.ndarray) -> MassProperties:
    total = mass.sum()
    centre = mass @ place / total
    arm = place - centre
    inertia = (mass * (arm**2).sum(axis=1)).sum() * np.eye(3) - (mass[:, None] * arm).T @ arm
    return MassProperties(total, centre, inertia)


@given(st.integers(0, 2**32))
def test_what_is_done_to_points(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mass, place = rng.uniform(0.1, 2.0, size=12), rng.normal(size=(12, 3))
    body = of_points(mass, place)
    turn, move = rotations(rng, 1)[0], rng.normal(size=3)
    # The quaternion of a rotation, by its trace where that is large.
    w = 0.5 * np.sqrt(max(1.0 + np.trace(turn), 0.0))
    if w > 0.1:
        x, y, z = (turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1])
        q = np.array([x / (4 * w), y / (4 * w), z / (4 * w), w])
        moved = body.transformed(q, move)
        assert np.allclose(moved.array, of_points(mass, place @ turn.T + move).array, atol=1e-11)
        first = body.transformed(q[[3, 0, 1, 2]] * 7.0, move, order="wxyz")
        assert np.allclose(first.array, moved.array, atol=1e-13)
    assert np.allclose(body.translated(move).array, of_points(mass, place + move).array, atol=1e-11)
    one, two = of_points(mass[:5], place[:5]), of_points(mass[5:], place[5:])
    assert np.allclose((one + two).array, body.array, atol=1e-11)
    assert np.allclose((body - two).array, one.array, atol=1e-10)
    about = body.inertia_about(move)
    arm = place - move
    assert np.allclose(about, (mass * (arm**2).sum(axis=1)).sum() * np.eye(3) - (mass[:, None] * arm).T @ arm)
    assert np.allclose(MassProperties.about_point(body.mass, body.centre, about, move).array, body.array, atol=1e-10)
    pseudo = np.concatenate([place, np.ones((12, 1))], axis=1)
    assert np.allclose(body.pseudo_inertia, (mass[:, None] * pseudo).T @ pseudo)
    linear = body.linear
    assert np.allclose(linear[1:4], mass @ place)
    assert np.allclose(linear[[4, 5, 6]], np.diag(body.inertia_about(np.zeros(3))))
    points = MassProperties(mass, place, np.zeros((12, 3, 3)))
    assert np.allclose(points.sum().array, body.array, atol=1e-11)


@given(st.integers(0, 2**32))
def test_coordinates_read_back(seed: int) -> None:
    some = bodies(np.random.default_rng(seed), 30)
    for again in (
        MassProperties.from_pseudo_inertia(some.pseudo_inertia),
        MassProperties.from_log_cholesky(some.log_cholesky),
        MassProperties.of(np.asarray(some)),
        pickle.loads(pickle.dumps(some)),
        copy.deepcopy(some),
    ):
        scale = np.abs(some.array).max(axis=-1, keepdims=True)
        assert (np.abs(again.array - some.array) <= 1e-10 * scale).all()
    assert (gyradius.pseudo_inertia(some.array) == some.pseudo_inertia).all()
    assert (gyradius.log_cholesky(some) == some.log_cholesky).all()


@given(st.integers(0, 2**32))
def test_mujoco_frames(seed: int) -> None:
    some = bodies(np.random.default_rng(seed), 30)
    made = some.to_mujoco()
    w, x, y, z = made.body_iquat.T
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    ).transpose(2, 0, 1)
    again = np.einsum("nij,nj,nkj->nik", turn, made.body_inertia, turn)
    assert np.allclose(again, some.inertia, atol=1e-13)
    assert (made.body_mass == some.mass).all() and (made.body_ipos == some.centre).all()
    assert some.to_mujoco(dtype=np.float32).body_iquat.dtype == np.float32
    assert some[0].to_mujoco().body_iquat.shape == (4,)


def test_plates_and_rods_in_32_bits_stay_bodies() -> None:
    rng = np.random.default_rng(6)
    wide = inertias(rng, 500).astype(np.float32)
    # Of a program for graphics cards: plates and rods lie outside of what bodies have by the rounding, in 64 bits.
    turns = rotations(rng, 500).astype(np.float32)
    narrow = turns @ wide @ turns.transpose(0, 2, 1)
    narrow = 0.5 * (narrow + narrow.transpose(0, 2, 1))
    lost = ~gyradius.is_realizable(narrow.astype(float))
    assert lost.sum() > 50
    parts = np.float32(2.0), np.zeros(3, np.float32)
    made = MassProperties(*parts, narrow)
    table = np.zeros((500, 10), np.float32)
    table[:, 0] = 2.0
    table[:, 4:] = [[one[at] for at in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))] for one in narrow]
    assert MassProperties.of(table) == made
    assert MassProperties(*parts, list(narrow)) == made
    assert made.is_realizable.all() and made.to_mujoco().body_inertia.shape == (500, 3)
    assert (made.translated([1.0, 2.0, 3.0]) + made).is_realizable.all()
    assert (made.inertia[~lost] == narrow[~lost]).all()
    moved = np.abs(made.inertia - narrow).max(axis=(1, 2))
    assert (moved <= 7.7e-6 * np.trace(narrow, axis1=1, axis2=2)).all() and (moved[lost] > 0).all()
    # What lies further outside stays what it was said to be, and so does what comes in 64 bits.
    outside = np.diag([1.0, 1.0, 2.001]).astype(np.float32)
    made = MassProperties(*parts, outside)
    assert not made.is_realizable and (made.inertia == outside).all()
    assert MassProperties(*parts, narrow.astype(float)).is_realizable.tolist() == (~lost).tolist()


@given(st.integers(0, 2**32), st.sampled_from(["<f4", ">f4"]), st.floats(-3.0, 3.0))
def test_plates_and_rods_of_32_bits_stay_bodies_however_they_are_given(seed: int, dtype: str, far: float) -> None:
    """Of the same bodies in 64 bits, what is known of their 32 bits, about any point and as pseudo-inertias, is a body beside them."""
    rng = np.random.default_rng(seed)
    flat = inertias(rng, 100)
    mass = np.trace(flat, axis1=1, axis2=2) / 10.0 ** rng.uniform(-2, 2, 100)
    centre = 10.0**far * rng.normal(size=(100, 3)) * np.sqrt(np.trace(flat, axis1=1, axis2=2) / mass)[:, None]
    exact = MassProperties(mass, centre, flat)
    about = exact.inertia_about(np.zeros(3))
    size = np.trace(about, axis1=1, axis2=2)
    narrow = [np.asarray(one).astype(dtype) for one in (mass, centre, about, exact.pseudo_inertia, flat, exact.array)]
    at_centre = MassProperties(mass, centre, narrow[4])
    assert at_centre == MassProperties(mass, centre, narrow[4].astype("=f4"))
    made = {
        "inertia": (at_centre, np.trace(flat, axis1=1, axis2=2)),
        "of": (MassProperties.of(narrow[5]), np.trace(flat, axis1=1, axis2=2)),
        "about_point": (MassProperties.about_point(narrow[0], narrow[1], narrow[2]), size),
        "pseudo_inertia": (MassProperties.from_pseudo_inertia(narrow[3]), size),
    }
    for name, (found, rounded) in made.items():
        assert found.is_realizable.all(), name
        # Moved by no more than what 32 bits leave of the numbers that were given.
        assert (np.abs(found.inertia - flat).max(axis=(1, 2)) <= 3e-5 * rounded).all(), name
        assert (found.mass == np.asarray(found.mass, np.float32)).all() or name == "inertia"


@settings(max_examples=15)
@given(st.integers(0, 2**32), st.sampled_from(["<f4", ">f4"]), st.floats(-6.0, 6.0))
def test_arrays_of_32_bits_are_fitted_and_held_as_the_bodies_of_them(seed: int, dtype: str, size: float) -> None:
    """Plates and others of any size, whose rounding alone takes them from what bodies have; what is known of them is that of 64 bits."""
    rng = np.random.default_rng(seed)
    roots = np.diag([3.0, 2.0, 1.0]) + 0.2 * rng.normal(size=(60, 3, 3))
    roots[rng.random(60) < 0.5, :, 2] = 0.0
    second = 10.0**size * roots @ roots.transpose(0, 2, 1)
    some = np.trace(second, axis1=1, axis2=2)[:, None, None] * np.eye(3) - second
    table = np.zeros((60, 10))
    table[:, 0] = 10.0**size * rng.uniform(1.0, 2.0, 60)
    table[:, 1:4] = rng.normal(size=(60, 3))
    table[:, 4:] = [[one[at] for at in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))] for one in some]
    narrow, matrices = table.astype(dtype), some.astype(dtype)
    made = MassProperties.of(narrow)
    assert made.is_realizable.all()
    assert gyradius.MassPropertiesLaw.fit(narrow).law == gyradius.MassPropertiesLaw.fit(made).law
    assert gyradius.InertiaLaw.fit(matrices).law == gyradius.InertiaLaw.fit(made.inertia).law
    region = gyradius.ellipsoid(semi_axes=[20.0, 20.0, 20.0])
    assert (region.holds(narrow) == region.holds(made)).all() and (region.holds(made) == 1.0).all()
    # In 64 bits nothing is mended.
    wide = narrow.astype(float)
    assert (region.holds(wide) == np.where(gyradius.is_realizable(MassProperties.of(wide).inertia), region.holds(made), 0.0)).all()


@given(st.integers(0, 2**32), st.floats(-3.0, 6.0), st.floats(-3.0, 3.0))
def test_plates_and_rods_about_a_point_far_away_stay_bodies(seed: int, far: float, off: float) -> None:
    rng = np.random.default_rng(seed)
    flat = inertias(rng, 100)
    trace = np.trace(flat, axis1=1, axis2=2)
    mass = trace / 10.0 ** rng.uniform(-2, 2, 100)
    size = np.sqrt(trace / mass)[:, None]
    centre, point = (10.0**one * rng.normal(size=(100, 3)) * size for one in (far, off))
    about = MassProperties(mass, centre, flat).inertia_about(point)
    rounded = np.trace(about, axis1=1, axis2=2)
    found = MassProperties.about_point(mass, centre, about, point)
    assert found.is_realizable.all()
    assert (found.mass == mass).all() and (found.centre == centre).all()
    # Moved by no more than the rounding of what was given, and of the mass and the distance that are subtracted.
    assert (np.abs(found.inertia - flat).max(axis=(1, 2)) <= 4e-14 * rounded).all()
    # What lies outside by more than this rounding stays there.
    axes = np.linalg.eigh(flat)[1]
    outside = flat + (1e-12 * rounded + trace)[:, None, None] * axes[:, :, 2:] * axes[:, None, :, 2].reshape(100, 1, 3)
    moved = MassProperties.about_point(mass, centre, about + outside - flat, point)
    assert not moved.is_realizable.any()


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf, 1e308])
@pytest.mark.parametrize("dtype", ["f4", "f8"])
@pytest.mark.parametrize("which", range(4))
def test_what_is_not_finite_about_a_point_is_no_body(wrong: float, dtype: str, which: int) -> None:
    known = [np.array(1.0), np.ones(3), np.eye(3), np.zeros(3)]
    for place in np.ndindex(known[which].shape):
        given = [one.copy() for one in known]
        given[which][place] = wrong
        with np.errstate(over="ignore"):
            given[2] = given[2].astype(dtype)
        # One product that is large and finite is an asymmetry.
        if which == 2 and dtype == "f8" and place[0] != place[1] and np.isfinite(wrong):
            with pytest.raises(ValueError, match="^inertia: it must be symmetric"):
                MassProperties.about_point(*given)
        else:
            assert not MassProperties.about_point(*given).is_realizable


def test_what_is_no_body_for_more_than_rounding_stays_none_in_32_bits() -> None:
    outside = np.diag([1.0, 1.0, 2.001])
    second = 0.5 * np.trace(outside) * np.eye(3) - outside
    pseudo = np.eye(4)
    pseudo[:3, :3] = second
    for dtype in ("<f4", ">f4"):
        made = MassProperties.about_point(1.0, np.zeros(3), outside.astype(dtype))
        assert not made.is_realizable and (made.inertia == outside.astype("f4")).all()
        with pytest.raises(ValueError):
            MassProperties.from_pseudo_inertia(pseudo.astype(dtype))
        for entry, value in (((0, 1), 0.1), ((3, 3), -1.0), ((1, 1), np.nan)):
            wrong = np.eye(4)
            wrong[entry] = value
            with pytest.raises(ValueError):
                MassProperties.from_pseudo_inertia(wrong.astype(dtype))


def test_shapes_and_parts() -> None:
    many = MassProperties.of(bodies(np.random.default_rng(1), 12).array.reshape(3, 4, 10))
    assert many.shape == (3, 4) and len(many) == 3 and many.centre.shape == (3, 4, 3)
    assert many[1].shape == (4,) and many[1, 2].shape == () and many[:, 0].shape == (3,)
    assert [one.shape for one in many] == [(4,)] * 3
    assert (many[1, 2] + many).shape == (3, 4)
    assert many.translated(np.zeros((4, 3))) == many
    assert many.with_mass(2.0 * many.mass).inertia[0, 0] == pytest.approx(2.0 * many.inertia[0, 0])
    with pytest.raises(ValueError, match="broadcast"):
        many.translated(np.zeros((5, 3)))
    with pytest.raises(AttributeError):
        many.mass = 3.0  # type: ignore[misc]
    with pytest.raises(ValueError):
        many.array[0, 0, 0] = 1.0
    assert eval(repr(many[0, 0]), {"MassProperties": MassProperties}) == many[0, 0]
    assert "3 x 4" in repr(many) and hash(many) == hash(MassProperties.of(many.array))


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        ((1.0, [0, 0], np.eye(3)), "centre"),
        ((1.0, [0, 0, 0], np.eye(2)), "inertia"),
        ((1.0, [0, 0, 0], [[1, 2, 0], [0, 1, 0], [0, 0, 1]]), "symmetric"),
        (("heavy", [0, 0, 0], np.eye(3)), "mass"),
        ((np.ones(3), np.zeros((4, 3)), np.eye(3)), "broadcast"),
    ],
)
def test_refused(arguments: tuple[object, ...], word: str) -> None:
    with pytest.raises(ValueError, match=word):
        MassProperties(*arguments)  # type: ignore[arg-type]


def test_what_is_no_body_is_told_by_its_row() -> None:
    some = bodies(np.random.default_rng(1), 5).array.copy()
    some[3, 6] = 1e4 * some[3, 4]
    mixed = MassProperties.of(some)
    assert mixed.is_realizable.tolist() == [True, True, True, False, True]
    with pytest.raises(ValueError, match="row 3 of 5: no body has this inertia"):
        _ = mixed.pseudo_inertia
    for bad in (0.0, -1.0, np.nan, np.inf):
        some[3] = some[2]
        some[3, 0] = bad
        assert not MassProperties.of(some).is_realizable[3]


def test_plates_and_rods() -> None:
    plate = MassProperties(1.0, np.zeros(3), np.diag([1.0, 1.0, 2.0]))
    rod = MassProperties(1.0, np.zeros(3), np.diag([0.0, 1.0, 1.0]))
    for body in (plate, rod):
        assert body.is_realizable
        turned = body.rotated([0.1, 0.2, 0.3, 0.9])
        assert turned.is_realizable and (turned + body).is_realizable
        assert np.isfinite(turned.to_mujoco().body_iquat).all()
        with pytest.raises(ValueError):
            _ = body.log_cholesky


def test_robots(tmp_path: Path) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text(URDF)
    links = gyradius.load(file)
    assert list(links) == ["forearm", "hand"]
    assert links["forearm"].inertia[0].tolist() == [0.004, 0.0003, -0.0002]
    assert links["forearm"].centre.tolist() == [0.15, 0.01, -0.02]
    assert gyradius.load(str(file)) == links
    with pytest.raises(ValueError, match="frame: no inertia"):
        gyradius.load(file, strict=True)
    for path in (tmp_path / "nowhere.urdf", tmp_path / "no folder" / "näher.xml", file / "below.sdf"):
        with pytest.raises(NotADirectoryError if path.parent == file else FileNotFoundError) as told:
            gyradius.load(path)
        # As `open` says it.
        with pytest.raises(OSError) as expected:
            path.open()
        assert type(told.value) is type(expected.value) and told.value.args == expected.value.args
        assert told.value.filename == str(path)
    for folder in (tmp_path, str(tmp_path)):
        with pytest.raises(IsADirectoryError) as told_of_folder:
            gyradius.load(folder)
        assert told_of_folder.value.filename == str(tmp_path)
    locked = tmp_path / "locked.urdf"
    locked.write_text(URDF)
    locked.chmod(0)
    try:
        locked.read_text()
    except PermissionError:
        with pytest.raises(PermissionError):
            gyradius.load(locked)
    (tmp_path / "bad.urdf").write_text("<robot")
    with pytest.raises(ValueError):
        gyradius.load(tmp_path / "bad.urdf")


def test_regions() -> None:
    ball = MassProperties(2.0, np.zeros(3), 0.4 * 2.0 * 0.01 * np.eye(3))
    assert gyradius.ellipsoid(semi_axes=[0.11, 0.11, 0.11]).holds(ball) == 1.0
    assert gyradius.ellipsoid([0.5, 0, 0], semi_axes=[0.11] * 3).holds(ball) == 0.0
    wide = gyradius.box(sides=[0.3, 0.3, 0.3])
    assert wide.holds(ball) == 1.0
    corners = np.array(np.meshgrid(*[[-0.15, 0.15]] * 3)).reshape(3, -1).T
    assert gyradius.hull(corners).holds(ball) == 1.0
    assert pickle.loads(pickle.dumps(wide)) == wide and hash(wide) == hash(gyradius.box(sides=0.3))
    for bad in ({"sides": [1, 2]}, {"sides": [1, 1, -1]}, {"sides": [1, 1, np.nan]}):
        with pytest.raises(ValueError):
            gyradius.box(**bad)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="points"):
        gyradius.hull(np.zeros(3))
    for turn in ([[0, 0, 0, 1], [1, 0, 0, 0]], [[0, 0, 0, 1]], [0, 0, 1], np.zeros((0, 4)), 1.0):
        with pytest.raises(ValueError, match="attitude: its shape is"):
            gyradius.box(sides=1, attitude=turn)
        with pytest.raises(ValueError, match="attitude: its shape is"):
            gyradius.ellipsoid(semi_axes=1, attitude=turn)


def test_rods_have_no_negative_moments_in_simulators() -> None:
    along = np.random.default_rng(0).normal(size=(2000, 3))
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    rods = MassProperties(1.0, np.zeros(3), np.eye(3) - along[:, :, None] * along[:, None, :])
    assert rods.is_realizable.all()
    assert (rods.to_mujoco().body_inertia >= 0.0).all()


def test_zeros_of_either_sign_and_masses() -> None:
    one, two = (MassProperties(1.0, [zero, 0.0, 0.0], np.eye(3)) for zero in (0.0, -0.0))
    assert one == two and hash(one) == hash(two)
    for bad in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(ValueError, match="mass"):
            one.with_mass(bad)
    with pytest.raises(ValueError, match="mass"):
        MassProperties(0.0, np.zeros(3), np.eye(3)).with_mass(1.0)


def test_tables_with_the_ten_in_another_order_are_refused() -> None:
    some = bodies(np.random.default_rng(1), 5).array

    class Table:
        """As that of pandas: an array with names."""

        def __init__(self, order: list[int]) -> None:
            self.columns = [gyradius.COLUMNS[i] for i in order]
            self.order = order

        def __array__(self, dtype: object = None, copy: object = None) -> np.ndarray:
            return some[:, self.order]

    assert MassProperties.of(Table(list(range(10)))).array.tolist() == some.tolist()
    with pytest.raises(ValueError, match="order of gyradius.COLUMNS"):
        MassProperties.of(Table(list(range(9, -1, -1))))
