"""Spillover: a loop designed on a cheap model, closed around dearer ones, without simulation.

Each eigenvalue of the closed loop is followed from where it is without feedback, as the gain is raised from 0 to 1 in
small steps, so that a mode that grows is known by the mode of the plant that it was. It is spillover where the design
model lacks that mode; one that the design model has at another frequency can grow too, above all where sampling folds
the two frequencies apart.

How far the bandwidth must fall is found by closing the loop again: with the controller's output scaled down, or with a
controller redesigned for dearer effort, until all plants are stable with a gain margin in reserve. What holds may be
a window of factors, as where an unstable plant needs a least gain: many are tried, and what is said is said of those.

Source   Balas 1978, "Feedback control of flexible systems", on control and observation spillover
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import linear_sum_assignment

from pliant.plants.core.argument_gates import (
    require_by_name,
    require_function,
    require_instance,
    require_number,
    require_text,
    shown,
)
from pliant.plants.dynamics.plant import Plant
from pliant.plants.linear import modal_analysis
from pliant.plants.linear.conserved import moved
from pliant.plants.linear.lti import LinearModel

from .loops import Array, Loop, closed_loops, felt_by, law_of, loop, plant_of

GAINS = 100  # steps in which the feedback is raised
RESERVE = 1.25  # gain margin that a loop which holds must have
TRIED = {"gain": 24, "effort": 4}  # factors in an octave: one costs a few eigenvalues, or a design
WITHIN = 5  # gains between that of a factor and its reserve
NEAR = 0.01  # of the factor: how near the limit it is found
MOST = 1e9  # largest factor tried
CROSSINGS = 2000  # frequencies at which the bandwidth is looked for

Point = Mapping[str, float] | Callable[[Plant], tuple[Any, Any]] | None


@dataclass(frozen=True)
class Case:
    """The loop on one plant; the worst mode is the one that grows fastest or decays slowest."""

    plant: str
    states: int
    growth: float  # [1/s] of the worst mode, negative where it decays
    number: int | None  # of the worst mode among the plant's own, from 1; None where it is the controller's
    frequency_hz: float  # of that mode without feedback
    dominant_state: str
    lacking: bool  # whether the design model lacks it
    design_modes: int  # how many the design model has
    design_hz: float | None  # of that mode in another design model

    @property
    def stable(self) -> bool:
        return self.growth < 0

    @property
    def mode(self) -> str:
        """In words."""
        if self.number is None:
            words = f"a mode of the controller, {self.frequency_hz:.3g} Hz, "
        else:
            words = f"mode {self.number} of the plant, {self.frequency_hz:.3g} Hz ({self.dominant_state}), "
        words += f"{'decays' if self.stable else 'grows'} at {abs(self.growth):.3g} 1/s"
        if not self.stable and self.lacking:
            words += f"; the design model has only {self.design_modes}"
        elif not self.stable and self.design_hz is not None:
            words += f"; the design model has it at {self.design_hz:.3g} Hz"
        return words


@dataclass(frozen=True)
class Spillover:
    """What `spillover` found. `factor` scales the gain down or the effort up; None where none was asked or found."""

    cases: tuple[Case, ...]
    bandwidth_hz: float  # of the loop on the design model: highest at which the largest singular value of L is 1
    by: str  # "gain" or "effort"
    factor: float | None  # the first of those tried
    allowed_hz: float | None  # bandwidth with that factor
    controller: Any = None  # what `redesign` gave for that factor
    conserved: tuple[str, ...] = ()  # by the design plant: what no input changes is not in the loop
    free: tuple[str, ...] = ()  # of it: what inputs change and neither plant nor controller feels, left as it is

    @property
    def holds(self) -> bool:
        """Whether all plants are stable."""
        return all(case.stable for case in self.cases)

    @property
    def first(self) -> Case | None:
        """The cheapest plant that is not stable."""
        return next((case for case in self.cases if not case.stable), None)

    @property
    def verdict(self) -> str:
        """In words."""
        apart = f"; apart from what no input changes: {', '.join(self.conserved)}" if self.conserved else ""
        free = f"; left as it is: {', '.join(self.free)}" if self.free else ""
        return f"{self._found()}{apart}{free}"

    def _found(self) -> str:
        if self.first is None:
            worst = max(self.cases, key=lambda case: case.growth)
            return f"holds on all {len(self.cases)} plants; slowest on {worst.plant}: {worst.mode}"
        words = f"unstable on {self.first.plant}: {self.first.mode}"
        if self.factor is None:
            tried = f"{TRIED[self.by]} factors on the {self.by} in each octave up to {MOST:g}"
            return f"{words}; of {tried} none makes it hold"
        fall = f"bandwidth from {self.bandwidth_hz:.3g} Hz to {self.allowed_hz:.3g} Hz"
        return f"{words}; it holds with {self.by} times {self.factor:.3g}: {fall}"


def spillover(
    controller: Any,
    plants: Sequence[Plant | LinearModel],
    at: Point = None,
    *,
    redesign: Callable[[float], Any] | None = None,
    reserve: float = RESERVE,
) -> Spillover:
    """Close the controller's loop around each plant, the design plant first, cheapest first after it.

    at: coordinates held at an equilibrium of each plant, or what gives its (x0, u0); not needed for linear models.
    redesign(factor): a controller for `factor` >= 1 times the effort; without it the controller's output is scaled
    down. reserve: factor on the loop's gain that what is recommended must bear too. PliantError for controllers without
    a linear form; limits are not in it.

    Example
    -------
    >>> from pliant.controllers import LQR
    >>> from pliant.envs import scenes
    >>> scene = scenes.get("single-link-slew")
    >>> spillover(LQR.for_scene(scene), [scene.plant], dict(scene.goal)).holds
    True
    """
    if not isinstance(plants, Sequence) or isinstance(plants, (str, bytes)) or not plants:
        raise ValueError(f"spillover: plants = {shown(plants)} must hold the design plant at least")
    reserve = require_number("spillover.reserve", reserve, least=1.0)
    if redesign is not None:
        require_function("spillover.redesign", redesign)
    models = [model_of(plant, at) for plant in plants]
    labels = [plant.label if isinstance(plant, Plant) else f"model {i}" for i, plant in enumerate(plants)]
    cases = tuple(case_of(model, controller, models[0], label) for model, label in zip(models, labels))
    by = "gain" if redesign is None else "effort"
    factor, allowed, changed = None, None, None
    if not all(case.stable for case in cases):
        own = [closed_loops(model, controller) for model in models]
        dt = law_of(controller).dt

        def holds(f: float) -> bool:
            if redesign is None:
                loops, gain = own, 1 / f
            else:
                law, gain = redesign(f), 1.0
                loops = [closed_loops(model, law) for model in models]
            more = np.geomspace(1.0, reserve, WITHIN)
            return all(_rates(np.linalg.eigvals(at(gain * k)), dt).max() < 0 for k in more for at in loops)

        effort = _first(holds, TRIED[by])
        if effort is not None:
            factor, gain = (1 / effort, 1 / effort) if redesign is None else (effort, 1.0)
            changed = None if redesign is None else redesign(effort)
            allowed = crossover_hz(loop(models[0], changed or controller), gain)
    whole = loop(models[0], controller)
    bandwidth = crossover_hz(whole)
    return Spillover(cases, bandwidth, by, factor, allowed, changed, whole.conserved, whole.free)


def model_of(plant: Plant | LinearModel, at: Point) -> LinearModel:
    """The plant's linear model in states that can be read, at its equilibrium or point."""
    if isinstance(plant, LinearModel):
        return plant
    require_instance("plant, of plants,", plant, Plant, what="Plant or a LinearModel")
    if callable(at) and not isinstance(at, type):
        point = at(plant)
        if not isinstance(point, tuple) or len(point) != 2:
            raise ValueError(f"at gives {shown(point)}, must be (x0, u0)")
    else:
        known = tuple(s.name for s in plant.states + plant.outputs)
        point = plant.equilibrium({} if at is None else require_by_name("at", at, known, "state"))
    return plant.feedback_model(*point)


def growth(model: LinearModel, controller: Any, gain: float = 1.0) -> float:
    """[1/s] of the mode of the loop that grows fastest or decays slowest, with `gain` times the controller's output."""
    gain = require_number("growth.gain", gain)
    return float(_rates(np.linalg.eigvals(closed_loops(model, controller)(gain)), law_of(controller).dt).max())


def case_of(model: LinearModel, controller: Any, design: LinearModel, label: str = "") -> Case:
    """The loop on one linear model of a plant, and which mode of it is the worst."""
    require_instance("case_of.model", model, LinearModel)
    require_instance("case_of.design", design, LinearModel)
    require_text("case_of.label", label, empty=True)
    dt = law_of(controller).dt
    values = np.linalg.eigvals(closed_loops(model, controller)(1.0)).astype(complex)
    rates = _rates(values, dt)
    worst = int(np.argmax(rates))
    start, own = origin(model, controller, values[worst])
    modes, had = model.modes(), design.modes()
    if not own:
        hz = abs(start) / (2 * np.pi)
        return Case(label, len(model.states), float(rates[worst]), None, hz, "", False, len(had), None)
    mode = min(modes, key=lambda m: abs(m.frequency_hz - abs(start) / (2 * np.pi)))
    lacking = mode.number > len(had)
    other = None if lacking or design is model else had[mode.number - 1].frequency_hz
    found = (mode.number, mode.frequency_hz, mode.dominant_state, lacking, len(had), other)
    return Case(label, len(model.states), float(rates[worst]), *found)


def origin(model: LinearModel, controller: Any, value: complex) -> tuple[complex, bool]:
    """The eigenvalue [1/s] without feedback that becomes `value` as the gain rises from 0 to 1, and whether it is the
    plant's rather than the controller's own.
    """
    law = law_of(controller)
    plant = modal_analysis.rates(moved(model, felt_by(law, model)).eigenvalues, model.dt)
    more = len(plant_of(model, law)[0]) - len(plant)  # inputs held and readings under way: poles at zero
    begin = plant if law.dt is None else np.exp(plant * law.dt)
    now = np.concatenate([begin, np.zeros(more), law.poles])
    closed = closed_loops(model, law)
    for gain in np.linspace(0.0, 1.0, GAINS + 1)[1:]:
        after = np.linalg.eigvals(closed(gain))
        now = after[linear_sum_assignment(np.abs(now[:, None] - after))[1]]
    k = int(np.argmin(np.abs(now - value)))
    if k < len(plant):
        return complex(plant[k]), True
    own = law.poles[k - len(plant) - more] if k >= len(plant) + more else 0.0
    return complex(own if law.dt is None else np.log(own or np.finfo(float).tiny) / law.dt), False


def crossover_hz(found: Loop, gain: float = 1.0) -> float:
    """Highest frequency at which the largest singular value of gain times L is 1; 0 where it is smaller throughout.

    Of a sampled loop half the sampling frequency, where it is larger up to there.
    """
    require_instance("crossover_hz.found", found, Loop)
    gain = require_number("crossover_hz.gain", gain, "positive")
    poles = np.linalg.eigvals(found.A).astype(complex)
    poles = np.abs(poles if found.dt is None else np.log(poles[poles != 0]) / found.dt)
    poles = poles[poles > 1e-6 * poles.max(initial=0.0)]
    low, high = (poles.min() / 1e3, poles.max() * 1e3) if len(poles) else (1e-3, 1e3)
    high = high if found.dt is None else np.pi / found.dt
    omega = np.geomspace(min(low, high / 1e3), high, CROSSINGS)

    def size(w: Array) -> Array:
        return np.log(np.maximum(gain * np.linalg.svd(found.at(w), compute_uv=False)[:, 0], 1e-300))

    values = size(omega)
    above = np.flatnonzero(values > 0)
    if not len(above):
        return 0.0
    k = int(above[-1])
    if k == len(omega) - 1:
        return float(omega[-1] / (2 * np.pi))
    share = values[k] / (values[k] - values[k + 1])
    return float(omega[k] ** (1 - share) * omega[k + 1] ** share / (2 * np.pi))


def _rates(values: Array, dt: float | None) -> Array:
    """Growth rates [1/s]."""
    if dt is None:
        return values.real
    return np.log(np.maximum(np.abs(values), np.finfo(float).tiny)) / dt


def _first(holds: Callable[[float], bool], octave: int) -> float | None:
    """The first factor > 1 that holds, of `octave` in each octave, then nearer to the last before it that does not."""
    step = 2.0 ** (1 / octave)
    low, high = 1.0, step
    while not holds(high):
        low, high = high, high * step
        if high > MOST:
            return None
    while high / low > 1 + NEAR:
        middle = float(np.sqrt(low * high))
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high
