"""A study is resumed, runs in parallel as in one process, and says what it found."""

import importlib
import json

import pytest

from pliant.studies.effectivity.effectivity import effectivity


@pytest.fixture
def tried(monkeypatch):
    seen = []

    def trial(seed):
        seen.append(seed)
        return {"seed": seed, "failure": "ValueError: none" if seed == 3 else "", "uncertainty": None}

    monkeypatch.setattr(importlib.import_module("pliant.studies.effectivity.effectivity"), "trial", trial)
    return seen


def test_it_goes_on_where_it_was_stopped(tried, tmp_path):
    kept, told = tmp_path / "rows.jsonl", []
    effectivity(range(3), backend="sequential", kept=kept)
    with kept.open("a") as file:
        file.write('{"seed": 3, "fail')  # killed while writing
    found = effectivity(range(5), backend="sequential", kept=kept, progress=lambda share, doing: told.append(share))
    assert tried == [0, 1, 2, 3, 4]
    assert [r["seed"] for r in found.rows] == [0, 1, 2, 3, 4]
    assert told == pytest.approx([0.6, 0.8, 1.0])
    assert found.tally.numbers["crashed"] == [3]
    again = effectivity(range(5), backend="sequential", kept=kept)
    assert len(tried) == 5 and again.rows == found.rows


def test_rows_of_other_seeds_are_left_in_the_file(tried, tmp_path):
    kept = tmp_path / "rows.jsonl"
    effectivity(range(4), backend="sequential", kept=kept)
    found = effectivity(range(2, 4), backend="sequential", kept=kept)
    assert [r["seed"] for r in found.rows] == [2, 3] and len(kept.read_text().splitlines()) == 4


def test_threads_give_the_same(tried):
    assert effectivity(range(6), jobs=2, backend="threading").rows == effectivity(range(6), backend="sequential").rows


def test_json_holds_the_summary_and_the_rows(tried):
    found = json.loads(json.dumps(effectivity([1], backend="sequential").to_json()))
    assert found["rows"][0]["seed"] == 1 and found["summary"]["scenes"] == 1


@pytest.mark.parametrize(
    "wrong", ({"seeds": []}, {"seeds": [-1]}, {"jobs": 0}, {"backend": "none"}, {"progress": 3}, {"kept": 7})
)
def test_bad_arguments(wrong):
    with pytest.raises(ValueError, match="effectivity"):
        effectivity(**{"seeds": [0], **wrong})
