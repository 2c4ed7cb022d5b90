"""A multiple-shooting program solved by an interior-point method: IPOPT, or FATROP, which knows the stages.

Both take the program's own derivatives as CasADi callbacks; nothing is differentiated symbolically.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol

import casadi as ca
import numpy as np

POINT, DUAL = ("x", "p"), ("x", "p", "lam_f", "lam_g")  # CasADi's names


class Pattern(Protocol):
    """Where a sparse matrix may have numbers."""

    @property
    def sparsity(self) -> ca.Sparsity: ...


class NonlinearProgram(Protocol):
    """min cost(z), bounds on z (size,) and on constraints(z) (rows,): see optimal_control.multiple_shooting."""

    @property
    def size(self) -> int: ...
    @property
    def rows(self) -> int: ...
    @property
    def N(self) -> int: ...  # stages
    @property
    def stages(self) -> dict[str, Any]: ...  # nx, nu, ng of each, as FATROP asks for them
    @property
    def jacobian_pattern(self) -> Pattern: ...
    @property
    def hessian_pattern(self) -> Pattern: ...
    def cost(self, z: np.ndarray) -> float: ...
    def gradient(self, z: np.ndarray) -> np.ndarray: ...
    def constraints(self, z: np.ndarray) -> np.ndarray: ...
    def jacobian(self, z: np.ndarray) -> Any: ...
    def hessian(self, z: np.ndarray, scale: float, multipliers: np.ndarray) -> Any: ...  # upper triangle
    def variable_bounds(self) -> tuple[np.ndarray, np.ndarray]: ...
    def row_bounds(self) -> tuple[np.ndarray, np.ndarray]: ...


def solve(
    problem: NonlinearProgram, z: np.ndarray, solver: str, tolerance: float, iterations: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
    """z, the multipliers of its bounds and of the constraints, and the solver's statistics, from the start z."""
    calls = _calls(problem, solver)  # kept alive here until the solver is done
    x, p = ca.MX.sym("x", problem.size), ca.MX.sym("p", 0)
    f, g = calls["nlp"](x, p)
    options: dict[str, Any] = {
        "print_time": False,
        "error_on_fail": False,
        "calc_lam_p": False,
        "show_eval_warnings": False,
    }
    if solver == "ipopt":
        own = {"tol": tolerance, "max_iter": iterations, "print_level": 0, "sb": "yes"}
        options |= {"ipopt": own | {"bound_relax_factor": 0.0}, "no_nlp_grad": True}
        options |= {"grad_f": calls["nlp_grad_f"], "jac_g": calls["nlp_jac_g"], "hess_lag": calls["nlp_hess_l"]}
    else:
        own = {"tolerance": tolerance, "max_iter": iterations, "print_level": 0}
        options |= {"fatrop": own, "structure_detection": "manual", "N": problem.N, **problem.stages}
        options["cache"] = {name: call for name, call in calls.items() if name != "nlp"}
    run = ca.nlpsol("optimal", solver, {"x": x, "p": p, "f": f, "g": g}, options)
    (lbx, ubx), (lbg, ubg) = problem.variable_bounds(), problem.row_bounds()
    found = run(x0=z, lbx=lbx, ubx=ubx, lbg=lbg, ubg=ubg)
    z, lam_z, lam = (np.array(found[name]).ravel() for name in ("x", "lam_x", "lam_g"))
    stats = run.stats()
    if solver == "fatrop":
        stats["return_status"] = stats["unified_return_status"]
    return z, lam_z, lam, stats


def _calls(problem: NonlinearProgram, solver: str) -> dict[str, Call]:
    """What each solver asks for, under CasADi's names."""
    n, m = ca.Sparsity.dense(problem.size), ca.Sparsity.dense(problem.rows)
    none, one = ca.Sparsity.dense(0, 1), ca.Sparsity.dense(1)
    J, H = problem.jacobian_pattern.sparsity, problem.hessian_pattern.sparsity
    point, dual = (POINT, [n, none]), (DUAL, [n, none, one, m])

    def values(z: np.ndarray) -> list[Any]:
        return [problem.cost(z), problem.constraints(z)]

    def lagrangian(z: np.ndarray, _: Any, scale: np.ndarray, lam: np.ndarray) -> np.ndarray:
        return scale[0] * problem.gradient(z) + np.array(problem.jacobian(z)[1].T @ lam).ravel()

    def hessian(z: np.ndarray, _: Any, scale: np.ndarray, lam: np.ndarray) -> ca.DM:
        return problem.hessian(z, float(scale[0]), lam)

    made = [Call("nlp", point, {"f": one, "g": m}, lambda z, _: values(z))]
    made.append(Call("nlp_jac_g", point, {"g": m, "jac_g_x": J}, lambda z, _: problem.jacobian(z)))
    if solver == "ipopt":
        with_value = {"f": one, "grad_f_x": n}
        made.append(Call("nlp_grad_f", point, with_value, lambda z, _: [problem.cost(z), problem.gradient(z)]))
        made.append(Call("nlp_hess_l", dual, {"triu_hess_gamma_x_x": H}, lambda *a: [hessian(*a)]))
    else:
        whole = {"grad_gamma_x": n, "hess_gamma_x_x": ca.triu2symm(ca.DM(H, 1)).sparsity()}
        all_slopes = {"f": one, "g": m, "grad_gamma_x": n, "grad_gamma_p": none}
        made.append(Call("nlp_grad_f", point, {"grad_f_x": n}, lambda z, _: [problem.gradient(z)]))
        made.append(Call("nlp_hess_l", dual, whole, lambda *a: [lagrangian(*a), ca.triu2symm(hessian(*a))]))
        made.append(Call("nlp_grad", dual, all_slopes, lambda *a: [*values(a[0]), lagrangian(*a), ca.DM(0, 1)]))
    return {call.name(): call for call in made}


class Call(ca.Callback):
    """A Python function of vectors as a CasADi function; results are arrays, or DM of the given pattern."""

    def __init__(
        self,
        name: str,
        inputs: tuple[Sequence[str], Sequence[ca.Sparsity]],
        outputs: dict[str, ca.Sparsity],
        evaluate: Callable[..., Sequence[Any]],
    ) -> None:
        ca.Callback.__init__(self)
        self._inputs, self._outputs, self._evaluate = inputs, list(outputs.items()), evaluate
        self.construct(name, {})

    def get_n_in(self) -> int:
        return len(self._inputs[0])

    def get_n_out(self) -> int:
        return len(self._outputs)

    def get_name_in(self, i: int) -> str:
        return self._inputs[0][i]

    def get_name_out(self, i: int) -> str:
        return self._outputs[i][0]

    def get_sparsity_in(self, i: int) -> ca.Sparsity:
        return self._inputs[1][i]

    def get_sparsity_out(self, i: int) -> ca.Sparsity:
        return self._outputs[i][1]

    def eval(self, arguments: Sequence[ca.DM]) -> list[Any]:
        with np.errstate(over="ignore", invalid="ignore"):  # a trial point may diverge: the solver shortens its step
            return [ca.DM(r) for r in self._evaluate(*[np.array(a).ravel() for a in arguments])]
