"""Rows are kept for one scene, reference, machine and version."""

import dataclasses

import pytest
from made_up_charts import row

from pliant.envs import scenes
from pliant.studies.charts.kept_rows import KeptRows
from pliant.studies.common.reference_motions import Motions
from pliant.studies.fidelity.speed_accuracy import SPENT
from pliant.studies.peers.peer_rows import PeerRow

SCENE = scenes.get("single-link-slew", duration=0.3)
MACHINE = {"processor": "P", "pliant": "1"}


def opened(path, scene=SCENE, reference="strain", machine=MACHINE):
    return KeptRows(path, Motions(scene), reference, machine)


def test_rows_and_programs_come_back_but_not_what_there_was_no_time_for(tmp_path):
    path, kept = tmp_path / "rows.jsonl", [row("a", "rk4", 1e-3, 2e-3), row("a", "rk8", "IntegrationError: no", None)]
    store = opened(path)
    for one in (*kept, row("a", "cvodes", SPENT, None)):
        store.keep(one)
    peer = PeerRow("Other", "", failure="not installed")
    store.keep_peer(peer)
    again = opened(path)
    assert again.rows == kept and again.peers == [peer]


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"scene": scenes.get("single-link-slew", duration=0.4)}, "other settings of it"),
        ({"scene": dataclasses.replace(SCENE, name="mine")}, "scene 'single-link-slew', not 'mine'"),
        ({"reference": "rigid"}, "reference 'strain', not 'rigid'"),
        ({"machine": MACHINE | {"processor": "Q"}}, "machine 'P', not 'Q'"),
        ({"machine": MACHINE | {"pliant": "2"}}, "pliant '1', not '2'"),
    ],
)
def test_anothers_rows_are_refused(tmp_path, changes, told):
    path = tmp_path / "rows.jsonl"
    opened(path)
    before = path.read_text()
    with pytest.raises(ValueError) as caught:
        opened(path, **changes)
    assert f"holds rows of {told}: name another file, or remove it" in str(caught.value)
    assert path.read_text() == before


def test_nothing_is_written_where_nothing_is_kept():
    opened(None).keep(row("a", "rk4", 1e-3, 2e-3))
