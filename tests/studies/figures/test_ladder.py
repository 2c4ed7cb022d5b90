"""The pictures of the ladder and of every setting of `simulate`."""

from types import SimpleNamespace

import numpy as np
from made_up_charts import made_up_chart

from pliant.studies.fidelity.choice import Rung
from pliant.studies.figures.ladder import effects, ladder, settings
from pliant.studies.physics.effects import Effect


def test_a_bar_for_each_rung_that_was_tried():
    rungs = (Rung("a", 2, 1e-2, 1.1e-2), Rung("b", 4, 1e-4, 2e-4, chosen=True), Rung("c", 6, None, None))
    choice = SimpleNamespace(rungs=rungs, tolerance=1e-3, convergence=1e-5, compare=("tip_x",), unit="m")
    (ax,) = ladder(choice).axes
    assert [text.get_text() for text in ax.get_yticklabels()] == ["a", "b", "c"]
    assert [bar.get_width() for bar in ax.patches][:2] == [1e-2, 1e-4]
    assert [text.get_text() for text in ax.texts] == [" not tried"]


def test_effects_are_lines_over_time_as_far_as_they_have_any():
    times = np.linspace(0.0, 1.0, 3)
    moved = np.array([[0.0, 0.0], [1e-3, -2e-3], [0.0, 5e-4]])
    shown = [
        Effect("bending", 2e-3, True, moved),
        Effect("shear", 2e-3, False, moved),
        Effect("luck", float("inf"), False),
        Effect("dust", 1e-9, False, 1e-7 * moved),
    ]
    told = {"tolerance": 1e-3, "compare": ("tip_x",), "unit": "m", "plant": SimpleNamespace(label="rigid")}
    (ax,) = effects(SimpleNamespace(effects=shown, **told), times).axes
    lines = {line.get_label(): line for line in ax.lines}
    assert list(lines) == ["bending, kept", "shear", "tolerance"]
    assert lines["shear"].get_ydata()[1:].tolist() == [2e-3, 5e-4] and lines["bending, kept"].get_linestyle() == "--"


def test_the_stepper_and_linear_models_are_no_settings_of_simulate():
    (ax,) = settings(made_up_chart()).axes
    columns = [text.get_text() for text in ax.get_xticklabels()]
    assert columns == ["dop853, rtol 1e-03", "rk4, 20 ms", "rosenbrock, 20 ms", "midpoint, 20 ms"]
    assert [text.get_text() for text in ax.texts] == ["S", "-", "B"]


def test_no_picture_of_effects_where_none_can_be_seen():
    told = {"tolerance": 1e-3, "compare": ("tip_x",), "unit": "m", "plant": SimpleNamespace(label="rigid")}
    dust = Effect("dust", 1e-9, False, np.full((3, 1), 1e-9))
    assert effects(SimpleNamespace(effects=[dust], **told), np.linspace(0.0, 1.0, 3)) is None


def test_a_rung_without_a_motion_has_no_bar():
    rungs = (Rung("lost", 2, np.inf, np.inf), Rung("b", 4, 1e-4, 2e-4, chosen=True))
    choice = SimpleNamespace(rungs=rungs, tolerance=1e-3, convergence=1e-9, compare=("tip_x",), unit="m")
    (ax,) = ladder(choice).axes
    assert len(ax.patches) == 1 and [text.get_text() for text in ax.texts] == [" no result"]
    assert "at the edge" not in ax.get_xlabel()
