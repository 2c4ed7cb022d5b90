"""Native kernels against the virtual machine and integration; layout, threads, fall-back, refusal of a bad one."""

import ctypes
import math
import os
import subprocess
import sys
import warnings
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from pliant.plants import SingleLinkArm, TwoLinkArm
from pliant.plants.integration.batch_stepper import rate_function, step_kernel
from pliant.plants.native import compiler, kernel_cache, kernel_loader, kernel_templates
from pliant.plants.native.batch_kernels import as_dtype, map_kernel, random_points

ARM, LINK = TwoLinkArm.textbook(), SingleLinkArm.textbook()
needs_compiler = pytest.mark.skipif(
    not kernel_loader.wanted(), reason="PLIANT_NATIVE=0: the virtual machine is under test"
)


def states(batch: int, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    size = np.r_[1.0, 1.0, np.full(4, 0.01), 1.0, 1.0, np.full(4, 0.1)]
    return rng.uniform(-1, 1, (batch, 12)) * size


def test_rk4_steps_equal_simulate() -> None:
    x0, u = states(3), np.array([2.0, -1.0])
    step = ARM.stepper(0.01, batch=3, substeps=20)
    after = step(x0, u)
    for x, have in zip(x0, after):
        want = ARM.simulate(x, u, np.array([0.0, 0.01]), method="rk4", step=0.0005).x[-1]
        np.testing.assert_allclose(have, want, rtol=1e-9, atol=1e-10)


def test_rosenbrock_steps_equal_simulate() -> None:
    x0, u = states(2)[:, [0, 2, 3, 6, 8, 9]], np.array([2.0])
    after = LINK.stepper(0.01, method="rosenbrock", batch=2, substeps=5)(x0, u)
    want = LINK.simulate(x0[1], u, np.array([0.0, 0.01]), method="rosenbrock", step=0.002).x[-1]
    np.testing.assert_allclose(after[1], want, rtol=1e-8, atol=1e-9)


@pytest.mark.parametrize("lanes", [None, 1])
def test_rk8_steps_equal_simulate(lanes: int | None) -> None:
    x0, u = states(3), np.array([2.0, -1.0])
    kernel = step_kernel(ARM, "rk8", as_dtype("float64"), lanes)
    assert kernel.native == kernel_loader.wanted()
    work = kernel.workspace(3)
    work.set(1, x0)
    work.set(2, u)
    work.run((0.002,), 5)
    for x, have, stepped in zip(x0, work.get(0), ARM.stepper(0.01, method="rk8", batch=3, substeps=5)(x0, u)):
        want = ARM.simulate(x, u, np.array([0.0, 0.01]), method="rk8", step=0.002).x[-1]
        np.testing.assert_allclose(have, want, rtol=1e-9, atol=1e-10)
        np.testing.assert_allclose(stepped, want, rtol=1e-9, atol=1e-10)


def test_midpoint_runs_on_the_virtual_machine() -> None:
    step = ARM.stepper(0.001, method="midpoint", batch=2)
    assert not step.native
    want = ARM.simulate(states(2)[0], np.zeros(2), np.array([0.0, 0.001]), method="midpoint", step=0.001).x[-1]
    np.testing.assert_allclose(step(states(2))[0], want, rtol=1e-10, atol=1e-12)


def test_parameters_differ_per_lane() -> None:
    arm = ARM.vary("payload.mass")
    x0, masses = states(5), np.linspace(0.1, 2.0, 5)[:, None]
    after = arm.stepper(0.005, batch=5, substeps=5)(x0, np.zeros(2), masses)
    for x, mass, have in zip(x0, masses, after):
        want = arm.simulate(x, None, np.array([0.0, 0.005]), p=mass, method="rk4", step=0.001).x[-1]
        np.testing.assert_allclose(have, want, rtol=1e-8, atol=1e-9)


def test_a_lane_depends_neither_on_its_place_nor_on_the_batch() -> None:
    x0, u = states(29), np.array([1.0, 0.5])
    whole = ARM.stepper(0.01, batch=29, substeps=10)(x0, u)
    alone = ARM.stepper(0.01, batch=1, substeps=10)
    for k in (0, 7, 28):
        assert np.array_equal(alone(x0[k : k + 1], u)[0], whole[k])
    turned = ARM.stepper(0.01, batch=29, substeps=10)(x0[::-1].copy(), u)
    assert np.array_equal(turned[::-1], whole)


def test_threads_change_nothing() -> None:
    x0 = states(640)
    one = ARM.stepper(0.01, batch=640, threads=1, substeps=10)(x0, np.zeros(2))
    two = ARM.stepper(0.01, batch=640, threads=2, substeps=10)(x0, np.zeros(2))
    assert np.isfinite(one).all()
    assert np.array_equal(one, two)


def test_fortran_order_is_used_in_place() -> None:
    x = np.asfortranarray(states(64))
    want = ARM.stepper(0.003, batch=64)(x.copy(), np.ones(2))
    step = ARM.stepper(0.003, batch=64)
    after = step(x, np.ones(2), out=x)
    assert after is x
    assert np.array_equal(x, want)


def test_single_precision_follows_double() -> None:
    x0 = states(16)
    double = ARM.stepper(0.01, batch=16, substeps=10)(x0, np.zeros(2))
    single = ARM.stepper(0.01, batch=16, substeps=10, dtype="float32")(x0.astype(np.float32), np.zeros(2))
    assert single.dtype == np.float32
    error = np.abs(single - double).max() / np.abs(double).max()
    # The accelerations solve M a = r, which no order of additions spoils by more than M's condition number, its rows
    # scaled alike, times the unit roundoff of 24 bits (Higham 2002, Section 10.1): 5e4 * 6e-8, 3e-3.
    scaled = [M / np.sqrt(np.outer(np.diag(M), np.diag(M))) for M in map(ARM.mass_matrix, x0)]
    assert 0 < error < max(map(np.linalg.cond, scaled)) * 2.0**-24 < 4e-3


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: ARM.stepper(0.0, batch=4), "stepper.dt = 0.0 must be > 0"),
        (lambda: ARM.stepper(0.01, batch=0), "stepper.batch = 0 must be an integer from 1"),
        (lambda: ARM.stepper(0.01, method="euler"), "stepper.method = 'euler' must be one of 'rk4'"),
        (lambda: ARM.stepper(0.01, dtype="int32"), "native.dtype = 'int32' must be one of 'float64'"),
        (lambda: ARM.stepper(0.003, batch=4)(np.zeros((3, 12))), r"stepper.x has shape \(3, 12\), must be \(4, 12\)"),
        (lambda: ARM.stepper(0.003, batch=4)(np.zeros((4, 12)), np.zeros(3)), "stepper.u has shape"),
    ],
)
def test_bad_input_is_named(build, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        build()


def test_compiled_plant_gives_the_same_functions() -> None:
    fast = ARM.compile()
    x, u = states(9), np.array([0.3, -0.2])
    assert fast == ARM
    np.testing.assert_allclose(fast.dynamics(x, u), ARM.dynamics(x, u), rtol=1e-9, atol=1e-8)
    np.testing.assert_allclose(fast.measure(x[0], u), ARM.measure(x[0], u), rtol=1e-12, atol=1e-14)
    for batch in (x, x[3]):
        for have, want in zip(fast.jacobians(batch, u), ARM.jacobians(batch, u)):
            assert have.shape == want.shape
            np.testing.assert_allclose(have, want, rtol=1e-9, atol=1e-9 * np.abs(want).max(initial=1.0))
    assert np.array_equal(fast.jacobians(x, u)[0][4], fast.jacobians(x[4], u)[0])  # a point equals its lane


def _child(code: str, **environment: str) -> subprocess.CompletedProcess:
    return subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env={**os.environ, **environment}, check=False
    )


STEP = """
import warnings, numpy as np
warnings.simplefilter("always")
from pliant.plants import SingleLinkArm, TwoLinkArm
arm = TwoLinkArm.textbook()
x = np.zeros((3, 12)); x[:, 0] = -1.0
for _ in range(2):
    step = arm.stepper(0.01, batch=3, substeps=10)
    after = step(x, np.ones(2))
print(step.native, repr(after[1].tolist()))
"""


def test_forced_virtual_machine_gives_the_same_to_rounding(tmp_path: Path) -> None:
    slow = _child(STEP, PLIANT_NATIVE="0", PLIANT_CACHE=str(tmp_path / "cache"))
    flag, numbers = slow.stdout.split(" ", 1)
    assert (flag, slow.stderr) == ("False", "")
    x = np.zeros((3, 12))
    x[:, 0] = -1.0
    want = ARM.stepper(0.01, batch=3, substeps=10)(x, np.ones(2))[1]
    np.testing.assert_allclose(eval(numbers), want, rtol=1e-9, atol=1e-12)


@needs_compiler
@pytest.mark.parametrize("compiler_command", ["no-such-compiler", "false"])
def test_without_a_compiler_one_line_is_said_once(tmp_path: Path, compiler_command: str) -> None:
    done = _child(STEP, CC=compiler_command, PLIANT_CACHE=str(tmp_path / "cache"))
    assert done.returncode == 0
    assert done.stdout.startswith("False [")
    assert done.stderr.count("native code is off") == 1


@needs_compiler
def test_a_compiler_that_takes_too_long_is_given_up(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    slow = tmp_path / "slow-cc"
    slow.write_text("#!/bin/sh\nsleep 20\n")
    slow.chmod(0o755)
    monkeypatch.setattr(compiler, "TIMEOUT", 0.2)
    with pytest.raises(compiler.CompileError, match="took more than"):
        compiler._run((str(slow),), "--version")


@needs_compiler
def test_a_kernel_that_disagrees_is_not_published(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PLIANT_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(kernel_loader, "_told", set())
    right = kernel_templates.rk4_source
    monkeypatch.setattr(kernel_templates, "rk4_source", lambda *a: right(*a).replace("h / 6", "h / 5"))
    arm = TwoLinkArm.textbook()
    with pytest.warns(kernel_loader.NativeWarning) as said:
        kernel = step_kernel.__wrapped__(arm, "rk4", as_dtype("float64"))
        step_kernel.__wrapped__(arm, "rk4", as_dtype("float64"))
        step_kernel.__wrapped__(arm, "rk4", as_dtype("float32"))
    words = [str(w.message) for w in said]  # once a kernel: which, what it costs, and why
    assert len(words) == 2 and "in single precision" in words[1] and not kernel.native
    for line in words:
        assert line.startswith("native code is off for rk4 steps of TwoLinkArm (linear, clamped-free 2+2)")
        assert "times slower" in line and "disagrees with the virtual machine by" in line
    assert [p.name for p in kernel_cache.entries() if p.name.startswith(("kernel", "building"))] == []


@needs_compiler
def test_an_operation_without_a_c_form_is_said_and_the_virtual_machine_runs(monkeypatch) -> None:
    monkeypatch.setattr(kernel_loader, "_told", set())
    x = ca.SX.sym("x", 2)
    with pytest.warns(kernel_loader.NativeWarning, match="the function 'odd'.*has no C form"):
        kernel = map_kernel(ca.Function("odd", [x], [ca.erf(x)]), [np.ones((2, 4))])
    work = kernel.workspace(1)
    work.set(0, np.array([0.5, 0.0]))
    work.run()
    np.testing.assert_allclose(work.get(0)[0], [math.erf(0.5), 0.0], rtol=1e-15)


@pytest.mark.parametrize(("value", "want"), [("0", False), ("off", False), ("1", True), ("", True), ("TRUE", True)])
def test_native_code_is_asked_for_in_words(monkeypatch, value, want) -> None:
    monkeypatch.setenv("PLIANT_NATIVE", value)
    assert kernel_loader.wanted() is want
    monkeypatch.setenv("PLIANT_NATIVE", "banana")
    with pytest.raises(ValueError, match=r"PLIANT_NATIVE='banana' must be 0 .* or 1"):
        kernel_loader.wanted()


@needs_compiler
def test_a_library_of_another_machine_is_built_anew(monkeypatch, tmp_path) -> None:
    """Whole files, by their digest, that this machine cannot load, or that lack what a kernel has."""
    monkeypatch.setenv("PLIANT_CACHE", str(tmp_path / "cache"))
    link, dtype = SingleLinkArm.textbook().ladder()[0], as_dtype("float64")
    first = step_kernel.__wrapped__(link, "rk4", dtype)
    for content in (b"\x7fELF of another machine", compiler.build("int nothing(void) { return 0; }")):
        monkeypatch.setattr(kernel_loader, "_loaded", {})
        kernel_cache.write(first.kernel.path.name, content)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            assert step_kernel.__wrapped__(link, "rk4", dtype).native


@needs_compiler
def test_vector_width_is_used() -> None:
    """The lane loop of the arm's dynamics holds vector arithmetic of the full width, not scalar code."""
    source = kernel_templates.rk4_source(rate_function(ARM), np.dtype(float))
    tools = compiler.toolchain()
    listing = subprocess.run(
        [*tools.command, *tools.compile_flags, "-S", "-x", "c", "-", "-o", "-"],
        input=source, capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip
    if tools.width >= 256:
        register = "%zmm" if tools.width == 512 else "%ymm"
        products = [line for line in listing.splitlines() if "mulpd" in line or ("fmadd" in line and "pd" in line)]
        scalar = [line for line in listing.splitlines() if "mulsd" in line or ("fmadd" in line and "sd" in line)]
        wide = [line for line in products if register in line]
        assert len(wide) > 200
        assert len(scalar) < len(wide) / 20


def test_workspace_refuses_arrays_that_are_not_whole_vectors() -> None:
    kernel = map_kernel(rate_function(ARM), random_points(ARM, np.random.default_rng(0)))
    if kernel.kernel is None:
        pytest.skip("no compiler")
    with pytest.raises(ValueError, match="a multiple of 8"):
        kernel.kernel.bind([np.zeros((1, 12))], [np.zeros((1, 12))])


def _control_register() -> int:
    """The x86 floating-point control register through fegetenv (glibc: 28 bytes of x87 state, then MXCSR)."""
    environment = ctypes.create_string_buffer(64)
    ctypes.CDLL("libm.so.6").fegetenv(environment)
    return int.from_bytes(environment.raw[28:32], "little")


@needs_compiler
@pytest.mark.skipif(os.uname().machine != "x86_64", reason="MXCSR is a register of x86-64")
def test_loading_a_kernel_leaves_the_floating_point_mode(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PLIANT_CACHE", str(tmp_path / "cache"))
    before = _control_register()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        kernel = step_kernel.__wrapped__(ARM, "rk4", as_dtype("float64"))
    assert kernel.native
    assert _control_register() & 0x8040 == before & 0x8040 == 0  # neither flush-to-zero nor denormals-are-zero
    assert np.float64(5e-324) * np.float64(1.0) > 0.0


@needs_compiler
@pytest.mark.skipif(os.uname().machine != "x86_64", reason="crtfastmath.o is x86's")
def test_the_trap_is_real_and_would_be_seen(tmp_path: Path) -> None:
    """Linking with -ffast-math, as a naive build does, sets flush-to-zero for the process that loads the library."""
    tools = compiler.toolchain()
    if "gcc" not in subprocess.run([*tools.command, "-v"], capture_output=True, text=True, check=False).stderr:
        pytest.skip("only gcc links crtfastmath.o")
    c, so = tmp_path / "trap.c", tmp_path / "trap.so"
    c.write_text("int nothing(void) { return 0; }\n")
    subprocess.run([*tools.command, "-ffast-math", "-shared", "-fPIC", str(c), "-o", str(so)], check=True)
    done = _child(f"import ctypes; ctypes.CDLL({str(so)!r}); print(5e-324 * 1.0 > 0.0)")
    if done.stdout.strip() == "True":
        pytest.skip("this gcc is of a version (13 or later) that no longer links crtfastmath.o into libraries")
    assert done.stdout.strip() == "False"
