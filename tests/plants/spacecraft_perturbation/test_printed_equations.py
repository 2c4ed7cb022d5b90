"""Which printed elements differ."""

import numpy as np
import pytest

from pliant.plants.core.quaternions import matrix_of
from pliant.plants.modal_data.modal_data import ModalData
from pliant.plants.spacecraft.appendage import Appendage, Hinge
from pliant.plants.spacecraft.hub import Hub
from pliant.plants.spacecraft.plant import FlexibleSpacecraft
from pliant.plants.spacecraft_perturbation.perturbation import RigidNominal
from pliant.plants.spacecraft_perturbation.printed_equations import differences


def unit(v):
    return tuple(v / np.linalg.norm(v))


def craft(kinematics, freedoms, seed=1, principal=False):
    """Random bodies, mountings and hinges."""
    rng = np.random.default_rng(seed)

    def body():
        g = rng.normal(size=(2, 2, 9, 3))
        return ModalData.from_nodes(
            rng.normal(size=(9, 3)),
            rng.uniform(0.5, 2, 9),
            rng.normal(size=(2, 9, 3)),
            stiffness=np.diag(rng.uniform(1, 3, 2)),
            damping=0.02,
            shortening=(g + g.swapaxes(0, 1)) / 2,
        )

    parts = tuple(
        Appendage(
            position=tuple(rng.normal(size=3)),
            orientation=tuple(rng.normal(size=4)),
            body=body(),
            damping=0.01,
            hinge=Hinge(axes=tuple(unit(rng.normal(size=3)) for _ in range(n)), stiffness=3.0, damping=0.3),
        )
        for n in freedoms
    )
    root = rng.normal(size=(3, 3))
    spread = root @ root.T + 1.5 * np.eye(3)  # int r r^T dm
    inertia = (3.0, 4.0, 5.0) if principal else np.trace(spread) * np.eye(3) - spread
    return FlexibleSpacecraft(hub=Hub(mass=5.0, inertia=inertia), appendages=parts, kinematics=kinematics)


def random_nominal(made, seed=2):
    """(x, accelerations, RigidNominal of one time) with random rates and accelerations, elastic coordinates zero."""
    rng, at = np.random.default_rng(seed), made.layout
    x, a = rng.normal(size=made.nx), rng.normal(size=6 + len(made.coordinates))
    x[at.quaternion] /= np.linalg.norm(x[at.quaternion])
    first = at.quaternion.stop - 6
    for s, r in zip(at.modes, at.mode_rates):
        x[s] = x[r] = a[s.start - first : s.stop - first] = 0.0
    R = matrix_of(x[at.quaternion])
    turns = [a[s.start - first : s.stop - first] for s in at.hinges]
    nominal = RigidNominal(
        np.array([0.0]),
        x[None, at.quaternion],
        x[None, at.omega],
        a[None, 3:6],
        (R @ a[:3])[None],
        tuple(x[None, s] for s in at.hinges),
        tuple(x[None, s] for s in at.hinge_rates),
        tuple(t[None] for t in turns),
    )
    return x, a, nominal


def test_printed_elements():
    made = craft("linear", (3, 3), principal=True)
    found = {d.block: d for d in differences(made, random_nominal(made)[2])}
    right = {"A_ii", "A_im rot", "A_mi rot", "A_mi trans", "A_mm rot-rot", "A_mm trans-rot", "A_mm rot-trans"}
    right |= {"B_ii", "B_im rot", "B_im trans", "B_mm rot-rot", "B_mm trans-rot", "C_ii modes", "C_mm trans-rot"}
    assert {name for name, d in found.items() if d.agrees} == right
    assert all(d.remark for d in found.values() if not d.agrees)
    damper = found["B_ii damper"]
    assert damper.largest == pytest.approx(3 * damper.scale)  # printed dampers count four times
    assert found["B_mi rot"].largest == pytest.approx(found["B_mi rot"].scale / 2)
    with pytest.raises(ValueError, match=r"hinges have \[1, 2\] freedoms, must have 3 each"):
        differences(craft("linear", (1, 2), principal=True), None)
