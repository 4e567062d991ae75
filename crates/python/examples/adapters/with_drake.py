"""Drake: one draw of some bodies, put into a context of a plant."""

from __future__ import annotations

import gyradius
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import RotationalInertia, SpatialInertia
from pydrake.systems.framework import Context


def spatial_inertia(body: gyradius.MassProperties) -> SpatialInertia:
    """A body as Drake has it, about the origin of its frame. Drake refuses an inertia that no body has."""
    i = body.inertia
    about_centre = RotationalInertia(i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2])
    return SpatialInertia.MakeFromCentralInertia(body.mass, body.centre, about_centre)


def apply(plant: MultibodyPlant, context: Context, draws: dict[str, gyradius.MassProperties], index: int) -> None:
    """Put draw `index` of the bodies, by their names, into a context of a plant; other contexts keep theirs."""
    for name, bodies in draws.items():
        plant.GetBodyByName(name).SetSpatialInertiaInBodyFrame(context, spatial_inertia(bodies[index]))
