"""Pinocchio: one draw of some links, put into a model."""

from __future__ import annotations

import gyradius
import pinocchio


def inertia(body: gyradius.MassProperties) -> pinocchio.Inertia:
    """A body as Pinocchio has it: mass, mass centre, and inertia about the mass centre."""
    return pinocchio.Inertia(float(body.mass), body.centre, body.inertia)


def apply(
    model: pinocchio.Model,
    nominal: dict[str, gyradius.MassProperties],
    draws: dict[str, gyradius.MassProperties],
    index: int,
) -> pinocchio.Model:
    """A copy of a nominal model with draw `index` of the links, by their names.

    Pinocchio adds up the links that a joint moves, also those at the end of fixed joints, so the nominal link is taken
    away and the drawn one added.
    """
    changed = model.copy()
    for name, bodies in draws.items():
        frame = model.frames[model.getFrameId(name, pinocchio.FrameType.BODY)]
        before = frame.placement.act(inertia(nominal[name])).toDynamicParameters()
        after = frame.placement.act(inertia(bodies[index])).toDynamicParameters()
        whole = changed.inertias[frame.parentJoint].toDynamicParameters() - before + after
        changed.inertias[frame.parentJoint] = pinocchio.Inertia.FromDynamicParameters(whole)
    return changed
