"""What was asked of the measurements, beside what was found."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import acts
import cantilever
import environments as env
import learning
import peers
import physics
import spacecraft
import stability
import startup
from sampling import Row, ratio
from soak import GROWTH, STEPS, Soak


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
    found += [_stability(rows), _spacecraft(rows), _controllers(rows)]
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


def _environments(rows: Sequence[Row]) -> Iterator[Check]:
    for name, threads, asked in (
        (physics.DOUBLE, 2, 1.0e6),
        (physics.SINGLE, 2, 1.7e6),
        (physics.DOUBLE, 1, 0.6e6),
        (physics.SINGLE, 1, 1.0e6),
    ):
        row = find(rows, env.GROUP, name, 1024, threads)
        shown = f"environment, {name.partition(', ')[2]}, {threads} thread{'s' * (threads > 1)}"
        yield Check(2, shown, _median(row), asked, "steps/s")
    for name in (physics.DOUBLE, physics.SINGLE):
        row = find(rows, env.OUTSIDE, name, 1024, 2)
        share = None if row is None or row.median is None else 100 * row.median
        shown = f"time outside the kernel, {name.partition(', ')[2]}, 2 threads"
        yield Check(2, shown, share, 25, "%", least=False)
    yield Check(3, "PlantEnv.step", _median(find(rows, env.SINGLE_GROUP, "Pliant, PlantEnv")), 40_000, "steps/s")


def _times(rows: Sequence[Row]) -> Iterator[Check]:
    name = "Pliant, exact Jacobians, native"
    for points, threads, scale, asked, unit, what in (
        (1, 1, 1e6, 15, "us", "exact Jacobians, one point"),
        (physics.POINTS, 2, 1e3, 15, "ms", f"exact Jacobians, {physics.POINTS} points in one call"),
    ):
        found = _median(find(rows, physics.JACOBIANS, name, points, threads))
        yield Check(4, what, None if found is None else scale * found, asked, unit, least=False)
    for name, asked in ((startup.COLD, 10.0), (startup.WARM, 0.3)):
        yield Check(5, name, _median(find(rows, startup.GROUP, name, startup.LANES)), asked, "s", least=False)


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
    rate = max((r.median or 0.0 for r in found), default=None)
    yield Check(8, "PPO end to end, 1,024 environments", rate, learning.ASKED_RATE, "steps/s")


def _cantilever(rows: Sequence[Row]) -> Iterator[Check]:
    for error, times in ((cantilever.COARSE, 100), (cantilever.FINE, 50)):
        found = cantilever.times_faster(rows, error)
        yield Check(9, f"cantilever-drop to {error:g} m, against Exudyn's fastest settings", found, times, "times")


def _stability(rows: Sequence[Row]) -> Iterator[Check]:
    for name, threads, asked in ((stability.VERDICT, 1, 0.3), (stability.CHART, 2, 20.0)):
        found = _median(find(rows, stability.GROUP, name, threads=threads))
        yield Check(10, name, found, asked, "s", least=False)


def _spacecraft(rows: Sequence[Row]) -> Iterator[Check]:
    build = _median(find(rows, spacecraft.GROUP, spacecraft.BUILD))
    yield Check(11, spacecraft.BUILD, build, 20.0, "s", least=False)
    name = spacecraft.linearise_name(spacecraft.COUNTS[-1])
    found = _median(find(rows, spacecraft.GROUP, name))
    yield Check(11, name, None if found is None else 1e3 * found, 5.0, "ms", least=False)
    grows = "time of a linearisation ~ states^k, largest k between neighbouring rows"
    yield Check(11, grows, spacecraft.exponent(rows), 3.0, "", least=False)


def _controllers(rows: Sequence[Row]) -> Iterator[Check]:
    """Median, and a 99th percentile within three times what was asked of it."""
    twenty, forty = (acts.mpc_name(n) for n in acts.HORIZONS)
    for name, asked in (
        (acts.LQR, 5.0),
        (acts.TVLQR, 15.0),
        (twenty, 60.0),
        (forty, 200.0),
        (acts.NMPC, 2000.0),
    ):
        row = find(rows, acts.GROUP, name)
        for what, found, most in (
            (name, _median(row), asked),
            (f"{name}, 99th percentile", row.tail if row else None, 3 * asked),
        ):
            yield Check(12, what, None if found is None else 1e6 * found, most, "us", least=False)
