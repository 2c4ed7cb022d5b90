"""A policy in C: the one that is shipped in closed loop, and a network by hand."""

import dataclasses

import numpy as np
import pytest
from exported import answers_in_c, compiled, needs_compiler, run, same_loop

from pliant.controllers import Policy
from pliant.controllers.export import export_c

pytestmark = needs_compiler


def test_the_shipped_policy(tmp_path, reach, near_double) -> None:
    same_loop(tmp_path, reach, Policy.for_scene("two-link-reach"), near_double)


def test_a_network_by_hand(tmp_path) -> None:
    """z = clip((y - 1 - 1) / 2, -3, 3), h = max(2 z, 0), u = 5 tanh(h - 1)."""
    law = Policy(
        weights=([[2.0]], [[1.0]]),
        biases=([0.0], [-1.0]),
        mean=[1.0],
        std=[2.0],
        scene="none",
        reads=("a",),
        goal=[1.0],
        inputs=("u",),
        limits=[5.0],
        dt=0.1,
        clip=3.0,
        activation="relu",
        squash=True,
    )
    y = np.array([[-9.0], [1.0], [2.5], [4.0], [40.0]])
    found = run(compiled([answers_in_c(tmp_path, law, y), export_c(law, tmp_path / "law.c")[0]], tmp_path / "answers"))
    h = np.maximum(2 * np.clip((y - 2) / 2, -3, 3), 0)
    assert np.abs(found[:, :1] - 5 * np.tanh(h - 1)).max() < 1e-14


def test_a_memory_has_no_form_in_c(tmp_path) -> None:
    own = Policy.for_scene("single-link-slew")
    wide = (np.zeros((64, 9)), *own.weights[1:])
    with pytest.raises(ValueError, match=r"Policy\.history = 1 must be 0"):
        export_c(dataclasses.replace(own, weights=wide, history=1), tmp_path / "law.c")
    for task in ({"hold": 2}, {"reach": np.full(len(own.inputs), 0.5)}):
        with pytest.raises(ValueError, match="commands last or are no shares of the limits"):
            export_c(dataclasses.replace(own, **task), tmp_path / "law.c")
