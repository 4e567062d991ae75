"""A free satellite after its spin-up motor: how fast it spins and how far it nutates. No packages are needed."""
import json
import math
import sys

STEPS = 200


def spin_up(inputs):
    """Integrates Euler's equations in body axes under the torque of the motor by the classical Runge-Kutta method."""
    i = {key: inputs["hub_i" + key] for key in ("11", "22", "33", "12", "13", "23")}
    inertia = [[i["11"], i["12"], i["13"]], [i["12"], i["22"], i["23"]], [i["13"], i["23"], i["33"]]]
    torque = [0.0, 0.0, inputs["torque_n_m"]]

    def dot(a, b):
        # Not sum(): since Python 3.12 it rounds otherwise.
        return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]

    def cross(a, b):
        return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]

    def momentum(w):
        return [dot(row, w) for row in inertia]

    rows = [cross(inertia[1], inertia[2]), cross(inertia[2], inertia[0]), cross(inertia[0], inertia[1])]
    determinant = dot(inertia[0], rows[0])

    def rate(w):
        load = [t - c for t, c in zip(torque, cross(w, momentum(w)))]
        return [dot([row[j] for row in rows], load) / determinant for j in range(3)]

    w, step = [0.0, 0.0, 0.0], inputs["burn_s"] / STEPS
    for _ in range(STEPS):
        a = rate(w)
        b = rate([x + step / 2 * d for x, d in zip(w, a)])
        c = rate([x + step / 2 * d for x, d in zip(w, b)])
        d = rate([x + step * e for x, e in zip(w, c)])
        w = [x + step / 6 * (p + 2 * q + 2 * r + s) for x, p, q, r, s in zip(w, a, b, c, d)]
    h = momentum(w)
    return {
        "spin_rad_per_s": math.sqrt(dot(w, w)),
        "nutation_deg": math.degrees(math.acos(h[2] / math.sqrt(dot(h, h)))),
        "mass_again_kg": inputs["hub_mass_kg"],
    }


for line in sys.stdin:
    asked = json.loads(line)
    try:
        answer = {"outputs": spin_up(asked["inputs"])}
    except (ArithmeticError, ValueError) as error:
        answer = {"error": str(error)}
    print(json.dumps({"run": asked["run"], **answer}), flush=True)
