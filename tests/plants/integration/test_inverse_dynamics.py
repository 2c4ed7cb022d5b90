"""Inputs by inverse dynamics: what they do to the plant they were made for, one time and many at once."""

import dataclasses
from dataclasses import dataclass

import casadi as ca
import numpy as np
import pytest

from pliant.plants import LagrangianPlant, LargeDeflectionBeam, Plant, Signal, TwoLinkArm
from pliant.plants.integration.inverse_dynamics import InverseDynamics
from pliant.plants.integration.minimum_jerk import minimum_jerk

RIGID = TwoLinkArm.textbook().ladder()[0]
BEGIN, END = np.array([-1.2, 0.4, 0.0, 0.0]), np.array([0.3, 1.1, 0.0, 0.0])


def test_the_rigid_arm_makes_the_minimum_jerk_motion():
    law, times = RIGID.rest_to_rest(BEGIN, END, 0.8), np.linspace(0.0, 1.0, 11)
    assert isinstance(law, InverseDynamics)
    motion = RIGID.simulate(BEGIN, law, times, rtol=1e-10, atol=1e-12)
    s, ds, _ = minimum_jerk(times / 0.8)
    np.testing.assert_allclose(motion.x[:, :2], BEGIN[:2] + np.outer(s, (END - BEGIN)[:2]), atol=1e-9)
    np.testing.assert_allclose(motion.x[:, 2:], np.outer(ds, (END - BEGIN)[:2]) / 0.8, atol=1e-8)


def test_many_times_at_once_are_each_by_itself():
    law, times = InverseDynamics(RIGID, BEGIN, END, 0.8), np.array([0.0, 0.13, 0.79, 0.8, 0.9])
    one_by_one = np.array([law(float(t)) for t in times])
    scale = np.abs(one_by_one).max()
    np.testing.assert_allclose(law.at_times(times), one_by_one, rtol=0, atol=1e-13 * scale)
    np.testing.assert_allclose(law.at_times(times[::-1]), one_by_one[::-1], rtol=0, atol=1e-13 * scale)  # any order
    np.testing.assert_array_equal(law.at_times(np.array([0.8, 2.0])), np.array([law(0.8), law(5.0)]))
    assert law.at_times(times[:0]).shape == (0, 2)


def test_a_simulation_asks_for_all_stages_together():
    class Told(InverseDynamics):
        asked = 0

        def __call__(self, t):
            raise AssertionError("one by one")

        def at_times(self, times):
            self.asked += 1
            return self._inputs(times)

    law, times = Told(RIGID, BEGIN, END, 0.8), np.linspace(0.0, 0.7, 8)
    plain = RIGID.simulate(BEGIN, lambda t: InverseDynamics(RIGID, BEGIN, END, 0.8)(t), times)
    np.testing.assert_allclose(RIGID.simulate(BEGIN, law, times).x, plain.x, atol=1e-12)
    assert law.asked > 1


def test_inputs_that_reach_no_coordinate_are_refused():
    beam = LargeDeflectionBeam.textbook()
    with pytest.raises(ValueError, match=r"one coordinate each: the 2 of LargeDeflectionBeam .* drive none"):
        dataclasses.replace(beam, modes=3).rest_to_rest(np.zeros(6), np.zeros(6), 1.0)


UPRIGHT = pytest.mark.filterwarnings("ignore::pliant.plants.core.errors.UnstableRestWarning")  # the link stands up
ROTOR, LINK, SPRING, WEIGHT = 0.5, 2.5, 800.0, 30.0  # kg m^2, kg m^2, N m/rad, N m


@dataclass(frozen=True, kw_only=True)
class ElasticJoint(LagrangianPlant):
    """A motor that carries a link against its weight through a spring; `loose`: a wheel on it that nothing ties."""

    spring: float = SPRING
    loose: bool = False
    coordinates = property(
        lambda self: (Signal("motor", "rad"), Signal("link", "rad"), *([Signal("wheel", "rad")] * self.loose))
    )
    inputs = (Signal("torque", "N m"),)
    disturbances = ()
    outputs = (Signal("height", "1"),)
    label = "elastic joint"

    def kinetic_energy(self, q, v):
        wheel = 0.1 * (v[1] + v[2]) ** 2 if self.loose else 0.0
        return 0.5 * ROTOR * v[0] ** 2 + 0.5 * LINK * v[1] ** 2 + wheel

    def potential_energy(self, q):
        return 0.5 * self.spring * (q[0] - q[1]) ** 2 + WEIGHT * ca.sin(q[1])

    def dissipation(self, q, v):
        return 0.5 * 2.0 * (v[0] - v[1]) ** 2

    def generalized_force(self, t, q, v, u, w):
        return ca.vertcat(u, *[0] * (len(self.coordinates) - 1))

    def output(self, t, x, u, w):
        return ca.sin(x[1])


def moved(plant, time):
    """(rest at motor = 0, at 1, inputs, samples of them over the motion)."""
    held = {"wheel": 0.0} if plant.loose else {}
    begin, end = (plant.equilibrium(motor=value, **held)[0] for value in (0.0, 1.0))
    u = plant.rest_to_rest(begin, end, time)
    return begin, end, u, u.at_times(np.linspace(0, time, 101))[:, 0]


@UPRIGHT
def test_a_link_behind_a_spring_is_carried_with_its_weight():
    """A stiff spring: (J_m + J_l) theta'' + W cos(theta) at the wanted angle."""
    s, _, dds = minimum_jerk(np.linspace(0, 1, 101))
    _, _, _, torque = moved(ElasticJoint(spring=1e7), 1.5)
    np.testing.assert_allclose(torque, (ROTOR + LINK) * dds / 1.5**2 + WEIGHT * np.cos(s), atol=1e-3)


@UPRIGHT
def test_an_elastic_joint_arrives_with_little_swing():
    """The spring twists by (J_l theta'' + W cos) / k, not by the whole way."""
    plant = ElasticJoint()
    begin, end, u, torque = moved(plant, 1.5)
    assert np.abs(torque).max() < 1.2 * (WEIGHT + (ROTOR + LINK) * 5.78 / 1.5**2)  # 10 / sqrt(3), the largest s''
    motion = plant.simulate(begin, u, np.linspace(0, 1.5, 4))
    np.testing.assert_allclose(motion.x[-1], end, atol=0.05)
    np.testing.assert_allclose(u(2.0), [WEIGHT * np.cos(end[1])], rtol=1e-9)  # rests there


@UPRIGHT
def test_what_nothing_ties_is_left_to_its_bearing():
    """A wheel without friction on the link (0.2 kg m^2) stays behind as the link turns: the same torque without it."""
    (*_, alone), (*_, carrying) = moved(ElasticJoint(), 1.5), moved(ElasticJoint(loose=True), 1.5)
    np.testing.assert_allclose(carrying, alone, rtol=1e-9)


def test_no_rest_along_the_way_is_told():
    """W sin(link) holds what the motor pulls with, 40 N m/rad, up to 0.75 rad of it."""

    class Torn(ElasticJoint):
        def potential_energy(self, q):
            return -WEIGHT * ca.cos(q[1]) - 40.0 * q[0] * q[1]

    with pytest.raises(ValueError, match=r"link of Torn .*, which no input drives, has none at 0\.7\d of it"):
        Torn().rest_to_rest(np.zeros(4), np.array([1.0, 0, 0, 0]), 1.0)
    assert Torn().rest_to_rest(np.zeros(4), np.array([0.6, 0, 0, 0]), 1.0)(1.0).shape == (1,)


@dataclass(frozen=True, kw_only=True)
class PoleOnCart(Plant):
    """A cart of 2 kg and a point of 0.5 kg on a pole of 1 m from upright, solved for the accelerations: the push is in
    both of them, and no joint can be read. `late`: the push comes through an amplifier of first order.
    """

    late: bool = False
    states = property(
        lambda self: (
            *(Signal(n, u) for n, u in (("pole", "rad"), ("cart", "m"), ("pole_w", "rad/s"), ("cart_v", "m/s"))),
            *([Signal("amplified", "N")] * self.late),
        )
    )
    inputs = (Signal("push", "N"),)
    disturbances = ()
    outputs = (Signal("tip", "m"),)
    label = "pole"

    def ode(self, t, x, u, w):
        sine, cosine = ca.sin(x[0]), ca.cos(x[0])
        force = x[4] if self.late else u
        a = (force + 0.5 * sine * (x[2] ** 2 - 9.81 * cosine)) / (2 + 0.5 * sine**2)
        return ca.vertcat(x[2], x[3], 9.81 * sine - a * cosine, a, *([(u - force) / 0.01] * self.late))

    def output(self, t, x, u, w):
        return x[1] + ca.sin(x[0])


def test_what_changes_is_moved_where_no_joint_can_be_read():
    """The pole leans so that it is carried, tan(lean) = x''/g up to its own lean's acceleration: push = 2.5 x''."""
    plant, time = PoleOnCart(), 20.0
    u = plant.rest_to_rest(np.zeros(4), np.array([0.0, 1.0, 0.0, 0.0]), time)
    s = np.linspace(0, 1, 21)
    wanted = 2.5 * minimum_jerk(s)[2] / time**2
    np.testing.assert_allclose(u.at_times(time * s)[:, 0], wanted, rtol=2e-2, atol=1e-3 * np.abs(wanted).max())
    with pytest.raises(ValueError, match=r"drive none; move 1 coordinates instead of 2, name those driven in `joints`"):
        plant.rest_to_rest(np.zeros(4), np.array([0.1, 1.0, 0.0, 0.0]), time)


def test_inputs_that_lose_what_they_move_are_told():
    """A push does not turn a level pole, and at once nothing through an amplifier."""
    with pytest.raises(
        ValueError, match=r"inputs that accelerate pole, .* of PoleOnCart \(pole\) do not at 0\.5 of it"
    ):
        PoleOnCart().rest_to_rest(np.array([np.pi, 0.0, 0.0, 0.0]), np.zeros(4), 1.0)
    with pytest.raises(ValueError, match=r"accelerate cart, each as is wanted, .* do not at 0 of it"):
        PoleOnCart(late=True).rest_to_rest(np.zeros(5), np.array([0.0, 1.0, 0.0, 0.0, 0.0]), 1.0)
