"""A run's checkpoint: whole or an error that names it."""

import numpy as np
import pytest

from pliant.controllers.analytic_gradients import run_files
from pliant.controllers.analytic_gradients.adam import Adam
from pliant.controllers.learning.policy import Policy

WORDS = {
    "scene": "s",
    "algorithm": "apg",
    "settings": {},
    "seed": 0,
    "stamp": 5,
    "spent": 1.0,
    "curve": [],
    "best_score": 2.0,
}
POLICY = Policy(
    weights=(np.ones((1, 1)),),
    biases=(np.zeros(1),),
    mean=np.zeros(1),
    std=np.ones(1),
    scene="s",
    reads=("a",),
    goal=np.zeros(1),
    inputs=("u",),
    limits=np.ones(1),
    dt=0.1,
)


def test_there_and_back(tmp_path) -> None:
    adam, rng = Adam.start(np.arange(3.0)), np.random.default_rng(4)
    rng.random(7)
    run_files.save(tmp_path, WORDS, adam, rng, np.array([2.0]), POLICY)
    words, again, drawn, std, best = run_files.load(tmp_path)
    assert run_files.exists(tmp_path) and words["stamp"] == 5 and std[0] == 2.0 and best.limits[0] == 1.0
    np.testing.assert_array_equal(again.theta, adam.theta)
    assert drawn.random() == rng.random()


def test_what_is_missing_or_damaged_is_named(tmp_path) -> None:
    with pytest.raises(ValueError, match=r"resume: .* holds no checkpoint \(checkpoint\.npz\)"):
        run_files.load(tmp_path)
    run_files.save(
        tmp_path, {**WORDS, "algorithm": "ppo"}, Adam.start(np.zeros(2)), np.random.default_rng(), np.ones(1), POLICY
    )
    with pytest.raises(ValueError, match="algorithm = 'ppo' must be 'apg'"):
        run_files.load(tmp_path)
    words = {k: v for k, v in WORDS.items() if k != "seed"}
    run_files.save(tmp_path, words, Adam.start(np.zeros(2)), np.random.default_rng(), np.ones(1), POLICY)
    with pytest.raises(ValueError, match="seed"):
        run_files.load(tmp_path)
    (tmp_path / "checkpoint.npz").write_bytes(b"no")
    with pytest.raises(ValueError, match=r"checkpoint\.npz"):
        run_files.load(tmp_path)
