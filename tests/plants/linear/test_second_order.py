"""Second-order form of two masses on springs, against their equations of motion written by hand."""

import dataclasses

import numpy as np
import pytest

from pliant.plants.core.signals import Signal
from pliant.plants.linear.ltv import LTVModel
from pliant.plants.linear.second_order import SecondOrderModel, from_ltv, natural_squares

M = np.diag([2.0, 0.5])
D = np.array([[0.3, -0.1], [-0.1, 0.2]])
K = np.array([[50.0, -20.0], [-20.0, 30.0]])
FORCE = np.array([[1.0], [0.0]])
T = np.linspace(0.0, 1.0, 11)


def masses(early=None):
    """M y'' + D y' + K y = FORCE u + [0, t], as dx/dt = A x + B u + c; `early` (nt, 2) enters dy/dt."""
    nt, one = len(T), np.linalg.inv(M)
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-one @ K, -one @ D]])
    B = np.vstack([np.zeros((2, 1)), one @ FORCE])
    c = np.zeros((nt, 4))
    c[:, 2:] = np.column_stack([np.zeros(nt), T]) @ one.T
    c[:, :2] = 0.0 if early is None else early
    none = {"C": np.zeros((nt, 0, 4)), "D": np.zeros((nt, 0, 1)), "F": np.zeros((nt, 0, 0)), "E": np.zeros((nt, 4, 0))}
    nominal = {"x": np.zeros((nt, 4)), "u": np.zeros((nt, 1)), "y": np.zeros((nt, 0)), "c": c}
    states = ("a", "b", "a_rate", "b_rate")
    named = {"states": states, "inputs": ("u",), "disturbances": (), "outputs": ()}
    return LTVModel(T, np.tile(A, (nt, 1, 1)), np.tile(B, (nt, 1, 1)), **none, **nominal, **named)


def test_matrices_are_those_of_the_equations_of_motion():
    form = masses().second_order(np.tile(M, (11, 1, 1)))
    for found, wanted in ((form.A, M), (form.B, D), (form.C, K), (form.Q_u, FORCE)):
        np.testing.assert_allclose(found, np.tile(wanted, (11, 1, 1)), atol=1e-12)
    np.testing.assert_allclose(form.Q, np.column_stack([np.zeros(11), T]), atol=1e-12)
    assert form.coordinates == (Signal("a", ""), Signal("b", ""))


def test_a_rate_that_is_not_the_coordinates_own_enters_with_its_derivative():
    """y' = v + e(t): y'' + .. = .. + e' + M^-1 D e, e = (t^2, 0) and e' = (2 t, 0)."""
    early = np.column_stack([T**2, np.zeros(11)])
    form = from_ltv(masses(early), np.tile(M, (11, 1, 1)))
    wanted = np.column_stack([np.zeros(11), T]) + (M @ np.column_stack([2 * T, np.zeros(11)]).T + D @ early.T).T
    np.testing.assert_allclose(form.Q, wanted, atol=1e-10)


def test_first_order_and_frozen_roots_are_those_of_the_masses():
    """det(M s^2 + D s + K) = 0."""
    form = from_ltv(masses(), np.tile(M, (11, 1, 1)))
    A, c = form.first_order()
    np.testing.assert_allclose(A, masses().A, atol=1e-12)
    np.testing.assert_allclose(c, masses().c, atol=1e-12)
    for s in form.eigenvalues(3):
        assert abs(np.linalg.det(M * s**2 + D * s + K)) < 1e-9 * np.linalg.det(K)


def test_blocks_by_name():
    n = np.arange(16.0).reshape(1, 4, 4)
    form = SecondOrderModel(
        T[:1], n, 2 * n, 3 * n, n[:, 0], ("a",) * 4, parts=(("1", (0,)), ("12", (1,)), ("m", (2, 3)))
    )
    assert form.block("A_1m").tolist() == [[[2.0, 3.0]]]
    assert form.block("B_m1").tolist() == [[[16.0], [24.0]]]
    assert form.block("C_1212").tolist() == [[[15.0]]]
    assert form.block("Q_m").tolist() == [[2.0, 3.0]]
    with pytest.raises(ValueError, match="block 'A_1x' must be"):
        form.block("A_1x")


def test_states_of_another_form_are_refused():
    model = masses()
    A = model.A.copy()
    A[:, 0, 1] = 0.5
    with pytest.raises(ValueError, match="must be coordinates and then their rates"):
        dataclasses.replace(model, A=A).second_order()


@pytest.mark.parametrize("rigid", [0.0, -3.0])
@pytest.mark.parametrize("stiffest", [1e3, 1e12, 1e25])
def test_natural_squares_keep_the_lowest_beside_the_stiffest(stiffest, rigid):
    """K = T'diag T, M = T'T with an integer T of determinant 1, so that both are exact; rounding of (omega^2 + s)^2/s,
    s about the lowest that is not zero. As it stands the eigenproblem gives the lowest no digit beside 1e25."""
    squares = np.array([rigid, 1.0, 40.0, stiffest])
    T = np.array([[1.0, 0.0, 0.0, 0.0], [2.0, 1.0, 0.0, 0.0], [1.0, -1.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
    K, M = T.T @ np.diag(squares) @ T, T.T @ T
    found, s = natural_squares(K, M), 1.0 + 2 * abs(rigid)
    eps = 64 * np.linalg.cond(M) * np.finfo(float).eps
    np.testing.assert_array_less(np.abs(found - squares), eps * np.minimum((squares + s) ** 2 / s + s, stiffest))
    assert natural_squares(np.zeros((0, 0)), np.zeros((0, 0))).shape == (0,)
    assert (natural_squares(np.zeros((2, 2)), np.eye(2)) == 0).all()
