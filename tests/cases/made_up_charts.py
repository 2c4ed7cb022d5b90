"""A chart with made-up numbers: rows of each path, failures, settings that were not run, other programs."""

from pliant.studies.fidelity.speed_accuracy import SPENT, Chart, Reference, Row, with_fronts
from pliant.studies.peers.peer_rows import PeerRow

UNSTABLE = "StabilityLimitError: rk4 with a step of 0.02 s is unstable"
NO_EQUILIBRIUM = "no linear model: the start is no equilibrium, d(a)/dt = 1 rad/s"


def row(variant, method, seconds, error, **more):
    """A measured row, or a failed one where `seconds` is a text."""
    step, rtol = (None, 1e-3) if method == "dop853" else (0.02, None)
    more = {"step": step, "rtol": rtol} | more
    if isinstance(seconds, str):
        return Row(variant, 4, method, failure=seconds, **more)
    own = None if more.get("path") == "linear" else error / 2
    return Row(variant, 4, method, seconds=seconds, error=error, step_error=own, runs=3, native=True, **more)


def made_up_chart(**changes):
    """Two variants; the rigid one is fast, the other exact."""
    lanes = {"path": "stepper", "lanes": 1024}
    rows = (
        row("rigid", "dop853", 1e-4, 2e-2),
        row("rigid", "rk4", 2e-4, 2e-2),
        row("rigid", "rk4", 1e-6, 2e-2, precision="single", **lanes),
        row("rigid", "linear", NO_EQUILIBRIUM, None, path="linear", step=None),
        row("strain, 3", "dop853", 3e-3, 1e-5),
        row("strain, 3", "rk4", UNSTABLE, None),
        row("strain, 3", "rk4", 1e-3, 2e-4, path="stepper", step=0.002),
        row("strain, 3", "rk4", 1e-4, 2e-4, step=0.002, **lanes),
        row("strain, 3", "rosenbrock", "not run: dominated by rigid, rk4, 20 ms", None),
        row("strain, 3", "midpoint", SPENT, None),
        row("strain, 3", "ltv", 5e-4, 3e-3, path="linear", made=0.02),
    )
    peers = (
        PeerRow("Other, chain", "20 links, 1 ms", 0.05, 5e-4, 3, 12),
        PeerRow("Third", "", failure="not installed: pip install third"),
    )
    fields = {
        "scene": "made-up",
        "compare": ("tip_x", "tip_y"),
        "tolerance": 1e-3,
        "duration": 3.0,
        "rows": with_fronts(rows),
        "reference": Reference("strain, 5, shear", "strain, 5, shear, from the motion of rigid", 2e-5),
        "machine": {"processor": "P", "pliant": "0", "evaluation": "simulate: compiled code"},
        "budget": 15.0,
        "peers": peers,
    }
    return Chart(**(fields | changes))
