"""A plant's equations at random points: sizes, finite numbers, derivatives against differences, the energy balance.

A difference is taken with several steps, of which the best counts: too long a one feels the curvature, too short a one
the rounding. What a smooth function has is found to about 1e-8; what is wrong is wrong by far more than 1e-5.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from pliant.plants.core.argument_gates import shown
from pliant.plants.core.errors import PliantError
from pliant.plants.core.signals import names
from pliant.plants.dynamics.plant import Plant
from pliant.plants.native.batch_kernels import home, random_points

Array = np.ndarray
STEPS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)  # of a difference, in each state's own unit
APART = 1e-5  # of the largest entry, beyond which two derivatives are not the same
SHRINKS = 8  # halvings of a random state
ROUNDING = 1e-15  # of a value that is differenced
ELSEWHERE = "where the machine is never so, as a rope of no length, let `rest_state` give a state that it can have"
BLOCKS = (  # of `jacobians`: what changes, with what
    ("A", "rate", "x"),
    ("B", "rate", "u"),
    ("E", "rate", "w"),
    ("C", "output", "x"),
    ("D", "output", "u"),
    ("F", "output", "w"),
)


def points(plant: Plant, count: int, seed: int) -> list[dict[str, Any]]:
    """[{t, x, u, w, p}] of which the plant's functions take each, nearer to its rest where the equations end there."""
    drawn = random_points(plant, np.random.default_rng(seed), count)
    drawn[1] = plant.consistent(drawn[1].T).T
    about = home(plant)
    for k in range(SHRINKS):
        try:
            plant.dynamics(drawn[1].T, drawn[2].T, w=drawn[3].T, p=drawn[4].T)
            if k:  # once more, for differences are taken about them
                drawn[1] = plant.consistent((about + drawn[1].T) / 2).T
            break
        except PliantError:
            drawn[1] = plant.consistent((about + drawn[1].T) / 2).T
    found = [dict(zip("txuwp", (part[:, k] for part in drawn))) for k in range(count)]
    return [point | {"t": float(point["t"][0])} for point in found]


def wrong_sizes(plant: Plant, at: list[dict[str, Any]]) -> Iterator[str]:
    """Expressions (nx,) and (ny,), finite at the points and at rest."""
    rate, output = plant.expressions
    for what, expression, size in (("ode", rate, plant.nx), ("output", output, plant.ny)):
        if expression.shape != (size, 1):
            yield f"{what} has {expression.numel()} entries, must have {size}: one for each signal"
            return
    if wrong := wrong_rest(plant):
        yield wrong
        return
    for point in [{"t": 0.0, "x": plant.rest_state, "u": np.zeros(plant.nu), "w": None, "p": None}, *at]:
        for what, values, signals in (
            ("ode", plant.dynamics(**point), plant.states),
            ("output", plant.measure(**point), plant.outputs),
        ):
            bad = [name for name, value in zip(names(signals), values) if not np.isfinite(value)]
            if bad:
                yield f"{what} gives no number for {', '.join(bad)} at x = {point['x']}, must be finite"
                return


def wrong_rest(plant: Plant) -> str | None:
    """What is wrong with `rest_state`, which stands wherever no state is given."""
    x = np.asarray(plant.rest_state)
    if x.shape != (plant.nx,) or x.dtype.kind not in "fiu" or not np.isfinite(x).all():
        return f"rest_state is {shown(plant.rest_state)}, must be an array ({plant.nx},) of finite numbers"
    try:
        rate = plant.dynamics(x)
    except PliantError as lost:
        return f"equations: {type(lost).__name__}: {lost}; {ELSEWHERE}"
    if not np.isfinite(rate).all():
        bad = ", ".join(s.name for s, value in zip(plant.states, rate) if not np.isfinite(value))
        return f"ode gives no number for {bad} at x = {x}, must be finite; {ELSEWHERE}"
    return None


def derivatives(plant: Plant, at: list[dict[str, Any]]) -> tuple[float, list[str]]:
    """(largest deviation of the Jacobians from differences, over the largest entry of a row; what is wrong)."""
    worst, wrong = 0.0, list[str]()
    functions: dict[str, Callable[..., Array]] = {"rate": plant.dynamics, "output": plant.measure}
    for point in at:
        blocks = plant.jacobians(**point)
        for (letter, what, of), block in zip(BLOCKS, blocks):
            if not block.size:
                continue
            pairs = [_difference(functions[what], plant, point, of, step, block) for step in STEPS]
            given, block = np.array([pair[0] for pair in pairs]), pairs[-2][1]
            scale = np.abs(block).max(axis=1, keepdims=True)
            scale = np.where(scale > 0, scale, max(float(np.abs(block).max()), 1.0))
            size = float(np.abs(functions[what](**point)).max())
            rounding = ROUNDING * size / np.array(STEPS)[:, None, None]
            apart = np.maximum(np.abs(given - block) - rounding, 0.0).min(axis=0) / scale
            worst = max(worst, float(apart.max()))
            if not apart.max() <= APART:
                i, j = np.unravel_index(int(np.argmax(apart)), apart.shape)
                signals = {"rate": plant.states, "output": plant.outputs}[what]
                inner = {"x": plant.states, "u": plant.inputs, "w": plant.disturbances}[of]
                best = given[int(np.argmin(np.abs(given[:, i, j] - block[i, j]))), i, j]
                wrong.append(
                    f"jacobians: d({what} of {signals[i].name})/d({inner[j].name}) in {letter} is {block[i, j]:.6g}, "
                    f"differences give {best:.6g}: they must agree, as where the equations are smooth"
                )
                return worst, wrong
    return worst, wrong


def _difference(
    function: Callable[..., Array], plant: Plant, point: dict[str, Any], of: str, step: float, block: Array
) -> tuple[Array, Array]:
    """(central differences (n, n of `of`), the Jacobian `block` along the same ways).

    States are moved to states: off the unit quaternions equations may go on as they like.
    """
    z = np.asarray(point[of], dtype=float)
    columns, ways = [], []
    for k in range(len(z)):
        h = np.zeros(len(z))
        h[k] = step * max(1.0, abs(z[k])) if of != "x" else step
        ends = [plant.consistent(z + sign * h) if of == "x" else z + sign * h for sign in (1, -1)]
        ahead, back = (function(**point | {of: end}) for end in ends)
        columns.append((ahead - back) / (2 * h[k]))
        ways.append((ends[0] - ends[1]) / (2 * h[k]))
    return np.array(columns).T, block @ np.array(ways).T


def energy_balance(plant: Plant, at: list[dict[str, Any]]) -> tuple[str, list[str]]:
    """(what was found, what is wrong): dE/dt along the motion against the power put in less the power lost."""
    own: Any = plant
    if not hasattr(plant, "energy"):
        return "not checked: it has no energy(x)", []
    worst = 0.0
    for point in at:
        told = {key: point[key] for key in ("u", "w", "t")}
        rate = plant.dynamics(**point)
        if hasattr(plant, "power"):
            put_in, lost = own.power(point["x"], p=point["p"], **told)
            if lost < -APART * max(abs(put_in), 1e-12):
                return "", [f"dissipation gives {-lost:.4g} W at x = {point['x']}, must take: it must be >= 0"]
        else:
            rate, put_in, lost = plant.dynamics(point["x"], p=point["p"]), 0.0, 0.0
        times = np.array(STEPS) / max(1.0, float(np.abs(rate).max()))
        change = np.array([_along(own.energy, point, rate, h) for h in times])
        size = max(float(np.abs(rate).max()), abs(put_in), abs(lost), 1e-12)
        expected = put_in - lost
        if hasattr(plant, "power"):
            off = np.abs(change - expected) - _rounding(own.energy, point, rate, times[-1]) / times
            apart = max(float(off.min()), 0.0) / max(float(np.abs(change).max()), abs(put_in), 1e-9 * size)
            worst = max(worst, apart)
            if not apart <= APART:
                best = change[int(np.argmin(np.abs(change - expected)))]
                return "", [
                    f"energy changes by {best:.6g} W at x = {point['x']}, but {expected:.6g} W are put in less "
                    "lost: they must agree, as where T is quadratic in the rates and forces are in generalized_force"
                ]
        elif change.min() > APART * float(np.abs(change).max()) and change.min() > 1e-9:
            return "", [f"energy grows by {change.min():.4g} W at x = {point['x']} without an input, must not grow"]
    if hasattr(plant, "power"):
        return f"dE/dt is the power put in less the power lost, {within(worst)}", []
    return "energy does not grow without an input", []


def _along(energy: Callable[..., Any], point: dict[str, Any], rate: Array, h: float) -> float:
    """dE/dt where x moves at `rate`, by a central difference over h [s]."""
    ahead, back = (float(energy(point["x"] + sign * h * rate, p=point["p"])) for sign in (1, -1))
    return (ahead - back) / (2 * h)


def _rounding(energy: Callable[..., Any], point: dict[str, Any], rate: Array, h: float) -> float:
    """[J] that an energy is off by: how it scatters about a parabola over a motion of h [s]. More than its last digits
    where it is a difference of large ones, as of weights about their places at rest.
    """
    along = np.linspace(-1.0, 1.0, 15)
    E = np.array([float(energy(point["x"] + s * h * rate, p=point["p"])) for s in along])
    scatter = np.ptp(E - np.polyval(np.polyfit(along, E, 2), along))
    return max(ROUNDING * float(np.abs(E).max()), float(scatter))


def wrong_masses(plant: Plant, at: list[dict[str, Any]]) -> Iterator[str]:
    """A mass matrix that is not symmetric, and positive definite in the coordinates that no input accelerates as it
    likes; a kinetic energy that is no form in the rates.
    """
    own: Any = plant
    if not hasattr(plant, "mass_matrix"):
        return
    given: Any = getattr(plant, "driven", {})
    for point in at:
        M = own.mass_matrix(point["x"], p=point["p"])
        if np.abs(M - M.T).max() > 1e-9 * np.abs(M).max():
            yield f"mass_matrix at x = {point['x']} must be symmetric"
        free = [i for i in range(len(M)) if i not in given]
        least = float(np.linalg.eigvalsh((M + M.T)[np.ix_(free, free)] / 2)[0]) if free else np.inf
        if not least > 0:
            yield f"mass_matrix has the eigenvalue {least:.3g} at x = {point['x']}, must be > 0: something has no mass"
        if hasattr(plant, "kinetic"):
            v = point["x"][len(own.coordinates) :]
            told, form = float(own.kinetic(point["x"], p=point["p"])), 0.5 * float(v @ M @ v)
            if not abs(told - form) <= 1e-8 * max(abs(told), abs(form)):
                yield f"kinetic_energy is {told:.6g} J where v'Mv/2 is {form:.6g} J: it must be quadratic in the rates"
        if least <= 0:
            return


def wrong_outline(plant: Plant, at: list[dict[str, Any]]) -> Iterator[str]:
    """An outline that is no lines of finite points, or has not as many of them at every state."""
    shapes = set()
    for x in [plant.rest_state, *(point["x"] for point in at)]:
        found = plant.outline(x, 7)
        lines = [np.asarray(line) for line in found]
        if plant.drawn_as == "links" and any(line.shape != (7, 2) for line in lines):
            yield f"outline(x, 7) has lines of shape {lines[0].shape}, must be (links, 7, 2): the points asked for"
            return
        if not all(np.isfinite(line).all() for line in lines):
            yield f"outline at x = {x} must be finite"
            return
        shapes.add(len(lines))
    if len(shapes) > 1:
        yield f"outline has {sorted(shapes)} lines at different states, must have one number of them"


def within(apart: float) -> str:
    """How far two numbers are apart, in words."""
    return f"to {apart:.0e}" if apart > 0 else "to rounding"
