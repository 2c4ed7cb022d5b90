"""The exported MPC on a Cortex-M4F under qemu gives the inputs that it gives here, and counts what a loop takes."""

import runpy
from pathlib import Path

import numpy as np
import pytest

from pliant.controllers import MPC
from pliant.envs import scenes

DEPLOY = Path(__file__).parents[1] / "examples" / "cortex_m4" / "deploy.py"
deploy = runpy.run_path(str(DEPLOY), run_name="deploy")


@pytest.mark.skipif(bool(deploy["missing"]()), reason=deploy["missing"]() or "all here")
def test_the_same_inputs_on_the_target(tmp_path) -> None:
    scene = scenes.get("two-link-reach")
    law = MPC.for_scene(scene)
    readings, wanted = deploy["recorded"](scene, law, 15)
    deploy["built"](tmp_path, law, readings, 2)
    run = deploy["played"](tmp_path, 2)
    assert law.record.limited > 2  # programs were solved on the target
    assert (np.abs(run.u - wanted) / np.abs(wanted).max(axis=0)).max() < 1e-5  # single precision
    assert run.known == pytest.approx(20_000, abs=2)  # main.c's loop: subs and bne 10,000 times
    assert run.instructions.min() > 120 * 12  # a product with each row of the limits at least
    assert 25_000 < run.code < 45_000 and 29_000 < run.state < 40_000  # the arrays alone are 27,000 and 29,000 bytes


def test_what_is_missing_is_told_in_words(monkeypatch) -> None:
    monkeypatch.setattr(deploy["shutil"], "which", lambda _: None)
    assert deploy["missing"]() == (
        "not here: gcc-arm-none-eabi, libnewlib-arm-none-eabi, qemu-system-arm; on Debian: apt-get install "
        "gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm"
    )
