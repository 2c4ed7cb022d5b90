"""Gains, functions and python-control systems in `loop`, beside python-control's own closed loop."""

import control
import numpy as np
import pytest

from pliant.controllers import Feedback, loop, margins
from pliant.controllers.analysis.linear_laws import LinearLaw
from pliant.plants import SingleLinkArm

ARM = SingleLinkArm.textbook()
MODEL = ARM.linearize(*ARM.equilibrium({"hub_angle": 0.0}))
GAIN, READS = np.array([[30.0, 8.0]]), ("hub_angle", "hub_angle_rate")
W = np.array([0.5, 3.0, 20.0])


def test_a_gain_and_a_function_are_the_feedback_that_they_are() -> None:
    wanted = loop(MODEL, Feedback(GAIN, READS)).at(W)
    assert loop(MODEL, GAIN, reads=READS).at(W) == pytest.approx(wanted, rel=1e-12)
    found = loop(MODEL, lambda y: -GAIN @ y + 1e-3 * y[0] ** 2, reads=READS).at(W)
    assert found == pytest.approx(wanted, rel=1e-8)
    held = loop(MODEL, lambda y: -GAIN @ y, reads=READS, dt=0.01)
    assert held.dt == 0.01 and margins(held).disk > 0


@pytest.mark.parametrize("dt", [0, 0.01])
def test_a_system_closes_the_loop_that_python_control_closes(dt) -> None:
    system = control.tf([60.0, 40.0], [1.0, 25.0])
    system = control.ss(system if not dt else system.sample(dt, "tustin"))
    own = loop(MODEL, system, reads=("hub_angle",))
    plant = (MODEL.discretize(dt) if dt else MODEL).to_control(outputs=("hub_angle",))
    wanted = np.sort_complex(control.feedback(plant * system, 1).poles())
    found = np.sort_complex(np.linalg.eigvals(own.closed()))
    assert found == pytest.approx(wanted, rel=1e-6)
    named = control.ss(system, inputs=["hub_angle"], outputs=["torque"])
    assert loop(MODEL, named).at(W) == pytest.approx(own.at(W))


@pytest.mark.parametrize("periods", [1, 3])
def test_a_sampled_system_with_delay_is_python_controls_loop_and_the_law_whose_readings_are_late(periods) -> None:
    dt = 0.01
    lead = control.ss(control.tf([6.0, 4.0], [1.0, 25.0]).sample(dt, "tustin"))
    late = lead * control.ss(control.tf([1.0], [1.0] + [0.0] * periods, dt))
    own = loop(MODEL, late, reads=("hub_angle",))
    plant = MODEL.discretize(dt).to_control(outputs=("hub_angle",))
    wanted = control.feedback(plant * late, 1).poles()
    found = np.linalg.eigvals(own.closed())
    assert np.poly(found).real == pytest.approx(np.poly(wanted).real, abs=1e-7)  # its zeros at the origin are multiple
    told = loop(MODEL, LinearLaw(lead.A, lead.B, lead.C, lead.D, ("hub_angle",), dt, delay=periods))
    assert told.at(W) == pytest.approx(own.at(W), rel=1e-9)
    static = loop(MODEL, lambda y: -40.0 * y, reads=("hub_angle",), dt=dt)
    assert static.at(W) == pytest.approx(loop(MODEL, control.ss([], [], [], [[40.0]], dt), reads=("hub_angle",)).at(W))


def test_what_does_not_fit_is_told() -> None:
    with pytest.raises(ValueError, match="python-control makes no states of this TransferFunction"):
        loop(MODEL, control.tf([1.0, 0.0, 0.0], [1.0, 1.0]), reads=("hub_angle",))
    with pytest.raises(ValueError, match=r"loop\.reads = None must name what a"):
        loop(MODEL, lambda y: y)
    with pytest.raises(ValueError, match=r"loop\.reads = None must name 2 of"):
        loop(MODEL, GAIN)
    with pytest.raises(ValueError, match="has 2 rows"):
        loop(MODEL, np.vstack([GAIN, GAIN]), reads=READS)
    with pytest.raises(ValueError, match="must be one of"):
        loop(MODEL, lambda y: y[:1], reads=("angle",))
    with pytest.raises(ValueError, match="give neither"):
        loop(MODEL, Feedback(GAIN, READS), reads=READS)
    with pytest.raises(ValueError, match=r"dt = 0\.1 must be None"):
        loop(MODEL, control.tf([1.0], [1.0, 1.0]), reads=("hub_angle",), dt=0.1)
