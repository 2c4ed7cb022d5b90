"""Plants M dv/dt = r whose coordinates q may hold unit quaternions: dq/dt is v but there, where it is Xi omega / 2.

States   x = [q; v]; one coordinate more than speeds for each quaternion
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from pliant.plants.core.argument_gates import require_by_name
from pliant.plants.core.casadi_functions import NumericFunction, built_once
from pliant.plants.core.errors import EquilibriumError
from pliant.plants.core.quaternions import rates
from pliant.plants.core.signals import Signal, Unfelt, names
from pliant.plants.dynamics.equilibrium import RestConditions
from pliant.plants.dynamics.lagrangian import LagrangianPlant

from .attitude_plant import AttitudePlant
from .deviations import Attitude
from .rests import TurnedForces, stiffness

Array = np.ndarray


@dataclass(frozen=True, kw_only=True)
class TurningPlant(AttitudePlant, LagrangianPlant):
    """M(q) dv/dt = r(t, q, v, u, w). Without quaternions it is a LagrangianPlant like others."""

    @property
    @abstractmethod
    def speeds(self) -> tuple[Signal, ...]:
        """v, in order."""

    @property
    @abstractmethod
    def turns(self) -> tuple[tuple[str, int, int], ...]:
        """(name, first of its coordinates, first of its speeds) of each quaternion."""

    @property
    def held(self) -> Mapping[str, float]:
        """Coordinates of which no force knows, as a free machine's place: held by `equilibrium` unless named.

        Values are in [m] and [-].
        """
        return {}

    @cached_property
    def attitudes(self) -> tuple[Attitude, ...]:
        """The quaternions."""
        n = len(self.coordinates)
        return tuple(Attitude(name, q, n + v) for name, q, v in self.turns)

    @property
    def states(self) -> tuple[Signal, ...]:
        return (*self.coordinates, *self.speeds)

    @cached_property
    def deviations(self) -> tuple[Signal, ...]:
        """The states of its linear models."""
        found = [Signal("", "")] * self.small.n
        for k in self.small.kept:
            found[self.small.at(k)] = self.states[k]
        for a in self.attitudes:
            found[self.small.turn(a)] = [Signal(f"{a.name}_turn_{c}", "rad") for c in "xyz"]
            found[self.small.spin(a)] = [Signal(f"{a.name}_turn_{c}_rate", "rad/s") for c in "xyz"]
        return tuple(found)

    @cached_property
    def rates(self) -> dict[str, str]:
        """Of coordinates that are no parts of quaternions."""
        n, spins = len(self.coordinates), [k for a in self.attitudes for k in range(a.omega, a.omega + 3)]
        own = [k for k in self.small.kept if k < n]
        after = [k for k in range(n, self.nx) if k not in spins]
        return {self.states[i].name: self.states[j].name for i, j in zip(own, after, strict=True)}

    @property
    def velocities(self) -> tuple[str, ...]:
        """Of its linear models too."""
        return tuple(dict.fromkeys((*names(self.speeds), *names(self.deviations[-len(self.speeds) :]))))

    @property
    def prescribed(self) -> tuple[str, ...]:
        known, given = {s.name: i for i, s in enumerate(self.speeds)}, self.driven
        own = tuple(name for name, rate in self.rates.items() if known[rate] in given)
        turned = (a for a, (_, _, v) in zip(self.attitudes, self.turns, strict=True) if v in given)
        return (*own, *(s.name for a in turned for s in self.states[a.quaternion]))

    @property
    def lockable(self) -> tuple[str, ...]:
        return tuple(name for name in self.rates if name not in {*self.prescribed, *self.held})

    @property
    def attitude_outputs(self) -> tuple[str, ...]:
        return tuple(f"{a.name}_attitude_{c}" for a in self.attitudes for c in "xyz")

    def coordinate_rates(self, x: ca.SX) -> ca.SX:
        n = len(self.coordinates)
        v, parts, q, at = x[n:], [], 0, 0
        for _, first, spin in self.turns:
            parts += [v[at : at + first - q], rates(x[first : first + 4]) @ v[spin : spin + 3] / 2]
            q, at = first + 4, spin + 3
        return ca.vertcat(*parts, v[at:])

    def rest_conditions(self, p: Any = None) -> RestConditions:
        return TurnedForces(self, p) if self.attitudes else super().rest_conditions(p)

    def equilibrium(
        self,
        fixed: Mapping[str, float] | None = None,
        *,
        guess: Mapping[str, float] | None = None,
        p: Any = None,
        **named: float,
    ) -> tuple[Array, Array]:
        """A rest point as in Plant.equilibrium. The search begins with nothing turned, and where that finds none with
        one joint that turns in space turned a quarter; place and attitude of a free base are held, at zero where they
        are not named. `fixed` and `guess` as there. The state (nx,) and the inputs (nu,).
        """
        first = {self.states[a.q].name: 1.0 for a in self.attitudes}
        given = first | ({} if guess is None else dict(require_by_name("equilibrium.guess", guess)))
        fixed = {} if fixed is None else require_by_name("equilibrium.fixed", fixed)
        held = {**self.held, **fixed, **named}
        try:
            return super().equilibrium(held, guess=given, p=p)
        except EquilibriumError:
            for turned in self._quarter_turns({*held, *(guess or {})}):
                with suppress(EquilibriumError):
                    return super().equilibrium(held, guess=given | turned, p=p)
            raise

    def _quarter_turns(self, known: set[str]) -> Iterator[dict[str, float]]:
        """Guesses of one attitude at a time, of those that are not known: a quarter about each axis, either way."""
        half = float(np.sqrt(0.5))
        for attitude in self.attitudes:
            scalar, *vector = names(self.states[attitude.quaternion])
            if known.isdisjoint((scalar, *vector)):
                yield from ({scalar: half, name: sign * half} for name in vector for sign in (1.0, -1.0))

    @built_once
    def _stiffness(self) -> NumericFunction:
        return stiffness(self)

    @property
    def unfelt(self) -> Unfelt:
        """Place and attitude of a free base, in states or deviations; coordinates in given motion."""
        given = (*self.prescribed, *(self.rates[name] for name in self.prescribed if name in self.rates))
        if not self.held:
            return Unfelt((), given if self.attitudes else ())
        places = tuple(name for name in self.rates if name in self.held)
        turned = [a for a in self.attitudes if self.states[a.q].name in self.held]
        quaternions = tuple(s.name for a in turned for s in self.states[a.quaternion])
        return Unfelt((places, quaternions, tuple(f"{a.name}_turn_{c}" for a in turned for c in "xyz")), given)
