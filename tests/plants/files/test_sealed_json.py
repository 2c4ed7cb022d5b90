"""JSON with a checksum: laid out otherwise it is the same, changed it is refused by name."""

import json

import pytest

from pliant.plants.files import sealed_json

VALUE = {"format": 2, "b": [1, 2.5, None, True], "a": {"é": 0.1 + 0.2, "tuple": (1, 2)}, "n": 10**20}


@pytest.fixture
def path(tmp_path):
    sealed_json.save(tmp_path / "x.json", VALUE)
    return tmp_path / "x.json"


def test_everything_comes_back_however_it_is_laid_out(path):
    want = json.loads(json.dumps(VALUE))
    assert sealed_json.load("here", path, 2) == want
    told = json.loads(path.read_text())
    assert set(told) == {*VALUE, "sha256"}
    path.write_text(json.dumps(dict(reversed(told.items()))))
    assert sealed_json.load("here", path, 2) == want


def changed(**changes):
    def change(path):
        path.write_text(json.dumps(json.loads(path.read_text()) | changes))

    return change


def without(name):
    def change(path):
        path.write_text(json.dumps({k: v for k, v in json.loads(path.read_text()).items() if k != name}))

    return change


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (changed(n=1), "was edited or is damaged: its checksum is another"),
        (changed(more=1), "its checksum is another"),
        (changed(sha256="0" * 64), "its checksum is another"),
        (changed(format=3), "was written by format 3, this Pliant reads up to 2"),
        (changed(format="x"), "says format 'x'"),
        (without("format"), "its checksum is another"),
        (without("sha256"), "has no checksum"),
        (lambda p: p.write_text("[1]"), "holds a list, must be a JSON object"),
        (lambda p: p.write_text('{"a": NaN}'), "holds NaN, which is no number"),
        (lambda p: p.write_text("{"), "cannot be read: JSONDecodeError"),
        (lambda p: p.write_text("[" * 10**5), "cannot be read: RecursionError"),
        (lambda p: p.write_bytes(b"\xff\xfe"), "cannot be read: UnicodeDecodeError"),
        (lambda p: p.write_bytes(b""), "is empty"),
    ],
)
def test_what_was_changed_is_refused_by_name(path, damage, words):
    damage(path)
    with pytest.raises(ValueError, match=r"here: '.*x\.json' .*" + words):
        sealed_json.load("here", path, 2)


def test_of_version_0_1_there_is_no_checksum(path):
    path.write_text('{"a": 1}')
    assert sealed_json.load("here", path, 2) == {"a": 1, "format": 1}
    path.write_text('{"a": 1, "format": 1}')
    assert sealed_json.load("here", path, 2) == {"a": 1, "format": 1}


def test_what_is_no_number_is_not_written(tmp_path):
    with pytest.raises(ValueError, match="not JSON compliant"):
        sealed_json.save(tmp_path / "x.json", {"a": float("nan")})
    assert list(tmp_path.iterdir()) == []
