"""Energies, equations of motion and outputs of a beam whose coordinates are its strains and where its root is.

T = (1/2) rho A L^3 sum W_ab t_a' . t_b' + turning of the sections + payload, V = strain energy - gravity; V is zero at
rest without weight, the root at the origin. See `rooted_points` for W, `strain_fields` for the strains.

Source   J. C. Simo and L. Vu-Quoc, "On the dynamics of flexible beams under large overall motions - the plane case",
         J. Appl. Mech. 53 (1986), 849-863; in space Comput. Methods Appl. Mech. Eng. 66 (1988), 125-161
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

from pliant.plants.core.parameters import is_symbolic
from pliant.plants.exact_rotations.quadrature import Points

from .planar_frames import PlanarFrames
from .rest_shape import RestShape
from .section_frames import Motion, SectionFrames
from .spatial_frames import SpatialFrames
from .strain_fields import StrainFields
from .tip_loads import TipLoads


@dataclass(frozen=True, eq=False)
class StrainedBeam:
    """Functions of q, v (n,) and loads (k,), as expressions."""

    frames: SectionFrames
    loads: TipLoads
    gravity: tuple[Any, ...]  # [m/s^2]

    @property
    def _g(self) -> ca.SX:
        return ca.SX(ca.vertcat(*self.gravity[: self.frames.d]))

    @property
    def _loaded(self) -> bool:
        return is_symbolic(self.frames.payload.mass) or self.frames.payload.mass != 0.0

    @property
    def _zero(self) -> ca.SX:
        return ca.SX.zeros(self.frames.strains.n)

    def _places(self, q: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
        """Mean position, tip, and the payload from the tip, (d,) each [m]."""
        own, t = self.frames, self.frames.beam.length * self.frames.tangents(q)
        carried = own.tip_frame(q) @ ca.vertcat(*own.payload.offset[: own.d]) if self._loaded else ca.SX.zeros(own.d)
        return t @ ca.DM(own.points.first_moment), t @ ca.DM(own.points.weight), carried

    def potential_energy(self, q: ca.SX) -> ca.SX:
        mean, tip, carried = (here - rest for here, rest in zip(self._places(q), self._places(self._zero)))
        fallen = self.frames.beam.mass * mean
        if self._loaded:
            fallen += self.frames.payload.mass * (tip + carried)
        return self.frames.strains.strain_energy(self.frames.beam, q) - ca.dot(self._g, fallen)

    def kinetic_energy(self, q: ca.SX, v: ca.SX) -> ca.SX:
        own, beam = self.frames, self.frames.beam
        at = own.at(q, v)
        T = beam.mass * beam.length**2 * at.kinetic() + at.turning_energy()
        if self._loaded:
            velocity = beam.length * at.sum_rate(own.points.weight) + at.carried_rate
            T += own.payload.mass * ca.sumsqr(velocity) / 2
        return T

    def dissipation(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """Rayleigh function [W] of the Kelvin-Voigt damping of all strains."""
        return self.frames.beam.damping * self.frames.strains.strain_energy(self.frames.beam, v)

    def _acting(self, at: Motion, loads: ca.SX) -> ca.SX:
        """Weight and loads on the coordinates (n,)."""
        own, points, L = self.frames, self.frames.points, self.frames.beam.length
        place = L * at.sum_jacobian(points.weight)
        acting = own.beam.mass * L * (at.sum_jacobian(points.first_moment).T @ self._g)
        acting += self.loads.generalised(loads, place, at.turning, at.frame)
        if self._loaded:
            acting += own.payload.mass * ((place + at.carried()[1]).T @ self._g)
        return acting

    def generalized_force(self, q: ca.SX, loads: ca.SX) -> ca.SX:
        """Of the loads alone (n,)."""
        at = self.frames.at(q, self._zero)
        place = self.frames.beam.length * at.sum_jacobian(self.frames.points.weight)
        return self.loads.generalised(loads, place, at.turning, at.frame)

    def statics(self, q: ca.SX, loads: ca.SX) -> tuple[ca.SX, ca.SX]:
        """(elastic forces, weight and loads) on the coordinates (n,); at rest they cancel."""
        elastic = self.frames.strains.elastic_force(self.frames.beam, q, self._zero)
        return elastic, self._acting(self.frames.at(q, self._zero), loads)

    def equations(self, q: ca.SX, v: ca.SX, loads: ca.SX) -> tuple[ca.SX, ca.SX]:
        """(M, r) with M q'' = r."""
        own, beam, at = self.frames, self.frames.beam, self.frames.at(q, v)
        M, r = at.inertia()
        M = M + beam.mass * beam.length**2 * at.mass()
        r = r - beam.mass * beam.length**2 * at.inertia_force() + own.strains.elastic_force(beam, q, v)
        r += self._acting(at, loads)
        if self._loaded:
            _, J, bias = at.carried()
            J = beam.length * at.sum_jacobian(own.points.weight) + J
            M += own.payload.mass * (J.T @ J)
            r -= own.payload.mass * (J.T @ (beam.length * at.sum_bias(own.points.weight) + bias))
        return M, r

    def balance(self, q: ca.SX, v: ca.SX, a: ca.SX, loads: ca.SX) -> ca.SX:
        """r - M a (n,) at accelerations a (n,) in the plane, where T = |dz/dt|^2/2 with z(q) = `inertial_places`."""
        assert isinstance(self.frames, PlanarFrames)
        z, turned = self.frames.inertial_places(q), self.frames.tip_rotation(q)
        second = ca.jtimes(ca.jtimes(z, q, v), ca.vertcat(q, v), ca.vertcat(v, a))
        acting = self.loads.acting(loads, self._places(q)[1], turned, self.frames.tip_frame(q), q)
        lost = ca.gradient(self.dissipation(q, v), v)
        return acting - ca.gradient(self.potential_energy(q), q) - lost - ca.jtimes(z, q, second, True)

    def output(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """What `LargeDeflectionBeam` lists as its outputs."""
        own, strains = self.frames, self.frames.strains
        tip, start, rest = self._places(q)[1], q[strains.slices["root"]], self._places(self._zero)[1]
        rate = ca.jtimes(tip, q, v)
        c, s, turning = ca.SX(1), ca.SX(0), q[: strains.travels + strains.bend.rotating]
        if strains.turns >= 0:
            c, s = ca.cos(q[strains.turns]), ca.sin(q[strains.turns])
        from_root = tip[:2] - start[:2] if strains.travels else tip[:2]
        across = c * from_root[1] - s * from_root[0] - rest[1]
        turned = own.tip_rotation(q)
        bent = strains.of("bend", q, 0 * self.frames.along.xi[:1]) / own.beam.length
        rates = [ca.jtimes(e, q, v) for e in (across, turned)]
        out = [turning, tip[:2], tip[:2] - rest[:2], rate[:2], turned, across, *rates, bent]
        if isinstance(own, SpatialFrames):
            out += [tip[2], rate[2], own.twisted(q)]
        return ca.vertcat(*out)


def of_declaration(plant: Any, along: Points) -> StrainedBeam:
    """That of a beam by its fields: shapes from its nominal parameters, known at the points `along`."""
    own, counts = plant.nominal, plant.strain_counts
    bend, flap = own._rotations
    travels = sum(s.unit == "m" for s in own.root_coordinates)
    strains = StrainFields(
        bend, None if own.planar else flap, own.twists, counts["stretches"], counts["shears"], own.segments, travels
    )
    kind = PlanarFrames if own.planar else SpatialFrames
    rest = RestShape(plant.rest_curvature, plant.beam.length)
    return StrainedBeam(kind(plant.beam, plant.payload, strains, rest, along, plant.rotary), plant.loads, plant.gravity)
