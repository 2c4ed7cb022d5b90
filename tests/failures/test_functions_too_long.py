"""A right-hand side too long for one C function.

Naive: its values in a table of their own, a row each, cut wherever it is long enough. The table outgrows every cache
near the core, and a part that is given a row which it still reads computes nonsense. Pliant: a row is free again after
the last part that reads it, and `require_agreement` refuses what is written otherwise.
"""

import casadi as ca
import numpy as np
import pytest

from pliant.plants import LargeDeflectionBeam
from pliant.plants.integration.batch_stepper import rate_function
from pliant.plants.native import kernel_loader, scalar_codegen
from pliant.plants.native.batch_kernels import map_kernel
from pliant.plants.toolchain import straight_line

LINE = 64  # bytes of a row of 8 lanes


def _parts(function: ca.Function, most: int) -> list[list[straight_line.Statement]]:
    statements, _ = scalar_codegen._statements("f", function)
    return [statements[k : k + most] for k in range(0, len(statements), most)]


def test_a_row_each_outgrows_the_cache_that_rows_used_again_fit() -> None:
    beam = LargeDeflectionBeam.textbook()
    parts = _parts(rate_function(beam), straight_line.LENGTHENED)
    naive = sum(not s.given and bool(s.name) for part in parts for s in part)
    rows, total = straight_line._rows(parts)
    assert naive * LINE > 32_768  # the first cache of most processors
    assert total <= len(rows) and total * LINE < 0.2 * naive * LINE


@pytest.mark.skipif(not kernel_loader.wanted(), reason="PLIANT_NATIVE=0: nothing is compiled")
def test_a_row_given_away_too_early_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    x, values = ca.SX.sym("x", 4), []
    for k in range(40):
        values.append(ca.sin(x[k % 4] + 0.1 * k))
    late = sum(values[k] * values[-1 - k] for k in range(20))
    function = ca.Function("late", [x], [ca.vertcat(late, *values[::7])])
    points = [np.random.default_rng(1).uniform(-1.0, 1.0, (4, 64))]
    monkeypatch.setattr(straight_line, "LENGTHENED", 11)
    assert map_kernel(function, points).native
    sound = straight_line._rows

    def too_early(parts):
        rows, total = sound(parts)
        return {name: row % max(1, total // 2) for name, row in rows.items()}, total

    monkeypatch.setattr(straight_line, "_rows", too_early)
    monkeypatch.setattr(kernel_loader, "_told", set())
    with pytest.warns(kernel_loader.NativeWarning, match="disagrees with the virtual machine"):
        assert not map_kernel(function, points).native
