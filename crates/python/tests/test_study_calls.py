"""Where the function of a study is called: in which context, on how large a stack, and what tells another function."""

from __future__ import annotations

import contextvars
import decimal
import functools
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import gyradius

WORD: contextvars.ContextVar[int] = contextvars.ContextVar("WORD", default=-1)
MODES = ("ignore", "warn", "raise", "print")
IN_CONTEXT = int(np.__version__.split(".")[0]) >= 2
"""Whether NumPy keeps what `seterr` says in a context variable."""


def scenario(**more: Any) -> dict[str, Any]:
    """A scenario with one quantity."""
    return {"name": "calls", "runs": 30, "quantities": [{"name": "x", "unit": "m", "law": gyradius.normal(1.0, 0.1)}], **more}


def seen() -> dict[str, float]:
    """What the context is, in numbers."""
    modes = [MODES.index(mode) for _, mode in sorted(np.geterr().items())]
    told = sum(mode * 4.0**place for place, mode in enumerate(modes)) if IN_CONTEXT else 0.0
    return {"word": float(WORD.get()), "digits": float(decimal.getcontext().prec), "modes": told}


def look(inputs: dict[str, float], run: int) -> dict[str, float]:
    """What the context is, which it then changes."""
    found = seen()
    WORD.set(1000 + run)
    decimal.getcontext().prec = 100 + run
    np.seterr(all=MODES[run % 2])
    return found


@settings(max_examples=20)
@given(
    word=st.integers(0, 99),
    digits=st.integers(1, 90),
    modes=st.tuples(*[st.sampled_from(MODES[:3])] * 4),
    threads=st.integers(1, 3),
    declared=st.booleans(),
)
def test_a_function_is_called_in_the_context_of_its_caller(
    word: int, digits: int, modes: tuple[str, ...], threads: int, declared: bool
) -> None:
    outputs = {"word": "1", "digits": "1", "modes": "1"} if declared else None

    def called() -> tuple[gyradius.Study, dict[str, float]]:
        WORD.set(word)
        decimal.getcontext().prec = digits
        np.seterr(**dict(zip(("divide", "invalid", "over", "under"), modes)))  # type: ignore[arg-type]
        return gyradius.study(scenario(), look, outputs=outputs, threads=threads), seen()

    modes_before, digits_before = np.geterr(), decimal.getcontext().prec
    try:
        study, expected = contextvars.copy_context().run(called)
    finally:
        np.seterr(**modes_before)  # type: ignore[arg-type]
        decimal.getcontext().prec = digits_before
    table = study.to_numpy()["all"]
    for name, value in expected.items():
        assert (table[name] == value).all(), name
    # Wherever it is asked for a run again.
    for run in (0, 7, 29):
        assert {name: study.replay(run).row[name] for name in expected} == expected
    assert decimal.getcontext().prec == digits_before and np.geterr() == modes_before


def test_what_a_function_raises_by_the_mode_of_its_caller_is_the_same_again() -> None:
    def divide(inputs: dict[str, float]) -> dict[str, float]:
        return {"y": float(np.minimum(1.0 / np.maximum(np.array([inputs["x"] - 1.0]), 0.0), 5.0)[0])}

    if not IN_CONTEXT:
        pytest.skip("this NumPy keeps the modes of each thread")
    with np.errstate(all="raise"):
        study = gyradius.study(scenario(), divide, outputs={"y": "1"})
    table = study.to_numpy()["all"]
    assert (table["status"] == np.where(table["x"] > 1.0, "ok", "simulator: FloatingPointError: divide by zero encountered in divide")).all()
    for run in range(30):
        assert study.replay(run).status == table["status"][run]


RECURSION = """
import functools, sys
import gyradius

sys.setrecursionlimit(10**6)


def deep(n):
    # Through C, each level of which takes some 400 bytes of stack.
    return 0 if n == 0 else functools.reduce(lambda a, b: deep(n - 1) + 1, [0, 1])


def outcome(function):
    try:
        return function()
    except Exception as error:
        return type(error).__name__


depth, threads, in_main, declared = map(int, sys.argv[1:])
x = {"name": "x", "unit": "1", "law": gyradius.normal(0.0, 1.0)}
outputs = {"y": "1"} if declared else None
main = outcome(lambda: deep(depth)) if in_main else depth
try:
    table = gyradius.study(
        {"name": "deep", "runs": 5, "quantities": [x]}, lambda inputs: {"y": deep(depth)}, outputs=outputs, threads=threads
    ).to_numpy()["all"]
    found = set(table["y"]) if (table["status"] == "ok").all() else {status.split(': ')[1] for status in table["status"]}
except ValueError as error:
    found = {str(main) if str(main) in str(error) else str(error)}
assert found == {main}, (found, main)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="main threads have less stack there")
@pytest.mark.parametrize(
    ("depth", "environment"), [(5000, {}), (10000, {}), (10000, {"RUST_MIN_STACK": "100000"}), (30000, {"RUST_MIN_STACK": "40000000"})]
)
@pytest.mark.parametrize(("threads", "declared"), [(1, 1), (3, 1), (1, 0)])
def test_what_fits_the_stack_of_the_main_thread_fits_that_of_a_study(
    depth: int, environment: dict[str, str], threads: int, declared: int, tmp_path: Path
) -> None:
    in_main = int(depth <= 10000)
    words = [sys.executable, "-c", RECURSION, *map(str, (depth, threads, in_main, declared))]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, env={**os.environ, **environment})
    assert done.returncode == 0, done


@pytest.mark.parametrize("rows", ["all", "failed", "none"])
@pytest.mark.parametrize("columns", [None, ["x"], ["y"], ["x", "y"]])
@pytest.mark.parametrize("change", [0.0, 1.0])
def test_another_function_is_told_by_what_was_kept(rows: str, columns: list[str] | None, change: float, tmp_path: Path) -> None:
    state = {"add": 0.0}

    def simulate(inputs: dict[str, float]) -> dict[str, float]:
        if inputs["x"] > 1.1:
            # Of the reason the words are compared, and not the numbers in it.
            raise ValueError(f"too long by {state['add']}" if state["add"] == 0.0 else "too far")
        return {"y": inputs["x"] + state["add"]}

    def call() -> gyradius.Study:
        return gyradius.study(
            scenario(runs=300), simulate, outputs={"y": "m"}, out=tmp_path / "it", rows=rows, columns=columns, force=False
        )

    kept = call().to_numpy()["all"]
    state["add"] = change
    is_told = rows == "failed" or rows == "all" and (columns is None or "y" in columns)
    if change and is_told:
        with pytest.raises(ValueError, match="the function is not the one that did the finished runs"):
            call()
        return
    study = call()
    for name, values in study.to_numpy()["all"].items():
        np.testing.assert_array_equal(values, kept[name])
    if rows == "all" and not change:
        said = str(study.replay(3))
        assert ("the same, bit for bit, as in" in said) == (columns is None or columns == ["x", "y"])
        assert ("bit for bit, in the columns that were kept, as in" in said) == (columns not in (None, ["x", "y"]))


def told(inputs: dict[str, float], run: float = -1.0, *, model: Any = -1.0, seed: float = -1.0) -> dict[str, float]:
    """What a function is told by name."""
    return {"told_run": float(run), "told_model": -2.0 if isinstance(model, str) else float(model), "told_seed": float(seed % 2**20)}


def told_all(inputs: dict[str, float], **about: Any) -> dict[str, float]:
    """The same, of a function that takes whatever it is given."""
    assert set(about) <= {"run", "model", "seed"}
    return told(inputs, **about)


class Part(functools.partial):  # type: ignore[type-arg]
    """A partial that another one does not take apart."""


@pytest.mark.parametrize("function", [told, told_all])
@pytest.mark.parametrize("made", [functools.partial, Part])
@pytest.mark.parametrize("inner", [set(), {"run"}, {"seed"}, {"model", "seed"}, {"run", "model", "seed"}])
@pytest.mark.parametrize("outer", [set(), {"run"}, {"model"}, {"run", "seed"}])
def test_what_is_bound_by_keyword_stays(function: Any, made: Any, inner: set[str], outer: set[str]) -> None:
    bound = {name: 5.0 + place for place, name in enumerate(sorted(inner))}
    last = {name: 55.0 + place for place, name in enumerate(sorted(outer))}
    simulation = made(made(function, **bound), **last) if outer else made(function, **bound)
    outputs = {f"told_{name}": "1" for name in ("run", "model", "seed")}
    tables = [gyradius.study(scenario(runs=5), one, outputs=outputs) for one in (simulation, function)]
    found, free = ([study.replay(run).row for run in range(5)] for study in tables)
    for name in outputs:
        kept = {**bound, **last}.get(name.removeprefix("told_"))
        assert [row[name] for row in found] == ([row[name] for row in free] if kept is None else [kept] * 5), name
    assert [row["told_run"] for row in free] == list(range(5)) and free[0]["told_model"] == -2.0
