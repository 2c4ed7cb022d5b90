"""Rest points: held coordinates, solved torques, static deflections, and what cannot rest."""

import dataclasses
import warnings

import numpy as np
import pytest

from pliant.plants import (
    ElasticJoint,
    EquilibriumError,
    FlexibleTree,
    Joint,
    Payload,
    SingleLinkArm,
    TreeBody,
    TwoLinkArm,
)
from pliant.plants.core.errors import UnstableRestWarning
from pliant.plants.dynamics.equilibrium import with_joints

ARM = TwoLinkArm.textbook()


def test_nothing_moves_at_an_equilibrium(arm):
    plant = arm
    angles = {s.name: 0.3 for s in plant.states[: plant.nu]}
    x0, u0 = plant.equilibrium(angles)
    rate = plant.dynamics(x0, u0)
    A = plant.jacobians(x0, u0)[0]
    assert np.abs(rate).max() < 1e-9 * max(1.0, np.abs(A).max() * np.abs(x0).max())
    assert [x0[i] for i in range(plant.nu)] == [0.3] * plant.nu
    np.testing.assert_allclose(x0[plant.nx // 2 :], 0.0, atol=1e-15)


def test_torques_are_those_of_the_static_moments():
    rigid = dataclasses.replace(ARM, reduction="rigid")
    _, u0 = rigid.equilibrium(theta1=0.4, theta2=-1.1)
    g, m, mj, mp = 9.81, ARM.link1.mass, ARM.joint_mass, ARM.payload.mass
    outer = g * (m / 2 + mp) * np.cos(0.4 - 1.1)
    inner = g * (m / 2 + mj + m + mp) * np.cos(0.4)
    np.testing.assert_allclose(u0, [inner + outer, outer], rtol=1e-12)


def test_sag_of_a_level_link_is_the_cantilevers():
    """m g under its own weight and the payload's: rho A g L^4/(8 E I) + m g L^3/(3 E I)."""
    arm = dataclasses.replace(SingleLinkArm.textbook(), gravity=9.81, basis="polynomial", modes=3, kinematics="linear")
    x0, u0 = arm.equilibrium(hub_angle=0.0)
    EI = arm.link.EI
    sag = 9.81 * arm.link.linear_density / (8 * EI) + 9.81 * arm.payload.mass / (3 * EI)
    assert arm.measure(x0)[1] == pytest.approx(-sag, rel=1e-10)
    assert u0[0] == pytest.approx(9.81 * (arm.link.mass / 2 + arm.payload.mass), rel=1e-10)


def test_without_held_coordinates_the_inputs_stay_as_given():
    x0, u0 = ARM.equilibrium(guess={"theta1": -1.5, "theta2": 0.1})
    np.testing.assert_array_equal(u0, [0.0, 0.0])
    assert x0[0] == pytest.approx(-np.pi / 2, abs=1e-9) and x0[1] == pytest.approx(0.0, abs=1e-8)
    x0, u0 = ARM.equilibrium(tau1=3.0, tau2=0.5, guess={"theta1": -1.5})
    np.testing.assert_array_equal(u0, [3.0, 0.5])
    assert np.abs(ARM.dynamics(x0, u0)).max() < 1e-6


def test_no_equilibrium_is_told_with_its_residual():
    with pytest.raises(EquilibriumError, match=r"no equilibrium of .*tau1.* remains; hold as many") as caught:
        ARM.equilibrium(tau1=1000.0, tau2=0.0)
    assert caught.value.residual > 1e-3
    with pytest.raises(EquilibriumError, match="no equilibrium"):
        ARM.equilibrium(theta1=0.0, theta2=0.0, q11=0.05, q21=0.0)  # more held than there are inputs


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"theta3": 0.0}, "state or input 'theta3' must be one of theta1, theta2"),
        ({"theta1": np.nan}, "equilibrium.*theta1.* = nan must be a finite number"),
    ],
)
def test_bad_names_and_values(given, message):
    with pytest.raises(ValueError, match=message):
        ARM.equilibrium(given)


def test_varied_parameters_shift_the_equilibrium():
    arm = ARM.vary("payload.mass")
    held = {"theta1": 0.2, "theta2": 0.1}
    for mass in (0.5, 1.5):
        heavier = dataclasses.replace(ARM, payload=dataclasses.replace(ARM.payload, mass=mass))
        for ours, theirs in zip(arm.equilibrium(held, p=[mass]), heavier.equilibrium(held)):
            np.testing.assert_allclose(ours, theirs, rtol=1e-9, atol=1e-13)


@pytest.mark.every(2)
@pytest.mark.parametrize("factor", [1.0, 1e2, 1e4, 1e6])
def test_stiff_polynomial_modes_do_not_hide_the_torque(factor):
    """The holding torque of a stiff arm tends to the rigid one; the difference falls as 1 / E."""
    arm = TwoLinkArm.textbook()
    link = dataclasses.replace(arm.link1, E=factor * arm.link1.E)
    stiff = dataclasses.replace(arm, link1=link, link2=link, basis="polynomial", modes=(6, 6))
    rigid = arm.ladder()[0]
    _, u = stiff.equilibrium(theta1=-0.9, theta2=0.6)
    _, wanted = rigid.equilibrium(theta1=-0.9, theta2=0.6)
    np.testing.assert_allclose(u, wanted, rtol=0.1 / factor + 1e-9)
    assert factor > 10 or np.abs(u / wanted - 1).max() > 0.03


def test_a_rest_that_nothing_holds_is_told_with_the_rate_at_which_it_is_left():
    """Upright, a rod falls by exp(sqrt(g S / J) t), S its static moment and J its inertia; hanging, nothing is said."""
    rod = dataclasses.replace(SingleLinkArm.textbook(), gravity=9.81).ladder()[0]
    L, m, load = rod.link.length, rod.link.mass, rod.payload
    moment, inertia = (m / 2 + load.mass) * L, rod.hub_inertia + (m / 3 + load.mass) * L**2 + load.inertia
    with pytest.warns(UnstableRestWarning, match=r"unstable: .* grow by exp\((\S+) t\), most in hub_angle") as told:
        rod.equilibrium(hub_angle=np.pi / 2)
    rate = float(str(told[0].message).split("exp(")[1].split(" ")[0])
    assert rate == pytest.approx(np.sqrt(9.81 * moment / inertia), rel=5e-3)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rod.equilibrium(hub_angle=-np.pi / 2)
        ARM.equilibrium(theta1=-np.pi / 2, theta2=0.0)
        dataclasses.replace(ARM, gravity=0.0).equilibrium(theta1=0.3, theta2=0.4)  # roots near a double one at zero


def test_a_link_that_is_named_decides_its_motor():
    """Two geared joints in a row: of those that are not named the motors are held at zero, but not of a named link."""
    gear = ElasticJoint(stiffness=500.0, ratio=10.0, rotor_inertia=1e-3)
    arm = FlexibleTree.serial(
        [
            TreeBody(name=n, joint=Joint(name=n, axis=(0, 1, 0), position=(0.4 * k, 0, 0), elastic=gear), mass=1.0)
            for k, n in enumerate("ab")
        ],
        payload=Payload(mass=1.0, inertia=0.1, offset=(0.3, 0, 0)),
    )
    assert with_joints(arm, {}) == {"a_motor": 0.0, "b_motor": 0.0}
    assert with_joints(arm, {"b": 0.5}) == {"a_motor": 0.0, "b": 0.5}
    assert with_joints(arm, {"a": 0.2, "b_motor": 1.0}) == {"a": 0.2, "b_motor": 1.0}
    x, u = arm.equilibrium(with_joints(arm, {"b": 0.5}))
    assert np.abs(arm.dynamics(x, u)).max() < 1e-8 and dict(zip((s.name for s in arm.states), x))["b"] == 0.5
