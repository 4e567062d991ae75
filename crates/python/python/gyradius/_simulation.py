"""Functions in Python that simulate runs: what they are told, which they are, and what is told of progress."""

from __future__ import annotations

import contextvars
import decimal
import functools
import hashlib
import importlib
import inspect
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeAlias, Union

from gyradius._arrays import Real

Simulation: TypeAlias = Callable[..., Mapping[str, Real]]
"""What simulates a run: its inputs in, its outputs out."""

Called: TypeAlias = Callable[[dict[str, float], dict[str, Any]], Any]
"""A simulation, called with its inputs and with what else there is to know of the run."""

Progress: TypeAlias = Union[bool, Callable[[int, int], object]]
"""Whether a bar is shown, or what is told how far a study is."""

ABOUT = ("run", "model", "seed", "vehicle", "flight")
"""What a simulation is told of its run by keyword, if it has parameters of these names."""

OF_VEHICLES = {"vehicle", "flight"}
"""What of it there is in scenarios with vehicles alone."""

SOURCE = ", source "
"""What stands before the SHA-256 of a function's source in what a scenario says of it."""

LONGEST = 200
"""Characters that a scenario may say of its function."""


def called_with(simulation: Simulation) -> tuple[Called, set[str]]:
    """The simulation, called with its inputs and, by keyword, with what it has parameters for; and which of these it needs."""
    try:
        parameters = list(inspect.signature(simulation).parameters.values())
    except (TypeError, ValueError):
        # Nobody knows what some functions in C take.
        return lambda inputs, about: simulation(inputs), set()
    by_place = (
        inspect.Parameter.POSITIONAL_ONLY,
        inspect.Parameter.POSITIONAL_OR_KEYWORD,
        inspect.Parameter.VAR_POSITIONAL,
    )
    if not parameters or parameters[0].kind not in by_place:
        raise ValueError("simulation: it must take the dictionary of the inputs as its first argument")
    first, *others = parameters
    if first.kind is inspect.Parameter.VAR_POSITIONAL:
        others = parameters
    bound = _bound(simulation)
    others = [other for other in others if other.name not in bound]
    by_name = (inspect.Parameter.KEYWORD_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    everything = any(other.kind is inspect.Parameter.VAR_KEYWORD for other in others)
    named = {other.name for other in others if other.kind in by_name}
    wanted = tuple(name for name in ABOUT if name not in bound and (everything or name in named))
    needed = set()
    for other in others:
        is_known = other.kind in by_name and other.name in ABOUT
        if is_known and other.default is inspect.Parameter.empty:
            needed.add(other.name)
        various = other.kind in (inspect.Parameter.VAR_KEYWORD, inspect.Parameter.VAR_POSITIONAL)
        if not (is_known or various) and other.default is inspect.Parameter.empty:
            if other.name in ABOUT:
                raise ValueError(f"simulation: its parameter {other.name!r} is given by its name, and stands before a `/`")
            known = ", ".join(ABOUT)
            raise ValueError(f"simulation: nothing is known for its parameter {other.name!r}; what is known is {known}")
    if not wanted:
        return lambda inputs, about: simulation(inputs), needed
    return lambda inputs, about: simulation(inputs, **{name: about[name] for name in wanted if name in about}), needed


def _bound(simulation: Simulation) -> set[str]:
    """The parameters that have got a value by keyword, in `functools.partial`, and keep it."""
    function: Any = simulation
    bound: set[str] = set()
    while isinstance(function, functools.partial):
        bound |= function.keywords.keys()
        function = function.func
    return bound


def in_context(called: Called) -> Called:
    """The same, called each time in a copy of the context that the caller has now, whatever thread calls it."""
    context, decimals = contextvars.copy_context(), decimal.getcontext().copy()

    def alone(inputs: dict[str, float], about: dict[str, Any]) -> Any:
        # A context has the settings of decimal numbers themselves, which a run could change for the others.
        decimal.setcontext(decimals.copy())
        return called(inputs, about)

    # No two threads may be in one context at the same time.
    return lambda inputs, about: context.copy().run(alone, inputs, about)


def described(simulation: Simulation) -> str:
    """Which function it is: by module, name and source."""
    function: Any = simulation
    while isinstance(function, functools.partial):
        function = function.func
    if not hasattr(function, "__qualname__"):
        function = type(function)
    name = f"{_module_of(function)}.{function.__qualname__}"
    try:
        source = inspect.getsource(function)
    except (OSError, TypeError):
        return name[:LONGEST]
    said = f"{SOURCE}{hashlib.sha256(source.encode()).hexdigest()[:16]}"
    return name[: LONGEST - len(said)] + said


def _module_of(function: Any) -> str | None:
    """Its module, by the name that an import gives it: a program's own is called otherwise, and otherwise again in its children."""
    name: str | None = getattr(function, "__module__", None)
    if name not in ("__main__", "__mp_main__"):
        return name
    module = sys.modules.get(name)
    spec, file = getattr(module, "__spec__", None), getattr(module, "__file__", None)
    return spec.name if spec else Path(file).stem if file else "__main__"


def progress_of(progress: Any) -> tuple[Callable[[int, int], object] | None, Callable[[], object]]:
    """What is told of progress, and what is called at the end."""
    if progress is None or progress is False:
        return None, lambda: None
    if callable(progress):
        return progress, lambda: None
    if progress is not True:
        raise ValueError(f"progress: it must be True, False or callable, not {type(progress).__name__}")
    try:
        tqdm: Any = importlib.import_module("tqdm.auto").tqdm
    except ImportError:
        return _line, lambda: print(file=sys.stderr)
    bar = tqdm(unit="run")

    def tell(done: int, of: int) -> None:
        bar.total = of
        bar.update(done - bar.n)

    return tell, bar.close


def _line(done: int, of: int) -> None:
    print(f"\r{done} of {of} runs", end="", file=sys.stderr, flush=True)
