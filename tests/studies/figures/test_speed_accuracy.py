"""The chart's picture: what is drawn, that nothing is cut off, and colours for all eyes."""

import dataclasses
import itertools

import numpy as np
import pytest
from made_up_charts import made_up_chart

from pliant.studies.fidelity.speed_accuracy import LINEAR, METHODS, Reference
from pliant.studies.figures.speed_accuracy import (
    METHOD_MARKERS,
    PEER_MARKERS,
    RAMPS,
    UNTOLD,
    save,
    speed_accuracy,
    variant_colours,
)
from pliant.studies.figures.style import COLOURS, INK

FOUND = made_up_chart()
# Machado, Oliveira, Fernandes, "A physiologically-based model for simulation of color vision deficiency" (2009), the
# tables for severity 1.0, on linear RGB
BLIND = {
    "none": np.eye(3),
    "protan": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "deutan": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "tritan": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
}
# Ottosson, "A perceptual color space for image processing" (2020): linear RGB to OKLab
CONES = [[0.4122214708, 0.5363325363, 0.0514459929], [0.2119034982, 0.6806995451, 0.1073969566]]
CONES += [[0.0883024619, 0.2817188376, 0.6299787005]]
LAB = [[0.2104542553, 0.7936177850, -0.0040720468], [1.9779984951, -2.4285922050, 0.4505937099]]
LAB += [[0.0259040371, 0.7827717662, -0.8086757660]]


def oklab(colour, kind):
    share = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return np.array(LAB) @ np.cbrt(np.array(CONES) @ np.clip(np.array(BLIND[kind]) @ linear, 0, 1))


def least(colours, kind):
    return min(np.linalg.norm(oklab(a, kind) - oklab(b, kind)) for a, b in itertools.combinations(colours, 2))


@pytest.mark.parametrize("kind", BLIND)
def test_colours_are_told_apart_without_any_kind_of_cone(kind):
    """0.02 is what an eye can just tell apart in OKLab."""
    assert least(COLOURS, kind) > 0.06
    assert least(COLOURS[:4], kind) > 0.08
    for end in (0, 1):  # of the ramps that a ladder of four kinematics uses, the first in ink
        assert least([INK, *(ramp[end] for ramp in RAMPS[:3])], kind) > 0.045


def test_a_hue_for_each_kinematics_from_light_to_dark():
    labels = ("rigid", "linear, 1", "linear, 2", "strain, 3", "linear, 3")
    colours = variant_colours(labels)
    assert set(colours) == set(labels) and len(set(colours.values())) == 5 and colours["rigid"] == INK
    light = [oklab(colours[f"linear, {k}"], "none")[0] for k in (1, 2, 3)]
    assert light == sorted(light, reverse=True)
    assert set(variant_colours(("a", "b"))) == {"a", "b"} and variant_colours(()) == {}


def test_every_method_has_a_marker_of_its_own():
    assert set(METHOD_MARKERS) == {*METHODS, *LINEAR}
    assert len({*METHOD_MARKERS.values(), *PEER_MARKERS}) == len(METHOD_MARKERS) + len(PEER_MARKERS)


def test_every_measured_row_is_in_the_panel_of_its_lanes():
    one, many = speed_accuracy(FOUND).axes[:2]
    for ax, lanes in ((one, 1), (many, 1024)):
        drawn = {line.get_gid() for line in ax.lines if (line.get_gid() or "").startswith("row-")}
        assert drawn == {f"row-{i}" for i, r in enumerate(FOUND.rows) if r.failure is None and r.lanes == lanes}
    assert one.get_ylabel() == "largest error of tip_x, tip_y [m]"


def test_title_band_and_legend_tell_scene_reference_and_only_what_is_drawn():
    figure = speed_accuracy(FOUND, FOUND.fastest())
    title = figure.get_suptitle().replace("\n", " ")
    assert title == "made-up: speed against accuracy; errors from physics, strain, 5, shear, known to 20 µm"
    said = [text.get_text() for text in figure.legends[0].get_texts()]
    assert said == [
        "rigid",
        "strain, 3",
        "dop853",
        "rk4",
        "LTV along a motion",
        "linear, about the start",
        "by the stepper",
        "by it in single precision",
        "Other, chain",
        "Pareto front",
        "chosen",
        "tolerance, 1 mm",
        "not told apart from physics",
        "below ten times what physics\nis known to, 0.2 mm",
    ]


def test_what_is_not_told_apart_from_the_reference_is_an_arrow_in_its_band_as_high_as_others():
    """The reference is known to 20 um: errors of 10 um, and of another program of 150 um, are no numbers."""
    peers = (dataclasses.replace(FOUND.peers[0], error=1.5e-4),)
    rows = [r for r in FOUND.rows if r.failure is None]
    lines = speed_accuracy(made_up_chart(rows=tuple(rows), peers=peers)).axes[0].lines
    own, other = (next(line for line in lines if line.get_gid() == gid) for gid in ("row-3", "peer-0"))
    assert own.get_ydata()[0] == other.get_ydata()[0] < 2e-4
    assert own.get_marker() == other.get_marker() == UNTOLD
    above = next(line for line in lines if line.get_gid() == "row-4")
    assert above.get_ydata()[0] == 2e-4 and above.get_marker() == METHOD_MARKERS["rk4"]


def frame_of(figure, box):
    """Whether a label is within the picture: those beyond the limits of an axis are not drawn."""
    return figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1


def test_what_is_far_off_stands_at_the_edge_which_says_so():
    figure = speed_accuracy(made_up_chart(tolerance=1e-5))  # a thousand times that is 10 mm, rows err by 20
    assert figure.axes[0].get_ylabel() == "largest error of tip_x, tip_y [m]\nfrom 0.01 m on at the edge"
    (far,) = (line for line in figure.axes[0].lines if line.get_gid() == "row-0")
    assert far.get_ydata()[0] == pytest.approx(0.01)


@pytest.mark.parametrize("many", (1, 9))
def test_nothing_is_cut_off(many):
    """Texts and legend lie within the picture, also of a long ladder."""
    rows = tuple(
        r.__class__(**(vars(r) | {"variant": f"{r.variant}, {k} and a long name"}))
        for k in range(many)
        for r in FOUND.rows
    )
    physics = Reference("strain, 5, of a long name, shear, rotation only", "simulated", 2e-5)
    figure = speed_accuracy(made_up_chart(rows=rows, reference=physics))
    figure.draw_without_rendering()
    title = next(text for text in figure.texts if text.get_text() == figure.get_suptitle()).get_window_extent()
    assert not title.overlaps(figure.legends[0].get_window_extent())
    for axis in (axis for ax in figure.axes for axis in (ax.xaxis, ax.yaxis)):
        labels = [text.get_window_extent() for text in axis.get_ticklabels("both") if text.get_text()]
        labels = [box for box in labels if box.width and frame_of(figure, box)]
        assert not any(a.overlaps(b) for a, b in itertools.combinations(labels, 2))
    frame = figure.bbox
    boxes = [figure.legends[0].get_window_extent(), *(ax.get_tightbbox() for ax in figure.axes)]
    for box in boxes:
        assert box.x0 >= frame.x0 - 1 and box.x1 <= frame.x1 + 1 and box.y0 >= frame.y0 - 1 and box.y1 <= frame.y1 + 1
    assert figure.legends[0].get_window_extent().x0 >= figure.axes[1].get_window_extent().x1


def test_saved_as_its_ending_says(tmp_path):
    save(made_up_chart(rows=FOUND.rows[:1], peers=()), tmp_path / "chart.png")
    assert (tmp_path / "chart.png").read_bytes().startswith(b"\x89PNG")
