"""Functions cut into parts: the same values as whole, whatever a part holds, rows are used again."""

from pathlib import Path

import casadi as ca
import kernel_growth
import numpy as np
import pytest

from pliant.plants.native import compiler, kernel_loader, kernel_templates
from pliant.plants.native.batch_kernels import map_kernel
from pliant.plants.toolchain import straight_line

RNG = np.random.default_rng(11)
X = RNG.uniform(-1.0, 1.0, (6, 64))


def _tangled(count: int) -> ca.Function:
    """`count` values, each of two earlier ones by chance, near or far; every tenth is put out."""
    x, rng = ca.SX.sym("x", 6), np.random.default_rng(5)
    values = [x[i] for i in range(6)]
    for k in range(count):
        a, b = values[rng.integers(len(values))], values[-1 - rng.integers(6)]
        values.append([a * b + 0.3, ca.sin(a) - b, a / (2 + b * b), ca.fmin(a, 0.5) + ca.if_else(b > a, 1.0, b)][k % 4])
    return ca.Function("tangled", [x], [ca.vertcat(*values[::10], 2.5), x[1] + values[-1]])


@pytest.mark.every(2)
@pytest.mark.parametrize("lanes", [None, 1])
@pytest.mark.parametrize("most", [1, 13, 10_000])
def test_parts_compute_what_the_whole_does(most: int, lanes: int | None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(straight_line, "LENGTHENED", most)
    function = _tangled(80)
    kernel = map_kernel(function, [X], lanes=lanes)
    if kernel_loader.wanted():
        assert kernel.native
    work = kernel.workspace(64)
    work.set(0, X.T)
    work.run()
    for k, want in enumerate(function.map(64)(X) if function.n_out() > 1 else [function.map(64)(X)]):
        np.testing.assert_allclose(work.get(k).T, np.asarray(want), rtol=1e-12, atol=1e-13)


def test_parts_may_share_nothing() -> None:
    """Each puts out what it computes: no row is passed on, and what is passed is declared all the same."""
    statements = [
        statement
        for k in range(straight_line.LENGTHENED)
        for statement in (
            straight_line.Statement(f"a{k}", f"i0[{k} * PER] * 2"),
            straight_line.Statement("", f"o0[{k} * PER] = a{k};", (f"a{k}",)),
        )
    ]
    text = straight_line.written("f", ["i0"], ["o0"], statements)
    assert "(V *)between + h" in text and "T between[1][W]" in text


@pytest.mark.skipif(not kernel_loader.wanted(), reason="PLIANT_NATIVE=0: nothing is compiled")
def test_parts_in_units_of_their_own_are_one_library(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Each part is compiled once, in one unit, all else in the first; the numbers are those of one unit, to the bit."""
    monkeypatch.setattr(straight_line, "LENGTHENED", 13)
    monkeypatch.setenv("PLIANT_CACHE", str(tmp_path))
    source = kernel_templates.map_source(_tangled(100), np.dtype(float))
    asked: list[tuple[str, ...]] = []
    run = compiler._run

    def told(command: tuple[str, ...], *arguments: str, **options: object) -> object:
        asked.append(arguments)
        return run(command, *arguments, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(compiler, "_run", told)
    found = []
    for longest in (10**9, 0):
        monkeypatch.setattr(compiler, "LONG_SOURCE", longest)
        monkeypatch.setattr(compiler, "QUICK", ())
        asked.clear()
        (path := tmp_path / f"units{longest}.so").write_bytes(compiler.build(source))
        outputs = [np.zeros((12, 64)), np.zeros((1, 64))]
        kernel_loader.Kernel(path, np.dtype(float), 8)([X], outputs)
        found.append(np.vstack(outputs))
        units = [a for arguments in asked for a in arguments if a.startswith("-DUNIT=")]
        assert sorted(units) == ([] if longest else [f"-DUNIT={k}" for k in range(compiler.UNITS)])
    np.testing.assert_array_equal(found[0], found[1])
    assert np.abs(found[0]).max() > 0


def test_a_row_is_free_again_after_the_last_part_that_reads_it() -> None:
    def of(name: str, *needs: str) -> straight_line.Statement:
        return straight_line.Statement(name, "+".join(needs), needs)

    parts = [[of("a"), of("b")], [of("c", "a", "b"), of("d", "b")], [of("e", "c"), of("f", "d")], [of("g", "e", "d")]]
    rows, total = straight_line._rows(parts)
    assert set(rows) == {"a", "b", "c", "d", "e"}  # f and g are put out, or nothing
    assert len({rows[n] for n in "abcd"}) == 4  # while c and d are made, a and b are still read
    assert total == 4 and rows["e"] in (rows["a"], rows["b"])


def test_no_part_is_longer_than_it_may_be_and_no_function_too_long(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(straight_line, "LENGTHENED", 50)
    statements = [straight_line.Statement("v0", "i0[0]", given=True)]
    statements += [straight_line.Statement(f"v{k}", f"v{k - 1} + v0", (f"v{k - 1}", "v0")) for k in range(1, 30_000)]
    source = straight_line.written("f", ["i0"], ["o0"], statements)
    bodies = source.split("#if IN_UNIT(")[1:]
    assert len(bodies) == 600
    # what it computes, one row in, one out, and the input read anew
    assert max(body.split("#else")[0].count(";") for body in bodies) <= 53
    assert "T between[2][W]" in source


def test_operations_grow_at_most_as_the_cube_of_the_states() -> None:
    """A sample of tests/campaigns/kernel_growth.py, which compiles every size of 60 plants; here the small ones."""
    if not kernel_loader.wanted():
        pytest.skip("PLIANT_NATIVE=0: nothing is compiled")
    row = kernel_growth.run(0, longest=400)
    assert not kernel_growth.faulty(row), row
    assert row["operations"] == sorted(row["operations"])


def test_a_unit_reads_its_own_parts_and_of_others_what_they_are_called():
    parts = ("head", *["#if IN_UNIT(0)", "zero {}", "#else", "zero;", "#endif"], "mid")
    source = "\n".join([*parts, *["#if IN_UNIT(5)", "five {}", "#else", "five;", "#endif"], "#endif"])
    assert straight_line.of_unit(source, 4, 0) == "head\nzero {}\nmid\nfive;\n#endif"
    assert straight_line.of_unit(source, 4, 1) == "head\nzero;\nmid\nfive {}\n#endif"
