"""The quadratic program with soft rows against IPOPT on the same problem with explicit violations."""

import casadi as ca
import numpy as np
import pytest

from pliant.controllers.solvers.daqp_model import CURVATURE
from pliant.controllers.solvers.soft_qp import SoftProgram

N, M, PENALTY = 10, 8, 100.0


def problem(seed: int, shift: float = 0.0):
    """H, f, Z and the bounds of the rows; `shift` moves the first row's out of reach."""
    rng = np.random.default_rng(seed)
    W = rng.standard_normal((20, N))
    Z = rng.standard_normal((M, N)) * rng.uniform(0.2, 3.0, (M, 1))
    middle = shift * np.eye(M)[0]
    return W.T @ W, 5 * rng.standard_normal(N), Z, middle - 0.1, middle + 0.1


def with_violations(H, f, Z, low, high) -> tuple[np.ndarray, np.ndarray]:
    """d and s of min 1/2 d'Hd + f'd + PENALTY (s + CURVATURE s^2 / 2), |d| <= 1, low - s <= Z d <= high + s."""
    d, s = ca.SX.sym("d", N), ca.SX.sym("s", M)
    cost = ca.bilin(H, d, d) / 2 + ca.dot(f, d) + PENALTY * (ca.sum1(s) + CURVATURE * ca.sumsqr(s) / 2)
    rows = ca.vertcat(Z @ d - s, Z @ d + s)
    options = {"print_time": False, "ipopt": {"print_level": 0, "tol": 1e-12, "bound_relax_factor": 0.0, "sb": "yes"}}
    solver = ca.nlpsol("reference", "ipopt", {"x": ca.vertcat(d, s), "f": cost, "g": rows}, options)
    far = np.full(M, np.inf)
    found = solver(
        lbg=np.r_[-far, low],
        ubg=np.r_[high, far],
        lbx=np.r_[-np.ones(N), np.zeros(M)],
        ubx=np.r_[np.ones(N), far],
    )["x"]
    assert solver.stats()["success"]
    return tuple(np.split(np.array(found).ravel(), [N]))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("shift", [0.0, 2.0, 30.0])
def test_equals_the_program_with_violations(seed: int, shift: float) -> None:
    H, f, Z, low, high = problem(seed, shift)
    program = SoftProgram(N, M, penalty=PENALTY)
    program.prepare(H, Z)
    d = program.solve(f, -np.ones(N), np.ones(N), low, high)
    want, s = with_violations(H, f, Z, low, high)
    np.testing.assert_allclose(d, want, atol=1e-7)
    np.testing.assert_allclose(program.excess, s, atol=1e-7)
    assert program.violation == pytest.approx(s.max(), abs=1e-7)
    if shift == 30.0:  # past what |d| <= 1 can reach
        assert program.violation > 1.0


def test_solving_again_gives_the_same_from_any_warm_start() -> None:
    program = SoftProgram(N, M, penalty=PENALTY)
    H, f, Z, low, high = problem(0)
    far = np.full(M, 1e3)
    box = -np.ones(N), np.ones(N)
    program.prepare(H, Z)
    first = program.solve(f, *box, low, high)
    assert program.near and program.limited
    loose = program.solve(f, *box, -far, far)
    assert not program.near and np.abs(loose - first).max() > 1e-3
    np.testing.assert_allclose(program.solve(f, *box, low, high), first, atol=1e-9)
    other = problem(1)
    program.prepare(other[0], other[2])
    program.solve(other[1], *box, *other[3:])
    program.prepare(H, Z)
    np.testing.assert_allclose(program.solve(f, *box, low, high), first, atol=1e-9)


def test_no_solution_is_said() -> None:
    H, f, Z, low, high = problem(0)
    program = SoftProgram(N, M, penalty=PENALTY, iteration_limit=0)
    program.prepare(H, Z)
    assert program.solve(f, -np.ones(N), np.ones(N), low, high) is None and program.status == -4
    program = SoftProgram(N, M, penalty=PENALTY)
    program.prepare(H, Z)
    assert program.solve(f, np.ones(N), -np.ones(N), low, high) is None and program.status == -1
    assert program.solve(f, -np.ones(N), np.ones(N), low, high) is not None


def test_what_settles_forgets_the_last_solutions_limits() -> None:
    H, f, Z, low, high = problem(0)
    program = SoftProgram(N, M, penalty=PENALTY)
    program.prepare(H, Z)
    assert program.solve(f, np.full(N, -1e-3), np.full(N, 1e-3), low, high) is not None and program.limited
    program.settle()
    assert not program.limited and program.status == 1 and not program.multipliers.any()
