"""The equations of motion against Euler's, the single-link arm, rotating beams and numbers by hand."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest
from evidence import agrees
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from pliant.plants import Beam, MassMatrixError, SingleLinkArm
from pliant.plants.beams.rotating_beam import rotating_frequencies
from pliant.plants.modal_data.modal_data import ModalData
from pliant.plants.spacecraft.plant import FlexibleSpacecraft
from pliant.plants.spacecraft_parts.appendage import Appendage, Hinge
from pliant.plants.spacecraft_parts.environment import Environment, Orbit, Sun, Surface
from pliant.plants.spacecraft_parts.hub import Hub

REFERENCE = json.loads((Path(__file__).parents[2] / "reference" / "spacecraft.json").read_text())
BOOM = Beam(length=5.0, area=1e-3, I_y=1e-7, I_z=4e-7, J=4e-7, density=2000.0, E=1e9, G=4e8)
CRAFT = dataclasses.replace(FlexibleSpacecraft.textbook(), kinematics="linear")


def test_norm_of_the_quaternion_returns():
    x = CRAFT.state(rate_x=0.3)
    for size in (1.01, 0.99):
        q = size * np.array([0.5, 0.5, -0.5, 0.5])
        x[CRAFT.layout.quaternion] = q
        assert (size - 1) * (q @ CRAFT.dynamics(x)[CRAFT.layout.quaternion]) < 0


def test_mass_matrix_is_positive_definite(busy, anywhere):
    for seed in range(5):
        M = busy().mass_matrix(anywhere(busy(), seed, size=0.02))
        np.testing.assert_allclose(M, M.T, atol=1e-10)
        assert np.linalg.eigvalsh(M)[0] > 0


def test_mass_matrix_stays_definite_in_large_deflections(busy, anywhere):
    """Shortening is a field of motion, not a truncated energy."""
    for seed in range(5):
        assert np.linalg.eigvalsh(busy().mass_matrix(anywhere(busy(), seed, size=0.5)))[0] > 0


def test_a_hinge_with_nothing_to_turn_is_said(hinged):
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
    agrees(
        run.x[:, rigid.layout.omega],
        euler.y.T,
        within=1e-10,
        absolute=True,
        of="FlexibleSpacecraft",
        what="rates of a tumbling rigid craft",
        source="Euler's equations, integrated by SciPy",
        kind="closed form",
    )
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


def test_translation_left_out_changes_nothing_else(busy, anywhere):
    full, short = busy(), busy(translation=False)
    x = anywhere(full, size=0.02)
    x[full.layout.position] = 0.0
    cut = np.delete(x, [*range(3), *range(full.layout.velocity.start, full.layout.velocity.stop)])
    a, b = full.dynamics(x, np.ones(full.nu)), short.dynamics(cut, np.ones(short.nu))
    kept = np.delete(np.arange(full.nx), [*range(3), *range(full.layout.velocity.start, full.layout.velocity.stop)])
    np.testing.assert_allclose(a[kept], b, atol=1e-12)


def test_hinge_drives(hinged, anywhere):
    moved = hinged(drive="motion")
    a = moved.dynamics(anywhere(moved), [0, 0, 0, 0.7, -0.2])
    assert [a[s][0] for s in moved.layout.hinge_rates] == [0.7, -0.2]
    turned = hinged(drive="angle", damping=2.0)
    _, u = turned.equilibrium(hinge1_1=0.3, hinge2_1=-0.1)
    np.testing.assert_allclose(u[3:], [0.3, -0.1], atol=1e-12)
    pushed = hinged(drive="torque")
    _, u = pushed.equilibrium(hinge1_1=0.3, hinge2_1=0.0)
    np.testing.assert_allclose(u[3:], [30.0, 0.0], atol=1e-9)


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
    scale = np.sqrt(100.0 / (2.0 * 5.0**4))
    flap = scale * np.asarray(rotating_frequencies(spin / scale, 2, plane="flap"))
    assert np.abs(roots["stiffened"] - flap[0]).min() < 2e-3 * flap[0]
    assert np.abs(roots["stiffened"] - flap[1]).min() < 1e-2 * flap[1]
    assert np.abs(roots["linear"] - flap[0]).min() > 0.05


def boom(**changes):
    return Appendage(**{"position": (1.0, 0.0, 0.0), "body": BOOM, **changes})


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


def bent_points(stiffened, seed=4):
    """A hub that gravity does not turn with one body of mass points on a hinge, bent far; what every point's position
    and its rates with the unknowns are, computed point by point.
    """
    rng = np.random.default_rng(seed)
    r, dm, phi = rng.normal(size=(9, 3)), rng.uniform(0.5, 2.0, 9), rng.normal(size=(2, 9, 3))
    g = rng.normal(size=(2, 2, 9, 3))
    g = (g + g.swapaxes(0, 1)) * stiffened
    data = ModalData.from_nodes(r, dm, phi, frequencies=[1.0, 2.0], shortening=g)
    mounted, axis, b = Rotation.from_rotvec([0.3, -0.8, 0.5]), np.array([0.6, 0.0, 0.8]), np.array([1.0, 0.5, -0.3])
    part = Appendage(
        position=tuple(b),
        orientation=mounted.as_matrix(),
        body=data,
        hinge=Hinge(axes=(tuple(axis),)),
        surface=Surface(area=3.0, normal=(0.0, 0.6, 0.8), both=True),
    )
    craft = FlexibleSpacecraft(hub=Hub(mass=50.0, inertia=(20.0, 20.0, 20.0)), appendages=(part,))
    craft = dataclasses.replace(craft, kinematics="stiffened" if stiffened else "linear")
    eta, theta, turned = np.array([0.4, -0.7]), 0.9, Rotation.from_rotvec([0.4, 0.2, -0.7])
    x = craft.state(hinge1_1=theta, eta1_1=eta[0], eta1_2=eta[1], position_x=900.0, position_z=-400.0)
    x[craft.layout.quaternion] = np.roll(turned.as_quat(), 1)
    C = (mounted * Rotation.from_rotvec(theta * axis)).as_matrix()
    s = r + np.einsum("k,kpi->pi", eta, phi) - np.einsum("klpi,k,l->pi", g, eta, eta) / 2
    slopes = phi - np.einsum("klpi,l->kpi", g, eta)
    arms, along = b + s @ C.T, np.cross(mounted.apply(axis), s @ C.T)  # hub axes

    def collected(forces):
        """Forces (9, 3) in hub axes -> those of the unknowns: force, torque about the hub, hinge torque, modal."""
        modal = np.einsum("kpi,pi->k", slopes @ C.T, forces)
        return np.concatenate([forces.sum(axis=0), np.cross(arms, forces).sum(axis=0), [(along * forces).sum()], modal])

    return craft, x, turned.as_matrix(), C, dm, arms, collected


def load_on(craft, x, environment, without):
    """What an environment puts into the equations beyond another, at rest."""
    zero = np.zeros(len(craft.mass_matrix(x)))
    one, other = (dataclasses.replace(craft, environment=e).residual(x, zero) for e in (environment, without))
    return other - one


@pytest.mark.parametrize("stiffened", [False, True], ids=["linear", "stiffened"])
def test_gravity_on_a_bent_appendage_is_newtons_on_its_points(stiffened):
    """Newton's attraction of every point, less what holds the orbit: no gradient and no integral of modes in between.

    The library's gradient is the first term of the difference in gravity; the second is r/R = 1e-6 of it.
    """
    craft, x, R, _, dm, arms, collected = bent_points(stiffened)
    rate, radius = 1.1e-3, 6.778e6
    hub = x[craft.layout.position]

    def attraction(places):
        """(.., 3) [m/s^2] in orbit axes at places relative to the orbit, z towards the centre."""
        X = places - [0.0, 0.0, radius]
        distance = np.linalg.norm(X, axis=-1, keepdims=True)
        return -(rate**2) * radius**3 * X / distance**3 - [0.0, 0.0, rate**2 * radius]

    wanted = collected(dm[:, None] * attraction(hub + arms @ R.T) @ R)
    wanted[:3] += 50.0 * R.T @ attraction(hub)
    orbit = Orbit(rate=rate, radius=radius)
    still = Environment(orbit=dataclasses.replace(orbit, gravity=False))
    found = load_on(craft, x, Environment(orbit=orbit), still)
    np.testing.assert_allclose(found, wanted, rtol=1e-5, atol=1e-5 * np.abs(wanted[3:]).min())


@pytest.mark.parametrize("stiffened", [False, True], ids=["linear", "stiffened"])
def test_sunlight_on_a_bent_appendage_is_the_light_on_its_points(stiffened):
    """A black plate takes the light's momentum, P A cos(sun, normal), spread over the points as their mass is."""
    craft, x, R, C, dm, _, collected = bent_points(stiffened)
    sun, pressure = np.array([0.48, -0.6, 0.64]), 2.0
    seen = C.T @ R.T @ sun
    push = -pressure * 3.0 * abs(seen @ [0.0, 0.6, 0.8]) * (R.T @ sun)
    wanted = collected(dm[:, None] / dm.sum() * push)
    found = load_on(craft, x, Environment(sun=Sun(direction=tuple(sun), pressure=pressure)), Environment())
    np.testing.assert_allclose(found, wanted, rtol=1e-12, atol=1e-12)
