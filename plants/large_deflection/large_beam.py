"""A beam that bends as far as it likes: clamped, hinged, driven, carried or free, a payload and loads at its tip.

States   q = [root_x, root_y (root_z) [m] where the root travels, hub_angle or root_angle where it turns, bend1 ..
         bendn], x = [q; dq/dt]; angles in rad. In space (planar=False) flaps (about y) and twists follow the bends,
         which are about z, as is the root's turn; then stretch1 .., shear1 .. (shear_z1 ..) [1] where they are strains
Inputs   tip_force_x, tip_force_y (tip_force_z) [N] and tip_moment (_x, _y, _z) [N m] in inertial axes,
         follower_force_x, .. [N] in the tip's, as `tip_loads` says. With a driven root hub_acceleration [rad/s^2], with
         a moving one root_x_acceleration, root_y_acceleration (root_z_acceleration) [m/s^2] and
         root_angle_acceleration [rad/s^2] are inputs, and the loads disturbances
Outputs  tip position, displacement from the beam at rest along x and its rate [m, m/s]; rotation of the tip's section
         [rad] and its rate; tip deflection across the root's direction, less that at rest, and its rate; the root's
         place and angle where it moves; curvature about z at the root, less that at rest [1/m]. In space tip_z, its
         rate, and the tip's twist: past what bending brings ("strain"), or the sub-beams' sum. Of a spatial beam of
         strains the tip's rotation and twist are integrals of the curvatures about the sections' own z and x
Valid    inextensible unless `extensible`, unshearable unless theory="timoshenko"; sections keep their rotary inertia.
         "strain": any rotation in the plane; in space below one turn against the root, any of a beam of strains.
         "substructured": rotations within a sub-beam small, see `sub_beam_chain`. How small each is meant: `ranges`
Source   "Substructuring Technique for Dynamics Analysis of Flexible Beams with Large Deformation", Eqs (1)-(39)
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any, Self, TypeVar

import casadi as ca
import numpy as np

from pliant.plants.beam_strains import fidelities
from pliant.plants.beams.section import Beam
from pliant.plants.core.argument_gates import real_array, require_finite, shown
from pliant.plants.core.casadi_functions import last_call
from pliant.plants.core.imports import linalg
from pliant.plants.core.parameters import is_symbolic
from pliant.plants.dynamics.arguments import line_points, one_state
from pliant.plants.dynamics.plant_contract import PhysicsContract
from pliant.plants.dynamics.residual_jacobians import Differentiated
from pliant.plants.exact_rotations.planar_chain import PlanarChain
from pliant.plants.exact_rotations.quadrature import Array
from pliant.plants.exact_rotations.tangent_sums import TangentSums
from pliant.plants.validity.ranges import Range

from .cross_sections import PlanarSections
from .declaration import BASES, MOST_TWISTS, LargeBeamDeclaration
from .fields import NodalBalance, nodal_balance, ranges_of_fields

PHYSICS_SHAPES = 5  # that physics has by itself
BeamT = TypeVar("BeamT")
LADDER = (  # kinematics, segments, modes
    ("strain", 1, 1),
    ("strain", 1, 2),
    ("substructured", 1, 2),
    ("strain", 1, 3),
    ("strain", 1, 4),
    ("substructured", 2, 2),
    ("strain", 1, 6),
    ("substructured", 3, 2),
    ("strain", 1, 8),
    ("substructured", 4, 2),
)


@dataclass(frozen=True, kw_only=True)
class LargeDeflectionBeam(LargeBeamDeclaration):
    """rho A L^3 W dt/dq . (dt/dq q'' + t'') + rho I L S q'' + (E I/L) K (q + damping q') = gravity + tip force.

    With extension, shear, a curvature at rest, other loads at the tip or a root that travels the coordinates are
    strains, see `plants/beam_strains`; `kinematics` is then "strain".

    Example
    -------
    >>> beam = Beam(length=78.54, area=1.0, I_y=1/12, I_z=1/12, J=1/6, density=1.0, E=1e7, G=5e6)
    >>> bend = LargeDeflectionBeam(beam=beam, planar=False, rest_curvature=0.01, modes=6, twists=5, gravity=(0, 0, 0))
    >>> x, u = bend.equilibrium(tip_force_z=600.0)
    >>> y = dict(zip((s.name for s in bend.outputs), bend.measure(x, u)))
    >>> print(round(y["tip_z"], 2))  # of 45 degrees of radius 100
    53.47
    """

    @classmethod
    def textbook(cls) -> Self:
        """The paper's example: a 10 m cantilever, straight along x and at rest, that gravity pulls down from t = 0.

        E = 68.95 GPa, Poisson's ratio 0.33, density 2766.7 kg/m^3, A = 7.3e-5 m^2, I = 8.218e-9 m^4 about y and z.
        Natural modes: no force bends its tip, and let go it swings in them (see `basis`).
        """
        E, I = 68.95e9, 8.218e-9
        beam = Beam(length=10.0, area=7.3e-5, I_y=I, I_z=I, J=2 * I, density=2766.7, E=E, G=E / (2 * 1.33))
        return cls(beam=beam, basis="modes")

    def ladder(self) -> tuple[Self, ...]:
        """Rotation fields with one to eight shapes and chains of sub-beams; in space twice the twists last. With more
        than bending: first without extension and shear.
        """
        return fidelities.ladder(self) if self.strained else _ladder_of_rotations(self)

    def physics(self, more: int = 0) -> Self:
        """Exact rotations, extension and shear, with `more` than five shapes; in space as many twists as shapes."""
        modes = min(PHYSICS_SHAPES + more, BASES[self.rotation_basis])
        twists = min(modes, MOST_TWISTS) if not self.planar else self.twists
        return dataclasses.replace(self, modes=modes, twists=twists, **fidelities.richest(self, more))

    @property
    def effects(self) -> dict[str, bool]:
        return fidelities.effects(self)

    def _lacking(self, effect: str) -> Self:
        return dataclasses.replace(self, **fidelities.lacking(effect))

    @property
    def unmodelled(self) -> tuple[str, ...]:
        return fidelities.unmodelled(self)

    @property
    def planar_chain(self) -> PlanarChain | str:
        return fidelities.planar_chain(self)

    def embedding(self, simpler: PhysicsContract) -> Array:
        """Turns of the root and twists as they are, curvatures projected: (nx, simpler.nx)."""
        if not (isinstance(simpler, LargeBeamDeclaration) and simpler.kinematics == self.kinematics == "strain"):
            return super().embedding(simpler)
        if self.strained or simpler.strained:
            return np.kron(np.eye(2), fidelities.embedding(self, simpler))
        bend, flap = (own.embedding(other) for own, other in zip(self._rotations, simpler._rotations))
        blocks = [bend] if self.planar else [bend, flap, np.eye(self.twists, simpler.twists)]
        return np.kron(np.eye(2), linalg.block_diag(*blocks))

    @property
    def _loaded(self) -> bool:
        return is_symbolic(self.payload.mass) or self.payload.mass != 0.0

    @property
    def _g(self) -> ca.SX:
        return ca.SX(ca.vertcat(*self.gravity[: 2 if self.planar else 3]))

    def _tip(self, at: TangentSums) -> ca.SX:
        return self.beam.length * at.sum(self.fields.tangents.points.weight)

    def kinetic_energy(self, q: ca.SX, v: ca.SX) -> ca.SX:
        if self.strained:
            return self.strained_beam.kinetic_energy(q, v)
        beam, at = self.beam, self.fields.tangents.at(q, v)
        T = beam.mass * beam.length**2 * at.kinetic() + self.fields.sections.kinetic(q, v)
        if self._loaded:
            velocity = beam.length * at.sum_rate(self.fields.tangents.points.weight)
            velocity += ca.jtimes(self.fields.sections.carried(q), q, v)
            T += self.payload.mass * ca.sumsqr(velocity) / 2
        return T

    def potential_energy(self, q: ca.SX) -> ca.SX:
        if self.strained:
            return self.strained_beam.potential_energy(q)
        beam, at = self.beam, self.fields.tangents.at(q, ca.SX.zeros(q.shape[0]))
        straight = ca.DM.zeros(at.d)
        straight[0] = 1.0
        moved = at.sum(self.fields.tangents.points.first_moment) - straight / 2
        fallen = beam.mass * beam.length * moved
        if self._loaded:
            offset = ca.vertcat(*self.payload.offset[: at.d])
            away = self._tip(at) + self.fields.sections.carried(q) - beam.length * straight - offset
            fallen += self.payload.mass * away
        return self.fields.sections.strain_energy(q) - ca.dot(self._g, fallen)

    def dissipation(self, q: ca.SX, v: ca.SX) -> ca.SX:
        if self.strained:
            return self.strained_beam.dissipation(q, v)
        return self.fields.sections.dissipation(q, v)

    def generalized_force(self, t: ca.SX, q: ca.SX, v: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX:
        if self.strained:
            return self.strained_beam.generalized_force(q, w if self.driven else u)
        tip = self._tip(self.fields.tangents.at(q, v))
        return ca.jtimes(tip, q, w if self.root == "driven" else u, True)

    @last_call
    def equations(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
        """What the base class derives from the energies, from the positions' Jacobians: a fraction of the size."""
        n = len(self.coordinates)
        q, v = x[:n], x[n:]
        if self.strained:
            M, r = self.strained_beam.equations(q, v, w if self.driven else u)
            return M, r, ca.bilin(M, v, v) / 2, self.potential_energy(q)
        beam, at, points = self.beam, self.fields.tangents.at(q, v), self.fields.tangents.points
        M, r = self.fields.sections.inertia(q, v)
        M = M + beam.mass * beam.length**2 * at.mass()
        r = r - beam.mass * beam.length**2 * at.inertia_force() + self.fields.sections.elastic_force(q, v)
        r += beam.mass * beam.length * (at.sum_jacobian(points.first_moment).T @ self._g)
        tip = beam.length * at.sum_jacobian(points.weight)
        r += tip.T @ (w if self.root == "driven" else u)
        if self._loaded:
            carried = self.fields.sections.carried(q)
            J = tip + ca.jacobian(carried, q)
            bias = beam.length * at.sum_bias(points.weight) + ca.jtimes(ca.jtimes(carried, q, v), q, v)
            M += self.payload.mass * (J.T @ J)
            r += self.payload.mass * (J.T @ (self._g - bias))
        return M, r, ca.bilin(M, v, v) / 2, self.potential_energy(q)

    @last_call
    def solved(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> tuple[ca.SX, list[ca.SX]]:
        """In the turns of nodes where that takes fewer operations: in the plane without payload."""
        if (found := self._in_nodes(x, u, ca.SX(len(self.coordinates), 1))) is None:
            return super().solved(t, x, u, w)
        a, pivots = self.acceleration(found.M, found.lacking, u)
        return found.back @ a, pivots

    def _in_nodes(self, x: ca.SX, u: ca.SX, a: ca.SX) -> NodalBalance | None:
        if self.strained or self._loaded or self.driven:
            return None
        n = a.shape[0]
        return nodal_balance(self.beam, self.fields, self._g, x[:n], x[n:], a, u)

    def _differentiated(self) -> Differentiated:
        _, x, u, w, _ = self.symbols
        a = ca.SX.sym("a", len(self.coordinates))
        if (found := self.symbolic._in_nodes(x, u, a)) is None:
            return super()._differentiated()
        rates, change = ca.vertcat(self.coordinate_rates(x), a), found.change(ca.vertcat(x, u, w))
        return Differentiated(a, rates, change, self._motion[0][a.shape[0] :])

    def output(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX) -> ca.SX:
        n = self.coordinates_slice.stop
        q, v = x[:n], x[n:]
        if self.strained:
            return self.strained_beam.output(q, v)
        at = self.fields.tangents.at(q, v)
        tip, rate = self._tip(at), self.beam.length * at.sum_rate(self.fields.tangents.points.weight)
        turning = [] if self.root == "clamped" else [q[0]]
        c, s, turn = (1, 0, 0) if self.root == "clamped" else (ca.cos(q[0]), ca.sin(q[0]), v[0])
        across = c * tip[1] - s * tip[0]
        across_rate = c * rate[1] - s * rate[0] - turn * (c * tip[0] + s * tip[1])
        moved = (tip[0] - self.beam.length, tip[1], rate[:2])
        sections = self.fields.sections
        turned = sections.tip_rotation(q)
        bent = ca.dot(ca.DM(self.fields.root_curvature), q) / self.beam.length
        out = [*turning, tip[:2], *moved, turned, across, across_rate, ca.jtimes(turned, q, v), bent]
        if not isinstance(sections, PlanarSections):
            out += [tip[2], rate[2], sections.tip_twist(q)]
        return ca.vertcat(*out)

    def ranges(self, t: ca.SX, x: ca.SX, u: ca.SX, w: ca.SX, y: ca.SX) -> tuple[Range, ...]:
        """Small strains; in space rotations below one turn, or of a chain small turns within each sub-beam."""
        n = self.coordinates_slice.stop
        if self.strained:
            given = (u, w) if self.driven else (u[:0], u)
            return fidelities.ranges(self, x[:n], x[n:], *given)
        spin = x[n] ** 2 if self.root != "clamped" else ca.SX(0)
        return ranges_of_fields(self, x[:n], spin, w if self.root == "driven" else u)

    def outline(self, x: Array, points: int = 60) -> Array:
        """The bent beam from root to tip at a state x (nx,): inertial positions (1, points, 2 or 3) [m]."""
        return self.positions(x, np.linspace(0.0, 1.0, line_points(self, points)))[None]

    def positions(self, x: Array, xi: Array) -> Array:
        """Positions (k, 2), in space (k, 3), [m] of the axis at xi (k,) in [0, 1], else ValueError; state x (nx,)."""
        x, name = one_state(self, x), f"{type(self).__name__}.positions.xi"
        xi = require_finite(name, np.atleast_1d(real_array(name, xi)), (-1,))
        if xi.size and not (xi.min() >= 0 and xi.max() <= 1):
            raise ValueError(f"{name} = {shown(xi)} must be within [0, 1]")
        own: Any = self.nominal
        tangents = own.strained_beam.frames if self.strained else self.fields.tangents
        return own.beam.length * tangents.points.cumulative(xi) @ tangents.values(x[self.coordinates_slice])


def _ladder_of_rotations(beam: BeamT) -> tuple[BeamT, ...]:
    own: Any = beam
    steps: list[BeamT] = []
    for kinematics, segments, modes in LADDER:
        steps.append(dataclasses.replace(own, kinematics=kinematics, segments=segments, modes=modes, points=None))
    if not own.planar:
        last: Any = steps[-1]
        steps.append(dataclasses.replace(last, twists=min(max(2 * own.twists, 1), MOST_TWISTS)))
    return tuple(steps)
