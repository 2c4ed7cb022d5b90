"""Every example script and every Python block of the README runs, and says what it says here."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
SAID = {  # a number that each example prints, and its range
    "cantilever.py": (r"lowest at [\d.]+ s: ([-\d.]+) m", -6.7745, -6.771),  # large_beam.json: -6.77426 m at 1.5427 s
    "slider_crank.py": (r"to ([\d.]+) um over", 14.2, 14.4),  # slider_crank.json: 14.275 um
    "design.py": (r"tip within ([\d.]+) mm", 0.0, 5.0),
    "environment.py": (r"payload ([\d.]+) kg", 0.35, 0.65),
    "input_delay.py": (r"predicted state: cost ([\d.]+)", 2.62, 2.67),  # least possible 2.6213 (tests/failures)
    "monte_carlo.py": (r"theta1 after 1 s from ([-\d.]+)", -1.57, -1.56),
    "shaping.py": (r"([\d.]+) percent", 0.0, 1.0),
    "mpc.py": (r"estimate: joints ([\d.]+) mrad", 0.0, 0.1),  # LQR: 16
    "nmpc.py": (r"largest bend ([\d.]+) mm", 99.0, 101.0),  # bounded at 100 mm
    "pd.py": (r"PD: cost ([\d.]+)", 3.5, 4.1),
    "lqg.py": (r"cost ([\d.]+) times", 0.99, 1.02),
    "spillover.py": (r"([\d.]+) Hz allowed", 40.0, 48.0),
    "paper_terms.py": (r"largest residual ([\d.e+-]+)", 0.0, 1e-10),
    "plan.py": (r"gentle: .* tip bends ([\d.]+) mm", 5.99, 6.001),
    "time_varying.py": (r"misses ([\d.]+) um", 0.0, 50.0),
    "tvlqr.py": (r"tip within ([\d.]+) mm of its goal", 0.0, 2.0),
}


@pytest.mark.parametrize("path", EXAMPLES, ids=[p.name for p in EXAMPLES])
def test_example(path: Path) -> None:
    done = subprocess.run([sys.executable, str(path)], capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    pattern, low, high = SAID[path.name]
    found = re.search(pattern, done.stdout)
    assert found, done.stdout
    assert low <= float(found[1]) <= high


def test_readme_blocks_run_in_order() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert len(blocks) >= 4
    names: dict = {}
    for block in blocks:
        exec(compile(block, "README.md", "exec"), names)
    assert names["rewards"].shape == (1024,)
    assert names["x"].shape == (1024, 12)
    assert abs(names["dy"]).max() > 1e-3


def test_readme_pictures_exist() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    for picture in re.findall(r"!\[.*?\]\((.*?)\)", text):
        assert (ROOT / picture).is_file(), picture
