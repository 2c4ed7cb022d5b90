"""How long it takes until something can be done, in fresh processes: the vector environment on an empty cache and on a
filled one, the imports alone, and beside them the import of libraries that stand for a program of this kind."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence

from harness.sampling import TIME, Progress, Row, busy

GROUP = "start"
COLD, WARM = "gymnasium.make_vec, empty cache", "gymnasium.make_vec, cache hit"
COLD_RESET, WARM_RESET = "make_vec and first reset, empty cache", "make_vec and first reset, cache hit"
IMPORTS, PLANTS = "import gymnasium, pliant.envs", "import pliant.plants"
PEER = "import scipy.signal, scipy.optimize"  # what a control script loads anyway
LANES = 1024
CODE = f"""
import json, time
times = [time.perf_counter()]
import gymnasium, pliant.envs
times.append(time.perf_counter())
env = gymnasium.make_vec("pliant/TwoLinkReach-v0", num_envs={LANES}, randomise=True)
times.append(time.perf_counter())
env.reset(seed=0)
times.append(time.perf_counter())
print(json.dumps(times))
"""


def once(cache: str, python: str = sys.executable) -> tuple[float, float, float]:
    """Seconds of the imports, of make_vec, and of make_vec and the first reset, in a new process."""
    done = subprocess.run(
        [python, "-c", CODE],
        env=os.environ | {"PLIANT_CACHE": cache},
        capture_output=True,
        text=True,
        check=True,
    )
    begin, imported, made, reset = json.loads(done.stdout.splitlines()[-1])
    return imported - begin, made - imported, reset - imported


def imported(what: str, python: str = sys.executable) -> float:
    """Seconds that an import takes in a new process, without the interpreter's own start."""
    code = f"import time; begin = time.perf_counter(); {what}; print(time.perf_counter() - begin)"
    done = subprocess.run([python, "-c", code], capture_output=True, text=True, check=True)
    return float(done.stdout.splitlines()[-1])


def against(rounds: int, other: str, progress: Progress) -> Sequence[Row]:
    """The warm start and the import of this and of another checkout's interpreter in turn, round after round."""
    names = (WARM, PLANTS)
    rows = {(name, p): Row(GROUP, name + f", {p}", TIME, 1, LANES, False) for name in names for p in ("here", "there")}
    with tempfile.TemporaryDirectory() as here, tempfile.TemporaryDirectory() as there:
        pythons = (("here", sys.executable, here), ("there", other, there))
        for _, python, cache in pythons:
            once(cache, python)  # fills the cache
        for k in range(rounds):
            for i, (place, python, cache) in enumerate(pythons if k % 2 else pythons[::-1]):
                progress((2 * k + i) / (2 * rounds), place)
                rows[WARM, place].samples.append(once(cache, python)[1])
                rows[PLANTS, place].samples.append(imported(PLANTS, python))
    progress(1.0, "")
    return list(rows.values())


def measure(rounds: int, progress: Progress) -> Sequence[Row]:
    """A cold and a warm start a round."""
    rows = {name: Row(GROUP, name, TIME, 1, LANES, False) for name in (COLD, WARM, COLD_RESET, WARM_RESET, IMPORTS)}
    rows |= {name: Row(GROUP, name, TIME, 1, LANES, name == PEER) for name in (PLANTS, PEER)}
    for k in range(rounds):
        for name in (PLANTS, PEER):
            rows[name].samples.append(imported(name))
        with tempfile.TemporaryDirectory() as cache:
            for i, (made, reset) in enumerate(((COLD, COLD_RESET), (WARM, WARM_RESET))):
                progress((2 * k + i) / (2 * rounds), made)
                before = busy()
                found = once(cache)
                after = busy()
                names = (IMPORTS, made, reset) if made == WARM else (made, reset)
                for name, value in zip(names, found if made == WARM else found[1:]):
                    rows[name].samples.append(value)
                    if before and after:
                        others = after[0] - before[0] - after[1] + before[1]
                        rows[name].others.append(max(0.0, others) / sum(found[::2]))
    progress(1.0, "")
    return list(rows.values())
