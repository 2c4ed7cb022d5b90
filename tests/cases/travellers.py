"""What travels: one object or more of every public class, in the middle of what it does, and what it does next.

MAKERS: name -> a function that makes the object, partly used. `go_on(name, thing)` drives it on, and returns arrays.
"""

from __future__ import annotations

import dataclasses
import importlib
import inspect
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
    Policy,
    Predictive,
    delayed,
    loop,
    margins,
    optimal,
    plan,
    riccati,
    rl,
    sensors_of,
    shaper_for,
    spillover,
)  # fmt: skip
from pliant.controllers.base.controller import Feedback
from pliant.controllers.base.joint_reference import Follow, RestToRest
from pliant.envs import PlantEnv, scenes
from pliant.plants import (
    Environment,
    FlexibleSpacecraft,
    LargeDeflectionBeam,
    Orbit,
    PliantError,
    SingleLinkArm,
    SliderCrank,
    Sun,
    Surface,
    Thruster,
    Trajectory,
    TransferMatrices,
    TwoLinkArm,
    Wheel,
    beams,
    paper_terms,
    stability,
)  # fmt: skip
from pliant.plants.linear import second_order
from pliant.plants.linear.piecewise_ltv import linearize_pieces
from pliant.plants.slider_crank.steady_cycles import speed_scan, steady_cycle
from pliant.studies.closed_loop.rollout import randomised, rollout

Going = Callable[[Any], Any]
RECORDS = {  # of studies, evaluations and certificates: filled with made-up values
    "plants.stability.frozen_time": "SlowVariation",
    "plants.stability.lyapunov_certificate": "Certificate",
    "controllers.linear_quadratic.funnel": "Funnel",
    "controllers.learning.evaluation": "Evaluation Training",
    "envs.scenes.beams": "SmoothSpinUp",
    "envs.scenes.spacecraft": "Articulation",
    "studies.closed_loop.closed_loop": "Loop",
    "studies.closed_loop.comparison": "Contest",
    "studies.closed_loop.contestants": "Designed",
    "studies.closed_loop.scores": "Score Row",
    "studies.fidelity.choice": "Rung Effect Choice",
    "studies.fidelity.mode_count": "ModeCount ModesNeeded",
    "studies.fidelity.speed_accuracy": "Row Reference Chart",
    "studies.fidelity.stiffening": "Stiffening",
    "studies.papers.single_link": "SpinUp",
    "studies.report.findings": "Findings",
    "studies.scoreboard.results": "Entry Line Results",
    "studies.scoreboard.scoreboard": "Scoreboard",
    "studies.stability.judgement": "Judgement",
    "studies.stability.parameter_map": "StabilityMap",
}
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


record("follow")(lambda: Follow(0.1, *(np.linspace(0, k, 8).reshape(4, 2) for k in (1, 2, 3))))
traveller("rest to rest", lambda r: [r(t) for t in (0.0, 0.3, 2.0)])(
    lambda: RestToRest([0.0], [1.0], 0.5, shaper_for([3.0]))
)
traveller("shaper", lambda s: (fields(s), s.residual(2.5), (s * s).times))(lambda: shaper_for([3.0, 8.0], "zvd"))
traveller("policy", acts)(lambda: used(Policy.for_scene("single-link-slew")))
traveller("sensors", lambda s: [k.read(0.3, 0.01, np.random.default_rng(0)) for k in s])(lambda: sensors_of(SLEW.plant))


def filtered(kalman: Any) -> Any:
    return [(kalman.step(y[: len(kalman.sensors)], [0.1]), kalman.estimate, kalman.covariance) for y in readings()[:5]]


@traveller("Kalman", filtered)
def _kalman() -> Any:
    kalman = LQG.for_scene(WIDE).filter
    filtered(kalman)
    return kalman


record("margins")(lambda: margins(loop(RIGID_MODEL(), RIGID_LAW())))
record("loop")(lambda: loop(RIGID_MODEL(), RIGID_LAW()))
record("spillover")(lambda: spillover(LQG.for_scene(WIDE), [r.linearize(r.rest_state) for r in LADDER]))
LADDER = [step for step in SLEW.plant.ladder() if step.nx >= SLEW.plant.nx][:2]
record("delayed model")(lambda: delayed(RIGID_MODEL().discretize(0.01), 2))
record("regulator")(lambda: riccati.lqr(RIGID_MODEL().A, RIGID_MODEL().B, np.eye(2), np.eye(1)))
record("regulator along")(lambda: riccati.tvlqr(_along(), np.eye(SLEW.plant.nx), np.eye(1)))


def RIGID_MODEL() -> Any:
    return RIGID.linearize(RIGID.rest_state)


def RIGID_LAW() -> Any:
    return LQR.design(RIGID_MODEL(), np.diag([10.0, 1.0]), np.eye(1), dt=0.01)


RIGID_SLEW = dataclasses.replace(
    SLEW, plant=RIGID, observe=("hub_angle", "hub_angle_rate"), weights=(("hub_angle", 10.0), ("hub_angle_rate", 0.1)),
    bounds=(), compare=("hub_angle",),
)  # fmt: skip
record("optimal motion")(lambda: optimal(Objective.of(RIGID_SLEW), RIGID_SLEW.initial[0], 20, substeps=3))
record("planned motion")(lambda: plan(RIGID_SLEW))
traveller("nominal input", lambda f: [f(t) for t in (0.0, 0.1, 0.4)])(lambda: SLEW.nominal_input)

CRANK, LONG = SliderCrank.textbook(), LargeDeflectionBeam.textbook()
record("steady cycle")(lambda: CRANK_CYCLE())


@cache
def CRANK_CYCLE() -> Any:
    return steady_cycle(dataclasses.replace(CRANK, modes=1), points=181)


record("verdict")(lambda: stability.assess(RIGID_MODEL()))
record("verdict of a cycle")(lambda: stability.assess(_cycle_model()))
record("Floquet")(lambda: stability.floquet(_cycle_model()))
record("frozen time")(lambda: stability.frozen_time(_cycle_model()))
record("speed scan")(lambda: speed_scan(dataclasses.replace(CRANK, modes=1), [20.0, 30.0], points=91))


def _cycle_model() -> Any:
    return dataclasses.replace(CRANK, modes=1).linearize_along(CRANK_CYCLE())


@traveller("pieces", lambda m: (fields(m), m.transition()))
def _pieces() -> Any:
    t = np.linspace(0, 0.2, 21)
    plant = SLEW.plant
    before = plant.simulate(plant.rest_state, [1.0], t)
    after = plant.simulate(before.x[-1], [0.0], t + 0.2)
    return linearize_pieces(plant, (before, after), [[0.0]])


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
    "PPO settings": rl.PPOSettings(),
    "SAC settings": rl.SACSettings(),
}.items():
    record(label)(lambda made=made: made)


@traveller("conditions and rollout", fields)
def _rollout() -> Any:
    given = randomised(SLEW, 1, 3)[0]
    return given, rollout(SLEW, LQR.for_scene(SLEW), given)


def kinds(base: type) -> list[type]:
    return [base, *(kind for below in base.__subclasses__() for kind in kinds(below))]


@traveller("errors", lambda errors: [str(e).encode() for e in errors] + [fields(vars(e)) for e in errors])
def _errors() -> Any:
    """Each that the library raises; what it takes beside its message is made up by name."""
    made = []
    for kind in [k for k in kinds(PliantError) if k.__module__.startswith("pliant")]:
        takes = [p for p in inspect.signature(kind.__init__).parameters.values() if p.kind is p.POSITIONAL_OR_KEYWORD]
        made.append(kind("what happened", *([0.5] * (len(takes) - 2 if "message" in [p.name for p in takes] else 0))))
    return made


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


record("modes")(lambda: _linear().modes())
record("quadratic cost")(lambda: SLEW.quadratic())
record("second-order form")(lambda: second_order.from_ltv(_cycle_model()))
record("converged plan")(lambda: NMPC.for_scene(SLEW, horizon=6).iterate(SLEW.initial[0], tolerance=1e-3))
record("places of sensors")(lambda: (SLEW.plant.sensors(), SLEW.plant.joints, FlexibleSpacecraft.textbook().unfelt))
record("left ranges")(lambda: SLEW.plant.left_ranges(nominal()))


def made_up(kind: type) -> Any:
    """A record with a value of each field's kind: it holds nothing that knows where it is."""
    made = kind.__new__(kind)
    for k, field in enumerate(dataclasses.fields(kind)):
        about = str(field.type)
        array = np.arange(3.0 + k)
        array.setflags(write=bool(k % 2))
        held = array if "ndarray" in about or about == "Array" else 0.5 + k
        value = (held, "name") if about.startswith("tuple") else held
        object.__setattr__(made, field.name, f"name {k}" if about == "str" else value)
    return made


for where, what in RECORDS.items():
    for name in what.split():
        at = importlib.import_module(f"pliant.{where}")
        record(f"{where}.{name}")(lambda at=at, name=name: made_up(getattr(at, name)))

# Why a class, or all of a module, does not travel by itself: of each module the longest name that fits counts.
NOT_MADE: dict[str, str] = {
    "plants.native": "compiled code: who owns it makes it anew, and is tried here",
    "plants.beams": "shape functions: parts of a plant's expressions, which are made anew from its fields",
    "plants.large_deflection": "sections and chains: parts of a plant's expressions, made anew from its fields",
    "plants.spacecraft": "parts of a spacecraft's expressions, made anew from its fields",
    "plants.spacecraft_parts.appendage.Inertia": "expressions",
    "plants.spacecraft_perturbation": "verification of a paper: nobody keeps one",
    "plants.slider_crank.rigid_kinematics": "expressions",
    "plants.core.casadi_functions": "a CasADi function, which travels itself, and its buffers",
    "plants.core.errors": "warnings: a message and no more; errors are tried",
    "plants.core.imports": "a module under another name",
    "plants.core.runge_kutta_tableaux": "constants of the library",
    "plants.core.signals": "what lets the others travel, and rows of a model in passing",
    "plants.dynamics.python_control.Shared": "in passing, inside python-control",
    "plants.dynamics.residual_jacobians": "expressions",
    "plants.integration": "a method, or a step in passing; steppers are tried inside what has one",
    "plants.linear.model_signals": "the base of the linear models",
    "plants.linear.rest_spaces": "in passing, inside a verdict or a design",
    "plants.stability.eigenvalue_bounds": "in passing, inside a verdict",
    "plants.stability.transition_error": "in passing, inside a verdict",
    "plants.validity": "a range, an expression of its plant",
    "controllers.learning": "training: it has its own checkpoints; settings, policies and evaluations are tried",
    "controllers.linear_quadratic.hold_set": "in passing, inside TVLQR's design",
    "controllers.mpc": "in passing, inside MPC's design",
    "controllers.nmpc.terminal_cost": "a warning",
    "controllers.optimal_control": "in passing, inside a solve",
    "controllers.riccati": "in passing, inside a design; regulators are tried",
    "controllers.solvers": "in passing, inside a solve",
    "envs.rendering": "a window of this process",
    "envs.scenes.scene.Manoeuvre": "the base of Scene",
    "envs.simulation": "compiled code: the environments make it anew",
    "studies.commands": "the command line",
    "studies.common.reference_motions": "a cache of this process",
    "studies.fidelity.speed_accuracy.Runner": "in passing, inside a chart",
}
