"""Arms of small slopes: their equations, written out, are those of their energies, differentiated by CasADi."""

import dataclasses

import casadi as ca
import numpy as np
import pytest

from pliant.plants import LagrangianPlant, Payload, SingleLinkArm, TwoLinkArm
from pliant.plants.arms import small_slope_equations

LOAD = Payload(mass=0.6, inertia=0.003, offset=(0.05, -0.08, 0.0))
ONE = dataclasses.replace(
    SingleLinkArm.textbook(), kinematics="stiffened", payload=LOAD, gravity=9.81, hub_radius=0.2, hub_friction=0.1
)
ONE = dataclasses.replace(ONE, link=dataclasses.replace(ONE.link, damping=1e-3))
TWO = dataclasses.replace(
    TwoLinkArm.textbook(),
    kinematics="stiffened",
    basis="polynomial",
    payload=LOAD,
    hub_inertia=(0.1, 0.02),
    joint_friction=(0.1, 0.2),
    modes=(2, 1),
)
TWO = dataclasses.replace(TWO, link2=dataclasses.replace(TWO.link2, damping=1e-3))
ARMS = {
    "one": ONE,
    "one linear": dataclasses.replace(ONE, kinematics="linear", modes=3),
    "one rigid": dataclasses.replace(ONE, kinematics="rigid"),
    "one with shear": dataclasses.replace(ONE, theory="timoshenko"),
    "one without offset": dataclasses.replace(ONE, payload=Payload(mass=0.6, inertia=0.003)),
    "one driven": dataclasses.replace(ONE, drive="motion", hub_radius=0.0),
    "one varied": ONE.vary("link.length", "payload.mass", "hub_radius", "link.density"),
    "two": TWO,
    "two linear": dataclasses.replace(TWO, kinematics="linear", basis="payload"),
    "two rigid": dataclasses.replace(TWO, reduction="rigid"),
    "two with shear": dataclasses.replace(TWO, theory="timoshenko"),
    "two without offset": dataclasses.replace(TWO, payload=Payload(mass=0.6, inertia=0.003)),
    "two no slope": dataclasses.replace(TWO, tip_slope=False),
    "two one-sided": dataclasses.replace(TWO, modes=(0, 2)),
    "two other side": dataclasses.replace(TWO, modes=(2, 0)),
    "two varied": TWO.vary("link1.length", "link2.density", "payload.offset.0", "payload.mass"),
}


@pytest.mark.parametrize("name", list(ARMS))
def test_equations_are_those_of_the_energies(name: str) -> None:
    """Against the base class's derivatives of T, V and the losses: M, r, T, V, and the accelerations solved for."""
    arm = ARMS[name]
    t, x, u, w, p = arm.symbols
    expected_terms = LagrangianPlant.equations(arm.symbolic, t, x, u, w)
    expected = ca.Function("derived", [x, u, w, p], [*expected_terms, arm.acceleration(*expected_terms[:2], u)[0]])
    got_terms = arm.symbolic.equations(t, x, u, w)
    built = ca.Function("built", [x, u, w, p], [*got_terms, arm.symbolic.solved(t, x, u, w)[0]])
    rng = np.random.default_rng(1)
    for _ in range(3):
        at = [0.3 * rng.uniform(-1, 1, k) for k in (arm.nx, arm.nu, arm.nw)]
        for want, have in zip(expected(*at, arm.nominal_parameters), built(*at, arm.nominal_parameters)):
            np.testing.assert_allclose(have, want, rtol=0, atol=1e-11 * np.abs(np.asarray(want)).max())


def _length(symbols: list[ca.SX], value: ca.SX) -> int:
    return int(ca.Function("f", symbols, ca.cse([value])).n_instructions())


def test_the_scene_arm_is_half_as_long_as_from_its_energies() -> None:
    """Two payload modes a link: at most 700 operations, 1395 instructions before (benchmarks/README.md)."""
    arm = dataclasses.replace(TWO, basis="payload", modes=(2, 2), payload=Payload(mass=0.5, inertia=0.002))
    t, x, u, w, _ = arm.symbols
    M, r = small_slope_equations.in_absolute_angles(arm, x, u, w, False)
    assert M.shape == (6, 6) and r.shape == (6, 1)
    derived = LagrangianPlant.equations(arm, t, x, u, w)
    before = _length([t, x, u, w], arm.acceleration(*derived[:2], u)[0])
    now = _length([t, x, u, w], arm.solved(t, x, u, w)[0])
    assert now <= min(700, 0.55 * before)
