"""Sensors as estimators ask for them: those of `pliant.plants.sensing`."""

from pliant.plants.sensing.sensors import (
    ACCELERATION,
    COUNT,
    STRAIN,
    Sensor,
    accelerometer,
    covariance,
    encoder,
    gauge,
    gyro,
    read,
    sensors_of,
)

__all__ = [
    "ACCELERATION",
    "COUNT",
    "STRAIN",
    "Sensor",
    "accelerometer",
    "covariance",
    "encoder",
    "gauge",
    "gyro",
    "read",
    "sensors_of",
]
