"""What acts on the tip of a beam: a force and a moment in inertial axes, a follower force in the tip section's axes.

Moments in space are no gradient of an energy: what they do depends on the way that the tip has turned.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from pliant.plants.core.signals import Signal

LOADS = ("force", "moment", "follower")


@dataclass(frozen=True)
class TipLoads:
    """Kinds of loads, in their order in the inputs."""

    kinds: tuple[str, ...]
    planar: bool

    @property
    def signals(self) -> tuple[Signal, ...]:
        """tip_force_x, .. [N], tip_moment or tip_moment_x, .. [N m], follower_force_x, .. [N]."""
        found = []
        for kind in self.kinds:
            stem, unit = {
                "force": ("tip_force", "N"),
                "moment": ("tip_moment", "N m"),
                "follower": ("follower_force", "N"),
            }[kind]
            if kind == "moment" and self.planar:
                found.append(Signal(stem, unit))
            else:
                found += [Signal(f"{stem}_{axis}", unit) for axis in ("xy" if self.planar else "xyz")]
        return tuple(found)

    def _parts(self, loads: ca.SX) -> dict[str, ca.SX]:
        """{kind: its components} of the inputs (k,)."""
        found, start = {}, 0
        for kind in self.kinds:
            size = 1 if kind == "moment" and self.planar else 2 if self.planar else 3
            found[kind] = loads[start : start + size]
            start += size
        return found

    def generalised(self, loads: ca.SX, place: ca.SX, turning: ca.SX, frame: ca.SX) -> ca.SX:
        """Q (n,) of loads (k,): `place` (d, n) the tip's Jacobian, `turning` that of its spin, `frame` its axes."""
        parts = self._parts(loads)
        force = parts.get("force", ca.SX.zeros(place.shape[0]))
        if "follower" in parts:
            force = force + frame @ parts["follower"]
        Q = place.T @ force
        return Q + turning.T @ parts["moment"] if "moment" in parts else Q

    def acting(self, loads: ca.SX, tip: ca.SX, turned: ca.SX, frame: ca.SX, q: ca.SX) -> ca.SX:
        """The same in the plane without Jacobians: `tip` (2,) its place, `turned` its angle."""
        parts = self._parts(loads)
        force = parts.get("force", ca.SX.zeros(2))
        if "follower" in parts:
            force = force + frame @ parts["follower"]
        Q = ca.jtimes(tip, q, force, True)
        return Q + ca.jtimes(turned, q, parts["moment"], True) if "moment" in parts else Q

    def pull(self, loads: ca.SX) -> ca.SX:
        """Magnitudes of the forces, added [N]."""
        parts = self._parts(loads)
        return sum((ca.norm_2(parts[kind]) for kind in ("force", "follower") if kind in parts), ca.SX(0))
