"""Numbers of a slew: of the plant itself to first order; names, sizes and words."""

import numpy as np
import pytest
from horizon_models import constant, random_ltv

from pliant.envs import scenes
from pliant.plants.finite_horizon import finite_horizon


def test_the_plant_moves_as_told_to_first_order():
    """The worst torque of small energy replayed on the nonlinear arm: what is left over falls as its square."""
    scene = scenes.get("two-link-reach", duration=0.6)
    plant, (x0, _) = scene.plant, scene.nominal_initial
    t = np.linspace(0.0, 0.6, 401)
    u = np.array([scene.nominal_input(s) for s in t])
    nominal = plant.simulate(x0, u, t, rtol=1e-12, atol=1e-14)
    model = plant.linearize_along(nominal)
    found = finite_horizon(model, outputs=["tip_y"], disturbances=["tau1", "tau2"])
    push = found.end["tip_y"]
    column, left = [s.name for s in plant.outputs].index("tip_y"), []
    assert len(found.t) == len(t) and push.time == pytest.approx(0.6)
    for size in (0.4, 0.2):
        held = u + size * push.disturbance
        moved = plant.simulate(x0, held, t, rtol=1e-12, atol=1e-14)
        left.append(moved.y[-1, column] - nominal.y[-1, column] - size * push.lower)
    assert abs(left[1]) < 0.05 * 0.2 * push.lower
    assert abs(left[0] / left[1]) == pytest.approx(4.0, rel=0.3)


def test_words_name_the_output_and_its_unit():
    found = finite_horizon(constant([[0.0, 1.0], [0.0, 0.0]], [[0.0], [1.0]], [[1.0, 0.0]], 2.0))
    assert found.words == (
        "Over its 2 s the motion lets w1 of unit energy (1 s) move z1 by at most 1.64, and at most 1 by at most 2"
    )
    passed = finite_horizon(constant([[-1.0]], [[1.0]], [[1.0]], 2.0, F=[[1.0]]))  # no bound by energy at one time
    assert passed.words == "Over its 2 s the motion lets w1, at most 1, move z1 by at most 1.86"  # 2 - e^-2
    assert passed.to_json()["outputs"]["z1"]["peak"]["upper"] is None


def test_what_is_refused():
    model = random_ltv(0)
    for match, options in (
        (r"outputs = \(\)", {"outputs": []}),
        ("one of", {"outputs": ["tip"]}),
        ("wind", {"disturbances": ["wind"]}),
        (r"scale\['w1'\] = 0", {"scale": {"w1": 0.0}}),
        (r"limits\['w1'\] = -1", {"limits": {"w1": -1.0}}),
        ("'none'", {"scale": {"none": 1.0}}),
    ):
        with pytest.raises(ValueError, match=match):
            finite_horizon(model, **options)
    with pytest.raises(ValueError, match="must be a LTVModel"):
        finite_horizon(np.eye(2))
    stiff = constant([[-1e6]], [[1.0]], [[1.0]], 1.0)
    with pytest.raises(ValueError, match="leave out the fastest modes"):
        finite_horizon(stiff)
