"""One run: its growth is that of the loop's eigenvalues, its score that of `rollout`."""

import dataclasses

import numpy as np
import pytest
from data_sheet_craft import pointing, scene, shifted

from pliant.controllers import loop
from pliant.studies.closed_loop.rollout import rollout
from pliant.studies.closed_loop.scores import score
from pliant.studies.monte_carlo.trial import drawn, trial


def test_a_run_is_the_scene_with_another_plant() -> None:
    law = pointing(0.1, 0.25)
    played = dataclasses.replace(scene(duration=10.0), randomise=(("appendages.0.stiffness_factor", 0.64, 1.44),))
    row = trial(played, law, 0, 5, False, 0)
    (factor,) = drawn(played, 0, 5)
    other = scene(duration=10.0).with_plant(shifted(played.plant, float(np.sqrt(factor))))
    assert row["cost"] == pytest.approx(score(other, rollout(other, law)).cost, rel=1e-9)
    model = other.plant.feedback_model(*other.target)
    assert row["growth"] == pytest.approx(np.log(np.abs(np.linalg.eigvals(loop(model, law).closed())).max()) / 0.25)
