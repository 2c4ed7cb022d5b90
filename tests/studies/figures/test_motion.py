"""The pictures of a motion: which signals share a panel, and which are not drawn."""

import dataclasses

import numpy as np

from pliant.envs import scenes
from pliant.plants import Trajectory
from pliant.studies import figures
from pliant.studies.figures.motion import still


def test_panels_part_signals_of_different_size():
    """The rod's deflection is 1e-4 of the slider's way, and is drawn apart from it."""
    scene = scenes.get("slider-crank-run", duration=0.1)
    motion = scene.open_loop(rtol=1e-6, atol=1e-8)
    shown = figures.histories(scene, [("", motion)]).axes
    legends = [{text.get_text() for text in ax.get_legend().get_texts()} for ax in shown]
    assert {"slider x"} in legends and {"mid deflection"} in legends and {"crank angle rate"} in legends
    assert still(scene, [motion]) == ("crank_acceleration",)  # the crank turns steadily: no panel for that
    assert not any("crank acceleration" in legend for legend in legends)
    assert {"crank pin x", "crank pin y", "axial force", "guide force"} in legends


def test_rounding_has_no_panel_of_its_own():
    """An attitude of 1e-14 about another axis is drawn with the rest, one of 1e-4 apart."""
    scene = scenes.get("spacecraft-slew", duration=5.0)
    motion = scene.open_loop(rtol=1e-7, atol=1e-9)
    for size, panels in ((1e-14, 1), (1e-4, 2)):
        x = motion.x.copy()
        x[:, 1] = size * np.sin(motion.t)
        shown = figures.histories(scene, [("", Trajectory.from_arrays(motion.t, x, motion.u, plant=scene.plant))]).axes
        assert sum(ax.get_ylabel() == "attitude [1]" for ax in shown) == panels


def test_what_stays_zero_is_named_and_not_drawn():
    scene = scenes.get("spacecraft-slew", duration=5.0)
    motion = scene.open_loop(rtol=1e-7, atol=1e-9)
    shown = figures.histories(scene, [("", motion)]).axes
    drawn = {text.get_text().replace(" ", "_") for ax in shown for text in ax.get_legend().get_texts()}
    zero = still(scene, [motion])
    assert {"tip1_x", "torque_x"} & set(zero) and not drawn & set(zero)
    assert all(np.abs(line.get_ydata()).max() > 0 for ax in shown for line in ax.lines if len(line.get_ydata()) > 2)


def test_an_odd_last_panel_is_as_wide_as_two():
    scene = dataclasses.replace(scenes.get("six-axis-pick"), duration=0.1, move_time=0.1)
    motion = scene.plant.simulate(scene.initial[0], scene.initial[1], scene.times, rtol=1e-6, atol=1e-8)
    drawn = figures.histories(scene, [("", motion)])
    drawn.draw_without_rendering()
    places = [ax.get_position() for ax in drawn.axes]
    assert len(places) % 2 == 1 and places[-1].x0 == places[0].x0 and places[-1].x1 == places[1].x1


def test_a_flat_path_is_stretched_and_says_so():
    """A crane's load moves by meters across and by millimeters up; both axes at one scale would be a line."""
    scene = scenes.get("crane-swing", duration=0.5)
    motion = scene.open_loop(rtol=1e-6, atol=1e-8)
    (ax,) = figures.tip_path(scene, [("", motion)]).axes
    assert ax.get_aspect() == "auto" and "stretched" in ax.get_ylabel() and ax.get_ylabel().startswith("tip z")


def test_an_arm_in_space_is_drawn_in_space():
    """At one scale, its path to where the tip is measured."""
    scene = scenes.get("six-axis-pick", duration=0.05)
    motion = scene.open_loop(rtol=1e-6, atol=1e-8)
    (ax,) = figures.strobe_in_space([("open loop", scene.plant, motion)], count=2).axes
    assert [ax.get_xlabel(), ax.get_ylabel(), ax.get_zlabel()] == ["x [m]", "y [m]", "z [m]"]
    path = np.array(ax.lines[-2].get_data_3d())
    np.testing.assert_allclose(path[:, -1], [motion[f"tip_{a}"][-1] for a in "xyz"], atol=1e-9)
    sides = np.array([np.ptp(ax.get_xlim()), np.ptp(ax.get_ylim()), np.ptp(ax.get_zlim())])
    np.testing.assert_allclose(ax._box_aspect / ax._box_aspect[0], sides / sides[0], rtol=1e-9)
    views = figures.tip_path(scene, [("", motion)]).axes
    assert [v.get_ylabel()[:5] for v in views] == ["tip y", "tip z"]
