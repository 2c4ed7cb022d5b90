"""Every kind of body that bends: what holds of its kinetic energy and its sections, whatever it is."""

import casadi as ca
import numpy as np
import pytest

from pliant.plants import Beam, ModalData
from pliant.plants.elastic_bodies.bent_beam import BentBeam
from pliant.plants.elastic_bodies.elastic_body import ElasticBody
from pliant.plants.elastic_bodies.modal_body import ModalBody
from pliant.plants.elastic_bodies.strain_beam import StrainBeam
from pliant.plants.multibody_parts.spatial import Motion
from pliant.plants.multibody_parts.tree_beam import TreeBeam

BEAM = Beam(length=1.3, area=2e-4, I_y=3e-9, I_z=5e-9, J=6e-9, density=2700.0, E=7e10, G=2.7e10)
KINDS = {
    "linear": BentBeam(TreeBeam(BEAM, (2, 1, 1, 1), "polynomial", False)),
    "stiffened": BentBeam(TreeBeam(BEAM, (2, 1, 1, 1), "polynomial", True)),
    "strain": StrainBeam(TreeBeam(BEAM, (2, 1, 1, 1), "polynomial", True)),
    "modes": ModalBody(ModalData.panel(BEAM, width=0.3, modes=(2, 1)), True),
}


def energy(body, eta, rate, v, omega):
    """T = m v^2/2 + v.(omega x S + S') + omega.J omega/2 + omega.H + eta'.M eta'/2."""
    I, M = body.inertia(eta), body.mass(eta)
    P = I.matrix()
    T = I.m * ca.dot(v, v) / 2 + ca.dot(v, ca.cross(omega, I.S)) + ca.dot(rate, M @ rate) / 2
    T += (ca.trace(P) * ca.dot(omega, omega) - ca.dot(omega, P @ omega)) / 2
    for k, one in enumerate(body.coupling(eta)):
        T += rate[k] * (ca.dot(v, one.f) + ca.dot(omega, one.n))
    return T


@pytest.mark.parametrize("kind", KINDS)
def test_forces_are_lagranges_in_quasi_coordinates(kind):
    """f = d/dt T_v + omega x T_v, n = d/dt T_omega + omega x T_omega + v x T_v, Q = d/dt T_rate - T_eta, at zero
    accelerations of the coordinates; by differentiating T.
    """
    body: ElasticBody = KINDS[kind]
    n = body.n
    eta, rate, v, omega = (ca.SX.sym(s, m) for s, m in (("eta", n), ("rate", n), ("v", 3), ("omega", 3)))
    a, alpha = ca.SX.sym("a", 3), ca.SX.sym("alpha", 3)
    T = energy(body, eta, rate, v, omega)
    p, h, modal = ca.gradient(T, v), ca.gradient(T, omega), ca.gradient(T, rate)
    where = ca.vertcat(eta, v, omega)
    moving = ca.vertcat(rate, a - ca.cross(omega, v), alpha)  # a: of the root in inertial space, in the body's axes
    p_rate, h_rate, modal_rate = (ca.jtimes(e, where, moving) for e in (p, h, modal))
    motion = Motion(omega, alpha, a)
    load, Q = body.inertial(motion, motion.U, eta, rate)
    gaps = [
        load.f - p_rate - ca.cross(omega, p),
        load.n - h_rate - ca.cross(omega, h) - ca.cross(v, p),
        Q - modal_rate + ca.gradient(T, eta),
    ]
    found = ca.Function("f", [eta, rate, v, omega, a, alpha], [ca.vertcat(*gaps), load.n])
    rng = np.random.default_rng(0)
    given = [0.1 * rng.normal(size=n), *(rng.normal(size=m) for m in (n, 3, 3, 3, 3))]
    gap, size = (np.array(e) for e in found(*given))
    np.testing.assert_allclose(gap, 0.0, atol=1e-12 * np.abs(size).max() + 1e-13)


@pytest.mark.parametrize("kind", KINDS)
def test_sections_move_as_their_derivatives_say(kind):
    body = KINDS[kind]
    eta, rate = ca.SX.sym("eta", body.n), ca.SX.sym("rate", body.n)
    at = body.section("tip" if kind == "modes" else 0.7, eta, rate)
    shift_rate, turn_rate = ca.jtimes(at.shift, eta, rate), ca.jtimes(at.turn, eta, rate)
    twist = ca.SX(0) if at.twist_bias is None else at.twist_bias
    gaps = ca.vertcat(
        at.shift_rate - shift_rate, at.turn_rate - turn_rate, at.shift_bias - ca.jtimes(shift_rate, eta, rate),
        ca.vertcat(twist, 0, 0) - ca.jtimes(turn_rate, eta, rate), at.T @ rate - ca.vertcat(shift_rate, turn_rate),
    )  # fmt: skip
    rng = np.random.default_rng(1)
    found = ca.Function("f", [eta, rate], [gaps])(0.2 * rng.normal(size=body.n), rng.normal(size=body.n))
    np.testing.assert_allclose(np.array(found), 0.0, atol=1e-13)
