"""A scene's rollout as a function of PyTorch, with exact gradients in states, inputs and parameters.

A control period is the environment's own RK4 steps in native code, x+ = F(x, u, p), with the derivatives of that map
(`plants.integration.step_sensitivities`); backward they are multiplied with what comes from the periods after.
Observations and costs are the environment's, differentiated symbolically. Nothing here ends an episode at a bound, and
nothing is cut off but the actions at the limits, where `rollout` does so.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants.core.argument_gates import require_count
from pliant.plants.core.casadi_functions import NumericFunction, function
from pliant.plants.integration.step_sensitivities import sensitivity_kernel

from .control_period import check_substep, observe_function, reference, reference_drift, require_time_shown
from .episode_start import draw, initial_states
from .parameter_inputs import ParameterInputs

Array = np.ndarray
Tensor = Any  # torch.Tensor: PyTorch is handed in, never imported


class Differentiable:
    """`lanes` rollouts of a scene at once, for the PyTorch that is handed in; tensors are of double precision.

    x (lanes, nx), u (lanes, nu) in the inputs' own units, p (lanes, np) the values of scene.randomise's parameters in
    their order (None: the plant's own); k is the number of the control period.

    Example
    -------
    >>> import torch
    >>> from pliant.envs import scenes
    >>> slew = scenes.get("single-link-slew").differentiable(torch, lanes=2)
    >>> cost, x = slew.rollout(lambda seen: -seen[:, :1] - 0.3 * seen[:, 1:2])
    >>> tuple(cost.shape), tuple(x.shape)
    ((2,), (151, 2, 6))
    """

    def __init__(self, scene: Scene, torch: Any, lanes: int = 1) -> None:
        if not hasattr(torch, "autograd"):
            raise ValueError(f"differentiable: torch = {torch!r} must be the module torch")
        require_time_shown(scene)
        check_substep(scene, False)
        self.scene, self.torch = scene, torch
        self.lanes = require_count("differentiable", "lanes", lanes, 1, 1_000_000)
        plant = self.plant = scene.varied_plant
        self._steered = ParameterInputs(plant)
        self._work = sensitivity_kernel(self._steered, np.dtype(float)).workspace(self.lanes)
        self._sense, self._slopes = _sensed(scene)
        self.limits = torch.tensor(scene.limits, dtype=torch.float64)
        self.nominal = self._lanes_of(plant.nominal_parameters)
        self._step = self._native(self._stepped)
        self._seen = self._native(self._observed)

    def _lanes_of(self, row: Array) -> Tensor:
        return self.torch.tensor(np.tile(row, (self.lanes, 1)), dtype=self.torch.float64)

    def _native(self, compute: Callable[..., tuple[Array, list[Array]]]) -> Callable[..., Tensor]:
        """compute(k, x, u, p) -> (value (lanes, m), its slopes (lanes, m, ..) in x, u, p) as a function of tensors."""
        torch = self.torch

        class Native(torch.autograd.Function):  # type: ignore[name-defined]
            @staticmethod
            def forward(ctx: Any, k: int, *given: Tensor) -> Tensor:
                arrays = [tensor.detach().to(torch.float64).numpy() for tensor in given]
                value, slopes = compute(k, *arrays)
                ctx.save_for_backward(*(torch.from_numpy(slope) for slope in slopes))
                return torch.from_numpy(value)

            @staticmethod
            def backward(ctx: Any, g: Tensor) -> tuple[Tensor | None, ...]:
                needed = zip(ctx.needs_input_grad[1:], ctx.saved_tensors)
                return None, *(torch.einsum("bi,bij->bj", g, slope) if wanted else None for wanted, slope in needed)

        return Native.apply

    def _stepped(self, k: int, x: Array, u: Array, p: Array) -> tuple[Array, list[Array]]:
        scene, work, nx, nu = self.scene, self._work, self.plant.nx, self.plant.nu
        changes = (p - self.plant.nominal_parameters) / self._steered.scale
        work.set(0, k * scene.dt)
        work.set(1, x)
        work.set(2, np.hstack([u, changes]))
        work.run((scene.dt / scene.substeps,), scene.substeps)
        after = work.outputs[0][:, : self.lanes].T.copy()
        S = work.outputs[1].reshape(nx, nx + self._steered.nu, -1)[:, :, : self.lanes].transpose(2, 0, 1)
        slopes = [S[:, :, :nx], S[:, :, nx : nx + nu], S[:, :, nx + nu :] / self._steered.scale]
        return after, [np.ascontiguousarray(slope) for slope in slopes]

    def _observed(self, k: int, x: Array, u: Array, p: Array) -> tuple[Array, list[Array]]:
        ref = reference(self.scene) + reference_drift(self.scene) * (k * self.scene.dt)
        points = x, u, np.tile(ref, (self.lanes, 1)), np.zeros((self.lanes, self.plant.nw)), p
        return self._sense(*points, batch=self.lanes)[0], list(self._slopes(*points, batch=self.lanes))

    def step(self, x: Tensor, u: Tensor, p: Tensor | None = None, k: int = 0) -> Tensor:
        """The states (lanes, nx) a control period later, the inputs held."""
        return self._step(k, x, u, self.nominal if p is None else p)

    def observe(self, x: Tensor, u: Tensor, p: Tensor | None = None, k: int = 0) -> Tensor:
        """What the environment shows (lanes, no): the scene's observations less their values at the goal."""
        return self._seen(k, x, u, self.nominal if p is None else p)[:, :-1]

    def cost(self, x: Tensor, u: Tensor, p: Tensor | None = None, k: int = 0) -> Tensor:
        """What the scene charges (lanes,) for the control period that starts at x."""
        return self._seen(k, x, u, self.nominal if p is None else p)[:, -1]

    def starts(self, seed: int) -> tuple[Tensor, Tensor]:
        """(x, p) of an episode a lane, drawn as randomised environments draw theirs; without gusts."""
        rng = np.random.default_rng(require_count("differentiable.starts", "seed", seed, 0, 2**63))
        held, _, p = draw(self.scene, rng, self.lanes)
        return tuple(self.torch.from_numpy(a) for a in (initial_states(self.scene, held, p), p))

    def rollout(
        self, policy: Callable[[Tensor], Tensor], x: Tensor | None = None, p: Tensor | None = None, *, steps: int = 0
    ) -> tuple[Tensor, Tensor]:
        """(cost (lanes,), states (steps + 1, lanes, nx)) of a whole episode, or of its first `steps` periods.

        `policy` takes observations (lanes, no), of torch's default type, and gives actions (lanes, nu) in [-1, 1];
        beyond they are cut off, without a slope. None for x: the scene's own start.
        """
        torch, scene = self.torch, self.scene
        steps = require_count("rollout", "steps", steps, 0, scene.steps) or scene.steps
        now = self._lanes_of(scene.initial[0]) if x is None else x
        before, states, total = torch.zeros_like(self.limits).expand(self.lanes, -1), [now], 0.0
        for k in range(steps):
            seen = self.observe(now, before, p, k).to(torch.get_default_dtype())
            u = policy(seen).to(torch.float64).clamp(-1.0, 1.0) * self.limits
            total = total + self.cost(now, u, p, k)
            now, before = self.step(now, u, p, k), u
            states.append(now)
        return total, torch.stack(states)


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
