"""C source of whole motions of one state: every step of every period in one call, rows written at the asked times.

A library of the explicit methods holds the plant's rates once and marches them by rk4, by rk8 and by the adaptive pair
of order 8(5,3), whose stages are rk8's; a library of the linearly implicit method holds its step map. The signature is

    long motion_M(last, most, t, counts, u, ahead, w, p, x, at)

M the method. t (nt,) [s]; counts (nt - 1,) steps in each period; x (nt, nx), row 0 given. From at = {k, i}, step i of
period k, it goes on to the start of period `last`, or for `most` steps, and leaves its place there; where step i
has no finite result it stops before it. Within a period the state stands in the row at its end. u is (nt, nu), a row
held over each period; or, ahead > 0, for the steps from i on of this period, its values wherever in a step the method
takes them, `ahead` numbers a step. Returns 0, or 1 where a step has no finite result.

    long adaptive(last, most, restart, t, u, w, p, x, s, now, at)

does the same by the pair's own steps, which end on every one of the times: adaptive_steps.py says how they are chosen.
With `restart` each period begins with a step within it. Of s and now see below. Returns 0; 1 after too many steps, 2
with too small a step, the state of both in row k + 1; 3 after `most` steps.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import casadi as ca
import numpy as np

from pliant.plants.core.runge_kutta_tableaux import TABLEAUS, Tableau, dop853_errors
from pliant.plants.native import kernel_templates
from pliant.plants.native.scalar_codegen import literal

DOUBLE = np.dtype(float)
EXPLICIT, IMPLICIT = ("rk4", "rk8"), ("rosenbrock",)
PAIR = "rk8"  # whose stages the adaptive method takes

# That a number is finite is read from its bits: the code is compiled for finite numbers only.
_SOUND = """
static inline int is_sound(T value) {
  BITS bits;
  memcpy(&bits, &value, sizeof bits);
  return (bits & EXPONENT) != EXPONENT;
}
static inline int all_sound(const T *x) {
  int sound = 1;
  for (int i = 0; i < NX; i++) sound &= is_sound(x[i]);
  return sound;
}
"""

_MOTION = """
EXPORTED long motion_{name}(long last, long most, const double *t, const long *counts, const double *u, long ahead,
                   const double *w, const double *p, double *x, long *at) {{
  T z[NX] ALIGNED, after[NX] ALIGNED;
  long k = at[0], i = at[1], first = i, failed = 0;
  memcpy(z, x + (i ? k + 1 : k) * NX, sizeof z);
  while (k < last && most > 0 && !failed) {{
    const T h = (t[k + 1] - t[k]) / counts[k];
    for (; i < counts[k] && most > 0; i++, most--) {{
      step_{name}(z, t[k] + i * h, ahead ? u + (i - first) * ahead : u + k * NU, ahead ? NU : 0, w, p, h, after);
      if (!all_sound(after)) {{ failed = 1; break; }}
      memcpy(z, after, sizeof z);
    }}
    if (i < counts[k] && !i) break;
    memcpy(x + (k + 1) * NX, z, sizeof z);
    if (i == counts[k]) {{ i = 0; k++; }}
  }}
  at[0] = k, at[1] = i;
  return failed;
}}
"""

# As the batch kernels step, for the comparison with the virtual machine.
_COMPARED = """
ENTRY(steps_{name}) {{
  BLOCK(w, NW); BLOCK(p, NP); BLOCK(u, NU); T z[NX] ALIGNED, after[NX] ALIGNED;
  EACH_BLOCK {{
    LOAD(u, 2, NU); LOAD(w, 3, NW); LOAD(p, 4, NP);
    for (int k = 0; k < NX; k++) z[k] = in[1][k * ld + b];
    for (long i = 0; i < n; i++) {{
      step_{name}(z, in[0][b] + i * (T)s[0], u[0], 0, w[0], p[0], (T)s[0], after);
      memcpy(z, after, sizeof z);
    }}
    for (int k = 0; k < NX; k++) out[0][k * ld + b] = z[k];
  }}
}}
"""

# Of NX states in rows of x: from z and time an attempt over `trial` makes `after`, its `error`, and whether both are
# `sound`.
_LOOP = """
  /* s: rtol, atol, largest factor of a step, smallest, safety, smallest step, most steps
     now: time, step, step tried last; at: period, whether it has begun, steps tried */
  T time = now[0], h = now[1], trial = now[2];
  long j = at[0], tried = at[2], status = 0;
  memcpy(z, x + (at[1] ? j + 1 : j) * NX, NX * sizeof *z);
  if (!at[1]) time = t[j];
  while (j < last && !status) {{
    const T end = t[j + 1];
    if (!at[1] && restart && h > end - time) h = end - time;
    at[1] = 1;
    while (time < end) {{
      if (most-- <= 0) {{ status = 3; break; }}
      const int ends = time + h >= end * (1 - 1e-15) || end - time - h < 1e-3 * h;
      trial = ends ? end - time : h;
      if (tried >= (long)s[6]) {{ tried++; status = 1; break; }}
{attempt}
      tried++;
      T factor = sound && error > 0 ? s[4] * POW(error, (T)-0.125) : s[2];
      if (sound && error < 1) {{
        if (factor > s[2]) factor = s[2];
        time = ends ? end : time + trial;
        memcpy(z, after, NX * sizeof *z);
        h = ends && h > trial * factor ? h : trial * factor;
        continue;
      }}
      h = trial * (sound && factor > s[3] ? factor : s[3]);
      if (h < s[5] * (FABS(time) > 1 ? FABS(time) : 1)) {{ status = 2; break; }}
    }}
    memcpy(x + (j + 1) * NX, z, NX * sizeof *z);
    if (!status) {{ j++; at[1] = 0; }}
  }}
  now[0] = time, now[1] = h, now[2] = trial;
  at[0] = j, at[2] = tried;
  return status;
}}
"""


def adaptive_loop(attempt: str) -> str:
    """The body of `adaptive` from its declarations on, as adaptive_steps.py says: `attempt` is the C of one step."""
    return _LOOP.format(attempt=attempt)


_ADAPTIVE = """
static T error_of(const T *z, const T *after, T (*restrict k)[NX], T h, T rtol, T atol) {{
  T s5 = 0, s3 = 0;
  for (int i = 0; i < NX; i++) {{
    const T most = FABS(z[i]) > FABS(after[i]) ? FABS(z[i]) : FABS(after[i]);
    const T scale = atol + rtol * most, e5 = ({e5}) / scale, e3 = ({e3}) / scale;
    s5 += e5 * e5; s3 += e3 * e3;
  }}
  const T bottom = s5 + (T)0.01 * s3;
  return bottom != 0 ? h * s5 / SQRT(bottom * NX) : 0;
}}
EXPORTED long adaptive(long last, long most, long restart, const double *t, const double *u, const double *w,
              const double *p, double *x, const double *s, double *now, long *at) {{
  T z[NX] ALIGNED, after[NX] ALIGNED, k[{stages}][NX] ALIGNED;{loop}"""
_ATTEMPT = """\
      stages_{pair}(z, time, u + j * NU, 0, w, p, trial, k, after);
      const T error = error_of(z, after, k, trial, s[0], s[1]);
      const int sound = is_sound(error) && all_sound(after);"""


def _sum(coefficients: Sequence[tuple[int, float]]) -> str:
    return " + ".join(f"{literal(a)} * k[{j}][i]" for j, a in coefficients)


def _explicit_step(name: str, tableau: Tableau, input_times: Sequence[float]) -> str:
    """`stages_`: all slopes k and the state after the step; `step_`: the state alone."""
    count, times = len(tableau.b), list(input_times)
    given = "const T *x, T t, const T *u, long ahead, const T *w, const T *p, T h"
    lines = [
        f"static void stages_{name}({given}, T (*restrict k)[NX], T *restrict after) {{",
        "  T y[NX] ALIGNED, now;",
        "  rate((in_t)&t, (in_t)x, (in_t)u, (in_t)w, (in_t)p, (T (*)[W])k[0]);",
    ]
    for i in range(1, count + 1):
        ahead = _sum(list(tableau.stage(i).items()))
        to = "after" if i == count else "y"
        lines.append(f"  LANES for (int i = 0; i < NX; i++) {to}[i] = x[i] + h * ({ahead});")
        if i < count:
            place = i if len(times) == count else times.index(float(tableau.c[i]))
            lines.append(f"  now = t + {literal(float(tableau.c[i]))} * h;")
            lines.append(
                f"  rate((in_t)&now, (in_t)y, (in_t)(u + {place} * ahead), (in_t)w, (in_t)p, (T (*)[W])k[{i}]);"
            )
    lines += [
        "}",
        f"static void step_{name}({given}, T *restrict after) {{",
        f"  T k[{count}][NX] ALIGNED;",
        f"  stages_{name}(x, t, u, ahead, w, p, h, k, after);",
        "}",
        "",
    ]
    return "\n".join(lines)


def _defined(function: ca.Function) -> str:
    sizes = {f"N{name}": function.nnz_in(k) for k, name in enumerate("TXUWP")}
    return "".join(f"#define {name} {size}\n" for name, size in sizes.items() if name not in ("NT", "NX"))


def explicit_source(rate: ca.Function, input_times: Mapping[str, Sequence[float]]) -> str:
    """All explicit methods of the rates (t, x, u, w, p) -> dx/dt; input_times: fractions of a step, by method."""
    parts = [kernel_templates.head(DOUBLE, 1), _defined(rate), kernel_templates._rate(rate, DOUBLE, 1), _SOUND]
    for name in EXPLICIT:
        parts.append(_explicit_step(name, TABLEAUS[name](), input_times[name]))
        parts += [_COMPARED.format(name=name), _MOTION.format(name=name)]
    count = len(TABLEAUS[PAIR]().b)
    e5, e3 = (_sum([(j, float(a)) for j, a in enumerate(E) if a != 0]) for E in dop853_errors())
    loop = adaptive_loop(_ATTEMPT.format(pair=PAIR))
    return "\n".join([*parts, _ADAPTIVE.format(e5=e5, e3=e3, stages=count, loop=loop)])


def implicit_source(step: ca.Function) -> str:
    """A step map (t, x, us (nu, 3), w, p, h) -> x that is linearly implicit."""
    (name,) = IMPLICIT
    nx, nu = step.nnz_in(1), step.nnz_in(2) // 3
    map_step = f"""
#define NX {nx}
#define NU {nu}
#define NW {step.nnz_in(3)}
#define NP {step.nnz_in(4)}
{_SOUND}
static void step_{name}(const T *x, T t, const T *u, long ahead, const T *w, const T *p, T h, T *restrict after) {{
  T us[3 * NU + 1];
  for (int c = 0; c < 3; c++) for (int k = 0; k < NU; k++) us[c * NU + k] = u[c * ahead + k];
  whole_step((in_t)&t, (in_t)x, (in_t)us, (in_t)w, (in_t)p, (in_t)&h, (T (*)[W])after);
}}
"""
    function = kernel_templates._function("whole_step", step, DOUBLE, 1)
    entries = [_COMPARED.format(name=name), _MOTION.format(name=name)]
    return "\n".join([kernel_templates.head(DOUBLE, 1), function, map_step, *entries])
