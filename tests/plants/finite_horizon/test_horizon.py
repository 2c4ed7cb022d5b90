"""Numbers of a slew: of the plant itself to first order; names, sizes and words."""

import numpy as np
import pytest
from horizon_models import constant, random_ltv
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from pliant.envs import scenes
from pliant.plants import Trajectory
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


def test_a_craft_moves_as_told_to_first_order():
    """The worst torques of small energy replayed on a slewing craft with flexible panels, half-way."""
    scene = scenes.get("spacecraft-slew")
    plant, whole = scene.plant, scene.nominal_motion()
    x0, t = whole.x[len(whole.t) // 4], np.linspace(0.0, 20.0, 401)
    u = np.array([scene.nominal_input(30.0 + s) for s in t])
    nominal = plant.simulate(x0, u, t, rtol=1e-11, atol=1e-13)
    model = plant.linearize_along(nominal, attitude="quaternion")
    found = finite_horizon(model, outputs=["attitude_z"], disturbances=[s.name for s in plant.inputs])
    push, column, left = found.end["attitude_z"], [s.name for s in plant.outputs].index("attitude_z"), []
    for size in (0.1, 0.05):
        moved = plant.simulate(x0, u + size * push.disturbance, t, rtol=1e-11, atol=1e-13)
        left.append(moved.y[-1, column] - nominal.y[-1, column] - size * push.lower)
    assert abs(left[1]) < 1e-3 * 0.05 * push.lower
    assert abs(left[0] / left[1]) == pytest.approx(4.0, rel=0.15)


def test_the_slew_of_the_readme_by_an_optimisation_of_its_own():
    """How far a tip force of 1 N^2 s pushes the tip of a rigid slew of 1.2 s: 6.05 mm, by projected gradient.

    The force's history is piecewise linear, every part of it carried by scipy's integration of the linear model.
    """
    scene = scenes.get("single-link-slew")
    t, nx = np.linspace(0.0, 1.2, 121), scene.plant.nx
    slew = scene.plant.ladder()[0].simulate([0.0, 0.0], scene.nominal_input, t)
    x = np.zeros((len(t), nx))
    x[:, 0], x[:, nx // 2] = slew["hub_angle"], slew["hub_angle_rate"]
    model = scene.plant.linearize_along(Trajectory.from_arrays(t, x, slew.u, plant=scene.plant))
    found = finite_horizon(model, outputs=["tip_deflection"], disturbances=["tip_force_x", "tip_force_y"])
    A, E, C = CubicSpline(t, model.A), CubicSpline(t, model.E), model.C[:, model.output_names.index("tip_deflection")]
    m = 161
    h = 1.2 / (m - 1)

    def rate(s, flat):
        states, k = flat.reshape(nx, 2, m), min(int(s / h), m - 2)
        change, push, share = np.einsum("ij,jkm->ikm", A(s), states), E(s), s / h - k
        change[:, :, k] += (1 - share) * push
        change[:, :, k + 1] += share * push
        return change.ravel()

    moved = solve_ivp(rate, (0.0, 1.2), np.zeros(2 * nx * m), t_eval=t[-12:], max_step=h, rtol=1e-5, atol=1e-9).y
    seen = np.einsum("tn,nkt->tk", C[-12:], moved.reshape(nx, 2 * m, -1))  # by each part of the history
    energy = h / 6 * (np.diag(np.r_[2.0, np.full(m - 2, 4.0), 2.0]) + np.eye(m, k=1) + np.eye(m, k=-1))
    energy = np.kron(np.eye(2), energy)
    most = []
    for row in seen:
        w, uphill = np.random.default_rng(0).normal(size=2 * m), np.linalg.solve(energy, row)
        for _ in range(60):
            w = w / np.sqrt(w @ energy @ w) + uphill / np.sqrt(uphill @ energy @ uphill)
        most.append(row @ w / np.sqrt(w @ energy @ w))
    assert max(most) == pytest.approx(6.05e-3, rel=1e-3)
    tip = found.peak["tip_deflection"]
    assert tip.lower < max(most) * (1 + 1e-4) and max(most) < tip.upper < 1.003 * tip.lower
    assert tip.lower == pytest.approx(6.05e-3, rel=1e-3)
