"""Timing: cases are sampled in turns, round after round, so that what slows the machine slows all of them.

On Linux a sample during which other processes used the processors is taken again, a few times. On a machine that is
always busy `by_processor_time` tells what this process itself worked, over its threads.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

Sampler = Callable[[float], Any]  # seconds to spend -> one value, or that and a 99th percentile of single calls
Progress = Callable[[float, str], None]

RATE, TIME, SHARE = "steps/s", "s", "share"  # units of a row
DISTURBED = 0.2  # processors that others used; a sample with more is taken again ..
RETAKES = 3  # .. at most so often
BUSY = "PLIANT_BENCH_PROCESSOR_TIME"  # set in the environment where processor time is told, for processes of cases too


def by_processor_time() -> None:
    """From now on, here and in processes that cases start."""
    os.environ[BUSY] = "1"


def clock(threads: int = 1) -> float:
    """[s] by the wall, or what this process and those that it waited for have worked, over its threads."""
    if BUSY not in os.environ:
        return time.perf_counter()
    took = os.times()
    return (time.process_time() + took.children_user + took.children_system) / threads


@dataclass(frozen=True, kw_only=True)
class Case:
    """What is to be measured. prepare() builds it, runs it once and gives its sampler.

    A peer that is not installed, or that fails to start, becomes a row that says so; any other failure is an error.
    """

    group: str
    name: str
    prepare: Callable[[], Sampler]
    unit: str = RATE
    threads: int = 1
    lanes: int = 1
    peer: bool = False
    note: str = ""
    rounds: int | None = None  # sampled in so many rounds only, where a sample takes many seconds


@dataclass
class Row:
    """The samples of a case, in its unit; one a round. `failure` says why there are none."""

    group: str
    name: str
    unit: str
    threads: int
    lanes: int
    peer: bool
    note: str = ""
    samples: list[float] = field(default_factory=list)
    others: list[float] = field(default_factory=list)  # processors that other processes used meanwhile
    tails: list[float] = field(default_factory=list)  # 99th percentiles of single calls, where a sample times each
    failure: str | None = None

    @property
    def median(self) -> float | None:
        """Of the samples; None where there are none."""
        return median(self.samples) if self.samples else None

    @property
    def tail(self) -> float | None:
        """Median of the 99th percentiles; None where there are none."""
        return median(self.tails) if self.tails else None


def rate_of(work: Callable[[], int], threads: int = 1) -> Sampler:
    """Steps a second of work(), which returns how many steps it made in so many threads."""

    def sample(seconds: float) -> float:
        done, begin = 0, clock(threads)
        while (spent := clock(threads) - begin) < seconds:
            done += work()
        return done / spent

    work()
    return sample


def time_of(work: Callable[[], object]) -> Sampler:
    """Seconds that one call of work() takes, on average over a sample."""

    def sample(seconds: float) -> float:
        calls, begin = 0, clock()
        while (spent := clock() - begin) < seconds:
            work()
            calls += 1
        return spent / calls

    work()
    return sample


def acts_of(controller: Any, episodes: Sequence[Sequence[tuple[float, Any, bool]]]) -> Sampler:
    """Median and 99th percentile [s] of single acts over whole passes through recorded episodes of (time, reading,
    whether the act counts); the controller is reset at the start of each.
    """

    def sample(seconds: float) -> tuple[float, float]:
        spent: list[int] = []
        now = time.process_time_ns if BUSY in os.environ else time.perf_counter_ns
        act, begin = controller.act, clock()
        while not spent or clock() - begin < seconds:
            for episode in episodes:
                controller.reset()
                for t, y, counts in episode:
                    start = now()
                    act(t, y)
                    end = now()
                    if counts:
                        spent.append(end - start)
        return 1e-9 * float(np.median(spent)), 1e-9 * float(np.percentile(spent, 99))

    sample(0.0)
    return sample


def family(process: str = "self") -> float:
    """Seconds that a process and all that live below it have worked, those included that it has waited for."""
    ticks = 0
    try:
        with open(f"/proc/{process}/stat") as file:
            ticks += sum(int(word) for word in file.read().rpartition(")")[2].split()[11:15])
        below = [path.read_text().split() for path in Path(f"/proc/{process}/task").glob("*/children")]
    except OSError:  # it has ended meanwhile, and is counted with its parent's
        return 0.0
    return ticks / os.sysconf("SC_CLK_TCK") + sum(family(child) for children in below for child in children)


def busy() -> tuple[float, float] | None:
    """Seconds that all processors worked since the start of the machine, and those of this process and its children;
    Linux only.
    """
    try:
        with open("/proc/stat") as file:
            ticks = [int(word) for word in file.readline().split()[1:9]]
    except OSError:
        return None
    user, nice, system, _, _, irq, softirq, steal = ticks
    return (user + nice + system + irq + softirq + steal) / os.sysconf("SC_CLK_TCK"), family()


def undisturbed(sampler: Sampler, seconds: float) -> tuple[Any, float | None]:
    """A sample, and how many processors others used meanwhile; the quietest of at most 1 + RETAKES."""
    best: tuple[Any, float | None] | None = None
    for _ in range(1 + RETAKES):
        before, begin = busy(), time.perf_counter()
        value = sampler(seconds)
        spent, after = time.perf_counter() - begin, busy()
        if before is None or after is None or BUSY in os.environ:
            return value, None
        others = max(0.0, (after[0] - before[0] - after[1] + before[1]) / spent)
        if best is None or best[1] is None or others < best[1]:
            best = value, others
        if others < DISTURBED:
            break
    assert best is not None
    return best


def reason(failure: Exception) -> str:
    """Why a peer has no numbers, in one line without paths."""
    if isinstance(failure, ModuleNotFoundError):
        return f"{failure.name} is not installed"
    lines = str(failure).splitlines()
    words = [word for word in (lines[0] if lines else "").split() if "/" not in word]
    return f"{type(failure).__name__}: {' '.join(words)}"[:160]


def start(case: Case) -> tuple[Row, Sampler | None]:
    """An empty row and the case's sampler, None where a peer does not start."""
    row = Row(case.group, case.name, case.unit, case.threads, case.lanes, case.peer, case.note)
    try:
        return row, case.prepare()
    except Exception as failure:
        if not case.peer:
            raise
        row.failure = reason(failure)
        return row, None


def measure(cases: Sequence[Case], rounds: int, seconds: float, progress: Progress) -> list[Row]:
    """Sample every case once a round."""
    started = []
    for i, case in enumerate(cases):
        progress(0.1 * i / len(cases), f"prepare {case.name}")
        started.append(start(case))
    for k in range(rounds):
        for i, (case, (row, sampler)) in enumerate(zip(cases, started)):
            progress(0.1 + 0.9 * (k + i / len(started)) / rounds, f"round {k + 1}: {row.name}")
            if sampler is None or (case.rounds is not None and k >= case.rounds):
                continue
            value, others = undisturbed(sampler, seconds)
            if isinstance(value, tuple):
                value, tail = value
                row.tails.append(tail)
            row.samples.append(value)
            if others is not None:
                row.others.append(others)
    progress(1.0, "")
    return [row for row, _ in started]


def ratio(first: Row | None, second: Row | None) -> float | None:
    """Median over the rounds of first / second, both sampled in the same round; None where either has no samples."""
    if first is None or second is None or not (first.samples and second.samples):
        return None
    return median(a / b for a, b in zip(first.samples, second.samples))
