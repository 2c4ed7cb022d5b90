"""C source of one linearly implicit step of one state: the Jacobian, its factors, the stages and what lies between.

The Jacobian is exact: the change of the rates along W unit directions at once, one a lane, until all columns are there;
df/dt is one more where the rates depend on time. What solves is loops, not straight line, so that it is compiled in no
time at any size: rows of LD numbers, whole vectors, factored by rows with partial pivoting.

    slopes(t, x, u, w, p, change, J)                     J (NX, LD): df/dx, and df/dt in column NX, the inputs
                                                         changing by `change` (nu,) a second where that is not 0
    stages_M(x, t, u, ahead, w, p, h, J, F, k, after)    factors F of W, k (stages, LD), after (LD); u: the inputs
                                                         of stages, `ahead` numbers after one another
    between_M(x, k, c, at)                               the state at the fraction c of the step, at (NX)
    defect_M(x, t, u, w, p, h, F, k, d)                  how far dense output is off where it errs most: d (LD)
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from pliant.plants.native import kernel_templates
from pliant.plants.native.scalar_codegen import block_function, literal

from .tableaux import RosenbrockTableau

DOUBLE = np.dtype(float)

_ALONE = """
static void rhs(T t, const T *x, const T *u, const T *w, const T *p, T *restrict dx) {
  rate((in_t)&t, (in_t)x, (in_t)u, (in_t)w, (in_t)p, (T (*)[W])dx);
}
"""

_SLOPES = """
#define TIMED {timed}
#define LD ((NX + W) / W * W)
#define SPREAD(block, from, count) \\
  for (int k = 0; k < (count); k++) for (int l = 0; l < W; l++) block[k][l] = (from)[k]
static void slopes(T t, const T *x, const T *u, const T *w, const T *p, const T *change, T (*restrict J)[LD]) {{
  BLOCK(t_, 1); BLOCK(x_, NX); BLOCK(u_, NU); BLOCK(w_, NW); BLOCK(p_, NP); BLOCK(dt, 1); BLOCK(dx, NX); BLOCK(d, NX);
  BLOCK(du, NU);
  const int columns = NX + (TIMED || change);
  SPREAD(t_, &t, 1); SPREAD(x_, x, NX); SPREAD(u_, u, NU); SPREAD(w_, w, NW); SPREAD(p_, p, NP);
  memset(J, 0, sizeof(T) * NX * LD);
  for (int c = 0; c < columns; c += W) {{
    memset(dx, 0, sizeof dx);
    for (int l = 0; l < W; l++) {{
      dt[0][l] = c + l == NX;
      for (int k = 0; k < NU; k++) du[k][l] = change && c + l == NX ? change[k] : 0;
      if (c + l < NX) dx[c + l][l] = 1;
    }}
    directional((const T (*)[W])t_, (const T (*)[W])x_, (const T (*)[W])u_, (const T (*)[W])w_, (const T (*)[W])p_,
                (const T (*)[W])dt, (const T (*)[W])dx, (const T (*)[W])du, d);
    for (int k = 0; k < NX; k++) memcpy(J[k] + c, d[k], sizeof d[k]);
  }}
}}
ENTRY(directions) {{
  BLOCK(t, 1); BLOCK(x, NX); BLOCK(u, NU); BLOCK(w, NW); BLOCK(p, NP); BLOCK(dt, 1); BLOCK(dx, NX); BLOCK(d, NX);
  BLOCK(du, NU);
  EACH_BLOCK {{
    LOAD(t, 0, 1); LOAD(x, 1, NX); LOAD(u, 2, NU); LOAD(w, 3, NW); LOAD(p, 4, NP); LOAD(dt, 5, 1); LOAD(dx, 6, NX);
    LOAD(du, 7, NU);
    directional((const T (*)[W])t, (const T (*)[W])x, (const T (*)[W])u, (const T (*)[W])w, (const T (*)[W])p,
                (const T (*)[W])dt, (const T (*)[W])dx, (const T (*)[W])du, d);
    STORE(d, 0, NX);
  }}
}}
"""

# lower and upper are kept column by column, so that a solution is sums of columns; both are zero where they hold none.
_FACTORS = """
struct factors {
  T lower[NX][LD] ALIGNED, upper[NX][LD] ALIGNED, inverse[NX];
  int order[NX];
};
static void factored(T (*restrict a)[LD], struct factors *restrict f) {
  memset(f->lower, 0, sizeof f->lower); memset(f->upper, 0, sizeof f->upper);
  for (int i = 0; i < NX; i++) f->order[i] = i;
  for (int k = 0; k < NX; k++) {
    int best = k;
    for (int i = k + 1; i < NX; i++) if (FABS(a[i][k]) > FABS(a[best][k])) best = i;
    if (best != k) {
      const int other = f->order[k];
      f->order[k] = f->order[best], f->order[best] = other;
      for (int g = 0; g < LD / VL; g++) {
        const V row = ((V *)a[k])[g];
        ((V *)a[k])[g] = ((V *)a[best])[g], ((V *)a[best])[g] = row;
      }
      for (int j = 0; j < k; j++) {
        const T part = f->lower[j][k];
        f->lower[j][k] = f->lower[j][best], f->lower[j][best] = part;
      }
    }
    f->inverse[k] = 1 / a[k][k];
    for (int i = k + 1; i < NX; i++) {
      if (a[i][k] == 0) continue;
      const T part = a[i][k] * f->inverse[k];
      f->lower[k][i] = part;
      for (int g = (k + 1) / VL; g < LD / VL; g++) ((V *)a[i])[g] -= part * ((V *)a[k])[g];
    }
    for (int i = 0; i < k; i++) f->upper[k][i] = a[i][k];
  }
}
static void solved(const struct factors *restrict f, const T *restrict r, T *restrict y) {
  for (int i = 0; i < NX; i++) y[i] = r[f->order[i]];
  for (int i = NX; i < LD; i++) y[i] = 0;
  for (int k = 0; k < NX; k++) {
    const T part = y[k];
    for (int g = (k + 1) / VL; g < LD / VL; g++) ((V *)y)[g] -= part * ((const V *)f->lower[k])[g];
  }
  for (int k = NX - 1; k >= 0; k--) {
    const T part = y[k] *= f->inverse[k];
    for (int g = 0; g <= (k - 1) / VL; g++) ((V *)y)[g] -= part * ((const V *)f->upper[k])[g];
  }
}
"""

# What follows has one state, and takes its lanes as they come.
_COMPARED = """
ENTRY(compared_{name}) {{
  T t, x[LD] ALIGNED, u[NU + 1], w[NW + 1], p[NP + 1], J[NX][LD] ALIGNED, k[{stages}][LD] ALIGNED, after[LD] ALIGNED;
  T at[LD] ALIGNED, defect[LD] ALIGNED;
  struct factors factors;
  for (long b = first; b < last; b++) {{
    memset(J, 0, sizeof J); memset(x, 0, sizeof x);
    t = in[0][b];
    for (int i = 0; i < NX; i++) x[i] = in[1][i * ld + b];
    for (int i = 0; i < NU; i++) u[i] = in[2][i * ld + b];
    for (int i = 0; i < NW; i++) w[i] = in[3][i * ld + b];
    for (int i = 0; i < NP; i++) p[i] = in[4][i * ld + b];
    for (int i = 0; i < NX; i++) for (int j = 0; j <= NX; j++) J[i][j] = in[5][(i * (NX + 1) + j) * ld + b];
    stages_{name}(x, t, u, 0, w, p, (T)s[0], (const T (*)[LD])J, &factors, k, after);
    between_{name}(x, (const T (*)[LD])k, (T)s[1], at);
    defect_{name}(x, t, u, w, p, (T)s[0], &factors, (const T (*)[LD])k, defect);
    for (int i = 0; i < NX; i++) {{
      out[0][i * ld + b] = after[i], out[1][i * ld + b] = k[{stages} - 1][i];
      out[2][i * ld + b] = at[i], out[3][i * ld + b] = defect[i];
    }}
  }}
}}
"""


def _sum(coefficients: np.ndarray, over: str = "") -> str:
    """Of stages, those with a coefficient."""
    return " + ".join(f"{literal(float(a))}{over} * k[{j}][i]" for j, a in enumerate(coefficients) if a != 0)


def _stages(name: str, tableau: RosenbrockTableau, input_times: Sequence[float]) -> str:
    count, each = len(tableau.d), "  LANES for (int i = 0; i < LD; i++) "
    given = "const T *restrict x, T t, const T *u, const T *w, const T *p, T h"
    lines = [
        f"static void stages_{name}({given.replace('*u', '*u, long ahead')}, const T (*restrict J)[LD],",
        "  struct factors *restrict factors,",
        "  T (*restrict k)[LD], T *restrict after) {",
        "  T a[NX][LD] ALIGNED, y[LD] ALIGNED, f[LD] ALIGNED, r[LD] ALIGNED;",
        f"  const T shift = 1 / ({literal(tableau.gamma)} * h), each = 1 / h;",
        "  for (int i = 0; i < NX; i++) {",
        "    for (int g = 0; g < LD / VL; g++) ((V *)a[i])[g] = -((const V *)J[i])[g];",
        "    a[i][i] += shift;",
        "  }",
        "  factored(a, factors);",
        "  for (int i = NX; i < LD; i++) f[i] = 0;",
    ]
    for i in range(count):
        known = i > 0 and (tableau.A[i] == tableau.A[i - 1]).all() and tableau.alpha[i] == tableau.alpha[i - 1]
        ahead = _sum(tableau.A[i])
        if ahead and not known:
            lines.append(f"{each}y[i] = x[i] + {ahead};")
        if not known:
            alpha = float(tableau.alpha[i])
            u = f"u + {list(input_times).index(alpha)} * ahead" if alpha in input_times else "u"
            lines.append(f"  rhs(t + {literal(alpha)} * h, {'y' if ahead else 'x'}, {u}, w, p, f);")
        lines.append(f"{each}r[i] = f[i]" + "".join(f" + {s}" for s in [_sum(tableau.C[i], " * each")] if s) + ";")
        if tableau.d[i] != 0:
            part = f"h * {literal(float(tableau.d[i]))}"
            lines.append(f"  for (int i = 0; i < NX; i++) r[i] += {part} * J[i][NX];")
        lines.append(f"  solved(factors, r, k[{i}]);")
    lines += [f"{each}after[i] = y[i] + k[{count - 1}][i];", "}"]
    lines += [f"static void between_{name}(const T *restrict x, const T (*restrict k)[LD], T c, T *restrict at) {{"]
    inner = [f"c * ({_sum(tableau.m)}"]
    for j, row in enumerate(tableau.dense):
        inner.append(f"(1 - c) * {'c * ' * j}({_sum(row)})")
    lines += [f"  LANES for (int i = 0; i < NX; i++) at[i] = x[i] + {' + '.join(inner)});", "}"]
    lines += [
        f"static void defect_{name}({given}, const struct factors *restrict factors, const T (*restrict k)[LD],",
        "  T *restrict d) {",
        "  T y[LD] ALIGNED, f[LD] ALIGNED;",
        "  const T each = 1 / h;",
        f"  between_{name}(x, k, {literal(tableau.worst)}, y);",
        f"  rhs(t + {literal(tableau.worst)} * h, y, u, w, p, f);",
        f"  LANES for (int i = 0; i < NX; i++) f[i] -= each * ({_sum(tableau.slope_along(tableau.worst))});",
        "  solved(factors, f, d);",
        "}",
        "",
    ]
    return "\n".join(lines)


def written(
    name: str,
    tableau: RosenbrockTableau,
    rate: ca.Function,
    directional: ca.Function,
    *,
    timed: bool,
    input_times: Sequence[float] = (0.0,),
) -> str:
    """All of it, after kernel_templates.head of one lane; `timed`: the rates depend on time.

    input_times: fractions of a step at which inputs are given, for stages that stand there; others take the first.
    """
    sizes = {f"N{symbol}": rate.nnz_in(k) for k, symbol in enumerate("TXUWP")}
    return "\n".join(
        [
            kernel_templates.head(DOUBLE, 1),
            *[f"#define {symbol} {size}" for symbol, size in sizes.items() if symbol not in ("NT", "NX")],
            kernel_templates._rate(rate, DOUBLE, 1),
            _ALONE,
            kernel_templates.other_lanes(DOUBLE),
            block_function("directional", directional),
            _SLOPES.format(timed=int(timed)),
            _FACTORS,
            _stages(name, tableau, input_times),
            _COMPARED.format(name=name, stages=len(tableau.d)),
        ]
    )
