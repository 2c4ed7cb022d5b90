"""The report as one self-contained HTML page."""

from __future__ import annotations

import json
from collections.abc import Sequence
from html import escape
from importlib import resources
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.plants.signals import names

from . import shapes
from .chart import Row
from .fidelity import millimetres

if TYPE_CHECKING:
    from .report import Findings

FRAMES = 76  # of the arm that the slider moves


def build(found: Findings, inlined: dict[str, str]) -> str:
    """The page's text; `inlined` are the pictures as svg."""
    scene = found.scene
    sections = [
        _section("The answer", _headline(found)),
        _section("The motion", _moving(found) + _pictures(inlined, "motion", "shapes", "tip_path")),
        _section("Modes and frequencies", _modes(found)),
        _section("The linear model at the goal", _linear(found) + _pictures(inlined, "eigenvalues")),
        _section(
            "The linear model along the motion", _along(found) + _pictures(inlined, "frozen_eigenvalues")
        ),
        _section("LQR in closed loop", _loops(found) + _pictures(inlined, "closed_loop")),
        _section(
            "Speed against accuracy",
            _chart_words(found) + _pictures(inlined, "speed_accuracy", "settings") + _rows(found),
        ),
        _section("The smallest model", _choice(found) + _pictures(inlined, "ladder")),
        _section("Versions and machine", table(("what", "value"), list(found.machine.items()))),
    ]
    links = "".join(f'<a href="#{_anchor(title)}">{escape(title)}</a>' for title, _ in sections)
    body = "".join(text for _, text in sections)
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(scene.name)} - Pliant</title>\n<style>\n{_asset('page.css')}</style>\n</head>\n<body>\n"
        f"<header><h1>{escape(scene.name)}</h1><p>{escape(scene.about)}</p><nav>{links}</nav></header>\n"
        f"<main>\n{body}</main>\n<footer>Made by Pliant {escape(found.machine['pliant'])} in "
        f"{found.seconds:.0f} s.</footer>\n<script>\n{_asset('page.js')}</script>\n</body>\n</html>\n"
    )


def _asset(name: str) -> str:
    return resources.files(__package__).joinpath(name).read_text(encoding="utf-8")


def _anchor(title: str) -> str:
    return title.lower().replace(" ", "-")


def _section(title: str, body: str) -> tuple[str, str]:
    return title, f'<section id="{_anchor(title)}"><h2>{escape(title)}</h2>\n{body}</section>\n'


def _pictures(inlined: dict[str, str], *wanted: str) -> str:
    return "".join(f'<figure class="{name}">{inlined[name]}</figure>\n' for name in wanted if name in inlined)


def table(head: Sequence[str], rows: Sequence[Sequence[Any]], *, marked: Sequence[int] = ()) -> str:
    """An HTML table; numbers are set right, the `marked` rows stand out."""
    top = "".join(f"<th>{escape(h)}</th>" for h in head)
    lines = []
    for i, row in enumerate(rows):
        cells = "".join(
            f'<td class="n">{number(v)}</td>' if isinstance(v, (int, float)) else f"<td>{escape(str(v))}</td>"
            for v in row
        )
        lines.append(f'<tr class="marked">{cells}</tr>' if i in marked else f"<tr>{cells}</tr>")
    return f'<div class="wide"><table><thead><tr>{top}</tr></thead><tbody>{"".join(lines)}</tbody></table></div>\n'


def number(value: float | int | None) -> str:
    """Four digits, or a dash where there is none."""
    if value is None or (isinstance(value, float) and not np.isfinite(value)):
        return "–"
    return str(value) if isinstance(value, int) else f"{value:.4g}"


def paragraph(text: str, kind: str = "") -> str:
    """One escaped paragraph."""
    return f'<p class="{kind}">{escape(text)}</p>\n' if kind else f"<p>{escape(text)}</p>\n"


def _headline(found: Findings) -> str:
    scene, choice = found.scene, found.choice
    text = paragraph(choice.text)
    if found.scene_error > scene.tolerance:
        text += paragraph(
            f"The scene's own plant, {scene.plant.label}, is {millimetres(found.scene_error)} from the finest variant: "
            f"more than the tolerance of {millimetres(scene.tolerance)}. Open-loop positions of this page carry that "
            "error.",
            "warning",
        )
    else:
        text += paragraph(
            f"The scene's own plant, {scene.plant.label}, is {millimetres(found.scene_error)} from the finest variant, "
            f"within the tolerance of {millimetres(scene.tolerance)}."
        )
    stable = [loop for loop in found.loops if loop.stable]
    words = f"The LQR designed on it is stable on {len(stable)} of {len(found.loops)} plants"
    if found.loops[0].cost is not None:
        words += f"; on the design plant it costs {found.loops[0].cost:.4g}"
    text += paragraph(words + ".")
    for loop in found.loops:
        if not loop.stable:
            text += paragraph(f"On {loop.name}: {loop.verdict}.", "warning")
    return text


def _moving(found: Findings) -> str:
    """The arm that a slider moves, open loop and under LQR."""
    scene = found.scene
    text = paragraph(
        f"Open loop: the torques that take the rigid arm along a minimum-jerk motion of {scene.move_time:g} s, played on "
        f"{scene.plant.label} ({scene.plant.nx} states)."
    )
    if not shapes.has_shape(scene.plant):
        return text
    motions = [("open loop", found.open_loop)]
    if found.loops[0].motion is not None:
        motions.append(("LQR", found.loops[0].motion))
    picks = np.unique(np.linspace(0, len(scene.times) - 1, FRAMES).round().astype(int))
    data = {
        "t": [round(float(t), 4) for t in scene.times[picks]],
        "arms": [
            {"name": name, "lines": shapes.lines(scene.plant, m.x[picks], 13).round(4).tolist()}
            for name, m in motions
        ],
    }
    packed = json.dumps(data, separators=(",", ":"))
    return text + (
        '<div id="arm"><svg role="img" aria-label="the arm over time"></svg><div class="controls">'
        '<button type="button">Play</button><input type="range" min="0" value="0" step="1" aria-label="time">'
        f'<output></output><span class="key"></span></div><script type="application/json">{packed}</script></div>\n'
    )


def _modes(found: Findings) -> str:
    rows = [
        (m.number, m.frequency_hz, m.damping_ratio, m.eigenvalue.real, m.eigenvalue.imag, m.dominant_state)
        for m in found.goal.modes()
    ]
    text = paragraph("Modes of the linear model at the goal, joints free.")
    text += table(
        ("mode", "frequency [Hz]", "damping ratio", "real part [1/s]", "imaginary part [rad/s]", "mostly in"),
        rows,
    )
    count = min(6, max(len(f) for _, f in found.frequencies)) if found.frequencies else 0
    if count:
        text += paragraph("Undamped natural frequencies [Hz] at the goal with the joints locked, by variant.")
        locked = [
            (label, *(float(f[i]) if i < len(f) else float("nan") for i in range(count)))
            for label, f in found.frequencies
        ]
        marked = [i for i, (label, _) in enumerate(found.frequencies) if label == found.scene.plant.label]
        text += table(("variant", *(f"{i + 1}" for i in range(count))), locked, marked=marked)
    return text


def _linear(found: Findings) -> str:
    model = found.goal
    unstable = [v for v in model.eigenvalues if v.real > 1e-9 * max(abs(v), 1.0)]
    state = (
        f"{len(unstable)} eigenvalues have a positive real part, the largest {max(v.real for v in unstable):.3g} 1/s."
        if unstable
        else "No eigenvalue has a positive real part."
    )
    inputs = ", ".join(f"{n} = {v:.4g}" for n, v in zip(names(model.inputs), model.u0))
    return paragraph(
        f"Exact by automatic differentiation, at rest with {inputs} N m. {state} The matrices are in linearization.json."
    )


def _along(found: Findings) -> str:
    text = paragraph(
        "The linear time-varying model along the open-loop motion. Frozen eigenvalues describe the motion only where it "
        "is slow against them. To test the model itself the motion is started off the nominal and its deviation is "
        "compared with the prediction; the error should fall with the square of the perturbation."
    )
    rows = []
    for i, (size, error) in enumerate(found.ltv_errors):
        slope = "–"
        if i:
            before = found.ltv_errors[i - 1]
            slope = f"{np.log(error / before[1]) / np.log(size / before[0]):.2f}"
        rows.append((f"{size:g} rad", millimetres(error), slope))
    return text + table(
        ("perturbation of the first coordinate", "error of the prediction", "falls with power"), rows
    )


def _loops(found: Findings) -> str:
    scene = found.scene
    text = paragraph(
        f"One LQR, designed from the scene's cost on {scene.plant.label} at the goal, sampled every {scene.dt * 1e3:g} ms, "
        f"limited to {', '.join(f'{v:g}' for v in scene.limits)} N m, started at rest at the start. It reads the true "
        f"states of its design model. The open-loop motion costs {scene.cost(found.open_loop):.4g}."
    )
    rows = [
        (
            loop.name,
            loop.states,
            loop.cost if loop.cost is not None else float("nan"),
            loop.final_error if loop.final_error is not None else float("nan"),
            f"{loop.saturated:.0%}" if loop.saturated is not None else "–",
            loop.verdict,
            loop.worst_mode if loop.stable else "",
        )
        for loop in found.loops
    ]
    head = (
        "run on",
        "states",
        "cost",
        "error at the end",
        "at a limit",
        "about the goal",
        "least damped mode",
    )
    return text + table(head, rows)


def _chart_words(found: Findings) -> str:
    chart = found.chart
    ref = chart.reference
    text = paragraph(
        f"Each point is one variant by one method at one step. Error: largest difference of {', '.join(chart.compare)} "
        f"over the {chart.duration:g} s open-loop motion (torques held over each control period) from {ref.variant} at "
        f"rtol {ref.rtol:g}. That reference is confirmed by {ref.nearest} to {millimetres(ref.difference)}; what all "
        "variants leave out is not in it. Time: integration only, after warm-up, median of up to three runs, "
        f"{chart.machine['evaluation']}."
    )
    fast = chart.fastest()
    if fast is not None:
        text += paragraph(
            f"Fastest within the tolerance of {millimetres(chart.tolerance)}: {fast.variant} by {fast.setting}, "
            f"{(fast.seconds or 0) * 1e3:.3g} ms a simulated second."
        )
    return text


def _rows(found: Findings) -> str:
    chart = found.chart

    def line(row: Row) -> tuple[Any, ...]:
        return row.variant, row.setting, (row.seconds or 0) * 1e3, row.error or 0.0, row.step_error or 0.0

    head = ("variant", "method", "ms per simulated second", "error [m]", "of it by the step [m]")
    front = sorted((r for r in chart.measured if r.pareto), key=lambda r: r.error or 0.0)
    text = paragraph("The Pareto front:") + table(head, [line(r) for r in front])
    text += f"<details><summary>All {len(chart.measured)} measured rows</summary>"
    marked = [i for i, r in enumerate(chart.measured) if r.pareto]
    text += table(head, [line(r) for r in chart.measured], marked=marked) + "</details>\n"
    if chart.failed:
        text += f"<details><summary>{len(chart.failed)} settings without a result, and why</summary>"
        text += table(
            ("variant", "method", "reason"), [(r.variant, r.setting, r.failure) for r in chart.failed]
        )
        text += "</details>\n"
    return text


def _choice(found: Findings) -> str:
    choice = found.choice
    text = paragraph(
        "A rung of the ladder is taken when it agrees with the finest one; agreement of two neighbours is not enough, "
        "for both may lack the same effect."
    )
    rows = [
        (
            r.variant,
            r.states,
            millimetres(r.change) if r.change is not None else "–",
            millimetres(r.error),
            "chosen" if r.chosen else r.note,
        )
        for r in choice.rungs
    ]
    marked = [i for i, r in enumerate(choice.rungs) if r.chosen]
    text += table(("variant", "states", "from the next rung", "from the finest", ""), rows, marked=marked)
    effects = [
        (
            e.name,
            f"{e.chosen}, not {e.other}" if e.kept else f"{e.chosen} for {e.other}",
            millimetres(e.change),
            kept,
        )
        for e in choice.effects
        for kept in ("kept" if e.kept else "left out",)
    ]
    if effects:
        text += paragraph("What each effect is worth, changed alone in the chosen model:")
        text += table(("effect", "change", "worth", ""), effects)
    return text
