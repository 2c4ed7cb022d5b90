"""A thousand arms with a thousand payloads at once, on a native kernel."""

import numpy as np

from pliant.plants import TwoLinkArm

arm = TwoLinkArm.textbook().vary("payload.mass")
mass = np.linspace(0.1, 1.0, 1024)[:, None]
step = arm.stepper(0.01, batch=1024, substeps=5)
x = np.zeros((1024, arm.nx), order="F")
x[:, 0] = -np.pi / 2  # hanging at rest
for k in range(100):
    x = step(x, 2.0 * np.sin(0.1 * k) * np.ones(2), mass, out=x)
print(f"compiled: {step.native}; theta1 after 1 s from {x[:, 0].min():.4f} to {x[:, 0].max():.4f} rad")
