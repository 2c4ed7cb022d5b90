"""Steppers and kernels that are copied or sent go on as the original would, in memory of their own."""

import copy
import os
import pickle
import subprocess
import sys

import cloudpickle
import joblib
import numpy as np
import pytest

from pliant.envs import scenes
from pliant.envs.simulation import episode_start
from pliant.envs.simulation.control_kernel import ControlStep, control_kernel
from pliant.plants import SingleLinkArm
from pliant.plants.integration.batch_stepper import step_kernel
from pliant.plants.native import kernel_loader

ARM = SingleLinkArm.textbook().ladder()[0].vary("payload.mass")
DOUBLE = np.dtype(float)


def by_buffers(thing):
    """Pickle's protocol 5, as Ray and Dask have it: what arrives may not be written to."""
    buffers: list[pickle.PickleBuffer] = []
    content = pickle.dumps(thing, protocol=5, buffer_callback=buffers.append)
    return pickle.loads(content, buffers=[bytes(b.raw()) for b in buffers])


WAYS = {
    "pickle": lambda thing: pickle.loads(pickle.dumps(thing)),
    "cloudpickle": lambda thing: pickle.loads(cloudpickle.dumps(thing)),
    "read-only buffers": by_buffers,
    "deepcopy": copy.deepcopy,
    "copy": copy.copy,
}


def on_its_way(dtype="float64"):
    """A stepper after two calls, the last of which leaves input and parameters as they were, and its states."""
    step = ARM.stepper(0.01, batch=8, substeps=2, dtype=dtype)
    x = np.asfortranarray(np.random.default_rng(0).uniform(-1, 1, (8, 2)).astype(dtype))
    step(x, np.linspace(0.0, 1.0, 8)[:, None], np.linspace(0.2, 0.9, 8)[:, None], w=[0.0, -9.81], t=1.0, out=x)
    step(x, out=x)
    return step, x


def onward(step, x):
    """Three steps more."""
    x = x.copy(order="F")
    for _ in range(3):
        step(x, out=x)
    return x


@pytest.mark.parametrize("dtype", ["float64", "float32"])
@pytest.mark.parametrize("way", WAYS)
def test_a_copy_of_a_stepper_goes_on_bit_for_bit_and_shares_nothing(way, dtype):
    step, x = on_its_way(dtype)
    other = WAYS[way](step)
    assert other.native == step.native == kernel_loader.wanted()
    assert other.guard.calls == 2 and np.array_equal(other.sound, step.sound)
    want = onward(step, x)
    np.testing.assert_array_equal(onward(other, x), want)
    other(x.copy(order="F"), np.array([5.0]), np.full((8, 1), 0.5))  # moves nothing of the original's
    np.testing.assert_array_equal(onward(step, x), want)


@pytest.mark.parametrize("way", WAYS)
def test_kernels_of_every_kind_travel(way):
    scene = scenes.get("spin-up")
    fast = SingleLinkArm.textbook().ladder()[0].compile()
    send = WAYS[way]
    assert send(step_kernel(ARM, "rk4", DOUBLE)) is step_kernel(ARM, "rk4", DOUBLE)  # equal plants share one
    assert send(control_kernel(scene, DOUBLE)).native == kernel_loader.wanted()
    values = (0.0, np.array([0.3, 0.1]), [0.5], [0.0, -9.81], [])
    np.testing.assert_array_equal(send(fast._dynamics)(*values)[0], fast._dynamics(*values)[0])
    assert send(fast._dynamics).native == kernel_loader.wanted()
    observing = episode_start._observing(scene)
    x, ref = np.full((3, 6), 0.01), np.tile(episode_start.reference(scene), (3, 1))
    rows = x, np.zeros((3, 1)), ref, np.zeros((3, scene.plant.nw)), np.zeros((3, len(scene.varied_plant.varied)))
    for have, want in zip(send(observing)(*rows), observing(*rows)):
        np.testing.assert_array_equal(have, want)


@pytest.mark.parametrize("way", WAYS)
def test_an_environments_kernel_goes_on(way):
    step = ControlStep(scenes.get("spin-up"), 3, DOUBLE, 1)
    step.action[:] = 0.7
    step.run()
    other = WAYS[way](step)
    for _ in range(2):
        for have, want in zip(other.run(), step.run()):
            np.testing.assert_array_equal(have, want)
    np.testing.assert_array_equal(other.x, step.x)
    np.testing.assert_array_equal(other.obs, step.obs)


def test_joblibs_processes_go_on_bit_for_bit():
    step, x = on_its_way()
    found = joblib.Parallel(n_jobs=2, backend="loky")(joblib.delayed(onward)(step, x) for _ in range(2))
    for have in found:
        np.testing.assert_array_equal(have, onward(step, x))


RECEIVE = """
import pickle, sys, warnings
warnings.simplefilter("always")
step, x = pickle.load(sys.stdin.buffer)
for _ in range(3):
    step(x, out=x)
print(step.native, repr(x.tolist()))
"""


@pytest.mark.skipif(not kernel_loader.wanted(), reason="PLIANT_NATIVE=0: no compiler is asked for")
def test_where_it_arrives_without_a_compiler_the_virtual_machine_goes_on(tmp_path):
    step, x = on_its_way()
    elsewhere = {"CC": "no-such-compiler", "PLIANT_CACHE": str(tmp_path / "cache")}
    done = subprocess.run(
        [sys.executable, "-c", RECEIVE],
        input=pickle.dumps((step, x)),
        capture_output=True,
        env=os.environ | elsewhere,
        check=True,
    )
    native, states = done.stdout.decode().split(" ", 1)
    assert native == "False" and done.stderr.decode().count("native code is off for rk4 steps of SingleLinkArm") == 1
    np.testing.assert_allclose(np.array(eval(states)), onward(step, x), rtol=1e-12)
