"""A motion and all that is seen on it in one native call: steps, rates and outputs at every row, step limit, ranges.

One small C program serves every plant: it is told where the plant's compiled functions are. It judges nothing. What is
not plainly sound (a number that is not finite or huge, a range that is left, a step that may be near its limit) it
says, and whoever asked has it looked at. Its arrays are laid out once, for one grid of times and steps.
"""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pliant.plants.native.compiler import CompileError
from pliant.plants.native.kernel_loader import Kernel
from pliant.plants.rows.tape_programs import Program
from pliant.plants.toolchain import shared_library

Array = np.ndarray
LONG, DOUBLE, ADDRESS = np.dtype(ctypes.c_long), np.dtype(float), np.dtype(np.uintp)
ODD, NEAR, LEFT = 1, 2, 4  # bits of what a call gives: something odd; a step maybe near its limit; a range left
PRICE = 0.25  # [s] to compile the C
LARGE = 1e100  # numbers are smaller: sums of their squares are finite

SOURCE = """
#include <limits.h>
#include <math.h>
typedef const double *in_t;
typedef double *out_t;
typedef long (*motion_t)(long, long, in_t, const long *, in_t, long, in_t, in_t, out_t, long *);
typedef void (*rows_t)(long, long, long, const in_t *, const out_t *, in_t, long);

static int plain(in_t v, long n) {
  int fine = 1;
  for (long i = 0; i < n; i++) fine &= fabs(v[i]) < LARGE;
  return fine;
}
/* A function of (t, x, u, w, p), n[k] numbers each, at `count` rows, `every` of a motion, on `ld` lanes: those beyond
   the rows do row 0 again. lanes: where its inputs stand, then its outputs. w and p are the same for all. */
static void seen(rows_t function, const long *n, const in_t *given, long count, long every, long ld,
                 const out_t *lanes) {
  for (int a = 0; a < 5; a++)
    for (long r = 0; r < ld; r++) {
      const in_t from = given[a] + (a < 3 && r < count ? r * every * n[a] : 0);
      for (long k = 0; k < n[a]; k++) lanes[a][k * ld + r] = from[k];
    }
  function(0, ld, ld, (const in_t *)lanes, lanes + 5, 0, 1);
}
static void product(in_t A, in_t B, long m, out_t C) {
  for (long i = 0; i < m; i++) {
    for (long j = 0; j < m; j++) C[i * m + j] = 0;
    for (long k = 0; k < m; k++) {
      const double a = A[i * m + k];
      if (a != 0) for (long j = 0; j < m; j++) C[i * m + j] += a * B[k * m + j];
    }
  }
}
/* max(a, d) + sqrt(b c) of the norms of the four blocks: no less than the spectral radius */
static double of_blocks(in_t A, long m) {
  double sum[2][2] = {{0, 0}, {0, 0}};
  const long half = m / 2;
  for (long i = 0; i < m; i++)
    for (long j = 0; j < m; j++) sum[i >= half][j >= half] += A[i * m + j] * A[i * m + j];
  return sqrt(fmax(sum[0][0], sum[1][1])) + sqrt(sqrt(sum[0][1]) * sqrt(sum[1][0]));
}
/* As step_maps.at_most has it: whether h times the spectral radius is for sure within a bound. */
static int is_within(in_t A, long m, double h, double bound, double rounded, out_t scratch) {
  const out_t squared = scratch, fourth = scratch + m * m;
  product(A, A, m, squared);
  product(squared, squared, m, fourth);
  const double size = of_blocks(A, m);
  return h * sqrt(sqrt(of_blocks(fourth, m) + rounded * (size * size) * (size * size))) <= bound;
}
/* n: sizes of t, x, u, w, p; rows, lanes of them, results of the observer, how many of its last one are ranges, rows
   whose step is looked at, how far apart, lanes of them; sizes of the results */
long play(const long *n, const double *s, void *const *a) {
  const long nx = n[1], rows = n[5], ld = n[6], results = n[7], ranges = n[8], looks = n[9];
  const in_t *given = (const in_t *)(a + 3);
  const out_t x = a[4], *lanes = (const out_t *)a[10], *told = (const out_t *)a[12], scratch = a[15];
  const in_t limits = a[13], steps = a[14];
  long *at = a[9], said = 0;
  at[0] = at[1] = 0;
  if (!plain(x, nx) || !plain(given[2], rows * n[2]) || !plain(given[3], n[3]) || !plain(given[4], n[4])) return 1;
  if (((motion_t)a[0])(rows - 1, LONG_MAX, given[0], a[8], given[2], 0, given[3], given[4], x, at)) return 1;
  if (at[0] != rows - 1 || !plain(x, rows * nx)) return 1;
  seen((rows_t)a[1], n, given, rows, 1, ld, lanes);
  for (long g = 0; g < results; g++) {
    const in_t from = lanes[5 + g];
    const long m = n[12 + g], judged = ranges && g == results - 1;
    for (long k = 0; k < m; k++)
      for (long r = 0; r < rows; r++) {
        const double value = from[k * ld + r];
        if (!(fabs(value) < LARGE)) return 1;
        if (judged && value > limits[k]) said = 4;
        told[g][r * m + k] = value;
      }
  }
  if (!looks) return said;
  const out_t *slopes = (const out_t *)a[11], A = scratch + 2 * nx * nx;
  seen((rows_t)a[2], n, given, looks, n[10], n[11], slopes);
  for (long r = 0; r < looks; r++) {
    for (long k = 0; k < nx * nx; k++) A[k] = slopes[5][k * n[11] + r];
    if (!plain(A, nx * nx)) return 1;
    if (!is_within(A, nx, steps[r], s[0], s[1], scratch)) return said | 2;
  }
  return said;
}
"""


def _load(path: Path) -> Any:
    (run,) = shared_library.functions(path, "play")
    run.argtypes, run.restype = [ctypes.c_void_p] * 3, ctypes.c_long
    return run


class PlayedMotion:
    """A motion by fixed steps from x (nx,) under inputs held over periods, on arrays of its own."""

    def __init__(
        self,
        run: Any,
        functions: tuple[Any, Kernel, Kernel | None],
        sizes: Sequence[int],
        results: Sequence[int],
        grid: tuple[Array, Array],
        limits: Array,
        looked_at: tuple[Array, float, float],
    ) -> None:
        """functions: of the motion, of what is seen on it, of its slopes; sizes of x, u, w, p and of the `results`
        that are seen, the last of which has the `limits` of ranges where there are some; grid (t, counts);
        looked_at: (rows, evenly apart; how large step times eigenvalue may be; what rounding is).
        """
        self.t, counts = grid
        looks, bound, rounded = looked_at
        motion, observer, slopes = functions
        nx, nu, nw, np_ = sizes
        rows, n = len(self.t), (1, *sizes)
        self.x, self.u = np.zeros((rows, nx)), np.zeros((rows, nu))
        self.w, self.p = np.zeros(nw), np.zeros(np_)
        self.results = [np.zeros((rows, m)) for m in results]
        self.steps = int(counts.sum())
        self.lock = threading.Lock()
        own = (self.t, self.x, self.u, self.w, self.p)
        every = int(looks[1] - looks[0]) if len(looks) > 1 else 1
        steps = (self.t[looks + 1] - self.t[looks]) / counts[looks]
        lanes, ld = _lanes([*n, *results], rows, observer.lanes)
        slope_lanes, lds = _lanes([*n, nx * nx], len(looks), slopes.lanes if slopes else 1)
        places = [_places(lanes), _places(slope_lanes), _places(self.results)]
        at, scratch = np.zeros(2, dtype=LONG), np.zeros(3 * nx * nx)
        kinds = (len(results), len(limits), len(looks), every, lds)
        self._n = np.array([*n, rows, ld, *kinds, *results], dtype=LONG)
        self._s = np.array([bound, rounded * nx])
        code = [_place_of(f) for f in (motion, observer._run, slopes._run if slopes else None)]
        arrays = [*own, np.ascontiguousarray(counts, dtype=LONG), at, *places, limits, steps, scratch]
        self._a = np.array([*code, *(array.ctypes.data for array in arrays)], dtype=ADDRESS)
        self._kept = functions, arrays, lanes, slope_lanes
        self._run, self._given = run, tuple(array.ctypes.data for array in (self._n, self._s, self._a))

    def play(self) -> int:
        """From x[0] under u, w, p, which the caller has set, to all rows of x and of the results; 0, or the bits of
        what has to be looked at; after ODD they are not to be trusted.
        """
        return int(self._run(*self._given))


def _place_of(function: Any) -> int:
    """Where a C function begins."""
    return ctypes.cast(function, ctypes.c_void_p).value or 0


def _lanes(sizes: Sequence[int], count: int, width: int) -> tuple[list[Array], int]:
    ld = max(1, -(-count // width)) * width
    return [np.zeros((max(1, n), ld)) for n in sizes], ld


def _places(arrays: Sequence[Array]) -> Array:
    return np.array([array.ctypes.data for array in arrays], dtype=ADDRESS)


def _check(run: Any) -> None:
    """That a body at rest under two functions of known numbers goes as it does; CompileError."""
    count, pointer = ctypes.c_long, ctypes.c_void_p
    numbers = ctypes.POINTER(ctypes.c_double)

    @ctypes.CFUNCTYPE(count, count, count, numbers, pointer, numbers, count, *[numbers] * 3, ctypes.POINTER(count))
    def motion(last: int, most: int, t: Any, counts: int, u: Any, ahead: int, w: Any, p: Any, x: Any, at: Any) -> int:
        for k in range(last):
            x[k + 1] = x[k] + u[k] * (t[k + 1] - t[k])
        at[0] = last
        return 0

    @ctypes.CFUNCTYPE(None, count, count, count, ctypes.POINTER(numbers), ctypes.POINTER(numbers), pointer, count)
    def doubled(first: int, last: int, ld: int, given: Any, out: Any, s: int, n: int) -> None:
        for r in range(ld):
            out[0][r] = 2 * given[1][r]

    class Written:
        lanes, _run = 2, doubled

    def played(at_most: float, start: float) -> tuple[int, list[float]]:
        written: Any = Written()
        t, looked_at = np.array([0.0, 1.0, 3.0]), (np.array([0, 1]), at_most, 0.0)
        grid = t, np.ones(2, dtype=LONG)
        motion_of = PlayedMotion(run, (motion, written, written), (1, 1, 0, 0), (1,), grid, np.zeros(0), looked_at)
        motion_of.x[0], motion_of.u[:] = start, [[1.0], [2.0], [0.0]]
        return motion_of.play(), motion_of.results[0].ravel().tolist()

    right = played(100.0, 1.0) == (0, [2.0, 4.0, 12.0]) and played(3.0, 1.0)[0] == NEAR
    if not right or played(100.0, np.inf)[0] != ODD:
        raise CompileError("a body that is driven at a known speed goes elsewhere")


program = Program("played", lambda: f"#define LARGE {LARGE!r}\n{SOURCE}", _load, _check, PRICE)
