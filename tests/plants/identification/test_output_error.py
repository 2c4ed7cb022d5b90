"""Residuals and their slopes, condensed motion by motion."""

import numpy as np
import pytest
from springs import NOISE, VARIED, pushed

from pliant.plants import Experiment
from pliant.plants.experiments.experiment import checked
from pliant.plants.identification.output_error import OutputError
from pliant.plants.identification.parameter_space import ParameterSpace


def problem(*motions):
    found = [checked(VARIED, motion, f"identify.motions[{k}]", k) for k, motion in enumerate(motions)]
    return OutputError(VARIED, found, ParameterSpace.of("identify", VARIED, None, None))


@pytest.fixture(scope="module")
def two():
    """A motion from an unknown start, and one with missing samples."""
    first, second = pushed(1.0, unknown="all"), pushed(1.5, seed=1)
    gaps = {
        name: np.where(np.arange(len(c)) % 3 == k, np.nan, c) for k, (name, c) in enumerate(second.measured.items())
    }
    return problem(first, Experiment(t=second.t, u=second.u, measured=gaps, start=second.start))


def dense(found, z):
    """The whole residual and its Jacobian by central differences, in standard deviations."""

    def r(at):
        parts = [((p.residual) / list(NOISE.values())).ravel() for p in found.play_all(at)]
        return np.concatenate([p[~np.isnan(p)] for p in parts])

    h = (3 * np.finfo(float).eps) ** (1 / 3)
    return r(z), np.column_stack([(r(z + h * e) - r(z - h * e)) / (2 * h) for e in np.eye(len(z))])


def test_the_triangle_is_that_of_the_whole_jacobian(two):
    z = two.start + np.array([0.1, -0.2, 0.1, 0.01, -0.02])
    r, J = dense(two, z)
    found = two.linearised(two.play_all(z), NOISE)
    assert np.abs(found.R.T @ found.R - J.T @ J).max() < 1e-6 * np.abs(J.T @ J).max()
    assert np.abs(found.R.T @ found.r - J.T @ r).max() < 1e-6 * np.abs(J.T @ r).max()
    assert found.cost == pytest.approx(r @ r / 2, rel=1e-12) and len(r) == two.samples


def test_information_is_what_is_left_when_starts_are_eliminated(two):
    _, J = dense(two, two.start)
    R = two.information(two.play_all(two.start), NOISE)
    right = np.linalg.inv(J.T @ J)[:3, :3]
    assert np.abs(np.linalg.inv(R.T @ R) / right - 1).max() < 1e-5


def test_squares_by_sensor_and_a_share_of_the_samples(two):
    squares = two.squares(two.play_all(two.start))
    assert squares["place"][1] == 51 + 76 - 26 and squares["felt"][1] == 51 + 76 - 25
    assert squares["place"][0] == pytest.approx(squares["place"][1] * NOISE["place"] ** 2, rel=0.5)
    two.share = 0.5
    assert [len(p.residual) for p in two.play_all(two.start)] == [26, 38]
    two.share = 1.0


def test_halved_steps_are_half_as_long(two):
    before = list(two.steps)
    assert two.halve() and np.allclose(two.steps, np.array(before) / 2, rtol=1e-6)
    two.steps = before


def test_a_motion_that_is_not_finite_is_none(two):
    z = two.start
    z[:3] = 1e-12, 0.0, 1e15
    assert two.play(z, 0) is None and two.play_all(z) is None
