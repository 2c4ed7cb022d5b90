"""Collocated PD, computed torque, command shaping."""
