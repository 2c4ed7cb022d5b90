"""Without geometric stiffening a beam spun at its first frequency loses its stiffness in the plane."""

import dataclasses

import numpy as np
import pytest

from pliant.plants import Beam, SingleLinkArm, beams
from pliant.plants.beams.rotating_beam import rotating_frequencies

CRITICAL = 3.5160152685
UNIT = Beam(length=1.0, area=1.0, I_y=1.0, I_z=1.0, J=2.0, density=1.0, E=1.0, G=1.0)


def first(gamma, stiffened):
    return rotating_frequencies(gamma, 1, "lag", stiffened)[0]


def test_unstiffened_is_unstable_from_3_516_on_and_stiffened_never():
    assert first(CRITICAL - 1e-6, False) > 0 > first(CRITICAL + 1e-6, False)
    scan = np.linspace(0.0, 50.0, 201)
    lowest = np.array([first(gamma, True) for gamma in scan])
    assert lowest.min() >= CRITICAL - 1e-9 and np.all(np.diff(lowest) > 0)
    softened = np.array([first(gamma, False) for gamma in scan])
    np.testing.assert_array_equal(softened > 0, scan < CRITICAL)


def test_no_tip_mass_or_hub_saves_the_unstiffened_one():
    for load in ({"tip_mass": 2.0}, {"hub_radius": 1.0}, {"tip_mass": 1.0, "tip_inertia": 0.3}):
        critical = rotating_frequencies(0.0, 1, **load)[0] if "tip_inertia" not in load else 10.0
        assert rotating_frequencies(1.001 * critical, 1, "lag", False, **load)[0] < 0
        assert rotating_frequencies(1.001 * critical, 1, "lag", True, **load)[0] > 0


@pytest.mark.parametrize("theory", ["euler-bernoulli", "timoshenko"])
def test_the_arm_runs_away_where_its_frequency_says(theory):
    link = UNIT if theory == "euler-bernoulli" else dataclasses.replace(UNIT, I_z=1e-6, E=1e6, G=1e6)
    arm = SingleLinkArm(link=link, drive="motion", modes=3, theory=theory)
    for gamma, grows in ((3.4, False), (3.6, True)):
        x = np.zeros(arm.nx)
        x[1], x[arm.nx // 2] = 1e-6, gamma
        for kinematics in ("linear", "stiffened"):
            own = dataclasses.replace(arm, kinematics=kinematics)
            bent = own.simulate(x, None, np.linspace(0, 30, 301))["tip_deflection"]
            assert (np.abs(bent).max() > 1e-2) == (grows and kinematics == "linear")


def test_out_of_plane_it_does_not_feel_the_spin_without_stiffening():
    np.testing.assert_allclose(
        rotating_frequencies(20.0, 3, "flap", False), beams.roots("clamped-free", 3) ** 2, rtol=1e-12
    )
