"""The scenes' trees against closed forms and the published data they take."""

import dataclasses

import numpy as np
import pytest

from pliant.envs.machines import trees
from pliant.plants import Payload


def test_the_elastic_joint_swings_at_its_closed_form() -> None:
    """omega^2 = k (1/J + 1/(n^2 J_m)), J = 5/3 + 2 + 0.006 kg m^2 about the joint, n^2 J_m = 0.2 kg m^2."""
    plant = trees.flexible_joint()
    found = plant.natural_frequencies(np.zeros(4))
    J = 5 / 12 + 5 * 0.25 + 2.0 + 0.005
    assert found.max() == pytest.approx(np.sqrt(2000.0 * (1 / J + 1 / 0.2)), rel=1e-9)
    locked = plant.natural_frequencies(np.zeros(4), locked=("joint_motor",))
    assert locked.max() / (2 * np.pi) == pytest.approx(3.7, abs=0.05)


def test_the_six_axis_arm_reaches_where_its_published_lengths_put_it() -> None:
    """UR5, Denavit-Hartenberg: d1 0.089159, a2 0.425, a3 0.39225, d4 0.10915, d5 0.09465, d6 0.0823 m, all joints zero:
    the flange stands at (a2 + a3, d4 + d6, d1 - d5); outputs are of the tip, in this arm's axes.
    """
    arm = dataclasses.replace(trees.six_axis("rigid"), payload=Payload())
    y = dict(zip((s.name for s in arm.outputs), arm.measure(np.zeros(arm.nx)), strict=True))
    assert [y["tip_x"], y["tip_y"], y["tip_z"]] == pytest.approx([0.81725, 0.19145, -0.005491], abs=1e-9)
    assert trees.six_axis().nx == 22 and [j.position for j in arm.joints][:3] == ["pan", "lift", "elbow"]
    masses = [b.mass for b in arm.bodies]
    assert sum(masses) == pytest.approx(3.7 + 8.393 + 2 * 1.219 + 0.1879)


def test_the_strips_weigh_and_bend_as_published() -> None:
    """0.3935 kg each; a spring of the code's three pieces a strip is 38 N m/rad: E I / (L / 3) = 38."""
    arm = trees.three_link()
    strip = arm.bodies[1].beam
    assert strip.mass == pytest.approx(0.3935) and strip.E * strip.I_z / (0.5 / 3) == pytest.approx(38.0, rel=1e-3)
    x, u = arm.equilibrium({"joint1": 0.0, "joint2": 0.0, "joint3": 0.0})
    assert u == pytest.approx([0.0, 0.3935 * 9.81 * (0.25 + 0.75), 0.3935 * 9.81 * 0.25], rel=2e-2)
    y = dict(zip((s.name for s in arm.outputs), arm.measure(x), strict=True))
    EI, w, L = strip.E * strip.I_z, 0.3935 * 9.81 / 0.5, 0.5
    assert y["link3_deflection_y"] == pytest.approx(-w * L**4 / (8 * EI), rel=0.03)  # a cantilever's, tilted a little


def test_the_cranes_load_swings_as_a_pendulum_and_pulls_its_rod_straight() -> None:
    """A mass on a light rod swings at sqrt(g / L), but for the rod's and its own inertia; between hinge and load, which
    turns freely here, the rod bends at sqrt(1 + T L^2 / (pi^2 E I)) times its frequency without pull (Euler).
    """
    crane = trees.crane()
    held = crane.natural_frequencies(np.zeros(8), locked=("trolley",))
    assert held[0] == pytest.approx(np.sqrt(9.81 / 4.0), rel=0.02)
    point = dataclasses.replace(crane, payload=Payload(mass=200.0, inertia=1e-3))
    loose = dataclasses.replace(point, gravity=(0.0, 0.0, -1e-9))
    rod = crane.bodies[1].beam
    T = 9.81 * (200.0 + rod.mass / 2)
    slack = loose.natural_frequencies(np.zeros(8), locked=("trolley",))
    taut = point.natural_frequencies(np.zeros(8), locked=("trolley",))
    assert taut[1] / slack[0] == pytest.approx(np.sqrt(1 + T * 16.0 / (np.pi**2 * rod.E * rod.I_z)), rel=0.03)
