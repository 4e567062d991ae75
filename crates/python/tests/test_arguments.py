"""Arguments of every kind: those that are wrong are named with what is allowed, and those that work have a type."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_study import NORMAL, double, scenario

import gyradius
from gyradius import MassPropertiesLaw, normal, uniform_attitude

BODY = gyradius.MassProperties(2.0, [0.1, 0.0, 0.0], np.diag([0.002, 0.01, 0.011]))
OUTPUTS = {"y": "m", "z": "1"}
HALF = "\ud800"


def joint(**keys: Any) -> MassPropertiesLaw:
    laws = [normal(one, 0.1 * one) for one in (0.12, 0.05, 0.04)]
    return MassPropertiesLaw.joint(normal(2.0, 0.1), [0.1, 0.0, 0.0], gyration_lengths=laws, axes=uniform_attitude(), **keys)


def study(**keys: Any) -> gyradius.Study:
    return gyradius.study(scenario(), double, outputs=OUTPUTS, **keys)


@pytest.mark.parametrize("way", [tuple, iter, np.array, dict.fromkeys, lambda names: (name for name in names)])
def test_columns_may_be_whatever_gives_names(way: Callable[[list[str]], Iterable[str]]) -> None:
    given = way(["y", "x"])
    if isinstance(given, dict):
        with pytest.raises(ValueError, match="^columns = .*: it must be a list of names"):
            study(columns=given)
        return
    assert list(study(columns=given).to_numpy()["all"]) == list(study(columns=["y", "x"]).to_numpy()["all"])
    assert "y" in study(columns=["y", "x"]).to_numpy()["all"]


@pytest.mark.parametrize("wrong", ["y", b"y", 3, True, np.array("y"), iter([3]), {"y": "m"}, [b"y"]])
def test_columns_that_are_no_names_are_refused(wrong: Any) -> None:
    with pytest.raises(ValueError, match="^columns = .*: it must be a list of names"):
        study(columns=wrong)


@pytest.mark.parametrize("kept", [[], ["y"], ["x", "z"], ["z", "y", "x"]])
@pytest.mark.parametrize("rows", ["all", "failed", "none"])
def test_columns_tell_what_a_run_fills_whatever_is_kept(kept: list[str], rows: str) -> None:
    whole, part = study(), study(columns=kept, rows=rows)
    assert part.columns == whole.columns and part.units == whole.units
    assert list(whole.columns) == list(whole.to_numpy()["all"])
    assert set(part.to_numpy()["all"]) <= set(part.columns)


SCALARS = ("mass", "centre1", "centre2", "centre3", "shape1", "shape2", "shape3")


@pytest.mark.parametrize("by_length", [True, False])
@pytest.mark.parametrize("pair", [(one, other) for one in SCALARS for other in SCALARS if one < other])
@pytest.mark.parametrize("varying", [set(), {0}, {1}, {0, 1}])
def test_numbers_have_no_correlation(by_length: bool, pair: tuple[str, str], varying: set[int]) -> None:
    given: dict[str, Any] = dict(zip(SCALARS, [2.0, 0.1, 0.2, 0.3, 0.3, 0.25, 0.2]))
    for place in varying:
        given[pair[place]] = gyradius.normal(given[pair[place]], 0.01)
    mass, *others = given.values()
    shape = {"gyration_lengths" if by_length else "roots": others[3:]}

    def made() -> gyradius.MassPropertiesLaw:
        return gyradius.MassPropertiesLaw.joint(
            mass, others[:3], axes=gyradius.uniform_attitude(), correlations=[(*pair, 0.5)], **shape
        )

    if len(varying) == 2:
        made()
        return
    fixed = next(name for place, name in enumerate(pair) if place not in varying)
    with pytest.raises(ValueError, match=rf"^correlations\[0\] = .*: {fixed} is the number .*, which does not vary"):
        made()


@pytest.mark.parametrize("by_length", [True, False])
@pytest.mark.parametrize("pair", [(one, other) for one in SCALARS for other in SCALARS if one < other])
@pytest.mark.parametrize("still", [set(), {0}, {1}, {0, 1}])
def test_laws_without_a_deviation_have_no_correlation(by_length: bool, pair: tuple[str, str], still: set[int]) -> None:
    given: dict[str, Any] = dict(zip(SCALARS, [2.0, 0.1, 0.2, 0.3, 0.3, 0.25, 0.2]))
    for place, name in enumerate(pair):
        given[name] = gyradius.normal(given[name], 0.0 if place in still else 0.01)
    mass, *others = given.values()
    shape = {"gyration_lengths" if by_length else "roots": others[3:]}

    def made(**keys: Any) -> gyradius.MassPropertiesLaw:
        return gyradius.MassPropertiesLaw.joint(mass, others[:3], axes=gyradius.uniform_attitude(), **keys, **shape)

    tied = {**made().form, "correlations": [[*pair, 0.5]]}
    for way in (lambda: made(correlations=[(*pair, 0.5)]), lambda: gyradius.MassPropertiesLaw.of(tied)):
        if not still:
            assert way() == gyradius.MassPropertiesLaw.of(way().form) != made()
            continue
        with pytest.raises(ValueError, match=f"correlation of {pair[0]} and {pair[1]}: {pair[min(still)]} does not vary"):
            way()


@pytest.mark.parametrize("way", [tuple, iter, lambda pairs: (pair for pair in pairs), lambda pairs: [list(pair) for pair in pairs]])
def test_correlations_may_be_whatever_gives_pairs(way: Callable[[list[Any]], Any]) -> None:
    pairs = [("mass", "shape1", 0.6), ("mass", "shape2", np.float32(0.25))]
    assert joint(correlations=way(pairs)) == joint(correlations=pairs) != joint()


@pytest.mark.parametrize(
    "wrong",
    [
        True,
        False,
        3,
        "mass",
        "",
        {"mass": 1, "centre1": 2, "shape1": 3},
        {},
        np.array([("mass", "shape1", 0.6)], dtype=object),
        np.array(3),
        BODY,
        [("mass", "shape1")],
        ["abc"],
        [("mass", "shape1", "0.6")],
        [(1, "shape1", 0.6)],
    ],
)
def test_correlations_that_are_none_are_refused(wrong: Any) -> None:
    with pytest.raises(ValueError, match=r"^correlations.*: it must be (a list of pairs|two names and a number|numbers|a text)"):
        joint(correlations=wrong)


def with_law(law: Any) -> dict[str, Any]:
    return scenario(quantities=[{"name": "u", "law": NORMAL}, {"name": "x", "unit": "m", "law": law}])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: MassPropertiesLaw.maximum_entropy(BODY, mass_delta=0.1, centre_std=0.01, delta=0.1, inside="box"), "^inside = 'box': it must be a Region"),  # type: ignore[arg-type]
        (lambda: joint(inside="box"), "^inside = 'box': it must be a Region"),
        (lambda: joint(inertia=3), "^inertia = 3: it must be an InertiaLaw"),
        (lambda: MassPropertiesLaw.naive(BODY, None, normal(1, 0.1)), "^rule = None: it must be a text"),  # type: ignore[arg-type]
        (lambda: MassPropertiesLaw.naive(3, "scale-all", normal(1, 0.1)), "^nominal = 3: it must be one MassProperties"),  # type: ignore[arg-type]
        (lambda: MassPropertiesLaw.pseudo_inertia_wishart("a", 9.0), "^mean = 'a': it must be one MassProperties"),  # type: ignore[arg-type]
        (lambda: study().replay(1, model=3), "^model = 3: it must be a text"),  # type: ignore[arg-type]
        (lambda: gyradius.key(1, HALF), r"^term = '\\ud800': it must be a text that UTF-8 can hold"),
        (lambda: gyradius.key(1, f"a{HALF}b"), "^term = "),
        (lambda: gyradius.nearest(np.eye(3), HALF), "^method = "),  # type: ignore[arg-type]
        (lambda: study(out=5), "^out = 5: it must be a path"),
        (lambda: study(out=b"x"), "^out = b'x': it must be a path"),
        (lambda: gyradius.study(BytesPath(), double), "^scenario = .*: it must be a path"),
        (lambda: gyradius.load(5), "^path = 5: it must be a path"),  # type: ignore[arg-type]
        (lambda: gyradius.study(with_law(uniform_attitude()), double), r"^quantities\[2\]\.law = <AttitudeLaw.*: it must be a ScalarLaw"),
        (lambda: gyradius.study(with_law(gyradius.law(BODY, mass="1%")), double), r"^quantities\[2\]\.law = <StatedLaw.*: it must be a ScalarLaw"),
        (lambda: gyradius.law(BODY, mass="5%").rvs(3, 1, inset="no"), "^inset = 'no': it must be True or False"),  # type: ignore[arg-type]
        (lambda: gyradius.load(Path("none.urdf"), strict=1), "^strict = 1: it must be True or False"),  # type: ignore[arg-type]
        (lambda: uniform_attitude().rvs(3, order=np.array(["xyzw", "wxyz"])), "^order = "),  # type: ignore[arg-type]
        (lambda: gyradius.from_estimate(np.zeros(10), np.eye(10), form=np.array([1, 2])), "^form = "),  # type: ignore[arg-type]
    ],
)
def test_what_is_wrong_is_named(call: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()


class BytesPath(os.PathLike):  # type: ignore[type-arg]
    """A path that is no text."""

    def __fspath__(self) -> bytes:
        return b"x"


def test_what_is_right_is_taken(tmp_path: Path) -> None:
    law = gyradius.law(BODY, mass="5%")
    assert law.rvs(3, 1, inset=np.True_) == law.rvs(3, 1, inset=True)  # type: ignore[arg-type]
    assert gyradius.key(1, "é𝄞").term == "é𝄞"
    one = study(out=str(tmp_path / "out"), force=np.False_)
    assert one.folder == tmp_path / "out" and one.replay(1, model="all").run == 1
    assert gyradius.study(with_law(normal(1.0, 0.25)), double, outputs=OUTPUTS).runs == {"all": 100}


LIMITED = """
import resource, sys, gyradius
# What reads without end gets no memory, and does not take that of others.
resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))
for more in ({}, {"outputs": {"y": "m"}}):
    for simulation in (None, lambda inputs: {"y": 1.0}):
        try:
            gyradius.study(sys.argv[1], simulation, **more)
        except OSError as error:
            print(error)
"""


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="files that are not regular")
@pytest.mark.parametrize("kind", ["device", "pipe", "large"])
def test_scenarios_are_read_from_regular_files_alone(kind: str, tmp_path: Path) -> None:
    path = Path("/dev/zero") if kind == "device" else tmp_path / "scenario.toml"
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "large":
        path.write_bytes(b"#" * ((16 << 20) + 1))
    environment = {**os.environ, "RAYON_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    run = [sys.executable, "-c", LIMITED, str(path)]
    done = subprocess.run(run, capture_output=True, text=True, timeout=60, env=environment, check=True)
    said = "it is larger than 16 MiB" if kind == "large" else "it is not a regular file"
    assert done.stdout.splitlines() == [f"{path}: {said}"] * 4


TYPED = """
import numpy as np
import gyradius
from gyradius import MassPropertiesLaw, key, normal, uniform

body = gyradius.MassProperties(2.0, [0.1, 0.0, 0.0], np.diag([0.002, 0.01, 0.011]))
one = normal(np.float32(1), np.int64(2))
uniform(0, np.float16(2))
one.rvs(np.int64(3), np.int64(7))
one.rvs((2, np.int32(3)), key(np.uint64(3), "a"))
gyradius.law(body, mass="5%", sigmas=np.int64(2)).rvs([2, 3], inset=True)
gyradius.is_realizable(np.eye(3), tolerance=np.float32(1e-6))
gyradius.InertiaLaw.about("wishart", np.eye(3), delta=np.float32(0.1)).rvs(np.int8(3))
gyradius.uniform_attitude().rvs(np.int64(2))
MassPropertiesLaw.pseudo_inertia_wishart(body, np.int64(9))
MassPropertiesLaw.maximum_entropy(body, mass_delta=np.float32(0.1), centre_std=0.01, delta=np.float32(0.1))
scenario = {
    "name": "t", "runs": 10, "quantities": [{"name": "x", "unit": "m", "law": one}],
}
def simulate(inputs: dict[str, float]) -> dict[str, np.float32]:
    return {"y": np.float32(inputs["x"])}

done = gyradius.study(scenario, simulate, outputs={"y": "m"}, runs=np.int64(30), seed=1e1, threads=np.int32(1), columns=iter(["y"]))
done = gyradius.study(scenario, simulate, outputs={"y": "m"}, runs=3e1)
done.replay(np.int64(3))
"""


def test_what_works_has_a_type(tmp_path: Path) -> None:
    pytest.importorskip("mypy")
    program = tmp_path / "typed.py"
    program.write_text(TYPED, encoding="utf-8")
    for run in ([sys.executable, "-m", "mypy", "--strict", program.name], [sys.executable, program.name]):
        done = subprocess.run(run, capture_output=True, text=True, cwd=tmp_path)
        assert done.returncode == 0, done.stdout + done.stderr


WRONGLY_TYPED = """
import gyradius
gyradius.normal("1", 2.0)
gyradius.key("7")
gyradius.uniform_attitude().rvs("3")
gyradius.uniform_attitude().rvs(2.5)
"""


def test_what_does_not_work_has_none(tmp_path: Path) -> None:
    pytest.importorskip("mypy")
    program = tmp_path / "typed.py"
    program.write_text(WRONGLY_TYPED, encoding="utf-8")
    done = subprocess.run([sys.executable, "-m", "mypy", "--strict", program.name], capture_output=True, text=True, cwd=tmp_path)
    found = [int(line.split(":")[1]) for line in done.stdout.splitlines() if ": error:" in line]
    assert found == [3, 4, 5, 6], done.stdout
