"""Plants for python-control: a NonlinearIOSystem that keeps python-control's contract and whose linearisation is exact.

Parameters that are varied are `params=` by name, in rates, outputs, responses, operating points and `linearize`.
`linearize` is in the system's own states, as many as the system has: feedback designed on it fits the system. A
spacecraft's own model has one state less, as three numbers describe its attitude: `linearize(..., minimal=True)`.

>>> system = TwoLinkArm.textbook().vary("payload.mass").to_control(outputs="states", name="arm")
>>> control.linearize(system, x0, u0, params={"payload.mass": 2.0})

Source  S. Fuller et al., "The Python Control Systems Library", CDC 2021; the contract is that of version 0.10
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from copy import deepcopy
from functools import cache
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from pliant.plants.core.argument_gates import (
    as_number,
    real_array,
    require_flag,
    require_mapping,
    require_names,
    require_number,
    require_text,
)
from pliant.plants.core.signals import index, names

if TYPE_CHECKING:
    import control

    from .plant import Plant

Array = np.ndarray
NAMES = {"name": "name", "input": "inputs", "output": "outputs", "state": "states"}  # that `linearize` may give


class Shared(dict[str, Any]):
    """Parameters of all systems of an interconnection, of which some are another's."""


class Defaults(dict[str, Any]):
    """A system's parameters. An interconnection copies them and adds those of the others."""

    def copy(self) -> Shared:
        return Shared(self)


class Chosen:
    """Which of a plant's signals are the system's, and its functions of (t, x, u, params)."""

    def __init__(self, plant: Plant, inputs: Any, disturbances: Any, outputs: Any) -> None:
        self.plant = plant
        driven, driving = list(names(plant.inputs)), list(names(plant.disturbances))
        used = driven if inputs is None else _listed("inputs", inputs, driven)
        disturbances = as_number(disturbances)
        if disturbances is True:
            used += driving
        elif disturbances is not False and disturbances is not None:
            used += _listed("disturbances", disturbances, driving)
        seen, states = list(names(plant.outputs)), list(names(plant.states))
        self.rows = list(range(plant.ny))  # of [y; x]
        if isinstance(outputs, str) and outputs == "states":
            seen, self.rows = states, list(range(plant.ny, plant.ny + plant.nx))
        elif outputs is not None:
            seen = _listed("outputs", outputs, [*seen, *states])
            self.rows = [index(plant.outputs + plant.states, name, "output") for name in seen]
        self.inputs, self.outputs, self.states = used, seen, states
        self.drives = [index(plant.inputs + plant.disturbances, name, "input") for name in used]
        self.plain = self.drives == list(range(plant.nu)), self.rows == list(range(plant.ny))

    def params(self, given: Mapping[str, Any] | None) -> dict[str, float]:
        """Values by name; ValueError where a name is not varied or a value is no number."""
        known = self.plant.varied
        values = require_mapping("params", {} if given is None else given)
        for name in values:
            if name not in known and not isinstance(given, Shared):
                may = ", ".join(known) or "(none: see `vary`)"
                raise ValueError(f"params[{name!r}]: {type(self.plant).__name__}.to_control() takes {may}")
        return {name: require_number(f"params[{name!r}]", values[name]) for name in known if name in values}

    def p(self, params: Mapping[str, Any]) -> Array | None:
        """p (np,) of the plant; None where nothing is varied."""
        own = self.plant
        if not own.varied:
            return None
        nominal = zip(own.varied, own.nominal_parameters)
        return np.array([params.get(name, value) for name, value in nominal], dtype=float)

    def drive(self, u: Array) -> tuple[Array, Array | None]:
        """(u, w) of the plant."""
        if self.plain[0]:
            return u, None
        whole = np.zeros(self.plant.nu + self.plant.nw)
        whole[self.drives] = u
        return whole[: self.plant.nu], whole[self.plant.nu :]

    def rates(self, t: float, x: Array, u: Array, params: Mapping[str, Any]) -> Array:
        """dx/dt (nx,)."""
        u, w = self.drive(u)
        return self.plant.dynamics(x, u, w=w, p=self.p(params), t=t)

    def seen(self, t: float, x: Array, u: Array, params: Mapping[str, Any]) -> Array:
        """The outputs."""
        u, w = self.drive(u)
        y = self.plant.measure(x, u, w=w, p=self.p(params), t=t)
        return y if self.plain[1] else np.concatenate([y, x])[self.rows]

    def matrices(self, t: float, x: Array, u: Array, params: Mapping[str, Any]) -> tuple[Array, ...]:
        """A, B, C, D in the plant's states."""
        own = self.plant
        own.check_state(x)
        u, w = self.drive(u)
        A, B, E, C, D, F = own.jacobians(x, u, w=w, p=self.p(params), t=t)
        C, D = np.vstack([C, np.eye(own.nx)]), np.vstack([np.hstack([D, F]), np.zeros((own.nx, own.nu + own.nw))])
        return A, np.hstack([B, E])[:, self.drives], C[self.rows], D[self.rows][:, self.drives]

    def minimal(self, t: float, x: Array, u: Array, params: Mapping[str, Any]) -> tuple[tuple[Array, ...], list[str]]:
        """A, B, C, D as the plant's own `linearize` has them, and the names of the states."""
        u, w = self.drive(u)
        model = self.plant.linearize(x, u, w=w, p=self.p(params), t=t)
        if max(self.rows, default=0) >= self.plant.ny:
            raise ValueError(
                "linearize(minimal=True): the system's outputs include states, must be the plant's outputs"
            )
        B, D = np.hstack([model.B, model.E])[:, self.drives], np.hstack([model.D, model.F])[:, self.drives]
        return (model.A, B, model.C[self.rows], D[self.rows]), list(model.state_names)


def _listed(kind: str, given: Any, known: Sequence[str]) -> list[str]:
    """The names that are given, each once and known."""
    return list(require_names(f"to_control.{kind}", [given] if isinstance(given, str) else given, known))


def _vector(name: str, given: Any, size: int) -> Array:
    """(size,) as python-control has it: a number for all, parts one after another, zeros for those that lack."""
    parts = given if isinstance(given, (list, tuple)) else [given]
    value = np.concatenate([np.zeros(0), *(np.ravel(real_array(f"linearize: {name}", part)) for part in parts)])
    if not isinstance(given, (list, tuple)) and np.ndim(given) == 0:
        value = np.repeat(value, size)
    if len(value) > size:
        raise ValueError(f"linearize: {name} has {len(value)} numbers, must have {size}")
    if len(value) < size:
        if len(value) and value[-1] != 0:
            warnings.warn(f"linearize: {name} has {len(value)} of {size} numbers; the others are zero", stacklevel=3)
        value = np.concatenate([value, np.zeros(size - len(value))])
    return value


@cache
def system_class() -> type[control.NonlinearIOSystem]:
    """The class of a plant's system: made when first asked for, as python-control takes a second to import."""
    import control

    class PlantIOSystem(control.NonlinearIOSystem):
        """A plant as a NonlinearIOSystem; `linearize` uses automatic differentiation, not differences."""

        def __init__(self, chosen: Chosen, name: str, params: Mapping[str, Any] | None) -> None:
            self.plant, self.chosen = chosen.plant, chosen
            signals = {kind: getattr(chosen, kind) for kind in ("states", "inputs", "outputs")}
            own = dict(zip(self.plant.varied, self.plant.nominal_parameters.tolist())) | chosen.params(params)
            whole = chosen.rows == list(range(self.plant.ny, self.plant.ny + self.plant.nx))
            seen = None if whole else chosen.seen  # None tells python-control that the outputs are the states
            super().__init__(chosen.rates, seen, params=own, name=name, dt=0, **signals)

        @property
        def params(self) -> dict[str, Any]:
            """The values of the varied parameters where none are given; may be changed."""
            return self._defaults

        @params.setter
        def params(self, given: Mapping[str, Any]) -> None:
            self._defaults = Defaults(self.chosen.params(given))

        def _update_params(self, params: Mapping[str, Any] | None) -> None:
            self._current_params = self.chosen.params(self._defaults) | self.chosen.params(params)

        def linearize(
            self,
            x0: Any = None,
            u0: Any = None,
            t: float = 0,
            params: Mapping[str, Any] | None = None,
            *,
            copy_names: bool = True,
            minimal: bool = False,
            **given: Any,
        ) -> control.StateSpace:
            """The exact linear model about (x0, u0), which may be an OperatingPoint; as python-control's own method.

            params: values of varied parameters by name. name, inputs, outputs, states: of the model; else they are the
            system's, or generic where copy_names=False. minimal: in the states of the plant's own `linearize`.
            TypeError for other arguments: `eps` too, as nothing is a difference.
            """
            if unknown := set(given) - {*NAMES, *NAMES.values()}:
                raise TypeError(f"linearize: unrecognized keywords {sorted(unknown)}; exact derivatives have no eps")
            copy_names, minimal = require_flag("copy_names", copy_names), require_flag("minimal", minimal)
            if isinstance(x0, control.OperatingPoint):
                x0, u0 = x0.states, x0.inputs if u0 is None else u0
            x = self.plant.rest_state if x0 is None else _vector("x0", x0, self.plant.nx)
            u = _vector("u0", 0.0 if u0 is None else u0, self.ninputs)
            self._update_params(params)
            states = list(self.state_labels)
            if minimal:
                blocks, states = self.chosen.minimal(t, x, u, self._current_params)
            else:
                blocks = self.chosen.matrices(t, x, u, self._current_params)
            copied: dict[str, Any] = {}
            if copy_names:
                before, after = (
                    control.config.defaults[f"iosys.linearized_system_name_{e}"] for e in ("prefix", "suffix")
                )
                copied = {"states": states, "inputs": self.input_labels, "outputs": self.output_labels}
                copied["name"] = before + self.name + after
            return control.StateSpace(control.StateSpace(*blocks, 0, remove_useless_states=False, **copied), **given)

        def __reduce__(self) -> tuple[Any, ...]:  # the class is made in a function, where pickle does not find it
            return _empty, (), self.__dict__

        def __copy__(self) -> Self:
            return deepcopy(self)

    return PlantIOSystem


def _empty() -> control.NonlinearIOSystem:
    return object.__new__(system_class())


def to_control(chosen: Chosen, name: str | None, params: Mapping[str, Any] | None) -> control.NonlinearIOSystem:
    """The plant as a control.NonlinearIOSystem; see `Plant.to_control`."""
    name = type(chosen.plant).__name__ if name is None else require_text("to_control.name", name)
    return system_class()(chosen, name, params)
