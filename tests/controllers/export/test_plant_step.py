"""A plant's step and outputs in C beside its own dynamics, with a disturbance and a parameter."""

import ctypes
import subprocess

import numpy as np
from exported import COMPILERS, STRICT, needs_compiler, same_loop

from pliant.controllers import LQR, Predictive
from pliant.controllers.export import export_c
from pliant.plants import SingleLinkArm


@needs_compiler
def test_a_step_with_disturbance_and_parameter(tmp_path) -> None:
    plant, h = SingleLinkArm.textbook().vary("payload.mass"), 1e-4
    source, _ = export_c(plant, tmp_path / "arm.c", dt=h)
    library = tmp_path / "arm.so"
    subprocess.run([COMPILERS[0], *STRICT, "-shared", "-fPIC", str(source), "-o", str(library), "-lm"], check=True)
    arm = ctypes.CDLL(str(library))
    rng = np.random.default_rng(0)
    x, u, w = 1e-2 * rng.standard_normal(plant.nx), rng.standard_normal(plant.nu), rng.standard_normal(plant.nw)
    p = np.array([0.3])

    def pointer(a):
        return a.ctypes.data_as(ctypes.POINTER(ctypes.c_double))

    def f(x):
        return plant.dynamics(x, u, w=w, p=p)

    k1 = f(x)
    k2 = f(x + h / 2 * k1)
    k3 = f(x + h / 2 * k2)
    wanted = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + f(x + h * k3))
    y, found = np.zeros(plant.ny), x.copy()
    given = [pointer(v) for v in ((w,) if plant.nw else ()) + (p,)]
    arm.arm_step(ctypes.c_double(0.0), pointer(found), pointer(u), *given)
    arm.arm_outputs(ctypes.c_double(0.0), pointer(x), pointer(u), *given, pointer(y))
    assert np.abs(found - wanted).max() < 1e-13 * np.abs(wanted).max()
    assert np.allclose(y, plant.measure(x, u, w=w, p=p), rtol=1e-13, atol=1e-15)


@needs_compiler
def test_a_law_that_predicts_over_late_inputs(tmp_path, reach, near_double) -> None:
    """Its inner law reads outputs too; an input past its limit acts as the limit does."""
    law = Predictive.for_scene(reach, 3, LQR.for_scene(reach, integral={"tip_x": 1.0, "tip_y": 1.0}))
    same_loop(tmp_path, reach, law, near_double, count=25)
