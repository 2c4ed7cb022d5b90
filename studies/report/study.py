"""What the report finds out about a scene: it simulates, linearises, judges, closes the loop, charts and chooses."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants import LTVModel, Plant, PliantError, Trajectory
from pliant.plants.core.signals import Signal, names
from pliant.plants.motions.tabulated_inputs import tabulated
from pliant.plants.motions.time_limit import TooLong, time_limit
from pliant.studies.charts.measure import chart
from pliant.studies.closed_loop.closed_loop import closed_loop, dearer
from pliant.studies.closed_loop.comparison import Contest, compare
from pliant.studies.common import operating_point
from pliant.studies.common.processor_time import processor_time
from pliant.studies.common.reference_motions import Motions, Progress, share, silent
from pliant.studies.fidelity.choice import choose
from pliant.studies.physics.physics_motion import physics_motion
from pliant.studies.stability.judgement import judge

from .findings import Findings

CHART_BUDGET = 8.0  # [s] beside the reference, less on a machine so slow or busy that the whole would take long
WHOLE = 40.0  # [s] of processor time that a report should take at most
AFTER = 0.4  # what comes after the chart, as a share of what comes before it
LIMIT = 45.0  # [s] of processor time at which what is still sought is given up; a budget that is given comes to it
LEAST = {"physics": 20.0, "chart": 6.0, "choice": 5.0, "scene_error": 5.0}  # [s] that a part has; others one
# Of the time that is left when they begin; of others all
SHARES = {"nominal": 0.3, "law": 0.25, "contests": 0.25, "physics": 0.8, "closed loops": 0.4, "chart": 0.8}
CHOOSING = 30.0  # [s] that physics of closed loops may take, expected to be as long as that of the open loop took each
RTOL = 1e-9
FINER, NODES = 10, 4_000  # times a control period, and in all, of the motion that is linearised along
PERTURBATIONS = (0.03, 0.003)  # of a coordinate [its unit], to test the LTV model
T = TypeVar("T")
FELT = 1e-6  # change of a compared output per unit of a coordinate above which it feels it


def study(scene: Scene, *, progress: Progress | None = None, budget: float | None = None) -> Findings:
    """Simulate, linearise, judge, close the loop, compare, chart and choose; what fails is told, the rest is found."""
    told, motions, began = progress or silent, Motions(scene), processor_time()
    found = Findings(scene)
    until = began + LIMIT

    def find(name: str, part: Callable[[], Any]) -> None:
        found.find(name, in_its_time(name, part, until))

    told(0.0, "open loop")
    find("nominal", lambda: _nominal(scene))
    find("open_loop", lambda: _every(found.nominal, _finer(scene), scene.plant))
    told(0.08, "linear models")
    find("goal", lambda: scene.goal_model)
    find("along", lambda: scene.plant.linearize_along(found.nominal))
    find("perturbed", lambda: found.along.states[_felt(scene, found.along)])
    find("ltv_errors", lambda: _ltv_errors(scene, found.nominal, found.along, found.perturbed))
    told(0.12, "frequencies")
    every = _frequencies(scene)
    found.frequencies = tuple((label, value) for label, value in every if not isinstance(value, str))
    found.unheld = tuple((label, value) for label, value in every if isinstance(value, str))
    found.law, found.no_law, found.loops = None, "", ()
    looped = share(progress, 0.15, 0.22)
    designed = found.attempt("law", in_its_time("law", lambda: closed_loop(scene, progress=looped), until))
    if designed is None:
        found.no_law = found.lost.pop("law")
    else:
        found.law, found.loops = designed
    told(0.22, "stability")
    find("judgement", lambda: judge(scene, progress=share(progress, 0.22, 0.27)))
    against = share(progress, 0.27, 0.35)
    find("contests", lambda: compare(scene, found.law, found.loops, progress=against) if scene.plant.nu else ())
    told(0.35, "reference")  # before the chart, whose budget is for what it measures
    before = processor_time()
    truth = found.attempt("physics", in_its_time("physics", lambda: physics_motion(motions, scene.tolerance), until))
    of_physics = processor_time() - before
    if budget is None:
        spent = processor_time() - began
        budget = min(CHART_BUDGET, max(0.5 * CHART_BUDGET, WHOLE - (1 + AFTER) * spent))
    else:
        until += budget
    seconds = budget
    contests: tuple[Contest, ...] = () if "contests" in found.lost else found.contests
    whole = [c for c in contests if c.plant == scene.plant.label and _whole(scene, c.motion)]
    affordable = int(CHOOSING / of_physics)
    found.unasked = tuple(c.controller for c in whole[affordable:])
    closed, late = _closed_loops(scene, whole[:affordable], SHARES["closed loops"] * (until - processor_time()))
    found.unasked = (*late, *found.unasked)
    measuring = share(progress, 0.4, 0.85)
    find("chart", lambda: chart(scene, budget=seconds, motions=motions, progress=measuring))
    measured = None if "chart" in found.lost else found.chart
    choosing = share(progress, 0.85, 1.0)
    find("choice", lambda: choose(scene, measured=measured, motions=[motions, *closed], progress=choosing))
    if measured is not None and "choice" not in found.lost:
        found.chart = measured.holding(found.choice.integrator)
    if truth is None:
        found.lost["scene_error"] = found.lost.pop("physics")
    else:
        find("scene_error", lambda: motions.difference(scene.plant, truth.outputs))
    return found


def _closed_loops(scene: Scene, contests: list[Contest], seconds: float) -> tuple[list[Motions], list[str]]:
    """The motions of controllers of which physics is had in so many seconds, and whose it is not."""
    had, late, until = list[Motions](), list[str](), processor_time() + seconds
    for contest in contests:
        assert contest.motion is not None
        motions = Motions.with_inputs_of(scene, contest.motion, f"motion of {contest.controller}")
        try:
            with time_limit(until - processor_time()):
                physics_motion(motions, scene.tolerance)
        except TooLong:
            late.append(contest.controller)
            continue
        except PliantError:  # the choice tells it
            pass
        had.append(motions)
    return had, late


def in_its_time(name: str, part: Callable[[], T], until: float) -> Callable[[], T]:
    """The same part, given up where it takes more than its share of the time until `until` [s of processor time]."""

    def limited() -> T:
        with time_limit(max(LEAST.get(name, 1.0), SHARES.get(name, 1.0) * (until - processor_time()))):
            return part()

    return limited


def _whole(scene: Scene, motion: Trajectory | None) -> bool:
    """Whether a controller's run lasted as long as the scene does."""
    return motion is not None and motion.t[-1] >= scene.times[-1] - scene.dt / 2


def _nominal(scene: Scene) -> Trajectory:
    """The open-loop motion at several times a control period: its modes must be followed."""
    k = _finer(scene)
    t = scene.dt / k * np.arange(k * scene.steps + 1)
    return scene.plant.simulate(scene.initial[0], tabulated(scene.nominal_input), t, rtol=RTOL, atol=RTOL / 100)


def _finer(scene: Scene) -> int:
    """Times a control period: fewer where there are many periods."""
    return max(1, min(FINER, NODES // scene.steps))


def _every(motion: Trajectory, k: int, plant: Plant) -> Trajectory:
    """Every k-th time of a motion."""
    assert motion.dx is not None
    return Trajectory.from_arrays(
        motion.t[::k], motion.x[::k], motion.u[::k], plant=plant, y=motion.y[::k], dx=motion.dx[::k]
    )


def _picks(scene: Scene) -> list[int]:
    """Where the compared signals stand among the outputs."""
    known = names(scene.plant.outputs)
    return [known.index(name) for name in scene.compare]


def _felt(scene: Scene, model: LTVModel) -> int:
    """The first coordinate that the compared outputs feel: not the angle of a hub seen from the hub.

    Where it stands among the model's states.
    """
    nx = len(model.states)
    known, coordinates = names(model.states), operating_point.coordinates(scene.plant)
    for name in coordinates:
        i = known.index(name)
        change = model.simulate(np.eye(nx)[i])[1] - model.simulate(np.zeros(nx))[1]
        if np.abs(change[:, _picks(scene)]).max() > FELT:
            return i
    return known.index(coordinates[0])


def _ltv_errors(
    scene: Scene, nominal: Trajectory, model: LTVModel, moved_from: Signal
) -> tuple[tuple[float, float, float], ...]:
    """Start off the nominal by each perturbation; largest error and size of the predicted compared outputs."""
    picks, rows, coordinate = _picks(scene), [], names(model.states).index(moved_from.name)
    inputs = tabulated(scene.nominal_input)
    for size in PERTURBATIONS:
        dx0, x0 = np.zeros(len(model.states)), nominal.x[0].copy()
        dx0[coordinate] = size
        x0[names(scene.plant.states).index(model.states[coordinate].name)] += size
        _, dy = model.simulate(dx0)
        predicted = float(np.abs(dy[:, picks]).max())
        try:
            moved = scene.plant.simulate(x0, inputs, nominal.t, rtol=RTOL, atol=RTOL / 100)
        except PliantError:
            rows.append((size, float("nan"), predicted))
            continue
        rows.append((size, float(np.abs(moved.y - nominal.y - dy)[:, picks].max()), predicted))
    return tuple(rows)


def _frequencies(scene: Scene) -> tuple[tuple[str, np.ndarray | str], ...]:
    """Natural frequencies [Hz] at the goal, the coordinates that it names and driven ones locked, by variant; of one
    that fails there the reason.
    """
    rows: list[tuple[str, np.ndarray | str]] = []
    plants: list[Plant] = [*scene.plant.ladder(), scene.plant, dearer(scene.plant)]
    for plant in dict.fromkeys(plants):
        locked = tuple(name for name, _ in scene.goal if name in plant.lockable)
        if not plant.attitude_states and set(plant.rates) <= {*locked, *plant.prescribed}:
            continue  # nothing is left that could swing
        try:
            found = plant.natural_frequencies(scene.with_plant(plant).target[0], locked=locked)
        except PliantError as failure:
            rows.append((plant.label, f"{type(failure).__name__}: {failure}"))
            continue
        if found is not None:
            rows.append((plant.label, found / (2 * np.pi)))
    return tuple(rows)
