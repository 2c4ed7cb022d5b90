"""Linear-quadratic design: pure functions of arrays.

lqr      min int x'Qx + u'Ru + 2 x'Nu dt, dx/dt = A x + B u      u = -K x, K = R^-1 (B'P + N'), cost x0'P x0
dlqr     min sum x'Qx + u'Ru + 2 x'Nu,    x+ = A x + B u         u = -K x, K = (R + B'PB)^-1 (B'PA + N')
lqi      lqr with the integrals of y = C x + D u as extra states
sampled  the discrete problem that is the continuous one with u held over each step
kalman   dx/dt = A x + E w, y = C x + v with white w, v          dz/dt = A z + L (y - C z), L = P C' V^-1
dkalman  x+ = A x + E w, y = C x + v                             z+ = A z + L (y - C z), L = A P C' (C P C' + V)^-1
dplqr    dlqr of a system that repeats, for ever: the periodic Riccati equation
dpkalman dkalman of one that repeats: its gains go round with it
tvlqr    lqr over a finite time along an LTVModel, its affine term included; dtvlqr the same in discrete time

Riccati equations by SciPy's QZ method in units that follow from the problem alone, refined by Newton steps in extended
precision; a gain that rounding of the data moves by more than 1e-6 is refused. A mode that does not decay must be
reached by the input and seen by the cost (Popov, Belevitch, Hautus); the error names the others.
"""

from .algebraic import Regulator, Sampled, dkalman, dlqr, kalman, lqi, lqr, sampled
from .ltv_discretisation import SampledLTV, noise_along, sampled_along
from .periodic import PeriodicRegulator, dplqr
from .periodic_filter import PeriodicFilter, dpkalman
from .time_varying import TimeVaryingRegulator, dtvlqr, tvlqr

__all__ = [
    "PeriodicFilter",
    "PeriodicRegulator",
    "Regulator",
    "Sampled",
    "SampledLTV",
    "TimeVaryingRegulator",
    "dkalman",
    "dlqr",
    "dpkalman",
    "dplqr",
    "dtvlqr",
    "kalman",
    "lqi",
    "lqr",
    "noise_along",
    "sampled",
    "sampled_along",
    "tvlqr",
]
