"""A board's raw runs played again, a seeded part of them, and compared with what was kept.

Another processor sums in another order and ends its loops elsewhere, so that digits differ; how far that may go depends
on the loop. It is measured: each run is played again with its start shaken by SHAKE of the signals' ranges, which is
more than rounding can do (steps x substeps x 1000 operations of half an epsilon each: 3e-10 for 3000 steps) and as
much as designs are found to (Riccati's and the QP's tolerance, 1e-8). FACTOR times the largest change that this makes,
and PLAYS of the cost, are let pass. A failure must be a failure again, unless the shaken runs do not agree about it:
such runs are counted as undecided, never as the same.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pliant.controllers import Controller
from pliant.envs.scenes.scene import Scene
from pliant.plants.core.argument_gates import require_count, require_function, require_instance
from pliant.studies.closed_loop.contestants import CONTESTANTS, Maker, playable
from pliant.studies.closed_loop.evaluation_scene import signal_ranges
from pliant.studies.closed_loop.rollout import Conditions, rollout
from pliant.studies.common.reference_motions import Progress, silent

from .raw_runs import RawRuns
from .tasks import conditions, played_scene, player

SHAKE = 1e-8  # of the range of each state in the scene's nominal motion
SHAKEN = 3  # runs
FACTOR = 10.0
PLAYS = 1e-6  # of the cost


@dataclass(frozen=True)
class Replay:
    """One run as it was kept and as it was played again."""

    scene: str
    case: str
    controller: str
    number: int
    kept: float  # cost
    again: float
    tolerance: float
    failed: bool
    failed_again: bool
    verdict: str  # "same", "differs" or "undecided"


@dataclass(frozen=True)
class Verification:
    """What `verify` returns."""

    replays: tuple[Replay, ...]
    skipped: Mapping[str, str]  # controllers that could not be played, and why

    @property
    def passed(self) -> bool:
        """Some runs were played, and none differs."""
        return bool(self.replays) and all(one.verdict != "differs" for one in self.replays)

    def __str__(self) -> str:
        count = {word: sum(one.verdict == word for one in self.replays) for word in ("same", "undecided", "differs")}
        lines = [", ".join(f"{n} {word}" for word, n in count.items())]
        for one in self.replays:
            if one.verdict != "same":
                told = f"{one.kept:.9g} then, {one.again:.9g} now, to {one.tolerance:.2g}"
                fell = f"failed {one.failed} then, {one.failed_again} now"
                lines.append(
                    f"{one.verdict}: {one.scene}, {one.case}, {one.controller}, run {one.number}: {told}; {fell}"
                )
        return "\n".join([*lines, *(f"not played: {name}: {why}" for name, why in self.skipped.items())])


def verify(
    raw: RawRuns,
    *,
    cells: int = 24,
    seed: int = 0,
    makers: Mapping[str, Maker] | None = None,
    progress: Progress | None = None,
) -> Verification:
    """Play one run each of `cells` cells (scene, case, controller) again, drawn by `seed`.

    makers: of controllers that are not `contestants.CONTESTANTS`, by name.

    Example
    -------
    >>> found = verify(RawRuns.load("docs/scoreboard/suite-2/runs.npz"))
    >>> print(found)
    """
    require_instance("verify.raw", raw, RawRuns)
    cells, seed = (
        require_count("verify", "cells", cells, 1, 100_000),
        require_count("verify", "seed", seed, 0, 2**32 - 1),
    )
    told = progress or silent
    if progress is not None:
        require_function("verify.progress", progress)
    known = {**CONTESTANTS, **(makers or {})}
    rng = np.random.default_rng([seed, 23])
    c = raw.columns
    groups = np.unique(np.stack([c["scene"], c["case"], c["controller"]], axis=1), axis=0)
    found, skipped = [], {}
    scenes: dict[str, Scene] = {}
    drawn = rng.permutation(len(groups))[:cells]
    for done, at in enumerate(np.sort(drawn)):
        scene, case, name = (names[i] for names, i in zip((raw.scenes, raw.cases, raw.controllers), groups[at]))
        told(done / len(drawn), f"{scene}, {case}, {name}")
        place = int(rng.choice(raw.rows(scene, case, name)))
        if name not in known:
            skipped[name] = "its maker was not given"
            continue
        if scene not in scenes:
            scenes[scene] = playable((scene,))[0]
        law = player(scenes[scene], case, known[name])
        if isinstance(law, str):
            skipped[name] = f"{scene}: {law}"
            continue
        found.append(_again(raw, place, scenes[scene], case, name, law))
    told(1.0, "done")
    return Verification(tuple(found), skipped)


def _again(raw: RawRuns, place: int, scene: Scene, case: str, name: str, law: Controller) -> Replay:
    number, kept = int(raw.columns["number"][place]), float(raw.columns["cost"][place])
    failed = bool(raw.columns["failure"][place] >= 0)
    played = played_scene(scene, case)[0]
    given = conditions(scene, case, int(raw.about["seeds"]), int(raw.about["seed"]))[number]
    run = rollout(played, law, given)
    shaken = [rollout(played, law, shake) for shake in _shaken(played, given)]
    tolerance = FACTOR * max(abs(other.cost - run.cost) for other in shaken) + PLAYS * abs(kept)
    agreed = all(bool(other.failure) == bool(run.failure) for other in shaken)
    alike = bool(run.failure) == failed
    same = alike and abs(run.cost - kept) <= tolerance
    verdict = "same" if same else ("differs" if agreed else "undecided")
    return Replay(scene.name, case, name, number, kept, run.cost, tolerance, failed, bool(run.failure), verdict)


def _shaken(played: Scene, given: Conditions) -> list[Conditions]:
    rng = np.random.default_rng([*given.seed, 29])
    ranges = signal_ranges(played)[: played.plant.nx]
    size = SHAKE * np.maximum(ranges, np.abs(given.x))
    return [dataclasses.replace(given, x=given.x + size * rng.standard_normal(len(size))) for _ in range(SHAKEN)]
