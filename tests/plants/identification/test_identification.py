"""The result: text, JSON, and no number where none is claimed."""

import json
import math

import pytest
from springs import VARIED, pushed

from pliant.plants import identify
from pliant.plants.identification.identification import digits


@pytest.fixture(scope="module")
def found():
    return identify(VARIED, pushed(1.0, unknown=("x",)), noise={"place": 2e-4})


def test_the_summary_names_every_parameter_with_its_unit(found):
    lines = found.summary().splitlines()
    assert [line.split()[0] for line in lines[1:4]] == ["mass", "damping", "stiffness"]
    assert lines[1].endswith("kg") and "place 0.0002 (given)" in lines[4] and "(estimated)" in lines[4]
    assert "102 samples of 1 motions" in lines[4] and "mass=" in repr(found)


def test_values_are_written_to_a_tenth_of_their_errors():
    assert digits(2.2, 4.96e-7) == 9 and f"{2.2 + 1.4e-6:.9g}" == "2.2000014"
    assert digits(50.0, 3.0) == digits(50.0, math.inf) == digits(0.0, 1.0) == 6 and digits(1.0, 1e-20) == 15


def test_the_table_is_strict_json(found):
    table = json.loads(json.dumps(found.table(), allow_nan=False))
    assert table["parameters"]["mass"]["unit"] == "kg" and table["noise"]["place"]["given"]
    low, high = table["parameters"]["mass"]["interval"]
    assert low < table["parameters"]["mass"]["value"] < high
    assert set(table["starts"][0]) == {"x"} and len(table["correlation"]) == 3 and table["doubts"] == []


def test_an_interval_is_the_quantile_times_the_error(found):
    """Student's quantile of 97.5 % with 98 degrees of freedom: 1.9845 (tables)."""
    low, high = found.intervals["stiffness"]
    assert (high - low) / 2 / found.standard_errors["stiffness"] == pytest.approx(1.9845, abs=1e-4)
    known = identify(VARIED, pushed(1.0), noise={"place": 2e-4, "felt": 1e-2})
    low, high = known.intervals["stiffness"]
    assert (high - low) / 2 / known.standard_errors["stiffness"] == pytest.approx(1.96, abs=1e-4)


def test_what_is_not_known_is_none():
    motion = pushed(1.0)
    silent = type(motion)(t=motion.t, measured={"place": 0 * motion.t})
    found = identify(VARIED, silent, noise={"place": 1e-3})
    table = json.loads(json.dumps(found.table(), allow_nan=False))
    assert table["parameters"]["mass"]["standard_error"] is None
    assert {tuple(g["names"]) for g in table["unidentifiable"]} == {("mass",), ("damping",), ("stiffness",)}
    assert all(math.isinf(e) for e in found.standard_errors.values()) and "none claimed" in found.summary()
