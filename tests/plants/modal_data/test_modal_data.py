"""Modal data against closed forms (Young and Felgar 1949; Blevins 1979), by three routes, and its bad input."""

import struct
import sys
import types
from pathlib import Path

import numpy as np
import pytest

from pliant.plants import Beam
from pliant.plants.core.quaternions import matrix_of, quaternion, skew
from pliant.plants.modal_data.component_modes import read_nastran
from pliant.plants.modal_data.modal_data import ModalData

BOOM = Beam(length=5.0, area=1e-3, I_y=1e-7, I_z=4e-7, J=4e-7, density=2000.0, E=1e9, G=4e8, damping=0.01)
ROOTS = np.array([1.8751040687119611664, 4.6940911329741745764, 7.8547574382376125648])  # cos x cosh x = -1
SIGMA = (np.cosh(ROOTS) + np.cos(ROOTS)) / (np.sinh(ROOTS) + np.sin(ROOTS))
RNG = np.random.default_rng(5)


def cloud(n, count=8, rng=RNG):
    """A body of random nodes."""
    return ModalData.from_nodes(
        rng.normal(size=(count, 3)),
        rng.uniform(0.5, 2, count),
        rng.normal(size=(n, count, 3)),
        frequencies=np.arange(1.0, n + 1),
    )


def test_uniform_boom_equals_its_closed_forms():
    data = ModalData.boom(BOOM, (1, 3))
    out = [k for k in range(data.n) if abs(data.R[k, 2]) > 0]
    m, L = 10.0, 5.0
    assert data.mass == pytest.approx(m, rel=1e-14)
    np.testing.assert_allclose(data.first, [m * L / 2, 0, 0], atol=1e-12)
    np.testing.assert_allclose(data.inertia, np.diag([0, m * L**2 / 3, m * L**2 / 3]), atol=1e-12)
    np.testing.assert_allclose(data.R[out, 2], 2 * m * SIGMA / ROOTS, rtol=1e-12)
    np.testing.assert_allclose(data.moments[out, 0, 2], 2 * m * L / ROOTS**2, rtol=1e-12)
    np.testing.assert_allclose(data.modal_mass, m * np.eye(4), atol=1e-12)
    omega = ROOTS**2 * np.sqrt(100.0 / (2.0 * L**4))
    np.testing.assert_allclose(np.sqrt(np.diag(data.stiffness)[out] / m), omega, rtol=1e-12)
    np.testing.assert_allclose(data.Y[out, 1], -2 * m * L / ROOTS**2, rtol=1e-12)  # x e_x cross phi e_z
    np.testing.assert_allclose(np.abs(data.tip_shapes[out, 2]), 2.0, rtol=1e-12)
    np.testing.assert_allclose(data.damping, 0.01 * data.stiffness)


def test_integrals_follow_their_definitions():
    data = cloud(3)
    r, dm, phi = data.outline, np.random.default_rng(5).uniform(size=0), data.outline_shapes
    rng = np.random.default_rng(5)
    r, dm = rng.normal(size=(8, 3)), rng.uniform(0.5, 2, 8)
    phi = rng.normal(size=(3, 8, 3))
    data = ModalData.from_nodes(r, dm, phi, frequencies=np.ones(3))
    for k in range(3):
        N = sum(m * (a @ b * np.eye(3) - np.outer(a, b)) for m, a, b in zip(dm, r, phi[k]))
        np.testing.assert_allclose(data.N[k], N, atol=1e-12)
        np.testing.assert_allclose(data.Y[k], sum(m * np.cross(a, b) for m, a, b in zip(dm, r, phi[k])), atol=1e-12)
        assert data.C[k] == pytest.approx(sum(m * (a @ b) for m, a, b in zip(dm, r, phi[k])))
        Y = np.array(
            [data.N[k][2, 1] - data.N[k][1, 2], data.N[k][0, 2] - data.N[k][2, 0], data.N[k][1, 0] - data.N[k][0, 1]]
        )
        np.testing.assert_allclose(data.Y[k], Y, atol=1e-12)  # Eq (11) as printed
        for l in range(3):
            E = data.E[k, l]
            Z = np.array([E[1, 2] - E[2, 1], E[2, 0] - E[0, 2], E[0, 1] - E[1, 0]])
            np.testing.assert_allclose(data.Z[k, l], Z, atol=1e-12)  # Eq (13) as printed
            np.testing.assert_allclose(E, data.E[l, k].T, atol=1e-12)  # what the lower triangle of (12) must satisfy
    assert np.linalg.eigvalsh(data.pi)[0] > -1e-12
    turn = matrix_of(quaternion([0.3, -0.2, 0.9]))
    turned = ModalData.from_nodes(r @ turn.T, dm, phi @ turn.T, frequencies=np.ones(3))
    np.testing.assert_allclose(turned.Z, data.Z @ turn.T, atol=1e-12)
    np.testing.assert_allclose(turned.inertia, turn @ data.inertia @ turn.T, atol=1e-12)


def test_boom_as_nodes_converges():
    """Point masses along the boom with the modes sampled: the midpoint rule, error of order two."""
    exact, errors = ModalData.boom(BOOM, (0, 2)), []
    from pliant.plants.beams.shape_functions import basis

    for count in (20, 40, 80):
        x = (np.arange(count) + 0.5) / count
        shapes = np.zeros((2, count, 3))
        shapes[:, :, 2] = basis("clamped-free", 2).phi(x).T
        nodes = np.column_stack([5 * x, 0 * x, 0 * x])
        data = ModalData.from_nodes(nodes, np.full(count, 10 / count), shapes, frequencies=exact.frequencies)
        errors.append(np.abs(data.R - exact.R).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.1)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2, abs=0.1)


def test_panel_is_a_pair_of_beams():
    data, boom = ModalData.panel(BOOM, 2.0, (2, 1)), ModalData.boom(BOOM, (0, 2))
    assert data.mass == pytest.approx(20.0)
    np.testing.assert_allclose(np.diag(data.inertia), [20.0, 500 / 3, 500 / 3 + 20.0], rtol=1e-12)
    np.testing.assert_allclose(data.R[:2], 2 * boom.R, atol=1e-12)
    np.testing.assert_allclose(data.R[2], 0, atol=1e-12)  # twisting moves no mass centre
    assert data.Y[2, 0] == pytest.approx(2 * boom.R[0, 2], rel=1e-12)  # but turns about x
    np.testing.assert_allclose(data.modal_mass, 20 * np.eye(3), atol=1e-12)


def test_panel_shortens_line_by_line():
    """Bending and twisting together: one beam bends twice as much, the other not at all; only the first shortens."""
    data, boom = ModalData.panel(BOOM, 2.0, (1, 1)), ModalData.boom(BOOM, (0, 1))
    eta = np.array([1.0, 1.0])
    first = np.einsum("kli,k,l->i", data.shortening, eta, eta)
    moment = np.einsum("klij,k,l->ij", data.shortening_moments, eta, eta)
    assert first[0] == pytest.approx(4 * boom.shortening[0, 0, 0], rel=1e-12)
    assert moment[1, 0] == pytest.approx(first[0] * 1.0, rel=1e-12)  # all of it at y = +1 m


def test_shortening_integrals_of_a_boom():
    """Against the beams' own integrals, which the rotating-beam references hold."""
    from pliant.plants.beams.shape_functions import basis

    data, own = ModalData.boom(BOOM, (0, 3)), basis("clamped-free", 3)
    np.testing.assert_allclose(data.shortening[:, :, 0], 10.0 / 5.0 * own.shortening_mean, rtol=1e-11)
    np.testing.assert_allclose(data.shortening_moments[:, :, 0, 0], 10.0 * own.shortening_moment, rtol=1e-11)


def test_shortening_of_a_pendulum():
    """One rigid-like shape phi = x e_z: a bar turned by eta shortens by x eta^2/2, the cosine's second order."""
    x = np.linspace(0.1, 1.0, 10)
    nodes = np.column_stack([x, 0 * x, 0 * x])
    shapes = np.zeros((1, 10, 3))
    shapes[0, :, 2] = x
    g = np.zeros((1, 1, 10, 3))
    g[0, 0, :, 0] = x
    data = ModalData.from_nodes(nodes, np.ones(10), shapes, frequencies=[1.0], shortening=g)
    assert data.shortening[0, 0, 0] == pytest.approx(x.sum())
    assert data.shortening_moments[0, 0, 0, 0] == pytest.approx((x**2).sum())


def frame_matrices(count=20, lumped=True):
    """Mass and stiffness of a cantilever boom of 6-freedom nodes, bending in x-z and x-y, stretching, twisting."""
    h, n = 5.0 / count, count + 1
    K, M = np.zeros((6 * n, 6 * n)), np.zeros((6 * n, 6 * n))
    for e in range(count):
        for t, r, sign, EI in ((2, 4, -1.0, 100.0), (1, 5, 1.0, 400.0)):
            k = (
                EI
                / h**3
                * np.array(
                    [
                        [12, 6 * h, -12, 6 * h],
                        [6 * h, 4 * h * h, -6 * h, 2 * h * h],
                        [-12, -6 * h, 12, -6 * h],
                        [6 * h, 2 * h * h, -6 * h, 4 * h * h],
                    ]
                )
            )
            s = np.diag([1, sign, 1, sign])
            at = [6 * e + t, 6 * e + r, 6 * e + 6 + t, 6 * e + 6 + r]
            K[np.ix_(at, at)] += s @ k @ s
        for t, stiff in ((0, 1e6), (3, 160.0)):
            at = [6 * e + t, 6 * e + 6 + t]
            K[np.ix_(at, at)] += stiff / h * np.array([[1, -1], [-1, 1]])
        for node in (e, e + 1):
            M[6 * node : 6 * node + 3, 6 * node : 6 * node + 3] += h * np.eye(3)
    positions = np.column_stack([np.linspace(0, 5, n), np.zeros(n), np.zeros(n)])
    return M, K, positions


def test_structural_matrices_give_the_boom():
    M, K, positions = frame_matrices()
    data, exact = ModalData.from_matrices(M, K, positions, root=[0], modes=3), ModalData.boom(BOOM, (1, 2))
    np.testing.assert_allclose(data.frequencies, np.sort(exact.frequencies), rtol=5e-3)
    assert data.mass == pytest.approx(10.0, rel=1e-12)
    for k, l in ((0, 0), (1, 1), (2, 2)):
        scale = np.sqrt(exact.modal_mass[l, l] / data.modal_mass[k, k])
        order = np.argsort(np.sqrt(np.diag(exact.stiffness)))[l]
        assert np.abs(data.R[k] * scale).max() == pytest.approx(np.abs(exact.R[order]).max(), rel=1e-2)
    assert abs(data.E - data.E.transpose(1, 0, 3, 2)).max() < 1e-12


def test_nastran_op4(tmp_path):
    op4 = pytest.importorskip("pyyeti.nastran.op4")
    M, K, positions = frame_matrices(8)
    path = tmp_path / "boom.op4"
    op4.write(str(path), {"mgg": M, "kgg": K})
    data = ModalData.from_nastran(path, positions, root=[0], modes=2)
    np.testing.assert_allclose(
        data.frequencies, ModalData.from_matrices(M, K, positions, root=[0], modes=2).frequencies, rtol=1e-12
    )
    with pytest.raises(ValueError, match=r"from_nastran: .* has no matrix 'maa'; it has kgg, mgg"):
        ModalData.from_nastran(path, positions, root=[0], modes=2, mass="maa")


def write_op2(path, matrices):
    """An OUTPUT2 file of real double matrices, as the NASTRAN Programmer's Manual lays it out: Fortran records, each
    preceded by a key; a column is a string of rows from its first that is not zero to its last.
    """
    with open(path, "wb") as file:

        def record(data):
            size = struct.pack("i", len(data))
            file.write(size + data + size)

        def keys(*values):
            for value in values:
                record(struct.pack("i", value))

        for name, M in matrices.items():
            label = name.upper().ljust(8).encode()
            keys(2)
            record(label)
            keys(-1, 7)
            record(struct.pack("7i", 101, M.shape[1], M.shape[0], 6, 2, 0, 0))  # columns, rows, symmetric, real double
            keys(-2, 1, 0, 2)
            record(label)
            keys(-3, 1, 1)
            for k, column in enumerate(M.T):
                rows = np.flatnonzero(column)
                if len(rows):
                    part = column[rows[0] : rows[-1] + 1]
                    keys(1 + 2 * len(part))
                    record(struct.pack("i", rows[0] + 1) + part.astype(float).tobytes())
                keys(-4 - k, 1, 1 if k + 1 < M.shape[1] else 0)
            keys(0)
        keys(0)


def test_nastran_op2(tmp_path):
    pytest.importorskip("pyyeti.nastran.op2")
    M, K, positions = frame_matrices(8)
    path = tmp_path / "boom.op2"
    write_op2(path, {"mgg": M, "kgg": K})
    for found, wanted in zip(read_nastran(path, "MGG", "kgg"), (M, K)):
        np.testing.assert_array_equal(found, wanted)
    data = ModalData.from_nastran(path, positions, root=[0], modes=2, damping=0.01)
    exact = ModalData.boom(BOOM, (1, 2)).frequencies
    np.testing.assert_allclose(data.frequencies, np.sort(exact)[:2], rtol=2e-2)  # 8 elements with lumped masses
    with pytest.raises(ValueError, match=r"from_nastran: boom\.op2 has no matrix 'kaa'; it has kgg, mgg"):
        read_nastran(path, "mgg", "kaa")


def test_complex_matrices_and_other_files_are_refused(tmp_path):
    op4 = pytest.importorskip("pyyeti.nastran.op4")
    M, K, positions = frame_matrices(2)
    path = tmp_path / "damped.op4"
    op4.write(str(path), {"mgg": M, "kgg": K * (1 + 0.02j)})
    with pytest.raises(ValueError, match=r"matrix 'kgg' of damped\.op4 is complex, must be real"):
        ModalData.from_nastran(path, positions, root=[0], modes=1)
    for name in ("text.op2", "text.op4"):
        (tmp_path / name).write_text("not a matrix, and not a NASTRAN file either\n")
        with pytest.raises(ValueError, match=rf"from_nastran: {name} "):
            ModalData.from_nastran(tmp_path / name, positions, root=[0], modes=1)


def test_lumping_that_changes_the_body_is_refused():
    """A mass on an arm across the boom: its offset couples translations and turns, which lumping would drop."""
    M, K, positions = frame_matrices(8)
    M[:48, :48] *= 0.1
    mass, arm = 5.0, np.array([0.0, 3.0, 0.0])
    last = slice(48, 54)
    M[last, last] += mass * np.block([[np.eye(3), -skew(arm)], [skew(arm), -skew(arm) @ skew(arm)]])
    with pytest.raises(ValueError, match=r"lumping at the nodes changes the first moment by 0\.\d+ of itself"):
        ModalData.from_matrices(M, K, positions, root=[0], modes=2)
    M, K, positions = frame_matrices(8)
    M[51:54, 51:54] += 100.0 * np.eye(3)
    with pytest.raises(ValueError, match=r"changes the inertia by 0\.\d+ of itself"):
        ModalData.from_matrices(M, K, positions, root=[0], modes=2)


def test_nastrans_own_op2_equals_its_op4():
    """Files that NASTRAN wrote, of those that pyYeti brings for its own tests: the same real matrix by both routes."""
    folder = Path(pytest.importorskip("pyyeti").__file__).parent / "tests"
    files = [folder / "nastran_op2_data" / "double_le.op2", folder / "nastran_op4_data" / "double_dense_le.op4"]
    if not all(file.exists() for file in files):
        pytest.skip("this pyYeti comes without its test files")
    one, _ = read_nastran(files[0], "zuzr01", "zuzr01")
    other, _ = read_nastran(files[1], "rmat", "rmat")
    assert one.shape == (25, 31) and np.abs(one).max() > 0
    np.testing.assert_array_equal(one, other)


def test_nastran_reader_through_a_stand_in(tmp_path, monkeypatch):
    """The same call with a reader that returns what pyYeti's does: {name: matrix}."""
    M, K, positions = frame_matrices(8)
    package, nastran, reader = (types.ModuleType(f"pyyeti{tail}") for tail in ("", ".nastran", ".nastran.op4"))
    reader.read = lambda path, **_: {"mgg": M, "kgg": K}
    nastran.op4 = reader
    package.nastran = nastran
    for name, module in (("pyyeti", package), ("pyyeti.nastran", nastran), ("pyyeti.nastran.op4", reader)):
        monkeypatch.setitem(sys.modules, name, module)
    path = tmp_path / "boom.op4"
    path.write_text("")
    data = ModalData.from_nastran(path, positions, root=[0], modes=2)
    assert data.n == 2


def test_nastran_without_a_reader(tmp_path, monkeypatch):
    for name in ("pyyeti", "pyyeti.nastran"):
        monkeypatch.setitem(sys.modules, name, None)
    path = tmp_path / "boom.op4"
    path.write_text("")
    with pytest.raises(ImportError, match="pip install pyyeti"):
        ModalData.from_nastran(path, np.zeros((2, 3)), root=[0], modes=1)


BAD = {
    "mass": (lambda: ModalData.rigid(-1.0, (0, 0, 0), np.eye(3)), r"ModalData\.mass = -1\.0 must be > 0 \[kg\]"),
    "inertia": (
        lambda: ModalData.rigid(1.0, (9.0, 0, 0), np.eye(3)),
        r"int z z\^T dm has the eigenvalue .* must be >= 0",
    ),
    "node mass": (
        lambda: ModalData.from_nodes(np.eye(3), [1, -1, 1], np.zeros((0, 3, 3)), frequencies=[]),
        r"masses\[1\] = -1",
    ),
    "both": (lambda: ModalData.from_nodes(np.eye(3), np.ones(3), np.ones((1, 3, 3))), "exactly one of frequencies"),
    "same modes": (
        lambda: ModalData.from_nodes(np.eye(3), np.ones(3), np.ones((2, 3, 3)), frequencies=[1, 2]),
        "the 2 modes must be independent",
    ),
    "counts": (lambda: ModalData.boom(BOOM, (1.5, 1)), r"ModalData\.boom\.modes = 1\.5 must be an integer"),
    "width": (lambda: ModalData.panel(BOOM, -1.0), r"width = -1\.0 must be > 0 \[m\]"),
    "keep": (
        lambda: ModalData.boom(BOOM, (1, 1)).keep([2]),
        r"ModalData\.keep\.mode = 2 must be an integer from 0 to 1",
    ),
    "shape": (
        lambda: ModalData.from_nodes(np.eye(3), np.ones(4), np.ones((1, 3, 3)), frequencies=[1]),
        r"masses has shape",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input(name):
    make, words = BAD[name]
    with pytest.raises(ValueError, match=words):
        make()


def test_hub_axes_do_not_matter():
    """Skew-symmetric helper against the cross product."""
    a, b = RNG.normal(size=(2, 3))
    np.testing.assert_allclose(skew(a) @ b, np.cross(a, b))
