"""The classical problems of beams of large deflection, in the units of their sources.

Where a source prints a curve only, the number beside it is another program's: a shooting solution of the rod's
equations (cases/cosserat_rod) at rest, Exudyn (tests/reference/classical_beams.json) in motion.
"""

import numpy as np
import pytest
from cosserat_rod import tip_of_rod
from evidence import agrees

from pliant.plants import Beam, LargeDeflectionBeam
from pliant.plants.beams import STEEL

SHEARED = {"extensible": True, "theory": "timoshenko"}
WEIGHTLESS = {"gravity": (0.0, 0.0, 0.0)}


def section(length, EI, EA, GA, density, GJ=None):
    """A beam of these stiffnesses, of unit area; without a torsional one GJ = EI."""
    return Beam(
        length=length, area=1.0, I_y=EI / EA, I_z=EI / EA, J=(GJ or EI) / GA, density=density, E=EA, G=GA,
        shear_coefficient=1.0,
    )  # fmt: skip


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
