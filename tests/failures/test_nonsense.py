"""Nonsense in public arguments and on the command line: refused in words, never a traceback from deep inside, and no
valid value refused. A sample of tests/campaigns/bad_input.py and bad_commands.py; `make campaign` runs the whole.
"""

import bad_commands
import bad_input
import calls_of_laws
import calls_of_optima
import calls_of_scenes
import numpy as np
import pytest
from calls_of_designs import design_calls, sensor_calls

import pliant.controllers
import pliant.envs.scenes
import pliant.studies
from pliant.controllers import riccati, rl
from pliant.envs import scenes

COUNT, COMMANDS = 300, 16


@pytest.fixture(scope="module")
def every():
    return calls_of_laws.law_calls()


def test_every_public_callable_has_a_call_or_a_reason(every):
    assert not calls_of_laws.without_call(every)
    assert all(calls_of_laws.reason(name) for name in calls_of_laws.public() if name.endswith(".reset"))
    assert calls_of_laws.reason("controllers.linear_quadratic.lqr.a_new_function") == ""


@pytest.mark.parametrize("package", [pliant.controllers, riccati, rl, pliant.envs.scenes, pliant.studies])
def test_what_a_package_exports_is_called(package, every):
    """No reason stands for an exported function or class: it, or one of its methods, is called."""
    called = {call.function.__qualname__.split(".")[0] for call in every}
    results = {
        "Spillover",
        "Motion",
        "Sampled",
        "SampledLTV",
        "PeriodicFilter",
        "PeriodicRegulator",
        "RobustGain",
        "RobustStability",
        "RobustLQG",
        "TunedMPC",
        "LawDerivative",
        "WorstParameters",
        "MissOverBox",
        "MarginsAlong",
        "Margins",
        "Evaluation",
        "Training",
        "Controller",
        "names",
    }
    exported = {getattr(package, name).__name__ for name in package.__all__ if callable(getattr(package, name))}
    assert exported - called <= results


def test_a_sample_of_the_campaign():
    found = [*design_calls(), *calls_of_optima.learning_calls(), *calls_of_scenes.scene_calls()]
    rng = np.random.default_rng(0)
    pick = rng.choice(len(bad_input.cases(found)), COUNT, replace=False)
    rows = bad_input.run(found, pick)
    assert not [row for row in rows if row["fault"]]


def test_the_campaign_sees_what_it_looks_for():
    """A function without a gate: NumPy's words, a result from a string, a valid integer refused."""
    call = sensor_calls()[1]
    loose = bad_input.Call("loose", lambda dt: np.sqrt(float(dt)), call.kinds)
    faults = {row["fault"] for row in bad_input.run([loose], None)}
    assert faults >= {"raw", "taken"}
    strict = bad_input.Call("strict", _only_floats, call.kinds)
    assert "refused" in {row["fault"] for row in bad_input.run([strict], None)}


def _only_floats(dt):
    if type(dt) is not float:
        raise ValueError("dt must be a float")
    return dt


def test_one_state_too_few_shifts_nothing():
    """The naive way, joining x and y, takes every output from its neighbour in the list."""
    scene = scenes.get("single-link-slew")
    x, y = scene.initial[0], np.arange(100.0, 100 + len(scene.plant.outputs))
    naive = np.concatenate([x[:-1], y])[scene.positions(("tip_deflection",))]
    assert naive != y[1]
    np.testing.assert_array_equal(scene.signal_values(x, y, ("tip_deflection",)), y[1:2])
    for wrong in (x[:-1], np.append(x, 0.0)):
        with pytest.raises(ValueError, match=r"signal_values\.x has shape \(\d,\), must be \(\.\., 6\)"):
            scene.signal_values(wrong, y, ("tip_deflection",))
        with pytest.raises(ValueError, match=r"stage_cost\.x has shape"):
            scene.stage_cost(wrong, [0.0], y)


def test_a_sample_of_the_command_line(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    every = bad_commands.cases(tmp_path)
    quick = [case for case in every if case[0][0] in ("linearize", "figures", "cache", "doctor", "nonsense", "report")]
    for k in np.random.default_rng(0).choice(len(quick), COMMANDS, replace=False):
        arguments, valid = quick[k]
        assert bad_commands.judged(arguments, valid, tmp_path) == ("", ""), arguments
