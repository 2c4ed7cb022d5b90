"""Modules of 0.1 under their old names are the modules in the rooms; late modules are imported by their first use,
what packages offer when it is asked for."""

import ast
import copy
import importlib
import inspect
import pickle
import subprocess
import sys

import pytest

import pliant.controllers
import pliant.envs
import pliant.plants
import pliant.studies
from pliant.plants.core import imports
from pliant.plants.core.imports import Late, loaded, offered

OLD = sorted(imports._finder.places.items())
GROUP = "pliant.tried"  # of entry points


@pytest.mark.parametrize(("old", "new"), OLD, ids=[old for old, _ in OLD])
def test_an_old_name_is_the_module_in_its_room(old, new):
    sys.modules.pop(old, None)
    with pytest.warns(DeprecationWarning, match=f"{old} has moved: import {new}"):
        found = importlib.import_module(old)
    assert found is importlib.import_module(new)
    assert found.__name__ == new
    assert found.__spec__.name == new


def test_attributes_of_the_package_are_the_same_modules():
    from pliant.controllers import rl, sensors

    assert rl is importlib.import_module("pliant.controllers.rl")
    assert sensors is importlib.import_module("pliant.controllers.sensors")


def test_a_name_that_never_was_is_not_found():
    with pytest.raises(ModuleNotFoundError, match=r"pliant\.plants\.nothing"):
        importlib.import_module("pliant.plants.nothing")


def test_the_script_that_imports_is_the_one_that_is_warned(tmp_path):
    script = tmp_path / "old.py"
    script.write_text("from pliant.plants.sensitivities import StepSensitivities\nprint(StepSensitivities.__name__)\n")
    done = subprocess.run([sys.executable, "-W", "default", script], capture_output=True, text=True, timeout=60)
    assert done.stdout.strip() == "StepSensitivities"
    assert "old.py:1: DeprecationWarning: pliant.plants.sensitivities has moved" in done.stderr


def test_an_attribute_is_the_modules_own():
    import fractions

    late = Late("fractions")
    assert late.Fraction is fractions.Fraction
    assert vars(late)["Fraction"] is fractions.Fraction  # kept: asked for once


def test_what_is_not_there_is_said():
    with pytest.raises(AttributeError, match="fractions"):
        _ = Late("fractions").no_such_name
    with pytest.raises(ModuleNotFoundError, match="no_such_module"):
        _ = Late("no_such_module").anything


def test_copies_and_pickles_import_nothing():
    twin = pickle.loads(pickle.dumps(copy.deepcopy(Late("no_such_module"))))
    assert vars(twin) == {"_name": "no_such_module"}


def test_plants_import_no_scipy():
    code = "import sys, pliant.plants; print(sorted(m for m in sys.modules if m.split('.')[0] == 'scipy'))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.stdout.strip() == "[]", done.stdout + done.stderr


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A folder as pip leaves it: a module, and entry_points.txt beside its metadata."""
    (tmp_path / "cranes_tried.py").write_text("crane = 7\n")
    info = tmp_path / "cranes_tried-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: cranes-tried\nVersion: 1.0\n")
    lines = f"[{GROUP}]\ncrane = cranes_tried:crane\nlost = cranes_tried:lost\nabsent = cranes_absent:crane\n"
    (info / "entry_points.txt").write_text(lines)
    monkeypatch.syspath_prepend(tmp_path)
    offered.cache_clear()
    yield
    sys.modules.pop("cranes_tried", None)
    offered.cache_clear()


def test_what_a_package_offers_is_listed_first_and_imported_when_it_is_asked_for(package):
    found = offered(GROUP)
    assert set(found) == {"crane", "lost", "absent"} and "cranes_tried" not in sys.modules
    assert loaded(found["crane"], "plant 'crane'") == 7 and "cranes_tried" in sys.modules
    assert offered("pliant.nothing") == {}


@pytest.mark.parametrize(("name", "why"), [("lost", "has no attribute 'lost'"), ("absent", "No module named")])
def test_what_cannot_be_had_is_told_with_its_package_and_the_reason(package, name, why):
    with pytest.raises(ValueError, match=rf"scene 'x' of package 'cranes-tried' cannot be had: .*{why}"):
        loaded(offered(GROUP)[name], "scene 'x'")


@pytest.mark.parametrize(
    "package",
    ["plants", "controllers", "studies", "studies.figures", "studies.fidelity", "studies.charts", "studies.stability"],
)
def test_what_a_package_offers_is_what_type_checkers_are_told(package):
    place = importlib.import_module(f"pliant.{package}")
    (block,) = [n for n in ast.parse(inspect.getsource(place)).body if isinstance(n, ast.If) and "TYPE" in ast.dump(n)]
    told = {
        alias.asname or alias.name: ("." * part.level + (part.module or ""), alias.name)
        for part in block.body
        for alias in part.names
    }
    assert set(place.__all__) <= set(told) and set(told) <= set(dir(place))
    for name, (module, inner) in told.items():
        found = importlib.import_module(module, place.__name__)
        own = getattr(found, inner, None)
        own = importlib.import_module(f"{module}.{inner}") if own is None else own
        vars(place).pop(name, None)  # what an old name of a module may have put there
        assert getattr(place, name) is own


def test_a_room_does_not_take_the_place_of_a_name():
    code = (
        "import pliant.studies.report.page, pliant.studies.scoreboard.tables; from pliant.studies import report, "
        "scoreboard; import pliant.studies as all; print(callable(report), callable(scoreboard), all.report is report)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    assert done.stdout.split() == ["True"] * 3, done.stdout + done.stderr


def test_a_name_that_is_not_offered_is_no_attribute():
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = pliant.studies.nothing
