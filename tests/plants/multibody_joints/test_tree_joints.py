"""Names of states, inputs and joints of trees with joints of every kind."""

from pliant.plants import ElasticJoint, FlexibleTree, Joint, TreeBody


def tree(**drives):
    gear = ElasticJoint(stiffness=10.0, rotor_inertia=1e-3)
    kinds = {"a": "planar", "b": "spherical", "c": "revolute", "d": "prismatic"}
    bodies = [
        TreeBody(
            name=f"body_{n}",
            joint=Joint(name=n, kind=kind, drive=drives.get(n, "torque"), elastic=gear if n == "c" else None),
            mass=1.0,
            inertia=0.1,
        )
        for n, kind in kinds.items()
    ]
    return FlexibleTree.serial(bodies)


def test_states_and_inputs():
    own = tree(a="none")
    assert [s.name for s in own.coordinates] == [
        *("a_x", "a_y", "a_angle", "b_quaternion_0", "b_quaternion_1", "b_quaternion_2", "b_quaternion_3"),
        *("c", "d", "c_motor"),
    ]
    assert [s.name for s in own.speeds] == [
        *("a_x_rate", "a_y_rate", "a_angle_rate", "b_rate_x", "b_rate_y", "b_rate_z", "c_rate", "d_rate"),
        "c_motor_rate",
    ]
    assert [s.name for s in own.inputs] == ["b_torque_x", "b_torque_y", "b_torque_z", "c_motor_torque", "d_force"]
    assert own.turns == (("b", 3, 3),)
    assert [(j.input, j.position, j.rate) for j in own.joints][2:] == [
        ("b_torque_z", "b_attitude_z", "b_rate_z"),
        ("c_motor_torque", "c_motor", "c_motor_rate"),
        ("d_force", "d", "d_rate"),
    ]
    assert [s.name for s in own.outputs][:10] == [
        *("a_x", "a_y", "a_angle", "c", "b_attitude_x", "b_attitude_y", "b_attitude_z", "d", "c_motor"),
        "tip_x",
    ]


def test_accelerations_as_inputs():
    own = tree(a="acceleration", d="acceleration")
    assert [s.name for s in own.inputs][:3] == ["a_acceleration_x", "a_acceleration_y", "a_acceleration"]
    assert own.driven == {0: 0, 1: 1, 2: 2, 7: 7}
    assert own.prescribed == ("a_x", "a_y", "a_angle", "d")
    assert own.held == {}
