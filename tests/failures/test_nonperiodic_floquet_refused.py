"""A nominal that is not periodic: Floquet's theory is refused, and growth decides or nothing does."""

import numpy as np
import pytest

from pliant.plants import LTVModel, Signal
from pliant.plants.stability import assess, floquet


def swept(start, rate, damping=0.0, duration=20.0, nodes=801, angle=None):
    """x'' + 2 d x' + k(t) x = 0, k = start + rate t."""
    t = np.linspace(0.0, duration, nodes)
    A = np.zeros((nodes, 2, 2))
    A[:, 0, 1], A[:, 1, 0], A[:, 1, 1] = 1.0, -(start + rate * t), -2 * damping
    return with_nominal(t, A, np.zeros((nodes, 2)) if angle is None else angle(t))


def with_nominal(t, A, x):
    nodes = len(t)
    zero = {
        k: np.zeros((nodes, *s)) for k, s in {"B": (2, 0), "E": (2, 0), "C": (0, 2), "D": (0, 0), "F": (0, 0)}.items()
    }
    rows = {"c": np.zeros((nodes, 2)), "x": x, "u": np.zeros((nodes, 0)), "y": np.zeros((nodes, 0))}
    states = (Signal("angle", "rad"), Signal("rate", "rad/s"))
    return LTVModel(t, A, **zero, **rows, states=states, inputs=(), disturbances=(), outputs=())


def test_refused_with_the_reason():
    model = swept(1.0, 0.1)
    with pytest.raises(ValueError, match="not periodic: A\\(t \\+ T\\) differs from A\\(t\\) by 1 of its range"):
        floquet(model)
    with pytest.raises(ValueError, match=r"floquet.period = 5 s: the model is not periodic"):
        floquet(model, 5.0)
    with pytest.raises(ValueError, match=r"covers 20 s, less than the period 30 s"):
        floquet(model, 30.0)
    with pytest.raises(ValueError, match=r"floquet.period = -1.0 must be > 0"):
        floquet(model, -1.0)


def test_growth_decides_where_it_can():
    falling = assess(swept(1.0, -0.2))  # the stiffness goes through zero at 5 s and the motion then runs away
    assert (falling.verdict, falling.method) == ("unstable", "growth")
    assert "not periodic" in falling.reasons["floquet"] or "differs" in falling.reasons["floquet"]
    assert any(abs(t - 5.0) < 1e-3 for t in falling.critical_times)  # the frozen root crosses there
    braked = assess(swept(1.0, 0.2, damping=0.6))
    assert braked.verdict == "stable" and braked.method in ("slow_variation", "lyapunov", "growth")


def test_over_its_time_it_is_bounded_where_nothing_else_is_shown():
    verdict = assess(swept(1.0, 0.01, damping=0.001))
    assert (verdict.verdict, verdict.method) == ("bounded", "growth")
    most = np.exp(-verdict.margin_bound * 20.0)
    assert verdict.evidence["growth"].total <= most < 10 and f"at most {most:.3g} times as large" in verdict.why
    assert set(verdict.reasons) == {"eigenvalues", "floquet", "slow_variation", "lyapunov", "exponents", "frozen_time"}
    assert all(verdict.reasons.values())


def test_a_rest_to_rest_motion_is_not_a_period_though_its_matrices_close():
    t = np.linspace(0.0, 4.0, 401)
    A = np.zeros((401, 2, 2))
    A[:, 0, 1], A[:, 1, 0], A[:, 1, 1] = 1.0, -4.0 + np.sin(np.pi * t / 4) ** 4, -0.1
    angle = 0.5 - 0.5 * np.cos(np.pi * t / 4)
    slew = with_nominal(t, A, np.stack([angle, np.gradient(angle, t)], axis=1))
    with pytest.raises(ValueError, match="the nominal angle ends at 1, not at 0 rad"):
        floquet(slew)
    assert floquet(slew, 4.0).verdict == "stable"  # who says that it repeats is believed, A(t) being periodic
    assert assess(slew).reasons["floquet"].startswith("the model is not periodic: the nominal angle ends")


def test_a_corner_at_the_seam_is_not_periodic():
    t = np.linspace(0.0, 1.0, 101)
    A = np.zeros((101, 2, 2))
    A[:, 0, 1], A[:, 1, 0] = 1.0, -4.0 + t * (1 - t)
    with pytest.raises(ValueError, match="dA/dt at the end differs from that at the start by"):
        floquet(with_nominal(t, A, np.zeros((101, 2))))


def test_free_drift_is_not_taken_for_instability():
    """v' = 0, x' = (1 + slowly varying) v: the deviation grows a hundredfold, in proportion to time."""
    t = np.linspace(0.0, 100.0, 401)
    A = np.zeros((401, 2, 2))
    A[:, 0, 1] = 1.0 + 0.1 * np.tanh((t - 50.0) / 20.0)
    verdict = assess(with_nominal(t, A, np.zeros((401, 2))), periodic=False)
    assert (verdict.verdict, verdict.drifting, verdict.growth) == ("drift", ("angle",), "polynomial")
    assert verdict.sentence.startswith("Drift of angle, which nothing else feels")
    assert verdict.evidence["growth"].total > 50


def test_growth_past_the_range_of_numbers_is_still_unstable():
    verdict = assess(swept(-1.0, -5.0, duration=400.0, nodes=4001))
    assert (verdict.verdict, verdict.method) == ("unstable", "growth") and verdict.margin < -1
