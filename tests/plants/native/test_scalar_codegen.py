"""Every SX operation that the code generator knows, against the virtual machine, scalar and vectorised."""

import casadi as ca
import numpy as np
import pytest

from pliant.plants.native import kernel_loader, scalar_codegen, slp_codegen
from pliant.plants.native.batch_kernels import map_kernel

RNG = np.random.default_rng(3)


def _all_operations() -> ca.Function:
    a, b = ca.SX.sym("a"), ca.SX.sym("b")
    results = [
        a + b, a - b, a * b, a / b, 1 / b, a**2, 2 * a, -a, ca.sqrt(ca.fabs(a)), ca.sin(a), ca.cos(a), ca.exp(a),
        ca.tanh(a), ca.fabs(b), ca.fmin(a, b), ca.fmax(a, b), ca.if_else(a > b, a, b), ca.if_else(a <= 0, 1.5, b),
        ca.fabs(a) ** 1.7, a / b + 3 / b + (a + 1) / b, ca.logic_and(a > 0, b > 0), ca.logic_or(a > 0, b > 0),
        ca.logic_not(a > 0), ca.SX(0.0), ca.SX(-2.5), a,
    ]  # fmt: skip
    return ca.Function("all", [a, b], [ca.vertcat(*results)])


@pytest.mark.parametrize("dtype", ["float64", "float32"])
@pytest.mark.parametrize(("lanes", "gain"), [(None, 1.75), (1, 1.75), (1, 0.0)])
def test_every_operation_equals_the_virtual_machine(
    dtype: str, lanes: int | None, gain: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(slp_codegen, "GAIN", gain)
    function = _all_operations()
    points = [RNG.uniform(0.2, 2.0, (1, 64)) * RNG.choice([-1.0, 1.0], (1, 64)) for _ in range(2)]
    kernel = map_kernel(function, points, dtype, lanes)
    if kernel_loader.wanted():
        assert kernel.native
    work = kernel.workspace(37)
    a, b = (p[0, :37].astype(dtype) for p in points)
    work.set(0, a[:, None])
    work.set(1, b[:, None])
    work.run()
    want = np.array([np.asarray(function(float(x), float(y))).ravel() for x, y in zip(a, b)])
    tolerance = 1e-13 if dtype == "float64" else 2e-6
    np.testing.assert_allclose(work.get(0), want, rtol=tolerance, atol=tolerance)


def test_divisions_by_one_value_share_one_reciprocal() -> None:
    a, b, c = (ca.SX.sym(n) for n in "abc")
    source = scalar_codegen.block_function("f", ca.Function("f", [a, b, c], [a / c + b / c, (a + b) / c]))
    assert source.count("(T)1 /") == 1


def test_unknown_operation_is_named() -> None:
    a = ca.SX.sym("a")
    with pytest.raises(NotImplementedError, match="no C form"):
        scalar_codegen.block_function("f", ca.Function("f", [a], [ca.erf(a)]))
