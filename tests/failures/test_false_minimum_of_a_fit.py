"""A fit from a wrong start ends in a false minimum, and its own formula calls it sure."""

import numpy as np
from scipy.optimize import least_squares
from springs import Spring

from pliant.plants import Experiment, identify

T = np.linspace(0.0, 15.0, 751)
SIGMA = 0.01
SPRING = Spring(damping=0.05)
MOTION = SPRING.simulate((1.0, 0.0), None, T)
READ = Experiment.of(MOTION, signals=("place",), noise={"place": SIGMA}, seed=2)
PLANT = SPRING.vary("stiffness")
WRONG, BOUNDS = {"stiffness": 65.0}, {"stiffness": (10.0, 200.0)}


def naive(mass=2.0, damping=0.05):
    """Least squares on the motion, with the textbook's standard error s^2 (J'J)^-1: (value, error)."""

    def residual(stiffness):
        a, w = damping / (2 * mass), np.sqrt(stiffness[0] / mass - (damping / (2 * mass)) ** 2)
        return np.exp(-a * T) * (np.cos(w * T) + a / w * np.sin(w * T)) - READ.measured["place"]

    found = least_squares(residual, [WRONG["stiffness"]], bounds=BOUNDS["stiffness"])
    return found.x[0], np.sqrt(2 * found.cost / (len(T) - 1) / (found.jac.T @ found.jac).item())


def test_the_naive_fit_is_sure_of_a_false_minimum() -> None:
    value, error = naive()
    assert abs(value - 50.0) > 5.0 and 1.96 * error < abs(value - 50.0) / 2


def test_pliant_claims_no_interval_there_and_says_why() -> None:
    found = identify(PLANT, READ, start=WRONG, bounds=BOUNDS)
    assert abs(found.values["stiffness"] - 50.0) > 5.0
    assert not found.trusted and set(found.intervals.values()) == {(-np.inf, np.inf)}
    assert any("a false minimum" in words for words in found.doubts)


def test_several_tries_within_bounds_find_the_truth() -> None:
    found = identify(PLANT, READ, start=WRONG, bounds=BOUNDS, tries=12)
    low, high = found.intervals["stiffness"]
    assert found.trusted and low < 50.0 < high and high - low < 1.0


def test_a_naive_inverse_hides_what_a_free_motion_cannot_tell() -> None:
    """Two of mass, damping and stiffness show in a free motion. With rounding as the only curvature, J'J has an
    inverse, or a Levenberg damping does, and a number comes out; here the three are named.
    """
    found = identify(SPRING.vary("mass", "damping", "stiffness"), READ)
    (group,) = found.unidentifiable
    assert set(group.names) == {"mass", "damping", "stiffness"} and group.standard_deviation == np.inf
    assert all(np.isinf(found.intervals[name]).all() for name in group.names)
