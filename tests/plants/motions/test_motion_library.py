"""Compiled motions: the virtual machine's numbers, closed forms, every kind of input, and one library a plant."""

import pickle
import threading

import native_motions
import numpy as np
import pytest
from oscillators import Oscillator, Scalar

from pliant.envs import scenes
from pliant.plants import IntegrationError
from pliant.plants.integration import batch_stepper
from pliant.plants.motions import compile_rule, motion_library
from pliant.plants.native import compiler, kernel_loader

pytestmark = pytest.mark.skipif(not kernel_loader.wanted(), reason="PLIANT_NATIVE=0: nothing is compiled")
SWING = Oscillator(omega=3.0)
TIMES = np.linspace(0.0, 2.0, 41)


@pytest.fixture(autouse=True)
def at_once(monkeypatch):
    """Nothing is too short to be compiled."""
    for price in ("COMPILING", "LOOKING"):
        monkeypatch.setattr(compile_rule, price, (0.0, 0.0))


@pytest.mark.parametrize("seed", range(12, 30, 2))
def test_a_sample_of_the_campaign(seed):
    row = native_motions.run(seed)
    assert row["right"], row


@pytest.mark.parametrize(("method", "order"), [("rk4", 4), ("rk8", 8)])
def test_steps_are_of_their_order_against_the_closed_form(method, order):
    """x = cos(3 t). A step errs by (3 h)^(p + 1) / (p + 1)!, what the exponential's series leaves, or twice that."""
    h = 0.05
    motion = SWING.simulate([1.0, 0.0], None, TIMES, method=method, step=h)
    assert motion.stats["native"] and motion.stats["steps"] == 40
    bound = 40 * (3 * h) ** (order + 1) / np.prod(np.arange(1.0, order + 2)) * 2 + 1e-14
    assert np.abs(motion.x[:, 0] - np.cos(3 * TIMES)).max() < bound


def test_adaptive_steps_keep_their_tolerance_and_end_on_every_time():
    motion = SWING.simulate([1.0, 0.0], None, TIMES, rtol=1e-9, atol=1e-9)
    assert motion.stats["native"]
    np.testing.assert_allclose(motion.x[:, 0], np.cos(3 * TIMES), atol=1e-9 * motion.stats["steps"])


def test_inputs_held_over_uneven_times_act_where_they_are_held():
    """x'' = u from rest with omega near 0: x' = sum u dt."""
    plant, t = Oscillator(omega=1e-9), np.array([0.0, 0.1, 0.15, 0.4])
    u = np.array([[1.0], [-2.0], [3.0], [9.0]])
    for options in ({"method": "rk4", "step": 0.03}, {"method": "rosenbrock", "step": 0.03}, {}):
        motion = plant.simulate(np.zeros(2), u, t, **options)
        assert motion.stats["native"]
        np.testing.assert_allclose(motion.x[:, 1], [0.0, 0.1, 0.0, 0.75], atol=1e-12)
        np.testing.assert_array_equal(motion.u, u)


def test_a_function_of_time_is_asked_at_the_same_times_in_the_same_order(monkeypatch):
    asked = {"0": [], "1": []}
    for native, told in asked.items():
        monkeypatch.setenv("PLIANT_NATIVE", native)
        SWING.simulate(
            np.zeros(2),
            lambda t, told=told: (told.append(float(t)), [np.sin(t)])[1],
            TIMES[:6],
            method="rk8",
            step=0.02,
        )
    assert asked["0"] == asked["1"] and len(asked["0"]) > 100


def test_more_steps_than_a_call_takes(monkeypatch):
    for limit in ("A_CALL", "SAMPLED"):
        monkeypatch.setattr(motion_library, limit, 7)
    for u in (None, lambda t: [np.sin(t)]):
        long, short = (
            SWING.simulate([1.0, 0.0], u, TIMES[:: 20 if many else 1], method="rk4", step=0.05, rtol=1e-9)
            for many in (True, False)
        )
        np.testing.assert_allclose(long.x, short.x[::20], atol=1e-13)
    np.testing.assert_allclose(SWING.simulate([1.0, 0.0], None, [0.0, 9.0]).x[1, 0], np.cos(27.0), atol=1e-8)


def test_progress_is_told_of_up_to_200_times():
    for options in ({"method": "rk4", "step": 0.05}, {}):
        seen = []
        SWING.simulate([1.0, 0.0], None, TIMES, progress=seen.append, **options)
        assert seen == TIMES[1:].tolist()
        seen.clear()
        SWING.simulate([1.0, 0.0], None, np.linspace(0.0, 2.0, 2001), progress=seen.append, **options)
        assert len(seen) == 200 and seen[-1] == 2.0


def test_time_and_integers_count():
    """x' = sin(t) + x rate, by quadrature at rate 0: x = 1 - cos t, from t = 1; the state an integer."""
    t = np.linspace(1.0, 2.0, 11)
    motion = Scalar(rate=0.0).simulate([0], None, t, method="rk8", step=0.05)
    assert motion.stats["native"]
    np.testing.assert_allclose(motion.x[:, 0], np.cos(1.0) - np.cos(t), atol=1e-13)


def test_one_plant_is_compiled_once_for_all_explicit_methods(monkeypatch, tmp_path):
    plant, built, build = Oscillator(omega=np.pi), [], compiler.build
    monkeypatch.setenv("PLIANT_CACHE", str(tmp_path))
    monkeypatch.setattr(compiler, "build", lambda source: (built.append(source), build(source))[1])
    for options in ({"method": "rk4", "step": 0.05}, {"method": "rk8", "step": 0.05}, {}, {"rtol": 1e-5}):
        assert plant.simulate([1.0, 0.0], None, TIMES, **options).stats["native"]
    # and once what is seen on them, and once the slopes that fixed steps are held against
    assert sorted("adaptive" in source for source in built) == [False, False, True]
    monkeypatch.setattr(motion_library, "_loaded", {})  # as another process finds it
    batch_stepper.motion_kernel.cache_clear()
    assert plant.simulate([1.0, 0.0], None, TIMES, method="rk4", step=0.05).stats["native"]
    assert len(built) == 3


def test_a_plant_travels_and_threads_share_its_library():
    plant = pickle.loads(pickle.dumps(SWING))
    want, found = plant.simulate([1.0, 0.0], None, TIMES, method="rk4", step=0.01).x, []
    tasks = [
        threading.Thread(
            target=lambda: found.append(SWING.simulate([1.0, 0.0], None, TIMES, method="rk4", step=0.01).x)
        )
        for _ in range(4)
    ]
    for task in tasks:
        task.start()
    for task in tasks:
        task.join()
    assert len(found) == 4
    for x in found:
        np.testing.assert_array_equal(x, want)


def test_what_is_written_and_read_must_lie_as_c_has_it():
    with pytest.raises(ValueError, match=r"an array of float64\(2, 2\) must be C-ordered"):
        motion_library._place(np.zeros((2, 4))[:, ::2])


def test_a_motion_that_ends_says_where(monkeypatch):
    ends = Scalar(ends=True)  # x' = 2 + sqrt(1 - x), no number beyond x = 1
    for options in ({"method": "rk4", "step": 0.01}, {"method": "rk8", "step": 0.01}, {}):
        told = []
        for native in ("0", "1"):
            monkeypatch.setenv("PLIANT_NATIVE", native)
            with pytest.raises(IntegrationError) as stopped:
                ends.simulate([0.0], None, np.linspace(0.0, 1.0, 11), **options)
            told.append(stopped.value)
        np.testing.assert_allclose(told[1].time, told[0].time, rtol=1e-9)
        np.testing.assert_allclose(told[1].state, told[0].state, rtol=1e-9)
        assert str(told[0])[:40] == str(told[1])[:40]


@pytest.mark.campaign
@pytest.mark.parametrize("name", scenes.names())
@pytest.mark.parametrize("method", ["rk4", "rk8", "dop853"])
def test_every_shipped_scene_is_the_virtual_machines(name, method):
    scene = scenes.get(name)
    t = scene.times[:9]
    u = np.array([scene.nominal_input(s) for s in t]).reshape(len(t), -1)
    step = None if method == "dop853" else scene.dt / scene.substeps
    far, bound, stats = native_motions.parted(scene.plant, scene.initial[0], u, t, method=method, step=step)
    assert far <= bound < native_motions.VAGUE and stats["native"]
