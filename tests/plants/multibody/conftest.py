"""Where the URDF files of other packages stand."""

import os
import sys
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def robots():
    """The folder of example-robot-data's URDF files."""
    pytest.importorskip("pinocchio", reason="the extra `robots` is not installed: pip install pin")
    places = [
        Path(p) / "cmeel.prefix/share/example-robot-data/robots" for p in (*sys.path, os.environ.get("ROBOTS", ""))
    ]
    found = next((p for p in places if p.is_dir()), None)
    if found is None:
        pytest.skip("the extra `robots` is not installed: pip install example-robot-data")
    return found
