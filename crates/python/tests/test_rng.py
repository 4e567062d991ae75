"""Random numbers: whose they are, and that nothing but their key decides them."""

from __future__ import annotations

import copy
import json
import os
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import URDF
from hypothesis import given
from hypothesis import strategies as st

import gyradius
from gyradius import MassProperties, key, normal


def law() -> gyradius.MassPropertiesLaw:
    lengths = [normal(0.12, 0.006), normal(0.03, 0.0015), normal(0.02, 0.001)]
    axes = gyradius.small_rotations([0, 0, 0, 1], np.eye(3) * 3e-3)
    return gyradius.MassPropertiesLaw.joint(normal(2.4, 0.1), [0.1, 0.0, 0.0], gyration_lengths=lengths, axes=axes)


@given(st.integers(0, 2**64 - 1), st.text(max_size=20), st.lists(st.integers(0, 2**40), max_size=50))
def test_a_draw_depends_on_its_key_alone(seed: int, term: str, places: list[int]) -> None:
    some = gyradius.uniform_attitude()
    together = some.rvs(rng=key(seed, term, np.array(places, dtype=np.uint64)))
    alone = [some.rvs(rng=key(seed, term, place)) for place in places]
    assert together.shape == (len(places), 4)
    assert all((one == other).all() for one, other in zip(together, alone))
    assert (some.rvs(5, rng=key(seed, term)) == some.rvs(rng=key(seed, term, range(5)))).all()


def test_integers_are_keys_without_a_term() -> None:
    whole = law().rvs(3000, rng=7).array
    assert (law().rvs(3000, rng=key(7)).array == whole).all()
    assert (law().rvs((30, 100), rng=np.int32(7)).array.reshape(-1, 10) == whole).all()
    assert (law().rvs(17, rng=7).array == whole[:17]).all()
    # In pieces, in any order.
    order = np.random.default_rng(1).permutation(3000)
    pieces = np.concatenate([law().rvs(rng=key(7, "", part)).array for part in np.array_split(order, 7)])
    assert (pieces == whole[order]).all()
    for other in (8, key(7, "a")):
        assert not np.isin(law().rvs(3000, rng=other).mass, whole[:, 0]).any()


def test_the_number_of_threads_changes_nothing(tmp_path: Path) -> None:
    program = (
        "import sys; sys.path.insert(0, sys.argv[1]); import test_rng, hashlib;"
        "print(hashlib.sha256(test_rng.law().rvs(20000, rng=7).array.tobytes()).hexdigest())"
    )
    found = set()
    for threads in ("1", "2", "3", "8"):
        run = [sys.executable, "-c", program, str(Path(__file__).parent)]
        environment = {**os.environ, "RAYON_NUM_THREADS": threads}
        found.add(subprocess.run(run, env=environment, capture_output=True, text=True, check=True).stdout)
    assert len(found) == 1


def test_generators_and_seed_sequences() -> None:
    some = gyradius.uniform_attitude()
    one, two = np.random.default_rng(5), np.random.default_rng(5)
    assert (some.rvs(10, rng=one) == some.rvs(10, rng=two)).all()
    assert (some.rvs(10, rng=one) != some.rvs(10, rng=7)).any()
    # A generator goes on by four words a call, however much is drawn.
    assert one.random() != np.random.default_rng(5).random()
    three, four = np.random.default_rng(5), np.random.default_rng(5)
    some.rvs(1, rng=three)
    some.rvs(10_000, rng=four)
    assert three.random() == four.random()
    children = np.random.SeedSequence(1).spawn(2)
    drawn = [some.rvs(10, rng=child) for child in children]
    assert (drawn[0] != drawn[1]).any()
    assert (some.rvs(10, rng=np.random.SeedSequence(1).spawn(2)[1]) == drawn[1]).all()
    assert (some.rvs(10) != some.rvs(10)).any()


@pytest.mark.parametrize("rng", [-1, 2**64, 1.5, "7", True, [1, 2], np.random.RandomState(1)])
def test_what_is_no_source(rng: object) -> None:
    with pytest.raises(ValueError, match="rng"):
        gyradius.uniform_attitude().rvs(3, rng=rng)  # type: ignore[arg-type]


@pytest.mark.parametrize("size", [-1, 1.5, "3", (2, -1), True, 2**60, (2**30, 2**30)])
def test_what_is_no_size(size: object) -> None:
    with pytest.raises(ValueError, match="size"):
        gyradius.uniform_attitude().rvs(size, rng=1)  # type: ignore[arg-type]


def test_keys() -> None:
    one = key(7, "hand", [1, 2])
    assert one == key(7, "hand", np.array([1, 2])) and hash(one) == hash(copy.copy(one))
    assert pickle.loads(pickle.dumps(one)) == one and one != key(7, "hand") and key(7) != key(8)
    assert eval(repr(key(7, "hand"))) == key(7, "hand")
    with pytest.raises(AttributeError):
        one.seed = 8  # type: ignore[misc]
    with pytest.raises(ValueError, match="size"):
        gyradius.uniform_attitude().rvs(3, rng=one)
    for bad in ((-1,), (1, 2), (1, "a", [-1]), (1, "a", [0.5]), (1.0,)):
        with pytest.raises(ValueError):
            key(*bad)  # type: ignore[arg-type]


def test_the_program_draws_the_same_bits(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(URDF)
    links = gyradius.load(tmp_path / "arm.urdf")
    flags = ["--mass", "10%", "--centre", "5mm", "--moments", "15%", "--axes", "5deg", "--seed", "7"]
    program = [sys.executable, "-m", "gyradius", "draw", "arm.urdf", "-n", "50", *flags, "-o", "links.jsonl"]
    subprocess.run(program, cwd=tmp_path, check=True, capture_output=True)
    rows = [json.loads(line) for line in (tmp_path / "links.jsonl").read_text().splitlines()]
    assert len(rows) == 100
    for name, link in links.items():
        stated = gyradius.law(link, mass="10%", centre="5mm", moments="15%", axes="5deg")
        drawn = stated.rvs(50, rng=key(7, name)).array
        mine = [row for row in rows if row["link"] == name]
        theirs = np.array([[row[column] for column in row if column not in ("link", "draw")] for row in mine])
        assert theirs.shape == drawn.shape
        assert (theirs == drawn).all()
        # Nothing here is near to the boundary.
        assert (stated.rvs(50, rng=key(7, name), inset=True).array == drawn).all()


FLAT = """<robot name="flat">
  <link name="plate"><inertial><origin xyz="0.1 0 0"/><mass value="1.5"/>
    <inertia ixx="0.25" ixy="0.125" ixz="0" iyy="0.25" iyz="0" izz="0.5"/></inertial></link>
  <link name="rod"><inertial><mass value="0.6"/>
    <inertia ixx="0" ixy="0" ixz="0" iyy="0.002" iyz="0" izz="0.002"/></inertial></link>
  <link name="ball"><inertial><mass value="2"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
</robot>
"""


@pytest.mark.parametrize(
    "said", [{"moments": "10%"}, {"mass": "5%"}, {"centre": "5mm"}, {"axes": "2deg"}, {"mass": "5%", "axes": "2deg", "moments": "1%"}]
)
def test_the_program_moves_plates_and_rods_inside_and_so_does_inset(said: dict[str, str], tmp_path: Path) -> None:
    (tmp_path / "flat.urdf").write_text(FLAT)
    flags = [word for name, amount in said.items() for word in (f"--{name}", amount)]
    program = [sys.executable, "-m", "gyradius", "draw", "flat.urdf", "-n", "40", *flags, "--seed", "7", "-o", "links.jsonl"]
    subprocess.run(program, cwd=tmp_path, check=True, capture_output=True)
    rows = [json.loads(line) for line in (tmp_path / "links.jsonl").read_text().splitlines()]
    moved = 0
    for name, link in gyradius.load(tmp_path / "flat.urdf").items():
        stated = gyradius.law(link, mass=said.get("mass"), centre=said.get("centre"), moments=said.get("moments"), axes=said.get("axes"))
        mine = [row for row in rows if row["link"] == name]
        theirs = np.array([[row[column] for column in row if column not in ("link", "draw")] for row in mine])
        for law in (stated, pickle.loads(pickle.dumps(stated))):
            drawn = law.rvs((8, 5), rng=key(7, name), inset=True)
            assert (drawn.array.reshape(-1, 10) == theirs).all()
        plain = stated.rvs((8, 5), rng=key(7, name))
        changes = (plain.array != drawn.array).any(axis=-1)
        moved += int(changes.sum())
        assert not (name == "ball" and changes.any())
        # By a hair.
        assert np.allclose(plain.array, drawn.array, rtol=0, atol=1e-8)
    assert moved > 0


def test_bits_of_rust() -> None:
    """The numbers are those of `tests/python_vectors.rs`, which draws them without Python."""
    vectors = json.loads((Path(__file__).parent / "vectors.json").read_text())
    body = MassProperties.of(vectors["body"])
    stated = gyradius.law(body, mass="5%", centre="1cm", moments="10%", axes="2deg")
    laws = {"stated": stated, "joint": gyradius.MassPropertiesLaw.of(vectors["joint"])}
    for name, made in laws.items():
        for place, expected in vectors["draws"][name].items():
            drawn = made.rvs(rng=key(vectors["seed"], vectors["term"], int(place))).array
            assert drawn.tolist() == expected


def test_whole_numbers_up_to_the_largest_are_places() -> None:
    both = gyradius.key(1, index=[2**64 - 1, 0])
    assert both.index is not None and both.index.tolist() == [2**64 - 1, 0]
    one = gyradius.key(1, index=2**64 - 1)
    assert one.index is not None and one.index.tolist() == 2**64 - 1
    for wrong, named in [([2**64], "18446744073709551616"), ([-1, 2**63], "-1"), ([1.5], "float64"), ([True], "bool")]:
        with pytest.raises(ValueError, match=named):
            gyradius.key(1, index=wrong)
