"""A driven hub with one elastic mode, weights and states for its predictive control, and the loop played."""

import dataclasses

import numpy as np

from pliant.plants.linear.lti import LinearModel

DT = 0.05
M2, K2, D2 = np.array([[2.0, 0.6], [0.6, 1.0]]), np.diag([0.0, 158.0]), np.diag([0.1, 0.25])
A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(M2, K2), -np.linalg.solve(M2, D2)]])
B = np.vstack([np.zeros((2, 2)), np.linalg.solve(M2, [[1.0, 0.2], [0.0, 0.5]])])
C = np.array([[1.0, 0.8, 0, 0], [0, 1.0, 0, 0]])  # tip, bend
LINK = LinearModel.from_matrices(
    A, B, C, states=["theta", "q", "omega", "v"], inputs=["torque", "piezo"], outputs=["tip", "bend"]
)  # a driven hub with one elastic mode, 2 Hz
Q, R = {"tip": 40.0, "theta": 5.0, "omega": 0.5}, {"torque": 0.02, "piezo": 0.05}
STATES = np.random.default_rng(3).uniform(-1, 1, (40, 4)) * [0.6, 0.05, 0.5, 0.5]


def plan(controller):
    """Inputs that the controller plans, (N, nu)."""
    return controller.plan.inputs()


def roll(controller, x, steps, *, disturbance=0.0, model=LINK, read=None):
    """States (steps+1, 4) and inputs (steps, 2) of the linear model with a constant force on each input."""
    sampled = model.discretize(DT)
    controller.reset()
    xs, us = [np.array(x, dtype=float)], []
    for k in range(steps):
        us.append(controller.act(k * DT, xs[-1] if read is None else read @ xs[-1]))
        xs.append(sampled.A @ xs[-1] + sampled.B @ (us[-1] + disturbance))
    return np.array(xs), np.array(us)


POINT, HELD = np.array([0.7, 0.0, 0.0, 0.0]), np.array([0.3, -0.2])


def moved(model):
    """The same machine about another point, where inputs hold it."""
    return dataclasses.replace(model, x0=POINT, u0=HELD, y0=C @ POINT)
