"""Isaac Lab: a draw of some bodies for each environment, through the tensors of PhysX.

The tensors are on the CPU and of 32 bits: masses (environments, bodies), poses of the mass centres (environments,
bodies, 7) with the quaternion scalar last, and inertias (environments, bodies, 9) about the mass centre in the axes of
the link.
"""

from __future__ import annotations

import gyradius
import torch


def apply(asset, env_ids: torch.Tensor | None, draws: dict[str, gyradius.MassProperties]) -> None:
    """Write a draw of the bodies, by their names, into each of some environments: row i of the draws into `env_ids[i]`.

    `asset` is an articulation, and `env_ids` is what an event gets: a tensor of indices on any device, or None for all environments.

    Raises
    ------
    RuntimeError
        If the simulator does not hold what was written, body by body. Some versions drop the products of inertia of
        rigid objects.
    """
    view = asset.root_physx_view
    masses, poses, inertias = view.get_masses(), view.get_coms(), view.get_inertias()
    env_ids = torch.arange(len(masses), device="cpu") if env_ids is None else env_ids.cpu()
    for name, bodies in draws.items():
        body = asset.body_names.index(name)
        rows = slice(0, len(env_ids))
        masses[env_ids, body] = masses.new_tensor(bodies.mass[rows])
        poses[env_ids, body, :3] = poses.new_tensor(bodies.centre[rows])
        poses[env_ids, body, 3:] = poses.new_tensor([0.0, 0.0, 0.0, 1.0])
        inertias[env_ids, body] = inertias.new_tensor(bodies.inertia[rows].reshape(-1, 9))
    view.set_masses(masses, env_ids)
    view.set_coms(poses, env_ids)
    view.set_inertias(inertias, env_ids)
    # The turn of the axes is left out: PhysX may turn them to the principal ones.
    held = {
        "masses": (masses[..., None], view.get_masses()[..., None]),
        "mass centres": (poses[..., :3], view.get_coms()[..., :3]),
        "inertias": (inertias, view.get_inertias()),
    }
    for what, (written, read) in held.items():
        # As seen from the body itself: what is small beside other bodies may be all of this one.
        if not (abs(read - written) <= 1e-5 * abs(written).sum(-1)[..., None]).all():
            raise RuntimeError(f"the simulator does not hold the {what} that were written")
