"""Files that are cut off or have flipped bits: a seeded campaign.

    python tests/campaigns/corruption.py

Each kind of file that Pliant reads back is written, damaged and read: cut off at a random length, one to three random
bits flipped, a stretch overwritten with noise or zeroed (as a disk does), bytes added, another kind's file under its
name. Right is a ValueError that names the file, or all that was written, where the damage does not touch it (spaces of
JSON). Files of version 0.1 have no checksum of their own: of them only raw errors are faults, and the wrong data that
the archive's CRC-32 and the shape of the content let pass are told.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import by_seed
import numpy as np
from file_kinds import KINDS, Kind, motion, policy

from pliant.controllers.learning import policy_files

DAMAGES = ("cut", "bits", "noise", "added", "other", "zeroed")
Write = Callable[[Path, int], object]


def _old_motion(folder: Path, version: int) -> None:
    """As version 0.1 wrote it."""
    m = motion(version)
    pairs = {kind: [[s.name, s.unit] for s in getattr(m, kind)] for kind in ("states", "outputs", "inputs")}
    about = {**pairs, "disturbances": [], "stats": {}, "hold": "linear", "format": 1}
    np.savez(folder / "run.npz", about=np.array(json.dumps(about)), t=m.t, x=m.x, u=m.u, y=m.y)


def _old_policy(folder: Path, version: int) -> None:
    """As version 0.1 wrote it: two files."""
    words, arrays = policy_files.parts_of(policy(version))
    np.savez_compressed(folder / "mine.npz", **arrays)
    (folder / "mine.json").write_text(json.dumps({"format": 1, **words}, indent=1) + "\n")


SEALED = {name: kind for name, kind in KINDS.items() if kind.sealed}
OLD = {
    "motion of 0.1": Kind("motion of 0.1", _old_motion, KINDS["motion"].read),
    "policy of 0.1": Kind("policy of 0.1", _old_policy, KINDS["policy"].read),
}
ALL = {**SEALED, **OLD}


def damaged(content: bytes, how: str, rng: np.random.Generator, other: bytes) -> bytes:
    data = bytearray(content)
    n = len(data)
    if how == "cut":
        return bytes(data[: rng.integers(n)])
    if how == "bits":
        for bit in rng.integers(8 * n, size=rng.integers(1, 4)):
            data[bit // 8] ^= 1 << bit % 8
    elif how in ("noise", "zeroed"):
        start, length = rng.integers(n), int(rng.integers(1, 400))
        part = rng.bytes(length) if how == "noise" else bytes(length)
        data[start : start + length] = part[: n - start]
    elif how == "added":
        at = rng.choice([0, n, rng.integers(n)])
        data[at:at] = rng.bytes(int(rng.integers(1, 100)))
    else:
        return other
    return bytes(data)


def run(seed: int, names: tuple[str, ...] = tuple(ALL)) -> dict[str, Any]:
    """One file of one kind, damaged 20 times."""
    rng = np.random.default_rng(seed)
    kinds = [ALL[name] for name in names]
    kind = kinds[seed % len(kinds)]
    counts = {"tried": 0, "refused": 0, "untouched": 0, "wrong": 0, "raw": 0}
    first = ""
    with tempfile.TemporaryDirectory() as there, tempfile.TemporaryDirectory() as elsewhere:
        folder = Path(there)
        kind.write(folder, 1)
        others = [k for k in kinds if k.name.split()[0] != kind.name.split()[0]]
        others[rng.integers(len(others))].write(Path(elsewhere), 2)
        foreign = next(p for p in sorted(Path(elsewhere).iterdir())).read_bytes()
        paths = sorted(folder.iterdir())
        contents = [path.read_bytes() for path in paths]
        for _ in range(20):
            which, how = int(rng.integers(len(paths))), DAMAGES[rng.integers(len(DAMAGES))]
            bad = damaged(contents[which], how, rng, foreign)
            for path, content in zip(paths, contents):
                path.write_bytes(content)
            if bad == contents[which]:
                continue
            paths[which].write_bytes(bad)
            counts["tried"] += 1
            try:
                found = kind.read(folder)
            except ValueError as error:
                named = paths[which].stem in str(error)
                counts["refused" if named else "raw"] += 1
                first = first or ("" if named else f"{how}: {error}")
            except Exception as error:
                counts["raw"] += 1
                first = first or f"{how}: {type(error).__name__}: {error}"
            else:
                counts["untouched" if found == {1} else "wrong"] += 1
    return {"seed": seed, "kind": kind.name, **counts, "first": first}


def summary(rows: list[dict[str, Any]]) -> str:
    def line(own: list[dict[str, Any]]) -> str:
        total = {name: sum(r[name] for r in own) for name in ("tried", "refused", "untouched", "wrong", "raw")}
        text = f"{total['tried']} damaged: {total['refused']} refused by name, {total['untouched']} read as written, "
        return text + f"{total['wrong']} wrong data, {total['raw']} raw errors"

    text = "with checksum: " + line([r for r in rows if r["kind"] in SEALED])
    for name in ALL:
        own = [r for r in rows if r["kind"] == name]
        text += f"\n  {name}: " + line(own) + "".join(f"\n    {r['first']}" for r in own if r["first"])[:500]
    return text


def faulty(row: dict[str, Any]) -> bool:
    return bool(row["raw"] or (row["wrong"] and row["kind"] in SEALED))


if __name__ == "__main__":
    by_seed.main(__doc__, 1000, run, summary, faulty)
