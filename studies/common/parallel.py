"""Many calls at once through joblib, on this machine or, by the same call, on a cluster.

`backend` is joblib's: "loky" and "threading" need nothing, "dask" and "ray" their packages.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

BACKENDS = ("loky", "threading", "multiprocessing", "sequential", "dask", "ray")


def as_they_come(
    owner: str, call: Callable[..., Any], arguments: Sequence[tuple[Any, ...]], jobs: int, backend: str
) -> Iterator[Any]:
    """Results as they come, where the backend can hand them over one by one; `owner` is named where it cannot run.

    Example
    -------
    >>> sorted(as_they_come("squares", pow, [(k, 2) for k in range(4)], 2, "threading"))
    [0, 1, 4, 9]
    """
    import joblib

    if backend == "ray":
        try:
            from ray.util.joblib import register_ray
        except ImportError as error:
            raise ImportError(f"{owner}.backend = 'ray' needs ray: pip install pliant[ray]") from error
        register_ray()
    if backend == "dask":
        try:
            import distributed  # noqa: F401  joblib registers its backend with it
        except ImportError as error:
            raise ImportError(f"{owner}.backend = 'dask' needs dask: pip install pliant[dask]") from error
    if backend == "sequential":  # joblib's keeps all results until the last
        yield from (call(*given) for given in arguments)
        return
    settings: dict[str, Any] = {"inner_max_num_threads": 1} if backend == "loky" else {}
    with joblib.parallel_config(backend=backend, n_jobs=jobs, **settings):
        tasks = [joblib.delayed(call)(*given) for given in arguments]
        running, _ = joblib.parallel.get_active_backend()
        by_one = getattr(running, "supports_return_generator", False)
        pool = joblib.Parallel(return_as="generator_unordered" if by_one else "list", batch_size=1)
        yield from pool(tasks)
