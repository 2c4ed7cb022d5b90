import json

import numpy as np
import pytest

from pliant.studies.common.atomic_files import MARK, dumps, whole_folder


def test_folder_appears_whole(tmp_path):
    out = tmp_path / "deep" / "report"
    with whole_folder(out) as folder:
        (folder / "a").write_text("a")
        assert not out.exists()
    assert [p.name for p in out.iterdir()] == ["a"]
    assert list(out.parent.iterdir()) == [out]


def test_empty_folder_and_former_report_are_replaced(tmp_path):
    out = tmp_path / "report"
    out.mkdir()
    for content in ("first", "second"):
        with whole_folder(out) as folder:
            (folder / MARK).write_text(content)
    assert (out / MARK).read_text() == "second"
    assert list(tmp_path.iterdir()) == [out]


def test_former_report_stays_when_the_new_one_fails(tmp_path):
    out = tmp_path / "report"
    with whole_folder(out) as folder:
        (folder / MARK).write_text("former")
    with pytest.raises(KeyError), whole_folder(out) as folder:
        (folder / MARK).write_text("half")
        raise KeyError
    assert (out / MARK).read_text() == "former"
    assert list(tmp_path.iterdir()) == [out]


def test_json_is_strict():
    value = {"a": np.array([1.0, np.nan]), "z": 1 + 2j, "n": np.int64(3), "t": (True, None), "f": float("inf")}
    assert json.loads(dumps(value)) == {"a": [1.0, None], "z": [1.0, 2.0], "n": 3, "t": [True, None], "f": None}
