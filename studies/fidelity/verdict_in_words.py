"""A choice in a few sentences."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pliant.plants.finite_horizon.asked import listed
from pliant.studies.common.formatting import measured

if TYPE_CHECKING:
    from .choice import Choice


def headline(choice: Choice) -> str:
    """Which variant and how far it is from physics, in one sentence."""
    rung = next((r for r in choice.rungs if r.chosen), None)
    outputs = listed(choice.compare)

    def said(value: float) -> str:
        return measured(value, choice.unit)

    everywhere = f" on all {choice.motions} motions" if choice.motions > 1 else ""
    if rung is None:
        return (
            f"No variant is chosen: how far any of them is from physics{everywhere} is not known. "
            f"{choice.plant.label} ({choice.plant.nx} states) is returned unchecked."
        )
    if choice.met and len(choice.rungs) == 1 and choice.physics.startswith(f"{rung.variant},"):
        return (
            f"{rung.variant} ({rung.states} states) is the plant's only variant, and physics as far as it is modelled "
            f"here: it keeps {outputs} within {said(choice.tolerance)}{everywhere}."
        )
    if choice.met:
        return (
            f"{rung.variant} ({rung.states} states) is the cheapest variant that keeps {outputs} within "
            f"{said(choice.tolerance)} of physics{everywhere}: it is {said(rung.error or 0.0)} away."
        )
    nearest = "" if rung.error is None or rung.error == float("inf") else f", {said(rung.error)} away"
    return (
        f"No variant is shown to keep {outputs} within {said(choice.tolerance)} of physics{everywhere}; "
        f"the nearest, {rung.variant}{nearest}, is returned."
    )


def words(choice: Choice) -> str:
    """The headline, how well physics is known, what the variant leaves out and what is missing."""

    def said(value: float) -> str:
        return measured(value, choice.unit)

    parts = [headline(choice)]
    if choice.convergence < float("inf"):
        parts.append(f"Physics is {choice.physics}, known to {said(choice.convergence)}.")
    else:
        parts.append(f"{choice.physics[0].upper()}{choice.physics[1:]}.")
    if choice.beyond:
        parts.append(f"It is taken beyond what it is made for: {'; '.join(choice.beyond)}.")
    for kept, word in ((False, "Left out"), (True, "Kept")):
        each = ", ".join(f"{e.name}, {said(e.change)}" for e in choice.effects if e.kept == kept)
        if each:
            parts.append(f"{word}: {each}.")
    if choice.missing and choice.missing != (choice.physics,):  # that is told already
        word = "No model here has" if choice.met else "Missing"
        parts.append(f"{word}: {', '.join(choice.missing)}.")
    if choice.integrator is not None:
        speed = (choice.integrator.seconds or 0.0) * 1e3
        parts.append(f"Fastest integrator within it: {choice.integrator.setting}, {speed:.3g} ms a simulated second.")
    if choice.batch is not None:
        speed = (choice.batch.seconds or 0.0) * 1e6
        parts.append(f"Fastest for many: {choice.batch.setting}, {speed:.3g} us a simulated second and lane.")
    if choice.largest_step is not None:
        parts.append(f"Largest fixed step within it: {choice.largest_step.setting}.")
    failed = [r for r in choice.rungs if r.error == float("inf")]
    if failed and choice.convergence < float("inf"):  # else it is physics that has none
        parts.append(f"Without a finite motion: {'; '.join(r.variant for r in failed)}.")
    return " ".join(parts)
