"""What other programs give of a scene, each at its own best settings: `measure(scene, outputs)`.

Every program models the scene's machine with its own beams, or with rigid segments where it has none, and is searched
by itself. All run on one core.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import util

import numpy as np

from pliant.envs.scenes.scene import Scene
from pliant.plants.core.argument_gates import require_finite, require_function, require_instance, require_seconds
from pliant.studies.common.reference_motions import Progress, silent

from .elastica_rods import Rods
from .exudyn_beams import Beams
from .mujoco_cable import Cable
from .mujoco_chain import Chain
from .peer_rows import PeerRow
from .planar_machine import Machine, NotModelledError, machine_of
from .programs import Program, described
from .search import Search
from .soromox_strains import Strains

PROGRAMS: tuple[Program, ...] = (Beams(), Chain(), Cable(), Rods(), Strains())


def measure(
    scene: Scene, outputs: np.ndarray, *, budget: float = 60.0, progress: Progress | None = None
) -> tuple[PeerRow, ...]:
    """The rows of each program's own front of error against time, or one row that says why there is none.

    `outputs` (nt, n): the compared outputs of the reference at the scene's control times [their unit]. Wall time is
    that of the integration per simulated second on one core, the median of several runs after a first one; building,
    assembling and compiling a model are left out. `budget` [s] of searching, shared among the programs; what takes long
    to compile comes on top (SoRoMoX: half a minute a model).
    ValueError for outputs of another shape or not finite, and for a budget that is not positive.

    >>> from pliant.envs import scenes
    >>> from pliant.studies.peers import measure
    >>> scene = scenes.get("spacecraft-slew")
    >>> rows = measure(scene, outputs=np.zeros((len(scene.times), len(scene.compare))))
    """
    require_instance("measure.scene", scene, Scene)
    outputs = require_finite("measure.outputs", outputs, (len(scene.times), len(scene.compare)))
    budget = require_seconds("measure.budget", budget)
    if progress is not None:
        require_function("measure.progress", progress)
    told = progress or silent
    try:
        machine = machine_of(scene)
    except NotModelledError as reason:
        return tuple(PeerRow(program.peer, "", failure=str(reason)) for program in PROGRAMS)
    why = {program: without(program, machine) for program in PROGRAMS}
    share = budget / max(1, sum(not reason for reason in why.values()))
    rows: list[PeerRow] = []
    with one_core():
        for i, program in enumerate(PROGRAMS):
            told(i / len(PROGRAMS), program.peer)
            rows += measured(program, machine, outputs, scene.tolerance, share) if not why[program] else []
            rows += [PeerRow(program.peer, "", failure=why[program])] if why[program] else []
    told(1.0, "peers")
    return tuple(rows)


def without(program: Program, machine: Machine) -> str:
    """Why a program gives no rows; "" where it may."""
    if util.find_spec(program.package) is None:
        return f"{program.package} is not installed"
    return program.why_not(machine)


def measured(
    program: Program, machine: Machine, outputs: np.ndarray, tolerance: float, seconds: float
) -> list[PeerRow]:
    """The rows of one program's front."""
    search = Search(program, machine, outputs, tolerance, seconds)
    try:
        front = search.front()
    except Exception as failure:  # what another program does wrong is a row, never the end of a chart
        return [PeerRow(program.peer, "", searched=search.tried, failure=f"{type(failure).__name__}: {failure}")]
    if not front:
        return [
            PeerRow(
                program.peer, "", searched=search.tried, failure=f"none of {search.tried} settings tried gives a motion"
            )
        ]
    return [
        PeerRow(program.peer, described(program, at.setting, machine.dt), at.seconds, at.error, at.runs, search.tried)
        for at in front
    ]


@contextmanager
def one_core() -> Iterator[None]:
    """This thread, and those that begin meanwhile, on one core, where the system lets a thread choose."""
    if not hasattr(os, "sched_setaffinity"):
        yield
        return
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(before)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)
