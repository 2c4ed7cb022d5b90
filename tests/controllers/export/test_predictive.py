"""MPC in C: in closed loop, and its answers on random programs beside those of DAQP."""

import numpy as np
import pytest
from exported import answers_in_c, answers_over_time, compiled, needs_compiler, run, same_loop

from pliant.controllers import MPC, plan
from pliant.controllers.export import export_c
from pliant.controllers.solvers.daqp_model import INFINITE
from pliant.envs import scenes
from pliant.plants.linear.lti import LinearModel

pytestmark = needs_compiler


def test_in_closed_loop(tmp_path, reach, near) -> None:
    law = MPC.for_scene(reach)
    same_loop(tmp_path, reach, law, near)
    assert law.record.limited > 2 and law.record.failures == 0  # programs were solved


@pytest.mark.parametrize("delay", [1.4, pytest.param((0, 1), marks=pytest.mark.campaign)])
def test_with_inputs_on_their_way(tmp_path, reach, near_double, delay) -> None:
    law = MPC.for_scene(reach, 10, rates=400.0, delay=delay)
    same_loop(tmp_path, reach, law, near_double, count=20)
    assert law.record.limited > 2 and law.record.failures == 0


def random_program(seed: int):
    """(law, readings, answers by DAQP): in some no plan keeps the bounds; in seed 0 the rates of inputs are limited."""
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(2, 7)), int(rng.integers(1, 3))
    A = rng.standard_normal((n, n))
    A -= (np.linalg.eigvals(A).real.max() - 0.3) * np.eye(n)
    model = LinearModel.from_matrices(A, rng.standard_normal((n, m)))
    limited = {"limits": (-1.0, 1.0), "bounds": {model.state_names[0]: (-1.0, 1.0)}}
    limited["rates"] = 5.0 if seed == 0 else None
    penalty, horizon = None if seed % 2 else 50.0, int(rng.integers(5, 15))
    law = MPC.design(model, np.eye(n), np.eye(m), dt=0.1, horizon=horizon, penalty=penalty, **limited)
    readings = rng.standard_normal((60, n)) * np.geomspace(0.1, 3, 60)[:, None]
    wanted = []
    for y in readings:
        law.reset()
        wanted.append(law.act(0.0, y).copy())
    return law, readings, np.array(wanted)


@pytest.mark.parametrize("seed", [0, 1])
def test_random_programs_with_soft_limits_that_cannot_be_kept(tmp_path, seed) -> None:
    law, readings, wanted = random_program(seed)
    sources = [answers_in_c(tmp_path, law, readings), export_c(law, tmp_path / "law.c")[0]]
    found = run(compiled(sources, tmp_path / "answers"))
    assert not found[:, -1].any()
    assert np.abs(found[:, :-1] - wanted).max() < 1e-9


def test_a_bound_that_stands_for_none_is_a_number_in_single_precision() -> None:
    assert np.finfo(np.float32).max > INFINITE


@pytest.mark.parametrize("definite", ["1e-12", "1e-13"])
def test_a_plan_that_rounding_makes_up_is_none(tmp_path, definite) -> None:
    """With rows told apart to 1e-13, rows that depend on each other pass for independent at one of these readings, and
    the program gives a plan where no plan keeps the bounds: the last look at all rows refuses it."""
    law, readings, wanted = random_program(13)
    source = export_c(law, tmp_path / "law.c")[0]
    text = source.read_text()
    assert "law_DEFINITE ((law_real)1e-12)" in text
    source.write_text(text.replace("law_DEFINITE ((law_real)1e-12)", f"law_DEFINITE ((law_real){definite})"))
    found = run(compiled([answers_in_c(tmp_path, law, readings), source], tmp_path / "answers"))
    assert np.abs(found[:, :-1] - wanted).max() < 1e-9


def test_along_a_nominal(tmp_path) -> None:
    """References and held inputs of each node, before its start and past its end; limits bind in some programs."""
    scene = scenes.get("single-link-slew")
    t = 0.02 * np.arange(12)
    motion = scene.plant.simulate(scene.initial[0], np.sin(9 * t)[:, None], t)
    law = MPC.for_scene(scene, 5, nominal=motion, rates=60.0)
    times = np.array([-0.01, *(t - 0.008), 0.3, 5.0])  # the nearest node counts
    rng = np.random.default_rng(1)
    nodes = np.clip(np.rint(times / 0.02).astype(int), 0, 11)
    readings = motion.x[nodes] + rng.standard_normal((len(times), scene.plant.nx)) * 2e-3
    law.reset()
    wanted = np.array([law.act(float(a), y).copy() for a, y in zip(times, readings)])
    assert law.record.limited > 2 and law.record.failures == 0 and len(law._steps) == 12
    files = [export_c(law, tmp_path / "law.c")[0], answers_over_time(tmp_path, law, times, readings, 1)]
    found = run(compiled(files, tmp_path / "answers"))
    assert np.abs(found - wanted).max() < 1e-9 * np.abs(wanted).max()


@pytest.mark.campaign
def test_along_a_plan_in_closed_loop(tmp_path, reach, near) -> None:
    law = MPC.for_scene(reach, 10, nominal=plan(reach, reserve=0.1).trajectory(reach.plant), blocks=(1, 1, 2, 6))
    same_loop(tmp_path, reach, law, near)


def test_what_would_be_too_large_is_told_with_its_size(tmp_path) -> None:
    model = LinearModel.from_matrices(-np.eye(2), np.eye(2))
    law = MPC.design(model, np.eye(2), np.eye(2), dt=0.1, horizon=10, limits=(-1.0, 1.0))
    law._steps = law._steps * 20_000
    with pytest.raises(ValueError, match=r"MPC, horizon 10 would take [\d,]+ numbers of constants \([\d.,]+ MB\)"):
        export_c(law, tmp_path / "law.c")
    assert not list(tmp_path.iterdir())
