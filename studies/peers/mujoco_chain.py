"""MuJoCo: each link a chain of rigid segments on sprung hinges, since it has no beam with joints.

A root that is turned as prescribed carries an armature so large that the links do not move it.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from .planar_machine import Machine
from .programs import BrokenDownError, Motion, Player, Setting
from .rigid_segments import Segment, segments, tips

INTEGRATORS = "RK4", "implicitfast", "discrete", "Euler"
HEAVY = 1e7  # armature of a prescribed root over the links' moment of inertia


class Chain:
    """mujoco.rollout of the whole motion in one call, nothing that can touch, no constraints."""

    peer = "MuJoCo, rigid segments"
    package = "mujoco"
    part = "hinges"

    def why_not(self, machine: Machine) -> str:
        return ""

    def parts(self, machine: Machine) -> tuple[int, ...]:
        return 1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96

    def solvers(self) -> tuple[str, ...]:
        return INTEGRATORS

    def beside(self, solver: str) -> tuple[str, ...]:
        return ()

    def player(self, machine: Machine, setting: Setting) -> Player:
        chain = segments(machine, setting.parts)
        angles = [a - b for a, b in zip(machine.angles, (0.0, *machine.angles))]
        start = np.zeros(len(chain))
        start[[i for i, s in enumerate(chain) if s.driven]] = angles

        def motion(q: np.ndarray) -> Motion:
            if machine.root == "clamped":
                q = np.concatenate([np.full((len(q), 1), machine.angles[0]), q], axis=1)
            return tips(chain, q), q[:, 0]

        return rollout_of(machine, setting, xml(machine, chain, setting), tuple(start), motion)


def rollout_of(
    machine: Machine, setting: Setting, text: str, start: tuple[float, ...], motion: Callable[[np.ndarray], Motion]
) -> Player:
    """mujoco.rollout of a model from its first coordinates, which a clamped root has none of; `motion` reads the
    coordinates (nt, n) at the control times.
    """
    import mujoco
    from mujoco import rollout

    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    first = start if machine.root != "clamped" else start[1:]
    data.qpos[: len(first)] = first
    kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
    begun = np.zeros((1, mujoco.mj_stateSize(model, kind)))
    mujoco.mj_getState(model, data, begun[0], kind)
    control = np.repeat(machine.held, setting.substeps, axis=0)[None, :, : model.nu]
    engine = rollout.Rollout(nthread=0)
    out = np.zeros((1, machine.steps * setting.substeps, begun.shape[1]))

    def play() -> tuple[Motion, float]:
        said: list[str] = []
        before = mujoco.get_mju_user_warning()
        mujoco.set_mju_user_warning(said.append)  # else it prints, starts anew, and goes on
        begin = time.perf_counter()
        engine.rollout(model, [data], begun, control, nstep=out.shape[1], state=out)
        seconds = time.perf_counter() - begin
        mujoco.set_mju_user_warning(before)
        kept = np.concatenate([begun, out[0, setting.substeps - 1 :: setting.substeps]])[:, 1 : 1 + model.nq]
        if said or not np.abs(kept).max() < 1e3:
            raise BrokenDownError("the steps are too long")
        return motion(kept), seconds

    return Player(play, lambda: play()[1])


def xml(machine: Machine, chain: tuple[Segment, ...], setting: Setting) -> str:
    """The chain in MuJoCo's format."""
    opened, offset, motors = "", 0.0, ""
    reach = sum(s.length for s in chain)
    heavy = HEAVY * (sum(s.mass for s in chain) * reach**2 + machine.payload.inertia_z)
    turned = machine.angles[0] if machine.root == "clamped" else 0.0
    for i, s in enumerate(chain):
        opened += f'<body pos="{offset!r} 0 0" euler="0 0 {turned if i == 0 else 0.0!r}">'
        if i or machine.root != "clamped":
            prescribed = i == 0 and machine.root == "motion"
            armature = f'armature="{heavy!r}"' if prescribed else ""
            hinge = f'stiffness="{s.stiffness!r}" damping="{s.damping!r}" {armature}'
            opened += f'<joint name="joint{i}" type="hinge" axis="0 0 1" {hinge}/>'
            if s.driven:
                motors += f'<motor joint="joint{i}" gear="{heavy if prescribed else 1.0!r}"/>'
        inertia = " ".join([repr(s.inertia)] * 3)
        opened += f'<inertial pos="{s.centre!r} 0 0" mass="{s.mass!r}" diaginertia="{inertia}"/>'
        offset = s.length
    step, (gx, gy) = machine.dt / setting.substeps, machine.gravity
    return (
        f'<mujoco><compiler angle="radian"/><option timestep="{step!r}" integrator="{setting.solver}" '
        f'gravity="{gx!r} {gy!r} 0" jacobian="dense"><flag contact="disable" constraint="disable" warmstart="disable"/>'
        f"</option><worldbody>{opened}{'</body>' * len(chain)}</worldbody><actuator>{motors}</actuator></mujoco>"
    )
