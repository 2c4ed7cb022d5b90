"""Scenes of arms in space that are trees of bodies."""

from __future__ import annotations

from pliant.envs.machines import trees

from .scene import Scene


def six_axis_pick() -> Scene:
    """Swing a payload from bin to bin with a six-axis arm whose forearm bends, for 2 s; control period 0.01 s.

    The arm is `machines.trees.six_axis`, its torques within the UR5's. It hangs from a high stand, so that it does
    not fall over where its torques are played without feedback.

    | observation                | unit  |
    |----------------------------|-------|
    | pan - 0.9                  | rad   |
    | lift - 0.2                 | rad   |
    | elbow - 0.6                | rad   |
    | roll_1 - -2.37             | rad   |
    | roll_2 - -1.57             | rad   |
    | roll_3 - 0.9               | rad   |
    | pan_rate                   | rad/s |
    | lift_rate                  | rad/s |
    | elbow_rate                 | rad/s |
    | roll_1_rate                | rad/s |
    | roll_2_rate                | rad/s |
    | roll_3_rate                | rad/s |
    | forearm_deflection_y - sag | m     |
    | forearm_deflection_z - sag | m     |
    | forearm_deflection_y_rate  | m/s   |
    | forearm_deflection_z_rate  | m/s   |

    | action        | unit | at -1 | at 1 |
    |---------------|------|-------|------|
    | pan_torque    | N m  | -100  | 100  |
    | lift_torque   | N m  | -120  | 120  |
    | elbow_torque  | N m  | -50   | 50   |
    | roll_1_torque | N m  | -6    | 6    |
    | roll_2_torque | N m  | -2    | 2    |
    | roll_3_torque | N m  | -1    | 1    |

    | cost of the deviation in  | unit  | weight |
    |---------------------------|-------|--------|
    | pan                       | rad   | 10     |
    | lift                      | rad   | 10     |
    | elbow                     | rad   | 10     |
    | roll_1                    | rad   | 10     |
    | roll_2                    | rad   | 10     |
    | roll_3                    | rad   | 10     |
    | pan_rate                  | rad/s | 0.1    |
    | lift_rate                 | rad/s | 0.1    |
    | elbow_rate                | rad/s | 0.1    |
    | roll_1_rate               | rad/s | 0.1    |
    | roll_2_rate               | rad/s | 0.1    |
    | roll_3_rate               | rad/s | 0.1    |
    | forearm_deflection_y_rate | m/s   | 10     |
    | forearm_deflection_z_rate | m/s   | 10     |
    | pan_torque                | N m   | 0.002  |
    | lift_torque               | N m   | 0.002  |
    | elbow_torque              | N m   | 0.002  |
    | roll_1_torque             | N m   | 0.1    |
    | roll_2_torque             | N m   | 0.1    |
    | roll_3_torque             | N m   | 0.1    |

    | ends beyond          | unit  | bound |
    |----------------------|-------|-------|
    | forearm_deflection_y | m     | 0.08  |
    | forearm_deflection_z | m     | 0.08  |
    | pan_rate             | rad/s | 12    |
    | lift_rate            | rad/s | 12    |
    | elbow_rate           | rad/s | 12    |
    | roll_1_rate          | rad/s | 12    |
    | roll_2_rate          | rad/s | 12    |
    | roll_3_rate          | rad/s | 12    |

    | policy                   | return |
    |--------------------------|--------|
    | bound: no law is better  | -10.18 |
    | LQR                      | -10.54 |
    | zero actions             | -116.4 |
    | random actions           | -225.2 |
    """
    large, small = ("pan", "lift", "elbow"), ("roll_1", "roll_2", "roll_3")
    joints = (*large, *small)
    bends = tuple(f"forearm_deflection_{axis}" for axis in "yz")
    return Scene(
        name="six-axis-pick",
        about="swing a 1.5 kg payload with a six-axis arm whose forearm bends",
        plant=trees.six_axis(),
        start=tuple(zip(joints, (-0.6, 0.5, 0.8, -2.87, -1.57, 0.0), strict=True)),
        goal=tuple(zip(joints, (0.9, 0.2, 0.6, -2.37, -1.57, 0.9), strict=True)),
        duration=2.0,
        dt=0.01,
        substeps=4,
        move_time=1.2,
        limits=(100.0, 120.0, 50.0, 6.0, 2.0, 1.0),
        bounds=(*((name, 0.08) for name in bends), *((f"{name}_rate", 12.0) for name in joints)),
        weights=(
            *((name, 10.0) for name in joints),
            *((f"{name}_rate", 0.1) for name in joints),
            *((f"{name}_rate", 10.0) for name in bends),
        ),
        effort=(*((f"{name}_torque", 2e-3) for name in large), *((f"{name}_torque", 0.1) for name in small)),
        observe=(*joints, *(f"{name}_rate" for name in joints), *bends, *(f"{name}_rate" for name in bends)),
        randomise=(("payload.mass", 0.7, 1.3),),
        start_spread=0.05,
        compare=("tip_x", "tip_y", "tip_z"),
    )


def three_link_flexible() -> Scene:
    """Turn and lift an arm of two thin steel strips, 0.5 m each, point to point, for 2 s; control period 0.005 s.

    The arm is that of "Safe Imitation Learning of Nonlinear Model Predictive Control for Flexible Robots"
    (`machines.trees.three_link`). Up to 20 and 10 N m and 2.5 and 3.5 rad/s are allowed there; torques as large would
    turn the thin strips by radians within a few periods.

    | observation              | unit  |
    |--------------------------|-------|
    | joint1 - 1               | rad   |
    | joint2 - -0.5            | rad   |
    | joint3 - 0.3             | rad   |
    | joint1_rate              | rad/s |
    | joint2_rate              | rad/s |
    | joint3_rate              | rad/s |
    | link2_deflection_y - sag | m     |
    | link3_deflection_y - sag | m     |
    | link2_deflection_y_rate  | m/s   |
    | link3_deflection_y_rate  | m/s   |

    | action        | unit | at -1 | at 1 |
    |---------------|------|-------|------|
    | joint1_torque | N m  | -4    | 4    |
    | joint2_torque | N m  | -6    | 6    |
    | joint3_torque | N m  | -1.5  | 1.5  |

    | cost of the deviation in | unit  | weight |
    |--------------------------|-------|--------|
    | joint1                   | rad   | 10     |
    | joint2                   | rad   | 10     |
    | joint3                   | rad   | 10     |
    | joint1_rate              | rad/s | 0.1    |
    | joint2_rate              | rad/s | 0.1    |
    | joint3_rate              | rad/s | 0.1    |
    | link2_deflection_y_rate  | m/s   | 0.1    |
    | link3_deflection_y_rate  | m/s   | 0.1    |
    | joint1_torque            | N m   | 1      |
    | joint2_torque            | N m   | 0.1    |
    | joint3_torque            | N m   | 0.1    |

    | ends beyond        | unit  | bound |
    |--------------------|-------|-------|
    | link2_deflection_y | m     | 0.25  |
    | link3_deflection_y | m     | 0.25  |
    | joint1_rate        | rad/s | 20    |
    | joint2_rate        | rad/s | 60    |
    | joint3_rate        | rad/s | 60    |

    | policy                   | return |
    |--------------------------|--------|
    | bound: no law is better  | -3.31  |
    | LQR                      | -4.097 |
    | zero actions             | -46.71 |
    | random actions           | -310.1 |
    """
    joints = ("joint1", "joint2", "joint3")
    bends = ("link2_deflection_y", "link3_deflection_y")
    return Scene(
        name="three-link-flexible",
        about="turn and lift an arm of two thin steel strips point to point",
        plant=trees.three_link(),
        start=tuple(zip(joints, (0.0, -1.2, 0.2), strict=True)),
        goal=tuple(zip(joints, (1.0, -0.5, 0.3), strict=True)),
        duration=2.0,
        dt=0.005,
        substeps=14,
        move_time=1.2,
        limits=(4.0, 6.0, 1.5),
        bounds=(
            *((name, 0.25) for name in bends),
            *((f"{name}_rate", bound) for name, bound in zip(joints, (20.0, 60.0, 60.0), strict=True)),
        ),
        weights=(
            *((name, 10.0) for name in joints),
            *((f"{name}_rate", 0.1) for name in (*joints, *bends)),
        ),
        effort=(("joint1_torque", 1.0), ("joint2_torque", 0.1), ("joint3_torque", 0.1)),
        observe=(*joints, *(f"{name}_rate" for name in joints), *bends, *(f"{name}_rate" for name in bends)),
        randomise=(("bodies.1.beam.E", 0.9, 1.1),),
        start_spread=0.05,
        compare=("tip_x", "tip_y", "tip_z"),
    )


def satellite_arm() -> Scene:
    """Move 10 kg with a free satellite's bending arm and keep the satellite pointed, for 20 s; control period 0.05 s.

    Nothing holds the satellite: the arm turns it, and wheels turn it back (`machines.trees.satellite_arm`).

    | observation             | unit  |
    |-------------------------|-------|
    | shoulder - 1            | rad   |
    | elbow - -0.4            | rad   |
    | shoulder_rate           | rad/s |
    | elbow_rate              | rad/s |
    | base_attitude_x         | 1     |
    | base_attitude_y         | 1     |
    | base_attitude_z         | 1     |
    | base_rate_x             | rad/s |
    | base_rate_y             | rad/s |
    | base_rate_z             | rad/s |
    | upper_deflection_y      | m     |
    | lower_deflection_y      | m     |
    | upper_deflection_y_rate | m/s   |
    | lower_deflection_y_rate | m/s   |

    | action          | unit | at -1 | at 1 |
    |-----------------|------|-------|------|
    | wheel_x_torque  | N m  | -2    | 2    |
    | wheel_y_torque  | N m  | -2    | 2    |
    | wheel_z_torque  | N m  | -2    | 2    |
    | shoulder_torque | N m  | -6    | 6    |
    | elbow_torque    | N m  | -3    | 3    |

    | cost of the deviation in | unit  | weight |
    |--------------------------|-------|--------|
    | shoulder                 | rad   | 10     |
    | elbow                    | rad   | 10     |
    | base_attitude_x          | 1     | 400    |
    | base_attitude_y          | 1     | 400    |
    | base_attitude_z          | 1     | 400    |
    | base_rate_x              | rad/s | 100    |
    | base_rate_y              | rad/s | 100    |
    | base_rate_z              | rad/s | 100    |
    | upper_deflection_y_rate  | m/s   | 1      |
    | lower_deflection_y_rate  | m/s   | 1      |
    | wheel_x_torque           | N m   | 0.1    |
    | wheel_y_torque           | N m   | 0.1    |
    | wheel_z_torque           | N m   | 0.1    |
    | shoulder_torque          | N m   | 0.1    |
    | elbow_torque             | N m   | 0.1    |

    | ends beyond        | unit  | bound |
    |--------------------|-------|-------|
    | upper_deflection_y | m     | 0.3   |
    | lower_deflection_y | m     | 0.3   |
    | shoulder_rate      | rad/s | 6     |
    | elbow_rate         | rad/s | 6     |
    | base_attitude_x    | 1     | 0.9   |
    | base_attitude_y    | 1     | 0.9   |
    | base_attitude_z    | 1     | 0.9   |

    | policy                   | return |
    |--------------------------|--------|
    | LQR                      | -40.39 |
    | zero actions             | -226   |
    | random actions           | -1837  |
    """
    attitude, turning = (tuple(f"base_{what}_{axis}" for axis in "xyz") for what in ("attitude", "rate"))
    bends, wheels = ("upper_deflection_y", "lower_deflection_y"), tuple(f"wheel_{axis}_torque" for axis in "xyz")
    bending = tuple(f"{name}_rate" for name in bends)
    return Scene(
        name="satellite-arm",
        about="move 10 kg with a free satellite's bending arm and keep the satellite pointed",
        plant=trees.satellite_arm(),
        start=(("shoulder", 0.3), ("elbow", -1.2)),
        goal=(("shoulder", 1.0), ("elbow", -0.4)),
        duration=20.0,
        dt=0.05,
        substeps=10,
        move_time=10.0,
        limits=(2.0, 2.0, 2.0, 6.0, 3.0),
        bounds=(
            *((name, 0.3) for name in bends),
            *(("shoulder_rate", 6.0), ("elbow_rate", 6.0)),
            *((name, 0.9) for name in attitude),  # 128 degrees; without one, to turn away would cost more than to end
        ),
        weights=(
            *(("shoulder", 10.0), ("elbow", 10.0)),
            *((name, 400.0) for name in attitude),
            *((name, 100.0) for name in turning),
            *((name, 1.0) for name in bending),
        ),
        effort=tuple((name, 0.1) for name in (*wheels, "shoulder_torque", "elbow_torque")),
        observe=("shoulder", "elbow", "shoulder_rate", "elbow_rate", *attitude, *turning, *bends, *bending),
        randomise=(("payload.mass", 0.7, 1.3),),
        start_spread=0.05,
    )
