"""Frequencies and roots against the reference file."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest
from craft_cases import deviations, motor_hinged, random_nominal, slew
from evidence import agrees

from pliant.plants import MassMatrixError, Trajectory
from pliant.plants.linear.piecewise_ltv import linearize_pieces
from pliant.plants.spacecraft.plant import FlexibleSpacecraft
from pliant.plants.spacecraft_parts.environment import Environment, Orbit
from pliant.plants.stability import assess

REFERENCE = json.loads((Path(__file__).parents[2] / "reference" / "spacecraft.json").read_text())
CRAFT = dataclasses.replace(FlexibleSpacecraft.textbook(), kinematics="linear")


def nearest(found, wanted):
    """Largest distance of a wanted root from the found ones."""
    return max(np.abs(found - complex(*root)).min() for root in wanted)


def test_free_frequencies(hinged):
    agrees(
        CRAFT.natural_frequencies(),
        REFERENCE["free_frequencies_rad_s"],
        within=1e-9,
        of="FlexibleSpacecraft",
        what="free frequencies",
        source="reference numbers (spacecraft.json)",
        kind="independent arithmetic",
    )
    wanted = REFERENCE["hinge_stiffness_modulated"]["hinge_frequencies_rad_s"]
    agrees(
        hinged().natural_frequencies(),
        wanted,
        within=1e-9,
        of="FlexibleSpacecraft",
        what="hinge frequencies",
        source="reference numbers (spacecraft.json)",
        kind="independent arithmetic",
    )
    roots = np.sort(np.abs(hinged().linearize(hinged().state()).eigenvalues))
    np.testing.assert_allclose(roots[roots > 0.1][::2], wanted, rtol=1e-3)  # damped a little


@pytest.mark.parametrize("axis", "xy")
def test_frozen_roots_in_spin(axis):
    model = CRAFT.linearize(CRAFT.state({f"rate_{axis}": 0.1}))
    agrees(
        nearest(model.eigenvalues, REFERENCE["spin_0.1_rad_s"][axis]),
        0.0,
        within=1e-8,
        absolute=True,
        of="FlexibleSpacecraft",
        what=f"roots in a spin about {axis}",
        source="reference numbers (spacecraft.json)",
        kind="independent arithmetic",
    )
    apart = [z for z in model.eigenvalues if abs(z) > 1e-5]
    wanted = np.array([complex(*z) for z in REFERENCE["spin_0.1_rad_s"][axis]])
    wanted = np.concatenate([wanted, wanted.conj()])
    assert max(np.abs(wanted - z).min() for z in apart) < 1e-7


def test_gravity_gradient_frequencies():
    """Roll = y, pitch = z, yaw = x: body axes (x, y, z) along the orbit axes (z, x, y)."""
    craft = dataclasses.replace(CRAFT, environment=Environment(orbit=Orbit(rate=1e-3)))
    x = craft.state(quaternion_0=0.5, quaternion_1=-0.5, quaternion_2=-0.5, quaternion_3=-0.5)
    R = craft.turn(x)
    np.testing.assert_allclose(R, [[0, 1, 0], [0, 0, 1], [1, 0, 0]], atol=1e-15)
    x[craft.layout.omega] = R.T @ [0.0, -1e-3, 0.0]
    assert np.abs(craft.dynamics(x)).max() < 1e-8  # centrifugal forces and tidal tension stretch nothing to first order
    ratios = np.abs(craft.linearize(x).eigenvalues.imag) / 1e-3
    for wanted in REFERENCE["gravity_gradient"]["frequencies_over_orbital_rate"]:
        agrees(
            ratios[np.abs(ratios - wanted).argmin()],
            wanted,
            within=1e-5,
            absolute=True,
            of="FlexibleSpacecraft",
            what=f"libration at {wanted:.4f} of the orbital rate",
            source="reference numbers (spacecraft.json)",
            kind="independent arithmetic",
        )
    assert craft.linearize(x).eigenvalues.real.max() < 1e-7


@pytest.mark.parametrize("axes", [((1.0, 0.0, 0.0),), ((0.0, 1.0, 0.0), (0.0, 1.0, 0.0))], ids=["slender", "parallel"])
def test_a_hinge_that_turns_nothing_has_no_frequency(hinged, axes):
    craft = hinged(axes=axes)
    for call in (craft.natural_frequencies, lambda: craft.linearize(craft.state())):
        with pytest.raises(
            MassMatrixError, match="no inertia about one of its hinge's axes, or two of these are paral"
        ):
            call()


def test_a_jump_in_the_nominal_is_carried():
    """An impulse on the hub: the rigid nominal jumps its way, the flexible craft its own; error again of second
    order in size.
    """
    errors = []
    for size in (1.0, 0.5):
        made = motor_hinged(4.0)
        rigid = dataclasses.replace(made, kinematics="rigid")
        impulse, t = size * np.array([0.0, 8.0, -6.0, 0.0]), np.linspace(0, 2, 81)
        at, short = made.layout, rigid.layout
        start = rigid.state(rate_x=0.3 * size, rate_y=0.2 * size, rate_z=0.25 * size)
        first = rigid.simulate(start, None, t)
        kicked = first.x[-1] + rigid.jacobians(first.x[-1])[1] @ impulse
        second = rigid.simulate(kicked, None, t)

        def widened(run, shift, made=made, at=at, short=short):
            x, dx = np.zeros((len(run.t), made.nx)), np.zeros((len(run.t), made.nx))
            for a, b in [
                (at.quaternion, short.quaternion),
                (at.omega, short.omega),
                *zip(at.hinges, short.hinges),
                *zip(at.hinge_rates, short.hinge_rates),
            ]:
                x[:, a], dx[:, a] = run.x[:, b], run.dx[:, b]
            return Trajectory.from_arrays(run.t + shift, x, run.u, plant=made, dx=dx)

        nominals = [widened(first, 0.0), widened(second, 2.0)]
        model = linearize_pieces(made, nominals, [impulse])
        assert model.jump_times == pytest.approx([2.0])
        dx, _ = model.simulate(np.zeros(made.nx - 1))
        true = made.simulate(nominals[0].x[0], None, t, rtol=1e-11)
        after = true.x[-1] + made.jacobians(true.x[-1])[1] @ impulse
        true = made.simulate(after, None, t, rtol=1e-11)
        gap = deviations(made, nominals[1], true.x) - dx[len(t) :]
        errors.append(np.abs(gap).max())
        assert np.abs(gap).max() < 0.05 * np.abs(dx).max()
        assert np.abs(model.jumps[0][1]).max() > 1e-3 * size  # without the jump the model would miss it
    assert np.log2(errors[0] / errors[1]) > 1.8


def test_the_map_of_deviations_across_a_jump():
    """Against the nonlinear jump of neighbouring states, by central differences, with large rates on both sides."""
    made, rng = motor_hinged(), np.random.default_rng(6)
    x, _, _ = random_nominal(made)
    x[made.layout.quaternion.stop :] *= 0.3
    impulse = np.array([30.0, 20.0, -40.0, 5.0])
    new = x + made.jacobians(x)[1] @ impulse
    new[made.layout.omega] += [0.1, -0.2, 0.3]  # the nominal's program jumped elsewhere
    t, still = np.array([0.0, 0.1, 0.2, 0.3]), np.zeros((4, 4))
    runs = [Trajectory.from_arrays(t + 0.3 * k, np.tile(v, (4, 1)), still, plant=made) for k, v in enumerate((x, new))]
    J, _ = linearize_pieces(made, runs, [impulse]).jumps[0]
    T = made.small.forward(x)
    for xi in rng.normal(size=(4, made.nx - 1)):
        ends = []
        for h in (1e-5, -1e-5):
            near = x + h * T @ xi
            near[made.layout.quaternion] /= np.linalg.norm(near[made.layout.quaternion])
            after = near + made.jacobians(near)[1] @ impulse
            flat = Trajectory.from_arrays(t, np.tile(new, (4, 1)), still, plant=made)
            ends.append(deviations(made, flat, np.tile(after, (4, 1)))[0])
        np.testing.assert_allclose((ends[0] - ends[1]) / 2e-5, J @ xi, atol=1e-6 * np.abs(J).max())


def test_a_varied_orbit_rate_is_that_of_the_parameters():
    """Rows of parameters along the nominal; against a spacecraft built with the rate."""
    outside = Environment(orbit=Orbit(rate=1.1e-3))
    made = dataclasses.replace(motor_hinged(), translation=True, environment=outside)
    nominal = slew(made, np.linspace(0, 3, 7))
    x, dx = nominal.x.copy(), nominal.dx.copy()
    x[:, made.layout.velocity] = [30.0, -20.0, 10.0]  # so that the axes' turning accelerates it
    x[:, made.layout.position] = np.outer(nominal.t, [30.0, -20.0, 10.0])
    dx[:, made.layout.position] = x[:, made.layout.velocity]
    nominal = dataclasses.replace(nominal, x=x, dx=dx)
    other = dataclasses.replace(made, environment=Environment(orbit=Orbit(rate=0.02)))
    varied = made.vary("environment.orbit.rate")
    for p in ([0.02], np.full((7, 1), 0.02)):
        found, wanted = varied.linearize_along(nominal, p=p), other.linearize_along(nominal)
        for name in "ABc":
            np.testing.assert_allclose(getattr(found, name), getattr(wanted, name), rtol=1e-10, atol=1e-10)
    assert np.abs(wanted.A - made.linearize_along(nominal).A).max() > 1e-2


@pytest.mark.parametrize("translation", [True, False])
def test_both_kinds_of_state_give_one_model(translation):
    """Along a nominal that satisfies nothing: in the plant's own states, its small turns, and back."""
    made = dataclasses.replace(motor_hinged(), translation=translation)
    nominal = slew(made, np.linspace(0, 3, 7))
    small, own = made.linearize_along(nominal), made.linearize_along(nominal, attitude="quaternion")
    assert own.A.shape[1] == small.A.shape[1] + 1 == made.nx
    h = 1e-5
    for k in (2, 4):
        T, L = made.small.forward(nominal.x[k]), made.small.back(nominal.x[k])
        ahead, behind = (  # T along the nominal's own motion
            made.small.forward(nominal.x[k] + s * h * nominal.dx[k]) for s in (1, -1)
        )
        wanted = L @ (own.A[k] @ T - (ahead - behind) / (2 * h))
        np.testing.assert_allclose(small.A[k], wanted, atol=1e-7 * np.abs(wanted).max())
        np.testing.assert_allclose(small.B[k], L @ own.B[k], atol=1e-12)
        np.testing.assert_allclose(small.c[k], L @ own.c[k], atol=1e-12)


def flat(made, q, t=(0.0, 0.1, 0.2, 0.3), dx=None):
    x = np.tile(made.state(), (4, 1))
    x[:, made.layout.quaternion] = q
    return Trajectory.from_arrays(np.array(t), x, np.zeros((4, made.nu)), plant=made, dx=dx)


@pytest.mark.parametrize("translation", [False, True])
def test_a_craft_at_rest_is_marginal_at_any_attitude(translation):
    """Its attitude and place are zero eigenvalues twice each, whatever the turn: no rounding of it may grow."""
    craft = dataclasses.replace(CRAFT, translation=translation)
    for seed in range(6):
        q = np.random.default_rng(seed).normal(size=4)
        x = craft.state()
        x[craft.layout.quaternion] = q / np.linalg.norm(q)
        model = craft.linearize(x)
        rows = [model.state_names.index(f"q_{axis}") for axis in "xyz"]
        rates = [model.state_names.index(f"q_{axis}_rate") for axis in "xyz"]
        np.testing.assert_array_equal(model.A[rows], np.eye(len(model.A))[rates])
        assert assess(model).verdict == "marginal"


def test_a_nominal_that_does_not_turn_as_its_rates_say_keeps_its_own_rows():
    x = CRAFT.state()
    x[CRAFT.layout.omega] = [0.1, -0.2, 0.05]
    dx, jacobians = CRAFT.dynamics(x), list(CRAFT.jacobians(x))
    q = slice(CRAFT.layout.quaternion.start, CRAFT.layout.quaternion.stop - 1)
    assert not CRAFT.small.model(x, dx, jacobians)[0][q, q].any()
    still = dx.copy()
    still[CRAFT.layout.quaternion] = 0.0
    assert np.abs(CRAFT.small.model(x, still, jacobians)[0][q, q]).max() > 0.01
