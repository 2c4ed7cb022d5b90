"""The validation page is what the tests measured, and names tests that are there."""

import importlib
import json
import re
import sys
from pathlib import Path

import pytest
from evidence import KEPT, KINDS, agrees

ROOT = Path(__file__).parents[1]
HOUSE = ROOT / "docs" / "house"
sys.path.insert(0, str(HOUSE))
validation = importlib.import_module("validation")
sys.path.remove(str(HOUSE))
EVIDENCE = json.loads((ROOT / "docs" / "validation.json").read_text(encoding="utf-8"))
COMPARED = [one for many in EVIDENCE.values() for one in many]


def test_the_json_names_only_tests_that_exist():
    for test in EVIDENCE:
        path, _, name = test.partition("::")
        assert (ROOT / path).is_file(), test
        function = re.escape(name.partition("[")[0])
        assert re.search(rf"^def {function}\(", (ROOT / path).read_text(encoding="utf-8"), re.MULTILINE), test


def test_every_comparison_held_and_has_a_source():
    assert validation.counted(COMPARED) >= 60
    for one in COMPARED:
        assert one["error"] <= one["within"] and one["source"] and one["of"] and one["kind"] in KINDS
    assert set(KINDS) == set(validation.LEVELS)


def test_what_is_of_others():
    """A publication or a program, each quantity once; not what was derived here, nor finer models."""
    told = {"of": "beam", "what": "root", "kind": "closed form"}
    ours = told | {"source": "omega^2 - gamma^2"}
    paper = told | {"source": "Blevins (1979), table 8-1", "variant": "first"}
    titled = told | {"source": '"On Beams", Eq (3)'}
    program = told | {"kind": "other program", "source": "Exudyn 1.13.6"}
    finer = told | {"kind": "finer model", "source": "40 elements, after Blevins (1979)"}
    assert [validation.by_others(one) for one in (ours, paper, titled, program, finer)] == [0, 1, 1, 1, 0]
    assert validation.counted([ours, paper, paper | {"variant": "second"}, program, finer]) == 2


def test_the_page_is_made_from_the_json():
    assert (ROOT / "docs" / "validation.md").read_text(encoding="utf-8") == validation.page(EVIDENCE)


def test_agrees_tells_what_is_off():
    """Of 1.0 and 2.0 the second is 10 % off; a shape that differs is refused, as is what is no number."""
    told = {"of": "beam", "source": "table", "kind": "table"}
    with pytest.raises(AssertionError, match=r"off table by 0\.1, more than 0\.01"):
        agrees([1.0, 2.2], [1.0, 2.0], within=0.01, **told)
    with pytest.raises(AssertionError):
        agrees([1.0], [1.0, 2.0], within=0.01, **told)
    with pytest.raises(AssertionError):
        agrees(float("nan"), 1.0, within=0.01, **told)
    KEPT.popitem()
