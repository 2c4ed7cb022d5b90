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

from pliant.plants.beams.section import Beam
from pliant.plants.core.argument_gates import (
    require_all,
    require_choice,
    require_finite,
    require_instance,
    require_number,
    require_seconds,
    require_text,
)
from pliant.plants.core.signals import Sensed
from pliant.plants.dynamics.plant import Plant

KINDS = ("encoder", "strain gauge", "accelerometer", "gyro", "star tracker", "tachometer", "other")
COUNT = 2 * np.pi / 2**17  # [rad]
STRAIN = 1e-6
ACCELERATION = 100e-6 * 9.81  # [m/s^2/sqrt(Hz)]
TIP_RATE = np.deg2rad(0.005)  # [rad/s/sqrt(Hz)]
DRIFT = np.sqrt(2) * np.deg2rad(0.005) / 60  # [rad/s/sqrt(Hz)]: angle random walk N [rad/sqrt(s)], density sqrt(2) N
STARS = np.deg2rad(5 / 3600)  # [rad]
SPEED = 2 * np.pi / 60  # [rad/s]
DEVICES = {  # what a plant names: kind; noise, density, quantum in what the device reads
    "encoder": ("encoder", COUNT / 2, 0.0, COUNT),
    "strain gauge": ("strain gauge", STRAIN, 0.0, 0.0),
    "accelerometer": ("accelerometer", 0.0, ACCELERATION, 0.0),
    "gyro": ("gyro", 0.0, TIP_RATE, 0.0),
    "fibre-optic gyro": ("gyro", 0.0, DRIFT, 0.0),
    "star tracker": ("star tracker", STARS, 0.0, 0.0),
    "tachometer": ("tachometer", SPEED, 0.0, 0.0),
}


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
        require_text("Sensor.output", self.output)
        require_text("Sensor.unit", self.unit, empty=True)
        for name in ("noise", "density", "quantum"):
            value = require_number(f"Sensor.{name} of {self.output}", getattr(self, name), "nonnegative", self.unit)
            object.__setattr__(self, name, value)
        if not (self.noise or self.density or self.quantum):
            raise ValueError(f"Sensor.noise of {self.output} = 0 must be > 0 where density and quantum are 0 too")

    def deviation(self, dt: float) -> float:
        """Standard deviation [unit] of what a sample every dt [s] errs by, quantisation taken as noise."""
        return float(np.sqrt(self.noise**2 + self.density**2 / (2 * _step(dt)) + self.quantum**2 / 12))

    def read(self, value: float, dt: float, rng: np.random.Generator) -> float:
        """One sample of the true `value` [unit] at a period of dt [s]."""
        value = require_number("Sensor.value", value, unit=self.unit)
        require_instance("Sensor.rng", rng, np.random.Generator)
        noisy = value + rng.normal() * np.sqrt(self.noise**2 + self.density**2 / (2 * _step(dt)))
        return float(self.quantum * np.round(noisy / self.quantum) if self.quantum else noisy)


def read(sensors: Sequence[Sensor], y: np.ndarray, dt: float, rng: np.random.Generator) -> np.ndarray:
    """One sample (ns,) of each sensor from the true values y (ns,) of what they read, in their units.

    Example
    -------
    >>> read([encoder("hub_angle")], np.array([0.5]), 0.01, np.random.default_rng(0)).round(3)
    array([0.5])
    """
    sensors = require_all("read.sensors", sensors, Sensor)
    y = require_finite("read.y", y, (len(sensors),))
    require_instance("read.rng", rng, np.random.Generator)
    return np.array([sensor.read(float(value), dt, rng) for sensor, value in zip(sensors, y)])


def covariance(sensors: Sequence[Sensor], dt: float) -> np.ndarray:
    """V (ns, ns) of their errors in samples dt [s] apart, in their units squared.

    Example
    -------
    >>> covariance([encoder("hub_angle"), gyro("tip_rate")], 0.01).shape
    (2, 2)
    """
    sensors, dt = require_all("covariance.sensors", sensors, Sensor), _step(dt)
    return np.diag([sensor.deviation(dt) ** 2 for sensor in sensors])


def sensors_of(plant: Plant) -> tuple[Sensor, ...]:
    """What a machine like this plant carries: the plant's own `sensors()` with the noise of the devices above.

    ValueError for a plant that names none.

    Example
    -------
    >>> from pliant.plants import SingleLinkArm
    >>> [sensor.kind for sensor in sensors_of(SingleLinkArm.textbook())]
    ['encoder', 'strain gauge', 'accelerometer']
    """
    found = require_instance("sensors_of.plant", plant, Plant).sensors()
    if not found:
        raise ValueError(f"sensors_of: no selection for a {type(plant).__name__}; give Sensors by name of output")
    units = {s.name: s.unit for s in (*plant.states, *plant.outputs)}
    return tuple(_sensor(place, place.unit or units[place.signal]) for place in found)


def _sensor(place: Sensed, unit: str) -> Sensor:
    require_choice("Sensed", "device", place.device, tuple(DEVICES))
    kind, *sizes = DEVICES[place.device]
    return Sensor(kind, place.signal, unit, *(size * place.scale for size in sizes))


def encoder(output: str) -> Sensor:
    """Of an angle [rad].

    Example
    -------
    >>> encoder("hub_angle").unit
    'rad'
    """
    return Sensor("encoder", output, "rad", noise=COUNT / 2, quantum=COUNT)


def gauge(output: str, beam: Beam) -> Sensor:
    """Of the curvature [1/m] about z, of a beam that stands in for the gauge's place.

    Example
    -------
    >>> from pliant.plants import SingleLinkArm
    >>> gauge("root_curvature", SingleLinkArm.textbook().link).unit
    '1/m'
    """
    require_instance("gauge.beam", beam, Beam)
    return Sensor("strain gauge", output, "1/m", noise=STRAIN / float(np.sqrt(3 * beam.I_z / beam.area)))


def accelerometer(output: str) -> Sensor:
    """Of an acceleration [m/s^2].

    Example
    -------
    >>> accelerometer("tip_acceleration").kind
    'accelerometer'
    """
    return Sensor("accelerometer", output, "m/s^2", density=ACCELERATION)


def gyro(output: str, density: float = TIP_RATE) -> Sensor:
    """Of a rate [rad/s]; density: of its white noise [rad/s per sqrt(Hz)].

    Example
    -------
    >>> gyro("tip_rate").kind
    'gyro'
    """
    return Sensor("gyro", output, "rad/s", density=density)


def _step(dt: float) -> float:
    return require_seconds("Sensor.dt", dt)
