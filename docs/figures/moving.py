"""Moving pictures of the scenes, under LQR or in open loop: `python docs/figures/moving.py [SCENE ...]`.

Each is drawn as its environment draws it: the true deformation times the number that stands in it, mostly 1. A file
may take LARGEST bytes: where it would take more, frames are left out.
"""

import io
import sys
from pathlib import Path

import numpy as np
from PIL import Image

from pliant.envs import scenes
from pliant.envs.rendering import renderer
from pliant.envs.scenes.registry import SCENES, VARIANTS
from pliant.plants.files.atomic_files import replacing
from pliant.studies.scene_pages.returns import under_lqr

HERE = Path(__file__).parent / "moving"
SIDE, FRAMES, SECONDS = 320, 48, 4.0  # [px], at most, [s] that it plays at most
LARGEST = 300_000  # [bytes]
FORMAT = {"format": "WEBP", "save_all": True, "loop": 0, "quality": 60, "method": 4}


def frames(scene) -> tuple[list[Image.Image], float]:
    """Pictures of a motion at even times, and the seconds between them as they are shown."""
    motion = under_lqr(scene) or scene.open_loop()
    picks = np.unique(np.linspace(0, len(motion.t) - 1, FRAMES).round().astype(int))
    picture, limits = renderer(scene), np.asarray(scene.limits) if scene.limits else np.ones(scene.plant.nu)
    rates = scene.stage_cost(motion.x, motion.u, motion.y, motion.t)
    spent = np.concatenate([[0.0], np.cumsum(rates[:-1] * np.diff(motion.t))])
    drawn = []
    for k in picks:
        seen = picture.draw(motion.x[k], motion.u[k] / limits, float(motion.t[k]), spent[k])
        drawn.append(Image.fromarray(seen).resize((SIDE, SIDE), Image.Resampling.LANCZOS))
    picture.close()
    return drawn, min(float(motion.t[-1] - motion.t[0]), SECONDS) / len(picks)


def write(name: str) -> int:
    """The file of a scene; its size [bytes]."""
    drawn, between = frames(scenes.get(name))
    for each in range(1, 9):  # every one, every second, ..
        buffer = io.BytesIO()
        kept = drawn[::each]
        kept[0].save(buffer, append_images=kept[1:], duration=round(1e3 * between * each), **FORMAT)
        if len(buffer.getvalue()) <= LARGEST:
            break
    HERE.mkdir(exist_ok=True)
    with replacing(HERE / f"{name}.webp") as file:
        file.write(buffer.getvalue())
    return len(buffer.getvalue())


if __name__ == "__main__":
    for name in sys.argv[1:] or (*SCENES, *VARIANTS):
        print(name, write(name), flush=True)
