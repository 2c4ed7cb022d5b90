"""An outsider's law on the board: `my_law.py:Law`, a Python file and a name in it.

The name is a class with `for_scene(scene)`, or a class or function that is called with the scene; what comes back has
`dt`, `reads`, `reset()` and `act(t, y)`, as every controller. It is designed on the scene's own plant, told the same
tighter bounds, and played as the others are.
"""

from __future__ import annotations

import hashlib
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pliant.controllers import Controller
from pliant.envs.scene_files.own_modules import import_file
from pliant.envs.scenes.scene import Scene
from pliant.plants import PliantError
from pliant.plants.core.argument_gates import require_text, shown

PROTOCOL = {  # of every controller
    "dt": "dt [s]",
    "reads": "reads, names of states or outputs",
    "reset": "reset()",
    "act": "act(t, y)",
}


@dataclass(frozen=True)
class OwnLaw:
    """A maker of controllers that travels to other processes by its file; the digest tells one version from another."""

    path: str
    name: str
    digest: str

    @classmethod
    def of(cls, text: str) -> OwnLaw:
        """From FILE.py:NAME. ValueError where there is no such file or name in it.

        Example
        -------
        >>> scoreboard(["single-link-slew"], {"mine": OwnLaw.of("my_law.py:Law")})
        """
        path, _, name = require_text("OwnLaw", text).rpartition(":")
        if not path or not name.isidentifier():
            raise ValueError(f"--law {shown(text)} must be a Python file and a name in it: my_law.py:Law")
        place = Path(path)
        if not place.is_file():
            raise ValueError(f"--law {shown(text)}: there is no file {path!r}")
        made = cls(str(place.resolve()), name, hashlib.sha256(place.read_bytes()).hexdigest())
        made._maker()
        return made

    def __call__(self, scene: Scene) -> Controller:
        make = self._maker()
        try:
            made = getattr(make, "for_scene", make)(scene)
        except (PliantError, ValueError):
            raise
        except Exception as error:  # whatever the user's file raises
            raise PliantError(f"{self.name} of {Path(self.path).name}: {type(error).__name__}: {error}") from error
        if not isinstance(made, Controller) or isinstance(made, type):
            lacks = [name for name in PROTOCOL if isinstance(made, type) or not hasattr(made, name)]
            told = f"an object of {type(made).__name__}" if lacks != list(PROTOCOL) else shown(made)
            raise PliantError(
                f"{self.name} of {Path(self.path).name} gave {told}, must be a controller: it lacks "
                f"{', '.join(PROTOCOL[name] for name in lacks)}"
            )
        return made

    def _maker(self) -> Any:
        """What the file has under the name."""
        try:
            import_file(Path(self.path))
        except ValueError as error:
            raise ValueError(str(error).replace("--with", "--law", 1)) from error
        found = getattr(sys.modules[Path(self.path).stem], self.name, None)
        if not callable(found):
            raise ValueError(f"--law: {Path(self.path).name} has no class or function {self.name!r}")
        return found
