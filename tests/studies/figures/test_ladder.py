"""The pictures of the ladder and of every setting of `simulate`."""

from types import SimpleNamespace

from made_up_charts import made_up_chart

from pliant.studies.fidelity.choice import Rung
from pliant.studies.figures.ladder import ladder, settings


def test_a_bar_for_each_rung_that_was_tried():
    rungs = (Rung("a", 2, 1e-2, 1.1e-2), Rung("b", 4, 1e-4, 2e-4, chosen=True), Rung("c", 6, None, None))
    choice = SimpleNamespace(rungs=rungs, tolerance=1e-3, convergence=1e-5, compare=("tip_x",), unit="m")
    (ax,) = ladder(choice).axes
    assert [text.get_text() for text in ax.get_yticklabels()] == ["a", "b", "c"]
    assert [bar.get_width() for bar in ax.patches][:2] == [1e-2, 1e-4]
    assert [text.get_text() for text in ax.texts] == [" not tried"]


def test_the_stepper_and_linear_models_are_no_settings_of_simulate():
    (ax,) = settings(made_up_chart()).axes
    columns = [text.get_text() for text in ax.get_xticklabels()]
    assert columns == ["dop853, rtol 1e-03", "rk4, 20 ms", "rosenbrock, 20 ms", "midpoint, 20 ms"]
    assert [text.get_text() for text in ax.texts] == ["S", "-", "B"]
