"""A data sheet's craft: its free frequencies, its linear model and what no body can have.

The craft is that of Di Gennaro, "Output stabilization of flexible spacecraft with active vibration suppression", IEEE
Transactions on Aerospace and Electronic Systems 39 (3), 2003, as later papers quote it: inertia J of the whole,
coupling matrix delta, frequencies and damping ratios of four modes. (Some of them print 280 for J_yy.)
"""

import numpy as np
import pytest
import scipy.linalg as sla
from data_sheet_craft import DAMPING, DELTA, FREQUENCIES, J, craft

from pliant.plants import FlexibleSpacecraft
from pliant.plants.modal_data.modal_data import ModalData
from pliant.plants.spacecraft_parts.appendage import Appendage
from pliant.plants.spacecraft_parts.hub import Hub


@pytest.mark.parametrize("kinematics", ["linear", "stiffened"])
def test_free_frequencies_are_those_of_the_closed_form(kinematics) -> None:
    """(I - delta J^-1 delta') eta'' + diag(omega^2) eta = 0, J d(omega)/dt having been put in."""
    free = np.eye(4) - DELTA @ np.linalg.solve(J, DELTA.T)
    wanted = np.sqrt(sla.eigh(np.diag(np.square(FREQUENCIES)), free, eigvals_only=True))
    assert craft(kinematics).natural_frequencies() == pytest.approx(wanted, rel=1e-12)


def test_translation_too_and_a_centre_off_the_hub() -> None:
    """All six directions, from the closed form M_rr [v; w]' + L' eta'' = 0 of the whole about the hub's centre."""
    rng = np.random.default_rng(0)
    L, omega = (
        np.hstack([0.8 * rng.standard_normal((3, 3)), 1.5 * rng.standard_normal((3, 3))]),
        np.array([1.0, 2.0, 5.0]),
    )
    d, I, at = np.array([0.5, 0.2, -0.1]), np.diag([30.0, 40.0, 50.0]), np.array([1.0, -0.5, 0.3])
    body = ModalData.from_participation(20.0, d, I, omega, 0.0, L[:, :3], L[:, 3:])
    hub = Hub(mass=100.0, inertia=(60.0, 70.0, 80.0))
    whole = FlexibleSpacecraft(hub=hub, appendages=(Appendage(position=tuple(at), body=body),), kinematics="linear")

    def cross(a):
        return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])

    move = np.block([[np.eye(3), -cross(at)], [np.zeros((3, 3)), np.eye(3)]])  # the body's origin from the hub's motion
    M = np.block([[20.0 * np.eye(3), -20.0 * cross(d)], [20.0 * cross(d), I]])
    M = move.T @ M @ move + sla.block_diag(100.0 * np.eye(3), np.diag([60.0, 70.0, 80.0]))
    free = np.eye(3) - L @ move @ np.linalg.solve(M, move.T @ L.T)
    wanted = np.sqrt(sla.eigh(np.diag(omega**2), free, eigvals_only=True))
    assert whole.natural_frequencies() == pytest.approx(wanted, rel=1e-12)


def test_its_linear_model_is_the_equation_of_the_data_sheet() -> None:
    """J d(omega)/dt + delta' eta'' = torque, eta'' + 2 zeta omega eta' + omega^2 eta = -delta d(omega)/dt."""
    whole = craft()
    model = whole.feedback_model(whole.state())
    M = np.block([[J, DELTA.T], [DELTA, np.eye(4)]])
    rates = [model.state_names.index(f"rate_{c}") for c in "xyz"]
    moving = rates + [model.state_names.index(f"eta1_{k}_rate") for k in range(1, 5)]
    assert M @ model.B[moving] == pytest.approx(np.eye(7, 3), abs=1e-12)
    eta = [model.state_names.index(f"eta1_{k}") for k in range(1, 5)]
    wanted = -np.vstack([np.zeros((3, 4)), np.diag(np.square(FREQUENCIES))])
    assert M @ model.A[np.ix_(moving, eta)] == pytest.approx(wanted, abs=1e-12)
    damped = -np.vstack([np.zeros((3, 4)), np.diag(2 * np.array(DAMPING) * FREQUENCIES)])
    assert M @ model.A[np.ix_(moving, moving[3:])] == pytest.approx(damped, abs=1e-12)


def test_a_rigid_body_has_what_it_is_given() -> None:
    body = ModalData.rigid(3.0, (0.3, 0.0, 0.6), np.diag([2.0, 3.0, 4.0]))
    assert body.n == 0 and body.inertia == pytest.approx(np.diag([2.0, 3.0, 4.0])) and body.centre[2] == 0.6 / 3


def test_its_root_is_clamped_and_its_mass_centre_moves_as_the_factors_say() -> None:
    """int (r + sum phi_k eta_k) dm / m, of which int phi_k dm is L_translation."""
    rng = np.random.default_rng(1)
    L = 0.5 * rng.standard_normal((2, 6))
    body = ModalData.from_participation(20.0, (0.5, 0.2, -0.1), 40.0 * np.eye(3), (1.0, 2.0), 0.0, L[:, :3], L[:, 3:])
    assert not body.outline_shapes[:, 0].any() and not body.outline[0].any()
    assert body.tip_shapes == pytest.approx(L[:, :3] / 20.0, rel=1e-14) and body.tip == pytest.approx(body.centre)
    assert (body.outline_shapes[:, 1] == body.tip_shapes).all()


def test_a_first_moment_in_place_of_the_centre_is_told() -> None:
    """11 kg at 1.1 m, given as 12.1: the inertia about the root is less than 11 kg at 12.1 m have."""
    I, factors = np.diag([14.0, 0.8, 14.5]), (np.zeros((1, 3)), np.ones((1, 3)))
    with pytest.raises(ValueError, match=r"inertia = .* too small for 11 kg whose centre is at \[0.0, 12.1, 0.0\] m"):
        ModalData.from_participation(11.0, (0.0, 12.1, 0.0), I, [1.0], 0.0, *factors)
    with pytest.raises(ValueError, match=r"ModalData.rigid.inertia = .* too small"):
        ModalData.rigid(11.0, (0.0, 133.1, 0.0), I)


def test_a_mode_may_take_all_of_the_mass_and_no_more() -> None:
    """A point mass of 3 kg on a spring: L = sqrt(3) kg^0.5, which rounded up to seven digits is 1.3e-7 too much."""

    def sprung(L):
        return ModalData.from_participation(3.0, (0, 0, 0), np.eye(3), (1.0,), 0.0, [[0, 0, L]], [[0, 0, 0]])

    assert sprung(np.sqrt(3.0)).R[0, 2] == np.sqrt(3.0) and sprung(1.732050).n == 1
    with pytest.raises(ValueError, match=r"the modes take 1\.0000002 times"):
        sprung(1.732051)


def test_what_no_body_can_have_is_told() -> None:
    with pytest.raises(ValueError, match=r"take .* times what mass or inertia"):
        ModalData.from_participation(100.0, (0, 0, 0), J / 10, FREQUENCIES, DAMPING, None, DELTA)
    with pytest.raises(ValueError, match=r"no principal moment above the sum .* give more of the craft"):
        ModalData.from_participation(100.0, (0, 0, 0), DELTA.T @ DELTA, FREQUENCIES, DAMPING, None, DELTA)
    with pytest.raises(ValueError, match="frequencies"):
        ModalData.from_participation(100.0, (0, 0, 0), J, (-1.0, 1.0, 1.0, 1.0), DAMPING, None, DELTA)
    with pytest.raises(ValueError, match="L_rotation"):
        ModalData.from_participation(100.0, (0, 0, 0), J, FREQUENCIES, DAMPING, None, DELTA.T)
