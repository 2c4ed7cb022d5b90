"""What travels: one object or more of every public class, in the middle of what it does, and what it does next.

MAKERS: name -> a function that makes the object, partly used. `go_on(name, thing)` drives it on, and returns arrays.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from pliant.controllers import (
    LQG,
    LQR,
    MPC,
    NMPC,
    PD,
    TVLQR,
    ComputedTorque,
    Objective,
    Predictive,
)  # fmt: skip
from pliant.controllers.base.controller import Feedback
from pliant.envs import PlantEnv, scenes
from pliant.plants import (
    FlexibleSpacecraft,
    LargeDeflectionBeam,
    SingleLinkArm,
    SliderCrank,
    Trajectory,
    TwoLinkArm,
)  # fmt: skip

Going = Callable[[Any], Any]
RIGID = dataclasses.replace(SingleLinkArm.textbook(), kinematics="rigid")
SLEW = scenes.get("single-link-slew")
WIDE = dataclasses.replace(SLEW, limits=(1e6,))  # an input at its limit is the same whatever a copy remembers
MAKERS: dict[str, Callable[[], Any]] = {}
GOING: dict[str, Going] = {}


def traveller(name: str, go_on: Going) -> Callable[[Callable[[], Any]], Callable[[], Any]]:
    def kept(make: Callable[[], Any]) -> Callable[[], Any]:
        MAKERS[name], GOING[name] = make, go_on
        return make

    return kept


def go_on(name: str, thing: Any) -> list[np.ndarray]:
    """What it does next, as arrays."""
    return list(_arrays(GOING[name](thing)))


def _arrays(found: Any) -> Any:
    if isinstance(found, (tuple, list)):
        for part in found:
            yield from _arrays(part)
    elif isinstance(found, dict):
        for key in sorted(found, key=str):
            yield from _arrays(found[key])
    elif found is not None and not isinstance(found, str):
        yield np.array(found)


@cache
def readings(count: int = 12) -> np.ndarray:
    """Deviations of 16 signals at most."""
    return 1e-4 * np.random.default_rng(0).standard_normal((count, 16))


def acts(law: Any, start: int = 6) -> np.ndarray:
    """Six acts about the goal of the slew, from act `start` on."""
    x, u = SLEW.target
    known = dict(zip([s.name for s in SLEW.plant.states + SLEW.plant.outputs], [*x, *SLEW.plant.measure(x, u)]))
    y = np.array([known[r] for r in law.reads]) + readings()[:, : len(law.reads)]
    dt = law.dt or 0.01
    return np.array([law.act(k * dt, y[k]) for k in range(start, start + 6)])


def used(law: Any) -> Any:
    law.reset()
    acts(law, 0)
    return law


def law(name: str, make: Callable[[], Any]) -> None:
    traveller(name, acts)(lambda: used(make()))


law("LQR", lambda: LQR.for_scene(WIDE))
law("LQR that integrates", lambda: LQR.for_scene(WIDE, integral={"hub_angle": 10.0}))
law("LQG", lambda: LQG.for_scene(WIDE))
law("LQG late", lambda: LQG.for_scene(WIDE, delay=2))
law("PD", lambda: PD.for_scene(WIDE))
law("computed torque", lambda: ComputedTorque.for_scene(WIDE))
law("TVLQR", lambda: TVLQR.for_scene(WIDE))
law("predictive", lambda: Predictive.for_scene(WIDE, delay=2))
law("MPC", lambda: MPC.for_scene(SLEW))
law("MPC that remembers", lambda: MPC.for_scene(SLEW, rates=[40.0]))
law("MPC that estimates", lambda: MPC.for_scene(SLEW, track=("hub_angle",)))
law("MPC along", lambda: MPC.for_scene(SLEW, nominal=nominal()))
law("NMPC", lambda: NMPC.for_scene(SLEW, horizon=6))
law("feedback", lambda: Feedback(np.array([[3.0, 1.0]]), ("hub_angle", "hub_angle_rate")))


@cache
def nominal() -> Trajectory:
    t = np.arange(SLEW.steps + 1) * SLEW.dt
    return SLEW.plant.simulate(SLEW.initial[0], lambda s: [2.0 * np.sin(3 * s)], t)


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
    "slider-crank": SliderCrank.textbook(),
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


def fields(thing: Any) -> Any:
    """All numbers of a record."""
    if dataclasses.is_dataclass(thing):
        return [fields(getattr(thing, f.name)) for f in dataclasses.fields(thing)]
    if isinstance(thing, (tuple, list)):
        return [fields(part) for part in thing]
    if isinstance(thing, dict):
        return [fields(thing[key]) for key in sorted(thing, key=str)]
    return thing if isinstance(thing, (int, float, complex, np.ndarray, np.generic)) else None


def record(name: str) -> Callable[[Callable[[], Any]], Callable[[], Any]]:
    return traveller(name, fields)


def model_goes(m: Any) -> Any:
    start, push = np.full(len(m.states), 0.01), np.full(len(m.inputs), 0.1)
    return fields(m), m.simulate(start, push) if hasattr(m, "t") else m.simulate(start, push, [0.0, 0.1])


@traveller("linear model", model_goes)
def _linear() -> Any:
    return SLEW.plant.linearize(*SLEW.target)


@traveller("model along a motion", model_goes)
def _along() -> Any:
    return SLEW.plant.linearize_along(nominal())


@traveller("sampled along a motion", fields)
def _sampled() -> Any:
    return _along().discretize()


@traveller("motion", lambda m: (fields(m), m.resample(np.linspace(0, 0.1, 7)).x, m["hub_angle"]))
def _motion() -> Any:
    return nominal()


def env_goes(env: Any) -> Any:
    found = []
    for k in range(5):
        found.append(env.step(np.full(env.action_space.shape, 0.1 * (k + 1), dtype=np.float32)))
    found.append(env.reset())  # of the generator that travels too
    return [part[:4] for part in found]


@traveller("environment", env_goes)
def _env() -> Any:
    env = PlantEnv(SLEW, randomise=True)
    env.reset(seed=3)
    env.step(np.array([0.5], dtype=np.float32))
    return env


@traveller("vector environment", env_goes)
def _vector() -> Any:
    env = SLEW.vector_env(3, randomise=True)
    env.reset(seed=3)
    env.step(np.full((3, 1), 0.5, dtype=np.float32))
    return env


def sb3_goes(env: Any) -> Any:
    found = []
    for k in range(4):
        env.step_async(np.full((env.num_envs, 1), 0.1 * k, dtype=np.float32))
        found.append(env.step_wait()[:3])
    return found, env.reset()


@traveller("Stable-Baselines3 environment", sb3_goes)
def _sb3() -> Any:
    env = SLEW.sb3_env(3, randomise=True)
    env.seed(3)
    env.reset()
    return env


@traveller(
    "scene", lambda s: (s.initial, s.target, s.plant.dynamics(s.initial[0]), s.draw(0) if hasattr(s, "draw") else ())
)
def _scene() -> Any:
    return SLEW


@traveller("objective", lambda o: (o.cost(np.full((3, SLEW.plant.nx), 0.1), np.full((3, 1), 0.2)), o.x_goal))
def _objective() -> Any:
    return Objective.of(SLEW)


NOT_MADE: dict[str, str] = {}
