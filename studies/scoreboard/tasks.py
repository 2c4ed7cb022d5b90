"""One piece of a scoreboard's work: a controller's runs, a case's bounds, or what a scene was played with."""

from __future__ import annotations

import dataclasses
import threading
from functools import lru_cache
from typing import Any

import numpy as np

from pliant.controllers import Controller
from pliant.envs.scenes.scene import Scene
from pliant.plants import PliantError
from pliant.plants.motions.time_limit import time_limit
from pliant.studies.closed_loop.closed_loop import driven_to_goal
from pliant.studies.closed_loop.contestants import Designed, Maker, designed
from pliant.studies.closed_loop.evaluation_scene import accurate, finer_plant, play, require_signals
from pliant.studies.closed_loop.optimal_bound import bound
from pliant.studies.closed_loop.rollout import Conditions, nominal, randomised, rollout
from pliant.studies.closed_loop.scores import deflections, score
from pliant.studies.common.reference_motions import Motions
from pliant.studies.physics.physics_motion import physics_motion

from .results import Entry, Line

CASES = ("exact", "finer", "varied", "delayed", "all at once")
MANY = ("varied", "delayed", "all at once")  # cases of many runs
LATE = ("delayed", "all at once")
CHUNK = 16  # runs that one worker plays before it tells
LARGEST = 30_000  # states over all periods of a run whose bound is sought
LONG = (Designed("NMPC"), Designed("TVLQR"))  # what is not played on such runs: their designs take minutes
PLAYED = 1e-7  # rtol of a motion whose error from physics is told
TOLD = 60.0  # [s] of processor time that telling it may take
PLAYING = threading.Lock()
DELAY = 1  # [control periods] of the late cases


@lru_cache(maxsize=16)
def played_scene(scene: Scene, case: str) -> tuple[Scene, float, str]:
    """(the scene as the case plays it, the error by the step, a remark)."""
    plant, remark = scene.plant, ""
    if case != "exact":
        try:
            plant, remark = finer_plant(scene)
        except ValueError as error:
            remark = str(error)
    return *accurate(play(scene, plant)), remark


@lru_cache(maxsize=32)
def conditions(scene: Scene, case: str, seeds: int, seed: int) -> tuple[Conditions, ...]:
    """The runs of a case: the scene as it is, or `seeds` drawn ones."""
    played = played_scene(scene, case)[0]
    if case not in MANY:
        return (nominal(played),)
    drawn = randomised(played, seeds, seed)
    if case == "delayed":
        own = played.varied_plant.nominal_parameters
        drawn = tuple(dataclasses.replace(c, p=own, noise=np.zeros(len(c.noise))) for c in drawn)
    return tuple(dataclasses.replace(c, delay=DELAY if case in LATE else 0) for c in drawn)


_law = lru_cache(maxsize=8)(designed)  # one design serves all cases that a process plays


def work(
    scene: Scene, case: str, name: str, maker: Maker | None, first: int, last: int, seeds: int, seed: int
) -> tuple[tuple[str, str, str], int, Any]:
    """One task, in a process of its own; threads of one process share laws and kernels, and take turns."""
    with PLAYING:
        return _work(scene, case, name, maker, first, last, seeds, seed)


def _work(
    scene: Scene, case: str, name: str, maker: Maker | None, first: int, last: int, seeds: int, seed: int
) -> tuple[tuple[str, str, str], int, Any]:
    key = (scene.name, case, name)
    if case == "entry":
        return key, 0, _entry(scene, seeds, seed)
    if maker is None:
        return key, first, _bounds(scene, case, first, last, seeds, seed)
    size = scene.steps * scene.plant.nx
    if size > LARGEST and maker in LONG:
        return key, first, f"not played: {size} states over all periods are more than {LARGEST}"
    law = player(scene, case, maker)
    if isinstance(law, str):
        return key, first, law
    played = played_scene(scene, case)[0]
    scores, times, line = [], [], None
    counts: dict[str, int] = {}
    for given in conditions(scene, case, seeds, seed)[first:last]:
        run = rollout(played, law, given)
        scores.append(score(played, run))
        times.append(run.act_ns)
        _count(counts, law)
        if case == "finer":
            line = Line(run.t, {n: run[n] for n in shown(played)}, run.u)
    return key, first, (scores, times, line, counts)


def player(scene: Scene, case: str, maker: Maker) -> Controller | str:
    """The controller as it plays a case, or why it cannot."""
    law = _law(scene, maker)
    if isinstance(law, str):
        return law
    played = played_scene(scene, case)[0]
    try:
        require_signals(law.reads, scene, played)
    except ValueError as error:
        return f"cannot play {played.plant.label}: {error}"
    return law


def _count(counts: dict[str, int], law: Any) -> None:
    """Add up what the controller itself recorded of a run: calls, acts without a solution, and so on."""
    record = getattr(law, "record", None)
    for name, value in (vars(record) if record is not None else {}).items():
        if isinstance(value, int):
            counts[name] = counts.get(name, 0) + value


def _bounds(scene: Scene, case: str, first: int, last: int, seeds: int, seed: int) -> Any:
    played = played_scene(scene, case)[0]
    costs: list[float | None] = []
    size = played.steps * played.plant.nx
    if size > LARGEST:
        reason = f"not sought: {size} states over all periods are more than {LARGEST}"
        return [None] * (last - first), reason, None
    law = _law(scene, Designed("LQR"))
    line, reason = None, ""
    for given in conditions(scene, case, seeds, seed)[first:last]:
        try:
            cost, x, u = bound(played, given, None if isinstance(law, str) else law)
        except PliantError as error:
            costs.append(None)
            reason = f"{type(error).__name__}: {str(error).splitlines()[0]}"
            continue
        costs.append(cost)
        if case == "finer":
            held = np.vstack([u, u[-1:]])
            values = played.signal_values(x, played.plant.measure(x, held), shown(played))
            line = Line(played.times, dict(zip(shown(played), values.T, strict=True)), u)
    return costs, reason, line


def shown(scene: Scene) -> tuple[str, ...]:
    """The signals that a figure shows of a motion: what the goal names, then the deflections."""
    return tuple(dict.fromkeys((*driven_to_goal(scene), *deflections(scene))))


def _entry(scene: Scene, seeds: int, seed: int) -> Entry:
    played, error, remark = played_scene(scene, "finer")
    noise = conditions(scene, "varied", seeds, seed)[0].noise
    apart, known, why = _from_physics(scene, played)
    return Entry(
        scene=scene.name,
        about=scene.about,
        design=scene.plant.label,
        design_states=scene.plant.nx,
        plant=played.plant.label,
        plant_states=played.plant.nx,
        limits=scene.limits,
        substeps=played.substeps,
        step_error=error,
        varied=played.randomise,
        noise={s.name: float(v) for s, v in zip(played.signals, noise, strict=True)},
        remark=remark,
        model_error=apart,
        model_known=known,
        model_remark=why,
    )


def _from_physics(scene: Scene, played: Scene) -> tuple[float | None, float | None, str]:
    """(error of the played plant on what the LQR plays, to what physics is known there, a remark)."""
    law, motions, remark = _law(scene, Designed("LQR")), Motions(played), "on the open loop"
    if not isinstance(law, str):
        u = rollout(played, law).u
        if len(u) == played.steps:
            motions, remark = Motions(played, np.vstack([u, u[-1:]])), "on what the LQR plays"
    try:
        with time_limit(TOLD):
            physics = physics_motion(motions, played.tolerance)
            apart = float(np.abs(motions.outputs(played.plant, PLAYED) - physics.outputs).max())
    except PliantError as failure:
        return None, None, f"{type(failure).__name__}: {str(failure).splitlines()[0]}"
    return apart, physics.uncertainty, remark
