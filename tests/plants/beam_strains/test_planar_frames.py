"""Places of a planar beam of strains against integrals of its own strains, and circles that are known."""

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from strained_cases import SECTION, replaced, strained, unit_states


@pytest.mark.parametrize("name", ["free", "hinged"])
def test_places_are_the_integrals_of_the_strains(name):
    plant = replaced(name, points=24)
    x = unit_states(plant, np.random.default_rng(1), 1.0)
    q, frames = ca.SX(x[: plant.nx // 2]), plant.strained_beam.frames
    strains = frames.strains

    def slope(xi, y):
        at = np.array([xi])
        bend, e, g = (float(ca.DM(strains.of(k, q, at))) for k in ("bend", "stretch", "shear_y"))
        c, s = np.cos(y[2]), np.sin(y[2])
        L = SECTION.length
        rest = float(ca.DM(frames.rest.bent(at)))
        return [L * (c * (1 + e) - s * g), L * (s * (1 + e) + c * g), bend + rest]

    start = [*x[:3]] if name == "free" else [0.0, 0.0, x[0]]
    followed = solve_ivp(slope, (0, 1), start, rtol=1e-10, atol=1e-12, dense_output=True).sol
    at = np.linspace(0, 1, 7)
    np.testing.assert_allclose(plant.positions(x, at), followed(at)[:2].T, atol=1e-8)
    y = dict(zip([s.name for s in plant.outputs], plant.measure(x)))
    rest = float(ca.DM(frames.rest.angle(np.ones(1))))
    assert y["tip_angle"] + rest == pytest.approx(followed(1.0)[2], abs=1e-8)


def test_a_ring_at_rest():
    plant = strained(rest_curvature=np.pi)  # 2 m long: a whole turn of radius 1/pi
    line = plant.positions(np.zeros(plant.nx), np.linspace(0, 1, 9))
    np.testing.assert_allclose(np.linalg.norm(line - [0, 1 / np.pi], axis=1), 1 / np.pi, atol=1e-4)
