"""NASTRAN's OP4 and OP2 files, read back."""

import struct
import sys
import types
from pathlib import Path

import numpy as np
import pytest
from boom_matrices import BOOM, frame_matrices

from pliant.plants.modal_data.modal_data import ModalData
from pliant.plants.modal_data.nastran import read_nastran


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
