"""Plants that travel, what they give to CasADi and python-control, and the parts they are made of."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from travelling import RIGID, SLEW, Roll, fields

from pliant.plants import (
    Environment,
    FlexibleSpacecraft,
    FlexibleTree,
    Joint,
    LargeDeflectionBeam,
    Orbit,
    SingleLinkArm,
    SliderCrank,
    Sun,
    Surface,
    Thruster,
    TransferMatrices,
    TreeBody,
    TwoLinkArm,
    Wheel,
    beams,
    paper_terms,
)  # fmt: skip

ROLL = Roll()
traveller, record = ROLL.traveller, ROLL.record


def plant_goes(plant: Any) -> Any:
    x = plant.rest_state
    x = x + 1e-3 * np.arange(plant.nx) * (np.arange(plant.nx) >= plant.nx // 2)
    u = np.full(plant.nu, 0.1)
    model = plant.linearize(x, u)
    step = plant.stepper(1e-5, check=False)(x[None], u[None])
    return plant.dynamics(x, u), plant.measure(x, u), model.A, step, plant.simulate(x, u, [0.0, 1e-3]).x


for label, made in {
    "single link": RIGID,
    "single link varied": RIGID.vary("payload.mass"),
    "two links": dataclasses.replace(TwoLinkArm.textbook(), reduction="rigid"),
    "large beam": LargeDeflectionBeam.textbook(),
    "large beam of strains": dataclasses.replace(
        LargeDeflectionBeam.textbook(), root="free", modes=1, extensible=True, rest_curvature=np.sin
    ),
    "slider-crank": SliderCrank.textbook(),
    "tree": FlexibleTree.serial([TreeBody(name="a", joint=Joint(name="j"), mass=1.0, inertia=0.1)]),
    "spacecraft": dataclasses.replace(FlexibleSpacecraft.textbook(), kinematics="rigid"),
}.items():
    traveller(label, plant_goes)(lambda made=made: made)


@traveller("compiled", lambda p: (plant_goes(p), [getattr(p, f).native for f in ("_dynamics", "_output")]))
def _compiled() -> Any:
    return RIGID.compile()


def io_goes(system: Any) -> Any:
    import control

    x = np.linspace(0.1, 0.2, system.nstates)
    model = control.linearize(system, x, params={"payload.mass": 0.7})
    return system.dynamics(0.0, x, [0.3]), system.output(0.0, x, [0.3]), model.A, model.C, list(system.params.values())


@traveller("python-control system", io_goes)
def _system() -> Any:
    system = RIGID.vary("payload.mass").to_control(outputs="states")
    system.params["payload.mass"] = 0.9
    return system


@traveller("casadi function", lambda f: np.array(f(x=np.full(RIGID.nx, 0.1))["dx"]))
def _function() -> Any:
    return RIGID.casadi()


@traveller("lit craft in orbit", plant_goes)
def _lit() -> Any:
    craft = FlexibleSpacecraft.textbook()
    side = Surface(area=2.0, normal=(1.0, 0.0, 0.0))
    thruster = Thruster(position=(0.5, 0.2, 0.0), direction=(0.0, 0.0, 1.0))
    hub = dataclasses.replace(
        craft.hub, surfaces=(side,), wheels=(Wheel(axis=(0.0, 0.0, 1.0), inertia=0.1),), thrusters=(thruster,)
    )
    outside = Environment(orbit=Orbit(rate=1e-3), sun=Sun(direction=(0.0, 0.6, 0.8)))
    return dataclasses.replace(craft, hub=hub, environment=outside, kinematics="rigid", appendages=craft.appendages[:1])


traveller("modal data", fields)(lambda: FlexibleSpacecraft.textbook().appendages[0].data)
record("paper's terms")(lambda: paper_terms(TwoLinkArm.textbook(), np.full(12, 0.01), [1.0, 2.0]))
traveller("transfer matrices", lambda s: s.acceleration(np.full(s.plant.nx, 0.01)))(
    lambda: TransferMatrices(
        dataclasses.replace(LargeDeflectionBeam.textbook(), kinematics="substructured", segments=2)
    )
)


for label, made in {
    "material": beams.ALUMINIUM,
    "beam": SingleLinkArm.textbook().link,
    "payload": SingleLinkArm.textbook().payload,
    "hub": FlexibleSpacecraft.textbook().hub,
    "appendages": FlexibleSpacecraft.textbook().appendages,
    "signals": SLEW.plant.states,
}.items():
    record(label)(lambda made=made: made)


record("places of sensors")(lambda: (SLEW.plant.sensors(), SLEW.plant.joints, FlexibleSpacecraft.textbook().unfelt))


@record("left ranges")
def _left() -> Any:
    """Of two links that turn too fast for linear kinematics."""
    arm = TwoLinkArm.textbook()
    x = arm.rest_state.copy()
    x[arm.nx // 2 : arm.nx // 2 + 2] = 20.0
    return arm.left_ranges(arm.simulate(x, None, [0.0, 0.005]))
