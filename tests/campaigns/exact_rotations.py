"""Arms of exact rotations against what else is exact, on random links, payloads, weights and motions of the hub.

    python tests/campaigns/exact_rotations.py --count 400 --jobs 2

beam      the tip of a driven arm moves as that of LargeDeflectionBeam with the same rotations and 24 quadrature points:
          within 1e-6 of the length while no section turns by more than 0.3 rad, within 1e-4 up to 1.5 rad
elastica  under a dead force across, of F L^2/(E I) up to 10, the tip rests where elliptic integrals have it: within
          5e-6 of the length, by six polynomials
definite  the mass matrix of such an arm, of any shapes, bent at random by up to ten radians, is positive definite
"""

import dataclasses

import by_seed
import numpy as np
from euler_elastica import elastica
from scipy.optimize import root

from pliant.plants import Beam, LargeDeflectionBeam, Payload, SingleLinkArm
from pliant.plants.beams import STEEL

SMALL, LARGE = 0.3, 1.5  # [rad]


def drawn(seed: int) -> tuple[SingleLinkArm, np.random.Generator]:
    """A link on a prescribed hub, of two to four polynomials."""
    rng = np.random.default_rng(seed)
    link = Beam.circular(float(rng.uniform(0.5, 5.0)), float(rng.uniform(0.003, 0.02)), STEEL)
    mass = link.mass * float(rng.choice([0.0, 0.3, 1.0]))
    offset = (float(rng.uniform(0, 0.05)) * link.length, float(rng.uniform(-0.05, 0.05)) * link.length, 0.0)
    load = Payload(mass=mass, inertia=mass * (0.05 * link.length) ** 2, offset=offset if mass else (0.0, 0.0, 0.0))
    modes = int(rng.integers(2, 5))
    arm = SingleLinkArm(link=link, payload=load, kinematics="strain", basis="polynomial", modes=modes, drive="motion")
    return arm, rng


def beside_the_beam(arm: SingleLinkArm, rng: np.random.Generator) -> float:
    """Largest distance of the tips over what is allowed, for a smooth turn over two first periods."""
    own = float(arm.natural_frequencies()[0])
    t = np.linspace(0.0, 4 * np.pi / own, 81)
    bend = float(rng.uniform(0.02, 0.5))  # of the tip over the length, about
    hard = bend * own**2 / 1.5 * np.sin(own * t * float(rng.uniform(0.2, 0.7)))[:, None]
    options = {"gravity": (0.0, 0.0, 0.0), "basis": arm.basis, "modes": arm.modes, "points": 24}
    beam = LargeDeflectionBeam(beam=arm.link, payload=arm.payload, root="driven", **options)
    moved = [p.simulate(np.zeros(p.nx), hard, t, rtol=1e-9, atol=1e-11) for p in (arm, beam)]
    slope = arm.elastic.basis.phi(np.linspace(0, 1, 21), 1) / arm.link.length
    turned = np.abs(moved[0].x[:, 1 : 1 + arm.modes] @ slope.T).max()
    if turned > LARGE:
        return 0.0
    apart = max(float(np.abs(moved[0][k] - moved[1][k]).max()) for k in ("tip_x", "tip_y", "tip_deflection"))
    return apart / arm.link.length / (1e-6 if turned <= SMALL else 1e-4)


def beside_the_elastica(arm: SingleLinkArm, rng: np.random.Generator) -> float:
    load, L = float(rng.uniform(0.1, 10.0)), arm.link.length
    arm = dataclasses.replace(arm, modes=6, payload=Payload())
    n, x = arm.nx // 2, np.zeros(arm.nx)

    def lacking(q: np.ndarray, force: float) -> np.ndarray:
        at = np.concatenate([[0.0], q, np.zeros(n)])
        w = np.array([0.0, force])
        return (arm.mass_matrix(at) @ arm.dynamics(at, w=w)[n:])[1:] * L**2 / arm.link.EI

    for part in np.linspace(0.1, 1.0, 10):
        x[1:n] = root(lacking, x[1:n], args=(part * load * arm.link.EI / L**2,), tol=1e-12).x
    tip = arm.measure(x)[[k for k, s in enumerate(arm.outputs) if s.name in ("tip_x", "tip_y")]]
    return float(np.abs(tip / L - elastica(load)[:2]).max()) / 5e-6


def lost(arm: SingleLinkArm, rng: np.random.Generator) -> float:
    """How many of ten bent states have no positive definite mass matrix."""
    arm = dataclasses.replace(arm, basis=str(rng.choice(["polynomial", "payload", "clamped-free"])))
    size = 10.0 * arm.link.length / np.abs(arm.elastic.basis.phi(np.linspace(0, 1, 101), 1)).max(axis=0)
    x = rng.uniform(-1, 1, (10, arm.nx))
    x[:, 1 : 1 + arm.modes] *= size
    return 2.0 * float(sum(np.linalg.eigvalsh(M)[0] <= 0 for M in arm.mass_matrix(x)))


def run(seed: int) -> dict:
    arm, rng = drawn(seed)
    shares = {
        "beam": round(beside_the_beam(arm, rng), 4),
        "elastica": round(beside_the_elastica(arm, rng), 4),
        "definite": lost(arm, rng),
    }
    wrong = [name for name, share in shares.items() if not share <= 1]
    said = f"{arm.modes} polynomials, payload {arm.payload.mass / arm.link.mass:.1f}"
    return {"seed": seed, "said": said, "shares": shares, "wrong": wrong}


def summary(rows: list[dict]) -> str:
    told = [f"seed {r['seed']} ({r['said']}): {r['shares']}" for r in rows if r["wrong"]]
    worst = {name: max((r["shares"][name] for r in rows), default=0.0) for name in ("beam", "elastica", "definite")}
    return "\n".join([*told, f"{len(rows)} arms, worst shares {worst}: {len(told)} faults"])


if __name__ == "__main__":
    by_seed.main(__doc__, 400, run, summary, lambda row: bool(row["wrong"]))
