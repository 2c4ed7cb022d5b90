"""The processor's own measured peak of fused multiply-adds, one thread, double: what absolute figures are measured by.

Compiled by the toolchain that compiles Pliant's kernels, with its vector width. Twelve independent vectors keep both
units of a core busy (two units, latency of four cycles: eight would do).
"""

from __future__ import annotations

import ctypes
import tempfile
from collections.abc import Iterator
from pathlib import Path

from harness.sampling import Case, Sampler, clock

from pliant.plants.native import compiler

GROUP, PEAK, UNIT = "machine", "fused multiply-adds, double, one thread", "FMA/s"
REFERENCE = 48e9  # FMA/s: a core of 3 GHz with two AVX-512 units, the kind of machine for which the figures were asked
CHAINS = 12
CODE = """
typedef double V __attribute__((vector_size(%d)));
double peak(long n, double m, double c) {
  %s
  for (long i = 0; i < n; i++) { %s }
  V s = %s;
  double sum = 0.0;
  for (int k = 0; k < %d; k++) sum += s[k];
  return sum;
}
"""


def source(width: int) -> str:
    """C for vectors of `width` bits."""
    chains = range(CHAINS)
    return CODE % (
        width // 8,
        " ".join(f"V a{k} = {{0}}; a{k} += {k + 1}.0;" for k in chains),
        " ".join(f"a{k} = a{k} * m + c;" for k in chains),
        " + ".join(f"a{k}" for k in chains),
        width // 64,
    )


def sampler() -> Sampler:
    """Fused multiply-adds a second. Each chain tends to c / (1 - m), so that the sum can be checked."""
    width = compiler.toolchain().width
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "peak.so")
        path.write_bytes(compiler.build(source(width), ("-ffp-contract=fast",)))
        library = ctypes.CDLL(str(path))
    library.peak.restype = ctypes.c_double
    library.peak.argtypes = ctypes.c_long, ctypes.c_double, ctypes.c_double
    count, lanes = 200_000, CHAINS * width // 64

    def sample(seconds: float) -> float:
        done, begin = 0, clock()
        while (spent := clock() - begin) < seconds:
            found = library.peak(count, 0.5, 1.0)
            if abs(found - 2.0 * lanes) > 1e-9 * lanes:
                raise FloatingPointError(f"the sum of the chains is {found}, not {2.0 * lanes}")
            done += count * lanes
        return done / spent

    sample(1e-3)
    return sample


def cases() -> Iterator[Case]:
    """One row; a machine without a compiler has none."""
    yield Case(group=GROUP, name=PEAK, unit=UNIT, prepare=sampler, peer=True)
