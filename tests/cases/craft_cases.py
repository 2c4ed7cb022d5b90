"""Spacecraft with random bodies, mountings and hinges, and rigid motions of them, by seed."""

import dataclasses

import numpy as np
from scipy.integrate import solve_ivp

from pliant.plants import Trajectory
from pliant.plants.core.quaternions import matrix_of, product, rates
from pliant.plants.modal_data.modal_data import ModalData
from pliant.plants.spacecraft.plant import FlexibleSpacecraft
from pliant.plants.spacecraft_parts.appendage import Appendage, Hinge
from pliant.plants.spacecraft_parts.hub import Hub
from pliant.plants.spacecraft_perturbation.perturbation import RigidNominal

TEXTBOOK = dataclasses.replace(FlexibleSpacecraft.textbook(), kinematics="linear")


def unit(v):
    return tuple(v / np.linalg.norm(v))


def craft(kinematics, freedoms, seed=1, principal=False):
    """Random bodies, mountings and hinges."""
    rng = np.random.default_rng(seed)

    def body():
        g = rng.normal(size=(2, 2, 9, 3))
        return ModalData.from_nodes(
            rng.normal(size=(9, 3)),
            rng.uniform(0.5, 2, 9),
            rng.normal(size=(2, 9, 3)),
            stiffness=np.diag(rng.uniform(1, 3, 2)),
            damping=0.02,
            shortening=(g + g.swapaxes(0, 1)) / 2,
        )

    parts = tuple(
        Appendage(
            position=tuple(rng.normal(size=3)),
            orientation=tuple(rng.normal(size=4)),
            body=body(),
            damping=0.01,
            hinge=Hinge(axes=tuple(unit(rng.normal(size=3)) for _ in range(n)), stiffness=3.0, damping=0.3),
        )
        for n in freedoms
    )
    root = rng.normal(size=(3, 3))
    spread = root @ root.T + 1.5 * np.eye(3)  # int r r^T dm
    inertia = (3.0, 4.0, 5.0) if principal else np.trace(spread) * np.eye(3) - spread
    return FlexibleSpacecraft(hub=Hub(mass=5.0, inertia=inertia), appendages=parts, kinematics=kinematics)


def random_nominal(made, seed=2):
    """(x, accelerations, RigidNominal of one time) with random rates and accelerations, elastic coordinates zero."""
    rng, at = np.random.default_rng(seed), made.layout
    x, a = rng.normal(size=made.nx), rng.normal(size=6 + len(made.coordinates))
    x[at.quaternion] /= np.linalg.norm(x[at.quaternion])
    first = at.quaternion.stop - 6
    for s, r in zip(at.modes, at.mode_rates):
        x[s] = x[r] = a[s.start - first : s.stop - first] = 0.0
    R = matrix_of(x[at.quaternion])
    turns = [a[s.start - first : s.stop - first] for s in at.hinges]
    nominal = RigidNominal(
        np.array([0.0]),
        x[None, at.quaternion],
        x[None, at.omega],
        a[None, 3:6],
        (R @ a[:3])[None],
        tuple(x[None, s] for s in at.hinges),
        tuple(x[None, s] for s in at.hinge_rates),
        tuple(t[None] for t in turns),
    )
    return x, a, nominal


def quintic(t, end=8.0):
    """From 0 to 1 with rates and accelerations zero at both ends, and two derivatives."""
    s = np.asarray(t) / end
    return (
        10 * s**3 - 15 * s**4 + 6 * s**5,
        (30 * s**2 - 60 * s**3 + 30 * s**4) / end,
        (60 * s - 180 * s**2 + 120 * s**3) / end**2,
    )


def slew(made, t):
    """A rigid three-axis slew with hinges turning, as another program would give it: the body rates are prescribed."""
    at, size = made.layout, np.array([1.6, -1.0, 1.2])
    g, dg, ddg = quintic(t)
    weights = np.column_stack([1 + 0 * g, 1 + 0.5 * g, 1 - 0.3 * g])  # the axis wanders
    slopes = np.column_stack([0 * g, 0.5 * dg, -0.3 * dg])
    omegas, alphas = size * weights * dg[:, None], size * (weights * ddg[:, None] + slopes * dg[:, None])

    def spin(s, q):
        g, dg, _ = quintic(s)
        return rates(q) @ (size * np.array([1, 1 + 0.5 * g, 1 - 0.3 * g]) * dg) / 2

    quaternions = solve_ivp(spin, (t[0], t[-1]), [1.0, 0, 0, 0], t_eval=t, rtol=1e-12, atol=1e-14).y.T
    x, dx = np.zeros((len(t), made.nx)), np.zeros((len(t), made.nx))
    x[:, at.quaternion] = quaternions / np.linalg.norm(quaternions, axis=1)[:, None]
    x[:, at.omega], dx[:, at.omega] = omegas, alphas
    dx[:, at.quaternion] = np.einsum("tij,tj->ti", rates(x[:, at.quaternion]), x[:, at.omega]) / 2
    for s, r in zip(at.hinges, at.hinge_rates):
        x[:, s], x[:, r], dx[:, r] = (0.5 * v[:, None] for v in (g, dg, ddg))
        dx[:, s] = x[:, r]
    return Trajectory.from_arrays(t, x, np.zeros((len(t), made.nu)), plant=made, dx=dx)


def deviations(made, nominal, x):
    """[y, dy/dt] of states x (nt, nx) from a nominal, not linearised in the turn."""
    at = made.layout
    q0, q1 = nominal.x[:, at.quaternion], x[:, at.quaternion]
    back = q0 * [1, -1, -1, -1]
    turn = product(back, q1)
    out = np.delete(x - nominal.x, at.quaternion.start, axis=1)
    q = 2 * turn[:, 1:] * np.sign(turn[:, :1])
    out[:, at.quaternion.start : at.quaternion.stop - 1] = q
    out[:, at.omega.start - 1 : at.omega.stop - 1] -= np.cross(nominal.x[:, at.omega], q)
    return out


def motor_hinged(factor=1.0):
    hinge = Hinge(axes=((0.0, 1.0, 0.0),), drive="torque", damping=0.5, stiffness=20.0)
    parts = (
        dataclasses.replace(TEXTBOOK.appendages[0], hinge=hinge, damping=0.01, stiffness_factor=factor),
        dataclasses.replace(TEXTBOOK.appendages[1], damping=0.01, stiffness_factor=factor),
    )
    return dataclasses.replace(TEXTBOOK, appendages=parts, translation=False)
