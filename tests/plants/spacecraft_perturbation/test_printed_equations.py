"""Which printed elements differ."""

import pytest
from craft_cases import craft, random_nominal

from pliant.plants.spacecraft_perturbation.printed_equations import differences


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
