"""python-control's own contract, tried on Pliant's systems, after the subjects of its test suites.

    python tests/campaigns/python_control.py

A seed is one check of the modules control_*.py beside this one: signals and names (iosys), rates and parameters
(nlsys), linearisation and operating points, interconnections, responses, state spaces with feedback, estimators,
sampling and optimal control. References are closed forms, SciPy, or python-control's own finite differences, at what
these are good for.

Not ours, and why:
  flat systems            need a flat output with its derivatives, which an elastic arm does not have
  transfer functions      of python-control's own making: models come as StateSpace
  describing functions    of static nonlinearities; a plant has states
  pickling a StateSpace   python-control keeps a lambda in it: cloudpickle and deepcopy take it, pickle does not
  discrete nonlinear      a plant is continuous: `stepper` and `LinearModel.discretize` sample it
  loops without inputs    python-control does not linearise them itself
  plots, Slycot, config   of python-control alone
  eps of linearize        refused: derivatives are exact, there is no step
  generic signal names    of linearize by default: ours are the system's unless copy_names=False
"""

from __future__ import annotations

import time
import warnings
from typing import Any

import by_seed
import control as ct
import control_linear
import control_loops
import control_rates
import control_responses
import control_signals
import control_spaces

THEMES = (control_signals, control_rates, control_linear, control_loops, control_responses, control_spaces)
CHECKS = [pair for theme in THEMES for pair in theme.CHECKS]


def run(seed: int) -> dict[str, Any]:
    name, ask = CHECKS[seed]
    began, fault = time.perf_counter(), ""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            ask()
    except Exception as error:
        fault = f"{type(error).__name__}: {error}"[:300]
    return {"seed": seed, "name": name, "fault": fault, "seconds": round(time.perf_counter() - began, 3)}


def summary(rows: list[dict[str, Any]]) -> str:
    faults = [f"{r['name']}: {r['fault']}" for r in rows if r["fault"]]
    return "\n  ".join([f"python-control {ct.__version__}: {len(rows) - len(faults)} of {len(rows)} hold", *faults])


if __name__ == "__main__":
    by_seed.main(__doc__, len(CHECKS), run, summary, lambda row: bool(row["fault"]))
