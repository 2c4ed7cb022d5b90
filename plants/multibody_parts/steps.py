"""The way from a body's frame to that of one that hangs on it, in steps: turn, move, turn by a constant.

Motion goes down the tree: omega, alpha [rad/s, rad/s^2] of a frame and a [m/s^2], the acceleration of its origin less
gravity, in the frame's own axes, at zero accelerations of the coordinates. Forces (f, n) about the origin come up it,
and with them the inertia of all that hangs beyond.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import casadi as ca

from pliant.plants.core.quaternions import matrix

from .spatial import AROUND, ENTRIES, Array, Inertia, Motion, Wrench, upper


class Acting(NamedTuple):
    """A coordinate of the recursion that acts in a step: its key, and the unit vector that it turns about or moves
    along.
    """

    key: int
    along: Array


@dataclass(frozen=True)
class Spin:
    """A turn about x, y or z by an angle, of cosine c and sine s, at `rate`."""

    axis: int
    c: ca.SX
    s: ca.SX
    rate: ca.SX
    acting: Acting
    angle: ca.SX
    bias: ca.SX | None = None  # [rad/s^2] that is left of the angle's where its coordinates do not accelerate

    def _into(self, v: ca.SX, s: ca.SX) -> ca.SX:
        i, j = AROUND[self.axis]
        found = ca.SX(v)
        found[i], found[j] = self.c * v[i] - s * v[j], s * v[i] + self.c * v[j]
        return found

    def out(self, v: ca.SX) -> ca.SX:
        """From the axes beyond to those before."""
        return self._into(v, self.s)

    def within(self, v: ca.SX) -> ca.SX:
        """From the axes before to those beyond."""
        return self._into(v, -self.s)

    def down(self, motion: Motion) -> Motion:
        omega, alpha = self.within(motion.omega), self.within(motion.alpha)
        i, j = AROUND[self.axis]
        turned = ca.SX(alpha)
        turned[i], turned[j] = alpha[i] + omega[j] * self.rate, alpha[j] - omega[i] * self.rate
        if self.bias is not None:
            turned[self.axis] = alpha[self.axis] + self.bias
        spun = ca.SX(omega)
        spun[self.axis] = omega[self.axis] + self.rate
        return Motion(spun, turned, self.within(motion.a))

    def pushed(self, motion: Motion, given: dict[int, ca.SX]) -> Motion:
        """A motion beyond, with accelerations of the coordinates added."""
        alpha = ca.SX(motion.alpha)
        alpha[self.axis] += float(self.acting.along[self.axis]) * given[self.acting.key]
        return Motion(motion.omega, alpha, motion.a)

    def up(self, load: Wrench) -> Wrench:
        return Wrench(self.out(load.f), self.out(load.n))

    def work(self, load: Wrench) -> dict[int, ca.SX]:
        """Generalised forces of a wrench beyond."""
        return {self.acting.key: self.acting.along[self.axis] * load.n[self.axis]}

    def unit(self, body: Inertia) -> dict[int, Wrench]:
        """What unit accelerations of its coordinates take of the inertia beyond."""
        one, sign = body.turning(self.axis), float(self.acting.along[self.axis])
        return {self.acting.key: Wrench(sign * one.f, sign * one.n)}

    def lift(self, body: Inertia) -> Inertia:
        return Inertia(body.m, self.out(body.S), self.turned(body.matrix()))

    def turned(self, P: ca.SX) -> ca.SX:
        """Upper entries of P (3, 3), symmetric, in the axes before, by its double angle: with t = s d + 2 c o, d and o
        its difference and its product in the plane.
        """
        (i, j), k, P = AROUND[self.axis], self.axis, ca.SX(P)
        d, o = P[i, i] - P[j, j], P[i, j]
        t = self.s * d + 2 * self.c * o
        P[i, i], P[j, j] = P[i, i] - self.s * t, P[j, j] + self.s * t
        P[i, j] = P[j, i] = self.c * t - o
        ik, jk = self.c * P[i, k] - self.s * P[j, k], self.s * P[i, k] + self.c * P[j, k]
        P[i, k] = P[k, i] = ik
        P[j, k] = P[k, j] = jk
        return upper(P)


@dataclass(frozen=True)
class Ball:
    """A turn in space by a unit quaternion: R takes components from the axes beyond to those before; `rate` (3,) is the
    angular velocity relative to those, in the axes beyond, whose components the coordinates `keys` are.
    """

    quaternion: ca.SX
    rate: ca.SX
    keys: tuple[int, int, int]

    @cached_property
    def R(self) -> ca.SX:
        """(3, 3)."""
        return matrix(self.quaternion)

    def out(self, v: ca.SX) -> ca.SX:
        return self.R @ v

    def within(self, v: ca.SX) -> ca.SX:
        return self.R.T @ v

    def down(self, motion: Motion) -> Motion:
        omega, alpha, a = map(self.within, motion)
        return Motion(omega + self.rate, alpha + ca.cross(omega, self.rate), a)

    def pushed(self, motion: Motion, given: dict[int, ca.SX]) -> Motion:
        return Motion(motion.omega, motion.alpha + ca.vertcat(*[given[key] for key in self.keys]), motion.a)

    def up(self, load: Wrench) -> Wrench:
        return Wrench(self.out(load.f), self.out(load.n))

    def work(self, load: Wrench) -> dict[int, ca.SX]:
        return {key: load.n[i] for i, key in enumerate(self.keys)}

    def unit(self, body: Inertia) -> dict[int, Wrench]:
        return {key: body.turning(i) for i, key in enumerate(self.keys)}

    def lift(self, body: Inertia) -> Inertia:
        return Inertia(body.m, self.out(body.S), self.turned(body.matrix()))

    def turned(self, P: ca.SX) -> ca.SX:
        """Upper entries of P (3, 3), symmetric, in the axes before."""
        return upper(ca.densify(self.R @ P @ self.R.T))


@dataclass(frozen=True)
class Fixed:
    """A constant turn: R takes components from the axes beyond to those before."""

    R: ca.DM

    def out(self, v: ca.SX) -> ca.SX:
        return ca.densify(self.R @ v)

    def within(self, v: ca.SX) -> ca.SX:
        return ca.densify(self.R.T @ v)

    def down(self, motion: Motion) -> Motion:
        return Motion(*map(self.within, motion))

    def pushed(self, motion: Motion, given: dict[int, ca.SX]) -> Motion:
        return motion

    def up(self, load: Wrench) -> Wrench:
        return Wrench(self.out(load.f), self.out(load.n))

    def work(self, load: Wrench) -> dict[int, ca.SX]:
        return {}

    def unit(self, body: Inertia) -> dict[int, Wrench]:
        return {}

    def lift(self, body: Inertia) -> Inertia:
        return Inertia(body.m, self.out(body.S), self.turned(body.matrix()))

    def turned(self, P: ca.SX) -> ca.SX:
        """Upper entries of P (3, 3), symmetric, in the axes before."""
        return upper(ca.densify(self.R @ P @ self.R.T))


@dataclass(frozen=True)
class Move:
    """A shift by r (3,), that changes at `rate` and `bias` [m/s^2] in the axes before, which do not turn."""

    r: ca.SX
    rate: ca.SX
    bias: ca.SX
    acting: tuple[Acting, ...] = ()

    def out(self, v: ca.SX) -> ca.SX:
        return v

    def within(self, v: ca.SX) -> ca.SX:
        return v

    def down(self, motion: Motion) -> Motion:
        a = motion.a + motion.U @ self.r + 2 * ca.cross(motion.omega, self.rate) + self.bias
        return Motion(motion.omega, motion.alpha, a)

    def pushed(self, motion: Motion, given: dict[int, ca.SX]) -> Motion:
        more = sum((ca.SX(ca.DM(one.along)) * given[one.key] for one in self.acting), ca.SX.zeros(3))
        return Motion(motion.omega, motion.alpha, motion.a + more)

    def up(self, load: Wrench) -> Wrench:
        return Wrench(load.f, load.n + ca.cross(self.r, load.f))

    def work(self, load: Wrench) -> dict[int, ca.SX]:
        return {one.key: ca.dot(ca.SX(ca.DM(one.along)), load.f) for one in self.acting}

    def unit(self, body: Inertia) -> dict[int, Wrench]:
        return {one.key: body.sliding(one.along) for one in self.acting}

    def lift(self, body: Inertia) -> Inertia:
        m, S, r = body.m, body.S, self.r
        half = S + m * r / 2  # P + r S^T + S r^T + m r r^T
        P = [r[i] * half[j] + half[i] * r[j] for i, j in ENTRIES]
        return Inertia(m, S + m * r, body.P + ca.vertcat(*P))


Step = Spin | Ball | Fixed | Move
