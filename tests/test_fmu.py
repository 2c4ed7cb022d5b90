"""The example's FMU, built by PythonFMU3 and played by FMPy, moves as the plant does; where these are installed."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from pliant.envs import scenes

ARM = Path(__file__).parents[1] / "examples" / "fmu" / "arm.py"


def test_an_fmu_of_the_arm(tmp_path) -> None:
    pytest.importorskip("pythonfmu3", reason="PythonFMU3 is not here: pip install pythonfmu3 fmpy")
    fmpy = pytest.importorskip("fmpy", reason="FMPy is not here: pip install fmpy")
    subprocess.run([sys.executable, "-m", "pythonfmu3", "build", "-f", str(ARM), "-d", str(tmp_path)], check=True)
    options = {"stop_time": 0.3, "step_size": 0.01, "output_interval": 0.01, "start_values": {"hub_torque": 2.0}}
    found = fmpy.simulate_fmu(str(tmp_path / "Arm.fmu"), output=["hub_angle", "tip_y"], **options)
    scene, t = scenes.get("single-link-slew"), np.linspace(0, 0.3, 31)
    wanted = scene.plant.simulate(scene.initial[0], np.full((31, 1), 2.0), t)
    for name in ("hub_angle", "tip_y"):
        assert found[name][1:] == pytest.approx(wanted[name][1 : len(found)], rel=1e-6, abs=1e-8)
