"""Sensors, process noise, Kalman gains and the filter."""
