"""Speed against accuracy: every fidelity of a scene's plant by every path, method and step, within a budget."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants import Plant, PliantError
from pliant.plants.core.argument_gates import (
    require_all,
    require_flag,
    require_function,
    require_instance,
    require_names,
    require_number,
    require_path,
    require_seconds,
)
from pliant.plants.integration.batch_stepper import compile_motions
from pliant.plants.motions import played_motion
from pliant.plants.motions.observations import compile_observations
from pliant.studies.common import machine
from pliant.studies.common.processor_time import processor_time
from pliant.studies.common.reference_motions import Motions, Progress, TooLong, share, silent
from pliant.studies.fidelity.speed_accuracy import (
    LINEAR,
    METHODS,
    PATHS,
    PRECISIONS,
    SPENT,
    TOLD_FROM,
    Chart,
    Reference,
    Row,
    with_fronts,
)
from pliant.studies.peers.measure import measure as measure_programs
from pliant.studies.peers.peer_rows import PeerRow
from pliant.studies.physics.physics_motion import physics_motion

from .kept_rows import KeptRows
from .plan import LEVELS, STEPPED_NATIVELY, parts, simulated
from .runner import Runner

COMPILING = 40.0  # [s] of motions, at least, that compiling may pay for: a chart plays each variant often
PREPARING = 15.0  # [s] that preparing all variants may take, or the budget if that is more; the first has no limit
SEEN = 0.2  # of the budget, for compiling each part of what is seen on motions: of short runs that is most
PREPARED, MEASURED = 0.25, 0.95  # of the progress told
SHARP = 0.1  # of a scene's tolerance: for which physics is sought, that rows below it are told apart too
Peers = Callable[..., Sequence[PeerRow]]


def chart(
    scene: Scene,
    *,
    budget: float = 15.0,
    variants: Sequence[Plant] | None = None,
    methods: Sequence[str] = METHODS,
    prune: bool = True,
    physics_tolerance: float | None = None,
    motions: Motions | None = None,
    kept: str | Path | None = None,
    peers: bool | Peers = False,
    progress: Progress | None = None,
) -> Chart:
    """Measure the rows of a scene in `budget` [s] of processor time, first one of each variant; see `plan`.

    Before it begins physics is found, each variant's own motion converged, and its motions compiled where that pays,
    cheapest variants first for as long as PREPARING or the budget. A budget that does not prepare each variant and buy
    it a row tells in `needed` which one would. `variants` (None: the plant's ladder)
    are charted, and errors are against physics. A setting is not run when the time is spent, when it would take too
    long, or when a measured row is faster and better than its variant can be at any step (`prune`); its row says so. A
    setting finer than one whose error no longer matters has no row.

    physics_tolerance: for which physics is sought, and so known to a few percent of it, where that can be had [the
    outputs' unit]; None: a tenth of the scene's tolerance.
    kept: a file of JSON lines to which rows go as they are measured, and from which a second call goes on, with a
    budget of its own. peers: also other programs on the same motion, see `pliant.studies.peers`, or what measures them.
    ValueError for a budget that is not positive, an unknown method, or a file that keeps another scene's rows.

    Example
    -------
    >>> found = chart(scene, budget=0.5)
    >>> min(row.error for row in found.front) < scene.tolerance
    True
    """
    require_instance("chart.scene", scene, Scene)
    budget = require_seconds("chart.budget", budget)
    methods = require_names("chart.methods", methods, METHODS, "method")
    if not methods:
        raise ValueError(f"chart.methods = () must name at least one of {', '.join(METHODS)}")
    if variants is not None and not (variants := require_all("chart.variants", variants, Plant)):
        raise ValueError("chart.variants = () must hold at least one Plant")
    prune = require_flag("chart.prune", prune)
    sought = SHARP * scene.tolerance if physics_tolerance is None else physics_tolerance
    sought = require_number("chart.physics_tolerance", sought, "positive", scene.unit)
    if motions is not None:
        require_instance("chart.motions", motions, Motions)
    if progress is not None:
        require_function("chart.progress", progress)
    wanted = programs("chart.peers", peers)
    told, motions = progress or silent, motions or Motions(scene)
    told(0.0, "physics")
    truth = physics_motion(motions, sought)
    reference = Reference(truth.physics.label, truth.how, truth.uncertainty)
    described = machine.describe()
    path = None if kept is None else require_path("chart.kept", kept)
    store = KeptRows(path, motions, f"{reference.variant}, for {sought:g} {scene.unit}", described)
    plants = tuple(variants) if variants is not None else motions.ladder
    runner = Runner(motions, truth.outputs, prune)
    ready, needed = _prepare(motions, plants, budget, share(progress, 0.05, PREPARED))
    by_label = {plant.label: plant for plant in plants}
    for row in store.rows:
        if row.variant in by_label and row.method in (*methods, *LINEAR):
            runner.take(by_label[row.variant], row)
    useful_first = sorted(ready, key=lambda plant: motions.difference(plant, truth.outputs) > scene.tolerance)
    campaign = _Campaign(runner, store, budget, share(progress, PREPARED, MEASURED))
    campaign.first_rows(useful_first, methods, scene.dt)
    campaign.fixed_rows(useful_first, methods, scene.dt)
    campaign.all_rows(useful_first, methods, scene.dt)
    order = {plant.label: i for i, plant in enumerate(plants)}
    late = [row for plant in plants if plant not in ready for row in _unprepared(plant, methods, scene.dt)]
    measured = {row.key for row in campaign.rows}
    rows = [*campaign.rows, *(row for row in late if row.key not in measured)]
    rows = sorted(rows, key=lambda r: (order[r.variant], *_order(r)))
    others = tuple(store.peers)
    if wanted is not None and not others:
        told(MEASURED, "other programs")
        others = tuple(wanted(scene, truth.outputs, budget=budget, progress=share(progress, MEASURED, 1.0)))
        for peer in others:
            store.keep_peer(peer)
    told(1.0, "chart")
    return Chart(
        scene=scene.name,
        compare=scene.compare,
        tolerance=scene.tolerance,
        duration=scene.steps * scene.dt,
        rows=with_fronts(rows, TOLD_FROM * reference.uncertainty),
        reference=reference,
        machine=described,
        budget=budget,
        unit=scene.unit,
        outside=tuple((p.label, words) for p in plants if (words := motions.outside_so_far(p))),
        peers=others if wanted is not None else (),
        needed=max((n for n in (needed, campaign.needed) if n is not None), default=None),
    )


def programs(name: str, asked: Any) -> Peers | None:
    """What measures other programs, where they are asked for."""
    if callable(asked) and not isinstance(asked, type):
        found: Peers = asked
        return found
    return measure_programs if require_flag(name, asked) else None


def _prepare(
    motions: Motions, plants: Sequence[Plant], budget: float, progress: Progress
) -> tuple[tuple[Plant, ...], float | None]:
    """What every row of a variant rests on, before the budget begins: the variants for which there was time, and the
    budget that is about what all of them take.
    """
    began, allowed = processor_time(), max(budget, PREPARING)

    def spent() -> float:
        return processor_time() - began

    for i, plant in enumerate(plants):
        progress(i / len(plants), f"{plant.label}, compiled")
        limit = allowed if i else math.inf
        if spent() < limit:
            compile_motions(plant, max(budget, COMPILING))
            compile_observations(plant, SEEN * budget)
            played_motion.program.at_hand(SEEN * budget)  # of all plants: a motion that is repeated is one call
        try:
            motions.converged(plant, until=began + limit)
        except TooLong:
            if not i:  # the time of the chart's caller
                raise
            return tuple(plants[:i]), rounded_up(len(plants) / i * max(allowed, spent()))
        except PliantError:
            continue  # what it failed by is kept
    return tuple(plants), None


def _unprepared(plant: Plant, methods: Sequence[str], dt: float) -> list[Row]:
    """Rows of a variant for which there was no time."""
    found = (simulated(plant, method, 0, dt) for method in methods)
    return [dataclasses.replace(row, failure=SPENT) for row in found if row is not None]


def _order(row: Row) -> tuple[Any, ...]:
    methods = (*METHODS, *LINEAR)
    return (
        PATHS.index(row.path),
        methods.index(row.method),
        row.lanes,
        PRECISIONS.index(row.precision),
        -(row.step or row.rtol or 0.0),
    )


class _Campaign:
    """The settings of one chart, part after part, each until its share of the budget is spent."""

    def __init__(self, runner: Runner, store: KeptRows, budget: float, progress: Progress) -> None:
        self.runner, self.store, self.budget, self.progress = runner, store, budget, progress
        self.began = processor_time()
        self.spent: list[Row] = []
        self.needed: float | None = None

    @property
    def rows(self) -> list[Row]:
        """Those measured, those that failed, those that there was no time for."""
        return [*self.runner.rows.values(), *(r for r in self.spent if r.key not in self.runner.rows)]

    def first_rows(self, plants: Sequence[Plant], methods: Sequence[str], dt: float) -> None:
        """One measured row of each variant, by the first method that gives one."""
        had = {row.variant for row in self.runner.done}
        for i, plant in enumerate(plants):
            for method in methods:
                row = simulated(plant, method, 0, dt)
                if plant.label in had or row is None:
                    break
                if not self._row(plant, row, self.budget if had else math.inf):
                    self.spent.append(dataclasses.replace(row, failure=SPENT))
                    break
                had |= {r.variant for r in self.runner.done}
            if self.needed is None and processor_time() - self.began > self.budget and i + 1 < len(plants):
                self.needed = rounded_up(len(plants) / (i + 1) * (processor_time() - self.began))
        if not self.spent:
            self.needed = None

    def fixed_rows(self, plants: Sequence[Plant], methods: Sequence[str], dt: float) -> None:
        """One measured row of each variant by a fixed step, the coarsest that can be played, before anything is
        refined.
        """
        fixed = [method for method in STEPPED_NATIVELY if method in methods]
        for plant in plants:
            for row in (simulated(plant, method, level, dt) for level in range(LEVELS) for method in fixed):
                if row is None or any(r.variant == plant.label and r.method in fixed for r in self.runner.done):
                    break
                if not self._row(plant, row, self.budget):
                    break

    def all_rows(self, plants: Sequence[Plant], methods: Sequence[str], dt: float) -> None:
        """Part after part; what a part had no time for comes last, where others leave any."""
        left: list[tuple[Plant, Row]] = []
        for part in parts(plants, methods, dt):
            promising = sorted(part.settings, key=lambda setting: self.runner.beaten(setting[1]))
            left += [(p, r) for p, r in promising if not self._row(p, r, part.until * self.budget)]
        for plant, row in left:
            if not self._row(plant, row, self.budget):
                self.spent.append(dataclasses.replace(row, failure=SPENT))

    def _row(self, plant: Plant, row: Row, until: float) -> bool:
        """Whether the setting is settled: measured, failed, or of no use; False where its time is spent."""
        self.progress((processor_time() - self.began) / self.budget, f"{plant.label}, {row.setting}")
        found = self.runner.measure(plant, row, self.began + until)
        if found is None:
            return True
        self.store.keep(found)
        return found.failure != SPENT


def rounded_up(seconds: float) -> float:
    """To two digits, upwards, with a tenth to spare."""
    seconds *= 1.1
    digit = 10.0 ** (math.floor(math.log10(seconds)) - 1)
    return float(np.ceil(seconds / digit) * digit)
