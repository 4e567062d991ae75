"""Studies: a scenario carried out, with a function in Python as the simulation or without, and what its runs amount to."""

from __future__ import annotations

import functools
import hashlib
import html
import importlib
import inspect
import json
import operator
import os
import shutil
import sys
import tempfile
import warnings
import weakref
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias, Union

import numpy as np

from gyradius import _core

if TYPE_CHECKING:
    from numpy.typing import NDArray

Simulation: TypeAlias = Callable[..., Mapping[str, float]]
"""What simulates a run: its inputs in, its outputs out."""

Progress: TypeAlias = Union[bool, Callable[[int, int], object]]
"""Whether a bar is shown, or what is told how far a study is."""

ABOUT = ("run", "model", "seed", "vehicle", "flight")
"""What a simulation is told of its run by keyword, if it has parameters of these names."""

SOURCE = ", source "
"""What stands before the SHA-256 of a function's source in what a scenario says of it."""

LONGEST = 200
"""Characters that a scenario may say of its function."""


class Verdict(NamedTuple):
    """What the runs of a model say of a requirement."""

    requirement: str
    """Its name."""
    model: str
    """The model."""
    verdict: str
    """``"met"``, ``"not met"`` or ``"undecided"``: then more runs are needed."""
    text: str
    """All that there is to say: shares, intervals, bounds."""


class Replay(NamedTuple):
    """One run of a study, done again. Its row is that of the study, bit for bit."""

    model: str
    """The model."""
    run: int
    """The number of the run, from 0."""
    status: str
    """``"ok"``, or why the run failed."""
    row: dict[str, float | int | str | bool | None]
    """What stands in the columns of its row."""
    inputs: dict[str, float]
    """What the simulation was given; empty for separations, which gyradius simulates itself."""
    text: str
    """What happened in the run, in lines."""

    def __str__(self) -> str:
        return self.text


class Study:
    """A study that was carried out; `gyradius.study` makes it.

    Its folder has the resolved scenario, run tables in Parquet, ``summary.json``, figures and ``report.html``. A study without ``out``
    is in a temporary folder, which is removed with the object.
    """

    __slots__ = ("__weakref__", "_done")

    _done: _core.StudyCore

    def __init__(self) -> None:
        raise TypeError("gyradius.study(...) makes studies")

    @classmethod
    def _of(cls, core: _core.StudyCore, temporary: str | None) -> Study:
        made = object.__new__(cls)
        made._done = core
        if temporary is not None:
            weakref.finalize(made, shutil.rmtree, temporary, ignore_errors=True)
        return made

    @property
    def name(self) -> str:
        """The name of the scenario."""
        return self._done.name

    @property
    def folder(self) -> Path:
        """Where everything is."""
        return self._done.folder

    @property
    def report(self) -> Path:
        """The report, a page of HTML that needs nothing but itself."""
        return self.folder / "report.html"

    @property
    def scenario(self) -> str:
        """The resolved scenario as a TOML file, every default spelled out."""
        return self._done.scenario

    @property
    def models(self) -> tuple[str, ...]:
        """The models, in their order."""
        return tuple(model for model, _, _ in self._done.failed)

    @property
    def failed(self) -> dict[str, int]:
        """How many runs of each model failed; the column ``status`` says why."""
        return {model: failed for model, failed, _ in self._done.failed}

    @property
    def runs(self) -> dict[str, int]:
        """How many runs of each model there are, those that failed too."""
        return {model: runs for model, _, runs in self._done.failed}

    @property
    def verdicts(self) -> list[Verdict]:
        """What the runs say of the requirements of the scenario, model by model."""
        return [Verdict(*verdict) for verdict in self._done.verdicts]

    @property
    def summary(self) -> dict[str, Any]:
        """Every number of the report, as ``summary.json`` has it."""
        found: dict[str, Any] = json.loads((self.folder / "summary.json").read_text(encoding="utf-8"))
        return found

    @property
    def columns(self) -> dict[str, str]:
        """The columns of the run tables, each with its meaning."""
        return {column["column"]: column["meaning"] for column in self.summary["columns"]}

    @property
    def units(self) -> dict[str, str]:
        """The units of the columns that have one, ``"1"`` of numbers without."""
        return {column["column"]: column["unit"] for column in self.summary["columns"] if "unit" in column}

    def to_numpy(self) -> dict[str, dict[str, NDArray[Any]]]:
        """The run tables: of each model its columns, of each column an array with an entry for every run.

        Numbers are of 64 bits, and NaN where a run has none. ``status`` says ``"ok"`` or why the run failed. There are the rows and the
        columns that were kept, and no columns if no row was.
        """
        return {model: self._arrays(model) for model in self.models}

    def to_pandas(self) -> Any:
        """The run tables of all models as one `pandas.DataFrame`, one row a run; the column ``model`` says of which model it is."""
        pandas: Any = importlib.import_module("pandas")
        tables = [pandas.DataFrame(table) for table in self.to_numpy().values()]
        return pandas.concat([table for table in tables if len(table)] or tables, ignore_index=True)

    def to_polars(self) -> Any:
        """The run tables of all models as one `polars.DataFrame`, one row a run; the column ``model`` says of which model it is."""
        polars: Any = importlib.import_module("polars")

        def table(columns: dict[str, NDArray[Any]]) -> Any:
            # What has no number is null, as in the files.
            frame = {name: one.tolist() if one.dtype == object else one for name, one in columns.items()}
            return polars.DataFrame(frame, nan_to_null=True)

        tables = [table(columns) for columns in self.to_numpy().values()]
        return polars.concat([one for one in tables if len(one)] or tables, how="vertical_relaxed")

    def replay(
        self,
        run: int | None = None,
        *,
        model: str | None = None,
        vehicle: int | None = None,
        flight: int | None = None,
    ) -> Replay:
        """Does one run again, alone, and holds it against its row, bit by bit.

        Parameters
        ----------
        run : int
            Its number, from 0; or ``vehicle`` and ``flight``, of a scenario with vehicles.
        model : str, optional
            The first of the scenario, if not given.

        Raises
        ------
        ValueError
            There is no such run or model; or the run is not what the study has of it, because the simulation has changed or does not
            depend on its inputs and its seed alone.
        """
        row, request, text = self._done.replay(
            run=_whole("run", run), vehicle=_whole("vehicle", vehicle), flight=_whole("flight", flight), model=model
        )
        inputs = json.loads(request)["inputs"] if request else {}
        return Replay(row["model"], row["run"], row["status"], row, inputs, text)

    def _arrays(self, model: str) -> dict[str, NDArray[Any]]:
        return {name: _array(values) for name, _, _, values in self._done.columns(model)}

    def __repr__(self) -> str:
        runs = ", ".join(f"{model}: {runs} runs, {failed} failed" for model, failed, runs in self._done.failed)
        said = "".join(f", {one.requirement} {one.verdict} ({one.model})" for one in self.verdicts)
        return f"<gyradius.Study {self.name!r}: {runs}{said}, in {str(self.folder)!r}>"

    def __str__(self) -> str:
        return str(self._done)

    def _repr_html_(self) -> str:
        def row(cells: Sequence[object], tag: str = "td") -> str:
            return "<tr>" + "".join(f"<{tag}>{html.escape(str(cell))}</{tag}>" for cell in cells) + "</tr>"

        runs = [row(("model", "runs", "failed"), "th")]
        runs += [row((model, runs, failed)) for model, failed, runs in self._done.failed]
        said = [row(("requirement", "model", "verdict"), "th")] if self.verdicts else []
        said += [row(one[:3]) for one in self.verdicts]
        # The report is a page of its own, which a notebook shows in a frame.
        page = html.escape(self.report.read_text(encoding="utf-8"), quote=True)
        return (
            f"<h3>{html.escape(self.name)}</h3><table>{''.join(runs)}</table><table>{''.join(said)}</table>"
            f'<details><summary>Report</summary><iframe srcdoc="{page}" width="100%" height="600"></iframe></details>'
        )


def study(
    scenario: str | os.PathLike[str] | Mapping[str, Any],
    simulation: Simulation | None = None,
    *,
    outputs: Mapping[str, str] | None = None,
    runs: int | None = None,
    vehicles: int | None = None,
    seed: int | None = None,
    until: str | None = None,
    look_every: int | None = None,
    rows: str | None = None,
    columns: Sequence[str] | None = None,
    drivers: int | None = None,
    out: str | os.PathLike[str] | None = None,
    threads: int | None = None,
    force: bool = False,
    retry_failed: bool = False,
    even_if_full: bool = False,
    progress: Progress | None = None,
) -> Study:
    """Carries out a scenario: draws what is uncertain, simulates every run, and makes run tables, a summary and a report.

    Parameters
    ----------
    scenario : path or dict
        A scenario file; the folder of a study, which is gone on with and, if it is complete, only read; or a dictionary with the keys
        of a file, in which laws of gyradius may stand for tables. A scenario as text is no path: give ``tomllib.loads(text)``.
    simulation : callable, optional
        Does a run: ``simulation(inputs)`` is called with a dictionary of what was drawn, by name, and returns a dictionary
        of the outputs, which must be finite numbers. If it has parameters called ``run``, ``model``, ``seed``, ``vehicle`` or ``flight``,
        it is given these by keyword; its own random numbers should come from ``numpy.random.default_rng(seed)``. An exception is a
        failed run: a row with the exception's type and text. Without it, gyradius simulates separations, and a file names a command.
    outputs : dict, optional
        Names and units of the outputs. If neither this nor the scenario declares any, the first of ten runs that does not fail does,
        and units are ``"1"``; that run is done again with the others.
    runs, vehicles, seed : int, optional
        In the place of what the scenario says.
    until : str, optional
        Go on until the runs show enough, at most to their number: ``"decided"``, ``"share within 0.1 %"``,
        ``"mean(spin_rad_per_s) within 0.02"``. They are looked at after ``look_every`` runs first.
    rows, columns : optional
        Which rows of the run tables are kept, ``"all"``, ``"failed"`` or ``"none"``, and which columns.
    drivers : int, optional
        Base runs by which it is found what drives the outcome.
    out : path, optional
        The folder of the study. The same call goes on there after an interruption. Without it, the study is in a temporary
        folder, which is removed with the returned object.
    threads : int, optional
        All cores if not given; one with a simulation in Python, which many threads would call at the same time.
    force, retry_failed, even_if_full : bool
        Replace another study in the folder; do failed runs again; begin even if there seems to be no room on the disk or in memory.
    progress : bool or callable, optional
        ``True`` shows a bar, by tqdm if it is installed; a callable is told how many runs are done, and of how many.

    Returns
    -------
    Study

    Raises
    ------
    ValueError
        The scenario is refused; the folder holds another study; the first runs of a simulation without declared outputs fail.
    KeyboardInterrupt
        After Ctrl-C, once the runs at hand have ended. With ``out``, the blocks of runs that were finished stay, and the same call
        goes on.

    Notes
    -----
    Draws depend on seed, model and run alone, so results are the same on any number of threads, if the simulation depends on its
    inputs and its seed alone. The study says in ``simulation.function`` which function it is, by module, name and SHA-256 of the source, so
    that runs of different versions are not mixed in one folder. What the function calls and refers to is not looked at: say
    ``{"simulation": {"function": "spin-up, version 3"}, ...}`` in the scenario if that matters.

    Examples
    --------
    >>> import gyradius
    >>> scenario = {
    ...     "name": "throw",
    ...     "runs": 500,
    ...     "quantities": [{"name": "speed_m_per_s", "unit": "m/s", "law": gyradius.normal(10.0, 1.0)}],
    ...     "requirements": [
    ...         {"name": "far", "quantity": "range_m", "at_least": 5.0, "probability": 0.95, "confidence": 0.9}
    ...     ],
    ... }
    >>> def throw(inputs):
    ...     return {"range_m": inputs["speed_m_per_s"] ** 2 / 9.81}
    >>> thrown = gyradius.study(scenario, throw, outputs={"range_m": "m"})
    >>> [(one.requirement, one.verdict) for one in thrown.verdicts]
    [('far', 'met')]
    >>> table = thrown.to_numpy()["all"]
    >>> table["range_m"].shape, bool((table["range_m"] == table["speed_m_per_s"] ** 2 / 9.81).all())
    ((500,), True)
    """
    given = None if outputs is None else [{"name": name, "unit": unit} for name, unit in _mapping("outputs", outputs)]
    if simulation is not None and not callable(simulation):
        raise ValueError(f"simulation: it must be callable, not {type(simulation).__name__}")
    called = None if simulation is None else _called(simulation)
    function = None if simulation is None else _described(simulation)
    core, place = _scenario(scenario, function, given)
    core = core.changed(
        runs=_whole("runs", runs),
        vehicles=_whole("vehicles", vehicles),
        seed=_whole("seed", seed),
        until=until,
        look_every=_whole("look_every", look_every),
        rows=rows,
        columns=None if columns is None else list(columns),
        drivers=_whole("drivers", drivers),
    )
    threads = _whole("threads", threads)
    if threads is None and called is not None:
        threads = 1
    tell, close = _progress(progress)
    temporary = None
    if out is not None:
        place = Path(out)
    if place is None:
        temporary = tempfile.mkdtemp(prefix="gyradius-")
        place = Path(temporary) / core.name
    try:
        done = core.run(
            simulation=called,
            out=place,
            threads=threads,
            force=force,
            retry_failed=retry_failed,
            even_if_full=even_if_full,
            progress=tell,
        )
    except BaseException:
        if temporary is not None:
            shutil.rmtree(temporary, ignore_errors=True)
        raise
    finally:
        close()
    for block in done.warnings:
        warnings.warn(f"{block}: its runs were done again", RuntimeWarning, stacklevel=2)
    return Study._of(done, temporary)


def _scenario(
    scenario: Any, function: str | None, outputs: list[dict[str, str]] | None
) -> tuple[_core.ScenarioCore, Path | None]:
    """The scenario, and the folder that it belongs to if it is that of a study."""
    if isinstance(scenario, Mapping):
        if function is None and "quantities" in scenario and "simulation" not in scenario:
            raise ValueError(
                "simulation: missing: a scenario with quantities needs a function or a command that simulates"
            )
        return _core.ScenarioCore.of(scenario, function, outputs), None
    if not isinstance(scenario, (str, os.PathLike)):
        raise ValueError(f"scenario: it must be a path or a dictionary, not {type(scenario).__name__}")
    path = Path(os.fspath(scenario))
    if isinstance(scenario, str) and "\n" in scenario:
        raise ValueError(
            "scenario: a text of several lines is no path; give a dictionary, as tomllib.loads(text) makes it"
        )
    core = _core.ScenarioCore.read(path, function, outputs)
    if not path.is_dir():
        return core, None
    if function is not None and core.function is not None and SOURCE in core.function and core.function != function:
        raise ValueError(
            f"simulation: the runs in {str(path)!r} are those of {core.function!r}, and would not go with those of {function!r}: give "
            "the scenario itself and another folder as `out`"
        )
    return core, path


def _whole(name: str, given: Any) -> int | None:
    """A whole number that is not negative, also one that is written as ``1e6``."""
    if given is None:
        return None
    if isinstance(given, float) and given.is_integer():
        return _whole(name, int(given))
    try:
        found = operator.index(given)
    except TypeError:
        raise ValueError(f"{name} = {given!r}: it must be a whole number") from None
    if not 0 <= found < 2**63:
        raise ValueError(f"{name} = {found}: it must not be negative, and below 2⁶³")
    return found


def _mapping(name: str, given: Any) -> Any:
    if not isinstance(given, Mapping):
        raise ValueError(f"{name}: it must be a dictionary of names and units, not {type(given).__name__}")
    return given.items()


def _called(simulation: Simulation) -> Callable[[dict[str, float], dict[str, Any]], Any]:
    """The simulation, called with its inputs and, by keyword, with what it has parameters for."""
    try:
        parameters = list(inspect.signature(simulation).parameters.values())
    except (TypeError, ValueError):
        # Nobody knows what some functions in C take.
        return lambda inputs, about: simulation(inputs)
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
    by_name = (inspect.Parameter.KEYWORD_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    everything = any(other.kind is inspect.Parameter.VAR_KEYWORD for other in others)
    wanted = (
        ABOUT if everything else tuple(other.name for other in others if other.kind in by_name and other.name in ABOUT)
    )
    for other in others:
        named = other.kind in by_name and other.name in ABOUT
        various = other.kind in (inspect.Parameter.VAR_KEYWORD, inspect.Parameter.VAR_POSITIONAL)
        if not (named or various) and other.default is inspect.Parameter.empty:
            known = ", ".join(ABOUT)
            raise ValueError(f"simulation: nothing is known for its parameter {other.name!r}; what is known is {known}")
    if not wanted:
        return lambda inputs, about: simulation(inputs)
    return lambda inputs, about: simulation(inputs, **{name: about[name] for name in wanted if name in about})


def _described(simulation: Simulation) -> str:
    """Which function it is: by module, name and source."""
    function: Any = simulation
    while isinstance(function, functools.partial):
        function = function.func
    if not hasattr(function, "__qualname__"):
        function = type(function)
    name = f"{getattr(function, '__module__', None)}.{function.__qualname__}"
    try:
        source = inspect.getsource(function)
    except (OSError, TypeError):
        return name[:LONGEST]
    said = f"{SOURCE}{hashlib.sha256(source.encode()).hexdigest()[:16]}"
    return name[: LONGEST - len(said)] + said


def _progress(progress: Any) -> tuple[Callable[[int, int], object] | None, Callable[[], object]]:
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


def _array(values: Any) -> NDArray[Any]:
    if isinstance(values, tuple):
        distinct, places = values
        # The last stands for what there is not, which has the place -1.
        return np.array([*distinct, None], dtype=object)[places]
    if isinstance(values, list):
        return np.array(values, dtype=object)
    found: NDArray[Any] = values
    return found
