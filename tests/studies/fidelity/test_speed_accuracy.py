import dataclasses
import json
from types import SimpleNamespace

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.studies import chart
from pliant.studies.common.reference_motions import Motions
from pliant.studies.fidelity import speed_accuracy
from pliant.studies.fidelity.speed_accuracy import METHODS, Runner, pareto
from pliant.studies.figures.speed_accuracy import save
from pliant.studies.physics.physics_motion import physics_motion
from pliant.studies.report import fidelity_sections

SLEW = scenes.get("single-link-slew", duration=0.6)
LADDER = SLEW.plant.ladder()
ORDERS = {"rk4": 4, "rosenbrock": 3, "midpoint": 2}


@pytest.fixture(scope="module")
def measured():
    return chart(SLEW, budget=40.0, variants=(LADDER[0], LADDER[1], LADDER[-1]), prune=False)


def test_pareto_keeps_what_nothing_beats():
    points = [(1.0, 9.0), (2.0, 5.0), (2.0, 4.0), (3.0, 4.0), (4.0, 6.0), (5.0, 1.0), (5.0, 1.0)]
    assert pareto(points) == [True, False, True, False, False, True, True]
    assert pareto([]) == []


@pytest.fixture(scope="module")
def fine():
    """One variant, charted down to small steps, though they matter little beside its own error."""
    scene = dataclasses.replace(SLEW, tolerance=1e-7)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(speed_accuracy, "ENOUGH", 0.0)
        return chart(scene, budget=40.0, variants=(LADDER[4],), methods=tuple(ORDERS), prune=False)


@pytest.mark.parametrize("method", ORDERS)
def test_error_falls_at_the_order_of_the_method(fine, method):
    rows = [r for r in fine.measured if r.method == method][-3:]
    steps, errors = np.array([r.step for r in rows]), np.array([r.step_error for r in rows])
    assert len(rows) == 3
    order = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert order == pytest.approx(ORDERS[method], abs=0.1)


@pytest.mark.campaign
def test_error_of_a_converged_row_is_the_difference_of_the_models(measured):
    """Against the same two models integrated by another code, CVODES of SUNDIALS."""
    u = np.array([SLEW.nominal_input(t) for t in SLEW.times])

    def tip(plant):
        x0 = SLEW.with_plant(plant).initial[0]
        motion = plant.simulate(x0, u, SLEW.times, method="cvodes", rtol=1e-8, atol=1e-10)
        return np.stack([motion[name] for name in SLEW.compare])

    expected = np.abs(tip(LADDER[0]) - tip(SLEW.plant.physics(1))).max()
    rigid = [r for r in measured.measured if r.variant == "rigid" and r.method in ("rk4", "dop853", "rosenbrock")]
    assert len(rigid) >= 3
    for row in rigid:
        assert row.error == pytest.approx(expected, rel=1e-3)


def test_failures_are_rows_with_a_reason(measured):
    row = next(r for r in measured.rows if r.variant == LADDER[-1].label and r.setting == "rk4, 20 ms")
    assert row.failure.startswith("StabilityLimitError: rk4 with a step of 0.02 s is unstable")
    assert row.seconds is None and row.error is None and not row.pareto
    assert all(r.failure for r in measured.failed)


def test_what_the_budget_cuts_is_said():
    short = chart(SLEW, budget=1e-3, variants=(LADDER[1],))
    assert {r.failure for r in short.failed} == {"not run: the time budget was spent"}
    assert short.failed


def test_variants_that_can_keep_the_tolerance_are_measured_first(monkeypatch):
    asked, motions = [], Motions(SLEW)
    monkeypatch.setattr(Runner, "measure", lambda self, plant, method, level: asked.append((level, method, plant)))
    chart(SLEW, motions=motions)
    first = [plant for level, method, plant in asked if (level, method) == (0, METHODS[0])]
    truth = physics_motion(motions, SLEW.tolerance).outputs
    able = [motions.difference(plant, truth) <= SLEW.tolerance for plant in first]
    assert any(able) and not all(able) and able == sorted(able, reverse=True)
    order = [(level, METHODS.index(method)) for level, method, _ in asked]
    assert order == sorted(order) and set(first) == set(motions.ladder)


def test_the_page_says_how_many_settings_there_was_no_time_for():
    """Nothing within the tolerance is not what a chart that was cut off shows."""
    short = chart(SLEW, budget=1e-3, variants=(LADDER[0],), methods=("dop853", "rk4"))
    assert short.fastest() is None
    assert short.not_run == sum("time" in (r.failure or "") for r in short.rows) > 0
    cut = dataclasses.replace(
        short, rows=(*(dataclasses.replace(r, failure=None, error=1.0) for r in short.rows[:1]), *short.rows[1:])
    )
    said = fidelity_sections.chart(SimpleNamespace(chart=cut))
    assert f"No setting that was measured is within 1 mm; {cut.not_run} were not run for want of time" in said


def test_front_is_the_front_of_the_measured_rows(measured):
    points = [(r.error, r.seconds) for r in measured.measured]
    assert [r.pareto for r in measured.measured] == pareto(points)
    fastest = measured.fastest()
    within = [r for r in measured.measured if r.error <= SLEW.tolerance]
    assert fastest.seconds == min(r.seconds for r in within)
    assert measured.fastest(1e-15) is None


def test_the_reference_is_physics_and_says_how_well_it_is_known(measured):
    reference = measured.reference
    assert reference.variant.startswith("strain, polynomial") and reference.how.startswith(reference.variant)
    assert 0 < reference.uncertainty < 0.1 * SLEW.tolerance


def test_dominated_settings_are_not_run():
    pruned = chart(SLEW, budget=40.0, variants=(LADDER[0], LADDER[1]))
    why = [r.failure for r in pruned.failed]
    assert why and all(w.startswith("not run: dominated by ") for w in why)
    assert pruned.fastest().variant == LADDER[1].label


def test_save_writes_table_and_picture(measured, tmp_path):
    measured.save(tmp_path / "chart.json")
    save(measured, tmp_path / "chart.png")
    table = json.loads((tmp_path / "chart.json").read_text())
    assert len(table["rows"]) == len(measured.rows)
    assert table["machine"]["evaluation"].startswith("simulate: compiled code")
    assert (tmp_path / "chart.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"budget": 0.0}, "chart.budget = 0.0 must be > 0"),
        ({"budget": float("nan")}, "chart.budget = nan must be > 0"),
        ({"methods": ("euler",)}, "chart.methods[0] = 'euler': no such method; choose from dop853"),
    ],
)
def test_bad_input(options, message):
    with pytest.raises(ValueError) as caught:
        chart(SLEW, **options)
    assert message in str(caught.value)
