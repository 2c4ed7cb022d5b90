"""What mechanics asks of any plant, on random ones: all fields crossed with all others (tests/cases/random_plants.py).

    python tests/campaigns/physics.py --count 1400 --jobs 2      # about nine checks a plant

definite    the mass matrix is symmetric and positive definite
energy      kinetic energy is v' M v/2
power       the rate of the energy along the motion is what is put in less what is lost, which is never negative
idle        a free spacecraft without inputs is given nothing
jacobians   of dynamics and outputs, by states, inputs and disturbances, in random directions
scale       a plant in other units of length, mass and time moves the same
mirror      a planar plant mirrored in x moves in mirror image
reversal    accelerations without damping are those of the reversed motion
momentum    of a free spacecraft changes by the forces and torques on it
rates       outputs that are rates are the rates of the outputs
vary        with a parameter as an input a plant moves as rebuilt with that number
rotation    all that is given in the world's axes turned with the plant leaves the accelerations as they are
bases       the lowest frequency of a link is the same in every basis, and in the beam of large deflections
"""

from collections import Counter

import by_seed
import mechanics as m
import numpy as np
from random_plants import draw

CHECKS = (
    m.definite,
    m.energy,
    m.power,
    m.idle,
    m.jacobians,
    m.scale,
    m.mirror,
    m.reversal,
    m.momentum,
    m.rates,
    m.vary,
    m.rotation,
    m.bases,
)


def run(seed: int) -> dict:
    """The checks of one plant: the largest share of what rounding and truncation allow, by check; over 1 is a fault."""
    drawn = draw(seed)
    rng = np.random.default_rng([seed, 1])
    c = m.Case(drawn, rng)
    shares = {check.__name__: check(c, rng) for check in CHECKS}
    shares = {name: round(share, 4) for name, share in shares.items() if share is not None}
    wrong = [name for name, share in shares.items() if not share <= 1]
    return {"seed": seed, "family": drawn.family, "shares": shares, "wrong": wrong, "said": " ".join(drawn.changed)}


def summary(rows: list[dict]) -> str:
    told = [
        f"seed {r['seed']} ({r['family']}; {r['said']}): {[(n, r['shares'][n]) for n in r['wrong']]}"
        for r in rows
        if r["wrong"]
    ]
    tried = Counter((r["family"], name) for r in rows for name in r["shares"])
    table = [f"{family:6} {name:10} {count:6}" for (family, name), count in sorted(tried.items())]
    return "\n".join(
        [*told, *table, f"{sum(tried.values())} checks of {len(rows)} plants: {len(told)} plants violate one"]
    )


if __name__ == "__main__":
    by_seed.main(__doc__, 1400, run, summary, lambda row: bool(row["wrong"]))
