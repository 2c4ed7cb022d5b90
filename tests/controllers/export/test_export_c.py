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

from pliant.controllers import (
    LQG,
    LQR,
    MPC,
    NMPC,
    PD,
    TVLQR,
    ComputedTorque,
    Feedback,
    Kalman,
    Policy,
    Predictive,
    plan,
)
from pliant.controllers.export import export_c
from pliant.plants import LinearModel

LAWS = {
    "lqr": lambda s: LQR.for_scene(s, integral={"tip_x": 1.0, "tip_y": 1.0}),
    "lqg": lambda s: LQG.for_scene(s),
    "mpc": lambda s: MPC.for_scene(s),
    "tvlqr": lambda s: TVLQR.for_scene(s),
}
OFFSET_FREE = {"track": ("theta1", "theta2"), "disturbance": "inputs", "reads": ("theta1", "theta2")}
MORE = {  # compiled with every warning in the tests of their own
    "pd": lambda s: PD.for_scene(s, shape="zvd"),
    "computed torque": lambda s: ComputedTorque.for_scene(s),
    "policy": lambda s: Policy.for_scene(s.name),
    "by phase": lambda s: TVLQR.for_scene(s, index="phase"),
    "lqr, late inputs": lambda s: LQR.for_scene(s, delay=1.4),
    "lqg, late inputs": lambda s: LQG.for_scene(s, input_delay=(0, 1)),
    "mpc, late inputs": lambda s: MPC.for_scene(s, 10, rates=400.0, delay=1.4),
    "late": lambda s: Predictive.for_scene(s, 2),
    "offset-free": lambda s: MPC.for_scene(s, rates=400.0, **OFFSET_FREE),
    "nominal": lambda s: MPC.for_scene(s, 5, nominal=plan(s, reserve=0.1).trajectory(s.plant)),
}


@needs_compiler
@pytest.mark.parametrize("precision", ["double", pytest.param("single", marks=pytest.mark.campaign)])
def test_no_warning_and_no_allocation(tmp_path, reach, precision) -> None:
    for name, law in LAWS.items():
        strict_everywhere(export_c(law(reach), tmp_path / f"{name}.c", precision=precision)[0])
    strict_everywhere(export_c(reach.plant, tmp_path / "arm.c", dt=1e-3, precision=precision)[0])


@needs_compiler
def test_clean_under_sanitizers(tmp_path, reach) -> None:
    """Of a filter, a program and the plant's step at once; the other laws: see the campaign."""
    if not sanitizers_work(tmp_path):
        pytest.skip("no sanitizers here")
    sanitized(tmp_path, reach, LQG(MPC.for_scene(reach, rates=400.0), Kalman.for_scene(reach)))


@needs_compiler
@pytest.mark.campaign
@pytest.mark.parametrize("kind", sorted([*LAWS, *MORE]))
@pytest.mark.parametrize("precision", ["double", "single"])
def test_every_law_is_clean_under_sanitizers(tmp_path, reach, kind, precision) -> None:
    if not sanitizers_work(tmp_path):
        pytest.skip("no sanitizers here")
    law = (LAWS | MORE)[kind](reach)
    strict_everywhere(export_c(law, tmp_path / "strict.c", precision=precision)[0])
    sanitized(tmp_path, reach, law, precision)


def sanitized(folder, scene, law, precision="double") -> None:
    files = [
        export_c(law, folder / "law.c", precision=precision)[0],
        export_c(scene.plant, folder / "plant.c", dt=scene.dt / 10)[0],
    ]
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
        (lambda s: NMPC.for_scene(s, 5), {}, "NMPC has no C form.* MPC.along"),
    ],
)
def test_what_has_no_c_form_is_told(tmp_path, reach, what, options, word) -> None:
    with pytest.raises(ValueError, match=word):
        export_c(what(reach), **({"path": tmp_path / "law.c"} | options))
    assert not list(tmp_path.iterdir())


@needs_compiler
@pytest.mark.parametrize("name", ["REALITY", "MY_NAME_T"])
def test_names_and_signals_that_templates_or_comments_could_mistake(tmp_path, name) -> None:
    states = ("\u03b8\u2081 */ /* ??/", "b\u202e")
    model = LinearModel.from_matrices(-np.eye(2), np.eye(2), states=states)
    law = MPC.design(
        model, np.eye(2), np.eye(2), dt=0.1, horizon=3, limits=(-1.0, 1.0), bounds={states[0]: (-1.0, 1.0)}
    )
    source, header = export_c(law, tmp_path / f"{name}.c")
    strict_everywhere(source)
    assert "y: \u03b8\u2081 * / / * ? ?/, b\\u202e" in header.read_text("utf-8")


@needs_compiler
@pytest.mark.parametrize(
    ("name", "signal"),
    [
        ("REAL", "a*/ int x;"),
        ("aREALb", "a/*b"),
        ("NAME", "a/*/"),
        ("SIN", "????/"),
        ("INFINITY", "back\\"),
        ("law", "REAL"),
    ],
)
def test_words_of_the_templates_may_be_names(tmp_path, name, signal) -> None:
    strict_everywhere(export_c(Feedback(np.eye(1), (signal,)), tmp_path / f"{name}.c")[0])


def test_a_file_that_cannot_stand_there_leaves_neither(tmp_path) -> None:
    law = Feedback(np.eye(1), ("a",))
    (tmp_path / "law.h").mkdir()
    for path, said in ((tmp_path / "law.c", "a folder of this name"), (tmp_path / "no" / "law.c", "does not exist")):
        with pytest.raises(OSError, match=said):
            export_c(law, path)
    assert [path.name for path in tmp_path.iterdir()] == ["law.h"]
