"""What is written as a whole: no warning of two compilers, no allocation, clean under sanitizers; refusals."""

import numpy as np
import pytest
from exported import (
    SANITIZERS,
    compiled,
    loop_in_c,
    needs_compiler,
    run,
    sanitizers_work,
    strict_everywhere,
)

from pliant.controllers import LQG, LQR, MPC, TVLQR, Feedback, Kalman
from pliant.controllers.export import export_c
from pliant.controllers.export.c_text import files


def laws(scene):
    """By name."""
    return {
        "lqr": LQR.for_scene(scene, integral={"tip_x": 1.0, "tip_y": 1.0}),
        "lqg": LQG.for_scene(scene),
        "mpc": MPC.for_scene(scene),
        "tvlqr": TVLQR.for_scene(scene),
    }


@needs_compiler
@pytest.mark.parametrize("precision", ["double", pytest.param("single", marks=pytest.mark.campaign)])
def test_no_warning_and_no_allocation(tmp_path, reach, precision) -> None:
    for name, law in laws(reach).items():
        strict_everywhere(export_c(law, tmp_path / f"{name}.c", precision=precision)[0])
    strict_everywhere(export_c(reach.plant, tmp_path / "arm.c", dt=1e-3, precision=precision)[0])


@needs_compiler
def test_clean_under_sanitizers(tmp_path, reach) -> None:
    """Of a filter, a program and the plant's step at once; the other laws: see the campaign."""
    if not sanitizers_work(tmp_path):
        pytest.skip("no sanitizers here")
    sanitized(tmp_path, reach, LQG(MPC.for_scene(reach, rates=400.0), Kalman.for_scene(reach)))


@needs_compiler
@pytest.mark.campaign
@pytest.mark.parametrize("kind", ["lqr", "lqg", "mpc", "tvlqr"])
def test_every_law_is_clean_under_sanitizers(tmp_path, reach, kind) -> None:
    if not sanitizers_work(tmp_path):
        pytest.skip("no sanitizers here")
    sanitized(tmp_path, reach, laws(reach)[kind])


def sanitized(folder, scene, law) -> None:
    files = [export_c(law, folder / "law.c")[0], export_c(scene.plant, folder / "plant.c", dt=scene.dt / 10)[0]]
    main = loop_in_c(folder, scene.plant, law, scene.initial[0], scene.dt, 20, 10)
    assert len(run(compiled([main, *files], folder / "loop", *SANITIZERS))) == 20


def test_files_say_what_they_are(tmp_path, reach) -> None:
    source, header = export_c(LQG.for_scene(reach), tmp_path / "pointing.c", precision="single")
    assert "typedef float pointing_real;" in header.read_text()
    assert "pointing_act" in header.read_text() and '#include "pointing.h"' in source.read_text()
    assert f"period: {reach.dt!r} s" in header.read_text()


@pytest.mark.parametrize(
    ("what", "options", "word"),
    [
        (lambda s: LQR.for_scene(s), {"path": "law.h"}, r"must end in \.c"),
        (lambda s: LQR.for_scene(s), {"path": "2law.c"}, "C name"),
        (lambda s: LQR.for_scene(s), {"precision": "half"}, "precision"),
        (lambda s: LQR.for_scene(s), {"dt": 0.1}, "dt = 0.1 must be None"),
        (lambda s: s.plant, {}, "dt = None must be the step"),
        (lambda s: s.plant, {"dt": -1.0}, "dt = -1"),
        (lambda s: s, {}, "has no C form"),
        (lambda s: MPC.for_scene(s, track=("theta1", "theta2")), {}, "track"),
        (lambda s: TVLQR.for_scene(s, index="phase"), {}, "index"),
    ],
)
def test_what_has_no_c_form_is_told(tmp_path, reach, what, options, word) -> None:
    with pytest.raises(ValueError, match=word):
        export_c(what(reach), **({"path": tmp_path / "law.c"} | options))
    assert not list(tmp_path.iterdir())


@needs_compiler
@pytest.mark.parametrize("name", ["REAL", "aREALb", "NAME", "SIN", "INFINITY", "SLACK_REAL"])
def test_a_name_may_hold_the_words_of_the_text(tmp_path, name) -> None:
    law = Feedback(np.array([[2.0, -1.0]]), ("a", "b"))
    strict_everywhere(export_c(law, tmp_path / f"{name}.c")[0])


@needs_compiler
@pytest.mark.parametrize(
    "signal", ["a*/ int x;", "a/*b", "a/*/", "tri??/", "????/", "back\\", "line\nbreak", "REAL", '"']
)
def test_signals_may_be_called_anything_in_comments(tmp_path, signal) -> None:
    strict_everywhere(export_c(Feedback(np.eye(1), (signal,)), tmp_path / "law.c")[0])


def test_comments_say_what_ends_them_in_other_words() -> None:
    header, _ = files("law", "y: a*/, /*b*/, c?????/d, /*/", "", "", "", "double")
    inside = header.partition("/* ")[2].partition("\n */")[0]
    assert not any(mark in inside for mark in ("*/", "/*", "??"))
