"""What the report says first: a table of the model, the stability and the controllers, and a sentence of each."""

from __future__ import annotations

from collections.abc import Callable

from pliant.plants.finite_horizon.asked import said
from pliant.studies.common.formatting import counted, measured, number, paragraph, table
from pliant.studies.fidelity.verdict_in_words import headline

from . import control_sections
from .findings import Findings, Lost

Rows = list[tuple[str, str]]


def told(found: Findings, name: str, part: Callable[[], str]) -> str:
    """What a part of the page says; where it fails, in its place why."""
    text: str | None = found.attempt(name, part)
    if text is None:
        return paragraph(f"{name}: nothing to tell. {sentence(found.lost[name])}", "warning")
    return text


def sentence(text: str) -> str:
    return text if text.endswith((".", "!", "?")) else f"{text}."


def answer(found: Findings) -> str:
    """The table, three sentences, and what warns of them."""
    return "".join(
        (
            table(("what", "answer"), rows(found)),
            told(found, "Stability in words", lambda: paragraph(control_sections.verdict(found))),
            told(found, "The smallest model in words", lambda: paragraph(headline(found.choice))),
            told(found, "Closed loop in words", lambda: _regulated(found)),
            told(found, "The scene's own plant against physics", lambda: _own_error(found)),
        )
    )


def rows(found: Findings) -> Rows:
    """What is known of model, stability and controllers, as (what, answer)."""
    return [row for part in (_model, _stability, _controllers) for row in _known(found, part)]


def _known(found: Findings, part: Callable[[Findings], Rows]) -> Rows:
    """A part's rows; none where it was not found, which the sentences below say."""
    try:
        return part(found)
    except Lost:
        return []


def _model(found: Findings) -> Rows:
    choice, unit = found.choice, found.choice.unit
    rung = next((r for r in choice.rungs if r.chosen), None)
    if rung is None:
        return [("model", "none is chosen")]
    rows = [
        ("model", f"{rung.variant}, {rung.states} states{'' if choice.met else ': not shown to keep the tolerance'}")
    ]
    if rung.error is not None and rung.error < float("inf"):
        known = f", known to {measured(choice.convergence, unit)}" if choice.convergence < float("inf") else ""
        rows.append(
            ("its error", f"{measured(rung.error, unit)} from physics{known}; asked {measured(choice.tolerance, unit)}")
        )
    fast, fixed = choice.integrator, choice.largest_step
    if fast is not None:
        rows.append(
            ("method and step", fast.setting + (f"; fixed at most {fixed.setting}" if fixed is not None else ""))
        )
        rows.append(("its speed", f"{number((fast.seconds or 0.0) * 1e3)} ms a simulated second"))
    else:
        rows.append(("method and step", "none measured is within the tolerance"))
    return rows


def _stability(found: Findings) -> Rows:
    told = found.judgement.found
    if told is None:
        return [("stability along the motion", "no verdict")]
    by = f", by {control_sections.called(told.method)}" if told.method else ""
    rows = [("stability along the motion", f"{told.verdict}{by}")]
    if told.horizon is not None:
        pushed = told.horizon.furthest
        peak, held = told.horizon.peak[pushed.name].upper, told.horizon.bounded[pushed.name].upper
        limits = told.horizon.limits_said
        beyond = "" if told.horizon.trusted else "; beyond where the linear model can be trusted"
        rows.append(
            (
                f"{pushed.name} is pushed by",
                f"at most {said(peak, pushed.unit)} of unit energy, {said(held, pushed.unit)} by {limits}{beyond}",
            )
        )
    return rows


def _controllers(found: Findings) -> Rows:
    own = control_sections.played(found)
    if not own:
        return [("LQR", "none")] if found.law is None else []
    costs = [f"{c.controller} {number(c.cost)}{' (ended early)' if c.failure else ''}" for c in own]
    return [("costs", f"{', '.join(costs)}; open loop {number(found.scene.cost(found.open_loop))}")]


def _own_error(found: Findings) -> str:
    scene, tolerance = found.scene, measured(found.scene.tolerance, found.scene.unit)
    away = measured(found.scene_error, scene.unit)
    own = f"The scene's own plant, {scene.plant.label}, is {away} from the finest variant"
    if found.scene_error > scene.tolerance:
        more = f"{own}: more than the tolerance of {tolerance}. Positions on this page carry that error."
        return paragraph(more, "warning")
    return ""


def _regulated(found: Findings) -> str:
    costs = control_sections.contest(found)
    if found.law is None:
        return paragraph(f"There is no LQR about the goal. {sentence(found.no_law)}", "warning") + (
            paragraph(costs) if costs else ""
        )
    stable = [loop for loop in found.loops if loop.stable]
    words = f"The LQR designed on it is stable on {len(stable)} of {counted(len(found.loops), 'plant')}"
    if found.loops[0].cost is not None and not costs:
        words += f"; on the design plant it costs {found.loops[0].cost:.4g}"
    text = paragraph(f"{words}. {costs}".strip())
    for loop in found.loops:
        if not loop.stable:
            text += paragraph(f"On {loop.name}: {loop.verdict}.", "warning")
    return text
