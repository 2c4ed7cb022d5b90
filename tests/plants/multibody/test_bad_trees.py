"""Bad trees, one table: each a ValueError that names the element and the value. Bad files: test_urdf.py."""

import numpy as np
import pytest

from pliant.plants import Beam, ElasticJoint, FlexibleTree, Frame, Joint, Payload, Sliding, TreeBody, beams

STRIP = Beam.rectangular(1.0, width=0.04, depth=0.008, material=beams.ALUMINIUM)
FLAT = ((0.03, 0.0, 0.0), (0.0, 0.03, 0.0), (0.0, 0.0, 0.07))


def body(name="a", parent="", joint=None, **made):
    given = {"mass": 1.0, "inertia": 0.1} | made
    return TreeBody(name=name, parent=parent, joint=joint or Joint(name=f"j{name}"), **given)


def tree(*bodies, **options):
    return FlexibleTree(bodies=bodies or (body(), body("b")), **options)


def on(kind="revolute", given=None, **joint):
    """One body on one joint."""
    return tree(body(joint=Joint(name="j", kind=kind, **joint), **(given or {})))


GEAR = ElasticJoint(stiffness=1.0, rotor_inertia=1.0)
JOINTS = {
    "kind": (lambda: on("screw"), r"Joint\.kind = 'screw' must be one of 'revolute', .*'spherical', 'planar', 'free'"),
    "nameless": (lambda: Joint(name=""), r"Joint\.name = '' must "),
    "name of a number": (lambda: Joint(name=3), r"Joint\.name = 3 must be words"),
    "axis zero": (lambda: on(axis=(0, 0, 0)), r"Joint\.axis = \(0, 0, 0\) must"),
    "axis NaN": (lambda: on(axis=(0, 0, np.nan)), r"Joint\.axis\[2\] = nan must be finite"),
    "axis of two": (lambda: on(axis=(0, 1)), r"Joint\.axis has shape \(2,\), must be \(3,\)"),
    "position NaN": (lambda: on(position=(np.nan, 0, 0)), r"Joint\.position\[0\] = nan must be a finite number \[m\]"),
    "position of one": (lambda: on(position=1.0), r"Joint\.position = 1\.0 must be three numbers \[m\]"),
    "rotation infinite": (lambda: on(rotation=(0, np.inf, 0)), r"Joint\.rotation\[1\] = inf must be a finite number"),
    "station beyond": (lambda: on(station=1.5), r"Joint\.station = 1\.5 of joint 'j' must be within \[0, 1\]"),
    "station < 0": (lambda: on(station=-0.1), r"Joint\.station = -0\.1 must be >= 0"),
    "damping < 0": (lambda: on(damping=-1.0), r"Joint\.damping = -1\.0 must be >= 0"),
    "friction NaN": (lambda: on(friction=np.nan), r"Joint\.friction = nan must be"),
    "friction rate 0": (lambda: on(friction_rate=0.0), r"Joint\.friction_rate = 0\.0 must be > 0"),
    "stiffness < 0": (lambda: on(stiffness=-2.0), r"Joint\.stiffness = -2\.0 must be >= 0"),
    "stop width 0": (lambda: on(stop_width=0.0), r"Joint\.stop_width = 0\.0 must be > 0"),
    "armature < 0": (lambda: on(armature=-1e-3), r"Joint\.armature = -0\.001 must be >= 0"),
    "limits crossed": (
        lambda: on(lower=1.0, upper=-1.0),
        r"Joint\.lower = 1\.0 of joint 'j' must be at most upper = -1",
    ),
    "limit of words": (lambda: on(upper="far"), r"Joint\.upper = 'far' must be"),
    "drive": (lambda: on(drive="belt"), r"Joint\.drive = 'belt' must be one of 'torque', 'acceleration', 'none'"),
    "gear of words": (lambda: on(elastic="soft"), r"Joint\.elastic = 'soft' must be an ElasticJoint or None"),
    "gear of a ball": (
        lambda: on("spherical", elastic=GEAR),
        r"Joint\.elastic of joint 'j' must be None where kind = 'sph",
    ),
    "gear of a weld": (
        lambda: on("fixed", elastic=GEAR),
        r"Joint\.elastic of joint 'j' must be None where kind = 'fixed'",
    ),
    "gear of a given motion": (lambda: on(elastic=GEAR, drive="acceleration"), r"must be None where .* 'acceleration'"),
    "armature of a ball": (
        lambda: on("spherical", armature=0.1),
        r"Joint\.armature = 0\.1 of joint 'j' must be 0 where",
    ),
    "armature of a plane": (lambda: on("planar", armature=0.1), r"Joint\.armature = 0\.1 of joint 'j' must be 0 where"),
    "rest of a ball": (
        lambda: on("spherical", rest=0.2),
        r"Joint\.rest = 0\.2 of joint 'j' must be left out where kind",
    ),
    "lower of a ball": (
        lambda: on("spherical", lower=-0.2),
        r"Joint\.lower = -0\.2 of joint 'j' must be left out where",
    ),
    "upper of a ball": (
        lambda: on("free", upper=4.0),
        r"Joint\.upper = 4\.0 of joint 'j' must be within \(0, pi\) where",
    ),
    "sliding hinge": (
        lambda: on(sliding=Sliding()),
        r"Joint\.sliding of joint 'j' must be None where kind = 'revolute'",
    ),
    "sliding of words": (lambda: on("free", sliding="ice"), r"Joint\.sliding = 'ice' must be a Sliding or None"),
    "sliding limits": (lambda: Sliding(lower=1.0, upper=0.0), r"Sliding\.lower = 1\.0 must be at most upper = 0\.0"),
    "sliding damping": (lambda: Sliding(damping=-1.0), r"Sliding\.damping = -1\.0 must be >= 0"),
    "gear stiffness 0": (
        lambda: ElasticJoint(stiffness=0.0, rotor_inertia=1.0),
        r"ElasticJoint\.stiffness = 0\.0 must be > 0",
    ),
    "gear ratio 0": (
        lambda: ElasticJoint(stiffness=1.0, rotor_inertia=1.0, ratio=0),
        r"ElasticJoint\.ratio = 0 must be > 0",
    ),
    "rotor of nothing": (lambda: ElasticJoint(stiffness=1.0, rotor_inertia=0.0), r"\.rotor_inertia = 0\.0 must be > 0"),
}
BODIES = {
    "nameless": (lambda: body(""), r"TreeBody\.name = '' must "),
    "mass < 0": (lambda: tree(body(mass=-1.0)), r"TreeBody\.mass = -1\.0 must be >= 0"),
    "mass NaN": (lambda: tree(body(mass=np.nan)), r"TreeBody\.mass = nan must be"),
    "mass of words": (lambda: tree(body(mass="heavy")), r"TreeBody\.mass = 'heavy' must be"),
    "centre infinite": (
        lambda: body(centre=(0, 0, np.inf)),
        r"TreeBody\.centre\[2\] = inf must be a finite number \[m\]",
    ),
    "inertia < 0": (
        lambda: body(inertia=-0.1),
        r"TreeBody\.inertia of body 'a' = -0\.1 must have principal moments >= 0",
    ),
    "inertia of no body": (
        lambda: body(inertia=FLAT),
        r"of body 'a' = .* no principal moment above the sum .*0\.07 > 0\.06",
    ),
    "inertia askew": (
        lambda: body(inertia=((1, 0.1, 0), (0.2, 1, 0), (0, 0, 1))),
        r"TreeBody\.inertia of body 'a' = .* must be symmetric",
    ),
    "inertia NaN": (lambda: body(inertia=np.nan), r"TreeBody\.inertia = nan must be"),
    "inertia 2 x 2": (lambda: body(inertia=((1, 0), (0, 1))), r"TreeBody\.inertia = .* must be"),
    "no beam": (lambda: body(beam=1.0), r"TreeBody\.beam = 1\.0 must be a Beam or None"),
    "no joint": (lambda: TreeBody(name="a", joint="hinge"), r"TreeBody\.joint = 'hinge' must be a Joint"),
    "modes < 0": (lambda: body(beam=STRIP, modes=(-1, 0, 0, 0)), r"TreeBody\.modes\[0\] = -1 must"),
    "modes of halves": (lambda: body(beam=STRIP, modes=(1.5, 0, 0, 0)), r"TreeBody\.modes\[0\] = 1\.5 must"),
    "too many modes": (lambda: body(beam=STRIP, modes=(99, 0, 0, 0)), r"TreeBody\.modes\[0\] = 99 must"),
    "three counts": (lambda: body(beam=STRIP, modes=(1, 0, 0)), r"TreeBody\.modes = \(1, 0, 0\) must be 4 integers"),
    "modal of words": (lambda: body(modal="panel"), r"TreeBody\.modal = 'panel' must be ModalData or None"),
    "point of mass on a hinge": (
        lambda: on(given={"inertia": 0.0}),
        r"bodies\[0\]\.inertia = 0\.0 of body 'a', with mass 1 kg at \(0\.0, 0\.0, 0\.0\), must give a moment > 0",
    ),
    "point on its axis": (
        lambda: on(given={"inertia": 0.0, "centre": (0, 0, 0.4)}),
        r"must give a moment > 0 .* 'j' \(rev",
    ),
    "rod on a ball": (
        lambda: on("spherical", {"inertia": ((1, 0, 0), (0, 1, 0), (0, 0, 0))}),
        r"where joint 'j' \(spherical",
    ),
    "point that floats": (
        lambda: on("free", {"inertia": 0.0, "centre": (1, 1, 1)}),
        r"a moment > 0 .* joint 'j' \(free\)",
    ),
    "nothing to turn": (
        lambda: on(given={"mass": 0.0, "inertia": 0.0}),
        r"\.mass = 0\.0 of body 'a', which joint 'j' moves",
    ),
    "nothing to slide": (
        lambda: on("prismatic", {"mass": 0.0}),
        r"\.mass = 0\.0 of body 'a' must be > 0",
    ),
    "nothing heavier beyond": (
        lambda: tree(body(), body("b", mass=0.0, inertia=0.0), body("c", mass=0.0, inertia=0.0)),
        r"FlexibleTree\.bodies\[2\]\.mass = 0\.0 of body 'c', which joint 'jc' moves with nothing heavier",
    ),
}
TREES = {
    "no bodies": (lambda: FlexibleTree(bodies=()), r"FlexibleTree\.bodies = \(\) must be one body at least"),
    "not bodies": (lambda: tree("arm"), r"FlexibleTree\.bodies\[0\] = 'arm' must be a TreeBody"),
    "body twice": (lambda: tree(body(), body()), r"FlexibleTree\.bodies\[1\] = 'a' must have a name of its own"),
    "joint twice": (
        lambda: tree(body(), body("b", joint=Joint(name="ja"))),
        r"bodies\[1\] = 'ja' must have a name of its",
    ),
    "loop of two": (
        lambda: tree(body("a", "b"), body("b", "a")),
        r"\[0\]\.parent = 'b' of body 'a' must be a body before",
    ),
    "onto itself": (
        lambda: tree(body("a", "a")),
        r"bodies\[0\]\.parent = 'a' of body 'a' must be a body before it: base",
    ),
    "no such parent": (
        lambda: tree(body("a", "hub")),
        r"bodies\[0\]\.parent = 'hub' of body 'a' must be a body before it",
    ),
    "called as the base": (
        lambda: tree(body("base")),
        r"FlexibleTree\.bodies\[0\] = 'base' must have a name of its own",
    ),
    "serial of none": (lambda: FlexibleTree.serial(3), r"FlexibleTree\.serial\.bodies"),
    "frame of no body": (
        lambda: tree(frames=(Frame(name="f", body="x"),)),
        r"frames\[0\]\.body = 'x' of frame 'f' must be",
    ),
    "frame twice": (
        lambda: tree(frames=(Frame(name="f", body="a"),) * 2),
        r"frames\[1\]\.name = 'f' must be a name of its",
    ),
    "frame off its beam": (
        lambda: Frame(name="f", body="a", station=2.0),
        r"Frame\.station = 2\.0 of frame 'f' must be",
    ),
    "frame at NaN": (
        lambda: Frame(name="f", body="a", position=(0, np.nan, 0)),
        r"Frame\.position\[1\] = nan must be a",
    ),
    "node of a rigid body": (
        lambda: tree(body(), body("b", joint=Joint(name="jb", node="tip"))),
        r"Joint\.node = 'tip' of joint 'jb' must be '' where body 'a' has no modal data",
    ),
    "node of a beam": (
        lambda: tree(body(beam=STRIP), frames=(Frame(name="f", body="a", node="tip"),)),
        r"Frame\.node = 'tip' of frame 'f' must be '' where body 'a' has no modal",
    ),
    "tip": (lambda: tree(tip="hand"), r"FlexibleTree\.tip = 'hand' must be a body or a frame: a, b, base, tip"),
    "load": (lambda: tree(loads=("hand",)), r"FlexibleTree\.loads\[0\] = 'hand' must be one of tip"),
    "load twice": (lambda: tree(loads=("tip", "tip")), r"FlexibleTree\.loads = \('tip', 'tip'\) must be distinct"),
    "device": (lambda: tree(devices=("lidar",)), r"FlexibleTree\.devices\[0\] = 'lidar': no such device; choose from"),
    "gravity of one": (lambda: tree(gravity=9.81), r"FlexibleTree\.gravity = 9\.81 must be three numbers"),
    "gravity NaN": (lambda: tree(gravity=(0, 0, np.nan)), r"FlexibleTree\.gravity\[2\] = nan must be a finite number"),
    "kinematics": (lambda: tree(kinematics="exact"), r"FlexibleTree\.kinematics = 'exact' must be one of"),
    "basis": (lambda: tree(basis="payload"), r"FlexibleTree\.basis = 'payload' must be one of"),
    "payload": (lambda: tree(payload=1.0), r"FlexibleTree\.payload = 1\.0 must be a Payload"),
    "payload of no body": (
        lambda: tree(payload=Payload(1.0, FLAT)),
        r"Payload\.inertia = .* no principal moment above the",
    ),
    "base": (
        lambda: tree(base="floating"),
        r"FlexibleTree\.base = 'floating' must be one of 'fixed', 'free', 'driven'",
    ),
    "platform": (lambda: tree(base="free", platform=5.0), r"FlexibleTree\.platform = 5\.0 must be a Payload"),
    "free base of nothing": (
        lambda: tree(base="free"),
        r"FlexibleTree\.platform\.mass = 0\.0 must be > 0 \[kg\] where base",
    ),
    "free base of a point": (
        lambda: tree(base="free", platform=Payload(mass=3.0)),
        r"FlexibleTree\.platform\.inertia = 0\.0 must have moments > 0 \[kg m\^2\]",
    ),
    "base freedom": (
        lambda: tree(base="driven", base_freedoms=("roll",)),
        r"base_freedoms\[0\] = 'roll': no such freedom",
    ),
    "no base freedom": (lambda: tree(base="driven", base_freedoms=()), r"base_freedoms = \(\) must name one freedom"),
    "nothing moves": (lambda: on("fixed"), r"FlexibleTree\.bodies = \('a',\) must have a joint that moves"),
    "coordinate twice": (
        lambda: tree(body(joint=Joint(name="p", kind="planar")), body("b", joint=Joint(name="p_x"))),
        r"FlexibleTree gives two states the name 'p_x'",
    ),
    "output twice": (
        lambda: tree(base="free", platform=Payload(1.0, 1.0), frames=(Frame(name="base", body="a"),)),
        r"FlexibleTree gives two outputs the name 'base_x'",
    ),
    "state of no name": (lambda: tree().state(leg=1.0), r"state 'leg' must be one of ja, jb"),
    "state NaN": (lambda: tree().state(ja=np.nan), r"FlexibleTree\.state.*nan"),
}
TABLE = {
    f"{part}: {name}": row
    for part, rows in (("joint", JOINTS), ("body", BODIES), ("tree", TREES))
    for name, row in rows.items()
}


@pytest.mark.parametrize("name", TABLE)
def test_refused(name):
    made, words = TABLE[name]
    with pytest.raises(ValueError, match=words):
        made()


def test_the_good_ones_are_taken():
    assert tree().nx == 4
    assert on("free").nx == 13
    assert len(TABLE) >= 60
