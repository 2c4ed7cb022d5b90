"""`assess` told what lies beyond the record, held against rates for ever that are known in closed form."""

import numpy as np
import pytest
from known_systems import ltv
from long_run_systems import FAMILIES, long_run

from pliant.plants.stability import assess

SEEDS = range(30)  # six of each family; `make campaign` takes more


def answer(seed):
    s = long_run(seed)
    v = assess(s.model, thorough=False, **{"beyond": "persists", **s.options})
    return s, v


def test_known_systems_are_decided_and_none_wrong():
    decided = dict.fromkeys(FAMILIES, 0)
    for seed in SEEDS:
        s, v = answer(seed)
        if v.verdict in ("stable", "unstable"):
            decided[s.family] += 1
            assert v.verdict == ("unstable" if s.truth > 0 else "stable" if s.truth < 0 else "neither"), seed
            if np.isfinite(v.margin_bound):
                assert s.truth <= -v.margin_bound + 1e-7, seed
    assert decided["edge"] == 0
    assert sum(decided.values()) >= 0.9 * len(SEEDS) * 4 / 5


@pytest.fixture
def fades():
    """An oscillator undamped at first, damped at 0.1 1/s in the end."""
    t = np.linspace(0.0, 20.0, 201)
    A = np.array([[0.0, 1.0], [-4.0, -0.2]]) + np.exp(-t)[:, None, None] * np.array([[0.0, 0.0], [0.0, 0.2]])
    return ltv(t, A)


def test_the_assumption_stands_in_the_sentence(fades):
    told = assess(fades, beyond="constant")
    assert told.verdict == "stable" and told.method == "exponents"
    assert told.margin == pytest.approx(0.1, abs=1e-6) and told.margin_bound <= told.margin
    assert "provided that A stays what it is at the end of the record" in told.sentence
    assert "estimate" not in told.sentence
    assert told.to_json()["provided"] in told.sentence
    assert "over the record alone" in told.why


def test_a_rate_of_what_persists_is_an_estimate():
    for seed in range(2, 40, 5):  # "almost" periodic
        _, v = answer(seed)
        if v.verdict in ("stable", "unstable"):
            assert np.isnan(v.margin_bound) and "at an estimated" in v.sentence and "provided that" in v.sentence
            return
    raise AssertionError("none decided")


def test_without_it_the_answer_is_about_the_record(fades):
    alone = assess(fades)
    assert alone.provided == "" and "in the long run" not in alone.sentence
    assert alone.reasons["exponents"] == "what lies beyond the record is not given"


def test_what_does_not_go_together_is_refused(fades):
    for options, says in (
        ({"beyond": "forever"}, "assess.beyond = 'forever' must be one of"),
        ({"limit": np.eye(2)}, "belong to beyond = 'tends'"),
        ({"beyond": "constant", "within": 0.1}, "belong to beyond = 'tends'"),
        ({"beyond": "constant", "periodic": True}, "assess.periodic = True does not go with"),
        ({"beyond": "periodic", "periodic": False}, "assess.periodic = False does not go with"),
    ):
        with pytest.raises(ValueError, match=says.replace("(", r"\(")):
            assess(fades, **options)
    with pytest.raises(ValueError, match="of a LinearModel, must be None"):
        assess(fades.at(0), beyond="constant")


@pytest.mark.parametrize(("mean", "said"), [(0.15, "unstable"), (0.0, "undecided"), (-0.15, "not unstable")])
def test_a_record_of_a_few_swings_tells_growth_by_smooth_averages(mean, said):
    """dx/dt = (mean + two oscillations) x for 4 s, whose plain averages over half of it stray by 0.15 1/s."""
    t = np.linspace(0.0, 4.0, 601)
    swings = 0.6 * np.cos(6.3 * t + 1.0) + 0.5 * np.cos(11.0 * t + 4.0)
    v = assess(ltv(t, (mean + swings)[:, None, None]), thorough=False, beyond="persists")
    assert v.verdict == said if said != "not unstable" else v.verdict != "unstable"
    if said == "unstable":
        assert v.margin == pytest.approx(-mean, rel=0.05) and np.isnan(v.margin_bound)
        assert "estimated from one deviation's growth" in v.why and "at an estimated" in v.sentence


@pytest.mark.parametrize(
    ("span", "size", "speed", "phase"),
    [(4.6, (1.8, 1.6), (6.3, 6.7), (0.3, 2.0)), (4.4, (1.7, 1.2), (6.3, 19.6), (1.4, 3.9))],
)
def test_growth_by_coupling_alone_is_not_told_for_growth(span, size, speed, phase):
    """Triangular, both diagonal entries of mean -0.02 1/s: all decays, though a deviation grows by a half here."""
    t = np.linspace(0.0, span, 121)
    A = np.zeros((121, 2, 2))
    A[:, 0, 1] = 1.0
    for i in (0, 1):
        A[:, i, i] = size[i] * np.cos(speed[i] * t + phase[i]) - 0.02
    assert assess(ltv(t, A), thorough=False, beyond="persists").verdict != "unstable"


def test_systems_that_grow_less_than_tenfold_are_decided():
    """Of the family "little" those that plain averages left undecided, the quickest of them."""
    assert all(answer(seed)[1].verdict == "unstable" for seed in (93, 123, 133, 178))
