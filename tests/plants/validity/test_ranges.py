"""What a motion leaves of its plant's ranges: told once, stored, and only where it is so."""

import dataclasses
import warnings
from dataclasses import dataclass

import casadi as ca
import numpy as np
import pytest

from pliant.plants import Beam, Material, Plant, Signal, SingleLinkArm, Trajectory, ValidityWarning
from pliant.plants.validity.ranges import Range, left, left_at, reach

STEEL = Material(density=7850.0, E=210e9, G=81e9)
ARM = SingleLinkArm(link=Beam.rectangular(5.0, width=0.02, depth=0.02, material=STEEL), hub_inertia=5.0, modes=2)
T = np.linspace(0.0, 0.3, 31)


@dataclass(frozen=True, kw_only=True)
class Falling(Plant):
    """A pendulum linearised, x'' = -x: its author says that it holds up to 0.5 rad."""

    @property
    def states(self):
        return Signal("angle", "rad"), Signal("angle_rate", "rad/s")

    inputs = disturbances = ()
    label = "linearised"

    @property
    def outputs(self):
        return (Signal("twice", "rad"),)

    def ode(self, t, x, u, w):
        return ca.vertcat(x[1], -x[0])

    def output(self, t, x, u, w):
        return 2 * x[0]

    def ladder(self):
        return (self,)

    def ranges(self, t, x, u, w, y):
        return (Range("angle", "rad", 0.5, "sin x is x to 4 %", "the pendulum itself", ca.fabs(y[0]) / 2),)


def motion(torque, **options):
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        found = ARM.simulate(np.zeros(ARM.nx), np.array([torque]), T, **options)
    return found, [w for w in told if w.category is ValidityWarning]


@pytest.mark.parametrize(
    "options",
    [{"rtol": 1e-6, "atol": 1e-8}, {"method": "rk4", "step": 1e-3}, {"method": "radau", "rtol": 1e-5, "atol": 1e-7}],
)
def test_every_method_tells_what_is_left_when_and_what_holds(options) -> None:
    found, told = motion(250.0, **options)
    assert len(told) == 1 and told[0].filename == __file__
    (entry,) = found.stats["validity"]
    assert entry["quantity"] == "slope of the link" and entry["range"] == [0.0, 0.3]
    xi = np.linspace(0.0, 1.0, 9)
    slope = np.abs(found.x[:, 1:3] @ ARM.elastic.basis.phi(xi, 1).T / 5.0).max(axis=1)
    assert entry["largest"] == pytest.approx(slope.max(), rel=1e-12)
    assert entry["time"] == T[np.argmax(slope)] and entry["since"] == T[np.argmax(slope > 0.3)]
    for word in ("slope of the link", "0.3 rad", 'kinematics="strain"', f"t = {entry['time']:g} s"):
        assert word in str(told[0].message)


def test_a_motion_within_is_told_nothing_of() -> None:
    found, told = motion(20.0, rtol=1e-6, atol=1e-8)
    assert not told and "validity" not in found.stats and ARM.left_ranges(found) == ()


def test_the_entry_survives_the_file(tmp_path) -> None:
    found, _ = motion(250.0, method="rk4", step=1e-3)
    found.save(tmp_path / "m.npz")
    again = Trajectory.load(tmp_path / "m.npz")
    assert again.stats["validity"] == found.stats["validity"] == [a.to_json() for a in ARM.left_ranges(again)]


def test_any_plant_states_its_own() -> None:
    plant = Falling()
    with pytest.warns(ValidityWarning, match="angle 0.6 rad at t = 0 s, 1.2 times the 0.5 rad up to which sin x is"):
        moved = plant.simulate([0.6, 0.0], None, np.linspace(0.0, 1.0, 11))
    assert moved.stats["validity"][0]["holds"] == "the pendulum itself"
    assert [a.largest for a in left_at(plant, 0.0, np.array([-0.7, 0.0]), np.zeros(0))] == pytest.approx([0.7])
    assert left_at(plant, 0.0, np.array([0.4, 0.0]), np.zeros(0)) == ()
    outside = ca.Function("f", [plant.symbols_of_outputs], [reach(plant.validity)])
    assert float(outside(1.5)) == 1.5 and float(outside(0.0)) == 0.0


def test_varied_parameters_count() -> None:
    """A link with twice the modulus carries twice the spin: the stiffening over the stiffness is half as large."""
    plant = dataclasses.replace(ARM, kinematics="linear").vary("link.E")
    x = np.array([[0.0, 0.0, 0.0, 1.5, 0.0, 0.0]] * 2)
    spun = Trajectory.from_arrays([0.0, 1.0], x, plant=plant)
    (own,), (half,) = left(plant, spun), left(plant, spun, np.array([0.5 * 210e9]))
    assert "axial force" in own.range.quantity
    assert half.largest == pytest.approx(2 * own.largest, rel=1e-12)


def test_of_another_plants_motion_nothing_is_said() -> None:
    other = dataclasses.replace(ARM, modes=1)
    found, _ = motion(20.0, method="rk4", step=1e-3)
    with pytest.raises(ValueError, match=r"left_ranges: motion.states = .* must be those of SingleLinkArm"):
        other.left_ranges(found)
