"""What the library asks of a plant beside its equations: where it is driven, measured, bent, drawn and uncertain.

Every answer has a default that is read from the equations, never from names, so that a plant that a user writes needs
none of them; one that knows better overrides what it knows. Answers are names of the plant's own signals.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import casadi as ca
import numpy as np

from pliant.plants.core import parameters
from pliant.plants.core.casadi_functions import pattern
from pliant.plants.core.signals import Joint, Sensed, Unfelt, names
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.exact_rotations.planar_chain import PlanarChain
from pliant.plants.integration.inverse_dynamics import InverseDynamics
from pliant.plants.validity.ranges import Range

from .declaration import Array, Declaration
from .residual_jacobians import ForceBalance

MOST_MATCHED = 6  # inputs whose coordinates are told apart by what they accelerate most
PINION = 0.05  # [m], radius of the wheel by which an encoder reads a length


@dataclass(frozen=True, kw_only=True)
class PhysicsContract(Declaration):
    """What a plant says of its fidelities: the physics they are judged by, how their motions are its own."""

    def physics(self, more: int = 0) -> Self:
        """The richest model of this machine, by which its fidelities are judged, with `more` shapes than it has by
        itself, which may be below 0. Default: the finest of the ladder, whatever `more` is."""
        return self.ladder()[-1]

    @property
    def effects(self) -> dict[str, bool]:
        """{effect of physics, in words: whether this variant has it}. Default: none are told apart."""
        return {}

    def without(self, effect: str) -> Self:
        """This model without an effect, in the same states if it can; itself if it lacks it, ValueError for others."""
        known = self.effects
        if effect not in known:
            raise ValueError(f"{type(self).__name__}.without: effect {effect!r} is not one of its effects")
        return self._lacking(effect) if known[effect] else self

    def _lacking(self, effect: str) -> Self:
        """This model, which has it, without one of its effects. No default: who names effects knows."""
        raise NotImplementedError(f"{type(self).__name__}.effects names {effect!r}, _lacking must take it away")

    @property
    def unmodelled(self) -> tuple[str, ...]:
        """What even `physics` leaves out, in words. Default: what every variant of the ladder does."""
        return ("what every variant of its ladder leaves out",)

    @property
    def stiff(self) -> bool:
        """Whether its fastest modes, which its motions do not show, bound explicit steps by stability. Default: no."""
        return False

    def estimates(self, motion: Trajectory) -> dict[str, tuple[Self, ...]]:
        """{effect that even `physics` leaves out: plants that move as this one with it would on a motion of this plant,
        first about so, of other parameters, then truly, where one can}. Default: nothing is estimated.
        """
        return {}

    def sparing(self, motion: Trajectory, compared: tuple[str, ...], within: float) -> tuple[Self, ...]:
        """Rungs with no more shapes than outputs of this plant's motion need to be `within`. Default: none."""
        return ()

    @property
    def left_out(self) -> float:
        """Where `physics` has no more shapes to add: what those do that are not known of, as a share of what the last
        that is known does. Dimensionless; default: as much.
        """
        return 1.0

    @property
    def planar_chain(self) -> PlanarChain | str:
        """The machine as links in a plane, which other programs know too; or why it is none, in words."""
        return "its machine is not told as a planar chain of beams"

    @property
    def force_balance(self) -> ForceBalance | None:
        """Its equations of motion M a = r as they stand, where they are known as such. Default: None."""
        return None

    def embedding(self, simpler: PhysicsContract) -> Array:
        """E (nx, nx of `simpler`): states E x of this model move as x of a simpler one. Default: those of one name."""
        have = {s.name: k for k, s in enumerate(simpler.states)}
        E = np.zeros((len(self.states), len(have)))
        for k, s in enumerate(self.states):
            if s.name in have:
                E[k, have[s.name]] = 1.0
        return E

    def state_jacobians_along(self, nominal: Trajectory, *, p: Any = None) -> Array:
        """A (nt, nx, nx) at the nodes of any nominal, in the plant's own states; see `linearize_along`."""
        own: Any = self  # of `Plant`
        w = nominal.w if nominal.w is not None else np.zeros((len(nominal.t), self.nw))
        return np.asarray(own._jacobians_along(nominal, w, p)[0])

    def _state_jacobians(self, x: Array, u: Array, p: Any) -> list[Array]:
        """[A, B] at one point."""
        own: Any = self
        found: list[Array] = own.jacobians(x, u, p=p)[:2]
        return found


@dataclass(frozen=True, kw_only=True)
class PlantContract(PhysicsContract):
    """The questions and their defaults; every `Plant` answers them."""

    @cached_property
    def rates(self) -> dict[str, str]:
        """{coordinate: its rate}, both states, in the order of the coordinates: where dx_i/dt is x_j itself."""
        rate, x = self.expressions[0], self.symbols[1]
        known = {x[j].element_hash(): j for j in range(x.shape[0])}
        entries = [rate[i] for i in range(x.shape[0])]
        found = [known.get(e.element_hash(), i) if e.nnz() else i for i, e in enumerate(entries)]
        word = names(self.states)
        return {word[i]: word[j] for i, j in enumerate(found) if i != j}

    def _sound_rate(self, x: Array, results: list[Array]) -> Array:
        """dx/dt from what `_dynamics` gave at states x; raises where the equations have lost their meaning there."""
        return results[0]

    @property
    def velocities(self) -> tuple[str, ...]:
        """States that are rates: where one is not zero, something moves."""
        return tuple(self.rates.values())

    @property
    def output_rates(self) -> dict[str, str]:
        """{output: the output or state that is its rate}, as far as the plant has one. Default: none."""
        return {}

    @cached_property
    def repeated(self) -> tuple[str, ...]:
        """States that an output repeats, under whatever name."""
        y, x = self.expressions[1], self.symbols[1]
        given = {y[i].element_hash() for i in range(y.shape[0]) if y[i].nnz()}
        return tuple(s.name for i, s in enumerate(self.states) if x[i].element_hash() in given)

    @property
    def prescribed(self) -> tuple[str, ...]:
        """Coordinates whose acceleration is an input. Default: none."""
        return ()

    @property
    def lockable(self) -> tuple[str, ...]:
        """Coordinates that a goal which names them holds, so that natural frequencies are told with them locked."""
        return tuple(name for name in self.rates if name not in self.prescribed)

    @property
    def shared_joints(self) -> tuple[Joint, ...]:
        """Coordinates that all inputs drive together, where there is not one for each; their `input` is "". Default:
        none.
        """
        return ()

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """For each input that drives one coordinate: the input, the coordinate and its rate, in the inputs' order.

        Default: the one of the cheapest fidelity that it accelerates most (B = M^-1: the matching of largest product is
        true, b_ij^2 <= b_ii b_jj); where a spring moves that one here, or there are more, what it accelerates alone."""
        rigid: Any = self.ladder()[0]
        known, nu = {*names(self.states), *names(self.outputs)}, len(self.inputs)
        pairs = tuple(rigid.rates.items())
        if len(pairs) != nu or len(rigid.states) != 2 * nu or not {n for pair in pairs for n in pair} <= known:
            return self._alone()
        order: tuple[int, ...] = tuple(range(nu))
        if 1 < nu <= MOST_MATCHED:
            rows = [names(rigid.states).index(rate) for _, rate in pairs]
            B = np.abs(rigid.jacobians(rigid.consistent(np.zeros(2 * nu)))[1][rows])
            order = max(itertools.permutations(order), key=lambda p: math.prod(B[i, k] for k, i in enumerate(p)))
        matched = tuple(Joint(s.name, *pairs[i]) for s, i in zip(self.inputs, order, strict=True))
        at, felt = names(self.states), pattern(self.expressions[0], self.symbols[2])
        moved = [k for k, one in enumerate(matched) if one.rate in at and not felt[at.index(one.rate), k]]
        return self._alone() if moved else matched

    def _alone(self) -> tuple[Joint, ...]:
        """The inputs that stand in the equation of one rate alone, each with a coordinate of its own."""
        at, felt = names(self.states), pattern(self.expressions[0], self.symbols[2])
        found = []
        for k, s in enumerate(self.inputs):
            on = np.flatnonzero(felt[:, k])
            pairs = [pair for pair in self.rates.items() if len(on) == 1 and at.index(pair[1]) == on[0]]
            found += [Joint(s.name, *pair) for pair in pairs]
        positions = [joint.position for joint in found]
        return tuple(joint for joint in found if positions.count(joint.position) == 1)

    def rest_to_rest(
        self, begin: Array, end: Array, time: float, *, profile: str = "minimum-jerk"
    ) -> Callable[[float], Array]:
        """u(t) (nu,) that takes this plant from the rest state `begin` (nx,) to `end` (nx,) in `time` [s].

        Default: every coordinate (where there are fewer inputs, every joint, and what is tied to it follows) moves by
        the same profile, "minimum-jerk", "jerk-limited" or "bang-bang". ValueError where the inputs do not reach them.
        """
        return InverseDynamics(self, begin, end, time, profile)

    def ranges(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX, y: ca.SX) -> tuple[Range, ...]:
        """What must stay small for this plant's kinematics to hold, as expressions of what a motion stores (y the
        outputs). Default: nothing is stated.
        """
        return ()

    def statics(self) -> ca.SX | None:
        """Net generalised forces (n,) on the coordinates, in the order of `rates`, in the plant's symbols.

        With all rates zero their zeros are the plant's rests. Default: None, not known as forces.
        """
        return None

    def natural_frequencies(self, x0: Any = None, *, locked: tuple[str, ...] = (), p: Any = None) -> Array | None:
        """Undamped natural frequencies [rad/s] about a rest x0 with the `locked` coordinates held. Default: None,
        not known, as a mass matrix is needed.
        """
        return None

    def sensors(self) -> tuple[Sensed, ...]:
        """What such a machine carries, as on its data sheets. Default: an encoder at every joint (of a length, on a
        pinion of PINION).
        """
        units = {s.name: s.unit for s in (*self.states, *self.outputs)}
        positions = tuple(joint.position for joint in self.joints)
        return tuple(Sensed("encoder", n, scale=PINION if units[n] == "m" else 1.0) for n in positions)

    @property
    def deflections(self) -> tuple[str, ...]:
        """Outputs that tell how far the bodies bend, each by one number [m]. Default: none."""
        return ()

    @property
    def attitude_states(self) -> tuple[str, ...]:
        """The states of a unit quaternion, scalar first, which mean nothing one by one. Default: none.

        A plant that has them linearises in them with `linearize(.., attitude="quaternion")`.
        """
        return ()

    @property
    def attitude_outputs(self) -> tuple[str, ...]:
        """The outputs that tell the attitude, in the place of `attitude_states`. Default: none."""
        return ()

    @property
    def small_states(self) -> tuple[str, ...]:
        """States that random points keep within centimetres: mass matrices stay definite. Default: lengths, rates."""
        return tuple(s.name for s in self.states if s.unit in ("m", "m/s"))

    @property
    def uncertain(self) -> tuple[str, ...]:
        """Parameters that a robustness study varies. Default: every `quantity(.., uncertain=True)`, as payload.mass."""
        return parameters.quantities(self, uncertain=True)

    @property
    def stiffening(self) -> tuple[Self, Self] | None:
        """This plant without and with geometric stiffening, same states. Default: None, there is no such choice."""
        return None

    @property
    def unfelt(self) -> Unfelt:
        """States that may have no part in the stability of the rest. Default: none."""
        return Unfelt()

    @property
    def drawn_as(self) -> str:
        """Which renderer draws it: "links" (default), by `outline` in the plane; "tree", in space; "spacecraft"."""
        return "links"

    def outline(self, x: Array, points: int = 30) -> Array | list[Array]:
        """The bodies as lines (links, points, 2) [m], root first, at a state x (nx,). Default: nothing to draw."""
        return np.zeros((0, points, 2))

    @property
    def outline_axes(self) -> tuple[str, str]:
        """What the two coordinates of `outline` are called."""
        return "x", "y"

    @property
    def seen_from(self) -> str | None:
        """A state, the angle of a hub that the whole machine turns with; pictures may be seen from there."""
        return None

    @property
    def cycle(self) -> str | None:
        """A state, the angle after whose full turn the machine has gone through all its shapes."""
        return None
