"""A control period and what is seen of it, on lanes, each with its derivatives: what PyTorch and JAX are given.

A control period is the environment's own RK4 steps in native code, x+ = F(x, u, p), with the derivatives of that map
(`plants.integration.step_sensitivities`). Observations and costs are the environment's, differentiated symbolically.
"""

from __future__ import annotations

import threading

import casadi as ca
import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.envs.simulation.control_period import (
    check_substep,
    observe_function,
    reference,
    reference_drift,
    require_time_shown,
)
from pliant.envs.simulation.episode_start import draw, initial_states
from pliant.plants.core.argument_gates import require_count
from pliant.plants.core.casadi_functions import NumericFunction, function
from pliant.plants.integration.step_sensitivities import sensitivity_kernel

from .parameter_inputs import ParameterInputs

Array = np.ndarray


class PeriodSlopes:
    """`stepped` and `observed` of `lanes` lanes: values (lanes, m) and slopes (lanes, m, ..) in x, u and p.

    x (lanes, nx), u (lanes, nu) in the inputs' own units, p (lanes, np) the values of scene.randomise's parameters in
    their order; k is the number of the control period. May be called from several threads.

    Example
    -------
    >>> from pliant.envs import scenes
    >>> slopes = PeriodSlopes(scenes.get("single-link-slew"), 2)
    >>> x, p = slopes.starts(0)
    >>> after, (by_x, by_u, by_p) = slopes.stepped(0, x, np.zeros((2, 1)), p)
    >>> after.shape, by_x.shape, by_u.shape, by_p.shape
    ((2, 6), (2, 6, 6), (2, 6, 1), (2, 6, 2))
    """

    def __init__(self, scene: Scene, lanes: int) -> None:
        require_time_shown(scene)
        check_substep(scene, False)
        self.scene = scene
        self.lanes = require_count("differentiable", "lanes", lanes, 1, 1_000_000)
        self.plant = scene.varied_plant
        self._steered = ParameterInputs(self.plant)
        self._work = sensitivity_kernel(self._steered, np.dtype(float)).workspace(self.lanes)
        self._lock = threading.Lock()  # of the workspace
        self._sense, self._slopes = _sensed(scene)

    def stepped(self, k: int, x: Array, u: Array, p: Array) -> tuple[Array, list[Array]]:
        """The states (lanes, nx) a control period later, the inputs held."""
        scene, work, nx, nu = self.scene, self._work, self.plant.nx, self.plant.nu
        changes = (p - self.plant.nominal_parameters) / self._steered.scale
        with self._lock:
            work.set(0, k * scene.dt)
            work.set(1, x)
            work.set(2, np.hstack([u, changes]))
            work.run((scene.dt / scene.substeps,), scene.substeps)
            after = work.outputs[0][:, : self.lanes].T.copy()
            S = work.outputs[1].reshape(nx, nx + self._steered.nu, -1)[:, :, : self.lanes].transpose(2, 0, 1)
            slopes = [S[:, :, :nx], S[:, :, nx : nx + nu], S[:, :, nx + nu :] / self._steered.scale]
            return after, [np.array(slope, order="C") for slope in slopes]

    def observed(self, k: int, x: Array, u: Array, p: Array) -> tuple[Array, list[Array]]:
        """What the environment shows, and last what the scene charges for the period that starts here."""
        ref = reference(self.scene) + reference_drift(self.scene) * (k * self.scene.dt)
        points = x, u, np.tile(ref, (self.lanes, 1)), np.zeros((self.lanes, self.plant.nw)), p
        return self._sense(*points, batch=self.lanes)[0], list(self._slopes(*points, batch=self.lanes))

    def starts(self, seed: int) -> tuple[Array, Array]:
        """(x, p) of an episode a lane, drawn as randomised environments draw theirs; without gusts."""
        rng = np.random.default_rng(require_count("differentiable.starts", "seed", seed, 0, 2**63))
        held, _, p = draw(self.scene, rng, self.lanes)
        return initial_states(self.scene, held, p), p

    def whole(self, row: Array) -> Array:
        """The row in every lane."""
        return np.tile(row, (self.lanes, 1))


def _sensed(scene: Scene) -> tuple[NumericFunction, NumericFunction]:
    """(x, u, ref, w, p) -> ([obs; cost],), and its slopes in x, u and p."""
    plant = scene.varied_plant
    sizes = plant.nx, plant.nu, plant.nw, len(plant.varied)
    x, u, w, p = (ca.SX.sym(name, size) for name, size in zip("xuwp", sizes))
    ref = ca.SX.sym("ref", len(reference(scene)))
    obs, cost, _ = observe_function(scene)(x, u, ref, w, p)
    value = ca.vertcat(obs, cost)
    inputs = [x, u, ref, w, p]
    slopes = [ca.jacobian(value, wanted) for wanted in (x, u, p)]
    return function("sense", inputs, [value]), function("slopes", inputs, slopes, matrices=True)
