"""What a beam of strains declares: its signals, when its coordinates are strains, and what it refuses."""

import dataclasses
import pickle

import numpy as np
import pytest
from large_beam_cases import BEAM, large
from strained_cases import STRAINED, replaced, strained


def names(signals):
    return [s.name for s in signals]


def test_signals_of_free_and_moving_roots():
    free, moving = STRAINED["free"], STRAINED["moving"]
    assert names(free.coordinates) == [
        "root_x", "root_y", "root_angle", "bend1", "bend2", "stretch1", "stretch2", "shear1", "shear2",
    ]  # fmt: skip
    assert names(free.inputs)[:4] == ["tip_force_x", "tip_force_y", "tip_moment", "follower_force_x"]
    assert free.disturbances == () and names(free.outputs)[:4] == ["root_x", "root_y", "root_angle", "tip_x"]
    assert names(moving.inputs) == ["root_x_acceleration", "root_y_acceleration", "root_angle_acceleration"]
    assert names(moving.disturbances) == ["tip_moment"] and moving.seen_from == "root_angle"
    assert moving.prescribed == ("root_x", "root_y", "root_angle")
    carried = STRAINED["space moving"]
    assert names(carried.coordinates)[:4] == ["root_x", "root_y", "root_z", "root_angle"]
    assert names(carried.inputs)[2:] == ["root_z_acceleration", "root_angle_acceleration"]
    assert [s.device for s in free.sensors()] == ["gyro"]
    assert [s.device for s in moving.sensors()] == ["encoder", "strain gauge", "gyro"]


def test_only_what_is_more_than_rotations_makes_coordinates_of_strains():
    assert not BEAM.strained and not large(planar=False).strained and not large(stretches=5, shears=3).strained
    for changes in (
        {"root": "free"},
        {"extensible": True},
        {"theory": "timoshenko"},
        {"tip_loads": ("moment",)},
        {"rest_curvature": 0.1},
        {"rest_curvature": np.sin},
        {"rotary": 0.0},
        {"segments": 2, "basis": "auto"},
    ):
        assert large(**changes).strained, changes
    assert BEAM.vary("rest_curvature").strained and not BEAM.vary("beam.E").strained


def test_the_default_beam_has_the_operations_it_had():
    """As counted where there are no strains: 3 natural modes at 7 points in the plane, and 2 in space."""
    sizes = [large(**c)._dynamics.function.n_instructions() for c in ({}, {"planar": False, "modes": 2})]
    assert sizes == [920, 7057]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"root": "floating"}, r"root = 'floating' must be one of 'clamped', 'hinged', 'driven', 'free', 'moving'"),
        ({"theory": "reissner"}, r"theory = 'reissner' must be one of 'euler-bernoulli', 'timoshenko'"),
        ({"extensible": 1}, r"extensible = 1 must be True or False"),
        ({"tip_loads": ("torque",)}, r"tip_loads\[0\] = 'torque': no such load; choose from force, moment, follower"),
        ({"tip_loads": ("force", "force")}, r"tip_loads = .* must be distinct"),
        ({"tip_loads": "force"}, r"tip_loads = 'force'"),
        ({"tip_loads": ()}, r"tip_loads = \(\) must name at least one of force, moment, follower"),
        ({"stretches": 0}, r"stretches = 0 must be an integer from 1 to 20"),
        ({"shears": 21}, r"shears = 21 must be an integer from 1 to 20"),
        (
            {"segments": 2, "extensible": True, "basis": "modes"},
            r"basis of segments = 'modes' must be one of 'auto', 'poly",
        ),
        ({"segments": 33, "extensible": True}, r"segments = 33 must be an integer from 1 to 32"),
        ({"rotary": -1.0}, r"rotary = -1.0 must be >= 0"),
        ({"rest_curvature": None}, r"rest_curvature = None must be"),
        ({"root": "free", "planar": False}, r"root = 'free' must be one of .*'moving' where planar = False"),
        ({"root": "moving", "kinematics": "substructured"}, r"root = 'moving' must be 'clamped', 'hinged' or 'driven'"),
        ({"extensible": True, "kinematics": "substructured"}, r"extensible = True must be False where kinematics"),
        ({"rest_curvature": 0.1, "kinematics": "substructured"}, r"rest_curvature = 0.1 must be 0.0 where kinematics"),
    ],
)
def test_bad_input_is_named(changes, message):
    with pytest.raises(ValueError, match="LargeDeflectionBeam." + message):
        large(**changes)


def test_loads_may_be_none_where_the_root_is_driven():
    plant = large(root="driven", tip_loads=())
    assert plant.disturbances == () and np.isfinite(plant.dynamics(np.zeros(plant.nx), [1.0])).all()


def test_parameters_can_vary():
    plant = STRAINED["moving"]
    varied = plant.vary("beam.E", "rest_curvature", "rotary", "beam.length")
    x = 0.1 * np.random.default_rng(1).uniform(-1, 1, plant.nx)
    p = [0.9 * plant.beam.E, 0.3, 2.0, 1.9]
    other = dataclasses.replace(
        plant, beam=dataclasses.replace(plant.beam, E=p[0], length=p[3]), rest_curvature=0.3, rotary=2.0,
        basis=plant.rotation_basis, points=varied.point_count,
    )  # fmt: skip
    same = dataclasses.replace(varied, basis=plant.rotation_basis, payload=dataclasses.replace(plant.payload, mass=0.0))
    other = dataclasses.replace(other, payload=same.payload)
    np.testing.assert_allclose(same.dynamics(x, p=p), other.dynamics(x), rtol=1e-9)


def test_segments_are_numbered_and_named():
    plant = strained(segments=2, modes=2, extensible=True, stretches=1)
    assert names(plant.coordinates) == ["bend1_1", "bend1_2", "bend2_1", "bend2_2", "stretch1_1", "stretch2_1"]
    assert plant.label == "strain, polynomial 2 x 2, stretches 1"
    assert len(plant.strained_beam.frames.along.xi) == 2 * plant.point_count


def test_pickles_and_compares_and_names_its_fidelity():
    plant = replaced("clamped", rest_curvature=np.sin)
    plant.dynamics(np.zeros(plant.nx))
    assert pickle.loads(pickle.dumps(plant)) == plant
    assert strained(extensible=True, theory="timoshenko").label == "strain, tip-force 2, stretches 2, shears 2"
    assert strained(tip_loads=("moment",)).rotation_basis == "polynomial"


def test_native_steps_are_those_of_the_virtual_machine():
    plant = STRAINED["moving"]
    step = plant.stepper(1e-4, batch=8)
    x = np.asfortranarray(np.tile(0.05 * np.random.default_rng(2).uniform(-1, 1, plant.nx), (8, 1)))
    u = np.tile([0.1, 0.2, 0.3], (8, 1))
    slow = plant.simulate(x[0].copy(), u[0], [0.0, 1e-4], method="rk4", step=1e-4).x[-1]
    np.testing.assert_allclose(step(x, u)[0], slow, rtol=1e-9, atol=1e-11)


def test_points_are_enough_for_every_strain():
    """Many stretches or shears of one bending shape: their inertia is definite, and too few points are refused."""
    for changes in ({"stretches": 9}, {"shears": 8}, {"planar": False, "twists": 9}):
        plant = strained(modes=1, extensible=True, theory="timoshenko", **changes)
        assert np.linalg.eigvalsh(plant.mass_matrix(np.zeros(plant.nx))).min() > 0
    with pytest.raises(ValueError, match=r"points = 4 are too few for stretches = 9"):
        strained(modes=1, extensible=True, stretches=9, points=4)
