"""robosuite: a draw of some bodies for an episode, in place of the inertia of its `DynamicsModder`."""

from __future__ import annotations

import gyradius
import with_mujoco


def nominal(env, name: str) -> gyradius.MassProperties:
    """What the model of an environment says of a body, such as `robot0_link3`."""
    return with_mujoco.nominal(env.sim.model._model, name)


def apply(env, draws: dict[str, gyradius.MassProperties], index: int) -> None:
    """Put draw `index` of the bodies, by their names, into an environment, again after each hard reset. Its state stays."""
    with_mujoco.apply(env.sim.model._model, env.sim.data._data, draws, index)
