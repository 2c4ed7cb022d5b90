"""Installed as `pliant`: four packages under one name, `pliant.plants`, `.envs`, `.controllers` and `.studies`.

    import pliant
    print(pliant.__version__)

Nothing is imported here, so that `import pliant.plants` stays light; the version is asked of the installed package.
"""

from typing import TYPE_CHECKING

__all__ = ["__version__"]

if TYPE_CHECKING:
    __version__: str
else:

    def __getattr__(name: str) -> str:
        if name != "__version__":
            raise AttributeError(f"module 'pliant' has no attribute {name!r}")
        from importlib import metadata

        return metadata.version("pliant")
