import dataclasses
import importlib
import json

import numpy as np
import pytest
from scipy.linalg import eigh

from pliant.envs import scenes
from pliant.plants import FlexibleTree, Trajectory
from pliant.plants.modal_data.modal_data import ModalData
from pliant.studies import choose
from pliant.studies.common.atomic_files import dumps
from pliant.studies.common.reference_motions import Motions
from pliant.studies.fidelity.speed_accuracy import Chart, Reference, Row
from pliant.studies.physics.known_physics import PhysicsMotion

SHORT = scenes.get("single-link-slew", duration=0.5, move_time=0.3)


def finer(scene):
    """A finer model than any of the ladder, in other or more shape functions than the finest rung.

    Natural modes of two and three links do not serve: at six a link they still miss a third of what polynomials show.
    """
    plant = scene.plant
    if scene.name == "two-link-reach":
        return dataclasses.replace(plant, kinematics="strain", theory="timoshenko", basis="polynomial", modes=(6, 6))
    if scene.name == "cantilever-drop":
        return dataclasses.replace(plant, basis="polynomial", modes=9)
    if scene.name == "slider-crank-run":
        return dataclasses.replace(plant, basis="frame-elements", modes=4)
    if scene.name.startswith("spacecraft"):
        parts = tuple(dataclasses.replace(a, modes=None, body=polynomial_panel()) for a in plant.appendages)
        return dataclasses.replace(plant, kinematics="stiffened", appendages=parts)
    if scene.name == "three-link-flexible":
        bodies = tuple(dataclasses.replace(b, modes=(4, 2, 2, 0) if any(b.modes) else b.modes) for b in plant.bodies)
        return dataclasses.replace(plant, kinematics="strain", basis="polynomial", bodies=bodies)
    if isinstance(plant, FlexibleTree):
        bodies = tuple(dataclasses.replace(b, modes=tuple(3 * min(n, 1) for n in b.modes)) for b in plant.bodies)
        return dataclasses.replace(plant, kinematics="stiffened", basis="clamped-free", bodies=bodies)
    return dataclasses.replace(plant, kinematics="strain", theory="timoshenko", basis="clamped-free", modes=6)


def polynomial_panel(n=5):
    """The modes of the scenes' panel, 6 m x 2 m, 2 kg/m, EI = 186 N m^2, in x^2 .. x^(n+1) on two lines.

    The shortening is int_0^x phi_k' phi_l' ds.
    """
    L, mu, EI = 6.0, 2.0, 186.0
    s, weight = (z / 2 for z in np.polynomial.legendre.leggauss(12))
    s, weight, k = np.append(s + 0.5, 1.0), np.append(weight, 0.0), np.arange(2, n + 2)
    value, bent = s[:, None] ** k, k * (k - 1) * s[:, None] ** (k - 2) / L**2
    squares, shapes = eigh(EI * L * (bent.T * weight) @ bent, mu * L * (value.T * weight) @ value)
    phi = np.zeros((n, 26, 3))
    phi[:, :, 2] = np.tile(value @ shapes, (2, 1)).T
    i, j = k[:, None], k[None, :]
    raw = i * j / (i + j - 1) / L * s[:, None, None] ** (i + j - 1)
    shortening = np.zeros((n, n, 26, 3))
    shortening[..., 0] = np.tile(np.einsum("ak,pab,bl->klp", shapes, raw, shapes), 2)
    nodes = np.concatenate([np.column_stack([L * s, np.full(13, y), np.zeros(13)]) for y in (1.0, -1.0)])
    masses, own = np.tile(mu * L * weight / 2, 2), {"frequencies": np.sqrt(squares), "shortening": shortening}
    return ModalData.from_nodes(nodes, masses, phi, tip=12, **own)


def tip(scene, plant):
    u = np.array([scene.nominal_input(t) for t in scene.times])
    x0 = scene.with_plant(plant).initial[0]
    motion = plant.simulate(x0, u, scene.times, method="cvodes", rtol=1e-8, atol=1e-10)
    return np.stack([motion[name] for name in scene.compare])


SAMPLE = ("single-link-slew",)  # of scenes, in `make test`; the others in `make campaign`


@pytest.fixture(
    scope="module",
    params=[*SAMPLE, *(pytest.param(n, marks=pytest.mark.campaign) for n in scenes.names() if n not in SAMPLE)],
)
def case(request):
    scene = scenes.get(request.param, **({"duration": 600.0} if request.param == "spacecraft-orbit" else {}))
    return scene, choose(scene)


def test_choice_keeps_the_tolerance_against_an_independent_finer_model(case):
    scene, choice = case
    exact = tip(scene, finer(scene))
    assert choice.met
    assert np.abs(tip(scene, choice.plant) - exact).max() < scene.tolerance
    rigid = scene.plant.ladder()[0]
    if len(scene.plant.ladder()) == 1:
        return
    if scene.name in ("spacecraft-orbit", "satellite-arm"):  # bending does not matter to where it points, or reaches
        assert choice.plant.label == rigid.label
        return
    assert np.abs(tip(scene, rigid) - exact).max() > scene.tolerance
    assert choice.plant.label != rigid.label


def test_every_cheaper_rung_misses_the_tolerance_and_no_dearer_one_is_tried(case):
    scene, choice = case
    chosen = [r.chosen for r in choice.rungs].index(True)
    assert all(r.bound > scene.tolerance for r in choice.rungs[:chosen])
    assert all(r.error is None and r.note.startswith("not tried") for r in choice.rungs[chosen + 1 :])
    labels = [r.variant for r in choice.rungs]
    assert [label for label in labels if label in {p.label for p in scene.plant.ladder()}] == [
        p.label for p in scene.plant.ladder()
    ]


def test_the_error_of_the_chosen_rung_is_its_difference_from_an_independent_finer_model(case):
    scene, choice = case
    rung = next(r for r in choice.rungs if r.chosen)
    true = np.abs(tip(scene, choice.plant) - tip(scene, finer(scene))).max()
    assert abs(true - rung.error) <= max(0.25 * true, choice.convergence)


def test_integrator_and_step_keep_the_tolerance(case):
    scene, choice = case
    for row in (choice.integrator, choice.largest_step):
        assert row.variant == choice.plant.label
        assert row.error <= scene.tolerance
    assert choice.largest_step.step <= scene.dt


def test_choice_is_json_and_text(case):
    scene, choice = case
    table = json.loads(dumps(choice.to_json()))
    assert table["chosen"] == choice.plant.label
    assert choice.plant.label in choice.text
    assert ("Left out: " in choice.text) == (scene.name != "flexible-joint-slew")  # whose bodies do not bend


@pytest.mark.campaign
@pytest.mark.parametrize("case", ["two-link-reach"], indirect=True)
def test_two_rungs_that_agree_and_are_both_wrong_are_not_taken(case):
    """Linear kinematics with two and with three polynomials agree to 0.1 mm, but both lack the shortening."""
    scene, choice = case
    error = {r.variant: r.error for r in choice.rungs}
    two, three = error["linear, polynomial 2+2"], error["linear, polynomial 3+3"]
    assert abs(two - three) < scene.tolerance < 0.1 * min(two, three)
    worth = {e.name: e for e in choice.effects}
    assert worth["shortening of the bent links"].kept and worth["shortening of the bent links"].change > scene.tolerance
    assert worth["exact rotations"].change == pytest.approx(1.6e-4, rel=0.1)  # what the finest rung of 0.1 was off by
    assert not worth["exact rotations"].kept


def test_tolerance_decides():
    labels = [choose(SHORT, tolerance).plant.label for tolerance in (1e-1, 1e-3, 1e-5)]
    assert labels[0] == "rigid"
    assert len(set(labels)) == 3


def test_a_charts_row_is_taken_where_it_keeps_the_tolerance_with_what_the_chart_is_known_to(monkeypatch):
    """At 0.9 of the tolerance, from a reference known to 0.05 and to 0.2 of it; no other is tried."""
    module = importlib.import_module("pliant.studies.fidelity.choice")
    monkeypatch.setattr(module, "integrators", lambda *_: (None, None))
    motions, found = Motions(SHORT), []
    for known in (5e-3, 2e-2):
        row = Row("rigid", 2, "cvodes", None, 1e-4, seconds=1e-9, error=9e-2, step_error=0.0, runs=1)
        chart = Chart(SHORT.name, SHORT.compare, 0.1, 0.5, (row,), Reference("physics", "simulated", known), {}, 1.0)
        found.append(choose(SHORT, 0.1, measured=chart, motions=motions).method)
    assert found == ["cvodes", None]


def test_no_rung_is_claimed_beyond_what_physics_is_known_to():
    choice = choose(scenes.get("single-link-slew", duration=0.5), 1e-12)
    assert not choice.met and choice.integrator is None and choice.method is None
    assert all(r.bound >= choice.convergence > choice.tolerance for r in choice.rungs)
    assert choice.text.startswith("No variant is shown to keep ") and choice.missing


@pytest.mark.campaign
def test_the_scenes_own_plant_is_a_rung_where_its_fields_are_on_none():
    own = dataclasses.replace(SHORT.plant, theory="timoshenko", modes=3)
    rungs = choose(SHORT.with_plant(own), 1e-3).rungs
    place = [r.variant for r in rungs].index(own.label)
    assert [r.variant for r in rungs].count(own.label) == 1
    assert rungs[place - 1].states <= rungs[place].states < rungs[place + 1].states


@pytest.mark.campaign
def test_the_tolerance_is_kept_on_every_motion_asked_for():
    """A motion four times as hard needs more than the open loop does."""
    held = Motions(SHORT).held
    fast = SHORT.plant.simulate(SHORT.initial[0], 4 * held, SHORT.times)
    slow, both = choose(SHORT, 3e-3), choose(SHORT, 3e-3, motions=[None, fast])
    order = [r.variant for r in both.rungs]
    assert order.index(both.plant.label) > order.index(slow.plant.label)
    for bad, words in (([], "must hold at least one"), ([3], r"motions\[0\] = 3 must be a Trajectory")):
        with pytest.raises(ValueError, match=words):
            choose(SHORT, motions=bad)


def test_inputs_of_a_motion_are_held_over_the_periods_whatever_rounding_made_of_its_times():
    """Inputs that count the periods; a third program's times, added up, end in other digits than k dt."""
    own = Motions(SHORT)
    counted = np.arange(len(SHORT.times), dtype=float)[:, None]
    summed = np.append(0.0, np.cumsum(np.full(SHORT.steps, SHORT.dt)))
    assert (summed != SHORT.times).any()
    for times in (SHORT.times, summed, summed - 1e-13, summed * (1 + 1e-14)):
        motion = Trajectory.from_arrays(times, np.zeros((len(times), SHORT.plant.nx)), counted, plant=SHORT.plant)
        motion = dataclasses.replace(motion, hold="zero-order")
        held = Motions.with_inputs_of(SHORT, motion, "motion").held
        np.testing.assert_array_equal(held[:-1], counted[:-1])
    assert held.shape == own.held.shape


def test_motions_that_are_too_short_or_of_another_scene_are_refused():
    motion = Trajectory.from_arrays(
        SHORT.times[:20], np.zeros((20, SHORT.plant.nx)), np.zeros((20, 1)), plant=SHORT.plant
    )
    with pytest.raises(ValueError, match=r"choose.motions\[0\] lasts from 0 to 0.38 s, must last as long as the scene"):
        choose(SHORT, motions=[motion])
    longer = scenes.get("single-link-slew", duration=0.6)
    for given in (Motions(longer), [None, Motions(longer)]):
        with pytest.raises(ValueError, match="are motions of 'single-link-slew', must be of the scene"):
            choose(SHORT, motions=given)


def test_a_rung_that_fails_is_a_row_with_its_reason():
    own = SHORT.plant
    soft = dataclasses.replace(own, link=dataclasses.replace(own.link, E=1.5e10, length=1.2), hub_inertia=0.04)
    scene = scenes.get("single-link-slew", duration=0.6, move_time=0.4).with_plant(soft)
    motions = Motions(scene)
    exact = motions.outputs(soft.physics(2), 1e-8)
    motions.truth[1e-3] = PhysicsMotion(exact, soft.physics(2), 0.0, 0.0, 1e-5, "simulated")
    choice = choose(scene, 1e-3, motions=motions)
    failed = [r for r in choice.rungs if r.error == float("inf")]
    assert failed and all(r.note.startswith("MassMatrixError: ") for r in failed)
    assert choice.plant.kinematics == "strain"


def test_a_rung_whose_outputs_are_no_numbers_is_not_taken():
    """The rigid one keeps 0.1 otherwise. max(0.0, NaN) is 0.0: taken for its error, it was right to every digit."""

    class Holed(Motions):
        def outputs(self, plant, rtol, **options):
            return super().outputs(plant, rtol, **options) * (np.nan if plant.label == "rigid" else 1.0)

    choice = choose(SHORT, 0.1, motions=Holed(SHORT))
    assert choice.rungs[0].error == float("inf") and choice.rungs[0].note == "outputs that are no numbers"
    assert choice.met and choice.rungs[1].chosen and "Without a finite motion: rigid." in choice.text


@pytest.mark.parametrize("tolerance", [0.0, -1.0, float("nan"), float("inf"), "small"])
def test_bad_tolerance(tolerance):
    with pytest.raises(ValueError, match=r"choose\.tolerance = .* must be (a number )?> 0"):
        choose(scenes.get("single-link-slew"), tolerance)
