"""Loads at the tip: their names, and the work they do."""

import casadi as ca
import numpy as np
import pytest
from strained_cases import STRAINED, replaced, unit_states

from pliant.plants.beam_strains.tip_loads import TipLoads


def test_names_in_the_order_asked_for():
    plane, space = (TipLoads(("follower", "moment", "force"), planar) for planar in (True, False))
    assert [s.name for s in plane.signals] == [
        "follower_force_x", "follower_force_y", "tip_moment", "tip_force_x", "tip_force_y",
    ]  # fmt: skip
    assert [s.name for s in space.signals][3:6] == ["tip_moment_x", "tip_moment_y", "tip_moment_z"]
    assert {s.unit for s in plane.signals} == {"N", "N m"}


@pytest.mark.parametrize("plant", [STRAINED["free"], replaced("space", root="hinged")], ids=["plane", "space"])
def test_power_of_each_load_is_force_by_velocity_and_moment_by_spin(plant):
    """Of the tip and its axes, moved by differences."""
    rng = np.random.default_rng(1)
    x = unit_states(plant, rng)
    n, d = plant.nx // 2, 2 if plant.planar else 3
    frames = plant.strained_beam.frames
    q = ca.SX.sym("q", n)
    tip = ca.Function("tip", [q], [frames.tip_frame(q)])
    h = 1e-6

    def at(s):
        moved = np.concatenate([x[:n] + s * h * x[n:], x[n:]])
        return plant.positions(moved, [1.0])[0], np.asarray(tip(moved[:n]))

    (r0, R0), (r1, R1), R = at(-1), at(1), np.asarray(tip(x[:n]))
    velocity, S = (r1 - r0) / (2 * h), (R1 - R0) / (2 * h) @ R.T
    spin = np.array([S[1, 0]]) if d == 2 else np.array([S[2, 1], S[0, 2], S[1, 0]])
    for part, power in (("tip_force", velocity), ("tip_moment", spin), ("follower_force", R.T @ velocity)):
        load = {s.name: rng.uniform(-1, 1) if s.name.startswith(part) else 0.0 for s in plant.loads.signals}
        values = np.array(list(load.values()))
        expected = values[[s.name.startswith(part) for s in plant.loads.signals]] @ power
        assert plant.power(x, values)[0] == pytest.approx(expected, abs=2e-7)


def test_the_pull_of_moments_is_none():
    loads = TipLoads(("force", "moment", "follower"), True)
    assert float(loads.pull(ca.DM([3.0, 4.0, 9.0, 0.0, 2.0]))) == pytest.approx(7.0)
