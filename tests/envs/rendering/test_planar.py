"""Pictures of a scene in its plane."""

import copy
import pickle

import numpy as np
import pytest
from trolleys import trolley

from pliant.envs import scenes
from pliant.envs.rendering import renderer

LINKS = {"two-link-reach": 2, "slider-crank-run": 2, "crane-swing": 2}  # drawn; one in the other scenes
PLANE = [name for name in scenes.names() if scenes.get(name).plant.drawn_as == "links"]


@pytest.mark.every(4)
@pytest.mark.parametrize("name", PLANE)
def test_outline_ends_at_the_tip(name: str) -> None:
    """In every fidelity the drawn links start at the hub, hang together, and end where the outputs say."""
    scene = scenes.get(name)
    rng = np.random.default_rng(0)
    for plant in scene.plant.ladder():
        x = 0.05 * rng.standard_normal(plant.nx)
        if scene.name == "slider-crank-run":
            x /= 10  # its rod is a quarter of a metre long
        turning = [
            i for i, s in enumerate(plant.states[: plant.nx // 2]) if s.name.startswith(("theta", "hub", "crank"))
        ]
        x[turning] = rng.uniform(-3, 3, len(turning))
        links = np.asarray(plant.outline(x, 12))
        assert links.shape == (LINKS.get(scene.name, 1), 12, 2)
        np.testing.assert_allclose(links[0, 0], 0.0, atol=1e-15)
        np.testing.assert_allclose(links[1:, 0], links[:-1, -1])
        y = dict(zip((s.name for s in plant.outputs), plant.measure(x)))
        end = (
            [y["slider_x"], 0.0] if "slider_x" in y else [y["tip_x"], y["tip_z" if name == "crane-swing" else "tip_y"]]
        )
        np.testing.assert_allclose(links[-1, -1], end, rtol=1e-9, atol=1e-9)


@pytest.mark.every(2)
@pytest.mark.parametrize("name", ["single-link-slew", "spacecraft-slew"])
def test_a_picture_goes_on_where_its_copy_arrives(name: str) -> None:
    """Also the tip's path; a figure that was pickled has no canvas to be drawn on."""
    drawn = renderer(scenes.get(name))
    x, u = scenes.get(name).initial[0], np.zeros(scenes.get(name).plant.nu)
    drawn.draw(x, u, 0.0, 0.0)
    copies = [copy.deepcopy(drawn), copy.copy(drawn), pickle.loads(pickle.dumps(drawn))]
    picture = drawn.draw(scenes.get(name).target[0], u, 0.1, 1.0)
    for twin in copies:
        np.testing.assert_array_equal(twin.draw(scenes.get(name).target[0], u, 0.1, 1.0), picture)
        assert twin.figure is not drawn.figure


def test_two_windows_of_a_scene_are_two() -> None:
    """pyplot gives all who ask for a figure of one name the same: the second drew into the first, and closed it."""
    pyplot = pytest.importorskip("matplotlib.pyplot")
    pyplot.switch_backend("agg")
    one, two = (renderer(scenes.get("single-link-slew"), window=True) for _ in range(2))
    assert one.figure is not two.figure
    two.close()
    assert pyplot.fignum_exists(one.figure.number)
    one.close()


@pytest.mark.parametrize("far", [2.0, 50.0])
def test_a_machine_that_moves_about_is_in_the_picture(far: float) -> None:
    """A crane's root is where its trolley is; where it has left the frame of start and goal, the frame widens."""
    drawn = renderer(trolley())
    x = np.array([far, 0.1, 0.0, 0.0])
    drawn.draw(x, np.zeros(1), 0.0, 0.0)
    for links in (trolley().plant.outline(x)[0], trolley().plant.outline(trolley().target[0])[0]):
        assert all(drawn.axes.get_xlim()[0] < a < drawn.axes.get_xlim()[1] for a, _ in links)
        assert all(drawn.axes.get_ylim()[0] < b < drawn.axes.get_ylim()[1] for _, b in links)
    assert drawn._root.get_xydata()[0].tolist() == [far, 0.0]
    np.testing.assert_array_equal(copy.copy(drawn).axes.get_xlim(), drawn.axes.get_xlim())


def test_an_arm_on_a_base_keeps_its_frame() -> None:
    arm = renderer(scenes.get("two-link-reach"))
    before = arm.axes.get_xlim()
    arm.draw(scenes.get("two-link-reach").initial[0], np.zeros(2), 0.0, 0.0)
    assert arm.axes.get_xlim() == before and before[0] == -before[1]


def test_a_trolley_has_no_circle_that_it_can_reach():
    """Its rail grows as it moves; an arm's links do not."""
    assert not renderer(scenes.get("crane-swing"))._stands
    assert renderer(scenes.get("two-link-reach"))._stands
