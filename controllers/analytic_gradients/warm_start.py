"""Where training starts: a network that does what a law of the scene does, by least squares in its last layer.

First the law plays all lanes; then the network plays them and the law says what it would have done there (Ross, Gordon,
Bagnell, "A reduction of imitation learning and structured prediction to no-regret online learning", DAgger): what the
network itself runs into is learned too, until it costs hardly more than the law, or ROUNDS times. The cheapest is kept.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.controllers.base.controller import Controller
from pliant.controllers.linear_quadratic.lqr import LQR
from pliant.plants import PliantError

from .rollouts import Episodes, Rollouts

Array = np.ndarray
ROUNDS = 8  # at most
ENOUGH = 1.002  # of the law's own mean cost: no more rounds then
POINTS = 200  # times of an episode that the law is asked at
OUT = 10.0  # largest reading over std that is learned from
LEAST = 0.2  # of the largest spread of readings in the same unit: a reading that hardly moves is not blown up


def law_of(scene: Any) -> Controller | None:
    """The scene's LQR; None where it has none."""
    try:
        return LQR.for_scene(scene)
    except PliantError:
        return None


def begin(rollouts: Rollouts, law: Controller | None, episodes: Episodes, rng: np.random.Generator) -> Array:
    """Theta to start from; also says what the rollouts divide their readings by (`std`).

    Without a law the network begins with the goal's input, whatever it reads.
    """
    scene, network = rollouts.scene, rollouts.network
    theta = network.start(rng)
    network.layers(theta).b3[:] = scene.target[1] / rollouts.limits
    x, read, u = _played(rollouts, law, episodes)
    rollouts.std = _spreads(read, _units(scene))
    if law is None:
        return theta
    z, wanted = rollouts.frames(read / rollouts.std, u / rollouts.limits), u / rollouts.limits
    inputs, outputs = z.reshape(-1, network.ny), wanted.reshape(-1, network.nu)
    enough = ENOUGH * float(np.mean(rollouts.charged(x, u, episodes.p)))
    every = max(1, rollouts.steps // POINTS)
    best, least = theta, np.inf
    for left in reversed(range(ROUNDS)):
        network.fit_output(theta, inputs, outputs)
        played = rollouts.play(theta, episodes)
        with np.errstate(over="ignore", invalid="ignore"):
            cost = float(np.mean(rollouts.charged(played.x, played.u, episodes.p)))
        if cost < least:
            best, least = theta.copy(), cost
        if not left or least <= enough:
            break
        for k in range(0, rollouts.steps, every):
            z = played.seen.z[k]
            near = np.abs(z).max(axis=1) < OUT
            if near.any():
                asked = _asked(law, scene, played.x[k][near], k) / rollouts.limits
                inputs, outputs = np.vstack([inputs, z[near]]), np.vstack([outputs, asked])
    return best


def _played(rollouts: Rollouts, law: Controller | None, episodes: Episodes) -> tuple[Array, Array, Array]:
    """(states (steps, lanes, nx), readings (.., no), inputs (.., nu)) under the law, or the goal's input, undelayed."""
    scene, lanes = rollouts.scene, rollouts.lanes
    goal = np.tile(np.clip(scene.target[1], -rollouts.limits, rollouts.limits), (lanes, 1))
    x, before = episodes.x.copy(), np.tile(rollouts.first, (lanes, 1))
    found: tuple[list[Array], list[Array], list[Array]] = [], [], []
    rollouts.vary(episodes.p)
    for k in range(rollouts.steps):
        u = goal if law is None else _asked(law, scene, x, k)
        for whole, part in zip(found, (x, rollouts.functions.observe(x, before, episodes.p), u)):
            whole.append(part)
        x, before = rollouts.after(x, u), u
    states, read, inputs = (np.array(whole) for whole in found)
    return states, read, inputs


def _spreads(read: Array, units: list[str]) -> Array:
    """What readings are divided by (no,): their root mean square, at least LEAST of the largest of their unit."""
    size = np.sqrt(np.mean(read.reshape(-1, read.shape[-1]) ** 2, axis=0))
    same = [max(b for b, other in zip(size, units) if other == unit) for unit in units]
    found: Array = np.maximum(size, LEAST * np.array(same))
    return np.where((found > 0) & np.isfinite(found), found, 1.0)


def _units(scene: Any) -> list[str]:
    units = {s.name: s.unit for s in scene.signals}
    return [units[name] for name in scene.observe]


def _asked(law: Controller, scene: Any, x: Array, k: int) -> Array:
    """What a law without memory asks at states x (n, nx) and time k dt: (n, nu), cut off at the limits."""
    limits = np.array(scene.limits)
    asked = []
    for row in x:
        y = scene.signal_values(row, scene.plant.measure(row, scene.target[1]), law.reads)
        asked.append(np.clip(law.act(k * scene.dt, y), -limits, limits))
    return np.array(asked)
