"""The satellite of spin_up.py, simulated by Basilisk (`pip install bsk`, https://avslab.github.io/basilisk)."""
import json
import math
import sys

import numpy as np
from Basilisk.simulation import extForceTorque, spacecraft
from Basilisk.utilities import SimulationBaseClass, macros

STEPS = 200


def spin_up(inputs):
    i = {key: inputs["hub_i" + key] for key in ("11", "22", "33", "12", "13", "23")}
    inertia = [[i["11"], i["12"], i["13"]], [i["12"], i["22"], i["23"]], [i["13"], i["23"], i["33"]]]
    simulation = SimulationBaseClass.SimBaseClass()
    step = macros.sec2nano(inputs["burn_s"] / STEPS)
    simulation.CreateNewProcess("process").addTask(simulation.CreateNewTask("task", step))
    satellite = spacecraft.Spacecraft()
    satellite.hub.mHub = inputs["hub_mass_kg"]
    satellite.hub.IHubPntBc_B = inertia
    motor = extForceTorque.ExtForceTorque()
    motor.extTorquePntB_B = [[0.0], [0.0], [inputs["torque_n_m"]]]
    satellite.addDynamicEffector(motor)
    simulation.AddModelToTask("task", satellite)
    simulation.AddModelToTask("task", motor)
    simulation.InitializeSimulation()
    simulation.ConfigureStopTime(step * STEPS)
    simulation.ExecuteSimulation()
    spin = np.array(satellite.scStateOutMsg.read().omega_BN_B)
    momentum = np.array(inertia) @ spin
    return {
        "spin_rad_per_s": float(np.linalg.norm(spin)),
        "nutation_deg": math.degrees(math.acos(momentum[2] / np.linalg.norm(momentum))),
        "mass_again_kg": inputs["hub_mass_kg"],
    }


for line in sys.stdin:
    asked = json.loads(line)
    try:
        answer = {"outputs": spin_up(asked["inputs"])}
    except Exception as error:
        answer = {"error": str(error)}
    print(json.dumps({"run": asked["run"], **answer}), flush=True)
