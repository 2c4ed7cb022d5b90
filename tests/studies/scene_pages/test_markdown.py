"""Pages as they are kept in docs/environments."""

import re
from pathlib import Path

import pytest

from pliant.envs import scenes
from pliant.envs.scenes.registry import SCENES
from pliant.studies.scene_pages import Table, markdown

KEPT = Path(__file__).parents[3] / "docs" / "environments"


@pytest.mark.parametrize("name", SCENES)
def test_the_kept_page_is_of_this_scene(name: str) -> None:
    """Its returns, which are measured, stand after the last table of the scene: `python docs/environments/make.py`."""
    kept = (KEPT / f"{name}.md").read_text(encoding="utf-8")
    kept = re.sub(r"!\[[^\n]*, played\].*?(?=## Facts)", "", kept, count=1, flags=re.DOTALL)  # the moving picture
    assert kept.startswith(markdown(scenes.get(name), picture=f"{name}.png"))
    assert "## Returns" in kept and "| zero actions |" in kept and (KEPT / f"{name}.png").is_file()
    assert f"({name}.md)" in (KEPT / "index.md").read_text(encoding="utf-8")


def test_further_tables_come_last_and_bars_do_not_break_rows() -> None:
    page = markdown(scenes.get("single-link-slew"), Table("further", ("a", "b"), (("x|y", 0.125),)))
    assert page.endswith("## Further\n\n| a | b |\n| --- | ---: |\n| x\\|y | 0.125 |\n")
