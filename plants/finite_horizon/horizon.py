"""What a motion that ends allows: how far disturbances and deviations at its start push its outputs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import require_instance, require_mapping, require_names, require_number
from pliant.plants.core.signals import OwnsArrays, Signal, index, names, rows_by_name
from pliant.plants.linear.ltv import LTVModel

from . import reached
from .amplification import Amplification, amplification
from .energy_gain import Gain, energy_gain
from .stretches import Stretches

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Furthest(OwnsArrays):
    """How far disturbances push one output: at least `lower` [its unit], which `disturbance` attains at `time`."""

    output: Signal
    lower: float
    upper: float
    time: float  # [s]
    disturbance: Array = field(repr=False)  # (m + 1, nw) in units of the disturbances, held from each time to the next


@dataclass(frozen=True, eq=False)
class FiniteHorizon(OwnsArrays):
    """Numbers of one motion. Rows of tubes belong to the times t (m + 1,) [s]; columns to `outputs`, in their units.

    Disturbances are sized by `sizes`: of unit energy means that the integral of |w / size|^2 is 1 s, bounded that
    |w| <= size at all times. All are of the linear model: of the plant to first order in the disturbance.
    """

    t: Array = field(repr=False)
    outputs: tuple[Signal, ...]
    disturbances: tuple[Signal, ...]
    sizes: dict[str, float]
    energy: Gain  # from |w / size| to |z / size|, root of their energies
    by_energy: Array = field(repr=False)  # (m + 1, nz) [unit of the output] the most under unit energy so far
    by_bound: Array = field(repr=False)  # (m + 1, nz) the most under |w| <= size
    furthest: tuple[Furthest, ...]  # by unit energy, over the motion, output by output
    furthest_bounded: tuple[Furthest, ...]  # under |w| <= size
    from_start: Array = field(repr=False)  # (m + 1, nz) the most from a start that is off by |x / size| <= 1
    growth: Amplification
    _stretches: Stretches = field(repr=False)

    def deviation(self, intensity: Mapping[str, float], start: Mapping[str, float] | None = None) -> Array:
        """Standard deviations (m + 1, nz) [unit of the output] under white noise and a start that is not known.

        intensity: of disturbances by name, the root of their power spectral density, two-sided [unit sqrt(s)]; start:
        standard deviations of states by name. Those that are not named are zero.

        >>> horizon.deviation({"tip_force": 0.01}, {"theta1": 1e-3})[-1]
        """
        on, known = self._stretches, names(self.disturbances)
        noise = require_mapping("deviation.intensity", intensity, known, "disturbance")
        root = np.array([float(_not_negative("deviation.intensity", n, noise.get(n, 0.0))) for n in known])
        states = names(on.model.states)
        first = require_mapping("deviation.start", {} if start is None else start, states, "state")
        P0 = np.diag([float(_not_negative("deviation.start", n, first.get(n, 0.0))) ** 2 for n in states])
        weights = root / np.array([self.sizes[n] for n in known])
        model = on.model
        into = _columns(model, self.disturbances)[0] * root
        seen = rows_by_name(model, names(self.outputs)).C
        own = Stretches(model, into, seen, np.zeros((*seen.shape[:2], len(weights))), self.outputs)
        W = reached.gramians(own, P0)
        C = own.nodes[2]
        return np.sqrt(np.maximum(np.einsum("kij,kjl,kil->ki", C, W, C), 0.0))

    @property
    def words(self) -> str:
        """One sentence on the output that a disturbance pushes furthest beside its size."""
        bound = [f for f in self.furthest if np.isfinite(f.upper)] or list(self.furthest)
        worst = max(bound, key=lambda f: f.lower / self.sizes[f.output.name])
        pushing = ", ".join(f"{n} {self.sizes[n]:g} {s.unit}" for s in self.disturbances if (n := s.name))
        bounded = next(f for f in self.furthest_bounded if f.output == worst.output)
        return (
            f"Within {self.t[-1] - self.t[0]:g} s a disturbance of unit energy ({pushing}, for one second) moves "
            f"{worst.output.name} by at most {worst.upper:.3g} {worst.output.unit}, at {worst.time:.3g} s; one that "
            f"stays within these sizes by at most {bounded.upper:.3g} {worst.output.unit}. Deviations grow "
            f"{self.growth.value:.3g}-fold at most, from {self.growth.start:.3g} to {self.growth.end:.3g} s."
        )


def finite_horizon(
    model: LTVModel,
    *,
    outputs: Sequence[str] | None = None,
    disturbances: Sequence[str] | None = None,
    scale: Mapping[str, float] | None = None,
) -> FiniteHorizon:
    """How far disturbances and deviations at the start can push the outputs of a motion before it ends.

    outputs: names of outputs or states (None: the model's outputs); disturbances: of disturbances or inputs (None: all
    disturbances). scale: what counts as one, by name, in its unit: tolerances of outputs, expected sizes of
    disturbances and of states' deviations; 1 where it is not given. ValueError for names that the model does not have,
    and where its fastest mode needs more than 40,000 stretches.

    Sources: Green and Limebeer, "Linear Robust Control" (1995), sections 3.7 and 4.3; Seiler, Moore, Meissen, Arcak and
    Packard, "Finite horizon robustness analysis of LTV systems using integral quadratic constraints" (2019).

    Example
    -------
    >>> along = plant.linearize_along(motion)
    >>> horizon = finite_horizon(along, outputs=["tip_x", "tip_y"], disturbances=["tip_force_x", "tip_force_y"])
    >>> print(horizon.words, horizon.energy.lower, horizon.energy.upper)
    """
    model = require_instance("finite_horizon.model", model, LTVModel)
    seen = names(model.outputs) if outputs is None else require_names("finite_horizon.outputs", outputs)
    pushing = (
        model.disturbance_names if disturbances is None else require_names("finite_horizon.disturbances", disturbances)
    )
    if not seen or not pushing:
        word = "outputs" if not seen else "disturbances"
        raise ValueError(f"finite_horizon.{word} = () must name one or more")
    signals = tuple(
        (*model.disturbances, *model.inputs)[index((*model.disturbances, *model.inputs), n, "disturbance or input")]
        for n in pushing
    )
    rows = rows_by_name(model, seen)
    shown = tuple((model.states + model.outputs)[k] for k in rows.at)
    known = {*names(model.states), *names(shown), *names(signals)}
    given = require_mapping("finite_horizon.scale", {} if scale is None else scale, sorted(known), "signal")
    given = {n: require_number(f"finite_horizon.scale[{n!r}]", v, "positive") for n, v in given.items()}
    sizes = {n: float(given.get(n, 1.0)) for n in known}
    size = {
        kind: np.array([sizes[s.name] for s in of]) for kind, of in (("z", shown), ("w", signals), ("x", model.states))
    }
    into, passed = _columns(model, signals)
    direct = np.concatenate([rows.F, rows.D], axis=-1)[..., passed]
    on = Stretches(
        model,
        into * size["w"],
        rows.C / size["z"][:, None],
        direct * size["w"] / size["z"][:, None],
        shown,
    )
    energy = energy_gain(on)
    tube, upper = reached.by_energy(on, reached.gramians(on))
    bounded = reached.by_bounded(on)
    start = _from_start(on, size["x"])
    return FiniteHorizon(
        t=on.t,
        outputs=shown,
        disturbances=signals,
        sizes=sizes,
        energy=energy,
        by_energy=tube * size["z"],
        by_bound=bounded * size["z"],
        furthest=tuple(_by_energy(on, tube, upper, i, size) for i in range(on.nz)),
        furthest_bounded=tuple(_by_bound(on, bounded, i, size) for i in range(on.nz)),
        from_start=start * size["z"],
        growth=amplification(on, size["x"]),
        _stretches=on,
    )


def _columns(model: LTVModel, signals: Sequence[Signal]) -> tuple[Array, list[int]]:
    """[E, B] of the named disturbances and inputs (nt, nx, nw), and where they stand in it."""
    at = [index((*model.disturbances, *model.inputs), s.name, "disturbance or input") for s in signals]
    return np.concatenate([model.E, model.B], axis=-1)[..., at], at


def _by_energy(on: Stretches, tube: Array, upper: Array, row: int, size: Mapping[str, Array]) -> Furthest:
    at = int(tube[:, row].argmax())
    worst, lower = reached.worst_of_energy(on, at, row)
    unit = float(size["z"][row])
    return Furthest(on.named[row], lower * unit, float(upper[:, row].max()) * unit, float(on.t[at]), worst * size["w"])


def _by_bound(on: Stretches, most: Array, row: int, size: Mapping[str, Array]) -> Furthest:
    at = int(most[:, row].argmax())
    worst, lower, upper = reached.worst_bounded(on, at, row)
    unit = float(size["z"][row])
    return Furthest(on.named[row], lower * unit, upper * unit, float(on.t[at]), worst * size["w"])


def _from_start(on: Stretches, sizes: Array) -> Array:
    """|c_i Phi(t, 0) X| at the ends of stretches (m + 1, nz)."""
    Phi, C = on.held[0], on.nodes[2]
    moved, found = np.diag(sizes), np.zeros((len(on.t), on.nz))
    found[0] = np.linalg.norm(C[0] @ moved, axis=1)
    for k in range(len(Phi)):
        moved = Phi[k] @ moved
        found[k + 1] = np.linalg.norm(C[k + 1] @ moved, axis=1)
    return found


def _not_negative(owner: str, name: str, value: Any) -> float:
    return float(require_number(f"{owner}[{name!r}]", value, "nonnegative"))
