"""Torch takes seconds to load: nothing loads it before training starts, and without it the rest works."""

import subprocess
import sys


def test_torch_is_not_loaded():
    code = "import sys, pliant.controllers; print({'torch', 'stable_baselines3'} & set(sys.modules))"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "set()"
