import pytest


@pytest.fixture(autouse=True)
def _balls():
    pytest.importorskip("flint", reason="python-flint is an extra: pip install pliant[rigorous]")
