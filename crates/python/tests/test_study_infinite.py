"""Infinite outputs of functions in Python: whatever else is wrong with the answer, they count against requirements."""

from __future__ import annotations

import json
import math
import sys
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gyradius

REQUIREMENT = {
    "name": "low",
    "quantity": "y",
    "at_most": 60.0,
    "probability": 0.9,
    "confidence": 0.9,
    "failed_runs": "left-out",
}
QUANTITY = {"name": "x", "unit": "m", "law": {"law": "normal", "mean": 1.0, "sigma": 0.25}}
SCENARIO = {"name": "made", "runs": 500, "quantities": [QUANTITY], "requirements": [REQUIREMENT]}


@pytest.mark.parametrize(
    ("number", "infinite"),
    [
        (math.inf, math.inf),
        (-math.inf, -math.inf),
        (np.float32(np.inf), math.inf),
        (10**400, math.inf),
        (-(10**400), -math.inf),
        (Fraction(10**400), math.inf),
        (Decimal("-1e400"), -math.inf),
    ],
)
@pytest.mark.parametrize("beside", [{}, {"z": None}, {"z": "a text"}, {"z": math.nan}, {"w": 1.0}, {2: 1.0}, {"z": 1j}])
def test_what_is_infinite_is_not_left_out(number: Any, infinite: float, beside: dict[Any, Any]) -> None:
    def simulate(inputs: dict[str, float], run: int) -> dict[Any, Any]:
        whole = {"y": inputs["x"], "z": 1.0}
        # In any order.
        return ({"y": number} | beside if run % 10 else beside | {"y": number}) if run % 5 == 0 else whole

    study = gyradius.study(SCENARIO, simulate, outputs={"y": "m", "z": "1"})
    table = study.to_numpy()["all"]
    assert table["y"][::5].tolist() == [infinite] * 100
    assert study.failed == {"all": 100}
    assert study.verdicts[0].verdict == "not met"


def test_a_command_and_a_function_are_judged_alike(tmp_path: Path) -> None:
    script = """import json, sys
for line in sys.stdin:
    asked = json.loads(line)
    y = float("inf") if asked["run"] % 5 == 0 else asked["inputs"]["x"]
    print(json.dumps({"outputs": {"y": y, "z": None if asked["run"] % 5 == 0 else 1.0}}), flush=True)
"""
    (tmp_path / "simulate.py").write_text(script)
    outputs = [{"name": "y", "unit": "m"}, {"name": "z"}]
    simulation = {"command": [sys.executable, str(tmp_path / "simulate.py")], "outputs": outputs}
    command = gyradius.study({**SCENARIO, "simulation": simulation})

    def simulate(inputs: dict[str, float], run: int) -> dict[str, Any]:
        return {"y": math.inf, "z": None} if run % 5 == 0 else {"y": inputs["x"], "z": 1.0}

    function = gyradius.study(SCENARIO, simulate, outputs={"y": "m", "z": "1"})
    assert json.dumps(command.to_numpy()["all"]["y"].tolist()) == json.dumps(function.to_numpy()["all"]["y"].tolist())
    assert command.verdicts[0].verdict == function.verdicts[0].verdict == "not met"
