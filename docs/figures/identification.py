"""Draw the picture of docs/identification.md from what its blocks compute: a fit that holds, one that lacks damping."""

import re
from pathlib import Path

from pliant.studies.figures.style import panels, save, styled
from pliant.studies.identification.residual_plot import draw

DOCS = Path(__file__).parents[1]


@styled
def beside(names: dict) -> object:
    """Residuals of the strain gauge over its noise as each fit finds it, and their autocorrelation."""
    figure, axes = panels(2, 2, height=2.0, gridspec_kw={"width_ratios": (2.4, 1.0)})
    for row, (found, words) in enumerate(((names["found"], "with damping"), (names["wrong"], "without damping"))):
        left, right = axes[2 * row : 2 * row + 2]
        draw(left, right, found, "root_curvature")
        left.set_title(f"{words}: the gauge's residuals over {found.noise['root_curvature']:.3g} 1/m")
        right.set_ylim(-1.05, 1.05)
    axes[2].set_xlabel("time [s]")
    axes[3].set_xlabel("lag [samples]")
    return figure


if __name__ == "__main__":
    names: dict = {}
    for block in re.findall(r"```python\n(.*?)```", (DOCS / "identification.md").read_text("utf-8"), re.DOTALL)[:2]:
        exec(block, names)
    save(beside(names), DOCS / "figures" / "identification.png")
