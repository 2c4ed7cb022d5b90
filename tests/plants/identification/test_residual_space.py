"""I - H against a dense projection, with missing samples, unknown starts and several motions."""

import numpy as np
import pytest
from springs import NOISE, VARIED, pushed

from pliant.plants import Experiment
from pliant.plants.identification.output_error import stated
from pliant.plants.identification.residual_space import ResidualSpace, basis


@pytest.fixture(scope="module")
def case():
    """(space, dense Jacobian) of two motions, one of unknown start, one with a sensor that drops out."""
    one, two = pushed(0.6, unknown="all"), pushed(0.5, seed=1)
    gone = np.where(np.arange(len(two.t)) % 3 == 0, np.nan, two.measured["felt"])
    two = Experiment(t=two.t, u=two.u, measured={"place": two.measured["place"], "felt": gone})
    problem, sigma = stated("test", VARIED, [one, two], NOISE, None, None)
    played = problem.play_all(problem.start)
    rows = []
    for k, this in enumerate(played):
        for j, name in enumerate(problem.experiments[k].signals):
            known = ~np.isnan(this.residual[:, j])
            J = np.zeros((int(known.sum()), 5))
            J[:, : 3 + 2 * (k == 0)] = this.slopes[known, j] / sigma[name]
            rows.append(J)
    return ResidualSpace.of(problem.experiments, played, sigma, np.ones(3, bool)), np.vstack(rows)


def test_what_is_left_is_the_dense_projection(case):
    space, J = case
    Q = np.linalg.qr(J / np.linalg.norm(J, axis=0))[0]
    e = np.random.default_rng(0).standard_normal((4, len(J)))
    assert np.abs(space.left(e) - (e - e @ Q @ Q.T)).max() < 1e-9
    assert np.abs(space.left(J.T) / np.linalg.norm(J, axis=0)[:, None]).max() < 1e-9


def test_degrees_of_freedom_add_up_to_samples_less_unknowns(case):
    space, J = case
    Q = np.linalg.qr(J / np.linalg.norm(J, axis=0))[0]
    each = [space.freedom(name) for name in NOISE]
    assert sum(each) == pytest.approx(len(J) - 5)
    at = [i for one in space.of_signal("felt") for i in range(one.first, one.end)]
    assert each[1] == pytest.approx(len(at) - (Q[at] ** 2).sum())


def test_a_basis_is_judged_by_directions_alone():
    J = np.random.default_rng(1).standard_normal((20, 2))
    Q = basis(np.column_stack([J[:, 0], 1e12 * J[:, 1], J @ [1.0, 1e-3], np.zeros(20)]))
    assert Q.shape == (20, 2) and np.abs(Q.T @ Q - np.eye(2)).max() < 1e-12
    assert basis(np.zeros((3, 0))).shape == (3, 0)
