"""Nodes of a nominal that cannot show what A does: a period of it apart, or a pulse between two of them.

From the nodes alone A is constant, and the verdict that of a pendulum whose pivot does not shake. `linearize_along`
looks between the nodes and keeps what it finds (`finer`), on which stability is judged.
"""

import pickle
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pliant.plants import FlexibleSpacecraft, Plant, Signal, Trajectory
from pliant.plants.stability import assess, growth


@dataclass(frozen=True, kw_only=True)
class Shaken(Plant):
    """phi'' + 2 d phi' + (1 + depth f(t)) sin(phi) = 0: a hanging pendulum whose pivot shakes, [1/s^2] over gravity."""

    depth: float = 0.6
    damping: float = 0.02
    pulse: bool = False

    states = (Signal("angle", "rad"), Signal("angle_rate", "rad/s"))
    inputs = disturbances = outputs = ()
    label = "shaken pendulum"

    def stiffness(self, t, of=ca):
        shape = of.exp(-(((t - 5.1) / 0.2) ** 2)) if self.pulse else of.cos(2 * t)
        return 1.0 + self.depth * shape

    def ode(self, t, x, u, w):
        return ca.vertcat(x[1], -self.stiffness(t) * ca.sin(x[0]) - 2 * self.damping * x[1])

    def output(self, t, x, u, w):
        return ca.SX(0, 1)

    def ladder(self):
        return (self,)


def at_rest(plant, t):
    still = np.zeros((len(t), 2))
    return Trajectory.from_arrays(t, still, np.zeros((len(t), 0)), plant=plant, dx=still)


def transition(plant, end):
    """The transition matrix (2, 2) from 0 to `end` by Dormand and Prince's method of order 8 at 1e-12."""

    def rate(t, y):
        A = np.array([[0.0, 1.0], [-plant.stiffness(t, np), -2 * plant.damping]])
        return (A @ y.reshape(2, 2)).ravel()

    run = solve_ivp(rate, (0.0, end), np.eye(2).ravel(), method="DOP853", rtol=1e-12, atol=1e-14, max_step=0.05)
    return run.y[:, -1].reshape(2, 2)


def test_nodes_a_period_apart():
    plant = Shaken()
    size = np.abs(np.linalg.eigvals(transition(plant, np.pi))).max()
    assert size > 1.3  # in the first tongue of Mathieu's equation
    t = np.pi * np.arange(13)
    model = plant.linearize_along(at_rest(plant, t))
    assert np.ptp(model.A, axis=0).max() < 1e-12 and (model.t == t).all()  # what was asked for
    assert assess(replace(model, between=None)).verdict == "stable"  # the naive way: wrong
    assert model.finer is not None and np.isin(t, model.finer.t).all()
    np.testing.assert_allclose(model.finer.A[:, 1, 0], -plant.stiffness(model.finer.t, np), atol=1e-12)
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(model)).finer.A, model.finer.A)
    found = assess(model, period=np.pi)
    assert found.verdict in ("unstable", "undecided")
    if found.verdict == "undecided":
        assert "more nodes" in found.why
    fine = plant.linearize_along(at_rest(plant, np.linspace(0.0, np.pi, 41)))
    assert fine.finer is None
    best = assess(fine, period=np.pi)
    assert best.verdict == "unstable"
    assert abs(np.abs(best.evidence["floquet"].multipliers).max() - size) < 1e-4


def test_a_pulse_between_two_nodes():
    """It turns the pendulum over: growth e^4 within 1.5 s, between nodes at rest 2 s apart."""
    plant = Shaken(pulse=True, depth=-40.0)
    t = np.linspace(0.0, 12.0, 7)
    model = plant.linearize_along(at_rest(plant, t))
    true = np.linalg.norm(transition(plant, 12.0), 2)
    naive, found = growth(replace(model, between=None), scale=(1.0, 1.0)), growth(model, scale=(1.0, 1.0))
    assert naive.total < 1.2 < 10 < true
    assert abs(found.total / true - 1) < 0.5
    dense = plant.linearize_along(at_rest(plant, np.linspace(0.0, 12.0, 241)))
    assert dense.finer is None and growth(dense, scale=(1.0, 1.0)).total == pytest.approx(true, rel=1e-3)
    assert replace(dense, A=2 * dense.A).finer is None
    assert replace(model, A=2 * model.A).finer is None  # what was found belongs to another A


def test_a_craft_that_turns_between_its_nodes():
    """Half a turn between two nodes: the quaternion is of unit length between them too."""
    craft = replace(FlexibleSpacecraft.textbook(), kinematics="rigid")
    t = np.linspace(0.0, 6.0, 7)
    x = np.zeros((7, craft.nx))
    q = craft.layout.quaternion
    angle = np.pi / 3 * t
    x[:, q.start], x[:, q.start + 3] = np.cos(angle / 2), np.sin(angle / 2)
    x[:, craft.layout.omega][:, 2] = np.pi / 3
    nominal = Trajectory.from_arrays(t, x, plant=craft)
    model = craft.linearize_along(nominal)
    assert (model.t == t).all()
    between = nominal.resample(t[:-1] + 0.4)
    assert np.abs(np.linalg.norm(between.x[:, q], axis=1) - 1).max() > 1e-4  # the naive way
    np.testing.assert_allclose(np.linalg.norm(craft.consistent(between.x)[:, q], axis=1), 1.0, atol=1e-15)


def test_a_model_that_is_no_more_of_its_motion_keeps_its_nodes():
    """Moved in time, of fewer states, or with an entry that was changed by little beside the largest."""
    model = Shaken().linearize_along(at_rest(Shaken(), np.pi * np.arange(13)))
    assert model.finer is not None
    assert replace(model, t=model.t + 1.0).finer is None
    one = {name: getattr(model, name)[:, :1] for name in ("B", "E", "c", "x")}
    assert replace(model, A=model.A[:, :1, :1], C=model.C[:, :, :1], states=model.states[:1], **one).finer is None
    A = model.A.copy()
    A[:, 0, 0] += 1e-9
    assert replace(model, A=A).finer is None


def test_an_angle_that_is_set_back_by_whole_turns():
    """It goes through no other angles between the two nodes; naively from pi to -pi through zero."""
    plant, t, rate = Shaken(depth=0.0), np.linspace(0.0, 4.0, 41), np.pi
    angle = (rate * t + np.pi + 1e-6) % (2 * np.pi) - np.pi
    x = np.column_stack([angle, np.full(41, rate)])
    nominal = Trajectory.from_arrays(t, x, np.zeros((41, 0)), plant=plant, dx=x[:, 1:] * [1.0, 0.0])
    assert np.abs(np.diff(angle)).max() > 5
    model = plant.linearize_along(nominal)
    assert np.abs(-np.cos(nominal.resample(t[:-1] + 0.05).x[:, 0]) + np.cos(rate * (t[:-1] + 0.05))).max() > 1  # naive
    assert model.finer is None


@pytest.mark.parametrize("signs", [False, True])
def test_what_the_motion_between_nodes_misses_is_not_taken_for_a(signs):
    """A craft that spins steadily, 12 degrees from node to node: between these a cubic misses its turning by 5e-6,
    whatever sign its quaternions are given with. It is marginal in all that moves.
    """
    craft = replace(FlexibleSpacecraft.textbook(), kinematics="rigid")
    t, at = np.linspace(0.0, 12.0, 62), craft.layout
    x = np.zeros((62, craft.nx))
    x[:, at.quaternion.start], x[:, at.quaternion.start + 3] = np.cos(np.pi / 6 * t), np.sin(np.pi / 6 * t)
    x[:, at.omega][:, 2] = np.pi / 3
    dx = craft.dynamics(x)
    dx[:, at.omega] = 0.0
    if signs:
        x[20:45, at.quaternion] *= -1
        dx[20:45, at.quaternion] *= -1
    model = craft.linearize_along(Trajectory.from_arrays(t, x, plant=craft, dx=dx))
    assert np.ptp(model.A, axis=0).max() < 1e-12 and model.finer is None
    assert assess(model, thorough=False).verdict == "marginal"
