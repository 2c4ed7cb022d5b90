"""Threads of kernels: how many may run, one pool a size, none inherited by a fork."""

import os
from threading import Barrier

import pytest

from pliant.plants.native import thread_pool


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="no affinity on this system")
def test_as_many_as_this_process_may_use():
    own = os.sched_getaffinity(0)
    assert thread_pool.available() == len(own)
    try:
        os.sched_setaffinity(0, {min(own)})
        assert thread_pool.available() == 1
    finally:
        os.sched_setaffinity(0, own)


def test_a_pool_runs_that_many_at_once_and_is_kept():
    meet = Barrier(3, timeout=20)  # passes only where three run at once
    found = list(thread_pool.pool(3).map(lambda k: (meet.wait() >= 0, k), range(3)))
    assert found == [(True, 0), (True, 1), (True, 2)]
    assert thread_pool.pool(3) is thread_pool.pool(3)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
@pytest.mark.filterwarnings("ignore:.*multi-threaded.*:DeprecationWarning")
def test_a_forked_process_makes_its_own_pool():
    """Threads do not survive a fork: work given to the parent's pool would never be done."""
    thread_pool.pool(2).submit(int).result(timeout=20)
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        os.write(write, b"%d" % thread_pool.pool(2).submit(lambda: 7).result(timeout=20))
        os._exit(0)
    os.waitpid(child, 0)
    assert os.read(read, 8) == b"7"
