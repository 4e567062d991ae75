"""How long the package takes and how large it is, beside what people write with NumPy.

`python marks.py` prints the table of `docs/python.md`; `--write PAGE` puts it there, and `--wheel FILE`
adds how large that wheel is.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import gyradius

DRAWS = 49_152
MATRICES = 1_000_000
BEGIN, END = "<!-- marks -->\n", "<!-- end of marks -->"


def best(work: Callable[[], object], repeats: int = 9) -> float:
    """The shortest of several times, in ms."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return 1e3 * min(times)


def recipe(body: gyradius.MassProperties, count: int) -> np.ndarray:
    """The recipe of many training set-ups, made possible: redraw factors until no moment exceeds the sum of the others."""
    rng = np.random.default_rng(7)
    made = np.empty((count, 3, 3))
    left = np.arange(count)
    while len(left):
        factor = rng.normal(1.0, 0.1, size=(len(left), 3))
        drawn = np.repeat(body.inertia[None], len(left), axis=0)
        drawn[:, [0, 1, 2], [0, 1, 2]] *= factor
        moments = np.linalg.eigvalsh(drawn)
        good = moments[:, 0] + moments[:, 1] >= moments[:, 2]
        made[left[good]] = drawn[good]
        left = left[~good]
    return made


def imports() -> float:
    """What `import gyradius` takes beyond that of NumPy, in ms."""
    program = "import numpy, time; t = time.perf_counter(); import gyradius; print(time.perf_counter() - t)"
    found = [float(subprocess.check_output([sys.executable, "-c", program])) for _ in range(7)]
    return 1e3 * min(found)


def table(wheel: Path | None) -> str:
    """The table, a row for each mark."""
    link = gyradius.MassProperties(2.4, [0.15, 0.01, -0.02], np.diag([0.004, 0.021, 0.022]))
    normal = gyradius.normal
    lengths = [normal(0.12, 0.006), normal(0.05, 0.002), normal(0.04, 0.002)]
    axes = gyradius.small_rotations([0, 0, 0, 1], np.eye(3) * 1e-3)
    centre = [normal(0.15, 0.003), normal(0.0, 0.003), normal(0.0, 0.003)]
    joint = gyradius.MassPropertiesLaw.joint(normal(2.4, 0.1), centre, gyration_lengths=lengths, axes=axes)
    stated = gyradius.law(link, mass="5%", centre="1cm", moments="10%", axes="2deg")
    good = joint.rvs(MATRICES, rng=1).inertia
    naive = good * np.random.default_rng(1).uniform(0.5, 1.5, size=(MATRICES, 1, 3))
    naive = np.triu(naive) + np.triu(naive, 1).transpose(0, 2, 1)

    def project() -> None:
        # Eigenvalues of the second moments clipped at zero: not the nearest, but possible.
        sigma = 0.5 * np.trace(naive, axis1=1, axis2=2)[:, None, None] * np.eye(3) - naive
        values, vectors = np.linalg.eigh(sigma)
        clipped = np.einsum("nij,nj,nkj->nik", vectors, np.maximum(values, 0.0), vectors)
        _ = np.trace(clipped, axis1=1, axis2=2)[:, None, None] * np.eye(3) - clipped

    rows = [
        (f"{DRAWS:,} bodies from laws of mass, centre, lengths and axes", best(lambda: joint.rvs(DRAWS, rng=7)), None, ""),
        (
            f"{DRAWS:,} bodies from statements",
            best(lambda: stated.rvs(DRAWS, rng=7)),
            best(lambda: recipe(link, DRAWS), 3),
            "three factors, redrawn until possible",
        ),
        (
            f"`is_realizable` of {MATRICES:,} matrices",
            best(lambda: gyradius.is_realizable(good), 5),
            best(lambda: np.linalg.eigvalsh(good), 3),
            "`numpy.linalg.eigvalsh`",
        ),
        (
            f"`nearest` of {MATRICES:,} matrices",
            best(lambda: gyradius.nearest(naive), 3),
            best(project, 2),
            "second moments clipped with `eigh`",
        ),
        ("`import gyradius` beyond NumPy", imports(), None, ""),
    ]
    lines = ["| | gyradius | rival | which |", "|---|---|---|---|"]
    for what, own, rival, which in rows:
        lines.append(f"| {what} | {own:.3g} ms | {'' if rival is None else f'{rival:.3g} ms'} | {which} |")
    if wheel:
        lines.append(f"| the wheel, with the program in it | {wheel.stat().st_size / 1e6:.3g} MB |  |  |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Prints the table, or writes it into a page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", type=Path, metavar="PAGE")
    parser.add_argument("--wheel", type=Path, metavar="FILE", help="the wheel, whose size is told")
    arguments = parser.parse_args()
    made = table(arguments.wheel)
    print(f"{os.cpu_count()} cores\n{made}", end="")
    if arguments.write:
        page = arguments.write.read_text()
        before, rest = page.split(BEGIN)
        arguments.write.write_text(before + BEGIN + made + END + rest.split(END)[1])


if __name__ == "__main__":
    main()
