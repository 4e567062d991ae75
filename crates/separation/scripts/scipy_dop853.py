"""The paper's separation by scipy's DOP853 with events, beside this crate: do they agree, and what do
they take?

    python scripts/scipy_dop853.py

needs numpy, scipy and cargo. Exits with 1 if anything differs by 1e-8 of itself or more.
"""

import json
import pathlib
import subprocess
import sys
import time

import numpy as np
from scipy.integrate import solve_ivp

MASSES = 1e4, 4e3
INERTIAS = (
    np.array([[5e3, 20, 2], [20, 4e3, -50], [2, -50, 3e3]]),
    np.array([[6.7e3, 0, 20], [0, 6.7e3, -20], [20, -20, 2e3]]),
)
STIFFNESSES = [1e5, 1e5, 3e4, 3e4]
STROKE = 0.1
POINTS = [(1, 1), (-1, 1), (1, -1), (-1, -1)]
PAYLOAD_POINTS = [np.array([x, y, -0.9]) for x, y in POINTS]
STAGE_POINTS = [np.array([x, y, 0.9]) for x, y in POINTS]
FREE_LENGTH = 0.2 + STROKE
INVERSES = [np.linalg.inv(i) for i in INERTIAS]


def rotation(q):
    x, y, z, w = q / np.sqrt(q @ q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def cross(a, b):
    return np.array(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )


def derivative(_, y, active):
    """Of relative position and velocity, then attitude and rate of payload and stage."""
    rp, rl = rotation(y[6:10]), rotation(y[13:17])
    force, tp, tl = np.zeros(3), np.zeros(3), np.zeros(3)
    for i in active:
        p, l = rp @ PAYLOAD_POINTS[i], rl @ STAGE_POINTS[i]
        line = y[:3] + p - l
        length = np.sqrt(line @ line)
        push = STIFFNESSES[i] * (FREE_LENGTH / length - 1) * line
        force += push
        tp += cross(p, push)
        tl -= cross(l, push)
    dy = np.empty(20)
    dy[:3] = y[3:6]
    dy[3:6] = force * (1 / MASSES[0] + 1 / MASSES[1])
    for at, torque, inertia, inverse in (
        (6, rp.T @ tp, INERTIAS[0], INVERSES[0]),
        (13, rl.T @ tl, INERTIAS[1], INVERSES[1]),
    ):
        v, s, w = y[at : at + 3], y[at + 3], y[at + 4 : at + 7]
        dy[at : at + 3] = 0.5 * (s * w + cross(v, w))
        dy[at + 3] = -0.5 * (v @ w)
        dy[at + 4 : at + 7] = inverse @ (torque - cross(w, inertia @ w))
    return dy


def separate():
    y = np.zeros(20)
    y[2], y[9], y[16] = 2, 1, 1
    active, now, times = [0, 1, 2, 3], 0.0, [0.0] * 4

    def event(i):
        def gap(_, y, active):
            line = y[:3] + rotation(y[6:10]) @ PAYLOAD_POINTS[i]
            return np.linalg.norm(line - rotation(y[13:17]) @ STAGE_POINTS[i]) - FREE_LENGTH

        gap.terminal, gap.direction = True, 1
        return gap

    while active:
        done = solve_ivp(
            derivative,
            (now, 60),
            y,
            "DOP853",
            events=[event(i) for i in active],
            args=(tuple(active),),
            rtol=1e-13,
            atol=1e-14,
        )
        which = next(n for n, t in enumerate(done.t_events) if len(t))
        now, y = done.t_events[which][0], done.y_events[which][0]
        times[active.pop(which)] = now
    rp = y[6:10] / np.linalg.norm(y[6:10])
    return {
        "release_times_s": times,
        "relative_velocity": y[3:6],
        "payload_rate": y[10:13],
        "stage_rate": y[17:20],
        "payload_attitude": rp,
        "stage_attitude": y[13:17] / np.linalg.norm(y[13:17]),
    }


def main():
    crate = pathlib.Path(__file__).resolve().parent.parent
    command = ["cargo", "run", "-q", "--release", "--example", "outcome"]
    ours = json.loads(subprocess.run(command, cwd=crate, check=True, capture_output=True).stdout)
    seconds = []
    for _ in range(5):
        start = time.perf_counter()
        theirs = separate()
        seconds.append(time.perf_counter() - start)
    worst = 0.0
    for name, value in theirs.items():
        a, b = np.array(ours[name]), np.array(value)
        difference = np.max(np.abs(a - b)) / np.max(np.abs(b))
        worst = max(worst, difference)
        print(f"{name:20} differs by {difference:.1e} of itself")
    print(f"scipy {min(seconds) * 1e3:.1f} ms, gyradius {ours['seconds'] * 1e6:.1f} us a run")
    return int(not worst < 1e-8)


if __name__ == "__main__":
    sys.exit(main())
