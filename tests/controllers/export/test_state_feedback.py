"""Gains in C: closed loops beside `act`, and a law with states beside its own recursion."""

import numpy as np
import pytest
from exported import (
    answers_over_time,
    compiled,
    loop_in_c,
    needs_compiler,
    plant_objects,
    run,
    same_loop,
    strict_everywhere,
)

from pliant.controllers import LQR, TVLQR, Feedback, Filtered, roll_off
from pliant.controllers.analysis.linear_laws import LinearLaw
from pliant.controllers.export import export_c
from pliant.envs import scenes

pytestmark = needs_compiler


def test_lqr(tmp_path, reach, near) -> None:
    same_loop(tmp_path, reach, LQR.for_scene(reach), near)


@pytest.mark.parametrize("delay", [1.4, pytest.param((0, 1), marks=pytest.mark.campaign)])
def test_inputs_on_their_way(tmp_path, reach, near_double, delay) -> None:
    law = LQR.for_scene(reach, delay=delay)
    assert len(law.K_past.T) // reach.plant.nu == (2 if delay == 1.4 else 1)
    same_loop(tmp_path, reach, law, near_double, count=20)


def test_integrals_that_stand_still_at_a_limit(tmp_path, reach, near_double) -> None:
    same_loop(tmp_path, reach, LQR.for_scene(reach, integral={"tip_x": 1.0, "tip_y": 1.0}), near_double)


def test_a_file_whose_name_has_two_underscores(tmp_path) -> None:
    """Also a law inside another has them in its prefix: both call the file's own product."""
    law = Filtered(Feedback(np.eye(2), ("a", "b"), dt=0.1), (roll_off(0.6),))
    strict_everywhere(export_c(law, tmp_path / "my__law.c")[0])


@pytest.mark.campaign
def test_tvlqr_by_time(tmp_path, reach, near_double) -> None:
    same_loop(tmp_path, reach, TVLQR.for_scene(reach), near_double, count=30)


def test_tvlqr_by_phase(tmp_path) -> None:
    """Readings that linger at the start, rush, jump back and pass the end; each with an error of its own."""
    law = TVLQR.for_scene(scenes.get("single-link-slew"), index="phase")
    last, at = len(law.x) - 1, np.repeat(0, 5)
    at = np.concatenate([at, np.arange(0, last // 2, 3), np.arange(last // 4, last + 6)])
    noise = 0.02 * np.random.default_rng(0).standard_normal((len(at), law.x.shape[1])) * np.ptp(law.x, axis=0)
    readings, times = law.x[np.minimum(at, last)] + noise, law.dt * np.arange(len(at))
    law.reset()
    wanted = np.array([law.act(float(t), y) for t, y in zip(times, readings)])
    assert law.phase == last and (np.abs(wanted) < law.limits[1]).sum() > len(at) / 2
    files = [export_c(law, tmp_path / "law.c")[0], answers_over_time(tmp_path, law, times, readings, 1)]
    assert np.abs(run(compiled(files, tmp_path / "answers")) - wanted).max() < 1e-12 * np.abs(wanted).max()


def test_feedback_and_a_law_with_states(tmp_path, reach) -> None:
    plant, start = reach.plant, reach.initial[0]
    names = tuple(s.name for s in plant.states)[:2]
    gains = np.array([[30.0, 2.0], [1.0, 8.0]])
    slow = LinearLaw(0.5 * np.eye(2), 0.1 * np.eye(2), -gains, gains, names, reach.dt)
    for law in (Feedback(gains, names, dt=reach.dt, limits=(-3.0, 3.0)), slow):
        files = [export_c(law, tmp_path / "law.c")[0], *plant_objects(plant, reach.dt / 10, "double", tmp_path)]
        found = run(compiled([loop_in_c(tmp_path, plant, law, start, reach.dt, 5, 10), *files], tmp_path / "loop"))
        s, x = np.zeros(2), start
        for row in found:
            y = x[:2]
            u = np.clip(-gains @ y, -3, 3) if law is not slow else -(slow.C @ s + slow.D @ y)
            s = slow.A @ s + slow.B @ y
            assert np.allclose(row[:2], u, atol=1e-12)
            x = row[2:]
