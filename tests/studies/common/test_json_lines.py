"""Rows in a file of JSON lines; what was cut off leaves it."""

import pytest

from pliant.studies.common.json_lines import add_line, read_lines


def test_a_line_that_was_cut_off_is_dropped_from_the_file(tmp_path):
    path = tmp_path / "rows.jsonl"
    assert read_lines(path) == [] == read_lines(None)
    for k in range(2):
        add_line(path, {"k": k, "x": 0.1 * k})
    with path.open("a") as file:
        file.write('{"k": 2, "x')
    assert read_lines(path) == [{"k": 0, "x": 0.0}, {"k": 1, "x": 0.1}]
    assert path.read_text().endswith("}\n")
    add_line(path, {"k": 3})
    assert [row["k"] for row in read_lines(path)] == [0, 1, 3]


@pytest.mark.parametrize("text", ("hello\n", "[1]\n", "3\n"))
def test_another_file_is_refused_and_left(tmp_path, text):
    path = tmp_path / "notes.txt"
    path.write_text(text)
    with pytest.raises(ValueError, match=r"notes.txt' is no file of rows kept"):
        read_lines(path)
    assert path.read_text() == text
