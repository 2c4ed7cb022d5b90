"""The unstable tongues of x'' + (a - 2 q cos 2t) x = 0 against the characteristic values of Mathieu's functions."""

import numpy as np
import pytest
from evidence import agrees
from scipy.special import mathieu_a, mathieu_b

from pliant.plants import LTVModel
from pliant.plants.stability import assess, floquet


def mathieu(a, q, damping=0.0, nodes=65):
    t = np.linspace(0.0, np.pi, nodes)
    A = np.zeros((nodes, 2, 2))
    A[:, 0, 1], A[:, 1, 0], A[:, 1, 1] = 1.0, -(a - 2 * q * np.cos(2 * t)), -2 * damping
    zero = {
        k: np.zeros((nodes, *s)) for k, s in {"B": (2, 0), "E": (2, 0), "C": (0, 2), "D": (0, 0), "F": (0, 0)}.items()
    }
    rows = {"c": np.zeros((nodes, 2)), "x": np.zeros((nodes, 2)), "u": np.zeros((nodes, 0)), "y": np.zeros((nodes, 0))}
    return LTVModel(t, A, **zero, **rows, states=("x", "v"), inputs=(), disturbances=(), outputs=())


def edge(q, low, high):
    """The value of a between low and high at which the verdict changes, by bisection."""
    first = floquet(mathieu(low, q)).verdict
    assert {first, floquet(mathieu(high, q)).verdict} == {"marginal", "unstable"}
    while high - low > 1e-6:
        middle = (low + high) / 2
        if floquet(mathieu(middle, q)).verdict == first:
            low = middle
        else:
            high = middle
    return (low + high) / 2


@pytest.mark.every(3)
@pytest.mark.parametrize("q", (0.1, 0.7, 2.5))
def test_boundaries(q):
    known = [mathieu_a(0, q), mathieu_b(1, q), mathieu_a(1, q), mathieu_b(2, q), mathieu_a(2, q)]
    found = []
    for k, value in enumerate(known):
        below = (known[k - 1] + value) / 2 if k else value - 0.2
        above = (known[k + 1] + value) / 2 if k + 1 < len(known) else value + 0.2
        found.append(edge(q, below, above))
    agrees(
        found,
        known,
        within=1e-4,
        absolute=True,
        of="stability.floquet",
        what=f"edges a0, b1, a1, b2, a2 of Mathieu's tongues at q = {q:g}",
        source="SciPy's mathieu_a and mathieu_b",
        kind="other program",
    )


@pytest.mark.campaign
def test_boundaries_as_tabulated():
    found = [edge(5.0, -5.9, -5.795), edge(5.0, 2.0, 2.2), edge(5.0, 7.3, 7.6)]
    agrees(
        found,
        [-5.80004602, 2.09946045, 7.44910974],
        within=1e-4,
        absolute=True,
        of="stability.floquet",
        what="edges a0, b2, a2 of Mathieu's tongues at q = 5",
        source="Abramowitz and Stegun (1964), table 20.1",
        kind="table",
    )


def test_frozen_time_sees_none_of_it():
    model = mathieu(1.0, 0.3, damping=0.05)  # in the first tongue; k(t) from 0.4 to 1.6
    verdict = assess(model)
    assert verdict.verdict == "unstable" and verdict.method == "floquet" and verdict.margin < -0.05
    assert verdict.evidence["frozen_time"].suggests == "stable"
    assert not verdict.evidence["slow_variation"]
    assert "not to be believed" in verdict.reasons["frozen_time"]
    assert "no certificate" in verdict.reasons["lyapunov"]


def test_damping_closes_the_tongue():
    assert assess(mathieu(1.0, 0.1, damping=0.08)).verdict == "stable"  # first order: unstable where damping < q/2
    assert assess(mathieu(1.0, 0.1, damping=0.03)).verdict == "unstable"
