"""Bad input, one table: each is a ValueError that names the field, the value and the range."""

import dataclasses

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.plants import Beam, LinearModel, Material, Payload, SingleLinkArm, Trajectory, TwoLinkArm, beams, step_limit
from pliant.plants.modal_data.modal_data import ModalData
from pliant.plants.stability.assessment import assess

ARM, LINK = TwoLinkArm.textbook(), SingleLinkArm.textbook()
STRIP = ARM.link1
ZERO = np.zeros(12)
NAN = ZERO.copy()
NAN[3] = np.nan


def two(**changes):
    return dataclasses.replace(ARM, **changes)


def one(**changes):
    return dataclasses.replace(LINK, **changes)


def beam(**changes):
    return dataclasses.replace(STRIP, **changes)


def run(**options):
    return ARM.simulate(**{"x0": ZERO, "t": [0, 0.01], **options})


class Wild:
    dt, reads = None, ("theta1",)

    def act(self, t, y):
        return [np.inf, 0.0]


class Hasty(Wild):
    dt = 0.0


def nominal(t):
    return Trajectory.from_arrays(t, np.zeros((len(t), 12)), np.zeros((len(t), 2)), plant=ARM)


TABLE = {
    # parameters
    "negative length": (lambda: beam(length=-1.0), r"Beam\.length = -1\.0 must be > 0 \[m\]"),
    "infinite length": (lambda: beam(length=np.inf), r"Beam\.length = inf must be > 0 \[m\]"),
    "zero density": (lambda: beam(density=0.0), r"Beam\.density = 0\.0 must be > 0 \[kg/m\^3\]"),
    "material": (lambda: Material(density=0, E=1.0, G=1.0), r"Material\.density = 0 must be > 0 \[kg/m\^3\]"),
    "negative damping": (lambda: beam(damping=-1e-3), r"Beam\.damping = -0\.001 must be >= 0 \[s\]"),
    "a word": (lambda: beam(E="steel"), r"Beam\.E = 'steel' must be a number > 0 \[Pa\]"),
    "yes": (lambda: beam(area=True), r"Beam\.area = True must be a number > 0 \[m\^2\]"),
    "hollow tube": (
        lambda: Beam.tube(1.0, outer=0.1, inner=0.2, material=beams.STEEL),
        r"Beam\.tube inner = 0\.2 must be > 0 and < outer = 0\.1 \[m\]",
    ),
    "payload mass": (lambda: Payload(mass=-0.1), r"Payload\.mass = -0\.1 must be >= 0 \[kg\]"),
    "payload inertia": (lambda: Payload(inertia=-1.0), r"Payload\.inertia = -1\.0 must be >= 0 \[kg m\^2\]"),
    "payload offset": (lambda: Payload(offset=(1.0, 0.0)), r"Payload\.offset = \(1\.0, 0\.0\) must be three"),
    "gravity": (lambda: two(gravity=np.nan), r"TwoLinkArm\.gravity = nan must be a finite number \[m/s\^2\]"),
    "joint mass": (lambda: two(joint_mass=-1.0), r"TwoLinkArm\.joint_mass = -1\.0 must be >= 0 \[kg\]"),
    "hub inertia": (
        lambda: two(hub_inertia=(0.1, -0.1)),
        r"TwoLinkArm\.hub_inertia\[1\] = -0\.1 must be >= 0 \[kg m\^2\]",
    ),
    "one hub": (lambda: two(hub_inertia=(0.1,)), r"TwoLinkArm\.hub_inertia = \(0\.1,\) must be two numbers"),
    "hub friction": (lambda: one(hub_friction=-1), r"SingleLinkArm\.hub_friction = -1 must be >= 0 \[N m s/rad\]"),
    # choices
    "basis": (lambda: two(basis="cubic"), r"TwoLinkArm\.basis = 'cubic' must be one of 'clamped-free', 'payload'"),
    "kinematics": (lambda: two(kinematics="rigid"), r"TwoLinkArm\.kinematics = 'rigid' must be one of 'linear'"),
    "reduction": (lambda: two(reduction=1), r"TwoLinkArm\.reduction = 1 must be one of 'full', 'rigid-inertia'"),
    "slope": (lambda: two(tip_slope="no"), r"TwoLinkArm\.tip_slope = 'no' must be True or False"),
    "drive": (lambda: one(drive="belt"), r"SingleLinkArm\.drive = 'belt' must be one of 'torque', 'motion'"),
    "theory": (lambda: one(theory="cosserat"), r"SingleLinkArm\.theory = 'cosserat' must be one of"),
    "too many modes": (lambda: two(modes=(2, 41)), r"TwoLinkArm\.modes\[1\] = 41 must be an integer from 0 to 40"),
    "too many polynomials": (
        lambda: two(basis="polynomial", modes=(21, 2)),
        r"TwoLinkArm\.modes\[0\] = 21 must be an integer from 0 to 20",
    ),
    "half a mode": (lambda: one(modes=1.5), r"SingleLinkArm\.modes = 1\.5 must be an integer from 0 to 40"),
    "negative modes": (lambda: one(modes=-1), r"SingleLinkArm\.modes = -1 must be an integer from 0 to 40"),
    # states and inputs
    "NaN state": (lambda: ARM.dynamics(NAN), r"TwoLinkArm\.x\[3\] \(q12\) = nan must be finite"),
    "NaN state in a batch": (
        lambda: ARM.measure(np.array([ZERO, NAN])),
        r"TwoLinkArm\.x\[3\] \(q12\) = nan must be finite",
    ),
    "infinite input": (
        lambda: ARM.dynamics(ZERO, [np.inf, 0]),
        r"TwoLinkArm\.u\[0\] \(tau1\) = inf must be finite",
    ),
    "short state": (lambda: ARM.dynamics(np.zeros(11)), r"TwoLinkArm\.x has shape \(11,\), must be \(12,\) or"),
    "number": (lambda: LINK.dynamics(np.zeros(6), 1.0), r"SingleLinkArm\.u has shape \(\), must be \(1,\) or"),
    "cube": (lambda: ARM.energy(np.zeros((2, 2, 12))), r"TwoLinkArm\.x has shape \(2, 2, 12\), must be \(12,\)"),
    "batches": (
        lambda: ARM.dynamics(np.zeros((3, 12)), np.zeros((2, 2))),
        r"TwoLinkArm\.u has 2 rows, must have 3",
    ),
    "disturbance": (lambda: ARM.dynamics(ZERO, w=[1.0]), r"TwoLinkArm\.w has shape \(1,\), must be \(2,\)"),
    "parameters": (lambda: ARM.dynamics(ZERO, p=[1.0]), r"TwoLinkArm\.p has shape \(1,\), must be \(0,\)"),
    "name of a linear system": (
        lambda: ARM.linearize(ZERO).to_control(name=[]),
        r"to_control\.name = \[\] must be words",
    ),
    "default parameter": (
        lambda: ARM.vary("payload.mass").to_control(params={"payload.mass": np.array("light")}),
        r"params\['payload\.mass'\] = 'light' must be a finite number",
    ),
    "coordinates in words": (
        lambda: assess(ARM.linearize(ZERO), coordinates=0),
        r"assess\.coordinates = 0 must be words",
    ),
    "modal data without modes": (
        lambda: dataclasses.replace(ModalData.rigid(1.0, [0, 0, 0], np.eye(3)), R=None),
        r"ModalData\.R = None must be an array",
    ),
    "varied parameter": (
        lambda: ARM.vary("payload.mass").dynamics(ZERO, p=[np.nan]),
        r"TwoLinkArm\.p\[0\] \(payload\.mass\) = nan must be finite",
    ),
    "batch to linearise": (
        lambda: ARM.linearize(np.zeros((2, 12))),
        r"TwoLinkArm\.x has shape \(2, 12\), must be \(12,\)",
    ),
    # unknown names
    "vary": (lambda: ARM.vary("payload.weight"), r"'payload\.weight': Payload has no 'weight'; it has mass"),
    "vary a word": (lambda: ARM.vary("basis"), r"'basis' is not a physical quantity; choose from link1\.length"),
    "vary twice": (lambda: ARM.vary("gravity", "gravity"), r"vary = \('gravity', 'gravity'\) must be distinct names"),
    "vary a third hub": (lambda: ARM.vary("hub_inertia.2"), "tuple has no '2'"),
    "equilibrium": (lambda: ARM.equilibrium(elbow=1.0), "state or input 'elbow' must be one of theta1"),
    "locked": (lambda: ARM.natural_frequencies(locked=("hub",)), "coordinate 'hub' must be one of theta1"),
    "column": (lambda: run()["tip_z"], r"Trajectory\['tip_z'\] must be one of theta1"),
    "scene": (lambda: scenes.get("juggling"), "'juggling' must be one of 'single-link-slew'"),
    # simulation
    "method": (
        lambda: run(method="euler"),
        r"method = 'euler' must be one of 'dop853', 'rodas5p', 'radau', 'cvodes'",
    ),
    "missing step": (lambda: run(method="rk4"), r"step = None must be a number of seconds for rk4"),
    "needless step": (lambda: run(step=0.1), r"step = 0\.1 must be .* None otherwise"),
    "zero step": (lambda: run(method="rk4", step=0.0), r"step = 0\.0 must be > 0 \[s\]"),
    "tolerance": (lambda: run(rtol=-1e-6), r"rtol = -1e-06 must be > 0 and at most 1"),
    "no tolerance": (lambda: run(atol=0.0), r"atol = 0\.0 must be > 0 and at most 1"),
    "one time": (lambda: run(t=[0.0]), "t has 1 times, must have at least 2"),
    "no times": (lambda: ARM.simulate(ZERO), r"t = None must be an array"),
    "late times": (lambda: run(t=[0, 2, 1]), r"t\[2\] = 1 must be greater than t\[1\] = 2"),
    "long input": (lambda: run(u=np.zeros((3, 2))), r"TwoLinkArm\.u has shape \(3, 2\), must be \(2, 2\)"),
    "wide input": (lambda: run(u=[1.0, 2.0, 3.0]), r"TwoLinkArm\.u has shape \(3,\), must be \(2,\)"),
    "NaN input": (lambda: run(u=[0.0, np.nan]), r"TwoLinkArm\.u\[1\] = nan must be finite"),
    "input function": (lambda: run(u=lambda t: [1.0]), r"u\(0\) = \[1\.\] must be 2 finite numbers"),
    "controller": (lambda: run(u=Wild()), r"controller at t = 0 s gave \[inf +0\.\], must be 2 finite"),
    "sampling time": (lambda: run(u=Hasty()), r"controller dt = 0\.0 must be > 0 \[s\]"),
    "batch to simulate": (lambda: run(x0=np.zeros((2, 12))), r"one state \(12,\), not a batch of 2"),
    "cvodes": (lambda: run(method="cvodes", u=lambda t: [0.0, 0.0]), '"cvodes" needs an input held'),
    "step limit": (lambda: step_limit(ARM, ZERO, "euler"), r"integrate\.method = 'euler' must be one of 'rk4'"),
    # nominal motions and linear models
    "repeated times": (
        lambda: nominal([0.0, 0.1, 0.1, 0.2]),
        r"Trajectory\.t\[2\] = 0\.1 must be greater than Trajectory\.t\[1\] = 0\.1",
    ),
    "nominal of another plant": (
        lambda: ARM.linearize_along(ARM.ladder()[0].simulate(np.zeros(4), None, [0, 0.1])),
        r"nominal\.states = \('theta1', 'theta2', 'theta1_rate', 'theta2_rate'\) must be \('theta1', 'theta2', 'q11'",
    ),
    "linear model": (lambda: LinearModel.from_matrices([[1.0, 2.0]], [[1.0]]), r"LinearModel\.A has shape \(1, 2\)"),
    # scenes
    "torque limit of zero": (
        lambda: scenes.get("two-link-reach", limits=(0.0, 20.0)),
        r"Scene\.limits\[0\] = 0\.0 must be > 0 \[N m\]",
    ),
    "duration": (lambda: scenes.get("two-link-reach", duration=-1.0), r"Scene\.duration = -1\.0 must be > 0 \[s\]"),
}


@pytest.mark.parametrize("name", list(TABLE))
def test_bad_input_is_named(name):
    make, message = TABLE[name]
    with pytest.raises(ValueError, match=message):
        make()
