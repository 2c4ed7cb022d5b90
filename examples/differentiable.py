"""A policy by exact gradients through the plant: PyTorch in front, the native step and its derivatives behind."""

import time

import torch

from pliant.envs import scenes

torch.manual_seed(0)
torch.set_num_threads(1)
scene = scenes.get("single-link-slew")
lanes = 8
rollouts = scene.differentiable(torch, lanes)
scale = torch.tensor([1.0, 0.2, 10.0, 0.2])  # angle, its rate, the tip's deflection, its rate
policy = torch.nn.Sequential(
    torch.nn.Linear(4, 32),
    torch.nn.Tanh(),
    torch.nn.Linear(32, scene.plant.nu),
)
with torch.no_grad():
    policy[-1].weight.mul_(0.01)
    policy[-1].bias.zero_()


def act(seen):
    return policy(seen * scale)


optimiser = torch.optim.Adam(policy.parameters(), 2e-2)
began, steps = time.perf_counter(), 60
schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, steps)
for k in range(steps):
    cost, _ = rollouts.rollout(act, *rollouts.starts(k))  # other starts and payloads each time
    optimiser.zero_grad()
    cost.mean().backward()
    torch.nn.utils.clip_grad_norm_(policy.parameters(), 1.0)
    optimiser.step()
    schedule.step()
seconds = time.perf_counter() - began
cost, _ = rollouts.rollout(act)
print(f"cost {cost[0].item():.3f} after {steps} gradient steps and {seconds:.0f} s; LQR 3.511, doing nothing 30")
