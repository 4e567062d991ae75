"""MuJoCo: one draw of some bodies, put into a compiled model."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from operator import attrgetter

import gyradius
import mujoco
import numpy as np

KEPT = (
    "eq_data",
    "tendon_length0",
    "tendon_lengthspring",
    "actuator_length0",
    "actuator_biasprm",
    "cam_pos0",
    "cam_mat0",
    "light_pos0",
    "light_dir0",
    "flexedge_length0",
    "stat.center",
    "stat.extent",
    "stat.meansize",
)
"""What `mj_setConst` computes in the reference configuration although it does not depend on masses: a program may have set it since the
model was compiled, such as the anchors of a grasp, or the file may state it."""

SLEEP = int(getattr(mujoco.mjtEnableBit, "mjENBL_SLEEP", 0))
"""The flag by which bodies at rest may sleep, which older versions lack."""


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
    state nobody needs. Of the model, only what depends on the masses changes.

    Raises
    ------
    ValueError
        If a body is compiled as simple, and its mass centre would leave its origin or its principal axes would turn: see
        `compile_movable`. The model is then as it was.
    """
    drawn = {model.body(name).id: bodies[index].to_mujoco() for name, bodies in draws.items()}
    for body, values in drawn.items():
        frame = *values.body_ipos, *np.abs(values.body_iquat)
        # To as much as MuJoCo itself takes for equal.
        if model.body_simple[body] and not np.allclose(frame, [0, 0, 0, 1, 0, 0, 0], rtol=0, atol=1e-6):
            raise ValueError(
                f"body {model.body(body).name}: it is compiled as simple, so its mass centre must stay at its origin, and its principal "
                f"axes along its own, and the draw has body_ipos = {values.body_ipos} and body_iquat = {values.body_iquat}: see compile_movable"
            )
    for body, values in drawn.items():
        for field, value in values._asdict().items():
            getattr(model, field)[body] = value
        # The frame of the inertia may have been that of the body, of a geom or of a site. It is no longer.
        model.body_sameframe[body] = mujoco.mjtSameFrame.mjSAMEFRAME_NONE
        model.geom_sameframe[model.geom_bodyid == body] = mujoco.mjtSameFrame.mjSAMEFRAME_NONE
        model.site_sameframe[model.site_bodyid == body] = mujoco.mjtSameFrame.mjSAMEFRAME_NONE
    kept = [(*name.rpartition(".")[::2], np.copy(attrgetter(name)(model))) for name in KEPT]
    with nothing_asleep(model):
        mujoco.mj_setConst(model, scratch)
        fit_boxes(model, scratch, np.array(list(drawn), dtype=int))
    for owner, name, value in kept:
        setattr(attrgetter(owner)(model) if owner else model, name, value)


@contextmanager
def nothing_asleep(model: mujoco.MjModel) -> Iterator[None]:
    """While this holds, MuJoCo computes all bodies, also those that sleep."""
    flags = model.opt.enableflags
    model.opt.enableflags &= ~SLEEP
    try:
        yield
    finally:
        model.opt.enableflags = flags


def fit_boxes(model: mujoco.MjModel, data: mujoco.MjData, bodies: np.ndarray) -> None:
    """Fit the bounding boxes of some bodies anew, by which MuJoCo passes over geoms far from a contact or from a ray.

    They stand in the frame of the inertia. MuJoCo 3.9.0 leaves them in the one that was compiled, and then contacts are lost; 4.0.0 fits
    them itself. `data` has any configuration of the model.
    """
    counts = model.body_bvhnum[bodies]
    starts = np.repeat(np.cumsum(counts) - counts, counts)
    owners = np.repeat(bodies, counts)
    nodes = model.body_bvhadr[owners] + np.arange(len(starts)) - starts
    geoms, depths = model.bvh_nodeid[nodes], model.bvh_depth[nodes]
    is_leaf = geoms >= 0
    geoms, of = geoms[is_leaf], owners[is_leaf]
    axes = data.ximat[of].reshape(-1, 3, 3).transpose(0, 2, 1)
    turns = axes @ data.geom_xmat[geoms].reshape(-1, 3, 3)
    middle = axes @ (data.geom_xpos[geoms] - data.xipos[of])[:, :, None] + turns @ model.geom_aabb[geoms, :3, None]
    half = np.abs(turns) @ model.geom_aabb[geoms, 3:, None]
    # How far the boxes reach up and down each axis: what holds two others, as far as the farther one.
    reach = np.empty((len(nodes), 2, 3))
    reach[is_leaf] = np.stack([half + middle, half - middle], axis=1)[..., 0]
    for depth in reversed(range(depths.max(initial=0))):
        parents = np.flatnonzero(~is_leaf & (depths == depth))
        reach[parents] = reach[starts[parents, None] + model.bvh_child[nodes[parents]]].max(axis=1)
    up, down = reach[:, 0], reach[:, 1]
    model.bvh_aabb[nodes] = 0.5 * np.hstack([up - down, up + down])


def apply(model: mujoco.MjModel, data: mujoco.MjData, draws: dict[str, gyradius.MassProperties], index: int) -> None:
    """Put draw `index` of the bodies into a model, as `write` does, and compute anew what `data` holds of its own state.

    The state itself stays: positions, velocities, activations, controls, forces, mocap bodies and time. Only what is drawn wakes up if it
    was asleep, and what sleeps with it, for a body with another mass centre may fall.
    """
    scratch = mujoco.MjData(model)
    write(model, scratch, draws, index)
    if SLEEP:
        bodies = np.array([model.body(name).id for name in draws], dtype=int)
        trees = model.body_treeid[bodies]
        # As MuJoCo marks what was moved in its sleep: it wakes such a tree, and all that fell asleep with it.
        data.tree_awake[trees[trees >= 0]] = 1
        # Bodies that cannot move are placed when data is made, and never again.
        still = bodies[trees < 0]
        data.xipos[still], data.ximat[still] = scratch.xipos[still], scratch.ximat[still]
    mujoco.mj_forward(model, data)
