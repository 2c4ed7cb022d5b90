"""Designs of what is conserved: against closed forms and SciPy on the part that inputs steer."""

import conserved as campaign
import numpy as np
import pytest
from scipy.linalg import solve_continuous_are

from pliant.controllers import LQR
from pliant.controllers.riccati.steerable import steerable
from pliant.plants import LinearModel, UncontrollableError

J, WHEEL, DRAG = 2.0, 0.1, 0.03  # hub, wheel [kg m^2], bearing [N m s]


def hub(friction=0.0, wheels=1):
    """J w' = sum of u + f (h / I - w), h' = -(that)."""
    A = np.zeros((2 + wheels, 2 + wheels))
    B = np.zeros((2 + wheels, wheels))
    A[0, 1] = 1.0
    for k in range(wheels):
        on_hub = np.zeros(2 + wheels)
        on_hub[1], on_hub[2 + k] = -friction, friction / WHEEL
        A[1] += on_hub / J
        A[2 + k] -= on_hub
        B[1, k], B[2 + k, k] = 1 / J, -1.0
    names = ["angle", "rate", *(f"h{k + 1}" for k in range(wheels))]
    return LinearModel.from_matrices(A, B, states=names)


def test_the_gain_of_a_double_integrator():
    """K = J [a^2, sqrt(2) a / sqrt(J) ..]: of J w'' = u with q angle^2 + r u^2, K1 = sqrt(q / r), K2 = sqrt(2 J K1)
    (Anderson and Moore 1990); P from its Riccati equation: P12 = J sqrt(q r)."""
    q, r = 9.0, 0.25
    law = LQR.design(hub(), {"angle": q}, [[r]])
    first = np.sqrt(q / r)
    np.testing.assert_allclose(law.K, [[first, np.sqrt(2 * J * first), 0.0]], rtol=1e-9, atol=1e-12)
    assert law.P[0, 1] == pytest.approx(J * np.sqrt(q * r)) and not law.P[2].any()
    assert len(law.conserved) == 1 and "rate" in law.conserved[0] and "h1" in law.conserved[0] and law.free == ()
    assert len(law.poles) == 2 and law.poles.real.max() < 0


@pytest.mark.parametrize("wheels", [2, 3])
def test_more_wheels_than_needed_share_the_torque_and_a_free_spin(wheels):
    """The least effort is the same torque on each, so K is that of one wheel with r / wheels, over wheels."""
    one = LQR.design(hub(), {"angle": 1.0}, [[1.0 / wheels]])
    law = LQR.design(hub(wheels=wheels), {"angle": 1.0}, np.eye(wheels))
    np.testing.assert_allclose(law.K[:, :2], np.tile(one.K[0, :2] / wheels, (wheels, 1)), rtol=1e-9)
    np.testing.assert_array_equal(law.K[:, 2:], 0.0)
    assert len(law.conserved) == 1 and len(law.free) == wheels - 1
    assert law.cost_to_go(np.eye(2 + wheels)[0]) == pytest.approx(one.cost_to_go(np.eye(3)[0]), rel=1e-9)


@pytest.mark.parametrize("dt", [None, 0.05])
def test_friction_is_held_at_the_momentum_that_there_is(dt):
    """On w'x = 0, h = -J w, so J w' = u - f (J / I + 1) w: SciPy solves that. With another momentum the angle still
    comes home, though the wheel's friction has to be paid for."""
    model = hub(DRAG)
    law = LQR.design(model, {"angle": 4.0, "rate": 1.0}, [[0.5]], dt=dt)
    if dt is None:
        d = DRAG * (J / WHEEL + 1) / J
        A, B = np.array([[0.0, 1.0], [0.0, -d]]), np.array([[0.0], [1 / J]])
        P = solve_continuous_are(A, B, np.diag([4.0, 1.0]), [[0.5]])
        x = np.array([0.3, -0.2, 0.2 * J])  # no momentum in all
        assert law.cost_to_go(x) == pytest.approx(x[:2] @ P @ x[:2], rel=1e-9)
        np.testing.assert_allclose(law.K @ x, B.T @ P @ x[:2] / 0.5, rtol=1e-9)
    closed = (model if dt is None else model.discretize(dt)).A - (
        model if dt is None else model.discretize(dt)
    ).B @ law.K
    step = np.linalg.matrix_power(closed, 4000) if dt is not None else None
    end = step @ [0.0, 0.0, 1.0] if dt is not None else _settled(closed, [0.0, 0.0, 1.0])
    np.testing.assert_allclose(end, [0.0, 0.0, 1.0], atol=1e-6)


def _settled(A, x):
    """Where x' = A x ends: the projection on the eigenvalue 0."""
    values, left, right = np.linalg.eig(A.T)[0], *(np.linalg.eig(M)[1] for M in (A.T, A))
    k, own = int(np.argmin(np.abs(values))), np.linalg.eigvals(A)
    assert np.sort(values.real)[-2] < 0
    v, w = right[:, int(np.argmin(np.abs(own)))].real, left[:, k].real
    return v * (w @ x) / (w @ v)


def test_a_momentum_that_is_weighed_is_refused_but_where_it_is_the_goals():
    model, Q = hub(), {"angle": 1.0, "rate": 1.0, "h1": 1.0}
    with pytest.raises(UncontrollableError, match=r"h1.*costs without end") as caught:
        LQR.design(model, Q, [[1.0]])
    assert len(caught.value.modes) == 1
    with pytest.raises(UncontrollableError, match="as the start has"):
        LQR.design(model, Q, [[1.0]], start=[0.5, 0.0, 1.0])
    law = LQR.design(model, Q, [[1.0]], start=[0.5, 0.1, -0.1 * J])
    P = solve_continuous_are([[0.0, 1.0], [0.0, 0.0]], [[0.0], [1 / J]], np.diag([1.0, 1.0 + J**2]), [[1.0]])
    assert law.cost_to_go([0.5, 0.1, -0.1 * J]) == pytest.approx(np.array([0.5, 0.1]) @ P @ [0.5, 0.1], rel=1e-9)
    assert law.cost_to_go([0.5, 0.1, 0.0]) == np.inf


def test_integrals_and_units_do_not_matter():
    model = hub()
    law = LQR.design(model, {"angle": 1.0}, [[1.0]], dt=0.1, integral={"angle": 0.5})
    bare = LinearModel.from_matrices(model.A[:2, :2], model.B[:2], states=["angle", "rate"])
    wanted = LQR.design(bare, {"angle": 1.0}, [[1.0]], dt=0.1, integral={"angle": 0.5})
    np.testing.assert_allclose(np.delete(law.K, 2, axis=1), wanted.K, rtol=1e-9)
    unit = np.diag([1.0, 1.0, 1e9])
    wide = LinearModel.from_matrices(unit @ model.A @ np.linalg.inv(unit), unit @ model.B, states=model.state_names)
    scaled = LQR.design(wide, {"angle": 1.0}, [[1.0]], dt=0.1, integral={"angle": 0.5})
    np.testing.assert_allclose(scaled.K, law.K, rtol=1e-9, atol=1e-15)


def test_a_free_base_that_no_cost_weighs():
    """Two masses and a force between them: the gain is that of the distance, m / 2 on a double integrator."""
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [np.zeros((2, 4))]])
    C = np.array([[1.0, -1.0, 0.0, 0.0]])
    model = LinearModel.from_matrices(A, [[0.0], [0.0], [1.0], [-1.0]], C, outputs=["distance"])
    law = LQR.design(model, {"distance": 4.0}, [[1.0]])
    np.testing.assert_allclose(law.K, [[2.0, -2.0, np.sqrt(2.0), -np.sqrt(2.0)]], rtol=1e-9)
    assert len(law.conserved) == 2 and law.poles.real.max() < 0


def test_what_conserves_nothing_is_left_alone():
    A, B = np.array([[0.0, 1.0], [-1.0, -0.1]]), np.array([[0.0], [1.0]])
    part = steerable(A, B, np.eye(2), np.zeros((2, 1)), ("a", "b"))
    assert part.names == ("a", "b") and part.conserved == part.free == ()
    np.testing.assert_array_equal(part.system(A, B)[0], A)
    np.testing.assert_array_equal(part.gain(np.array([[1.0, 2.0, 3.0]])), [[1.0, 2.0, 3.0]])


def test_a_sample_of_the_campaign():
    """tests/campaigns/conserved.py, where `make campaign` runs a thousand."""
    rows = [campaign.run(seed) for seed in range(20)]
    assert not [row for row in rows if campaign.faulty(row)] and len(campaign.summary(rows)) > 20
