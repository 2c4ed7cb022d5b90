"""Where a regulator's loop rests when the plant has other parameters than it was designed for, and if it stays there.

u = u0 - K (x - x0) holds a load that weighs other than it was told in another place, f(x, u0 - K (x - x0), p) = 0.
Newton's method follows it from the design's parameters to each corner of a box. The linear loop about that rest decides
there; about x0, which is then no rest, it says nothing.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from pliant.controllers import LQR
from pliant.controllers.analysis.loops import closed_loop
from pliant.plants import LinearModel, Plant
from pliant.plants.core.errors import PliantError, unstable_rests_untold
from pliant.plants.core.signals import names

Array = np.ndarray
PARTS = 4  # of the way to a corner, at each of which the loop is looked at
MOST_CORNERS = 16
STEPS, CLOSE = 20, 1e-9  # of Newton's method; the change, of the state's own size, at which it ends
STANDS = 1e-6  # of the largest rate that inputs at their limits cause: a smaller one leaves a rest what it was


@dataclass(frozen=True)
class OwnRests:
    """moved: whether the rest is another at any corner; worst: what was found where the loop does not stay."""

    moved: bool
    worst: str = ""


def own_rests(
    plant: Plant, law: LQR, box: Mapping[str, tuple[float, float]], at: tuple[Array, Array], times: float = 1.0
) -> OwnRests:
    """Of the corners of `times` the box, and on the way to them; `at` is the rest (x0, u0) of the design.

    Example
    -------
    >>> scene = scenes.get("two-link-reach")
    >>> own_rests(scene.plant, LQR.for_scene(scene), {"payload.mass": (0.35, 0.65)}, scene.target)
    OwnRests(moved=True, worst='')
    """
    varied, (x0, u0) = plant.vary(*box), at
    middle = np.array([(low + high) / 2 for low, high in box.values()])
    half = times * np.array([(high - low) / 2 for low, high in box.values()])
    scale = np.abs(varied.jacobians(x0, u0, p=middle)[1] @ law.limits[1]).max()
    whole = law.K.shape == (plant.nu, plant.nx) and law.reads == names(plant.states)
    moved = False
    for corner in itertools.islice(itertools.product((-1.0, 1.0), repeat=len(box)), MOST_CORNERS):
        p = middle + half * corner
        if (p <= 0).any() or np.abs(varied.dynamics(x0, u0, p=p)).max() <= STANDS * scale:
            continue
        moved = True
        if whole:
            for told, rest in _on_the_way(varied, law, x0, u0, middle, p):
                if worst := _wrong(varied, law, dict(zip(box, told.tolist())), told, rest):
                    return OwnRests(True, worst)
    return OwnRests(moved)


def _on_the_way(
    varied: Plant, law: LQR, x0: Array, u0: Array, middle: Array, end: Array
) -> Iterator[tuple[Array, Array | None]]:
    """(p, the loop's rest x there or None) in parts from the middle to the end."""
    x: Array | None = np.array(x0)
    for part in range(1, PARTS + 1):
        p = middle + (end - middle) * part / PARTS
        x = None if x is None else _rest(varied, law, x, x0, u0, p)
        yield p, x


def _rest(varied: Plant, law: LQR, x: Array, x0: Array, u0: Array, p: Array) -> Array | None:
    try:
        for _ in range(STEPS):
            u = u0 - law.K @ (x - x0)
            A, B = varied.jacobians(x, u, p=p)[:2]
            change = np.linalg.lstsq(A - B @ law.K, -varied.dynamics(x, u, p=p), rcond=None)[0]
            x = x + change
            if np.abs(change).max() <= CLOSE * max(1.0, float(np.abs(x).max())):
                return x
    except (PliantError, ValueError, np.linalg.LinAlgError):  # where the equations end
        return None
    return None


def _wrong(varied: Plant, law: LQR, values: Mapping[str, float], p: Array, x: Array | None) -> str:
    """What is wrong with the loop at a rest, in words."""
    where = " and ".join(f"{name} = {value:.4g}" for name, value in values.items())
    if x is None:
        return f"with {where} no rest of it was found"
    with unstable_rests_untold():
        model: LinearModel = varied.linearize(x, law.u0 - law.K @ (x - law.x0), p=p)
    rho = float(np.abs(np.linalg.eigvals(closed_loop(model, law))).max())
    if rho < 1 or law.dt is None:
        return ""
    far = int(np.argmax(np.abs(x - law.x0)))
    state = varied.states[far]
    return (
        f"with {where} it rests at {state.name} = {x[far]:.4g} {state.unit}, not at {law.x0[far]:.4g}, and grows there "
        f"at {np.log(rho) / law.dt:.3g} 1/s"
    )
