import dataclasses
from dataclasses import dataclass

import casadi as ca
import numpy as np
import pytest
from hoist import Hoist

from pliant.envs import scenes
from pliant.plants import ElasticJoint, FlexibleTree, Joint, LagrangianPlant, Payload, Plant, Signal, TreeBody, check
from pliant.plants.contract import equations
from pliant.plants.contract.check import ContractError
from pliant.plants.dynamics.equilibrium import with_joints


@dataclass(frozen=True, kw_only=True)
class Pendulum(LagrangianPlant):
    """Of one metre; `fault` breaks one clause."""

    fault: str = ""
    coordinates = property(lambda self: (Signal("angle", "rad"),))
    inputs = property(lambda self: (Signal("torque", "N m"),))
    disturbances = property(lambda self: ())
    label = property(lambda self: "pendulum")

    @property
    def outputs(self):
        return (Signal("tip_x", "m"),) * (2 if self.fault == "twice" else 1)

    def kinetic_energy(self, q, v):
        return 0.5 * v[0] ** 2 * (-1 if self.fault == "mass" else 1) + (v[0] ** 3 if self.fault == "cubic" else 0)

    def potential_energy(self, q):
        return -9.81 * ca.cos(q[0])

    def dissipation(self, q, v):
        return 0.1 * v[0] ** 2 * (-1 if self.fault == "dissipation" else 1)

    def generalized_force(self, t, q, v, u, w):
        return u

    def output(self, t, x, u, w):
        if self.fault == "kink":
            return ca.fabs(x[0] * 1e-12)
        return ca.vertcat(ca.sin(x[0]), *([x[0]] if self.fault == "size" else []))

    def ladder(self):
        short = dataclasses.replace(self, fault="" if self.fault == "labels" else "twice")
        return (self, short) if self.fault in ("labels", "rungs") else (self,)

    def outline(self, x, points=30):
        line = np.outer(np.linspace(0, 1, 5 if self.fault == "outline" else points), [np.sin(x[0]), -np.cos(x[0])])
        return line[None]

    @property
    def deflections(self):
        return ("bend",) if self.fault == "names" else ()


class Bent(Pendulum):
    """Its Jacobians are written by hand, wrongly."""

    def jacobians(self, x, u=None, **given):
        found = super().jacobians(x, u, **given)
        return [found[0] * 1.001, *found[1:]]


@pytest.mark.parametrize(
    ("plant", "words"),
    [
        (Pendulum(fault="twice"), "outputs has tip_x more than once"),
        (Pendulum(fault="size"), "output has 2 entries, must have 1"),
        (Pendulum(fault="mass"), "mass matrix of pendulum is not positive definite"),
        (Pendulum(fault="cubic"), "it must be quadratic in the rates"),
        (Pendulum(fault="dissipation"), "dissipation gives .* W at x = .* it must be >= 0"),
        (Pendulum(fault="labels"), "ladder\\(\\) has 'pendulum' more than once, must have a label for each rung"),
        (Pendulum(fault="rungs"), "the outputs of 'pendulum' stand in another order"),
        (Pendulum(fault="outline"), r"outline\(x, 7\) has lines of shape \(5, 2\), must be"),
        (Pendulum(fault="names"), "deflections names 'bend', must be one of: tip_x"),
        (Bent(), r"d\(rate of angle_rate\)/d\(angle\) in A is .* differences give"),
    ],
)
def test_each_clause_is_told_in_words(plant, words):
    with pytest.raises(ContractError, match=words) as told:
        check(plant)
    assert isinstance(told.value, ValueError) and all("\n" not in fault for fault in told.value.faults)


def test_what_a_method_raises_is_a_fault_of_the_plant():
    class Failing(Pendulum):
        def sensors(self):
            raise KeyError("angle")

    with pytest.raises(ContractError, match="names: KeyError: 'angle'"):
        check(Failing())


def test_a_sound_plant_is_told_what_was_found():
    found = dict(check(Pendulum()).found)
    assert found["names"] == "torque drives angle; sensors: encoder of angle" and found["ladder"] == "one rung"
    assert "put in less the power lost" in found["energy"] and "energy" in str(check(Pendulum()))


@pytest.mark.parametrize("name", list(scenes.SCENES))
@pytest.mark.every(4)
def test_shipped_plants_keep_the_contract(name):
    check(scenes.get(name).plant, points=2)


KINDS, BASES = ("revolute", "spherical", "prismatic", "planar", "free"), ("fixed", "free", "driven")


def jointed(seed):
    """Two bodies; over the seeds every kind of joint, drive and base, with springs, gears and weight by chance."""
    rng = np.random.default_rng(seed)
    bodies = []
    for k in range(2):
        kind = KINDS[(seed + k * (1 + seed // 5)) % len(KINDS)]
        axis, offset = rng.normal(size=3), rng.uniform(-0.3, 0.3, 3)
        single = kind in ("revolute", "prismatic")
        drive = ("torque", "none" if kind == "free" else "acceleration", "none")[(seed + 2 * k) % 3]
        gear = ElasticJoint(stiffness=50.0, damping=0.1, ratio=5.0, rotor_inertia=1e-3)
        joint = Joint(
            name=f"j{k}",
            kind=kind,
            axis=tuple(axis / np.linalg.norm(axis)),
            position=tuple(offset),
            rotation=tuple(rng.uniform(-1, 1, 3)),
            stiffness=float(rng.choice([0.0, 7.0])),
            damping=float(rng.choice([0.0, 0.3])),
            drive=drive,
            elastic=gear if single and drive == "torque" and rng.random() < 0.5 else None,
        )
        inertia = np.diag(rng.uniform(0.05, 0.09, 3)) + 0.005
        bodies.append(
            TreeBody(
                name=f"b{k}",
                joint=joint,
                mass=float(rng.uniform(0.5, 2)),
                centre=tuple(rng.uniform(-0.3, 0.3, 3)),
                inertia=tuple(map(tuple, inertia.tolist())),
            )
        )
    base = BASES[seed % 3]
    given = {"platform": Payload(mass=3.0, inertia=0.4, offset=(0.1, 0.0, -0.05))} if base != "fixed" else {}
    if base == "driven":
        given["base_freedoms"] = [("turn_x", "turn_y", "turn_z"), ("x", "turn_z"), ("x", "y", "z")][seed % 5 % 3]
    weight = tuple(rng.choice([0.0, 1.0]) * np.array([0.5, -1.0, -9.0]))
    return FlexibleTree.serial(bodies, base=base, gravity=weight, **given)


@pytest.mark.parametrize("seed", range(20))
def test_trees_of_every_joint_and_base_keep_the_contract(seed):
    """Quaternions are states of unit length alone; a base whose motion is given needs no mass."""
    check(jointed(seed), points=2, seed=seed)


def test_a_base_that_is_turned_needs_no_mass_of_its_own():
    bodies = [TreeBody(name="a", joint=Joint(name="a"), mass=1.0, centre=(0.4, 0, 0), inertia=0.05)]
    turned = FlexibleTree.serial(bodies, base="driven", base_freedoms=("turn_x", "turn_y", "turn_z"))
    assert np.linalg.eigvalsh(turned.mass_matrix(turned.rest_state))[0] < 1e-12  # about the arm's own line ..
    assert dict(check(turned).found)["mass matrix"] == "symmetric, positive definite"  # .. but not in the joint


def test_an_energy_is_known_to_its_rounding_and_at_states():
    """Of weights about their places at rest it is a difference of large ones, and quaternions are of unit length."""
    for name, kinematics in (("crane-swing", "stiffened"), ("satellite-arm", "rigid")):
        tree = dataclasses.replace(scenes.get(name).plant, kinematics=kinematics)
        _, wrong = equations.energy_balance(tree, equations.points(tree, 4, 0))
        assert not wrong
        assert not list(equations.wrong_outline(tree, equations.points(tree, 4, 0)))


@dataclass(frozen=True, kw_only=True)
class Spring(Plant):
    """A cart on a spring, as plain dynamics; `gain` > 0 puts energy in."""

    gain: float = 0.0
    states = property(lambda self: (Signal("v", "m/s"), Signal("x", "m")))
    inputs = property(lambda self: (Signal("force", "N"),))
    disturbances = property(lambda self: ())
    outputs = property(lambda self: (Signal("place", "m"),))
    label = property(lambda self: "cart")

    def ode(self, t, x, u, w):
        return ca.vertcat(u - 4 * x[1] + self.gain * x[0], x[0])

    def output(self, t, x, u, w):
        return x[1]

    def energy(self, x, *, p=None):
        return 0.5 * x[0] ** 2 + 2 * x[1] ** 2


def test_plain_dynamics_in_any_order_of_states():
    """The coordinate and what drives it are read from the equations; without a ladder it is its own."""
    cart = Spring()
    assert cart.rates == {"x": "v"} and [(j.input, j.position) for j in cart.joints] == [("force", "x")]
    assert cart.ladder() == (cart,) and dict(check(cart).found)["energy"] == "energy does not grow without an input"
    with pytest.raises(ContractError, match=r"energy grows by .* without an input"):
        check(Spring(gain=0.5))


def test_a_machine_that_is_never_at_zero_says_where_it_is():
    with pytest.raises(ContractError, match=r"not positive definite.*let `rest_state` give a state that it can have"):
        check(Hoist(at_home=False))
    assert "finite at rest" in str(check(Hoist()))
    points = equations.points(Hoist(), 64, 0)
    assert max(abs(point["x"][0] - 4.0) for point in points) <= 0.5  # an eighth of it
    x, u = Hoist().equilibrium(with_joints(Hoist(), {"sway": 0.0}))
    assert np.allclose(x, [4, 0, 0, 0]) and np.allclose(u, [-9.81, 0])  # the rope as it is at home


@pytest.mark.parametrize("rest", [np.zeros(3), [0.0, np.nan, 0.0, 0.0], "there"])
def test_a_rest_that_is_no_state_is_told(monkeypatch, rest):
    monkeypatch.setattr(Hoist, "rest_state", rest)
    with pytest.raises(ContractError, match=r"rest_state is .* must be an array \(4,\) of finite numbers"):
        check(Hoist())
