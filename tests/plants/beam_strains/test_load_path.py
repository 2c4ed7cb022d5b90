"""Rests that are followed from the unloaded beam: the right branch, or an error that says where it is lost."""

import dataclasses

import numpy as np
import pytest
from euler_elastica import elastica
from strained_cases import SECTION, strained

from pliant.plants.beam_strains.load_path import follow, tell_unstable
from pliant.plants.core.errors import EquilibriumError, UnstableRestWarning

STILL = {"gravity": (0.0, 0.0, 0.0), "modes": 8, "basis": "polynomial"}


class Spring:
    """One coordinate: share of a load less a cubic of stiffness polynomial `force`."""

    def __init__(self, force, load):
        self.force, self.load = np.polynomial.Polynomial(force), load

    def net(self, q, share):
        return np.array([share * self.load - self.force(q[0])]), abs(self.load)

    def jacobian(self, q, share):
        return np.array([[-self.force.deriv()(q[0])]])


def arch(load):
    """A shallow truss, x^3 - 3 x^2 + 2 x against a load; it snaps at 2/(3 sqrt 3) = 0.3849."""
    return Spring([0, 2, -3, 1], load)


@pytest.mark.parametrize("load", [0.05, 0.3, 0.38])
def test_below_the_limit_point_the_near_branch_is_found(load):
    """The least of three roots of x^3 - 3 x^2 + 2 x = load."""
    roots = np.sort(np.roots([1, -3, 2, -load]).real)
    assert follow(arch(load), np.zeros(1), "the arch")[0] == pytest.approx(roots[0], rel=1e-9)


def test_past_the_limit_point_there_is_an_error_that_says_where():
    """At 0.7698 of a load of 0.5; Newton's method alone goes to the far branch."""
    with pytest.raises(EquilibriumError, match=r"the arch on the branch of the unloaded beam: it is lost at 0.769"):
        follow(arch(0.5), np.zeros(1), "the arch")


def test_steps_grow_again_past_a_narrow_place():
    """A curve of x^3 + x/50 = lambda is steep at its start: 0.964 at the end."""
    known = max(np.roots([1, 0, 0.02, -1]).real)
    assert follow(Spring([0, 0.02, 0, 1], 1.0), np.zeros(1), "a spring")[0] == pytest.approx(known, rel=1e-9)


@pytest.mark.parametrize("load", [1.0, 10.0, 100.0])
def test_a_tip_force_bends_as_the_elastica(load):
    """Elliptic integrals; at 100 the tip stands up by 86 degrees, where Newton's method from straight does not go."""
    plant = strained(rotary=0.0, **STILL)
    force = load * SECTION.EI / SECTION.length**2
    x, u = plant.equilibrium(tip_force_y=force)
    y = dict(zip((s.name for s in plant.outputs), plant.measure(x, u)))
    tip = [y["tip_x"] / SECTION.length, y["tip_y"] / SECTION.length, y["tip_angle"]]
    np.testing.assert_allclose(tip, elastica(load), atol={1.0: 1e-8, 10.0: 1e-5, 100.0: 5e-3}[load])


def test_a_straight_column_is_told_to_buckle():
    plant = strained(rotary=0.0, **STILL)
    critical = np.pi**2 / 4 * SECTION.EI / SECTION.length**2
    with pytest.warns(UnstableRestWarning, match=r"unstable: with the loads held, .* most in bend1"):
        x, _ = plant.equilibrium(tip_force_x=-1.05 * critical)
    assert np.abs(x).max() < 1e-9
    plant.equilibrium(tip_force_x=-0.95 * critical)


def test_a_follower_force_makes_it_flutter():
    """M. Beck, ZAMP 3 (1952), 225: a cantilever under a follower force flutters from 20.05 E I/L^2 on."""
    plant = strained(rotary=0.0, tip_loads=("follower",), **STILL)
    unit = SECTION.EI / SECTION.length**2
    plant.equilibrium(follower_force_x=-20.0 * unit)
    with pytest.warns(UnstableRestWarning):
        plant.equilibrium(follower_force_x=-20.1 * unit)


def test_growth_below_rounding_is_not_told(recwarn):
    M = np.eye(2)
    tell_unstable(M, np.array([[-1.0, 1e-9], [-1e-9, -1.0]]), "two masses", ("a", "b"))
    assert not recwarn.list
    with pytest.warns(UnstableRestWarning, match="two masses"):
        tell_unstable(M, np.array([[-1.0, 1e-3], [-1e-3, -1.0]]), "two masses", ("a", "b"))


def test_a_snapped_column_is_not_passed_off_as_the_next_rest():
    """Bent to one side by 1.2 times its buckling load, then pushed to the other: the branch ends where it snaps."""
    plant = strained(rotary=0.0, **STILL)
    unit = SECTION.EI / SECTION.length**2
    column = {"tip_force_x": -1.2 * np.pi**2 / 4 * unit}
    x, _ = plant.equilibrium(**column, guess={"bend1": 1.2})
    names = [s.name for s in plant.coordinates]
    deflected = []
    for push in (0.0, -0.02, -0.04):
        x, u = plant.equilibrium(**column, tip_force_y=push * unit, guess=dict(zip(names, x)))
        deflected.append(plant.measure(x, u)[1])
    assert deflected[0] > deflected[1] > deflected[2] > 0
    with pytest.raises(EquilibriumError, match="on the branch of the guess"):
        plant.equilibrium(**column, tip_force_y=-0.4 * unit, guess=dict(zip(names, x)))


def test_states_held_are_solved_for_as_ever():
    plant = strained(modes=2, extensible=True)
    x, _ = plant.equilibrium(bend1=0.3, bend2=0.0)
    assert (
        x[0] == pytest.approx(0.3)
        and np.abs(plant.dynamics(x, plant.equilibrium(bend1=0.3, bend2=0.0)[1])).max() < 1e-6
    )


def test_parameters_that_vary():
    plant = strained(rotary=0.0, **STILL).vary("beam.E")
    soft = dataclasses.replace(plant, varied=(), beam=dataclasses.replace(SECTION, E=0.5 * SECTION.E))
    np.testing.assert_allclose(
        plant.equilibrium(tip_force_y=5.0, p=[0.5 * SECTION.E])[0], soft.equilibrium(tip_force_y=5.0)[0], atol=1e-9
    )
