"""A torsion mode crosses a bending mode as the payload's inertia about the beam's axis grows."""

import numpy as np

from pliant.plants.beams.euler_bernoulli_modes import loaded_roots
from pliant.plants.beams.offset_payload_roots import OffsetPayload

BENDING = loaded_roots(3, 1.0, 0.1)


def crossing(k, coupling=0.0, inertia=0.0):
    """A beam whose torsion root, without coupling, is its bending root number k."""
    chi = 1.2
    mu = np.pi / 2 / (chi * BENDING[k] ** 2)
    return OffsetPayload(mass=1.0, offset=(0.0, 0.0, coupling), inertia=(inertia, 0.1, 0.0), chi=chi, mu=mu)


def test_double_root_touches_zero_without_a_change_of_sign_and_is_counted_twice():
    s = crossing(1)
    near = BENDING[1] + np.array([-2e-4, -1e-4, 1e-4, 2e-4])
    assert len(set(np.sign(s.equation(near)))) == 1
    assert np.diff(s.count(near)).tolist() == [0, 2, 0]
    np.testing.assert_allclose(s.roots(3)[1:], BENDING[1], rtol=1e-13)


def test_shapes_at_the_double_root_are_two():
    """The null vector of a double root is a plane: one vector for both would give the same shape twice."""
    modes = crossing(1).shapes(4)
    np.testing.assert_allclose(modes.mass, np.eye(4), atol=1e-11)
    scaled = modes.stiffness / np.outer(modes.roots, modes.roots) ** 2
    np.testing.assert_allclose(scaled, np.eye(4), atol=1e-11)


def test_order_is_no_name_where_modes_cross():
    """On either side of the crossing mode 1 is another motion: torsion_share tells them apart."""
    inertia = np.linspace(0.0, 0.02, 9)
    swept = [
        OffsetPayload(mass=1.0, inertia=(I, 0.1, 0.0), chi=1.2, mu=0.9 * crossing(1).mu).shapes(3) for I in inertia
    ]
    share = np.array([modes.torsion_share[:3] for modes in swept])
    assert share[0, 1] < 1e-9 < 0.99 < share[-1, 1]
    np.testing.assert_allclose(np.sort(share, axis=1), [[0.0, 0.0, 1.0]] * 9, atol=1e-9)


def test_coupling_turns_the_crossing_into_veering():
    """The gap grows with the offset and the two share their torsion; weak coupling loses no root."""
    gaps = []
    for a in (1e-9, 1e-7, 1e-5, 1e-3):
        modes = crossing(1, coupling=a).shapes(3)
        assert crossing(1, coupling=a).count(np.array([1.01 * BENDING[1]])).tolist() == [3]
        gaps.append(modes.roots[2] - modes.roots[1])
        np.testing.assert_allclose(modes.mass, np.eye(3), atol=1e-9)
    np.testing.assert_allclose(modes.torsion_share[1:], 0.5, atol=0.05)
    assert np.log10(gaps[3] / gaps[2]) == np.clip(np.log10(gaps[3] / gaps[2]), 1.9, 2.1)
