"""A law, or a design of one, made to survive a box of parameters and delays, by playing its vertices.

Vertices    the scene's own parameters and the corners of the box, each with each of the delays, from the scene's start,
            readings with noise: all are played; a vertex fails as a run does (see `rollout`), and nothing less counts
First       the law as it is, where it fails on no vertex
Detuned     a design with an `effort` is made again with the inputs dearer, a step of the ladder at a time
Redesigned  one gain for all models of the box (MultiModelLQR), from the states where the law reads states, else from
            the scene's sensors; with the same ladder
Of the first of each that lasts, the one with the least mean cost is taken; its cost on the scene as it is, and the mean
over the vertices, are told beside the first law's. No certificate: between the vertices, and from other starts, nothing
was shown.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.controllers import Controller
from pliant.controllers.robust_design.box_models import corners
from pliant.controllers.robust_design.many_model_lqr import MultiModelLQR, box_of, delays_of
from pliant.envs.scenes.scene import Scene
from pliant.plants import PliantError
from pliant.plants.core.argument_gates import require_finite, require_flag, require_function, require_instance, shown
from pliant.plants.core.signals import OwnsArrays, names
from pliant.studies.closed_loop.rollout import Conditions, nominal, reading_noise, rollout
from pliant.studies.common.reference_motions import Progress, silent

EFFORTS = (1.0, 3.0, 10.0, 30.0, 100.0)  # times what the scene charges for its inputs
Design = Callable[..., Controller]


@dataclass(frozen=True)
class Attempt:
    """One law on all vertices."""

    how: str  # "as it is", "detuned" or "redesigned"
    effort: float
    failures: int
    vertices: int
    nominal: float | None = None  # cost of the scene as it is
    mean: float | None = None  # over the vertices, failed ones as charged
    worst: float | None = None
    reason: str = ""  # the first failure, or why there was no law

    def __str__(self) -> str:
        told = f"{self.how}, effort x {self.effort:g}: {self.failures} of {self.vertices} vertices failed"
        if self.nominal is not None:
            told += f"; cost {self.nominal:.4g} as it is, {self.mean:.4g} in the mean, {self.worst:.4g} at worst"
        return told + (f" ({self.reason})" if self.reason else "")


@dataclass(frozen=True, eq=False)
class Robustified(OwnsArrays):
    """What `robustify` returns: the law that lasted with its attempt, or None, and all that was tried, in order."""

    law: Controller | None
    chosen: Attempt | None
    attempts: tuple[Attempt, ...]

    @property
    def lasted(self) -> bool:
        """Whether there is a law that failed on no vertex."""
        return self.law is not None

    @property
    def price(self) -> float:
        """Cost of the scene as it is under the law that lasted, over the first law's; NaN where there is none."""
        first = self.attempts[0].nominal
        return self.chosen.nominal / first if self.chosen and self.chosen.nominal and first else float("nan")

    def __str__(self) -> str:
        words = "none lasted"
        if self.chosen is not None:
            words = (
                f"{self.chosen.how}, effort x {self.chosen.effort:g}: lasts on all vertices; on the scene as it is it "
            )
            words += f"costs {self.price:.4g} times what the first law does"
        return "\n".join([*map(str, self.attempts), words])


def robustify(
    law: Controller | Design,
    scene: Scene,
    ranges: Mapping[str, tuple[float, float]] | None = None,
    *,
    delays: Sequence[int] = (0, 1),
    noise: bool = True,
    redesign: bool = True,
    efforts: Sequence[float] = EFFORTS,
    progress: Progress | None = None,
) -> Robustified:
    """Detune or redesign a law until it fails on no vertex of a box of parameters and delays.

    law: a controller of the scene, or what designs one, as LQG.for_scene; only a design that takes `effort` can be
    detuned. ranges: smallest and largest factor by name; +-30 % of what the plant calls uncertain where None. delays
    [periods]. noise: of readings. redesign: whether another law may take its place. efforts: the ladder, from 1 on.
    ValueError for a scene, a range, a delay or an effort that is none.

    Example
    -------
    >>> found = robustify(law, scene, {"payload.mass": (0.9, 1.1)}, delays=(0,), noise=False, redesign=False)
    >>> found.law is law, found.price, found.attempts[0].failures
    (True, 1.0, 0)

    A design, as `LQG.for_scene`, in place of a law is detuned until it lasts: minutes.
    """
    require_instance("robustify.scene", scene, Scene)
    box, late = box_of(scene, ranges, "robustify.ranges"), delays_of(delays, "robustify.delays")
    noise, redesign = require_flag("robustify.noise", noise), require_flag("robustify.redesign", redesign)
    steps = require_finite("robustify.efforts", efforts, (-1,)).tolist()
    if not steps or min(steps) <= 0:
        raise ValueError(f"robustify.efforts = {shown(efforts)} must be numbers > 0")
    if progress is not None:
        require_function("robustify.progress", progress)
    told = progress or silent
    played = dataclasses.replace(scene, randomise=tuple((path, *pair) for path, pair in box.items()))
    vertices = _vertices(played, box, late, noise)
    first, design = _given(law, scene)
    told(0.0, "as it is")
    attempts = [_played(played, first, vertices, "as it is", 1.0)]
    lasting: list[tuple[Attempt, Controller]] = [(attempts[0], first)] if not attempts[0].failures else []
    ways: list[tuple[str, Design, list[float]]] = []
    if not lasting and design is not None:
        ways.append(("detuned", lambda effort: design(scene, effort=effort), [e for e in steps if e != 1.0]))
    if not lasting and redesign:
        reads = "states" if set(first.reads) <= set(names(scene.plant.states)) else "sensors"
        options: dict[str, Any] = {"reads": reads, "ranges": box, "delays": late}
        ways.append(("redesigned", lambda effort: MultiModelLQR.for_scene(scene, effort=effort, **options), steps))
    for how, make, ladder in ways:
        for effort in ladder:
            told(len(attempts) / (1 + 2 * len(steps)), f"{how}, effort x {effort:g}")
            try:
                made = make(effort)
            except (PliantError, TypeError) as failure:  # a design without `effort`, or none found
                reason = f"{type(failure).__name__}: {str(failure).splitlines()[0]}"
                attempts.append(Attempt(how, effort, len(vertices), len(vertices), reason=reason))
                continue
            attempts.append(_played(played, made, vertices, how, effort))
            if not attempts[-1].failures:
                lasting.append((attempts[-1], made))
                break
    told(1.0, "done")
    best, kept = min(lasting, key=lambda pair: pair[0].mean or 0.0) if lasting else (None, None)
    return Robustified(kept, best, tuple(attempts))


def _given(law: Controller | Design, scene: Scene) -> tuple[Controller, Design | None]:
    """The law as it is, and what designs it."""
    if isinstance(law, Controller) and not isinstance(law, type):
        return law, None
    design = require_function("robustify.law", law)
    try:
        made = design(scene)
    except TypeError as error:
        raise ValueError(f"robustify.law = {shown(law)} must design a controller for a scene: {error}") from error
    return require_instance("robustify.law", made, Controller, what="a controller, or what makes one"), design


def _vertices(
    scene: Scene, box: Mapping[str, tuple[float, float]], delays: Sequence[int], noise: bool
) -> list[Conditions]:
    """The corners of the box and its own parameters, with each delay; noise by the number of the vertex."""
    own, p = nominal(scene), scene.varied_plant.nominal_parameters
    levels = reading_noise(scene) if noise else own.noise
    pairs = [(factors, delay) for factors in corners(box) for delay in delays]
    return [
        dataclasses.replace(own, p=p * factors, delay=delay, noise=levels, seed=(0, k))
        for k, (factors, delay) in enumerate(pairs)
    ]


def _played(scene: Scene, law: Controller, vertices: Sequence[Conditions], how: str, effort: float) -> Attempt:
    runs = [rollout(scene, law, given) for given in vertices]
    costs, failed = [run.cost for run in runs], [run.failure for run in runs if run.failure]
    as_it_is = rollout(scene, law, nominal(scene)).cost
    reason = failed[0] if failed else ""
    return Attempt(
        how, effort, len(failed), len(runs), float(as_it_is), float(np.mean(costs)), float(np.max(costs)), reason
    )
