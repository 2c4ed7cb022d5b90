"""The classical problems of beams of large deflection in motion, in the units of their sources.

Where a source prints a curve only, the number beside it is Exudyn's (tests/reference/classical_beams.json).
"""

import numpy as np
import pytest
from classical_sections import SHEARED, WEIGHTLESS, section
from evidence import agrees

from pliant.plants import LargeDeflectionBeam

SPUN = section(10.0, 1.4e4, 2.8e7, 1e7, 1.2)
SPEED, TIME = 6.0, 15.0  # [rad/s, s]


def spin_up(t):
    """The root's acceleration (1,) [rad/s^2]."""
    return np.array([SPEED / TIME * (1 - np.cos(2 * np.pi * t / TIME)) if t < TIME else 0.0])


def spun(**changes):
    plant = LargeDeflectionBeam(beam=SPUN, root="driven", **({"modes": 3, "stretches": 2} | WEIGHTLESS | changes))
    times = np.arange(9) * 2.5
    motion = plant.simulate(np.zeros(plant.nx), spin_up, times, method="rosenbrock", step=1e-2)
    c, s = np.cos(motion["hub_angle"]), np.sin(motion["hub_angle"])
    return np.column_stack([c * motion["tip_x"] + s * motion["tip_y"] - 10.0, motion["tip_deflection"]])[1:]


def test_displacement_driven_rotating_arm(reference):
    """J. C. Simo and L. Vu-Quoc, J. Appl. Mech. 53 (1986), 855-863, spin-up: tip across and along in curves, digits by
    Exudyn; at last the arm is 5.14e-4 longer, printed and rho A omega^2 L^3/(3 E A) in closed form.
    """
    rows = np.array(reference("classical_beams")["spin_up"]["rows"])
    found = spun(extensible=True)
    told = {"of": "LargeDeflectionBeam", "source": "Exudyn 1.13.6", "kind": "other program", "absolute": True}
    agrees(found[:, 0], rows[:, 1], within=3e-6, what="tip along the spun-up arm of Simo and Vu-Quoc", **told)
    agrees(found[:, 1], rows[:, 2], within=2e-4, what="tip across the spun-up arm of Simo and Vu-Quoc", **told)
    agrees(
        found[5:, 0].mean(),
        5.14e-4,
        within=2e-3,
        of="LargeDeflectionBeam",
        what="how much longer a turning arm is",
        source="Simo and Vu-Quoc (1986), spin-up, as printed",
        kind="table",
    )
    assert found[5:, 0].mean() == pytest.approx(1.2 * SPEED**2 * 10.0**3 / (3 * 2.8e7), rel=2e-3)


@pytest.mark.campaign
def test_displacement_driven_rotating_arm_with_shear(reference):
    """With its shear, whose frequency of 1.3e5 rad/s an L-stable method steps over."""
    rows = np.array(reference("classical_beams")["spin_up"]["rows"])
    found = spun(shears=3, modes=5, **SHEARED)
    np.testing.assert_allclose(found, rows[:, 1:], atol=1e-5)


@pytest.mark.campaign
def test_a_moving_root_spins_the_arm_up_as_a_driven_one():
    """Carried by its prescribed root, which stands still."""
    plant = LargeDeflectionBeam(beam=SPUN, root="moving", extensible=True, modes=3, **WEIGHTLESS)
    u = lambda t: np.array([0.0, 0.0, spin_up(t)[0]])  # noqa: E731
    motion = plant.simulate(np.zeros(plant.nx), u, np.arange(9) * 2.5, method="rosenbrock", step=1e-2)
    np.testing.assert_allclose(motion["tip_deflection"][1:], spun(extensible=True)[:, 1], atol=1e-6)


def flown(EI, modes, others, until, step):
    """(times, places of root, middle and tip (nt, 6), plant, motion) of the free flying spaghetti, pushed for 2.5."""
    beam = section(10.0, EI, 1e4, 1e4, 1.0)
    plant = LargeDeflectionBeam(
        beam=beam, root="free", modes=modes, stretches=others, shears=others, tip_loads=("force", "moment"),
        rotary=10.0 / beam.I_z, **WEIGHTLESS, **SHEARED,
    )  # fmt: skip
    x = np.zeros(plant.nx)
    x[1], x[2] = 8.0, np.arctan2(-8.0, 6.0)
    times = np.arange(0.0, until + 0.1, 2.5)
    push = np.outer(times == 0, [8.0, 0.0, -80.0])  # held until the next time
    flight = plant.simulate(x, push, times, method="rk8", step=step)
    places = [plant.positions(state, [0.0, 0.5, 1.0]).ravel() for state in flight.x[1:]]
    return times[1:], np.array(places), plant, flight


# J. C. Simo and L. Vu-Quoc, J. Appl. Mech. 53 (1986), 855-863: the free-free flexible beam ("flying spaghetti"), E A =
# kappa G A = 1e4, rho A = 1, rho I = 10, L = 10 from (0, 8) to (6, 0), F = 8 and T = 80 at the lower end for 2.5.
# The paper draws its shapes; the digits are Exudyn's.
def test_free_flying_spaghetti_until_it_is_let_go(reference):
    """And its momentum: 8 x 2.5 along x, none along y."""
    row = reference("classical_beams")["spaghetti"]["rows"][0]
    _, places, plant, flight = flown(500.0, 4, 3, 2.5, 0.02)
    agrees(
        places[0],
        row[1:],
        within=0.04,
        absolute=True,
        of="LargeDeflectionBeam",
        what="free flying spaghetti (length 10) after its push",
        source="Exudyn 1.13.6",
        kind="other program",
    )
    p = plant.mass_matrix(flight.x[-1]) @ flight.x[-1][plant.nx // 2 :]
    np.testing.assert_allclose(p[:2], [20.0, 0.0], atol=1e-6)


@pytest.mark.campaign
@pytest.mark.parametrize("case", ["spaghetti", "soft_spaghetti"])
def test_free_flying_spaghetti(reference, case):
    """Over 10 s, in which it tumbles over: within 0.006 (0.06 the soft one) of its length of 10."""
    known = reference("classical_beams")[case]
    times, places, *_ = flown(known["parameters"]["EI_N_m2"], 9, 8, 10.0, 0.01)
    rows = np.array(known["rows"])
    np.testing.assert_allclose(times, rows[:, 0])
    agrees(
        places,
        rows[:, 1:],
        within=0.006 if case == "spaghetti" else 0.06,
        absolute=True,
        of="LargeDeflectionBeam",
        what=f"free flying {case.replace('_', ' ')} (length 10) over 10 s",
        source="Exudyn 1.13.6",
        kind="other program",
    )
