"""The histogram draws what the rows say, also where little is known."""

import math

import pytest

from pliant.studies.effectivity.effectivity import Effectivity
from pliant.studies.figures.effectivity import effectivity


def row(seed, kind, predicted, true, met=True):
    rung = {"variant": "v", "predicted": predicted, "bound": predicted, "true": true}
    made = {"seed": seed, "kind": kind, "failure": "", "met": met, "tolerance": 1.0, "uncertainty": 1e-4}
    costs = {"cpu": 1.0, "cpu_chosen": 1.0, "cpu_finest": 1.0, "wall": 1.0}
    return made | costs | {"true": true, "bound": predicted, "rungs": [rung]}


def test_every_ratio_is_in_a_bin_and_every_scene_a_point():
    rows = [row(0, "drop", 0.5, 0.5), row(1, "slew", 9.0, 0.5), row(2, "slew", None, 0.5), row(3, "drop", 0.01, 0.5)]
    figure = effectivity(Effectivity(tuple(rows)))
    bars = [p for container in figure.axes[0].containers for p in container.patches]
    assert sum(p.get_height() for p in bars) == len(rows)
    assert "4 predictions on 4 scenes" in figure.axes[0].get_title(loc="left")
    assert "25.0 % within 0.5 to 2" in figure.axes[0].texts[0].get_text()
    assert '4 "met", 0 of them wrong' in figure.axes[1].get_title(loc="left")


def test_a_wrong_one_is_told():
    figure = effectivity(Effectivity((row(0, "drop", 0.5, 1.5),)))
    assert "1 of them wrong" in figure.axes[1].get_title(loc="left")


@pytest.mark.parametrize("rows", ((), ({"seed": 0, "failure": "ValueError: no"},)))
def test_nothing_known_is_drawn_too(rows):
    figure = effectivity(Effectivity(rows))
    assert "0 predictions on 0 scenes" in figure.axes[0].get_title(loc="left")
    assert math.isnan(Effectivity(rows).tally.share((0.5, 2.0)))
