import dataclasses

import numpy as np
import pytest
import theorems
from periodic_models import model_of, oscillator

from pliant.plants import LTVModel
from pliant.plants.linear.piecewise_ltv import PiecewiseLTV
from pliant.plants.stability import assess

pytest.importorskip("flint", reason="python-flint is an extra: pip install pliant[rigorous]")


def still(A, nodes=5):
    return model_of(np.linspace(0.0, 1.0, nodes), np.repeat(np.array(A, dtype=float)[None], nodes, axis=0))


def test_constant_model():
    found = assess(still([[0, 1], [-2, -3]]), rigorous=True)
    assert found.verdict == found.proof.verdict == "stable" and found.method == "eigenvalues"
    assert found.margin_bound <= 1.0 < found.margin_bound + 1e-12
    assert "a theorem" in found.sentence and "a theorem" in str(found)
    assert found.to_json()["proof"]["verdict"] == "stable"
    assert assess(still([[0, 1], [-2, -3]])).proof is None


def test_undamped_is_marginal_as_a_theorem():
    found = assess(still([[0, 1], [-2, 0]]).at(0), rigorous=True)
    assert (found.verdict, found.growth, found.proof.rate) == ("marginal", "bounded", (0.0, 0.0))


def test_periodic_with_and_without_damping():
    for damping, told in ((0.05, "stable"), (0.0, "undecided")):
        model = oscillator(lambda t: 2.0 + 0.3 * np.cos(t), 2 * np.pi, damping=damping)
        found = assess(model, rigorous=True)
        assert found.proof.verdict == told and found.proof.kind == "periodic"
        # Liouville: the determinant is exp(-2 d T); both multipliers lie on that circle's square root
        assert found.proof.largest == pytest.approx((np.exp(-damping * 2 * np.pi),) * 2, rel=1e-12)
        assert found.verdict == ("stable" if damping else "marginal")


def test_what_is_not_shown_is_not_said(monkeypatch):
    from pliant.plants.rigorous import enclosed_transition

    model = oscillator(lambda t: 2.0 + 0.3 * np.cos(t), 2 * np.pi, damping=0.05)
    monkeypatch.setattr(enclosed_transition, "MOST_STEPS", 3)
    found = assess(model, rigorous=True)
    assert found.verdict == found.growth.replace("unknown", "undecided") == "undecided" and found.method == ""
    assert "no theorem" in found.why and np.isnan(found.margin_bound)


def test_motion_in_its_own_units():
    t = np.arange(0, 33) / 8.0
    A = np.zeros((33, 2, 2))
    A[:, 0, 0], A[:, 0, 1], A[:, 1, 1] = -1.0, 1e-6 * t, -2.0
    found = assess(model_of(t, A), rigorous=True, periodic=False)
    assert found.verdict == "stable" and found.proof.kind == "motion"
    # x0' = -x0 + 1e-6 t x1, x1 = e^(-2t): x0(4) = 1e-6 e^-4 (1 - 5 e^-4)
    assert found.proof.transition[0, 1] == pytest.approx(1e-6 * np.exp(-4) * (1 - 5 * np.exp(-4)), rel=1e-12)
    assert found.proof.transition_error[0, 1] < 1e-20


def test_pieces_with_jumps_over_a_period():
    t = np.linspace(0.0, 1.0, 5)
    pieces = tuple(model_of(t + k, np.full((5, 1, 1), rate)) for k, rate in enumerate((-1.0, 0.5)))
    joined = PiecewiseLTV(pieces, ((np.array([[1.5]]), np.zeros(1)),))
    found = assess(joined, period=2.0, rigorous=True)
    truth = 1.5 * np.exp(-0.5)
    assert found.verdict == "stable" and found.proof.largest == pytest.approx((truth, truth), rel=1e-15)


def test_left_out_states_and_too_many():
    big: LTVModel = still(-np.eye(13))
    with pytest.raises(ValueError, match=r"assess.rigorous = True of 13 states"):
        assess(big, rigorous=True)
    assert assess(big, states=("x1", "x2"), rigorous=True).verdict == "stable"


def test_the_gates():
    model = still([[0, 1], [-2, -3]])
    with pytest.raises(ValueError, match=r"assess\.rigorous"):
        assess(model, rigorous="yes")
    with pytest.raises(ValueError, match="what is assumed is not shown"):
        assess(model, rigorous=True, beyond="constant")


def test_a_rounding_that_only_the_doubles_show():
    # Routh: s^3 + s^2 + s + c is stable for c < 1; the last bit of c is no finding of `assess`, but one of its doubles
    A = np.eye(3, k=1)
    A[-1] = -(1 + 2**-52), -1.0, -1.0
    model = still(A).at(0)
    assert assess(model).verdict == "marginal"
    found = assess(model, rigorous=True)
    assert (
        found.verdict == "unstable"
        and "as computed, with what rounding and the nodes leave open, marginal" in found.why
    )
    assert dataclasses.replace(found, proof=None).sentence != found.sentence


@pytest.mark.parametrize("seed", range(3))
def test_random_models_with_a_closed_form(seed):
    row = theorems.run(seed)
    assert row["proof"] != "undecided" and not row["wrong"]
