"""Arms whose links stretch: closed forms of bars, and Exudyn's beams where a link bends by half a metre."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest
from evidence import agrees
from scipy.optimize import brentq

from pliant.envs import scenes
from pliant.plants import SingleLinkArm, TwoLinkArm, beams
from pliant.plants.beams.payload import Payload

BAR = beams.Beam.rectangular(1.2, width=0.02, depth=0.02, material=beams.Material(E=2e8, G=8e7, density=1200.0))
LOAD = Payload(mass=0.7)
EXACT = {"kinematics": "strain", "theory": "timoshenko", "basis": "polynomial", "extensible": True}


def hanging(**options):
    return SingleLinkArm(link=BAR, payload=LOAD, hub_inertia=0.1, gravity=9.81, modes=2, **EXACT, **options)


def test_a_bar_that_hangs_is_longer_by_its_load_and_half_its_weight():
    """(m_p + m/2) g L/(E A), Gere and Timoshenko, "Mechanics of Materials", section 2.3."""
    arm = hanging()
    x0, _ = arm.equilibrium(hub_angle=-np.pi / 2)
    longer = -arm.measure(x0)[[s.name for s in arm.outputs].index("tip_y")] - BAR.length
    assert longer == pytest.approx((LOAD.mass + BAR.mass / 2) * 9.81 * BAR.length / (BAR.E * BAR.area), rel=1e-9)


def test_two_links_that_hang():
    """The first carries the second and the load."""
    arm = TwoLinkArm(link1=BAR, link2=BAR, payload=LOAD, hub_inertia=(0.1, 0.1), modes=(2, 2), **EXACT)
    x0, _ = arm.equilibrium(theta1=-np.pi / 2, theta2=0.0)
    longer = -arm.measure(x0)[[s.name for s in arm.outputs].index("tip_y")] - 2 * BAR.length
    carried = 2 * LOAD.mass + 2 * BAR.mass  # m_p + m/2 of the second link, m_p + 3 m/2 of the first
    assert longer == pytest.approx(carried * 9.81 * BAR.length / (BAR.E * BAR.area), rel=1e-9)


def test_a_bar_with_a_load_swings_along_itself():
    """beta tan(beta) = m/m_p, omega = beta sqrt(E/rho)/L: Ritz's two shapes come from above (Rao, section 8.3)."""
    arm = dataclasses.replace(hanging(), gravity=0.0, drive="motion")
    beta = brentq(lambda b: b * np.tan(b) - BAR.mass / LOAD.mass, 1e-3, np.pi / 2 - 1e-6)
    along = beta * np.sqrt(BAR.E / BAR.density) / BAR.length
    rates = [s.name for s in arm.states].index("stretch1_rate")
    A = arm.jacobians(np.zeros(arm.nx))[0]
    own = A[rates : rates + 2, rates - arm.nx // 2 : rates - arm.nx // 2 + 2]  # a straight bar's stretch by itself
    found = np.sqrt(np.linalg.eigvals(-own).real.min())
    assert along < found < 1.001 * along


def test_without_extension_nothing_of_it_is_left():
    arm = hanging()
    plain = arm.without("extension")
    assert not plain.extensible and plain.nx == arm.nx - 4 and "extension" not in plain.effects
    E = arm.embedding(plain)
    assert E.shape == (arm.nx, plain.nx) and np.allclose(E[[3, 4]], 0.0)
    np.testing.assert_allclose(arm.embedding(arm), np.eye(arm.nx), atol=1e-12)
    assert not any(rung.extensible for rung in arm.ladder())


def test_extension_needs_kinematics_that_have_it():
    for changes in ({"kinematics": "stiffened"}, {"theory": "euler-bernoulli"}):
        with pytest.raises(ValueError, match=r"SingleLinkArm.extensible = True needs kinematics = 'strain' and theory"):
            dataclasses.replace(hanging(), **changes)


@pytest.mark.campaign
def test_moves_as_exudyns_beams():
    """Bent by half of its length; left out, extension is worth 0.33 mm here. Exudyn is known to 8 um."""
    kept = json.loads((Path(__file__).parents[2] / "reference" / "extensible_arm.json").read_text())
    scene = scenes.get("single-link-slew", move_time=0.5, duration=1.2)
    link = dataclasses.replace(scene.plant.link, E=1.5e10, length=1.2)
    arm = dataclasses.replace(scene.plant, hub_inertia=0.04, link=link, modes=8, **EXACT)
    t = np.arange(len(kept["torque"])) * kept["dt"]
    motion = arm.simulate(None, np.array(kept["torque"])[:, None], t, method="rodas5p", rtol=1e-7, atol=1e-9)
    tip = np.column_stack([motion["tip_x"], motion["tip_y"]])[::6]
    theirs, within = np.column_stack([kept["tip_x"], kept["tip_y"]]), 2 * kept["known_to"]  # [m]
    told = {"of": "SingleLinkArm", "source": "Exudyn 1.13.6, 32 geometrically exact beams", "kind": "other program"}
    agrees(tip, theirs, within=within, what="tip of an extensible link over 1.2 s [m]", absolute=True, **told)
    assert within < 2e-5
