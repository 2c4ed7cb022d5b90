"""How a motion goes on: who plays which method, and from where compiled code does."""

import numpy as np
import pytest
from oscillators import Oscillator

from pliant.plants.integration import motion_run, simulation
from pliant.plants.integration.step_maps import METHODS
from pliant.plants.motions.held_inputs import HeldInput

SWING, TIMES = Oscillator(omega=3.0), np.linspace(0.0, 1.0, 17)


def made(method, u=None, **options):
    w, p = np.zeros(1), np.zeros(0)
    drive = HeldInput(SWING, u, TIMES, w, p)
    given = {"step": None, "rtol": 1e-8, "atol": 1e-8, "audit": False, "progress": None} | options
    kind = simulation.ADAPTIVE.get(method, motion_run.FixedRun)
    return kind(SWING, drive, TIMES, np.array([1.0, 0.0]), w, p, method, *given.values())


@pytest.mark.parametrize("method", [*simulation.ADAPTIVE, *METHODS])
def test_every_method_is_played_and_is_a_cosine(method, monkeypatch):
    monkeypatch.setenv("PLIANT_NATIVE", "0")
    run = made(method, u=np.zeros((17, 1)), step=1e-3 if method in METHODS else None)
    x, work = run.march()
    np.testing.assert_allclose(x[:, 0], np.cos(3 * TIMES), atol=1e-5)
    assert run.reached == run.intervals == 16 and run.native == 0 and not work.any()


def test_parts_double_until_a_library_is_there(monkeypatch):
    """Of a smooth input: 1, 1, 2, 4, .. intervals; of one that jumps each by itself; all where none is to be had."""
    monkeypatch.setenv("PLIANT_NATIVE", "1")
    run, parts = made("dop853"), []
    while run.reached < run.intervals:
        parts.append(run.next_part() - run.reached)
        run.reached = run.next_part()
    assert parts == [1, 1, 2, 4, 8]
    assert made("dop853", u=np.zeros((17, 1))).next_part() == 1
    monkeypatch.setenv("PLIANT_NATIVE", "0")
    assert made("dop853").next_part() == 16


def test_the_input_is_known_as_far_as_nobody_has_to_be_asked():
    assert made("rk4", step=0.1).ahead() == 16 and made("rk4", u=lambda t: [0.0], step=0.1).ahead() == 1
    assert made("rk4", step=0.1, progress=print).ahead() == 1  # 200 parts of 16


def test_a_first_step_is_a_tenth_of_the_fastest_modes_time_within_the_motion():
    assert made("rodas5p").first_step(0, np.array([1.0, 0.0])) == pytest.approx(0.1 / 3, rel=1e-6)
