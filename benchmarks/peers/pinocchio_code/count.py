"""Operations of Pinocchio's generated code: its articulated-body algorithm on the rigid arm of six-axis-pick, recorded
through its CasADi scalars, common subexpressions removed. Writes benchmarks/results/trees/pinocchio_code.json.

    python benchmarks/peers/pinocchio_code/count.py [--eigen /usr/include/eigen3]

Needs `pip install pin` (headers and URDF reader), CasADi and Eigen's headers; the compiler takes two minutes and 3 GB.
The wheel of Pinocchio has no CasADi module, so a program of fifty lines is built from its headers. Products with
an exact 0 or 1 are left out by CasADi; the right angles of the URDF, which a sine gives to 5e-12, are made exact first.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import tempfile
from collections import Counter
from pathlib import Path

import casadi as ca
import numpy as np
import pinocchio as pin

HERE = Path(__file__).resolve().parent
RESULT = HERE.parents[1] / "results/trees/pinocchio_code.json"
SILENT = {ca.OP_INPUT, ca.OP_OUTPUT, ca.OP_CONST}
KINDS = {ca.OP_ADD: "sums", ca.OP_SUB: "sums", ca.OP_NEG: "sums", ca.OP_MUL: "products", ca.OP_DIV: "quotients"}
FLAGS = ["-std=c++17", "-O0", "-w", "-DBOOST_MPL_LIMIT_LIST_SIZE=30", "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS"]


def written(model: pin.Model) -> str:
    """The tree as aba.cpp reads it: per joint its parent, kind, placement, mass, mass centre and inertia."""
    lines = [str(model.njoints - 1)]
    for j in range(1, model.njoints):
        place, body = model.jointPlacements[j], model.inertias[j]
        numbers = np.concatenate(
            [np.ravel(part) for part in (place.rotation, place.translation, body.mass, body.lever, body.inertia)]
        )
        exact = np.where(np.abs(numbers) < 1e-9, 0.0, numbers)
        lines.append(f"{model.parents[j]} {model.joints[j].shortname()} " + " ".join(repr(float(v)) for v in exact))
    return "\n".join(lines) + "\n"


def recorded(model: pin.Model, eigen: str) -> ca.Function:
    """CasADi's function of Pinocchio's algorithm, checked at one state against Pinocchio's numbers."""
    packages = Path(pin.__file__).resolve().parents[4]
    casadi = Path(ca.__file__).resolve().parent
    with tempfile.TemporaryDirectory() as folder:
        tree, program, saved = (Path(folder) / name for name in ("tree.txt", "aba", "aba.casadi"))
        tree.write_text(written(model), encoding="utf-8")
        includes = [f"-I{packages / 'include'}", f"-I{eigen}", f"-I{casadi / 'include'}"]
        libraries = [f"-L{casadi}", "-lcasadi", f"-L{packages / 'lib'}", "-lpinocchio_default"]
        paths = [f"-Wl,-rpath,{casadi}:{packages / 'lib'}"]
        subprocess.run(
            ["g++", *FLAGS, *includes, str(HERE / "aba.cpp"), "-o", str(program), *libraries, *paths], check=True
        )
        told = subprocess.run([program, tree, saved], check=True, capture_output=True, text=True).stdout
        function = ca.Function.load(str(saved))
    at = np.linspace(-0.7, 0.9, model.nv)
    np.testing.assert_allclose(np.ravel(function(at, at[::-1], 3 * at)), np.array(told.split(), float), rtol=1e-9)
    return function


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--eigen", default="/usr/include/eigen3", help="folder of Eigen's headers")
    model = pin.buildModelFromUrdf(str(HERE.parents[2] / "envs/machines/six_axis.urdf"))
    function = recorded(model, parser.parse_args().eigen)
    symbols = [ca.SX.sym(name, model.nv) for name in ("q", "v", "tau")]
    shared = ca.Function("shared", symbols, [ca.cse(function(*symbols))])
    each = [shared.instruction_id(k) for k in range(shared.n_instructions())]
    kinds = Counter(KINDS.get(kind, "functions") for kind in each if kind not in SILENT)
    told = {
        "machine": "envs/machines/six_axis.urdf, rigid",
        "pinocchio": pin.__version__,
        "casadi": ca.__version__,
        "operations": sum(kinds.values()),
        "kinds": dict(sorted(kinds.items())),
    }
    RESULT.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")
    print(json.dumps(told))


if __name__ == "__main__":
    main()
