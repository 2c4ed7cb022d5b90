"""Are true parameters of trees and two-link arms inside the 95 % intervals in 95 % of runs?

    python tests/campaigns/machines_identified.py two-link --machines 20 --runs 10

Three machines, their parameters drawn by seed about a nominal set, moved for DURATION by torques of random sign; dop853
plays them, an integrator that the identification does not use, and sensors of a data sheet are read anew for each run.

two-link   two strips; both moduli, the payload, the shoulder's friction from encoders at both joints and strain gauges
           at both roots
joint      a bar behind an elastic gear (`flexible-joint-slew`): the gear's stiffness and damping, the payload and the
           rotor's friction from an encoder at the motor and one at the bar
boom       a strip that bends behind such a gear: the gear's stiffness, the strip's modulus, the payload from the same
           encoders and a gauge

Starts are 10 to 30 % away, noise levels are estimated. The checks of a run hang together, so the share of true values
inside is a mean over runs, and scatters by what they do. Fails where it is more than three deviations from 95 %, where
joint regions (chi-squared) are, or where a run is doubted more often than the tests say.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import by_seed  # noqa: F401 - finds tests/cases
import numpy as np
from identification import DEVIATIONS, LEVEL
from scipy.stats import chi2

from pliant.controllers.estimation.sensors import COUNT, STRAIN
from pliant.envs.scenes.registry import get
from pliant.plants import (
    Beam,
    ElasticJoint,
    Experiment,
    FlexibleTree,
    Joint,
    Material,
    Payload,
    Trajectory,
    TreeBody,
    TwoLinkArm,
    identify,
)
from pliant.plants.dynamics.plant import Plant

DURATION, RATE = 1.0, 500.0  # [s], [Hz]
ALUMINIUM = Material(density=2700.0, E=70e9, G=27e9, damping=5e-4)
GEAR = "bodies.0.joint.elastic"


@dataclass(frozen=True)
class Machine:
    """A plant that varies parameters, the sizes of its torques [N m], the noise of its sensors."""

    plant: Plant
    torques: tuple[float, ...]
    noise: Mapping[str, float]
    flips: float  # changes of a torque's sign a second


def two_link() -> Machine:
    """No gravity, so that torques alone move it."""
    strip = Beam.rectangular(0.8, 0.05, 0.006, ALUMINIUM)
    arm = TwoLinkArm(
        link1=strip,
        link2=strip,
        joint_mass=0.5,
        payload=Payload(mass=0.3, inertia=1e-3),
        joint_friction=(0.05, 0.02),
        kinematics="stiffened",
        basis="polynomial",
    )
    bent = STRAIN / strip.half_depth
    noise = {"theta1": COUNT, "theta2": COUNT, "root1_curvature": bent, "root2_curvature": bent}
    return Machine(arm.vary("link1.E", "link2.E", "payload.mass", "joint_friction.0"), (2.0, 0.7), noise, 10.0)


def joint() -> Machine:
    plant = get("flexible-joint-slew").plant
    varied = plant.vary(f"{GEAR}.stiffness", f"{GEAR}.damping", "payload.mass", f"{GEAR}.rotor_friction")
    return Machine(varied, (0.3,), {"joint_motor": 20 * COUNT, "joint": COUNT}, 10.0)


def boom() -> Machine:
    gear = ElasticJoint(stiffness=4000.0, damping=3.0, ratio=50.0, rotor_inertia=1e-4, rotor_friction=2e-4)
    strip = Beam.rectangular(0.8, 0.05, 0.006, ALUMINIUM)
    body = TreeBody(name="boom", joint=Joint(name="j1", elastic=gear), inertia=0.01, beam=strip, modes=(2, 0, 0, 0))
    tree = FlexibleTree.serial([body], payload=Payload(mass=0.5, inertia=1e-3))
    noise = {"j1_motor": 20 * COUNT, "j1": COUNT, "boom_curvature_y": STRAIN / strip.half_depth}
    return Machine(tree.vary(f"{GEAR}.stiffness", "bodies.0.beam.E", "payload.mass"), (0.1,), noise, 10.0)


MACHINES = {"two-link": two_link, "joint": joint, "boom": boom}


def drawn(machine: Machine, seed: int, k: int) -> tuple[dict[str, float], Trajectory, np.random.Generator]:
    """(true parameters, motion, what further is drawn from) of the k-th machine."""
    rng, plant = np.random.default_rng([seed, k]), machine.plant
    true = plant.nominal_parameters * np.exp(rng.uniform(-0.4, 0.4, len(plant.varied)))
    t = np.arange(int(DURATION * RATE) + 1) / RATE
    signs = np.cumprod(np.where(rng.uniform(size=(len(t), plant.nu)) < machine.flips / RATE, -1.0, 1.0), axis=0)
    motion = plant.simulate(plant.rest_state, signs * machine.torques, t, p=true)
    return dict(zip(plant.varied, true.tolist())), motion, rng


def runs(machine: Machine, machines: int, count: int, seed: int = 0) -> Iterator[tuple[dict[str, bool], float, Any]]:
    """Of each run: whether each true value is inside its interval, the squared distance, what was found."""
    for k in range(machines):
        true, motion, rng = drawn(machine, seed, k)
        value = np.array(list(true.values()))
        start = dict(zip(true, value * (1 + rng.choice([-1, 1], len(value)) * rng.uniform(0.1, 0.3, len(value)))))
        for _ in range(count):
            read = {s: motion[s] + level * rng.standard_normal(len(motion)) for s, level in machine.noise.items()}
            found = identify(machine.plant, Experiment(t=motion.t, u=motion.u, measured=read), start=start)
            error = np.array(list(found.standard_errors.values()))
            off = (np.array(list(found.values.values())) - value) / error
            ends = [found.intervals[n] for n in true]
            yield (
                {n: bool(a <= v <= b) for n, v, (a, b) in zip(true, value, ends)},
                float(off @ np.linalg.solve(found.correlation, off)),
                found,
            )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("machine", nargs="?", choices=list(MACHINES), help="all three where none is named")
    parser.add_argument("--machines", type=int, default=20)
    parser.add_argument("--runs", type=int, default=10)
    parser.add_argument("--seed", type=int, default=0)
    told = parser.parse_args()
    return max([judged(name, told) for name in ([told.machine] if told.machine else MACHINES)])


def judged(name: str, told: argparse.Namespace) -> int:
    """1 where too many or too few true values are inside."""
    began, machine = time.monotonic(), MACHINES[name]()
    found = list(runs(machine, told.machines, told.runs, told.seed))
    sure = [one for one in found if not one[2].doubts and not one[2].unidentifiable]
    doubted = sum(bool(one[2].doubts) for one in found)
    for words in sorted({said for one in found for said in one[2].doubts}):
        print(f"doubt: {words}")
    inside = np.array([list(one[0].values()) for one in sure])
    joint_share, n = np.mean([d <= chi2.ppf(LEVEL, inside.shape[1]) for _, d, _ in sure]), len(sure)
    near = float(inside.mean(axis=1).std() / np.sqrt(n))
    print(f"{name}: {len(found)} runs in {time.monotonic() - began:.0f} s, {doubted} in doubt, {n} counted")
    print("inside: " + ", ".join(f"{k} {100 * v:.1f} %" for k, v in zip(machine.plant.varied, inside.mean(axis=0))))
    print(f"all {100 * inside.mean():.1f} %, where a mean of so many runs scatters by {100 * near:.1f} %")
    print(f"jointly {100 * joint_share:.1f} %, mean squared distance {np.mean([d for _, d, _ in sure]):.2f}", end=" ")
    print(f"({inside.shape[1]} expected)")
    good = abs(inside.mean() - LEVEL) <= DEVIATIONS * near and doubted <= 1 + len(found) // 100
    return 0 if good and abs(joint_share - LEVEL) <= DEVIATIONS * np.sqrt(LEVEL * (1 - LEVEL) / n) else 1


if __name__ == "__main__":
    sys.exit(main())
