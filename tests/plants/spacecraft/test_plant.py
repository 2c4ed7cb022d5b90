"""The spacecraft against the reference file, conservation laws, Euler's equations and the single-link arm."""

import dataclasses
import json
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pliant.plants import Beam, MassMatrixError, SingleLinkArm
from pliant.plants.modal_data.modal_data import ModalData
from pliant.plants.spacecraft.appendage import Appendage, Hinge
from pliant.plants.spacecraft.environment import Environment, Orbit, Sun, Surface
from pliant.plants.spacecraft.hub import Hub, Thruster, Wheel
from pliant.plants.spacecraft.plant import FlexibleSpacecraft

REFERENCE = json.loads((Path(__file__).parents[2] / "reference" / "spacecraft.json").read_text())
BOOM = Beam(length=5.0, area=1e-3, I_y=1e-7, I_z=4e-7, J=4e-7, density=2000.0, E=1e9, G=4e8)
CRAFT = dataclasses.replace(FlexibleSpacecraft.textbook(), kinematics="linear")


def hinged(craft=CRAFT, **hinge):
    """The reference spacecraft with both booms hinged about their y."""
    options = {"axes": ((0.0, 1.0, 0.0),), "stiffness": 100.0, **hinge}
    parts = tuple(dataclasses.replace(a, hinge=Hinge(**options), damping=0.005) for a in craft.appendages)
    return dataclasses.replace(craft, appendages=parts)


def busy(kinematics="stiffened", drive="torque", **changes):
    """Wheels, thrusters, two-axis hinges, sunlight and an orbit all at once."""
    hinge = Hinge(axes=((0.0, 1.0, 0.0), (0.6, 0.0, 0.8)), stiffness=(100.0, 50.0), damping=2.0, drive=drive)
    plate = Surface(area=4.0, normal=(0.0, 0.0, 1.0), specular=0.3, diffuse=0.2, both=True)
    parts = tuple(dataclasses.replace(a, hinge=hinge, damping=0.01, surface=plate) for a in CRAFT.appendages)
    hub = Hub(
        mass=500.0,
        inertia=((200.0, 5.0, -3.0), (5.0, 150.0, 2.0), (-3.0, 2.0, 180.0)),
        wheels=(Wheel(axis=(1.0, 0.0, 0.0), inertia=0.1, friction=1e-3), Wheel(axis=(0.0, 0.6, 0.8), inertia=0.2)),
        thrusters=(Thruster(position=(0.5, 0.2, 0.0), direction=(0.0, 0.0, 1.0)),),
        surfaces=(Surface(area=2.0, normal=(1.0, 0.0, 0.0), centre=(0.5, 0.1, 0.0)),),
    )
    outside = Environment(
        orbit=Orbit(rate=1.1e-3),
        sun=Sun(direction=(0.0, 0.6, 0.8)),
        dipole=(1.0, 2.0, 0.5),
        magnetic_field=(2e-5, 0.0, 3e-5),
        torque=(1e-5, 0.0, 0.0),
    )
    made = FlexibleSpacecraft(hub=hub, appendages=parts, kinematics=kinematics, environment=outside)
    return dataclasses.replace(made, **changes)


def anywhere(craft, seed=0, size=0.1):
    """A random state."""
    rng = np.random.default_rng(seed)
    x = size * rng.normal(size=craft.nx)
    x[craft.layout.quaternion] = rng.normal(size=4)
    x[craft.layout.quaternion] /= np.linalg.norm(x[craft.layout.quaternion])
    return x


def nearest(found, wanted):
    """Largest distance of a wanted root from the found ones."""
    return max(np.abs(found - complex(*root)).min() for root in wanted)


def test_free_frequencies():
    np.testing.assert_allclose(CRAFT.natural_frequencies(), REFERENCE["free_frequencies_rad_s"], rtol=1e-9)
    wanted = REFERENCE["hinge_stiffness_modulated"]["hinge_frequencies_rad_s"]
    np.testing.assert_allclose(hinged().natural_frequencies(), wanted, rtol=1e-9)
    roots = np.sort(np.abs(hinged().linearize(hinged().state()).eigenvalues))
    np.testing.assert_allclose(roots[roots > 0.1][::2], wanted, rtol=1e-3)  # damped a little


@pytest.mark.parametrize("axis", "xy")
def test_frozen_roots_in_spin(axis):
    model = CRAFT.linearize(CRAFT.state({f"rate_{axis}": 0.1}))
    assert nearest(model.eigenvalues, REFERENCE["spin_0.1_rad_s"][axis]) < 1e-8
    apart = [z for z in model.eigenvalues if abs(z) > 1e-5]
    wanted = np.array([complex(*z) for z in REFERENCE["spin_0.1_rad_s"][axis]])
    wanted = np.concatenate([wanted, wanted.conj()])
    assert max(np.abs(wanted - z).min() for z in apart) < 1e-7


def test_gravity_gradient_frequencies():
    """Roll = y, pitch = z, yaw = x: body axes (x, y, z) along the orbit axes (z, x, y)."""
    craft = dataclasses.replace(CRAFT, environment=Environment(orbit=Orbit(rate=1e-3)))
    x = craft.state(quaternion_0=0.5, quaternion_1=-0.5, quaternion_2=-0.5, quaternion_3=-0.5)
    R = craft.turn(x)
    np.testing.assert_allclose(R, [[0, 1, 0], [0, 0, 1], [1, 0, 0]], atol=1e-15)
    x[craft.layout.omega] = R.T @ [0.0, -1e-3, 0.0]
    assert np.abs(craft.dynamics(x)).max() < 1e-8  # centrifugal forces and tidal tension stretch nothing to first order
    ratios = np.abs(craft.linearize(x).eigenvalues.imag) / 1e-3
    for wanted in REFERENCE["gravity_gradient"]["frequencies_over_orbital_rate"]:
        assert np.abs(ratios - wanted).min() < 1e-5
    assert craft.linearize(x).eigenvalues.real.max() < 1e-7


@pytest.mark.parametrize("kinematics", ["linear", "stiffened"])
def test_momentum_norm_and_energy(kinematics):
    craft = hinged(dataclasses.replace(CRAFT, kinematics=kinematics), damping=2.0)
    wheels = (Wheel(axis=(1.0, 0.0, 0.0), inertia=0.1, friction=1e-3), Wheel(axis=(0.0, 0.0, 1.0), inertia=0.1))
    craft = dataclasses.replace(craft, hub=dataclasses.replace(craft.hub, wheels=wheels))
    x = craft.state(
        rate_x=0.05,
        rate_y=0.08,
        rate_z=0.1,
        eta1_1=0.05,
        eta2_2=0.02,
        velocity_x=0.1,
        hinge1_1=0.1,
        wheel1_momentum=3.0,
    )
    t = np.linspace(0, 30, 61)
    run = craft.simulate(x, lambda s: np.array([0.5 * np.cos(0.3 * s), 0.2]), t)
    linear, angular = craft.momentum(run.x)
    assert np.abs(linear - linear[0]).max() < 1e-12 * np.linalg.norm(linear[0])
    assert np.abs(angular - angular[0]).max() < 1e-11 * np.linalg.norm(angular[0])
    assert np.abs(np.linalg.norm(run.x[:, craft.layout.quaternion], axis=1) - 1).max() < 1e-12
    push = np.array([0.5, 0.2])

    def with_work(s, z):
        put_in, lost = craft.power(z[:-1], push)
        return np.append(craft.dynamics(z[:-1], push), put_in - lost)

    end = solve_ivp(with_work, (0, 5), np.append(x, 0.0), method="DOP853", rtol=1e-11, atol=1e-13).y[:, -1]
    gained = craft.energy(end[:-1]) - craft.energy(x)
    assert abs(gained) > 0.01 * craft.energy(x)
    assert gained == pytest.approx(end[-1], abs=1e-9 * craft.energy(x))


def test_momentum_over_a_thousand_seconds():
    """Undamped, so that it never comes to rest."""
    craft = dataclasses.replace(CRAFT, appendages=tuple(dataclasses.replace(a, modes=(1, 1)) for a in CRAFT.appendages))
    x = craft.state(rate_x=0.03, rate_y=0.05, rate_z=0.04, eta1_1=0.05, eta2_2=0.02, velocity_x=0.1)
    run = craft.simulate(x, None, np.linspace(0, 1000, 101), rtol=1e-12)
    for kept in craft.momentum(run.x):
        assert np.abs(kept - kept[0]).max() < 1e-10 * np.linalg.norm(kept[0])
    assert np.abs(np.linalg.norm(run.x[:, craft.layout.quaternion], axis=1) - 1).max() < 1e-12
    energy = craft.energy(run.x)
    assert np.abs(energy - energy[0]).max() < 1e-9 * energy[0]
    assert np.abs(run.x[-10:, craft.layout.modes[0]]).max() > 0.01  # it still moves


def test_without_translation_energy_and_momentum_are_about_the_mass_centre():
    """The whole spacecraft set off so that its mass centre rests has the same, and both keep them."""
    full = hinged(damping=0.0)
    full = dataclasses.replace(full, appendages=(full.appendages[0],))
    short = dataclasses.replace(full, translation=False)
    x = full.state(rate_x=0.05, rate_y=0.08, rate_z=0.1, eta1_1=0.05, eta1_1_rate=0.03, hinge1_1=0.1, hinge1_1_rate=0.1)
    M, at = full.mass_matrix(x), full.layout  # hub axes are the reference axes here
    speeds = np.concatenate([x[at.omega], x[at.rates :]])
    x[at.velocity] = -np.linalg.solve(M[:3, :3], M[:3, 3:] @ speeds)
    cut = np.delete(x, [*range(3), *range(at.velocity.start, at.velocity.stop)])
    assert np.abs(full.momentum(x)[0]).max() < 1e-12
    assert np.abs(short.momentum(cut)[0]).max() < 1e-12
    assert short.energy(cut) == pytest.approx(full.energy(x), rel=1e-13)
    np.testing.assert_allclose(short.momentum(cut)[1], full.momentum(x)[1], rtol=1e-12)
    assert full.energy(full.state(rate_y=0.08)) > 1.001 * short.energy(short.state(rate_y=0.08))  # about the hub
    run = short.simulate(cut, lambda t: np.array([0.2, -0.1, 0.3]) * np.sin(t), np.linspace(0, 10, 41), audit=True)
    assert run.stats["energy_balance"] < 1e-9 and np.ptp(short.energy(run.x)) > 0.1
    free = short.simulate(cut, None, np.linspace(0, 10, 41))
    kept = short.momentum(free.x)[1]
    assert np.abs(kept - kept[0]).max() < 1e-11 * np.linalg.norm(kept[0])


def test_norm_of_the_quaternion_returns():
    x = CRAFT.state(rate_x=0.3)
    for size in (1.01, 0.99):
        q = size * np.array([0.5, 0.5, -0.5, 0.5])
        x[CRAFT.layout.quaternion] = q
        assert (size - 1) * (q @ CRAFT.dynamics(x)[CRAFT.layout.quaternion]) < 0


def test_power_is_the_rate_of_energy():
    craft = dataclasses.replace(
        busy(), environment=Environment(sun=Sun(direction=(0.0, 0.6, 0.8)), torque=(1.0, 0.0, 0.0))
    )
    t, x, u, w, p = craft.symbols
    from pliant.plants.spacecraft.layout import conserved

    rate = ca.Function("rate", [t, x, u, w, p], [ca.jtimes(conserved(craft, x)[0], x, craft.expressions[0])])
    rng = np.random.default_rng(3)
    at, u, w = anywhere(craft), rng.normal(size=craft.nu), rng.normal(size=craft.nw)
    put_in, lost = craft.power(at, u, w=w)
    assert put_in - lost == pytest.approx(float(rate(0, at, u, w, [])), rel=1e-10)
    assert lost > 0


@pytest.mark.parametrize(
    "made", [busy(), busy("linear", "motion"), busy("stiffened", "angle", translation=False), busy("rigid")]
)
def test_jacobians_are_those_of_the_dynamics(made):
    t, x, u, w, p = made.symbols
    whole = ca.Function("whole", [t, x, u, w, p], [ca.jacobian(e, ca.vertcat(x, u, w)) for e in made.expressions])
    rng = np.random.default_rng(1)
    at, u, w = anywhere(made, size=0.03), rng.normal(size=made.nu), rng.normal(size=made.nw)
    f, h = (np.array(v) for v in whole(2.0, at, u, w, []))
    A, B, E, C, D, F = made.jacobians(at, u, w=w, t=2.0)
    np.testing.assert_allclose(np.hstack([A, B, E]), f, atol=1e-11 * np.abs(f).max())
    np.testing.assert_allclose(np.hstack([C, D, F]), h, atol=1e-12)


def test_mass_matrix_is_positive_definite():
    for seed in range(5):
        M = busy().mass_matrix(anywhere(busy(), seed, size=0.02))
        np.testing.assert_allclose(M, M.T, atol=1e-10)
        assert np.linalg.eigvalsh(M)[0] > 0


def test_mass_matrix_stays_definite_in_large_deflections():
    """Shortening is a field of motion, not a truncated energy."""
    for seed in range(5):
        assert np.linalg.eigvalsh(busy().mass_matrix(anywhere(busy(), seed, size=0.5)))[0] > 0


def test_a_hinge_with_nothing_to_turn_is_said():
    """A slender boom about its own axis."""
    craft = hinged(axes=((1.0, 0.0, 0.0),))
    with pytest.raises(MassMatrixError, match=r"not positive definite .* no inertia about one of its hinge's axes"):
        craft.dynamics(craft.state())


def test_stiff_appendages_tend_to_euler():
    """Composite rigid body by another route: Euler's equations of the whole, integrated by SciPy."""
    I = np.diag(REFERENCE["composite_inertia"])
    start, t = np.array([0.03, 0.05, 0.04]), np.linspace(0, 20, 101)
    euler = solve_ivp(
        lambda s, w: -np.linalg.solve(I, np.cross(w, I @ w)), (0, 20), start, t_eval=t, rtol=1e-11, atol=1e-13
    )
    rigid = dataclasses.replace(CRAFT, kinematics="rigid")
    run = rigid.simulate(rigid.state(dict(zip(("rate_x", "rate_y", "rate_z"), start))), None, t)
    np.testing.assert_allclose(run.x[:, rigid.layout.omega], euler.y.T, atol=1e-10)
    whole, gaps = run.x[:, rigid.layout.quaternion], []
    for factor in (10.0, 40.0):
        parts = tuple(dataclasses.replace(a, stiffness_factor=factor) for a in CRAFT.appendages)
        stiff = dataclasses.replace(CRAFT, appendages=parts)
        x = stiff.state(dict(zip(("rate_x", "rate_y", "rate_z"), start)))
        run = stiff.simulate(x, None, t)
        gaps.append(np.abs(run.x[:, stiff.layout.quaternion] - whole).max())
    assert np.log(gaps[0] / gaps[1]) / np.log(4) == pytest.approx(1, abs=0.15)
    assert gaps[1] < 2e-4


def beside_the_arm(kinematics, size, seed):
    """Hub and modal accelerations of the spacecraft and of SingleLinkArm, in a plane, hub too heavy to be pushed."""
    arm = SingleLinkArm(
        link=BOOM, hub_inertia=180.0, hub_radius=1.0, kinematics=kinematics, basis="clamped-free", modes=2
    )
    hub = Hub(mass=1e13, inertia=(200.0, 150.0, 180.0))
    boom = Appendage(position=(1.0, 0.0, 0.0), body=BOOM, modes=(2, 0))
    craft = FlexibleSpacecraft(hub=hub, appendages=(boom,), kinematics=kinematics)
    rng = np.random.default_rng(seed)
    omega, torque = rng.normal(), 100 * rng.normal()
    eta, rate = size * rng.normal(size=2), size * rng.normal(size=2)
    x = craft.state(rate_z=omega, eta1_1=eta[0], eta1_2=eta[1], eta1_1_rate=rate[0], eta1_2_rate=rate[1])
    found = craft.dynamics(x, [0.0, 0.0, torque])
    wanted = arm.dynamics(np.array([0.0, *eta, omega, *rate]), [torque])[3:]
    return np.concatenate([found[craft.layout.omega][2:], found[craft.layout.mode_rates[0]]]), wanted


@pytest.mark.parametrize("seed", range(5))
def test_one_boom_on_a_heavy_hub_is_the_single_link_arm(seed):
    np.testing.assert_allclose(*beside_the_arm("linear", 0.3, seed), rtol=1e-10, atol=1e-10)
    # stiffened: the arm truncates its energy at the second order, the spacecraft does not: equal to first order in eta
    gaps = [np.abs(np.subtract(*beside_the_arm("stiffened", size, seed))).max() for size in (2e-3, 1e-3)]
    assert gaps[0] / gaps[1] > 3.5  # second order or higher
    np.testing.assert_allclose(*beside_the_arm("stiffened", 1e-6, seed), rtol=1e-8, atol=1e-9)


def test_a_free_hub_carries_the_arm_along():
    """The planar case by hand: one rigid bar on a free hub turns about the common mass centre."""
    bar = ModalData.boom(BOOM, (0, 0))
    craft = FlexibleSpacecraft(
        hub=Hub(mass=500.0, inertia=(200.0, 150.0, 180.0)), appendages=(Appendage(position=(1.0, 0, 0), body=bar),)
    )
    a = craft.dynamics(craft.state(), [0.0, 0.0, 1.0])
    reduced = 500.0 * 10.0 / 510.0
    assert a[craft.layout.omega][2] == pytest.approx(1 / (180.0 + 10 * 25 / 12 + reduced * 3.5**2), rel=1e-12)


def test_translation_left_out_changes_nothing_else():
    full, short = busy(), busy(translation=False)
    x = anywhere(full, size=0.02)
    x[full.layout.position] = 0.0
    cut = np.delete(x, [*range(3), *range(full.layout.velocity.start, full.layout.velocity.stop)])
    a, b = full.dynamics(x, np.ones(full.nu)), short.dynamics(cut, np.ones(short.nu))
    kept = np.delete(np.arange(full.nx), [*range(3), *range(full.layout.velocity.start, full.layout.velocity.stop)])
    np.testing.assert_allclose(a[kept], b, atol=1e-12)


def test_hinge_drives():
    moved = hinged(drive="motion")
    a = moved.dynamics(anywhere(moved), [0, 0, 0, 0.7, -0.2])
    assert [a[s][0] for s in moved.layout.hinge_rates] == [0.7, -0.2]
    turned = hinged(drive="angle", damping=2.0)
    _, u = turned.equilibrium(hinge1_1=0.3, hinge2_1=-0.1)
    np.testing.assert_allclose(u[3:], [0.3, -0.1], atol=1e-12)
    pushed = hinged(drive="torque")
    _, u = pushed.equilibrium(hinge1_1=0.3, hinge2_1=0.0)
    np.testing.assert_allclose(u[3:], [30.0, 0.0], atol=1e-9)


def test_hinge_turns_follow_the_right_hand():
    """A three-axis hinge: the tip of a rigid bar after quarter turns, by hand."""
    hinge = Hinge(axes=((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)))
    craft = FlexibleSpacecraft(
        hub=CRAFT.hub, appendages=(Appendage(position=(1.0, 0, 0), body=ModalData.boom(BOOM, (0, 0)), hinge=hinge),)
    )
    line = craft.outline(craft.state(hinge1_1=np.pi / 2))[0]
    np.testing.assert_allclose(line[-1], [1.0, 5.0, 0.0], atol=1e-12)
    line = craft.outline(craft.state(hinge1_1=np.pi / 2, hinge1_2=np.pi / 2))[0]
    np.testing.assert_allclose(line[-1], [1.0, 0.0, -5.0], atol=1e-12)


def test_spinning_boom_stiffens():
    """Steady spin about z on a heavy hub: in-plane and out-of-plane frequencies as of a rotating beam on a hub."""
    spin, roots = 2.0, {}
    for kinematics in ("linear", "stiffened"):
        boom = Appendage(position=(0.0, 0.0, 0.0), body=BOOM, modes=(0, 4))
        craft = FlexibleSpacecraft(
            hub=Hub(mass=1e12, inertia=(1e12, 1e12, 1e12)), appendages=(boom,), kinematics=kinematics
        )
        found = np.sort(np.abs(craft.linearize(craft.state(rate_z=spin)).eigenvalues.imag))
        roots[kinematics] = found[np.abs(found - spin) > 1e-6]
    from pliant.plants.beams.rotating_beam import rotating_frequencies

    scale = np.sqrt(100.0 / (2.0 * 5.0**4))
    flap = scale * np.asarray(rotating_frequencies(spin / scale, 2, plane="flap"))
    assert np.abs(roots["stiffened"] - flap[0]).min() < 2e-3 * flap[0]
    assert np.abs(roots["stiffened"] - flap[1]).min() < 1e-2 * flap[1]
    assert np.abs(roots["linear"] - flap[0]).min() > 0.05


def test_sunlight_by_hand():
    """A black plate face on, and a mirror at 45 degrees, on a hub without spin."""
    sun = Environment(sun=Sun(direction=(1.0, 0.0, 0.0), pressure=1e-3))

    def push(**surface):
        hub = Hub(mass=10.0, inertia=(1.0, 1.0, 1.0), surfaces=(Surface(area=2.0, **surface),))
        craft = FlexibleSpacecraft(hub=hub, environment=sun)
        return craft.dynamics(craft.state())

    at = FlexibleSpacecraft(hub=CRAFT.hub).layout
    a = push(normal=(1.0, 0.0, 0.0), centre=(0.0, 0.5, 0.0))
    np.testing.assert_allclose(a[at.velocity], [-2e-4, 0, 0], atol=1e-18)
    np.testing.assert_allclose(a[at.omega], [0, 0, 1e-3], atol=1e-18)
    s = np.sqrt(0.5)
    a = push(normal=(s, s, 0.0), specular=1.0)
    np.testing.assert_allclose(a[at.velocity], [-2e-4 * s, -2e-4 * s, 0], atol=1e-18)
    assert not push(normal=(-1.0, 0.0, 0.0)).any()
    np.testing.assert_allclose(push(normal=(-1.0, 0.0, 0.0), both=True)[at.velocity], [-2e-4, 0, 0], atol=1e-18)


def test_orbit_by_hand():
    """A point mass keeps Hill's equations near the orbit; the environment switched off leaves a free body."""
    n, craft = 1.1e-3, FlexibleSpacecraft(hub=CRAFT.hub, environment=Environment(orbit=Orbit(rate=1.1e-3)))
    x = craft.state(position_x=10.0, position_y=-20.0, position_z=30.0, velocity_x=0.1, velocity_y=0.2, velocity_z=-0.3)
    a = craft.dynamics(x)[craft.layout.velocity]
    hill = [2 * n * -0.3, -(n**2) * -20.0, 3 * n**2 * 30.0 - 2 * n * 0.1]  # x along the velocity, z down
    np.testing.assert_allclose(a, hill, atol=1e-9)
    still = dataclasses.replace(busy(), environment=Environment())
    x = still.state(rate_z=0.0)
    assert not still.dynamics(x).any()


def test_varied_parameters():
    craft = hinged().vary("hub.mass", "appendages.0.hinge.stiffness.0", "appendages.1.stiffness_factor")
    p = [400.0, 150.0, 2.0]
    made = hinged()
    parts = (
        dataclasses.replace(made.appendages[0], hinge=Hinge(axes=((0.0, 1.0, 0.0),), stiffness=150.0)),
        dataclasses.replace(made.appendages[1], stiffness_factor=2.0),
    )
    made = dataclasses.replace(made, hub=dataclasses.replace(made.hub, mass=400.0), appendages=parts)
    x = anywhere(made)
    np.testing.assert_allclose(craft.dynamics(x, p=p), made.dynamics(x), atol=1e-12)
    np.testing.assert_allclose(craft.natural_frequencies(p=p), made.natural_frequencies(), rtol=1e-10)


def ring(count):
    """A hub with booms of four modes around it."""
    parts = []
    for k in range(count):
        c, s = np.cos(0.3 * k), np.sin(0.3 * k)
        turn = ((c, -s, 0), (s, c, 0), (0, 0, 1))
        parts.append(Appendage(position=(c, s, 0.1 * k), orientation=turn, body=BOOM, modes=(2, 2)))
    return FlexibleSpacecraft(hub=CRAFT.hub, appendages=tuple(parts))


def test_twenty_appendages_of_four_modes():
    craft = ring(20)
    x = anywhere(craft, size=0.01)
    A = craft.jacobians(x)[0]
    assert A.shape == (173, 173) and len(craft.deviations) == 172
    assert craft._linear.solved.function.n_instructions() < 500_000  # about a millisecond
    modes, rates = craft.layout.modes, craft.layout.mode_rates
    assert np.abs(A[rates[3], modes[17]]).max() > 0  # one boom moves another, through the hub


def test_the_block_arrow_solves_the_whole():
    craft = ring(5)
    x = anywhere(craft, size=0.01)
    M, found = craft.mass_matrix(x), craft.dynamics(x)
    order = [
        *(craft.turn(x).T @ found[craft.layout.velocity]),
        *found[craft.layout.omega],
        *found[craft.layout.rates :],
    ]
    rest = craft.residual(x, np.zeros(len(M)))
    np.testing.assert_allclose(M @ order, -rest, atol=1e-9 * np.abs(rest).max())


def test_ladder_and_labels():
    steps = busy().ladder()
    assert [s.label.split(",")[0] for s in steps] == ["rigid", "linear", "linear", "stiffened", "stiffened"]
    assert all(s.outputs == busy().outputs for s in steps)
    assert all(np.isfinite(s.dynamics(s.state())).all() for s in steps)


def boom(**changes):
    return Appendage(**{"position": (1.0, 0.0, 0.0), "body": BOOM, **changes})


def test_a_count_of_modes_is_of_the_slowest():
    """Modal data in any order: here two modes out of plane, then the one in plane that lies between them."""
    data = ModalData.boom(BOOM, (1, 2))
    assert data.slowest(2).frequencies == pytest.approx([0.994479295645, 1.98895859129], rel=1e-9)
    part = boom(body=data, modes=2)
    np.testing.assert_array_equal(part.data.stiffness, data.slowest(2).stiffness)
    np.testing.assert_allclose(boom(modes=2).data.frequencies, part.data.frequencies, rtol=1e-12)


@pytest.mark.parametrize("axes", [((1.0, 0.0, 0.0),), ((0.0, 1.0, 0.0), (0.0, 1.0, 0.0))], ids=["slender", "parallel"])
def test_a_hinge_that_turns_nothing_has_no_frequency(axes):
    craft = hinged(axes=axes)
    for call in (craft.natural_frequencies, lambda: craft.linearize(craft.state())):
        with pytest.raises(
            MassMatrixError, match="no inertia about one of its hinge's axes, or two of these are paral"
        ):
            call()


def test_a_bare_hub_and_appendages_without_modes():
    """Euler's equations, and a rigid boom beside the same boom of zero modes."""
    bare = dataclasses.replace(CRAFT, appendages=())
    omega = np.array([0.3, -0.2, 0.5])
    x = bare.state(dict(zip(("rate_x", "rate_y", "rate_z"), omega)))
    I = np.array([200.0, 150.0, 180.0])
    np.testing.assert_allclose(bare.dynamics(x)[bare.layout.omega], -np.cross(omega, I * omega) / I, atol=1e-15)
    assert bare.natural_frequencies().size == 0 and bare.linearize(x).A.shape == (12, 12)
    none = dataclasses.replace(CRAFT, appendages=tuple(dataclasses.replace(a, modes=0) for a in CRAFT.appendages))
    rigid = dataclasses.replace(CRAFT, kinematics="rigid")
    x = rigid.state(dict(zip(("rate_x", "rate_y", "rate_z"), omega)))
    np.testing.assert_allclose(none.dynamics(x), rigid.dynamics(x), atol=1e-14)


def test_lists_and_arrays_become_tuples():
    part = boom(position=np.array([1.0, 0.0, 0.0]), hinge=Hinge(axes=[[0.0, 1.0, 0.0]], stiffness=[3.0]))
    assert part.position == (1.0, 0.0, 0.0) and part.hinge.stiffness == (3.0,)
    assert hash(FlexibleSpacecraft(hub=CRAFT.hub, appendages=[part])) is not None


BAD = {
    "hub": (lambda: FlexibleSpacecraft(hub=3.0), r"FlexibleSpacecraft\.hub = 3\.0 must be a Hub"),
    "appendages": (
        lambda: FlexibleSpacecraft(hub=CRAFT.hub, appendages=(BOOM,)),
        r"FlexibleSpacecraft\.appendages = .* must be a tuple of Appendage",
    ),
    "one appendage": (
        lambda: FlexibleSpacecraft(hub=CRAFT.hub, appendages=boom()),
        r"FlexibleSpacecraft\.appendages = .* must be a tuple of Appendage",
    ),
    "environment": (
        lambda: FlexibleSpacecraft(hub=CRAFT.hub, environment=Orbit(rate=1e-3)),
        r"FlexibleSpacecraft\.environment = .* must be an Environment",
    ),
    "translation": (
        lambda: FlexibleSpacecraft(hub=CRAFT.hub, translation="yes"),
        r"FlexibleSpacecraft\.translation = 'yes' must be one of True, False",
    ),
    "no body": (
        lambda: Hub(mass=1.0, inertia=(1.0, 1.0, 5.0)),
        r"the largest principal moment 5 kg m\^2 must be <= 2, the sum of the others",
    ),
    "not symmetric": (
        lambda: Hub(mass=1.0, inertia=((1.0, 0.2, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))),
        r"Hub\.inertia = .* must be symmetric and positive",
    ),
    "hinge": (lambda: boom(hinge="free"), r"Appendage\.hinge = 'free' must be a Hinge"),
    "flat axes": (lambda: Hinge(axes=(0.0, 1.0, 0.0)), r"Hinge\.axes = .* must be a tuple of unit vectors"),
    "negative modes": (lambda: boom(modes=-1), r"Appendage\.modes = -1 must be an integer from 0 to 100"),
    "too many modes": (
        lambda: boom(body=ModalData.boom(BOOM), modes=3),
        r"Appendage\.modes = 3 must be an integer from 0 to 2",
    ),
    "no turn": (lambda: boom(orientation=(0.0, 0.0, 0.0, 0.0)), r"Appendage\.orientation = .* rotation matrix or a q"),
    "zero quaternion": (lambda: CRAFT.simulate(np.zeros(CRAFT.nx), None, [0, 1]), "the quaternion has norm 0, must be"),
    "long quaternion": (
        lambda: CRAFT.linearize(3 * CRAFT.state()),
        "the quaternion has norm 3, must be 1; see `state`",
    ),
    "hub mass": (lambda: Hub(mass=0.0, inertia=(1, 1, 1)), r"Hub\.mass = 0\.0 must be > 0 \[kg\]"),
    "hub inertia": (lambda: Hub(mass=1.0, inertia=(1, -1, 1)), r"Hub\.inertia = .* must be symmetric and positive"),
    "wheel axis": (
        lambda: Wheel(axis=(1.0, 1.0, 0.0), inertia=1.0),
        r"Wheel\.axis = \(1\.0, 1\.0, 0\.0\) must be a unit vector",
    ),
    "hinge axes": (lambda: Hinge(axes=((1.0, 0.0, 0.0),) * 4), r"number of axes = 4 must be an integer from 0 to 3"),
    "hinge axis": (lambda: Hinge(axes=((1.0, 1.0, 0.0),)), r"Hinge\.axes\[0\] = .* must be a unit vector"),
    "hinge stiffness": (
        lambda: Hinge(axes=((1.0, 0, 0),), stiffness=-1.0),
        r"Hinge\.stiffness\[0\] = -1\.0 must be >= 0",
    ),
    "hinge count": (
        lambda: Hinge(axes=((1.0, 0, 0),), stiffness=(1.0, 2.0)),
        r"Hinge\.stiffness .* one value for each of 1",
    ),
    "drive": (lambda: Hinge(drive="belt"), r"Hinge\.drive = 'belt' must be one of 'free'"),
    "orientation": (
        lambda: boom(orientation=((1, 0, 0), (0, 1, 0), (0, 0, -1))),
        r"Appendage\.orientation .* rotation matrix",
    ),
    "body": (lambda: boom(body="boom"), r"Appendage\.body = 'boom' must be a Beam or ModalData"),
    "pair of modes": (
        lambda: boom(body=ModalData.boom(BOOM), modes=(1, 1)),
        r"Appendage\.modes = \(1, 1\) must be a count",
    ),
    "kinematics": (
        lambda: FlexibleSpacecraft(hub=CRAFT.hub, kinematics="strain"),
        r"kinematics = 'strain' must be one of",
    ),
    "attitude": (
        lambda: CRAFT.linearize(CRAFT.state(), attitude="euler"),
        r"linearize\.attitude = 'euler' must be one of",
    ),
    "state": (lambda: CRAFT.state(rate=1.0), r"state 'rate' must be one of position_x"),
    "sun": (lambda: Sun(direction=(1.0, 1.0, 0.0)), r"Sun\.direction = .* must be a unit vector"),
    "surface": (
        lambda: Surface(area=1.0, normal=(1.0, 0, 0), specular=0.7, diffuse=0.7),
        r"specular \+ diffuse = 1\.4 must be <= 1",
    ),
    "orbit": (lambda: Orbit(rate=-1.0), r"Orbit\.rate = -1\.0 must be > 0 \[rad/s\]"),
    "varied body": (
        lambda: CRAFT.vary("appendages.0.body.E").dynamics(CRAFT.state()),
        r"vary its stiffness_factor instead",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input(name):
    make, words = BAD[name]
    with pytest.raises(ValueError, match=words):
        make()
