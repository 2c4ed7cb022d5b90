"""A filtered controller: its linear form is what it does, its margins are those of the product, its C is itself."""

import numpy as np
import pytest
from data_sheet_craft import J, craft, pointing, scene
from exported import compiled, loop_in_c, loop_in_python, needs_compiler, run

from pliant.controllers import Filtered, export_c, loop, margins, notch, roll_off
from pliant.controllers.analysis.linear_laws import law_of
from pliant.plants import PliantError

FILTERS = (notch(0.8305, depth=0.1), roll_off(2.0))


def test_acting_is_the_linear_form() -> None:
    law = Filtered(pointing(0.1, 0.25), FILTERS)
    form, rng, s = law_of(law), np.random.default_rng(0), np.zeros(12)
    for k in range(20):
        y = 1e-2 * rng.standard_normal(6)
        assert law.act(0.25 * k, y) == pytest.approx(-(form.C @ s + form.D @ y), rel=1e-12)
        s = form.A @ s + form.B @ y


def test_the_loop_is_the_product() -> None:
    whole = craft()
    model, w = whole.feedback_model(whole.state()), np.array([0.05, 0.3, 0.9])
    plain, with_it = (loop(model, law).at(w) for law in (pointing(0.1, None), Filtered(pointing(0.1, None), FILTERS)))
    shape = FILTERS[0].at(w) * FILTERS[1].at(w)
    assert with_it == pytest.approx(shape[:, None, None] * plain, rel=1e-10)
    assert margins(loop(model, Filtered(pointing(0.1), FILTERS[:1]))).disk > 1


def test_limits_hold_behind_the_filters() -> None:
    law = Filtered(pointing(0.1, 0.25), FILTERS)
    assert np.abs(law.act(0.0, np.full(6, 1e6))).max() <= 20.0


@needs_compiler
def test_the_same_in_c(tmp_path) -> None:
    played = scene()
    law, plant = Filtered(pointing(0.1, 0.25), FILTERS), played.plant
    files = [export_c(law, tmp_path / "law.c")[0], export_c(plant, tmp_path / "plant.c", dt=0.125)[0]]
    wanted = loop_in_python(plant, law, played.initial[0], 0.25, 40, 2)
    found = run(compiled([loop_in_c(tmp_path, plant, law, played.initial[0], 0.25, 40, 2), *files], tmp_path / "loop"))
    assert np.abs(found - wanted).max() < 1e-9 * np.abs(J).max()


def test_what_cannot_be_is_told() -> None:
    with pytest.raises(PliantError, match="acts only behind a sampled"):
        Filtered(pointing(0.1, None), FILTERS).act(0.0, np.zeros(6))
    with pytest.raises(ValueError, match="at least one Filter"):
        Filtered(pointing(0.1, 0.25), ())
    with pytest.raises(ValueError, match=r"filters\[0\]\.dt"):
        Filtered(pointing(0.1, 0.25), (notch(1.0).discretised(0.5),))
