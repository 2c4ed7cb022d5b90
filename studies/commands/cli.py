"""The `pliant` command: tables and pictures, or --json. Data go to stdout, progress to stderr."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from pliant.studies.common.console import Commands, bar, complain, scene_with, show
from pliant.studies.stability.verdicts import stability

from .scoreboard import scoreboard

if TYPE_CHECKING:
    from pliant.envs.scenes.scene import Scene
    from pliant.plants import Trajectory

app = typer.Typer(
    cls=Commands,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    help="Plants that bend, for people who design controllers.",
)

SceneName = Annotated[str, typer.Argument(help="A scene's name; `pliant scenes` lists them.")]
Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="Change the plant (payload.mass=0.7) or the scene (duration=5)."),
]
AsJson = Annotated[bool, typer.Option("--json", help="Write JSON to stdout in place of the table.")]
Picture = Annotated[Path | None, typer.Option("--plot", help="Draw into this file: png, svg or pdf.")]
Budget = Annotated[float, typer.Option(help="Seconds that the measurement may take.")]


def _version(wanted: bool) -> None:
    if wanted:
        from pliant.studies.common.machine import version

        print(f"pliant {version('pliant')}")
        raise typer.Exit()


@app.callback()
def common(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and end.")
    ] = False,
) -> None:
    """Plants that bend, for people who design controllers."""


def _print_json(value: Any) -> None:
    from pliant.studies.common.atomic_files import dumps

    print(dumps(value))


def _draw(figure: Any, path: Path) -> None:
    from pliant.studies.figures.style import save

    save(figure, path)


@app.command()
def scenes(as_json: AsJson = False) -> None:
    """List the scenes."""
    from pliant.envs import scenes as known
    from pliant.studies.common.formatting import measured

    found = [known.get(name) for name in known.names()]
    if as_json:
        from pliant.studies.report.json_tables import scene_table

        _print_json([scene_table(s) for s in found])
        return
    rows = [(s.name, s.about, s.plant.label, s.plant.nx, s.duration, measured(s.tolerance, s.unit)) for s in found]
    show("Scenes", ("name", "about", "plant", "states", "seconds", "tolerance"), rows)


@app.command()
def simulate(
    scene: SceneName,
    settings: Settings = None,
    lqr: Annotated[bool, typer.Option("--lqr", help="Under the scene's LQR, not its nominal inputs.")] = False,
    method: Annotated[
        str, typer.Option(help="dop853, radau, cvodes (with --lqr), rk4, rk8, midpoint, rosenbrock")
    ] = "dop853",
    step: Annotated[float | None, typer.Option(help="Step [s] of rk4, rk8, midpoint and rosenbrock.")] = None,
    rtol: Annotated[float, typer.Option(help="Relative tolerance of the adaptive methods.")] = 1e-8,
    out: Annotated[Path | None, typer.Option(help="Save the motion as npz.")] = None,
    plot: Picture = None,
    as_json: AsJson = False,
) -> None:
    """Play a scene: its nominal inputs, or its LQR."""
    chosen = scene_with(scene, settings or [])
    if not 0 < rtol < 1:
        raise ValueError(f"--rtol {rtol} must be within (0, 1)")
    motion = _simulated(chosen, lqr, {"method": method, "step": step, "rtol": rtol, "atol": rtol / 100})
    if out is not None:
        motion.save(out)
    if plot is not None:
        from pliant.studies.figures.motion import histories

        _draw(histories(chosen, [(chosen.plant.label, motion)], title=chosen.name), plot)
    if as_json:
        from pliant.studies.report.json_tables import motion_table

        _print_json(motion_table(chosen, motion))
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


def _simulated(scene: Scene, lqr: bool, options: dict[str, Any]) -> Trajectory:
    title = f"simulate {scene.name}"
    with bar(title) as tell:

        def progress(t: float) -> None:
            tell(t / scene.duration, f"{t:.2f} s")

        if not lqr:
            return scene.open_loop(progress=progress, **options)
        from pliant.studies.closed_loop.closed_loop import regulator

        return scene.plant.simulate(scene.initial[0], regulator(scene), scene.times, progress=progress, **options)


@app.command()
def linearize(
    scene: SceneName,
    settings: Settings = None,
    at: Annotated[Literal["goal", "start"], typer.Option(help="Where to linearise.")] = "goal",
    plot: Picture = None,
    as_json: AsJson = False,
) -> None:
    """The exact linear model of a scene's plant at its goal or start: modes, matrices with --json."""
    from pliant.studies.common.operating_point import words

    chosen = scene_with(scene, settings or [])
    model = chosen.plant.linearize(*(chosen.target if at == "goal" else chosen.initial))
    if plot is not None:
        from pliant.studies.figures.motion import eigenvalues

        _draw(eigenvalues([(chosen.plant.label, model.eigenvalues)], title=f"Eigenvalues at the {at}"), plot)
    if as_json:
        from pliant.studies.report.json_tables import linear_table

        _print_json({"scene": chosen.name, "plant": chosen.plant.label, "at": at, **linear_table(model)})
        return
    rows = [(m.number, m.frequency_hz, m.damping_ratio, f"{m.eigenvalue:.4g}", m.dominant_state) for m in model.modes()]
    caption = f"{chosen.plant.label}, {words(model, chosen.plant)}; matrices with --json"
    head = ("mode", "frequency [Hz]", "damping ratio", "eigenvalue [1/s]", "mostly in")
    show(f"{chosen.name}, modes at the {at}", head, rows, caption=caption)


@app.command()
def chart(
    scene: SceneName,
    settings: Settings = None,
    budget: Budget = 15.0,
    out: Annotated[Path | None, typer.Option(help="Save the table as json.")] = None,
    plot: Picture = None,
    as_json: AsJson = False,
) -> None:
    """Measure speed against accuracy: every variant of the plant, by every method, at several steps."""
    from pliant.studies.common.atomic_files import dumps
    from pliant.studies.common.formatting import measured
    from pliant.studies.fidelity.speed_accuracy import chart as measure

    chosen = scene_with(scene, settings or [])
    with bar(f"chart {chosen.name}") as tell:
        found = measure(chosen, budget=budget, progress=tell)
    found.save(out, plot)
    if as_json:
        print(dumps(found.to_json()))
        return
    front = sorted((r for r in found.measured if r.pareto), key=lambda r: r.error or 0.0)
    rows = [(r.variant, r.setting, (r.seconds or 0.0) * 1e3, r.error, r.step_error) for r in front]
    caption = (
        f"{len(found.measured)} settings measured, {len(found.failed)} without a result (see --json). "
        f"Errors are from {found.reference.variant}, confirmed by {found.reference.nearest} to "
        f"{measured(found.reference.difference, found.unit)}."
    )
    head = ("variant", "method", "ms per simulated s", f"error [{found.unit}]", f"of it by the step [{found.unit}]")
    show(f"{chosen.name}, the Pareto front", head, rows, caption=caption)


@app.command()
def choose(
    scene: SceneName,
    settings: Settings = None,
    tolerance: Annotated[float | None, typer.Option(help="Largest error [m]; the scene's own if not given.")] = None,
    plot: Picture = None,
    as_json: AsJson = False,
) -> None:
    """Find the smallest model that a scene needs. Exit code 1 where none is shown to be good enough."""
    from pliant.studies.common.formatting import measured
    from pliant.studies.fidelity.choice import choose as climb

    chosen = scene_with(scene, settings or [])
    with bar(f"choose {chosen.name}") as tell:
        found = climb(chosen, tolerance, progress=tell)
    if plot is not None:
        from pliant.studies.figures.motion import ladder

        _draw(ladder(found), plot)
    if as_json:
        _print_json(found.to_json())
    else:
        rows = [
            (
                r.variant,
                r.states,
                measured(r.change, found.unit) if r.change is not None else "-",
                measured(r.error, found.unit),
                "chosen" if r.chosen else r.note,
            )
            for r in found.rungs
        ]
        show(f"{chosen.name}, the ladder", ("variant", "states", "from the next", "from the finest", ""), rows)
        print(found.text)
    if not found.met:
        complain("no variant is shown to keep the tolerance")
        raise typer.Exit(1)


@app.command()
def train(
    scene: SceneName,
    settings: Settings = None,
    algorithm: Annotated[Literal["ppo", "sac"], typer.Option(help="Who learns.")] = "ppo",
    seed: Annotated[int, typer.Option(help="Of everything drawn at random.")] = 0,
    seconds: Annotated[float | None, typer.Option(help="Time it may take; 300 if nothing is said.")] = None,
    steps: Annotated[int | None, typer.Option(help="Environment steps, in place of a time.")] = None,
    num_envs: Annotated[int | None, typer.Option(help="Lanes; the algorithm's own number if not given.")] = None,
    threads: Annotated[int | None, typer.Option(help="Of torch; measured if not given.")] = None,
    out: Annotated[Path | None, typer.Option(help="Folder to write; trained/SCENE if not given.")] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on from the folder's checkpoint.")] = False,
    as_json: AsJson = False,
) -> None:
    """Learn to play a scene: a policy as arrays and JSON, its evaluation curve, a checkpoint to go on from."""
    import shlex

    from .train import lqr_cost, table
    from .train import train as learn

    chosen = scene_with(scene, settings or [])
    folder = Path("trained") / chosen.name if out is None else out
    words = ["pliant", "train", scene, *(w for s in settings or [] for w in ("--set", s)), "--algorithm", algorithm]
    given = {"--seed": seed, "--seconds": seconds, "--steps": steps, "--num-envs": num_envs, "--threads": threads}
    words += [w for key, value in given.items() if value is not None for w in (key, str(value))]
    try:
        found = learn(
            chosen,
            algorithm,
            seed=seed,
            seconds=seconds,
            steps=steps,
            num_envs=num_envs,
            folder=folder,
            resume=resume,
            threads=threads,
            command=shlex.join(words),
        )
    except ImportError as error:
        complain(str(error))
        raise typer.Exit(1) from None
    lqr = lqr_cost(chosen)
    if as_json:
        _print_json(table(found, lqr))
        return
    beside = f", {found.cost / lqr:.3g} times LQR's {lqr:.4g}" if lqr else ""
    print(f"cost {found.cost:.4g}{beside}")
    print(f"{found.steps:,} steps in {found.seconds:.0f} s, {found.rate:,.0f} steps/s; {found.threads}")
    print(folder)


@app.command()
def report(
    scene: SceneName,
    settings: Settings = None,
    out: Annotated[Path | None, typer.Option(help="Folder to write; reports/SCENE if not given.")] = None,
    budget: Annotated[float | None, typer.Option(help="Seconds of the chart; as time allows if not given.")] = None,
    as_json: AsJson = False,
) -> None:
    """Everything about one scene in one folder: report.html, the pictures, the tables."""
    from pliant.studies.report.report import report as write

    chosen = scene_with(scene, settings or [])
    folder = Path("reports") / chosen.name if out is None else out
    with bar(f"report {chosen.name}") as tell:
        page = write(chosen, folder, progress=tell, budget=budget)
    if as_json:
        print((folder / "report.json").read_text(encoding="utf-8"), end="")
    else:
        print(page)


@app.command()
def figures(
    paper: Annotated[str, typer.Argument(help="single-link, large-beam or slider-crank.")],
    out: Annotated[Path | None, typer.Option(help="Folder to write; figures/PAPER if not given.")] = None,
) -> None:
    """Draw the figures of the paper that a plant comes from."""
    from pliant.studies.papers.registry import write

    with bar(f"figures {paper}") as tell:
        files = write(paper, Path("figures") / paper if out is None else out, tell)
    print("\n".join(map(str, files)))


@app.command()
def doctor(as_json: AsJson = False) -> None:
    """Say which compiler and vector width serve, where the cache is, and what to do if something is missing."""
    from .doctor import advise

    advise(as_json)


@app.command()
def cache(
    action: Annotated[Literal["info", "clear", "verify"], typer.Argument(help="What to do with the compiled kernels.")],
    as_json: AsJson = False,
) -> None:
    """Show, empty or check the cache of compiled kernels; verify ends with 1 where a file is refused or damaged."""
    from .doctor import manage_cache

    if not manage_cache(action, as_json):
        raise typer.Exit(1)


app.command()(stability)
app.command()(scoreboard)


def main() -> None:
    """The console script."""
    app()
