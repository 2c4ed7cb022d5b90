"""The tests of native code and single precision, many times, their starting states moved by one unit in the last place.

    python tests/campaigns/nudge.py [times, 50]

A bound that rounding decides fails in one of them. Every run is `PLIANT_TEST_NUDGE=n pytest ..`; the seeds of those
that fail are printed, and the exit status is 1 where there are any.
"""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
NATIVE = ["tests/plants/native", "tests/plants/integration/test_batch_stepper.py"]
SINGLE = ["tests/envs/environments/test_vector_env.py"]  # and all that takes float32 as an argument


def main(times: int) -> int:
    files = [name for name in (*NATIVE, *SINGLE) if (ROOT / name).exists()]
    failed = []
    for seed in range(1, times + 1):
        command = [sys.executable, "-m", "pytest", "-q", "--no-header", "-p", "no:cacheprovider", *files]
        environment = os.environ | {"PLIANT_TEST_NUDGE": str(seed), "OMP_NUM_THREADS": "1"}
        done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
        print(f"nudge {seed}/{times}: {done.stdout.strip().splitlines()[-1]}", file=sys.stderr)
        if done.returncode:
            failed.append(seed)
            print("\n".join(line for line in done.stdout.splitlines() if line.startswith("FAILED")))
    print(f"{times - len(failed)} of {times} runs passed" + (f"; seeds that failed: {failed}" if failed else ""))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 50))
