"""Every example script and every Python block of the README runs, and says what it says here."""

import os
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
    "differentiable.py": (r"cost ([\d.]+) after", 3.5, 4.2),  # doing nothing 30, LQR 3.511
    "pd.py": (r"PD: cost ([\d.]+)", 3.5, 4.1),
    "lqg.py": (r"cost ([\d.]+) times", 0.99, 1.02),
    "spillover.py": (r"([\d.]+) Hz allowed", 40.0, 48.0),
    "paper_terms.py": (r"largest residual ([\d.e+-]+)", 0.0, 1e-10),
    "plan.py": (r"gentle: .* tip bends ([\d.]+) mm", 5.99, 6.001),
    "time_varying.py": (r"misses ([\d.]+) um", 0.0, 50.0),
    "tvlqr.py": (r"tip within ([\d.]+) mm of its goal", 0.0, 2.0),
}


# One process imports what the scripts import and then forks for each: importing is half of what a script costs.
PARENT = """
import os, runpy, sys
import pliant.controllers, pliant.envs, pliant.plants
from pathlib import Path
assert Path(pliant.plants.__file__).is_relative_to(sys.argv[1]), pliant.plants.__file__
for line in sys.stdin:
    script, folder, said = line.rstrip().split("\\t")
    child = os.fork()
    if child == 0:
        os.chdir(folder)
        out = os.open(said, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
        os.dup2(out, 1), os.dup2(out, 2)
        sys.stdin, sys.argv[:] = open(os.devnull), [script]
        runpy.run_path(script, run_name="__main__")
        sys.stdout.flush()
        sys.exit()
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
"""


@pytest.fixture(scope="module")
def parent(installed, tmp_path_factory):
    """A process with the installed wheel, in an empty folder, that runs a script a line."""
    environment = os.environ | {"PYTHONPATH": str(installed), "MPLBACKEND": "agg"}
    command = [sys.executable, "-c", PARENT, str(installed)]
    folder = tmp_path_factory.mktemp("parent")
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=folder, env=environment
    ) as process:
        yield process
        process.stdin.close()


@pytest.fixture
def alone(parent, tmp_path):
    """Run a script in an empty folder of its own."""

    def run(path: Path) -> str:
        folder, said = tmp_path / "empty", tmp_path / "said"
        folder.mkdir()
        parent.stdin.write(f"{path}\t{folder}\t{said}\n")
        parent.stdin.flush()
        status = parent.stdout.readline().strip()
        assert status == "0", said.read_text()
        assert not list(folder.iterdir())
        return said.read_text()

    return run


# Run by `make test`; the others, longer by half a minute, are run with the pages, by `make docs`.
SAMPLE = ("environment.py", "paper_terms.py")


@pytest.mark.parametrize(
    "path", [pytest.param(p, id=p.name, marks=[] if p.name in SAMPLE else pytest.mark.docs) for p in EXAMPLES]
)
def test_example(path: Path, alone) -> None:
    said = alone(path)
    pattern, low, high = SAID[path.name]
    found = re.search(pattern, said)
    assert found, said
    assert low <= float(found[1]) <= high


def blocks(page: Path) -> list[str]:
    return re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)


README_CHECKS = """
assert rewards.shape == (1024,)
assert x.shape == (1024, 12)
assert abs(dy).max() > 1e-3
"""
METHODS_CHECKS = """
assert abs(drop["tip_v"][-1] + 6.7742) < 1e-3  # m at 1.54 s, tests/reference/large_beam.json
assert np.ptp(quiet["tip_deflection"][times > 1.5]) < 0.01 * np.ptp(slew["tip_deflection"][times > 1.5])
assert abs(bend).max() < 0.006 + 1e-6
"""
IDENTIFIED = """
assert found.trusted and all(low < high for low, high in found.intervals.values()) and not wrong.trusted
assert few.conditional and not few.trusted
assert set(pair.unidentifiable[0].names) == {"link.E", "link.I_z"} and ranking.best.name == "10 Hz"
"""
GNC_CHECKS = """
from pathlib import Path
closed = [0.8305173808, 1.1186408217, 1.9036343593, 2.5981417890]  # tests/plants/modal_data/test_data_sheet.py
assert np.allclose(craft.natural_frequencies(), closed, rtol=1e-9)
assert abs(budget.ape.max() - 0.00289) < 2e-5 and np.linalg.eigvals(held.A[0]).real.max() < 0
assert 0 < len(study.unstable) < 10 and not study.failures and len(study.rows) == 200
left = {slew.profile: slew.left for slew in slews}
assert left["jerk-limited"] < left["minimum-jerk"] < left["bang-bang"]
written = ("acs.c", "acs.h", "acs.mat", "craft.npz", "craft_step.c", "craft_step.h", "slews.png")
assert all(Path(name).stat().st_size > 500 for name in written)
[Path(name).unlink() for name in written]
"""

DEPLOYMENT_CHECKS = """
assert "typedef float law_real;" in header.read_text()
source.unlink(), header.unlink()
"""

ELASTIC_ARM = """
assert abs(cost - 2.4825) < 1e-3 and told.verdict.startswith("holds") and stands.stable_to > 3
"""
URDF_ARM = """
assert told.verdict.startswith("unstable") and missed < 1e-6
assert [s.name for s in arm.states][2:4] == ["fore_z1", "fore_z2"]
chosen = choose(scene)
assert chosen.met and chosen.plant.label.startswith("linear")
Path("arm.urdf").unlink()
"""
SLEW = """
assert told.verdict == "bounded" and 0 < push.upper - push.lower < 1e-4 and moved < 0.05 * push.upper
"""
TRAINED = """
from pathlib import Path
assert found.cost < 3.52 and abs(costs["policy"] - found.cost) < 1e-3
[Path(name).unlink() for name in ("slew.npz", "slew.json", "slew_policy.c", "slew_policy.h")]
"""
CLUSTER = """
from pathlib import Path
assert all(same) and len(more.rows) == 16
Path("runs.jsonl").unlink()
"""
CHOSEN = "assert choice.met and len(choice.rungs) > 2 and choice.effects\n"
UNDECIDED = """
assert coarse.verdict == "undecided" and fine.verdict == "bounded" and later.verdict == "stable"
assert drifts.verdict == "drift" and held.verdict == "bounded" and push.upper - push.lower < 1e-4 * push.upper
"""


@pytest.mark.parametrize(
    ("page", "least", "checks"),
    [
        pytest.param("README.md", 4, README_CHECKS, id="README"),
        pytest.param("docs/methods.md", 12, METHODS_CHECKS, id="methods", marks=pytest.mark.docs),
        pytest.param("docs/identification.md", 5, IDENTIFIED, id="identification", marks=pytest.mark.docs),
        pytest.param("docs/gnc.md", 4, GNC_CHECKS, id="gnc", marks=pytest.mark.docs),
        pytest.param("docs/deployment.md", 1, DEPLOYMENT_CHECKS, id="deployment", marks=pytest.mark.docs),
        pytest.param("docs/tutorials/elastic_arm.md", 5, ELASTIC_ARM, id="elastic_arm", marks=pytest.mark.docs),
        pytest.param("docs/tutorials/urdf_arm.md", 4, URDF_ARM, id="urdf_arm", marks=pytest.mark.docs),
        pytest.param("docs/tutorials/slew_stability.md", 4, SLEW, id="slew_stability", marks=pytest.mark.docs),
        pytest.param("docs/tutorials/train_a_policy.md", 3, TRAINED, id="train_a_policy", marks=pytest.mark.docs),
        pytest.param("docs/tutorials/cluster.md", 2, CLUSTER, id="cluster", marks=pytest.mark.docs),
        pytest.param("docs/undecided.md", 4, UNDECIDED, id="undecided", marks=pytest.mark.docs),
        pytest.param("docs/choose_model.md", 1, CHOSEN, id="choose_model", marks=pytest.mark.docs),
    ],
)
def test_blocks_run_in_order(page, least, checks, alone, tmp_path_factory) -> None:
    found = blocks(ROOT / page)
    assert len(found) >= least
    script = tmp_path_factory.mktemp("blocks") / "script.py"
    script.write_text("\n".join([*found, checks]), encoding="utf-8")
    alone(script)


def test_a_data_sheet_takes_twelve_lines() -> None:
    """To margins with a notch, 200 runs over the frequencies, .mat and C, imports apart, none longer than our own."""
    lines = [line for line in blocks(ROOT / "docs" / "gnc.md")[0].splitlines() if line]
    counted = [line for line in lines if not line.startswith(("import ", "from "))]
    assert len(counted) <= 12 and max(map(len, lines)) <= 120


def test_methods_pictures_are_those_that_the_script_draws() -> None:
    text = (ROOT / "docs" / "methods.md").read_text(encoding="utf-8")
    shown = re.findall(r"!\[.*?\]\(figures/(.*?)\.png\)", text)
    scripts = [ROOT / "docs" / "house" / name for name in ("pictures.py", "law_pictures.py")]
    script = "".join(path.read_text(encoding="utf-8") for path in scripts)
    drawn = [name.replace("_", "-") for name in re.findall(r"^def ([a-z]\w*)\(n: Names\)", script, re.MULTILINE)]
    assert sorted(shown) == sorted(drawn)
    assert all((ROOT / "docs" / "figures" / f"{name}.png").is_file() for name in shown)


def test_readme_pictures_exist() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    for picture in re.findall(r"!\[.*?\]\((.*?)\)", text):
        assert (ROOT / picture).is_file(), picture
