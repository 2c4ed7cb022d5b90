"""Which settings are tried, in which order."""

from pliant.envs import scenes
from pliant.studies.charts.plan import parts, simulated
from pliant.studies.fidelity.speed_accuracy import METHODS

PLANTS = scenes.get("single-link-slew").plant.ladder()[:3]
PARTS = parts(PLANTS, METHODS, 0.02)


def test_every_setting_is_in_one_part_once():
    keys = [row.key for part in PARTS for _, row in part.settings]
    assert len(keys) == len(set(keys))
    each = len(keys) / len(PLANTS)
    assert each == 4 + 3 + 4 * 6 + 3 + 5 * 6 * 2 + 4  # dop853, rodas5p, fixed steps, cvodes, stepper, linear
    assert [part.until for part in PARTS] == sorted(part.until for part in PARTS) and PARTS[-1].until == 1.0


def test_one_lane_and_many_in_both_precisions():
    stepped = {(row.lanes, row.precision) for part in PARTS for _, row in part.settings if row.path == "stepper"}
    assert stepped == {(1, "double"), (1, "single"), (1024, "double"), (1024, "single")}


def test_coarse_steps_come_before_fine_ones():
    steps = [row.step for _, row in PARTS[0].settings if row.method == "rk4"]
    assert steps == sorted(steps, reverse=True) and steps[0] == 0.02


def test_only_methods_asked_for():
    few = parts(PLANTS, ("rk8",), 0.02)
    assert {row.method for part in few for _, row in part.settings if row.path != "linear"} == {"rk8"}


def test_a_method_ends_with_its_last_setting():
    assert simulated(PLANTS[0], "cvodes", 2, 0.02).rtol == 1e-8
    assert simulated(PLANTS[0], "cvodes", 3, 0.02) is None
    assert simulated(PLANTS[0], "rk4", 5, 0.02).step == 0.02 / 50
