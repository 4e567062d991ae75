"""What rules for randomizing an inertia do to the bodies of public robots, as docs/domain-randomization.md tells.

python table.py                  # download 370 MB of wheels, draw, print the tables
python table.py --write PAGE     # and write them into a page, between the markers
python table.py --wheels FOLDER  # use and keep the wheels in a folder
"""

from __future__ import annotations

import argparse
import tempfile
import zlib
from collections import Counter
from pathlib import Path

import gyradius
import numpy as np
from harvest import TOLERANCE, Harvest, download, harvest
from plates import not_finite
from rules import RULES

SEED = 2026
DRAWS = 4000
STATED = {
    "mass ± 10 %, centre ± 5 mm, moments ± 15 %, axes ± 5°": {
        "mass": "10%",
        "centre": "5mm",
        "moments": "15%",
        "axes": "5deg",
    },
    "moments ± 28.9 %, the standard deviation of U(0.5, 1.5)": {"moments": "28.9%"},
}
"""What is stated of each body."""


def impossible(inertias: np.ndarray) -> float:
    """The share of inertias (n, 3, 3) that no body has; of one that is not symmetric, the symmetric part counts."""
    symmetric = (inertias + np.swapaxes(inertias, -1, -2)) / 2
    return float(np.mean(~gyradius.is_realizable(symmetric, tolerance=TOLERANCE)))


def row(rule: str, source: str, shares: list[float]) -> str:
    """A row of the table, from the share of impossible draws of each body."""
    low, high = np.quantile(shares, [0.1, 0.9])
    spread = [f"{percent(low)} – {percent(high)}", percent(np.mean(np.array(shares) > 0), 0)]
    return (
        "| " + " | ".join([rule, source, percent(np.mean(shares)), *(spread if len(shares) > 1 else ["", ""])]) + " |"
    )


def percent(share: float, digits: int = 1) -> str:
    """A share in percent; what is not exactly nothing or all does not read so."""
    text = f"{100 * share:.{digits}f}"
    if share > 0 and float(text) == 0:
        text = f"< {10.0**-digits:.{digits}f}"
    return "0 %" if share == 0 else f"{text} %"


def rules_table(bodies: list[gyradius.MassProperties]) -> str:
    """The table of rules."""
    lines = [
        "| rule | read in | impossible draws, mean | middle 80 % of bodies | bodies hit |",
        "|---|---|---|---|---|",
    ]
    for rule in RULES:
        purpose = zlib.crc32(rule.what.encode())
        chosen = [body.inertia for body in bodies] if rule.body is None else [rule.body]
        generators = (np.random.default_rng([SEED, purpose, number]) for number in range(len(chosen)))
        shares = [impossible(rule.draw(inertia, rng, DRAWS)) for inertia, rng in zip(chosen, generators)]
        lines.append(row(rule.what, str(rule.source), shares))
    for words, stated in STATED.items():
        laws = (gyradius.law(body, **stated) for body in bodies)
        shares = [impossible(law.rvs(DRAWS, rng=gyradius.key(SEED, str(i))).inertia) for i, law in enumerate(laws)]
        lines.append(row(f"**{words}**", "`gyradius.law`", shares))
    return "\n".join(lines)


def bodies_text(found: Harvest) -> str:
    """Which bodies are counted."""
    wheels = Counter(body.wheel for body in found.bodies)
    text = ", ".join(f"{name} {count}" for name, count in wheels.items())
    return (
        f"{len(found.bodies)} bodies: {text}. {found.files} files state {found.stated:,} bodies. A body counts once, where "
        "it is found first, if mass and principal moments agree to five digits. Left out are "
        f"{found.balls} with three equal moments, {found.impossible} that cannot exist as they are stated, and "
        f"{found.massless:,} stated without mass or inertia."
    )


def written(page: str, name: str, text: str) -> str:
    """A page with the text between its markers `<!-- name -->` and `<!-- end of name -->`."""
    start, end = f"<!-- {name} -->\n", f"\n<!-- end of {name} -->"
    if page.count(start) != 1 or page.count(end) != 1:
        raise ValueError(f"the page has no {start.strip()} with its end, or several")
    return page.split(start)[0] + start + text + end + page.split(end)[1]


def main() -> None:
    """Print the tables, and write them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--wheels", type=Path, help="a folder of wheels, which are downloaded if they are not there")
    parser.add_argument("--write", type=Path, help="a page that has the markers")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        found = harvest(download(options.wheels or Path(scratch)), Path(scratch) / "robots")
    texts = {
        "bodies": bodies_text(found),
        "rules": rules_table([body.body for body in found.bodies]),
        "plates": f"{100 * not_finite(np.random.default_rng([SEED, 0]), 10_000):.0f} %",
    }
    for text in texts.values():
        print(text, end="\n\n")
    if options.write:
        page = options.write.read_text()
        for name, text in texts.items():
            page = written(page, name, text)
        options.write.write_text(page)


if __name__ == "__main__":
    main()
