"""The pictures of docs/methods.md, drawn from what its blocks compute: `python docs/house/pictures.py [NAME ...]`.

The page's Python blocks run in order in one namespace, as a reader would run them; each function below draws the
picture of its name (`two_link_arm` -> docs/figures/two-link-arm.png) from that namespace.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import law_pictures
import numpy as np
from matplotlib.figure import Figure

from pliant.studies.figures import arm_outline, linear_models
from pliant.studies.figures import motion as motions
from pliant.studies.figures.ladder import ladder
from pliant.studies.figures.speed_accuracy import speed_accuracy as charted_picture
from pliant.studies.figures.style import COLOURS, QUIET, panels, save, styled

DOCS = Path(__file__).parents[1]
Names = dict[str, Any]
Curve = tuple[str, np.ndarray, np.ndarray]  # label, x, y


def blocks(page: Path = DOCS / "methods.md") -> list[str]:
    """The page's Python blocks."""
    return re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)


def run(page: Path = DOCS / "methods.md") -> Names:
    """Everything that the blocks define."""
    names: Names = {}
    for block in blocks(page):
        exec(compile(block, str(page), "exec"), names)
    return names


def _lines(
    curves: list[list[Curve]],
    labels: list[str],
    *,
    x: str = "time [s]",
    height: float = 2.3,
) -> Figure:
    """Panels side by side, each a list of (label, x, y)."""
    figure, axes = panels(1, len(curves), height=height)
    for ax, inside, label in zip(axes, curves, labels):
        for k, (name, t, y) in enumerate(inside):
            ax.plot(t, y, label=name, color=COLOURS[k], ls=("-", "--", "-.")[k % 3])
        ax.set(xlabel=x, title=label)
        if any(name for name, *_ in inside):
            ax.legend()
    return figure


def two_link_arm(n: Names) -> Figure:
    return motions.stroboscopic([("let go, 1 s", n["arm"], n["swing"])])


@styled
def single_link_arm(n: Names) -> Figure:
    m = n["slew"]
    bend = 1e3 * m["tip_deflection"]
    return _lines([[("", m.t, m["hub_angle"])], [("", m.t, bend)]], ["hub angle [rad]", "tip deflection [mm]"])


@styled
def large_deflection_beam(n: Names) -> Figure:
    beam, m = n["beam"], n["drop"]
    figure, (ax,) = panels(1, height=3.2)
    picks = np.linspace(0, len(m.t) - 1, 16).round().astype(int)
    for k, shape in zip(picks, arm_outline.lines(beam, m.x[picks])):
        ax.plot(shape[:, 0], shape[:, 1], color=COLOURS[0], alpha=0.2 + 0.8 * k / len(m.t))
        ax.plot(*shape[-1, :2], ".", color=COLOURS[1])
    ax.set(xlabel="x [m]", ylabel="y [m]", title="10 m cantilever, let go: 1.54 s", aspect="equal")
    return figure


@styled
def slider_crank(n: Names) -> Figure:
    m = n["cycle"]
    turn = np.rad2deg(m["crank_angle"] - m["crank_angle"][0])
    bend = 1e6 * m["mid_deflection"]
    return _lines([[("", turn, bend)]], ["deflection of the rod's middle [um]"], x="crank angle from the start [deg]")


@styled
def flexible_tree(n: Names) -> Figure:
    figure, (ax, other) = panels(1, 2, height=3.0)
    crane, run = n["crane"], n["swung"]
    for k in range(0, 101, 20):
        for line in crane.outline(run.x[k]):
            ax.plot(*line.T, color=COLOURS[0], alpha=0.3 + 0.7 * k / 100)
    ax.set(xlabel="x [m]", ylabel="z [m]", title="every 0.2 s", aspect="equal")
    other.plot(run.t, 1e3 * run["boom_deflection_z"], color=COLOURS[1])
    other.set(xlabel="time [s]", title="deflection of the boom's end [mm]")
    return figure


def spacecraft(n: Names) -> Figure:
    return motions.snapshots(n["slewing"], [("LQR", n["turn"])])


@styled
def rotating_beam(n: Names) -> Figure:
    figure, axes = panels(1, 2, height=2.6, sharey=True)
    for ax, plane in zip(axes, ("flap", "lag")):
        for k in range(3):
            ax.plot(n["speeds"], n[plane][:, k], color=COLOURS[k], label=f"mode {k + 1}")
        ax.set(xlabel="speed of rotation", title=f"{plane}wise frequency")
    axes[0].legend()
    return figure


@styled
def linearisation(n: Names) -> Figure:
    model, hz = n["model"], n["frequencies"]
    rows = [model.output_names.index(name) for name in ("theta1", "theta2")]
    gain = np.empty((2, len(hz)))
    for k, w in enumerate(2 * np.pi * hz):
        G = model.C @ np.linalg.solve(1j * w * np.eye(len(model.A)) - model.A, model.B) + model.D
        gain[:, k] = np.abs(G[rows, [0, 1]])
    figure, (ax,) = panels(1, height=2.6)
    for k, label in enumerate(("tau1 to theta1", "tau2 to theta2")):
        ax.loglog(hz, gain[k], label=label)
    ax.set(xlabel="frequency [Hz]", title="gain [rad/(N m)], arm held at (-0.9, 0.6) rad")
    ax.legend()
    return figure


@styled
def linear_along(n: Names) -> Figure:
    k = [s.name for s in n["elastic"].outputs].index("tip_deflection")
    t, rigid = n["t"], n["ltv"].y[:, k] if hasattr(n["ltv"], "y") else 0.0
    predicted = 1e3 * (n["dy"][:, k] + rigid)
    true = 1e3 * n["truth"]["tip_deflection"]
    curves = [("truth, 4 states nonlinear", t, true), ("along the rigid slew", t, predicted)]
    off = [("", t, 1e3 * (predicted - true))]
    return _lines([curves, off], ["tip deflection [mm]", "difference [um]"])


def stability(n: Names) -> Figure:
    slow = [(f"about {axis}", np.array([v for v in m.eigenvalues if abs(v) < 1.0])) for axis, m in n["spins"].items()]
    return linear_models.eigenvalues(slow, title="Slow eigenvalues of a free spin of 0.1 rad/s")


@styled
def vary(n: Names) -> Figure:
    history, mass = np.array(n["history"]), n["mass"][:, 0]
    figure, (ax,) = panels(1, height=2.6)
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    scale = Normalize(mass.min(), mass.max())
    for k in range(0, history.shape[1], 8):
        ax.plot(0.005 * np.arange(1, 201), history[:, k], color=colormaps["viridis"](scale(mass[k])), lw=0.9)
    ax.set(xlabel="time [s]", title="theta1 [rad], arms with payloads from 0.1 to 1 kg")
    figure.colorbar(ScalarMappable(scale, "viridis"), ax=ax, label="payload [kg]")
    return figure


def choose(n: Names) -> Figure:
    return ladder(n["choice"])


@styled
def speed_accuracy(n: Names) -> Figure:
    return charted_picture(n["charted"])


def environments(n: Names) -> Figure:
    rewards = np.array(n["rewards"])
    figure, (ax,) = panels(1, height=2.3)
    ax.plot(rewards, color=QUIET, lw=0.5, alpha=0.6)
    ax.plot(np.median(rewards, axis=1), color=COLOURS[1], label="median")
    ax.set(xlabel="control period", title="reward of 64 randomised arms, no torque")
    ax.legend()
    return figure


@styled
def predictive(n: Names) -> Figure:
    found = n["motions"]
    tip = [(name, m.t, m["tip_y"]) for name, m in found.items()]
    bend = [("", m.t, 1e3 * m["tip1_deflection"]) for m in found.values()]
    return _lines([tip, bend], ["height of the tip [m]", "bending of link 1 [mm]"], height=2.6)


@styled
def plan(n: Names) -> Figure:
    found = n["gentle"].trajectory(n["elastic"])
    return _lines(
        [[("", found.t, found["hub_angle"])], [("", found.t, 1e3 * n["bend"])]],
        ["hub angle [rad]", "tip deflection [mm], within 6 mm"],
    )


@styled
def lqg(n: Names) -> Figure:
    m = n["estimated"]
    bend = 1e3 * m["tip_deflection"]
    return _lines([[("", m.t, m["hub_angle"])], [("", m.t, bend)]], ["hub angle [rad]", "tip deflection [mm]"])


@styled
def shaping(n: Names) -> Figure:
    raw, quiet = n["slew"], n["quiet"]
    curves = [("as it is", raw.t, 1e3 * raw["tip_deflection"]), ("shaped", quiet.t, 1e3 * quiet["tip_deflection"])]
    return _lines([curves], ["tip deflection [mm]"])


@styled
def policy(n: Names) -> Figure:
    from pliant.controllers import LQR

    scene, m = n["scene"], n["played"]
    best = scene.plant.simulate(scene.initial[0], LQR.for_scene(scene), scene.times)
    both = [("trained policy", m), ("LQR", best)]
    return _lines(
        [[(name, x.t, x["hub_angle"]) for name, x in both], [("", x.t, 1e3 * x["tip_deflection"]) for _, x in both]],
        ["hub angle [rad]", "tip deflection [mm]"],
    )


PICTURES: dict[str, Callable[[Names], Figure]] = {
    draw.__name__.replace("_", "-"): draw
    for draw in (
        two_link_arm,
        single_link_arm,
        large_deflection_beam,
        slider_crank,
        flexible_tree,
        spacecraft,
        rotating_beam,
        linearisation,
        linear_along,
        stability,
        vary,
        choose,
        speed_accuracy,
        environments,
        predictive,
        plan,
        lqg,
        shaping,
        policy,
        law_pictures.validity,
        law_pictures.periodic_lqr,
        law_pictures.spillover,
        law_pictures.boxes,
        law_pictures.lasting,
    )
}


def main(wanted: list[str]) -> None:
    names = run()
    for name in wanted or PICTURES:
        save(PICTURES[name](names), DOCS / "figures" / f"{name}.png")
        print(name, file=sys.stderr)


if __name__ == "__main__":
    main(sys.argv[1:])
