"""What a run, and many runs, of a controller are worth: cost, settling, deflection, limits, effort, failures, time."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pliant.envs.scenes.scene import Scene

from .closed_loop import driven_to_goal
from .rollout import SLACK, Rollout

BAND = 0.05  # of the way from start to goal: within it a signal has settled
LAST = 0.1  # share of the run over which what is left of the motion is taken


@dataclass(frozen=True)
class Score:
    """Of one run. None where the run ended early or there is nothing to measure."""

    cost: float
    failure: str  # "" where there was none
    settling: float | None  # [s] from when on all signals that the goal names stay within BAND; infinite: never
    peak: float | None  # [m] largest deflection
    residual: float | None  # [m] half of what the deflections still swing over the LAST part
    at_limit: float  # share of the control periods in which an input is at its limit
    beyond: float  # share in which more was asked than the limits allow
    effort: float  # root mean square of the inputs [of their limits]


def deflections(scene: Scene) -> tuple[str, ...]:
    """The outputs that tell how far the bodies bend, as the plant says, else the lengths that the scene compares."""
    compared = (s.name for s in scene.plant.outputs if s.unit == "m" and s.name in scene.compare)
    return scene.plant.deflections or tuple(compared)


def score(scene: Scene, run: Rollout) -> Score:
    """The score of a run of `scene`, the scene as it was played."""
    limits = np.array(scene.limits)
    beyond = (np.abs(run.asked) > limits * (1 + SLACK)).any(axis=1) if len(run.asked) else np.zeros(1)
    at_limit = (np.abs(run.u) >= limits * (1 - SLACK)).any(axis=1) if len(run.u) else np.zeros(1)
    shares = {"beyond": float(beyond.mean()), "at_limit": float(at_limit.mean())}
    effort = float(np.sqrt(np.mean((run.u / limits) ** 2))) if len(run.u) else 0.0
    if run.failure:
        return Score(run.cost, run.failure, None, None, None, effort=effort, **shares)
    bent = [run[name] for name in deflections(scene)]
    tail = slice(int((1 - LAST) * len(run.t)), None)
    return Score(
        run.cost,
        "",
        settling_time(scene, run),
        max((float(np.abs(z).max()) for z in bent), default=None),
        max((float(np.ptp(z[tail])) / 2 for z in bent), default=None),
        effort=effort,
        **shares,
    )


def settling_time(scene: Scene, run: Rollout) -> float | None:
    """[s]; infinite where a signal does not settle; None where no signal that the goal names has a way to go."""
    told = driven_to_goal(scene)
    goal, outer = scene.goal_values(told), np.zeros(len(run.t), dtype=bool)
    begin = scene.signal_values(scene.initial[0], scene.plant.measure(*scene.initial), told)
    moving = np.abs(begin - goal) > 1e-9
    if not moving.any():
        return None
    for name, end, way in zip(np.array(told)[moving], goal[moving], np.abs(begin - goal)[moving], strict=True):
        outer |= np.abs(run[name] - end) > BAND * way
    if outer[-1]:
        return float("inf")
    last = np.flatnonzero(outer)
    return float(run.t[last[-1] + 1]) if len(last) else 0.0


@dataclass(frozen=True)
class Row:
    """A controller on a scene in a case. Costs and ratios are means over the runs, failed ones as charged."""

    scene: str
    case: str
    controller: str
    runs: int
    cost: float | None = None
    ratio: float | None = None  # mean cost over mean bound, of the runs whose bound is known
    ratio_median: float | None = None  # of the single runs' ratios to their own bounds
    ratio_low: float | None = None  # their 10th ..
    ratio_high: float | None = None  # .. and 90th percentile
    failures: int = 0
    settling: float | None = None  # [s] median, infinite runs among them
    unsettled: int = 0
    peak: float | None = None  # [m] largest
    residual: float | None = None  # [m] median
    at_limit: float | None = None  # share of periods with an input at its limit, mean
    beyond: float | None = None  # share of periods that ask more than the limits allow, mean
    effort: float | None = None  # mean
    act_median: float | None = None  # [us]
    act_p99: float | None = None  # [us]
    ratio_iqm: float | None = None  # interquartile mean of the single runs' ratios
    intervals: Mapping[str, tuple[float, float]] = field(default_factory=dict)  # 95 %, by name of the number
    record: Mapping[str, int] = field(default_factory=dict)  # what the controller counted itself, all runs
    reason: str = ""  # why there is no score, or the first failure

    def to_json(self) -> dict[str, Any]:
        return dataclasses.asdict(self)


def summarise(
    scene: str,
    case: str,
    controller: str,
    scores: Sequence[Score],
    act_ns: np.ndarray,
    bounds: Sequence[float | None],
) -> Row:
    """The row of `scores`, one a run, and the runs' bounds; act_ns (any,) [ns] of all calls."""
    costs = np.array([s.cost for s in scores])
    best = np.array([np.nan if b is None else b for b in [*bounds, *[None] * (len(scores) - len(bounds))]])
    known = np.isfinite(best)
    single = costs[known] / best[known]
    settled = [s.settling for s in scores if s.settling is not None]
    middle = float(np.median(settled)) if settled else None
    failed = [s.failure for s in scores if s.failure]
    ratios: dict[str, Any] = {}
    if known.any():
        low, mid, high = np.quantile(single, [0.1, 0.5, 0.9], method="nearest")
        ratios = {
            "ratio": float(costs[known].mean() / best[known].mean()),
            "ratio_median": float(mid),
            "ratio_low": float(low),
            "ratio_high": float(high),
        }
    return Row(
        scene,
        case,
        controller,
        len(scores),
        cost=float(costs.mean()),
        failures=len(failed),
        settling=middle if middle is not None and np.isfinite(middle) else None,
        unsettled=int(sum(np.isinf(s) for s in settled)),
        peak=max((s.peak for s in scores if s.peak is not None), default=None),
        residual=_median([s.residual for s in scores]),
        at_limit=float(np.mean([s.at_limit for s in scores])),
        beyond=float(np.mean([s.beyond for s in scores])),
        effort=float(np.mean([s.effort for s in scores])),
        act_median=float(np.median(act_ns)) / 1e3 if len(act_ns) else None,
        act_p99=float(np.quantile(act_ns, 0.99)) / 1e3 if len(act_ns) else None,
        reason=failed[0] if failed else "",
        **ratios,
    )


def _median(values: Sequence[float | None]) -> float | None:
    found = [v for v in values if v is not None]
    return float(np.median(found)) if found else None
