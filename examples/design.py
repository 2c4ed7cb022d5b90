"""From parameters to a controller for a two-link elastic arm, in ten lines of design."""

import dataclasses

import numpy as np

from pliant.controllers import LQR
from pliant.plants import TwoLinkArm

arm = dataclasses.replace(TwoLinkArm.textbook(), kinematics="stiffened", basis="payload", hub_inertia=(0.1, 0.02))
x0, u0 = arm.equilibrium(theta1=-0.9, theta2=0.6)  # hold the arm up against gravity
plant = arm.linearize(x0, u0)  # exact, by automatic differentiation
print(*plant.modes(), sep="\n")
lqr = LQR.design(plant, Q={"tip_x": 100.0, "tip_y": 100.0, "theta1": 10.0}, R={"tau1": 0.01, "tau2": 0.01}, dt=0.01)
motion = arm.simulate(arm.equilibrium(theta1=-1.0, theta2=0.5)[0], lqr, np.linspace(0.0, 5.0, 501))
error = np.hypot(motion["tip_x"] - motion["tip_x"][-1], motion["tip_y"] - motion["tip_y"][-1])
print(f"tip within {error[300:].max() * 1e3:.2f} mm after 3 s")
