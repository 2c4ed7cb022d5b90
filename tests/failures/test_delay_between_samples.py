"""A delay of a part of a period: the margin read off the sampled response is not that of the loop.

A mode of 8 Hz sampled at 10 Hz looks like one of 2 Hz. The phase margin of the sampled response, as a time, says that
0.2 s are borne; a motion with inputs that act late, put together event by event, grows from 0.061 s on. Pliant tells
the shorter, and a law that leaves that mode alone holds what it says.
"""

import numpy as np
from scipy.linalg import expm

from pliant.controllers import LQR, loop, margins
from pliant.plants import LinearModel

DT = 0.1
A = np.array([[0, 1.0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 1.0], [0, 0, -2500.0, -0.5]])
B = np.array([[0.0], [1.0], [0.0], [1.0]])
PLANT = LinearModel.from_matrices(A, B)


def law(effort):
    return LQR.design(PLANT, np.diag([1, 0.1, 100.0, 0.1]), [[effort]], dt=DT)


def moves(time):
    both = expm(time * np.block([[A, B], [np.zeros((1, 5))]]))
    return both[:4, :4], both[:4, 4]


def grows(K, late, periods=4000):
    """Whether the state does, over many periods in which inputs act `late` [s] after their sample, event by event."""
    (E1, G1), (E2, G2) = moves(late), moves(DT - late)
    x, before, sizes = np.ones(4), 0.0, []
    for _ in range(periods):
        u = -float(K[0] @ x)
        x, before = E2 @ (E1 @ x + G1 * before) + G2 * u, u
        sizes.append(np.abs(x).max())
    return max(sizes[-200:]) > max(sizes[periods // 2 : periods // 2 + 200])


def naive(K):
    """The phase margin of L(e^jw) as a time [s]: the least (pi + arg L) / w where |L| = 1."""
    E, G = moves(DT)
    w = np.linspace(1e-3, np.pi / DT, 200_000)
    V = np.linalg.eig(E)
    modal = (K[0] @ V[1]) * np.linalg.solve(V[1], G.astype(complex))
    L = (modal / (np.exp(1j * w * DT)[:, None] - V[0])).sum(axis=1)
    at = np.flatnonzero(np.diff(np.sign(np.abs(L) - 1)))
    return float(((np.angle(-L[at]) % (2 * np.pi)) / w[at]).min())


def test_the_naive_margin_is_not_borne():
    K = law(0.01).K
    assert naive(K) > 0.2
    assert not grows(K, 0.05) and grows(K, 0.07)


def test_pliant_tells_the_delay_that_is():
    made = law(0.01)
    [channel] = margins(loop(PLANT, made)).channels
    assert 0.05 < channel.delay < 0.07 < naive(made.K)
    assert not grows(made.K, 0.99 * channel.delay) and grows(made.K, 1.01 * channel.delay)
    assert f"delay {channel.delay:.3g} s" in str(margins(loop(PLANT, made)))


def test_where_only_the_sampled_model_is_known_whole_periods_are_told():
    [channel] = margins(loop(PLANT.discretize(DT), law(0.01))).channels
    assert abs(channel.delay / DT - round(channel.delay / DT)) < 1e-9


def test_a_law_that_leaves_the_mode_alone_bears_what_is_asked():
    """Without a weight on the mode 0.07 s are borne, as the margin said beforehand."""
    calm = LQR.design(PLANT, np.diag([1, 0.1, 0.0, 0.0]) + 1e-9 * np.eye(4), [[1.0]], dt=DT)
    [channel] = margins(loop(PLANT, calm)).channels
    assert channel.delay > 0.07 and not grows(calm.K, 0.07)
