"""The laws of plain statements about a body, and about the links of a robot."""

from __future__ import annotations

import json
import warnings
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from gyradius import _core
from gyradius._arrays import flag, form, real
from gyradius._bodies import MassProperties, Region
from gyradius._body_laws import MassPropertiesLaw, ten_of

if TYPE_CHECKING:
    from gyradius._arrays import Real, Size
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
    sigmas: Real = 1.0,
) -> StatedLaw:
    """The law of mass, mass centre and inertia that plain statements make about a body.

    There must be one statement or more. One more does not change what the others draw. What nothing is said of stays as it is, but the inertia follows the
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
    ``sigmas`` comes first. It may not have ``arm_m``: mass centre and inertia are drawn together, and the inertia is about the
    mass centre as it is drawn. So `centre` leaves the inertia as it is. In the law that `gyradius model` writes, whose inertia is about
    the nominal mass centre, an uncertain mass centre adds to those moments and products of which nothing is stated.

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
    _check_body("body", body)
    _check_region("inside", inside)
    return _about(body, _statements(mass, centre, moments, products, axes, sigmas), inside)


def laws(
    robot: Mapping[str, MassProperties],
    *,
    mass: Any = None,
    centre: Any = None,
    moments: Any = None,
    products: Any = None,
    axes: Any = None,
    inside: Mapping[str, Region] | None = None,
    sigmas: Real = 1.0,
) -> dict[str, StatedLaw]:
    """The laws that plain statements make about the links of a robot, each about its own nominal numbers.

    Each law is that of `gyradius.law`, and links are drawn independently of each other if each has its name as the term of a
    `gyradius.key`. The draws are then those of ``gyradius draw`` with the same seed, which are drawn with ``inset=True``.

    Parameters
    ----------
    robot : mapping of str to MassProperties
        As `gyradius.load` returns it: one body for each name.
    mass, centre, moments, products, axes, sigmas
        As for `gyradius.law`. An amount with a unit is the same for all links.
    inside : mapping of str to Region
        Where all matter of a link must be possible, in the frame of that link, for the links that it names.

    Returns
    -------
    dict of str to StatedLaw
        In the order of `robot`, without the links that have a mass of 0, which stay as they are: a `RuntimeWarning` names them.

    Raises
    ------
    ValueError
        No body has the numbers of some links, or the statements are beyond what these links can have. All of them are named, with the reason.

    Examples
    --------
    >>> import numpy as np, gyradius
    >>> robot = {name: gyradius.MassProperties(2.0, [0.1, 0.0, 0.0], np.diag([0.002, 0.01, 0.011])) for name in ("arm", "hand")}
    >>> laws = gyradius.laws(robot, mass="5%", centre="1cm", moments="10%", axes="2deg")
    >>> draws = {name: law.rvs(4096, rng=gyradius.key(7, name)) for name, law in laws.items()}
    >>> draws["hand"].inertia.shape, bool(draws["hand"].is_realizable.all())
    ((4096, 3, 3), True)
    """
    if not isinstance(robot, Mapping):
        raise ValueError(f"robot = {robot!r}: it must be a dict of bodies by the names of their links, as gyradius.load returns it")
    if inside is not None and not isinstance(inside, Mapping):
        raise ValueError(f"inside = {inside!r}: it must be a dict of regions by the names of their links")
    regions: Mapping[str, Region] = {} if inside is None else inside
    for name, body in robot.items():
        _check_body(f"robot[{name!r}]", body)
    for name, region in regions.items():
        if name not in robot:
            raise ValueError(f"inside: the robot has no link {name!r}")
        _check_region(f"inside[{name!r}]", region)
    statements = _statements(mass, centre, moments, products, axes, sigmas)
    made, weightless, refused = {}, [], []
    for name, body in robot.items():
        if body.mass == 0.0:
            weightless.append(name)
            continue
        try:
            made[name] = _about(body, statements, regions.get(name))
        except ValueError as error:
            refused.append(f'"{name}": {error}')
    if refused:
        raise ValueError(f"{len(refused)} of {len(robot)} links have no law: {'; '.join(refused)}")
    if weightless:
        left_out = ", ".join(f'"{name}"' for name in weightless)
        warnings.warn(f"links with a mass of 0 kg have no law, and are left out: {left_out}", RuntimeWarning, stacklevel=2)
    return made


def _check_body(name: str, body: Any) -> None:
    if not isinstance(body, MassProperties) or body.shape != ():
        raise ValueError(f"{name}: it must be one MassProperties")


def _check_region(name: str, region: Any) -> None:
    if region is not None and not isinstance(region, Region):
        raise ValueError(f"{name} = {region!r}: it must be a box, an ellipsoid or a hull of gyradius")


EXAMPLES = {"mass": "5%", "centre": "5mm", "moments": "10%", "products": "0.1kgm2", "axes": "2deg"}
"""What may be stated of each."""


def _statements(mass: Any, centre: Any, moments: Any, products: Any, axes: Any, sigmas: Real) -> _core.StatementsCore:
    if all(value is None for value in (mass, centre, moments, products, axes)):
        raise ValueError(
            'nothing is stated: mass="10%", centre="5mm", moments="15%" and axes="5deg" say what is uncertain'
        )

    def said(name: str, value: Any) -> str | None:
        if value is None:
            return None
        if isinstance(value, (list, tuple)) and all(isinstance(one, str) for one in value):
            value = ",".join(value)
        if isinstance(value, Mapping):
            return form(name, {"sigmas": sigmas, **value})
        if isinstance(value, str):
            return form(name, value)
        raise ValueError(
            f'{name} = {value!r}: it must be a text with a unit, such as "{EXAMPLES[name]}", or a dict as in a file'
        )

    return _core.StatementsCore(
        said("mass", mass),
        said("centre", centre),
        said("moments", moments),
        said("products", products),
        said("axes", axes),
        real("sigmas", sigmas),
    )


def _about(body: MassProperties, statements: _core.StatementsCore, inside: Region | None) -> StatedLaw:
    core, warned = statements.about(ten_of("body", body), None if inside is None else json.dumps(inside.form))
    return _stated(core, core.form(), tuple(warned))


class StatedLaw(MassPropertiesLaw):
    """The law of mass, mass centre and inertia that statements make: see `gyradius.law`."""

    __slots__ = ("_warnings",)

    _warnings: tuple[str, ...]

    def rvs(
        self, size: Size = None, rng: RNG = None, *, inset: bool = False
    ) -> MassProperties:
        """Draws, as `MassProperties` of the shape `size`: see `AttitudeLaw.rvs` for `rng`.

        With `inset`, bodies that lie on the boundary of what bodies can have, such as flat plates and thin rods, are moved inside by 1e-9
        of the trace of their inertia, as the robots are that ``gyradius draw`` writes: programs that compare 64-bit numbers without tolerance
        take them then. In 32 bits rounding is larger, up to 1e-7 of
        the trace: for programs that compare those without tolerance, add 1e-6 of the trace to each of the three moments.

        Examples
        --------
        >>> import numpy as np, gyradius
        >>> plate = gyradius.MassProperties(1.0, [0.0, 0.0, 0.0], np.diag([0.1, 0.2, 0.3]))
        >>> law = gyradius.law(plate, axes="2deg")
        >>> [bool(gyradius.margin(law.rvs(rng=7, inset=inset).inertia) > 1e-10) for inset in (False, True)]
        [False, True]
        >>> drawn = law.rvs(1000, rng=7)
        >>> trace = np.trace(drawn.inertia, axis1=1, axis2=2)[:, None, None]
        >>> thicker = gyradius.MassProperties(drawn.mass, drawn.centre, drawn.inertia + 1e-6 * trace * np.eye(3))
        >>> moments = thicker.to_mujoco(np.float32).body_inertia
        >>> bool((2 * moments.max(axis=1) <= moments.sum(axis=1)).all())
        True
        """
        is_inset = flag("inset", inset)
        drawn = super().rvs(size, rng)
        if not is_inset:
            return drawn
        return MassProperties._of(_core.body_inset(drawn._flat()).reshape(*drawn.shape, 10))

    @property
    def warnings(self) -> tuple[str, ...]:
        """What of the statements cannot be had, and why, and what was left open."""
        return self._warnings

    def __reduce__(self) -> tuple[Any, ...]:
        return _stated_again, (*self._made[1], self._warnings)


def _stated_again(form: str, warnings: tuple[str, ...]) -> StatedLaw:
    return _stated(_core.BodyCore.joint(form), form, warnings)


def _stated(core: _core.BodyCore, form: str | None, warnings: tuple[str, ...]) -> StatedLaw:
    made = StatedLaw._of(core, "joint", form)
    object.__setattr__(made, "_warnings", warnings)
    return made
