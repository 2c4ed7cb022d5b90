"""Frequencies of trees against closed forms, rotating beams and frames of finite elements."""

import numpy as np

from pliant.plants import (
    Beam,
    FlexibleTree,
    Joint,
    Payload,
    TreeBody,
    beams,
)


def test_torsion_and_stretch_have_their_closed_form_frequencies():
    """A clamped rod: (k - 1/2) pi/L times the wave speed; sqrt(G J/(rho I_p)) and sqrt(E/rho)."""
    beam = Beam.circular(1.2, 0.02, beams.STEEL)
    body = TreeBody(name="rod", joint=Joint(name="j", drive="acceleration"), beam=beam, modes=(0, 0, 2, 2))
    tree = FlexibleTree.serial([body], basis="clamped-free", gravity=(0, 0, 0))
    waves = np.sqrt([beam.G * beam.J / (beam.density * beam.polar_moment), beam.E / beam.density])
    closed = np.sort(np.outer(waves, (np.arange(2) + 0.5) * np.pi / beam.length).ravel())
    np.testing.assert_allclose(tree.natural_frequencies(), closed, rtol=1e-10)


def test_spinning_beam_has_the_frequencies_of_a_rotating_one():
    """Both planes against `beams.rotating_frequencies`, a series of its own that is tested by published tables."""
    beam = Beam(length=1.0, area=1e-4, I_y=2e-9, I_z=1e-9, J=2e-9, density=2700.0, E=7e10, G=2.7e10)
    body = TreeBody(name="b", joint=Joint(name="j", drive="acceleration"), beam=beam, modes=(8, 8, 0, 0))
    tree = FlexibleTree.serial([body], gravity=(0, 0, 0))
    x = np.zeros(tree.nx)
    for plane, moment, at in (("lag", beam.I_z, slice(1, 9)), ("flap", beam.I_y, slice(9, 17))):
        unit = np.sqrt(beam.E * moment / (beam.linear_density * beam.length**4))
        x[17] = 3.0 * unit
        A = tree.jacobians(x)[0][17:, :17]
        found = np.sort(np.sqrt(np.linalg.eigvals(-A[at, at]).real))[:3] / unit
        wanted = beams.rotating_frequencies(3.0, 3, plane=plane, stiffened=True)
        np.testing.assert_allclose(found, wanted, rtol=1e-6)


def frame_element(beam, length):
    """(M, K) (12, 12) of an Euler-Bernoulli beam element in space, cubic shapes, linear stretch and twist; node
    freedoms x, y, z and turns about them (J. S. Przemieniecki, "Theory of Matrix Structural Analysis", 1968).
    """
    M, K, rho = np.zeros((12, 12)), np.zeros((12, 12)), beam.linear_density
    for (i, j), mass, stiffness in (
        ((0, 6), rho, beam.E * beam.area),
        ((3, 9), beam.density * beam.polar_moment, beam.G * beam.J),
    ):
        at = np.ix_((i, j), (i, j))
        M[at] += mass * length / 6 * np.array([[2, 1], [1, 2]])
        K[at] += stiffness / length * np.array([[1, -1], [-1, 1]])
    a = length
    bent = np.array([[156, 22 * a, 54, -13 * a], [22 * a, 4 * a**2, 13 * a, -3 * a**2], [54, 13 * a, 156, -22 * a],
                     [-13 * a, -3 * a**2, -22 * a, 4 * a**2]])  # fmt: skip
    stiff = np.array([[12, 6 * a, -12, 6 * a], [6 * a, 4 * a**2, -6 * a, 2 * a**2], [-12, -6 * a, 12, -6 * a],
                      [6 * a, 2 * a**2, -6 * a, 4 * a**2]])  # fmt: skip
    for rows, EI, sign in (((1, 5, 7, 11), beam.E * beam.I_z, 1.0), ((2, 4, 8, 10), beam.E * beam.I_y, -1.0)):
        s = np.outer([1, sign, 1, sign], [1, sign, 1, sign])
        M[np.ix_(rows, rows)] += rho * a / 420 * bent * s
        K[np.ix_(rows, rows)] += EI / a**3 * stiff * s
    return M, K


def test_a_bent_frame_has_the_frequencies_of_frame_elements():
    """Two beams welded at an angle in space with a load at the end, against 2 x 24 elements of the textbook."""
    first = Beam(length=0.9, area=1e-4, I_y=2e-9, I_z=1e-9, J=2.5e-9, density=2700.0, E=7e10, G=2.7e10)
    second = Beam(length=0.6, area=8e-5, I_y=6e-10, I_z=9e-10, J=1.2e-9, density=2700.0, E=7e10, G=2.7e10)
    rpy, load = (0.4, -0.7, 1.1), Payload(mass=0.3, inertia=0.002)
    bodies = [
        TreeBody(name="a", joint=Joint(name="held", drive="acceleration"), beam=first, modes=(7, 7, 4, 4)),
        TreeBody(name="b", joint=Joint(name="weld", kind="fixed", rotation=rpy), beam=second, modes=(7, 7, 4, 4)),
    ]
    tree = FlexibleTree.serial(bodies, payload=load, gravity=(0, 0, 0))
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    R = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]]) @ np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    R = R @ np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    count = 24
    M, K = np.zeros((2, 6 * (2 * count + 1), 6 * (2 * count + 1)))
    for k in range(2 * count):
        beam, turn = (first, np.eye(3)) if k < count else (second, R)
        T = np.kron(np.eye(4), turn)
        at = slice(6 * k, 6 * k + 12)
        own, stiff = frame_element(beam, beam.length / count)
        M[at, at] += T @ own @ T.T
        K[at, at] += T @ stiff @ T.T
    M[-6:, -6:] += np.diag([load.mass] * 3 + [load.inertia] * 3)
    values = np.sort(np.linalg.eigvals(np.linalg.solve(M[6:, 6:], K[6:, 6:])).real)
    np.testing.assert_allclose(tree.natural_frequencies()[:8], np.sqrt(values[:8]), rtol=2e-5)
