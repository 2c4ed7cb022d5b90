"""A craft turned by wheels keeps its total momentum: eigenvalues on the unit circle that no Riccati equation moves.

SciPy finds no solution, or one whose loop does not decay, on the whole model: the naive design. What conserves nothing
is a design of its own. By equal inertia of the wheels' axes and small wheels the loop is that of the same craft turned
by torques.
"""

import dataclasses

import numpy as np
import pytest
from scipy.linalg import LinAlgError, solve_discrete_are

from pliant.controllers import LQR, PD, TVLQR, Feedback, loop, margins, riccati, spillover
from pliant.controllers.base.objective import Objective
from pliant.controllers.linear_quadratic.period_cost import law_at_goal
from pliant.controllers.optimal_control.stage_derivatives import StageTerms
from pliant.envs import scenes
from pliant.plants import PliantError, Trajectory, UncontrollableError, Wheel
from pliant.plants.stability import assess
from pliant.studies.fidelity.mode_count import modes_needed

SLEW = scenes.get("spacecraft-slew")
WHEELS = scenes.get("spacecraft-wheels")
LIGHT = 1e-9  # [kg m^2]: what the hub loses about each axis by its wheels, beside 150


def turned_by(axes, friction=0.0, **craft):
    """spacecraft-slew with wheels in place of torques."""
    wheels = tuple(Wheel(axis=a, inertia=LIGHT, friction=friction) for a in axes)
    plant = dataclasses.replace(SLEW.plant, hub=dataclasses.replace(SLEW.plant.hub, wheels=wheels), **craft)
    effort = tuple((s.name, 0.01) for s in plant.inputs)
    return dataclasses.replace(SLEW, plant=plant, effort=effort, limits=(2.0,) * plant.nu)


AXES = ((1.0, 0, 0), (0, 1.0, 0), (0, 0, 1.0))
THREE = turned_by(AXES)


def test_naive_scipy_does_not_solve_it():
    model, (Q, R, N) = THREE.feedback_model, THREE.quadratic()
    A, B, Q, R, N = riccati.sampled(model.A, model.B, Q, R, N, dt=THREE.dt)
    try:
        P = solve_discrete_are(A, B, Q, R, s=N)
    except LinAlgError:
        pass
    else:
        K = np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A + N.T)
        assert np.abs(np.linalg.eigvals(A - B @ K)).max() > 1 - 1e-9
    with pytest.raises(UncontrollableError, match="cannot be reached"):
        riccati.dlqr(A, B, Q, R, N, dt=THREE.dt)


def test_cost_margins_and_verdict_are_those_without_wheels():
    model = THREE.feedback_model
    assert "wheel1_momentum" in model.state_names
    law = LQR.design(model, dict(THREE.weights), dict(THREE.effort), dt=THREE.dt)
    wanted = LQR.for_scene(SLEW)
    assert len(law.conserved) == 3 and law.free == () and np.abs(law.poles).max() < 1
    own = SLEW.feedback_model.state_names
    at = [model.state_names.index(name) for name in own]
    np.testing.assert_allclose(law.P[np.ix_(at, at)], wanted.P, rtol=1e-6, atol=1e-9 * np.abs(wanted.P).max())
    np.testing.assert_allclose(law.K[:, at], wanted.K, rtol=1e-6, atol=1e-9 * np.abs(wanted.K).max())
    np.testing.assert_array_equal(np.delete(law.K, at, axis=1), 0.0)
    found, before, omega = loop(model, law), loop(SLEW.feedback_model, wanted), np.geomspace(1e-3, 30.0, 50)
    assert found.conserved == law.conserved and len(found.A) == len(before.A)
    np.testing.assert_allclose(found.at(omega), before.at(omega), rtol=1e-5, atol=1e-9)  # and so all margins
    verdict, without = (spillover(k, [s.plant], dict(s.goal)) for k, s in ((law, THREE), (wanted, SLEW)))
    assert verdict.holds and verdict.conserved == law.conserved
    assert verdict.cases[0].growth == pytest.approx(without.cases[0].growth, rel=1e-6)


def test_modes_needed_at_rest_are_those_without_wheels():
    """Naive: momentum and attitude make every count of modes marginal, margin 0, and one mode enough for any answer."""

    def rest(craft):
        t = np.linspace(0.0, 20.0, 41)
        x = np.zeros((len(t), craft.nx))
        x[:, craft.layout.quaternion.start] = 1.0
        return Trajectory.from_arrays(t, x, np.zeros((len(t), craft.nu)), plant=craft, dx=0 * x)

    naive = assess(SLEW.plant.linearize_along(rest(SLEW.plant)), thorough=False)
    assert naive.verdict == "marginal" and abs(naive.margin) < 1e-9
    wanted, found = (modes_needed(craft, rest, 1e-9, most=2) for craft in (SLEW.plant, THREE.plant))
    for one, other in zip(wanted.rows, found.rows):
        assert one.verdict == other.verdict == "stable" and one.margin > 1e-3
        assert other.margin == pytest.approx(one.margin, rel=1e-6)
    assert wanted.modes is found.modes is None  # 6e-8 1/s apart, which one count more does not tell to be the last
    wheels = {f"wheel{k}_momentum" for k in (1, 2, 3)}
    assert len(wanted.conserved) == 6 and len(found.conserved) == 9
    assert wheels <= {name.split()[0] for name in found.conserved} and "9 conserved quantities" in found.why
    assert modes_needed(THREE.plant, rest, 1e-6, most=2).modes == 1


def test_four_wheels_share_a_spin_that_nothing_feels():
    law = LQR.for_scene(WHEELS)
    assert len(law.conserved) == 3 and len(law.free) == 1 and law.free[0].count("wheel") == 4
    found = loop(WHEELS.feedback_model, law)
    assert found.free == law.free and np.abs(np.linalg.eigvals(found.closed())).max() < 1 - 1e-4
    verdict = spillover(law, [WHEELS.plant], dict(WHEELS.goal))
    assert verdict.holds and "left as it is" in verdict.verdict and "1/s" in verdict.verdict
    assert verdict.cases[0].growth < -1e-4  # of a mode, not the rounding of the spin's zero


@pytest.mark.parametrize(
    "scene", [THREE, turned_by(AXES, friction=1e-3), turned_by(AXES, translation=True)], ids=["", "friction", "free"]
)
def test_laws_for_the_scene_name_what_is_conserved(scene):
    pd = PD.for_scene(scene)
    kept = 9 if scene.plant.translation else 3  # and the velocity and place of the mass centre
    assert len(pd.conserved) == len(LQR.for_scene(scene).conserved) == kept


def test_the_law_at_the_end_of_a_nominal_is_that_without_wheels():
    """What TVLQR.for_scene holds the goal by, in the plant's own states with a quaternion."""
    found = []
    for scene in (SLEW, THREE):
        about, start = objective(scene), scene.initial[0]
        found.append(law_at_goal(*about, scene.substeps, 1.0, scene.feedback_model.state_names, start)[0])
    n = SLEW.plant.nx
    np.testing.assert_allclose(found[1][:, :n], found[0], rtol=1e-6, atol=1e-8 * np.abs(found[0]).max())
    np.testing.assert_array_equal(found[1][:, n:], 0.0)


def objective(scene):
    about = Objective.of(scene)
    return about, StageTerms(about, about.residual_expression)


def test_a_spinning_craft_keeps_the_momentum_along_its_spin():
    """H is turned by what turns the craft, so only H'dH is kept: one quantity, along z, where three wheels give it."""
    rates = ("body_rate_x", "body_rate_y", "body_rate_z")
    spin = dataclasses.replace(THREE, start=(("rate_z", 0.1),), goal=(("rate_z", 0.1),), goal_at_rest=False)
    spin = dataclasses.replace(spin, weights=tuple((n, 100.0) for n in rates), observe=rates)
    law = LQR.for_scene(spin)
    assert len(law.conserved) == 1 and "wheel3" in law.conserved[0] and "wheel1" not in law.conserved[0]
    assert loop(spin.feedback_model, law).conserved == law.conserved


def test_what_is_weighed_is_refused_by_name_and_a_loop_that_fails_still_fails():
    one = turned_by(AXES[:1])
    with pytest.raises(UncontrollableError, match=r"attitude_z.*as the start has, costs without end"):
        LQR.for_scene(one)
    with pytest.raises(UncontrollableError, match="costs without end"):
        TVLQR.for_scene(one)  # before the nominal is sought, which there is none
    about_x = dataclasses.replace(one, start=(("quaternion_0", np.cos(0.2)), ("quaternion_1", -np.sin(0.2))))
    law = LQR.for_scene(about_x)
    assert np.abs(law.poles).max() < 1 and law.cost_to_go(law.x0 + np.eye(len(law.x0))[1]) == np.inf
    still = Feedback(np.zeros((3, 1)), ("body_rate_x",))
    with pytest.raises(PliantError, match="is not stable"):
        margins(loop(THREE.feedback_model, still))


def test_pd_by_four_wheels_gives_a_rigid_craft_the_poles_that_were_asked_for():
    """s^2 + 2 z b s + b^2 of each axis, whatever wheels share the torque; the momentum and the spin stay at rest."""
    rigid = WHEELS.plant.ladder()[0]
    law = PD.design(rigid, *rigid.equilibrium(), bandwidth=0.3, damping=0.5)
    assert law.K.shape == (4, 6) and law.joints.positions == ("attitude_x", "attitude_y", "attitude_z")
    values = np.linalg.eigvals(loop(rigid.feedback_model(*rigid.equilibrium()), law).closed())
    np.testing.assert_allclose(
        values[np.argsort(values.imag)], -0.15 + np.repeat([-1j, 1j], 3) * np.sqrt(0.09 - 0.0225), rtol=1e-5
    )


def test_pd_for_the_scene_turns_it_and_leaves_the_wheels_at_rest():
    law = PD.for_scene(WHEELS)
    motion = WHEELS.plant.simulate(WHEELS.initial[0], law, WHEELS.times, rtol=1e-6, atol=1e-8)
    assert len(law.conserved) == 3 and np.abs(motion.x[-1] - WHEELS.target[0]).max() < 1e-3
    np.testing.assert_allclose(WHEELS.plant.momentum(motion.x)[1], 0.0, atol=1e-4)
