"""Distinct bodies of public robots, from the MJCF and URDF files in wheels on PyPI."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from dataclasses import dataclass
from pathlib import Path

import gyradius
import numpy as np

WHEELS = (
    "mjlab==1.6.0",
    "playground==0.2.0",
    "robosuite==1.5.2",
    "mani_skill==3.0.1",
    "genesis-world==1.4.5",
    "isaaclab==2.3.2",
    "brax==0.14.2",
)
ROBOTS = (".xml", ".mjcf", ".urdf")
TOLERANCE = 1e-9
"""How far below zero the smallest second moment may lie, as a share of the trace of the inertia."""


@dataclass(frozen=True)
class Found:
    """A body and where it was found first."""

    wheel: str
    file: str
    name: str
    body: gyradius.MassProperties


@dataclass
class Harvest:
    """What was found, and what was not counted."""

    bodies: list[Found]
    """Distinct bodies that can exist and whose moments are not all equal."""
    files: int = 0
    """Files that hold at least one body."""
    stated: int = 0
    """Bodies in these files, the same ones as often as they stand there."""
    balls: int = 0
    """Distinct bodies that can exist, with three equal moments."""
    impossible: int = 0
    """Distinct bodies that cannot exist."""
    massless: int = 0
    """Bodies without mass or without inertia."""


def download(folder: Path) -> list[Path]:
    """Download the wheels into a folder, those that are not there, and return them in the order of `WHEELS`."""
    found = []
    for wheel in WHEELS:
        pattern = wheel.replace("-", "_").replace("==", "-") + "-*.whl"
        if not list(folder.glob(pattern)):
            # One wheel is for Python 3.11 on Linux alone; its robots are for everybody.
            target = ["--python-version", "3.11", "--platform", "manylinux_2_35_x86_64"]
            pip = [sys.executable, "-m", "pip", "download", "--no-deps", "--only-binary", ":all:", "--dest", folder]
            subprocess.run([*pip, *target, wheel], check=True)
        found.extend(folder.glob(pattern))
    return found


def digits(numbers: np.ndarray) -> tuple[str, ...]:
    """Numbers to five digits, so that the same body in two files is one."""
    return tuple(f"{number:.5g}" for number in numbers)


def harvest(wheels: list[Path], folder: Path) -> Harvest:
    """Unpack the robots of wheels below a folder and collect their bodies.

    Bodies are the same if their masses and their principal moments agree to five digits; the first one counts.
    """
    result = Harvest([])
    seen = set()
    for wheel in wheels:
        with zipfile.ZipFile(wheel) as archive:
            names = sorted(name for name in archive.namelist() if Path(name).suffix in ROBOTS)
            for name in names:
                bodies = read(Path(archive.extract(name, folder / wheel.stem)))
                result.files += bool(bodies)
                for link, body in bodies.items():
                    result.stated += 1
                    collect(Found(wheel.stem.split("-")[0], name, link, body), result, seen)
    return result


def read(path: Path) -> dict[str, gyradius.MassProperties]:
    """The bodies of one file; none of a file that is no robot or that refers to files outside."""
    try:
        return gyradius.load(path)
    except ValueError:
        return {}


def collect(found: Found, result: Harvest, seen: set[tuple[str, ...]]) -> None:
    """Count one body."""
    body = found.body
    moments = np.linalg.eigvalsh(body.inertia)
    if not (body.mass > 0 and moments[2] > 0):
        result.massless += 1
        return
    key = digits(np.array([body.mass, *moments]))
    if key in seen:
        return
    seen.add(key)
    if not gyradius.is_realizable(body.inertia, tolerance=TOLERANCE):
        result.impossible += 1
    elif moments[2] - moments[0] < 1e-4 * moments[2]:
        result.balls += 1
    else:
        result.bodies.append(found)
