"""Compiled functions of one point, for loops that call the same function many thousand times.

The C that CasADi writes is compiled without any optimisation: that takes a tenth of a second where the virtual machine
has run for as long, and the arithmetic stays the virtual machine's own, operation by operation. It is four to six times
faster; -O1 and -O2 took two to ten times longer to compile and ran no faster (five plants, 324 to 3659 operations).
"""

from __future__ import annotations

from pathlib import Path

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import LONG, NumericFunction

from . import compiler, kernel_cache, kernel_loader
from .compiler import CompileError

PLAIN = ("-O0", "-fno-fast-math", "-ffp-contract=off")  # after the kernels' own flags, so that they win
SCALES = (1.0, 1e-2, 1e-4)  # of the point at which a compiled function is compared
START, PER_OPERATION, SAVED = 0.06, 5e-5, 6e-9  # [s] to compile, for each operation of it, and saved by it a call
_made: dict[str, ca.Function] = {}


def pays_after(function: ca.Function) -> int:
    """Calls after which compiling has cost no more than it saves: whoever waits as long loses at most half."""
    operations = max(1, function.n_instructions())
    return int((START + PER_OPERATION * operations) / (SAVED * operations)) + 1


def compiled(function: ca.Function) -> ca.Function:
    """The same function as native code, from the cache or compiled; itself where that is not to be had."""
    if not kernel_loader.wanted() or function.n_instructions() > LONG:
        return function
    try:
        with kernel_loader.generating:
            writer = ca.CodeGenerator("point")
            writer.add(function)
            source = writer.dump()
            key = compiler.digest(source, compiler.toolchain())
            if key not in _made:
                name = f"point-{key}.so"
                path = kernel_cache.path_of(name)
                if path is None:
                    aside = kernel_cache.write_aside(compiler.build(source, PLAIN))
                    try:
                        _agree(_load(function.name(), aside), function)
                        path = kernel_cache.publish(aside, name)
                    finally:
                        aside.unlink(missing_ok=True)
                _made[key] = _load(function.name(), path)
            return _made[key]
    except (CompileError, kernel_cache.CacheError, kernel_loader.KernelMismatch, OSError) as failure:
        kernel_loader.tell(str(failure))
        return function


class OftenCalled(NumericFunction):
    """A function of one point that is compiled once it has been called so often that this pays."""

    def __init__(self, function: ca.Function) -> None:
        super().__init__(function)
        self._plain = function  # what is pickled: native code belongs to this machine
        self._until = pays_after(function) if function.class_name() == "SXFunction" else -1

    def __call__(self, *values: np.ndarray | float, batch: int | None = None) -> list[np.ndarray]:
        self._until -= 1
        if self._until == 0:
            self._function = compiled(self._function)
            self._local.__dict__.pop("buffers", None)
        return super().__call__(*values, batch=batch)

    def __reduce__(self) -> tuple:
        return OftenCalled, (self._plain,)


def _load(name: str, path: Path) -> ca.Function:
    try:
        return ca.external(name, str(path))
    except RuntimeError as refused:  # CasADi's for all that the loader says
        raise OSError(f"{path.name} cannot be loaded: {str(refused)[:200]}") from refused


def _agree(made: ca.Function, function: ca.Function) -> None:
    """At a point by chance, closer to zero where the function is not finite there."""
    draw = np.random.default_rng(1).uniform
    at = [draw(0.1, 1.0, function.size_in(i)) for i in range(function.n_in())]
    for scale in SCALES:
        point = [scale * values for values in at]
        wanted = [np.array(found) for found in function.call(point)]
        if all(np.isfinite(want).all() for want in wanted):
            break
    for i, (found, want) in enumerate(zip(made.call(point), wanted)):
        have, known = np.array(found), np.isfinite(want)
        worst = np.max(np.abs(have[known] - want[known]) / (1e-9 + np.abs(want[known])), initial=0.0)
        if not worst < 1e-7 or (np.isfinite(have) != known).any():
            raise kernel_loader.KernelMismatch(
                f"a compiled function disagrees with the virtual machine by {worst:.2g} in output {i}; it is not used"
            )
