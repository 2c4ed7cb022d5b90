"""Parameters as inputs: one set of functions for every value, equal to a plant rebuilt with that value."""

import dataclasses
import pickle
from fractions import Fraction

import numpy as np
import pytest

from pliant.envs import scenes
from pliant.plants import Payload, SingleLinkArm, TwoLinkArm
from pliant.plants.core import parameters

ARM, LINK = TwoLinkArm.textbook(), SingleLinkArm.textbook()
PATHS = ("payload.mass", "link1.damping")
VALUES = [(0.5, 0.0), (0.25, 1e-4), (2.0, 3e-3)]


def rebuilt(arm, paths, values):
    for path, value in zip(paths, values):
        arm = parameters.put(arm, path, value)
    return arm


@pytest.mark.every(4)
@pytest.mark.parametrize("changes", [{}, {"basis": "polynomial", "kinematics": "stiffened"}, {"tip_slope": False}])
@pytest.mark.parametrize("values", VALUES)
def test_functions_of_p_equal_the_rebuilt_plant(changes, values, random_state):
    plain = dataclasses.replace(ARM, **changes)
    varied, exact = plain.vary(*PATHS), rebuilt(plain, PATHS, values)
    x, u = random_state(plain, 1, 0.3), np.array([1.0, -0.5])
    np.testing.assert_allclose(varied.dynamics(x, u, p=values), exact.dynamics(x, u), rtol=1e-12)
    seen, expected = varied.measure(x, u, p=values), exact.measure(x, u)
    np.testing.assert_allclose(seen[:-1], expected[:-1], rtol=1e-14)
    np.testing.assert_allclose(seen[-1], expected[-1], rtol=1e-11)  # tip_acceleration: dynamics are in it
    for ours, theirs in zip(varied.jacobians(x, u, p=values), exact.jacobians(x, u)):
        np.testing.assert_allclose(ours, theirs, rtol=1e-9, atol=1e-12 * np.abs(theirs).max(initial=1.0))
    assert varied.energy(x, p=values) == pytest.approx(exact.energy(x), rel=1e-13)
    np.testing.assert_allclose(varied.mass_matrix(x, p=values), exact.mass_matrix(x), rtol=1e-13)
    motion = varied.simulate(x, u, [0, 0.05], p=values, audit=True)
    np.testing.assert_allclose(motion.x, exact.simulate(x, u, [0, 0.05]).x, rtol=1e-7, atol=1e-9)
    assert motion.stats["energy_balance"] < 1e-9


@pytest.mark.parametrize(
    "path", ["gravity", "joint_mass", "hub_inertia.0", "joint_friction.1", "link1.E", "link2.length",
             "payload.inertia", "payload.offset.0"]
)  # fmt: skip
def test_every_kind_of_parameter(path, random_state):
    varied, x = ARM.vary(path), random_state(ARM, 2)
    value = 0.3 + 1.01 * parameters.get(ARM, path)
    np.testing.assert_allclose(varied.dynamics(x, p=[value]), rebuilt(ARM, [path], [value]).dynamics(x), rtol=1e-10)
    assert varied.parameters[0].name == path and varied.parameters[0].unit
    np.testing.assert_array_equal(varied.dynamics(x), varied.dynamics(x, p=varied.nominal_parameters))


def test_loaded_shape_functions_stay_those_of_the_nominal_payload(random_state):
    """basis="payload": shapes are numbers, so another mass moves the nominal shapes; with many it makes no matter."""
    few, many = (dataclasses.replace(LINK, basis="payload", modes=n) for n in (2, 12))
    x = random_state(few, 3)
    mass = 1.5 * LINK.payload.mass
    heavier = [rebuilt(arm, ["payload.mass"], [mass]) for arm in (few, many)]
    for arm in (few, many):
        z = np.zeros(arm.nx)
        varied = arm.vary("payload.mass")
        np.testing.assert_allclose(varied.dynamics(z, [1.0]), arm.dynamics(z, [1.0]), rtol=1e-12)
    heavy = few.vary("payload.mass").measure(x, p=[mass])
    np.testing.assert_array_equal(heavy[:-1], few.measure(x)[:-1])  # the last one, tip_acceleration, moves
    errors = []
    for arm, exact in zip((few, many), heavier):
        ours = arm.vary("payload.mass").natural_frequencies(locked=("hub_angle",), p=[mass])[0]
        errors.append(ours / exact.natural_frequencies(locked=("hub_angle",))[0] - 1)
    assert 0 < errors[1] < 1e-6 < errors[0] < 1e-2
    damped = few.vary("link.damping")
    exact = rebuilt(few, ["link.damping"], [1e-3])
    np.testing.assert_allclose(damped.dynamics(x, p=[1e-3]), exact.dynamics(x), rtol=1e-12)


def test_a_batch_may_have_its_own_parameters_in_every_row(random_state):
    varied = ARM.vary(*PATHS)
    x = np.array([random_state(ARM, k) for k in range(3)])
    rows = varied.dynamics(x, p=VALUES)
    for k in range(3):
        np.testing.assert_array_equal(rows[k], varied.dynamics(x[k], p=VALUES[k]))
    shared = varied.dynamics(x[0], p=VALUES)
    assert shared.shape == (3, 12) and not np.array_equal(shared[0], shared[1])


def test_varied_plant_pickles_and_climbs_its_ladder(random_state):
    varied = ARM.vary(*PATHS)
    same = pickle.loads(pickle.dumps(varied))
    assert same == varied and [s.unit for s in same.parameters] == ["kg", "s"]
    x = random_state(ARM, 5)
    np.testing.assert_array_equal(same.dynamics(x, p=VALUES[2]), varied.dynamics(x, p=VALUES[2]))
    for step in varied.ladder()[:4]:
        assert step.varied == PATHS
        plain = dataclasses.replace(step, varied=())
        z = random_state(step, 6)
        np.testing.assert_allclose(
            step.dynamics(z, p=VALUES[1]), rebuilt(plain, PATHS, VALUES[1]).dynamics(z), rtol=1e-10
        )
    assert varied.vary().parameters == ()


def test_an_offset_that_is_zero_may_be_varied(random_state):
    link = dataclasses.replace(LINK, basis="clamped-free")  # shapes that know nothing of the payload
    varied = link.vary("payload.offset.1")
    bent = dataclasses.replace(link, payload=Payload(mass=1.0, inertia=0.001, offset=(0.0, 0.05, 0.0)))
    x = random_state(link, 7)
    np.testing.assert_allclose(varied.dynamics(x, [1.0], p=[0.05]), bent.dynamics(x, [1.0]), rtol=1e-11)


def test_quantities_are_those_with_units_and_the_uncertain_ones_among_them():
    """A link has length, section and material, of which only some are marked uncertain; none hides those after it."""
    beam = SingleLinkArm.textbook().link
    every, unsure = parameters.quantities(beam), parameters.quantities(beam, uncertain=True)
    assert {"length", "area", "E", "density"} <= set(every) and set(unsure) < set(every)
    marked = [f.name for f in dataclasses.fields(beam) if f.metadata.get("uncertain")]
    assert marked and list(unsure) == marked
    arm = parameters.quantities(SingleLinkArm.textbook())
    assert {"link.E", "payload.mass", "gravity"} <= set(arm)


def test_a_field_annotated_as_a_tuple_is_one_of_any_length_and_another_is_a_number():
    """As a plant of a user declares it, with no word of a shape."""

    @dataclasses.dataclass(frozen=True)
    class Springs:
        rates: tuple[float, ...] = parameters.quantity("N/m", "positive", (1.0, 2.0))
        damping: float = parameters.quantity("N s/m", "nonnegative", 0.0)

        def __post_init__(self) -> None:
            parameters.validate(self)

    assert Springs([1, np.float32(2.0), 3.0]).rates == (1, 2.0, 3.0) and Springs().rates == (1.0, 2.0)
    assert parameters.quantities(Springs()) == ("rates.0", "rates.1", "damping")
    for bad, words in (({"rates": 1.0}, "rates = 1.0 must be a tuple"), ({"damping": (1.0,)}, "damping = .* a number")):
        with pytest.raises(ValueError, match=words):
            Springs(**bad)
    with pytest.raises(ValueError, match=r"rates\[1\] = -1.0 must be > 0 \[N/m\]"):
        Springs((1.0, -1.0))


def test_numbers_of_every_type_are_floats_that_equations_take():
    """Fraction(1, 2) has no product with a CasADi symbol: what is kept is 0.5."""
    arm = dataclasses.replace(TwoLinkArm.textbook(), joint_mass=Fraction(1, 2), hub_inertia=[np.float32(0.5), 1])
    assert type(arm.joint_mass) is float and arm.joint_mass == 0.5
    assert arm.hub_inertia == (0.5, 1.0) and {type(value) for value in arm.hub_inertia} == {float}
    want = dataclasses.replace(TwoLinkArm.textbook(), joint_mass=0.5, hub_inertia=(0.5, 1.0))
    x = np.full(arm.nx, 0.01)
    np.testing.assert_array_equal(arm.dynamics(x), want.dynamics(x))


VARIED = LINK.vary("payload.mass", "link.E", "hub_inertia")
WAYS = {
    "dynamics": lambda p: VARIED.dynamics(VARIED.rest_state, p=p),
    "linearize": lambda p: VARIED.linearize(VARIED.rest_state, p=p),
    "simulate": lambda p: VARIED.simulate(None, None, np.linspace(0.0, 0.01, 3), p=p, method="rk4", step=1e-3),
    "stepper": lambda p: VARIED.stepper(1e-3, batch=2)(np.zeros((2, VARIED.nx)), p=p),
    "python-control": lambda p: VARIED.to_control().linearize(
        VARIED.rest_state, np.zeros(1), params=dict(zip(VARIED.varied, p.tolist()))
    ),
}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize(("k", "value", "said"), [(0, -1.0, ">= 0 [kg]"), (1, -2e11, "> 0 [Pa]"), (1, 0.0, "> 0 [Pa]")])
def test_a_value_that_the_field_refuses_is_refused_as_a_parameter(way, k, value, said):
    """A payload of -1 kg ran through the stepper, and an elastic modulus below zero through everything: with roots that
    no machine has."""
    p = VARIED.nominal_parameters
    p[k] = value
    with pytest.raises(ValueError) as told:
        WAYS[way](p)
    assert f"({VARIED.varied[k]}) = {value:g} must be {said}" in str(told.value)
    with pytest.raises(ValueError, match=VARIED.varied[k].rpartition(".")[2]):
        parameters.put(LINK, VARIED.varied[k], value)  # as the field itself says


def test_a_motion_that_is_repeated_refuses_it_too():
    p, t = VARIED.nominal_parameters, np.linspace(0.0, 0.01, 3)
    for _ in range(3):
        VARIED.simulate(None, None, t, p=p, method="rk4", step=1e-3)
    with pytest.raises(ValueError, match=r"p\[0\] \(payload.mass\) = -1 must be >= 0"):
        VARIED.simulate(None, None, t, p=p - [1.0 + p[0], 0.0, 0.0], method="rk4", step=1e-3)


def test_no_payload_at_all_is_allowed():
    p = VARIED.nominal_parameters
    p[0] = 0.0
    assert np.isfinite(VARIED.dynamics(VARIED.rest_state, p=p)).all()


def test_what_no_field_says_the_body_is_asked():
    """Moments of inertia are more than zero, products of inertia may be anything: only the body that has both knows."""
    craft = scenes.get("spacecraft-slew").plant.vary("hub.inertia.0.0", "hub.inertia.0.1", "hub.mass")
    p = craft.nominal_parameters
    p[1] = -1.0  # kg m^2, of hundreds
    assert np.isfinite(craft.dynamics(craft.rest_state, p=p)).all()
    p[0] = -p[0]
    with pytest.raises(ValueError, match=r"\.p\[0\] \(hub\.inertia\.0\.0\) = -.* must be > 0"):
        craft.dynamics(craft.rest_state, p=p)
