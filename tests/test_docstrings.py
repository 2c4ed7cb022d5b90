"""Every public name has shapes, units, errors and an example, and the examples run."""

import doctest
import importlib
import re
import sys
from pathlib import Path

import numpy as np
import pytest

from pliant.plants.tables import plant_types

HOUSE = Path(__file__).parents[1] / "docs" / "house"
sys.path.insert(0, str(HOUSE))
docstrings, sessions = importlib.import_module("docstrings"), importlib.import_module("sessions")
sys.path.remove(str(HOUSE))

# What an example needs that does not come with Pliant: it runs where that is installed, all of them in `make campaign`.
NEEDS = {
    "pliant.plants.core.trajectory.Trajectory.to_pandas": "pandas",
    "pliant.plants.modal_data.modal_data.ModalData.from_nastran": "pyyeti",
    "pliant.envs.scenes.scene.Scene.differentiable": "torch",
}
SAMPLE = ("controllers: LQR", "parts: Beam", "parts: Trajectory", "scenes: PlantEnv")
PUBLIC = docstrings.public()
SECTIONS = {test.name: test for test in sessions.tests()}
OWN = {name: item for name, item in PUBLIC.items() if ">>>" in item.doc}


@pytest.fixture(scope="module")
def known():
    """What examples take as known beside their own module's names: what the block of docs/api.md makes."""
    [block] = re.findall(r"```python\n(.*?)```", (HOUSE.parent / "api.md").read_text(encoding="utf-8"), re.DOTALL)
    names: dict = {}
    exec(block, names)
    return {name: names[name] for name in ("np", "scene", "arm", "law", "motion")}


def outcome(test):
    told = []
    with np.printoptions(precision=4, suppress=True):
        runner = doctest.DocTestRunner(optionflags=sessions.OPTIONS)
        runner.run(test, out=told.append)
    return "".join(told)


def test_public_names_lack_nothing():
    assert docstrings.gaps(PUBLIC) == {}
    assert set(NEEDS) <= set(OWN)


def bare(q, v):
    return q


def half_told(mass: float) -> float:
    """The mass.

    >>> half_told(1.0)
    """
    if mass < 0:
        raise ValueError("mass")
    return mass


def test_a_planted_gap_is_found():
    """Without a docstring all is lacking; without unit and error those are."""
    assert docstrings.lacks(docstrings.Public("tests.bare", bare)) == list(docstrings.KINDS)
    assert docstrings.lacks(docstrings.Public("tests.half_told", half_told)) == ["measure", "errors"]
    beam = PUBLIC["pliant.plants.beams.section.Beam"]
    assert docstrings.lacks(beam) == []
    planted = {"tests.half_told": docstrings.Public("tests.half_told", half_told), "beam": beam}
    assert docstrings.gaps(planted) == {"tests.half_told": ["measure", "errors"]}


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[] if n in SAMPLE else pytest.mark.docs, id=n) for n in SECTIONS]
)
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_a_session_runs(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert outcome(SECTIONS[name]) == ""


@pytest.mark.docs
@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("name", OWN)
def test_an_example_in_a_docstring_runs(name, known, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(plant_types, "_registered", dict(plant_types._registered))  # what one registers, none keeps
    if name in NEEDS:
        pytest.importorskip(NEEDS[name], reason="what this example needs is not installed")
    item = OWN[name]
    module = importlib.import_module((item.function or item.what).__module__)
    names = known | vars(module)
    assert outcome(doctest.DocTestParser().get_doctest(item.doc, names, name, None, 0)) == ""
