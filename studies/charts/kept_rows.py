"""Rows of a chart in a file as they are measured: a second call goes on where the first ended, or was killed.

Times compare only on one machine, and errors only of one scene and version: the file's first line says of which, and
another's is refused.
"""

from __future__ import annotations

import hashlib
from dataclasses import asdict
from pathlib import Path
from typing import Any

from pliant.studies.common.json_lines import add_line, read_lines
from pliant.studies.common.reference_motions import Motions
from pliant.studies.fidelity.speed_accuracy import SPENT, Row
from pliant.studies.peers.peer_rows import PeerRow

HEAD = "rows of"


class KeptRows:
    """The rows of one scene's chart in a file of JSON lines; None: nothing is kept."""

    def __init__(self, path: Path | None, motions: Motions, reference: str, described: dict[str, str]) -> None:
        """ValueError where the file holds the rows of another scene, reference, machine or version."""
        self.path = path
        own = {
            "scene": motions.scene.name,
            "settings": _digest(motions),
            "reference": reference,
            "machine": described["processor"],
            "pliant": described["pliant"],
        }
        lines = read_lines(path)
        self.rows: list[Row] = []
        self.peers: list[PeerRow] = []
        if not lines:
            self._add({HEAD: own})
            return
        for name, wanted in own.items():
            found = lines[0].get(HEAD, {}).get(name) if isinstance(lines[0].get(HEAD), dict) else None
            if found != wanted:
                told = "other settings of it" if name == "settings" else f"{name} {found!r}, not {wanted!r}"
                raise ValueError(f"chart.kept {str(path)!r} holds rows of {told}: name another file, or remove it")
        for line in lines[1:]:
            if "peer" in line:
                self.peers.append(PeerRow(**line))
            else:
                self.rows.append(Row(**line))

    def keep(self, row: Row) -> None:
        """One row more; those that no time was left for are asked for again."""
        if row.failure != SPENT:
            self._add(asdict(row))

    def keep_peer(self, row: PeerRow) -> None:
        """The same of another program."""
        self._add(asdict(row))

    def _add(self, line: dict[str, Any]) -> None:
        if self.path is not None:
            add_line(self.path, line)


def _digest(motions: Motions) -> str:
    """Of what the rows depend on: the plant, the times, the inputs, what is compared."""
    scene = motions.scene
    told = f"{scene.plant!r} {scene.start!r} {scene.compare!r} {scene.tolerance!r} {scene.dt!r} {scene.steps}"
    return hashlib.sha256(told.encode() + motions.held.round(9).tobytes()).hexdigest()[:16]
