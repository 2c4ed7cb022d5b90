"""Rates and outputs along a motion: natively the virtual machine's, with its warnings and errors."""

import numpy as np
import pytest
from oscillators import Oscillator, Scalar

from pliant.plants import MassMatrixError, SingleLinkArm
from pliant.plants.core.errors import NotFiniteWarning
from pliant.plants.motions import compile_rule
from pliant.plants.motions.observations import Observer, Slopes, compile_observations, observer, slopes_at_rows
from pliant.plants.native import kernel_loader

pytestmark = pytest.mark.skipif(not kernel_loader.wanted(), reason="PLIANT_NATIVE=0: nothing is compiled")


@pytest.fixture
def at_once(monkeypatch):
    for price in ("COMPILING", "LOOKING"):
        monkeypatch.setattr(compile_rule, price, (0.0, 0.0))


@pytest.mark.parametrize("rows", [1, 7, 8, 30])
def test_rows_are_the_virtual_machines(at_once, rows):
    plant, rng = Oscillator(), np.random.default_rng(rows)
    x, u, w, t = rng.normal(size=(rows, 2)), rng.normal(size=(rows, 1)), np.array([0.3]), rng.normal(size=(rows, 1))
    (rate,), (y,), _ = Observer(plant)((t, x, u, w, np.zeros(0)), rows)
    np.testing.assert_allclose(rate, np.column_stack([x[:, 1], u[:, 0] + 0.3 - 100 * x[:, 0]]), rtol=1e-14)
    np.testing.assert_allclose(y, x[:, :1] + u, rtol=1e-14)
    assert rate.flags.c_contiguous


def test_rows_without_a_number_are_told_of(at_once):
    plant = Scalar(ends=True)
    values, rows = plant._arguments(np.array([[0.0], [2.0]]), t=np.zeros(2))
    results, *_ = Observer(plant)(values, rows)
    with pytest.warns(NotFiniteWarning, match=r"1 of 2 entries are not finite, first \[1, 0\]"):
        plant._told_rates(values, results)


def test_a_mass_matrix_that_is_lost_is_an_error():
    arm = SingleLinkArm.textbook()
    values, rows = arm._arguments(np.zeros((2, arm.nx)))
    rate, pivot = arm._dynamics(*values, batch=rows)
    with pytest.raises(MassMatrixError, match="not positive definite"):
        arm._told_rates(values, [rate, -pivot])


def test_few_rows_stay_on_the_virtual_machine_and_are_counted():
    own = Observer(Oscillator(omega=np.e))
    values = (np.zeros((3, 1)), np.ones((3, 2)), np.zeros(1), np.zeros(1), np.zeros(0))
    own(values, 3)
    assert own.kernel.spent > 0.0 and not own.kernel.compiled
    assert observer(Oscillator(omega=np.e)) is observer(Oscillator(omega=np.e))


def test_what_is_asked_for_is_compiled_unless_it_costs_too_much():
    plant = Oscillator(omega=1.2345)  # of no other test
    own = observer(plant), slopes_at_rows(plant)
    compile_observations(plant, 0.5 * min(seen.kernel.price for seen in own))
    assert not any(seen.kernel.compiled or seen.kernel._looked for seen in own)  # nor looked for on disk
    compile_observations(plant, 2.0 * max(seen.kernel.price for seen in own))
    assert all(seen.kernel.at_hand for seen in own)


@pytest.mark.parametrize("plant", [Oscillator(), SingleLinkArm.textbook()], ids=str)
def test_slopes_are_the_virtual_machines_row_by_row(at_once, plant):
    rng = np.random.default_rng(5)
    values = (
        0.0,
        0.1 * rng.normal(size=(9, plant.nx)),
        rng.normal(size=(9, plant.nu)),
        np.zeros(plant.nw),
        np.zeros(0),
    )
    own = Slopes(plant)
    found = own(values, 9)
    assert own.kernel.compiled or own.kernel._library is not None
    wanted = plant._jacobians(*values, batch=9)[0]
    np.testing.assert_allclose(found, wanted, rtol=1e-10, atol=1e-10 * np.abs(wanted).max())
