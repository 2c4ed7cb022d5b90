"""Energies and tips of both arms against points followed through space, their rates by complex step."""

import dataclasses

import numpy as np
import pytest

from pliant.plants import Payload, SingleLinkArm, TwoLinkArm

NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)
XI, WEIGHTS = (1 + NODES) / 2, WEIGHTS / 2
H = 1e-30
PAYLOAD = Payload(mass=0.6, inertia=0.003, offset=(0.05, -0.08, 0.0))
TWO = dataclasses.replace(TwoLinkArm.textbook(), payload=PAYLOAD, hub_inertia=(0.1, 0.02), modes=(2, 3))
ONE = dataclasses.replace(SingleLinkArm.textbook(), payload=PAYLOAD, gravity=9.81, modes=3)
ARMS = {
    "two": TWO,
    "two no slope": dataclasses.replace(TWO, tip_slope=False),
    "two polynomial": dataclasses.replace(TWO, basis="polynomial"),
    "two payload": dataclasses.replace(TWO, basis="payload"),
    "one": dataclasses.replace(ONE, kinematics="linear"),
    "one rigid": dataclasses.replace(ONE, kinematics="rigid"),
}


def points(link, q, root, turn, shortened):
    """Points (40,) and tip of a link, complex numbers x + j y kept as pairs, its slope at the tip."""
    L, phi = link.beam.length, link.basis.phi

    def at(xi):
        x = L * xi
        if shortened:
            inner = np.multiply.outer(xi, XI)
            x = x - xi * ((phi(inner, 1) @ q) ** 2 @ WEIGHTS) / (2 * L)
        y = phi(xi) @ q
        c, s = np.cos(turn), np.sin(turn)
        return np.array([root[0] + c * x - s * y, root[1] + s * x + c * y])

    return at(XI), at(np.array(1.0)), phi(1.0, 1) @ q / L


def bodies(arm, q):
    """Everything with mass: [(mass (k,), position (2, k))], [(inertia, angle)], and the tip (2,)."""
    stiffened = arm.kinematics == "stiffened"
    zero = np.zeros(2)
    if isinstance(arm, SingleLinkArm):
        line, tip, slope = points(arm.elastic, q[1:], zero, q[0], stiffened)
        masses, turning = [(arm.link.mass * WEIGHTS, line)], [(arm.hub_inertia, q[0])]
        angle = q[0] + slope
    else:
        n1 = arm.mode_counts[0]
        first, elbow, slope = points(arm.links[0], q[2 : 2 + n1], zero, q[0], stiffened)
        turn = q[0] + q[1] + (slope if arm.tip_slope else 0.0)
        second, tip, last = points(arm.links[1], q[2 + n1 :], elbow, turn, stiffened)
        masses = [(arm.link1.mass * WEIGHTS, first), (arm.link2.mass * WEIGHTS, second)]
        masses += [(np.array([arm.joint_mass]), elbow[:, None])]
        turning = [(arm.hub_inertia[0], q[0]), (arm.hub_inertia[1], turn)]
        angle = turn + last
    c, s, (ox, oy) = np.cos(angle), np.sin(angle), arm.payload.offset[:2]
    load = np.array([tip[0] + c * ox - s * oy, tip[1] + s * ox + c * oy])
    masses += [(np.array([arm.payload.mass]), load[:, None])]
    return masses, [*turning, (arm.payload.inertia_z, angle)], tip


def energies(arm, x):
    """(T, V without strain) [J] and the tip (2,)."""
    n = arm.nx // 2
    masses, turning, tip = bodies(arm, x[:n] + 1j * H * x[n:])
    T = sum(m @ ((r.imag / H) ** 2).sum(axis=0) / 2 for m, r in masses)
    T += sum(J * (np.imag(a) / H) ** 2 / 2 for J, a in turning)
    return T, 9.81 * sum(m @ r[1].real for m, r in masses), tip.real


def strain(arm, x):
    n = arm.nx // 2
    links = (arm.elastic,) if isinstance(arm, SingleLinkArm) else arm.links
    start, V = (1 if len(links) == 1 else 2), 0.0
    for link in links:
        q = x[start : start + link.basis.n]
        V += link.beam.EI / (2 * link.beam.length**3) * WEIGHTS @ (link.basis.phi(XI, 2) @ q) ** 2
        start += link.basis.n
    assert start == n
    return V


def place(arm, x):
    """The tip (2,) [m] at a state x."""
    return arm.measure(x)[[i for i, s in enumerate(arm.outputs) if s.name in ("tip_x", "tip_y")]]


@pytest.mark.parametrize("name", list(ARMS))
def test_energies_and_tip_are_those_of_the_points(name, random_state):
    arm = ARMS[name]
    for seed in range(5):
        x = random_state(arm, seed)
        T, V, tip = energies(arm, x)
        assert arm.kinetic(x) == pytest.approx(T, rel=1e-12)
        assert arm.potential(x) == pytest.approx(V + strain(arm, x), rel=1e-11, abs=1e-12)
        np.testing.assert_allclose(place(arm, x), tip, rtol=0, atol=1e-14)


@pytest.mark.parametrize("arm", [TWO, ONE], ids=["two", "one"])
def test_stiffened_energies_are_exact_to_second_order_in_the_deflection(arm, random_state):
    """What is left out of T (s ds/dt and s^2) is of third order; V and the tip are exact."""
    arm = dataclasses.replace(arm, kinematics="stiffened", basis="polynomial")
    n, k = arm.nx // 2, arm.nu
    x = random_state(arm, 8)
    sizes, missing = np.array([1.0, 1 / 8, 1 / 16, 1 / 32]), []
    for size in sizes:
        z = x.copy()
        z[k:n] *= size
        z[n + k :] *= size
        T, V, tip = energies(arm, z)
        missing.append(abs(arm.kinetic(z) - T))
        assert arm.potential(z) == pytest.approx(V + strain(arm, z), rel=1e-11)
        np.testing.assert_allclose(place(arm, z), tip, rtol=0, atol=1e-14)
    assert np.polyfit(np.log(sizes[1:]), np.log(missing[1:]), 1)[0] > 2.7
    assert missing[0] < 0.1 * abs(arm.kinetic(x) - arm.kinetic(np.where(np.arange(arm.nx) % n < k, x, 0.0)))
