"""Separations of which everything is dispersed, by a program that shares nothing with this one.

    python dispersed.py > dispersed.json

needs Python 3.11, numpy and scipy. Reads dispersed.toml, draws values of its own, sets the bodies up as
docs/models/dispersions.md says, and integrates both of them whole, in inertial axes (DOP853,
rtol 1e-12; releases by Newton's iteration on integrations that end there).
"""

import json
import pathlib
import tomllib

import numpy as np
from scipy.integrate import solve_ivp

HERE = pathlib.Path(__file__).parent
BODIES = "payload", "stage"


def multiply(a, b):
    (ax, ay, az, aw), (bx, by, bz, bw) = a, b
    return np.array(
        [
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz,
        ]
    )


def matrix(q):
    x, y, z, w = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def turn(vector):
    """The quaternion of a rotation vector."""
    half = np.linalg.norm(vector) / 2
    return np.array([*(np.sinc(half / np.pi) / 2 * np.asarray(vector)), np.cos(half)])


class Drawn(dict):
    """What is drawn, by the names of the run table; in its order."""

    def vector(self, name, unit, otherwise):
        return np.array([self.get(f"{name}_{i + 1}_{unit}", x) for i, x in enumerate(otherwise)])


def draw(scenario, rng):
    drawn = Drawn()

    def vector(name, unit, nominal, sigma):
        for i, x in enumerate(nominal):
            drawn[f"{name}_{i + 1}_{unit}"] = x + sigma * rng.normal()

    for name in BODIES:
        body = scenario[name]
        d = body["dispersion"]
        sigma = d.get("mass_kg", 0.01 * d.get("mass_percent", 0) * body["mass_kg"])
        drawn[f"{name}_mass_kg"] = body["mass_kg"] + sigma * rng.normal()
        for key, quantity, unit, nominal in [
            ("mass_centre_m", "mass_centre", "m", [0] * 3),
            ("position_m", "position", "m", body["position_m"]),
            ("velocity_m_per_s", "velocity", "m_per_s", body["velocity_m_per_s"]),
            ("attitude_deg", "attitude", "deg", [0] * 3),
            (
                "angular_velocity_rad_per_s",
                "angular_velocity",
                "rad_per_s",
                body["angular_velocity_rad_per_s"],
            ),
        ]:
            if key in d:
                vector(f"{name}_{quantity}", unit, nominal, d[key])
    stack = scenario["stack"]["dispersion"]
    vector("stack_attitude", "deg", [0] * 3, stack["attitude_deg"])
    rate = stack["angular_velocity_rad_per_s"]
    vector("stack_angular_velocity", "rad_per_s", [0] * 3, rate)
    for number, spring in enumerate(scenario["springs"], 1):
        d, name = spring["dispersion"], f"spring_{number}"
        for quantity, unit in [("stiffness", "n_per_m"), ("stroke", "m")]:
            key, nominal = f"{quantity}_{unit}", spring[f"{quantity}_{unit}"]
            percent = 0.01 * d.get(f"{quantity}_percent", 0) * nominal
            if sigma := d.get(key, percent):
                drawn[f"{name}_{key}"] = nominal + sigma * rng.normal()
        if "friction_n" in d:
            drawn[f"{name}_friction_n"] = rng.uniform(0, d["friction_n"]["high"])
        for key, size in [("line_of_action_deg", 2), ("payload_point_m", 3), ("stage_point_m", 3)]:
            if key in d:
                quantity, unit = key.rsplit("_", 1)
                nominal = spring.get(key, [0] * size)
                vector(f"{name}_{quantity}", unit, nominal, d[key])
        late = rng.random() < d.get("late_probability", 1)
        if "start_s" in d:
            low, high = d["start_s"]["low"], d["start_s"]["high"]
            drawn[f"{name}_start_s"] = rng.uniform(low, high) if late else spring.get("start_s", 0.0)
        if "late_probability" in d:
            drawn[f"{name}_late"] = float(late)
        if "failure_probability" in d:
            drawn[f"{name}_failure"] = float(rng.random() < d["failure_probability"])
    return drawn


class Run:
    """Position, velocity, attitude and rate of the payload, then of the stage: 26 numbers."""

    def __init__(self, scenario, drawn, inertias):
        self.inertias = inertias
        self.masses = [drawn[f"{name}_mass_kg"] for name in BODIES]
        states, centres, nominal = [], [], []
        for name in BODIES:
            body = scenario[name]
            centre = drawn.vector(f"{name}_mass_centre", "m", [0] * 3)
            x = drawn.vector(f"{name}_position", "m", body["position_m"])
            v = drawn.vector(f"{name}_velocity", "m_per_s", body["velocity_m_per_s"])
            w = body["angular_velocity_rad_per_s"]
            w = drawn.vector(f"{name}_angular_velocity", "rad_per_s", w)
            q0 = np.array(body["body_to_inertial"])
            q0 /= np.linalg.norm(q0)
            q = multiply(q0, turn(np.radians(drawn.vector(f"{name}_attitude", "deg", [0] * 3))))
            states.append([x + matrix(q) @ centre, v + matrix(q) @ np.cross(w, centre), q, w])
            nominal.append((np.array(body["position_m"]), matrix(q0)))
            centres.append(centre)
        springs = enumerate(scenario["springs"], 1)
        self.springs = [self.spring(drawn, s, n, states, centres, nominal) for n, s in springs]
        self.start = self.stack(drawn, states)
        for spring in self.springs:
            length = np.linalg.norm(self.line(self.start, spring))
            spring["free"] = length + spring["stroke"]
            spring["end"] = spring["free"] - spring["friction"] / spring["stiffness"]

    @staticmethod
    def spring(drawn, spring, number, states, centres, nominal):
        name = f"spring_{number}"
        p = drawn.vector(f"{name}_payload_point", "m", spring["payload_point_m"]) - centres[0]
        l = drawn.vector(f"{name}_stage_point", "m", spring["stage_point_m"]) - centres[1]
        tilt = np.radians(drawn.vector(f"{name}_line_of_action", "deg", [0] * 2))
        (xp, _, qp, _), (xl, _, ql, _) = states
        rp, rl = matrix(qp), matrix(ql)
        line = rl.T @ (xp - xl + rp @ p - rl @ l)
        # About which axes: by the line before any dispersion.
        (x0p, r0p), (x0l, r0l) = nominal
        points = np.array(spring["payload_point_m"]), np.array(spring["stage_point_m"])
        before = r0l.T @ (x0p - x0l + r0p @ points[0] - r0l @ points[1])
        axis, along = np.eye(3)[(np.argmax(abs(before)) + 1) % 3], line / np.linalg.norm(line)
        first = axis - along * (along @ axis)
        first /= np.linalg.norm(first)
        tilted = matrix(turn(first * tilt[0] + np.cross(along, first) * tilt[1])) @ line
        value = lambda key: drawn.get(f"{name}_{key}", spring.get(key, 0.0))
        return {
            "payload": p + rp.T @ rl @ (tilted - line),
            "stage": l,
            "stiffness": value("stiffness_n_per_m"),
            "stroke": value("stroke_m"),
            "friction": value("friction_n"),
            "start": np.inf if value("failure") else value("start_s"),
        }

    def stack(self, drawn, states):
        share = np.array(self.masses) / sum(self.masses)
        centre = share[0] * states[0][0] + share[1] * states[1][0]
        velocity = share[0] * states[0][1] + share[1] * states[1][1]
        axes = matrix(states[1][2])
        q = turn(axes @ np.radians(drawn.vector("stack_attitude", "deg", [0] * 3)))
        spin = matrix(q) @ axes @ drawn.vector("stack_angular_velocity", "rad_per_s", [0] * 3)
        y = []
        for x, v, attitude, w in states:
            arm, attitude = matrix(q) @ (x - centre), multiply(q, attitude)
            y += [*(centre + arm), *(velocity + matrix(q) @ (v - velocity) + np.cross(spin, arm))]
            y += [*attitude, *(w + matrix(attitude).T @ spin)]
        return np.array(y)

    @staticmethod
    def line(y, spring):
        ends = matrix(y[6:10]) @ spring["payload"], matrix(y[19:23]) @ spring["stage"]
        return y[:3] - y[13:16] + ends[0] - ends[1]

    def gap(self, y, spring):
        return np.linalg.norm(self.line(y, spring)) - spring["end"]

    def derivative(self, _, y, pushing):
        rotations, force = (matrix(y[6:10]), matrix(y[19:23])), np.zeros(3)
        torques = [np.zeros(3), np.zeros(3)]
        for spring in pushing:
            line = self.line(y, spring)
            length = np.linalg.norm(line)
            push = spring["stiffness"] * (spring["free"] - length) - spring["friction"]
            push = push * line / length
            force += push
            torques[0] += np.cross(spring["payload"], rotations[0].T @ push)
            torques[1] -= np.cross(spring["stage"], rotations[1].T @ push)
        out = []
        for i, sign in (0, 1), (1, -1):
            _, v, q, w = np.split(y[13 * i : 13 * i + 13], [3, 6, 10])
            inertia = self.inertias[i]
            turning = np.linalg.solve(inertia, torques[i] - np.cross(w, inertia @ w))
            out += [*v, *(sign * force / self.masses[i])]
            out += [*(0.5 * multiply(q, [*w, 0.0])), *turning]
        return np.array(out)

    def follow(self, y, start, end, pushing, events=None):
        return solve_ivp(
            self.derivative, (start, end), y, "DOP853",
            args=(pushing,), events=events, rtol=1e-12, atol=1e-15,
        )  # fmt: skip

    def separate(self):
        able = [s for s in self.springs if np.isfinite(s["start"]) and s["end"] > s["free"] - s["stroke"]]
        left, now, y = list(able), 0.0, self.start
        while left:
            pushing = [s for s in left if s["start"] <= now]
            until = min([s["start"] for s in left if s["start"] > now], default=60.0)
            events = [lambda _, y, __, s=s: self.gap(y, s) for s in left]
            for event in events:
                event.terminal, event.direction = True, 1
            done = self.follow(y, now, until, pushing, events)
            if done.status == 0:
                assert until < 60
                now, y = until, done.y[:, -1]
                continue
            spring = next(s for s, t in zip(left, done.t_events) if len(t))
            before, time = done.t[-2], done.t[-1]
            for _ in range(5):
                y = self.follow(done.y[:, -2], before, time, pushing).y[:, -1]
                ahead = self.follow(y, time, time + 1e-7, pushing).y[:, -1]
                behind = self.gap(y, spring)
                time -= behind / ((self.gap(ahead, spring) - behind) / 1e-7)
            y, now = self.follow(done.y[:, -2], before, time, pushing).y[:, -1], time
            spring["released"] = now
            left = [s for s in left if s is not spring]
        return y


def main():
    scenario = tomllib.loads((HERE / "dispersed.toml").read_text())
    rng, runs = np.random.default_rng(28), []
    for _ in range(6):
        drawn, inertias = draw(scenario, rng), []
        for name in BODIES:
            noise = 0.01 * rng.normal(size=(3, 3))
            change = np.eye(3) + noise
            inertias.append(change @ np.array(scenario[name]["inertia_kg_m2"]) @ change.T)
        entries = [[m[0, 0], m[1, 1], m[2, 2], m[0, 1], m[0, 2], m[1, 2]] for m in inertias]
        inertias = [np.array([[a, d, e], [d, b, f], [e, f, c]]) for a, b, c, d, e, f in entries]
        run = Run(scenario, drawn, inertias)
        y = run.separate()
        runs.append(
            {
                "drawn": list(drawn.values()),
                "payload_inertia": entries[0],
                "stage_inertia": entries[1],
                "start": list(run.start),
                "release_times_s": [s.get("released", 0.0) for s in run.springs],
                "end": [*y[:6], *y[6:10] / np.linalg.norm(y[6:10]), *y[10:19]]
                + [*y[19:23] / np.linalg.norm(y[19:23]), *y[23:]],
            }
        )
    print(json.dumps({"about": __doc__.split("\n")[0], "columns": list(drawn), "runs": runs}, indent=1))


main()
