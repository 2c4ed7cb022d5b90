"""A sample of tests/campaigns/planted_faults.py and sound_kernels.py; the whole is run by `make campaign`."""

import planted_faults
import pytest
import sound_kernels

from pliant.plants.native import kernel_loader

pytestmark = pytest.mark.skipif(not kernel_loader.wanted(), reason="PLIANT_NATIVE=0: nothing is compiled")


def test_faults_that_change_a_result_are_caught_and_sound_kernels_pass(monkeypatch):
    """Of two small kernels in both precisions: every kind of fault, and none."""
    names = ("link rates", "spin-up control")
    monkeypatch.setattr(planted_faults, "POINTS", 128)
    every = planted_faults.kernels.small()
    monkeypatch.setattr(planted_faults.kernels, "small", lambda: {name: every[name] for name in names})
    rows = [planted_faults.run(seed) for seed in range(1000, 1010)]
    states = [row["state"] for row in rows]
    assert states.count("caught") >= 5 and not {"missed", "refused"} & set(states), rows
    assert "sound" in states


def test_the_campaign_counts_shares_and_what_was_missed():
    row = {"seed": 1, "kernel": "k", "precision": "float64", "fault": "sign", "error": 9.0, "line": "x"}
    rows = [row | {"state": state} for state in 3 * ["caught"] + ["missed", "equivalent", "sound"]]
    assert planted_faults.shares(rows) == {"float64": 0.75, "float32": 1.0}
    assert "missed: 1 k float64 sign 9 x" in planted_faults.summary(rows) and planted_faults._failed[-1]


def test_a_sound_kernel_has_room(monkeypatch):
    monkeypatch.setattr(sound_kernels, "names", lambda: [("spin-up point rates", "float64")])
    for name in ("CC", "PLIANT_CFLAGS", "PLIANT_NATIVE"):
        monkeypatch.setenv(name, "")
    row = sound_kernels.run(0)
    sound_kernels.compiler.toolchain.cache_clear()
    assert row["state"] in ("sound", "no such compiler") and max(row.get("z", [0.0])) < 2.0
    assert "refused" in sound_kernels.summary([row])
