"""A scene's rollouts as functions of PyTorch or JAX, with exact gradients; neither is imported here."""

from typing import Any

from pliant.envs.scenes.scene import ENVIRONMENTS, Scene

from .jax_rollouts import JaxRollouts
from .torch_rollouts import Differentiable

__all__ = ["Differentiable", "JaxRollouts"]


def _differentiable(scene: Scene, module: Any, lanes: int = 1) -> Differentiable | JaxRollouts:
    """Of the module jax or torch, told apart by how each has functions with derivatives of one's own."""
    if hasattr(module, "custom_vjp"):
        return JaxRollouts(scene, module, lanes)
    if hasattr(module, "autograd"):
        return Differentiable(scene, module, lanes)
    raise ValueError(f"differentiable: module = {module!r} must be the module torch or jax")


ENVIRONMENTS.update(differentiable=_differentiable)
