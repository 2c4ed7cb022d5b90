"""A plant: named signals, symbolic dynamics dx/dt = f(t, x, u, w; p) and outputs y = h(t, x, u, w; p).

A subclass states its signals and writes `ode` and `output` in CasADi expressions (`Declaration`); simulation, exact
Jacobians, linear models and equilibria follow from those two, each in its own module.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from pliant.plants.core.casadi_functions import NumericFunction, built_once, function
from pliant.plants.core.plant_protocol import Arguments
from pliant.plants.core.trajectory import Trajectory
from pliant.plants.integration.batch_stepper import Stepper
from pliant.plants.integration.simulation import Input, simulate
from pliant.plants.linear.lti import LinearModel
from pliant.plants.linear.ltv import LTVModel
from pliant.plants.native.batch_kernels import as_dtype
from pliant.plants.rows.instruction_tape import RowsRead
from pliant.plants.validity.ranges import Left, Range, left

from . import arguments, equilibrium, linear_models, python_control
from .declaration import Array
from .equilibrium import RestConditions
from .plant_contract import PlantContract

if TYPE_CHECKING:
    import control

NumericFunction.rows_read = RowsRead  # which the room of functions does not know


@dataclass(frozen=True, kw_only=True)
class Plant(PlantContract):
    """Base of all plants: what is done with what a plant states."""

    @built_once
    def _dynamics(self) -> NumericFunction:
        return function("dynamics", list(self.symbols), [self.expressions[0]])

    @built_once
    def _output(self) -> NumericFunction:
        return function("output", list(self.symbols), [self.expressions[1]])

    @built_once
    def validity(self) -> tuple[Range, ...]:
        """The ranges of this plant's kinematics, in `symbols` and `symbols_of_outputs`: see `left_ranges`."""
        t, x, u, w, _ = self.symbols
        return self.symbolic.ranges(t, x, u, w, self.symbols_of_outputs)

    @built_once
    def symbols_of_outputs(self) -> ca.SX:
        """Symbols of y (ny,)."""
        return ca.SX.sym("y", self.ny)

    @built_once
    def _measured_ranges(self) -> bool:
        """Whether any of them depends on an output."""
        return bool(ca.depends_on(ca.vertcat(0, *[r.value for r in self.validity]), self.symbols_of_outputs))

    @built_once
    def _reached(self) -> NumericFunction:
        given = [*self.symbols, self.symbols_of_outputs]
        return function("reached", given, [ca.vertcat(*[r.value for r in self.validity])])

    @built_once
    def _jacobians(self) -> NumericFunction:
        _, x, u, w, _ = self.symbols
        f, h = ca.cse(list(self.expressions))  # before they are differentiated: half as much is
        blocks = [ca.jacobian(e, s) for e in (f, h) for s in (x, u, w)]
        return function("jacobians", list(self.symbols), blocks, matrices=True)

    def slopes(self) -> ca.SX:
        """[df/dx, df/du] (nx, nx + nu) in the symbols, sparse."""
        _, x, u, _, _ = self.symbols
        return ca.jacobian(self.expressions[0], ca.vertcat(x, u))

    def _arguments(self, x: Any, u: Any = None, w: Any = None, p: Any = None, t: Any = 0.0) -> Arguments:
        """Checked (t, x, u, w, p) and the batch size (None for one point)."""
        return arguments.checked(self, x, u, w, p, t)

    def dynamics(self, x: Any, u: Any = None, *, w: Any = None, p: Any = None, t: Any = 0.0) -> Array:
        """dx/dt: (nx,) for one point; rows (B, nx) for a batch, in which any argument may be shared.

        This, `measure` and `jacobians` warn (NotFiniteWarning) of NaN and infinity at finite arguments.
        """
        values, batch = self._arguments(x, u, w, p, t)
        return arguments.told(self, "dynamics", [self._rate(values, batch)], values[1])[0]

    def _rate(self, values: tuple[Any, ...], batch: int | None) -> Array:
        return self._sound_rate(values[1], self._dynamics(*values, batch=batch))

    def _told_rates(self, values: tuple[Any, ...], results: list[Array]) -> Array:
        """What `dynamics` gives at checked arguments, and tells, from what `_dynamics` gave there: (..., nx)."""
        return arguments.told(self, "dynamics", [self._sound_rate(values[1], results)], values[1])[0]

    def measure(self, x: Any, u: Any = None, *, w: Any = None, p: Any = None, t: Any = 0.0) -> Array:
        """Outputs y: (ny,) or (B, ny)."""
        values, batch = self._arguments(x, u, w, p, t)
        return arguments.told(self, "measure", self._output(*values, batch=batch), values[1])[0]

    def jacobians(self, x: Any, u: Any = None, *, w: Any = None, p: Any = None, t: Any = 0.0) -> list[Array]:
        """[A, B, E, C, D, F] by automatic differentiation: df/dx, df/du, df/dw, dh/dx, dh/du, dh/dw."""
        values, batch = self._arguments(x, u, w, p, t)
        return arguments.told(self, "jacobians", self._jacobians(*values, batch=batch), values[1])

    def equilibrium(
        self,
        fixed: Mapping[str, float] | None = None,
        *,
        guess: Mapping[str, float] | None = None,
        p: Any = None,
        **named: float,
    ) -> tuple[Array, Array]:
        """A rest point (x0, u0) with the named states or inputs held: `equilibrium(theta1=-pi/2, theta2=0)`.

        Rates are held at zero, and so is every input unless as many states are held as there are inputs; then the
        inputs are solved for. `guess` starts the search. Raises EquilibriumError with the residual, and warns
        (UnstableRestWarning) where small deviations from the point grow.
        """
        x0, u0 = equilibrium.find(self, {} if fixed is None else fixed, named, {} if guess is None else guess, p)
        equilibrium.tell_unstable(self, x0, u0, p)
        return x0, u0

    def rest_conditions(self, p: Any = None) -> RestConditions:
        """What must vanish at rest, and its slopes."""
        return RestConditions(self, p)

    def explain_stop(self, passed: Array, last: Array, w: Any, p: Any) -> None:
        """Raise the error that says why an integration stopped at `last` (nx,) after the states `passed` (k, nx)."""

    def simulate(
        self,
        x0: Any,
        u: Input = None,
        t: Any = None,
        *,
        w: Any = None,
        p: Any = None,
        method: str = "dop853",
        step: float | None = None,
        rtol: float = 1e-10,
        atol: float = 1e-12,
        audit: bool = False,
        progress: Any = None,
    ) -> Trajectory:
        """The motion from x0 at the times t (nt,) [s].

        u: None (zero), (nu,) constant, (nt, nu) held over each interval, a callable u(t), or a controller with
        act(t, y). method: "dop853", "rodas5p", "radau", "cvodes" (adaptive, to rtol and atol; the last three if stiff),
        "rk4", "rk8", "midpoint" or "rosenbrock" (fixed `step` [s]). audit=True puts the energy balance into stats.
        Raises StabilityLimitError when a fixed step is past the method's limit, IntegrationError where it must stop.
        Warns (ValidityWarning) where the motion leaves a range of `validity`, and says so in stats["validity"].

        Fixed steps but midpoint's, and dop853's and rodas5p's under inputs held, run in compiled code where that pays:
        stats["native"] says whether all did, plants/motions/compile_rule.py when a compiler is asked. Same digits.
        """
        options: dict[str, Any] = {"method": method, "step": step, "rtol": rtol, "atol": atol}
        return simulate(self, x0, u, t, w=w, p=p, audit=audit, progress=progress, **options)

    def left_ranges(self, motion: Trajectory, *, p: Any = None) -> tuple[Left, ...]:
        """Where a motion in this plant's signals leaves the ranges of `validity`, judged at its times; () where not.

        >>> assert not arm.left_ranges(motion)  # of each: print(left.words)
        """
        return left(self, motion, p)

    def stepper(
        self,
        dt: float,
        *,
        method: str = "rk4",
        batch: int = 1,
        dtype: Any = np.float64,
        threads: int | None = None,
        substeps: int = 1,
        check: bool = True,
    ) -> Stepper:
        """A batch step `step(x, u, p) -> x` of dt [s] in `substeps` fixed steps, the input held, on a native kernel.

        x, u, p: (batch, n), or (n,) for all lanes; a Fortran-ordered (batch, nx) array is used without a copy.
        threads None: all processors for large batches. Runs on CasADi's virtual machine where nothing compiles.
        Raises StabilityLimitError where a step is past the method's limit, here at rest and then at the lanes;
        check=False leaves that to the caller. `step.sound` (batch,) tells which lanes are finite numbers.
        """
        return Stepper(self, dt, method, batch, as_dtype(dtype), threads, substeps, check)

    def linearize(self, x0: Any, u0: Any = None, *, w: Any = None, p: Any = None, t: float = 0.0) -> LinearModel:
        """The exact linear model about (x0, u0): A B E C D F by automatic differentiation, f0 the residual rate."""
        return linear_models.about(self, x0, u0, w, p, t)

    def feedback_model(self, x0: Any, u0: Any = None, *, p: Any = None) -> LinearModel:
        """The linear model about (x0, u0) in states that are the plant's signals by name, for designing feedback."""
        return self.linearize(x0, u0, p=p)

    def linearize_along(self, nominal: Trajectory, *, p: Any = None) -> LTVModel:
        """The linear time-varying model about any nominal motion given in this plant's states and inputs.

        The nominal need not satisfy the equations: its residual f(x, u) - dx/dt is kept as the affine term c(t).
        Mechanical plants are then linearised at the nominal's accelerations, not at those they would have there; see
        `MechanicalPlant`. Outputs are linearised at (x, u). `p`: (np,), or (nt, np) where parameters vary on the way.

        Where the nodes cannot show what A does (a period apart, or a pulse between two of them), `finer` is the model
        with nodes between them, up to 8 times as many, the motion as `Trajectory.resample` has it there: stability
        is judged on it. Simulation and design keep to the nodes that were asked for.
        """
        return linear_models.along(self, nominal, p)

    def _jacobians_along(self, nominal: Trajectory, w: Array, p: Any) -> list[Array]:
        """[A, B, E, C, D, F] (nt, ..) at the nodes of a nominal that need not satisfy the equations."""
        return self.jacobians(nominal.x, nominal.u, w=w, p=p, t=nominal.t)

    def jump_map(self, x: Array, P: Array, *, after: Array, p: Any = None, t: float = 0.0) -> tuple[Array, Array]:
        """(J, j) of the jump dx+ = J dx- + j of this plant's deviations, in the states of `linearize_along`,
        under an impulse P (nu,) [input units times s] at x (nx,), from where the nominal goes on at `after` (nx,).
        """
        return linear_models.over_impulse(self, x, after, P, p, t)

    def to_control(
        self,
        *,
        inputs: Any = None,
        disturbances: Any = False,
        outputs: Any = None,
        name: Any = None,
        params: Any = None,
    ) -> control.NonlinearIOSystem:
        """A python-control NonlinearIOSystem whose `linearize` is exact, in as many states as the system has.

        outputs: None (the plant's), "states", or names of outputs and states. inputs: None (all) or names, the others
        zero; disturbances: True (all) or names, as further inputs. params: defaults of varied parameters by name.
        """
        return python_control.to_control(python_control.Chosen(self, inputs, disturbances, outputs), name, params)
