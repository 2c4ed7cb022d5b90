"""Files of measured motions: to and fro, gaps, and lines that say what is wrong."""

import numpy as np
import pytest
from springs import SPRING, VARIED, pushed

from pliant.plants import Experiment, identify, read_experiment, write_experiment

HEAD = "t [s],force [N],place [m]\n"


def file(tmp_path, text):
    path = tmp_path / "run.csv"
    path.write_text(text)
    return path


def test_a_file_gives_back_what_was_written(tmp_path):
    motion = pushed(0.5)
    gaps = {k: np.where(np.arange(26) % 5 == 0, np.nan, c) for k, c in motion.measured.items()}
    write_experiment(SPRING, Experiment(t=motion.t, u=motion.u, measured=gaps), tmp_path / "run.csv")
    found = read_experiment(SPRING, tmp_path / "run.csv", unknown="all")
    assert found.name == "run" and found.unknown == "all" and (found.t == motion.t).all()
    assert (found.u["force"] == motion.u[:, 0]).all()
    assert all(np.array_equal(found.measured[k], c, equal_nan=True) for k, c in gaps.items())
    assert (tmp_path / "run.csv").read_text().startswith("t [s],force [N],place [m],felt [m/s^2]\n")


def test_a_spreadsheets_file_is_read(tmp_path):
    path = file(tmp_path, "\ufeff place [m] , t [s] \r\n0.1,0\r\n, 0.5\r\nnan,1\r\n0.2,1.5\r\n\r\n")
    found = read_experiment(SPRING, path)
    assert found.t.tolist() == [0, 0.5, 1, 1.5] and np.isnan(found.measured["place"]).sum() == 2
    assert identify(VARIED, found, noise={"place": 1.0}).samples == 2


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "has 0 lines that are not blank"),
        (HEAD + "0,0,0\n", "has 2 lines that are not blank, must have a head and at least two samples"),
        ("force [N],place [m]\n0,0\n1,1\n", r"has no column 't \[s\]'"),
        ("t [s],speed [m]\n0,0\n1,1\n", r"column 'speed \[m\]'; the plant has force, x, v, place"),
        ("t [s],place [mm]\n0,0\n1,1\n", r"column 'place \[mm\]', must be 'place \[m\]'"),
        ("t [s],place\n0,0\n1,1\n", r"column 'place', must be 'place \[m\]'"),
        ("t [s],place [m],place [m]\n0,0,0\n1,1,1\n", "the column 'place' twice"),
        (HEAD + "0,0,0\n1,0\n", "line 3 has 2 cells, must have 3"),
        (HEAD + "0,0,0\n1,0,fast\n", "line 3: place = 'fast' must be a number"),
        (HEAD + "0,0,0\n1,,0\n", "line 3: force is missing, only what is measured may be"),
        (HEAD + "0,0,0\n,0,0\n", "line 3: t is missing"),
        ("\n" + HEAD + "\n0,0,0\n,,\n\n1,0\n", "line 7 has 2 cells"),
        (HEAD + "\n0,0,0\n1,0,fast\n", "line 4: place = 'fast'"),
        (HEAD + "\n\n0,0,0\n1,,0\n", "line 5: force is missing"),
        (HEAD + "1,0,0\n0,0,0\n", r"Experiment\.t"),
        (HEAD + "0,0,0\n1,0,inf\n", "must be finite, or NaN"),
        ("t [s],force [N]\n0,0\n1,1\n", "must name at least one output or state"),
    ],
)
def test_refused(tmp_path, text, words):
    with pytest.raises(ValueError, match=words):
        read_experiment(SPRING, file(tmp_path, text))


def test_what_is_no_text_or_no_file_is_refused(tmp_path):
    (tmp_path / "run.csv").write_bytes(b"\xff\xfe\x00\x01" * 20)
    with pytest.raises(ValueError, match="is no CSV file of text"):
        read_experiment(SPRING, tmp_path / "run.csv")
    with pytest.raises(OSError, match="missing"):
        read_experiment(SPRING, tmp_path / "missing.csv")
    with pytest.raises(ValueError, match="must be a Plant"):
        read_experiment(3, tmp_path / "run.csv")
