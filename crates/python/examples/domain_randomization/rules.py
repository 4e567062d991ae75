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
class Source:
    """Where a rule was read."""

    name: str
    """Of the repository on GitHub, or of the package."""
    version: str
    """A commit of the repository, or a version of the package."""
    path: str
    """The file."""
    function: str
    """What in the file is the rule."""

    def __str__(self) -> str:
        """As a link of Markdown."""
        if "/" in self.name:
            url = f"https://github.com/{self.name}/blob/{self.version}/{self.path}"
        else:
            url = f"https://pypi.org/project/{self.name}/{self.version}/"
        return f"[{self.name.split('/')[-1]} {self.version}]({url})"


@dataclass(frozen=True)
class Rule:
    """A rule with where it was read."""

    what: str
    """What the rule does, with its range, as the table says it."""
    source: Source
    draw: Draw
    body: np.ndarray | None = None
    """The inertia that the code uses it on, if its numbers are for one body."""


ROBOT_LAB = Source(
    "fan-ziqi/robot_lab",
    "09f7fb4",
    "source/robot_lab/robot_lab/tasks/manager_based/locomotion/velocity/mdp/events.py",
    "randomize_rigid_body_inertia",
)
EVENTS = ("isaac-sim/IsaacLab", "025ffcd", "source/isaaclab/isaaclab/envs/mdp/events.py")
ISAAC_LAB = Source(*EVENTS, "randomize_rigid_body_inertia")
ISAAC_LAB_MASS = Source(*EVENTS, "randomize_rigid_body_mass")
ISAAC_LAB_CENTRE = Source(*EVENTS, "randomize_rigid_body_com")
ROBOSUITE = Source("robosuite", "1.5.2", "robosuite/utils/mjmod.py", "DynamicsModder")
HOLOSOMA = Source(
    "amazon-far/holosoma",
    "76a52b5",
    "src/holosoma/holosoma/config_values/wbt/g1/randomization.py",
    "randomize_object_rigid_body_inertia_startup",
)
CRAZYFLOW_TEST = Source("utiasDSL/crazyflow", "9bf4f2c", "tests/unit/test_randomize.py", "test_randomize_inertia")
CRAZYFLOW = Source("utiasDSL/crazyflow", "9bf4f2c", "examples/randomize.py", "main")
PLAYGROUND = Source("playground", "0.2.0", "mujoco_playground/_src/locomotion/g1/randomize.py", "domain_randomize")
CRAZYFLIE = np.diag([16.8e-6, 16.8e-6, 29.8e-6])
"""Of drone-models 0.1.0, from which crazyflow takes it, in kg·m²."""

RULES = (
    Rule("I₁₁, I₂₂, I₃₃ × U(0.5, 1.5) each", ROBOT_LAB, entrywise_diagonal(0.5, 1.5)),
    Rule("I₁₁, I₂₂, I₃₃ × U(0.8, 1.2) each", ROBOT_LAB, entrywise_diagonal(0.8, 1.2)),
    Rule("I₁₁, I₂₂, I₃₃ × U(0.9, 1.1) each", ROBOT_LAB, entrywise_diagonal(0.9, 1.1)),
    Rule("each of the nine entries × U(0.9, 1.2), in a copy of it", ROBOT_LAB, entrywise_all(0.9, 1.2)),
    Rule("I₁₁ × U(0.5, 1.5)", HOLOSOMA, first_entry(0.5, 1.5)),
    Rule("each principal moment × U(0.98, 1.02)", ROBOSUITE, principal_moments(0.02)),
    Rule("each principal moment × U(0.9, 1.1)", ROBOSUITE, principal_moments(0.1)),
    Rule("each principal moment × U(0.7, 1.3)", ROBOSUITE, principal_moments(0.3)),
    Rule("diagonal × U(0.5, 1.5), products kept", ISAAC_LAB, common_diagonal(0.5, 1.5)),
    Rule("diagonal × U(0.8, 1.2), products kept", ISAAC_LAB, common_diagonal(0.8, 1.2)),
    Rule("all nine entries + U(0, 10 % of the mean moment)", ISAAC_LAB, added_all(0.1)),
    Rule("all nine entries + U(0, 50 % of the mean moment)", ISAAC_LAB, added_all(0.5)),
    Rule("all nine entries = U(0.01, 0.1) kg·m²", ISAAC_LAB, replaced_all(0.01, 0.1)),
    Rule(
        "nine entries + N(0, 10⁻⁵ kg·m²), Crazyflie",
        CRAZYFLOW_TEST,
        gaussian_all(1e-5),
        CRAZYFLIE,
    ),
    Rule("nine entries + N(0, 10⁻⁶ kg·m²), Crazyflie", CRAZYFLOW, gaussian_all(1e-6), CRAZYFLIE),
    Rule("diagonal + U(0, 50 % of the mean moment)", ISAAC_LAB, added_diagonal(0.5)),
    Rule("all nine entries × U(0.5, 1.5), one factor", ISAAC_LAB, common_all(0.5, 1.5)),
    Rule("mass, and the inertia by the same factor", ISAAC_LAB_MASS, common_all(0.5, 1.5)),
    Rule("mass alone", PLAYGROUND, unchanged),
    Rule("mass centre alone", ISAAC_LAB_CENTRE, unchanged),
)
