"""Draw the README's picture: the arm's motion beside the measured chart of speed against accuracy."""

import io
from pathlib import Path

import matplotlib.image
import matplotlib.pyplot as plt

from pliant.controllers import LQR
from pliant.envs import scenes
from pliant.studies import chart
from pliant.studies.figures import save, speed_accuracy, stroboscopic


def picture(figure) -> "matplotlib.image.AxesImage":
    """A figure as pixels."""
    buffer = io.BytesIO()
    figure.savefig(buffer, dpi=150, format="png", bbox_inches="tight")
    buffer.seek(0)
    return matplotlib.image.imread(buffer)


scene = scenes.get("two-link-reach")
motion = scene.plant.simulate(scene.initial[0], LQR.for_scene(scene), scene.times)
images = [
    picture(stroboscopic([("LQR", scene.plant, motion)], until=1.2)),
    picture(speed_accuracy(chart(scene, budget=40.0))),
]
widths = [image.shape[1] / image.shape[0] for image in images]
figure, axes = plt.subplots(1, 2, figsize=(4.2 * sum(widths), 4.2), width_ratios=widths, layout="constrained")
for ax, image in zip(axes, images):
    ax.imshow(image)
    ax.axis("off")
save(figure, Path(__file__).with_name("hero.png"))
