"""A slider-crank with an elastic rod, its rigid kinematics and its steady cycles."""

from .plant import SliderCrank

__all__ = ["SliderCrank"]
