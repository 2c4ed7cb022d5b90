"""LQG: a state feedback that acts on the estimate of a Kalman filter, both sampled at dt.

    estimate   the filter's, from the sensors and from the inputs that the feedback really gave, limits included
    law        any controller that reads the model's states, or outputs, and has `act`: LQR, MPC, ..

Without limits the poles of the loop are those of the regulator and those of the estimation error (separation;
Anderson and Moore, "Optimal Control: Linear Quadratic Methods" (1990), Section 8.2). It has no guaranteed margins
(Doyle 1978): read them with `margins`, and close the loop around dearer plants with `spillover`. `recovery` brings the
state feedback's back, where the plant allows it (loop transfer recovery). Margins at the inputs are not where stiffness
and payload err: a filter that knows of no errors there trusts its modes' frequencies, and the loop is lost where these
are others. A scene's filter is therefore told what errors of the parameters that its plant calls uncertain push,
of UNCERTAIN unless said otherwise (`parameter_noise`): on two-link-reach that costs 0.1 % on the linear model.

Guarantee   the loop of the linear model is stable. None on margins, other parameters, delay and limits.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self, final

import numpy as np

from pliant.controllers.base.controller import Controller, reading
from pliant.controllers.estimation.kalman import Kalman
from pliant.controllers.estimation.parameter_noise import linear_motion, off_by, pushed, told_parameters, uncertain_box
from pliant.controllers.estimation.process_noise import recovering, scene_noise
from pliant.controllers.estimation.sensors import Sensor
from pliant.controllers.riccati.late_inputs import delay_range
from pliant.plants.core.argument_gates import require_instance, require_number, require_seconds
from pliant.plants.core.errors import UncontrollableError, warn_caller
from pliant.plants.core.signals import OwnsArrays, names, rows_by_name
from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.ltv import LTVModel

from .lqr import LQR

if TYPE_CHECKING:
    from pliant.controllers.base.scene_protocol import CostedScene


Delay = float | tuple[float, float]  # [periods]
UNCERTAIN = 0.1  # spread of what the plant calls uncertain
READING = 1e-3  # of what a sensor reads on the way to the goal: what its model is off by, modes that it lacks


class PlainFilterWarning(UserWarning):
    """A filter was to be told of uncertain parameters and could not be."""


@final
@dataclass(eq=False)
class LQG(OwnsArrays):
    """u = law(estimate). It reads what the filter's sensors read."""

    law: Controller
    filter: Kalman
    plain: str = ""  # why `for_scene` could not tell the filter of uncertain parameters; "" where it did or was not to

    def __post_init__(self) -> None:
        require_instance("LQG.law", self.law, Controller)
        law, dt = self.law, require_instance("LQG.filter", self.filter, Kalman).dt
        if law.dt is None or abs(law.dt - dt) > 1e-9 * dt:
            raise ValueError(f"LQG.law.dt = {law.dt!r} must be the filter's, {dt:g} s")
        self._rows = self._wanted()
        self.reset()

    @classmethod
    def design(
        cls,
        model: LinearModel,
        Q: Any,
        R: Any,
        sensors: Sequence[Sensor],
        W: Mapping[str, float],
        *,
        dt: float,
        limits: Any = None,
        delay: int = 0,
        noise: str = "white",
        input_delay: Delay = 0.0,
        recovery: float = 0.0,
    ) -> Self:
        """LQR.design and Kalman.design on one continuous-time model: Q, R, limits, W, delay, noise as there.

        dt: period [s]. delay: of the readings, input_delay: of the inputs [periods], taken for known; of a range
        (low, high) the law is LQR's for the range, and the filter is told the middle. recovery: standard deviation of
        noise besides on each input, in its unit, that counts as process noise: the larger, the nearer the loop at the
        inputs comes to that of the state feedback, where no zero of the plant, sampled, is outside the unit circle
        (Doyle and Stein 1979; Maciejowski 1985 for samples).
        """
        dt = require_seconds("LQG.dt", dt)
        late, middle = _late(input_delay)
        law = LQR.design(model, Q, R, dt=dt, limits=limits, delay=late)
        W = recovering(W, dict.fromkeys(model.input_names, 1.0), recovery, dt)
        return cls(law, Kalman.design(model, sensors, W, dt=dt, delay=delay, noise=noise, input_delay=middle))

    @classmethod
    def for_scene(
        cls,
        scene: CostedScene,
        *,
        sensors: Sequence[Sensor] | None = None,
        W: Mapping[str, float] | None = None,
        delay: int = 0,
        effort: float = 1.0,
        input_delay: Delay = 0.0,
        recovery: float = 0.0,
        uncertain: float | None = None,
    ) -> Self:
        """LQR.for_scene and Kalman.for_scene. effort: a factor on what the inputs cost [-]. W: densities [unit^2 s].

        input_delay: as in `design`; recovery: as there, in limits of the inputs. uncertain: spread of the
        parameters that the plant calls uncertain, 0.1 for +-10 %, whose errors the filter counts as process noise; 0
        for a plain design. All noise is then white, not held over periods, and each reading is off by READING of
        its range besides. None: UNCERTAIN, or as 0 where W is given; also where the goal moves, the law leaves states
        out, or no such filter is found, which `plain` and a PlainFilterWarning say.
        """
        late, middle = _late(input_delay)
        law = LQR.for_scene(scene, effort=effort, delay=late)
        options: dict[str, Any] = {"delay": delay, "input_delay": middle, "recovery": recovery}
        plain = Kalman.for_scene(scene, sensors=sensors, W=W, **options)
        spread, why = _spread(uncertain, scene, law, plain, W)
        if why:
            return cls._plain(law, plain, scene, why)
        if not spread or not (box := uncertain_box(scene, spread)):
            return cls(law, plain)
        assert isinstance(plain.model, LinearModel)
        K, W = LQR.for_scene(scene).K, scene_noise(scene, W, recovery)[0]
        read = off_by(plain.sensors, plain.model, linear_motion(scene, plain.model, K), READING)
        roots = pushed(scene, plain.model, box, K)
        try:
            return cls(law, told_parameters(plain, read, roots, W, "white", scene.dt))
        except UncontrollableError as failure:
            if uncertain is not None:
                raise
            return cls._plain(law, plain, scene, str(failure).splitlines()[0])

    @classmethod
    def _plain(cls, law: Controller, plain: Kalman, scene: CostedScene, why: str) -> Self:
        """With the filter that knows of no uncertain parameters, and a warning that says why."""
        warn_caller(
            f"LQG.for_scene: the filter of {scene.name!r} is told nothing of its uncertain parameters: {why}. "
            "uncertain=0 asks for that filter",
            PlainFilterWarning,
        )
        return cls(law, plain, why)

    @property
    def dt(self) -> float:
        """[s]"""
        return self.filter.dt

    @property
    def reads(self) -> tuple[str, ...]:
        """The sensors' outputs."""
        return self.filter.reads

    def reset(self) -> None:
        """Forget the estimate and the input."""
        self.filter.reset()
        self.law.reset()
        self.u: np.ndarray | None = None  # (nu,) held since the last sample

    def act(self, t: float, y: np.ndarray) -> np.ndarray:
        """u (nu,) from the sensors' y (ns,) at time t [s]."""
        x = self.filter.step(reading("LQG.y", y, len(self.filter.sensors)), self.u)
        u = self.law.act(t, self._seen(x))
        self.u = u.copy()  # the caller may change what it gets
        return u

    def _wanted(self) -> tuple[np.ndarray, np.ndarray] | None:
        """(C, y0) of what the law reads, about the nominal; None where it reads the model's states in their order,
        under their names or others."""
        model, reads = self.filter.model, tuple(self.law.reads)
        known = names(model.states + model.outputs)
        missing = [name for name in reads if name not in known]
        renamed = len(missing) == len(reads) == len(getattr(self.law, "x0", ())) == len(model.states)
        if reads == model.state_names or renamed:
            return None
        if isinstance(model, LTVModel):
            raise ValueError(f"LQG.law.reads = {reads} must be the states {model.state_names} along a nominal")
        if missing:
            raise ValueError(f"LQG.law.reads = {missing[0]!r} must be one of {', '.join(known)}")
        at, C, _, _ = rows_by_name(model, reads)
        return C, np.concatenate([model.x0, model.y0])[at] - C @ model.x0

    def _seen(self, x: np.ndarray) -> np.ndarray:
        """What the law reads, of the estimate x (nx,); feedthrough of the held input is left out."""
        return x if self._rows is None else self._rows[0] @ x + self._rows[1]


def _spread(
    uncertain: float | None, scene: CostedScene, law: LQR, plain: Kalman, W: Mapping[str, float] | None
) -> tuple[float, str]:
    """(the spread of uncertain parameters that is asked for, why the default cannot be told); ValueError where one is
    asked for and cannot be told."""
    why = ""
    if dict(scene.goal_rates):
        why = "the goal moves"
    elif law.reads != plain.model.state_names or not isinstance(plain.model, LinearModel):
        why = "the law leaves states out"
    if uncertain is None:
        named = W is None and bool(uncertain_box(scene, UNCERTAIN))
        return (0.0, why if named else "") if why or W is not None else (UNCERTAIN, "")
    spread = require_number("LQG.uncertain", uncertain, "nonnegative")
    if not spread < 1.0:
        raise ValueError(f"LQG.uncertain = {uncertain!r} must be >= 0 and < 1, a share of the parameters")
    if spread and why:
        raise ValueError(f"LQG.uncertain = {uncertain!r} must be 0 where the goal moves or the law leaves states out")
    return spread, ""


def _late(input_delay: Delay) -> tuple[Delay, float]:
    """The delay or the range of it that a law is designed for, and the one that its filter is told [periods]."""
    low, high = delay_range("LQG", input_delay, "input_delay")
    return (low if low == high else (low, high)), (low + high) / 2
