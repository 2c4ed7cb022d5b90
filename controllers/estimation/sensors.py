"""What real machines measure: sensors by the plant's outputs, with noise and resolution of a data sheet's order.

Each number below is the usual size for its kind of device, not one product's. `noise` is the standard deviation of
one sample; `density` is a one-sided amplitude density [unit/sqrt(Hz)], as data sheets give it, so that a sample
averaged over dt has the variance density^2/(2 dt); a quantum q adds q^2/12 (Widrow and Kollar 2008, "Quantization
Noise", uniform model).

device               kind             noise, quantum                              stands for
joint encoder        encoder          2^17 counts a turn, half a count jitter     absolute encoders of robot joints
strain gauge         strain gauge     1e-6 of strain                              foil full bridge, 1 kHz amplifier
accelerometer        accelerometer    100 micro-g/sqrt(Hz)                        industrial MEMS accelerometers
tip gyro             gyro             0.005 deg/s/sqrt(Hz)                        tactical MEMS gyros
spacecraft gyro      gyro             angle random walk 0.005 deg/sqrt(h)         fibre-optic gyros
star tracker         star tracker     5 arc seconds, one sigma                    star trackers of small spacecraft
wheel tachometer     tachometer       1 rpm                                       reaction wheels' own electronics

A gauge reads strain, which is curvature times the distance from the neutral axis. Beam has no thickness: that of a
rectangle with its area and second moment, sqrt(3 I/A) to either side, is taken.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pliant.plants.arms.single_link import SingleLinkArm
from pliant.plants.arms.two_link import TwoLinkArm
from pliant.plants.beams.section import Beam
from pliant.plants.core.parameters import require_choice, require_finite
from pliant.plants.dynamics.plant import Plant
from pliant.plants.large_deflection.large_beam import LargeDeflectionBeam
from pliant.plants.slider_crank.plant import SliderCrank
from pliant.plants.spacecraft.plant import FlexibleSpacecraft

KINDS = ("encoder", "strain gauge", "accelerometer", "gyro", "star tracker", "tachometer", "other")
COUNT = 2 * np.pi / 2**17  # [rad]
STRAIN = 1e-6
ACCELERATION = 100e-6 * 9.81  # [m/s^2/sqrt(Hz)]
TIP_RATE = np.deg2rad(0.005)  # [rad/s/sqrt(Hz)]
DRIFT = np.sqrt(2) * np.deg2rad(0.005) / 60  # [rad/s/sqrt(Hz)]: angle random walk N [rad/sqrt(s)], density sqrt(2) N
STARS = np.deg2rad(5 / 3600)  # [rad]
SPEED = 2 * np.pi / 60  # [rad/s]


@dataclass(frozen=True)
class Sensor:
    """Reads the plant's output (or state) `output`, plus noise, rounded to whole quanta."""

    kind: str  # one of KINDS
    output: str
    unit: str
    noise: float = 0.0  # [unit] standard deviation of a sample
    density: float = 0.0  # [unit/sqrt(Hz)] one-sided
    quantum: float = 0.0  # [unit]

    def __post_init__(self) -> None:
        require_choice("Sensor", "kind", self.kind, KINDS)
        for name in ("noise", "density", "quantum"):
            value = getattr(self, name)
            if not 0 <= value < np.inf:
                raise ValueError(f"Sensor.{name} of {self.output} = {value!r} must be >= 0")
        if not (self.noise or self.density or self.quantum):
            raise ValueError(f"Sensor.noise of {self.output} = 0 must be > 0 where density and quantum are 0 too")

    def deviation(self, dt: float) -> float:
        """Standard deviation [unit] of what a sample every dt [s] errs by, quantisation taken as noise."""
        return float(np.sqrt(self.noise**2 + self.density**2 / (2 * _step(dt)) + self.quantum**2 / 12))

    def read(self, value: float, dt: float, rng: np.random.Generator) -> float:
        """One sample of the true `value` [unit] at a period of dt [s]."""
        noisy = value + rng.normal() * np.sqrt(self.noise**2 + self.density**2 / (2 * _step(dt)))
        return float(self.quantum * np.round(noisy / self.quantum) if self.quantum else noisy)


def read(sensors: Sequence[Sensor], y: np.ndarray, dt: float, rng: np.random.Generator) -> np.ndarray:
    """One sample (ns,) of each sensor from the true values y (ns,) of what they read."""
    y = require_finite("read.y", y, (len(sensors),))
    return np.array([sensor.read(float(value), dt, rng) for sensor, value in zip(sensors, y)])


def covariance(sensors: Sequence[Sensor], dt: float) -> np.ndarray:
    """V (ns, ns) of their errors in samples dt [s] apart."""
    return np.diag([sensor.deviation(dt) ** 2 for sensor in sensors])


def sensors_of(plant: Plant) -> tuple[Sensor, ...]:
    """What a machine like this plant carries. ValueError for a plant of another kind.

    SingleLinkArm        hub encoder, strain gauge at the root, accelerometer at the tip
    TwoLinkArm           joint encoders, a strain gauge at each link's root, accelerometer at the tip
    LargeDeflectionBeam  encoder of a root that turns, strain gauge at a root that does not hinge, gyro at the tip
    FlexibleSpacecraft   star tracker, gyro, tachometers of its wheels, encoders of its hinges; not its place
    SliderCrank          crank encoder, accelerometer across the rod at its middle
    """
    found = _arm(plant) or _beam(plant) or _craft(plant) or _crank(plant)
    if not found:
        raise ValueError(f"sensors_of: no selection for a {type(plant).__name__}; give Sensors by name of output")
    return found


def encoder(output: str) -> Sensor:
    """Of an angle [rad]."""
    return Sensor("encoder", output, "rad", noise=COUNT / 2, quantum=COUNT)


def gauge(output: str, beam: Beam) -> Sensor:
    """Of the curvature [1/m] about z."""
    return Sensor("strain gauge", output, "1/m", noise=STRAIN / float(np.sqrt(3 * beam.I_z / beam.area)))


def accelerometer(output: str) -> Sensor:
    """Of an acceleration [m/s^2]."""
    return Sensor("accelerometer", output, "m/s^2", density=ACCELERATION)


def gyro(output: str, density: float = TIP_RATE) -> Sensor:
    """Of a rate [rad/s]."""
    return Sensor("gyro", output, "rad/s", density=density)


def _arm(plant: Plant) -> tuple[Sensor, ...]:
    if isinstance(plant, SingleLinkArm):
        return encoder("hub_angle"), gauge("root_curvature", plant.link), accelerometer("tip_acceleration")
    if isinstance(plant, TwoLinkArm):
        gauges = gauge("root1_curvature", plant.link1), gauge("root2_curvature", plant.link2)
        return (encoder("theta1"), encoder("theta2"), *gauges, accelerometer("tip_acceleration"))
    return ()


def _beam(plant: Plant) -> tuple[Sensor, ...]:
    if not isinstance(plant, LargeDeflectionBeam):
        return ()
    turning = {"clamped": (), "hinged": (encoder("root_angle"),), "driven": (encoder("hub_angle"),)}[plant.root]
    held = () if plant.root == "hinged" else (gauge("root_curvature", plant.beam),)
    return (*turning, *held, gyro("tip_angle_rate"))


def _craft(plant: Plant) -> tuple[Sensor, ...]:
    if not isinstance(plant, FlexibleSpacecraft):
        return ()
    stars = [Sensor("star tracker", f"attitude_{c}", "rad", noise=STARS) for c in "xyz"]
    rates = [gyro(f"body_rate_{c}", DRIFT) for c in "xyz"]
    wheels = [
        Sensor("tachometer", f"wheel{k}_momentum", "N m s", noise=float(wheel.inertia) * SPEED)
        for k, wheel in enumerate(plant.hub.wheels, start=1)
    ]
    hinges = [encoder(s.name) for s in plant.coordinates if s.name.startswith("hinge")]
    return (*stars, *rates, *wheels, *hinges)


def _crank(plant: Plant) -> tuple[Sensor, ...]:
    if not isinstance(plant, SliderCrank):
        return ()
    return encoder("crank_angle"), accelerometer("mid_acceleration")


def _step(dt: float) -> float:
    if not 0 < dt < np.inf:
        raise ValueError(f"Sensor: dt = {dt!r} must be > 0 [s]")
    return dt
