"""A scene's rollout as a function of JAX, with exact gradients in states, inputs and parameters, also under jit.

JAX calls back (`jax.pure_callback`) for each control period: native code gives what comes after and its derivatives
(`PeriodSlopes`), which reverse mode (`jax.custom_vjp`) multiplies with what comes from the periods after. Nothing here
ends an episode at a bound, and nothing is cut off but the actions at the limits, where `rollout` does so.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants.core.argument_gates import require_count

from .period_slopes import PeriodSlopes

Array = np.ndarray
JaxArray = Any  # jax.Array: JAX is handed in, never imported


class JaxRollouts:
    """`lanes` rollouts of a scene at once, for the JAX that is handed in; arrays are of double precision.

    x (lanes, nx), u (lanes, nu) in the inputs' own units, p (lanes, np) the values of scene.randomise's parameters in
    their order (None: the plant's own); k is the number of the control period, also traced. Reverse mode only; under
    `jax.vmap` the rollouts are computed one after the other. ValueError without jax.config's "jax_enable_x64".

    Example
    -------
    >>> import jax
    >>> from pliant.envs import scenes
    >>> jax.config.update("jax_enable_x64", True)
    >>> slew = scenes.get("single-link-slew").differentiable(jax, lanes=2)
    >>> cost, x = slew.rollout(lambda seen: -seen[:, :1] - 0.3 * seen[:, 1:2])
    >>> cost.shape, x.shape
    ((2,), (151, 2, 6))
    """

    def __init__(self, scene: Scene, jax: Any, lanes: int = 1) -> None:
        if not jax.config.read("jax_enable_x64"):
            raise ValueError('differentiable: jax.config.update("jax_enable_x64", True) must come first')
        self.slopes = slopes = PeriodSlopes(scene, lanes)
        self.scene, self.jax, self.lanes = scene, jax, slopes.lanes
        self.limits = np.array(scene.limits)
        self.nominal = slopes.whole(slopes.plant.nominal_parameters)
        self._step = self._native(slopes.stepped, slopes.plant.nx)
        self._seen = self._native(slopes.observed, len(scene.observe) + 1)

    def _native(self, compute: Callable[..., tuple[Array, list[Array]]], m: int) -> Callable[..., JaxArray]:
        """compute(k, x, u, p) -> (value (lanes, m), its slopes (lanes, m, ..) in x, u, p) as a function of JAX."""
        jax, plant, n = self.jax, self.slopes.plant, self.lanes
        sizes = plant.nx, plant.nu, len(plant.varied)
        shapes = tuple(jax.ShapeDtypeStruct(shape, np.float64) for shape in ((n, m), *((n, m, size) for size in sizes)))

        def called(k: Any, *given: Any) -> tuple[Array, ...]:
            value, slopes = compute(int(k), *(np.asarray(a, dtype=float) for a in given))
            return value, *slopes

        def with_slopes(k: Any, *given: Any) -> tuple[JaxArray, ...]:
            return tuple(jax.pure_callback(called, shapes, k, *given, vmap_method="sequential"))

        @jax.custom_vjp
        def native(k: Any, x: Any, u: Any, p: Any) -> JaxArray:
            return with_slopes(k, x, u, p)[0]

        def forward(k: Any, *given: Any) -> tuple[JaxArray, tuple[JaxArray, ...]]:
            value, *slopes = with_slopes(k, *given)
            return value, tuple(slopes)

        def backward(slopes: tuple[JaxArray, ...], g: JaxArray) -> tuple[JaxArray | None, ...]:
            return None, *(jax.numpy.einsum("bi,bij->bj", g, slope) for slope in slopes)

        native.defvjp(forward, backward)
        return native

    def _called(self, function: Callable[..., JaxArray], k: Any, x: Any, u: Any, p: Any) -> JaxArray:
        given = (x, u, self.nominal if p is None else p)
        return function(k, *(self.jax.numpy.asarray(a, dtype=float) for a in given))

    def step(self, x: JaxArray, u: JaxArray, p: JaxArray | None = None, k: Any = 0) -> JaxArray:
        """The states (lanes, nx) a control period later, the inputs held."""
        return self._called(self._step, k, x, u, p)

    def observe(self, x: JaxArray, u: JaxArray, p: JaxArray | None = None, k: Any = 0) -> JaxArray:
        """What the environment shows (lanes, no): the scene's observations less their values at the goal."""
        return self._called(self._seen, k, x, u, p)[:, :-1]

    def cost(self, x: JaxArray, u: JaxArray, p: JaxArray | None = None, k: Any = 0) -> JaxArray:
        """What the scene charges (lanes,) for the control period that starts at x."""
        return self._called(self._seen, k, x, u, p)[:, -1]

    def starts(self, seed: int) -> tuple[JaxArray, JaxArray]:
        """(x, p) of an episode a lane, drawn as randomised environments draw theirs; without gusts."""
        x, p = (self.jax.numpy.asarray(a) for a in self.slopes.starts(seed))
        return x, p

    def rollout(
        self,
        policy: Callable[[JaxArray], JaxArray],
        x: JaxArray | None = None,
        p: JaxArray | None = None,
        *,
        steps: int = 0,
    ) -> tuple[JaxArray, JaxArray]:
        """(cost (lanes,), states (steps + 1, lanes, nx)) of a whole episode, or of its first `steps` periods.

        `policy` takes observations (lanes, no) and gives actions (lanes, nu) in [-1, 1]; beyond they are cut off,
        without a slope. None for x: the scene's own start. One loop of JAX (`jax.lax.scan`): compiled once a shape.
        """
        jnp, scene = self.jax.numpy, self.scene
        steps = require_count("rollout", "steps", steps, 0, scene.steps) or scene.steps
        start = jnp.asarray(self.slopes.whole(scene.initial[0]) if x is None else x, dtype=float)
        p = jnp.asarray(self.nominal if p is None else p, dtype=float)

        def period(carry: tuple[JaxArray, JaxArray], k: JaxArray) -> tuple[tuple[JaxArray, JaxArray], Any]:
            now, before = carry
            u = jnp.clip(policy(self.observe(now, before, p, k)), -1.0, 1.0) * self.limits
            after = self.step(now, u, p, k)
            return (after, u), (self.cost(now, u, p, k), after)

        still = jnp.zeros((self.lanes, len(self.limits)))
        _, (costs, after) = self.jax.lax.scan(period, (start, still), jnp.arange(steps))
        return costs.sum(axis=0), jnp.concatenate([start[None], after])
