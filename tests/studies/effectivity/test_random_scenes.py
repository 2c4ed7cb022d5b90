"""Scenes by seed: the same each time, of five kinds, spread as said."""

import numpy as np
import pytest

from pliant.studies.effectivity.random_scenes import KINDS, TOLERANCES, random_scene

DRAWN = [random_scene(k) for k in range(40)]


def stiffness(drawn):
    plant = drawn.scene.plant
    for part in ("link", "link1", "beam"):
        if hasattr(plant, part):
            beam = getattr(plant, part)
            return beam.E * beam.I_z
    return drawn.line.E * drawn.line.I_y


def test_one_seed_is_one_scene():
    a, b = random_scene(6).scene, random_scene(6).scene
    assert a.plant == b.plant and a.tolerance == b.tolerance and (a.times == b.times).all()
    assert random_scene(11).scene.plant != a.plant


def test_all_kinds_come_in_turn():
    assert [d.kind for d in DRAWN[: len(KINDS)]] == [name for name, _ in KINDS]


@pytest.mark.parametrize("k", range(len(KINDS)))
def test_stiffness_is_spread_over_more_than_a_decade(k):
    found = [stiffness(d) for d in DRAWN[k :: len(KINDS)]]
    assert max(found) > 10 * min(found)


def test_tolerances_are_spread_over_their_decades():
    found = np.log10([d.scene.tolerance / reach(d) for d in DRAWN])
    assert TOLERANCES[0] <= found.min() < TOLERANCES[0] + 0.5 and TOLERANCES[1] - 0.5 < found.max() <= TOLERANCES[1]


def reach(drawn):
    plant = drawn.scene.plant
    return sum(getattr(plant, p).length for p in ("link", "link1", "link2", "beam") if hasattr(plant, p)) or 1.0


@pytest.mark.parametrize("k", range(len(KINDS)))
def test_every_kind_can_be_played_by_its_cheapest_variant(k):
    scene = DRAWN[k].scene
    assert np.isfinite(scene.nominal_input(scene.times[1])).all()
    assert scene.steps == len(scene.times) - 1 == 150


@pytest.mark.parametrize("seed", (-1, 1.5, "one"))
def test_bad_seed(seed):
    with pytest.raises(ValueError, match=r"random_scene"):
        random_scene(seed)
