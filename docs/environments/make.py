"""Write the environments' pages: `python docs/environments/make.py` plays each scene; returns of laws come from the
kept scoreboard.
"""

import json
from pathlib import Path

import matplotlib.image

from pliant.envs import PlantEnv, environment_id, scenes
from pliant.envs.scenes.registry import SCENES
from pliant.studies.scene_pages import markdown
from pliant.studies.scene_pages.returns import returns, under_lqr

HERE = Path(__file__).parent
SCOREBOARD = HERE.parent / "scoreboard" / "scoreboard.json"
MOMENT = 0.12  # of the episode, at which it is drawn
TOP = """# Environments

`gymnasium.make("pliant/TwoLinkReach-v0")`, or a batch: `scenes.get("two-link-reach").vector_env(1024)`. Each page says
what is observed, moved, priced, bounded and drawn, and what simple laws return; `pliant scenes NAME` prints the same
of any scene, your own included. Made by `python docs/environments/make.py`.

| scene | environment | states | actions | episode |
| --- | --- | ---: | ---: | --- |
"""


def draw(scene, path: Path) -> None:
    """The scene under LQR, or in open loop, as its environment draws it."""
    motion = under_lqr(scene) or scene.open_loop()
    env = PlantEnv(scene, render_mode="rgb_array")
    env.reset(seed=0, options={"state": motion.x[round(MOMENT * scene.steps)]})
    matplotlib.image.imsave(path, env.render())
    env.close()


kept = json.loads(SCOREBOARD.read_text(encoding="utf-8"))
lines = []
for name in SCENES:
    scene = scenes.get(name)
    draw(scene, HERE / f"{name}.png")
    (HERE / f"{name}.md").write_text(markdown(scene, returns(scene, kept), picture=f"{name}.png"), encoding="utf-8")
    lines.append(
        f"| [{name}]({name}.md) | {environment_id(name)} | {scene.plant.nx} | {scene.plant.nu} "
        f"| {scene.duration:g} s of {scene.dt:g} s |"
    )
(HERE / "index.md").write_text(TOP + "\n".join(lines) + "\n", encoding="utf-8")
