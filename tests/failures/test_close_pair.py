"""Two roots 3e-4 apart: a search for changes of sign passes over both, counting finds them."""

import beam_elements
import mpmath as mp
import numpy as np

from pliant.plants.beams.offset_payload_roots import OffsetPayload


def pair(reference):
    found = reference("offset_payload")["close_pair"]
    p = found["params"]
    s = OffsetPayload(
        mass=p["Mt"],
        offset=(p["ax"], p["ay"], p["az"]),
        inertia=(p["Ixx"], p["Izz"], p["Ixz"]),
        chi=p["chi"],
        mu=p["mu"],
    )
    return s, found["lambda"]


def test_sign_scan_misses_the_pair_and_the_count_does_not(reference):
    s, expected = pair(reference)
    scan = np.arange(0.5, 43.0, 5e-4) + 0.00011
    value = s.equation(scan)
    crossings = scan[:-1][value[:-1] * value[1:] < 0]
    assert not np.any(np.abs(crossings - expected[0]) < 0.1)
    roots = s.roots(60)
    np.testing.assert_allclose(roots[57:59], expected[:2], rtol=0, atol=1e-8)
    assert len(crossings) == len(roots) - 2
    assert s.count(np.array([42.44, 42.4402, 42.45])).tolist() == [57, 58, 59]
    assert len(s.roots_between(42.44, 42.45)) == 2


def test_shapes_of_the_pair_are_independent(reference):
    modes = pair(reference)[0].shapes(60)
    np.testing.assert_allclose(modes.mass[57:59, 57:59], np.eye(2), atol=1e-10)


def test_root_60_is_not_the_files_third_number(reference):
    """42.640115 is the second root plus 0.2, not a root: a mesh of elements has none from 42.5 to 42.9."""
    s, expected = pair(reference)
    assert abs(expected[2] - expected[0] - 0.2) < 1e-9
    K, M = beam_elements.bending_torsion(s, 160)
    assert [beam_elements.count_below(K, M, v**4) for v in (42.3, 42.5, 42.9, 42.95)] == [57, 59, 59, 60]
    assert abs(s.roots(60)[59] - 42.93097346) < 1e-8
    left, right = (float(s.equation(np.array(mp.mpf(v)).astype(float))) for v in (42.93097, 42.93098))
    assert left * right < 0
