"""Draws the picture of the README: a slender stage, each moment for itself and as a body.

`python slender_stage.py ../../../docs/images/slender-stage.svg` writes it.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import gyradius
from gyradius import _figure

DRAWS = 2000


def picture() -> str:
    """Moments of inertia known to 10 %, in kg·m²."""
    stage = gyradius.MassProperties(4000.0, np.zeros(3), np.diag([2000.0, 15000.0, 15500.0]))
    naive = gyradius.MassPropertiesLaw.naive(stage, "diagonal-factors", gyradius.normal(1.0, 0.1))
    law = gyradius.law(stage, moments="10%")
    panels = [
        ("each moment drawn for itself", naive.rvs(DRAWS, rng=7).inertia),
        ("gyradius, the same deviations", law.rvs(DRAWS, rng=7).inertia),
    ]
    return _figure.triangle(panels, "A slender stage whose moments of inertia are known to 10 %")


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(picture())
