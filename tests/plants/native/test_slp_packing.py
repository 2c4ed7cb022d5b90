"""Vectors within one lane: what is found in functions of matrices, and that the code computes the same."""

import dataclasses

import casadi as ca
import numpy as np
import pytest

from pliant.plants import LargeDeflectionBeam, TwoLinkArm
from pliant.plants.integration.batch_stepper import rate_function, step_kernel
from pliant.plants.native import kernel_loader, scalar_codegen, slp_codegen
from pliant.plants.native.batch_kernels import map_kernel, random_points
from pliant.plants.native.expression_graph import Graph
from pliant.plants.native.slp_packing import Packing

RNG = np.random.default_rng(5)
C, R = RNG.normal(size=(20, 6)), np.triu(RNG.normal(size=(20, 20)))


def packed(function: ca.Function, width: int = 8) -> tuple[Graph, Packing]:
    graph = Graph(function)
    return graph, Packing(graph, width)


def scalars(graph: Graph, packing: Packing) -> int:
    return sum(len(left) for left, _ in packing.order)


def agrees(function: ca.Function, dtype: str = "float64", size: float = 1.0) -> None:
    """The code of one lane against CasADi's own evaluation at 40 points."""
    points = [size * RNG.uniform(-1, 1, (function.nnz_in(k), 40)) for k in range(function.n_in())]
    kernel = map_kernel(function, points, dtype, 1)
    assert kernel.native == kernel_loader.wanted()
    work = kernel.workspace(40)
    for k, p in enumerate(points):
        work.set(k, p.T)
    work.run()
    want = np.array([np.asarray(function(*p), dtype=float).ravel() for p in zip(*[q.T for q in points])])
    tolerance = 1e-12 if dtype == "float64" else 1e-5
    np.testing.assert_allclose(work.get(0), want, rtol=0, atol=tolerance * np.abs(want).max())


def gram() -> ca.Function:
    """The lower half of P^T S P, and P^T R (cos(C x) * (C y)), for P = R diag(sin(C x)) C, R triangular, S = +-1."""
    x, y, root = ca.SX.sym("x", 6), ca.SX.sym("y", 6), ca.sparsify(ca.DM(R))
    angle, turn = ca.DM(C) @ x, ca.DM(C) @ y
    P = root @ ca.diag(ca.sin(angle)) @ ca.DM(C)
    halves = [ca.dot(P[:10, i], P[:10, j]) - ca.dot(P[10:, i], P[10:, j]) for i in range(6) for j in range(i + 1)]
    return ca.Function("gram", [x, y], [ca.cse(ca.vertcat(*halves, P.T @ (root @ (ca.cos(angle) * turn))))])


def test_a_constant_matrix_times_a_vector_is_columns_of_vectors() -> None:
    x = ca.SX.sym("x", 6)
    graph, packing = packed(ca.Function("f", [x], [ca.DM(C) @ x]))
    assert scalars(graph, packing) == 0
    assert [len(v.elements) for v in packing.vectors] == [8, 8, 4]
    assert all(len(v.shapes) == 6 for v in packing.vectors)
    columns = np.concatenate(
        [np.array([v.tables[k] for k in range(6)])[:, : len(v.elements)] for v in packing.vectors], 1
    )
    order = [j for _, j in packing.vectors[0].shapes[0][1:] if j >= 0]
    assert len(order) == 1  # one constant and one element of x in every term
    np.testing.assert_allclose(np.sort(columns, axis=None), np.sort(C, axis=None))


def test_a_triangular_matrix_times_a_vector_is_filled_up_with_zeros() -> None:
    x = ca.SX.sym("x", 8)
    graph, packing = packed(ca.Function("f", [x], [ca.DM(np.tril(RNG.normal(size=(8, 8)))) @ x]))
    assert [len(v.elements) for v in packing.vectors] == [8]
    assert sum(row.count(0.0) for row in packing.vectors[0].tables.values()) == 28
    assert scalars(graph, packing) == 0


def test_a_gram_matrix_and_what_it_is_made_of_leave_no_scalars() -> None:
    graph, packing = packed(gram())
    assert packing.gain(1) > 4
    assert packing.gain(4) < packing.gain(1) / 2  # four registers a vector
    assert scalars(graph, packing) <= 1  # one of the 21 entries may be left alone
    assert sum(v.op == ca.OP_SIN for v in packing.vectors) == 3


def test_vectors_need_only_earlier_ones() -> None:
    graph, packing = packed(rate_function(LargeDeflectionBeam.textbook()))
    seen: set[int] = set()
    for left, numbers in packing.order:
        level = [*left, *(i for n in numbers for i in packing.vectors[n].elements.values())]
        for i in level:
            node = graph.nodes[i]
            needed = {a for _, *factors in node.terms for a in factors} or set(node.args)
            assert all(a in seen or graph.nodes[a].given for a in needed)
        assert not seen.intersection(level)
        seen.update(level)
    assert seen == {i for i in graph.kept if not graph.nodes[i].given}


@pytest.mark.every(2)
@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_matrix_code_equals_the_virtual_machine(dtype: str) -> None:
    agrees(gram(), dtype)


@pytest.mark.every(3)
@pytest.mark.parametrize("seed", range(6))
def test_any_function_equals_the_virtual_machine(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Random sums, products and calls of earlier values, all vectors used however little they gain."""
    monkeypatch.setattr(slp_codegen, "GAIN", 0.0)
    rng = np.random.default_rng(seed)
    x = ca.SX.sym("x", 10)
    values = [x[i] for i in range(10)] + [ca.SX(float(c)) for c in rng.integers(-3, 4, 4)]
    for _ in range(250):
        a, b, c = (values[i] for i in rng.integers(max(0, len(values) - 40), len(values), 3))
        made = [
            a + b,
            a - b * c,
            a * b - c,
            -a,
            ca.sin(a),
            ca.cos(b),
            a**2,
            2 * a,
            a / (2 + b**2),
            ca.tanh(a) * 0.3 - b,
        ]
        made += [ca.sqrt(1 + a**2), ca.exp(ca.sin(a)), ca.fmax(a, b), ca.if_else(a > b, c, a)]
        values.append(ca.tanh(made[rng.integers(len(made))]) if rng.random() < 0.5 else made[rng.integers(len(made))])
    out = ca.cse(ca.tanh(ca.vertcat(*values[-60:])))
    function = ca.Function("f", [x], [out])
    assert len(packed(function)[1].vectors) > 5
    agrees(function)


def test_where_vectors_gain_little_the_code_is_scalar() -> None:
    rate = rate_function(TwoLinkArm.textbook())
    assert packed(rate)[1].gain(1) < slp_codegen.GAIN
    assert slp_codegen.lane_function("rate", rate, 8, 1) == scalar_codegen.block_function("rate", rate)
    beam = rate_function(LargeDeflectionBeam.textbook())
    assert packed(beam)[1].gain(1) > slp_codegen.GAIN
    assert "g0[8]" in slp_codegen.lane_function("rate", beam, 8, 1)
    assert slp_codegen.lane_function("rate", beam, 8, 8) == scalar_codegen.block_function("rate", beam)


@pytest.mark.campaign
@pytest.mark.every(2)
@pytest.mark.parametrize("root", ["clamped", "driven"])
def test_one_lane_of_a_beam_moves_as_many_do(root: str) -> None:
    """The same 50 steps by the kernel that fills vectors within a lane and by the one that fills them with lanes."""
    beam = LargeDeflectionBeam(beam=LargeDeflectionBeam.textbook().beam, root=root, modes=4)
    results = []
    for lanes in (None, 1):
        work = step_kernel(beam, "rk4", np.dtype(float), lanes).workspace(2)
        work.set(1, 0.3 * random_points(beam, np.random.default_rng(1))[1][:, :2].T)
        work.run((0.01,), 50)
        results.append(work.get(0).copy())
    assert np.abs(results[0]).max() > 0.1
    np.testing.assert_allclose(results[0], results[1], rtol=0, atol=1e-10 * np.abs(results[0]).max())


@pytest.mark.parametrize(("modes", "least"), [(4, 2.5), (8, 3.5)])
def test_elements_that_stand_in_their_place_by_chance_do_not_hide_a_matrix(modes: int, least: float) -> None:
    """Eight nodes and nine points beside them, of which one fills no vector: 1.85 where chance was not seen."""
    beam = dataclasses.replace(LargeDeflectionBeam.textbook(), modes=modes)
    assert Packing(Graph(rate_function(beam)), 8).gain(1) > least
