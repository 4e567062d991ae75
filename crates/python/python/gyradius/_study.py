"""Studies: a scenario carried out, with a function in Python as the simulation or without, and what its runs amount to."""

from __future__ import annotations

import atexit
import html
import importlib
import json
import os
import shutil
import tempfile
import warnings
import weakref
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from gyradius import _core
from gyradius._arrays import Real, flag, folder_or_file, listed, text, whole
from gyradius._simulation import ABOUT, OF_VEHICLES, SOURCE, Progress, Simulation, called_with, described, in_context, progress_of

# Threads that are in a study when the program ends, as those of daemons are.
atexit.register(_core.end_all)

if TYPE_CHECKING:
    from numpy.typing import NDArray

MOST = 2**63 - 1
"""The greatest whole number of a scenario."""

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
    """One run of a study, done again. What was kept of its row is the same, bit for bit; `text` says if that is not all of it."""

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

    A study does not change, and a copy is the study itself. In a pickle is the path of its folder, from which it is read again, and of a
    study without ``out`` all that its folder has. The simulation is in no pickle, so that runs of what is read again are not
    replayed.
    """

    __slots__ = ("__weakref__", "_done", "_is_temporary")

    _done: _core.StudyCore
    _is_temporary: bool

    def __init__(self) -> None:
        raise TypeError("gyradius.study(...) makes studies")

    @classmethod
    def _of(cls, core: _core.StudyCore, temporary: str | None) -> Study:
        made = object.__new__(cls)
        made._done = core
        made._is_temporary = temporary is not None
        if temporary is not None:
            weakref.finalize(made, _remove, temporary, os.getpid())
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
        """The resolved scenario as a TOML file, defaults filled in."""
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
        """What a run fills, each column with its meaning, as `summary` has numbers of it; `to_numpy` has those of them that were kept."""
        return {column["column"]: column["meaning"] for column in self.summary["columns"]}

    @property
    def units(self) -> dict[str, str]:
        """The units of the `columns` that have one, ``"1"`` of numbers without."""
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
        run: Real | None = None,
        *,
        model: str | None = None,
        vehicle: Real | None = None,
        flight: Real | None = None,
    ) -> Replay:
        """Does one run again, alone, and holds it against what was kept of its row, bit by bit.

        A function is called in the context that the caller of `gyradius.study` had, as it was then.

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
        row, request, told = self._done.replay(
            run=_whole("run", run), vehicle=_whole("vehicle", vehicle), flight=_whole("flight", flight), model=_text("model", model)
        )
        inputs = json.loads(request)["inputs"] if request else {}
        return Replay(row["model"], row["run"], row["status"], row, inputs, told)

    def _arrays(self, model: str) -> dict[str, NDArray[Any]]:
        return {name: _array(values) for name, _, _, values in self._done.columns(model)}

    def __copy__(self) -> Study:
        return self

    def __deepcopy__(self, known: object) -> Study:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        if not self._is_temporary:
            return _read_again, (self.folder.absolute(),)
        files = (file for file in self.folder.rglob("*") if file.is_file())
        return _made_again, (self.name, {file.relative_to(self.folder).parts: file.read_bytes() for file in files})

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


def _remove(temporary: str, process: int) -> None:
    """Removes a temporary folder, unless this is a process that was forked from the one that made it, which still has it."""
    if os.getpid() == process:
        shutil.rmtree(temporary, ignore_errors=True)


def _read_again(folder: Path) -> Study:
    return Study._of(_core.StudyCore.read(folder), None)


def _made_again(name: str, files: dict[tuple[str, ...], bytes]) -> Study:
    temporary = tempfile.mkdtemp(prefix="gyradius-")
    try:
        folder = Path(temporary) / name
        for parts, content in files.items():
            file = folder.joinpath(*parts)
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(content)
        return Study._of(_core.StudyCore.read(folder), temporary)
    except BaseException:
        shutil.rmtree(temporary, ignore_errors=True)
        raise


def study(
    scenario: str | os.PathLike[str] | Mapping[str, Any],
    simulation: Simulation | None = None,
    *,
    outputs: Mapping[str, str] | None = None,
    runs: Real | None = None,
    vehicles: Real | None = None,
    seed: Real | None = None,
    until: str | None = None,
    look_every: Real | None = None,
    rows: str | None = None,
    columns: Iterable[str] | None = None,
    drivers: Real | None = None,
    out: str | os.PathLike[str] | None = None,
    threads: Real | None = None,
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
        it is given these by keyword, but for those that a `functools.partial` has bound by keyword; its own random numbers should come from ``numpy.random.default_rng(seed)``. An exception is a
        failed run: a row with the exception's type and text. Without it, gyradius simulates separations, and a file names a command.
    outputs : dict, optional
        Names and units of the outputs. If neither this nor the scenario declares any, the first of ten runs that does not fail does,
        and units are ``"1"``; that run is done again with the others. With declared outputs no run is tried before: if all fail, as with a
        command, all rows say why.
    runs, vehicles, seed : int, optional
        In the place of what the scenario says.
    until : str, optional
        Go on until the runs show enough, at most to their number: ``"decided"``, ``"share within 0.1 %"``,
        ``"mean(spin_rad_per_s) within 0.02"``. They are looked at after ``look_every`` runs first.
        What of the two is not said is as the scenario has it.
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
    OSError
        The file of the scenario cannot be read: `FileNotFoundError`, `PermissionError`.
    KeyboardInterrupt
        After Ctrl-C, once the runs at hand have ended. With ``out``, the blocks of runs that were finished stay, and the same call
        goes on.

    Notes
    -----
    Draws depend on seed, model and run alone, so results are the same on any number of threads, if the simulation depends on its
    inputs and its seed alone. The study says in ``simulation.function`` which function it is, by module, name and SHA-256 of the source, so
    that runs of different versions are not mixed in one folder. What the function calls and refers to is not in it; therefore one of the
    finished runs in ``out`` is done again first, and a function that does it otherwise, in what was kept of it, is refused. With
    ``rows="none"``, or ``columns`` that the other function leaves as they are, nothing can tell. Say
    ``{"simulation": {"function": "spin-up, version 3"}, ...}`` in the scenario to tell versions apart yourself.

    Each call of the function is in a copy of the caller's context (`contextvars`): precision of decimal numbers, and `numpy.seterr` from
    NumPy 2 on. What else belongs to a thread, as `threading.local` and ``torch.no_grad`` do, is as in a new thread. There are 8 MiB of stack, or
    as much as the limit of the process or ``RUST_MIN_STACK`` says if that is more.

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
    flags = {"force": force, "retry_failed": retry_failed, "even_if_full": even_if_full}
    flags = {name: flag(name, value) for name, value in flags.items()}
    kept = None if columns is None else listed("columns", columns, "names")
    if kept is not None and not all(isinstance(one, str) for one in kept):
        raise ValueError(f"columns = {kept!r}: it must be a list of names")
    given = None if outputs is None else [{"name": name, "unit": unit} for name, unit in _mapping("outputs", outputs)]
    if simulation is not None and not callable(simulation):
        raise ValueError(f"simulation: it must be callable, not {type(simulation).__name__}")
    called, needed = (None, set()) if simulation is None else called_with(simulation)
    called = None if called is None else in_context(called)
    function = None if simulation is None else described(simulation)
    core, place = _scenario(scenario, function, given)
    core = core.changed(
        runs=_whole("runs", runs),
        vehicles=_whole("vehicles", vehicles),
        seed=_whole("seed", seed),
        until=_text("until", until),
        look_every=_whole("look_every", look_every),
        rows=_text("rows", rows),
        columns=kept,
        drivers=_whole("drivers", drivers),
    )
    if not core.has_vehicles and needed & OF_VEHICLES:
        raise ValueError(
            f"simulation: it asks for {' and '.join(sorted(needed & OF_VEHICLES))}, and the scenario has no vehicles; what is known of "
            f"its runs is {', '.join(name for name in ABOUT if name not in OF_VEHICLES)}"
        )
    on = _whole("threads", threads)
    if on is None and called is not None:
        on = 1
    tell, close = progress_of(progress)
    temporary = None
    if out is not None:
        place = folder_or_file("out", out)
        if not os.fspath(out):
            # An empty path would be the current folder.
            raise ValueError('out = "": it must be the name of a folder')
    if place is None:
        temporary = tempfile.mkdtemp(prefix="gyradius-")
        place = Path(temporary) / core.name
    # The study is there when somebody has changed the current folder, such as its own simulation.
    place = place.absolute()
    try:
        done = core.run(
            simulation=called,
            out=place,
            threads=on,
            progress=tell,
            **flags,
        )
    except BaseException:
        if temporary is not None:
            shutil.rmtree(temporary, ignore_errors=True)
        raise
    finally:
        close()
    for warning in done.warnings:
        warnings.warn(warning, RuntimeWarning, stacklevel=2)
    found = Study._of(done, temporary)
    for model, failed, of in done.failed:
        if failed == of > 0:
            # If the rows were kept.
            reason = "".join(f"; the first: {status}" for status in found._arrays(model).get("status", [])[:1])
            warnings.warn(f"{model}: all {of} runs failed{reason}", RuntimeWarning, stacklevel=2)
    return found


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
    path = folder_or_file("scenario", scenario)
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
    return None if given is None else whole(name, given, MOST, of_float=True)


def _text(name: str, given: Any) -> str | None:
    return None if given is None else text(name, given)


def _mapping(name: str, given: Any) -> Any:
    if not isinstance(given, Mapping):
        raise ValueError(f"{name}: it must be a dictionary of names and units, not {type(given).__name__}")
    return given.items()


def _array(values: Any) -> NDArray[Any]:
    if isinstance(values, tuple):
        distinct, places = values
        # The last stands for what there is not, which has the place -1.
        return np.array([*distinct, None], dtype=object)[places]
    if isinstance(values, list):
        return np.array(values, dtype=object)
    found: NDArray[Any] = values
    return found
