"""A network of two tanh layers in NumPy: forward, backward, and its last layer by least squares.

    net(z) = W3 tanh(W2 tanh(W1 z + b1) + b2) + b3

All its numbers are one vector theta, of which W1, b1, .. are views in this order. The first ny units of both layers
begin as SMALL z, where tanh is straight: the last layer can be a linear law of the inputs, however large they are.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

Array = np.ndarray
GAIN, BIAS = (
    0.5,
    0.3,
)  # of the first weights: inputs of size 1 stay where tanh is nearly straight, and no two units alike
RIDGE = 1e-6  # of the least squares, per row, against the units' squares of at most 1
SMALL = 0.05  # what the straight units make of an input: at 3 they bend by 0.7 %
ROUNDS = 60  # of least squares where outputs are cut off


class Layers(NamedTuple):
    """Weights and biases as views of theta, or of a gradient."""

    W1: Array  # (width, ny)
    b1: Array  # (width,)
    W2: Array  # (width, width)
    b2: Array  # (width,)
    W3: Array  # (nu, width)
    b3: Array  # (nu,)


class Activations(NamedTuple):
    """What a forward pass leaves for the backward one; rows are points."""

    z: Array  # (n, ny)
    h1: Array  # (n, width)
    h2: Array  # (n, width)
    v: Array  # (n, nu), the output


@dataclass(frozen=True)
class Network:
    """The sizes: ny inputs, nu outputs, two layers of `width` units.

    Example
    -------
    >>> network = Network(3, 1, width=8)
    >>> theta = network.start(np.random.default_rng(0))
    >>> network.forward(network.layers(theta), np.zeros((5, 3))).v.shape
    (5, 1)
    """

    ny: int
    nu: int
    width: int = 64

    @property
    def shapes(self) -> tuple[tuple[int, ...], ...]:
        n = self.width
        return (n, self.ny), (n,), (n, n), (n,), (self.nu, n), (self.nu,)

    @property
    def size(self) -> int:
        """Numbers of theta."""
        return sum(int(np.prod(shape)) for shape in self.shapes)

    def layers(self, theta: Array) -> Layers:
        """Views of theta (size,)."""
        ends = np.cumsum([np.prod(shape) for shape in self.shapes])[:-1]
        return Layers(*(part.reshape(shape) for part, shape in zip(np.split(theta, ends), self.shapes)))

    def start(self, rng: np.random.Generator) -> Array:
        """Theta (size,) whose output is zero: units drawn at random but the straight ones, the last layer empty."""
        theta = np.zeros(self.size)
        at = self.layers(theta)
        at.W1[:] = GAIN * rng.standard_normal(at.W1.shape) / np.sqrt(max(self.ny, 1))
        at.W2[:] = rng.standard_normal(at.W2.shape) / np.sqrt(self.width)
        for bias in (at.b1, at.b2):
            bias[:] = rng.uniform(-BIAS, BIAS, self.width)
        straight = min(self.ny, self.width // 2)
        for W, b, gain in ((at.W1, at.b1, SMALL), (at.W2, at.b2, 1.0)):
            W[:straight], b[:straight] = 0.0, 0.0
            W[range(straight), range(straight)] = gain
        return theta

    @staticmethod
    def forward(at: Layers, z: Array) -> Activations:
        """Outputs at z (n, ny), and what lies between."""
        h1 = np.tanh(z @ at.W1.T + at.b1)
        h2 = np.tanh(h1 @ at.W2.T + at.b2)
        return Activations(z, h1, h2, h2 @ at.W3.T + at.b3)

    @staticmethod
    def backward(at: Layers, seen: Activations, dv: Array) -> tuple[Array, Array, Array]:
        """(d/dz (n, ny), d/d(argument of h1), d/d(argument of h2)) of a function whose slope at the output is dv
        (n, nu).
        """
        d2 = (dv @ at.W3) * (1.0 - seen.h2**2)
        d1 = (d2 @ at.W2) * (1.0 - seen.h1**2)
        return d1 @ at.W1, d1, d2

    def gradient(self, seen: Activations, d1: Array, d2: Array, dv: Array) -> Array:
        """d/d(theta) (size,), summed over the points, from what `backward` gave of them."""
        found = np.empty(self.size)
        at = self.layers(found)
        for slope, below, W, b in (
            (d1, seen.z, at.W1, at.b1),
            (d2, seen.h1, at.W2, at.b2),
            (dv, seen.h2, at.W3, at.b3),
        ):
            W[:], b[:] = slope.T @ below, slope.sum(axis=0)
        return found

    def fit_output(self, theta: Array, z: Array, wanted: Array) -> None:
        """Set the last layer so that the output at z (n, ny), cut off at 1, is nearest to `wanted` (n, nu).

        Where what is wanted is 1 or beyond, any output beyond 1 will do: round by round of least squares, what is
        wanted there is what the output already is, at least 1.
        """
        at = self.layers(theta)
        h2 = self.forward(at, z).h2
        columns = np.hstack([h2, np.ones((len(h2), 1))])
        scale = np.maximum(np.sqrt(np.mean(columns**2, axis=0)), 1e-3)  # the straight units are small
        columns /= scale
        normal = columns.T @ columns + RIDGE * len(columns) * np.eye(columns.shape[1])
        solve = np.linalg.solve(normal, columns.T)
        beyond, side = np.abs(wanted) >= 1.0, np.sign(wanted)
        found = solve @ wanted
        for _ in range(ROUNDS if beyond.any() else 0):
            now = columns @ found
            found = solve @ np.where(beyond, side * np.maximum(side * now, 1.0), wanted)
        found /= scale[:, None]
        at.W3[:], at.b3[:] = found[:-1].T, found[-1]
