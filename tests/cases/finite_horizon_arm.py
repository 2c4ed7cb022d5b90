"""The two-link arm of Seiler, Moore, Meissen, Arcak and Packard (Automatica 100, 2019) with its motion and its law.

Data as published with their code (demo/TwoLinkRobotArm of LTVTools): m1 = 3 kg, m2 = 2 kg, links of 0.3 m, moments of
inertia m L^2/3 about the middles, 5 s; the tip's x a spline through -0.5, -0.5, 0, 0.5, 0.5 m at 0, 0.005, 2.5, 4.995
and 5 s, y = 0.25 sin(5 x) + 0.1; Q = 100 diag(1, 1, 0.1, 0.1), R = 0.1 I, P(T) = diag(1, 1, 0.1, 0.1).
"""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from pliant.controllers.robust_analysis.robust_gain import UncertainLTV
from pliant.plants import Beam, Trajectory, TwoLinkArm

L, T = 0.3, 5.0
Q, R, END = 100 * np.diag([1.0, 1.0, 0.1, 0.1]), 0.1 * np.eye(2), np.diag([1.0, 1.0, 0.1, 0.1])


def arm(kinematics="rigid", E=7e10, modes=(0, 0)):
    """A rigid link of mass m adds m L^2/3 about its joint, the published one m L^2/3 + m L^2/4: hubs carry the rest."""

    def link(mass):
        side = 0.02
        return Beam(
            length=L,
            area=side**2,
            I_y=side**4 / 12,
            I_z=side**4 / 12,
            J=side**4 / 7,
            density=mass / L / side**2,
            E=E,
            G=E / 2.6,
        )

    keywords = (
        {"kinematics": "linear", "modes": (0, 0)}
        if kinematics == "rigid"
        else {"kinematics": kinematics, "modes": modes}
    )
    return TwoLinkArm(
        link1=link(3.0),
        link2=link(2.0),
        joint_mass=0.0,
        hub_inertia=(3 * L**2 / 4, 2 * L**2 / 4),
        gravity=0.0,
        **keywords,
    )


def motion(nodes=400):
    """t, joint angles, rates and accelerations, each (nodes, 2)."""
    t = np.linspace(0, T, nodes)
    x = CubicSpline(T * np.array([0, 0.001, 0.5, 0.999, 1]), [-0.5, -0.5, 0, 0.5, 0.5])(t)
    y = 0.25 * np.sin(5 * x) + 0.1
    second = -np.arccos((x**2 + y**2 - 2 * L**2) / (2 * L**2))
    first = np.unwrap(np.arctan2(y, x) - np.arctan2(L * np.sin(second), L + L * np.cos(second)))
    q = CubicSpline(t, np.column_stack([first, np.unwrap(second)]))
    return t, q(t), q(t, 1), q(t, 2)


def nominal(plant, nodes=400):
    """The rigid motion with the torques that make it."""
    t, q, v, a = motion(nodes)
    x = np.hstack([q, v])
    M = np.array([plant.mass_matrix(s) for s in x])
    bias = -np.einsum("kij,kj->ki", M, np.asarray(plant.dynamics(x, np.zeros((nodes, 2))))[:, 2:])
    return Trajectory.from_arrays(t, x, np.einsum("kij,kj->ki", M, a) + bias, plant=plant)


def gains(ltv):
    """K (nt, 2, 4) of the regulator of the linear model, by its Riccati differential equation."""
    A, B = CubicSpline(ltv.t, ltv.A), CubicSpline(ltv.t, ltv.B)

    def back(s, p):
        P, a, b = p.reshape(4, 4), A(T - s), B(T - s)
        return (a.T @ P + P @ a + Q - P @ b @ np.linalg.solve(R, b.T) @ P).ravel()

    found = solve_ivp(back, (0, T), END.ravel(), t_eval=T - ltv.t[::-1], rtol=1e-8, atol=1e-10, method="LSODA")
    P = found.y.T[::-1].reshape(-1, 4, 4)
    return np.linalg.solve(R, np.swapaxes(ltv.B, 1, 2) @ P)


def in_its_loop(ltv, K):
    """Delta on the second torque: v is that torque with its disturbance, w adds to it; e = both angles at the end."""
    m, n = len(ltv.t), ltv.A.shape[1]
    second = ltv.B[:, :, 1:]
    F = np.zeros((m, 1, 2))
    F[:, 0, 1] = 1
    G = np.zeros((2, n))
    G[0, 0] = G[1, 1] = 1
    return UncertainLTV(ltv.t, ltv.A - ltv.B @ K, second, ltv.B, -K[:, 1:], np.zeros((m, 1, 1)), F, G)
