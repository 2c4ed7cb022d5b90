"""Which motion tells most: criteria of known matrices, a published design, and what intervals then show."""

import numpy as np
import pytest
from springs import GONE, NOISE, SPRING, VARIED, Runaway, pushed

from pliant.plants import Experiment, IntegrationError, identify, rank_motions
from pliant.plants.identification.experiment_design import criteria

T = np.linspace(0.0, 20.0, 401)


def shaken(frequency, plant=SPRING):
    """The spring under a sine [rad/s] from rest."""
    return plant.simulate(np.zeros(2), np.sin(frequency * T)[:, None], T)


def named(frequency):
    motion = Experiment.of(shaken(frequency), signals=("place",))
    return Experiment(t=T, u=motion.u, measured=motion.measured, name=f"{frequency:g} rad/s")


def test_criteria_of_a_known_information():
    """F = diag(4, 100): det^(1/4) = 4.47, trace of the inverse 0.26, least eigenvalue 4."""
    found = criteria(np.diag([2.0, 10.0]))
    assert found["D"] == pytest.approx(1 / np.sqrt(20)) and found["E"] == pytest.approx(0.5)
    assert found["A"] == pytest.approx(np.sqrt(0.26 / 2))
    assert set(criteria(np.diag([2.0, 0.0])).values()) == {np.inf}


def test_a_sine_near_resonance_tells_most_of_the_stiffness():
    """|dG/dk| = 1/|k - m w^2 + i c w|^2 is largest at resonance, 5 rad/s (Goodwin and Payne, "Dynamic System
    Identification", 1977, Chapter 6: power goes where the transfer function's slope is largest).
    """
    ranking = rank_motions(SPRING.vary("stiffness"), [named(1.0), named(5.0), named(20.0)], noise={"place": 1e-3})
    assert [one.name for one in ranking.motions] == ["5 rad/s", "1 rad/s", "20 rad/s"]
    slope = [1 / abs(50 - 2 * w * w + 0.8j * w) ** 2 for w in (5.0, 1.0)]
    errors = {one.name: one.standard_errors["stiffness"] for one in ranking.motions}
    assert errors["1 rad/s"] / errors["5 rad/s"] == pytest.approx(slope[0] / slope[1], rel=0.5)
    assert "5 rad/s" in ranking.summary().splitlines()[1] and "all of them" in ranking.summary()


def test_what_is_promised_is_what_identification_then_finds():
    motion = pushed(2.0)
    promised = rank_motions(VARIED, [motion], noise=NOISE).best
    found = identify(VARIED, motion, noise=NOISE)
    for name, error in promised.standard_errors.items():
        assert found.standard_errors[name] == pytest.approx(error, rel=0.05)


def test_together_they_tell_what_none_tells_alone():
    """A sine's steady response is two numbers, three parameters need two sines; its transient tells faintly."""
    low, high = named(1.0), named(15.0)
    ranking = rank_motions(VARIED, [low, high], noise={"place": 1e-2}, criterion="A")
    assert ranking.together.criteria["A"] < 0.7 * ranking.best.criteria["A"] and ranking.together.index == -1
    free = Experiment.of(SPRING.simulate((1.0, 0.0), None, T), signals=("place",), name="free")
    alone = rank_motions(VARIED, [free], noise={"place": 1e-3}).best
    assert alone.criteria["D"] == np.inf and len(alone.unidentifiable[0].names) == 3
    assert "free: " in rank_motions(VARIED, [free], noise={"place": 1e-3}).summary()


def test_refused():
    motion = shaken(1.0)
    with pytest.raises(ValueError, match=r"rank_motions\.noise lacks felt"):
        rank_motions(VARIED, [motion], noise={"place": 1.0})
    with pytest.raises(ValueError, match=r"rank_motions\.criterion = 'T' must be one of"):
        rank_motions(VARIED, [motion], noise=NOISE, criterion="T")
    with pytest.raises(ValueError, match=r"rank_motions\.motions = \(\)"):
        rank_motions(VARIED, (), noise=NOISE)
    with pytest.raises(IntegrationError, match="gone is not finite"):
        rank_motions(Runaway().vary("stiffness"), [GONE], noise={"place": 1.0})
    with pytest.raises(ValueError, match=r"step of gone = .* steps of the 20 s"):
        rank_motions(VARIED, [GONE], noise={"place": 1.0}, start={"mass": 1e-70})
