"""Rules by which public code randomizes an inertia, each written anew from what the code does.

A rule takes the inertia of a body about its mass centre in the axes of the link, shape (3, 3) in kg·m² with products
as tensor entries, a generator and a count n, and returns n inertias, shape (n, 3, 3). `RULES` holds them with their
source.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

Draw = Callable[[np.ndarray, np.random.Generator, int], np.ndarray]

DIAGONAL = np.arange(3)


def entrywise_diagonal(low: float, high: float) -> Draw:
    """Give each of the three diagonal entries a uniform factor of its own; leave the products as they are."""

    def draw(inertia: np.ndarray, rng: np.random.Generator, n: int) -> np.ndarray:
        drawn = np.repeat(inertia[None], n, axis=0)
        drawn[:, DIAGONAL, DIAGONAL] *= rng.uniform(low, high, (n, 3))
        return drawn

    return draw


def first_entry(low: float, high: float) -> Draw:
    """Give I₁₁ alone a uniform factor."""

    def draw(inertia: np.ndarray, rng: np.random.Generator, n: int) -> np.ndarray:
        drawn = np.repeat(inertia[None], n, axis=0)
        drawn[:, 0, 0] *= rng.uniform(low, high, n)
        return drawn

    return draw


def entrywise_all(low: float, high: float) -> Draw:
    """Give each of the nine entries a uniform factor of its own."""

    def draw(inertia: np.ndarray, rng: np.random.Generator, n: int) -> np.ndarray:
        return inertia * rng.uniform(low, high, (n, 3, 3))

    return draw


def common_diagonal(low: float, high: float) -> Draw:
    """Give the three diagonal entries one uniform factor; leave the products as they are."""

    def draw(inertia: np.ndarray, rng: np.random.Generator, n: int) -> np.ndarray:
        drawn = np.repeat(inertia[None], n, axis=0)
        drawn[:, DIAGONAL, DIAGONAL] *= rng.uniform(low, high, (n, 1))
        return drawn

    return draw


def common_all(low: float, high: float) -> Draw:
    """Give all nine entries one uniform factor, as a mass does that the inertia follows."""

    def draw(inertia: np.ndarray, rng: np.random.Generator, n: int) -> np.ndarray:
        return inertia * rng.uniform(low, high, (n, 1, 1))

    return draw


def added_diagonal(share: float) -> Draw:
    """Add one uniform number between 0 and a share of the mean moment to the three diagonal entries."""

    def draw(inertia: np.ndarray, rng: np.random.Generator, n: int) -> np.ndarray:
        return inertia + rng.uniform(0.0, share * np.trace(inertia) / 3, (n, 1, 1)) * np.eye(3)

    return draw


def added_all(share: float) -> Draw:
    """Add one uniform number between 0 and a share of the mean moment to all nine entries."""

    def draw(inertia: np.ndarray, rng: np.random.Generator, n: int) -> np.ndarray:
        return inertia + rng.uniform(0.0, share * np.trace(inertia) / 3, (n, 1, 1))

    return draw


def replaced_all(low: float, high: float) -> Draw:
    """Set all nine entries to one uniform number."""

    def draw(inertia: np.ndarray, rng: np.random.Generator, n: int) -> np.ndarray:
        return np.ones((3, 3)) * rng.uniform(low, high, (n, 1, 1))

    return draw


def principal_moments(ratio: float) -> Draw:
    """Give each principal moment a uniform factor between 1 − ratio and 1 + ratio of its own; keep their axes."""

    def draw(inertia: np.ndarray, rng: np.random.Generator, n: int) -> np.ndarray:
        moments, axes = np.linalg.eigh(inertia)
        drawn = moments * rng.uniform(1.0 - ratio, 1.0 + ratio, (n, 3))
        return np.einsum("ij,nj,kj->nik", axes, drawn, axes)

    return draw


def gaussian_all(deviation: float) -> Draw:
    """Add nine independent normal numbers of a standard deviation in kg·m², without making the result symmetric."""

    def draw(inertia: np.ndarray, rng: np.random.Generator, n: int) -> np.ndarray:
        return inertia + deviation * rng.standard_normal((n, 3, 3))

    return draw


def unchanged(inertia: np.ndarray, rng: np.random.Generator, n: int) -> np.ndarray:
    """Leave the inertia as it is, while the mass or the mass centre is drawn."""
    return np.repeat(inertia[None], n, axis=0)


@dataclass(frozen=True)
class Rule:
    """A rule with where it was read."""

    what: str
    """What the rule does, with its range, as the table says it."""
    where: str
    """Repository or package, with the commit or the version that was read."""
    file: str
    """The file and the function in it."""
    draw: Draw
    body: np.ndarray | None = None
    """The inertia that the code uses it on, if its numbers are for one body."""


ROBOT_LAB = "fan-ziqi/robot_lab at 09f7fb4"
ROBOT_LAB_FILE = (
    "source/robot_lab/robot_lab/tasks/manager_based/locomotion/velocity/mdp/events.py, randomize_rigid_body_inertia"
)
ISAAC_LAB = "isaac-sim/IsaacLab at 025ffcd"
ISAAC_LAB_INERTIA = "source/isaaclab/isaaclab/envs/mdp/events.py, randomize_rigid_body_inertia"
ISAAC_LAB_MASS = "source/isaaclab/isaaclab/envs/mdp/events.py, randomize_rigid_body_mass"
ISAAC_LAB_CENTRE = "source/isaaclab/isaaclab/envs/mdp/events.py, randomize_rigid_body_com"
ROBOSUITE = "robosuite 1.5.2"
ROBOSUITE_FILE = "robosuite/utils/mjmod.py, DynamicsModder"
HOLOSOMA = "amazon-far/holosoma at 76a52b5"
HOLOSOMA_FILE = "src/holosoma/holosoma/config_values/wbt/g1/randomization.py, for objects"
CRAZYFLOW = "utiasDSL/crazyflow at 9bf4f2c"
CRAZYFLIE = np.diag([16.8e-6, 16.8e-6, 29.8e-6])
"""Of drone-models 0.1.0, from which crazyflow takes it, in kg·m²."""
PLAYGROUND = "playground 0.2.0"
PLAYGROUND_FILE = "mujoco_playground/_src/locomotion/g1/randomize.py"

RULES = (
    Rule("I₁₁, I₂₂, I₃₃ × U(0.5, 1.5) each", ROBOT_LAB, ROBOT_LAB_FILE, entrywise_diagonal(0.5, 1.5)),
    Rule("I₁₁, I₂₂, I₃₃ × U(0.8, 1.2) each", ROBOT_LAB, ROBOT_LAB_FILE, entrywise_diagonal(0.8, 1.2)),
    Rule("I₁₁, I₂₂, I₃₃ × U(0.9, 1.1) each", ROBOT_LAB, ROBOT_LAB_FILE, entrywise_diagonal(0.9, 1.1)),
    Rule("each of the nine entries × U(0.9, 1.2)", "a copy of robot_lab", ROBOT_LAB_FILE, entrywise_all(0.9, 1.2)),
    Rule("I₁₁ × U(0.5, 1.5)", HOLOSOMA, HOLOSOMA_FILE, first_entry(0.5, 1.5)),
    Rule("each principal moment × U(0.98, 1.02)", ROBOSUITE, ROBOSUITE_FILE, principal_moments(0.02)),
    Rule("each principal moment × U(0.9, 1.1)", ROBOSUITE, ROBOSUITE_FILE, principal_moments(0.1)),
    Rule("each principal moment × U(0.7, 1.3)", ROBOSUITE, ROBOSUITE_FILE, principal_moments(0.3)),
    Rule("diagonal × U(0.5, 1.5), products kept", ISAAC_LAB, ISAAC_LAB_INERTIA, common_diagonal(0.5, 1.5)),
    Rule("diagonal × U(0.8, 1.2), products kept", ISAAC_LAB, ISAAC_LAB_INERTIA, common_diagonal(0.8, 1.2)),
    Rule("all nine entries + U(0, 10 % of the mean moment)", ISAAC_LAB, ISAAC_LAB_INERTIA, added_all(0.1)),
    Rule("all nine entries + U(0, 50 % of the mean moment)", ISAAC_LAB, ISAAC_LAB_INERTIA, added_all(0.5)),
    Rule("all nine entries = U(0.01, 0.1) kg·m²", ISAAC_LAB, ISAAC_LAB_INERTIA, replaced_all(0.01, 0.1)),
    Rule(
        "nine entries + N(0, 10⁻⁵ kg·m²), Crazyflie",
        CRAZYFLOW,
        "tests/unit/test_randomize.py",
        gaussian_all(1e-5),
        CRAZYFLIE,
    ),
    Rule(
        "nine entries + N(0, 10⁻⁶ kg·m²), Crazyflie", CRAZYFLOW, "examples/randomize.py", gaussian_all(1e-6), CRAZYFLIE
    ),
    Rule("diagonal + U(0, 50 % of the mean moment)", ISAAC_LAB, ISAAC_LAB_INERTIA, added_diagonal(0.5)),
    Rule("all nine entries × U(0.5, 1.5), one factor", ISAAC_LAB, ISAAC_LAB_INERTIA, common_all(0.5, 1.5)),
    Rule("mass, and the inertia by the same factor", ISAAC_LAB, ISAAC_LAB_MASS, common_all(0.5, 1.5)),
    Rule("mass alone", PLAYGROUND, PLAYGROUND_FILE, unchanged),
    Rule("mass centre alone", ISAAC_LAB, ISAAC_LAB_CENTRE, unchanged),
)
