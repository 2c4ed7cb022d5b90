"""Margins of frozen loops are no margins of a motion: a spring that varies, held by rate feedback.

The naive way: of x'' + (1 + 0.4 cos 2t) x = u + d, u = -0.4 f dx/dt, the loop frozen at any time is stable for every
f > 0: a gain that may fall to nothing, a phase of 90 deg. What holds: the spring feeds the motion at twice its
frequency, by 0.4/4 a second (Mathieu's first tongue), and feedback takes 0.2 f: below f = 1/2 the loop grows.
"""

import numpy as np
import pytest

from pliant.controllers.analysis.margins_along import margins_along
from pliant.plants import LTVModel, Signal


def spring(T=40 * np.pi, nodes=501):
    t = np.linspace(0.0, T, nodes)
    A = np.zeros((nodes, 2, 2))
    A[:, 0, 1], A[:, 1, 0] = 1.0, -(1 + 0.4 * np.cos(2 * t))
    B, C, none = np.zeros((nodes, 2, 1)), np.zeros((nodes, 1, 2)), np.zeros((nodes, 1, 1))
    B[:, 1, 0], C[:, 0, 0] = 1.0, 1.0
    signals = (Signal("x", "m"), Signal("x_rate", "m/s")), (Signal("u", "N"),), (Signal("d", "N"),), (Signal("y", "m"),)
    zero = np.zeros((nodes, 2)), np.zeros((nodes, 2)), np.zeros((nodes, 1)), np.zeros((nodes, 1))
    return LTVModel(t, A, B, B, C, none, none, *zero, *signals)


def test_the_gain_may_not_fall_as_far_as_frozen_loops_say():
    ltv = spring()
    K = np.tile([[0.0, 0.4]], (len(ltv.t), 1, 1))
    found = margins_along(ltv, K, limit=2.0, frozen=5)
    assert found.frozen_gain[:, 0].max() == pytest.approx(0.0, abs=1e-6)
    assert found.frozen_phase_deg.min() > 85
    assert 0.5 < found.gain[0] < 0.75  # the limit is met before it grows
    for factor, grows in ((0.35, True), (0.7, False)):  # by simulation
        looped = LTVModel(
            *(ltv.t, ltv.A - factor * ltv.B @ K, ltv.B, ltv.E, ltv.C, ltv.D, ltv.F, ltv.c, ltv.x, ltv.u, ltv.y),
            *(ltv.states, ltv.inputs, ltv.disturbances, ltv.outputs),
        )
        dx = looped.simulate(np.array([1.0, 0.0]))[0]
        size = np.abs(dx[-40:, 0]).max()
        assert size > 10 if grows else size < 0.1
