"""The reference elements converge at their order."""

import beam_elements
import numpy as np
import pytest

from pliant.plants.beams.offset_payload_roots import OffsetPayload

CASES = (
    "i_plain",
    "ii_Mt1",
    "iii_Ixx0.005_Izz0.05",
    "iii_Ixx0.05_Izz0.05",
    "iii_Ixx0.5_Izz0.005",
    "iii_Ixx0.5_Izz0.5",
)


def system(p):
    return OffsetPayload(
        mass=p["Mt"],
        offset=(p["ax"], p["ay"], p["az"]),
        inertia=(p["Ixx"], p["Izz"], p["Ixz"]),
        chi=p["chi"],
        mu=p["mu"],
    )


@pytest.mark.parametrize("case", CASES)
def test_beam_elements_converge_to_the_roots_at_their_order(reference, case):
    s = system(reference("offset_payload")["cases"][case]["params"])
    roots = s.roots(6)
    meshes = np.array([8, 12, 16, 24])
    errors = np.array(
        [beam_elements.lowest(*beam_elements.bending_torsion(s, int(n)), 6) ** 0.25 / roots - 1 for n in meshes]
    )
    assert np.all(errors > -1e-10) and np.all(errors[-1] < 1e-4)  # from above, as Ritz's do
    seen = errors[-1] > 1e-8
    assert seen.sum() >= 3
    order = np.polyfit(np.log(meshes), np.log(errors[:, seen]), 1)[0]
    np.testing.assert_allclose(order, -4, atol=0.35)
