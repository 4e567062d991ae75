"""MuJoCo: one draw of some bodies, put into a compiled model."""

from __future__ import annotations

import gyradius
import mujoco
import numpy as np


def compile_movable(spec: mujoco.MjSpec) -> mujoco.MjModel:
    """Compile a model whose mass centres may leave the origins of their bodies (MuJoCo 4).

    MuJoCo compiles a free body with its mass centre at the origin as simple, for speed, and then its mass matrix stays
    diagonal whatever is written.
    """
    for body in spec.bodies[1:]:
        body.simple = 0
    return spec.compile()


def nominal(model: mujoco.MjModel, name: str) -> gyradius.MassProperties:
    """What a model says of a body, whether its file states an inertia or MuJoCo made it of geoms."""
    body = model.body(name)
    axes = np.empty(9)
    mujoco.mju_quat2Mat(axes, body.iquat)
    axes = axes.reshape(3, 3)
    return gyradius.MassProperties(float(body.mass[0]), body.ipos, axes @ np.diag(body.inertia) @ axes.T)


def write(model: mujoco.MjModel, scratch: mujoco.MjData, draws: dict[str, gyradius.MassProperties], index: int) -> None:
    """Put draw `index` of the bodies, by their names, into a model, and update the constants that MuJoCo derives from it.

    MuJoCo computes these constants in the model's reference configuration, and leaves `scratch` in it: give data whose
    state nobody needs.

    Raises
    ------
    ValueError
        If a body is compiled as simple, so that its mass centre cannot leave its origin: see `compile_movable`.
    """
    for name, bodies in draws.items():
        body = model.body(name).id
        if model.body_simple[body]:
            raise ValueError(
                f"body {name}: it is compiled as simple, so its mass centre cannot move: see compile_movable"
            )
        for field, value in bodies[index].to_mujoco()._asdict().items():
            getattr(model, field)[body] = value
        # The frame of the inertia may have been that of the body, of a geom or of a site. It is no longer.
        model.body_sameframe[body] = mujoco.mjtSameFrame.mjSAMEFRAME_NONE
        model.geom_sameframe[model.geom_bodyid == body] = mujoco.mjtSameFrame.mjSAMEFRAME_NONE
        model.site_sameframe[model.site_bodyid == body] = mujoco.mjtSameFrame.mjSAMEFRAME_NONE
    mujoco.mj_setConst(model, scratch)


def apply(model: mujoco.MjModel, data: mujoco.MjData, draws: dict[str, gyradius.MassProperties], index: int) -> None:
    """Put draw `index` of the bodies into a model, as `write` does, and compute anew what `data` holds of its own state.

    The state itself stays: positions, velocities, activations, controls, forces, mocap bodies and time.
    """
    write(model, mujoco.MjData(model), draws, index)
    mujoco.mj_forward(model, data)
