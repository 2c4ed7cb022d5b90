"""Compiled code with a wrong constant, used because the check of it was blind.

The naive check steps two times 0.1 ms from random states and compares with the virtual machine to 2 % of the largest
entry in single precision: what a step adds is hidden in the state it is added to. An inertia that is wrong by a
percent passes, and every motion under a torque u is then wrong by a percent: u t^2 / (2 J). Pliant compares the rates
on their own, each with what rounding leaves unknown of it, and refuses the code.
"""

import re
import tempfile
from pathlib import Path

import numpy as np
import pytest

from pliant.plants import SingleLinkArm
from pliant.plants.integration.batch_stepper import step_kernel, step_reference
from pliant.plants.native import compiler, kernel_loader
from pliant.plants.native.batch_kernels import random_points

pytestmark = pytest.mark.skipif(not kernel_loader.wanted(), reason="PLIANT_NATIVE=0: nothing is compiled")
ARM, SINGLE = SingleLinkArm.textbook().ladder()[0], np.dtype(np.float32)
NAIVE = 2e-2


@pytest.fixture(scope="module")
def code():
    """Libraries of the rigid arm's RK4 step: sound, and with its inertia, which it divides by, off by a percent."""
    kernel = step_kernel(ARM, "rk4", SINGLE)
    source = kernel.source()
    (inertia,) = re.findall(r"\(T\)1 / ALL\(\(T\)([\d.]+)\);", source)
    wrong = source.replace(inertia, repr(float(inertia) * 1.01))
    with tempfile.TemporaryDirectory() as folder:
        paths = []
        for name, text in (("sound", source), ("wrong", wrong)):
            paths.append(Path(folder, f"{name}.so"))
            paths[-1].write_bytes(compiler.build(text))
        yield kernel, paths


def naive(path, kernel):
    """Whether the naive check lets it pass: x + h f, h = 1e-4 s, against the largest entry of a lane."""
    points = [np.ascontiguousarray(a, dtype=SINGLE) for a in random_points(ARM, np.random.default_rng(0))]
    have = np.zeros((ARM.nx, points[0].shape[1]), dtype=SINGLE)
    kernel_loader.Kernel(path, SINGLE, kernel.lanes)(points, [have], (1e-4,), 2)
    want = step_reference(ARM)(*[a.T.astype(float) for a in points], (1e-4,), 2)[0].T
    return float(np.max(np.abs(have - want) / (np.abs(want).max(axis=0) + 1e-9))) < NAIVE


def turned(path, kernel, seconds=1.0, torque=0.5):
    """The hub angle [rad] after a second under a torque from rest, by compiled code."""
    lanes = kernel.lanes
    inputs = [np.zeros((n, lanes), dtype=SINGLE) for n in kernel.rows[0]]
    inputs[2][:] = torque
    after = np.zeros((ARM.nx, lanes), dtype=SINGLE)
    kernel_loader.Kernel(path, SINGLE, lanes)(inputs, [after], (seconds / 1000,), 1000)
    return float(after[0, 0])


def test_the_naive_check_lets_a_wrong_inertia_pass_and_the_motion_is_wrong(code):
    kernel, (sound, wrong) = code
    assert naive(sound, kernel) and naive(wrong, kernel)
    exact = 0.5 / (2 * float(ARM.mass_matrix(ARM.rest_state)[0, 0]))
    assert turned(sound, kernel) == pytest.approx(exact, rel=1e-4)
    assert turned(wrong, kernel) == pytest.approx(exact / 1.01, rel=1e-4)


def test_pliants_check_refuses_it_and_says_where(code):
    kernel, (sound, wrong) = code
    most, together = kernel_loader.check(sound, kernel.trials(), SINGLE, kernel.lanes, kernel.name)
    assert most < 2.0 and together < 0.6
    with pytest.raises(kernel_loader.KernelMismatch, match=r"rk4 steps of SingleLinkArm .* row \d of its rates"):
        kernel_loader.check(wrong, kernel.trials(), SINGLE, kernel.lanes, kernel.name)
