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
from pliant.plants.rounding.agreement import KernelMismatch, Trial, of_function, require_agreement

from . import compiler, kernel_cache, kernel_loader
from .compiler import CompileError

PLAIN = ("-O0", "-fno-fast-math", "-ffp-contract=off")  # after the kernels' own flags, so that they win
SCALES = (1.0, 1e-2, 1e-4)  # of the points at which a compiled function is compared, in turn
POINTS = 8
SLOWER = "4 to 6 times slower"
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
    name = f"the function {function.name()!r} of {function.n_instructions()} operations at one point"
    try:
        with kernel_loader.generating:
            writer = ca.CodeGenerator("point")
            writer.add(function)
            source = writer.dump()
            key = compiler.digest(source, compiler.toolchain())
            if key not in _made:
                _made[key] = kernel_cache.kept(
                    f"point-{key}.so",
                    lambda: compiler.build(source, PLAIN),
                    lambda path: _load(function.name(), path),
                    lambda path: check(_load(function.name(), path), function, name),
                )
            return _made[key]
    except compiler.NoCompiler as missing:
        kernel_loader.tell(str(missing), name, every=True, slower=SLOWER)
    except (CompileError, NotImplementedError, kernel_cache.CacheError, KernelMismatch, OSError) as failure:
        kernel_loader.tell(str(failure), name, slower=SLOWER)
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


def check(made: ca.Function, function: ca.Function, name: str) -> tuple[float, float]:
    """Largest error at a point and over the points of a sound function, in what rounding explains; or KernelMismatch.

    At points by chance, in turn closer to zero, where a function may be finite alone.
    """

    def draw(rng: np.random.Generator) -> list[np.ndarray]:
        scales = np.resize(SCALES, POINTS * len(SCALES))
        return [scales * rng.uniform(0.1, 1.0, (function.numel_in(i), len(scales))) for i in range(function.n_in())]

    def run(trial: Trial, inputs: list[np.ndarray], results: list[np.ndarray]) -> None:
        for lane in range(inputs[0].shape[1]):
            point = [a[:, lane].reshape(function.size_in(i), order="F") for i, a in enumerate(inputs)]
            for out, found in zip(results, made.call(point)):
                out[:, lane] = np.array(found).ravel(order="F")

    return require_agreement(run, [Trial(of_function(function), draw)], np.dtype(float), POINTS, name)
