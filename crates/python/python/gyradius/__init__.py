"""Uncertain rigid-body mass properties: every drawn body can be built.

Inertia is about the mass centre, in the axes of the body, in kg·m²; products are tensor entries, I₁₂ = -∫ x₁ x₂ dm. Quaternions
have the scalar last unless ``order="wxyz"`` says otherwise. Arrays have any leading shape, and are computed in 64 bits.

Without any law
    `is_realizable`, `margin`, `report`, `nearest`, `principal_axes` of inertia matrices; `MassProperties`, which are added, moved
    and turned; `load` for the links of a robot.
Laws
    `law` of plain statements about a body, and `laws` about the links of a robot; `MassPropertiesLaw`, `InertiaLaw`, `AttitudeLaw`
    and `ScalarLaw` with ``rvs``, ``logpdf``, ``mean``, ``cov`` and ``fit``; `from_estimate` of an identification.
Random numbers
    ``rng=`` an integer, a `numpy.random.Generator`, or a `key`, whose draws do not depend on what else is drawn.

>>> import numpy as np, gyradius
>>> link = gyradius.MassProperties(2.0, [0.1, 0.0, 0.0], np.diag([0.002, 0.01, 0.011]))
>>> draws = gyradius.law(link, mass="5%", centre="1cm", moments="10%", axes="2deg").rvs(4096, rng=7)
>>> bool(draws.is_realizable.all())
True
"""

from gyradius._attitude_laws import (
    AttitudeLaw,
    about_axis,
    bingham,
    fisher_bingham,
    fixed_attitude,
    radially_constrained_gaussian,
    small_rotations,
    uniform_attitude,
)
from gyradius._bodies import (
    COLUMNS,
    MassProperties,
    MujocoBodies,
    Region,
    box,
    ellipsoid,
    hull,
    load,
    log_cholesky,
    pseudo_inertia,
)
from gyradius._body_laws import MassPropertiesLaw
from gyradius._core import __version__
from gyradius._estimate import Estimate, from_estimate
from gyradius._inertia import (
    PrincipalAxes,
    Report,
    is_realizable,
    margin,
    nearest,
    principal_axes,
    report,
)
from gyradius._inertia_laws import InertiaLaw
from gyradius._law import Fit
from gyradius._rng import key
from gyradius._scalar_laws import ScalarLaw, normal, uniform
from gyradius._stated import StatedLaw, law, laws
from gyradius._study import Replay, Study, Verdict, study

__all__ = [
    "COLUMNS",
    "AttitudeLaw",
    "Estimate",
    "Fit",
    "InertiaLaw",
    "MassProperties",
    "MassPropertiesLaw",
    "MujocoBodies",
    "PrincipalAxes",
    "Region",
    "Replay",
    "Report",
    "ScalarLaw",
    "StatedLaw",
    "Study",
    "Verdict",
    "__version__",
    "about_axis",
    "bingham",
    "box",
    "ellipsoid",
    "fisher_bingham",
    "fixed_attitude",
    "from_estimate",
    "hull",
    "is_realizable",
    "key",
    "law",
    "laws",
    "load",
    "log_cholesky",
    "margin",
    "nearest",
    "normal",
    "principal_axes",
    "pseudo_inertia",
    "radially_constrained_gaussian",
    "report",
    "small_rotations",
    "study",
    "uniform",
    "uniform_attitude",
]
