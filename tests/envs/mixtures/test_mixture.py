"""Which model each lane plays: shares, streams of the lanes' own, words."""

import dataclasses

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.envs.mixtures.mixture import Mixture

SLEW = scenes.get("single-link-slew")
PAIRS = (("rigid", 1.0), ("linear", 1.0), ("own", 2.0))


def drawn(lanes: int, times: int, seed: int = 0) -> np.ndarray:
    mixture = Mixture(SLEW, PAIRS, lanes)
    mixture.seed(range(lanes), range(seed, seed + lanes))
    found = []
    for _ in range(times):
        mixture.draw(np.arange(lanes))
        found.append(mixture.rung.copy())
    return np.array(found)


def test_models_are_drawn_by_their_shares() -> None:
    """4000 draws of shares 1/4, 1/4, 1/2: within five standard deviations of the binomial."""
    counts = np.bincount(drawn(40, 100).ravel(), minlength=3)
    shares = np.array([0.25, 0.25, 0.5])
    assert (np.abs(counts - 4000 * shares) < 5 * np.sqrt(4000 * shares * (1 - shares))).all()


def test_a_lane_draws_the_same_whatever_the_others_do() -> None:
    assert np.array_equal(drawn(1, 20, seed=3)[:, 0], drawn(6, 20)[:, 3])
    assert not np.array_equal(drawn(6, 20), drawn(6, 20, seed=6))


def test_words_and_labels_find_their_model() -> None:
    mixture = Mixture(SLEW, PAIRS, 2)
    assert [mixture.index("", word) for word in ("rigid", "linear", "linear, payload 2", "own")] == [0, 1, 1, 2]
    with pytest.raises(ValueError, match="fidelity = 'strain' must be one of 'rigid', 'linear, payload 2'"):
        mixture.index("fidelity", "strain")


def test_plants_of_ones_own_that_differ_in_numbers_alone_are_told_apart() -> None:
    loose = dataclasses.replace(SLEW.plant, hub_friction=0.5)
    mixture = Mixture(SLEW, (("own", 1.0), (loose, 1.0)), 2)
    assert mixture.labels.tolist() == ["stiffened, payload 2", "stiffened, payload 2 (2)"]
    assert mixture.index("", "stiffened, payload 2 (2)") == 1 and mixture.scenes[1].plant is loose


def test_a_model_twice_is_refused() -> None:
    with pytest.raises(ValueError, match="'stiffened' is 'stiffened, payload 2' again"):
        Mixture(SLEW, (("own", 1.0), ("stiffened", 1.0)), 2)
