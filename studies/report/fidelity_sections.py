"""What the report says of speed against accuracy and of the smallest model."""

from __future__ import annotations

from pliant.studies.charts import page as chart_page
from pliant.studies.common.formatting import measured, paragraph, table

from .findings import Findings


def chart(found: Findings) -> str:
    """What was measured, against what, and the fastest setting within the tolerance."""
    chart = found.chart
    ref = chart.reference
    text = paragraph(
        "Each point is one variant by one method at one step. Error: largest difference of "
        f"{', '.join(chart.compare)} over the {chart.duration:g} s open-loop motion (inputs held over each control "
        f"period) from physics: {ref.how}, known to {measured(ref.uncertainty, chart.unit)}. Time: integration only, "
        f"per lane, after warm-up, median of several runs; {chart.machine['evaluation']}. The stepper is called "
        "once a control period, in one thread. The settings are under the pointer."
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
    """The tables: the Pareto fronts, all rows, what has no result."""
    return chart_page.tables(found.chart)


def choice(found: Findings) -> str:
    """The ladder and what each effect is worth."""
    choice = found.choice
    text = paragraph(choice.text) + paragraph(
        "The cheapest rung whose difference from physics, with what physics is known to, keeps the tolerance is taken; "
        "that rungs agree with each other shows nothing, as they may lack the same effect."
    )
    if choice.motions > 1:
        text += paragraph(
            f"Asked for {choice.motions} motions, the open loop and the closed loops above; `pliant choose` asks for "
            "the open loop alone, and may take a cheaper one."
        )
    if found.unasked:
        text += paragraph(
            f"Not asked for the closed loop of {' and '.join(found.unasked)}: physics of one motion takes long here.",
            "warning",
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
    text += table(("variant", "states", "from physics", "and what physics is known to", ""), rows, marked=marked)
    effects = [(e.name, measured(e.change, choice.unit), "kept" if e.kept else "left out") for e in choice.effects]
    if effects:
        text += paragraph("What each effect of physics is worth, left out alone:")
        text += table(("effect", "worth", "in the chosen model"), effects)
    return text
