"""Rest points: states and inputs at which nothing changes, by Newton's method with minimum-norm steps."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from pliant.plants.core.argument_gates import require_by_name
from pliant.plants.core.casadi_functions import NumericFunction, built_once, function
from pliant.plants.core.errors import EquilibriumError, UnstableRestWarning, rests_told, warn_caller
from pliant.plants.core.signals import index

if TYPE_CHECKING:
    from .plant import Plant

Array = np.ndarray
TOLERANCE = 1e-10  # relative to the rates that each unknown can cause
STEP = 1e-6  # of an unknown or of SMALL: a Newton step beyond it means that very stiff terms hide the others' residual
SMALL = 1e-3
FOLLOWS = 1e-6  # of what a coordinate follows most: less is nothing but rounding


class RestConditions:
    """What must vanish for (x, u) to be a rest of a plant: dx/dt."""

    def __init__(self, plant: Any, p: Any) -> None:
        self.plant, self.p = plant, p

    def still(self) -> Array:
        """Which states (nx,) are zero at every rest. None are known."""
        return np.zeros(self.plant.nx, dtype=bool)

    def forces(self, x: Array, u: Array, at: Array) -> Array:
        """(nx,), weighed as at a state `at` (nx,) near by."""
        rate: Array = self.plant._rate(*self.plant._arguments(x, u, p=self.p))
        return rate

    def slopes(self, x: Array, u: Array) -> Array:
        """The Jacobian (nx, nx + nu) of these in [x; u], weighed as at x."""
        return np.hstack(self.plant._state_jacobians(x, u, self.p))

    def exactly(self, x: Array, u: Array) -> bool:
        """Whether (x, u) is seen to be a rest without slopes: all forces are zero, to the last bit."""
        return False

    def states(self, x: Array, u: Array) -> Array:
        """A (nx, nx) at a rest."""
        A: Array = self.plant._state_jacobians(x, u, self.p)[0]
        return A

    def rate(self, x: Array, u: Array) -> Array:
        """dx/dt (nx,); raises where the equations have lost their meaning."""
        rate: Array = self.plant.dynamics(x, u, p=self.p)
        return rate


class ForcesAtRest(RestConditions):
    """Of M(q) dv/dt = r: dq/dt and the forces r, so that a stiff mode's are in its own row only.

    Where nothing moves and no coordinate is driven they come from `_forces_at_rest`, a fraction of all equations.
    """

    def still(self) -> Array:
        """Rates."""
        return np.arange(self.plant.nx) >= len(self.plant.coordinates)

    def _known(self, x: Array, u: Array) -> list[Array] | None:
        if self.plant.driven or x[len(x) // 2 :].any():
            return None
        t, x, u, w, p = self.plant._arguments(x, u, p=self.p)[0]
        if self.plant._written_out:
            found: list[Array] = self.plant._forces_at_rest(t, x, u, w, p)
            return found
        forces: list[Array] = self.plant.force_balance.at_rest(np.atleast_1d(t), x[None], u[None], w=w, p=p)
        return forces

    def exactly(self, x: Array, u: Array) -> bool:
        """By what is built, or by the rates, which a simulation needs anyway: slopes take longer to build."""
        if self.plant.driven or x[len(x) // 2 :].any():
            return False
        if not built_once.has(self.plant, "force_balance"):
            return not self.rate_of_all(x, u).any()
        t, x, u, w, p = (np.atleast_2d(v) for v in self.plant._arguments(x, u, p=self.p)[0])
        balance = self.plant.force_balance
        if balance.lacking(t[0], x, u, np.zeros((1, balance.n)), w=w, p=p).any():
            return False
        self.plant.check_definite(x[0], np.linalg.eigvalsh(balance.mass(t[0], x, u, w=w, p=p)[0])[:1])
        return True

    def rate_of_all(self, x: Array, u: Array) -> Array:
        """dx/dt (nx,) by the plant's own equations; raises where they have lost their meaning."""
        return super().rate(x, u)

    def forces(self, x: Array, u: Array, at: Array) -> Array:
        n = len(x) // 2
        if (known := self._known(x, u)) is not None:
            return np.concatenate([x[n:], known[0][:, 0]])
        rate = super().forces(x, u, at)
        return np.concatenate([rate[:n], self.plant.mass_matrix(at, p=self.p) @ rate[n:]])

    def slopes(self, x: Array, u: Array) -> Array:
        n = len(x) // 2
        if (known := self._known(x, u)) is not None:
            return np.block([[np.zeros((n, n)), np.eye(n), np.zeros((n, len(u)))], known[1:4]])
        slopes = super().slopes(x, u)
        return np.vstack([slopes[:n], self.plant.mass_matrix(x, p=self.p) @ slopes[n:]])

    def states(self, x: Array, u: Array) -> Array:
        n = len(x) // 2
        if (known := self._known(x, u)) is None:
            return super().states(x, u)
        return np.block([[np.zeros((n, n)), np.eye(n)], [np.linalg.solve(known[4], np.hstack(known[1:3]))]])

    def rate(self, x: Array, u: Array) -> Array:
        if (known := self._known(x, u)) is None or not all(np.isfinite(e).all() for e in known):
            return super().rate(x, u)
        self.plant.check_definite(x, np.linalg.eigvalsh(known[4])[:1])
        return np.concatenate([x[len(x) // 2 :], np.linalg.solve(known[4], known[0][:, 0])])


def forces_at_rest(plant: Any) -> NumericFunction:
    """(t, x, u, w, p) -> the forces r (n,) where nothing moves, their Jacobians in q, v and u, and M (n, n)."""
    t, x, u, w, p = plant.symbols
    M, r, _, _ = plant._terms
    n = x.shape[0] // 2
    moving = ca.vertcat(x[n:], w)
    still = ca.SX.zeros(moving.shape[0])
    at_rest = ca.substitute(r, moving, still)
    slopes = [ca.jacobian(at_rest, x[:n]), ca.substitute(ca.jacobian(r, x[n:]), moving, still)]
    return function("rest", [t, x, u, w, p], [at_rest, *slopes, ca.jacobian(at_rest, u), M], matrices=True)


def find(
    plant: Plant, fixed: Mapping[str, float], named: Mapping[str, float], guess: Mapping[str, float], p: Any
) -> tuple[Array, Array]:
    """Solve f(x, u) = 0 with the named signals held. Unknown: every other state, and the inputs when enough is held."""
    names = tuple(s.name for s in plant.states + plant.inputs)
    signals = plant.states + plant.inputs
    z = np.append(plant.rest_state, np.zeros(plant.nu))
    held = np.zeros(len(names), dtype=bool)
    for kind, source in (("guess", guess), ("fixed", fixed), ("named", named)):
        for name, value in require_by_name(f"equilibrium.{kind}", source).items():
            i = index(signals, name, "state or input")
            z[i] = value
            held[i] |= kind != "guess"
    nx, fixed = plant.nx, {**fixed, **named}
    if held[:nx].sum() < plant.nu:
        held[nx:] = True  # too few states are given to determine the inputs: they stay as given, or zero

    rest = plant.rest_conditions(p)
    still = np.append(rest.still(), np.zeros(plant.nu, dtype=bool)) & ~held
    z[still] = 0.0
    free = np.flatnonzero(~held & ~still)
    if rest.exactly(z[:nx], z[nx:]):
        return z[:nx], z[nx:]
    scale, step = 1.0, 0.0
    for _ in range(100):
        at = z[:nx]
        J, residual = rest.slopes(at, z[nx:])[:, free], rest.forces(at, z[nx:], at)
        size = np.maximum(np.abs(z[free]), SMALL)
        scale = np.maximum(np.abs(J) @ size, 1e-3)
        change = np.linalg.lstsq(J / scale[:, None], -residual / scale, rcond=1e-12)[0]
        step = float(np.max(np.abs(change) / size, initial=0.0))
        if np.max(np.abs(residual) / scale) < TOLERANCE * 1e-2 and step < STEP:
            break
        length, best = 1.0, float(np.linalg.norm(residual / scale))
        while length > 1e-6:
            trial = z.copy()
            trial[free] += length * change
            moved = rest.forces(trial[:nx], trial[nx:], at)  # not finite where the step was too long
            if np.linalg.norm(moved / scale) < best:
                break
            length /= 2
        else:
            break
        z, residual = trial, moved
    worst = float(np.max(np.abs(residual) / scale))
    rate = rest.rate(z[:nx], z[nx:])
    if not (worst < TOLERANCE and step < STEP):
        k, told = int(np.argmax(np.abs(rate))), {name: float(value) for name, value in dict(fixed).items()}
        raise EquilibriumError(
            f"no equilibrium of {plant.label} with {told} held: d({names[k]})/dt = {rate[k]:.3g} remains; "
            "hold as many coordinates as there are inputs, or give a closer guess",
            float(np.max(np.abs(rate))),
        )
    return z[:nx], z[nx:]


def with_joints(plant: Plant, named: Mapping[str, float]) -> dict[str, float]:
    """The named states, and as in `rest_state`, at zero, the driven coordinates that they leave open.

    A coordinate without an input that is named (a link behind its gear) decides the driven one that it follows most.
    """
    driven = [joint.position for joint in plant.joints if joint.position in plant.rates]
    left = [name for name in driven if name not in named]
    given = [name for name in named if name in plant.rates and name not in driven]
    if left and given:
        others = [name for name in plant.rates if name not in driven]
        follows = np.abs(_follows(plant, driven, others))
        for name in given:
            row = follows[others.index(name)]
            most = max(left, key=lambda one: float(row[driven.index(one)]), default=None)
            if most is not None and row[driven.index(most)] > FOLLOWS * row.max():
                left.remove(most)
    at_rest = dict(zip((s.name for s in plant.states), np.asarray(plant.rest_state).tolist()))
    return {**{name: at_rest[name] for name in left}, **named}


def _follows(plant: Plant, driven: list[str], others: list[str]) -> Array:
    """d(others)/d(driven) from rest to rest, (others, driven): zero where nothing ties them."""
    A, B = plant.jacobians(plant.rest_state)[:2]
    at = {s.name: k for k, s in enumerate(plant.states)}
    q, p = ([at[name] for name in names] for names in (driven, others))
    dq, dp = ([at[plant.rates[name]] for name in names] for names in (driven, others))
    slopes = A[dp] - B[dp] @ np.linalg.pinv(B[dq]) @ A[dq]
    found: Array = -np.linalg.pinv(slopes[:, p], rcond=TOLERANCE) @ slopes[:, q]
    return found


def growth_at_rest(plant: Plant, x0: Array, u0: Array, p: Any = None) -> str:
    """How fast small deviations from a rest grow; "" where no eigenvalue there has a real part > 0 beyond its error.

    The error is what rounding of A can do to a simple eigenvalue, n eps |A| / |y^H x| with the left and right vectors y
    and x of length one (Golub and Van Loan, "Matrix Computations", 7.2.2). Roots that are nearly multiple have large
    errors: of them nothing is said.
    """
    A = plant.rest_conditions(p).states(x0, u0)
    roots, right = np.linalg.eig(A)
    try:
        left = np.linalg.inv(right)
    except np.linalg.LinAlgError:
        return ""
    k = int(np.argmax(roots.real))
    with np.errstate(over="ignore"):  # a vector beside a nearly equal one
        size = np.linalg.norm(right[:, k]) * np.linalg.norm(left[k])
    error = len(A) * np.finfo(float).eps * np.linalg.norm(A) * size
    if roots[k].real <= 10 * error:
        return ""
    most = plant.states[int(np.argmax(np.abs(right[:, k])))]
    return f"with the inputs held, small deviations grow by exp({roots[k].real:.3g} t), most in {most.name}"


def tell_unstable(plant: Plant, x0: Array, u0: Array, p: Any) -> None:
    """Warn (UnstableRestWarning) where small deviations from a rest grow."""
    if rests_told() and (grows := growth_at_rest(plant, x0, u0, p)):
        warn_caller(
            f"the rest point of {plant.label} is unstable: {grows}; a feedback must hold it, or another guess finds "
            "another",
            UnstableRestWarning,
        )
