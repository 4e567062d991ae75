"""Robots: their links as bodies, and the laws of all of them."""

from __future__ import annotations

import json
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from conftest import bodies, inertias
from hypothesis import given
from hypothesis import strategies as st

import gyradius
from gyradius import MassProperties, key

SAID = {"mass": "10%", "centre": "5mm", "moments": "15%", "axes": "5deg"}


def urdf(links: dict[str, MassProperties]) -> str:
    """A robot of these links."""
    text = ""
    for name, link in links.items():
        x, y, z = link.centre.tolist()
        entries = " ".join(f'{entry}="{float(number)!r}"' for entry, number in zip(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), link.array[4:]))
        text += (
            f'<link name="{name}"><inertial><origin xyz="{x!r} {y!r} {z!r}"/><mass value="{float(link.mass)!r}"/>'
            f"<inertia {entries}/></inertial></link>\n"
        )
    return f'<robot name="r">\n{text}</robot>\n'


def weightless(inertia: object = np.zeros((3, 3))) -> MassProperties:
    return MassProperties(0.0, [0.1, 0.0, 0.0], inertia)  # type: ignore[arg-type]


@given(st.integers(0, 2**32 - 1), st.integers(1, 5), st.sets(st.sampled_from(list(SAID)), min_size=1), st.floats(0.5, 3.0))
def test_the_laws_of_a_robot_are_those_of_its_links(seed: int, count: int, parts: set[str], sigmas: float) -> None:
    """Bodies with a volume, plates and rods; and links without mass among them, with and without inertia."""
    rng = np.random.default_rng(seed)
    several = bodies(rng, count)
    flat = MassProperties(rng.uniform(0.1, 5.0, size=count), rng.normal(size=(count, 3)), inertias(rng, count))
    links = {f"solid {place}": several[place] for place in range(count)} | {f"any {place}": flat[place] for place in range(count)}
    links |= {"tool0": weightless(), "base": weightless(np.eye(3))}
    order = rng.permutation(list(links)).tolist()
    robot = {name: links[name] for name in order}
    said = {part: SAID[part] for part in parts}
    with pytest.warns(RuntimeWarning) as told:
        laws = gyradius.laws(robot, **said, sigmas=sigmas)
    assert len(told) == 1 and told[0].filename == __file__
    left_out = ", ".join(f'"{name}"' for name in order if links[name].mass == 0)
    assert str(told[0].message).endswith(f": {left_out}")
    assert list(laws) == [name for name in order if links[name].mass > 0]
    for name, law in laws.items():
        alone = gyradius.law(robot[name], **said, sigmas=sigmas)
        assert law == alone and law.form == alone.form and law.warnings == alone.warnings
        for inset in (False, True):
            drawn = [one.rvs(5, rng=key(7, name), inset=inset).array for one in (law, alone)]
            assert drawn[0].tobytes() == drawn[1].tobytes()
    del robot["tool0"], robot["base"]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert list(gyradius.laws(robot, **said, sigmas=sigmas)) == list(laws)


def test_the_laws_of_a_robot_draw_what_the_program_draws(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    some = bodies(rng, 5)
    links = {"base": weightless()} | {f"arm {place}": some[place] for place in range(5)}
    links["plate"] = MassProperties(2.0, [0.0, 0.1, 0.0], np.diag([0.25, 0.25, 0.5]))
    (tmp_path / "r.urdf").write_text(urdf(links))
    flags = [word for name, amount in SAID.items() for word in (f"--{name}", amount)]
    program = [sys.executable, "-m", "gyradius", "draw", "r.urdf", "-n", "20", *flags, "--seed", "7", "-o", "links.jsonl"]
    subprocess.run(program, cwd=tmp_path, check=True, capture_output=True)
    rows = [json.loads(line) for line in (tmp_path / "links.jsonl").read_text().splitlines()]
    with pytest.warns(RuntimeWarning, match='mass of 0 kg .*: "base"$'):
        laws = gyradius.laws(gyradius.load(tmp_path / "r.urdf"), **SAID)
    for name, law in laws.items():
        theirs = [[row[column] for column in gyradius.COLUMNS] for row in rows if row["link"] == name]
        assert (law.rvs(20, rng=key(7, name), inset=True).array == np.array(theirs)).all()
    assert {row["link"] for row in rows} == set(laws)


def test_all_links_that_have_no_law_are_named() -> None:
    good = MassProperties(1.0, [0, 0, 0], np.diag([0.02, 0.03, 0.04]))
    robot = {
        "base": weightless(),
        "flat": MassProperties(1.0, [0, 0, 0], np.diag([1.0, 1.0, 2.5])),
        "good": good,
        "lost": MassProperties(-1.0, [0, 0, 0], np.eye(3)),
        "nowhere": MassProperties(1.0, [np.nan, 0, 0], np.eye(3)),
    }
    with pytest.raises(ValueError, match=r'^3 of 5 links have no law: "flat": .*; "lost": mass = -1.0 kg.*; "nowhere": ') as told:
        gyradius.laws(robot, mass="10%")
    assert "good" not in str(told.value) and "base" not in str(told.value)
    for name in ("flat", "lost", "nowhere"):
        with pytest.raises(ValueError) as alone:
            gyradius.law(robot[name], mass="10%")
        assert f'"{name}": {alone.value}' in str(told.value)
    # What is wrong with a statement is said once, and without a link.
    with pytest.raises(ValueError, match=r'^mass = "10": it must be'):
        gyradius.laws(robot, mass="10")
    for wrong in ([good], good, None, {"a": good.array}, {"a": MassProperties.of([good.array] * 2)}):
        with pytest.raises(ValueError, match=r"^robot"):
            gyradius.laws(wrong, mass="10%")  # type: ignore[arg-type]
    assert gyradius.laws({}, mass="10%") == {}


NAMED = [*(f"iso8859_{part}" for part in range(1, 17) if part != 12), *(f"cp125{part}" for part in range(9))]


@pytest.mark.parametrize("codec", NAMED)
def test_names_have_the_characters_of_their_encoding(codec: str, tmp_path: Path) -> None:
    """Every byte beyond ASCII against the codec of Python, and the stream of random numbers of such a name."""
    declared = codec.replace("iso8859_", "ISO-8859-").replace("cp", "windows-")
    names = {}
    for byte in range(0xA0 if codec.startswith("iso") else 0x80, 0x100):
        try:
            names[f"link {bytes([byte]).decode(codec)}"] = byte
        except UnicodeDecodeError:
            continue
    body = MassProperties(1.0, [0, 0, 0], np.diag([0.02, 0.03, 0.04]))
    text = f'<?xml version="1.0" encoding="{declared}"?>\n{urdf(dict.fromkeys(names, body))}'
    (tmp_path / "r.urdf").write_bytes(text.encode(codec))
    robot = gyradius.load(tmp_path / "r.urdf")
    assert list(robot) == list(names) and len(names) > 40
    picked = list(names)[-1]
    program = [sys.executable, "-m", "gyradius", "draw", "r.urdf", "-n", "3", "--mass", "10%", "--seed", "7", "--links", picked]
    subprocess.run([*program, "-o", "links.jsonl"], cwd=tmp_path, check=True, capture_output=True)
    rows = [json.loads(line) for line in (tmp_path / "links.jsonl").read_text(encoding="utf-8").splitlines()]
    assert [row["link"] for row in rows] == [picked] * 3
    drawn = gyradius.law(robot[picked], mass="10%").rvs(3, rng=key(7, picked))
    assert [row["mass_kg"] for row in rows] == drawn.mass.tolist()


def test_regions_belong_to_links() -> None:
    body = MassProperties(1.0, [0, 0, 0], np.diag([0.02, 0.03, 0.04]))
    robot, box = {"a": body, "b": body}, gyradius.box(sides=[0.7, 0.7, 0.7])
    laws = gyradius.laws(robot, mass="10%", centre="5cm", inside={"a": box})
    assert laws["a"] == gyradius.law(body, mass="10%", centre="5cm", inside=box) != laws["b"]
    assert laws["b"] == gyradius.law(body, mass="10%", centre="5cm")
    for wrong, message in (({"c": box}, "no link 'c'"), (box, "it must be a dict of regions"), ({"a": 3}, r"inside\['a'\] = 3")):
        with pytest.raises(ValueError, match=message):
            gyradius.laws(robot, mass="10%", inside=wrong)  # type: ignore[arg-type]


@given(st.floats(-3.0, 3.0), st.floats(-2.0, 2.0), st.floats(0.2, 5.0), st.sampled_from(["mass", "moments", "products"]), st.booleans())
def test_what_is_beyond_a_body_is_refused_in_any_unit(size: float, ratio: float, sigmas: float, part: str, as_dict: bool) -> None:
    scale, ratio = 10.0**size, 10.0**ratio
    body = MassProperties(scale, [0, 0, 0], scale * np.diag([0.02, 0.03, 0.04]))
    limit = scale if part == "mass" else 10.0 * scale * 0.09
    amount = float(limit * ratio * sigmas)
    unit = ("kg", "kg") if part == "mass" else ("kg_m2", "kgm2")
    said = {part: {unit[0]: amount} if as_dict else f"{amount!r}{unit[1]}"}
    if ratio > 1.0:
        for call in (lambda: gyradius.law(body, **said, sigmas=sigmas), lambda: gyradius.laws({"a": body}, **said, sigmas=sigmas)):  # type: ignore[arg-type]
            with pytest.raises(ValueError, match=f"{part}.*: a standard deviation of .* is stated, and it must be at most"):
                call()
    elif part == "mass" or ratio < 0.1:
        assert gyradius.law(body, **said, sigmas=sigmas).std is not None  # type: ignore[arg-type]
