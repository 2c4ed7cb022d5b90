"""What a linear model does in the long run, with what has to be assumed for it said in the answer.

spectrum(model, beyond=..)   Lyapunov exponents and dichotomy intervals by QR: `spectrum`, `triangular_flow`
slow_dichotomy(model)        slow variation that decides both ways: `slow_dichotomy`
"""

from __future__ import annotations

from .long_run import Drift, Spectrum
from .slow_dichotomy import SlowDichotomy, slow_dichotomy
from .spectrum import BEYOND, spectrum

__all__ = ["BEYOND", "Drift", "SlowDichotomy", "Spectrum", "slow_dichotomy", "spectrum"]
