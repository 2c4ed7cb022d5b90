"""The C of the templates, as the compiler turns it into instructions."""

import subprocess

import casadi as ca
import numpy as np
import pytest

from pliant.plants import TwoLinkArm
from pliant.plants.integration.batch_stepper import rate_function
from pliant.plants.native import compiler, kernel_loader, kernel_templates

ARM = TwoLinkArm.textbook()


@pytest.mark.skipif(not kernel_loader.wanted(), reason="PLIANT_NATIVE=0: nothing is compiled")
def test_vector_width_is_used() -> None:
    """The lane loop of the arm's dynamics holds vector arithmetic of the full width, not scalar code."""
    rate = rate_function(ARM)
    multiplied = sum(rate.instruction_id(k) in (ca.OP_MUL, ca.OP_SQ) for k in range(rate.n_instructions()))
    source = kernel_templates.rk4_source(rate, np.dtype(float))
    tools = compiler.toolchain()
    if tools.width < 256:
        pytest.skip("this processor's vectors hold no more than two numbers of double precision")
    listing = subprocess.run(
        [*tools.command, *tools.compile_flags, "-S", "-x", "c", "-", "-o", "-"],
        input=source, capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip
    register = "%zmm" if tools.width == 512 else "%ymm"
    products = [line for line in listing.splitlines() if "mulpd" in line or ("fmadd" in line and "pd" in line)]
    scalar = [line for line in listing.splitlines() if "mulsd" in line or ("fmadd" in line and "sd" in line)]
    wide = [line for line in products if register in line]
    assert len(wide) > 0.8 * multiplied > 100
    assert len(scalar) < len(wide) / 20
