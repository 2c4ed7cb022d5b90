"""What was asked of the measurements, beside what was found.

A figure holds from machine to machine only as a ratio, so each is one: to a peer in the same run, or, where no peer
does the same, to what this core can do at all. Then a time is multiplied by the core's measured peak of fused
multiply-adds over that of the machine for which it was asked (cases/fma_peak.py), and is told as "scaled".
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from cases import cold_start, controller_acts, fma_peak, learning, motions, physics, spacecraft, stability, trees
from cases import environments as env
from cases.soak import GROWTH, STEPS, Soak
from peers import cantilever, peers

from harness.sampling import Row, ratio


@dataclass(frozen=True)
class Check:
    """A number that was asked for. `least` says whether it is the least or the most allowed."""

    number: int
    what: str
    measured: float | None  # None: not measured in this run
    asked: float
    unit: str
    least: bool = True

    @property
    def holds(self) -> bool | None:
        if self.measured is None:
            return None
        return self.measured >= self.asked if self.least else self.measured <= self.asked


def find(rows: Sequence[Row], group: str, name: str, lanes: int = 1, threads: int = 1) -> Row | None:
    """The row of that name, or None."""
    wanted = group, name, lanes, threads
    return next((r for r in rows if (r.group, r.name, r.lanes, r.threads) == wanted), None)


def _median(row: Row | None) -> float | None:
    return row.median if row else None


def checks(rows: Sequence[Row], soak: Soak | None, steps: int = STEPS) -> list[Check]:
    """Everything asked, in order; `steps` of the soak."""
    found = [_physics(rows), _environments(rows), _times(rows), _soak(soak, steps), _learning(rows), _cantilever(rows)]
    found += [_stability(rows), _spacecraft(rows), _controllers(rows), _motions(rows), _trees(rows)]
    return [check for part in found for check in part]


def _physics(rows: Sequence[Row]) -> Iterator[Check]:
    simd, scalar, single = (
        find(rows, physics.GROUP, name, 1024) for name in (physics.DOUBLE, physics.SCALAR, physics.SINGLE)
    )
    chain = best(rows, physics.GROUP, peers.MUJOCO)
    yield Check(1, "RK4 step, SIMD double, against MuJoCo's 6-joint chain", ratio(simd, chain), 60, "times")
    yield Check(1, "RK4 step, SIMD double, against scalar native", ratio(simd, scalar), 5, "times")
    yield Check(1, "RK4 step, SIMD single, against double", ratio(single, simd), 1.6, "times")


def best(rows: Sequence[Row], group: str, name: str) -> Row | None:
    """A peer's fastest row on one thread, so that it is not judged by its worst."""
    found = [r for r in rows if r.group == group and r.name == name and r.threads == 1 and r.samples]
    return max(found, key=lambda r: r.median or 0.0, default=None)


def scaled(rows: Sequence[Row], seconds: float | None, unit: float = 1.0) -> float | None:
    """A time on this core, told as on a core of the reference's peak, in units of `unit` [s]; None where either is not
    measured."""
    peak = _median(find(rows, fma_peak.GROUP, fma_peak.PEAK))
    return None if seconds is None or peak is None else seconds * peak / fma_peak.REFERENCE / unit


def _environments(rows: Sequence[Row]) -> Iterator[Check]:
    swimmer, pendulum = (best(rows, env.GROUP, name) for name in (peers.SWIMMER, peers.PENDULUM))
    for name, threads, asked in (
        (physics.DOUBLE, 2, 45),
        (physics.SINGLE, 2, 75),
        (physics.DOUBLE, 1, 27),
        (physics.SINGLE, 1, 45),
    ):
        row = find(rows, env.GROUP, name, 1024, threads)
        shown = f"environment, {name.partition(', ')[2]}, {threads} thread{'s' * (threads > 1)}, against Swimmer-v5"
        yield Check(2, shown, ratio(row, swimmer), asked, "times")
    for name in (physics.DOUBLE, physics.SINGLE):
        row = find(rows, env.OUTSIDE, name, 1024, 2)
        share = None if row is None or row.median is None else 100 * row.median
        shown = f"time outside the kernel, {name.partition(', ')[2]}, 2 threads"
        yield Check(2, shown, share, 25, "%", least=False)
    single = find(rows, env.SINGLE_GROUP, "Pliant, PlantEnv")
    yield Check(3, "PlantEnv.step, against a lane of Gymnasium's Pendulum", ratio(single, pendulum), 0.4, "times")


def _times(rows: Sequence[Row]) -> Iterator[Check]:
    name = "Pliant, exact Jacobians, native"
    for points, threads, scale, asked, unit, what in (
        (1, 1, 1e-6, 15, "us", "exact Jacobians, one point, scaled"),
        (physics.POINTS, 2, 1e-3, 15, "ms", f"exact Jacobians, {physics.POINTS} points in one call, scaled"),
    ):
        found = scaled(rows, _median(find(rows, physics.JACOBIANS, name, points, threads)), scale)
        yield Check(4, what, found, asked, unit, least=False)
    imports = find(rows, cold_start.GROUP, cold_start.PEER, cold_start.LANES)
    for name, asked in ((cold_start.COLD, 20.0), (cold_start.WARM, 1.0), (cold_start.PLANTS, 1.5)):
        row = find(rows, cold_start.GROUP, name, cold_start.LANES)
        yield Check(5, f"{name}, against {cold_start.PEER}", ratio(row, imports), asked, "times", least=False)


def _soak(soak: Soak | None, steps: int) -> Iterator[Check]:
    ran, wrong, growth, same = (
        (soak.steps, soak.not_finite, soak.growth, soak.repeats) if soak else (None, None, None, None)
    )
    yield Check(6, "soak: environment steps", ran, steps, "steps")
    yield Check(6, "soak: numbers that are not finite", wrong, 0, "", least=False)
    yield Check(6, "soak: memory gained after the first tenth", growth, GROWTH, "MB", least=False)
    yield Check(6, "soak: runs of one seed that agree bit for bit", None if same is None else 1 + same, 2, "")


def _learning(rows: Sequence[Row]) -> Iterator[Check]:
    found = [r for r in rows if (r.group, r.name) == (learning.GROUP, learning.PLIANT) and r.samples]
    fastest = max(found, key=lambda r: r.median or 0.0, default=None)
    times = ratio(fastest, best(rows, learning.GROUP, learning.SYNC))
    yield Check(8, "PPO end to end, 1,024 environments, against Gymnasium's SyncVectorEnv", times, 3, "times")
    step = find(rows, learning.GROUP, learning.GRADIENT, learning.GRADIENT_LANES)  # as measured, as trees are
    found_ms = None if step is None or step.median is None else 1e3 * step.median
    yield Check(8, f"{learning.GRADIENT}, {learning.GRADIENT_LANES} lanes", found_ms, 60, "ms", least=False)


def _cantilever(rows: Sequence[Row]) -> Iterator[Check]:
    for error, times in ((cantilever.COARSE, 100), (cantilever.FINE, 50)):
        found = cantilever.times_faster(rows, error)
        yield Check(9, f"cantilever-drop to {error:g} m, against Exudyn's fastest settings", found, times, "times")
        found = cantilever.times_faster(rows, error, own=cantilever.SIMULATE)
        yield Check(9, f"the same through simulate, {error:g} m", found, 100, "times")


def _stability(rows: Sequence[Row]) -> Iterator[Check]:
    asked_of = (
        (stability.VERDICT, 1, 0.3),
        (stability.NUMBERS, 1, 0.9),
        (stability.LARGE, 1, 10.0),
        (stability.CHART, 2, 20.0),
    )
    for name, threads, asked in asked_of:
        found = scaled(rows, _median(find(rows, stability.GROUP, name, threads=threads)))
        yield Check(10, f"{name}, scaled", found, asked, "s", least=False)


def _spacecraft(rows: Sequence[Row]) -> Iterator[Check]:
    build = scaled(rows, _median(find(rows, spacecraft.GROUP, spacecraft.BUILD)))
    yield Check(11, f"{spacecraft.BUILD}, scaled", build, 20.0, "s", least=False)
    name = spacecraft.linearise_name(spacecraft.COUNTS[-1])
    found = scaled(rows, _median(find(rows, spacecraft.GROUP, name)), 1e-3)
    yield Check(11, f"{name}, scaled", found, 5.0, "ms", least=False)
    grows = "time of a linearisation ~ states^k, largest k between neighbouring rows"
    yield Check(11, grows, spacecraft.exponent(rows), 3.0, "", least=False)


def _controllers(rows: Sequence[Row]) -> Iterator[Check]:
    """Median, and a 99th percentile within three times what was asked of it."""
    for name, asked in (
        (controller_acts.LQR, 5.0),
        (controller_acts.TVLQR, 15.0),
        (controller_acts.NMPC, 2000.0),
    ):
        row = find(rows, controller_acts.GROUP, name)
        for what, found, most in (
            (f"{name}, scaled", _median(row), asked),
            (f"{name}, 99th percentile, scaled", row.tail if row else None, 3 * asked),
        ):
            yield Check(12, what, scaled(rows, found, 1e-6), most, "us", least=False)
    for horizon, asked in zip(
        controller_acts.HORIZONS, (20, 14)
    ):  # HPIPM takes 1.3 and 2.8 ms; asked were 60 and 200 us
        own = find(rows, controller_acts.GROUP, controller_acts.mpc_name(horizon))
        peer = find(rows, controller_acts.GROUP, controller_acts.hpipm_name(horizon))
        what = controller_acts.mpc_name(horizon)
        yield Check(12, f"{what}, against HPIPM", ratio(peer, own), asked, "times")
        tails = None if not (own and peer and own.tail and peer.tail) else peer.tail / own.tail
        yield Check(12, f"{what}, 99th percentile, against HPIPM's", tails, asked / 3, "times")


def _motions(rows: Sequence[Row]) -> Iterator[Check]:
    """The worst of the scenes."""
    found = motions.over(rows, "simulate", "stepper", motions.METHODS)
    yield Check(13, "simulate, held inputs, fixed steps, over the stepper's time", found, 1.3, "times", least=False)
    found = motions.over(rows, "dop853", "rk8 at its error", [f"{rtol:g}" for rtol in motions.TOLERANCES])
    yield Check(13, "simulate, adaptive, over rk8's time at equal error", found, 2.0, "times", least=False)


def _trees(rows: Sequence[Row]) -> Iterator[Check]:
    """As measured, not scaled: asked was of the machine as it is."""
    yield Check(14, trees.BENT, _median(find(rows, trees.GROUP, trees.BENT, trees.LANES)), 1e6, "steps/s")
    steps = _median(find(rows, trees.GROUP, trees.ENVIRONMENT, trees.LANES, 2))
    yield Check(14, f"{trees.ENVIRONMENT}, 2 threads", steps, 1e5, "steps/s")
    for name, most, unit, scale in (
        (trees.JACOBIANS, 200.0, "us", 1e-6),
        (trees.COLD, 20.0, "s", 1.0),
        (trees.MPC_SIX, 60.0, "us", 1e-6),
        (trees.NMPC_SIX, 5.0, "ms", 1e-3),
        (trees.NMPC_THREE, 8.0, "ms", 1e-3),
    ):
        found = _median(find(rows, trees.GROUP, name))
        yield Check(14, name, None if found is None else found / scale, most, unit, least=False)
