"""Campbell diagrams, held against closed forms, a published table and a power series."""

import dataclasses

import numpy as np
import pytest
from scipy.optimize import brentq

from pliant.plants import EquilibriumError, FlexibleSpacecraft, LinearModel, Payload, SingleLinkArm
from pliant.plants.beams.rotating_beam import rotating_frequencies
from pliant.plants.periodic import campbell

# Flap frequencies of a uniform cantilever that rotates, hub of no radius, in sqrt(EI/(rho A L^4)): Wright, Smith,
# Thresher and Wang, "Vibration modes of centrifugally stiffened beams", J. Appl. Mech. 49 (1982), Table 1; the same in
# Hodges and Rutkowski, AIAA J. 19 (1981), to these digits.
WRIGHT = {
    0: (3.5160, 22.0345, 61.6972),
    1: (3.6817, 22.1810, 61.8418),
    2: (4.1373, 22.6149, 62.2732),
    3: (4.7973, 23.3203, 62.9850),
    4: (5.5850, 24.2734, 63.9668),
    5: (6.4495, 25.4461, 65.2050),
    6: (7.3604, 26.8091, 66.6840),
    7: (8.2996, 28.3341, 68.3860),
    8: (9.2568, 29.9954, 70.2930),
    9: (10.2257, 31.7705, 72.3867),
    10: (11.2023, 33.6404, 74.6493),
    11: (12.1843, 35.5890, 77.0638),
    12: (13.1702, 37.6031, 79.6145),
}


def characteristic(omega, gamma, terms=110):
    """w'''' = gamma^2/2 ((1 - x^2) w')' + omega^2 w by power series about the clamped end; zero where w'' = w''' = 0 at
    the free one. (n+4)..(n+1) a_n+4 = gamma^2/2 ((n+2)(n+1) a_n+2 - n(n+1) a_n) + omega^2 a_n.
    """
    ends = []
    for first in (2, 3):
        a = np.zeros(terms, dtype=np.longdouble)
        a[first] = 1
        for n in range(terms - 4):
            pull = np.longdouble(gamma) ** 2 / 2 * ((n + 2) * (n + 1) * a[n + 2] - n * (n + 1) * a[n])
            a[n + 4] = (pull + np.longdouble(omega) ** 2 * a[n]) / ((n + 4) * (n + 3) * (n + 2) * (n + 1))
        n = np.arange(terms)
        ends.append(((n * (n - 1) * a).sum(), (n * (n - 1) * (n - 2) * a).sum()))
    return ends[0][0] * ends[1][1] - ends[0][1] * ends[1][0]


def series_root(omega, gamma):
    value = lambda w: float(characteristic(w, gamma))  # noqa: E731
    return brentq(value, omega * (1 - 1e-3), omega * (1 + 1e-3), xtol=1e-9 * omega)


def flapping(gamma):
    """A model whose modes are the beam's three lowest across the plane: what `campbell` is given of it."""
    K = np.diag(rotating_frequencies(gamma, 3) ** 2)
    A = np.block([[np.zeros((3, 3)), np.eye(3)], [-K, np.zeros((3, 3))]])
    return LinearModel.from_matrices(A, np.zeros((6, 0)))


def test_the_table_and_the_power_series():
    found = campbell(flapping, np.arange(13.0), orders=(1, 2, 3, 4, 5))
    assert np.abs(found.frequencies - np.array(list(WRIGHT.values()))).max() < 1.01e-4
    for gamma in (1.0, 6.0, 12.0):
        series = [series_root(f, gamma) for f in WRIGHT[int(gamma)]]
        assert found.frequencies[int(gamma)] == pytest.approx(series, rel=1e-6)


def test_crossings_of_the_table_lie_on_the_series():
    """First flap at 2 per rev, 3 per rev ..: omega(gamma) = k gamma there, to 1e-6 by the series."""
    found = campbell(flapping, np.arange(13.0), orders=(2, 3, 4))
    first = [c for c in found.crossings if c.mode == 0]
    assert [c.order for c in first] == [4, 3, 2]
    for c in first:
        assert c.frequency == pytest.approx(c.order * c.speed, rel=1e-10)
        assert c.frequency == pytest.approx(series_root(c.frequency, c.speed), rel=1e-6)


def test_an_arm_about_its_hub_is_the_rotating_beam():
    """In the plane, by the stiffened arm's own linear model; gamma = W / sqrt(EI/(rho A L^4))."""
    arm = _arm()
    beam = arm.link
    unit = np.sqrt(beam.E * beam.I_z / (beam.density * beam.area * beam.length**4))
    own = tuple(f"eta{i}{rate}" for rate in ("", "_rate") for i in range(1, 7))
    found = campbell(arm, unit * np.array([0.0, 1.0, 2.0, 4.0]), rate="hub_angle_rate", states=own)
    for gamma in (1.0, 2.0, 4.0):
        k = int(np.argmin(np.abs(found.speeds - gamma * unit)))
        wanted = rotating_frequencies(gamma, 2, "lag") * unit
        assert found.frequencies[k, :2] == pytest.approx(wanted, rel=2e-4)


def _arm():
    """A hub so heavy that nothing turns it."""
    own = SingleLinkArm.textbook()
    return dataclasses.replace(own, kinematics="stiffened", modes=6, payload=Payload(), gravity=0.0, hub_inertia=1e7)


def test_a_spinning_craft():
    """Booms on a craft that spins about z: crossings are on their lines."""
    craft = FlexibleSpacecraft.textbook()
    found = campbell(craft, np.linspace(0.3, 2.0, 5), rate="rate_z", x0=craft.state(), orders=(1, 2))
    assert found.mac > 0.8 and len(found.crossings) > 0
    for c in found.crossings:
        assert c.frequency == pytest.approx(c.order * c.speed, rel=1e-9)


def test_bad_input():
    for given, words in (
        ({"speeds": [1.0, 0.5]}, "speeds"),
        ({"orders": (0,)}, "orders"),
        ({"least": 2.0}, "least"),
        ({"rate": "x"}, "rate"),
        ({"plant": 3.0}, "plant"),
        ({"plant": lambda w: None}, "plant"),
    ):
        with pytest.raises(ValueError, match=words):
            campbell(**({"plant": flapping, "speeds": [0.0, 1.0]} | given))
    arm = _arm()
    with pytest.raises(ValueError, match="rate"):
        campbell(arm, [0.0, 1.0])
    with pytest.raises(EquilibriumError, match="hub_angle changes"):
        campbell(arm, [0.0, 1.0], rate="hub_angle_rate")
