"""A bang-bang slew of an elastic arm leaves it vibrating; the same slew through a ZVD shaper does not."""

import numpy as np

from pliant.controllers.joint_control.input_shaping import shape, shaper_for
from pliant.plants import SingleLinkArm

arm = SingleLinkArm.textbook()
model = arm.linearize(np.zeros(arm.nx))
by = shaper_for(model, "zvd")
print(
    f"{len(by.times)} impulses over {by.duration:.3f} s for", *(f"{m.frequency_hz:.2f} Hz" for m in model.modes()[1:])
)


def slew(t: float) -> list[float]:
    """Torque [N m] that turns the hub and stops it."""
    return [5.0 if 0 <= t < 0.4 else -5.0 if 0.4 <= t < 0.8 else 0.0]


t = np.linspace(0.0, 2.0, 2001)
left = []
for torque in (slew, shape(slew, model, "zvd")):
    held = np.array([torque(s) for s in t])
    motion = arm.simulate(np.zeros(arm.nx), held, t)
    left.append(np.ptp(motion["tip_deflection"][t > 0.85 + by.duration]))
print(f"vibration left: {1e3 * left[0]:.3f} mm, shaped {1e3 * left[1]:.4f} mm, {100 * left[1] / left[0]:.2f} percent")
