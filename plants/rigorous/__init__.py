"""Theorems for a linear model as it is given: its doubles and its interpolation, in ball arithmetic.

proof                 what is shown of a constant, a periodic or a finite model
balls                 matrices of balls (Arb, by python-flint): norms, bounds as doubles rounded outwards
exact_roots           where the roots of a rational matrix are: counted in exact arithmetic, enclosed
spline_in_balls       the cubic spline through given doubles
taylor_steps          a transition matrix over a step of a cubic A(t), with its remainder
enclosed_transition   products of many of them in frames that keep errors apart
enclosed_multipliers  the largest eigenvalue of a matrix of balls, against the unit circle
"""
