"""Links of exact rotations against points followed through space, elliptic integrals, a large beam, stiffened links."""

import dataclasses

import exact_rotations
import numpy as np
import pytest
from evidence import agrees
from scipy.linalg import eigh
from scipy.optimize import root

from pliant.envs import scenes
from pliant.plants import Beam, LargeDeflectionBeam, Payload, SingleLinkArm, TwoLinkArm
from pliant.plants.beams import STEEL
from pliant.plants.exact_rotations.quadrature import points
from pliant.plants.exact_rotations.strain_link import WITHIN, StrainLink, elastic_link, enough

NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)
XI, WEIGHTS = (1 + NODES) / 2, WEIGHTS / 2
H = 1e-30
PAYLOAD = Payload(mass=0.6, inertia=0.003, offset=(0.05, -0.08, 0.0))
ONE = dataclasses.replace(
    SingleLinkArm.textbook(), kinematics="strain", payload=PAYLOAD, gravity=9.81, hub_radius=0.2, modes=3
)
TWO = dataclasses.replace(
    TwoLinkArm.textbook(), kinematics="strain", basis="payload", payload=PAYLOAD, hub_inertia=(0.1, 0.02), modes=(2, 3)
)
ARMS = {
    "one": ONE,
    "one polynomial": dataclasses.replace(ONE, basis="polynomial"),
    "one sheared": dataclasses.replace(ONE, theory="timoshenko"),
    "two": TWO,
    "two no slope": dataclasses.replace(TWO, tip_slope=False),
}


def followed(link, q, start, turn):
    """Points (2, 40), section angles (40,), tip (2,) and its angle of a link: integrals of its tangents, complex q."""
    L, phi = link.beam.length, link.basis.phi
    sheared = hasattr(phi, "rotation")

    def tangent(xi):
        angle = turn + (phi.rotation(xi) if sheared else phi(xi, 1)) @ q / L
        gamma = phi.shear_strain(xi) @ q / L if sheared else 0.0
        c, s = np.cos(angle), np.sin(angle)
        return np.array([c - gamma * s, s + gamma * c]), angle

    inner = tangent(np.multiply.outer(XI, XI))[0]
    line = start[:, None] + L * XI * (inner @ WEIGHTS)
    at, angles = tangent(XI)
    return line, angles, start + L * at @ WEIGHTS, tangent(np.array([1.0]))[1][0]


def bodies(arm, q):
    """[(mass (k,), position (2, k))], [(inertia, angle)], and the tip (2,)."""
    if isinstance(arm, SingleLinkArm):
        hub = arm.hub_radius * np.array([np.cos(q[0]), np.sin(q[0])])
        line, angles, tip, angle = followed(arm.elastic, q[1:], hub, q[0])
        masses, turning = [(arm.link.mass * WEIGHTS, line)], [(np.array([arm.hub_inertia]), q[:1])]
        sections = [(arm.link, angles)]
    else:
        n1 = arm.mode_counts[0]
        first, angles1, elbow, bent = followed(arm.links[0], q[2 : 2 + n1], np.zeros(2), q[0])
        turn = q[1] + (bent if arm.tip_slope else q[0])
        second, angles2, tip, angle = followed(arm.links[1], q[2 + n1 :], elbow, turn)
        masses = [(arm.link1.mass * WEIGHTS, first), (arm.link2.mass * WEIGHTS, second)]
        masses += [(np.array([arm.joint_mass]), elbow[:, None])]
        turning = [(np.array(arm.hub_inertia), np.array([q[0], turn]))]
        sections = [(arm.link1, angles1), (arm.link2, angles2)]
    turning += [(beam.density * beam.I_z * beam.length * WEIGHTS, a) for beam, a in sections]
    c, s, (ox, oy) = np.cos(angle), np.sin(angle), arm.payload.offset[:2]
    load = np.array([tip[0] + c * ox - s * oy, tip[1] + s * ox + c * oy])
    masses += [(np.array([arm.payload.mass]), load[:, None])]
    return masses, [*turning, (np.array([arm.payload.inertia_z]), np.array([angle]))], tip


def state(arm, bend, seed):
    """A state with its links bent by `bend` [rad] at most by each coordinate, and rates alike."""
    rng = np.random.default_rng(seed)
    n, k = arm.nx // 2, arm.nu
    x = rng.uniform(-1, 1, arm.nx)
    links = (arm.elastic,) if isinstance(arm, SingleLinkArm) else arm.links
    xi = np.linspace(0, 1, 201)
    steep = []
    for link in links:
        phi = link.basis.phi
        psi = phi.rotation(xi) if hasattr(phi, "rotation") else phi(xi, 1)
        steep += [link.beam.length / np.abs(psi).max(axis=0) / 4.0 ** np.arange(link.basis.n)]
    for part in (slice(k, n), slice(n + k, 2 * n)):
        x[part] *= bend * np.concatenate(steep)
    return x


@pytest.mark.parametrize(("bend", "rel"), [(1.0, WITHIN), (0.03, 3e-6)])
@pytest.mark.parametrize("name", list(ARMS))
def test_energies_and_tip_are_those_of_the_points(name, bend, rel):
    """Straight they agree to rounding; the error of the rule that `enough` takes grows with the square of the bend."""
    arm = ARMS[name]
    for seed in range(3):
        x = state(arm, bend, seed)
        n = arm.nx // 2
        masses, turning, tip = bodies(arm, x[:n] + 1j * H * x[n:])
        T = sum(m @ ((r.imag / H) ** 2).sum(axis=0) / 2 for m, r in masses)
        T += sum(J @ (a.imag / H) ** 2 / 2 for J, a in turning)
        assert arm.kinetic(x) == pytest.approx(T, rel=rel)
        lifted = 9.81 * sum(m @ r[1].real for m, r in masses)
        straight = np.where(np.arange(arm.nx) < arm.nu, 0.0, x)
        level = 9.81 * sum(m @ r[1].real for m, r in bodies(arm, straight[:n] + 0j)[0])
        weight = 9.81 * sum(m.sum() for m, _ in masses) * 2
        assert arm.potential(x) - arm.potential(straight) == pytest.approx(lifted - level, abs=rel * weight)
        got = dict(zip((s.name for s in arm.outputs), arm.measure(x)))
        np.testing.assert_allclose([got["tip_x"], got["tip_y"]], tip.real, rtol=0, atol=rel)


@pytest.mark.parametrize("load", [1.0, 10.0])
def test_static_tip_load_against_elliptic_integrals(load):
    """K. Mattiasson, Int. J. Numer. Methods Eng. 17 (1981), 145, table I: 1 - x/L and y/L of a tip force across."""
    shortened, across = {1.0: (0.05643, 0.30172), 10.0: (0.55500, 0.81061)}[load]
    beam = Beam.circular(2.0, 0.01, STEEL)
    arm = SingleLinkArm(link=beam, kinematics="strain", basis="polynomial", modes=6, drive="motion")
    force = load * beam.EI / beam.length**2
    n = arm.nx // 2
    x = np.zeros(arm.nx)
    for scale in np.linspace(0.1, 1.0, 10):  # at rest M a is the unbalanced force
        w = np.array([0.0, scale * force])

        def lacking(q: np.ndarray) -> np.ndarray:
            at = np.concatenate([[0.0], q, np.zeros(n)])
            return (arm.mass_matrix(at) @ arm.dynamics(at, w=w)[n:])[1:]  # noqa: B023

        x[1:n] = root(lacking, x[1:n], tol=1e-12).x
    y = dict(zip((s.name for s in arm.outputs), arm.measure(x)))
    agrees(
        [1 - y["tip_x"] / 2.0, y["tip_deflection"] / 2.0],
        [shortened, across],
        within=6e-6,
        absolute=True,
        of="SingleLinkArm",
        what=f"tip under {load:g} E I/L^2, kinematics strain",
        source="Mattiasson (1981), table I",
        kind="table",
    )
    assert y["root_curvature"] == pytest.approx(
        force * y["tip_x"] / beam.EI, rel=5e-3
    )  # by moments; curvatures converge last


@pytest.mark.campaign
@pytest.mark.parametrize("modes", [2, 3])
def test_spin_up_is_that_of_the_large_deflection_beam(modes):
    """The beam of scene spin-up, turned so fast that its tip lags by a fifth of its length."""
    scene = scenes.get("spin-up", speed=4.0, time=3.5)
    arm = dataclasses.replace(scene.plant, kinematics="strain", basis="polynomial", modes=modes)
    options = {"gravity": (0.0, 0.0, 0.0), "basis": "polynomial", "modes": modes, "points": 24}
    beam = LargeDeflectionBeam(beam=scene.plant.link, root="driven", **options)
    times = scene.times[: len(scene.times) // 2 : 5]
    u = np.array([scene.nominal_input(t) for t in times])
    got, true = (p.simulate(np.zeros(p.nx), u, times, rtol=1e-9, atol=1e-11) for p in (arm, beam))
    assert np.abs(true["tip_deflection"]).max() > 1.9
    for name in ("tip_x", "tip_y", "tip_deflection"):
        np.testing.assert_allclose(got[name], true[name], rtol=0, atol=1e-6)


@pytest.mark.parametrize("arm", [ONE, TWO], ids=["one", "two"])
def test_small_angles_tend_to_the_stiffened_arm(arm):
    """Accelerations of both at slopes and rates smaller and smaller: they part with the cube. Thin sections, so that
    rotary inertia, which the stiffened arm leaves out, is below what is compared.
    """
    thin = {"I_y": 1e-18, "I_z": 1e-18, "E": 210e9 * 1e9}
    names = ("link",) if isinstance(arm, SingleLinkArm) else ("link1", "link2")
    arm = dataclasses.replace(
        arm, basis="polynomial", **{n: dataclasses.replace(getattr(arm, n), **thin) for n in names}
    )
    arm = dataclasses.replace(arm, payload=Payload(mass=0.6, inertia=0.003), gravity=0.0)
    stiff = dataclasses.replace(arm, kinematics="stiffened")
    sizes, parted = np.array([0.2, 0.1, 0.05]), []
    x = state(arm, 1.0, 7)
    n = arm.nx // 2
    for size in sizes:
        z = size * x
        z[: arm.nu] = x[: arm.nu]
        parted.append(np.abs((arm.mass_matrix(z) @ arm.dynamics(z)[n:]) - stiff.mass_matrix(z) @ stiff.dynamics(z)[n:]))
    order = np.polyfit(np.log(sizes), np.log([np.abs(p).max() for p in parted]), 1)[0]
    assert order > 2.7
    assert np.abs(arm.mass_matrix(np.zeros(arm.nx)) - stiff.mass_matrix(np.zeros(arm.nx))).max() < 1e-10


def test_points_are_as_few_as_a_bend_of_a_radian_allows():
    """Fewer by one err by more than WITHIN in the inertia of the bent link, for some combination of rates. Exact are
    integrals of integrals by 40 points each.
    """
    basis = ONE.elastic.basis
    link = elastic_link("strain", ONE.link, basis)
    assert isinstance(link, StrainLink) and enough(basis) is link.points
    straight, bent = np.zeros(basis.n), np.zeros(basis.n)
    bent[0] = 1.0 / np.abs(basis.phi(np.linspace(0.0, 1.0, 101), 1)[:, 0]).max()

    def turning(xi, q):
        psi = basis.phi(xi, 1)
        angle, each = psi @ q, np.concatenate([np.ones((*xi.shape, 1)), psi], axis=-1)
        return np.array([-np.sin(angle)[..., None] * each, np.cos(angle)[..., None] * each])

    def exact(q):
        moved = XI[:, None] * np.einsum("ckbi,b->cki", turning(np.multiply.outer(XI, XI), q), WEIGHTS)
        return np.einsum("cki,k,ckj->ij", moved, WEIGHTS, moved)

    def error(m):
        at = points(m)
        rule = [np.einsum("ab,cbi->cai", at.root, turning(at.xi, q)) for q in (bent, straight)]
        more, less = (np.einsum("cai,caj->ij", r, r) for r in rule)
        return np.abs(eigh(more - less + exact(straight) - exact(bent), exact(bent), eigvals_only=True)).max()

    count = len(link.points.xi)
    assert error(count) <= WITHIN < error(count - 1)


def test_frames_that_hold_for_small_slopes_alone_are_refused():
    with pytest.raises(ValueError, match=r"frame = 'pinned' must be 'clamped' where kinematics = 'strain'"):
        dataclasses.replace(ONE, frame="pinned")
    with pytest.raises(ValueError, match=r"must be 'clamped' where kinematics = 'strain'"):
        ONE.frame_map("pinned-pinned")


def test_what_is_claimed_holds_on_a_sample_of_random_arms():
    rows = [exact_rotations.run(seed) for seed in (1,)]
    assert not [row for row in rows if row["wrong"]], rows
