"""Basilisk: one draw of the hub of a spacecraft. Set it before the simulation is initialized."""

from __future__ import annotations

import gyradius
from Basilisk.simulation import spacecraft


def apply(satellite: spacecraft.Spacecraft, hub: gyradius.MassProperties, index: int) -> None:
    """Put draw `index` of the hub into a spacecraft: its mass centre from the origin of the hub, in axes of the hub."""
    drawn = hub[index]
    satellite.hub.mHub = float(drawn.mass)
    satellite.hub.r_BcB_B = drawn.centre.reshape(3, 1).tolist()
    satellite.hub.IHubPntBc_B = drawn.inertia.tolist()
