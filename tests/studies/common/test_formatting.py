"""Numbers, lengths and pieces of HTML."""

import pytest

from pliant.studies.common.formatting import details, duration, measured, number, paragraph, pictures, table


@pytest.mark.parametrize(
    ("value", "unit", "says"),
    [
        (9.4e20, "m", "> 1000 km"),
        (12.0, "m", "12 m"),
        (2e-3, "m", "2 mm"),
        (3e-6, "m", "3 µm"),
        (1e-9, "m", "< 0.01 µm"),
        (float("inf"), "m", "no result"),
        (0.5, "1", "0.5"),
        (0.5, "rad", "0.5 rad"),
        (float("nan"), "rad", "no result"),
    ],
)
def test_measured(value, unit, says):
    assert measured(value, unit) == says


def test_numbers_and_times():
    assert [number(v) for v in (None, float("nan"), 3, 0.123456)] == ["–", "–", "3", "0.1235"]
    assert [duration(v) for v in (0.02, 0.9999, 1.0, 12.345)] == ["20 ms", "1e+03 ms", "1 s", "12.35 s"]


def test_html_is_escaped_and_rows_are_marked():
    text = table(("a<b", "n"), [("x & y", 1.5), ("second", None)], marked=(1,))
    assert "a&lt;b" in text and "x &amp; y" in text and text.count('class="marked"') == 1 and ">1.5<" in text
    assert paragraph("say `pliant` & go", "warning") == '<p class="warning">say <code>pliant</code> &amp; go</p>\n'
    assert details("<more>", "b") == "<details><summary>&lt;more&gt;</summary>b</details>\n"
    assert pictures({"one": "<svg/>"}, "one", "two") == '<figure class="one"><svg/></figure>\n'
