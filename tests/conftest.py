"""What tests ask for by name: plants (tests/cases/every_plant.py), states, references, a wheel; and how they are run.

`plant` is any of them, `lagrangian` one with coordinates and their rates alone as states, `arm` one with payload,
gravity and a tip in the plane, `undamped` an arm without damping.

PLIANT_TEST_NUDGE=n moves every number that NumPy's generators draw uniformly, and so the starting states of most tests,
by one unit in the last place, up or down by chance seeded with n: of double precision where n is odd, of single where
it is even. No test may feel it (tests/campaigns/nudge.py).
"""

import gc
import json
import os
import shutil
import subprocess
import sys
import zipfile
from collections import Counter
from pathlib import Path

import evidence
import numpy as np
import pytest
from every_plant import ARMS, LAGRANGIAN, PLANTS, SELDOM, UNDAMPED

from pliant.plants import SliderCrank
from pliant.plants.spacecraft.plant import FlexibleSpacecraft

ROOT = Path(__file__).parents[1]


class Nudged(np.random.Generator):
    """What it draws uniformly is moved by one unit in the last place."""

    def __init__(self, bits, seed):
        super().__init__(bits)
        self._chance = np.random.Generator(np.random.PCG64(seed))
        self._unit = np.finfo(np.float64 if seed % 2 else np.float32).eps

    def uniform(self, *args, **kwargs):
        drawn = super().uniform(*args, **kwargs)
        return drawn + self._chance.choice([-1.0, 1.0], np.shape(drawn)) * self._unit * np.abs(drawn)


@pytest.fixture(autouse="PLIANT_TEST_NUDGE" in os.environ)
def nudge(monkeypatch):
    """Every new generator nudges."""
    new, seed = np.random.default_rng, int(os.environ.get("PLIANT_TEST_NUDGE", "1"))
    monkeypatch.setattr(np.random, "default_rng", lambda *a: Nudged(new(*a).bit_generator, seed))


def variants(names):
    """Parameters of a fixture."""
    return [pytest.param(name, marks=[pytest.mark.campaign] if name in SELDOM else []) for name in names]


@pytest.fixture(scope="session", params=variants(PLANTS))  # so that all tests of one plant follow one another
def plant(request):
    return PLANTS[request.param]


@pytest.fixture(scope="session", params=variants(LAGRANGIAN))
def lagrangian(request):
    return LAGRANGIAN[request.param]


@pytest.fixture(scope="session", params=variants(ARMS))
def arm(request):
    return ARMS[request.param]


@pytest.fixture(scope="session", params=variants(UNDAMPED))
def undamped(request):
    return ARMS[request.param]


@pytest.fixture
def reference():
    """A file of tests/reference by name."""
    folder = Path(__file__).parent / "reference"
    return lambda name: json.loads((folder / f"{name}.json").read_text())


@pytest.fixture
def random_state():
    """A state: angles of any size, deflections of some per cent of a metre, moderate rates; of a spacecraft a unit
    quaternion.
    """

    def draw(plant, seed, size=1.0):
        rng = np.random.default_rng(seed)
        bent = np.array([s.unit.startswith("m") for s in plant.states])
        rates = np.array([s.unit.endswith("/s") for s in plant.states])
        # Small enough for the stage that loses definiteness at about a millimetre, and for a rod of 4 mm.
        slender = isinstance(plant, SliderCrank) or getattr(plant, "reduction", "") == "rigid-inertia"
        deflection = 2e-4 if slender else 0.02
        scale = np.where(bent, np.where(rates, 0.1, deflection), 2.0)
        x = size * scale * rng.uniform(-1, 1, plant.nx)
        if isinstance(plant, FlexibleSpacecraft):
            q = rng.normal(size=4)
            x[plant.layout.quaternion] = q / np.linalg.norm(q)
        return x

    return draw


@pytest.fixture(scope="session")
def wheel_file(tmp_path_factory):
    """The wheel, built from a copy of the tree, without network."""
    pytest.importorskip("setuptools", minversion="77")
    out = tmp_path_factory.mktemp("wheel")
    copy = out / "copy"
    copy.mkdir()
    for name in ("pyproject.toml", "setup.py", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, copy / name)
    for folder in ("package", "plants", "controllers", "envs", "studies"):
        shutil.copytree(ROOT / folder, copy / folder, ignore=shutil.ignore_patterns("__pycache__"))
    command = ("wheel", "--quiet", "--no-deps", "--no-build-isolation", "--wheel-dir", str(out), str(copy))
    built = subprocess.run([sys.executable, "-m", "pip", *command], capture_output=True, text=True)
    assert built.returncode == 0, built.stderr
    (path,) = out.glob("pliant-*.whl")
    return path


@pytest.fixture(scope="session")
def installed(wheel_file, tmp_path_factory):
    """The folder that the wheel is installed in."""
    folder = tmp_path_factory.mktemp("installed")
    with zipfile.ZipFile(wheel_file) as archive:  # a wheel of Python files alone: unpacked is installed
        archive.extractall(folder)
    return folder


SETTINGS = {name: os.environ.get(name) for name in ("CC", "PLIANT_NATIVE", "PLIANT_CFLAGS", "PLIANT_CACHE")}


def pytest_addoption(parser):
    parser.addoption("--evidence", help="write what `agrees` compared to this json, beside what stands there")


def pytest_sessionfinish(session):
    path = session.config.getoption("--evidence")
    if path and evidence.KEPT:
        kept = json.loads(Path(path).read_text(encoding="utf-8")) if Path(path).is_file() else {}
        Path(path).write_text(
            json.dumps(dict(sorted((kept | evidence.KEPT).items())), indent=1) + "\n", encoding="utf-8"
        )


def pytest_collection_finish():
    """What is there by now stays: the collector of garbage need not go through it again and again.

    No module may have turned the compiler off, or to other settings, as it was imported: every test would be of those.
    """
    assert {name: os.environ.get(name) for name in SETTINGS} == SETTINGS
    gc.collect()
    gc.freeze()
    gc.set_threshold(50_000, 20, 20)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """`every(n)`: the first of each n variants of a test runs in `make test`, all of them in `make campaign`.

    Tests that are `early` come first: at the end of a run, processes take tests from each other.
    """
    items.sort(key=lambda item: item.get_closest_marker("early") is None)
    seen = Counter()
    for item in items:
        if mark := item.get_closest_marker("every"):
            test = item.nodeid.partition("[")[0]
            if seen[test] % mark.args[0]:
                item.add_marker(pytest.mark.campaign)
            seen[test] += 1
