"""What tests have in common: bodies and matrices of every kind."""

from __future__ import annotations

import signal

import numpy as np
import pytest
from hypothesis import settings
from numpy.typing import NDArray

import gyradius

# The same cases on every run, and no limit of time: machines are shared.
settings.register_profile("gyradius", deadline=None, derandomize=True, max_examples=60)
settings.load_profile("gyradius")

# What runs in the background inherits from some shells that it ignores interrupts, and so would the programs that are interrupted here.
signal.signal(signal.SIGINT, signal.default_int_handler)


def rotations(rng: np.random.Generator, count: int) -> NDArray[np.float64]:
    """Rotation matrices, all equally likely."""
    q, r = np.linalg.qr(rng.normal(size=(count, 3, 3)))
    q = q * np.sign(np.einsum("nii->ni", r))[:, None, :]
    q[np.linalg.det(q) < 0] *= -1
    return q


def second_moments(rng: np.random.Generator, count: int) -> NDArray[np.float64]:
    """Second moments about principal axes: solid bodies, plates, rods and points of any size."""
    k = rng.uniform(0.0, 1.0, size=(count, 3)) ** 3
    kind = rng.integers(0, 8, size=count)
    k[kind == 0, 0] = 0.0
    k[kind == 1, :2] = 0.0
    return k * 10.0 ** rng.uniform(-6, 6, size=(count, 1))


def inertias(rng: np.random.Generator, count: int) -> NDArray[np.float64]:
    """Inertias of bodies about turned axes."""
    k = second_moments(rng, count)
    moments = k.sum(axis=1, keepdims=True) - k
    a = rotations(rng, count)
    made = np.einsum("nij,nj,nkj->nik", a, moments, a)
    return 0.5 * (made + made.transpose(0, 2, 1))


def bodies(rng: np.random.Generator, count: int) -> gyradius.MassProperties:
    """Bodies with a volume."""
    k = rng.uniform(0.05, 1.0, size=(count, 3))
    a = rotations(rng, count)
    made = np.einsum("nij,nj,nkj->nik", a, k.sum(axis=1, keepdims=True) - k, a)
    return gyradius.MassProperties(
        10.0 ** rng.uniform(-3, 3, size=count), rng.uniform(-2, 2, size=(count, 3)), made
    )


@pytest.fixture
def link() -> gyradius.MassProperties:
    """A link of a robot, with products of inertia."""
    return gyradius.MassProperties(
        2.4, [0.15, 0.01, -0.02], [[0.004, 0.0003, -0.0002], [0.0003, 0.021, 0.0001], [-0.0002, 0.0001, 0.022]]
    )


URDF = """<robot name="arm">
  <link name="forearm"><inertial><origin xyz="0.15 0.01 -0.02"/><mass value="2.4"/>
    <inertia ixx="0.004" ixy="0.0003" ixz="-0.0002" iyy="0.021" iyz="0.0001" izz="0.022"/></inertial></link>
  <link name="hand"><inertial><mass value="0.6"/>
    <inertia ixx="0.002" ixy="0" ixz="0" iyy="0.0015" iyz="0" izz="0.001"/></inertial></link>
  <link name="frame"/>
</robot>
"""
