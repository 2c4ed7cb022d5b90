"""Weights that are no weights, and modes that are out of reach, named by state and frequency."""

import numpy as np
import pytest

from pliant.controllers import riccati
from pliant.controllers.riccati.checks import known_names, require_reached, system, weight_matrix
from pliant.plants import UncontrollableError


def test_a_mode_that_stays_and_is_not_reached_is_named():
    """Two oscillators at 1 and 2 Hz without damping, of which the force pushes the first."""
    w = 2 * np.pi * np.array([1.0, 2.0])
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.diag(w**2), np.zeros((2, 2))]])
    names = ("a", "b", "a_rate", "b_rate")
    with pytest.raises(UncontrollableError, match=r"mode 2\.00 Hz \(b") as caught:
        require_reached(A, np.array([[0.0], [0.0], [1.0], [0.0]]), names, None, "cannot be reached")
    assert len(caught.value.args[0].split(",")) == 1
    require_reached(A - 0.1 * np.eye(4), np.zeros((4, 1)), names, None, "cannot be reached")  # what decays need not be


def test_shapes_names_and_signs():
    assert known_names(None, 2) == ("x1", "x2")
    for call, message in (
        (lambda: known_names(("a",), 2), "must be 2 names"),
        (lambda: system(np.eye(2), np.ones((3, 1))), "B has shape"),
        (lambda: weight_matrix("Q", [[1.0, 2.0], [0.0, 1.0]], 2, definite=False), "must equal"),
        (lambda: weight_matrix("Q", -np.eye(2), 2, definite=False), "must be >= 0"),
        (lambda: weight_matrix("R", np.zeros((1, 1)), 1, definite=True), "must be > 0"),
    ):
        with pytest.raises(ValueError, match=message):
            call()


@pytest.mark.parametrize("name", ["A", "B", "Q", "R", "N"])
def test_entries_whose_products_are_no_numbers_are_refused_by_name(name):
    """The naive way ends in "SVD did not converge", or in "array must not contain infs or NaNs"."""
    given = {"A": np.eye(2), "B": np.eye(2), "Q": np.eye(2), "R": np.eye(2), "N": np.zeros((2, 2))}
    for design in (riccati.lqr, lambda **k: riccati.sampled(**k, dt=0.1)):
        with pytest.raises(ValueError, match=rf"{name} = .* at most 1e\+75 in size"):
            design(**given | {name: np.full((2, 2), 1e140)})
