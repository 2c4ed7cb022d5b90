"""A scene's rollout as a function of PyTorch, with exact gradients in states, inputs and parameters.

Forward, a control period of native code gives what comes after and its derivatives (`PeriodSlopes`); backward they are
multiplied with what comes from the periods after. Nothing here ends an episode at a bound, and nothing is cut off but
the actions at the limits, where `rollout` does so.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants.core.argument_gates import require_count

from .period_slopes import PeriodSlopes

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
        self.slopes = slopes = PeriodSlopes(scene, lanes)
        self.scene, self.torch, self.lanes = scene, torch, slopes.lanes
        self.limits = torch.tensor(scene.limits, dtype=torch.float64)
        self.nominal = torch.from_numpy(slopes.whole(slopes.plant.nominal_parameters))
        self._step, self._seen = self._native(slopes.stepped), self._native(slopes.observed)

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
        x, p = (self.torch.from_numpy(a) for a in self.slopes.starts(seed))
        return x, p

    def rollout(
        self, policy: Callable[[Tensor], Tensor], x: Tensor | None = None, p: Tensor | None = None, *, steps: int = 0
    ) -> tuple[Tensor, Tensor]:
        """(cost (lanes,), states (steps + 1, lanes, nx)) of a whole episode, or of its first `steps` periods.

        `policy` takes observations (lanes, no), of torch's default type, and gives actions (lanes, nu) in [-1, 1];
        beyond they are cut off, without a slope. None for x: the scene's own start.
        """
        torch, scene = self.torch, self.scene
        steps = require_count("rollout", "steps", steps, 0, scene.steps) or scene.steps
        now = torch.from_numpy(self.slopes.whole(scene.initial[0])) if x is None else x
        before, states, total = torch.zeros_like(self.limits).expand(self.lanes, -1), [now], 0.0
        for k in range(steps):
            seen = self.observe(now, before, p, k).to(torch.get_default_dtype())
            u = policy(seen).to(torch.float64).clamp(-1.0, 1.0) * self.limits
            total = total + self.cost(now, u, p, k)
            now, before = self.step(now, u, p, k), u
            states.append(now)
        return total, torch.stack(states)
