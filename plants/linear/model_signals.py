"""The signals of a linear model, of one point or along a motion: their names, and how many its matrices must fit."""

from __future__ import annotations

from pliant.plants.core.signals import Signal, as_signals, names

KINDS = ("states", "inputs", "disturbances", "outputs")


class ModelSignals:
    """Base of `LinearModel` and `LTVModel`, whose fields the four tuples are."""

    states: tuple[Signal, ...]
    inputs: tuple[Signal, ...]
    disturbances: tuple[Signal, ...]
    outputs: tuple[Signal, ...]

    def _matrix_shapes(self) -> dict[str, tuple[int, int]]:
        """Shapes of A, B, E, C, D, F at one point."""
        nx, nu, nw, ny = (len(getattr(self, kind)) for kind in KINDS)
        return {"A": (nx, nx), "B": (nx, nu), "E": (nx, nw), "C": (ny, nx), "D": (ny, nu), "F": (ny, nw)}

    def _check_signals(self) -> None:
        """ValueError unless the signals of each kind are named, each name once."""
        for kind in KINDS:
            signals = getattr(self, kind)
            object.__setattr__(self, kind, as_signals(f"{type(self).__name__}.{kind}", signals, len(signals), ""))

    @property
    def state_names(self) -> tuple[str, ...]:
        return names(self.states)

    @property
    def input_names(self) -> tuple[str, ...]:
        return names(self.inputs)

    @property
    def disturbance_names(self) -> tuple[str, ...]:
        return names(self.disturbances)

    @property
    def output_names(self) -> tuple[str, ...]:
        return names(self.outputs)
