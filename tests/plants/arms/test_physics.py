"""The richest models of the arms, and simpler motions in their states."""

import dataclasses

import numpy as np
import pytest

from pliant.plants import Beam, LargeDeflectionBeam, Material, Payload, SingleLinkArm, TwoLinkArm

ARMS = [SingleLinkArm.textbook(), TwoLinkArm.textbook()]


@pytest.mark.parametrize("arm", ARMS)
def test_physics_has_every_effect_and_one_shape_more_where_asked(arm):
    physics = arm.physics()
    assert all(physics.effects.values()) and physics.effects.keys() == arm.effects.keys()
    assert not any(arm.ladder()[0].effects.values())
    bodies = len(arm.modes) if isinstance(arm.modes, tuple) else 1
    assert arm.physics(1).nx - physics.nx == 2 * bodies
    assert arm.physics(40).nx == arm.physics(50).nx  # as many as polynomials are told apart
    assert arm.unmodelled


@pytest.mark.parametrize("arm", ARMS)
def test_without_an_effect_it_is_there_no_more(arm):
    physics = arm.physics()
    for effect in physics.effects:
        lacking = physics.without(effect)
        assert not lacking.effects[effect] and lacking != physics
    with pytest.raises(ValueError, match=r"without: effect 'luck' is not one of its effects"):
        physics.without("luck")


@pytest.mark.parametrize("arm", ARMS)
@pytest.mark.parametrize("basis", ["polynomial", "payload"])
def test_an_embedded_state_is_the_same_machine_bent_the_same(arm, basis):
    """Bends of 1e-4 m: the tip stands where it does in the simpler model, to what shear adds: 3 EI/(kappa G A L^2),
    8e-5 and 5e-5 of the bend in the first mode, and up to ten times as much in the second.
    """
    modes = (2, 2) if isinstance(arm.modes, tuple) else 2
    simple = dataclasses.replace(arm, kinematics="stiffened", basis=basis, modes=modes)
    physics = arm.physics(6)
    E = physics.embedding(simple)
    x = np.random.default_rng(3).uniform(-1, 1, simple.nx) * 1e-4
    joints = 2 if isinstance(arm.modes, tuple) else 1
    x[:joints] = 0.3
    for name in ("tip_x", "tip_y"):
        k = [s.name for s in simple.outputs].index(name)
        assert physics.measure(E @ x)[k] == pytest.approx(simple.measure(x)[k], abs=3e-7)


def test_a_frame_of_another_kind_is_left():
    pinned = SingleLinkArm.textbook()
    pinned = dataclasses.replace(pinned, frame="pinned", kinematics="linear")
    physics = pinned.physics()
    x = np.r_[0.2, 1e-3, -5e-4, np.zeros(3)]
    k = [s.name for s in pinned.outputs].index("hub_angle")
    assert (physics.embedding(pinned) @ x)[0] == pytest.approx(pinned.measure(x)[k], abs=1e-12)


def test_effects_go_one_after_the_other_in_any_order():
    """Without shortening there are no exact rotations to take away: that must not bring the shortening back."""
    physics = TwoLinkArm.textbook().physics()
    both = ("shortening of the bent links", "exact rotations")
    for names in (both, both[::-1]):
        lacking = physics
        for name in names:
            lacking = lacking.without(name)
        assert lacking.kinematics == "linear"


@pytest.mark.campaign
@pytest.mark.parametrize("E", [5e7, 5e8])
def test_extension_is_estimated_as_no_less_than_a_beam_that_stretches_shows(E):
    """The arm against `LargeDeflectionBeam`, other equations: spun up and held, with and without extension."""
    beam = Beam.rectangular(2.0, 0.02, 0.01, Material(density=1200.0, E=E, G=E / 2.6))
    arm = SingleLinkArm(link=beam, drive="motion", payload=Payload(mass=0.05))
    times = np.linspace(0.0, 2.0, 101)
    held = np.where(times < 0.5, 2.0, 0.0)[:, None]
    options = {"method": "rodas5p", "rtol": 1e-8, "atol": 1e-11}
    shapes = {"modes": 5, "basis": "polynomial", "stretches": 3, "shears": 3, "theory": "timoshenko"}
    tips = []
    for extensible in (False, True):
        plant = LargeDeflectionBeam(
            beam=beam, root="driven", gravity=(0.0, 0.0, 0.0), payload=arm.payload, extensible=extensible, **shapes
        )
        tips.append(plant.simulate(np.zeros(plant.nx), held, times, **options)["tip_deflection"])
    true = np.abs(tips[1] - tips[0]).max()
    physics = arm.physics()
    motion = physics.simulate(np.zeros(physics.nx), held, times, rtol=1e-9, atol=1e-11)
    longer, _ = physics.estimates(motion)["extension"]
    moved = longer.simulate(np.zeros(physics.nx), held, times, rtol=1e-9, atol=1e-11)
    told = np.abs(moved["tip_deflection"] - motion["tip_deflection"]).max()
    assert true <= told <= 20 * true  # from above, and far above where it bends by a radian
