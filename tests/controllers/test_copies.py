"""copy, deepcopy and pickle of every controller go on exactly as the original would, and apart from it."""

import copy
import dataclasses
import pickle

import numpy as np
import pytest

from pliant.controllers import LQG, LQR, MPC, NMPC, PD, TVLQR, ComputedTorque, Predictive
from pliant.envs import scenes

SLEW = scenes.get("single-link-slew")
WIDE = dataclasses.replace(SLEW, limits=(1e6,))  # an input at its limit is the same whatever a copy remembers
LAWS = {
    "LQR": lambda: LQR.for_scene(WIDE),
    "LQG": lambda: LQG.for_scene(WIDE),
    "PD": lambda: PD.for_scene(WIDE),
    "computed torque": lambda: ComputedTorque.for_scene(WIDE),
    "TVLQR": lambda: TVLQR.for_scene(WIDE),
    "predictive": lambda: Predictive.for_scene(WIDE, delay=2),
    "MPC": lambda: MPC.for_scene(SLEW),
    "MPC that remembers": lambda: MPC.for_scene(SLEW, rates=[40.0]),
    "MPC that estimates": lambda: MPC.for_scene(SLEW, track=("hub_angle",)),
    "NMPC": lambda: NMPC.for_scene(SLEW, horizon=6),
}
COPIES = {"copy": copy.copy, "deepcopy": copy.deepcopy, "pickle": lambda law: pickle.loads(pickle.dumps(law))}


@pytest.mark.parametrize("name", LAWS)
def test_copies_go_on_as_the_original_would(name):
    law = LAWS[name]()
    x, u = SLEW.target
    signals = SLEW.plant.states + SLEW.plant.outputs
    known = dict(zip((s.name for s in signals), np.append(x, SLEW.plant.measure(x, u))))
    rng = np.random.default_rng(0)
    y = np.array([known[r] for r in law.reads]) + 1e-4 * rng.standard_normal((12, len(law.reads)))
    for k in range(6):
        law.act(k * law.dt, y[k])
    twins = {how: made(law) for how, made in COPIES.items()}
    for made in COPIES.values():  # a copy that is driven elsewhere
        other = made(law)
        for k in range(6, 9):
            other.act(k * law.dt, y[k] + 0.01)
    on = np.array([law.act(k * law.dt, y[k]) for k in range(6, 12)])
    assert np.ptp(on) > 0
    for how, twin in twins.items():
        found = np.array([twin.act(k * law.dt, y[k]) for k in range(6, 12)])
        np.testing.assert_allclose(found, on, rtol=1e-9, atol=1e-12 * np.abs(on).max(), err_msg=how)
