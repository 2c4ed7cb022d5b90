"""What the report says of stability along the motion, of LQR on several plants and of controllers side by side."""

from __future__ import annotations

from typing import Any

from pliant.envs.scenes.registry import is_by_name
from pliant.studies.closed_loop.closed_loop import driven_to_goal
from pliant.studies.closed_loop.comparison import HORIZON, POLICY, Contest
from pliant.studies.closed_loop.scores import deflections
from pliant.studies.common.formatting import duration, number, paragraph, table
from pliant.studies.figures import arm_outline

from .findings import Findings

SHOWN = 10  # critical times
PEAK = 4  # column of the table of controllers


def verdict(found: Findings) -> str:
    """The verdict along the motion in one sentence, and what LQR stands of the scene's ranges in another."""
    told = found.judgement.found
    if told is None:
        return f"There is no stability verdict along the motion: {found.judgement.reason}."
    return f"{told.sentence} {found.judgement.over_ranges}".strip()


def played(found: Findings) -> list[Contest]:
    """The controllers that were played on the scene's own plant."""
    return [c for c in found.contests if c.plant == found.scene.plant.label and c.cost is not None]


def contest(found: Findings) -> str:
    """What the controllers cost on the scene's plant in one sentence; "" where none was played to the end."""
    own = played(found)
    if not any(c.controller != "LQR" for c in own):
        return ""
    costs = ", ".join(f"{c.controller} {number(c.cost)}{' (ended early)' if c.failure else ''}" for c in own)
    return f"Costs on the scene's own plant: open loop {number(found.scene.cost(found.open_loop))}, {costs}."


def stability(found: Findings) -> str:
    """The verdict, what decided it, when it is critical, and what every method said."""
    judged, told = found.judgement, found.judgement.found
    space = arm_outline.in_space(found.scene.plant)
    about = "along the goal's own steady motion" if found.scene.goal_rates else "along the open-loop motion"
    text = paragraph(
        f"Whether deviations from the motion grow: judged on the linear time-varying model {about}, without control. "
        "Frozen-time eigenvalues alone decide nothing; where no method can tell, the verdict is undecided; how far "
        "disturbances push the motion is told all the same."
        + (f" The same as `pliant stability {found.scene.name}`." if is_by_name(found.scene) else "")
    )
    rows: list[tuple[str, Any]] = []
    if told is None:
        text += paragraph(f"No verdict: {judged.reason}.", "warning")
    else:
        rows += [("verdict", told.verdict), ("decided by", called(told.method) if told.method else "no method")]
        rows.append(("margin", f"{number(told.margin)} 1/s; below zero, deviations grow on average"))
        if told.horizon is None:
            rows.append(("numbers of the motion", f"none: {told.no_horizon}"))
        times = ", ".join(number(t) for t in told.critical_times[:SHOWN])
        more = len(told.critical_times) - SHOWN
        rows.append(("critical times", f"{times} s{f' and {more} more' if more > 0 else ''}" if times else "none"))
        rows.append(("frozen roots in", told.coordinates or "the model's own states"))
    if judged.left_out:
        rows.append(("left out", ", ".join(judged.left_out)))
    goal = judged.at_the_goal
    if goal is not None:
        rows.append(("about the goal alone", f"{goal.verdict}: {goal.why}"))
    if rows:
        text += table(("what", "answer"), rows)
    if told is not None and told.horizon is not None:
        pushing = ", ".join(told.horizon.limits) + (" pushes" if len(told.horizon.limits) == 1 else " push")
        pushed = f"How far {pushing}, of unit energy and within limits: bounds."
        columns = ("output", "unit energy", "attained", told.horizon.limits_said, "attained", "at")
        text += paragraph(pushed) + table(columns, told.horizon.rows())
    if told is not None:
        marked = [i for i, (_, role, _) in enumerate(told.rows()) if role == "decides"]
        methods = [(called(name), role, words) for name, role, words in told.rows()]
        text += table(("method", "role", "what it says, or why it was not used"), methods, marked=marked)
        if told.critical_times:
            text += paragraph(
                "Critical times, dotted in the picture: a frozen root crosses the axis, or windows begin or cease to "
                "grow."
            )
    if space and judged.left_out:
        text += paragraph("Left out is what the rest does not feel, what is driven, and what nothing moves.")
    return text


def loops(found: Findings) -> str:
    """The LQR on plants that differ."""
    scene = found.scene
    cost = f"The open-loop motion costs {scene.cost(found.open_loop):.4g}."
    if found.law is None:
        return paragraph(f"No LQR: {found.no_law}.", "warning") + paragraph(cost)
    limits = ", ".join(f"{v:g} {s.unit}" for v, s in zip(scene.limits, scene.plant.inputs))
    start = "started at rest at the start" if scene.start_at_rest else "started at the start"
    text = paragraph(
        f"One LQR, designed from the scene's cost on {scene.plant.label} at the goal, sampled every "
        f"{duration(scene.dt)}, limited to {limits}, {start}. It reads the true states of its design model. {cost}"
    )
    if scene.goal_rates:
        moved = " and ".join(f"{name} by {rate:g} 1/s" for name, rate in scene.goal_rates)
        text += paragraph(
            f"The goal moves, {moved}: the regulator reads deviations from where the goal then is, with the gain of "
            "t = 0, and what is said of stability is of the loop frozen there."
        )
    rows = [
        (
            loop.name,
            loop.states,
            loop.cost,
            loop.final_error,
            f"{loop.saturated:.0%}" if loop.saturated is not None else "–",
            loop.verdict,
            loop.worst_mode if loop.stable else "",
        )
        for loop in found.loops
    ]
    told = driven_to_goal(scene)
    units = " or ".join(dict.fromkeys(s.unit for s in scene.signals if s.name in told))
    head = ("run on", "states", "cost", f"end error [{units}]", "at a limit", "about the goal", "least damped mode")
    text += table(head, rows)
    for loop in found.loops:
        if loop.failure and loop.stable is not None:
            text += paragraph(f"No run on {loop.name}. {loop.failure}.", "warning")
    return text


def controllers(found: Findings) -> str:
    """The table of controllers on two plants."""
    scene, contests = found.scene, found.contests
    shipped = any(c.controller == POLICY for c in contests)
    players = f"LQR, MPC (horizon {HORIZON}) and the trained policy" if shipped else f"LQR and MPC (horizon {HORIZON})"
    text = paragraph(
        f"{players}, sampled every {duration(scene.dt)}, started at the scene's start and told the true signals that "
        f"they read. {'' if shipped else 'No trained policy is shipped for this scene. '}"
        f"`pliant scoreboard` plays more controllers, with noise, delay and varied plants."
    )
    if not contests:
        return text + paragraph(f"Nothing to play: {found.no_law or 'the plant has no inputs'}.", "warning")
    if all(c.motion is None for c in contests):
        for name, reason in dict.fromkeys((c.controller, c.failure) for c in contests):
            text += paragraph(f"No {name}. {reason}.", "warning")
        return text
    if found.law is None:
        text += _reduced(found)
    units = " or ".join(dict.fromkeys(s.unit for s in scene.signals if s.name in driven_to_goal(scene)))
    bent = deflections(scene)
    peak = "peak deflection [m]" if scene.plant.deflections or not bent else f"largest {', '.join(bent)} [m]"
    head = ["on", "controller", "cost", f"end error [{units}]", peak, "at a limit", "predicted violations"]
    keep = [i for i in range(len(head)) if i != PEAK or bent]
    rows = [_row(c) for c in contests]
    text += table([head[i] for i in keep], [[row[i] for i in keep] for row in rows])
    for c in contests:
        if c.failure:
            text += paragraph(f"{c.controller} on {c.plant}: {c.failure.removesuffix('.')}.", "warning")
    text += paragraph(
        "At a limit: share of the control periods with an input at its limit. Predicted violations: acts of the MPC "
        "whose plan exceeds a bound of the scene, which it may at a price, by its own record. Lines that coincide hide "
        "each other."
    )
    unsolved = [c for c in contests if c.unsolved]
    for c in unsolved:
        text += paragraph(f"MPC on {c.plant}: {c.unsolved} of {c.acts} acts had no solution; an earlier plan went on.")
    return text


def _row(c: Contest) -> tuple[Any, ...]:
    share = "–" if c.at_limit is None else f"{c.at_limit:.0%}"
    counted = "–" if c.violations is None else f"{c.violations} of {c.acts} acts"
    return f"{c.plant} ({c.states} states)", c.controller, c.cost, c.final_error, c.peak, share, counted


def _reduced(found: Findings) -> str:
    """Why there is an LQR here although there is none on all states."""
    reads = next((c.reads for c in found.contests if c.reads), ())
    left = [name for name in found.scene.feedback_model.state_names if name not in reads]
    if not left:
        return ""
    return paragraph(
        f"These controllers leave out {', '.join(left)}, on which nothing else depends and which the cost does not "
        "see: with all states there is no LQR."
    )


def called(method: str) -> str:
    """What a method of stability is called."""
    return {"floquet": "Floquet multipliers", "lyapunov": "Lyapunov certificate"}.get(method, method.replace("_", " "))
