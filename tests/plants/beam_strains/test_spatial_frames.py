"""Frames of a spatial beam of strains against integration of its curvatures, and spins against moved frames."""

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from strained_cases import SECTION, replaced, strained, unit_states

from pliant.plants.core.quaternions import matrix_of

PLANT = replaced("space", points=24, modes=2, twists=2)


def followed(plant, q):
    """(places and axes) (12,) at xi of the coordinates' strains."""
    frames = plant.strained_beam.frames
    strains = frames.strains

    def slope(xi, y):
        at, R = np.array([xi]), y[3:].reshape(3, 3)
        one = {kind: strains.rows(kind, at)[0] @ q[own] for kind, own in strains.slices.items() if kind != "root"}
        k = [one[kind] for kind in ("twist", "flap", "bend")]
        k[2] += float(ca.DM(frames.rest.bent(at)))
        onward = [one[kind] for kind in ("stretch", "shear_y", "shear_z")]
        K = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
        return np.concatenate([SECTION.length * R @ (np.array(onward) + np.eye(3)[0]), (R @ K).ravel()])

    h = q[strains.turns] if strains.turns >= 0 else 0.0
    start = np.array([[np.cos(h), -np.sin(h), 0], [np.sin(h), np.cos(h), 0], [0, 0, 1]])
    options = {"method": "DOP853", "rtol": 1e-9, "atol": 1e-11, "dense_output": True}
    return solve_ivp(slope, (0, 1), np.concatenate([np.zeros(3), start.ravel()]), **options).sol


@pytest.mark.parametrize("plant", [PLANT, replaced("space segments", points=14)], ids=["one", "segments"])
def test_frames_and_places_are_the_integrals_of_the_strains(plant):
    """On segments the strains jump between points."""
    x = unit_states(plant, np.random.default_rng(1), 1.0)
    q, frames = x[: plant.nx // 2], plant.strained_beam.frames
    known, xi = followed(plant, q), np.append(frames.along.xi, 1.0)
    symbol = ca.SX.sym("q", len(q))
    turned = frames.quaternions(symbol)[0]
    found = ca.Function("f", [symbol], [ca.horzcat(*[turned[k] for k in frames.at_points])])(q)
    got = matrix_of(np.asarray(found).T)
    np.testing.assert_allclose(got, known(xi)[3:].T.reshape(-1, 3, 3), atol=1e-7)
    at = np.linspace(0, 1, 6)
    np.testing.assert_allclose(plant.positions(x, at), known(at)[:3].T, atol=1e-7)


def test_a_beam_winds_up_as_often_as_it_likes():
    """Seven turns of curvature kappa and twist tau: a helix of pitch 2 pi tau/(kappa^2 + tau^2)."""
    plant = strained(planar=False, rest_curvature=14.0, twists=1, points=40, modes=1, tip_loads=("moment",))
    x = np.zeros(plant.nx)
    x[[s.name for s in plant.coordinates].index("twist1")] = 2 * 3.0  # over 2 m
    omega = np.hypot(14.0, 3.0)
    axis = np.array([3.0, 0.0, 14.0]) / omega
    tip = 2 * axis * axis[0] + np.sin(2 * omega) / omega * (np.array([1, 0, 0]) - axis * axis[0])
    tip = tip + (1 - np.cos(2 * omega)) / omega * np.cross(axis, [1, 0, 0])
    assert 2 * omega / (2 * np.pi) > 4.5
    np.testing.assert_allclose(plant.positions(x, [1.0])[0], tip, atol=1e-9)


def test_spins_are_those_of_moved_frames():
    x = unit_states(PLANT, np.random.default_rng(2), 1.0)
    n, frames = PLANT.nx // 2, PLANT.strained_beam.frames
    q, v = ca.SX.sym("q", n), ca.SX.sym("v", n)
    motion = frames.at(q, v)
    found = ca.Function("f", [q, v], [motion.frame, motion.turning @ v, motion._w[-1]])
    h = 1e-6
    back, ahead = (np.asarray(found(x[:n] + s * h * x[n:], x[n:])[0]) for s in (-1, 1))
    R, by_rows, by_steps = (np.asarray(e) for e in found(x[:n], x[n:]))
    S = (ahead - back) / (2 * h) @ R.T
    np.testing.assert_allclose(by_rows.ravel(), [S[2, 1], S[0, 2], S[1, 0]], atol=1e-8)
    np.testing.assert_allclose(by_steps, by_rows, atol=1e-12)


@pytest.mark.parametrize("twists", [0, 2])
def test_the_twist_of_the_tip_is_the_integral_of_the_twist(twists):
    plant = strained(planar=False, twists=twists, extensible=True)
    x = unit_states(plant, np.random.default_rng(3))
    y = dict(zip([s.name for s in plant.outputs], plant.measure(x)))
    names = [s.name for s in plant.coordinates]
    assert y["tip_twist"] == (pytest.approx(x[names.index("twist1")]) if twists else 0.0)
