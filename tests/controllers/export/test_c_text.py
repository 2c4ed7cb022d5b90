"""Numbers and names in C."""

import numpy as np
import pytest

from pliant.controllers.export.c_text import array, c_name, files, number


def test_numbers_keep_every_digit() -> None:
    for value in (0.1, -1e-300, 3.0, 1 / 3):
        assert float(number(value).replace("REAL", "").strip("()")) == pytest.approx(value, rel=0, abs=0)
    assert number(np.inf) == "INFINITY" and number(-np.inf) == "-INFINITY"


def test_single_precision_has_single_constants() -> None:
    _, source = files("law", "a law", "", "", array("law_K", [0.1, -2.0, 1e30]), "single")
    assert source.endswith("{\n    0.10000000149011612f, (-2.0f), 1.0000000150474662e+30f\n};\n")


@pytest.mark.parametrize("name", ["2a", "int", "a-b", "", "a" * 41])
def test_names_that_c_does_not_take(name) -> None:
    with pytest.raises(ValueError, match="must be"):
        c_name("file", name)
