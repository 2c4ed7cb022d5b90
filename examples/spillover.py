"""Before any simulation: does a loop designed on two bending modes hold on finer models, and if not, what does?"""

import dataclasses

import numpy as np

from pliant.controllers import LQR, spillover
from pliant.plants import SingleLinkArm

arm = SingleLinkArm.textbook()
arm = dataclasses.replace(arm, link=dataclasses.replace(arm.link, damping=2e-6), basis="clamped-free")
finer = [dataclasses.replace(arm, modes=n) for n in (3, 4, 6)]
model = arm.linearize(np.zeros(arm.nx))


def design(effort: float) -> LQR:
    """Sampled at 500 Hz; the torque costs `effort` times next to nothing."""
    weights = {"hub_angle": 10.0, "tip_deflection": 100.0, "tip_deflection_rate": 0.1}
    return LQR.design(model, weights, {"hub_torque": 2e-9 * effort}, dt=0.002)


report = spillover(design(1.0), [arm, *finer], {"hub_angle": 0.0}, redesign=design)
print(report.verdict)
again = spillover(report.controller, [arm, *finer], {"hub_angle": 0.0})
print(again.verdict)
print(f"bandwidth {report.bandwidth_hz:.1f} Hz asked, {report.allowed_hz:.1f} Hz allowed")
