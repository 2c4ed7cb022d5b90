"""Timoshenko's beam at any slenderness: Ritz frequencies are never below the exact ones, and few shapes meet them.

    python tests/campaigns/slender.py --count 400

Each seed draws a beam (depth/length from 1e-7 to 0.3, E I/(kappa G A L^2) from 3e-15 to 0.03), a body at its tip, a
basis and a count of shapes; the arm's frequencies are held against the characteristic equation in forty digits.

below   the share of rounding that a frequency is below the exact one; over 1 is a fault. Rounding of omega_k^2 is
        8 m eps omega_k^2/omega_1^2 of itself: see `natural_squares`; m = n + 16, as many terms as the integrals have
linear  the same of the linear model's roots, whose rounding is that of the highest frequency, 64 m eps omega_n
met     the relative error of the first frequency with eight shapes or more, where the basis must meet it: 1e-6
"""

import dataclasses

import by_seed
import numpy as np
from timoshenko_exact import exact_square

from pliant.plants import SingleLinkArm
from pliant.plants.beams import STEEL, Beam, Payload

EPS = np.finfo(float).eps
MET = 1e-6


def run(seed: int) -> dict:
    rng = np.random.default_rng(seed)
    beam = Beam.rectangular(1.0, width=0.05, depth=10 ** rng.uniform(-7, -0.5), material=STEEL)
    mass, inertia, offset = rng.choice((0.0, 1.0), 3) * (10 ** rng.uniform(-2, 2), 10 ** rng.uniform(-3, 0.5), 0.3)
    load = Payload(mass=mass * beam.mass, inertia=inertia * beam.mass, offset=(offset * (mass > 0), 0.0, 0.0))
    n, basis = int(rng.integers(1, 21)), str(rng.choice(("polynomial", "polynomial", "payload", "clamped-free")))
    arm = SingleLinkArm(
        link=beam,
        hub_inertia=1.0,
        payload=load,
        theory="timoshenko",
        basis=basis,
        modes=n,
        kinematics="linear",
        drive="motion",
    )
    unit = np.sqrt(beam.EI / beam.mass)
    found = arm.natural_frequencies() / unit
    roots = np.sort(np.abs(arm.linearize(np.zeros(arm.nx)).eigenvalues.imag))[-2 * n :: 2] / unit
    near = dataclasses.replace(arm, basis="payload", modes=20).natural_frequencies() / unit
    section = (beam.I_z / beam.area, beam.EI / beam.shear_stiffness)
    exact = [exact_square(w * w, *section, *load.ratios(beam.mass, 1.0).values()) for w in near[: min(n, 3)]]
    m = n + 16
    below = [
        max(0.0, float(1 - found[k] ** 2 / W)) / (8 * m * EPS * found[k] ** 2 / found[0] ** 2)
        for k, W in enumerate(exact)
    ]
    linear = [
        max(0.0, float(1 - roots[k] / W**0.5)) / (64 * m * EPS * found[-1] / found[k]) for k, W in enumerate(exact)
    ]
    met = abs(float(found[0] ** 2 / exact[0] - 1)) / MET if n >= 8 and basis != "clamped-free" else 0.0
    shares = {"below": round(float(max(below)), 4), "linear": round(float(max(linear)), 4), "met": round(met, 4)}
    wrong = [name for name, share in shares.items() if not share <= 1] + ["lost"] * (len(found) != n)
    said = f"{basis} {n}, shear {section[1]:.1e}, tip {mass:.2g} {inertia:.2g} {offset:.2g}"
    return {"seed": seed, "said": said, "shares": shares, "wrong": wrong}


def summary(rows: list[dict]) -> str:
    told = [f"seed {r['seed']} ({r['said']}): {r['shares']}" for r in rows if r["wrong"]]
    worst = {name: max((r["shares"][name] for r in rows), default=0.0) for name in ("below", "linear", "met")}
    return "\n".join([*told, f"{len(rows)} beams, worst shares {worst}: {len(told)} faults"])


if __name__ == "__main__":
    by_seed.main(__doc__, 400, run, summary, lambda row: bool(row["wrong"]))
