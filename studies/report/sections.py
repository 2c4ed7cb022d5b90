"""What the report says, section by section."""

from __future__ import annotations

import json
from collections.abc import Callable

import numpy as np

from pliant.envs.scenes.nominal_inputs import largest_beyond
from pliant.envs.scenes.scene import Scene
from pliant.plants.validity.ranges import in_words
from pliant.studies.charts import page as chart_page
from pliant.studies.common import operating_point
from pliant.studies.common.formatting import counted, measured, paragraph, pictures, table
from pliant.studies.figures import arm_outline
from pliant.studies.figures.motion import still

from . import answer, control_sections, fidelity_sections
from .findings import Findings

KINDS = {"N m": "torques", "N": "forces", "rad/s^2": "accelerations", "m/s^2": "accelerations"}  # inputs by unit
FRAMES = 76  # of the arm that the slider moves
ROUNDED = 1e-12  # of the largest eigenvalue, below which a real part is rounding
LINEAR = 1e-5  # error of a prediction against its size, below which it is the integrator's


def all_of(found: Findings, inlined: dict[str, str]) -> list[tuple[str, str]]:
    """(title, HTML) of every section; of one that cannot be written the reason."""

    def drawn(*wanted: str) -> str:
        return pictures(inlined, *wanted)

    def measured_chart() -> str:
        interactive = chart_page.interactive(found.chart, inlined["speed_accuracy"]) if found.chart.measured else ""
        return fidelity_sections.chart(found) + interactive + fidelity_sections.front(found) + drawn("settings")

    parts: list[tuple[str, Callable[[], str]]] = [
        ("The answer", lambda: answer.answer(found)),
        ("The motion", lambda: _motion(found) + drawn("motion", "shapes", "tip_path")),
        ("Modes and frequencies", lambda: answer.told(found, "The modes", lambda: _modes(found)) + _frequencies(found)),
        ("The linear model at the goal", lambda: _goal(found) + drawn("eigenvalues")),
        ("The linear model along the motion", lambda: _along(found) + drawn("frozen_eigenvalues")),
        ("Stability along the motion", lambda: control_sections.stability(found) + drawn("stability")),
        ("LQR in closed loop", lambda: control_sections.loops(found) + drawn("closed_loop")),
        ("Controllers in closed loop", lambda: control_sections.controllers(found) + drawn("controllers")),
        ("Speed against accuracy", measured_chart),
        ("The smallest model", lambda: fidelity_sections.choice(found) + drawn("ladder", "effects")),
        ("Versions and machine", lambda: table(("what", "value"), list(found.machine.items()))),
    ]
    made = [(title, answer.told(found, title, part)) for title, part in parts]
    undrawn = [f"{name}: {why}" for name, why in found.lost.items() if name.startswith(("figure ", "table "))]
    if undrawn:
        made[-1] = (made[-1][0], made[-1][1] + "".join(paragraph(f"Not made: {line}.", "warning") for line in undrawn))
    return made


def _motion(found: Findings) -> str:
    """The arm that a slider moves, open loop and under LQR."""
    scene = found.scene
    cheapest = scene.plant.ladder()[0].label
    whom = "it" if cheapest == scene.plant.label else f"the cheapest variant, {cheapest},"
    inputs = f"the {_kind(scene)} that take {whom} along a minimum-jerk motion of {scene.move_time:g} s"
    if scene.drive is not None:
        inputs = "the scene's own inputs" if np.any(found.open_loop.u) else "all inputs zero"
    text = paragraph(f"Open loop: {inputs}, played on {scene.plant.label} ({scene.plant.nx} states).")
    if beyond := largest_beyond(scene, found.open_loop.t, found.open_loop.u):
        text += paragraph(f"They are beyond the limits, which controllers keep: {beyond}.", "warning")
    motions = [("Open loop", found.nominal)]
    motions += [(f"LQR on {loop.name}", loop.motion) for loop in found.loops if loop.motion is not None]
    for name, motion in motions:
        for entry in motion.stats.get("validity", ()):
            text += paragraph(f"{name}, the motion leaves the range of its kinematics: {in_words(entry)}.", "warning")
    zero = still(scene, [found.nominal])
    if zero:
        text += paragraph(f"Zero throughout and not drawn: {', '.join(zero)}.")
    whirls = arm_outline.whirls(scene.plant, found.open_loop)
    if whirls:
        text += paragraph("The hub turns more than once: shapes are drawn as seen from it.")
    if arm_outline.in_space(scene.plant):
        text += paragraph(
            "The hub is drawn as the homogeneous box of its mass and inertia, every panel from its two long edges; "
            "what twists it is not drawn."
        )
    if not arm_outline.has_shape(scene.plant):
        return text
    motions = [("open loop", found.open_loop)]
    motions += [("LQR", loop.motion) for loop in found.loops[:1] if loop.motion is not None]
    picks = np.unique(np.linspace(0, len(scene.times) - 1, FRAMES).round().astype(int))
    data = {
        "t": [round(float(t), 4) for t in scene.times[picks]],
        "arms": [
            {"name": name, "lines": arm_outline.lines(scene.plant, m.x[picks], 13, from_hub=whirls).round(4).tolist()}
            for name, m in motions
        ],
    }
    packed = json.dumps(data, separators=(",", ":"))
    return text + (
        '<div id="arm"><svg role="img" aria-label="the arm over time"></svg><div class="controls">'
        '<button type="button">Play</button><input type="range" min="0" value="0" step="1" aria-label="time">'
        '<output></output><span class="key"></span></div>'
        f'<script type="application/json">{packed}</script></div>\n'
    )


def _kind(scene: Scene) -> str:
    """What a plant's inputs are, by their units."""
    units = {s.unit for s in scene.plant.inputs}
    return KINDS.get(units.pop(), "inputs") if len(units) == 1 else "inputs"


def _modes(found: Findings) -> str:
    modes = found.goal.modes()
    nothing = ROUNDED * max(abs(m.eigenvalue) for m in modes)
    rows = [
        (
            m.number,
            m.frequency_hz,
            m.damping_ratio if abs(m.eigenvalue.real) > nothing else 0.0,
            m.eigenvalue.real if abs(m.eigenvalue.real) > nothing else 0.0,
            m.eigenvalue.imag,
            m.dominant_state,
        )
        for m in modes
    ]
    head = ("mode", "frequency [Hz]", "damping ratio", "real part [1/s]", "imaginary part [rad/s]", "mostly in")
    space = found.scene.plant.drawn_as == "spacecraft"
    free = ", joints free" if found.scene.goal and not space and not found.scene.plant.prescribed else ""
    return paragraph(f"Modes of the linear model at the goal{free}.") + table(head, rows)


def _frequencies(found: Findings) -> str:
    space, text = found.scene.plant.drawn_as == "spacecraft", ""
    count = min(6, max((len(f) for _, f in found.frequencies), default=0))
    if count:
        held = " with the joints locked" if found.scene.goal else ""
        held = " of the free spacecraft without spin or loads, driven hinges held" if space else held
        text += paragraph(f"Undamped natural frequencies [Hz] at the goal{held}, by variant.")
        if any((f < 0).any() for _, f in found.frequencies):
            text += paragraph("A negative one stands for negative stiffness: that variant runs away from the goal.")
        locked = [(label, *_filled(f, count)) for label, f in found.frequencies]
        marked = [i for i, (label, _) in enumerate(found.frequencies) if label == found.scene.plant.label]
        text += table(("variant", *(f"{i + 1}" for i in range(count))), locked, marked=marked)
    for label, why in found.unheld:
        text += paragraph(f"{label} has none: {answer.sentence(why)}", "warning")
    return text


def _filled(values: np.ndarray, count: int) -> list[float | None]:
    """The first `count` values, None where there are fewer."""
    return [float(values[i]) if i < len(values) else None for i in range(count)]


def _goal(found: Findings) -> str:
    model = found.goal
    growing = [v.real for v in model.eigenvalues if v.real > 1e-9 * max(abs(v), 1.0)]
    state = "No eigenvalue has a positive real part."
    if growing:
        have = f"{counted(len(growing), 'eigenvalue')} {'has' if len(growing) == 1 else 'have'}"
        state = f"{have} a positive real part, the largest {max(growing):.3g} 1/s."
    text = paragraph(
        f"Exact, by automatic differentiation, {operating_point.words(model, found.scene.plant)}. {state} "
        "The matrices are in linearization.json."
    )
    if operating_point.residual(model):
        more = (
            "The goal is no equilibrium: deviations from it are not those of this model alone, its residual acts too."
        )
        text += paragraph(more, "warning")
    return text


def _along(found: Findings) -> str:
    frozen = "" if found.judgement.found else "Frozen eigenvalues describe it only where it is slow against them. "
    text = paragraph(
        f"The linear time-varying model along the open-loop motion. {frozen}To test the model, the motion is "
        "started off the nominal and its deviation in "
        f"{', '.join(found.scene.compare)} is compared with the prediction; the error should fall with power 2 "
        "of the perturbation."
    )
    rows, linear = [], all(error <= LINEAR * predicted for _, error, predicted in found.ltv_errors)
    if linear:
        text += paragraph(
            f"It does not here, because the motion is linear in {found.perturbed.name}: what is left is rounding and "
            "the tolerance of the integrator."
        )
    for i, (size, error, predicted) in enumerate(found.ltv_errors):
        power = "–"
        if i and error > 0 and not linear:
            before = found.ltv_errors[i - 1]
            power = f"{np.log(error / before[1]) / np.log(size / before[0]):.2f}"
        rows.append(
            (
                f"{size:g} {found.perturbed.unit}",
                measured(predicted, found.scene.unit),
                measured(error, found.scene.unit),
                power,
            )
        )
    head = (f"perturbation of {found.perturbed.name}", "predicted", "error of the prediction", "falls with power")
    return text + table(head, rows)
