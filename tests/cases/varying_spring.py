"""A spring that stiffens and slackens, pushed by a varying force and a moving base, with weights of its regulator."""

import numpy as np

from pliant.plants.linear.ltv import LTVModel

Q, R, N, END = np.diag([3.0, 0.5]), np.array([[0.1]]), np.array([[0.1], [0.05]]), np.diag([2.0, 1.0])


def varying(s):
    """A, B, c of a spring that stiffens and slackens, pushed by a varying force and a moving base."""
    A = np.array([[0, 1], [-4 - 2 * np.sin(3 * s), -0.2]])
    B = np.array([[0.0], [1 + 0.5 * np.cos(2 * s)]])
    return A, B, np.array([0.3 * np.sin(s), 0.5 * np.cos(2 * s)])


def along(t, parts):
    """An LTVModel of states only."""
    n, nt = len(parts[0][0]), len(t)
    A, B, c = (np.array([part[i] for part in parts]) for i in range(3))
    none = np.zeros
    return LTVModel(
        *(t, A, B, none((nt, n, 0)), none((nt, 0, n)), none((nt, 0, B.shape[2])), none((nt, 0, 0)), c),
        *(none((nt, n)), none((nt, B.shape[2])), none((nt, 0))),
        *(tuple(f"x{i}" for i in range(n)), tuple(f"u{i}" for i in range(B.shape[2])), (), ()),
    )


def spring(nodes, end=2.0):
    t = np.linspace(0.0, end, nodes)
    return along(t, [varying(s) for s in t])
