"""Results of every call, whatever the backend, and the package that one lacks named."""

import sys

import pytest

from pliant.studies.common.parallel import as_they_come

TASKS = [(k, 2) for k in range(5)]


@pytest.mark.parametrize("backend", ("sequential", "threading"))
def test_all_results_come(backend):
    assert sorted(as_they_come("squares", pow, TASKS, 2, backend)) == [0, 1, 4, 9, 16]


def test_results_of_one_process_come_one_by_one():
    seen = []
    coming = as_they_come("squares", lambda k: seen.append(k) or k, [(k,) for k in range(3)], 1, "sequential")
    assert next(coming) == 0 and seen == [0]


@pytest.mark.parametrize(("backend", "package"), (("ray", "ray.util.joblib"), ("dask", "distributed")))
def test_the_missing_package_is_named(monkeypatch, backend, package):
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(ImportError, match=rf"squares\.backend = '{backend}' needs {backend}: pip install"):
        list(as_they_come("squares", pow, TASKS, 1, backend))
