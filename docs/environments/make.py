"""Write the environments' pages: `python docs/environments/make.py` plays each scene; returns of laws come from the
kept scoreboard.
"""

import json
from pathlib import Path

import matplotlib.image

from pliant.envs import PlantEnv, environment_id, scenes
from pliant.envs.scenes.registry import SCENES, VARIANTS
from pliant.studies.scene_pages import markdown
from pliant.studies.scene_pages.returns import returns, under_lqr

HERE = Path(__file__).parent
BOARDS = HERE.parent / "scoreboard"
MOMENT = 0.12  # of the episode, at which it is drawn
TOP = """# Environments

`gymnasium.make("pliant/TwoLinkReach-v0")`, or a batch: `scenes.get("two-link-reach").vector_env(1024)`. Each page says
what is observed, moved, priced, bounded and drawn, and what simple laws return; `pliant scenes NAME` prints all but the
returns of any scene, your own included. Made by `python docs/environments/make.py`.

Every environment takes the keywords of `pliant.envs.Task`, by `gymnasium.make(id, ...)`, `vector_env` and `sb3_env`:

| keyword | what it makes of the scene |
| --- | --- |
| reward="normalised" | in [0, 1]: 1 at the goal, 0 where an episode ends early ([learning](../learning.md)) |
| difficulty="nominal", "randomised" | nothing drawn; what the scene's page calls drawn |
| difficulty="hard" | also all that is uncertain by +-30 %, 1 % of noise, actions late by 0 or 1 period |
| sensors=True | observed are the readings of the plant's own sensors, with a data sheet's noise |
| noise=0.01 | standard deviation of each reading, over its signal's range in the nominal motion |
| action_delay=1, observation_delay=(0, 2) | whole control periods; a pair is drawn anew for each episode |
| history=3 | so many former readings and actions are observed too |
| goal_spread=0.2 | the goal is drawn about the scene's own, and where it is observed |
| terms=True | info["reward_terms"]: what each weighted signal and input adds to minus the stage cost |
| constraint="cost" | leaving a bound ends no episode: info["cost_constraint"] is 1 in a period that ends beyond |
| actions="midway" | 0 is the input midway between what holds start and goal, 1 adds half of the limit, or more |
| actions="nominal" | as "midway", but 1 adds 1.25 times the most that the nominal inputs differ from there |
| hold=5 | an action lasts so many control periods; their costs are summed, of a normalised reward the mean |
| fidelities=("rigid", "linear", "own") | each episode plays one of these models, drawn; of a mapping, by shares |

`info["cost"]` is what the scene charges, whatever the reward is; what Safety-Gymnasium calls cost is
`info["cost_constraint"]`. The `reward_threshold` of an id is LQR's return less one percent (MPC's on -gentle), of
the reward "cost" from the scene's own start. Learners with their defaults: [learning](../learning.md).

| scene | environment | states | actions | episode |
| --- | --- | ---: | ---: | --- |
"""
MOVING = """![{name}, played](../figures/moving/{name}.webp)

Played under LQR, or in open loop where there is none (`docs/figures/moving.py`). Deflections are magnified by the
number that stands in the picture: x 1 is as large as they are.

## Facts"""


def draw(scene, path: Path) -> None:
    """The scene under LQR, or in open loop, as its environment draws it."""
    motion = under_lqr(scene) or scene.open_loop()
    env = PlantEnv(scene, render_mode="rgb_array")
    env.reset(seed=0, options={"state": motion.x[round(MOMENT * scene.steps)]})
    matplotlib.image.imsave(path, env.render())
    env.close()


def boards() -> dict:
    """The second suite's rows and bounds, and the first one's of scenes that the second has not."""
    second, first = (
        json.loads((BOARDS / name).read_text("utf-8")) for name in ("suite-2/scoreboard.json", "scoreboard.json")
    )
    own = {row["scene"] for row in second["rows"]}
    return {part: second[part] + [r for r in first[part] if r["scene"] not in own] for part in ("rows", "bounds")}


kept = boards()
lines = []
for name in (*SCENES, *VARIANTS):
    scene = scenes.get(name)
    draw(scene, HERE / f"{name}.png")
    text = markdown(scene, returns(scene, kept), picture=f"{name}.png")
    (HERE / f"{name}.md").write_text(text.replace("## Facts", MOVING.format(name=name), 1), encoding="utf-8")
    lines.append(
        f"| [{name}]({name}.md) | {environment_id(name)} | {scene.plant.nx} | {scene.plant.nu} "
        f"| {scene.duration:g} s of {scene.dt:g} s |"
    )
(HERE / "index.md").write_text(TOP + "\n".join(lines) + "\n", encoding="utf-8")
