"""C source of the batch kernels: a function over lanes, fixed steps, a whole control step of an environment.

All kernels share one signature, `run(first, last, ld, in, out, s, n)`: lanes first..last-1 in blocks of W, arrays of
structure-of-arrays layout with leading dimension ld (element k of lane b at in[a][k * ld + b]), scalars s, count n.
Kernels that step a rate have a second one, `rates`, that gives it on its own: a step hides what it adds to the state.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from pliant.plants.core.runge_kutta_tableaux import Tableau
from pliant.plants.toolchain import straight_line

from . import compiler
from .scalar_codegen import block_function
from .slp_codegen import lane_function

LANES = {np.dtype(np.float64): 8, np.dtype(np.float32): 16}  # one 512-bit vector, two of 256 bit, four of 128

_HEAD = """#include <math.h>
#include <string.h>
#include <stdint.h>
typedef {real} T;
typedef {word} BITS;
#define EXPONENT {exponent}
#define W {lanes}
#define VL {vector}
#define PER (W / VL)
typedef T V {vectors};
#define ALL(value) ((V){{0}} + (value))
#define LANES _Pragma("omp simd")
#define ALIGNED __attribute__((aligned(64)))
#define KEEP(array) __asm__("" : "+m"(array))
#define SIN sin{f}
#define COS cos{f}
#define SQRT sqrt{f}
#define EXP exp{f}
#define TANH tanh{f}
#define FABS fabs{f}
#define POW pow{f}
typedef const T (*restrict in_t)[W];
#define ENTRY(name) \\
  EXPORTED void name(long first, long last, long ld, const T *const *in, T *const *out, const double *s, long n)
#define RUN ENTRY(run)
#define EACH_BLOCK for (long b = first; b < last; b += W)
#define LOAD(block, a, count) for (int k = 0; k < (count); k++) memcpy(block[k], in[a] + k * ld + b, sizeof block[k])
#define STORE(block, a, count) for (int k = 0; k < (count); k++) memcpy(out[a] + k * ld + b, block[k], sizeof block[k])
#define BLOCK(name, count) T name[(count) > 0 ? (count) : 1][W] ALIGNED
"""


def _vector(dtype: np.dtype, lanes: int) -> tuple[int, str]:
    """Lanes of a vector of the machine, at most `lanes`, and what makes its type of a number's."""
    vector = min(lanes, max(1, compiler.toolchain().width // (8 * dtype.itemsize)))
    return vector, f"__attribute__((vector_size({vector * dtype.itemsize}), may_alias))" if vector > 1 else ""


def other_lanes(dtype: np.dtype, lanes: int | None = None) -> str:
    """What follows is for as many lanes, after a `head` for another number of them."""
    width = LANES[dtype] if lanes is None else lanes
    vector, aligned = _vector(dtype, width)
    return f"""typedef T OTHER {aligned};
#define V OTHER
#undef W
#define W {width}
#undef VL
#define VL {vector}
"""


def head(dtype: np.dtype, lanes: int | None = None) -> str:
    """What every kernel starts with; `lanes` = 1 is for one state at a time."""
    single, width = dtype == np.float32, LANES[dtype] if lanes is None else lanes
    vector, aligned = _vector(dtype, width)
    return straight_line.HEAD + _HEAD.format(
        real="float" if single else "double",
        word="uint32_t" if single else "uint64_t",
        exponent="0x7f800000u" if single else "0x7ff0000000000000ull",
        lanes=width,
        vector=vector,
        vectors=aligned,
        f="f" if single else "",
    )


def _sizes(function: ca.Function) -> tuple[list[int], list[int]]:
    return (
        [function.nnz_in(k) for k in range(function.n_in())],
        [function.nnz_out(k) for k in range(function.n_out())],
    )


def _function(name: str, function: ca.Function, dtype: np.dtype, lanes: int | None) -> str:
    """The function over W lanes; over vectors within itself where there is one lane."""
    if lanes != 1:
        return block_function(name, function)
    width = LANES[dtype]
    return lane_function(name, function, width, max(1, 8 * dtype.itemsize * width // compiler.toolchain().width))


def _call(name: str, inputs: Sequence[str], outputs: Sequence[str]) -> str:
    return f"{name}({', '.join([f'(in_t){i}' for i in inputs] + list(outputs))});"


def map_source(function: ca.Function, dtype: np.dtype, lanes: int | None = None) -> str:
    """The function once a lane: its inputs and outputs in order."""
    inputs, outputs = _sizes(function)
    body = [f"  BLOCK(i{k}, {c});" for k, c in enumerate(inputs)]
    body += [f"  BLOCK(o{k}, {c});" for k, c in enumerate(outputs)]
    body += ["  EACH_BLOCK {"]
    body += [f"    LOAD(i{k}, {k}, {c});" for k, c in enumerate(inputs)]
    names = [f"i{k}" for k in range(len(inputs))], [f"o{k}" for k in range(len(outputs))]
    body += ["    " + _call("function", *names)]
    body += [f"    STORE(o{k}, {k}, {c});" for k, c in enumerate(outputs)]
    return "\n".join(
        [head(dtype, lanes), _function("function", function, dtype, lanes), "RUN {", *body, "  }", "}", ""]
    )


def iteration_source(change: ca.Function, dtype: np.dtype) -> str:
    """z <- z + change(z, ...) n times: (z, ...) -> (z, last change)."""
    inputs, (nz,) = _sizes(change)
    names = [f"i{k}" for k in range(len(inputs))]
    body = [f"  BLOCK({name}, {c});" for name, c in zip(names, inputs)]
    body += [f"  BLOCK(d, {nz});", "  EACH_BLOCK {"]
    body += [f"    LOAD({name}, {k}, {c});" for k, (name, c) in enumerate(zip(names, inputs))]
    body += [
        "    for (long i = 0; i < n; i++) {",
        "      " + _call("change", names, ["d"]),
        f"      for (int k = 0; k < {nz}; k++) LANES for (int l = 0; l < W; l++) i0[k][l] += d[k][l];",
        "    }",
        f"    STORE(i0, 0, {nz}); STORE(d, 1, {nz});",
    ]
    return "\n".join([head(dtype), block_function("change", change), "RUN {", *body, "  }", "}", ""])


# y = x + h k, and y += h k, of the rows of a block of lanes.
AHEAD = """
static inline void ahead(int count, T (*restrict y)[W], in_t x, T h, in_t k) {
  for (int i = 0; i < count; i++) LANES for (int l = 0; l < W; l++) y[i][l] = x[i][l] + h * k[i][l];
}
static inline void add(int count, T (*restrict y)[W], T h, in_t k) {
  for (int i = 0; i < count; i++) LANES for (int l = 0; l < W; l++) y[i][l] += h * k[i][l];
}
"""
_RK4 = (
    AHEAD
    + """\
static void rk4(T (*restrict x)[W], T (*restrict t)[W], in_t u, in_t w, in_t p, T h, long n) {
  BLOCK(y, NX); BLOCK(sum, NX); BLOCK(k, NX); BLOCK(half, 1); BLOCK(end, 1);
  for (long step = 0; step < n; step++) {
    LANES for (int l = 0; l < W; l++) { half[0][l] = t[0][l] + h / 2; end[0][l] = t[0][l] + h; }
    rate((in_t)t, (in_t)x, u, w, p, k);
    ahead(NX, sum, (in_t)x, h / 6, (in_t)k); ahead(NX, y, (in_t)x, h / 2, (in_t)k);
    rate((in_t)half, (in_t)y, u, w, p, k);
    add(NX, sum, h / 3, (in_t)k); ahead(NX, y, (in_t)x, h / 2, (in_t)k);
    rate((in_t)half, (in_t)y, u, w, p, k);
    add(NX, sum, h / 3, (in_t)k); ahead(NX, y, (in_t)x, h, (in_t)k);
    rate((in_t)end, (in_t)y, u, w, p, k);
    ahead(NX, x, (in_t)sum, h / 6, (in_t)k);
    LANES for (int l = 0; l < W; l++) t[0][l] = end[0][l];
  }
}
"""
)


def _rate(function: ca.Function, dtype: np.dtype, lanes: int | None = None) -> str:
    """The rate function (t, x, u, w, p) -> dx/dt, alone as `rates`."""
    _, nx, nu, nw, np_ = _sizes(function)[0]
    alone = f"""
ENTRY(rates) {{
  BLOCK(t, 1); BLOCK(x, {nx}); BLOCK(u, {nu}); BLOCK(w, {nw}); BLOCK(p, {np_}); BLOCK(dx, {nx});
  EACH_BLOCK {{
    LOAD(t, 0, 1); LOAD(x, 1, {nx}); LOAD(u, 2, {nu}); LOAD(w, 3, {nw}); LOAD(p, 4, {np_});
    rate((in_t)t, (in_t)x, (in_t)u, (in_t)w, (in_t)p, dx);
    STORE(dx, 0, {nx});
  }}
}}
"""
    return f"#define NX {nx}\n" + _function("rate", function, dtype, lanes) + alone


def rk4_source(rate: ca.Function, dtype: np.dtype, lanes: int | None = None) -> str:
    """n RK4 steps of s[0] seconds with the input held: (t, x, u, w, p) -> x."""
    return head(dtype, lanes) + _rate(rate, dtype, lanes) + _RK4 + _steps(rate, "rk4")


def explicit_source(rate: ca.Function, tableau: Tableau, dtype: np.dtype, lanes: int | None = None) -> str:
    """The same by any explicit Runge-Kutta method."""
    marching = [
        "static void march(T (*restrict x)[W], T (*restrict t)[W], in_t u, in_t w, in_t p, T h, long n) {",
        f"  BLOCK(y, NX); BLOCK(now, 1); T k[{len(tableau.b)}][NX * W] ALIGNED;",
        "  T *const start = x[0], *const at = y[0];",
        "  for (long step = 0; step < n; step++) {",
        "    rate((in_t)t, (in_t)x, u, w, p, (T (*)[W])k[0]);",
    ]
    for i in range(1, len(tableau.b) + 1):
        last = i == len(tableau.b)
        ahead = " + ".join(f"(T){a!r} * k[{j}][i]" for j, a in tableau.stage(i).items())
        marching.append(
            f"    LANES for (int i = 0; i < NX * W; i++) {'start' if last else 'at'}[i] = start[i] + h * ({ahead});"
        )
        if not last:
            marching.append(
                f"    LANES for (int l = 0; l < W; l++) now[0][l] = t[0][l] + (T){float(tableau.c[i])!r} * h;"
            )
            marching.append(f"    rate((in_t)now, (in_t)y, u, w, p, (T (*)[W])k[{i}]);")
    marching += ["    LANES for (int l = 0; l < W; l++) t[0][l] += h;", "  }", "}", ""]
    return "\n".join([head(dtype, lanes) + _rate(rate, dtype, lanes), *marching]) + _steps(rate, "march")


def _steps(rate: ca.Function, by: str) -> str:
    """A run of n steps of s[0] seconds."""
    _, nx, nu, nw, np_ = _sizes(rate)[0]
    return f"""
RUN {{
  BLOCK(t, 1); BLOCK(x, {nx}); BLOCK(u, {nu}); BLOCK(w, {nw}); BLOCK(p, {np_});
  EACH_BLOCK {{
    LOAD(t, 0, 1); LOAD(x, 1, {nx}); LOAD(u, 2, {nu}); LOAD(w, 3, {nw}); LOAD(p, 4, {np_});
    {by}(x, t, (in_t)u, (in_t)w, (in_t)p, (T)s[0], n);
    STORE(x, 0, {nx});
  }}
}}
"""


def steps_source(step: ca.Function, dtype: np.dtype) -> str:
    """n steps of s[0] seconds of any one-step map (t, x, us, w, p, h) -> x, the input held: (t, x, u, w, p) -> x."""
    _, nx, nus, nw, np_, _ = _sizes(step)[0]
    body = f"""
RUN {{
  BLOCK(t, 1); BLOCK(x, {nx}); BLOCK(y, {nx}); BLOCK(us, {nus}); BLOCK(w, {nw}); BLOCK(p, {np_}); BLOCK(h, 1);
  EACH_BLOCK {{
    LOAD(t, 0, 1); LOAD(x, 1, {nx}); LOAD(w, 3, {nw}); LOAD(p, 4, {np_});
    for (int c = 0; c < 3; c++)
      for (int k = 0; k < {nus // 3}; k++) memcpy(us[c * {nus // 3} + k], in[2] + k * ld + b, sizeof us[0]);
    for (int l = 0; l < W; l++) h[0][l] = (T)s[0];
    for (long i = 0; i < n; i++) {{
      step((in_t)t, (in_t)x, (in_t)us, (in_t)w, (in_t)p, (in_t)h, y);
      memcpy(x, y, sizeof x);
      for (int l = 0; l < W; l++) t[0][l] += h[0][l];
    }}
    STORE(x, 0, {nx});
  }}
}}
"""
    return head(dtype) + block_function("step", step) + body


def control_step_source(
    rate: ca.Function,
    drive: ca.Function,
    score: ca.Function,
    sense: ca.Function,
    dtype: np.dtype,
    largest: float,
) -> str:
    """A control period of an environment: (t, x, action, ref, w, p) -> (x, obs, cost, margin, sound).

    drive (action) -> u; score (x, u, ref, w, p) -> cost at the start of the period; n RK4 steps of s[0] seconds;
    sense (x, u, ref, w, p) -> (obs, margin) at its end. sound is 1 where every state and observation is a number below
    `largest`; that it is a number is read from its bits, since this code is compiled for finite numbers only.
    """
    _, nx, nu, nw, np_ = _sizes(rate)[0]
    na, nr, no = drive.nnz_in(0), score.nnz_in(2), sense.nnz_out(0)
    functions = [block_function(n, f) for n, f in (("drive", drive), ("score", score), ("sense", sense))]
    body = f"""
static int is_sound(T value) {{
  BITS bits;
  memcpy(&bits, &value, sizeof bits);
  return (bits & EXPONENT) != EXPONENT && FABS(value) < (T){largest!r};
}}
RUN {{
  BLOCK(t, 1); BLOCK(x, {nx}); BLOCK(a, {na}); BLOCK(ref, {nr}); BLOCK(w, {nw}); BLOCK(p, {np_});
  BLOCK(u, {nu}); BLOCK(obs, {no}); BLOCK(cost, 1); BLOCK(margin, 1); BLOCK(sound, 1);
  EACH_BLOCK {{
    LOAD(t, 0, 1); LOAD(x, 1, {nx}); LOAD(a, 2, {na}); LOAD(ref, 3, {nr}); LOAD(w, 4, {nw}); LOAD(p, 5, {np_});
    drive((in_t)a, u);
    score((in_t)x, (in_t)u, (in_t)ref, (in_t)w, (in_t)p, cost);
    rk4(x, t, (in_t)u, (in_t)w, (in_t)p, (T)s[0], n);
    sense((in_t)x, (in_t)u, (in_t)ref, (in_t)w, (in_t)p, obs, margin);
    for (int l = 0; l < W; l++) {{
      int whole = is_sound(cost[0][l]) && is_sound(margin[0][l]);
      for (int k = 0; k < {nx}; k++) whole &= is_sound(x[k][l]);
      for (int k = 0; k < {no}; k++) whole &= is_sound(obs[k][l]);
      sound[0][l] = (T)whole;
    }}
    STORE(x, 0, {nx}); STORE(obs, 1, {no}); STORE(cost, 2, 1); STORE(margin, 3, 1); STORE(sound, 4, 1);
  }}
}}
"""
    return head(dtype) + _rate(rate, dtype) + _RK4 + "\n".join(functions) + body
