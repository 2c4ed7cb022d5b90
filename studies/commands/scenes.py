"""`pliant scenes`: what there is to play."""

from __future__ import annotations

from pliant.envs import scenes as known
from pliant.studies.common.formatting import measured
from pliant.studies.report.json_tables import scene_table

from .console import print_json, show
from .options import AsJson


def scenes(as_json: AsJson = False) -> None:
    """List the scenes."""
    found = [known.get(name) for name in known.names()]
    if as_json:
        print_json([scene_table(s) for s in found])
        return
    rows = [(s.name, s.about, s.plant.label, s.plant.nx, s.duration, measured(s.tolerance, s.unit)) for s in found]
    show("Scenes", ("name", "about", "plant", "states", "seconds", "tolerance"), rows)
