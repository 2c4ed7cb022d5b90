"""What the ranges of kinematics claim, on random machines at rest under a load: inside, the error against a finer
kinematics stays under the share that is claimed; far outside, the range is said to be left.

slope     a stiffened arm against a beam of large deflection, under tip force and weight: deflection within 5 % (by
          1/(1 - c) more where c of the stiffness is lost to compression)
axial     a linear arm against a stiffened one, under tip force and spin: deflection within 5 %, tip within 1 % of the
          length
chain     one to three sub-beams against a rotation field, under a tip force: tip within 5 % of how far it has moved

Statics by SciPy's `root` on the plants' own accelerations. A seed that finds a wrong claim is printed; the script then
exits with status 1.
"""

from collections import Counter

import by_seed
import numpy as np
from scipy.optimize import root

from pliant.plants import Beam, LargeDeflectionBeam, Payload, SingleLinkArm, Trajectory

KINDS = ("slope", "axial", "chain")
FAR = 1.2  # times its limit, past which a range must be said to be left


def run(seed: int) -> dict:
    """One claim tried: whether the range was kept, the error as a share of what is claimed, and what is wrong."""
    kind = KINDS[seed % len(KINDS)]
    left, share, reached = {"slope": slope, "axial": axial, "chain": chain}[kind](np.random.default_rng(seed))
    wrong = ""
    if not np.isfinite(share):
        return {"seed": seed, "kind": kind, "found": "not solved", "share": 0.0, "wrong": ""}
    if not left and share > 1:
        wrong = f"within the range the error is {share:.3g} times what is claimed"
    if reached > FAR and not left:
        wrong = f"at {reached:.3g} times the limit nothing is said"
    return {"seed": seed, "kind": kind, "found": "left" if left else "kept", "share": share, "wrong": wrong}


def beam(rng) -> Beam:
    """A slender one: 0.3 to 10 m, a hundredth to a thousandth as thick, of any stiffness and weight."""
    length = 10.0 ** rng.uniform(-0.5, 1.0)
    thick = length * 10.0 ** rng.uniform(-3, -2)
    E = 10.0 ** rng.uniform(9, 11.5)
    return Beam(
        length=length,
        area=4 * thick**2,
        I_y=thick**4,
        I_z=thick**4 / 3,
        J=thick**4,
        density=10.0 ** rng.uniform(3, 4),
        E=E,
        G=E / 2.6,
    )


def rest(plant, x0, bent, rows, u, w):
    """The state with the coordinates at `bent` so that the accelerations at `rows` vanish, else None."""

    def residual(q):
        x = x0.copy()
        x[bent] = q
        return plant.dynamics(x, u, w=w)[rows] / scale

    scale = 1.0
    scale = np.abs(residual(np.zeros(bent.stop - bent.start) + 1e-9)).max() or 1.0
    found = root(residual, np.zeros(bent.stop - bent.start), tol=1e-10)
    x = x0.copy()
    x[bent] = found.x
    return x if np.abs(found.fun).max() < 1e-6 else None


def looked_at(plant, x, u, w):
    """(whether a range is left, the outputs) at a state."""
    motion = Trajectory.from_arrays(
        [0.0, 1.0], np.array([x, x]), np.array([u, u]), plant=plant, w=np.array([w, w]) if len(w) else None
    )
    return bool(plant.left_ranges(motion)), {s.name: v for s, v in zip(plant.outputs, motion.y[0], strict=True)}


def arm_at(arm, angle, spin, w):
    n = 1 + arm.mode_count
    x = np.zeros(arm.nx)
    x[0], x[n] = angle, spin
    x = rest(arm, x, slice(1, n), slice(n + 1, 2 * n), np.zeros(1), w)
    return None if x is None else (x, *looked_at(arm, x, np.zeros(1), w))


def loads(link: Beam, across: float, along: float):
    """Tip force across the link that alone bends it by `across` L, and along it as a share of what buckles it."""
    stiff = link.EI / link.length**2
    return 3 * stiff * across, 2.467 * stiff * along  # pi^2/4, Euler


def slope(rng):
    link, angle = beam(rng), rng.uniform(-np.pi, np.pi)
    across, along = 10.0 ** rng.uniform(-2, -0.35), rng.uniform(-0.4, 0.4)
    share, c, s = rng.uniform(), np.cos(angle), np.sin(angle)
    F, N = loads(link, share * across, along)
    weight = 8 * link.EI / link.length**3 * (1 - share) * across / link.mass  # bends by (1 - share) across L
    w = np.array([N * c - F * s, N * s + F * c])
    load = Payload(mass=link.mass * rng.uniform(0, 1))
    arm = SingleLinkArm(
        link=link, drive="motion", basis="polynomial", modes=6, payload=load, gravity=weight * link.length
    )
    large = LargeDeflectionBeam(
        beam=link, root="driven", basis="polynomial", modes=6, payload=load, gravity=(0.0, -arm.gravity, 0.0)
    )
    found = arm_at(arm, angle, 0.0, w)
    x = np.zeros(large.nx)
    x[0], n = angle, large.nx // 2
    x = rest(large, x, slice(1, n), slice(n + 1, 2 * n), np.zeros(1), w)
    if found is None or x is None:
        return True, np.nan, 0.0
    _, left, got = found
    true = looked_at(large, x, np.zeros(1), w)[1]
    buckling = -(along + (load.mass + 0.31 * link.mass) * -arm.gravity * s * link.length**2 / (2.467 * link.EI))
    if buckling > 0.5:
        return True, np.nan, 0.0
    error = abs(got["tip_deflection"] - true["tip_deflection"]) / abs(true["tip_deflection"])
    reached = abs(true["tip_angle"] - angle) / 0.3
    return left, error * (1 - max(buckling, 0.0)) / 0.05, reached


def axial(rng):
    link, angle = beam(rng), rng.uniform(-np.pi, np.pi)
    across, along = 10.0 ** rng.uniform(-3, -1), rng.uniform(-0.15, 0.15)
    F, N = loads(link, across, along)
    c, s = np.cos(angle), np.sin(angle)
    w = np.array([N * c - F * s, N * s + F * c])
    first = 3.516 * np.sqrt(link.EI / (link.linear_density * link.length**4))
    spin = first * rng.uniform(0, 0.3) * rng.integers(2)
    options = {"link": link, "drive": "motion", "modes": 4, "basis": "clamped-free", "hub_radius": 0.3 * link.length}
    linear, stiff = (SingleLinkArm(kinematics=k, **options) for k in ("linear", "stiffened"))
    found = [arm_at(arm, angle, spin, w) for arm in (linear, stiff)]
    if any(f is None for f in found):
        return True, np.nan, 0.0
    (_, left, got), (y, _, true) = found
    error = abs(got["tip_deflection"] - true["tip_deflection"]) / abs(true["tip_deflection"]) / 0.05
    short = float(stiff.elastic.shortening(y[1:5])) / link.length / 0.01
    return left, max(error, short), max(short, abs(along) / 0.05 if spin == 0 else 0.0)


def chain(rng):
    link, segments = beam(rng), int(rng.integers(1, 4))
    F = loads(link, 10.0 ** rng.uniform(-1.5, 0.3), 0.0)[0]
    options = {"beam": link, "gravity": (0.0, 0.0, 0.0)}
    frame = ("mean-axis", "chord", "tangent")[rng.integers(3)]
    coarse = LargeDeflectionBeam(kinematics="substructured", segments=segments, modes=4, frame=frame, **options)
    fine = LargeDeflectionBeam(basis="polynomial", modes=9, **options)
    tips, left = [], []
    for plant in (coarse, fine):
        n = plant.nx // 2
        x = rest(plant, np.zeros(plant.nx), slice(0, n), slice(n, 2 * n), np.array([0.0, F]), np.zeros(0))
        if x is None:
            return True, np.nan, 0.0
        out, y = looked_at(plant, x, np.array([0.0, F]), np.zeros(0))
        tips.append(np.array([y["tip_u"], y["tip_v"]]))
        left.append(out)
    return left[0], np.linalg.norm(tips[0] - tips[1]) / np.linalg.norm(tips[1]) / 0.05, 0.0


def summary(rows: list[dict]) -> str:
    kinds = Counter((r["kind"], r["found"]) for r in rows)
    worst = {k: max((r["share"] for r in rows if r["kind"] == k and r["found"] == "kept"), default=0.0) for k in KINDS}
    said = "\n".join(f"seed {r['seed']} {r['kind']}: {r['wrong']}" for r in rows if r["wrong"])
    table = ", ".join(f"{k} {f} {n}" for (k, f), n in sorted(kinds.items()))
    most = ", ".join(f"{k} {v:.2f}" for k, v in worst.items())
    return f"{said}\n{len(rows)} tried: {table}; largest error within, of what is claimed: {most}".strip()


if __name__ == "__main__":
    by_seed.main(__doc__, 300, run, summary, lambda row: bool(row["wrong"]))
