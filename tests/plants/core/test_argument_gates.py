"""The gates: what is taken, what is refused and in which words, and that every public callable stands behind them."""

import inspect
from fractions import Fraction

import bad_input
import casadi as ca
import numpy as np
import pytest
from argument_kinds import Failing, Hostile, endless
from calls_of_identification import identification_calls
from calls_of_models import model_calls
from calls_of_plants import plant_calls

import pliant.plants
from pliant.plants import Beam, LinearModel, Material, Payload, beams, stability
from pliant.plants.core import argument_gates as gates
from pliant.plants.core.signals import as_signals

SAMPLE = 700  # of some 11,000 calls: tests/campaigns/bad_input.py makes them all


def test_real_numbers_of_any_kind_and_layout():
    want = np.array([[1.0, 2.0], [3.0, 4.0]])
    locked = want.astype(">f8")
    locked.setflags(write=False)
    same = (want.tolist(), want.astype(int), want.astype(np.float32), np.asfortranarray(want), locked)
    mixed = ([[1, 2.0], (3, 4)], [[Fraction(1), 2], [3, 4]], np.ma.masked_array(want))
    for given in (*same, *mixed):
        found = gates.require_finite("a", given, (2, 2))
        assert found.dtype == np.float64 and (found == want).all()
    assert gates.real_array("a", want) is want


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (["1", "2"], r"a = \['1', '2'\] must be an array of real numbers, has strings"),
        ([1.0, 1j], "has complex numbers"),
        ([1.0, None], "has objects"),
        ([[1.0], [1.0, 2.0]], "rows of one length"),
        ([10**400, 1.0], "beyond what a float holds"),
        (np.ma.masked_array([1.0, 2.0], mask=[True, False]), "1 masked"),
        ([1.0, 2.0, 3.0], r"a has shape \(3,\), must be \(2,\)"),
        ([1.0, np.nan], r"a\[1\] = nan must be finite"),
        (Hostile(), "a = <Hostile> must be"),
    ],
)
def test_what_is_no_real_number_is_refused_in_words(given, words):
    with pytest.raises(ValueError, match=words):
        gates.require_finite("a", given, (2,))


def test_one_number():
    for value in (2, 2.0, np.float32(2), np.int8(2), np.array(2.0), Fraction(2)):
        found = gates.require_number("a", value, "positive", "m")
        assert found == 2.0 and type(found) is float
    for value in (0.0, -1, np.inf, np.nan, 10**400, "2", [2.0], True, None, 2j, np.zeros(2)):
        with pytest.raises(ValueError, match=r"a = .* must be (a number )?> 0 \[m\]"):
            gates.require_number("a", value, "positive", "m")
    with pytest.raises(ValueError, match=r"a = 3 must be within \[0, 2\]$"):
        gates.require_number("a", 3, least=0.0, most=2.0)
    with pytest.raises(ValueError, match=r"a = 3 must be > 0 and at most 2$"):
        gates.require_number("a", 3, "positive", most=2.0)


def test_counts_choices_names_and_objects():
    assert (
        gates.require_count("a", "n", np.int64(3), 0, 5) == 3
        and type(gates.require_count("a", "n", np.uint8(3), 0, 5)) is int
    )
    assert gates.require_counts("a", "n", np.array([1, 2]), 0, 5) == (1, 2)
    for value in (True, 3.0, "3", None, [3], 10**30):
        with pytest.raises(ValueError, match=r"a\.n = .* must be an integer from 0 to 5"):
            gates.require_count("a", "n", value, 0, 5)
    with pytest.raises(ValueError, match=r"a\.n = \(1, 1\) must name each once"):
        gates.require_counts("a", "n", (1, 1), 0, 5)
    gates.require_choice("a", "n", np.str_("b"), ("b", "c"))
    for value in ("nonsense", 1, True, None, ["b"], np.zeros(2), np.nan):
        with pytest.raises(ValueError, match=r"a\.n = .* must be one of 'b', 'c'"):
            gates.require_choice("a", "n", value, ("b", "c"))
    assert gates.require_names("n", ["b", "c"]) == ("b", "c")
    for value in ("bc", 3, ("b", 3), ("b", "b"), {"b": 1}, None):
        with pytest.raises(ValueError, match="n"):
            gates.require_names("n", value)
    with pytest.raises(ValueError, match=r"n = 3 must be an Axis, not int"):
        gates.require_instance("n", 3, type("Axis", (), {}))
    assert gates.require_by_name("n", {"b": np.int64(2)}) == {"b": 2.0}
    with pytest.raises(ValueError, match=r"n\['b'\] = nan must be a finite number"):
        gates.require_by_name("n", {"b": np.nan})


def test_a_sample_of_the_campaign():
    found = [*plant_calls(), *model_calls(), *identification_calls()]
    rng = np.random.default_rng(12)
    pick = rng.choice(len(bad_input.cases(found)), size=SAMPLE, replace=False)
    wrong = [row for row in bad_input.run(found, pick) if row["fault"]]
    assert not wrong, wrong[:5]


# what holds no arguments of a user's own, or is called with symbols by the library
INNER = {
    *("Plant", "LagrangianPlant", "Terms", "ModeShapes", "Polynomials", "Basis", "PayloadModes", "LinearModel"),
    *(
        "ModalData",
        "Trajectory",
        "Certificate",
        "Floquet",
        "FrozenTime",
        "Growth",
        "SlowVariation",
        "Verdict",
        "FiniteHorizon",
        "PointingBudget",
    ),
}


def test_every_public_callable_has_a_call():
    named = {
        part
        for call in [*plant_calls(), *model_calls(), *identification_calls()]
        for part in (call.name, call.name.split(".")[-1])
    }
    for module in (pliant.plants, beams, stability):
        for name in dir(module):
            thing = getattr(module, name)
            own = getattr(thing, "__module__", "").startswith("pliant.")
            failure = inspect.isclass(thing) and issubclass(thing, (Exception, Warning))
            if own and callable(thing) and not failure and name not in INNER:
                assert name in named or any(n.startswith(f"{name}.") for n in named), name


@pytest.mark.parametrize(
    "value", [np.array("a"), np.array(1.0), ca.SX.sym("a", 2), ca.DM([1, 2]), Failing(), {"a"}, "a"]
)
def test_what_has_no_order_is_no_tuple_of_names(value):
    for gate in (gates.require_names, lambda name, given: as_signals(name, given, None, "")):
        with pytest.raises(ValueError, match=r"a = .* must be a tuple of names"):
            gate("a", value)


def test_what_numpy_would_read_as_numbers_is_refused():
    for value in (np.timedelta64(1, "ns"), np.datetime64("NaT"), bytearray(b"12345678"), ca.SX.sym("a", 2), endless()):
        with pytest.raises(ValueError, match="a = "):
            gates.require_number("a", value)
        with pytest.raises(ValueError, match=r"a = |a has"):
            gates.require_finite("a", value, (8,))
        with pytest.raises(ValueError, match=r"o\.a = "):
            gates.require_count("o", "a", value, 0, 9)


def test_lists_without_end_and_vectors_of_symbols_are_no_quantities():
    for value in (endless(), ca.SX.sym("a", 2), np.timedelta64(1, "ns")):
        with pytest.raises(ValueError, match=r"Payload\.mass = "):
            Payload(mass=value)
    assert Payload(mass=ca.SX.sym("m")).mass.is_scalar()


@pytest.mark.parametrize("size", [1e300, -1e300, 1e76])
def test_a_number_whose_fourth_power_is_none_is_refused(size):
    """The naive way: a width of 1e300 m ends in an OverflowError of Python's power, 300 lines below."""
    with pytest.raises(ValueError, match=r"a = .* at most 1e\+75"):
        gates.require_number("a", size)
    with pytest.raises(ValueError, match=r"diameter = "):
        Beam.circular(1.0, abs(size), Material(density=1.0, E=1.0, G=1.0))


def test_what_has_to_be_positive_is_not_next_to_nothing():
    with pytest.raises(ValueError, match="from 1e-75"):
        gates.require_number("a", 5e-324, "positive")
    assert gates.require_number("a", 5e-324) == 5e-324
    with pytest.raises(ValueError, match=r"discretize\.dt"):
        LinearModel.from_matrices([[-1.0]], [[1.0]]).discretize(5e-324)


def test_a_tensor_without_dimensions_is_a_number():
    torch = pytest.importorskip("torch")
    assert (
        gates.require_number("a", torch.tensor(2.0)) == 2.0
        and gates.require_count("o", "a", torch.tensor(2), 1, 3) == 2
    )
