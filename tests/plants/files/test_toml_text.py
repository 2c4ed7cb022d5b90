import tomllib

import pytest

from pliant.plants.files.toml_text import dumps, load, loads, save

TABLES = {
    "name": 'a "quoted" \\ word\n\x7f\u00e9',
    "numbers": [0.1, 1e-300, 1e22, -0.0, 3, -5],
    "flag": True,
    "nested": [[1.0, 2.0], [3.0, 4.0]],
    "long": [float(k) / 3 for k in range(60)],
    "empty": [],
    "table": {"payload.mass": [0.7, 1.3], "inner": {"x": 1}, "none": {}},
    "rows": [{"a": 1, "part": {"b": 2.5}}, {"a": 2, "parts": [{"c": 1}, {"c": 2}]}],
}


def test_what_is_written_is_read_back_to_the_last_bit():
    """Python's own reader, tomllib, is the reference."""
    found = tomllib.loads(dumps(TABLES, "a head\nof two lines"))
    assert found == TABLES and repr(found) == repr(TABLES)
    assert max(map(len, dumps({"long": TABLES["long"]}).splitlines())) <= 120


def test_a_file_is_read_and_written_whole(tmp_path):
    path = tmp_path / "a.toml"
    save(path, TABLES)
    assert load("test", path) == TABLES


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a = 1\nb = \n", "line 2: 'b =' must be TOML: Invalid value"),
        ("a = nan", "a = nan must be a finite number"),
        ("[t]\nx = [1, inf]", r"t.x\[1\] = inf must be a finite number"),
        ("a = 1979-05-27", "a = 1979-05-27 must be a number"),
        ("a = 1\na = 2", "Cannot overwrite a value"),
        ("a" * 20 + ".b" * 60 + " = 1", "must be at most 40 deep"),
        ("x = " + "[" * 5000, "must be"),
        ("x = " + "9" * 5000, "must be TOML: Exceeds the limit"),
    ],
)
def test_what_is_damaged_is_told_by_line_or_key(text, words):
    with pytest.raises(ValueError, match=words):
        loads(text)


def test_a_file_of_other_bytes_is_refused_by_its_line(tmp_path):
    path = tmp_path / "a.toml"
    path.write_bytes(b"a = 1\nb = '\xff'\n")
    with pytest.raises(ValueError, match="line 2: byte 11 = 0xff must be UTF-8"):
        load("test", path)


@pytest.mark.parametrize("value", [float("nan"), None, object(), 1j])
def test_what_toml_lacks_is_not_written(value):
    with pytest.raises(ValueError, match="cannot be written"):
        dumps({"a": value})
