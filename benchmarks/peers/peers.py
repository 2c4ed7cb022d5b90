"""The neighbours, each at the best settings found: Gymnasium's own environments, MuJoCo and Exudyn.

None of them is needed: one that is not installed becomes a row that says so.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

import gymnasium
import numpy as np
from cases import environments, physics
from harness.sampling import Case, Sampler, rate_of

from peers import lumped_chain
from pliant.envs import scenes
from pliant.studies.peers.exudyn_beams import library
from pliant.studies.peers.planar_machine import machine_of

MUJOCO, EXUDYN = "MuJoCo, 6-joint chain", "Exudyn, 6-joint chain"
FAST, BATCH = f"{MUJOCO}, implicitfast", f"{MUJOCO}, implicitfast, mujoco.batch"
SOROMOX = "SoRoMoX, 6 curvatures of a clamped beam, RK4"
SWIMMER, REACHER = "MuJoCo, Swimmer-v5", "MuJoCo, Reacher-v5"
CARTPOLE, PENDULUM = "Gymnasium, CartPole (native vector)", "Gymnasium, Pendulum (sync vector)"
EXUDYN_ENV = "Exudyn, 6-joint chain (its Gym interface)"
SUBSTEPS = 10  # of the chains' environments, as in two-link-reach
CHUNK = 20  # steps a lane and call


def mujoco_rollout(
    lanes: int, threads: int, steps: int, counted: int | None = None, integrator: str = "RK4"
) -> Sampler:
    """mujoco.rollout over a batch; counts physics steps, or what `counted` says a call is worth."""
    import mujoco
    from mujoco import rollout

    model = mujoco.MjModel.from_xml_string(lumped_chain.mujoco_xml(integrator))
    data = [mujoco.MjData(model) for _ in range(threads)]
    size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    data[0].qpos[:] = lumped_chain.START
    first = np.zeros(size)
    mujoco.mj_getState(model, data[0], first, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    start, out = np.tile(first, (lanes, 1)), np.zeros((lanes, steps, size))
    engine = rollout.Rollout(nthread=0 if threads == 1 else threads)
    control = np.zeros((lanes, steps, model.nu))

    def run() -> int:
        engine.rollout(model, data, start, control, nstep=steps, state=out)
        return counted or lanes * steps

    sampler = rate_of(run)
    if not np.isfinite(out).all():
        raise FloatingPointError("the chain's states are not finite")
    return sampler


def mujoco_batch(lanes: int, threads: int, steps: int) -> Sampler:
    """mujoco.batch: live arrays of all simulations, `steps` of implicitfast a call."""
    import mujoco
    from mujoco import batch

    model = mujoco.MjModel.from_xml_string(lumped_chain.mujoco_xml("implicitfast"))
    engine = batch.Batch(model, nsim=lanes, nthread=threads)
    q, v = engine.bind("qpos"), engine.bind("qvel")

    def run() -> int:
        q[:], v[:] = lumped_chain.START, 0.0
        engine.step(nstep=steps)
        return lanes * steps

    sampler = rate_of(run)
    if not np.isfinite(q).all():
        raise FloatingPointError("the chain's states are not finite")
    return sampler


def soromox(lanes: int, steps: int) -> Sampler:
    """RK4 steps of SoRoMoX's own equations of motion, jitted and mapped over the lanes, in double precision."""
    import jax
    from jax import numpy as jnp

    from pliant.studies.peers.soromox_strains import robot

    machine, n = machine_of(scenes.get("cantilever-drop")), len(lumped_chain.START)
    h = 1e-3  # [s], well within RK4's limit there
    with jax.enable_x64(True):
        found = robot(machine, n)
        still = jnp.zeros((found.num_actuators,))

        def rate(x: Any) -> Any:
            return found.forward_dynamics(jnp.asarray(0.0), x, (still, None))

        def step(x: Any, _: Any) -> tuple[Any, None]:
            k1 = rate(x)
            k2 = rate(x + h / 2 * k1)
            k3 = rate(x + h / 2 * k2)
            return x + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(x + h * k3)), None

        play = jax.jit(jax.vmap(lambda x: jax.lax.scan(step, x, None, length=steps)[0]))
        start = jnp.asarray(1e-3 * np.random.default_rng(0).uniform(-1.0, 1.0, (lanes, 2 * n)))
        if not np.isfinite(np.asarray(play(start))).all():
            raise FloatingPointError("the beam's states are not finite")

    def run() -> int:
        with jax.enable_x64(True):
            play(start).block_until_ready()
        return lanes * steps

    return rate_of(run)


def exudyn_settings(exu: Any, steps: int) -> Any:
    """Explicit steps, dense algebra, the mass matrix inverted per body, nothing written: the fastest found."""
    settings = exu.SimulationSettings()
    settings.linearSolverType = exu.LinearSolverType.EigenDense
    settings.parallel.numberOfThreads = 1
    settings.displayStatistics = settings.displayComputationTime = False
    settings.solutionSettings.writeSolutionToFile = False
    settings.solutionSettings.sensorsWritePeriod = 1e9
    integration = settings.timeIntegration
    integration.numberOfSteps, integration.endTime = steps, steps * lumped_chain.STEP
    integration.verboseMode = integration.stepInformation = 0
    integration.explicitIntegration.computeEndOfStepAccelerations = False
    integration.explicitIntegration.computeMassMatrixInversePerBody = True
    return settings


def exudyn_steps(steps: int = 2000) -> Sampler:
    """RK4 steps of one chain, many in one call."""
    exu = library()
    mbs = exu.SystemContainer().AddSystem()
    lumped_chain.exudyn_system(mbs)
    settings = exudyn_settings(exu, steps)

    def run() -> int:
        mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.RK44)
        return steps

    return rate_of(run)


def exudyn_environment() -> Sampler:
    """The chain in Exudyn's own Gym interface, on its explicit solver: one step is SUBSTEPS RK4 steps."""
    exu = library()
    from exudyn.artificialIntelligence import OpenAIGymInterfaceEnv

    n = len(lumped_chain.START)
    driven = [i for i, s in enumerate(lumped_chain.segments()) if s.driven]

    class ChainEnv(OpenAIGymInterfaceEnv):  # type: ignore[misc]
        def CreateMBS(self, SC: Any, mbs: Any, simulationSettings: Any, **_: Any) -> int:
            self.tree = lumped_chain.exudyn_system(mbs)
            self.torques = [0.0] * n
            self.stepUpdateTime = SUBSTEPS * lumped_chain.STEP
            self.simulationSettings = exudyn_settings(exu, SUBSTEPS)
            return 2 * n

        def SetupSpaces(self) -> None:
            self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (len(driven),), np.float32)
            self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (2 * n,), np.float32)

        def PreInitializeSolver(self) -> None:
            self.SetSolver(exu.DynamicSolverType.RK44)

        def MapAction2MBS(self, action: np.ndarray) -> None:
            for i, value in zip(driven, action):
                self.torques[i] = float(value)
            self.mbs.SetObjectParameter(self.tree, "jointForceVector", self.torques)

        def Output2StateAndDone(self) -> bool:
            data = self.mbs.systemData
            self.state = np.concatenate([data.GetODE2Coordinates(), data.GetODE2Coordinates_t()])
            return bool(np.abs(self.state).max() > 1e3)

        def State2InitialValues(self) -> list[np.ndarray]:
            return [self.state[:n], self.state[n:]]

    return environments.single_steps(ChainEnv())


def difference(seconds: float = 0.5) -> float | None:
    """Largest difference of the chain's joint angles [rad] between MuJoCo and Exudyn; None where one is missing."""
    try:
        import mujoco

        exu = library()
    except ImportError:
        return None
    steps = round(seconds / lumped_chain.STEP)
    model = mujoco.MjModel.from_xml_string(lumped_chain.mujoco_xml())
    data = mujoco.MjData(model)
    data.qpos[:] = lumped_chain.START
    mujoco.mj_step(model, data, nstep=steps)
    mbs = exu.SystemContainer().AddSystem()
    lumped_chain.exudyn_system(mbs)
    mbs.SolveDynamic(exudyn_settings(exu, steps), solverType=exu.DynamicSolverType.RK44)
    return float(np.abs(data.qpos - mbs.systemData.GetODE2Coordinates()).max())


def physics_cases() -> Iterator[Case]:
    for lanes, threads, steps in ((1, 1, 2000), (1024, 1, CHUNK), (1024, 2, CHUNK)):
        yield Case(
            group=physics.GROUP,
            name=MUJOCO,
            lanes=lanes,
            threads=threads,
            peer=True,
            prepare=partial(mujoco_rollout, lanes, threads, steps),
        )
        case = partial(Case, group=physics.GROUP, lanes=lanes, threads=threads, peer=True)
        yield case(name=FAST, prepare=partial(mujoco_rollout, lanes, threads, steps, None, "implicitfast"))
        yield case(name=BATCH, prepare=partial(mujoco_batch, lanes, threads, steps))
    yield Case(group=physics.GROUP, name=EXUDYN, peer=True, prepare=exudyn_steps)
    for lanes, steps in ((1, 200), (1024, 1)):
        prepare = partial(soromox, lanes, steps)
        yield Case(group=physics.GROUP, name=SOROMOX, lanes=lanes, peer=True, prepare=prepare)


def environment_cases() -> Iterator[Case]:
    def case(name: str, prepare: Any, lanes: int = 1, threads: int = 1) -> Case:
        return Case(group=environments.GROUP, name=name, prepare=prepare, lanes=lanes, threads=threads, peer=True)

    make = partial(gymnasium.make, disable_env_checker=True)
    yield case(SWIMMER, lambda: environments.single_steps(make("Swimmer-v5")))
    yield case(REACHER, lambda: environments.single_steps(make("Reacher-v5")))
    for lanes, threads in ((1, 1), (1024, 1), (1024, 2)):
        yield case(
            f"{MUJOCO} ({SUBSTEPS} steps, no reward)",
            partial(mujoco_rollout, lanes, threads, SUBSTEPS, lanes),
            lanes,
            threads,
        )
    yield case(EXUDYN_ENV, exudyn_environment)
    for name, identity, mode, most in (
        (CARTPOLE, "CartPole-v1", "vector_entry_point", 4096),
        (PENDULUM, "Pendulum-v1", "sync", 1024),
    ):
        for lanes in physics.LANES:
            if lanes <= most:
                yield case(name, partial(_gymnasium_vector, identity, lanes, mode), lanes)


def _gymnasium_vector(identity: str, lanes: int, mode: str) -> Sampler:
    env = gymnasium.make_vec(identity, num_envs=lanes, vectorization_mode=mode)
    env.reset(seed=0)
    return environments.vector_steps(env)
