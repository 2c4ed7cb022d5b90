"""Motions by a plant's tape are those of the virtual machine, whose loop is written in Python."""

import dataclasses
import itertools

import numpy as np
import pytest

from pliant.plants import SingleLinkArm
from pliant.plants.integration import dormand_prince
from pliant.plants.motions import motion_library, tape_motion
from pliant.plants.motions.adaptive_steps import TOO_MANY, limits
from pliant.plants.motions.tape_motion import TapePair
from pliant.plants.rows.tape_programs import COMPILING

TIMES = np.linspace(0.0, 0.5, 26)


@pytest.fixture
def arm():
    """With the C at hand, where there is a compiler."""
    plant = SingleLinkArm.textbook()
    if tape_motion.at_hand(plant, 2 * COMPILING) is None:
        pytest.skip("no compiler")
    return plant


def marched(plant, held, settings, restart=True):
    found, run = tape_motion.at_hand(plant, 0.0)
    x = np.zeros((len(TIMES), plant.nx))
    motion = found.adapted(run, (TIMES, held, *plant.quiet, x), settings)
    return x, motion, motion.march(0, len(TIMES) - 1, 1e-3, restart=restart)


def test_states_and_steps_are_those_of_the_loop_in_python(arm):
    held = np.where(TIMES < 0.25, 1.0, -1.0)[:, None]
    x, motion, status = marched(arm, held, (1e-8, 1e-10, *limits()))
    assert status == 0
    z, tried, step = np.zeros(arm.nx), 0, 1e-3
    for k, (start, end) in enumerate(itertools.pairwise(TIMES)):
        given = (np.array([start, end]), z, held[k], None, *arm.quiet)
        first = min(step, end - start)
        rows, more, step = dormand_prince.march(arm, *given, rtol=1e-8, atol=1e-10, first=first, audit=False)
        z, tried = rows[-1], tried + more
        np.testing.assert_allclose(x[k + 1], z, rtol=1e-12, atol=1e-13)
    assert motion.tried == tried


def test_a_motion_stops_after_as_many_steps_as_it_may_take(arm):
    *bounds, _ = limits()
    _, motion, status = marched(arm, np.ones((len(TIMES), 1)), (1e-8, 1e-10, *bounds, 7))
    assert status == TOO_MANY
    assert motion.tried == 8


def test_simulate_takes_it_and_says_that_no_compiled_code_took_the_steps(arm, monkeypatch):
    monkeypatch.setattr(motion_library, "cached", lambda *a: None)
    asked, adapted = [], TapePair.adapted
    monkeypatch.setattr(TapePair, "adapted", lambda *given: asked.append(1) or adapted(*given))
    other = dataclasses.replace(arm, hub_inertia=0.1234)
    motion = other.simulate(np.zeros(other.nx), np.ones((len(TIMES), 1)), TIMES)
    assert not motion.stats["native"]
    assert len(asked) == 6  # intervals 1, 2, 4, 8, 16 and 25: a library may come between
    monkeypatch.setattr(tape_motion.program, "run", None)
    monkeypatch.setattr(tape_motion.program, "_refused", True)
    np.testing.assert_allclose(
        motion.x, other.simulate(np.zeros(other.nx), np.ones((len(TIMES), 1)), TIMES).x, rtol=1e-9
    )


def test_c_with_other_numbers_is_refused(monkeypatch):
    wrong = tape_motion._ATTEMPT.replace("trial * sum;", "trial * sum * 1.001;", 1)
    monkeypatch.setattr(tape_motion, "_ATTEMPT", wrong)
    program = tape_motion.Program("pair", tape_motion.source, tape_motion._load, tape_motion._check)
    assert program.at_hand(2 * COMPILING) is None
