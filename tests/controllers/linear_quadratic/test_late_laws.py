"""LQR, LQG and Predictive with inputs that act late: cost to go, the linear form, poles, gates."""

import numpy as np
import pytest

from pliant.controllers import LQG, LQR
from pliant.controllers.analysis.linear_laws import law_of
from pliant.controllers.analysis.loops import loop
from pliant.controllers.analysis.margins import margins
from pliant.controllers.estimation.kalman import Kalman
from pliant.controllers.estimation.sensors import sensors_of
from pliant.controllers.linear_quadratic.delay import predictive_gain
from pliant.controllers.riccati.late_inputs import late_period
from pliant.controllers.robust_design.lqg_over_box import loops_over
from pliant.envs import scenes

SCENE = scenes.get("single-link-slew")
PLANT = SCENE.plant
MODEL = PLANT.linearize(*SCENE.target)
Q, R = {"hub_angle": 10.0, "tip_deflection": 100.0}, {"hub_torque": 0.002}
W = {"tip_force_y": 1e-2, "hub_torque": 1e-3}
DT = 0.01


def test_whole_periods_are_the_gain_on_the_delayed_model():
    law, plain = LQR.design(MODEL, Q, R, dt=DT, delay=2), LQR.design(MODEL, Q, R, dt=DT)
    wanted = predictive_gain(MODEL.discretize(DT), plain.K, 2)
    np.testing.assert_allclose(np.hstack([law.K, law.K_past]), wanted, rtol=1e-8, atol=1e-8 * np.abs(wanted).max())
    slow = np.abs(plain.poles)
    assert np.abs(law.poles).max() == pytest.approx(slow.max(), rel=1e-8)


@pytest.mark.parametrize("delay", [0.0, 0.6, 2.0])
def test_cost_to_go_is_what_the_loop_costs(delay):
    law = LQR.design(MODEL, Q, R, dt=DT, delay=delay, before=[0.3])
    past = 0 if law.K_past is None else law.K_past.shape[1]
    weights = {"Q": np.zeros((6, 6)), "N": np.zeros((6, 1)), "R": np.array([[0.002]])}
    for name, weight in Q.items():
        C = MODEL.C[MODEL.output_names.index(name)] if name in MODEL.output_names else None
        row = np.eye(6)[MODEL.state_names.index(name)] if C is None else C
        weights["Q"] += weight * np.outer(row, row)
    one = late_period(MODEL.A, MODEL.B, weights["Q"], weights["R"], weights["N"], DT, delay, past)
    x = np.array([0.1, 0.0, 0.0, 0.0, 0.2, 0.0])
    z, cost = np.concatenate([x, np.full(past, 0.3 - law.u0[0])]), 0.0
    law.reset()
    for k in range(3000):
        both = np.append(z, law.act(k * DT, law.x0 + z[:6]) - law.u0)
        cost += both @ one.cost @ both
        z = one.step @ both
    law.reset()
    assert law.cost_to_go(law.x0 + x) == pytest.approx(cost, rel=1e-8)


@pytest.mark.parametrize("delay", [0.0, 0.6, 1.0, 2.4])
def test_lqg_acts_as_its_linear_form_and_its_poles_are_those_of_law_and_filter(delay):
    law = LQG.design(MODEL, Q, R, sensors_of(PLANT), W, dt=DT, input_delay=delay)
    form, rng = law_of(law), np.random.default_rng(1)
    s, y0 = np.zeros(len(form.A)), law.filter.y0[0]
    for k in range(20):
        y = np.array([1e-3, 1e-2, 1.0]) * rng.normal(size=3)
        np.testing.assert_allclose(law.act(DT * k, y0 + y), law.law.u0 - form.C @ s - form.D @ y, rtol=1e-7, atol=1e-9)
        s = form.A @ s + form.B @ y
    names = [sensor.output for sensor in law.filter.sensors]
    rows = [MODEL.output_names.index(n) if n in MODEL.output_names else None for n in names]
    C = np.array([np.eye(6)[MODEL.state_names.index(n)] if i is None else MODEL.C[i] for n, i in zip(names, rows)])
    D = np.array([[0.0] if i is None else MODEL.D[i] for i in rows])
    past = int(np.ceil(delay)) + 1
    one = late_period(MODEL.A, MODEL.B, np.zeros((6, 6)), np.eye(1), np.zeros((6, 1)), DT, delay, past).step
    nz, m = 6 + past, len(form.A)
    acting = np.zeros((1, past))  # when the sample is taken, the input of one period before the oldest still waiting
    acting[0, past - (int(np.ceil(delay)) if delay else 1) - (0 if delay % 1 or not delay else 1)] = 1.0
    seen = np.hstack([C, D @ acting])
    whole = np.zeros((nz + m, nz + m))
    whole[:nz, :nz] = one[:, :nz] - one[:, nz:] @ form.D @ seen
    whole[:nz, nz:] = -one[:, nz:] @ form.C
    whole[nz:, :nz], whole[nz:, nz:] = form.B @ seen, form.A
    found = np.linalg.eigvals(whole)
    for pole in np.concatenate([law.law.poles, law.filter.poles]):
        if abs(pole) > 0.1:
            assert np.abs(found - pole).min() < 1e-6


def test_recovery_brings_the_margins_of_the_state_feedback_back():
    """Doyle and Stein (1979): with more noise at the input the loop comes to the LQR's. From the encoder alone."""
    hub = [sensor for sensor in sensors_of(PLANT) if sensor.output == "hub_angle"]

    def disk(law):
        return margins(loop(MODEL, law)).channels[0].disk

    wanted = disk(LQR.design(MODEL, Q, R, dt=DT))
    found = [
        disk(LQG.design(MODEL, Q, R, hub, {"tip_force_y": 1e-2}, dt=DT, noise="held", recovery=q)) for q in (0, 1, 100)
    ]
    assert found[0] < 0.92 * wanted and found[0] < found[1] < found[2]
    assert found[2] == pytest.approx(wanted, rel=5e-3)


def test_lqg_for_a_range_of_delays_is_stable_on_time_and_late():
    """Two-link-reach: told 1 period it is not stable without a delay, nor told none with one."""
    reach, delays = scenes.get("two-link-reach"), (0.0, 0.5, 1.0)
    model = reach.plant.feedback_model(*reach.target)

    def radii(given):
        law = LQG.for_scene(reach, input_delay=given)
        return [loops_over(reach, law.filter.sensors, [model], [d]).value(law).radius for d in delays]

    assert radii(0)[2] > 1 and radii(1)[0] > 1 and max(radii((0, 1))) < 1
    law = LQG.for_scene(reach, input_delay=(0, 1))
    assert law.filter.input_delay == 0.5 and law.law.delay == (0.0, 1.0)


def test_bad_input():
    with pytest.raises(ValueError, match=r"LQR\.delay"):
        LQR.design(MODEL, Q, R, delay=1)
    with pytest.raises(ValueError, match=r"LQR\.delay"):
        LQR.design(MODEL, Q, R, dt=DT, delay=1, integral={"hub_angle": 1.0})
    with pytest.raises(ValueError, match=r"LQR\.before"):
        LQR.design(MODEL, Q, R, dt=DT, delay=1, before=[1.0, 2.0])
    with pytest.raises(ValueError, match=r"LQG\.input_delay"):
        LQG.for_scene(SCENE, input_delay=-1)
    with pytest.raises(ValueError, match=r"LQG\.input_delay"):
        LQG.for_scene(SCENE, input_delay=(1.0, 0.5))
    with pytest.raises(ValueError, match=r"LQG\.recovery"):
        LQG.for_scene(SCENE, recovery=-1)
    with pytest.raises(ValueError, match=r"Kalman\.input_delay"):
        Kalman.for_scene(SCENE, input_delay="late")
