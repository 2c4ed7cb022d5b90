"""Identification end to end: published bounds, Monte Carlo, pairs that cannot be told, bounds, gaps, starts, tries."""

import identification as campaign
import numpy as np
import pytest
from scipy.stats import chi2
from springs import GONE, NOISE, SPRING, TRUE, VARIED, Runaway, pushed

from pliant.plants import Beam, Experiment, IntegrationError, SingleLinkArm, beams, identify
from pliant.plants.identification.output_error import stated

FROM = {"mass": 2.4, "damping": 1.1, "stiffness": 44.0}


@pytest.fixture(scope="module")
def found():
    return identify(VARIED, [pushed(), pushed(seed=1)], start=FROM)


def test_truth_noise_and_intervals(found):
    for name, value in TRUE.items():
        low, high = found.intervals[name]
        assert low < value < high and found.values[name] == pytest.approx(value, abs=4 * found.standard_errors[name])
    for name, level in NOISE.items():
        assert found.noise[name] == pytest.approx(level, rel=4 / np.sqrt(2 * 402))
    assert found.trusted and found.converged and not found.unidentifiable and found.step_error < 0.05
    assert found.plant.mass == found.values["mass"] and found.plant.varied == ()


def test_residuals_are_what_the_plant_found_leaves(found):
    motion = pushed()
    computed = found.plant.simulate(motion.start, motion.u, motion.t)
    left = motion.measured["place"] - computed["place"]
    assert np.abs(found.residuals[0].values[:, 0] - left).max() < 1e-9


def test_the_bound_on_the_frequency_of_a_sinusoid():
    """Rife and Boorstyn 1974; Kay 1993, Example 3.14: var(w) >= 12/(eta N (N^2 - 1)) [rad^2/sample^2], eta = A^2/(2
    sigma^2), amplitude and phase unknown too, for frequencies away from 0 and half the sampling rate. k = m w^2.
    """
    N, rate, A, sigma = 3201, 100.0, 0.5, 0.01
    plant = SPRING.vary("damping", "stiffness")
    w = np.sqrt(SPRING.stiffness / SPRING.mass)
    t = np.arange(N) / rate
    place = A * np.cos(w * t + 0.3) + sigma * np.random.default_rng(0).standard_normal(N)
    motion = Experiment(t=t, measured={"place": place}, start=(A, 0.0), unknown="all")
    least = {"damping": (0.0, 1e-9), "stiffness": (10.0, 100.0)}
    found = identify(plant, motion, noise={"place": sigma}, bounds=least, start={"damping": 1e-10})
    variance = 12 / (A**2 / (2 * sigma**2) * N * (N**2 - 1)) * rate**2
    assert found.standard_errors["stiffness"] == pytest.approx(2 * SPRING.mass * w * np.sqrt(variance), rel=0.01)
    assert found.values["stiffness"] == pytest.approx(50.0, abs=4 * found.standard_errors["stiffness"])


def test_standard_errors_are_what_monte_carlo_sees():
    """The sum of (estimate - truth)^2/variance over 60 runs is chi-squared with 60 degrees of freedom."""
    runs = [identify(VARIED, pushed(1.5, seed=k), noise=NOISE) for k in range(60)]
    for name, value in TRUE.items():
        total = sum(((r.values[name] - value) / r.standard_errors[name]) ** 2 for r in runs)
        assert chi2.ppf(1e-4, 60) < total < chi2.ppf(1 - 1e-4, 60)


def test_a_free_motion_tells_ratios_alone():
    """m x'' + c x' + k x = 0 is the same for all multiples of (m, c, k)."""
    t = np.linspace(0.0, 4.0, 201)
    motion = Experiment.of(SPRING.simulate((1.0, 0.0), None, t), noise=NOISE)
    found = identify(VARIED, motion, start=FROM)
    (group,) = found.unidentifiable
    assert sorted(group.names) == sorted(TRUE) and group.direction == pytest.approx((1.0,) * 3, abs=1e-3)
    assert set(found.intervals.values()) == {(-np.inf, np.inf)}
    assert found.values["stiffness"] / found.values["mass"] == pytest.approx(25.0, rel=1e-3)
    assert any("cannot be told apart" in words for words in found.remarks)


def test_pairs_of_an_arm_that_cannot_be_told():
    """Of a rigid arm only the sum J + m L^2 + .. shows, and no modulus."""
    strip = Beam.rectangular(1.0, width=0.05, depth=0.01, material=beams.STEEL)
    arm = SingleLinkArm(link=strip, hub_inertia=1.3, kinematics="rigid")
    arm = arm.vary("hub_inertia", "link.density", "link.E")
    t = np.linspace(0.0, 1.0, 101)
    motion = arm.simulate(None, np.sin(6 * t)[:, None], t)
    found = identify(arm, Experiment.of(motion, signals=("hub_angle",), noise={"hub_angle": 1e-5}))
    assert {frozenset(g.names) for g in found.unidentifiable} == {
        frozenset({"hub_inertia", "link.density"}),
        frozenset({"link.E"}),
    }


def test_missing_samples_change_nothing_but_what_is_known():
    motion = pushed()
    keep = np.arange(len(motion.t)) % 4 == 0
    gaps = {"place": np.where(keep, motion.measured["place"], np.nan), "felt": motion.measured["felt"]}
    found = identify(VARIED, Experiment(t=motion.t, u=motion.u, measured=gaps), noise=NOISE)
    assert found.samples == keep.sum() + len(keep)
    half = identify(VARIED, Experiment(t=motion.t, u=motion.u, measured=motion.measured), noise=NOISE)
    assert all(found.standard_errors[n] > half.standard_errors[n] for n in TRUE)
    assert all(abs(found.values[n] - TRUE[n]) < 4 * found.standard_errors[n] for n in TRUE)


def test_an_unknown_start_is_found_with_the_parameters():
    t = np.linspace(0.0, 3.0, 151)
    true = SPRING.simulate((0.3, -0.5), np.sign(np.sin(3 * t))[:, None], t)
    motion = Experiment.of(true, noise=NOISE, seed=5)
    blind = Experiment(t=t, u=true.u, measured=motion.measured, unknown="all")
    found = identify(VARIED, blind, start=FROM)
    for name, right in (("x", 0.3), ("v", -0.5)):
        value, error = found.starts[0][name]
        assert abs(value - right) < 4 * error < 0.02
    assert all(abs(found.values[n] - TRUE[n]) < 4 * found.standard_errors[n] for n in TRUE)
    wrong = identify(VARIED, Experiment(t=t, u=true.u, measured=motion.measured), start=FROM)
    assert not wrong.trusted


def test_bounds_are_kept_and_said():
    found = identify(VARIED, pushed(), bounds={"stiffness": (52.0, 60.0)}, start={"stiffness": 55.0})
    assert found.values["stiffness"] == 52.0 and found.at_bound == ("stiffness",)
    assert found.intervals["stiffness"] == (-np.inf, np.inf)
    assert any("stiffness stands at a bound" in words for words in found.remarks)


def test_a_model_that_lacks_physics_is_doubted():
    found = identify(SPRING.vary("mass"), pushed(), noise=NOISE, start={"mass": 2.1})
    assert found.trusted
    lacking = type(SPRING)(damping=0.3).vary("mass", "stiffness")
    found = identify(lacking, pushed(), noise=NOISE)
    assert not found.trusted and set(found.intervals.values()) == {(-np.inf, np.inf)}
    assert any("not white noise" in words for words in found.doubts)
    assert any("times the noise that was given" in words for words in found.doubts)


def test_noise_free_motions_are_met_to_rounding():
    t = np.linspace(0.0, 2.0, 101)
    found = identify(VARIED, SPRING.simulate((0.5, 0.0), np.sign(np.sin(4 * t))[:, None], t), start=FROM)
    assert found.trusted and all(abs(found.values[n] / TRUE[n] - 1) < 1e-6 for n in TRUE)


def test_long_motions_begin_with_a_part(monkeypatch):
    from pliant.plants.identification import maximum_likelihood

    whole = identify(VARIED, pushed(), start=FROM)
    monkeypatch.setattr(maximum_likelihood, "MANY", 100)
    part = identify(VARIED, pushed(), start=FROM)
    assert all(abs(part.values[n] - whole.values[n]) < 0.05 * whole.standard_errors[n] for n in TRUE)


def test_tries_and_progress():
    told = []
    bounds = {"mass": (0.5, 8.0), "damping": (0.0, 5.0), "stiffness": (10.0, 400.0)}
    start = {"mass": 0.6, "damping": 0.1, "stiffness": 390.0}
    tell = lambda part, doing: told.append((part, doing))  # noqa: E731
    found = identify(VARIED, pushed(), bounds=bounds, start=start, tries=4, progress=tell)
    assert found.trusted and found.values["mass"] == pytest.approx(2.0, rel=0.05) and found.stats["tries"] == 4
    parts = [part for part, _ in told]
    assert min(parts) >= 0 and max(parts) <= 1 and "sigma" in told[0][1]


def test_a_start_that_runs_away_is_an_error_that_says_so():
    with pytest.raises(IntegrationError, match="no search has a start whose motion is finite"):
        identify(Runaway().vary("stiffness"), GONE)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"motions": ()}, r"identify\.motions = \(\) must hold"),
        ({"motions": 3}, r"identify\.motions = 3 must be motions"),
        ({"noise": {"speed": 1.0}}, "signal 'speed' must be one of place, felt"),
        ({"noise": {"place": 0.0}}, r"noise\['place'\] = 0\.0 must be > 0"),
        ({"tries": 0}, r"identify\.tries = 0 must be an integer"),
        ({"seed": -1}, r"identify\.seed = -1"),
        ({"progress": 3}, r"identify\.progress = 3 must be a function"),
    ],
)
def test_refused(options, words):
    with pytest.raises(ValueError, match=words):
        identify(VARIED, **{"motions": pushed(0.2)} | options)


def test_a_sample_of_the_campaign_of_coverage():
    """tests/campaigns/identification.py: one random flexible arm by a data sheet's sensors, 8 runs. Squared distances
    of the estimates add up to chi-squared of 32.
    """
    found = list(campaign.runs(1, 8, seed=11))
    assert all(not doubts for _, _, doubts in found)
    assert chi2.ppf(1e-4, 32) < sum(d for _, d, _ in found) < chi2.ppf(1 - 1e-4, 32)
    assert sum(sum(inside.values()) for inside, _, _ in found) >= 24


def test_the_estimate_is_that_of_linear_theory_under_noise():
    """Of four random arms by a data sheet's sensors: least squares about the truth, without a search; its coverage is
    then that of the intervals, whatever the number of samples."""
    for k in range(4):
        arm, motion, rng = campaign.drawn(0, k)
        plant, read = arm.vary(*campaign.PARAMETERS), campaign.readings(arm, motion, rng)
        start = dict(zip(plant.varied, plant.nominal_parameters * rng.uniform(0.8, 1.2, 4)))
        found = identify(plant, Experiment(t=motion.t, u=motion.u, measured=read), start=start)
        exact = Experiment(t=motion.t, u=motion.u, measured={s: motion[s] for s in read})
        problem, _ = stated("test", plant, exact, {}, None, None)
        slopes = problem.play(problem.start, 0).slopes
        off, error = campaign.linear_estimate(slopes, np.column_stack([read[s] - motion[s] for s in read]))
        value, errors = (np.array(list(d.values())) for d in (found.values, found.standard_errors))
        assert errors == pytest.approx(error * problem.space.scale, rel=5e-3)
        assert np.abs(((value - plant.nominal_parameters) / problem.space.scale - off) / error).max() < 0.01
