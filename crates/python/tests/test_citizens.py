"""What a package owes to those who use it: pickles, texts, types, memory, threads, interrupts, the program."""

from __future__ import annotations

import copy
import doctest
import importlib
import json
import multiprocessing
import os
import pickle
import pkgutil
import re
import signal
import subprocess
import sys
import threading
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import URDF, bodies
from hypothesis import given, settings
from hypothesis import strategies as st
from test_laws import laws_of_bodies

import gyradius
from gyradius import normal


def objects() -> dict[str, object]:
    link = bodies(np.random.default_rng(3), 1)[0]
    inertia = gyradius.InertiaLaw.about("wishart", np.diag([5.0, 4.0, 3.0]), delta=0.05)
    mean = inertia.mean[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    return {
        **laws_of_bodies(),
        "naive": gyradius.MassPropertiesLaw.naive(link, "entry-noise", normal(0.0, 0.1), centre=normal(0.0, 0.01)),
        "stated": gyradius.law(link, mass="5%", moments="1%"),
        "number": normal(1.0, 2.0),
        "uniform": gyradius.uniform_attitude(),
        "small": gyradius.small_rotations([0, 0, 0, 1], 0.05 * np.eye(3)),
        "bingham": gyradius.bingham(np.diag([1.0, 2.0, 3.0, 0.0])),
        "turns": gyradius.about_axis([0, 0, 0, 1], [0, 0, 1]),
        "inertia": inertia,
        "matched": gyradius.InertiaLaw.matched("entrywise", mean, inertia.cov),
        "bodies": link,
        "box": gyradius.box(sides=1.0),
        "key": gyradius.key(7, "a", [1]),
    }


@pytest.mark.parametrize("name", list(objects()))
def test_objects_are_frozen_copied_and_told_apart(name: str) -> None:
    one = objects()[name]
    for again in (pickle.loads(pickle.dumps(one)), copy.copy(one), copy.deepcopy(one), objects()[name]):
        assert again == one and hash(again) == hash(one) and repr(again) == repr(one)
        if hasattr(one, "rvs"):
            assert np.array_equal(np.asarray(again.rvs(5, rng=1)), np.asarray(one.rvs(5, rng=1)))  # type: ignore[attr-defined]
    assert one != object() and not (one == 3)
    assert type(one).__name__ in repr(one) or repr(one).startswith("key")
    with pytest.raises(AttributeError):
        one.colour = 3  # type: ignore[attr-defined]
    stated = objects()["stated"]
    assert pickle.loads(pickle.dumps(stated)).warnings == stated.warnings  # type: ignore[attr-defined]


def test_everything_that_is_public_is_told_of() -> None:
    for name in gyradius.__all__:
        one = getattr(gyradius, name)
        if name.startswith("__") or isinstance(one, tuple) and not isinstance(one, type):
            continue
        assert one.__doc__ and len(one.__doc__) > 20, name
        assert not name.startswith("_")
        if isinstance(one, type):
            for member, value in vars(one).items():
                if not member.startswith("_") and (callable(value) or isinstance(value, (property, staticmethod))):
                    assert value.__doc__, f"{name}.{member}"


@pytest.mark.parametrize("name", [one.name for one in pkgutil.iter_modules(gyradius.__path__)])
def test_examples_in_docstrings(name: str) -> None:
    failed, _ = doctest.testmod(importlib.import_module(f"gyradius.{name}"))
    assert failed == 0


def test_stubs() -> None:
    pytest.importorskip("mypy")
    allow = Path(__file__).parent / "stubtest-allowlist.txt"
    run = [sys.executable, "-m", "mypy.stubtest", "gyradius", "--allowlist", str(allow)]
    done = subprocess.run(run, capture_output=True, text=True, cwd=Path(__file__).parent)
    assert done.returncode == 0, done.stdout + done.stderr


def test_types() -> None:
    pytest.importorskip("mypy")
    done = subprocess.run([sys.executable, "-m", "mypy"], capture_output=True, text=True, cwd=Path(__file__).parent.parent)
    assert done.returncode == 0, done.stdout


MEMORY = """
import gyradius, numpy as np, os
law, matrix, page = gyradius.uniform_attitude(), np.eye(3), os.sysconf("SC_PAGE_SIZE")

def calls(count):
    for i in range(count):
        law.rvs(3, rng=i)
        gyradius.is_realizable(matrix)
    return int(open("/proc/self/statm").read().split()[1]) * page

before = calls(5_000)
print(calls(100_000) - before)
"""


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="how much memory a process has is not told here")
def test_memory_does_not_grow() -> None:
    done = subprocess.run([sys.executable, "-c", MEMORY], capture_output=True, text=True, check=True)
    # A leak of the smallest array a call would be ten million bytes.
    assert int(done.stdout) < 2_000_000


def test_threads_of_python() -> None:
    law = laws_of_bodies()["lengths"]
    whole = law.rvs(4000, rng=7).array
    found: dict[int, np.ndarray] = {}

    def work(part: int) -> None:
        places = np.arange(1000 * part, 1000 * (part + 1))
        found[part] = law.rvs(rng=gyradius.key(7, "", places)).array

    threads = [threading.Thread(target=work, args=(part,)) for part in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert (np.concatenate([found[part] for part in range(4)]) == whole).all()


def total(seed: int) -> float:
    return float(gyradius.uniform_attitude().rvs(20_000, rng=seed).sum())


@pytest.mark.parametrize("method", multiprocessing.get_all_start_methods())
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_processes_that_are_forked_or_begun_anew(method: str) -> None:
    expected = [total(seed) for seed in range(4)]
    context = multiprocessing.get_context(method)
    with context.Pool(2) as pool:
        assert pool.map_async(total, range(4)).get(timeout=120) == expected


def test_others_run_while_it_draws() -> None:
    law = laws_of_bodies()["lengths"]
    ticks = 0
    done = threading.Event()

    def count() -> None:
        nonlocal ticks
        while not done.is_set():
            ticks += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    law.rvs(1_000_000, rng=1)
    done.set()
    thread.join()
    # With the interpreter held there would be one or two.
    assert ticks > 10


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.parametrize(
    "call",
    [
        "gyradius.small_rotations([0, 0, 0, 1], [[.01, 0, 0], [0, .01, 0], [0, 0, .01]]).rvs(200_000_000, rng=1)",
        # Of two thousand draws about one is kept.
        "gyradius.law(link, centre='1m', inside=gyradius.box([0.1, 0, 0], sides=[0.3, 0.3, 0.3])).rvs(250_000, rng=1)",
    ],
    ids=["many", "slow"],
)
def test_control_c_ends_a_long_call(call: str) -> None:
    program = (
        "import gyradius\n"
        "link = gyradius.MassProperties(2.0, [0.1, 0, 0], [[0.002, 0, 0], [0, 0.01, 0], [0, 0, 0.011]])\n"
        "print('ready', flush=True)\n"
        "try:\n"
        f"    {call}\n"
        "except KeyboardInterrupt:\n"
        "    print('interrupted', flush=True)\n"
    )
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True) as child:
        try:
            assert child.stdout is not None
            assert child.stdout.readline() == "ready\n"
            time.sleep(0.5)
            child.send_signal(signal.SIGINT)
            out, _ = child.communicate(timeout=60)
        finally:
            child.kill()
    assert out == "interrupted\n" and child.returncode == 0


THREADS = """
import os, sys, time
import gyradius

def threads():
    return len(os.listdir("/proc/self/task"))

before = threads()
gyradius.normal(0.0, 1.0).rvs(100_000, rng=1)
had = threads() - before
folder, table, peck = sys.argv[1:] or sys.exit(print(had))
gyradius.study(peck, runs=20, out=folder).to_numpy()
gyradius.study(folder).replay(3)
quiet = os.dup(1)
os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
for call in (["report", folder], ["verdict", table, "--require", "y <= 1 in 50 % at 90 %"]):
    assert gyradius._core.run_program(["gyradius"], ["gyradius", *call]) == 0, call
os.dup2(quiet, 1)
# Threads that end may still be there for a moment.
until = time.monotonic() + 30
while threads() > before + had and time.monotonic() < until:
    time.sleep(0.01)
print(had, threads() - before)
"""


def threads_of(said: str, *arguments: str) -> list[int]:
    """How many threads a program has beside its first, with so many in the variable."""
    environment = {**os.environ, "RAYON_NUM_THREADS": said, "OPENBLAS_NUM_THREADS": "1"}
    run = [sys.executable, "-c", THREADS, *arguments]
    done = subprocess.run(run, env=environment, capture_output=True, text=True, check=True)
    return [int(word) for word in done.stdout.split()]


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="how many threads a process has is not told here")
def test_the_variable_asks_for_no_more_threads_than_a_caller_may() -> None:
    assert [threads_of(said) for said in ("3", "1100")] == [[3], [1024]]


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="how many threads a process has is not told here")
def test_no_threads_are_left_that_no_bound_holds_for(tmp_path: Path) -> None:
    table = tmp_path / "table.csv"
    table.write_text("y\n" + "0.5\n" * 5_000, encoding="utf-8")
    peck = Path(__file__).parents[2] / "study/src/scenario/peck-2003.toml"
    # Those that rayon has of its own, as many as the variable says without any bound, would stay.
    assert threads_of("3", str(tmp_path / "out"), str(table), str(peck)) == [3, 3]


def test_the_program(tmp_path: Path) -> None:
    def run(*arguments: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "gyradius", *arguments], capture_output=True, text=True, cwd=tmp_path
        )

    assert run("--version").stdout.strip() == f"gyradius {gyradius.__version__}"
    (tmp_path / "bad.urdf").write_text(
        '<robot name="r"><link name="a"><inertial><mass value="1"/>'
        '<inertia ixx="1" iyy="1" izz="3" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>'
    )
    assert run("check", "bad.urdf").returncode == 1
    assert run("check", "nowhere.urdf").returncode == 2
    assert run("nothing").returncode == 2
    assert "Usage" in run("--help").stdout
    script = Path(sys.executable).with_name("gyradius")
    if script.exists():
        assert subprocess.run([script, "--version"], capture_output=True, check=True).stdout


@pytest.mark.skipif(sys.platform == "win32", reason="signals, and a shell")
def test_the_program_is_called_again_and_interrupted_as_the_other_one(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "gyradius"]
    script = subprocess.run(
        [*command, "slurm", "--runs", "100", "--shards", "1", "--time", "10", "--out", "it"],
        capture_output=True, text=True, cwd=tmp_path, check=True,
    ).stdout
    line = next(line for line in script.splitlines() if line.startswith("exec ") and " study " in line)
    assert f"{sys.executable} -m gyradius study " in line
    done = subprocess.run(["bash", "-c", line.replace("$SLURM_ARRAY_TASK_ID", "1")], cwd=tmp_path, capture_output=True)
    assert done.returncode == 0 and (tmp_path / "it").is_dir()

    child = subprocess.Popen(
        [*command, "study", "--runs", "2000000", "--out", "long"], stderr=subprocess.PIPE, text=True, cwd=tmp_path
    )
    deadline = time.monotonic() + 60
    while not (tmp_path / "long").exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    time.sleep(1)
    child.send_signal(signal.SIGINT)
    _, said = child.communicate(timeout=60)
    assert child.returncode == 130 and "Traceback" not in said, said


def test_import_is_quick_and_brings_nothing() -> None:
    program = (
        "import sys, numpy; before = set(sys.modules); import gyradius;"
        "new = {name.split('.')[0] for name in set(sys.modules) - before};"
        "print(sorted(name for name in new if name in ('scipy', 'pandas', 'polars', 'matplotlib', 'tqdm', 'mujoco')))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, env=dict(os.environ))
    assert done.stdout == "[]\n"


@pytest.mark.parametrize("page", ["README.md", "docs/python.md", "crates/python/README.md"])
def test_the_pages(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = (Path(__file__).parents[3] / page).read_text()
    # As many robots have one: a frame to which tools are fixed.
    tool = '<link name="tool0"><inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>'
    (tmp_path / "robot.urdf").write_text(URDF.replace("</robot>", f"{tool}</robot>"))
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    blocks = [block.split("```")[0] for block in text.split("```python\n")[1:]]
    assert blocks
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        for block in blocks:
            exec(block, names)
    assert all('left out: "tool0"' in str(one.message) for one in told)
    assert bool(told) == any("gyradius.load(" in block for block in blocks)
    if page == "README.md":
        assert set(names["draws"]) == {"forearm", "hand"}  # type: ignore[call-overload]


def test_the_laws_of_an_estimate(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = (Path(__file__).parents[3] / "docs" / "fit.md").read_text()
    (tmp_path / "phi.json").write_text(text.split("```json\n")[1].split("```")[0])
    fit = [sys.executable, "-m", "gyradius", "fit", "--estimate", "phi.json", "-o", "law.json"]
    subprocess.run(fit, cwd=tmp_path, check=True, capture_output=True)
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    exec(text.split("```python\n")[1].split("```")[0], names)
    estimate = json.loads((tmp_path / "phi.json").read_text())
    assert np.allclose(names["exact"].linear_moments[0], estimate["mean"], rtol=1e-6, atol=1e-9)
    assert names["bodies"].shape == (4096,) and isinstance(names["joint"], gyradius.MassPropertiesLaw)


def test_the_picture_of_the_readme() -> None:
    root = Path(__file__).parents[3]
    program = Path(__file__).parents[1] / "examples" / "slender_stage.py"
    made = subprocess.run(
        [sys.executable, "-c", f"import sys; sys.path.insert(0, {str(program.parent)!r}); import slender_stage as s; print(s.picture(), end='')"],
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    assert made == (root / "docs" / "images" / "slender-stage.svg").read_text()
    assert made.count("#d1242f") > 1


@pytest.mark.parametrize("name", ["lengths", "inertia", "naive"])
def test_pictures_in_notebooks(name: str) -> None:
    import xml.etree.ElementTree as tree

    one = objects()[name]
    page = one._repr_html_()  # type: ignore[attr-defined]
    assert tree.fromstring(page).tag.endswith("svg")
    assert ("#d1242f" in page) == (name == "naive")
    some = bodies(np.random.default_rng(1), 20)
    assert tree.fromstring(some._repr_html_()).tag.endswith("svg")
    assert some[0]._repr_html_().startswith("<pre>")


IMPOSSIBLE = [
    [-1.0, 0, 0, 0, 1, 1, 1, 0, 0, 0],
    [0.0, 0, 0, 0, 1, 1, 1, 0, 0, 0],
    [1.0, 0, 0, 0, 1, 1, 3, 0, 0, 0],
    [1.0, 0, 0, 0, 1, 1, 1, 5, 0, 0],
    [1.0, 0, 0, 0, 1, 1, np.nan, 0, 0, 0],
    [1.0, 0, np.inf, 0, 1, 1, 1, 0, 0, 0],
    [np.nan, 0, 0, 0, 1, 1, 1, 0, 0, 0],
]


@settings(max_examples=60)
@given(st.integers(1, 700), st.sampled_from([0, 1, 2, 3, None]), st.booleans(), st.integers(0, 2**32))
def test_pictures_say_how_many_draws_belong_to_no_body(count: int, few: int | None, others: bool, seed: int) -> None:
    rng = np.random.default_rng(seed)
    number = int(rng.integers(0, count + 1)) if few is None else min(few, count)
    number = count - number if others else number
    table = bodies(rng, count).array.copy()
    for place in rng.permutation(count)[:number]:
        table[place] = IMPOSSIBLE[rng.integers(len(IMPOSSIBLE))]
    page = gyradius.MassProperties.of(table)._repr_html_()
    (share, percent, total) = re.findall(r">([0-9]+)( %)? of ([0-9]+) draws belongs? to no body<", page)[0]
    assert int(total) == count
    if percent:
        assert abs(int(share) - 100 * number / count) <= 0.5
        assert (int(share) == 0) == (number == 0) and (int(share) == 100) == (number == count)
    else:
        assert int(share) == number
    # Red where there is one, and green where there is none.
    assert ('fill="#d1242f"' in page) == (number > 0)
