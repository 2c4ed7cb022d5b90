"""LQG: separation, saturated inputs, laws that read outputs, scenes."""

import dataclasses

import numpy as np
import pytest

from pliant.controllers import LQR, Controller, Feedback
from pliant.controllers.analysis.loops import closed_loop, law_of, loop
from pliant.controllers.analysis.margins import margins
from pliant.controllers.base.goal_model import goal_model
from pliant.controllers.estimation.kalman import Kalman
from pliant.controllers.estimation.process_noise import process_noise
from pliant.controllers.estimation.sensors import Sensor, read, sensors_of
from pliant.controllers.linear_quadratic import lqg as lqg_module
from pliant.controllers.linear_quadratic.lqg import LQG
from pliant.envs import scenes
from pliant.plants import PliantError, UncontrollableError

SCENE = scenes.get("single-link-slew")
PLANT = SCENE.plant
MODEL = PLANT.linearize(*SCENE.target)
W = {"tip_force_y": 1e-2, "hub_torque": 1e-3}
Q, R = {"hub_angle": 10.0, "tip_deflection": 100.0}, {"hub_torque": 0.002}


def designed(**options):
    return LQG.design(MODEL, Q, R, sensors_of(PLANT), W, dt=0.01, **options)


@pytest.mark.parametrize("delay", [0, 2])
@pytest.mark.parametrize("sensors", [slice(0, 2), slice(0, 3)], ids=["without feedthrough", "with accelerometer"])
def test_separation(sensors, delay):
    """The loop's poles are the regulator's, the estimation error's, and zeros of inputs held and outputs under way."""
    lqr = LQR.design(MODEL, Q, R, dt=0.01)
    lqg = LQG(lqr, Kalman.design(MODEL, sensors_of(PLANT)[sensors], W, dt=0.01, delay=delay))
    wanted = np.concatenate([lqr.poles, lqg.filter.poles])
    for A in (closed_loop(MODEL, lqg), loop(MODEL, lqg).closed(), loop(MODEL, lqg, at="output").closed()):
        found = np.linalg.eigvals(A)
        for pole in wanted[np.abs(wanted) > 0.05]:
            assert np.abs(found - pole).min() < 1e-7
        assert (np.abs(found) > 0.05).sum() == (np.abs(wanted) > 0.05).sum()


def test_linear_form_is_what_act_does():
    lqg = designed()
    law, rng = law_of(lqg), np.random.default_rng(1)
    s = np.zeros(len(law.A))
    y0 = lqg.filter.y0[0]
    for k in range(30):
        y = np.array([1e-3, 1e-2, 1.0]) * rng.normal(size=3)
        np.testing.assert_allclose(lqg.act(0.01 * k, y0 + y), -(law.C @ s + law.D @ y), rtol=1e-7, atol=1e-9)
        s = law.A @ s + law.B @ y


def test_limits_are_known_to_the_filter():
    lqg = designed(limits=(-1.0, 1.0))
    lqg.act(0.0, lqg.filter.y0[0] + np.array([-1.0, 0, 0]))
    assert lqg.u == pytest.approx([1.0])
    lqg.act(0.01, lqg.filter.y0[0])
    other = Kalman.design(MODEL, sensors_of(PLANT), W, dt=0.01)
    other.step(lqg.filter.y0[0] + np.array([-1.0, 0, 0]))
    other.step(lqg.filter.y0[0], np.array([1.0]))
    np.testing.assert_array_equal(lqg.filter.estimate, other.estimate)
    lqg.reset()
    assert lqg.u is None and lqg.filter.k == -1


def test_slew_with_noisy_sensors():
    """The scene's cost within a few per cent of the full-state LQR's, with all sensors' noise and quanta."""
    lqg, rng = LQG.for_scene(SCENE), np.random.default_rng(0)
    assert isinstance(lqg, Controller)

    class Noisy:
        dt, reads = lqg.dt, lqg.reads
        reset = lqg.reset

        def act(self, t, y):
            return lqg.act(t, read(lqg.filter.sensors, y, lqg.dt, rng))

    motion = PLANT.simulate(SCENE.initial[0], Noisy(), SCENE.times, rtol=1e-8, atol=1e-10)
    limits = np.array(SCENE.limits)
    full = LQR.design(MODEL, dict(SCENE.weights), dict(SCENE.effort), dt=SCENE.dt, limits=(-limits, limits))
    best = PLANT.simulate(SCENE.initial[0], full, SCENE.times, rtol=1e-8, atol=1e-10)
    assert SCENE.cost(motion) < 1.2 * SCENE.cost(best)
    assert abs(motion["hub_angle"][-1] - 1.0) < 2e-3


@pytest.mark.parametrize("name", ["two-link-reach", "cantilever-drop", "spin-up"])
def test_scenes_on_their_own_sensors(name):
    """From the scene's start, without noise: within 20 % of the cost of the LQR that reads every state."""
    scene = scenes.get(name)
    lqg = LQG.for_scene(scene)
    np.testing.assert_allclose(lqg.filter.estimate, scene.initial[0], atol=1e-12)
    costs = [
        scene.cost(scene.plant.simulate(scene.initial[0], law, scene.times, rtol=1e-6, atol=1e-8))
        for law in (lqg, LQR.for_scene(scene))
    ]
    assert costs[0] < 1.2 * costs[1]


def test_spacecraft_on_star_tracker_and_gyros():
    """Attitude outputs stand for the quaternion; the filter starts at the attitude that the scene starts from."""
    scene = scenes.get("spacecraft-slew")
    lqg = LQG.for_scene(scene)
    assert {"attitude_x", "body_rate_z"} <= set(lqg.reads)
    found = dict(zip(lqg.filter.model.state_names, lqg.filter.estimate))
    wanted = dict(zip((s.name for s in scene.plant.outputs), scene.plant.measure(*scene.initial)))
    assert found["attitude_z"] == pytest.approx(wanted["attitude_z"])
    assert np.abs(np.linalg.eigvals(closed_loop(lqg.filter.model, lqg))).max() < 1


def test_laws_that_read_outputs_get_them_from_the_estimate():
    K = np.array([[30.0, 8.0]])
    law = Feedback(K, ("hub_angle", "tip_y"), dt=0.01)
    lqg = LQG(law, Kalman.design(MODEL, sensors_of(PLANT), W, dt=0.01))
    u = lqg.act(0.0, lqg.filter.y0[0] + np.array([1e-3, 1e-2, 0.1]))
    x = lqg.filter.estimate
    link = PLANT.link.length * np.sin(1.0) + np.cos(1.0) * (
        PLANT.link.length * (x[0] - 1) + PLANT.elastic.basis.tip @ x[1:3]
    )
    np.testing.assert_allclose(u, -K @ [x[0], link], rtol=1e-9)  # linear about hub_angle = 1


@pytest.mark.parametrize(
    ("law", "message"),
    [
        (LQR.design(MODEL, Q, R, dt=0.02), r"LQG\.law\.dt = 0\.02 must be the filter's, 0\.01 s"),
        (LQR.design(MODEL, Q, R), r"LQG\.law\.dt = None"),
        (Feedback([[1.0]], ("nose",), dt=0.01), "'nose' must be one of hub_angle"),
    ],
)
def test_bad_law(law, message):
    with pytest.raises(ValueError, match=message):
        LQG(law, Kalman.design(MODEL, sensors_of(PLANT), W, dt=0.01))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"kind": "ear"}, "kind = 'ear'"),
        ({"noise": -1.0}, "noise of hub_angle = -1.0 must be >= 0"),
        ({"noise": 0.0}, "must be > 0 where density and quantum are 0 too"),
    ],
)
def test_bad_sensor(change, message):
    with pytest.raises(ValueError, match=message):
        Sensor(**{"kind": "encoder", "output": "hub_angle", "unit": "rad", "noise": 1.0, **change})
    with pytest.raises(ValueError, match="dt = 0 must be > 0"):
        sensors_of(PLANT)[0].deviation(0)


def test_sensors_err_by_their_deviation():
    """2000 samples of a value that moves over many quanta: standard deviation within 3.3 standard errors."""
    rng = np.random.default_rng(4)
    for sensor in sensors_of(PLANT):
        values = rng.uniform(-1, 1, 2000)
        error = [sensor.read(v, 0.01, rng) - v for v in values]
        assert np.std(error) == pytest.approx(sensor.deviation(0.01), rel=3.3 / np.sqrt(4000))
    assert sensors_of(PLANT)[0].read(1.0, 0.01, rng) / (2 * np.pi / 2**17) % 1 == pytest.approx(0, abs=1e-6)


def test_every_plant_of_the_library_has_sensors_that_it_knows():
    from pliant.plants import FlexibleSpacecraft, LargeDeflectionBeam, SliderCrank, TwoLinkArm

    plants = [PLANT, TwoLinkArm.textbook(), SliderCrank.textbook(), FlexibleSpacecraft.textbook()]
    plants += [
        dataclasses.replace(LargeDeflectionBeam.textbook(), root=root) for root in ("clamped", "hinged", "driven")
    ]
    for plant in plants:
        known = {s.name: s.unit for s in plant.states + plant.outputs}
        for sensor in sensors_of(plant):
            assert known[sensor.output] in (sensor.unit, "1")
    with pytest.raises(ValueError, match="must be a Plant, not str"):
        sensors_of("arm")


@pytest.mark.campaign
def test_a_spin_that_the_filter_reads_and_the_law_leaves_has_no_margins_and_without_it_there_are():
    """Four wheels share a spin that turns nothing: with their tachometers the filter's loop keeps a pole at one, which
    rounding put within the circle on some machines: "disk 0.0023". On the model without it, which the regulator has,
    star tracker and gyro alone leave a disk near the regulator's own.
    """
    scene = scenes.get("spacecraft-wheels")
    law = LQG.for_scene(scene)
    with pytest.raises(PliantError, match=r"a pole is 1.*as of what inputs change, a filter reads and the law leaves"):
        margins(loop(law.filter.model, law))
    model, _ = goal_model(scene)
    known = model.state_names + model.output_names
    sensors = [s for s in sensors_of(scene.plant) if s.output in known]
    made = LQG(law.law, Kalman.design(model, sensors, process_noise(scene), dt=scene.dt, noise="held"))
    whole, own = margins(loop(model, made)), margins(loop(law.filter.model, law.law))
    assert 1.0 < whole.disk < own.disk
    assert own.free == law.law.free and len(own.free) == 1


def test_a_scenes_filter_knows_that_parameters_may_be_off():
    """Two-link-reach with stiffness and payload at a corner of +-30 %: the linear loop of the plain design grows."""
    reach = scenes.get("two-link-reach")
    box = {"payload.mass": 1.3, "link1.E": 0.7, "link2.E": 0.7}
    varied = reach.plant.vary(*box)
    corner = varied.feedback_model(*reach.target, p=varied.nominal_parameters * np.array(list(box.values())))
    grown = [
        np.abs(np.linalg.eigvals(closed_loop(corner, LQG.for_scene(reach, uncertain=spread)))).max()
        for spread in (0.0, None, 0.1)
    ]
    assert grown[0] > 1.05 and grown[1] < 1.0 and grown[2] == grown[1]
    given = LQG.for_scene(reach, W=process_noise(reach))
    np.testing.assert_array_equal(given.filter.gains[-1].L, Kalman.for_scene(reach, W=process_noise(reach)).gains[-1].L)


@pytest.mark.parametrize(("name", "uncertain"), [("two-link-reach", -0.1), ("two-link-reach", 1.0), ("spin-up", 0.1)])
def test_what_cannot_be_uncertain_is_refused(name, uncertain):
    with pytest.raises(ValueError, match=rf"LQG\.uncertain = {uncertain} must be"):
        LQG.for_scene(scenes.get(name), uncertain=uncertain)


def test_a_filter_that_cannot_be_told_of_parameters_says_so_and_why(monkeypatch):
    """On spin-up the law leaves the hub's angle out; a filter that is not found tells the modes that it is not for."""
    with pytest.warns(
        lqg_module.PlainFilterWarning, match=r"'spin-up' is told nothing .*: the law leaves states out\. un"
    ):
        law = LQG.for_scene(scenes.get("spin-up"))
    assert law.plain == "the law leaves states out" and "plain='the law leaves" in repr(law)

    def refuses(*given):
        raise UncontrollableError("mode 0.41 Hz (link2) is not driven by the noise W\nremedy", ("link2",))

    monkeypatch.setattr(lqg_module, "told_parameters", refuses)
    with pytest.warns(lqg_module.PlainFilterWarning, match=r"mode 0\.41 Hz \(link2\) is not driven"):
        law = LQG.for_scene(SCENE)
    np.testing.assert_array_equal(law.filter.gains[-1].L, LQG.for_scene(SCENE, uncertain=0.0).filter.gains[-1].L)
    with pytest.raises(UncontrollableError):
        LQG.for_scene(SCENE, uncertain=0.1)


def test_a_filter_that_is_not_asked_to_know_parameters_says_nothing(recwarn):
    for law in (LQG.for_scene(scenes.get("spin-up"), uncertain=0.0), LQG.for_scene(SCENE), LQG.for_scene(SCENE, W=W)):
        assert law.plain == ""
    assert not [one for one in recwarn if one.category is lqg_module.PlainFilterWarning]
