"""What a study owes to who uses Python: errors in its words, refusals before the first run, copies and pickles, reading alone."""

from __future__ import annotations

import copy
import gc
import math
import multiprocessing
import os
import pickle
import re
import shutil
import weakref
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_study import NORMAL, PECK, REQUIREMENT, double, scenario, tables

import gyradius

OUTPUTS = {"y": "m", "z": "1"}


def study(out: Path | None = None, **keys: Any) -> gyradius.Study:
    """A study of a scenario with these keys, or of a call with them."""
    call = {key: keys.pop(key) for key in ("force", "even_if_full", "rows", "columns", "runs") if key in keys}
    return gyradius.study(scenario(**keys), double, outputs=OUTPUTS, out=out, **call)


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ({}, {"seed": 6}, ["out=...", "force=True"]),
        ({}, {"quantities": [{"name": "x", "law": NORMAL}, {"name": "u", "law": NORMAL}]}, ["out=...", "force=True"]),
        (None, {}, ["out=...", "force=True"]),
        ({"rows": "none"}, {"runs": 130}, ["out=...", "force=True"]),
        ({"columns": ["y"]}, {"runs": 130}, ["out=...", "force=True"]),
    ],
)
@pytest.mark.parametrize("name", ["out", "a --force b"])
def test_errors_speak_of_keyword_arguments(before: Any, after: Any, words: list[str], name: str, tmp_path: Path) -> None:
    out = tmp_path / name
    if before is None:
        out.mkdir()
        (out / "mine.txt").write_text("mine", encoding="utf-8")
    else:
        study(out, **before)
    with pytest.raises(ValueError) as told:
        study(out, **after)
    text = str(told.value).replace(str(out), "")
    assert str(out) in str(told.value)
    assert "--" not in text and "command" not in text
    assert [word for word in words if word not in text] == []
    # What it says helps.
    if "force=True" in words and before is not None:
        assert study(out, **after, force=True).runs["all"] == after.get("runs", 100)


class Begun(BaseException):
    """Of a study that should not have begun."""


def test_no_room_is_told_in_keyword_arguments() -> None:
    def simulate(inputs: dict[str, float]) -> dict[str, float]:
        raise Begun

    # Some terabytes.
    quantities = [{"name": f"x{place}", "law": NORMAL} for place in range(290)]
    with pytest.raises(ValueError, match=r"the disk has .* out=\.\.\., or pass even_if_full=True to begin") as told:
        gyradius.study(scenario(quantities=quantities), simulate, outputs={"y": "m"}, runs=10**9)
    assert "--" not in str(told.value)


@pytest.mark.parametrize("wanted", ["vehicle", "flight"])
def test_vehicles_that_there_are_not_are_refused_before_the_first_run(wanted: str, tmp_path: Path) -> None:
    calls: list[int] = []
    space: dict[str, Any] = {"calls": calls}
    for default in ("", "=None"):
        exec(f"def simulate(inputs, run, {wanted}{default}):\n    calls.append(run)\n    return {{'y': inputs['x']}}", space)
        if default:
            assert gyradius.study(scenario(), space["simulate"]).failed == {"all": 0}
            continue
        with pytest.raises(ValueError, match=f"simulation: it asks for {wanted}.*no vehicles.*run, model, seed"):
            gyradius.study(scenario(), space["simulate"], out=tmp_path / "out")
        assert calls == [] and not (tmp_path / "out").exists()


@pytest.mark.parametrize("answer", [math.nan, math.inf, -math.inf, None])
def test_what_fails_at_first_is_refused_if_it_is_to_declare_the_outputs(answer: float | None) -> None:
    calls: list[int] = []

    def simulate(inputs: dict[str, float], run: int) -> dict[str, float]:
        calls.append(run)
        if run >= 10:
            return double(inputs)
        if answer is None:
            raise ArithmeticError("no root")
        return {"y": answer, "z": 1.0}

    reason = "ArithmeticError: no root" if answer is None else "the output `y` is not a finite number"
    with pytest.raises(ValueError, match=rf"simulation\.outputs.*{reason}"):
        gyradius.study(scenario(runs=30), simulate)
    assert calls == list(range(10))
    # Declared, they are failed runs as any others.
    assert gyradius.study(scenario(runs=30), simulate, outputs=OUTPUTS).failed == {"all": 10}
    with pytest.warns(RuntimeWarning, match=rf"all: all 10 runs failed.*{reason}"):
        assert gyradius.study(scenario(runs=10), simulate, outputs=OUTPUTS).failed == {"all": 10}


def shown(one: gyradius.Study) -> tuple[Any, ...]:
    """Whatever a study says."""
    arrays = {model: {name: repr(values.tolist()) for name, values in table.items()} for model, table in one.to_numpy().items()}
    return one.name, one.scenario, one.runs, one.failed, one.verdicts, one.summary, arrays, one.report.read_bytes()


@pytest.mark.parametrize("make", [study, lambda out: gyradius.study(PECK, runs=20, out=out)])
def test_studies_are_copied_and_pickled(make: Callable[[Path | None], gyradius.Study], tmp_path: Path) -> None:
    kept, temporary = make(tmp_path / "out"), make(None)
    for one in (kept, temporary):
        assert copy.copy(one) is one and copy.deepcopy([one])[0] is one
        again = pickle.loads(pickle.dumps(one))
        assert shown(again) == shown(one)
        assert str(again).replace(str(again.folder), "") == str(one).replace(str(one.folder), "")
        assert (again.folder == one.folder) == (one is kept)
    # The pickle of a study without a folder of its own holds all of it, and so does what is read from it.
    text, folder = pickle.dumps(temporary), temporary.folder
    expected = shown(temporary)
    del temporary, one
    assert not folder.exists()
    again = pickle.loads(text)
    folder = again.folder
    assert shown(pickle.loads(pickle.dumps(again))) == expected == shown(again)
    assert tables(folder)
    del again
    assert not folder.exists()
    text = pickle.dumps(kept)
    shutil.rmtree(kept.folder)
    with pytest.raises(ValueError, match="holds no study"):
        pickle.loads(text)


@pytest.mark.parametrize("make", [study, lambda out: gyradius.study(PECK, runs=20, out=out)])
def test_a_folder_that_is_gone_is_told(make: Callable[[Path], gyradius.Study], tmp_path: Path) -> None:
    one = make(tmp_path / "out")
    shutil.rmtree(one.folder)
    for call in (lambda: one.replay(3), one.to_numpy):
        with pytest.raises(ValueError, match=re.escape(str(one.folder))) as told:
            call()
        assert "`gyradius " not in str(told.value)


def mean(one: gyradius.Study) -> float:
    return float(one.to_numpy()["all"]["y"].mean())


def test_processes_read_a_study_at_the_same_time(tmp_path: Path) -> None:
    both = [study(tmp_path / "out"), study()]
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        assert pool.map_async(mean, both * 8, chunksize=1).get(timeout=120) == [mean(both[0])] * 16


def dropped(known: list[gyradius.Study]) -> None:
    """What a process does that was forked, and lets go of what it has from the other."""
    known.clear()
    gc.collect()


@pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="there is no fork")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_process_that_was_forked_leaves_the_study_of_its_parent() -> None:
    studies = [study(), pickle.loads(pickle.dumps(study()))]
    folders = [one.folder for one in studies]
    for ends in (True, False):
        child = os.fork()
        if child == 0:
            dropped(list(studies) if ends else studies)
            # With what is done at the end of a program, or without.
            if ends:
                weakref.finalize._exitfunc()  # type: ignore[attr-defined]
            os._exit(0)
        assert os.waitpid(child, 0)[1] == 0
        assert all(folder.is_dir() for folder in folders), ends
    other = multiprocessing.get_context("fork").Process(target=dropped, args=(studies,))
    other.start()
    other.join(60)
    assert other.exitcode == 0 and all((folder / "report.html").exists() for folder in folders)
    assert [mean(one) for one in studies] == [mean(studies[0])] * 2
    dropped(studies)
    assert not any(folder.exists() for folder in folders)


def test_what_is_read_from_a_pickle_does_no_runs() -> None:
    one = study()
    assert one.replay(3).status == "ok"
    with pytest.raises(ValueError, match=r"gyradius\.study\("):
        pickle.loads(pickle.dumps(one)).replay(3)


@pytest.mark.parametrize("until", ["decided", "mean(y) within 0.5", "mean(y) within 1e-9"])
def test_a_study_that_a_rule_ended_is_only_read(until: str, tmp_path: Path) -> None:
    calls: list[int] = []

    def simulate(inputs: dict[str, float], run: int) -> dict[str, float]:
        calls.append(run)
        return double(inputs)

    scene = scenario(runs=3000, requirements=[REQUIREMENT | {"at_most": 5.0}])
    first = gyradius.study(scene, simulate, outputs=OUTPUTS, until=until, out=tmp_path)
    done = len(calls)
    assert done == first.runs["all"]
    again = [gyradius.study(tmp_path), gyradius.study(tmp_path, simulate)]
    # The function is held against one of the runs.
    assert len(calls) == done + 1
    for one in again:
        assert one.summary == first.summary
    # Whoever asks for more must say how.
    with pytest.raises(ValueError, match=r"gyradius\.study\("):
        gyradius.study(tmp_path, until="mean(y) within 1e-12", runs=6000)


@pytest.mark.parametrize(
    ("keys", "outputs", "message"),
    [
        ({"quantities": [{"name": "x", "law": NORMAL}] * 2}, None, r"quantities\[2\]\.name"),
        ({"quantities": [{"name": "x", "law": NORMAL}] * 2}, OUTPUTS, r"quantities\[2\]\.name"),
        ({"quantities": [{"name": "run", "law": NORMAL}]}, OUTPUTS, r"quantities\[1\]\.name"),
        ({"quantities": [{"name": "x", "law": NORMAL}]}, {"y": "m", "x": "m"}, r"simulation\.outputs\[2\]\.name"),
        ({}, {"status": "m"}, r"simulation\.outputs\[1\]\.name"),
    ],
)
def test_names_that_are_taken_are_told_where_they_stand(keys: Any, outputs: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        gyradius.study(scenario(**keys), double, outputs=outputs)


@pytest.mark.parametrize(
    "wrong",
    [
        {"force": "yes"},
        {"retry_failed": 1},
        {"even_if_full": None},
        {"until": 3},
        {"rows": 3},
        {"columns": "y"},
        {"columns": [3]},
        {"runs": True},
        {"seed": np.True_},
    ],
)
def test_arguments_of_wrong_types_are_named(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=f"^{next(iter(wrong))} = "):
        gyradius.study(scenario(), double, **wrong)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"law": 3}, "law: unknown key `law`, expected one of `name`"),
        ({"quantities": 3}, "quantities: invalid type: integer `3`, expected a list"),
        ({"quantities": [3]}, r"quantities\[1\]: invalid type: integer `3`, expected a dictionary"),
        ({"quantities": {"name": "map"}}, "quantities: invalid type: a dictionary, expected a list"),
        ({"name": 3}, "name: invalid type: integer `3`, expected a text"),
        ({"runs": "a string"}, 'runs: invalid type: a text "a string", expected a whole number'),
        ({"requirements": [{"name": "map"}]}, r"requirements\[1\].*: missing key `quantity`"),
    ],
)
def test_scenarios_are_refused_in_the_words_of_python(keys: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        gyradius.study(scenario(**keys), double)


def test_a_study_stays_where_it_was_made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # Also where another one is in the place that its relative path names now.
    found = []
    for place, seed in [("a", 1), ("b", 2)]:
        (tmp_path / place).mkdir()
        monkeypatch.chdir(tmp_path / place)
        found.append(gyradius.study(scenario(seed=seed), double, outputs=OUTPUTS, out="study"))
    read = gyradius.study("study", double, outputs=OUTPUTS)
    monkeypatch.chdir(tmp_path)
    first, second, again = (study.to_numpy()["all"]["x"] for study in (*found, read))
    assert not np.array_equal(first, second) and np.array_equal(second, again)
    assert found[0].folder == tmp_path / "a" / "study" and found[0].summary["seed"] == 1
    assert np.array_equal(pickle.loads(pickle.dumps(found[0])).to_numpy()["all"]["x"], first)


def test_a_folder_without_a_name_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError, match=r'^out = "": it must be the name of a folder$'):
        gyradius.study(scenario(), double, outputs=OUTPUTS, out="")
    assert not list(tmp_path.iterdir())


def by_place(inputs: dict[str, float], run: int, /) -> tuple[float, float]:
    return inputs["x"], float(run)


def of_nobody(inputs: dict[str, float], colour: str) -> tuple[float, float]:
    return inputs["x"], 0.0


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (by_place, "^simulation: its parameter 'run' is given by its name, and stands before a `/`$"),
        (of_nobody, "^simulation: nothing is known for its parameter 'colour'; what is known is run, "),
        (lambda: (0.0, 0.0), "^simulation: it must take the dictionary of the inputs as its first argument$"),
    ],
)
def test_functions_that_cannot_be_called_are_refused(function: Callable[..., Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        gyradius.study(scenario(), function, outputs=OUTPUTS)
