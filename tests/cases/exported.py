"""C files that Pliant wrote, compiled with every warning an error; closed loops of them beside the same in Python."""

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import pytest

from pliant.controllers.export import export_c

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O1")
SANITIZERS = ("-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
COMPILERS = tuple(name for name in ("gcc", "clang") if shutil.which(name))
ALLOCATES = ("malloc", "calloc", "realloc", "free(", "alloca")

needs_compiler = pytest.mark.skipif(not COMPILERS, reason="no C compiler")


def compiled(sources: list[Path], program: Path, *flags: str, compiler: str = "") -> Path:
    """A program of these sources."""
    made = [compiler or COMPILERS[0], *STRICT, *flags, *map(str, sources), "-o", str(program), "-lm"]
    done = subprocess.run(made, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return program


def strict_everywhere(source: Path) -> None:
    """Compiles without a warning, and names no allocation."""
    for compiler in COMPILERS:
        flags = [compiler, *STRICT, "-c", str(source), "-o", str(source.with_suffix(f".{compiler}.o"))]
        done = subprocess.run(flags, capture_output=True, text=True, timeout=120)
        assert done.returncode == 0, done.stderr
    assert not any(word in source.read_text() for word in ALLOCATES)


def sanitizers_work(folder: Path) -> bool:
    """Whether a program with them can be built and run here."""
    source = folder / "empty.c"
    source.write_text("int main(void) { return 0; }\n")
    made = [COMPILERS[0], *SANITIZERS, str(source), "-o", str(folder / "empty")]
    return (
        not subprocess.run(made, capture_output=True).returncode and not subprocess.run([folder / "empty"]).returncode
    )


_PLANTS: dict = {}


def plant_objects(plant, h: float, precision: str, folder: Path) -> list[Path]:
    """The plant's step of h as plant.h in `folder` and an object file, compiled once a session."""
    key = plant, h, precision
    if key not in _PLANTS:
        made = Path(tempfile.mkdtemp())
        source, _ = export_c(plant, made / "plant.c", dt=h, precision=precision)
        subprocess.run([COMPILERS[0], *STRICT, "-c", str(source), "-o", str(made / "plant.o")], check=True, timeout=120)
        _PLANTS[key] = made
    shutil.copy(_PLANTS[key] / "plant.h", folder / "plant.h")
    return [_PLANTS[key] / "plant.o"]


def same_loop(folder: Path, scene, law, within: dict[str, float], count: int = 40, substeps: int = 10) -> None:
    """The loop of a law and the scene's plant from its start in C, to `within` of each signal's largest in Python."""
    plant, start, h = scene.plant, scene.initial[0], scene.dt / substeps
    wanted = loop_in_python(plant, law, start, scene.dt, count, substeps)
    for precision, bound in within.items():
        sources = [export_c(law, folder / "law.c", precision=precision)[0], *plant_objects(plant, h, precision, folder)]
        main = loop_in_c(folder, plant, law, start, scene.dt, count, substeps)
        found = run(compiled([main, *sources], folder / "loop"))
        off = (np.abs(found - wanted) / np.abs(wanted).max(axis=0)).max()
        assert off < bound, f"{precision}: {off:.2g}"


def run(program: Path) -> np.ndarray:
    """Rows of numbers that it prints. Nothing that a sanitizer says."""
    done = subprocess.run([program], capture_output=True, text=True, timeout=120, env=dict(os.environ))
    assert done.returncode == 0 and not done.stderr, done.stderr
    return np.array([[float(v) for v in line.split()] for line in done.stdout.splitlines()])


def loop_in_c(folder: Path, plant, law, x0, dt: float, count: int, substeps: int) -> Path:
    """main.c: `law.c` and `plant.c`, of dt / substeps, in closed loop from x0; each row is u, then x a period later."""
    known = [*(s.name for s in plant.states), *(s.name for s in plant.outputs)]
    at = ", ".join(str(known.index(name)) for name in law.reads)
    nx, nu, ny, n = plant.nx, plant.nu, plant.ny, len(law.reads)
    w = f", w[{plant.nw}] = {{0}}" if plant.nw else ""
    more = ", w" if plant.nw else ""
    start = ", ".join(f"{v!r}" for v in map(float, x0))
    (folder / "main.c").write_text(
        f"""#include <stdio.h>
#include "law.h"
#include "plant.h"
int main(void)
{{
    static law_state s;
    static const double start[{nx}] = {{{start}}};
    static const int at[{n}] = {{{at}}};
    plant_real x[{nx}], z[{ny}], v[{nu}]{w};
    law_real y[{n}], u[{nu}];
    int i, j, k;
    for (i = 0; i < {nx}; i++) x[i] = (plant_real)start[i];
    for (i = 0; i < {nu}; i++) v[i] = 0;
    law_reset(&s);
    for (k = 0; k < {count}; k++) {{
        double t = k * {dt!r};
        plant_outputs(t, x, v{more}, z);
        for (i = 0; i < {n}; i++) y[i] = (law_real)(at[i] < {nx} ? x[at[i]] : z[at[i] - {nx}]);
        law_act(&s, t, y, u);
        for (i = 0; i < {nu}; i++) v[i] = (plant_real)u[i];
        for (j = 0; j < {substeps}; j++) plant_step(t, x, v{more});
        for (i = 0; i < {nu}; i++) printf("%.17g ", (double)u[i]);
        for (i = 0; i < {nx}; i++) printf("%.17g ", (double)x[i]);
        printf("\\n");
    }}
    return 0;
}}
"""
    )
    return folder / "main.c"


def loop_in_python(plant, law, x0, dt: float, count: int, substeps: int) -> np.ndarray:
    """The same rows, by `act` and four calls of `dynamics` a step."""
    known = [*(s.name for s in plant.states), *(s.name for s in plant.outputs)]
    at = [known.index(name) for name in law.reads]
    x, u, rows = np.array(x0, dtype=float), np.zeros(plant.nu), []
    law.reset()
    for k in range(count):
        y = np.concatenate([x, plant.measure(x, u)])[at]
        u = law.act(k * dt, y)
        h = dt / substeps
        for _ in range(substeps):
            k1 = plant.dynamics(x, u)
            k2 = plant.dynamics(x + h / 2 * k1, u)
            k3 = plant.dynamics(x + h / 2 * k2, u)
            k4 = plant.dynamics(x + h * k3, u)
            x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        rows.append(np.concatenate([u, x]))
    return np.array(rows)


def answers_in_c(folder: Path, law, readings: np.ndarray) -> Path:
    """main.c: what `law.c` answers to each reading, each after a reset; the last number of a row counts failures."""
    n, rows = len(law.reads), ",\n        ".join(", ".join(f"{float(v)!r}" for v in y) for y in readings)
    predicts = hasattr(law, "horizon")
    nu, failures = (len(law.limits.low), "s.failures") if predicts else (len(law.inputs), "0L")
    (folder / "main.c").write_text(
        f"""#include <stdio.h>
#include "law.h"
int main(void)
{{
    static law_state s;
    static const law_real y[{readings.size}] = {{
        {rows}
    }};
    law_real u[{nu}];
    int i, k;
    for (k = 0; k < {len(readings)}; k++) {{
        law_reset(&s);
        law_act(&s, 0, y + k * {n}, u);
        for (i = 0; i < {nu}; i++) printf("%.17g ", (double)u[i]);
        printf("%ld\\n", {failures});
    }}
    return 0;
}}
"""
    )
    return folder / "main.c"


def answers_over_time(folder: Path, law, times: np.ndarray, readings: np.ndarray, nu: int) -> Path:
    """main.c: what `law.c` answers to one reading after the other, after one reset."""
    n, rows = len(law.reads), ",\n        ".join(", ".join(f"{float(v)!r}" for v in y) for y in readings)
    at = ", ".join(f"{float(t)!r}" for t in times)
    (folder / "main.c").write_text(
        f"""#include <stdio.h>
#include "law.h"
int main(void)
{{
    static law_state s;
    static const double at[{len(times)}] = {{{at}}};
    static const law_real y[{readings.size}] = {{
        {rows}
    }};
    law_real u[{nu}];
    int i, k;
    law_reset(&s);
    for (k = 0; k < {len(times)}; k++) {{
        law_act(&s, at[k], y + k * {n}, u);
        for (i = 0; i < {nu}; i++) printf("%.17g ", (double)u[i]);
        printf("\\n");
    }}
    return 0;
}}
"""
    )
    return folder / "main.c"
