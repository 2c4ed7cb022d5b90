"""The paper's first reduction stage loses its mass matrix at under a millimetre of deflection."""

import dataclasses
import re

import numpy as np
import pytest

from pliant.plants import MassMatrixError, TwoLinkArm

FULL = TwoLinkArm.textbook()
FIRST = dataclasses.replace(FULL, reduction="rigid-inertia")
SECOND = dataclasses.replace(FULL, reduction="rigid-coupling")


def bent(deflection, elbow=np.pi / 2):
    """The arm with its elbow at a right angle and both tips deflected inwards [m], in first modes (phi(1) = 2)."""
    x = np.zeros(12)
    x[1], x[2], x[4] = elbow, -deflection / 2, -deflection / 2
    return x


def definite(arm, x):
    return np.linalg.eigvalsh(arm.mass_matrix(x)).min() > 0


def test_first_stage_is_definite_at_half_a_millimetre_and_not_at_eight_tenths():
    assert definite(FIRST, bent(0.5e-3)) and not definite(FIRST, bent(0.8e-3))
    # Where the inertia taken away reaches what the other coordinates leave of it: M11(q) - M11(0) = 1/(M^-1)_11.
    spare = {}
    for d in (0.5e-3, 0.8e-3):
        M, straight = FULL.mass_matrix(bent(d)), FULL.mass_matrix(bent(0.0))
        spare[d] = 1 / np.linalg.inv(M)[0, 0] - (M - straight)[0, 0]
    assert spare[0.5e-3] > 0 > spare[0.8e-3]


def test_pliant_names_the_deflection():
    with pytest.raises(MassMatrixError, match="rigid-inertia is not positive definite") as caught:
        FIRST.dynamics(bent(0.8e-3))
    said = re.findall(r"tip\d_deflection = (\S+) m", str(caught.value))
    assert [float(v) for v in said] == pytest.approx([-0.8e-3, -0.8e-3])
    assert caught.value.pivot < 0
    np.testing.assert_array_equal(caught.value.state, bent(0.8e-3))
    rows = np.array([bent(0.0), bent(0.8e-3), bent(2e-3)])
    with pytest.raises(MassMatrixError, match=r"tip1_deflection = -0\.0008 m"):
        FIRST.dynamics(rows)


def test_a_motion_that_comes_near_is_stopped_with_the_same_error():
    arm = dataclasses.replace(FIRST, gravity=0.0)
    with pytest.raises(
        MassMatrixError, match=r"rigid-inertia .* at tip1_deflection = \S+ m, tip2_deflection"
    ) as caught:
        arm.simulate(bent(0.0), [1.0, 0.0], np.linspace(0, 0.5, 101))
    deflections = np.abs(arm.measure(caught.value.state)[2:4])
    assert 2e-4 < deflections.max() < 2e-2
    for method, options in (("rk4", {"step": 5e-4}), ("dop853", {}), ("rodas5p", {})):
        with pytest.raises(MassMatrixError, match=r"tip1_deflection = -0\.0008 m"):  # at the start already
            arm.simulate(bent(0.8e-3), None, [0, 0.01], method=method, **options)


def test_second_stage_and_the_full_arm_stay_definite(random_state):
    for d in (0.8e-3, 5e-3, 0.05):
        assert definite(SECOND, bent(d)) and definite(FULL, bent(d))
    assert all(definite(SECOND, random_state(SECOND, seed)) for seed in range(50))
    motion = dataclasses.replace(SECOND, gravity=0.0).simulate(bent(0.0), [1.0, 0.0], np.linspace(0, 0.5, 11))
    assert np.all(np.isfinite(motion.x))


def test_hub_inertia_helps_but_does_not_cure():
    hubbed = dataclasses.replace(FIRST, hub_inertia=(0.1, 0.02))
    assert definite(hubbed, bent(0.8e-3)) and not definite(hubbed, bent(0.05))
