"""Nonlinear predictive control of a two-link elastic arm: lift a payload, its bend and its torques bounded."""

import numpy as np

from pliant.controllers import NMPC, Objective
from pliant.envs import scenes

arm = scenes.get("two-link-reach").plant  # damped links, motors with inertia, gravity, 0.5 kg at the tip
start, _ = arm.equilibrium(theta1=-np.pi / 2, theta2=0.0)
x_goal, u_goal = arm.equilibrium(theta1=-0.9, theta2=0.6)
objective = Objective(
    plant=arm,
    x_goal=x_goal,
    u_goal=u_goal,
    weights={"theta1": 10.0, "theta2": 10.0, "theta1_rate": 0.1, "theta2_rate": 0.1},
    effort={"tau1": 2e-3, "tau2": 2e-3},
    dt=0.02,
    limits={"tau1": (-40.0, 40.0), "tau2": (-15.0, 15.0)},
    bounds={"tip1_deflection": (-0.1, 0.1)},  # 0.14 m without; 0.08 m is the sag at the goal
)
nmpc = NMPC(objective, horizon=30, starts=(start,))  # 0.6 s, and the cost-to-go beyond
motion = arm.simulate(start, nmpc, np.arange(0.0, 2.5001, 0.02), rtol=1e-7, atol=1e-9)
goal = arm.measure(x_goal, u_goal)
names = [signal.name for signal in arm.outputs]
missed = np.hypot(*(motion[name][-1] - goal[names.index(name)] for name in ("tip_x", "tip_y")))
u, bend = np.abs(motion.u).max(axis=0), np.abs(motion["tip1_deflection"]).max()
print(f"largest torques {u[0]:.1f} and {u[1]:.1f} N m; largest bend {1e3 * bend:.1f} mm")
print(f"tip {1e3 * missed:.2f} mm from its goal after 2.5 s; programs without solution: {nmpc.record.failures}")
print(f"last act: feedback {1e6 * nmpc.record.feedback:.0f} us, preparation {1e6 * nmpc.record.preparation:.0f} us")
