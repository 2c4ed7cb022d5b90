"""Inertias that no body has: refused, or the nearest that one can have, said in words."""

import numpy as np
import pytest

from pliant.plants.beams.payload import check_inertia
from pliant.plants.multibody_parts.urdf_inertia import NONE, moved, nearest, of_link

FLAT = ((0.03, 0.0, 0.0), (0.0, 0.03, 0.0), (0.0, 0.0, 0.07))


def test_the_nearest_has_the_negative_part_of_the_mass_left_out():
    """P = diag(0.035, 0.035, -0.005) becomes diag(0.035, 0.035, 0): J = diag(0.035, 0.035, 0.07)."""
    taken = of_link("a", 2.0, FLAT, "repair")
    np.testing.assert_allclose(taken.inertia, np.diag([0.035, 0.035, 0.07]), atol=1e-16)
    assert taken.change == (
        "link 'a': its principal moments (0.03, 0.03, 0.07) kg m^2, which no body has, became (0.035, 0.035, 0.07)"
    )


@pytest.mark.parametrize("seed", range(5))
def test_any_symmetric_matrix_is_repaired(seed):
    J = np.random.default_rng(seed).normal(size=(3, 3))
    found = nearest(J + J.T)
    check_inertia("J", tuple(map(tuple, found)))
    np.testing.assert_allclose(nearest(found), found, atol=1e-14)  # what a body can have stays


def test_what_a_body_can_have_is_taken_as_it_is():
    good = ((0.03, 0.001, 0.0), (0.001, 0.03, 0.0), (0.0, 0.0, 0.05))
    for how in ("refuse", "repair"):
        assert of_link("a", 2.0, good, how) == (good, "")
        assert moved("a", "j", 2.0, good, how) == (good, "")


def test_mass_without_inertia_and_the_other_way():
    taken = of_link("a", 0.0, FLAT, "repair")
    assert taken.inertia == NONE
    assert "was left out, as it has no mass" in taken.change
    ball = moved("a", "j", 2.0, NONE, "repair")
    np.testing.assert_allclose(np.diag(ball.inertia), 0.4 * 2.0 * 1e-4)
    assert "that of a ball of 1 cm" in ball.change
    with pytest.raises(ValueError, match=r"link 'a' inertia = .*inertias='repair' takes the nearest"):
        of_link("a", 2.0, FLAT, "refuse")
    with pytest.raises(ValueError, match=r"link 'a' has mass value = 2\.0 and no inertia"):
        moved("a", "j", 2.0, NONE, "refuse")
