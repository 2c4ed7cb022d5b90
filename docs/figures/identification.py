"""Draw the picture of docs/identification.md from what its blocks compute: a fit that holds, one that lacks damping."""

import re
from pathlib import Path

import numpy as np

from pliant.plants.identification.residual_tests import autocorrelation
from pliant.studies.figures.style import COLOURS, INK, panels, save, styled

DOCS = Path(__file__).parents[1]


@styled
def beside(names: dict) -> object:
    """Residuals of the strain gauge over its noise, and their autocorrelation, of both fits."""
    figure, axes = panels(2, 2, height=2.0, gridspec_kw={"width_ratios": (2.4, 1.0)})
    for row, (found, words) in enumerate(((names["found"], "with damping"), (names["wrong"], "without damping"))):
        one = found.residuals[0]
        r = one.values[:, one.signals.index("root_curvature")] / names["noise"]["root_curvature"]
        left, right = axes[2 * row], axes[2 * row + 1]
        left.plot(one.t, r, ".", ms=1.8, color=COLOURS[row])
        left.set(title=f"{words}: residuals over the gauge's noise")
        rho = autocorrelation(r)[0]
        right.plot(np.arange(1, len(rho) + 1), rho, "o-", ms=2.5, lw=0.8, color=COLOURS[row])
        right.set(title="autocorrelation", ylim=(-1.05, 1.05))
        for end in (-1.96, 1.96):
            left.axhline(end, color=INK, lw=0.7, ls="--")
            right.axhline(end / np.sqrt(len(r)), color=INK, lw=0.7, ls="--")
    axes[2].set_xlabel("time [s]")
    axes[3].set_xlabel("lag [samples]")
    return figure


if __name__ == "__main__":
    names: dict = {}
    for block in re.findall(r"```python\n(.*?)```", (DOCS / "identification.md").read_text("utf-8"), re.DOTALL)[:2]:
        exec(block, names)
    save(beside(names), DOCS / "figures" / "identification.png")
