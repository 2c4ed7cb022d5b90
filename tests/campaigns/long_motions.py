"""Work done equals energy gained over twenty seconds, of every undamped arm; `make test` looks at four.

python tests/campaigns/long_motions.py
"""

import os
import subprocess
import sys
from pathlib import Path

TEST = "tests/plants/dynamics/test_lagrangian.py"

if __name__ == "__main__":
    command = [sys.executable, "-m", "pytest", "-q", TEST, "-k", "test_work_done_equals_energy_gained"]
    environment = os.environ | {"PLIANT_TEST_SECONDS": "20", "OMP_NUM_THREADS": "1"}
    sys.exit(subprocess.run(command, cwd=Path(__file__).parents[2], env=environment, check=False).returncode)
