"""The tree of two carts is the published plant."""

import numpy as np
import pytest

from pliant.studies.two_carts.machine import SCENE, blown, model, two_carts


@pytest.mark.parametrize(("m1", "m2", "k"), [(1.0, 1.0, 1.0), (0.8, 1.3, 2.0)])
def test_linear_model_is_that_of_the_paper(m1, m2, k):
    """Wie and Bernstein 1992, Eq. (1): states x1, x2, x3 = x1', x4 = x2'; here the second coordinate is x2 - x1."""
    A = np.array([[0, 0, 1, 0], [0, 0, 0, 1], [-k / m1, k / m1, 0, 0], [k / m2, -k / m2, 0, 0]])
    B = np.array([0, 0, 1 / m1, 0])
    T = np.kron(np.eye(2), [[1.0, 0.0], [-1.0, 1.0]])
    found = model(m1, m2, k)
    np.testing.assert_allclose(found.A, T @ A @ np.linalg.inv(T), atol=1e-12)
    np.testing.assert_allclose(found.B[:, 0], T @ B, atol=1e-12)
    row = found.C[[s.name for s in found.outputs].index("tip_x")]
    np.testing.assert_allclose(row, np.array([0, 1, 0, 0]) @ np.linalg.inv(T), atol=1e-12)


def test_scene_starts_with_the_blow_and_tells_the_second_carts_place():
    np.testing.assert_allclose(SCENE.initial[0], blown(2))
    assert [s.name for s in two_carts().inputs] == ["x1_force"]
    assert blown(1)[2] == 1.0 and blown(1)[2] + blown(1)[3] == 0.0  # the second stands
