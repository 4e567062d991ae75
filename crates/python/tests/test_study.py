"""Studies with functions in Python: the same as with a process, whatever fails, interrupted and going on."""

from __future__ import annotations

import functools
import math
import re
import shutil
import subprocess
import sys
import textwrap
import threading
import time
import types
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import gyradius

CRATES = Path(__file__).parents[2]
EXAMPLE = CRATES / "study/examples/simulators/spin_up.toml"
PECK = CRATES / "study/src/scenario/peck-2003.toml"
NORMAL = {"law": "normal", "mean": 1.0, "sigma": 0.25}
UNIFORM = {"law": "uniform", "low": 0.0, "high": 1.0}
BODY = {
    "name": "hub",
    "mass_kg": 120.0,
    "inertia_kg_m2": [[21.0, 0.2, -0.1], [0.2, 19.0, 0.3], [-0.1, 0.3, 26.0]],
    "dispersion": {
        "mass_percent": 1.0,
        "root_second_moment_variance_kg_m2": [0.001] * 3,
        "axes": "fixed",
    },
}
MODELS = [
    {"name": "proposed", "law": "principal", "axes": "whole-sphere"},
    {"name": "naive", "law": "entrywise", "matched_to": "proposed"},
]
REQUIREMENT = {"name": "low", "quantity": "y", "at_most": 2.0, "probability": 0.9, "confidence": 0.9}


def scenario(**keys: Any) -> dict[str, Any]:
    """A scenario with two quantities."""
    quantities = [{"name": "x", "unit": "m", "law": NORMAL}, {"name": "u", "law": UNIFORM}]
    return {"name": "made", "runs": 100, "seed": 5, "quantities": quantities, **keys}


def double(inputs: dict[str, float]) -> dict[str, float]:
    """Twice one, and the other."""
    return {"y": 2.0 * inputs["x"], "z": inputs["u"]}


def spin_up() -> Any:
    """The function of the shipped example, without what reads and writes."""
    text = EXAMPLE.with_suffix(".py").read_text(encoding="utf-8")
    space: dict[str, Any] = {"__name__": "spin_up"}
    exec(text[: text.index("for line in sys.stdin")], space)
    return space["spin_up"]


def tables(folder: Path) -> dict[str, bytes]:
    """The files of the run tables."""
    return {str(file.relative_to(folder)): file.read_bytes() for file in sorted(folder.glob("runs/**/*.parquet"))}


def test_a_function_leaves_what_a_process_does(tmp_path: Path) -> None:
    command = gyradius.study(EXAMPLE, runs=40, out=tmp_path / "command")
    text = EXAMPLE.read_text(encoding="utf-8")
    asked = 'command = ["python3", "spin_up.py"]\ntimeout_s = 20.0\n'
    assert asked in text
    (tmp_path / "spin.toml").write_text(text.replace(asked, ""), encoding="utf-8")
    function = gyradius.study(tmp_path / "spin.toml", spin_up(), runs=40, out=tmp_path / "function")
    assert len(tables(command.folder)) == 2
    assert tables(command.folder) == tables(function.folder)
    assert command.to_numpy()["naive"].keys() == function.units.keys() | {"model", "run", "status", "status_kind"}
    # The scenario of a command takes no function.
    with pytest.raises(ValueError, match=r"simulation\.command"):
        gyradius.study(EXAMPLE, spin_up(), out=tmp_path / "both")


@settings(max_examples=12)
@given(
    bodies=st.booleans(),
    fleet=st.booleans(),
    declared=st.booleans(),
    requirement=st.booleans(),
    threads=st.integers(1, 3),
    seed=st.integers(0, 2**63 - 1),
    runs=st.integers(12, 300),
    faulty=st.sets(st.integers(0, 40), max_size=8),
)
def test_rows_are_what_the_function_says(
    bodies: bool, fleet: bool, declared: bool, requirement: bool, threads: int, seed: int, runs: int, faulty: set[int]
) -> None:
    lock = threading.Lock()
    asked: dict[tuple[str, int], tuple[int, dict[str, float]]] = {}

    def simulate(inputs: dict[str, float], *, run: int, model: str, seed: int) -> dict[str, float]:
        assert 0 <= seed < 2**53
        with lock:
            known = asked.setdefault((model, run), (seed, dict(inputs)))
        assert known == (seed, inputs)
        if run in faulty:
            raise ArithmeticError(f"diverged at {inputs['x']} s")
        return {"y": np.float32(inputs["x"]), "flag": run % 2 == 0}  # type: ignore[dict-item]

    scene = scenario(runs=runs)
    if fleet:
        del scene["runs"]
        scene |= {"vehicles": runs // 4, "flights": 4}
        runs = runs // 4 * 4
    if bodies:
        scene |= {"bodies": [BODY], "models": MODELS}
    if requirement:
        scene["requirements"] = [REQUIREMENT]
    outputs = {"y": "m", "flag": "1"} if declared else None
    study = gyradius.study(scene, simulate, outputs=outputs, threads=threads, seed=seed)
    assert study.models == (("proposed", "naive") if bodies else ("all",))
    failed = sorted(run for run in faulty if run < runs)
    assert study.failed == dict.fromkeys(study.models, len(failed))
    assert study.runs == dict.fromkeys(study.models, runs)
    assert len(study.verdicts) == (len(study.models) if requirement else 0)
    assert len(asked) == runs * len(study.models)
    for model, table in study.to_numpy().items():
        assert table["run"].tolist() == list(range(runs))
        assert table.keys() == study.columns.keys()
        bad = np.isin(table["run"], failed)
        assert (table["status"] == "ok").tolist() == (~bad).tolist()
        said = [f"simulator: ArithmeticError: diverged at {x!r} s" for x in table["x"][bad].tolist()]
        assert table["status"][bad].tolist() == said
        assert np.isnan(table["y"]).tolist() == bad.tolist()
        np.testing.assert_array_equal(table["y"][~bad], table["x"][~bad].astype(np.float32))
        for run in range(runs):
            assert all(table[name][run] == value for name, value in asked[model, run][1].items())
        if fleet:
            assert table["vehicle"].tolist() == [run // 4 for run in range(runs)]
    run = min(runs - 1, 7)
    again = study.replay(run, model=study.models[-1])
    assert (again.run, again.model) == (run, study.models[-1])
    assert (again.status == "ok") == (run not in faulty)
    assert again.inputs == asked[study.models[-1], run][1]


@pytest.mark.parametrize(
    ("answer", "reason"),
    [
        ({"y": 1.0}, "the output `z` is not in the answer"),
        ({"y": 1.0, "z": math.nan}, "the output `z` is not a finite number"),
        ({"y": math.inf, "z": 1.0}, "the output `y` is not a finite number"),
        ({"y": 1.0, "z": 1.0, "w": 1.0}, "has an output `w`, which is not declared"),
        ({"y": 1.0, "z": "one"}, "TypeError: the output `z` is str: it must be a number"),
        ({"y": 1.0, "z": 10**400}, "the output `z` is not a finite number: inf"),
        ({"y": 1.0, "z": 1j}, "TypeError: the output `z` is complex: it must be a number"),
        ({"y": 1.0, 2: 1.0}, "TypeError: the name of an output is int"),
        (None, "TypeError: the simulation returned NoneType: it must return a dictionary"),
        ([1.0, 2.0], "TypeError: the simulation returned list"),
        (ValueError("no\nroot"), "ValueError: no"),
        (KeyError("k"), "KeyError: 'k'"),
        (AssertionError(), "AssertionError"),
    ],
)
def test_wrong_answers_are_rows(answer: Any, reason: str) -> None:
    def simulate(inputs: dict[str, float], run: int) -> Any:
        if run != 3:
            return double(inputs)
        if isinstance(answer, Exception):
            raise answer
        return answer

    study = gyradius.study(scenario(runs=12), simulate, outputs={"y": "m", "z": "1"})
    table = study.to_numpy()["all"]
    assert [run for run, status in enumerate(table["status"]) if status != "ok"] == [3]
    assert reason in table["status"][3]


class OfOthers:
    """A number of a type that another library has given to NumPy, as bfloat16 of JAX."""

    def __init__(self, value: float, kind: str, char: str) -> None:
        self.value = value
        self.dtype = types.SimpleNamespace(kind=kind, char=char)

    def __float__(self) -> float:
        return self.value


@pytest.mark.parametrize("dtype", ["?", *np.typecodes["AllInteger"], *np.typecodes["AllFloat"], "M8[s]", "m8[s]", "S3", "U3", "V3", "O", [("a", float)]])
@pytest.mark.parametrize("scalar", [True, False])
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_answers_are_taken_of_real_types_alone(dtype: Any, scalar: bool) -> None:
    number = np.zeros((), dtype)
    if number.dtype.kind in "SUV" and number.dtype.names is None:
        number = np.frombuffer("1.5".encode("utf-32-le" if number.dtype.kind == "U" else "ascii"), dtype)[0]
    study = gyradius.study(scenario(), lambda inputs: {"y": number[()] if scalar else np.array(number)}, outputs={"y": "m"})
    # An object is whatever it holds.
    is_taken = number.dtype.kind in "biuf" or number.dtype.kind == "O" and scalar
    assert (study.failed["all"] == 0) == is_taken


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize(("kind", "char", "is_taken"), [("V", "E", True), ("V", "4", True), ("f", "5", True), ("V", "V", False), ("c", "F", False)])
def test_answers_may_be_numbers_of_types_of_others(kind: str, char: str, is_taken: bool) -> None:
    study = gyradius.study(scenario(), lambda inputs: {"y": OfOthers(1.5, kind, char)}, outputs={"y": "m"})
    found = study.to_numpy()["all"]["y"]
    assert (found == 1.5).all() if is_taken else np.isnan(found).all()


def test_outputs_are_declared_by_the_first_answer() -> None:
    tried = []

    def simulate(inputs: dict[str, float], run: int) -> dict[str, float]:
        tried.append(run)
        if run < 4:
            raise RuntimeError("too early")
        return double(inputs)

    study = gyradius.study(scenario(runs=12), simulate)
    assert tried == [0, 1, 2, 3, 4, *range(12)]
    assert list(study.units) == ["x", "u", "y", "z"]
    assert study.units["y"] == "1"
    assert study.failed == {"all": 4}

    def broken(inputs: dict[str, float]) -> dict[str, float]:
        raise ZeroDivisionError("float division by zero")

    with pytest.raises(ValueError, match="ZeroDivisionError: float division by zero"):
        gyradius.study(scenario(), broken)
    with pytest.raises(ValueError, match=r"simulation\.outputs"):
        gyradius.study(scenario(), lambda inputs: {})


def test_runs_are_the_same_in_any_order(tmp_path: Path) -> None:
    def simulate(inputs: dict[str, float], seed: int) -> dict[str, float]:
        return {"y": np.random.default_rng(seed).normal(inputs["x"])}

    studies = [gyradius.study(scenario(runs=700), simulate, threads=n, out=tmp_path / str(n)) for n in (1, 3)]
    assert tables(studies[0].folder) == tables(studies[1].folder)


@pytest.mark.parametrize("name", ["pandas", "polars"])
def test_frames_have_what_arrays_have(name: str) -> None:
    pytest.importorskip(name)

    def simulate(inputs: dict[str, float], run: int) -> dict[str, float]:
        if run == 5:
            raise ValueError("five")
        return double(inputs)

    study = gyradius.study(scenario(bodies=[BODY], models=MODELS), simulate)
    arrays = study.to_numpy()
    frame = study.to_pandas() if name == "pandas" else study.to_polars()
    assert frame.shape == (200, len(study.columns))
    assert list(frame.columns) == list(study.columns)
    assert list(frame["model"]) == ["proposed"] * 100 + ["naive"] * 100
    for column in ("x", "y", "hub_q1", "hub_mass_kg"):
        expected = np.concatenate([arrays[model][column] for model in study.models])
        np.testing.assert_array_equal(frame[column].to_numpy(), expected)
    assert frame["status"][5] == "simulator: ValueError: five"


def test_what_is_kept_is_what_there_is() -> None:
    def simulate(inputs: dict[str, float]) -> dict[str, float]:
        if inputs["u"] > 0.8:
            raise ValueError("too large")
        return double(inputs)

    outputs = {"y": "m", "z": "1"}
    whole = gyradius.study(scenario(), simulate, outputs=outputs).to_numpy()["all"]
    bad = whole["status"] != "ok"
    assert 5 < bad.sum() < 40
    failed = gyradius.study(scenario(), simulate, outputs=outputs, rows="failed").to_numpy()["all"]
    assert failed["run"].tolist() == whole["run"][bad].tolist()
    one = gyradius.study(scenario(), simulate, outputs=outputs, columns=["y"]).to_numpy()["all"]
    assert list(one) == ["model", "run", "status", "y", "status_kind"]
    none = gyradius.study(scenario(), simulate, outputs=outputs, rows="none")
    assert none.to_numpy() == {"all": {}}
    assert none.failed == {"all": int(bad.sum())}
    for package, table in (("polars", none.to_polars), ("pandas", none.to_pandas)):
        pytest.importorskip(package)
        assert len(table()) == 0
    with pytest.raises(ValueError, match='"all", "failed", "none"'):
        gyradius.study(scenario(), simulate, rows="some")
    with pytest.raises(ValueError, match="no such column"):
        gyradius.study(scenario(), simulate, columns=["w"])


def test_changes_go_before_the_scenario() -> None:
    scene = scenario(requirements=[REQUIREMENT])
    study = gyradius.study(scene, double, runs=2000, seed=9, until="decided", look_every=256)
    assert study.runs["all"] < 2000
    assert study.verdicts[0].verdict == "not met"
    assert "seed = 9" in study.scenario
    assert "not met" in repr(study)
    assert str(study.folder) in repr(study)
    driven = gyradius.study(scene, double, runs=50, drivers=100)
    assert driven.summary["drivers"][0]["groups"][:2] == ["x", "u"]
    with pytest.raises(ValueError, match="until"):
        gyradius.study(scenario(), double, until="decided")


def test_a_folder_is_gone_on_with(tmp_path: Path) -> None:
    calls: list[int] = []

    def simulate(inputs: dict[str, float], run: int) -> dict[str, float]:
        calls.append(run)
        return double(inputs)

    out = tmp_path / "out"
    outputs = {"y": "m", "z": "1"}
    first = gyradius.study(scenario(), simulate, outputs=outputs, out=out)
    assert calls == list(range(100))
    # It is complete: one run is done again with a function, to see that it is the one, and none without.
    again = [
        gyradius.study(scenario(), simulate, outputs=outputs, out=out),
        gyradius.study(out),
        gyradius.study(out, simulate),
    ]
    assert [one.folder for one in again] == [out] * 3
    assert calls == [*range(100), 0, 0]
    assert all(one.to_numpy()["all"]["y"].tolist() == first.to_numpy()["all"]["y"].tolist() for one in again)
    more = gyradius.study(out, simulate, runs=130)
    assert calls == [*range(100), 0, 0, 0, *range(100, 130)]
    assert more.runs == {"all": 130}
    # Another function is another study.
    for other in (scenario(), out):
        with pytest.raises(ValueError, match="simulation"):
            gyradius.study(other, double, outputs=outputs, runs=200, out=out)
    # Nobody else can do its runs.
    with pytest.raises(ValueError, match=r"gyradius\.study\("):
        gyradius.study(out, runs=200)
    with pytest.raises(ValueError, match=r"gyradius\.study\("):
        gyradius.study(out).replay(3)
    assert len(calls) == 133


class Gain:
    """A simulation with something of its own."""

    def __init__(self, gain: float) -> None:
        self.gain = gain

    def __call__(self, inputs: dict[str, float]) -> dict[str, float]:
        return {"y": self.gain * inputs["x"]}

    def of_method(self, inputs: dict[str, float]) -> dict[str, float]:
        return self(inputs)


def gained(gain: float, inputs: dict[str, float]) -> dict[str, float]:
    return {"y": gain * inputs["x"]}


def closed_over(gain: float) -> Any:
    return lambda inputs: {"y": gain * inputs["x"]}


@pytest.mark.parametrize("made", [Gain, lambda gain: Gain(gain).of_method, lambda gain: functools.partial(gained, gain), closed_over])
def test_another_function_of_the_same_source_is_refused(made: Any, tmp_path: Path) -> None:
    out = tmp_path / "out"
    first = gyradius.study(scenario(), made(2.0), out=out)
    before = {path: path.read_bytes() for path in out.rglob("*") if path.is_file()}
    with pytest.raises(ValueError, match=r"run \d+ of the model all has y = .*when it is done again"):
        gyradius.study(scenario(), made(3.0), out=out)
    with pytest.raises(ValueError, match="when it is done again"):
        gyradius.study(scenario(), made(3.0), out=out, runs=400)
    assert {path: path.read_bytes() for path in out.rglob("*") if path.is_file()} == before
    again = gyradius.study(scenario(), made(2.0), out=out)
    assert again.to_numpy()["all"]["y"].tolist() == first.to_numpy()["all"]["y"].tolist()


def test_a_program_is_the_module_that_others_import(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text(
        "import multiprocessing, gyradius\n"
        f"SCENARIO = {scenario()!r}\n"
        "def simulate(inputs):\n"
        "    return {'y': 2 * inputs['x']}\n"
        "def work(_):\n"
        "    return len(gyradius.study(SCENARIO, simulate, out='out').to_numpy()['all']['y'])\n"
        "if __name__ == '__main__':\n"
        "    with multiprocessing.get_context('spawn').Pool(1) as pool:\n"
        "        print(work(0), *pool.map(work, [0]))\n"
    )
    for words in (["mine.py"], ["-m", "mine"], ["-c", "import mine; print(mine.work(0))"]):
        done = subprocess.run([sys.executable, *words], cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0 and len(set(done.stdout.split())) == 1, done


def test_a_run_that_is_another_is_told() -> None:
    state = {"shift": 0.0}

    def simulate(inputs: dict[str, float]) -> dict[str, float]:
        return {"y": inputs["x"] + state["shift"]}

    study = gyradius.study(scenario(), simulate)
    assert "the same, bit for bit" in str(study.replay(3))
    state["shift"] = 1e-12
    with pytest.raises(ValueError, match="y"):
        study.replay(3)
    wrong: list[dict[str, Any]] = [{"run": 100}, {"run": 3, "model": "none"}, {}, {"run": 1, "vehicle": 0, "flight": 0}]
    for which in wrong:
        with pytest.raises(ValueError, match="run|model"):
            study.replay(**which)


def test_temporary_folders_go_with_their_study() -> None:
    study = gyradius.study(scenario(), double)
    folder = study.folder
    assert study.report.read_text(encoding="utf-8").startswith("<!")
    assert study._repr_html_().count("<iframe") == 1
    del study
    assert not folder.exists()
    with pytest.raises(TypeError):
        gyradius.Study()


def test_separations_are_studied() -> None:
    study = gyradius.study(PECK, runs=20)
    table = study.to_numpy()[study.models[0]]
    assert len(table["nutation_deg"]) == 20
    assert np.isfinite(table["nutation_deg"]).all()
    assert table["realizable"].dtype == bool
    assert study.replay(2).row["nutation_deg"] == table["nutation_deg"][2]
    assert study.replay(2).inputs == {}


def test_laws_and_arrays_stand_for_what_they_are_in_files() -> None:
    def simulate(inputs: dict[str, float]) -> dict[str, float]:
        return {"y": inputs["x"]}

    quantities = [{"name": "x", "law": gyradius.normal(1.0, 0.25), "unit": None}]
    one = gyradius.study(scenario(quantities=quantities), simulate)
    two = gyradius.study(scenario(quantities=[{"name": "x", "law": NORMAL}]), simulate)
    assert one.to_numpy()["all"]["y"].tolist() == two.to_numpy()["all"]["y"].tolist()
    body = BODY | {"inertia_kg_m2": np.array(BODY["inertia_kg_m2"]), "mass_kg": np.float32(120.0)}
    assert gyradius.study(scenario(bodies=[body], runs=np.int64(10)), double).runs == {"principal": 10}


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (scenario(runs=0), "runs"),
        (scenario(colour="red"), "colour"),
        (scenario(runs="many"), "runs"),
        (scenario(runs=2**70), "runs: a whole number"),
        (scenario(quantities=[{"name": "x", "law": {"law": "normal", "mean": 1.0, "sigma": -1.0}}]), "sigma"),
        (scenario(quantities=[{"name": "x", "law": object()}]), r"quantities\[1\]\.law: object"),
        ({1: 2}, "keys must be texts"),
        ([1], "path or a dictionary"),
        (None, "path or a dictionary"),
        ("name = 'x'\nruns = 3", "tomllib"),
        ("no-such-file.toml", "no-such-file"),
        (Path("/"), "scenario"),
    ],
)
def test_refusals_are_value_errors(wrong: Any, message: str) -> None:
    with pytest.raises((ValueError, OSError), match=message) as told:
        gyradius.study(wrong, double)
    assert "(line" not in str(told.value)


@pytest.mark.parametrize("answer", [1j, np.complex128(1 + 5j), np.array("3.5"), np.str_("3.5"), np.void(b"12345678"), "3.5"])
def test_outputs_that_are_no_real_numbers_fail(answer: Any) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error", category=np.exceptions.ComplexWarning)
        with pytest.warns(RuntimeWarning, match="the output `y` is"):
            study = gyradius.study(scenario(runs=3), lambda inputs: {"y": answer}, outputs={"y": "1"})
    assert list(study.failed.values()) == [3]


@pytest.mark.parametrize("daemon", ["time.sleep(0.01)", "sum(range(20_000))"])
def test_a_program_ends_while_a_daemon_is_in_a_study(daemon: str) -> None:
    program = f"""
import threading, time, gyradius
def simulate(inputs):
    {daemon}
    return {{"y": 1.0}}
scenario = {{"name": "t", "runs": 100_000, "quantities": [{{"name": "a", "law": gyradius.normal(0.0, 1.0)}}]}}
threading.Thread(target=lambda: gyradius.study(scenario, simulate, outputs={{"y": "1"}}), daemon=True).start()
time.sleep(0.7)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")


def test_files_that_cannot_be_read_are_os_errors(tmp_path: Path) -> None:
    missing = tmp_path / "none.toml"
    for given in [(missing,), (missing, double), (str(missing),)]:
        with pytest.raises(FileNotFoundError) as told:
            gyradius.study(*given)
        assert told.value.filename == str(missing)


@pytest.mark.parametrize("name", ["runs", "vehicles", "seed", "look_every", "drivers", "threads"])
@pytest.mark.parametrize("wrong", [-1, 2.5, math.nan, "many", 2**64, 1j])
def test_numbers_that_are_none_are_named(name: str, wrong: Any) -> None:
    until: dict[str, Any] = {"until": "mean(y) within 0.1"} if name == "look_every" else {}
    with pytest.raises(ValueError, match=name):
        gyradius.study(scenario(), double, **until, **{name: wrong})


def test_looks_need_a_rule_that_ends_the_runs() -> None:
    with pytest.raises(ValueError, match="look_every: it goes with until"):
        gyradius.study(scenario(), double, look_every=10)


@pytest.mark.parametrize("looks", [None, 150])
@pytest.mark.parametrize("rule", [None, "mean(y) within 1e-9"])
@pytest.mark.parametrize("given", [None, 250])
def test_what_is_not_said_of_a_rule_is_that_of_the_scenario(
    rule: str | None, given: int | None, looks: int | None
) -> None:
    until: dict[str, Any] = {"rule": "mean(y) within 1e9"}
    if looks is not None:
        until["look_every"] = looks
    scene = {**scenario(), "until": until, "runs": 500}
    study = gyradius.study(scene, double, until=rule, look_every=given)
    expected = 500 if rule else given or looks or 256
    assert list(study.runs.values()) == [expected]


def test_a_million_may_be_written_as_a_float() -> None:
    twenty: Any = 2e1
    assert gyradius.study(scenario(), double, runs=twenty).runs == {"all": 20}
    with pytest.raises(ValueError, match="simulation: missing"):
        gyradius.study(scenario())


def test_nested_without_end_is_refused() -> None:
    scene: dict[str, Any] = scenario()
    scene["author"] = scene
    with pytest.raises(ValueError, match="less deep"):
        gyradius.study(scene, double)


def test_simulations_take_what_they_name() -> None:
    class Simulator:
        def __call__(self, inputs: dict[str, float], **about: Any) -> dict[str, float]:
            return {"y": float(about["run"])}

    def every(*all_of_them: Any, run: int = 0) -> dict[str, float]:
        return {"y": float(run + len(all_of_them))}

    assert gyradius.study(scenario(runs=10), Simulator()).to_numpy()["all"]["y"].tolist() == list(range(10))
    assert gyradius.study(scenario(runs=10), every).to_numpy()["all"]["y"].tolist() == list(range(1, 11))
    wrong: list[Any] = [lambda: {}, lambda inputs, wind: {}, lambda *, inputs: {}, 3, "f"]
    for one in wrong:
        with pytest.raises(ValueError, match="simulation"):
            gyradius.study(scenario(), one)


def test_flights_know_their_vehicles() -> None:
    def simulate(inputs: dict[str, float], vehicle: int, flight: int, model: str) -> dict[str, float]:
        assert model == "all"
        return {"place": 4.0 * vehicle + flight, "x_again": inputs["x"]}

    scene = scenario(vehicles=9, flights=4)
    del scene["runs"]
    scene["quantities"][0]["law"] = NORMAL | {"drawn": "vehicle"}
    study = gyradius.study(scene, simulate, threads=2)
    table = study.to_numpy()["all"]
    assert table["place"].tolist() == list(range(36))
    assert table["vehicle"].dtype == table["flight"].dtype == np.int64
    assert np.unique(table["x_again"]).size == 9
    assert study.replay(vehicle=3, flight=2).run == 14


def test_progress_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    def slow(inputs: dict[str, float]) -> dict[str, float]:
        time.sleep(0.004)
        return double(inputs)

    told: list[tuple[int, int]] = []
    gyradius.study(scenario(), slow, progress=lambda *now: told.append(now))
    assert len(told) > 2
    assert told[-1] == (100, 100)
    assert told == sorted(told)
    assert {of for _, of in told} == {100}
    gyradius.study(scenario(), slow, progress=True)
    assert "100" in capsys.readouterr().err

    def bad(done: int, of: int) -> None:
        raise RuntimeError("no bar")

    with pytest.raises(RuntimeError, match="no bar"):
        gyradius.study(scenario(runs=3000), slow, progress=bad)
    with pytest.raises(ValueError, match="progress"):
        gyradius.study(scenario(), slow, progress="bar")  # type: ignore[arg-type]


def test_a_study_is_read_until_what_replaces_it_is_done(tmp_path: Path) -> None:
    whole = gyradius.study(scenario(runs=600), simulation=double, out=tmp_path)
    before = (tmp_path / "summary.json").read_bytes()
    calls = []

    def stops(inputs: dict[str, float]) -> dict[str, float]:
        calls.append(1)
        if len(calls) == 400:
            raise KeyboardInterrupt
        return double(inputs)

    stops.__qualname__ = double.__qualname__
    other = scenario(runs=600, seed=6)
    with pytest.raises(KeyboardInterrupt):
        gyradius.study(other, simulation=stops, out=tmp_path, force=True, threads=1)
    told = "to replace this one once they are all done: seed is 6 there and 5 here. .* pass force=True"
    with pytest.warns(RuntimeWarning, match=told):
        again = gyradius.study(scenario(runs=600), simulation=double, out=tmp_path)
    assert again.runs["all"] == whole.runs["all"] and (tmp_path / "summary.json").read_bytes() == before
    with pytest.raises(ValueError, match="another study"):
        gyradius.study(other, simulation=double, out=tmp_path)


@pytest.mark.parametrize("way", ["os.kill(os.getpid(), signal.SIGINT)", "raise KeyboardInterrupt"])
def test_interrupts_stop_and_the_same_call_goes_on(way: str, tmp_path: Path) -> None:
    out = tmp_path / "out"
    text = f"""
        import os, signal, time
        import gyradius
        done = []
        def simulate(inputs):
            done.append(1)
            if len(done) == 400:
                {way}
            time.sleep(0.002)
            return {{"y": inputs["x"]}}
        scene = {scenario(runs=600)!r}
        def study():
            return gyradius.study(scene, simulate, outputs={{"y": "m"}}, out={str(out)!r})
        try:
            study()
        except KeyboardInterrupt:
            before = len(done)
            found = study()
            print("interrupted", before, len(done) - before, found.runs["all"])
    """
    # Functions of a text have no source, and are called by their names alone.
    call = [sys.executable, "-c", textwrap.dedent(text)]
    said = subprocess.run(call, capture_output=True, text=True, timeout=300, check=False)
    found = re.fullmatch(r"interrupted (\d+) (\d+) 600\n", said.stdout)
    assert found is not None, said
    # A block of 256 runs was finished.
    assert 400 <= int(found[1]) < 600
    # One of them is done again first, to see that the function is the one.
    assert int(found[2]) == 1 + 600 - 256
    shutil.rmtree(out)


def test_studies_in_threads(tmp_path: Path) -> None:
    found: list[Any] = []

    def one(seed: int) -> None:
        found.append(gyradius.study(scenario(seed=seed), double, out=tmp_path / str(seed)).summary["seed"])

    together = [threading.Thread(target=one, args=(seed,)) for seed in range(4)]
    for thread in together:
        thread.start()
    for thread in together:
        thread.join()
    assert sorted(found) == [0, 1, 2, 3]


@pytest.mark.parametrize("threads", [None, 1, 2])
def test_functions_that_draw_are_called_one_at_a_time(threads: int | None) -> None:
    depth = threading.local()
    attitudes = gyradius.uniform_attitude()
    under_way: list[int] = []

    def simulate(inputs: dict[str, float], run: int, seed: int) -> dict[str, float]:
        inside = getattr(depth, "calls", 0)
        depth.calls = inside + 1
        under_way.append(run)
        # More rows than one core fills at a time.
        drawn = attitudes.rvs(2_000, rng=seed)
        gyradius.is_realizable(np.broadcast_to(np.eye(3), (2_000, 3, 3)))
        most = len(under_way)
        under_way.remove(run)
        depth.calls = inside
        return {"y": inputs["x"], "inside": float(inside), "most": float(most), "drawn": float(drawn.sum())}

    outputs = {"y": "m", "inside": "1", "most": "1", "drawn": "1"}
    # Deep enough to leave the stack if each run began another.
    table = gyradius.study(scenario(), simulate, outputs=outputs, runs=700, threads=threads).to_numpy()["all"]
    assert (table["y"] == table["x"]).all() and (table["inside"] == 0.0).all()
    assert table["most"].max() <= (threads or 1)
