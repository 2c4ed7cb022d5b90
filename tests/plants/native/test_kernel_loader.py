"""Which code serves: fall-back to the virtual machine, refusal of a bad kernel, and the floating-point mode."""

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
from pliant.plants.integration.batch_stepper import step_kernel
from pliant.plants.native import compiler, kernel_cache, kernel_loader, kernel_templates
from pliant.plants.native.batch_kernels import as_dtype, map_kernel

ARM, LINK = TwoLinkArm.textbook(), SingleLinkArm.textbook()
needs_compiler = pytest.mark.skipif(
    not kernel_loader.wanted(), reason="PLIANT_NATIVE=0: the virtual machine is under test"
)


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
