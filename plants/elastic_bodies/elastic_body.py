"""What a tree asks of a body that bends, in the axes of its root: kinetic energy, strain, places to hang on.

With coordinates eta (n,), S = int p dm, P = int p p^T dm of its points p(eta), a body that turns at omega, its root
moving at v, has T = m v^2/2 + v . (omega x S + S') + omega . J omega/2 + omega . H + eta' . M eta'/2, J = tr(P) 1 - P.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import casadi as ca

from pliant.plants.multibody_parts.spatial import Inertia, Motion, Wrench
from pliant.plants.multibody_parts.tree_beam import Section

Place = float | str  # x/L along a beam, or the name of a node


class ElasticBody(ABC):
    """A body whose points are functions of n coordinates."""

    @property
    @abstractmethod
    def n(self) -> int:
        """How many coordinates."""

    @abstractmethod
    def inertia(self, eta: ca.SX) -> Inertia:
        """m, S and P."""

    @abstractmethod
    def coupling(self, eta: ca.SX) -> list[Wrench]:
        """Force and moment at the root that a unit acceleration of each coordinate takes."""

    @abstractmethod
    def mass(self, eta: ca.SX) -> ca.SX:
        """M (n, n)."""

    @abstractmethod
    def inertial(self, motion: Motion, U: ca.SX, eta: ca.SX, rate: ca.SX) -> tuple[Wrench, ca.SX]:
        """What moves the root so ((f, n) there) and what the coordinates take (n,), at zero accelerations of these."""

    @abstractmethod
    def section(self, place: Place, eta: ca.SX, rate: ca.SX) -> Section:
        """Where something hangs."""

    @abstractmethod
    def resistance(self, eta: ca.SX, rate: ca.SX) -> ca.SX:
        """Forces of strain and of its damping (n,), against the motion."""

    @abstractmethod
    def strain_energy(self, eta: ca.SX) -> ca.SX:
        """[J]."""

    @abstractmethod
    def dissipation(self, rate: ca.SX) -> ca.SX:
        """Rayleigh's function [W]."""

    @abstractmethod
    def readings(self, eta: ca.SX, rate: ca.SX) -> list[ca.SX]:
        """Of a beam: deflections of its end across its root's direction along y and z [m], their rates, curvatures at
        the root in x-y and x-z [1/m]. Of modal data: the watched point's deflection (x, y, z) and its rate.
        """

    @abstractmethod
    def line(self, eta: ca.SX, points: int) -> ca.SX:
        """For drawing (3, points) [m], as an expression of eta (n,)."""
