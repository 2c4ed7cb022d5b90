"""What the report says of speed against accuracy and of the smallest model."""

from __future__ import annotations

from typing import Any

from pliant.studies.common.formatting import details, measured, paragraph, table
from pliant.studies.fidelity.speed_accuracy import Row

from .findings import Findings


def chart(found: Findings) -> str:
    """What was measured, against what, and the fastest setting within the tolerance."""
    chart = found.chart
    ref = chart.reference
    text = paragraph(
        "Each point is one variant by one method at one step. Error: largest difference of "
        f"{', '.join(chart.compare)} over the {chart.duration:g} s open-loop motion (inputs held over each control "
        f"period) from physics: {ref.how}, known to {measured(ref.uncertainty, chart.unit)}. Time: integration only, "
        f"after warm-up, median of up to three runs; {chart.machine['evaluation']}."
    )
    fast = chart.fastest()
    for variant, words in chart.outside:
        text += paragraph(f"{variant} leaves the range of its kinematics: {words}.", "warning")
    if not chart.measured:
        return text + paragraph("No setting was measured: see below why.", "warning")
    if fast is None:
        left = f"; {chart.not_run} were not run for want of time" if chart.not_run else ""
        bound = measured(chart.tolerance, chart.unit)
        return text + paragraph(f"No setting that was measured is within {bound}{left}.", "warning")
    return text + paragraph(
        f"Fastest within the tolerance of {measured(chart.tolerance, chart.unit)}: {fast.variant} by {fast.setting}, "
        f"{(fast.seconds or 0) * 1e3:.3g} ms a simulated second."
    )


def front(found: Findings) -> str:
    """The tables: the Pareto front, all rows, what has no result."""
    chart = found.chart

    def line(row: Row) -> tuple[Any, ...]:
        return row.variant, row.setting, (row.seconds or 0) * 1e3, row.error, row.step_error

    head = (
        "variant",
        "method",
        "ms per simulated second",
        f"error [{chart.unit}]",
        f"of it by the step [{chart.unit}]",
    )
    best = sorted((r for r in chart.measured if r.pareto), key=lambda r: r.error or 0.0)
    marked = [i for i, r in enumerate(chart.measured) if r.pareto]
    text = paragraph("The Pareto front:") + table(head, [line(r) for r in best])
    everything = table(head, [line(r) for r in chart.measured], marked=marked)
    text += details(f"All {len(chart.measured)} measured rows", everything)
    if chart.failed:
        reasons = table(("variant", "method", "reason"), [(r.variant, r.setting, r.failure) for r in chart.failed])
        text += details(f"{len(chart.failed)} settings without a result, and why", reasons)
    return text


def choice(found: Findings) -> str:
    """The ladder and what each effect is worth."""
    choice = found.choice
    text = paragraph(
        "The cheapest rung whose difference from physics, with what physics is known to, keeps the tolerance is taken; "
        "that rungs agree with each other shows nothing, as they may lack the same effect."
    )
    rows = [
        (
            r.variant,
            r.states,
            measured(r.error, choice.unit) if r.error is not None else "–",
            measured(r.bound, choice.unit) if r.bound is not None else "–",
            "chosen" if r.chosen else r.note,
        )
        for r in choice.rungs
    ]
    marked = [i for i, r in enumerate(choice.rungs) if r.chosen]
    text += table(("variant", "states", "from physics", "at most", ""), rows, marked=marked)
    effects = [(e.name, measured(e.change, choice.unit), "kept" if e.kept else "left out") for e in choice.effects]
    if effects:
        text += paragraph("What each effect of physics is worth, left out alone:")
        text += table(("effect", "worth", "in the chosen model"), effects)
    return text
