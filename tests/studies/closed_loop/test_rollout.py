"""A sampled controller on a plant: the same as Plant.simulate and as the environment, and every failure recorded."""

import dataclasses

import numpy as np
import pytest
from scipy.stats import chi2

from pliant.controllers import LQR, Feedback
from pliant.controllers.estimation.sensors import sensors_of
from pliant.envs import PlantEnv, scenes
from pliant.plants import InfeasibleError
from pliant.studies.closed_loop.closed_loop import regulator
from pliant.studies.closed_loop.evaluation_scene import accurate, finer, play
from pliant.studies.closed_loop.rollout import NOISE, nominal, randomised, reading_noise, rollout

SLEW, REACH = scenes.get("single-link-slew"), scenes.get("two-link-reach")


class Scripted:
    """u(t) from a function; keeps what it is shown."""

    dt = None
    reads = ("hub_angle", "tip_deflection")

    def __init__(self, law):
        self.law, self.seen = law, []

    def reset(self):
        self.seen = []

    def act(self, t, y):
        self.seen.append(y.copy())
        return np.atleast_1d(self.law(t))


@pytest.fixture(scope="module")
def fine():
    return accurate(play(SLEW, finer(SLEW.plant)))[0]


def test_a_goal_that_moves_is_charged_where_it_then_is() -> None:
    """spacecraft-orbit, whose panels follow the sun, a tenth of an orbit: the cost is that of Plant.simulate."""
    orbit = scenes.get("spacecraft-orbit", duration=600.0)
    law = LQR.for_scene(orbit)
    want = orbit.cost(orbit.plant.simulate(orbit.initial[0], law, orbit.times, rtol=1e-9, atol=1e-12))
    run = rollout(orbit, law)
    assert run.cost == pytest.approx(want, rel=1e-5)
    assert np.ptp(run["hinge1_1"]) > 0.5  # the panels did turn


@pytest.mark.every(2)
@pytest.mark.parametrize("scene", [SLEW, REACH], ids=lambda s: s.name)
def test_without_noise_and_delay_it_is_plant_simulate(scene):
    law, played = regulator(scene), play(scene)
    run = rollout(played, law)
    same = scene.plant.simulate(scene.initial[0], law, scene.times, method="rk4", step=scene.dt / played.substeps)
    assert run.failure == "" and len(run.t) == scene.steps + 1
    assert run.cost == pytest.approx(scene.cost(same), rel=1e-9)
    for name in ("tip_x", scene.goal[0][0]):
        assert np.allclose(run[name], same[name], rtol=0, atol=1e-9)
    exact = scene.plant.simulate(scene.initial[0], law, scene.times, rtol=1e-9, atol=1e-11)
    assert run.cost == pytest.approx(scene.cost(exact), rel=1e-5)


@pytest.mark.campaign
def test_finer_plant_from_other_parameters_is_that_plant(fine):
    """The kernel's parameters p against a plant that is built with the numbers; payload shapes stay the nominal's."""
    given = dataclasses.replace(nominal(fine), p=fine.varied_plant.nominal_parameters * [1.0, 1.2, 0.8])
    assert fine.varied_plant.varied == ("payload.mass", "link.E", "link.damping")
    link = dataclasses.replace(fine.plant.link, E=1.2 * SLEW.plant.link.E, damping=0.8 * SLEW.plant.link.damping)
    plant = dataclasses.replace(fine.plant, link=link)
    law = regulator(SLEW)
    motion = plant.simulate(SLEW.initial[0][[0, 1, 2, 2, 3, 4, 5, 5]], law, SLEW.times, rtol=1e-9, atol=1e-11)
    assert rollout(fine, law, given).cost == pytest.approx(fine.cost(motion), rel=1e-5)


def test_a_run_is_a_function_of_seed_and_number(fine):
    law = regulator(SLEW)
    few, many, other = randomised(fine, 2, 7), randomised(fine, 5, 7), randomised(fine, 2, 8)
    for a, b in zip(few, many, strict=False):
        assert (a.x == b.x).all() and (a.p == b.p).all() and a.seed == b.seed
        first, again = rollout(fine, law, a), rollout(fine, law, b)
        assert first.cost == again.cost and (first.signals == again.signals).all()
    assert (few[0].p != other[0].p).all()
    assert rollout(fine, law, few[0]).cost != rollout(fine, law, few[1]).cost


def test_drawn_parameters_fill_their_ranges(fine):
    p = np.array([c.p for c in randomised(fine, 400)]) / fine.varied_plant.nominal_parameters
    assert p.min() >= 0.7 and p.max() <= 1.3 and p.min() < 0.71 and p.max() > 1.29
    assert np.allclose(p.std(axis=0), 0.6 / np.sqrt(12), rtol=0.1)  # uniform


def test_delay_shifts_the_input():
    law = Scripted(lambda t: 2.0 * np.sin(3 * t))
    played = play(SLEW)
    for delay in (0, 1, 3):
        run = rollout(played, law, dataclasses.replace(nominal(played), delay=delay))
        assert np.allclose(run.asked[:, 0], 2.0 * np.sin(3 * played.times[:-1]))
        assert (run.u[delay:] == run.asked[: len(run.asked) - delay]).all()
        assert np.allclose(run.u[:delay], SLEW.initial[1])


def test_before_the_first_input_acts_the_start_is_held():
    """Against gravity: nothing moves while nothing new acts."""
    played = play(REACH)
    hold = Feedback(np.zeros((2, 1)), reads=("theta1",), u_ref=np.array([30.0, 0.0]), dt=REACH.dt)
    run = rollout(played, hold, dataclasses.replace(nominal(played), delay=5))
    assert np.abs(run.signals[5, :12] - REACH.initial[0]).max() < 1e-9
    assert np.abs(run.signals[7, :12] - REACH.initial[0]).max() > 1e-3


def test_inputs_are_cut_off_at_the_limits_and_what_was_asked_is_kept():
    run = rollout(play(SLEW), Scripted(lambda t: 100.0 if t < 0.05 else 0.0))
    assert run.asked.max() == 100.0 and run.u.max() == pytest.approx(40.0, rel=1e-12)


def test_noise_has_the_stated_deviation_and_is_white(fine):
    law = Scripted(lambda t: 0.0)
    scale = reading_noise(fine)[[fine.positions([name])[0] for name in law.reads]]
    errors = []
    for given in randomised(fine, 20):
        run = rollout(fine, law, given)
        errors.append(np.array(law.seen) - np.stack([run[n] for n in law.reads], axis=1)[:-1])
    e = np.array(errors) / scale  # (runs, samples, signals)
    n = e[..., 0].size
    low, high = chi2.ppf([1e-4, 1 - 1e-4], n) / n
    for k in range(2):
        assert low < (e[..., k] ** 2).mean() < high
        assert abs(e[..., k].mean()) < 4 / np.sqrt(n)
        assert abs((e[:, 1:, k] * e[:, :-1, k]).mean()) < 4 / np.sqrt(n)
    assert abs((e[..., 0] * e[..., 1]).mean()) < 4 / np.sqrt(n)


def test_noise_is_the_sensors_where_there_is_one_and_a_share_of_the_range_elsewhere(fine):
    known, noise = [s.name for s in fine.signals], reading_noise(fine)
    (encoder,) = (s for s in sensors_of(fine.plant) if s.output == "hub_angle")
    assert noise[known.index("hub_angle")] == encoder.deviation(fine.dt)
    span = np.ptp(fine.open_loop(rtol=1e-8, atol=1e-10)["tip_deflection"])
    assert noise[known.index("tip_deflection")] == pytest.approx(NOISE * span, rel=0.05)


def test_leaving_a_bound_ends_the_run_and_is_charged_as_the_environment_charges():
    env = PlantEnv(SLEW)
    env.reset()
    total, over = 0.0, False
    while not over:
        _, reward, over, _, _ = env.step(np.ones(1))
        total -= reward
    run = rollout(SLEW, Scripted(lambda t: 40.0))
    assert run.failure.startswith("hub_angle_rate beyond its bound 12 at ")
    assert run.cost == pytest.approx(total, rel=1e-12)
    assert len(run.u) == len(run.t) - 1 < SLEW.steps


def test_divergence_is_recorded_with_a_finite_or_infinite_cost():
    """RK4 far beyond its step limit: the state grows without end."""
    wild = dataclasses.replace(SLEW, substeps=1, bounds=(), dt=0.05)
    run = rollout(wild, Scripted(lambda t: 1.0))
    assert run.failure.startswith("diverged at ")
    assert np.isfinite(run.signals).all() and run.cost > rollout(SLEW, Scripted(lambda t: 1.0)).cost


def test_a_controller_that_gives_up_is_recorded_and_other_errors_pass():
    def gives_up(t):
        if t > 0.1:
            raise InfeasibleError("no plan")
        return 0.0

    run = rollout(SLEW, Scripted(gives_up))
    assert run.failure == "InfeasibleError at 0.12 s: no plan" and len(run.u) == 6
    assert run.cost > 100  # the time left is charged
    assert rollout(SLEW, Scripted(lambda t: np.nan)).failure.startswith("the controller gave [nan] at 0 s")
    with pytest.raises(ZeroDivisionError):
        rollout(SLEW, Scripted(lambda t: 1 / 0))


def test_bad_input():
    law, played = regulator(SLEW), play(SLEW)
    with pytest.raises(ValueError, match=r"controller\.dt = 0.01 s must be the scene's 0.02 s"):
        rollout(played, Feedback(np.zeros((1, 1)), reads=("hub_angle",), dt=0.01))
    with pytest.raises(ValueError, match="signal 'eta9' must be one of"):
        rollout(played, Feedback(np.zeros((1, 1)), reads=("eta9",)))
    with pytest.raises(ValueError, match=r"Conditions\.p has shape \(1,\), must be \(3,\)"):
        rollout(played, law, dataclasses.replace(nominal(played), p=np.ones(1)))
    with pytest.raises(ValueError, match=r"Conditions\.delay = -1"):
        rollout(played, law, dataclasses.replace(nominal(played), delay=-1))
    with pytest.raises(ValueError, match=r"randomised\.count = 0"):
        randomised(played, 0)


def test_time_of_every_act_is_measured():
    run = rollout(play(SLEW), regulator(SLEW))
    assert run.act_ns.shape == (SLEW.steps,) and (run.act_ns > 0).all()


class Odd:
    """A controller of one's own."""

    dt, reads = None, ("hub_angle",)

    def reset(self):
        pass

    def act(self, t, y):
        return np.zeros(1)


@pytest.mark.parametrize(
    ("name", "value"),
    [("dt", float("nan")), ("dt", "0.02"), ("reads", b"ab"), ("reads", 3), ("reset", 3), ("act", lambda t, y: ["1.0"])],
)
def test_a_controller_with_an_odd_part_is_refused_by_its_name(name, value):
    law = Odd()
    setattr(law, name, value)
    with pytest.raises(ValueError, match=rf"controller\.{name} = "):
        rollout(scenes.get("single-link-slew"), law)
