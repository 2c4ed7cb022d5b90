"""C source of fixed linearly implicit steps over blocks of lanes: the Jacobian once a step, its factors as loops.

Every lane has its own pivots: rows are compared and exchanged lane by lane, so that a lane's result depends on nothing
but itself. The Jacobian is straight line, or, where that would be too long to compile, one direction after another.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from pliant.plants.core.plant_protocol import PlantLike
from pliant.plants.native import kernel_templates
from pliant.plants.native.scalar_codegen import block_function, literal

from . import plant_functions
from .tableaux import RosenbrockTableau, rodas3

# rows are exchanged only where a lane asks for it; what is nothing in all lanes is not eliminated
_FACTORS = """
#define EACH_VECTOR for (int h = 0; h < PER; h++)
typedef T row_t[NX][W];
struct factors { T a[NX][NX][W] ALIGNED, inverse[NX][W] ALIGNED; int order[NX][W], moved; };
static void exchanged(struct factors *restrict f, int k, int i, const int *restrict best) {
  for (int j = 0; j < NX; j++) LANES for (int l = 0; l < W; l++) {
    const T upper = f->a[k][j][l], lower = f->a[i][j][l];
    f->a[k][j][l] = best[l] == i ? lower : upper;
    f->a[i][j][l] = best[l] == i ? upper : lower;
  }
  for (int l = 0; l < W; l++) if (best[l] == i) {
    const int other = f->order[k][l];
    f->order[k][l] = f->order[i][l], f->order[i][l] = other;
  }
}
static void factored(struct factors *restrict f) {
  f->moved = 0;
  for (int k = 0; k < NX; k++) for (int l = 0; l < W; l++) f->order[k][l] = k;
  for (int k = 0; k < NX; k++) {
    T most[W] ALIGNED; int best[W] ALIGNED, any = 0;
    LANES for (int l = 0; l < W; l++) { most[l] = FABS(f->a[k][k][l]); best[l] = k; }
    for (int i = k + 1; i < NX; i++) LANES for (int l = 0; l < W; l++) {
      const T size = FABS(f->a[i][k][l]);
      best[l] = size > most[l] ? i : best[l];
      most[l] = size > most[l] ? size : most[l];
    }
    for (int l = 0; l < W; l++) any |= best[l] != k;
    for (int i = k + 1; any && i < NX; i++) {
      int here = 0;
      for (int l = 0; l < W; l++) here |= best[l] == i;
      if (here) exchanged(f, k, i, best), f->moved = 1;
    }
    EACH_VECTOR ((V *)f->inverse[k])[h] = ALL((T)1) / ((V *)f->a[k][k])[h];
    for (int i = k + 1; i < NX; i++) {
      T size = 0;
      LANES for (int l = 0; l < W; l++) size += FABS(f->a[i][k][l]);
      if (size == 0) continue;
      EACH_VECTOR {
        const V part = ((V *)f->a[i][k])[h] *= ((V *)f->inverse[k])[h];
        for (int j = k + 1; j < NX; j++) ((V *)f->a[i][j])[h] -= part * ((V *)f->a[k][j])[h];
      }
    }
  }
}
static void solved(const struct factors *restrict f, const T (*restrict r)[W], T (*restrict y)[W]) {
  if (f->moved) for (int i = 0; i < NX; i++) for (int l = 0; l < W; l++) y[i][l] = r[f->order[i][l]][l];
  else memcpy(y, r, sizeof(T) * NX * W);
  for (int i = 0; i < NX; i++) EACH_VECTOR {
    V sum = ((V *)y[i])[h];
    for (int j = 0; j < i; j++) sum -= ((const V *)f->a[i][j])[h] * ((V *)y[j])[h];
    ((V *)y[i])[h] = sum;
  }
  for (int i = NX - 1; i >= 0; i--) EACH_VECTOR {
    V sum = ((V *)y[i])[h];
    for (int j = i + 1; j < NX; j++) sum -= ((const V *)f->a[i][j])[h] * ((V *)y[j])[h];
    ((V *)y[i])[h] = sum * ((const V *)f->inverse[i])[h];
  }
}
"""

_WHOLE = """
static const int at_row[] = {{{rows}}}, at_column[] = {{{columns}}};
static void slopes(in_t t, in_t x, in_t u, in_t w, in_t p, T (*restrict a)[NX][W], T (*restrict drift)[W]) {{
  BLOCK(values, {count});
  whole(t, x, u, w, p, values, drift);
  for (int k = 0; k < {count}; k++) memcpy(a[at_row[k]][at_column[k]], values[k], sizeof values[k]);
}}
"""

_BY_COLUMNS = """
static void slopes(in_t t, in_t x, in_t u, in_t w, in_t p, T (*restrict a)[NX][W], T (*restrict drift)[W]) {
  BLOCK(dt, 1); BLOCK(dx, NX); BLOCK(du, NU); BLOCK(d, NX);
  memset(dt, 0, sizeof dt); memset(dx, 0, sizeof dx); memset(du, 0, sizeof du);
  for (int c = 0; c < NX; c++) {
    for (int l = 0; l < W; l++) dx[c][l] = 1;
    directional(t, x, u, w, p, (in_t)dt, (in_t)dx, (in_t)du, d);
    for (int i = 0; i < NX; i++) memcpy(a[i][c], d[i], sizeof d[i]);
    memset(dx[c], 0, sizeof dx[c]);
  }
  if (TIMED) {
    for (int l = 0; l < W; l++) dt[0][l] = 1;
    directional(t, x, u, w, p, (in_t)dt, (in_t)dx, (in_t)du, drift);
  }
}
"""

_RUN = """
RUN {{
  BLOCK(t, 1); BLOCK(x, NX); BLOCK(u, {nu}); BLOCK(w, {nw}); BLOCK(p, {np}); BLOCK(after, NX);
  EACH_BLOCK {{
    LOAD(t, 0, 1); LOAD(x, 1, NX); LOAD(u, 2, {nu}); LOAD(w, 3, {nw}); LOAD(p, 4, {np});
    for (long i = 0; i < n; i++) {{
      step(x, t, (in_t)u, (in_t)w, (in_t)p, (T)s[0], after);
      memcpy(x, after, sizeof x);
      LANES for (int l = 0; l < W; l++) t[0][l] += (T)s[0];
    }}
    STORE(x, 0, NX);
  }}
}}
"""


def _sum(coefficients: np.ndarray, over: str = "") -> str:
    return " + ".join(f"{literal(float(a))}{over} * k[{j}][i][l]" for j, a in enumerate(coefficients) if a != 0)


def _step(tableau: RosenbrockTableau) -> str:
    count, each = len(tableau.d), "  for (int i = 0; i < NX; i++) LANES for (int l = 0; l < W; l++) "
    lines = [
        "static void step(T (*restrict x)[W], T (*restrict t)[W], in_t u, in_t w, in_t p, T h,",
        "                 T (*restrict after)[W]) {",
        f"  BLOCK(y, NX); BLOCK(f, NX); BLOCK(r, NX); BLOCK(now, 1); BLOCK(drift, NX); T k[{count}][NX][W] ALIGNED;",
        "  struct factors factors;",
        f"  const T shift = 1 / ({literal(tableau.gamma)} * h), each = 1 / h;",
        "  memset(factors.a, 0, sizeof factors.a);",
        "  slopes((in_t)t, (in_t)x, u, w, p, factors.a, drift);",
        "  for (int i = 0; i < NX; i++) for (int j = 0; j < NX; j++)",
        "    LANES for (int l = 0; l < W; l++) factors.a[i][j][l] = (i == j ? shift : 0) - factors.a[i][j][l];",
        "  factored(&factors);",
    ]
    for i in range(count):
        known = i > 0 and (tableau.A[i] == tableau.A[i - 1]).all() and tableau.alpha[i] == tableau.alpha[i - 1]
        ahead = _sum(tableau.A[i])
        if ahead and not known:
            lines.append(f"{each}y[i][l] = x[i][l] + {ahead};")
        if not known:
            alpha = literal(float(tableau.alpha[i]))
            lines.append(f"  LANES for (int l = 0; l < W; l++) now[0][l] = t[0][l] + {alpha} * h;")
            lines.append(f"  rate((in_t)now, (in_t){'y' if ahead else 'x'}, u, w, p, f);")
        lines.append(
            f"{each}r[i][l] = f[i][l]" + "".join(f" + {s}" for s in [_sum(tableau.C[i], " * each")] if s) + ";"
        )
        if tableau.d[i] != 0:
            lines.append(f"  if (TIMED){each[1:]}r[i][l] += h * {literal(float(tableau.d[i]))} * drift[i][l];")
        lines.append(f"  solved(&factors, (const T (*)[W])r, k[{i}]);")
    lines += [f"{each}after[i][l] = y[i][l] + k[{count - 1}][i][l];", "}", ""]
    return "\n".join(lines)


def steps_source(
    tableau: RosenbrockTableau, rate: ca.Function, slopes: ca.Function, dtype: np.dtype, *, timed: bool
) -> str:
    """n steps of s[0] seconds, the input held: (t, x, u, w, p) -> x.

    slopes: (t, x, u, w, p) -> df/dx, sparse, and df/dt; or with (dt, dx, du) besides, the rates' change along them.
    """
    nu, nw, n_p = (rate.nnz_in(k) for k in (2, 3, 4))
    parts = [
        kernel_templates.head(dtype),
        kernel_templates._rate(rate, dtype),
        f"#define TIMED {int(timed)}\n#define NU {nu}",
        _FACTORS,
    ]
    if slopes.n_in() == rate.n_in():
        rows, columns = slopes.sparsity_out(0).get_triplet()
        places = {"rows": ", ".join(map(str, rows)), "columns": ", ".join(map(str, columns)), "count": len(rows)}
        parts += [block_function("whole", slopes), _WHOLE.format(**places)]
    else:
        parts += [block_function("directional", slopes), _BY_COLUMNS]
    return "\n".join([*parts, _step(tableau), _RUN.format(nu=nu, nw=nw, np=n_p)])


def steps_of(plant: PlantLike, dtype: np.dtype) -> str:
    """The same of a plant, by RODAS3."""
    slopes, timed = plant_functions.lane_slopes(plant), plant_functions.changing_in_time(plant)
    return steps_source(rodas3(), plant_functions.rate_function(plant), slopes, dtype, timed=timed)
