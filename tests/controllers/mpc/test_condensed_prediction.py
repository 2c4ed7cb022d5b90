"""The condensed prediction: conditioned far better in v = u + K x than in u."""

import numpy as np

from pliant.controllers import riccati
from pliant.controllers.mpc.condensed_prediction import laws
from pliant.envs import scenes


def test_hessian_before_and_after_prestabilisation():
    """The arm of two-link-reach over 40 steps: in the inputs u, and in v = u + K x, where it is block diagonal."""
    scene = scenes.get("two-link-reach")
    model = scene.plant.linearize(*scene.target).discretize(scene.dt)
    weight, effort, _ = (scene.dt * M for M in scene.quadratic())
    P = riccati.dlqr(model.A, model.B, weight, effort).P
    nx, nu, N = 12, 2, 40
    reach, square = np.zeros((nx, N * nu)), np.kron(np.eye(N), effort)
    for j in range(N):
        reach = model.A @ reach
        reach[:, j * nu : (j + 1) * nu] = model.B
        square += reach.T @ (P if j == N - 1 else weight) @ reach
    many = [np.broadcast_to(M, (N, *M.shape)) for M in (model.A, model.B, np.zeros(nx), weight, effort)]
    roots = laws(*many, np.zeros((N, nx, nu)), P).root
    assert np.linalg.cond(square) > 500
    assert np.linalg.cond(roots[0].T @ roots[0]) < 30
    np.testing.assert_allclose(roots, np.broadcast_to(roots[0], roots.shape), rtol=1e-8, atol=1e-10)
