"""The cost of episodes under a network, and its exact gradient in the network's numbers.

Forward, every lane plays a whole episode: the network reads, its command is cut off at the limits and acts `delay`
periods later, the plant moves on by the environment's RK4 steps. Backward, the adjoint lambda of the state goes through
the same steps,

    lambda_k = dl/dx + (dx+/dx)' lambda_k+1 + C' mu_k,     mu_k the slope in what is observed at k,

whose products with the transposed derivatives a native kernel gives without forming these (`StepAdjoints`),

and what reaches the commands goes through the network to its numbers. A command that is cut off has no slope there;
the part that would bring it back within the limits is kept, so that it can come back.

A lane whose adjoint is far larger than the median of all would drown them: it counts at most FAR medians.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.plants.integration.batch_stepper import step_kernel

from .network import Activations, Layers, Network
from .scene_functions import SceneFunctions
from .step_adjoints import StepAdjoints

Array = np.ndarray
FAR = 3.0
LARGEST = 1e6  # |state| from which on a lane is out of the world: its slopes are left out


@dataclass(frozen=True, eq=False)
class Episodes:
    """What lanes start from and suffer."""

    x: Array  # (lanes, nx)
    p: Array  # (lanes, np) the randomised parameters
    delay: Array  # (lanes,) whole control periods from reading to acting
    noise: Array | None = None  # (steps, lanes, no) added to the readings, in units of `std`


@dataclass(frozen=True, eq=False)
class Played:
    """A forward pass: by period and lane."""

    x: Array  # (steps, lanes, nx) at the period's start
    before: Array  # (steps, lanes, nu) what acted when it was observed
    u: Array  # (steps, lanes, nu) what acts over the period
    seen: Activations  # (steps, lanes, ..)


class Rollouts:
    """Episodes of a scene on `lanes` lanes at once, from readings over `std` (no,).

    history: so many former readings and commands are read too. Example: `rollouts(theta, episodes)` gives the cost of
    every lane and the gradient of their mean.
    """

    def __init__(self, scene: Any, lanes: int, std: Array, *, width: int = 64, history: int = 0) -> None:
        self.scene, self.lanes, self.std, self.history = scene, lanes, std, history
        plant = self.plant = scene.varied_plant
        self.steps, self.limits = scene.steps, np.array(scene.limits)
        self.no = len(scene.observe)
        self.network = Network(self.no + history * (self.no + plant.nu), plant.nu, width)
        self.functions = SceneFunctions(scene)
        self.back = StepAdjoints(plant, scene.dt, substeps=scene.substeps, batch=lanes)
        self._ahead = step_kernel(plant, "rk4", np.dtype(float)).workspace(lanes)
        self.first = np.clip(scene.initial[1], -self.limits, self.limits)

    def __call__(self, theta: Array, episodes: Episodes) -> tuple[Array, Array]:
        """(the scene's cost of every lane (lanes,), the gradient (size,) of the mean of what they are charged)."""
        played = self.play(theta, episodes)
        cost, slope = self._charged(played, episodes.p)
        return cost, self._backward(self.network.layers(theta), played, episodes, slope)

    def cost(self, theta: Array, episodes: Episodes) -> tuple[Array, Array]:
        """(the scene's cost (lanes,), what nearness to bounds adds (lanes,)) of every lane."""
        played = self.play(theta, episodes)
        return self._sums(played.x, played.u, episodes.p)

    def charged(self, x: Array, u: Array, p: Array) -> Array:
        """What lanes are charged (lanes,), nearness to bounds counted, of states (steps, lanes, nx) and inputs."""
        cost, near = self._sums(x, u, p)
        return cost + near

    def _sums(self, x: Array, u: Array, p: Array) -> tuple[Array, Array]:
        flat = (x.reshape(-1, self.plant.nx), u.reshape(-1, self.plant.nu), self._rows(p))
        _, _, cost, near = self.functions.cost_slopes(*flat)
        return cost.reshape(self.steps, -1).sum(0), near.reshape(self.steps, -1).sum(0)

    def vary(self, p: Array) -> None:
        """From now on the lanes have the randomised parameters p (lanes, np)."""
        self._ahead.set(4, p)
        self.back.work.set(4, p)

    def after(self, x: Array, u: Array) -> Array:
        """The states (lanes, nx) a control period later, of x (lanes, nx) and inputs u (lanes, nu) that are held."""
        self._ahead.set(1, x)
        self._ahead.set(2, u)
        self._ahead.run((self.scene.dt / self.scene.substeps,), self.scene.substeps)
        return self._ahead.get(0).copy()

    def play(self, theta: Array, episodes: Episodes) -> Played:
        """All periods forward."""
        K, n, plant, network = self.steps, self.lanes, self.plant, self.network
        layers = network.layers(theta)
        x, u = np.empty((K, n, plant.nx)), np.empty((K, n, plant.nu))
        before = np.empty((K, n, plant.nu))
        sizes = (network.ny, network.width, network.width, network.nu)
        seen = Activations(*(np.empty((K, n, size)) for size in sizes))
        now, acting = episodes.x.copy(), np.tile(self.first, (n, 1))
        memory = np.zeros((n, self.history * (self.no + plant.nu)))
        commands = np.empty((K, n, plant.nu))
        lanes, late = np.arange(n), bool(episodes.delay.any())
        self.vary(episodes.p)
        for k in range(K):
            x[k], before[k] = now, acting
            read = self.functions.observe(now, acting, episodes.p) / self.std
            if episodes.noise is not None:
                read = read + episodes.noise[k]
            if k == 0:
                memory = self._first_memory(read)
            at = network.forward(layers, np.hstack([read, memory]) if self.history else read)
            for whole, part in zip(seen, at):
                whole[k] = part
            commands[k] = np.clip(at.v, -1.0, 1.0) * self.limits
            acting = commands[k]
            if late:
                sent = k - episodes.delay
                acting = np.where((sent >= 0)[:, None], commands[np.maximum(sent, 0), lanes], self.first)
            u[k] = acting
            now = self.after(now, acting)
            memory = self._remembered(memory, read, commands[k] / self.limits)
        return Played(x, before, u, seen)

    def frames(self, read: Array, commands: Array) -> Array:
        """What the network reads (steps, lanes, ny): of readings over std (steps, lanes, no), commands over limits."""
        found, memory = [], self._first_memory(read[0])
        for now, command in zip(read, commands):
            found.append(np.hstack([now, memory]))
            memory = self._remembered(memory, now, command)
        return np.array(found)

    def _first_memory(self, read: Array) -> Array:
        """As if it had always been read, and nothing commanded."""
        h = self.history
        return np.hstack([np.tile(read, (1, h)), np.zeros((len(read), h * self.plant.nu))])

    def _remembered(self, memory: Array, read: Array, command: Array) -> Array:
        """The memory with what was read and commanded put first: [readings, newest first; commands, newest first]."""
        h, no, nu = self.history, self.no, self.plant.nu
        if not h:
            return memory
        readings, sent = memory[:, : h * no], memory[:, h * no :]
        return np.hstack([read, readings[:, : (h - 1) * no], command, sent[:, : (h - 1) * nu]])

    def _rows(self, p: Array) -> Array:
        return np.tile(p, (self.steps, 1))

    def _charged(self, played: Played, p: Array) -> tuple[Array, tuple[Array, Array, Array, Array]]:
        K, n, plant = self.steps, self.lanes, self.plant
        rows = self._rows(p)
        x = played.x.reshape(-1, plant.nx)
        lx, lu, cost, _ = self.functions.cost_slopes(x, played.u.reshape(-1, plant.nu), rows)
        C, D = self.functions.observation_slopes(x, played.before.reshape(-1, plant.nu), rows)
        shaped = (
            lx.reshape(K, n, -1),
            lu.reshape(K, n, -1),
            C.reshape(K, n, *C.shape[1:]),
            D.reshape(K, n, *D.shape[1:]),
        )
        return cost.reshape(K, n).sum(axis=0), shaped

    def _backward(
        self, layers: Layers, played: Played, episodes: Episodes, slopes: tuple[Array, Array, Array, Array]
    ) -> Array:
        K, n, nx, nu, no, h = self.steps, self.lanes, self.plant.nx, self.plant.nu, self.no, self.history
        lx, lu, C, D = slopes
        adjoint = np.zeros((n, nx))
        command = np.zeros((K, n, nu))  # slope in each command
        reading = np.zeros((K, n, no))  # .. and in each reading
        dv, d1, d2 = (np.zeros((K, n, size)) for size in (nu, self.network.width, self.network.width))
        acting = np.zeros((n, nu))  # slope, from the period after, in what acts now: it is seen there
        lanes, late = np.arange(n), bool(episodes.delay.any())
        for k in reversed(range(K)):
            back, pushed = self.back(played.x[k], played.u[k], adjoint)
            reached = lu[k] + pushed + acting
            if late:
                sent = k - episodes.delay
                from_here = sent >= 0
                command[sent[from_here], lanes[from_here]] += reached[from_here]
            else:
                command[k] += reached
            v, slope = played.seen.v[k], command[k] * self.limits
            dv[k] = np.where((np.abs(v) > 1.0) & (v * slope < 0.0), 0.0, slope)  # but what brings it back is kept
            at = Activations(*(part[k] for part in played.seen))
            dz, d1[k], d2[k] = self.network.backward(layers, at, dv[k])
            reading[k] += dz[:, :no]
            for j in range(1, h + 1):
                past = max(k - j, 0)
                reading[past] += dz[:, j * no : (j + 1) * no]
                if k >= j:
                    start = (h + 1) * no + (j - 1) * nu
                    command[k - j] += dz[:, start : start + nu] / self.limits
            mu = reading[k] / self.std
            adjoint = lx[k] + back + np.matmul(mu[:, None, :], C[k])[:, 0]
            acting = np.matmul(mu[:, None, :], D[k])[:, 0]
        return self._mean(played, dv, d1, d2)

    def _mean(self, played: Played, dv: Array, d1: Array, d2: Array) -> Array:
        """The mean over lanes of their gradients, none counted for more than FAR medians, what diverged for nothing."""
        with np.errstate(over="ignore", invalid="ignore"):
            read = 1.0 + np.mean(played.seen.z**2, axis=2)  # the straight units' weights feel how large it is
            size = np.sqrt(((dv**2).sum(axis=2) * read).sum(axis=0))
        sound = np.isfinite(size) & (np.abs(played.x).max(axis=(0, 2)) < LARGEST)
        if not sound.any():
            return np.zeros(self.network.size)
        most = FAR * np.median(size[sound])
        weight = np.where(sound, np.minimum(1.0, most / np.maximum(size, 1e-300)), 0.0) / self.lanes
        if not sound.all():
            played, dv, d1, d2 = _without(played, sound), *(np.where(sound[:, None], a, 0.0) for a in (dv, d1, d2))
        flat = [(a * weight[:, None]).reshape(-1, a.shape[2]) for a in (d1, d2, dv)]
        seen = Activations(*(a.reshape(-1, a.shape[2]) for a in played.seen))
        return self.network.gradient(seen, *flat)


def _without(played: Played, sound: Array) -> Played:
    """What a lane that diverged has seen, as zeros."""
    seen = Activations(*(np.where(sound[:, None], part, 0.0) for part in played.seen))
    return dataclasses.replace(played, seen=seen)
