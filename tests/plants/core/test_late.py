"""A module that is imported late is imported by its first use, and is then the module itself."""

import copy
import pickle
import subprocess
import sys

import pytest

from pliant.plants.core.late import Late


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
