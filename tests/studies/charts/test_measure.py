"""A chart measured: its rows against theory and another code, its budget, what it keeps."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.plants.native import kernel_loader
from pliant.studies import chart
from pliant.studies.charts import measure, runner
from pliant.studies.charts.measure import rounded_up
from pliant.studies.charts.runner import Runner
from pliant.studies.common.reference_motions import Motions
from pliant.studies.fidelity.speed_accuracy import METHODS, SPENT, pareto
from pliant.studies.peers.peer_rows import PeerRow
from pliant.studies.physics.physics_motion import physics_motion
from pliant.studies.report import fidelity_sections

SLEW = scenes.get("single-link-slew", duration=0.6)
LADDER = SLEW.plant.ladder()
ORDERS = {"rk4": 4, "rosenbrock": 3, "midpoint": 2}


@pytest.fixture(scope="module")
def measured():
    few = {"variants": (LADDER[0], LADDER[-1]), "methods": ("dop853", "rk4", "rosenbrock")}
    return chart(SLEW, budget=60.0, prune=False, **few)


@pytest.fixture(scope="module")
def fine():
    """One variant, charted down to small steps, though they matter little beside its own error."""
    scene = dataclasses.replace(SLEW, tolerance=1e-7)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(runner, "ENOUGH", 0.0)
        return chart(scene, budget=40.0, variants=(LADDER[4],), methods=tuple(ORDERS), prune=False)


@pytest.mark.parametrize("method", ORDERS)
def test_error_falls_at_the_order_of_the_method(fine, method):
    rows = [r for r in fine.measured if r.method == method and r.path == "simulate"][-3:]
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


def test_every_path_number_of_lanes_and_precision_is_measured(measured):
    paths = {(r.path, r.lanes, r.precision) for r in measured.measured}
    had = ("double", "single") if kernel_loader.wanted() else ("double",)  # single in compiled code alone
    stepped = {("stepper", lanes, precision) for lanes in (1, 1024) for precision in had}
    assert paths == {("simulate", 1, "double"), ("linear", 1, "double"), *stepped}
    assert {r.method for r in measured.measured if r.path == "linear"} == {"ltv", "linear", "reduced"}


def test_the_stepper_errs_as_simulate_does_and_single_precision_by_rounding_more(measured):
    rows = {r.key: r for r in measured.measured}
    stepped = [r for r in rows.values() if r.path == "stepper" and r.lanes == 1]
    assert stepped
    for row in stepped:
        twin = rows[dataclasses.replace(row, path="simulate", precision="double").key]
        assert row.error == pytest.approx(twin.error, rel=1e-9 if row.precision == "double" else 0.5, abs=1e-5)
        many = rows.get(dataclasses.replace(row, lanes=1024).key)
        assert many is None or many.error == row.error


def test_failures_are_rows_with_a_reason(measured):
    row = next(r for r in measured.rows if r.variant == LADDER[-1].label and r.setting == "rk4, 20 ms")
    assert row.failure.startswith("StabilityLimitError: rk4 with a step of 0.02 s is unstable")
    assert row.seconds is None and row.error is None and not row.pareto
    assert all(r.failure for r in measured.failed)
    assert not any(
        r.path == "stepper" and (r.variant, r.method, r.step) == row.key[:1] + row.key[2:4] for r in measured.rows
    )


def test_front_is_the_front_of_the_measured_rows(measured):
    for lanes in (1, 1024):
        own = [r for r in measured.measured if r.lanes == lanes and r.path != "linear"]
        assert [r.pareto for r in own] == pareto([(max(r.error, measured.told_from), r.seconds) for r in own])
    within = [r for r in measured.measured if r.error + measured.reference.uncertainty <= SLEW.tolerance]
    alone = [r.seconds for r in within if r.lanes == 1 and r.path != "linear"]
    assert measured.fastest().seconds == min(alone)


def test_the_reference_is_physics_and_says_how_well_it_is_known(measured):
    reference = measured.reference
    assert reference.variant.startswith("strain, polynomial") and reference.how.startswith(reference.variant)
    assert 0 < reference.uncertainty < 0.1 * SLEW.tolerance


def test_what_the_budget_cuts_is_said():
    short = chart(SLEW, budget=1e-3, variants=LADDER[1:2])
    assert {r.failure for r in short.failed} == {SPENT}
    assert short.failed and short.lacking == () and short.needed is None


def test_a_budget_that_buys_not_every_variant_a_row_says_which_would():
    short = chart(SLEW, budget=1e-6, variants=LADDER[:3])
    assert len({r.variant for r in short.measured}) == 1 and len(short.lacking) == 2
    assert short.needed > 0
    enough = chart(SLEW, budget=max(1.0, 10 * short.needed), variants=LADDER[:3], methods=("dop853",))
    assert enough.lacking == () and enough.needed is None and len({r.variant for r in enough.measured}) == 3


def test_a_fixed_step_of_each_variant_comes_before_anything_is_refined(monkeypatch):
    asked = []
    real = Runner.measure

    def measured(self, plant, row, until):
        found = real(self, plant, row, until)
        asked.extend([found] if found is not None else [])
        return found

    monkeypatch.setattr(Runner, "measure", measured)
    variants = (LADDER[0], LADDER[-1])
    chart(SLEW, budget=1.0, variants=variants)
    good = [(r.variant, r.method) for r in asked if r.failure is None][:4]
    assert [method for _, method in good[:2]] == ["dop853", "dop853"]
    assert {variant for variant, _ in good[2:]} == {p.label for p in variants}
    assert {method for _, method in good[2:]} <= {"rk4", "rk8"}


def test_a_budget_is_told_in_two_digits_and_not_too_small():
    assert rounded_up(1.0) == pytest.approx(1.1) and rounded_up(0.0123) == pytest.approx(0.014)
    assert rounded_up(95.0) == pytest.approx(110.0)


def test_variants_that_can_keep_the_tolerance_are_measured_first(monkeypatch):
    asked, motions = [], Motions(SLEW)
    monkeypatch.setattr(Runner, "measure", lambda self, plant, row, until: asked.append((plant, row)))
    monkeypatch.setattr(measure, "compile_motions", lambda plant, coming: False)
    chart(SLEW, motions=motions)
    first = list(dict.fromkeys(plant for plant, row in asked))
    truth = physics_motion(motions, SLEW.tolerance).outputs
    able = [motions.difference(plant, truth) <= SLEW.tolerance for plant in first]
    assert any(able) and not all(able) and able == sorted(able, reverse=True)
    assert set(first) == set(motions.ladder)


def test_the_page_says_how_many_settings_there_was_no_time_for():
    """Nothing within the tolerance is not what a chart that was cut off shows."""
    short = chart(SLEW, budget=1e-3, variants=(LADDER[0],), methods=("dop853", "rk4"))
    assert short.fastest() is None
    assert short.not_run == sum("time" in (r.failure or "") for r in short.rows) > 0
    said = fidelity_sections.chart(SimpleNamespace(chart=short))
    assert f"No setting that was measured is within 1 mm; {short.not_run} were not run for want of time" in said


def test_dominated_settings_are_not_run():
    pruned = chart(SLEW, budget=40.0, variants=(LADDER[0], LADDER[1]), methods=("dop853", "rk4", "midpoint", "cvodes"))
    why = [r for r in pruned.failed if r.path == "simulate"]
    assert why and all(r.failure.startswith("not run: dominated by ") for r in why)
    assert pruned.fastest().variant == LADDER[1].label


@pytest.mark.skipif(not kernel_loader.wanted(), reason="PLIANT_NATIVE=0: 1,024 lanes take longer than a test has")
def test_a_second_call_goes_on_where_the_first_ended(tmp_path):
    kept, few = tmp_path / "rows.jsonl", {"variants": LADDER[:2], "methods": ("dop853", "rk4")}
    first = chart(SLEW, budget=1e-6, kept=kept, **few)
    with kept.open("a") as file:
        file.write('{"variant": "rig')  # killed while writing
    second = chart(SLEW, budget=20.0, kept=kept, **few)
    assert len(second.measured) > len(first.measured) and second.not_run == 0 < first.not_run
    again = chart(SLEW, budget=1e-6, kept=kept, **few)
    assert again.rows == second.rows  # nothing is measured anew
    with pytest.raises(ValueError, match=r"rows.jsonl' holds rows of other settings of it: name another file"):
        chart(dataclasses.replace(SLEW, tolerance=2e-3), budget=1e-6, kept=kept, **few)


def test_other_programs_are_told_the_references_outputs_and_stand_beside(tmp_path):
    asked = []

    def programs(scene, outputs, *, budget, progress):
        asked.append((scene, outputs, budget))
        return (PeerRow("Other", "1 ms", 0.1, 1e-4, 3, 5),)

    few = {"budget": 2.0, "variants": LADDER[:1], "methods": ("rk4",), "kept": tmp_path / "rows.jsonl"}
    found = chart(SLEW, peers=programs, **few)
    assert found.peers == (PeerRow("Other", "1 ms", 0.1, 1e-4, 3, 5),)
    (scene, outputs, budget), truth = asked[0], physics_motion(Motions(SLEW), 0.1 * SLEW.tolerance).outputs
    assert scene is SLEW and budget == 2.0 and np.array_equal(outputs, truth)
    assert chart(SLEW, peers=programs, **few).peers == found.peers and len(asked) == 1  # they were kept
    assert chart(SLEW, **few).peers == ()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"budget": 0.0}, "chart.budget = 0.0 must be > 0"),
        ({"budget": float("nan")}, "chart.budget = nan must be > 0"),
        ({"methods": ("euler",)}, "chart.methods[0] = 'euler': no such method; choose from dop853"),
        ({"methods": ()}, f"chart.methods = () must name at least one of {', '.join(METHODS)}"),
        ({"peers": 3}, "chart.peers = 3 must be True or False"),
        ({"kept": 7}, "chart.kept is a int, must be a path"),
    ],
)
def test_bad_input(options, message):
    with pytest.raises(ValueError) as caught:
        chart(SLEW, **options)
    assert message in str(caught.value)


def test_variants_that_there_was_no_time_to_prepare_are_told_with_the_budget_needed(monkeypatch):
    """The first is prepared whatever it takes; the budget asked for grows with the number of variants."""
    monkeypatch.setattr(measure, "PREPARING", 0.0)
    monkeypatch.setattr(measure, "compile_motions", lambda plant, coming: False)
    motions = Motions(SLEW)
    ready, needed = measure._prepare(motions, LADDER[:3], 1e-9, lambda fraction, task: None)
    assert ready == LADDER[:1] and needed > 0
    assert measure._prepare(motions, LADDER[:3], 60.0, lambda fraction, task: None) == (LADDER[:3], None)
    late = measure._unprepared(LADDER[2], ("dop853", "rk4"), SLEW.dt)
    assert [(r.variant, r.method, r.failure) for r in late] == [(LADDER[2].label, m, SPENT) for m in ("dop853", "rk4")]
