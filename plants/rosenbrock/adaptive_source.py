"""C source of a whole motion of one state by a linearly implicit method's own steps, rows filled by dense output.

    long adaptive(last, most, ends, t, u, w, p, x, s, now, at)

t (nt,) [s]; u (nt, nu), a row held over each period; x (nt, nx), row 0 given; ends (nt - 1,) the row at whose time the
input of each period jumps next. From `now` and `at` it goes on until row `last` is there, or for `most` steps, and
leaves its place there: now = {time, step, step tried last, state (nx,) at that time}, at = {last row that is there,
whether its input has been taken before, steps tried}. After a jump comes a step within what follows, and steps end on
jumps; rows beyond `last`, before the next jump, may come with it.
s = {rtol, atol, largest factor of a step, smallest, safety, smallest step, most steps}.
Returns 0; 1 after too many steps, 2 with too small a step; 3 after `most` steps. Steps are chosen as the explicit
pair's are: plants/motions/adaptive_steps.py.
"""

from __future__ import annotations

import casadi as ca

from pliant.plants.motions import motion_source

from . import step_source
from .tableaux import RosenbrockTableau

_ADAPTIVE = """
static T in_tolerances(const T *error, const T *before, const T *after, const double *s) {{
  T sum = 0;
  for (int i = 0; i < NX; i++) {{
    const T size = FABS(before[i]) > FABS(after[i]) ? FABS(before[i]) : FABS(after[i]);
    const T share = error[i] / (s[1] + s[0] * size);
    sum += share * share;
  }}
  return SQRT(sum / NX);
}}
EXPORTED long adaptive(long last, long most, const long *ends, const double *t, const double *u, const double *w,
              const double *p, double *x, const double *s, double *now, long *at) {{
  T z[LD] ALIGNED, after[LD] ALIGNED, k[{stages}][LD] ALIGNED, J[NX][LD] ALIGNED, d[LD] ALIGNED;
  struct factors factors;
  T time = now[0], h = now[1], trial = now[2];
  long j = at[0], tried = at[2], status = 0;
  memset(z, 0, sizeof z);
  memcpy(z, now + 3, sizeof(T) * NX);
  for (int fresh = 0; j < last && !status;) {{
    const long jump = ends[j];
    const T end = t[jump];
    const double *const held = u + j * NU;
    if (!at[1] && h > end - time) h = end - time;
    at[1] = 1;
    if (most-- <= 0) {{ status = 3; break; }}
    const int jumps = time + h >= end * (1 - 1e-15) || end - time - h < 1e-3 * h;
    trial = jumps ? end - time : h;
    if (tried >= (long)s[6]) {{ tried++; status = 1; break; }}
    if (!fresh) slopes(time, z, held, w, p, 0, J), fresh = 1;
    stages_{name}(z, time, held, 0, w, p, trial, (const T (*)[LD])J, &factors, k, after);
    tried++;
    T error = in_tolerances(k[{stages} - 1], z, after, s);
    int sound = is_sound(error) && all_sound(after);
    const T reached = jumps ? end : time + trial;
    if (sound && error < 1 && t[j + 1] < reached) {{
      defect_{name}(z, time, held, w, p, trial, &factors, (const T (*)[LD])k, d);
      const T between = in_tolerances(d, z, after, s);
      if (!is_sound(between)) sound = 0;
      else if (between > error) error = between;
    }}
    T factor = sound && error > 0 ? s[4] * POW(error, {power}) : s[2];
    if (sound && error < 1) {{
      if (factor > s[2]) factor = s[2];
      for (; j < jump && t[j + 1] <= reached; j++) {{
        if (t[j + 1] == reached) memcpy(x + (j + 1) * NX, after, sizeof(T) * NX);
        else between_{name}(z, (const T (*)[LD])k, (t[j + 1] - time) / trial, x + (j + 1) * NX);
      }}
      time = reached, fresh = 0, at[1] = j < jump;
      memcpy(z, after, sizeof z);
      h = jumps && h > trial * factor ? h : trial * factor;
      continue;
    }}
    h = trial * (sound && factor > s[3] ? factor : s[3]);
    if (h < s[5] * (FABS(time) > 1 ? FABS(time) : 1)) status = 2;
  }}
  now[0] = time, now[1] = h, now[2] = trial;
  memcpy(now + 3, z, sizeof(T) * NX);
  at[0] = j, at[2] = tried;
  return status;
}}
"""


def adaptive_source(
    name: str, tableau: RosenbrockTableau, rate: ca.Function, directional: ca.Function, *, timed: bool
) -> str:
    """The library of a method of the rates (t, x, u, w, p) -> dx/dt and their changes along (dt, dx)."""
    power = f"(T){-1 / (tableau.order + 1)!r}"
    return "\n".join(
        [
            step_source.written(name, tableau, rate, directional, timed=timed),
            motion_source._SOUND,
            _ADAPTIVE.format(name=name, stages=len(tableau.d), power=power),
        ]
    )
