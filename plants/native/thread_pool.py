"""Slices of a batch on several threads: a small pool in C whose workers wait awake for a moment before they sleep.

A batch takes a fraction of a millisecond, and waking a sleeping thread takes a good part of that; a worker therefore
spins for about 50 microseconds after its last slice. Where nothing compiles, Python's thread pool serves.
"""

from __future__ import annotations

import ctypes
import os
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from typing import Any

from pliant.plants.toolchain import shared_library

from . import compiler, kernel_cache

SOURCE = """
#include <pthread.h>
#include <stdatomic.h>
#include <unistd.h>
#if defined(__x86_64__)
#define PAUSE __builtin_ia32_pause()
#else
#define PAUSE ((void)0)
#endif
#define MOST 64
#define SPINS 2000
typedef void (*run_t)(long, long, long, const void *, void *, const double *, long);
typedef struct { run_t run; long first, last, ld, n; const void *in; void *out; const double *s; } job_t;
typedef struct { pthread_t thread; atomic_int state; job_t job; pthread_mutex_t lock; pthread_cond_t wake; } worker_t;
static worker_t workers[MOST];
static int made = 0;
static pid_t owner = 0;
enum { IDLE, READY, ASLEEP };

static void *work(void *argument) {
  worker_t *w = argument;
  for (;;) {
    int spins = 0;
    while (atomic_load_explicit(&w->state, memory_order_acquire) != READY) {
      if (++spins < SPINS) { PAUSE; continue; }
      int idle = IDLE;
      pthread_mutex_lock(&w->lock);
      if (atomic_compare_exchange_strong(&w->state, &idle, ASLEEP))
        while (atomic_load(&w->state) == ASLEEP) pthread_cond_wait(&w->wake, &w->lock);
      pthread_mutex_unlock(&w->lock);
    }
    job_t j = w->job;
    j.run(j.first, j.last, j.ld, j.in, j.out, j.s, j.n);
    atomic_store_explicit(&w->state, IDLE, memory_order_release);
  }
  return 0;
}

static void hire(int wanted) {
  if (owner != getpid()) { made = 0; owner = getpid(); }  /* a forked child has none of its parent's threads */
  for (; made < wanted && made < MOST; made++) {
    worker_t *w = &workers[made];
    atomic_store(&w->state, IDLE);
    pthread_mutex_init(&w->lock, 0);
    pthread_cond_init(&w->wake, 0);
    if (pthread_create(&w->thread, 0, work, w)) return;
    pthread_detach(w->thread);
  }
}

/* Slices of `share` lanes: the last ones to the workers, the first to the caller. Not for two callers at once. */
void spread(run_t run, long share, long ld, const void *in, void *out, const double *s, long n) {
  int slices = (int)((ld + share - 1) / share);
  hire(slices - 1);
  int given = slices - 1 < made ? slices - 1 : made;
  for (int k = 0; k < given; k++) {
    long first = (slices - 1 - k) * share;
    job_t job = {run, first, first + share < ld ? first + share : ld, ld, n, in, out, s};
    worker_t *w = &workers[k];
    w->job = job;
    if (atomic_exchange(&w->state, READY) == ASLEEP) {
      pthread_mutex_lock(&w->lock);
      pthread_cond_signal(&w->wake);
      pthread_mutex_unlock(&w->lock);
    }
  }
  run(0, (slices - given) * share < ld ? (slices - given) * share : ld, ld, in, out, s, n);
  for (int k = 0; k < given; k++)
    for (long spins = 0; atomic_load_explicit(&workers[k].state, memory_order_acquire) == READY; spins++)
      if (spins < 100000) PAUSE; else usleep(20);
}
"""


@lru_cache(maxsize=1)
def spreader() -> Any:
    """The compiled `spread`; None where it cannot be built."""
    try:
        tools = compiler.toolchain()
        name = f"threads-{compiler.digest(SOURCE, tools)}.so"
        spread = kernel_cache.kept(
            name,
            lambda: compiler.build(SOURCE, ("-pthread",)),
            lambda path: shared_library.functions(path, "spread")[0],
        )
    except (compiler.CompileError, kernel_cache.CacheError, OSError):
        return None  # the pool is a convenience: kernel_loader.load has told why nothing compiles
    pointer = ctypes.c_void_p
    spread.argtypes = [pointer, ctypes.c_long, ctypes.c_long, pointer, pointer, pointer, ctypes.c_long]
    spread.restype = None
    return spread


@lru_cache(maxsize=4)
def pool(threads: int) -> ThreadPoolExecutor:
    """Python's thread pool."""
    return ThreadPoolExecutor(threads, thread_name_prefix="pliant-kernel")


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=pool.cache_clear)


def available() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
