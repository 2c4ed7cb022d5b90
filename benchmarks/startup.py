"""How long the vector environment takes to be there, in a fresh process: on an empty cache, and on a filled one."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence

from sampling import TIME, Progress, Row, busy

GROUP = "start"
COLD, WARM = "gymnasium.make_vec, empty cache", "gymnasium.make_vec, cache hit"
COLD_RESET, WARM_RESET = "make_vec and first reset, empty cache", "make_vec and first reset, cache hit"
IMPORTS = "import gymnasium, pliant.envs"
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


def once(cache: str) -> tuple[float, float, float]:
    """Seconds of the imports, of make_vec, and of make_vec and the first reset, in a new process."""
    done = subprocess.run(
        [sys.executable, "-c", CODE],
        env=os.environ | {"PLIANT_CACHE": cache},
        capture_output=True,
        text=True,
        check=True,
    )
    begin, imported, made, reset = json.loads(done.stdout.splitlines()[-1])
    return imported - begin, made - imported, reset - imported


def measure(rounds: int, progress: Progress) -> Sequence[Row]:
    """A cold and a warm start a round."""
    rows = {name: Row(GROUP, name, TIME, 1, LANES, False) for name in (COLD, WARM, COLD_RESET, WARM_RESET, IMPORTS)}
    for k in range(rounds):
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
