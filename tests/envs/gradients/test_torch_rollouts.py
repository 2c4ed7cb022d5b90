"""Rollouts in PyTorch: gradients against central differences of fourth order, costs against the environment's."""

import numpy as np
import pytest

from pliant.envs import PlantEnv, scenes

torch = pytest.importorskip("torch")


def differences(f, at, along, h: float) -> float:
    """The derivative of f at `at` along `along`, to fourth order in h."""
    near, far = (f(at + s * h * along) - f(at - s * h * along) for s in (1, 2))
    return float((8 * near - far) / (12 * h))


@pytest.mark.parametrize("name", ["single-link-slew", "two-link-reach"])
def test_gradients_of_a_rollout_in_policy_states_and_parameters(name: str) -> None:
    scene, rng = scenes.get(name), np.random.default_rng(0)
    rollouts = scene.differentiable(torch, lanes=2)
    gains = torch.tensor(0.1 * np.abs(rng.standard_normal((len(scene.observe), scene.plant.nu))))
    given = [gains, *rollouts.starts(0)]
    kind = torch.get_default_dtype()
    torch.set_default_dtype(torch.float64)
    try:

        def cost(W, x, p):
            return rollouts.rollout(lambda seen: torch.tanh(-seen @ W), x, p, steps=30)[0].sum()

        wanted = [a.clone().requires_grad_() for a in given]
        gradients = torch.autograd.grad(cost(*wanted), wanted)
        for place, (gradient, h) in enumerate(zip(gradients, (1e-4, 1e-6, 1e-5))):
            along = torch.tensor(rng.standard_normal(given[place].shape))

            def moved(value, place=place):
                with torch.no_grad():
                    return cost(*[value if k == place else a for k, a in enumerate(given)])

            found = float((gradient * along).sum())
            assert found == pytest.approx(differences(moved, given[place], along, h), rel=1e-6), place
    finally:
        torch.set_default_dtype(kind)


def test_a_rollout_is_the_environments_episode() -> None:
    scene = scenes.get("two-link-reach")
    rollouts, env = scene.differentiable(torch), PlantEnv(scene)

    def policy(seen):
        return 0.1 * torch.tanh(-seen[:, :2] - 0.3 * seen[:, 2:4])

    cost, states = rollouts.rollout(policy)
    obs, _ = env.reset(seed=0)
    total, over = 0.0, False
    while not over:
        action = policy(torch.tensor(obs[None]).float())[0].numpy()
        obs, reward, *ends, _ = env.step(action)
        over, total = any(ends), total - reward
    assert cost.item() == pytest.approx(total, rel=1e-5)
    np.testing.assert_allclose(states[-1, 0].numpy(), env.state, atol=1e-5)


def test_gradcheck_of_one_step_and_what_is_refused() -> None:
    scene = scenes.get("single-link-slew")
    rollouts = scene.differentiable(torch, lanes=1)
    x, p = rollouts.starts(1)
    u = torch.tensor([[3.0]], dtype=torch.float64)
    assert torch.autograd.gradcheck(rollouts.step, [a.requires_grad_() for a in (x, u, p)], eps=1e-6, atol=1e-6)
    with pytest.raises(ValueError, match="must be the module torch or jax"):
        scene.differentiable(np)
    with pytest.raises(ValueError, match="lanes"):
        scene.differentiable(torch, lanes=0)
