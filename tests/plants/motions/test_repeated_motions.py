"""Motions that are simulated again are those of the long way, to the last digit, refused and warned of in its words."""

import dataclasses
import pickle
import warnings

import numpy as np
import pytest

from pliant.plants import SingleLinkArm
from pliant.plants.core.errors import PliantError, StabilityLimitError, ValidityWarning
from pliant.plants.integration.batch_stepper import motion_kernel
from pliant.plants.motions import played_motion, repeated_motions
from pliant.plants.motions.observations import observer, slopes_at_rows
from pliant.plants.motions.time_limit import time_limit

ARM = dataclasses.replace(SingleLinkArm.textbook(), kinematics="linear", modes=1).vary("payload.mass", "link.E")
T = np.linspace(0.0, 0.5, 21)
HELD = np.where(T < 0.2, 1.0, -0.5)[:, None]
START = np.array([0.1, 0.01, 0.2, -0.1])
AS_IT_WAS = {"method": "rk4", "step": 0.002}


@pytest.fixture(scope="module")
def arm():
    """With all that is compiled of it in memory."""
    plant = dataclasses.replace(ARM)
    for kernel in (motion_kernel(plant, "rk4"), observer(plant).kernel, slopes_at_rows(plant).kernel):
        if kernel.library(np.inf) is None:
            pytest.skip("no compiler")
    played_motion.program.spent = np.inf
    plant.simulate(START, HELD, T, **AS_IT_WAS)
    return plant


def both(plant, monkeypatch, *given, **options):
    """What is given, raised and warned of, and that of the long way; whether the short way was gone."""
    told, gone, again = [], [], repeated_motions.again

    def short(*values):
        gone.append(found := again(*values))
        return found

    for way in (short, lambda *values: None):
        monkeypatch.setattr(repeated_motions, "again", way)
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            try:
                found = plant.simulate(*given, **{**AS_IT_WAS, **options})
            except (ValueError, PliantError) as error:
                found = f"{type(error).__name__}: {error}"
        told.append((found, [(w.category, str(w.message), w.filename) for w in said]))
    monkeypatch.setattr(repeated_motions, "again", again)
    return *told, any(one is not None for one in gone)


@pytest.mark.parametrize("u", [None, np.array([0.3]), HELD, -2 * HELD], ids=["none", "constant", "held", "more"])
def test_it_is_the_motion_of_the_long_way(arm, monkeypatch, u):
    for options in ({}, {"p": np.array([0.3, 7e10])}):
        (short, said), (long, meant), gone = both(arm, monkeypatch, START, u, T, **options)
        assert gone and said == meant
        for name in ("t", "x", "u", "y", "dx", "w"):
            one, other = getattr(short, name), getattr(long, name)
            np.testing.assert_array_equal(one, other, strict=True)
            assert not one.flags.writeable and one.flags.owndata and one.flags.c_contiguous
        for name in ("states", "inputs", "outputs", "disturbances", "hold"):
            assert getattr(short, name) == getattr(long, name)
        assert {k: v for k, v in short.stats.items() if k != "seconds"} == {
            k: v for k, v in long.stats.items() if k != "seconds"
        }
        assert pickle.loads(pickle.dumps(short))["tip_x"][-1] == long["tip_x"][-1]


def at(array, place, value):
    changed = array.copy()
    changed[place] = value
    return changed


@pytest.mark.parametrize(
    ("given", "options", "words"),
    [
        ((at(START, 1, np.nan), HELD, T), {}, "ValueError: SingleLinkArm.x[1]"),
        ((START, at(HELD, (3, 0), np.inf), T), {}, "ValueError: SingleLinkArm.u"),
        ((START, HELD, T), {"p": np.array([np.nan, 7e10])}, "ValueError: SingleLinkArm.p"),
        ((START, HELD, T), {"rtol": 2.0}, "ValueError: rtol"),
        ((START, HELD, T), {"audit": 0}, "ValueError: simulate.audit"),
        ((START[:3], HELD, T), {}, "ValueError: SingleLinkArm.x has shape"),
        ((START, HELD[:-1], T), {}, "ValueError: SingleLinkArm.u has shape"),
        ((START, 1e99 * HELD, T), {}, ""),
        ((1e120 * START, HELD, T), {}, ""),
    ],
)
def test_what_is_odd_is_refused_in_the_words_of_the_long_way(arm, monkeypatch, given, options, words):
    short, long, gone = both(arm, monkeypatch, *given, **options)
    assert not gone and str(short) == str(long)
    assert words in str(short[0])


def test_it_starts_at_rest_where_no_state_is_given(arm, monkeypatch):
    (short, _), (long, _), gone = both(arm, monkeypatch, None, HELD, T)
    assert gone
    np.testing.assert_array_equal(short.x, long.x)


@pytest.mark.parametrize("name", ["check_state", "_sound_rate"])
def test_what_a_plant_itself_refuses_it_refuses(arm, monkeypatch, name):
    def refused(*given):
        raise ValueError(f"{name} of {given[1].shape}")

    monkeypatch.setattr(SingleLinkArm, name, refused)
    short, long, _ = both(arm, monkeypatch, START, HELD, T)
    assert short == long and short[0].startswith(f"ValueError: {name}")


def test_a_range_that_is_left_is_told_and_kept(arm, monkeypatch):
    (short, said), (long, meant), gone = both(arm, monkeypatch, 40 * START, HELD, T)
    assert gone and said == meant and said[0][0] is ValidityWarning and said[0][2] == __file__
    assert short.stats["validity"] == long.stats["validity"]


@pytest.mark.parametrize(("size", "refused"), [(2.0, False), (2.7, False), (3.5, True)])
def test_a_step_past_its_limit_is_refused(arm, monkeypatch, size, refused):
    """Up to 2 sqrt(2) over the eigenvalue, a little more if damped; from 2.5 on the long way decides."""
    mass, stiffness = arm.nominal_parameters
    fastest = np.abs(np.linalg.eigvals(arm.jacobians(np.zeros(4))[0])).max()
    p = np.array([mass, stiffness * (size / (fastest * AS_IT_WAS["step"])) ** 2])
    (short, said), (long, meant), gone = both(arm, monkeypatch, 1e-3 * START, HELD, T, p=p)
    assert gone == (size < 2.5) and said == meant
    if refused:
        assert short == long and short.startswith(f"{StabilityLimitError.__name__}: rk4 with a step of")
    else:
        np.testing.assert_array_equal(short.x, long.x)


def test_nothing_is_taken_from_another_grid_or_step(arm, monkeypatch):
    for given, options in (((START, HELD, T * 1.01), {}), ((START, HELD, T), {"step": 0.0021})):
        (short, _), (long, _), gone = both(arm, monkeypatch, *given, **options)
        assert not gone
        np.testing.assert_array_equal(short.x, long.x)


def test_it_goes_the_long_way_under_a_limit_of_time_and_where_native_code_is_not_wanted(arm, monkeypatch):
    given = (arm, START, HELD, T, None, None, "rk4", 0.002, (1e-10, 1e-12))
    assert repeated_motions.again(*given) is not None
    with time_limit(100.0):
        assert repeated_motions.again(*given) is None
    monkeypatch.setenv("PLIANT_NATIVE", "0")
    assert repeated_motions.again(*given) is None


def test_a_motion_keeps_its_numbers_when_the_next_is_played(arm):
    first = arm.simulate(START, HELD, T, **AS_IT_WAS)
    kept = first.x.copy(), first.t.copy(), first.y.copy()
    arm.simulate(2 * START, -HELD, T, **AS_IT_WAS)
    np.testing.assert_array_equal(kept[0], first.x)
    np.testing.assert_array_equal(kept[1], first.t)
    np.testing.assert_array_equal(kept[2], first.y)


def test_a_plant_travels_without_what_was_laid_out(arm):
    assert repeated_motions.NAME in vars(arm)
    assert repeated_motions.NAME not in vars(pickle.loads(pickle.dumps(arm)))
    assert repeated_motions.NAME not in vars(dataclasses.replace(arm))


def test_one_caller_at_a_time_has_its_arrays(arm):
    known = vars(arm)[repeated_motions.NAME][*AS_IT_WAS.values(), T.tobytes()]
    given = (arm, START, HELD, T, None, None, "rk4", 0.002, (1e-10, 1e-12))
    with known.played.lock:
        assert repeated_motions.again(*given) is None
    assert repeated_motions.again(*given) is not None
