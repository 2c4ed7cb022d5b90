"""Results of every call, whatever the backend, and the package that one lacks named."""

import sys

import pytest

from pliant.studies.common.parallel import as_they_come

TASKS = [(k, 2) for k in range(5)]


@pytest.mark.parametrize("backend", ("sequential", "threading"))
def test_all_results_come(backend):
    assert sorted(as_they_come("squares", pow, TASKS, 2, backend)) == [0, 1, 4, 9, 16]


@pytest.mark.parametrize(("backend", "package"), (("ray", "ray.util.joblib"), ("dask", "distributed")))
def test_the_missing_package_is_named(monkeypatch, backend, package):
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(ImportError, match=rf"squares\.backend = '{backend}' needs {backend}: pip install"):
        list(as_they_come("squares", pow, TASKS, 1, backend))
