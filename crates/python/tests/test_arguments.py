"""Arguments of every kind: those that are wrong are named with what is allowed, and those that work have a type."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest


LIMITED = """
import resource, sys, gyradius
# What reads without end gets no memory, and does not take that of others.
resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))
for more in ({}, {"outputs": {"y": "m"}}):
    for simulation in (None, lambda inputs: {"y": 1.0}):
        try:
            gyradius.study(sys.argv[1], simulation, **more)
        except OSError as error:
            print(error)
"""


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="files that are not regular")
@pytest.mark.parametrize("kind", ["device", "pipe", "large"])
def test_scenarios_are_read_from_regular_files_alone(kind: str, tmp_path: Path) -> None:
    path = Path("/dev/zero") if kind == "device" else tmp_path / "scenario.toml"
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "large":
        path.write_bytes(b"#" * ((16 << 20) + 1))
    environment = {**os.environ, "RAYON_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    run = [sys.executable, "-c", LIMITED, str(path)]
    done = subprocess.run(run, capture_output=True, text=True, timeout=60, env=environment, check=True)
    said = "it is larger than 16 MiB" if kind == "large" else "it is not a regular file"
    assert done.stdout.splitlines() == [f"{path}: {said}"] * 4
