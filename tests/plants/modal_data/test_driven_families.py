"""The modes of modal data by the motions of the root that drive them."""

import numpy as np
import pytest

from pliant.envs.machines.spacecraft_parts import LINE, WIDTH
from pliant.plants.modal_data.driven_families import before_the_last, left_out
from pliant.plants.modal_data.modal_data import ModalData


def panel(bending, twisting=0):
    return ModalData.panel(LINE, WIDTH, (bending, twisting))


@pytest.mark.parametrize("bending", [1, 2, 3, 4])
def test_the_last_of_a_family_and_those_above_it_go(bending):
    assert before_the_last(panel(bending)) == bending - 1
    assert before_the_last(panel(bending, 2)) < bending + 1


@pytest.mark.parametrize(("known", "turned"), [(2, True), (3, True), (4, True), (2, False), (3, False), (4, False)])
def test_what_is_left_out_is_that_of_a_cantilever_whose_root_is_moved_slowly(known, turned):
    """Mode k under the inertia of a root that is turned (its load x) or moved (its load 1) bends the tip by
    phi_k(L) integral(load phi_k) / lambda_k^4; of clamped-free modes phi_k(L) = 2 (-1)^(k+1), integral(x phi_k) =
    2 / lambda_k^2, integral(phi_k) = 2 sigma_k / lambda_k. lambda_k and sigma_k: Blevins, "Formulas for Natural
    Frequency and Mode Shape" (1979), table 8-1. Summed as if all had one sign, which makes the sum no smaller.
    """
    roots = np.append([1.87510407, 4.69409113, 7.85475744, 10.99554073], (2 * np.arange(5, 31) - 1) * np.pi / 2)
    sigma = np.append([0.734095514, 1.018467319, 0.999224497, 1.000033553], np.ones(26))
    tip = 1 / roots**6 if turned else sigma / roots**5
    true = tip[known:].sum() / tip[known - 1]
    found = left_out(panel(known), turned=turned)
    assert max(true, 0.05) == pytest.approx(found, rel=0.1)


def test_of_what_a_single_mode_does_some_is_always_left_out():
    assert left_out(panel(1), turned=True) == 0.05
