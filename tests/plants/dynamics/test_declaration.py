"""What `vary` takes works, and what it refuses it refuses in words; a sample of tests/campaigns/vary_names.py."""

import dataclasses
import pickle

import casadi as ca
import numpy as np
import pytest
import vary_names

from pliant.plants import Environment, FlexibleSpacecraft, Hinge, SingleLinkArm, Sun, Surface, TwoLinkArm
from pliant.plants.core import parameters

ARM, CRAFT = TwoLinkArm.textbook(), FlexibleSpacecraft.textbook()
LIT = dataclasses.replace(
    CRAFT,
    hub=dataclasses.replace(CRAFT.hub, surfaces=(Surface(area=2.0, normal=(1.0, 0.0, 0.0)),)),
    environment=Environment(sun=Sun(direction=(0.0, 0.6, 0.8))),
)


def test_a_sample_of_the_campaign():
    seeds = {n: [k for k, pair in enumerate(vary_names.pairs()) if pair[0] == n] for n in ("one rigid", "craft bare")}
    rows = [vary_names.run(k) for k in seeds["one rigid"][::4] + seeds["craft bare"][::12]]
    assert len(rows) > 10 and {row["became"] for row in rows} == {"works", "refused"}
    assert not [row for row in rows if row["fault"]], rows


def test_the_campaign_sees_a_parameter_without_effect(monkeypatch):
    """Of a plant whose `vary` forgets to put the symbol in, every function answers; `uses` then tells the two apart."""
    arm = dataclasses.replace(SingleLinkArm.textbook(), kinematics="rigid").vary("payload.mass")
    near, far = (vary_names.uses(arm, [m]) for m in (1.0, 2.0))
    assert vary_names.apart(near, near) == "" and vary_names.apart(near, far) == "dynamics"


@pytest.mark.parametrize(
    ("plant", "path", "words"),
    [
        (LIT, "hub.surfaces.0.normal.0", "part of a unit vector"),
        (LIT, "environment.sun.direction.2", "part of a unit vector"),
        (CRAFT, "hub.inertia.0", r"must be one number; name one of them, as 'hub.inertia.0.0'"),
        (CRAFT, "appendages.0.body.E", "vary its stiffness_factor instead"),
        (CRAFT, "appendages.0.orientation.0.0", "is not a physical quantity; choose from hub.mass, hub.inertia.0.0"),
        (ARM, "payload.offset", r"must be one number"),
        (ARM, "payload.mass.real", "float has no 'real'; no parts"),
        (ARM, "payload.offset.3", "tuple has no '3'; it holds 3"),
        (ARM, "", "TwoLinkArm has no ''"),
        (ARM, 0, "must be a string"),
        (ARM, ["payload.mass"], "must be a string"),
        (ARM, "kinematics", "is not a physical quantity"),
    ],
)
def test_what_cannot_be_varied_is_refused_by_vary(plant, path, words):
    with pytest.raises(ValueError, match=words):
        plant.vary(path)


def test_a_users_plant_that_is_built_by_its_value_is_told():
    @dataclasses.dataclass(frozen=True, kw_only=True)
    class Gated(SingleLinkArm):
        gate: float = parameters.quantity("1", "finite", 1.0)

        def __post_init__(self):
            super().__post_init__()
            if self.gate > 2:
                raise ValueError("gate")

    made = Gated(**{f.name: getattr(SingleLinkArm.textbook(), f.name) for f in dataclasses.fields(SingleLinkArm)})
    with pytest.raises(ValueError, match=r"'gate' of Gated cannot be varied: its value decides how the plant is built"):
        made.vary("gate")


def test_a_product_of_inertia_is_varied_in_both_of_its_places():
    """The equations hold a symmetric tensor: as those of a hub that is built with it."""
    rigid = dataclasses.replace(CRAFT, kinematics="rigid", appendages=())
    I = ((200.0, 7.0, 0.0), (7.0, 150.0, 0.0), (0.0, 0.0, 180.0))
    built = dataclasses.replace(rigid, hub=dataclasses.replace(rigid.hub, inertia=I))
    x = rigid.state(rate_x=0.1, rate_y=-0.2, rate_z=0.3)
    for path in ("hub.inertia.0.1", "hub.inertia.1.0"):
        varied = rigid.vary("hub.mass", path)
        found = varied.dynamics(x, p=[rigid.hub.mass, 7.0])
        np.testing.assert_allclose(found, built.dynamics(x), rtol=1e-13, atol=1e-16)
        assert varied.natural_frequencies(p=[rigid.hub.mass, 7.0]).size == 0


@pytest.mark.parametrize("drive", ["motion", "torque", "angle", "free"])
def test_a_craft_with_one_input_and_a_hinge_without_axes_moves(drive):
    """It is the craft whose appendage is clamped; u has one entry, of which CasADi cuts no entries as a row."""
    wheel = dataclasses.replace(CRAFT.hub, wheels=(vary_names.plants()["craft busy"].hub.wheels[0],))
    parts = tuple(dataclasses.replace(CRAFT.appendages[0], modes=1, hinge=h) for h in (Hinge(drive=drive), Hinge()))
    hinged, clamped = (FlexibleSpacecraft(hub=wheel, appendages=(part,)) for part in parts)
    x = hinged.state(rate_x=0.1, eta1_1=0.01)
    np.testing.assert_array_equal(hinged.dynamics(x, [0.3]), clamped.dynamics(x, [0.3]))
    found = hinged.simulate(x, [0.3], [0.0, 0.1], audit=True)
    assert found.stats["energy_balance"] < 1e-9


@pytest.mark.every(6)
def test_casadi_function_has_names_derivatives_and_takes_every_kind(plant, random_state):
    f = plant.casadi()
    assert f.name_in() == ["t", "x", "u", "w", "p"] and f.name_out() == ["dx", "y"]
    assert [f.size1_in(k) for k in range(5)] == [1, plant.nx, plant.nu, plant.nw, 0]
    x, u = random_state(plant, 3), np.full(plant.nu, 0.1)
    dx, y = f(0.0, x, u, np.zeros(plant.nw), [])
    np.testing.assert_allclose(np.ravel(dx), plant.dynamics(x, u), rtol=1e-12, atol=1e-12 * np.abs(dx).max())
    np.testing.assert_allclose(np.ravel(y), plant.measure(x, u), rtol=1e-12, atol=1e-12 * np.abs(y).max())
    for kind in (ca.SX, ca.MX):
        z, v = kind.sym("z", plant.nx), kind.sym("v", plant.nu)
        g = ca.Function("g", [z, v], [ca.jacobian(f(x=z, u=v)["dx"], z)])  # t and w left out
        A = plant.jacobians(x, u)[0]
        np.testing.assert_allclose(np.array(g(x, u)), A, rtol=1e-9, atol=1e-9 * np.abs(A).max())


def test_a_parameter_of_the_casadi_function_is_not_zero_where_it_is_left_out():
    f, x = ARM.vary("payload.mass").casadi(), np.zeros(ARM.nx)
    assert np.isnan(np.array(f(x=x)["dx"])).any()
    expected = ARM.vary("payload.mass").dynamics(x, p=[2.0])
    np.testing.assert_allclose(np.ravel(f(x=x, p=2.0)["dx"]), expected, rtol=1e-10)


def test_casadi_function_stands_in_a_users_program():
    """The torques that hold an arm, found by Opti with the plant inside: weights times arms, from statics."""
    arm = dataclasses.replace(ARM, reduction="rigid")
    opti = ca.Opti()
    u = opti.variable(2)
    x = np.zeros(arm.nx)
    opti.subject_to(arm.casadi()(x=x, u=u)["dx"][2:] == 0)
    opti.solver("ipopt", {"print_time": False}, {"print_level": 0, "sb": "yes"})
    _, u0 = arm.equilibrium(theta1=0.0, theta2=0.0)
    np.testing.assert_allclose(opti.solve().value(u), u0, rtol=1e-7)


def test_the_casadi_function_travels():
    f, x = ARM.casadi(), np.full(ARM.nx, 0.01)
    same = pickle.loads(pickle.dumps(f))
    np.testing.assert_array_equal(np.array(same(x=x)["dx"]), np.array(f(x=x)["dx"]))
