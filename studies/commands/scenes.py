"""`pliant scenes`: what there is to play."""

from __future__ import annotations

from pliant.envs import environment_id
from pliant.envs import scenes as known
from pliant.envs.scenes.scene import Scene
from pliant.studies.common.formatting import measured
from pliant.studies.report.json_tables import scene_table

from .console import complain, listed, print_json
from .options import AsJson


def scenes(as_json: AsJson = False) -> None:
    """List the scenes: shipped, registered by files that --with imports, and of installed packages."""
    found, refused = [], []
    for name in known.names():
        try:
            found.append(known.get(name))
        except ValueError as reason:  # another package's
            refused.append(str(reason))
    if as_json:
        print_json([scene_table(s) for s in found])
    else:
        _list(found)
    for reason in refused:
        complain(reason)


def _list(found: list[Scene]) -> None:
    entries = []
    for s in found:
        facts = (s.plant.label, f"{s.plant.nx} states", f"{s.duration:g} s")
        entries.append(
            ((s.name, environment_id(s.name)), s.about, (*facts, f"tolerance {measured(s.tolerance, s.unit)}"))
        )
    listed("Scenes", entries)
