"""A soft bar spun about its end grows longer, and no number of bending shapes says so.

The naive ladder of an inextensible beam is of one mind at every rung, down to the last digit. Its range tells that the
axis would stretch by percents, and names what holds; the extensible beam is where the closed form puts it.
"""

import dataclasses

import numpy as np
import pytest

from pliant.plants import Beam, LargeDeflectionBeam
from pliant.plants.core.errors import ValidityWarning

BAR = Beam(length=1.0, area=1e-4, I_y=1e-9, I_z=1e-9, J=2e-9, density=1000.0, E=1e6, G=4e5)
SPEED = 10.0  # [rad/s]: omega L sqrt(rho/E) = 0.316
NAIVE = LargeDeflectionBeam(beam=BAR, root="driven", gravity=(0.0, 0.0, 0.0))


def spun(plant):
    """Distance of the tip from the hub at a steady speed [m]."""
    n = plant.nx // 2
    x = np.zeros(plant.nx)
    x[n] = SPEED
    names = [s.name for s in plant.coordinates]
    if plant.extensible:  # at rest against the hub by Newton's method on the accelerations
        at = [k for k, name in enumerate(names) if name.startswith("stretch")]
        for _ in range(20):
            A = plant.jacobians(x, [0.0])[0][np.ix_([n + k for k in at], at)]
            x[at] -= np.linalg.solve(A, plant.dynamics(x, [0.0])[[n + k for k in at]])
    return dict(zip([s.name for s in plant.outputs], plant.measure(x)))["tip_x"], x


def test_the_rungs_of_an_inextensible_bar_agree_on_a_wrong_length():
    longer = np.tan(SPEED * np.sqrt(BAR.density / BAR.E)) / (SPEED * np.sqrt(BAR.density / BAR.E))
    assert longer == pytest.approx(1.0347, abs=1e-4)  # u'' + k^2 (x + u) = 0: r(L) = tan(k L)/k
    found = [spun(step)[0] for step in NAIVE.ladder() if step.kinematics == "strain"]
    np.testing.assert_allclose(found, 1.0, atol=1e-12)
    assert not NAIVE.effects["extension"]


def test_pliant_says_so_and_the_extensible_beam_holds():
    _, x = spun(NAIVE)
    with pytest.warns(ValidityWarning, match=r"axial strain of the beam 0.05.* holds: .*extensible=True"):
        NAIVE.simulate(x, [0.0], [0.0, 1e-3])
    plant = dataclasses.replace(NAIVE, extensible=True, modes=1)
    k = SPEED * np.sqrt(BAR.density / BAR.E)
    for stretches, within in ((1, 5e-3), (2, 2e-3), (3, 2e-5), (5, 1e-7)):
        length, _ = spun(dataclasses.replace(plant, stretches=stretches))
        assert length == pytest.approx(np.tan(k) / k, abs=within)
    assert plant.effects["extension"]
