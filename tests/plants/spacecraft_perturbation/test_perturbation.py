"""The paper's model against differentiation, the plant and its motions."""

import dataclasses

import casadi as ca
import numpy as np
import pytest
from craft_cases import TEXTBOOK, craft, deviations, motor_hinged, random_nominal, slew
from scipy.interpolate import CubicSpline

from pliant.plants import SingleLinkArm, Trajectory
from pliant.plants.core.quaternions import matrix_of, rates, skew
from pliant.plants.linear.piecewise_ltv import linearize_pieces
from pliant.plants.spacecraft_parts.appendage import Hinge
from pliant.plants.spacecraft_parts.hub import Wheel
from pliant.plants.spacecraft_perturbation.perturbation import RigidNominal, perturbation


def by_differentiation(made, x, a):
    """A, B, C, Q of the nonlinear residual in the deviations of the paper, in the order of `perturbation`.

    The plant's rows for the hub are in its perturbed axes: force rows turn with q; for a turn, the row of q is
    (1 + q~/2) times the torque in perturbed axes, since q is the vector of a finite turn.
    """
    t, sx, u, w, p = made.symbols
    n, at = 6 + len(made.coordinates), made.layout
    sa = ca.SX.sym("a", n)
    r = made._residual.function(t, sx, u, w, p, sa)[0]
    f = ca.Function("f", [sx, sa, u, w, p], [r, ca.jacobian(r, sx), ca.jacobian(r, sa)])
    r0, rx, ra = (np.array(v) for v in f(x, a, np.zeros(made.nu), np.zeros(made.nw), []))
    R, omega = matrix_of(x[at.quaternion]), x[at.omega]
    X0, X1, A0, A1, A2 = np.zeros((made.nx, n)), np.zeros((made.nx, n)), np.zeros((n, n)), np.zeros((n, n)), np.eye(n)
    X0[at.quaternion, 3:6], X0[at.omega, 3:6], X1[at.omega, 3:6] = rates(x[at.quaternion]) / 2, skew(omega), np.eye(3)
    X0[at.quaternion.stop + np.arange(n - 6), 6 + np.arange(n - 6)] = 1.0
    X1[at.rates + np.arange(n - 6), 6 + np.arange(n - 6)] = 1.0
    A2[:3, :3], A0[:3, 3:6], A1[3:6, 3:6], A0[3:6, 3:6] = R.T, skew(a[:3]), skew(omega), skew(a[3:6])
    A, B, C = ra @ A2, ra @ A1 + rx @ X1, ra @ A0 + rx @ X0
    C[3:6, 3:6] -= skew(r0[3:6, 0]) / 2
    C[:3, 3:6] -= skew(r0[:3, 0])
    turn = np.eye(n)
    turn[:3, :3] = R
    order = [k for i in range(len(made.appendages)) for k in at.unknowns(i)] + [3, 4, 5, 0, 1, 2]
    return [*((turn @ M)[np.ix_(order, order)] for M in (A, B, C)), -(turn @ r0[:, 0])[order]]


@pytest.mark.every(3)
@pytest.mark.parametrize("kinematics", ["linear", "stiffened", "rigid"])
@pytest.mark.parametrize("freedoms", [(0,), (1,), (2,), (3,), (0, 3), (1, 2)], ids=str)
def test_equals_differentiation_at_random_nominals(kinematics, freedoms):
    made = craft(kinematics, freedoms)
    for seed in range(3):
        x, a, nominal = random_nominal(made, seed)
        model = perturbation(made, nominal)
        for name, wanted in zip("ABCQ", by_differentiation(made, x, a)):
            np.testing.assert_allclose(getattr(model, name)[0], wanted, atol=1e-12 * np.abs(wanted).max(), err_msg=name)


def test_blocks_by_name():
    made = craft("linear", (1, 2))
    model = perturbation(made, random_nominal(made)[2])
    assert model.block("A_11").shape == (1, 3, 3)
    assert model.block("B_1m").shape == (1, 3, 6)
    assert model.block("C_m2").shape == (1, 6, 4)
    assert model.block("Q_m").shape == (1, 6)
    np.testing.assert_array_equal(model.block("A_12"), 0.0)  # appendages do not touch
    np.testing.assert_array_equal(model.block("B_mm")[:, :, 3:], 0.0)  # p is inertial
    np.testing.assert_array_equal(model.block("C_1m")[:, :, 3:], 0.0)
    np.testing.assert_allclose(model.block("A_1m"), model.block("A_m1").swapaxes(1, 2), atol=1e-13)
    with pytest.raises(ValueError, match=r"block 'A_13' must be A_, B_, C_ with two of, or Q_ with one of 1, 2, m"):
        model.block("A_13")


def with_torques(made, motion):
    """The slew with the hub and hinge torques that carry it, taken from the rigid plant."""
    rigid = dataclasses.replace(made, kinematics="rigid", translation=False)
    at, short = made.layout, rigid.layout
    x = np.zeros((len(motion.t), rigid.nx))
    for a, b in [
        (at.quaternion, short.quaternion),
        (at.omega, short.omega),
        *zip(at.hinges, short.hinges),
        *zip(at.hinge_rates, short.hinge_rates),
    ]:
        x[:, b] = motion.x[:, a]
    want = np.column_stack([motion.dx[:, at.omega], *(motion.dx[:, s] for s in at.hinge_rates)])
    rows = np.r_[short.omega.start : rigid.nx]
    u = []
    for k in range(len(motion.t)):
        free, B = rigid.dynamics(x[k]), rigid.jacobians(x[k])[1]
        u.append(np.linalg.solve(B[rows], want[k] - free[rows]))
    moved = Trajectory.from_arrays(motion.t, motion.x, np.array(u), plant=made, dx=motion.dx)
    return moved


@pytest.mark.campaign
def test_error_falls_with_the_square_about_a_slewing_rigid_nominal():
    """A rigid nominal of fixed size; the stiffer the booms, the smaller the deviations and, squared, the error of
    the LTV model. Linearised at the accelerations that the plant would have there, it is a hundred times larger.
    """
    t, sizes, errors = np.linspace(0, 8, 241), [], []
    for factor in (4.0, 8.0, 16.0, 32.0):
        made = motor_hinged(factor)
        nominal = with_torques(made, slew(made, t))
        model = made.linearize_along(nominal)
        assert np.abs(model.c).max() > 0.01  # the nominal does not satisfy the flexible equations
        u = CubicSpline(t, nominal.u)
        run = made.simulate(nominal.x[0], lambda s, u=u: u(s), t, rtol=1e-9)
        true, linear = deviations(made, nominal, run.x), model.simulate(np.zeros(made.nx - 1))[0]
        n = (made.nx - 1) // 2
        sizes.append(np.abs(true[:, :n]).max())
        errors.append(np.abs(true - linear)[:, :n].max())
    slope = np.polyfit(np.log(sizes), np.log(errors), 1)[0]
    assert slope == pytest.approx(2, abs=0.1)
    assert errors[-1] < 0.002 * sizes[-1]
    own = made.jacobians(nominal.x, nominal.u, t=t)
    A, B, E, *_ = made.small.model(nominal.x, nominal.dx, own)
    other = dataclasses.replace(model, A=A, B=B, E=E).simulate(np.zeros(made.nx - 1))[0]
    assert np.abs(true - other)[:, :n].max() > 100 * errors[-1]


def test_plant_and_paper_give_one_model():
    """`linearize_along` (automatic differentiation) premultiplied by A is the paper's B and C, loads on the nominal
    apart.
    """
    made = dataclasses.replace(motor_hinged(), translation=True)
    nominal = slew(made, np.linspace(0, 3, 7))
    model, paper = made.linearize_along(nominal), perturbation(made, nominal)
    n = (made.nx - 1) // 2
    order = [k for i in range(2) for k in made.layout.unknowns(i)] + [3, 4, 5, 0, 1, 2]
    mass = np.zeros_like(paper.A)
    for k in range(7):
        mass[k][np.ix_(order, order)] = paper.A[k]
    second = model.second_order(mass)
    assert second.coordinates == model.states[:n]
    pick = np.ix_(range(7), order, order)
    np.testing.assert_allclose(second.B[pick], paper.B, atol=1e-10 * np.abs(paper.B).max())
    np.testing.assert_allclose(second.Q[:, order], paper.Q, atol=1e-10 * np.abs(paper.Q).max())
    # the paper's rows are of q as a finite turn and of fixed axes: they differ by the turned residual, which is -Q
    wanted, n = paper.C.copy(), len(order)
    q, p = slice(n - 6, n - 3), slice(n - 3, n)
    R = matrix_of(nominal.x[:, made.layout.quaternion])
    wanted[:, q, q] -= skew(paper.Q[:, q]) / 2
    wanted[:, p, q] -= skew(paper.Q[:, p]) @ R
    np.testing.assert_allclose(second.C[pick], wanted, atol=1e-10 * np.abs(paper.C).max())


def test_steady_spin_has_the_plants_roots():
    at = TEXTBOOK.state(rate_x=0.1)
    t = np.linspace(0, 1, 3)
    quaternion = np.column_stack([np.cos(0.05 * t), np.sin(0.05 * t), 0 * t, 0 * t])
    zero = np.zeros((3, 3))
    nominal = RigidNominal(
        t,
        quaternion,
        np.tile([0.1, 0.0, 0.0], (3, 1)),
        zero,
        zero,
        (np.zeros((3, 0)),) * 2,
        (np.zeros((3, 0)),) * 2,
        (np.zeros((3, 0)),) * 2,
    )
    roots = perturbation(TEXTBOOK, nominal).eigenvalues(1)
    wanted = TEXTBOOK.linearize(at).eigenvalues
    assert max(np.abs(wanted - z).min() for z in roots if abs(abs(z) - 0.1) > 1e-3 and abs(z) > 1e-3) < 1e-9
    assert np.abs(roots.real).max() < 1e-5  # no false growth: the second-order turn is in


def test_second_order_of_an_arm():
    arm = SingleLinkArm.textbook()
    t = np.linspace(0, 1, 11)
    run = arm.simulate(np.array([0.1, 0.01, 0.0, 0.5, 0.0, 0.0]), None, t)
    model = arm.linearize_along(run)
    form = model.second_order(arm.mass_matrix(run.x))
    np.testing.assert_allclose(form.A, arm.mass_matrix(run.x))
    np.testing.assert_allclose(form.first_order()[0], model.A, atol=1e-8 * np.abs(model.A).max())
    np.testing.assert_allclose(
        np.sort_complex(form.eigenvalues(3)), np.sort_complex(model.at(3).eigenvalues), atol=1e-5
    )
    hub = dataclasses.replace(TEXTBOOK.hub, wheels=(Wheel(axis=(1.0, 0, 0), inertia=0.1),))
    made = dataclasses.replace(TEXTBOOK, hub=hub)
    with pytest.raises(ValueError, match="must be coordinates and then their rates"):
        made.linearize_along(made.simulate(made.state(), None, [0.0, 0.1, 0.2, 0.3])).second_order()


def test_without_translation_the_hub_moves_as_the_whole_asks():
    """The paper's force on the whole is then balanced: its Q of p is zero."""
    made = dataclasses.replace(motor_hinged(), translation=False)
    nominal = slew(made, np.linspace(0, 3, 7))
    assert np.abs(perturbation(made, nominal).Q[:, -3:]).max() < 1e-9
    assert np.abs(RigidNominal.of(made, nominal).acceleration).max() > 1e-3


def flat(made, q, t=(0.0, 0.1, 0.2, 0.3), dx=None):
    x = np.tile(made.state(), (4, 1))
    x[:, made.layout.quaternion] = q
    return Trajectory.from_arrays(np.array(t), x, np.zeros((4, made.nu)), plant=made, dx=dx)


FLIP = np.array([[1.0, 0, 0, 0], [1.0, 0, 0, 0], [-1.0, 0, 0, 0], [-1.0, 0, 0, 0]])
TURNED = np.tile([np.cos(0.5), np.sin(0.5), 0.0, 0.0], (4, 1))
BAD = {
    "long quaternion": (
        lambda: TEXTBOOK.linearize_along(flat(TEXTBOOK, 1.3 * np.abs(FLIP))),
        r"the quaternion has norm 1\.3, must be 1",
    ),
    "flipped quaternion": (
        lambda: TEXTBOOK.linearize_along(flat(TEXTBOOK, FLIP)),
        r"the quaternion changes its sign at t = 0\.2 s",
    ),
    "jump of the attitude": (
        lambda: linearize_pieces(
            TEXTBOOK, [flat(TEXTBOOK, np.abs(FLIP)), flat(TEXTBOOK, TURNED, (0.3, 0.4, 0.5, 0.6))]
        ),
        r"the attitude jumps by 1 rad at t = 0\.3 s",
    ),
    "no pieces": (lambda: linearize_pieces(TEXTBOOK, []), r"nominals = \(\) must be one or more pieces"),
    "driven hinge": (
        lambda: perturbation(
            dataclasses.replace(
                TEXTBOOK,
                appendages=(
                    dataclasses.replace(TEXTBOOK.appendages[0], hinge=Hinge(axes=((0.0, 1.0, 0.0),), drive="motion")),
                ),
            ),
            None,
        ),
        'hinges with drive = "motion" are prescribed',
    ),
    "shape": (
        lambda: RigidNominal([0.0], np.ones((1, 3)), *np.zeros((3, 1, 3))),
        r"RigidNominal\.quaternion has shape \(1, 3\)",
    ),
    "norm": (
        lambda: RigidNominal([0.0], np.ones((1, 4)), *np.zeros((3, 1, 3))),
        r"RigidNominal\.quaternion has norm 2, must be 1",
    ),
    "hinges": (
        lambda: perturbation(craft("linear", (1,)), RigidNominal([0.0], [[1.0, 0, 0, 0]], *np.zeros((3, 1, 3)))),
        r"RigidNominal\.angles has columns \(\), must have \(1,\)",
    ),
    "elastic": (
        lambda: perturbation(TEXTBOOK, TEXTBOOK.simulate(TEXTBOOK.state(eta1_1=0.1), None, [0.0, 0.1])),
        "must be zero: the nominal is a rigid motion",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input(name):
    make, words = BAD[name]
    with pytest.raises(ValueError, match=words):
        make()
