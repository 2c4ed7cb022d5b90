"""The classical problems of beams of large deflection at rest, in the units of their sources.

Where a source prints a curve only, the number beside it is a shooting solution of the rod's equations
(cases/cosserat_rod).
"""

import numpy as np
import pytest
from classical_sections import SHEARED, WEIGHTLESS, section
from cosserat_rod import tip_of_rod
from evidence import agrees

from pliant.plants import Beam, LargeDeflectionBeam
from pliant.plants.beams import STEEL


def measured(plant, x, u=None):
    return dict(zip((s.name for s in plant.outputs), plant.measure(x, u)))


MATTIASSON = {  # P L^2/(E I): (L - x)/L, y/L, angle [rad]
    1: (0.05643, 0.30172, 0.46135),
    2: (0.16064, 0.49346, 0.78175),
    3: (0.25442, 0.60325, 0.98602),
    4: (0.32894, 0.66996, 1.12124),
    5: (0.38763, 0.71379, 1.21537),
    6: (0.43459, 0.74457, 1.28370),
    7: (0.47293, 0.76737, 1.33496),
    8: (0.50483, 0.78498, 1.37443),
    9: (0.53182, 0.79906, 1.40547),
    10: (0.55500, 0.81061, 1.43029),
}


@pytest.mark.parametrize("strained", [False, True], ids=["rotations", "strains"])
def test_cantilever_of_mattiasson(strained):
    """K. Mattiasson, Int. J. Numer. Methods Eng. 17 (1981), 145-153, table I, every printed digit."""
    beam = Beam.circular(2.0, 0.01, STEEL)
    loads = ("force", "follower") if strained else ("force",)
    plant = LargeDeflectionBeam(beam=beam, basis="polynomial", modes=7, points=16, tip_loads=loads, **WEIGHTLESS)
    assert plant.strained == strained
    guess = {}
    for load, row in MATTIASSON.items():
        x, u = plant.equilibrium(tip_force_y=load * beam.EI / beam.length**2, guess=guess)
        y = measured(plant, x, u)
        found = [-y["tip_u"] / 2.0, y["tip_v"] / 2.0, y["tip_angle"]]
        agrees(
            found,
            row,
            within=6e-6,
            absolute=True,
            of="LargeDeflectionBeam",
            what=f"tip under {load} E I/L^2",
            variant="strains" if strained else "rotations",
            source="Mattiasson (1981), table I",
            kind="table",
        )
        guess = {} if strained else dict(zip((s.name for s in plant.coordinates), x))


# Tip of the 45-degree bend: R = 100, a section of 1 x 1, E = 1e7, G = E/2, G J = G/6, a dead load across its plane.
# J. C. Simo and L. Vu-Quoc, Comput. Methods Appl. Mech. Eng. 58 (1986), 79-116, eight linear elements;
# K. J. Bathe and S. Bolourchi, Int. J. Numer. Methods Eng. 14 (1979), 961-986, eight straight elements, where printed.
BEND = {
    300.0: ((58.84, 22.33, 40.08), (59.2, 22.5, 39.5)),
    450.0: ((52.32, 18.62, 48.39), None),
    600.0: ((47.23, 15.79, 53.37), (47.2, 15.9, 53.4)),
}


@pytest.mark.campaign
@pytest.mark.parametrize("strains", [{}, SHEARED], ids=["inextensible", "sheared"])
def test_bend_of_45_degrees(strains):
    """Shooting to 1e-4; Simo and Vu-Quoc's coarse mesh is 0.11 (of 78.5) away from that, Bathe and Bolourchi's 0.7."""
    beam = Beam(length=25 * np.pi, area=1.0, I_y=1 / 12, I_z=1 / 12, J=1 / 6, density=1.0, E=1e7, G=5e6)
    plant = LargeDeflectionBeam(
        beam=beam,
        planar=False,
        rest_curvature=0.01,
        modes=6,
        twists=5,
        stretches=4,
        shears=4,
        points=17,
        **WEIGHTLESS,
        **strains,
    )
    start = measured(plant, np.zeros(plant.nx))
    np.testing.assert_allclose([start[f"tip_{k}"] for k in "xyz"], [70.7107, 29.2893, 0.0], atol=1e-4)
    stiff = (beam.E, beam.shear_stiffness, beam.shear_stiffness) if strains else None
    rigid = (beam.GJ, beam.EI, beam.EI)
    for load, (simo, bathe) in BEND.items():
        y = measured(plant, *plant.equilibrium(tip_force_z=load))
        tip = [y[f"tip_{k}"] for k in "xyz"]
        known, _ = tip_of_rod(beam.length, rigid, (0, 0, load), rest=(0, 0, 0.01), stiffness=stiff, steps=2)
        np.testing.assert_allclose(tip, known, atol=1e-4)
        agrees(
            tip,
            simo,
            within=0.12,
            absolute=True,
            of="LargeDeflectionBeam",
            what=f"tip of the 45-degree bend under {load:g}, of 78.5",
            source="Simo and Vu-Quoc (1986)",
            kind="table",
            variant="sheared" if strains else "inextensible",
        )
        if bathe:
            agrees(
                tip,
                bathe,
                within=0.75,
                absolute=True,
                of="LargeDeflectionBeam",
                what=f"tip of the 45-degree bend under {load:g}, of 78.5",
                source="Bathe and Bolourchi (1979), eight straight elements",
                kind="table",
                variant="sheared" if strains else "inextensible",
            )


def princeton(**changes):
    """7075 aluminium, 20 in x 0.5 in x 0.125 in; y is the stiff way."""
    b, h, E, nu = 12.7e-3, 3.175e-3, 71.7e9, 0.31
    J = b * h**3 * (1 / 3 - 0.21 * h / b * (1 - (h / b) ** 4 / 12))  # R. J. Roark, torsion of a rectangle
    beam = Beam(
        length=0.508, area=b * h, I_y=b * h**3 / 12, I_z=h * b**3 / 12, J=J, density=2795.0, E=E, G=E / (2 * (1 + nu))
    )
    options = {"basis": "polynomial", "modes": 5, "twists": 4} | WEIGHTLESS | changes
    return LargeDeflectionBeam(beam=beam, planar=False, points=14, **options)


@pytest.mark.campaign
@pytest.mark.parametrize("strains", [{}, SHEARED], ids=["rotations", "sheared"])
def test_princeton_beam(strains):
    """E. H. Dowell, J. Traybar and D. H. Hodges, J. Sound Vib. 50 (1977), 533-544: a blade under a dead tip load of 1,
    2 and 3 lb at pitch angles from flat to edge. They print points in diagrams; the digits are those of shooting.
    """
    plant = princeton(**strains)
    beam, twisted = plant.beam, []
    rigid = (beam.GJ, beam.E * beam.I_y, beam.EI)
    stiff = (beam.E * beam.area, beam.shear_stiffness, beam.shear_stiffness) if strains else None
    within = 2e-6 if strains else 5e-5  # sines of the twist sum slowly
    for load in (4.448, 8.896, 13.345):
        for pitch in (0.0, 15.0, 45.0, 75.0, 90.0):
            c, s = np.cos(np.radians(pitch)), np.sin(np.radians(pitch))
            force = (0.0, -load * s, -load * c)
            guess = {"flap1": 0.3 * c, "bend1": -0.02 * s} if not strains else {}
            y = measured(plant, *plant.equilibrium(tip_force_y=force[1], tip_force_z=force[2], guess=guess))
            known, _ = tip_of_rod(beam.length, rigid, force, stiffness=stiff, steps=3)
            np.testing.assert_allclose([y[f"tip_{k}"] for k in "xyz"], known, atol=within)
            twisted.append(y["tip_twist"])
    assert np.abs(twisted[10:]).argmax() == 2  # most where the load stands askew


HELIX = {  # share of the load: tip, by shooting; the source draws tip_z
    0.05: (0.71148, 6.28566, 2.75074),
    0.1: (0.41020, 0.05377, -1.09173),
    0.2: (0.11506, 0.00836, -0.59850),
    0.3: (0.05240, 0.00259, -0.39959),
}


@pytest.mark.campaign
@pytest.mark.filterwarnings("ignore::pliant.plants.core.errors.UnstableRestWarning")  # a dead moment follows no energy
def test_helicoidal_beam():
    """A. Ibrahimbegovic, Comput. Methods Appl. Mech. Eng. 149 (1997), 49-71: M = 200 pi and F = 50 at the tip wind it
    up ten times; here up to three, which twelve curvatures of each kind show. After J. C. Simo and L. Vu-Quoc,
    Comput. Methods Appl. Mech. Eng. 58 (1986), 79-116, who bend it by the moment alone.
    """
    plant = LargeDeflectionBeam(
        beam=section(10.0, 100.0, 1e4, 1e4, 1.0), planar=False, modes=12, twists=12, stretches=12, shears=12,
        tip_loads=("force", "moment"), **WEIGHTLESS, **SHEARED,
    )  # fmt: skip
    for share, known in HELIX.items():
        y = measured(plant, *plant.equilibrium(tip_force_z=50 * share, tip_moment_z=200 * np.pi * share))
        np.testing.assert_allclose([y[f"tip_{k}"] for k in "xyz"], known, atol=1e-4, err_msg=str(share))


@pytest.mark.campaign
@pytest.mark.filterwarnings("ignore::pliant.plants.core.errors.UnstableRestWarning")
def test_helicoidal_beam_winds_up_ten_times():
    """The whole load, on ten segments, without extension and shear; digits by shooting. (With them, E A = kappa G A, it
    is F L/(E A) = 0.05 longer along z.)
    """
    plant = LargeDeflectionBeam(
        beam=section(10.0, 100.0, 1e4, 1e4, 1.0), planar=False, segments=10, modes=4, twists=4, points=6,
        tip_loads=("force", "moment"), **WEIGHTLESS,
    )  # fmt: skip
    y = measured(plant, *plant.equilibrium(tip_force_z=50.0, tip_moment_z=200 * np.pi))
    np.testing.assert_allclose([y[f"tip_{k}"] for k in "xyz"], [0.00480, 0.00007, -0.12644], atol=1e-4)


def test_helicoidal_beam_winds_up():
    """A half turn of it without extension and shear; digits by shooting."""
    share = 0.05
    plant = LargeDeflectionBeam(
        beam=section(10.0, 100.0, 1e4, 1e4, 1.0), planar=False, modes=5, twists=4, points=13,
        tip_loads=("force", "moment"), **WEIGHTLESS,
    )  # fmt: skip
    y = measured(plant, *plant.equilibrium(tip_force_z=50 * share, tip_moment_z=200 * np.pi * share))
    np.testing.assert_allclose([y[f"tip_{k}"] for k in "xyz"], (0.71148, 6.28566, 2.74824), atol=0.01)


@pytest.mark.filterwarnings("ignore::pliant.plants.core.errors.UnstableRestWarning")
@pytest.mark.parametrize("turns", [0.5, 1.0, 2.0])
def test_a_moment_rolls_the_cantilever_up(turns):
    """J. C. Simo and L. Vu-Quoc, Comput. Methods Appl. Mech. Eng. 58 (1986), 79-116: M L/(E I) = 2 pi n closes n
    circles; in the plane and in space, exactly.
    """
    beam = section(10.0, 100.0, 1e4, 1e4, 1.0)
    moment = 2 * np.pi * turns * beam.EI / beam.length
    for given in ({"tip_loads": ("moment",), "points": 24}, {"tip_loads": ("moment",), "planar": False, "points": 24}):
        plant = LargeDeflectionBeam(beam=beam, modes=2, **WEIGHTLESS, **given)
        x, u = plant.equilibrium(**{plant.inputs[-1].name: moment})
        y = measured(plant, x, u)
        angle = 2 * np.pi * turns
        tip = np.array([np.sin(angle), 1 - np.cos(angle)]) * 10.0 / angle
        agrees(
            [y["tip_x"], y["tip_y"], y["tip_angle"]],
            [*tip, angle],
            within=1e-6,
            absolute=True,
            of="LargeDeflectionBeam",
            what=f"tip of a cantilever of 10 that a moment rolls up {turns:g} times",
            source="Simo and Vu-Quoc (1986), M L/(E I) = 2 pi n",
            kind="closed form",
            variant="in space" if "planar" in given else "in the plane",
        )
