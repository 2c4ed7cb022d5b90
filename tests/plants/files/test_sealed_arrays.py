"""Archives with a checksum: what comes back is what was written; all else is refused by name, and nothing is run."""

import io
import json
import os
import pickle
import zipfile

import numpy as np
import pytest

from pliant.plants.files import sealed_arrays

ARRAYS = {
    "a": np.arange(6.0).reshape(2, 3),
    "columns": np.asfortranarray(np.arange(6, dtype=np.int16).reshape(2, 3)),
    "none": np.zeros((0, 4)),
    "number": np.array(True),
    "swapped": np.arange(3, dtype=">f4"),
}


@pytest.fixture
def path(tmp_path):
    sealed_arrays.save(tmp_path / "x.npz", "thing", 2, {"words": ["é", 1.5]}, ARRAYS)
    return tmp_path / "x.npz"


def load(path, kind="thing", newest=2, **options):
    return sealed_arrays.load("here", path, kind, newest, **options)


def npz(path, *, sealed=False, **arrays):
    """As another program writes it; sealed: with our checksum all the same."""
    np.savez(path, **arrays)
    if sealed:
        seal(path)


def seal(path):
    """Our checksum, as a forger who knows it sets it."""
    with zipfile.ZipFile(path, "a") as archive:
        archive.comment = sealed_arrays.SEAL + b"0" * 64
    content = path.read_bytes()[:-64]
    path.write_bytes(content + sealed_arrays._digest(io.BytesIO(content), len(content)))


def about(**words):
    return np.array(json.dumps({"kind": "thing", "format": 2, **words}))


def test_everything_comes_back_and_numpy_reads_it_too(path):
    found = load(path)
    assert found.sealed and found.about == {"kind": "thing", "format": 2, "words": ["é", 1.5]}
    with np.load(path, allow_pickle=False) as numpy_s:
        for name, want in ARRAYS.items():
            for have in (found.arrays[name], numpy_s[name]):
                np.testing.assert_array_equal(have, want)
                assert have.dtype == want.dtype and have.shape == want.shape
    assert not found.arrays["a"].flags.writeable


def test_the_same_content_is_the_same_file(path, tmp_path):
    sealed_arrays.save(tmp_path / "again.npz", "thing", 2, {"words": ["é", 1.5]}, ARRAYS)
    assert path.read_bytes() == (tmp_path / "again.npz").read_bytes()


def test_through_a_pipe_it_is_the_same(path):
    class Pipe(io.BytesIO):
        def seekable(self):
            return False

    pipe = Pipe()
    sealed_arrays.write(pipe, "thing", 2, {"words": ["é", 1.5]}, ARRAYS)
    assert pipe.getvalue() == path.read_bytes()


def test_every_single_byte_is_guarded(tmp_path):
    path = tmp_path / "x.npz"
    sealed_arrays.save(path, "thing", 2, {}, {"a": np.arange(2.0)})
    content = path.read_bytes()
    for k in range(0, len(content), 7):
        path.write_bytes(content[:k] + bytes([content[k] ^ 4]) + content[k + 1 :])
        with pytest.raises(ValueError, match=r"here: '.*x\.npz' "):
            load(path)
    for k in range(0, len(content), 31):
        path.write_bytes(content[:k])
        with pytest.raises(ValueError, match=r"here: '.*x\.npz' "):
            load(path)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda p: p.write_bytes(b""), "is empty"),
        (lambda p: p.write_bytes(b"no archive at all" * 9), "cannot be read: cut off, damaged or no npz"),
        (lambda p: p.mkdir(), "is no ordinary file but a folder"),
        (os.mkfifo, "is no ordinary file"),
        (lambda p: np.save(p.open("wb"), np.zeros(3)), "cut off, damaged or no npz"),
        (lambda p: npz(p, a=np.zeros(2)), r"has arrays \['a'\], must have 'about'"),
        (lambda p: npz(p, about=about(kind="motion")), "is a motion, must be a thing"),
        (lambda p: npz(p, about=about(format=3)), "was written by format 3, this Pliant reads up to 2"),
        (lambda p: npz(p, about=about(format="2")), "says format '2', must be one from 1 to 2"),
        (lambda p: npz(p, about=about(format=True)), "says format True"),
        (lambda p: npz(p, about=about(format=0)), "says format 0"),
        (lambda p: npz(p, about=about()), "has no checksum: another program has written it again"),
        (lambda p: npz(p, about=np.array("[1]")), "must be a JSON object"),
        (lambda p: npz(p, about=np.array("{")), "cannot be read: JSONDecodeError"),
        (lambda p: npz(p, about=np.array("[" * 10**5)), "cannot be read: RecursionError"),
        (lambda p: npz(p, about=np.array([str(about())] * 2)), r"shape \(2,\), must be one text"),
        (lambda p: npz(p, about=np.zeros(2)), "must be text"),
        (lambda p: npz(p, sealed=True, about=about(), a=np.zeros(2, complex)), "holds complex128 in 'a', must be numb"),
        (lambda p: npz(p, sealed=True, about=about(), a=np.array(["1.0"])), "holds <U3 in 'a', must be numbers"),
        (lambda p: npz(p, sealed=True, about=about(), a=np.zeros(2, "f8,i4")), "must be numbers"),
        (lambda p: npz(p, sealed=True, about=about(), a=np.array([{}])), "holds objects in 'a', which only a pickle"),
    ],
)
def test_what_is_not_ours_is_refused_by_name(tmp_path, make, words):
    make(tmp_path / "x.npz")
    with pytest.raises(ValueError, match=r"here: '.*x\.npz' .*" + words):
        load(tmp_path / "x.npz")


def test_no_file_is_no_file(tmp_path):
    with pytest.raises(FileNotFoundError):
        load(tmp_path / "none.npz")
    with pytest.raises(ValueError, match="here: path is a NoneType, must be a path"):
        load(None)


def test_nothing_pickled_is_run(tmp_path):
    class Bomb:
        def __reduce__(self):
            return open, (str(tmp_path / "run"), "w")

    for content in (pickle.dumps(Bomb()), None):
        if content is None:
            npz(tmp_path / "x.npz", sealed=True, about=about(), a=np.array([Bomb()], dtype=object))
        else:
            (tmp_path / "x.npz").write_bytes(content)
        with pytest.raises(ValueError, match="here: "):
            load(tmp_path / "x.npz")
        assert not (tmp_path / "run").exists()


def member(name, content, path, **options):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("about.npy", npy(about()))
        archive.writestr(name, content, **options)
    seal(path)


def npy(array):
    stream = io.BytesIO()
    np.lib.format.write_array(stream, array)
    return stream.getvalue()


def header(shape, descr="<f8"):
    stream = io.BytesIO()
    np.lib.format.write_array_header_1_0(stream, {"descr": descr, "fortran_order": False, "shape": shape})
    return stream.getvalue()


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.npy", bytes(2**22), "would unpack to more than 1048576 bytes"),
        ("a.npy", header((2**60,)), "holds 0 bytes in 'a', its shape .* needs"),
        ("a.npy", header((2,)) + bytes(8), "holds 8 bytes in 'a', its shape .* needs 16"),
        ("a.npy", header((2,)) + bytes(24), "holds 24 bytes in 'a', its shape .* needs 16"),
        ("a.npy", header((-1, -2)) + bytes(16), "its shape"),
        ("a.npy", header((2,), "|O") + bytes(16), "holds objects"),
        ("a.npy", b"text", "cannot be read"),
        ("a.npy", b"\x93NUMPY\x03\x00" + bytes(20), r"version \(3, 0\) of NumPy's format"),
        ("a.txt", b"text", r"must hold arrays with distinct names"),
        ("about.npy", npy(about()), r"must hold arrays with distinct names"),
    ],
)
@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_archives_that_are_made_to_harm_are_refused(tmp_path, monkeypatch, name, content, words):
    monkeypatch.setattr(sealed_arrays, "LEAST", 2**20)  # so that the bomb is small
    member(name, content, tmp_path / "x.npz")
    with pytest.raises(ValueError, match=r"here: '.*x\.npz' .*" + words):
        load(tmp_path / "x.npz")


def test_objects_are_not_written_either(tmp_path):
    with pytest.raises(ValueError, match="Object arrays cannot be saved"):
        sealed_arrays.save(tmp_path / "x.npz", "thing", 2, {}, {"a": np.array([{}])})
    assert list(tmp_path.iterdir()) == []


def test_arrays_alone_where_they_may_be(tmp_path):
    npz(tmp_path / "x.npz", a=np.zeros(2))
    found = load(tmp_path / "x.npz", must=False)
    assert found.about is None and not found.sealed and list(found.arrays) == ["a"]
    seal(tmp_path / "x.npz")
    with pytest.raises(ValueError, match="must have 'about'"):
        load(tmp_path / "x.npz", must=False)
