"""`pliant simulate`, `linearize` and `identify`: one scene's motion, its linear model, its parameters from data."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from pliant.envs.scene_files.settings import with_settings
from pliant.envs.scenes.scene import Scene
from pliant.plants import Trajectory, ValidityWarning
from pliant.plants.identification.identification import COLUMNS
from pliant.plants.validity.ranges import in_words
from pliant.studies.closed_loop.closed_loop import regulator
from pliant.studies.common.operating_point import words
from pliant.studies.figures.linear_models import eigenvalues
from pliant.studies.figures.motion import histories
from pliant.studies.figures.style import save
from pliant.studies.identification import scene_data
from pliant.studies.identification.residual_plot import residual_plot
from pliant.studies.report.json_tables import linear_table, motion_table

from .console import bar, drawable, print_json, say, show, writable, writable_folder
from .options import AsJson, Picture, SceneName, Settings


def simulate(
    scene: SceneName,
    settings: Settings = None,
    lqr: Annotated[bool, typer.Option("--lqr", help="Under the scene's LQR, not its nominal inputs.")] = False,
    method: Annotated[
        str, typer.Option(help="dop853, rodas5p, radau, cvodes (with --lqr), rk4, rk8, midpoint, rosenbrock")
    ] = "dop853",
    step: Annotated[float | None, typer.Option(help="Step in s of rk4, rk8, midpoint and rosenbrock.")] = None,
    rtol: Annotated[float, typer.Option(help="Relative tolerance of the adaptive methods.")] = 1e-8,
    out: Annotated[Path | None, typer.Option(help="Save the motion as npz.")] = None,
    plot: Picture = None,
    as_json: AsJson = False,
) -> None:
    """Play a scene: its nominal inputs, or its LQR."""
    chosen = with_settings(scene, settings or [])
    if not 0 < rtol < 1:
        raise ValueError(f"--rtol {rtol} must be within (0, 1)")
    writable("--out", out)
    drawable(plot)
    motion = _simulated(chosen, lqr, {"method": method, "step": step, "rtol": rtol, "atol": rtol / 100})
    if out is not None:
        motion.save(out)
    if plot is not None:
        save(histories(chosen, [(chosen.plant.label, motion)], title=chosen.name), plot)
    if as_json:
        print_json(motion_table(chosen, motion))
        return
    rows = []
    for kind in ("outputs", "inputs"):
        for signal in getattr(motion, kind):
            values = motion[signal.name]
            rows.append(
                (
                    signal.name,
                    signal.unit,
                    *(float(v) for v in (values[0], values[-1], values.min(), values.max())),
                )
            )
    took = motion.stats["seconds"]
    caption = (
        f"{chosen.plant.label}, {method}, {motion.t[-1]:g} s simulated in {took:.3g} s, cost {chosen.cost(motion):.5g}"
    )
    show(chosen.name, ("signal", "unit", "start", "end", "least", "most"), rows, caption=caption)
    for entry in motion.stats.get("validity", ()):
        say(f"The motion leaves the range in which these kinematics hold: {in_words(entry)}.")


def _simulated(scene: Scene, lqr: bool, options: dict[str, Any]) -> Trajectory:
    title = f"simulate {scene.name}"
    with bar(title) as tell:

        def progress(t: float) -> None:
            tell(t / scene.duration, f"{t:.2f} s")

        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ValidityWarning)  # said below the table, and in the JSON's stats
            if not lqr:
                return scene.open_loop(progress=progress, **options)
            return scene.plant.simulate(scene.initial[0], regulator(scene), scene.times, progress=progress, **options)


def linearize(
    scene: SceneName,
    settings: Settings = None,
    at: Annotated[Literal["goal", "start"], typer.Option(help="Where to linearise.")] = "goal",
    plot: Picture = None,
    as_json: AsJson = False,
) -> None:
    """The exact linear model of a scene's plant at its goal or start: modes, matrices with --json."""
    chosen = with_settings(scene, settings or [])
    drawable(plot)
    model = chosen.plant.linearize(*(chosen.target if at == "goal" else chosen.initial))
    if plot is not None:
        save(eigenvalues([(chosen.plant.label, model.eigenvalues)], title=f"Eigenvalues at the {at}"), plot)
    if as_json:
        print_json({"scene": chosen.name, "plant": chosen.plant.label, "at": at, **linear_table(model)})
        return
    rows = [(m.number, m.frequency_hz, m.damping_ratio, f"{m.eigenvalue:.4g}", m.dominant_state) for m in model.modes()]
    caption = f"{chosen.plant.label}, {words(model, chosen.plant)}; matrices with --json"
    head = ("mode", "frequency [Hz]", "damping ratio", "eigenvalue [1/s]", "mostly in")
    show(f"{chosen.name}, modes at the {at}", head, rows, caption=caption)


def identify(
    scene: SceneName,
    data: Annotated[list[Path], typer.Argument(help='CSV files with columns "t \\[s]" and "SIGNAL [UNIT]".')],
    vary: Annotated[list[str], typer.Option("--vary", help="A parameter to estimate: payload.mass.")],
    settings: Settings = None,
    noise: Annotated[
        list[str] | None, typer.Option("--noise", metavar="SIGNAL=SIGMA", help="Noise of a sensor; else estimated.")
    ] = None,
    bound: Annotated[
        list[str] | None, typer.Option("--bound", metavar="NAME=LOW:HIGH", help="Bounds of a parameter.")
    ] = None,
    start: Annotated[
        Literal["scene", "rest", "unknown"], typer.Option(help="The state at the start; unknown: estimated too.")
    ] = "scene",
    hold: Annotated[Literal["zero-order", "linear"], typer.Option(help="Inputs between two samples.")] = "zero-order",
    tries: Annotated[int, typer.Option(help="Searches, from points within the bounds.")] = 1,
    out: Annotated[Path | None, typer.Option(help="Folder for the result as txt, json and png.")] = None,
    plot: Picture = None,
    as_json: AsJson = False,
) -> None:
    """Estimate parameters of a scene's plant from measured motions, with intervals and what cannot be told."""
    chosen = with_settings(scene, settings or [])
    drawable(plot)
    writable_folder("--out", out)
    levels = scene_data.numbers("--noise", noise or [], 1)
    bounds = scene_data.numbers("--bound", bound or [], 2)
    options: dict[str, Any] = {"noise": levels, "bounds": bounds, "tries": tries, "start": start, "hold": hold}
    with bar(f"identify {chosen.name}") as tell:
        found = scene_data.of_scene(chosen, data, vary, progress=tell, **options)
    if out is not None:
        scene_data.write(out, chosen, data, found)
    if plot is not None:
        save(residual_plot(found), plot)
    if as_json:
        print_json(scene_data.table(chosen, data, found))
        return
    levels_found = ", ".join(f"{name} {level:.3g}" for name, level in found.noise.items())
    caption = f"{chosen.plant.label}; {found.samples} samples; noise {levels_found}; {found.stats['seconds']:.3g} s"
    show(chosen.name, COLUMNS, found.rows(), caption=caption)
    for remark in found.remarks:
        say(f"{remark[0].upper()}{remark[1:]}.")
