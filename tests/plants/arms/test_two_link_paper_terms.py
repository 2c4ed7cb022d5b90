"""The paper's terms against the equations of motion."""

import dataclasses

import numpy as np
import pytest

from pliant.plants import Payload, TwoLinkArm, paper_terms

ARM = TwoLinkArm.textbook()
VARIANTS = {"CS": ARM, "CC": dataclasses.replace(ARM, tip_slope=False)}
TERMS = {
    "slope": ARM,
    "no slope": VARIANTS["CC"],
    "hubs and losses": dataclasses.replace(
        ARM,
        hub_inertia=(0.1, 0.02),
        joint_friction=(0.4, 0.2),
        link1=dataclasses.replace(ARM.link1, damping=1e-3),
        link2=dataclasses.replace(ARM.link2, damping=2e-3, length=0.7),
    ),
    "payload basis": dataclasses.replace(ARM, basis="payload", modes=(3, 1), tip_slope=False),
    "polynomial": dataclasses.replace(ARM, basis="polynomial", modes=(1, 3)),
    "link 2 alone bends": dataclasses.replace(ARM, modes=(0, 2)),
    "rigid": dataclasses.replace(ARM, modes=(0, 0)),
}


@pytest.mark.parametrize("name", list(TERMS))
def test_paper_terms_add_up_to_the_equations_of_motion(name, random_state):
    """With accelerations from automatic differentiation, J q'' + F q' + Gamma = tau in every equation."""
    arm, u = TERMS[name], np.array([2.0, -1.0])
    for seed in range(20):
        terms = paper_terms(arm, random_state(arm, seed), u)
        size = np.abs(terms.J * terms.acceleration) + np.abs(terms.F * terms.rate) + np.abs(terms.Gamma)
        assert np.all(np.abs(terms.residual) < 1e-11 * size.max())
    n = arm.nx // 2
    np.testing.assert_allclose(terms.acceleration, arm.dynamics(random_state(arm, 19), u)[n:], rtol=1e-12)
    np.testing.assert_array_equal(terms.applied, [2.0, -1.0] + [0.0] * (n - 2))


@pytest.mark.parametrize("name", ["slope", "no slope", "hubs and losses"])
def test_paper_inertia_is_the_diagonal_of_the_mass_matrix(name, random_state):
    arm = TERMS[name]
    x = random_state(arm, 3)
    np.testing.assert_allclose(paper_terms(arm, x).J, np.diag(arm.mass_matrix(x)), rtol=1e-12)


@pytest.mark.parametrize(
    "changes",
    [
        {"kinematics": "stiffened"},
        {"reduction": "rigid-coupling"},
        {"payload": Payload(mass=1.0, offset=(0.1, 0, 0))},
    ],
)
def test_paper_terms_refuse_what_they_do_not_hold(changes):
    with pytest.raises(ValueError, match=f"{next(iter(changes))}.* must be"):
        paper_terms(dataclasses.replace(ARM, **changes), np.zeros(12))


def rigid_arm(arm, q, v, tau):
    """Accelerations of two rigid links as in any robotics textbook: M(q) a + c(q, v) + g(q) = tau."""
    m1, m2, mj, mp = arm.link1.mass, arm.link2.mass, arm.joint_mass, arm.payload.mass
    L1, L2, g = arm.link1.length, arm.link2.length, arm.gravity
    J1 = m1 * L1**2 / 12 + arm.hub_inertia[0]
    J2 = m2 * L2**2 / 12 + arm.hub_inertia[1]
    carried = m2 * L2 / 2 + mp * L2
    own2 = J2 + m2 * (L2 / 2) ** 2 + mp * L2**2 + arm.payload.inertia_z
    own1 = J1 + m1 * (L1 / 2) ** 2 + (mj + m2 + mp) * L1**2
    c2, s2 = np.cos(q[1]), np.sin(q[1])
    M = np.array([[own1 + own2 + 2 * L1 * carried * c2, own2 + L1 * carried * c2], [own2 + L1 * carried * c2, own2]])
    h = L1 * carried * s2
    c = np.array([-h * (2 * v[0] * v[1] + v[1] ** 2), h * v[0] ** 2])
    outer = g * carried * np.cos(q[0] + q[1])
    gravity = np.array([g * (m1 / 2 + mj + m2 + mp) * L1 * np.cos(q[0]) + outer, outer])
    friction = np.array(arm.joint_friction) * v
    return np.linalg.solve(M, tau - c - gravity - friction)


@pytest.mark.parametrize("changes", [{"reduction": "rigid"}, {"modes": (0, 0)}])
def test_last_stage_is_the_rigid_arm(changes, random_state):
    arm = dataclasses.replace(
        ARM,
        link2=dataclasses.replace(ARM.link2, length=0.6),
        hub_inertia=(0.1, 0.02),
        joint_friction=(0.3, 0.1),
        **changes,
    )
    for seed in range(20):
        x, tau = random_state(arm, seed), np.array([3.0, -2.0])
        expected = rigid_arm(arm, x[:2], x[2:], tau)
        np.testing.assert_allclose(arm.dynamics(x, tau)[2:], expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_stages_agree_at_zero_deflection_and_differ_beyond(random_state):
    stages = {name: dataclasses.replace(ARM, reduction=name) for name in ("full", "rigid-inertia", "rigid-coupling")}
    straight = random_state(ARM, 1)
    straight[2:6] = 0.0
    M = stages["full"].mass_matrix(straight)
    bent = straight.copy()
    bent[2:6] = [2e-4, 1e-4, -1e-4, 1e-4]
    for arm in stages.values():
        np.testing.assert_allclose(arm.mass_matrix(straight), M, rtol=1e-13)
        assert arm.potential(bent) == stages["full"].potential(bent)
    full, inertia, coupling = (arm.mass_matrix(bent) for arm in stages.values())
    np.testing.assert_allclose(np.diag(inertia)[:2], np.diag(M)[:2], rtol=1e-13)
    off = ~np.eye(6, dtype=bool)
    np.testing.assert_allclose(inertia[off], full[off], rtol=1e-13)
    assert np.abs(inertia[0, 1] - M[0, 1]) > 1e-6
    np.testing.assert_allclose(coupling, M, rtol=1e-13)
