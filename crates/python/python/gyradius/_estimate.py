"""The law of an estimate: of an identification or a posterior."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from gyradius import _core
from gyradius._arrays import FORMS, same_names, told_form
from gyradius._bodies import MassProperties
from gyradius._body_laws import MassPropertiesLaw
from gyradius._law import Matrix, make, vector

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


class Estimate(NamedTuple):
    """The laws of bodies that are as near as can be to an estimate of the ten parameters."""

    law: MassPropertiesLaw
    """The nearer of the two below: the one whose moments are exact, else the one with the smaller ``"total"``."""
    nearest: MassProperties
    """The nearest body to the mean, in the metric of the covariance."""
    moved: float
    """How far that is, in standard deviations: 0 if the mean is that of a body."""
    joint: MassPropertiesLaw | None
    """Of mass, mass centre, gyration lengths and axes."""
    joint_distance: dict[str, Any] | None
    """How far its moments are from those of the estimate, in the ten numbers of the estimate:

    * ``"means"``: what the means differ by, in standard deviations of the estimate; None for what does not vary.
    * ``"deviations"``: by how many percent the standard deviations are larger; None for what does not vary.
    * ``"mahalanobis"``: of the means, with the covariance of the estimate.
    * ``"correlation"``: the largest difference of a correlation.
    * ``"total"``: what the laws are made to have as small as they can: the root of the sum of the squares of the differences of means in
      deviations, of half the relative differences of variances, and of covariances over the deviations of the estimate (of each pair
      once).
    * ``"is_exact"``: whether mean and covariance are those of the estimate, but for rounding.
    """
    log_cholesky: MassPropertiesLaw | None
    """A Gaussian in the log-Cholesky coordinates."""
    log_cholesky_distance: dict[str, Any] | None
    """The same of this law."""


SAID = {"linear": "m, m c, and the inertia about the origin", "natural": "mass, mass centre, and the inertia about it"}
"""Which numbers each form has."""


def from_estimate(phi: MassProperties | ArrayLike, cov: ArrayLike, *, form: Literal["linear", "natural"] = "linear") -> Estimate:
    """The laws of bodies with the mean and covariance of an estimate, as nearly as any have them.

    Parameters
    ----------
    phi : array_like, shape (10,), or MassProperties
        The estimate; it may be that of no body. A `MassProperties` is natural.
    cov : array_like, shape (10, 10)
        Its covariance.
    form : {"linear", "natural"}
        ``"linear"``: m, m c, and the inertia about the origin, as identification gives them. ``"natural"``: mass, mass centre, and
        the inertia about it. Where phi and cov have names, such as those of `gyradius.COLUMNS`, what contradicts this form, and what stands in
        another order than the rest, is refused.
    """
    if not isinstance(form, str) or form not in ("linear", "natural"):
        raise ValueError(f'form = {form!r}: it must be "linear" or "natural"')
    of_bodies = isinstance(phi, MassProperties)
    for name, told in (("phi", "natural" if of_bodies else told_form(phi)), ("cov", told_form(cov))):
        if told is not None and told != form:
            raise ValueError(f'{name}: its numbers are {SAID[told]}: these need form="{told}", and form = "{form}"')
    if isinstance(phi, MassProperties):
        phi = phi.array
    same_names(phi=phi, cov=cov)
    covariance = np.array(Matrix.of("cov", cov, (10, 10), order=FORMS[form]))
    given = vector("phi", phi, 10, order=FORMS[form])
    nearest, moved, joint, log_cholesky = _core.from_estimate(given, covariance, form == "linear")
    laws: list[tuple[MassPropertiesLaw | None, dict[str, Any] | None]] = []
    laws.append((None, None) if joint is None else (make(MassPropertiesLaw, "joint", joint[0]), json.loads(joint[1])))
    if log_cholesky is None:
        laws.append((None, None))
    else:
        mean, flat, distance = log_cholesky
        made = MassPropertiesLaw.log_cholesky(mean, np.reshape(flat, (10, 10)))
        laws.append((made, json.loads(distance)))
    known = [(law, distance) for law, distance in laws if law is not None and distance is not None]
    if not known:
        raise ValueError("no law of bodies is near the estimate")
    best = min(known, key=lambda one: (not one[1]["is_exact"], one[1]["total"]))
    return Estimate(best[0], MassProperties.of(nearest), moved, *laws[0], *laws[1])
