"""What joints, gears and frames refuse."""

import numpy as np
import pytest

from pliant.plants import ElasticJoint, Frame, Joint

GEAR = ElasticJoint(stiffness=1.0, rotor_inertia=1.0)
TABLE = {
    "nameless": (lambda: Joint(name=""), r"Joint\.name = '' must be words"),
    "kind": (lambda: Joint(name="j", kind="ball"), r"Joint\.kind = 'ball' must be one of 'revolute'"),
    "axis": (lambda: Joint(name="j", axis=(0, 0, 2)), r"Joint\.axis = \(0, 0, 2\) must be a unit vector"),
    "position": (lambda: Joint(name="j", position=(0, np.nan, 0)), r"Joint\.position\[1\] = nan must be a finite"),
    "rotation": (lambda: Joint(name="j", rotation=(0, 0)), r"Joint\.rotation = \(0, 0\) must be three numbers \[rad\]"),
    "station": (lambda: Joint(name="j", station=1.5), r"Joint\.station = 1\.5 of joint 'j' must be within \[0, 1\]"),
    "turned": (lambda: Joint(name="j", turned=1), r"Joint\.turned = 1 must be True or False"),
    "damping": (lambda: Joint(name="j", damping=-1), r"Joint\.damping = -1 must be >= 0 \[N m s/rad\]"),
    "friction rate": (lambda: Joint(name="j", friction_rate=0), r"Joint\.friction_rate = 0 must be > 0"),
    "armature": (lambda: Joint(name="j", armature="a"), r"Joint\.armature = 'a' must be a number >= 0"),
    "drive": (lambda: Joint(name="j", drive="belt"), r"Joint\.drive = 'belt' must be one of 'torque'"),
    "elastic": (lambda: Joint(name="j", elastic=3), r"Joint\.elastic = 3 must be an ElasticJoint or None"),
    "elastic fixed": (
        lambda: Joint(name="j", kind="fixed", elastic=GEAR),
        r"Joint\.elastic of joint 'j' must be None where kind = 'fixed'",
    ),
    "limit": (lambda: Joint(name="j", lower=np.inf), r"Joint\.lower = inf must be a finite number"),
    "limits": (
        lambda: Joint(name="j", lower=1, upper=0),
        r"Joint\.lower = 1\.0 of joint 'j' must be at most upper = 0",
    ),
    "stiffness": (lambda: ElasticJoint(stiffness=0, rotor_inertia=1), r"ElasticJoint\.stiffness = 0 must be > 0"),
    "rotor": (lambda: ElasticJoint(stiffness=1, rotor_inertia=0), r"ElasticJoint\.rotor_inertia = 0 must be > 0"),
    "ratio": (lambda: ElasticJoint(stiffness=1, rotor_inertia=1, ratio=-1), r"ElasticJoint\.ratio = -1 must be > 0"),
    "frame": (lambda: Frame(name="f", body=""), r"Frame\.body = '' must be words"),
    "frame's station": (
        lambda: Frame(name="f", body="b", station=2),
        r"Frame\.station = 2\.0 of frame 'f' must be with",
    ),
}


@pytest.mark.parametrize("name", TABLE)
def test_refused(name):
    made, words = TABLE[name]
    with pytest.raises(ValueError, match=words):
        made()


def test_what_moves():
    assert Joint(name="j").moves
    assert not Joint(name="j", kind="fixed").moves
    assert Joint(name="j", kind="prismatic").slides
