"""Arguments of a plant's functions: defaults, batches, and what is refused by name."""

import numpy as np
import pytest

from pliant.plants import TwoLinkArm
from pliant.plants.dynamics.arguments import checked

ARM = TwoLinkArm.textbook().vary("payload.mass")
X, U = np.zeros(ARM.nx), np.zeros(ARM.nu)


def test_defaults_are_zero_and_the_plants_own_parameters():
    for x in (X, X.tolist()):  # arrays take the short way
        (t, _, u, w, p), batch = checked(ARM, x, U if x is X else None, None, None, 0.0)
        assert batch is None and float(np.squeeze(t)) == 0.0
        assert u.tolist() == [0.0, 0.0] and w.tolist() == [0.0] * ARM.nw and p.tolist() == [ARM.payload.mass]


def test_a_batch_is_as_long_as_its_rows():
    values, batch = checked(ARM, np.zeros((3, ARM.nx)), U, None, [[1.0], [2.0], [3.0]], [0.0, 0.1, 0.2])
    assert batch == 3 and values[0].shape == (3, 1) and values[2].shape == (ARM.nu,)


@pytest.mark.parametrize(
    ("x", "u", "p", "message"),
    [
        (X[1:], U, None, r"TwoLinkArm.x has shape \(\d+,\), must be \(\d+,\) or \(B, \d+\)"),
        (X, [0.0, np.nan], None, r"TwoLinkArm.u\[1\] \(tau2\) = nan must be finite"),
        (X, U, [np.inf], r"TwoLinkArm.p\[0\] \(payload.mass\) = inf must be finite"),
        (np.zeros((2, ARM.nx)), np.zeros((3, ARM.nu)), None, "TwoLinkArm.u has 3 rows, must have 2"),
    ],
)
def test_what_is_refused(x, u, p, message):
    with pytest.raises(ValueError, match=message):
        checked(ARM, x, u, None, p, 0.0)


def test_infinity_is_refused_on_the_short_way_too():
    x = X.copy()
    x[0] = np.inf
    with pytest.raises(ValueError, match=r"x\[0\] \(theta1\) = inf must be finite"):
        checked(ARM, x, U, None, None, 0.0)
