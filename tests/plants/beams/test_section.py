"""Sections and materials against closed forms and tables."""

import math

import casadi as ca
import mpmath as mp
import pytest
from evidence import agrees

from pliant.plants import beams
from pliant.plants.beams.payload import Payload
from pliant.plants.beams.section import ALUMINIUM, STEEL, Beam, Material
from pliant.plants.core import parameters

PLAIN = {
    "length": 2.0,
    "area": 1e-3,
    "I_y": 2e-7,
    "I_z": 1e-7,
    "J": 5e-8,
    "density": 2700.0,
    "E": 7e10,
    "G": 2.7e10,
}


def test_sections():
    r = Beam.rectangular(2.0, 0.02, 0.05, ALUMINIUM)
    assert r.area == pytest.approx(1e-3) and r.mass == pytest.approx(5.4)
    assert r.I_z == pytest.approx(0.02 * 0.05**3 / 12) and r.I_y == pytest.approx(0.05 * 0.02**3 / 12)
    assert pytest.approx(70e9 * r.I_z) == r.EI and r.polar_moment == pytest.approx(r.I_y + r.I_z)
    c = Beam.circular(1.0, 0.03, STEEL)
    assert pytest.approx(math.pi * 0.03**4 / 32) == c.J and pytest.approx(c.polar_moment) == c.J
    t = Beam.tube(1.0, 0.05, 0.03, STEEL)
    assert t.area == pytest.approx(math.pi * (0.05**2 - 0.03**2) / 4)
    assert t.I_z == pytest.approx(math.pi * (0.05**4 - 0.03**4) / 64) and pytest.approx(2 * t.I_z) == t.J
    assert pytest.approx(81e9 * t.J) == t.GJ


@pytest.mark.parametrize("sides", [(0.05, 0.05), (0.02, 0.05), (0.05, 0.02), (1.0, 1e-3)])
def test_rectangle_torsion_constant_is_the_full_series(sides):
    a, b = max(sides), min(sides)
    series = mp.nsum(lambda k: mp.tanh((2 * k + 1) * mp.pi * a / (2 * b)) / (2 * k + 1) ** 5, [0, mp.inf])
    exact = a * b**3 * (mp.mpf(1) / 3 - 64 * b / (mp.pi**5 * a) * series)
    assert pytest.approx(float(exact), rel=1e-14, abs=0) == Beam.rectangular(1.0, *sides, STEEL).J


# b/a: J/(b a^3), of S. Timoshenko and J. N. Goodier, "Theory of Elasticity", 1951, section 109
TORSION = {1.0: 0.1406, 1.2: 0.166, 1.5: 0.196, 2.0: 0.229, 2.5: 0.249, 3.0: 0.263, 4.0: 0.281, 5.0: 0.291, 10.0: 0.312}


def test_torsion_constants_as_tabulated():
    assert pytest.approx(TORSION[1.0], abs=5e-5) == Beam.rectangular(1.0, 1.0, 1.0, STEEL).J  # a digit more than others
    agrees(
        [Beam.rectangular(1.0, 1.0, ratio, STEEL).J / ratio for ratio in TORSION],
        list(TORSION.values()),
        within=5e-4,
        absolute=True,
        of="Beam.rectangular",
        what="torsion constants J/(b a^3), b/a from 1 to 10",
        source="Timoshenko and Goodier (1951), section 109",
        kind="table",
    )


def test_a_parameter_may_be_a_symbol():
    length, width = ca.SX.sym("L"), ca.SX.sym("b")
    beam = parameters.put(Beam(**PLAIN), "length", length)
    assert float(ca.Function("m", [length], [beam.mass])(2.0)) == pytest.approx(5.4)
    section = Beam.rectangular(length, width, 0.05, ALUMINIUM)
    J = ca.Function("J", [width], [section.J])
    for w in (0.02, 0.09):
        assert float(J(w)) == pytest.approx(Beam.rectangular(1.0, w, 0.05, ALUMINIUM).J, rel=1e-14, abs=0)
    payload = Payload(mass=ca.SX.sym("m"), inertia=ca.SX.sym("I"), offset=(ca.SX.sym("x"), 0.0, 0.0))
    assert parameters.is_symbolic(payload.inertia_z)


@pytest.mark.parametrize(
    "make, text",
    [
        (lambda: Beam(**{**PLAIN, "length": -1.0}), r"Beam.length = -1.0 must be > 0 \[m\]"),
        (lambda: Beam(**{**PLAIN, "density": 0.0}), "Beam.density = 0.0 must be > 0"),
        (lambda: Beam(**{**PLAIN, "I_z": math.nan}), "Beam.I_z = nan"),
        (lambda: Beam(**PLAIN, damping=-1e-3), "Beam.damping = -0.001 must be >= 0"),
        (lambda: Material(density=1.0, E=0.0, G=1.0), "Material.E = 0.0 must be > 0"),
        (lambda: Beam.rectangular(1.0, 0.1, -0.2, STEEL), "rectangular depth = -0.2 must be > 0"),
        (lambda: Beam.rectangular(0.0, 0.1, 0.2, STEEL), "Beam.length = 0.0 must be > 0"),
        (lambda: Beam.circular(1.0, "wide", STEEL), "circular diameter = 'wide' must be a number > 0"),
        (lambda: Beam.tube(1.0, 0.03, 0.05, STEEL), "tube inner = 0.05 must be > 0 and < outer = 0.03"),
        (lambda: Payload(mass=-1.0), "Payload.mass = -1.0 must be >= 0"),
        (lambda: Payload(inertia=-1.0), "Payload.inertia = -1.0 must be >= 0"),
        (lambda: Payload(inertia=((1.0, 0.0), (0.0, 1.0))), "must be a number or 3 x 3"),
        (lambda: Payload(inertia=((1, 0.5, 0), (0, 1, 0), (0, 0, 1))), "must be symmetric"),
        (lambda: Payload(inertia=((1, 2, 0), (2, 1, 0), (0, 0, 1))), "principal moments >= 0"),
        (lambda: Payload(inertia=((1, 0, 0), (0, 1, 0), (0, 0, 3))), "above the sum of the others"),
        (lambda: Payload(offset=(1.0, 2.0)), r"Payload.offset = \(1.0, 2.0\) must be three numbers"),
        (lambda: beams.basis("hermite", 2), "basis.kind = 'hermite' must be one of"),
        (lambda: beams.basis("polynomial", 31), "basis.n = 31 must be an integer from 0 to 30"),
        (lambda: beams.basis("payload", 201), "basis.n = 201 must be an integer from 0 to 200"),
        (lambda: beams.basis("payload", 2, tip_mass_ratio=-1.0), "tip_mass_ratio = -1.0 must be within"),
        (lambda: beams.frequencies(Beam(**PLAIN), 2, "free"), "boundary = 'free'"),
        (lambda: beams.frequencies(Beam(**PLAIN), 2, "pinned-free", Payload()), "'clamped-free'"),
        (lambda: beams.frequencies(Beam(**PLAIN), 2, payload=Payload(1.0, 0.1, (0, 0, 0.1))), r"offset\[2\]"),
    ],
)
def test_bad_input_names_field_value_and_range(make, text):
    with pytest.raises(ValueError, match=text):
        make()
