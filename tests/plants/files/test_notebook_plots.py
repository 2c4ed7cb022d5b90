"""Pictures of motions, models and verdicts: what is drawn is what they hold, and a notebook can show it."""

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.plants import SingleLinkArm, stability

ARM = SingleLinkArm.textbook()
MOTION = ARM.simulate(np.zeros(ARM.nx), [1.0], np.linspace(0.0, 0.1, 11))


def test_a_motion_is_drawn_by_unit():
    axes = MOTION.plot("hub_angle", "tip_x", "tip_y", "hub_torque").axes
    assert [ax.get_ylabel() for ax in axes] == ["[rad]", "[m]", "[N m]"]
    assert [[line.get_label() for line in ax.lines] for ax in axes] == [
        ["hub_angle"],
        ["tip_x", "tip_y"],
        ["hub_torque"],
    ]
    np.testing.assert_array_equal(axes[1].lines[1].get_xydata(), np.column_stack([MOTION.t, MOTION["tip_y"]]))
    assert sum(len(ax.lines) for ax in MOTION.plot().axes) == len(MOTION.outputs)
    assert MOTION.plot()._repr_png_().startswith(b"\x89PNG")
    with pytest.raises(ValueError, match=r"Trajectory\['tip_z'\] must be one of"):
        MOTION.plot("tip_z")


def test_bode_is_python_controls():
    """At one frequency the curve is |C (jw - A)^-1 B + D|."""
    model = ARM.linearize(np.zeros(ARM.nx))
    found = model.bode(outputs=["tip_x", "tip_y"], omega=[10.0, 20.0], dB=False)
    at = model.output_names.index("tip_y")
    wanted = np.abs(model.C[at] @ np.linalg.solve(20j * np.eye(ARM.nx) - model.A, model.B) + model.D[at])
    drawn = [
        line.get_ydata() for ax in found.figure.axes for line in ax.lines if "magnitude" in ax.get_ylabel().lower()
    ]
    assert any(np.allclose(y[-1], wanted, rtol=1e-9) for y in drawn if len(y))


def test_a_verdict_is_drawn_by_what_it_rests_on():
    scene = scenes.get("single-link-slew", duration=0.6, move_time=0.4)
    told = stability.assess(ARM.linearize_along(scene.open_loop(rtol=1e-6)))
    labels = [ax.get_ylabel().replace("\n", " ") for ax in told.plot().axes]
    assert labels[1:] == ["largest growth [1]", "frozen real part [1/s]"] and labels[0].startswith(
        told.horizon.furthest.name
    )
    assert told.plot().axes[0].get_title(loc="left").startswith(told.verdict)
    still = stability.assess(ARM.linearize(np.zeros(ARM.nx)))
    (ax,) = still.plot().axes
    assert ax.lines[0].get_xdata().size == ARM.nx
