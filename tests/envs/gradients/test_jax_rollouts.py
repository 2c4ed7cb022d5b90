"""Rollouts in JAX, where it is installed: gradients under jit, against differences and against PyTorch's."""

import re
from pathlib import Path

import numpy as np
import pytest

from pliant.envs import scenes

jax = pytest.importorskip("jax")


@pytest.fixture(autouse=True)
def double():
    kept = jax.config.read("jax_enable_x64")
    jax.config.update("jax_enable_x64", True)
    yield
    jax.config.update("jax_enable_x64", kept)


def problem(name: str, lanes: int = 2):
    """(rollouts, the cost of gains, states and parameters over 30 periods, these)."""
    scene = scenes.get(name)
    rollouts = scene.differentiable(jax, lanes=lanes)
    gains = 0.1 * np.abs(np.random.default_rng(0).standard_normal((len(scene.observe), scene.plant.nu)))

    def cost(W, x, p):
        return rollouts.rollout(lambda seen: jax.numpy.tanh(-seen @ W), x, p, steps=30)[0].sum()

    return rollouts, cost, (jax.numpy.asarray(gains), *rollouts.starts(0))


@pytest.mark.parametrize("name", ["single-link-slew", "two-link-reach"])
def test_gradients_under_jit_against_central_differences_of_fourth_order(name: str) -> None:
    _, cost, given = problem(name)
    gradients = jax.jit(jax.grad(cost, argnums=(0, 1, 2)))(*given)
    plain, rng = jax.jit(cost), np.random.default_rng(1)
    for place, (gradient, h) in enumerate(zip(gradients, (1e-4, 1e-6, 1e-5))):
        along = rng.standard_normal(given[place].shape)

        def moved(s, place=place, along=along):
            return float(plain(*[a + s * along if k == place else a for k, a in enumerate(given)]))

        near, far = (moved(s * h) - moved(-s * h) for s in (1, 2))
        assert float((gradient * along).sum()) == pytest.approx((8 * near - far) / (12 * h), rel=1e-6), place


def test_gradients_are_those_of_pytorch() -> None:
    torch = pytest.importorskip("torch")
    _, cost, given = problem("two-link-reach")
    value, gradients = jax.value_and_grad(cost, argnums=(0, 1, 2))(*given)
    rollouts, kind = scenes.get("two-link-reach").differentiable(torch, lanes=2), torch.get_default_dtype()
    torch.set_default_dtype(torch.float64)
    try:
        wanted = [torch.tensor(np.array(a), requires_grad=True) for a in given]
        total = rollouts.rollout(lambda seen: torch.tanh(-seen @ wanted[0]), *wanted[1:], steps=30)[0].sum()
        theirs = torch.autograd.grad(total, wanted)
    finally:
        torch.set_default_dtype(kind)
    assert float(value) == pytest.approx(total.item(), rel=1e-12)
    for mine, other in zip(gradients, theirs):
        np.testing.assert_allclose(mine, other.numpy(), rtol=1e-10, atol=1e-10 * float(other.abs().max()))


def test_one_period_outside_of_jit_is_the_plants_own() -> None:
    scene = scenes.get("single-link-slew")
    rollouts, _, (_, x, p) = problem("single-link-slew")
    u = np.array([[3.0], [-2.0]])
    after = rollouts.step(x, u, p)
    for lane in range(2):
        motion = scene.varied_plant.simulate(
            np.array(x[lane]), lambda t, lane=lane: u[lane], scene.times[:2], p=np.array(p[lane]), method="rk4",
            step=scene.dt / scene.substeps,
        )  # fmt: skip
        np.testing.assert_allclose(after[lane], motion.x[-1], rtol=1e-12, atol=1e-14)
    assert rollouts.observe(x, u).shape == (2, 4) and (rollouts.cost(x, u) > 0).all()


def test_the_block_of_the_page_runs() -> None:
    page = (Path(__file__).parents[3] / "docs" / "learning.md").read_text(encoding="utf-8")
    [block] = [text for text in re.findall(r"```python\n(.*?)```", page, re.DOTALL) if text.startswith("import jax")]
    found: dict = {}
    exec(block, found)
    assert found["value"] > 0 and found["slope"].shape == (4, 1) and np.isfinite(found["slope"]).all()


def test_what_is_refused() -> None:
    jax.config.update("jax_enable_x64", False)
    with pytest.raises(ValueError, match="jax_enable_x64"):
        scenes.get("single-link-slew").differentiable(jax)
