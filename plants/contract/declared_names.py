"""What a plant declares: its signals, and every name by which it answers the library's questions."""

from __future__ import annotations

import pickle
from collections import Counter
from collections.abc import Iterator
from typing import Any

from pliant.plants.core.signals import Signal, names
from pliant.plants.dynamics.plant import Plant

KINDS = ("states", "inputs", "disturbances", "outputs")


def wrong_signals(plant: Plant) -> Iterator[str]:
    """Tuples of signals of distinct names, and words for the fidelity."""
    for kind in KINDS:
        found: Any = getattr(plant, kind)
        if not isinstance(found, tuple) or not all(isinstance(s, Signal) for s in found):
            yield f"{kind} = {found!r} must be a tuple of Signal(name, unit)"
            continue
        twice = [name for name, count in Counter(names(found)).items() if count > 1]
        if twice:
            yield f"{kind} has {', '.join(twice)} more than once, must have distinct names"
        if not found and kind in ("states", "outputs"):
            yield f"{kind} = () must hold one signal at least"
    if not isinstance(plant.label, str) or not plant.label:
        yield f"label = {plant.label!r} must be words that tell the fidelity"


def wrong_names(plant: Plant) -> Iterator[str]:
    """Answers that name no signal of the plant."""
    states, inputs, outputs = (names(getattr(plant, kind)) for kind in ("states", "inputs", "outputs"))
    signals = (*states, *outputs)
    asked: list[tuple[str, Any, tuple[str, ...], str]] = [
        ("rates", [*plant.rates, *plant.rates.values()], states, "state"),
        ("prescribed", plant.prescribed, (*plant.rates, *plant.attitude_states), "coordinate"),
        ("lockable", plant.lockable, tuple(plant.rates), "coordinate"),
        ("output_rates", [*plant.output_rates, *plant.output_rates.values()], signals, "state or output"),
        ("deflections", plant.deflections, outputs, "output"),
        ("attitude_states", plant.attitude_states, states, "state"),
        ("attitude_outputs", plant.attitude_outputs, outputs, "output"),
        ("small_states", plant.small_states, states, "state"),
        ("repeated", plant.repeated, states, "state"),
        ("sensors()", [s.signal for s in plant.sensors()], signals, "state or output"),
        ("joints", [j.input for j in plant.joints], inputs, "input"),
        ("joints", [n for j in plant.joints for n in (j.position, j.rate)], signals, "state or output"),
        ("seen_from", [n for n in (plant.seen_from,) if n is not None], states, "state"),
        ("cycle", [n for n in (plant.cycle,) if n is not None], states, "state"),
    ]
    for what, given, known, kind in asked:
        for name in dict.fromkeys(given):
            if name not in known:
                yield f"{what} names {name!r}, must be one of: {', '.join(known) or '(there is none)'} ({kind})"
    for joint in plant.joints:
        if joint.position in plant.rates and plant.rates[joint.position] != joint.rate:
            yield f"joints: the rate of {joint.position!r} is {plant.rates[joint.position]!r}, not {joint.rate!r}"


def wrong_ladder(plant: Plant) -> Iterator[str]:
    """Rungs that are no plants, or that share too little with the plant."""
    rungs: Any = plant.ladder()
    if not isinstance(rungs, tuple) or not rungs or not all(isinstance(rung, Plant) for rung in rungs):
        yield f"ladder() = {rungs!r} must be a tuple of plants, the cheapest first"
        return
    twice = [label for label, count in Counter(rung.label for rung in rungs).items() if count > 1]
    if twice:
        yield f"ladder() has {', '.join(map(repr, twice))} more than once, must have a label for each rung"
    units = {s.name: s.unit for s in plant.states}
    for rung in rungs:
        for kind in ("inputs", "disturbances", "outputs"):
            own, there = getattr(plant, kind), getattr(rung, kind)
            if own != there:
                lacking = [s.name for s in own if s not in there] or [s.name for s in there if s not in own]
                which = f"differ in {', '.join(lacking)}" if lacking else "stand in another order"
                yield f"ladder(): the {kind} of {rung.label!r} {which}, must be those of the plant"
        for s in rung.states:
            if units.get(s.name, s.unit) != s.unit:
                yield f"ladder(): {s.name} of {rung.label!r} is in {s.unit!r}, must be in {units[s.name]!r}"


def wrong_travel(plant: Plant) -> Iterator[str]:
    """A plant is its parameters: it has a hash, and a copy equals it."""
    hash(plant)
    if pickle.loads(pickle.dumps(plant)) != plant:
        yield "a pickled copy must equal the plant: all that it is must stand in its fields"
