import mpmath
import numpy as np
import pytest

from pliant.plants.rigorous import taylor_steps
from pliant.plants.rigorous.balls import flint, identity, matrix
from pliant.plants.rigorous.taylor_steps import parts, shifted, step


def ball(x):
    """An mpmath number to 60 digits."""
    return flint().arb(mpmath.nstr(x, 60))


@pytest.mark.parametrize("bits", [64, 160])
def test_airy_functions(bits):
    # y'' = t y from 0 to 2: y = a Ai(t) + b Bi(t); mpmath at 60 digits
    with flint().ctx.workprec(bits), mpmath.workdps(60):
        zero = matrix(np.zeros((2, 2)))
        A = [matrix(np.array([[0.0, 1.0], [0.0, 0.0]])), matrix(np.array([[0.0, 0.0], [1.0, 0.0]])), zero, zero]
        h = flint().arb(2)
        count = parts(A, h)
        Phi = identity(2)
        for k in range(count):
            Phi = step(shifted(A, h / count * k), h / count) * Phi
        W = [
            mpmath.matrix([[f(t, derivative=d) for f in (mpmath.airyai, mpmath.airybi)] for d in (0, 1)])
            for t in (0, 2)
        ]
        truth = W[1] * W[0] ** -1
        for i in range(2):
            for j in range(2):
                assert Phi[i, j].overlaps(ball(truth[i, j]))
                assert Phi[i, j].rad() < 2.0 ** (12 - bits)


def test_scalar_with_a_cubic_rate():
    # dz/dt = (1 - 2 t + 3 t^2 - 4 t^3) z: z(1) = exp(1 - 1 + 1 - 1) z(0)
    with flint().ctx.workprec(128):
        Phi = step([matrix(np.array([[c]])) for c in (1.0, -2.0, 3.0, -4.0)], flint().arb(1))
        assert Phi[0, 0].contains(flint().arb(1)) and Phi[0, 0].rad() < 1e-33


def test_shift():
    with flint().ctx.workprec(128):
        A = [matrix(np.array([[c]])) for c in (1.0, -2.0, 3.0, -4.0)]
        at = [float(a[0, 0]) for a in shifted(A, flint().arb(0.5))]  # p, p', p''/2, p'''/6 at 1/2
    assert at == [0.25, -2.0, -3.0, -4.0]


def test_the_remainder_of_few_terms(monkeypatch):
    # e = 1 + 1 + 1/2 + 1/6 + ..: what four terms leave is inside, and hardly more
    monkeypatch.setattr(taylor_steps, "MOST_TERMS", 3)
    zero = matrix(np.zeros((1, 1)))
    with flint().ctx.workprec(100):
        Phi = step([matrix(np.eye(1)), zero, zero, zero], flint().arb(1))
        e = flint().arb(1).exp()
        assert Phi[0, 0].contains(e) and Phi[0, 0].rad() < 1.0001 * (e - 8 / flint().arb(3)).upper()
