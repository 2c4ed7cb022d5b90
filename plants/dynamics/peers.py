"""What other libraries get of a plant: a CasADi function for a user's own programs, a system for python-control."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import casadi as ca

from pliant.plants.core.casadi_functions import built_once

from . import python_control
from .plant_contract import PlantContract

if TYPE_CHECKING:
    import control


@dataclass(frozen=True, kw_only=True)
class ForPeers(PlantContract):
    """A `Plant` is one of these."""

    @built_once
    def _function(self) -> ca.Function:
        """Without a value p is not a number: zero would be a plant without mass."""
        options = {"default_in": [0.0, 0.0, 0.0, 0.0, float("nan") if self.varied else 0.0]}
        results = [ca.densify(e) for e in self.expressions]
        return ca.Function("plant", list(self.symbols), results, list("txuwp"), ["dx", "y"], options)

    def casadi(self) -> ca.Function:
        """A casadi.Function (t, x, u, w, p) -> (dx, y) for a user's own expressions and programs; takes SX, MX and DM.

        t [s] is a number, x (nx,), u (nu,), w (nw,), p (np,) columns in the order of `states`, `inputs`,
        `disturbances` and `parameters`; dx (nx,) is dx/dt, y (ny,) the outputs. It has all its derivatives. By name,
        t, u and w may be left out, and are zero; a parameter that is varied must be given, or all is NaN. Of a
        spacecraft x holds a unit quaternion: dx keeps its length, and y holds twice its vector part.

        >>> f = arm.casadi()
        >>> x = opti.variable(arm.nx)  # of a casadi.Opti
        >>> opti.subject_to(f(x=x, u=u)["dx"] == 0)
        """
        return self._function

    def to_control(
        self,
        *,
        outputs: Any = None,
        inputs: Any = None,
        disturbances: Any = False,
        name: str | None = None,
        params: Mapping[str, float] | None = None,
    ) -> control.NonlinearIOSystem:
        """A python-control NonlinearIOSystem whose `linearize` is exact, in as many states as the system has.

        outputs: None (the plant's), "states", or names of outputs and states. inputs: None (all) or names, the others
        zero; disturbances: True (all) or names, as further inputs. params: defaults of varied parameters by name.

        >>> system = TwoLinkArm.textbook().vary("payload.mass").to_control(outputs="states", name="arm")
        >>> control.linearize(system, x0, u0, params={"payload.mass": 2.0})
        """
        given: dict[str, Any] = {"outputs": outputs, "inputs": inputs, "disturbances": disturbances}
        return python_control.to_control(self, **given, name=name, params=params)
