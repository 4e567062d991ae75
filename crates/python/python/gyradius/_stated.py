"""The law of plain statements about a body."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from gyradius import _core
from gyradius._arrays import form, real
from gyradius._bodies import MassProperties, Region
from gyradius._body_laws import MassPropertiesLaw, ten_of

if TYPE_CHECKING:
    from gyradius._rng import RNG


def law(
    body: MassProperties,
    *,
    mass: Any = None,
    centre: Any = None,
    moments: Any = None,
    products: Any = None,
    axes: Any = None,
    inside: Region | None = None,
    sigmas: float = 1.0,
) -> StatedLaw:
    """The law of mass, mass centre and inertia that plain statements make about a body.

    A statement more does not change what the others draw. What nothing is said of stays as it is, but the inertia follows the
    mass. Every draw is a body.

    Parameters
    ----------
    body : MassProperties
        One body: the nominal one. A flat plate or a thin rod that rounding to six digits has made impossible is taken as the
        nearest that a body can be.
    mass : str
        ± ``"5%"``, ``"0.2kg"`` or ``"30g"``.
    centre : str
        Along each axis, ± ``"1cm"``, ``"5mm"`` or ``"0.01m"``, or three of them, ``"5mm, 5mm, 2cm"``.
    moments : str
        Of inertia about the axes of the body, ± ``"10%"`` or ``"0.3kgm2"`` (or ``"0.3 kg·m²"``), or three; what the mass does to them is
        a part.
    products : str
        Of inertia, ± ``"0.01kgm2"``, or three, of 12, 13 and 23.
    axes : str
        The rotation about each principal axis, ± ``"2deg"``, ``"2°"`` or ``"0.03rad"``, or three.
    inside : Region
        Where all matter must be possible: `box`, `ellipsoid` or `hull`.
    sigmas : float
        How many standard deviations ± stands for in all of these.

    Each statement may also be a dict as in the file of `gyradius model`, such as ``{"percent": 10, "sigmas": 3}``; what a dict says of
    ``sigmas`` comes first.

    Returns
    -------
    StatedLaw
        A `MassPropertiesLaw` with `warnings`: what cannot be had, and why.

    Examples
    --------
    >>> import numpy as np, gyradius
    >>> link = gyradius.MassProperties(2.0, [0.1, 0.0, 0.0], np.diag([0.002, 0.01, 0.011]))
    >>> law = gyradius.law(link, mass="5%", centre="1cm", moments="10%", axes="2deg")
    >>> draws = law.rvs(4096, rng=7)
    >>> draws.inertia.shape, bool(draws.is_realizable.all())
    ((4096, 3, 3), True)
    """
    if not isinstance(body, MassProperties) or body.shape != ():
        raise ValueError("body: it must be one MassProperties")
    if inside is not None and not isinstance(inside, Region):
        raise ValueError(f"inside = {inside!r}: it must be a box, an ellipsoid or a hull of gyradius")

    def said(name: str, value: Any) -> str | None:
        if value is None:
            return None
        if isinstance(value, (list, tuple)) and all(isinstance(one, str) for one in value):
            value = ",".join(value)
        if isinstance(value, Mapping):
            return form(name, {"sigmas": sigmas, **value})
        if isinstance(value, str):
            return form(name, value)
        raise ValueError(f'{name} = {value!r}: it must be a text with a unit, such as "5%", or a dict as in a file')

    core, warnings, nominal = _core.stated_law(
        ten_of(body),
        said("mass", mass),
        said("centre", centre),
        said("moments", moments),
        said("products", products),
        said("axes", axes),
        real("sigmas", sigmas),
        None if inside is None else json.dumps(inside.form),
    )
    return _stated(core, core.form(), tuple(warnings), tuple(nominal))


class StatedLaw(MassPropertiesLaw):
    """The law of mass, mass centre and inertia that statements make: see `gyradius.law`."""

    __slots__ = ("_nominal", "_warnings")

    _nominal: tuple[float, ...]
    _warnings: tuple[str, ...]

    def rvs(
        self, size: int | tuple[int, ...] | None = None, rng: RNG = None, *, inset: bool = False
    ) -> MassProperties:
        """Draws, as `MassProperties` of the shape `size`: see `AttitudeLaw.rvs` for `rng`.

        With `inset`, bodies that lie on the boundary of what bodies can have, such as flat plates and thin rods, are moved inside by 1e-9
        of the trace of their inertia, as the robots are that ``gyradius draw`` writes: programs that compare without tolerance, or
        hold numbers of 32 bits, take them then. Bodies of which no statement changes the inertia stay as they are.

        Examples
        --------
        >>> import numpy as np, gyradius
        >>> plate = gyradius.MassProperties(1.0, [0.0, 0.0, 0.0], np.diag([0.1, 0.2, 0.3]))
        >>> law = gyradius.law(plate, axes="2deg")
        >>> [bool(gyradius.margin(law.rvs(rng=7, inset=inset).inertia) > 1e-10) for inset in (False, True)]
        [False, True]
        """
        drawn = super().rvs(size, rng)
        if not inset:
            return drawn
        return MassProperties._of(_core.body_inset(drawn._flat(), self._nominal).reshape(*drawn.shape, 10))

    @property
    def warnings(self) -> tuple[str, ...]:
        """What of the statements cannot be had, and why, and what was left open."""
        return self._warnings

    def __reduce__(self) -> tuple[Any, ...]:
        return _stated_again, (*self._made[1], self._warnings, self._nominal)


def _stated_again(form: str, warnings: tuple[str, ...], nominal: tuple[float, ...]) -> StatedLaw:
    return _stated(_core.BodyCore.joint(form), form, warnings, nominal)


def _stated(core: _core.BodyCore, form: str | None, warnings: tuple[str, ...], nominal: tuple[float, ...]) -> StatedLaw:
    made = StatedLaw._of(core, "joint", form)
    object.__setattr__(made, "_warnings", warnings)
    object.__setattr__(made, "_nominal", nominal)
    return made
