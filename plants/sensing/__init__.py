"""What real machines measure, with the noise of a data sheet."""

from .sensors import Sensor, sensors_of

__all__ = ["Sensor", "sensors_of"]
