"""How many threads torch should use for small networks: measured, unless the machine is busy.

On a busy two-processor machine two threads were seen to be thirty times slower than one: they wait for each other.
"""

from __future__ import annotations

import os
import time

import torch

from pliant.plants.native.thread_pool import available

BUSY = 0.5  # waiting processes for each processor, above which one thread is taken unmeasured
GAIN = 1.15  # how much faster several must be
BATCH, WIDTH, ROUNDS = 4096, 64, 5


def choose() -> tuple[int, str]:
    """(threads, why). Sets torch's threads while it measures."""
    most = available()
    if most == 1:
        return 1, "one processor"
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0
    if load > BUSY * most:
        return 1, f"the machine is busy, load {load:.1f}"
    one, several = _seconds(1), _seconds(most)
    words = f"{most} threads take {several / one:.2f} times as long as one"
    return (most, words) if one > GAIN * several else (1, words)


def _seconds(threads: int) -> float:
    """The shortest of a few updates of a network as training makes them."""
    torch.set_num_threads(threads)
    net = torch.nn.Sequential(
        torch.nn.Linear(WIDTH, WIDTH), torch.nn.Tanh(), torch.nn.Linear(WIDTH, WIDTH), torch.nn.Tanh()
    )
    inputs = torch.ones(BATCH, WIDTH)
    found = []
    for _ in range(ROUNDS + 1):
        begin = time.perf_counter()
        net(inputs).sum().backward()
        found.append(time.perf_counter() - begin)
    return min(found[1:])
