"""A scene's motion by linear models of a variant: along the motion of a simpler one, or about the start.

ltv      The cheapest variant's motion under the smooth nominal inputs, in the variant's states; what it lacks of being
         a motion of the variant drives the model along it, and so does what inputs held differ by, its mean over each
         control period.
linear   About the start, where that is an equilibrium; exact for inputs held.
reduced  The same with half the states, the slowest modes kept.
"""

from __future__ import annotations

import time as clock
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from pliant.plants import LinearModel, Plant, PliantError, Trajectory, ValidityWarning
from pliant.plants.core.signals import GAUSS
from pliant.plants.linear import modal_analysis
from pliant.plants.motions.tabulated_inputs import tabulated
from pliant.studies.common import operating_point
from pliant.studies.common.reference_motions import Motions
from pliant.studies.physics.fine_model import compared

Array = np.ndarray
RTOL = 1e-8  # of the nominal
ALIKE = 0.1  # of the range of an output: what a nominal may differ by in the variant's states, before it is none
SAME = 1e-12  # of the largest state


class NoLinearModel(PliantError):
    """Why a variant has no such linear model of this motion."""


@dataclass(frozen=True, eq=False)
class LinearRun:
    """play() gives the compared outputs (nt, n); `made` [s] is what the model took; its states.

    rms_bound [unit of the outputs]: of a reduced model, what their root mean square over the motion can differ by at
    most from the linear model with all states, known before either is played.
    """

    play: Callable[[], Array]
    made: float
    states: int
    rms_bound: float | None = None


def simplifies(motions: Motions, plant: Plant, kind: str) -> bool:
    """Whether there is anything that "ltv", "linear" or "reduced" makes simpler."""
    cheapest = motions.ladder[0]
    return {"ltv": plant != cheapest, "reduced": plant.nx > cheapest.nx}.get(kind, True)


def linear_run(motions: Motions, plant: Plant, kind: str, apart: float | None = None) -> LinearRun:
    """ "ltv", with nodes `apart` [s], "linear" or "reduced". NoLinearModel says why there is none."""
    if kind == "ltv":
        return _along(motions, plant, 1 if apart is None else round(motions.scene.dt / apart))
    return _about_start(motions, plant, kind == "reduced")


def _along(motions: Motions, plant: Plant, parts: int) -> LinearRun:
    """Nodes at every `parts`-th part of a control period."""
    scene, simple, columns = motions.scene, motions.ladder[0], compared(motions, plant)
    began = clock.perf_counter()
    smooth, nodes = tabulated(scene.nominal_input), scene.dt / parts * np.arange(parts * scene.steps + 1)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ValidityWarning)  # the chart tells it of the variant
        own = simple.simulate(motions.start(simple), smooth, nodes, rtol=RTOL, atol=RTOL / 100)
    E, dx = plant.embedding(simple), own.derivative()
    unused = np.zeros((len(own.t), plant.ny))
    nominal = Trajectory.from_arrays(own.t, own.x @ E.T, own.u, plant=plant, y=unused, dx=dx @ E.T)
    model = plant.linearize_along(nominal)
    apart = np.abs(model.y[:, columns] - motions.compared(own)).max()
    if not apart <= ALIKE * max(np.ptp(motions.compared(own), axis=0).max(), scene.tolerance):
        raise NoLinearModel(f"no linear model: the motion of {simple.label} has no like in the states of this variant")
    off = motions.start(plant) - nominal.x[0]
    at_rest = np.abs(off).max() <= SAME * max(np.abs(nominal.x[0]).max(), 1.0)
    if len(model.states) != plant.nx and not at_rest:
        raise NoLinearModel("no linear model: it does not start where the nominal does")
    start = np.zeros(len(model.states)) if at_rest else off
    if not at_rest and [s.name for s in model.states] != [s.name for s in plant.states]:
        raise NoLinearModel("no linear model: it does not start where the nominal does")
    push = _left_by_the_mean(np.repeat(motions.held[:-1], parts, axis=0), nodes, smooth)
    model.discretize()
    made = clock.perf_counter() - began

    def play() -> Array:
        return (model.y + model.simulate(start, push)[1])[::parts, columns]

    return LinearRun(play, made, len(model.states))


def _left_by_the_mean(held: Array, times: Array, smooth: Callable[[float], Array]) -> Array:
    """Input held (nt - 1, nu) less the mean of the smooth one from each of the times (nt,) to the next, (nt, nu)."""
    at = times[:-1, None] + np.diff(times)[:, None] * GAUSS
    mean = np.array([[smooth(float(t)) for t in pair] for pair in at]).mean(axis=1)
    return np.vstack([held - mean, np.zeros((1, held.shape[1]))])


def _about_start(motions: Motions, plant: Plant, half: bool) -> LinearRun:
    scene, columns = motions.scene, compared(motions, plant)
    began = clock.perf_counter()
    x0, u0 = scene.with_plant(plant).initial
    model = plant.linearize(x0, u0)
    left = operating_point.residual(model)
    if left:
        raise NoLinearModel(f"no linear model: the start is no equilibrium, {left}")
    du, bound = motions.held - u0, None
    if half:
        gain, model = _halved(model, columns)
        bound = gain * float(np.linalg.norm(du[:-1])) / np.sqrt(scene.steps) if np.isfinite(gain) else None
    zero, at_start = np.zeros(len(model.states)), model.y0[columns]
    made = clock.perf_counter() - began

    def play() -> Array:
        return at_start + model.simulate(zero, du, scene.times)[1][:, columns]

    return LinearRun(play, made, len(model.states), bound)


def _halved(model: LinearModel, columns: Sequence[int]) -> tuple[float, LinearModel]:
    """The model, and by how much the gain from its inputs to the compared outputs is off at any frequency.

    No motion's outputs are further off in their L2 norm than as many times its inputs': Antoulas, Approximation of
    Large-Scale Dynamical Systems, section 5.1.
    """
    order = 2 * -(-len(model.states) // 4)
    try:
        *_, gain = modal_analysis.truncation(model.A, model.B, model.C[columns], order, "modal", None)
        return gain, model.reduce(order, "modal")
    except ValueError as reason:
        raise NoLinearModel(f"no linear model: {reason}") from None
