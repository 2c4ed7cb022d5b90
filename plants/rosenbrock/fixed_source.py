"""C source of a whole motion of one state by fixed steps of RODAS3, as motions/motion_source.py has the explicit ones.

The input over a step is the parabola through its values at the start, the middle and the end of it: the stages take it
where they stand, and its slope at the start counts as time does.
"""

from __future__ import annotations

import casadi as ca

from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.motions import motion_source

from . import plant_functions, step_source
from .tableaux import rodas3

_STEP = """
static void step_{name}(const T *x, T t, const T *u, long ahead, const T *w, const T *p, T h, T *restrict after) {{
  T z[LD] ALIGNED, y[LD] ALIGNED, change[NU + 1], k[{stages}][LD] ALIGNED, J[NX][LD] ALIGNED;
  struct factors factors;
  memset(z, 0, sizeof z);
  memcpy(z, x, sizeof(T) * NX);
  for (int i = 0; ahead && i < NU; i++) change[i] = (4 * u[ahead + i] - 3 * u[i] - u[2 * ahead + i]) / h;
  slopes(t, z, u, w, p, ahead ? change : 0, J);
  stages_{name}(z, t, u, ahead, w, p, h, (const T (*)[LD])J, &factors, k, y);
  memcpy(after, y, sizeof(T) * NX);
}}
ENTRY(steps_{name}) {{
  T t, x[NX], u[NU + 1], w[NW + 1], p[NP + 1], after[NX];
  for (long b = first; b < last; b++) {{
    t = in[0][b];
    for (int i = 0; i < NX; i++) x[i] = in[1][i * ld + b];
    for (int i = 0; i < NU; i++) u[i] = in[2][i * ld + b];
    for (int i = 0; i < NW; i++) w[i] = in[3][i * ld + b];
    for (int i = 0; i < NP; i++) p[i] = in[4][i * ld + b];
    for (long i = 0; i < n; i++) {{
      step_{name}(x, t + i * (T)s[0], u, 0, w, p, (T)s[0], after);
      memcpy(x, after, sizeof x);
    }}
    for (int i = 0; i < NX; i++) out[0][i * ld + b] = x[i];
  }}
}}
"""


def fixed_source(name: str, rate: ca.Function, directional: ca.Function, *, timed: bool) -> str:
    """The library of a fixed-step method, `name` in it, of the rates and their changes along (dt, dx, du)."""
    tableau = rodas3()
    parts = step_source.written(name, tableau, rate, directional, timed=timed, input_times=(0.0, 0.5, 1.0))
    step = _STEP.format(name=name, stages=len(tableau.d))
    return "\n".join([parts, motion_source._SOUND, step, motion_source._MOTION.format(name=name)])


def motions_of(plant: PlantLike, name: str) -> str:
    """The same of a plant."""
    directional, timed = plant_functions.directional_function(plant), plant_functions.changing_in_time(plant)
    return fixed_source(name, plant_functions.rate_function(plant), directional, timed=timed)
