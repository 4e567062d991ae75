"""Genesis: a draw of some links for each environment.

The scene must be built with `RigidOptions(batch_links_info=True)`, and the entity be loaded with `align=False` and, from
URDF, with `merge_fixed_links=False`, so that links at fixed joints keep an inertia of their own.
"""

from __future__ import annotations

import gyradius
import numpy as np


def apply(entity, draws: dict[str, gyradius.MassProperties], n: int) -> None:
    """Write draws 0 to n − 1 of the links, by their names, into n environments."""
    for name, bodies in draws.items():
        link = entity.get_link(name)
        # Genesis takes an inertia in the axes of the inertia that the file states, which stay as they are in the link.
        w, x, y, z = np.asarray(link.desc.inertial_quat, dtype=float)
        axes = np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
            ]
        )
        link.set_mass(bodies.mass[:n])
        link.set_COM(bodies.centre[:n])
        link.set_inertia(axes.T @ bodies.inertia[:n] @ axes)
