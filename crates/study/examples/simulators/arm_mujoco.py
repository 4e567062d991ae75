"""An arm that swings an uncertain tool to a target, simulated by MuJoCo (`pip install mujoco`, https://mujoco.org)."""
import json
import math
import sys

import mujoco
import numpy as np

MODEL = mujoco.MjModel.from_xml_string("""
<mujoco>
  <option timestep="0.002"/>
  <worldbody>
    <body name="arm">
      <inertial pos="0.3 0 0" mass="4" diaginertia="0.01 0.13 0.13"/>
      <joint name="shoulder" axis="0 -1 0" damping="0.5"/>
      <body name="tool" pos="0.6 0 0">
        <!-- Off the frame of the body: versions before 4.0 take a mass centre that coincides with it for fixed. -->
        <inertial pos="0.1 0 0" quat="0.9 0.1 0.1 0.1" mass="1" diaginertia="0.01 0.01 0.01"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position joint="shoulder" kp="400" kv="40" forcerange="-90 90"/>
  </actuator>
</mujoco>
""")
TARGET = math.radians(60.0)


def swing(inputs):
    tool = MODEL.body("tool").id
    i = {key: inputs["tool_i" + key] for key in ("11", "22", "33", "12", "13", "23")}
    inertia = np.array([[i["11"], i["12"], i["13"]], [i["12"], i["22"], i["23"]], [i["13"], i["23"], i["33"]]])
    moments, axes = np.linalg.eigh(inertia)
    axes[:, 0] *= np.linalg.det(axes)
    MODEL.body_mass[tool] = inputs["tool_mass_kg"]
    MODEL.body_ipos[tool] = [inputs[f"tool_mass_centre_{k}_m"] for k in (1, 2, 3)]
    MODEL.body_inertia[tool] = moments
    mujoco.mju_mat2Quat(MODEL.body_iquat[tool], axes.flatten())
    data = mujoco.MjData(MODEL)
    mujoco.mj_setConst(MODEL, data)
    mujoco.mj_resetData(MODEL, data)
    angles, torques = [], []
    for _ in range(1500):
        data.ctrl[0] = TARGET * min(1.0, data.time)
        mujoco.mj_step(MODEL, data)
        angles.append(data.qpos[0])
        torques.append(abs(data.actuator_force[0]))
    return {
        "overshoot_deg": math.degrees(max(angles) - TARGET),
        "error_at_end_deg": math.degrees(angles[-1] - TARGET),
        "greatest_torque_n_m": max(torques),
    }


for line in sys.stdin:
    asked = json.loads(line)
    try:
        answer = {"outputs": swing(asked["inputs"])}
    except Exception as error:
        answer = {"error": str(error)}
    print(json.dumps({"run": asked["run"], **answer}), flush=True)
