"""MJX and MuJoCo Playground: a draw of some bodies for each environment of a batch."""

from __future__ import annotations

import copy
from collections.abc import Callable
from operator import attrgetter

import gyradius
import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import with_mujoco
from mujoco import mjx

FIELDS = (
    "body_mass",
    "body_ipos",
    "body_inertia",
    "body_iquat",
    # What MuJoCo derives from them.
    "body_subtreemass",
    "body_invweight0",
    "dof_invweight0",
    "dof_M0",
    "tendon_invweight0",
    "actuator_acc0",
    "cam_poscom0",
    "light_poscom0",
    # Which MuJoCo 3 derives and uses; MuJoCo 4 does neither.
    "stat.meaninertia",
)


def randomize(
    host: mujoco.MjModel, model: mjx.Model, draws: dict[str, gyradius.MassProperties], n: int
) -> tuple[mjx.Model, mjx.Model]:
    """The model with n draws of the bodies along the first axis, and the axes for `jax.vmap`: 0 for what is drawn."""
    scratch, fields = copy.copy(host), {name: [] for name in FIELDS if hasattr(model, name.split(".")[0])}
    data = mujoco.MjData(scratch)
    for index in range(n):
        with_mujoco.write(scratch, data, draws, index)
        for name, rows in fields.items():
            rows.append(np.array(attrgetter(name)(scratch)))
    axes = jax.tree.map(lambda _: None, model).tree_replace(dict.fromkeys(fields, 0))
    return model.tree_replace({name: jnp.asarray(np.stack(rows)) for name, rows in fields.items()}), axes


def for_playground(
    host: mujoco.MjModel, draws: dict[str, gyradius.MassProperties]
) -> Callable[[mjx.Model, jax.Array], tuple[mjx.Model, mjx.Model]]:
    """A function as MuJoCo Playground and Brax want it in `randomization_fn`: one key for each environment.

    The keys are only counted. The draws are those given, environment 7 has draw 7, and their seed is that of `rvs`.
    """
    return lambda model, rng: randomize(host, model, draws, rng.shape[0])
