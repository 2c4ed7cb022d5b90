"""Pictures of a spacecraft at several times."""

from pliant.envs import scenes
from pliant.studies.figures.motion import snapshots


def test_snapshots_show_every_motion():
    scene = scenes.get("spacecraft-orbit", duration=600.0)
    motion = scene.open_loop(rtol=1e-6, atol=1e-8)
    drawn = snapshots(scene, [("open loop", motion), ("again", motion)], count=3)
    assert len(drawn.axes) == 6
    words = {text.get_text() for text in drawn.texts}
    assert {"open loop, 0 s", "again, 0 s", "300 s", "600 s"} <= words
